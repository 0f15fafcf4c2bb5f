"""From the sections of a flexible body to its finite-element model and reduced body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case_geometry import BoxGroup, FaceGroup, PlaneGroup
from heavylift.pipeline.storage import replacing

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.modal.reduced import ReducedBody
    from heavylift.pipeline.case import Case
    from heavylift.pipeline.case_bodies import FlexibleBodySection, ModesSection
    from heavylift.pipeline.case_geometry import FourFilesGeometry, Group
    from heavylift.preprocess.exchange import FourFileData
    from heavylift.preprocess.groups import NodeSelector
    from heavylift.preprocess.mesh import Mesh
    from heavylift.preprocess.model import FEModel

__all__ = [
    "assemble_model",
    "model_properties",
    "reduce_model",
    "reduced_properties",
    "write_vtu",
]


def assemble_model(case: Case, name: str, body: FlexibleBodySection) -> FEModel:
    """Mesh a body and assemble its matrices, or read them."""
    from heavylift.preprocess.elasticity import assemble
    from heavylift.preprocess.model import Material

    if body.geometry.type == "four_files":
        return _four_files(case, body.geometry).model
    assert body.material is not None
    mesh = _mesh(case, name, body)
    material = Material(**body.material.model_dump())
    return assemble(mesh, material, formulation=body.mesh.formulation, mass=body.mesh.mass)


def _mesh(case: Case, name: str, body: FlexibleBodySection) -> Mesh:
    from heavylift.preprocess.refinement import Refinement

    geometry, options = body.geometry, body.mesh
    selectors = _selectors(geometry.groups)
    refine = [Refinement(place.at, place.size, place.growth) for place in options.refine]
    if geometry.type == "blocks":
        from heavylift.preprocess.blocks import Box, mesh_blocks

        add, cut = (
            [Box(block.name, block.lower, block.upper) for block in blocks]
            for blocks in (geometry.add, geometry.cut)
        )
        return mesh_blocks(
            add,
            cut,
            element_type=options.element,
            size=options.size,
            divisions={axis: counts for axis, counts in options.divisions.items()} or None,  # noqa: C416
            groups=selectors,
            refine=refine,
            name=name,
        )
    if geometry.type == "step":
        from heavylift.preprocess.geometry import read_step

        file = case.folder / geometry.file
        return read_step(file, size=options.size, curved=options.curved, groups=selectors, refine=refine)
    from heavylift.preprocess.geometry import read_mesh

    assert geometry.type == "mesh"
    return read_mesh(case.folder / geometry.file, length_unit=geometry.length_unit, groups=selectors)


def _selectors(groups: Mapping[str, Group]) -> list[NodeSelector]:
    from heavylift.preprocess.groups import InBox, OnFace, OnPlane

    selectors: list[NodeSelector] = []
    for name, group in groups.items():
        if isinstance(group, PlaneGroup):
            selectors.append(OnPlane(name, group.plane, group.at))
        elif isinstance(group, BoxGroup):
            selectors.append(InBox(name, group.lower, group.upper))
        elif isinstance(group, FaceGroup):
            selectors.append(OnFace(name, group.face))
    return selectors


def _four_files(case: Case, geometry: FourFilesGeometry) -> FourFileData:
    from dataclasses import replace

    from heavylift.preprocess.exchange import read_four_files
    from heavylift.preprocess.groups import select_nodes

    clamped = geometry.clamped_nodes
    folder = case.folder / geometry.folder
    data = read_four_files(
        folder,
        length_unit=geometry.length_unit,
        mass_factor=geometry.mass_unit,
        stiffness_factor=geometry.stiffness_unit,
        clamped_nodes=None if clamped is None else [node - 1 for node in clamped],
    )
    groups = select_nodes(data.model.nodes, _selectors(geometry.groups), source=str(folder))
    return replace(data, model=replace(data.model, node_groups={**data.model.node_groups, **groups}))


def model_properties(model: FEModel) -> dict[str, Any]:
    """Numbers of a finite-element model for its manifest and for checks."""
    density = model.material.density if model.material else None
    return {
        "node_count": model.node_count,
        "element_count": None if model.mesh is None else len(model.mesh.elements),
        "dof_count": 3 * model.node_count,
        "mass": model.total_mass,
        "volume": None if density is None else model.total_mass / density,
    }


def write_vtu(path: Path, model: FEModel) -> None:
    """Write the mesh of a model, with its groups as 0/1 point data, for viewers; nothing without elements."""
    if model.mesh is None:
        return
    import meshio

    kind = {"tet10": "tetra10", "hex8": "hexahedron"}[model.mesh.element_type]
    groups = {name: np.isin(np.arange(model.node_count), nodes) for name, nodes in model.node_groups.items()}
    mesh = meshio.Mesh(
        model.nodes,
        [(kind, model.mesh.elements)],
        point_data={f"group {name}": member.astype(np.int64) for name, member in groups.items()},
    )
    with replacing(path) as temporary:
        mesh.write(temporary, file_format="vtu")


def reduce_model(
    case: Case, body: FlexibleBodySection, model: FEModel
) -> tuple[ReducedBody, tuple[float, float, float]]:
    """Reduced body of a model, and the origin of its frame in coordinates of the geometry [m]."""
    from heavylift.modal import bases
    from heavylift.modal.eigen import eigenmodes
    from heavylift.modal.flexibility import Flexibility
    from heavylift.modal.reduction import reduce_body

    options = body.modes
    clamped = _nodes_of(model, options.clamp)
    origin = np.zeros(3)
    if body.frame.origin == "centre_of_mass":
        row_sum = np.asarray(model.mass.sum(axis=0)).ravel()
        origin = row_sum @ model.nodes / row_sum.sum()
    if options.basis == "stored":
        assert body.geometry.type == "four_files"
        shapes = _four_files(case, body.geometry).modes
        chosen = [number - 1 for number in options.select] or list(range(shapes.shape[1]))
        if max(chosen) >= shapes.shape[1]:
            raise InputError(
                f"'modes.select' asks for shape {max(chosen) + 1}",
                source=case.file,
                expected=f"numbers up to {shapes.shape[1]}, the stored shapes",
            )
        basis = bases.Basis(shapes[:, chosen], tuple(f"stored {number + 1}" for number in chosen))
        flexibility = Flexibility(model, clamped) if options.has_static else None
    elif options.basis == "craig_bampton":
        interface = _nodes_of(model, options.interface)
        basis = bases.craig_bampton(model, interface, options.count, fixed_nodes=clamped)
        flexibility = Flexibility(model, clamped) if options.has_static else None
    else:
        flexibility = Flexibility(model, clamped)
        parts = []
        if options.count:
            modes = eigenmodes(model, options.count, flexibility=flexibility)
            parts.append(bases.eigenmode_basis(modes, options.select or None))
        if options.basis == "krylov":
            parts += [
                bases.moment_matching(flexibility, loads, options.order) for loads in _loads(options, model)
            ]
        basis = sum(parts[1:], start=parts[0])
    if flexibility is not None and options.basis != "krylov":
        for loads in _loads(options, model):
            basis += bases.static_vectors(flexibility, loads)
    reduced = reduce_body(
        model,
        basis.vectors,
        basis.labels,
        fixed_nodes=clamped,
        origin=origin,
        mean_axis=body.frame.motion == "free",
    )
    return reduced, tuple(float(x) for x in origin)  # type: ignore[return-value]


def _nodes_of(model: FEModel, groups: Sequence[str]) -> NDArray[np.int64]:
    """Nodes of some groups together."""
    for group in groups:
        if group not in model.node_groups:
            known = ", ".join(sorted(model.node_groups)) or "none"
            raise InputError(
                f"group {group!r} does not exist", source=model.name, expected=f"one of: {known}"
            )
    parts = [model.node_groups[group] for group in groups]
    return np.unique(np.concatenate(parts)).astype(np.int64) if parts else np.empty(0, dtype=np.int64)


def _loads(options: ModesSection, model: FEModel) -> list[Any]:
    """Static loads of the points and groups of a reduction."""
    from heavylift.modal import bases

    loads = []
    if options.static_points:
        nearest = {
            int(np.argmin(((model.nodes - point) ** 2).sum(axis=1))): None for point in options.static_points
        }
        loads.append(bases.point_loads(model, list(nearest), options.static_directions))
    for group in options.static_groups:
        nodes = _nodes_of(model, [group])
        loads.append(bases.patch_loads(model, nodes, options.static_directions, name=group))
    return loads


def reduced_properties(reduced: ReducedBody) -> dict[str, Any]:
    """Numbers of a reduced body for its manifest."""
    return {
        "vector_count": reduced.mode_count,
        "frequencies_hz": [float(f) for f in reduced.frequencies],
        "largest_residual": float(reduced.residuals.max()),
        "orthogonality": reduced.orthogonality,
        "dropped": list(reduced.dropped) or None,
    }
