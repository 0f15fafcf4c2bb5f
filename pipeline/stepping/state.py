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

    from heavylift.pipeline.stepping.past import Past

__all__ = ["State"]

HEAD = b"heavylift state 1\n"
DIGEST = 16
"""Bytes behind the head, of what follows them."""
DRIVEN, CASE = "driven", "case"
"""Names of the digests of what inputs were set to, and of the case, beside the arrays."""


@dataclass(frozen=True, eq=False)
class State:
    """All that a continuation with the same bits needs: of bodies, ropes, controllers, the scenario and inputs.

    Attributes
    ----------
    arrays
        By name, as `heavylift.solver.simulation.Simulation.state` gives them.
    driven
        Digest of what inputs were set to up to it; None if that is not known.
    case
        Digest of the case, but for its duration.
    past
        What is behind it, in the process that has saved it; not among the bytes.

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
    driven: bytes | None = None
    case: str = ""
    past: Past | None = None

    @property
    def digest(self) -> bytes:
        """Of what inputs were set to up to it; if that is not known one that no other state has."""
        if self.driven is not None:
            return self.driven
        found = hashlib.blake2b(digest_size=DIGEST)
        for name, array in sorted(self.arrays.items()):
            if name != "cpu_seconds":
                found.update(name.encode() + array.tobytes())
        return found.digest()

    def to_bytes(self) -> bytes:
        """The state as bytes; in NumPy's format, without pickles."""
        stream = io.BytesIO()
        digests = {DRIVEN: np.frombuffer(self.digest, np.uint8), CASE: np.array(self.case)}
        np.savez(stream, **self.arrays, **digests)  # type: ignore[arg-type]
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
            arrays = {name: file[name] for name in file.files}
        return cls(arrays, arrays.pop(DRIVEN).tobytes(), str(arrays.pop(CASE)))


def _digest(data: bytes) -> bytes:
    return hashlib.blake2b(data, digest_size=DIGEST).digest()
