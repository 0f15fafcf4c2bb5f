"""Stress of a flexible body over a run as an HDF5 file."""

from __future__ import annotations

import json
from dataclasses import field
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.model_io import open_hdf5, replacing_hdf5

if TYPE_CHECKING:
    from pathlib import Path

    import h5py
    from numpy.typing import NDArray

__all__ = [
    "BodyStress",
    "GroupStress",
    "PanelStress",
    "PartEnvelope",
    "read_stress",
    "stress_digest_of",
    "write_stress",
]

_FORMAT = "heavylift stress 1"
_REMEDY = "make it with `heavylift report CASE --force`"


@dataclass(frozen=True, eq=False)
class PartEnvelope:
    """Extremes over all records at the points of one part of a body.

    Attributes
    ----------
    name
        Plate group, beam property, or the body.
    sides
        What stress is told of at each point.
    total
        Which of them are the whole stress of a material point, shape (sides,).
    positions
        In coordinates of the geometry [m], shape (m, 3).
    nodes
        Node of each point, shape (m,).
    thickness
        Of the plate there [m], shape (m,); no numbers where there is none.
    largest
        Von Mises stress by side [Pa], shape (m, sides).
    record
        Number of the record at which it is, shape (m, sides).
    highest, lowest
        Of the components of each layer [Pa], shape (m, layers, components), each by itself.
    """

    name: str
    sides: tuple[str, ...]
    total: NDArray[np.bool_]
    positions: NDArray[np.float64]
    nodes: NDArray[np.int64]
    thickness: NDArray[np.float64]
    largest: NDArray[np.float32]
    record: NDArray[np.int32]
    highest: NDArray[np.float32]
    lowest: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class GroupStress:
    """Largest stress of a group at each record.

    Attributes
    ----------
    name
        Of the group.
    sides
        What is told: `heavylift.modal.stress_points.SURFACE`, or sides of plates.
    total
        Which of them are the whole stress of a material point, shape (sides,).
    largest
        Von Mises stress [Pa], shape (records, sides).
    place
        Where it is, in coordinates of the geometry [m], shape (records, sides, 3).
    strength
        Of the yield strengths of its points the smallest and the largest [Pa], shape (2,); empty without.
    utilisation
        Largest ratio to the yield strength, partial factor included, shape (records, sides); empty without strength.
    used_place
        Where that is, as `place`; empty without strength.
    """

    name: str
    sides: tuple[str, ...]
    total: NDArray[np.bool_]
    largest: NDArray[np.float64]
    place: NDArray[np.float64]
    strength: NDArray[np.float64]
    utilisation: NDArray[np.float64]
    used_place: NDArray[np.float64]

    def history(self, side: str = "", *, used: bool = False) -> NDArray[np.float64]:
        """Von Mises stress [Pa], or utilisation, at each record, shape (records,).

        Parameters
        ----------
        side
            One of its sides; empty for the largest of those that are the whole stress.
        used
            Whether the utilisation is meant.

        Raises
        ------
        InputError
            If it has no such side, or no strength.
        """
        values = self.utilisation if used else self.largest
        if used and not self.strength.size:
            raise InputError(
                f"group {self.name!r} has no yield strength",
                expected="'grade' or 'yield_strength' in 'stress'",
            )
        if not side:
            return np.asarray(values[:, self.total].max(axis=1))
        if side not in self.sides:
            raise InputError(
                f"group {self.name!r} has no side {side!r}", expected=f"one of: {', '.join(self.sides)}"
            )
        return np.asarray(values[:, self.sides.index(side)])

    def extreme(self, side: str = "", *, used: bool = False) -> tuple[float, int, NDArray[np.float64]]:
        """Largest value of `history`, its record and its place [m]."""
        history = self.history(side, used=used)
        record = int(history.argmax())
        return float(history[record]), record, self.place_at(record, side, used=used)

    def place_at(self, record: int, side: str = "", *, used: bool = False) -> NDArray[np.float64]:
        """Where the value of `history` at a record is, in coordinates of the geometry [m], shape (3,)."""
        columns = [self.sides.index(side)] if side else np.flatnonzero(self.total).tolist()
        values, places = (self.utilisation, self.used_place) if used else (self.largest, self.place)
        column = max(columns, key=lambda one: values[record, one])
        return np.asarray(places[record, column])


@dataclass(frozen=True, eq=False)
class PanelStress:
    """Rectangular plates between stiffeners and other plates.

    Attributes
    ----------
    group
        Names of their properties.
    centre
        In coordinates of the geometry [m], shape (np, 3).
    length, width, thickness
        a >= b and t [m], shape (np,).
    stress
        Mean sigma_x along a, sigma_y and tau at each record [Pa], tension positive, shape (records, np, 3).
    use
        Utilisation by buckling at each record, shape (records, np).
    """

    group: tuple[str, ...]
    centre: NDArray[np.float64]
    length: NDArray[np.float64]
    width: NDArray[np.float64]
    thickness: NDArray[np.float64]
    stress: NDArray[np.float32]
    use: NDArray[np.float32]

    def of(self, name: str) -> NDArray[np.int64]:
        """Numbers of the panels of a group; InputError if it has none."""
        found = np.flatnonzero([one == name for one in self.group])
        if not found.size:
            groups = ", ".join(dict.fromkeys(self.group)) or "there are none"
            raise InputError(f"{name!r} has no plate panels", expected=f"a group that has: {groups}")
        return found


@dataclass(frozen=True, eq=False)
class BodyStress:
    """Stress of a flexible body over a run.

    Attributes
    ----------
    times
        Of the records [s], shape (records,).
    groups
        By name.
    hot_spots
        Structural stress at weld toes at each record [Pa], by name, shape (records,).
    parts
        Envelopes.
    correction
        Displacements, and rotations of nodes that have some, by unit load of the static correction, shape (N, k).
    loads
        These loads at each record, shape (records, k).
    notes
        What is to be known, one sentence each.
    panels
        Of plates; None if they are not asked for.
    """

    times: NDArray[np.float64]
    groups: dict[str, GroupStress]
    hot_spots: dict[str, NDArray[np.float64]]
    parts: tuple[PartEnvelope, ...]
    correction: NDArray[np.float64]
    loads: NDArray[np.float64]
    notes: tuple[str, ...] = field(default=())
    panels: PanelStress | None = None

    def corrected(
        self,
        record: int,
        displacements: NDArray[np.float64],
        rotations: NDArray[np.float64] | None,
        rotating: NDArray[np.int64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
        """Displacements of the modes (n, 3) [m], and rotations (n, 3), with those of the static correction at a record.

        `rotating` are the nodes that have rotations.
        """
        more = self.correction @ self.loads[record]
        own = displacements.size
        moved = displacements + more[:own].reshape(-1, 3)
        if rotations is not None:
            rotations = rotations.copy()
            rotations[rotating] += more[own:].reshape(-1, 3)
        return moved, rotations

    def group(self, name: str) -> GroupStress:
        """A group by name; InputError if there is none."""
        if name not in self.groups:
            raise InputError(
                f"there is no group {name!r} of stress", expected=f"one of: {', '.join(self.groups)}"
            )
        return self.groups[name]


_UNITS = {
    "times": "s",
    "centre": "m",
    "length": "m",
    "width": "m",
    "stress": "Pa",
    "largest": "Pa",
    "highest": "Pa",
    "lowest": "Pa",
    "positions": "m",
    "place": "m",
    "used_place": "m",
    "strength": "Pa",
    "thickness": "m",
}
"""Of what has a dimension."""


def write_stress(path: Path, stress: BodyStress, digest: str) -> None:
    """Write the stress of a body in SI units, with the digest of what it was made from; replaces `path` in one step."""
    with replacing_hdf5(path) as file:
        file.attrs["format"] = _FORMAT
        file.attrs["digest"] = digest
        file.attrs["notes"] = json.dumps(stress.notes)
        for key in ("times", "correction", "loads"):
            _write(file, key, getattr(stress, key))
        groups = file.create_group("groups")
        for number, group in enumerate(stress.groups.values()):
            _write_entry(groups.create_group(f"{number:06d}"), group)
        spots = file.create_group("hot_spots")
        for name, history in stress.hot_spots.items():
            spots.create_dataset(name, data=history).attrs["unit"] = "Pa"
        file.attrs["hot_spots"] = json.dumps(list(stress.hot_spots))
        parts = file.create_group("parts")
        for number, part in enumerate(stress.parts):
            _write_entry(parts.create_group(f"{number:06d}"), part)
        if stress.panels is not None:
            panels = file.create_group("panels")
            panels.attrs["group"] = json.dumps(stress.panels.group)
            for key, value in vars(stress.panels).items():
                if key != "group":
                    _write(panels, key, value)


def read_stress(path: Path) -> BodyStress:
    """Read what `write_stress` wrote; InputError if the file is absent, damaged or something else."""
    with open_hdf5(path, _REMEDY) as file:
        if file.attrs.get("format") != _FORMAT:
            raise InputError("is no file of stress", source=path, expected=f"a {_FORMAT!r}; {_REMEDY}")
        entries = [GroupStress(**_read_entry(group)) for group in file["groups"].values()]
        return BodyStress(
            times=file["times"][()],
            correction=file["correction"][()],
            loads=file["loads"][()],
            notes=tuple(json.loads(file.attrs["notes"])),
            groups={group.name: group for group in entries},
            hot_spots={name: file["hot_spots"][name][()] for name in json.loads(file.attrs["hot_spots"])},
            parts=tuple(PartEnvelope(**_read_entry(part)) for part in file["parts"].values()),
            panels=_read_panels(file["panels"]) if "panels" in file else None,
        )


def _read_panels(group: h5py.Group) -> PanelStress:
    values: dict[str, Any] = {key: dataset[()] for key, dataset in group.items()}
    return PanelStress(group=tuple(json.loads(group.attrs["group"])), **values)


def stress_digest_of(path: Path) -> str:
    """Digest of what a file was made from; empty if there is no whole file."""
    if not path.is_file():
        return ""
    try:
        with open_hdf5(path, _REMEDY) as file:
            return str(file.attrs.get("digest", "")) if file.attrs.get("format") == _FORMAT else ""
    except InputError:
        return ""


def _write(group: h5py.Group, key: str, value: Any) -> None:
    group.create_dataset(key, data=value).attrs["unit"] = _UNITS.get(key, "1")


def _write_entry(group: h5py.Group, entry: GroupStress | PartEnvelope) -> None:
    group.attrs["name"] = entry.name
    group.attrs["sides"] = json.dumps(entry.sides)
    for key, value in vars(entry).items():
        if key not in {"name", "sides"}:
            _write(group, key, value)


def _read_entry(group: h5py.Group) -> dict[str, Any]:
    values: dict[str, Any] = {key: dataset[()] for key, dataset in group.items()}
    return {
        **values,
        "name": str(group.attrs["name"]),
        "sides": tuple(json.loads(group.attrs["sides"])),
    }
