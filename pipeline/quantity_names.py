"""Names of computed quantities, as checks and convergence studies write them.

=============================================  ==========================================================
``mesh.BODY.node_count``                       also ``element_count``, ``dof_count``, ``mass``, ``volume``
``modes.BODY.frequency.I``                     natural frequency of vector I of the reduced body
``modes.BODY.residual.I``                      relative residual of that vector in the full model
``modes.BODY.orthogonality``                   largest deviation of the modal mass from the identity
``ringdown.BODY.I``                            frequency of one sinusoid fitted to modal coordinate I
``drift.energy``                               also ``momentum``, ``angular_momentum``: largest deviation
                                               from the initial value, relative
``channel.OWNER.KIND[.COMPONENT].STATISTIC``   ``end``, ``min``, ``max``, ``mean`` or ``rms`` of a recorded
                                               channel, e.g. ``channel.tip.position.y.max``
=============================================  ==========================================================
"""

from __future__ import annotations

from difflib import get_close_matches
from typing import NamedTuple

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.units import KINDS, Kind

__all__ = ["QuantityName", "parse_quantity_name"]

MESH_QUANTITIES = {
    "node_count": "number",
    "element_count": "number",
    "dof_count": "number",
    "mass": "mass",
    "volume": "volume",
}
DRIFTS = ("energy", "momentum", "angular_momentum")
STATISTICS = ("end", "min", "max", "mean", "rms")
ENERGIES = ("kinetic", "elastic", "potential", "external_work", "drive_work", "dissipated", "balance")
BODY_CHANNELS = {
    "position": "length",
    "orientation": "number",
    "velocity": "velocity",
    "angular_velocity": "angular velocity",
    "modal_position": "modal coordinate",
    "modal_velocity": "modal velocity",
    "reaction_force": "force",
    "reaction_moment": "moment or energy",
}
SCENE_CHANNELS = {f"energy.{name}": "moment or energy" for name in ENERGIES} | {
    "momentum.linear": "momentum",
    "momentum.angular": "angular momentum",
}
RESERVED_NAMES = frozenset({"energy", "momentum", "time"})
"""First parts of channel names that no body or sensor may take."""


class QuantityName(NamedTuple):
    """A quantity string, taken apart."""

    text: str
    family: str
    """``mesh``, ``modes``, ``ringdown``, ``drift`` or ``channel``."""
    owner: str
    """Body or sensor; empty for quantities of the whole scene."""
    item: str
    """What of the owner, e.g. ``frequency`` or the channel name ``tip.position``."""
    component: str
    """One-based number of a vector, or component of a channel; may be empty."""
    statistic: str
    """Of a channel."""
    kind: Kind
    """Its unit and dimension."""

    @property
    def stage(self) -> str:
        """The last stage that must have run."""
        return self.family if self.family in {"mesh", "modes"} else "simulate"


def parse_quantity_name(text: str) -> QuantityName:
    """Take a quantity string apart.

    Raises
    ------
    InputError
        If it is not one of the forms in the table above.
    """
    parts = text.split(".")
    readers = {
        "mesh": _mesh,
        "modes": _modes,
        "ringdown": _ringdown,
        "drift": _drift,
        "channel": _channel,
    }
    if parts[0] not in readers:
        raise InputError(
            _unknown(text, parts[0], readers), expected=f"one of {', '.join(readers)} as first word"
        )
    return readers[parts[0]](text, parts)


def _unknown(text: str, word: str, known: object) -> str:
    near = get_close_matches(word, list(known), 1)  # type: ignore[call-overload]
    return f"quantity {text!r} is unknown" + (f"; did you mean {near[0]!r}?" if near else "")


def _mesh(text: str, parts: list[str]) -> QuantityName:
    if len(parts) != 3 or parts[2] not in MESH_QUANTITIES:
        word = parts[2] if len(parts) > 2 else ""
        raise InputError(
            _unknown(text, word, MESH_QUANTITIES), expected="mesh.BODY." + "|".join(MESH_QUANTITIES)
        )
    return QuantityName(text, "mesh", parts[1], parts[2], "", "", KINDS[MESH_QUANTITIES[parts[2]]])


def _modes(text: str, parts: list[str]) -> QuantityName:
    numbered = len(parts) == 4 and parts[2] in {"frequency", "residual"} and _is_index(parts[3])
    if not numbered and not (len(parts) == 3 and parts[2] == "orthogonality"):
        raise InputError(
            f"quantity {text!r} is unknown",
            expected="modes.BODY.frequency.I, modes.BODY.residual.I (I from 1) or modes.BODY.orthogonality",
        )
    kind = KINDS["frequency" if parts[2] == "frequency" else "number"]
    return QuantityName(text, "modes", parts[1], parts[2], parts[3] if numbered else "", "", kind)


def _ringdown(text: str, parts: list[str]) -> QuantityName:
    if len(parts) != 3 or not _is_index(parts[2]):
        raise InputError(f"quantity {text!r} is unknown", expected="ringdown.BODY.I, I from 1")
    return QuantityName(text, "ringdown", parts[1], "frequency", parts[2], "", KINDS["frequency"])


def _drift(text: str, parts: list[str]) -> QuantityName:
    if len(parts) != 2 or parts[1] not in DRIFTS:
        raise InputError(_unknown(text, parts[-1], DRIFTS), expected="drift." + "|".join(DRIFTS))
    return QuantityName(text, "drift", "", parts[1], "", "", KINDS["number"])


def _channel(text: str, parts: list[str]) -> QuantityName:
    if len(parts) not in {4, 5} or parts[-1] not in STATISTICS:
        raise InputError(
            f"quantity {text!r} is unknown",
            expected="channel.OWNER.KIND.STATISTIC or channel.OWNER.KIND.COMPONENT.STATISTIC with STATISTIC one of "
            + ", ".join(STATISTICS),
        )
    name, component = f"{parts[1]}.{parts[2]}", parts[3] if len(parts) == 5 else ""
    if parts[1] in RESERVED_NAMES:
        known, key, owner = SCENE_CHANNELS, name, ""
    else:
        known, key, owner = BODY_CHANNELS, parts[2], parts[1]
    if key not in known:
        raise InputError(_unknown(text, key, known), expected="a channel: " + ", ".join(known))
    return QuantityName(text, "channel", owner, name, component, parts[-1], KINDS[known[key]])


def _is_index(text: str) -> bool:
    return text.isdecimal() and int(text) >= 1
