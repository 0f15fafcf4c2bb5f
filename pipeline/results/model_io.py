"""Finite-element models and reduced bodies as HDF5 files."""

from __future__ import annotations

import contextlib
import json
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.hdf5_files import opened_hdf5
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.storage import hdf5_stream, replacing
from heavylift.pipeline.results.structure_io import read_structure, write_structure

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

    import h5py
    from scipy.sparse import csr_array

    from heavylift.modal.reduced import ReducedBody
    from heavylift.modal.statics import StaticState
    from heavylift.preprocess.finite_elements.model import FEModel

__all__ = [
    "INTEGRAL_UNITS",
    "open_hdf5",
    "read_header",
    "read_model",
    "read_reduced",
    "read_states",
    "replacing_hdf5",
    "write_model",
    "write_reduced",
]

MODEL_FORMAT = "heavylift finite-element model 2"
REDUCED_FORMAT = "heavylift reduced body 3"


def open_hdf5(path: Path, remedy: str) -> AbstractContextManager[h5py.File]:
    """Open an HDF5 file of ours for reading; one that is absent, damaged or another one is an error with a remedy."""
    return opened_hdf5(path, f"a whole result file; {remedy}")


@contextlib.contextmanager
def replacing_hdf5(path: Path) -> Iterator[h5py.File]:
    """An HDF5 file to write, which replaces `path` in one step; errors as `storage.replacing`."""
    import h5py

    with replacing(path) as temporary, hdf5_stream(temporary) as stream, h5py.File(stream, "w") as file:
        yield file


def write_model(path: Path, model: FEModel, header: Mapping[str, Any]) -> None:
    """Write a finite-element model in SI units.

    Parameters
    ----------
    path
        Replaced in one step.
    model
        Matrices, mesh, material and groups.
    header
        Plain values kept as attributes, such as digests and versions.
    """
    with replacing_hdf5(path) as file:
        _write_header(file, MODEL_FORMAT, header)
        file.attrs["name"] = model.name
        file.attrs["notes"] = json.dumps(model.notes)
        _write(file, "nodes", model.nodes, "m", "positions of the nodes, body frame")
        _write(file, "fixed_nodes", model.fixed_nodes, "1", "zero-based nodes clamped by the data")
        _write_sparse(file, "stiffness", model.stiffness, "N/m", "K, node-major x y z")
        if model.points is None:
            _write_sparse(file, "mass", model.mass, "kg", "scalar mass matrix; the full one is kron(M, I3)")
        else:
            _write_sparse(
                file, "mass", model.mass, "kg, kg m, kg m^2", "mass matrix of all degrees of freedom"
            )
            points = file.create_group("points")
            _write(points, "positions", model.points.positions, "m", "places that have mass, body frame")
            _write(points, "masses", model.points.masses, "kg", "of these places")
            _write_sparse(
                points,
                "operator",
                model.points.operator,
                "1, m",
                "their displacements from degrees of freedom",
            )
        if model.rotating.size:
            _write(
                file,
                "rotating",
                model.rotating,
                "1",
                "zero-based nodes with rotations, after all displacements",
            )
        if model.fixed_dofs.size:
            _write(file, "fixed_dofs", model.fixed_dofs, "1", "zero-based degrees of freedom that are held")
        if model.constraint is not None:
            _write_sparse(
                file,
                "constraint",
                model.constraint,
                "1, m",
                "all degrees of freedom from those that are free",
            )
        if model.structure is not None:
            write_structure(file.create_group("structure"), model.structure)
        _write_groups(file, model.node_groups)
        if model.material is not None:
            group = file.create_group("material")
            for key, unit in (("young_modulus", "Pa"), ("poisson_ratio", "1"), ("density", "kg/m^3")):
                _write(group, key, getattr(model.material, key), unit, key.replace("_", " "))
        if model.mesh is not None:
            mesh = file.create_group("mesh")
            mesh.attrs["element_type"] = model.mesh.element_type
            mesh.attrs["name"] = model.mesh.name
            _write(mesh, "elements", model.mesh.elements, "1", "zero-based nodes, VTK order")
            if not np.array_equal(model.mesh.nodes, model.nodes):
                _write(mesh, "nodes", model.mesh.nodes, "m", "positions of the nodes of the mesh")
            _write_groups(mesh, model.mesh.node_groups)


def read_model(path: Path) -> FEModel:
    """Read a finite-element model that `write_model` wrote.

    Raises
    ------
    InputError
        If the file is absent, damaged or something else.
    """
    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.finite_elements.model import FEModel, MassPoints, Material

    with open_hdf5(path, "make it with `heavylift mesh CASE --force`") as file:
        _check_format(file, path, MODEL_FORMAT)
        nodes = file["nodes"][:]
        mesh = material = None
        if "mesh" in file:
            group = file["mesh"]
            mesh = Mesh(
                nodes=group["nodes"][:] if "nodes" in group else nodes,
                elements=group["elements"][:],
                element_type=str(group.attrs["element_type"]),
                node_groups=_read_groups(group),
                name=str(group.attrs["name"]),
            )
        points = structure = None
        if "points" in file:
            group = file["points"]
            points = MassPoints(group["positions"][:], group["masses"][:], _read_sparse(group["operator"]))
        if "structure" in file:
            structure = read_structure(file["structure"], nodes)
        if "material" in file:
            material = Material(**{key: float(value[()]) for key, value in file["material"].items()})
        return FEModel(
            nodes=nodes,
            stiffness=_read_sparse(file["stiffness"]),
            mass=_read_sparse(file["mass"]),
            mesh=mesh,
            material=material,
            node_groups=_read_groups(file),
            fixed_nodes=file["fixed_nodes"][:],
            fixed_dofs=_indices(file, "fixed_dofs"),
            rotating=_indices(file, "rotating"),
            points=points,
            constraint=_read_sparse(file["constraint"]) if "constraint" in file else None,
            structure=structure,
            name=str(file.attrs["name"]),
            notes=tuple(json.loads(file.attrs.get("notes", "[]"))),
        )


def write_reduced(
    path: Path, body: ReducedBody, header: Mapping[str, Any], states: Sequence[StaticState] = ()
) -> None:
    """Write a reduced body and its static load cases in SI units; parameters as `write_model`."""
    with replacing_hdf5(path) as file:
        _write_header(file, REDUCED_FORMAT, header)
        file.attrs["mean_axis"] = body.mean_axis
        file.attrs["orthogonality"] = body.orthogonality
        file.attrs["labels"] = json.dumps(body.labels)
        file.attrs["dropped"] = json.dumps(body.dropped)
        _write(file, "nodes", body.nodes, "m", "positions of the nodes, body frame")
        _write(file, "eigenvalues", body.eigenvalues, "rad^2/s^2", "diagonal of the modal stiffness")
        _write(file, "mode_shapes", body.mode_shapes, "kg^-0.5", "(vector, node, component), modal mass 1")
        if body.mesh is not None:
            mesh = file.create_group("mesh")
            mesh.attrs["element_type"] = body.mesh.element_type
            _write(mesh, "elements", body.mesh.elements, "1", "zero-based nodes, VTK order")
        if body.structure is not None:
            write_structure(file.create_group("structure"), body.structure)
        if body.mode_rotations is not None:
            _write(file, "rotating", body.rotating, "1", "zero-based nodes with rotations")
            _write(
                file,
                "mode_rotations",
                body.mode_rotations,
                "rad kg^-0.5 m^-1",
                "(vector, node, component), rotations of the nodes",
            )
        interfaces = file.create_group("interfaces")
        for name, interface in body.interfaces.items():
            group = interfaces.create_group(name)
            for key, (unit, words) in _INTERFACE_FIELDS.items():
                _write(group, key, getattr(interface, key), unit, words)
        _write(file, "residuals", body.residuals, "1", "relative residual of each vector in the full model")
        integrals = file.create_group("integrals")
        for key, value in body.integrals._asdict().items():
            _write(integrals, key, value, INTEGRAL_UNITS[key], key.replace("_", " "))
        if body.stiffening is not None:
            group = file.create_group("stiffening")
            group.attrs["labels"] = json.dumps(body.stiffening.labels)
            for key, (unit, words) in _STIFFENING.items():
                _write(group, key, getattr(body.stiffening, key), unit, words)
        statics = file.create_group("static")
        for state in states:
            group = statics.create_group(state.name)
            group.attrs["residual"] = state.residual
            _write(group, "displacements", state.displacements, "m", "of all nodes under a static load case")
            _write(group, "reaction", state.reaction, "N", "resultant of the forces of all supports")
            if state.rotations is not None:
                _write(group, "rotations", state.rotations, "rad", "of all nodes under a static load case")
            if state.buckling_factor is not None:
                group.attrs["buckling_factor"] = state.buckling_factor


_INTERFACE_FIELDS = {
    "point": ("m", "reference point, body frame"),
    "displacement": ("kg^-0.5", "of the point, (vector, component)"),
    "rotation": ("rad kg^-0.5 m^-1", "of the place relative to the frame, (vector, component)"),
    "nodes": ("1", "zero-based nodes of the group"),
    "forces": ("1, 1/m", "forces on the nodes from force and moment at the point, (node, component, load)"),
    "moments": ("m, 1", "moments on the nodes from force and moment at the point, (node, component, load)"),
    "captured": ("1", "smallest share of the static compliance of its six directions that the modes have"),
}

INTEGRAL_UNITS = {
    "mass": "kg",
    "first_moment": "kg m",
    "modal_translation": "kg^0.5",
    "inertia_kl": "kg m^2",
    "position_mode": "kg^0.5 m",
    "mode_mode": "1",
}


_STIFFENING = {
    "second_moments": ("1", "what second moments 11 22 33 12 13 23 lose by products of modal coordinates"),
    "angular": ("1", "modal stiffness by angular acceleration of the frame"),
    "linear": ("1/m", "modal stiffness by acceleration of the frame minus gravity"),
    "places": ("m", "points of the body frame where forces act whose stiffening is known"),
    "loads": ("1/(N s^2), 1/(N m s^2)", "modal stiffness by unit forces and moments there"),
    "generalised": ("1, m, kg^-0.5", "force, moment about the origin and modal forces of each of them"),
}


def read_reduced(path: Path) -> ReducedBody:
    """Read a reduced body that `write_reduced` wrote; errors as `read_model`."""
    from heavylift.modal.invariants import ShapeIntegrals
    from heavylift.modal.reduced import Interface, ReducedBody
    from heavylift.modal.stiffening import Stiffening
    from heavylift.preprocess.finite_elements.mesh import Mesh

    with open_hdf5(path, "make it with `heavylift modes CASE --force`") as file:
        _check_format(file, path, REDUCED_FORMAT)
        integrals = {key: dataset[()] for key, dataset in file["integrals"].items()}
        integrals["mass"] = float(integrals["mass"])
        stiffening = None
        if "stiffening" in file:
            group = file["stiffening"]
            stiffening = Stiffening(
                labels=tuple(json.loads(group.attrs["labels"])), **{key: group[key][:] for key in _STIFFENING}
            )
        nodes, mesh = file["nodes"][:], None
        if "mesh" in file:
            group = file["mesh"]
            mesh = Mesh(nodes, group["elements"][:], str(group.attrs["element_type"]))
        interfaces = {
            name: Interface(
                **{key: group[key][:] for key in _INTERFACE_FIELDS if key != "captured"},
                captured=float(group["captured"][()]),
            )
            for name, group in file["interfaces"].items()
        }
        return ReducedBody(
            nodes=nodes,
            eigenvalues=file["eigenvalues"][:],
            mode_shapes=file["mode_shapes"][:],
            integrals=ShapeIntegrals(**integrals),
            mean_axis=bool(file.attrs["mean_axis"]),
            labels=tuple(json.loads(file.attrs["labels"])),
            residuals=file["residuals"][:],
            orthogonality=float(file.attrs["orthogonality"]),
            dropped=tuple(json.loads(file.attrs["dropped"])),
            mesh=mesh,
            structure=read_structure(file["structure"], nodes) if "structure" in file else None,
            mode_rotations=file["mode_rotations"][:] if "mode_rotations" in file else None,
            rotating=_indices(file, "rotating"),
            interfaces=interfaces,
            stiffening=stiffening,
        )


def read_states(path: Path) -> dict[str, StaticState]:
    """Static load cases that `write_reduced` wrote, by name; errors as `read_model`."""
    from heavylift.modal.statics import StaticState

    with open_hdf5(path, "make it with `heavylift modes CASE --force`") as file:
        _check_format(file, path, REDUCED_FORMAT)
        return {
            name: StaticState(
                name,
                group["displacements"][:],
                group["reaction"][:],
                float(group.attrs["residual"]),
                group["rotations"][:] if "rotations" in group else None,
                float(group.attrs["buckling_factor"]) if "buckling_factor" in group.attrs else None,
            )
            for name, group in file["static"].items()
        }


def read_header(path: Path) -> dict[str, Any]:
    """Attributes of a file, with NumPy scalars made plain."""
    with open_hdf5(path, "make it with `heavylift run CASE --force`") as file:
        return {key: value.item() if hasattr(value, "item") else value for key, value in file.attrs.items()}


def _write_header(file: h5py.File, kind: str, header: Mapping[str, Any]) -> None:
    file.attrs["format"] = kind
    for key, value in header.items():
        file.attrs[key] = value if isinstance(value, (str, int, float)) else json.dumps(value)


def _check_format(file: h5py.File, path: Path, kind: str) -> None:
    found = str(file.attrs.get("format", "unknown"))
    if found != kind:
        raise InputError(f"is a file of format {found!r}", source=path, expected=f"a {kind!r}")


def _write(group: h5py.Group, key: str, value: Any, unit: str, description: str) -> None:
    dataset = group.create_dataset(key, data=value)
    dataset.attrs["unit"] = unit
    dataset.attrs["description"] = description


def _write_sparse(file: h5py.File, key: str, matrix: csr_array, unit: str, description: str) -> None:
    group = file.create_group(key)
    group.attrs["shape"] = matrix.shape
    _write(group, "data", matrix.data, unit, f"{description}; entries of a compressed sparse row matrix")
    _write(group, "indices", matrix.indices, "1", "columns of the entries")
    _write(group, "indptr", matrix.indptr, "1", "first entry of each row")


def _read_sparse(group: h5py.Group) -> csr_array:
    from scipy.sparse import csr_array

    parts = (group["data"][:], group["indices"][:], group["indptr"][:])
    return csr_array(parts, shape=tuple(int(n) for n in group.attrs["shape"]))


def _indices(group: h5py.Group, key: str) -> Any:
    """Indices of a file, none if it has none."""
    return group[key][:] if key in group else np.empty(0, dtype=np.int64)


def _write_groups(file: h5py.Group, node_groups: Mapping[str, Any]) -> None:
    group = file.create_group("node_groups")
    for name, nodes in node_groups.items():
        group.create_dataset(name, data=nodes)


def _read_groups(file: h5py.Group) -> dict[str, Any]:
    return {name: dataset[:] for name, dataset in file["node_groups"].items()}
