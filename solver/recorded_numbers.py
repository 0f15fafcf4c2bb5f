"""Numbers of a record by name, as other programs ask for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable

    from heavylift.solver.scene.channels import Channel

__all__ = ["RecordedNumber", "recorded_numbers"]


class RecordedNumber(NamedTuple):
    """A number of a record: its channel, column, SI unit, and sentence."""

    channel: str
    column: int
    unit: str
    sentence: str


def recorded_numbers(channels: Iterable[Channel]) -> dict[str, RecordedNumber]:
    """All numbers of channels: ``OWNER.CHANNEL.COMPONENT``, or ``OWNER.CHANNEL`` of a channel of one number.

    Parameters
    ----------
    channels
        Of a simulation.

    Examples
    --------
    >>> from heavylift.solver.scene.channels import Channel
    >>> place = Channel("load.position", "m", ("x", "y", "z"), 0, "where it is")
    >>> pull = Channel("fall.tension", "N", ("",), 3, "largest of its parts")
    >>> {name: number.column for name, number in recorded_numbers([place, pull]).items()}
    {'load.position.x': 0, 'load.position.y': 1, 'load.position.z': 2, 'fall.tension': 3}
    """
    found = {}
    for channel in channels:
        for k, component in enumerate(channel.components):
            name = channel.name if len(channel.components) == 1 else f"{channel.name}.{component}"
            found[name] = RecordedNumber(channel.name, channel.column + k, channel.unit, channel.sentence)
    return found
