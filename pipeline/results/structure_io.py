"""Structures of plates, beams and masses as groups of HDF5 files."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.structures.sections import BeamSection
from heavylift.preprocess.structures.structure import (
    Average,
    Beams,
    PointMass,
    RigidLink,
    Shells,
    Solids,
    Structure,
    Tie,
)

if TYPE_CHECKING:
    import h5py

__all__ = ["read_structure", "write_structure"]

_PARTS: dict[str, type[Any]] = {
    "shells": Shells,
    "beams": Beams,
    "solids": Solids,
    "masses": PointMass,
    "links": RigidLink,
    "averages": Average,
    "ties": Tie,
}
"""Fields of a structure that are tuples of parts."""

_OWN: dict[str, type[Any]] = {"material": Material, "section": BeamSection}
"""Fields of parts that have fields of their own."""

_UNITS = {
    "area": "m^2",
    "corners": "m",
    "density": "kg/m^3",
    "inertia": "kg m^2",
    "mass": "kg",
    "nonstructural_mass": "kg/m or kg/m^2",
    "offset": "m",
    "offset_a": "m",
    "offset_b": "m",
    "product": "m^4",
    "second_moment_1": "m^4",
    "second_moment_2": "m^4",
    "shear_area_1": "m^2",
    "shear_area_2": "m^2",
    "shear_centre": "m",
    "thickness": "m",
    "torsion": "m^4",
    "young_modulus": "Pa",
}
"""Of fields with a dimension; plain numbers and indices have the unit 1."""


def write_structure(group: h5py.Group, structure: Structure) -> None:
    """Write all of a structure but its nodes, which are those of the model or body in the same file."""
    group.attrs["name"] = structure.name
    group.attrs["notes"] = list(structure.notes)
    group.create_dataset("numbers", data=structure.numbers)
    groups = group.create_group("node_groups")
    for name, nodes in structure.node_groups.items():
        groups.create_dataset(name, data=nodes)
    for key in _PARTS:
        parts = group.create_group(key)
        for index, part in enumerate(getattr(structure, key)):
            _write_fields(parts.create_group(f"{index:06d}"), part)


def read_structure(group: h5py.Group, nodes: Any) -> Structure:
    """Read a structure that `write_structure` wrote; nodes [m], shape (n, 3), are those of the file."""
    parts = {
        key: tuple(_read_fields(part, kind) for part in group[key].values()) for key, kind in _PARTS.items()
    }
    return Structure(
        nodes,
        node_groups={name: dataset[:] for name, dataset in group["node_groups"].items()},
        numbers=group["numbers"][:],
        name=str(group.attrs["name"]),
        notes=tuple(str(note) for note in group.attrs["notes"]),
        **parts,
    )


def _write_fields(group: h5py.Group, part: Any) -> None:
    for one in dataclasses.fields(part):
        value = getattr(part, one.name)
        if one.name in _OWN:
            _write_fields(group.create_group(one.name), value)
        elif isinstance(value, (str, bool)):
            group.attrs[one.name] = value
        else:
            dataset = group.create_dataset(one.name, data=value)
            dataset.attrs["unit"] = _UNITS.get(one.name, "1")


def _read_fields(group: h5py.Group, kind: type[Any]) -> Any:
    values: dict[str, Any] = {
        name: bool(value) if isinstance(value, np.bool_) else str(value)
        for name, value in group.attrs.items()
    }
    for name, item in group.items():
        if name in _OWN:
            values[name] = _read_fields(item, _OWN[name])
        elif item.shape:
            array = item[()]
            values[name] = tuple(array.tolist()) if name == "shear_centre" else array
        else:
            values[name] = item[()].item()
    return kind(**values)
