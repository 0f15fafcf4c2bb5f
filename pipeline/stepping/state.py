"""The state of a simulation as one object, and as bytes for another process."""

from __future__ import annotations

import hashlib
import io
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["State"]

HEAD = b"heavylift state 1\n"
DIGEST = 16
"""Bytes behind the head, of what follows them."""


@dataclass(frozen=True, eq=False)
class State:
    """All that a continuation with the same bits needs: of bodies, ropes, controllers, the scenario and inputs.

    Attributes
    ----------
    arrays
        By name, as `heavylift.solver.simulation.Simulation.state` gives them.

    Examples
    --------
    >>> import heavylift as hl
    >>> sim = hl.Simulation("cases/hoist")
    >>> sim.step(0.1)
    >>> state = hl.State.from_bytes(sim.save().to_bytes())
    >>> sim.step(0.1)
    >>> sim.restore(state)
    >>> round(sim.time, 9)
    0.1
    """

    arrays: dict[str, NDArray[Any]]

    def to_bytes(self) -> bytes:
        """The state as bytes; in NumPy's format, without pickles."""
        stream = io.BytesIO()
        np.savez(stream, **self.arrays)  # type: ignore[arg-type]
        data = stream.getvalue()
        return HEAD + _digest(data) + data

    @classmethod
    def from_bytes(cls, data: bytes) -> State:
        """A state from its bytes.

        Raises
        ------
        InputError
            If they are none.
        """
        begin = len(HEAD) + DIGEST
        whole = bytes(data)
        if whole[:begin] != HEAD + _digest(whole[begin:]):
            raise InputError(
                f"{len(whole)} bytes that are no state",
                source="simulation",
                key="state",
                expected="what 'State.to_bytes' gives",
            )
        with np.load(io.BytesIO(whole[begin:]), allow_pickle=False) as file:
            return cls({name: file[name] for name in file.files})


def _digest(data: bytes) -> bytes:
    return hashlib.blake2b(data, digest_size=DIGEST).digest()
