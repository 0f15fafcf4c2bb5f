"""From the sections of a flexible body to its finite-element model."""

from __future__ import annotations

import contextlib
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.geometry import BoxGroup, FaceGroup, PlaneGroup
from heavylift.pipeline.results.storage import replacing

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.flexible_bodies import FlexibleBodySection
    from heavylift.pipeline.case.geometry import (
        FourFilesGeometry,
        Group,
        MaterialSection,
        MatricesGeometry,
        MeshFileGeometry,
    )
    from heavylift.pipeline.case.panels import PanelsGeometry
    from heavylift.preprocess.finite_elements.deck import Deck
    from heavylift.preprocess.finite_elements.exchange import FourFileData
    from heavylift.preprocess.finite_elements.groups import NodeSelector
    from heavylift.preprocess.finite_elements.material import Material
    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.finite_elements.model import FEModel
    from heavylift.preprocess.structures.structure import Structure

__all__ = [
    "assemble_model",
    "four_files",
    "in_body",
    "model_properties",
    "write_vtu",
]


def assemble_model(case: Case, name: str, body: FlexibleBodySection) -> FEModel:
    """Mesh a body and assemble its matrices, or read them; its notes say what was found in files."""
    from heavylift.preprocess.finite_elements.elasticity import assemble
    from heavylift.preprocess.finite_elements.model import Material

    with in_body(case, name):
        if body.geometry.type == "four_files":
            return four_files(case, body.geometry).model
        if body.geometry.type == "matrices":
            return _of_matrices(case, body.geometry)
        if body.geometry.type == "mesh":
            return _of_deck(case, name, body, body.geometry)
        if body.geometry.type == "panels":
            return _of_panels(case, name, body, body.geometry)
        assert body.material is not None
        mesh = _mesh(case, name, body)
        if body.geometry.type == "blocks" and body.mesh.formulation == "reduced":
            _refuse_single_layer(mesh)
        material = Material(**body.material.given())
        return assemble(mesh, material, formulation=body.mesh.formulation, mass=body.mesh.mass)


def _of_panels(case: Case, name: str, body: FlexibleBodySection, geometry: PanelsGeometry) -> FEModel:
    """Plates with stiffeners and lugs, with more groups of their nodes."""
    from dataclasses import replace

    from heavylift.pipeline.assemble.panels import structure_of_panels
    from heavylift.preprocess.finite_elements.groups import select_nodes
    from heavylift.preprocess.structures.assemble import assemble_structure

    made = structure_of_panels(case, name, body, geometry)
    groups = select_nodes(made.nodes, _selectors(geometry.groups), faces=made.node_groups, source=name)
    mass = body.mesh.mass if "mass" in body.mesh.model_fields_set else "lumped"
    return assemble_structure(replace(made, node_groups={**made.node_groups, **groups}), mass=mass)


def _of_deck(case: Case, name: str, body: FlexibleBodySection, geometry: MeshFileGeometry) -> FEModel:
    """One body of a mesh file, with the materials of the file as far as the case gives none."""
    from dataclasses import replace

    from heavylift.preprocess.finite_elements.deck import material_of
    from heavylift.preprocess.finite_elements.deck_structure import has_structure
    from heavylift.preprocess.finite_elements.elasticity import assemble_several
    from heavylift.preprocess.finite_elements.geometry import read_deck, scaled_mesh

    unit = geometry.length_unit
    deck = read_deck(case.folder / geometry.file, case.folder)
    if has_structure(deck, geometry.elements, [*body.plates, *body.stiffeners]):
        return _structure_of_deck(deck, name, body, geometry)
    taken = deck.body(
        elements=geometry.elements,
        part=geometry.part,
        merge_nodes=None if geometry.merge_nodes is None else geometry.merge_nodes / unit,
        materials=not geometry.ignore_material,
    )
    given = body.material.given() if body.material else {}
    materials = [
        material_of(
            one,
            given,
            source=name,
            length_unit=unit if "length_unit" in geometry.model_fields_set else None,
            mass_unit=geometry.mass_unit,
        )
        for one in taken.materials or [None]
    ]
    mesh = scaled_mesh(taken.mesh, unit, _selectors(geometry.groups))
    options = body.mesh
    model = assemble_several(
        mesh, materials, taken.material_index, formulation=options.formulation, mass=options.mass
    )
    notes = [*taken.notes, *(note for one in taken.materials for note in one.notes)]
    if len(materials) > 1:
        names = ", ".join(one.name for one in taken.materials)
        notes.append(f"{len(materials)} materials: {names}; such a body has no stress")
    return replace(model, notes=tuple(notes))


def _structure_of_deck(
    deck: Deck, name: str, body: FlexibleBodySection, geometry: MeshFileGeometry
) -> FEModel:
    """Plates, beams, solids, masses and rigid elements of a mesh file, with what the case gives by group."""
    from dataclasses import replace

    from heavylift.pipeline.assemble.panels import part_material
    from heavylift.preprocess.finite_elements.deck_structure import (
        BeamProperty,
        PlateProperty,
        structure_of,
    )
    from heavylift.preprocess.finite_elements.groups import select_nodes
    from heavylift.preprocess.structures.assemble import assemble_structure
    from heavylift.preprocess.structures.sections import profile

    if "formulation" in body.mesh.model_fields_set:
        raise InputError(
            f"{body.mesh.formulation!r} with plates, beams, masses or rigid elements in the file",
            source=name,
            key="mesh.formulation",
            expected="no formulation: it is for bodies of solids alone",
        )
    of_body = body.material.given() if body.material else {}

    def material(own: MaterialSection | None, key: str) -> Material | None:
        return None if own is None else part_material(body, own, name, f"{key}.material")

    plates = {
        key: PlateProperty(
            one.thickness, one.offset, one.nonstructural_mass, material(one.material, f"plates.{key}")
        )
        for key, one in body.plates.items()
    }
    beams = {}
    for key, beam in body.stiffeners.items():
        section, offset = None, None
        if beam.section is not None:
            section, centroid = profile(beam.section.shape, **beam.section.measures())
            offset = (0.0, 0.0)
            if beam.foot is not None:
                # the plate keeps it from turning aside
                section, offset = replace(section, product=0.0), (beam.foot + centroid[0], centroid[1])
        beams[key] = BeamProperty(
            section, beam.web, beam.flange, offset, material(beam.material, f"stiffeners.{key}")
        )
    made = structure_of(
        deck,
        elements=geometry.elements,
        part=geometry.part,
        merge_nodes=geometry.merge_nodes,
        given=of_body,
        ignore_material=geometry.ignore_material,
        length_unit=geometry.length_unit if "length_unit" in geometry.model_fields_set else None,
        mass_unit=geometry.mass_unit,
        plates=plates,
        beams=beams,
        source=name,
    )
    groups = select_nodes(made.nodes, _selectors(geometry.groups), faces=made.node_groups, source=made.name)
    mass = body.mesh.mass if "mass" in body.mesh.model_fields_set else "lumped"
    return assemble_structure(replace(made, node_groups={**made.node_groups, **groups}), mass=mass)


def _of_matrices(case: Case, geometry: MatricesGeometry) -> FEModel:
    """Matrices that another program has written for the nodes of its deck."""
    from dataclasses import replace

    from heavylift.preprocess.finite_elements.geometry import read_deck
    from heavylift.preprocess.finite_elements.groups import select_nodes
    from heavylift.preprocess.finite_elements.matrix_files import read_matrices

    files = {key: case.folder / name for key, name in geometry.matrix_files().items()}
    deck = case.folder / geometry.file
    model = read_matrices(
        read_deck(deck, case.folder),
        files["stiffness"],
        files["mass"],
        files["degrees"] if geometry.degrees or files["degrees"].is_file() else None,
        length_unit=geometry.length_unit,
        mass_factor=geometry.mass_unit,
        stiffness_factor=geometry.stiffness_unit,
    )
    groups = select_nodes(model.nodes, _selectors(geometry.groups), faces=model.node_groups, source=str(deck))
    return replace(model, node_groups={**model.node_groups, **groups})


_CASE_KEYS = (
    (re.compile(r"node group '([^']*)'"), r"geometry.groups.\1"),
    (re.compile(r"(divisions(?:\..)?|refine|size)"), r"mesh.\1"),
    (re.compile(r"(add|cut)"), r"geometry.\1"),
    (re.compile(r"(elements|part|merge_nodes|length_unit|mass_unit)"), r"geometry.\1"),
    (re.compile(r"((?:plates|stiffeners)\..*)"), r"\1"),
    (re.compile(r"(material(?:\..*)?)"), r"\1"),
    (re.compile(r"modes"), "modes.count"),
    (re.compile(r"up_to"), "modes.up_to"),
    (re.compile(r"((?:modes|mesh|supports|static|interfaces)\..*|interface)"), r"\1"),
)
"""Keys in messages of the stages, and what they are below the body in a case file."""


@contextlib.contextmanager
def in_body(case: Case, name: str, model_name: str = "") -> Iterator[None]:
    """Say of errors that name only the body, or a group of it, where in the case file they stand."""
    try:
        yield
    except InputError as error:
        of_file = case.bodies[name].geometry.type in {"mesh", "matrices"}
        grouped = error.key.startswith("node group ") and not of_file
        grouped |= error.key in {"elements", "part", "merge_nodes", "length_unit", "mass_unit"} and of_file
        grouped |= error.key.startswith(("plates.", "stiffeners.")) and of_file
        if error.source not in {name, model_name, str(case.file), ""} and not grouped:
            raise
        if error.source == str(case.file) and error.key.startswith(("bodies.", "repeat.", "contours.")):
            raise
        problem, key = error.problem, ""
        for pattern, below in _CASE_KEYS:
            match = pattern.fullmatch(error.key)
            if match:
                key = match.expand(below)
                break
        else:
            problem = f"{error.key}: {problem}" if error.key else problem
        key = f"modes.{key}" if key == "interface" else key
        if case.bodies[name].geometry.type == "panels" and error.key.startswith(
            ("plates.", "stiffeners.", "lugs.")
        ):
            problem, key = error.problem, f"geometry.{error.key}"
        raise InputError(
            problem,
            source=case.file,
            key=case.place(f"bodies.{name}.{key}".removesuffix(".")),
            expected=error.expected,
        ) from None


def _refuse_single_layer(mesh: Mesh) -> None:
    """A brick with one integration point has no bending stiffness; one through the body is a trap."""
    for axis, label in enumerate("xyz"):
        if np.ptp(mesh.nodes[mesh.elements, axis], axis=1).min() >= 0.999 * np.ptp(mesh.nodes[:, axis]):
            raise InputError(
                f"one brick with reduced integration through the body along {label} has no bending stiffness",
                source=mesh.name,
                key=f"divisions.{label}",
                expected="2 or more bricks (4 for bending within 7 %), or formulation 'incompatible'",
            )


def _mesh(case: Case, name: str, body: FlexibleBodySection) -> Mesh:
    from heavylift.preprocess.finite_elements.refinement import Refinement

    geometry, options = body.geometry, body.mesh
    selectors = _selectors(geometry.groups)
    refine = [Refinement(place.at, place.size, place.growth) for place in options.refine]
    if geometry.type == "blocks":
        from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks

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
    from heavylift.preprocess.finite_elements.geometry import read_step

    assert geometry.type == "step"
    file = case.folder / geometry.file
    return read_step(file, size=options.size, curved=options.curved, groups=selectors, refine=refine)


def _selectors(groups: Mapping[str, Group]) -> list[NodeSelector]:
    from heavylift.preprocess.finite_elements.groups import InBox, OnFace, OnPlane

    selectors: list[NodeSelector] = []
    for name, group in groups.items():
        if isinstance(group, PlaneGroup):
            selectors.append(OnPlane(name, group.plane, group.at))
        elif isinstance(group, BoxGroup):
            selectors.append(InBox(name, group.lower, group.upper))
        elif isinstance(group, FaceGroup):
            selectors.append(OnFace(name, group.face))
    return selectors


def four_files(case: Case, geometry: FourFilesGeometry) -> FourFileData:
    """Matrices, mesh and shapes that another program has written."""
    from dataclasses import replace

    from heavylift.preprocess.finite_elements.exchange import read_four_files
    from heavylift.preprocess.finite_elements.groups import select_nodes

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
    model = replace(data.model, node_groups={**data.model.node_groups, **groups}, notes=data.notes)
    return replace(data, model=model)


def model_properties(model: FEModel) -> dict[str, Any]:
    """Numbers of a finite-element model for its manifest and for checks."""
    density = model.material.density if model.material else None
    structure = model.structure
    count = None if model.elements is None else model.elements.element_count
    return {
        "node_count": model.node_count,
        "element_count": count,
        "parts": None if structure is None else _parts(structure),
        "dof_count": model.dof_count if model.constraint is None else int(model.constraint.shape[1]),
        "mass": model.total_mass,
        "centre_of_mass": None if structure is None else model.centre_of_mass.tolist(),
        "volume": None if density is None else model.total_mass / density,
        "notes": list(model.notes),
    }


def _parts(structure: Structure) -> dict[str, str | int]:
    """How many elements each property has, and how many masses and rigid elements there are."""
    found: dict[str, str | int] = {}
    for word, parts in (
        ("plates", structure.shells),
        ("beams", structure.beams),
        ("solids", structure.solids),
    ):
        counts: dict[str, int] = {}
        for part in parts:
            counts[part.name] = counts.get(part.name, 0) + len(part.elements)
        if counts:
            found[word] = ", ".join(f"{name} {count}" for name, count in counts.items())
    for word, others in (
        ("masses", structure.masses),
        ("rigid links", structure.links),
        ("averages", structure.averages),
        ("ties", structure.ties),
    ):
        if others:
            found[word] = len(others)
    return found


_VTU = {"tet10": "tetra10", "hex8": "hexahedron", "hex20": "hexahedron20"}


def _cells(model: FEModel) -> list[tuple[str, NDArray[np.int64]]]:
    """Elements by kind, with the words of meshio."""
    if model.mesh is not None:
        return [(_VTU[model.mesh.element_type], model.mesh.elements)]
    assert model.structure is not None
    shells = {3: "triangle", 4: "quad"}
    return [
        *((shells[part.elements.shape[1]], part.elements) for part in model.structure.shells),
        *(("line", part.elements) for part in model.structure.beams),
        *((_VTU[part.element_type], part.elements) for part in model.structure.solids),
    ]


def write_vtu(path: Path, model: FEModel) -> None:
    """Write the mesh of a model, with its groups as 0/1 point data, for viewers; nothing without elements."""
    if model.elements is None:
        return
    import meshio

    groups = {name: np.isin(np.arange(model.node_count), nodes) for name, nodes in model.node_groups.items()}
    mesh = meshio.Mesh(
        model.nodes,
        _cells(model),
        point_data={f"group {name}": member.astype(np.int64) for name, member in groups.items()},
    )
    with replacing(path) as temporary:
        mesh.write(temporary, file_format="vtu")
