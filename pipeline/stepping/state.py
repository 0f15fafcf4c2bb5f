"""The state of a simulation as one object, and as bytes for another process."""

from __future__ import annotations

import hashlib
import io
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["InputChange", "Past", "State"]

HEAD = b"heavylift state 1\n"
DIGEST = 16
"""Bytes behind the head, of what follows them."""


class InputChange(NamedTuple):
    """A row of the log of inputs.

    From a time [s] on an input has a value that changes at a rate, until a time [s].
    """

    time: float
    name: str
    value: float
    rate: float
    until: float


class Past(NamedTuple):
    """What led to a state: chains that many states share, whose last parts are the newest ones.

    Attributes
    ----------
    origin
        Digest of the state of another process with which it began; empty for the start of the case.
    records
        A chain of times, shape (rows,), and records, shape (rows, columns): what was before, and the last part.
    changes
        A chain of changes of inputs.
    """

    origin: str
    records: tuple[Any, tuple[NDArray[np.float64], NDArray[np.float64]]] | None = None
    changes: tuple[Any, InputChange] | None = None

    def with_records(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> Past:
        """The same, and records that follow."""
        return self._replace(records=(self.records, (times, rows)))

    def with_change(self, change: InputChange) -> Past:
        """The same, and a change that follows."""
        return self._replace(changes=(self.changes, change))

    @property
    def all_records(self) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Parts of times and records, the oldest first."""
        return _listed(self.records)

    @property
    def all_changes(self) -> list[InputChange]:
        """Changes of inputs, the oldest first."""
        return _listed(self.changes)


def _listed(chain: Any) -> list[Any]:
    """Parts of a chain, the oldest first."""
    parts = []
    while chain is not None:
        chain, part = chain
        parts.append(part)
    return parts[::-1]


@dataclass(frozen=True, eq=False)
class State:
    """All that a continuation with the same bits needs: of bodies, ropes, controllers, the scenario and inputs.

    Attributes
    ----------
    arrays
        By name, as `heavylift.solver.simulation.Simulation.state` gives them.
    past
        How it came about; None of a state from bytes, of which nobody here knows it.

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
    past: Past | None = None

    @property
    def digest(self) -> str:
        """Digest of all that a continuation depends on."""
        found = hashlib.blake2b(digest_size=DIGEST)
        for name in sorted(self.arrays.keys() - {"cpu_seconds"}):
            found.update(name.encode() + self.arrays[name].tobytes())
        return found.hexdigest()

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
