"""What a result was made from: digests of inputs and sources, versions of what computed it."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, get_args

from heavylift.numerics.packages import version_of
from heavylift.pipeline.case.connectivity import connected_to_hull
from heavylift.pipeline.case.fields import InFolder, Section, files_read
from heavylift.pipeline.case.interfaces import holding_joints, pulled_points, pulling_joints
from heavylift.pipeline.case.tables import SceneTables
from heavylift.pipeline.results.storage import digest_file, digest_json, read_json

if TYPE_CHECKING:
    from typing import Any

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.flexible_bodies import FlexibleBodySection
    from heavylift.pipeline.case.hulls import DatabaseSection
    from heavylift.pipeline.case.meshes import MeshBodySection
    from heavylift.pipeline.case.surfaces import SurfaceSection
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = [
    "database_digest",
    "files_of_case",
    "memory_digest",
    "mesh_digest",
    "modes_digest",
    "report_digest",
    "simulate_digest",
    "source_digest",
    "surface_digest",
    "versions",
]

PACKAGE = Path(__file__).resolve().parents[2]

STAGE_SOURCES = {
    "mesh": (
        "numerics",
        "preprocess/finite_elements",
        "preprocess/structures",
        "pipeline/assemble/finite_elements.py",
        "pipeline/assemble/panels.py",
        "pipeline/results/model_io.py",
        "pipeline/stages/stages.py",
    ),
    "modes": (
        "modal",
        "contours",
        "preprocess/structures",
        "pipeline/assemble/finite_elements.py",
        "pipeline/assemble/contacts.py",
        "pipeline/assemble/interfaces.py",
        "pipeline/assemble/modes.py",
        "pipeline/results/model_io.py",
        "pipeline/stages/stages.py",
    ),
    "simulate": (
        "contours",
        "solver",
        "pipeline/assemble",
        "pipeline/results/mesh_results.py",
        "pipeline/stages/advance.py",
        "pipeline/stages/prepared.py",
        "pipeline/stages/simulate.py",
    ),
    "fmus": ("pipeline/coupling",),
    "start": ("contours", "numerics", "solver"),
    "stress": (
        "modal",
        "preprocess/structures",
        "pipeline/case/steel.py",
        "pipeline/case/yield_strengths.csv",
        "pipeline/checks/body_stress.py",
        "pipeline/results/stress_io.py",
    ),
    "report": ("pipeline",),
    "surfaces": (
        "numerics",
        "preprocess/finite_elements",
        "preprocess/surfaces",
        "pipeline/assemble/surfaces.py",
    ),
    "hydrodynamics": (
        "numerics",
        "preprocess",
        "pipeline/assemble/hulls.py",
        "pipeline/assemble/water.py",
        "pipeline/stages/hydrodynamics.py",
    ),
    "contour nodes": (
        "contours/splines/face_grid.py",
        "contours/splines/node_matrix.py",
        "pipeline/assemble/contacts.py",
    ),
}
"""Sources, below the package, whose change makes the outputs of a stage stale; of modes also those that pick the nodes
of contours, if they depend on them."""

OWN_DIGESTS = {"bodies", "surfaces", "databases"}
"""Tables of a scene with digests of their own."""

MEMORY_KEYS = {"memory", "memory_length", "fit_error", "drift"}
"""Keys of a database that say how the time domain takes it."""

_SOURCES = {".py", ".js", ".css", ".html"}  # code, and what the page of a report is made of

STAGE_PACKAGES = {
    "mesh": ("numpy", "scipy", "gmsh", "meshio", "scikit-fem"),
    "modes": ("numpy", "scipy", "scikit-sparse", "pypardiso"),
    "simulate": ("numpy", "numba"),
    "fmus": ("fmpy",),
    "start": ("numpy", "scipy", "numba"),
    "report": ("numpy", "matplotlib", "pyvista", "k3d"),
    "surfaces": ("numpy", "scipy", "trimesh", "gmsh", "meshio"),
    "hydrodynamics": ("numpy", "scipy", "h5py", "capytaine"),
    "derived": ("numpy", "scipy", "numba"),
}
"""Packages whose versions are recorded with the outputs of a stage."""


@cache
def source_digest(stage: str) -> str:
    """Hexadecimal digest of the names and contents of the sources that a stage runs."""
    digest = hashlib.blake2b(digest_size=16)
    for name in STAGE_SOURCES[stage]:
        top = PACKAGE / name
        for path in [top] if top.is_file() else sorted(p for p in top.rglob("*") if p.suffix in _SOURCES):
            digest.update(str(path.relative_to(PACKAGE)).encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


@cache
def versions(stage: str) -> dict[str, str]:
    """Versions of the package and of what a stage uses; absent packages are left out."""
    found = {name: version_of(name) for name in ("heavylift", *STAGE_PACKAGES[stage])}
    return {name: version for name, version in found.items() if version is not None}


def _digest(stage: str, inputs: dict[str, Any]) -> str:
    return digest_json(
        {"stage": stage, "sources": source_digest(stage), "versions": versions(stage), **inputs}
    )


def mesh_digest(case: Case, body: FlexibleBodySection) -> str:
    """Digest of all that the finite-element model of a body depends on."""
    sections = {
        "geometry": body.geometry.model_dump(mode="json"),
        "material": body.material and body.material.model_dump(mode="json"),
        "mesh": body.mesh.model_dump(mode="json"),
    }
    for key in ("plates", "stiffeners"):
        parts = getattr(body, key)
        if parts:
            sections[key] = {name: one.model_dump(mode="json") for name, one in parts.items()}
    return _digest("mesh", {**sections, "files": _files(case, body)})


def _files(case: Case, body: FlexibleBodySection | MeshBodySection) -> dict[str, str]:
    """Digests of the files that a geometry names."""
    geometry = getattr(body, "geometry", None)
    name = getattr(geometry, "file", None) or getattr(geometry, "folder", None)
    if name is None:
        return {}
    path = case.folder / name
    if path.is_dir():
        return {item.name: digest_file(item) for item in sorted(path.glob("*.dat"))}
    found = _with_includes(case, name)
    if geometry is not None and geometry.type == "matrices":
        files = [case.folder / other for other in geometry.matrix_files().values()]
        found |= {item.name: digest_file(item) for item in files if item.is_file()}
    return found


def _with_includes(case: Case, name: str) -> dict[str, str]:
    """Digests of a mesh file and the files that it names."""
    from heavylift.preprocess.finite_elements.named_files import mesh_files

    path, root = case.folder / name, case.folder.resolve()
    return {
        item.name if item == path else item.relative_to(root).as_posix(): digest_file(item)
        for item in mesh_files(path, case.folder)
    }


def modes_digest(case: Case, body: FlexibleBodySection) -> str:
    """Digest of all that the reduced body depends on."""
    reduction = body.modes.model_dump(mode="json", exclude={"damping_ratio", "stiffness_damping"})
    owner = next(name for name, other in case.bodies.items() if other is body)
    if body.modes.attach and not body.modes.patches:
        own = {name: contour for name, contour in case.contours.items() if contour.body == owner}
        reduction["contour sources"] = source_digest("contour nodes")
        reduction["contours"] = {
            name: {
                **contour.model_dump(mode="json"),
                "matrix": digest_file(case.folder / contour.nodes) if contour.nodes else None,
            }
            for name, contour in own.items()
        }
    held = [joint.model_dump(mode="json") for _, joint in holding_joints(case.joints, owner)]
    if body.geometry.type in {"mesh", "panels"}:  # perhaps of plates and beams
        held += [joint.model_dump(mode="json") for _, joint in pulling_joints(case.joints, owner)]
        reduction["pulled"] = [
            list(point) for _, point in pulled_points(case.ropes, case.forces, owner, case.inputs)
        ]
    if held:  # their places in the body depend on where it starts
        frames = (body.frame, body.initial)
        reduction["held"] = [*held, *(section.model_dump(mode="json") for section in frames)]
    return _digest(
        "modes",
        {
            "model": mesh_digest(case, body),
            "modes": reduction,
            "supports": [support.model_dump(mode="json") for support in body.supports],
            "static": [one.model_dump(mode="json") for one in body.static],
            "interfaces": {name: one.model_dump(mode="json") for name, one in body.interfaces.items()},
            "origin": body.frame.origin,
            "free": body.frame.motion == "free",
        },
    )


def simulate_digest(case: Case) -> str:
    """Digest of all that the time histories depend on."""
    bodies: dict[str, Any] = {}
    for name, body in case.bodies.items():
        if body.BODY.MODAL:
            bodies[name] = {
                "modes": modes_digest(case, body),
                "damping": [*body.modes.damping_ratio, body.modes.stiffness_damping],
                "frame": body.frame.model_dump(mode="json"),
                "initial": body.initial.model_dump(mode="json"),
            }
        else:
            bodies[name] = body.model_dump(mode="json")
    for name, mesh in case.meshes.items():
        bodies[name]["files"] = _files(case, mesh)
    scene = case.model_dump(mode="json", include={*SceneTables.model_fields, "simulate"} - OWN_DIGESTS)
    files = _files_in([getattr(case, key) for key in SceneTables.model_fields if key not in OWN_DIGESTS])
    for fmu in case.fmus:
        files |= _unpacked(case, fmu.file)
    scene["files"] = {name: digest_file(case.folder / name) for name in sorted(files)}
    if case.surfaces:
        scene["surfaces"] = {
            surface.name: [surface.body, surface.facets, surface_digest(case, surface)]
            for surface in case.surfaces
        }
    if case.measured_gaps:
        scene["measured_gaps"] = sorted(case.measured_gaps)
    if case.databases:
        scene["databases"] = {
            name: [section.model_dump(mode="json", include=MEMORY_KEYS), database_digest(case, section)]
            for name, section in case.databases.items()
        }
    if case.fmus:
        scene["exchange"] = [source_digest("fmus"), versions("fmus")]
    return _digest("simulate", {"bodies": bodies, **scene})


def files_of_case(case: Case) -> set[str]:
    """Names, relative to its folder, of all files that a case needs: that it names, or that are read with those."""
    from heavylift.preprocess.finite_elements.named_files import mesh_files

    root = case.folder.resolve()
    paths = {
        case.folder / name for name in _files_in([getattr(case, key) for key in type(case).model_fields])
    }
    for body in case.bodies.values():
        geometry = getattr(body, "geometry", None)
        if geometry is not None and geometry.type == "matrices":
            paths |= {case.folder / name for name in geometry.matrix_files().values()}
    for fmu in case.fmus:
        paths |= {case.folder / name for name in _unpacked(case, fmu.file)}
    found = {part for path in paths for part in files_read(path) if part.is_file()}
    found |= {part for path in found for part in mesh_files(path, case.folder)}
    return {path.relative_to(root if path.is_relative_to(root) else case.folder).as_posix() for path in found}


def _unpacked(case: Case, name: str) -> set[str]:
    """Files of an FMU that is not packed; none of one that is."""
    path = case.folder / name
    if path.suffix != ".xml":
        return set()
    inside = (file for file in path.parent.rglob("*") if file.is_file())
    return {file.relative_to(case.folder).as_posix() for file in inside}


def _files_in(node: Any) -> set[str]:
    """Files of the case folder that sections name, with those of all sections below them."""
    if isinstance(node, Section):
        own = {getattr(node, key) for key in _file_keys(type(node))} - {None}
        keys = type(node).model_fields.keys() - _file_keys(type(node))
        return own.union(*(_files_in(getattr(node, key)) for key in keys))
    below = node.values() if isinstance(node, dict) else node if isinstance(node, (list, tuple)) else ()
    return {name for entry in below for name in _files_in(entry)}


@cache
def _file_keys(section: type[Section]) -> frozenset[str]:
    """Keys that are names of files in the case folder."""
    return frozenset(
        key
        for key, field in section.model_fields.items()
        for mark in [*field.metadata, *(m for part in get_args(field.annotation) for m in get_args(part)[1:])]
        if isinstance(mark, InFolder)
    )


def database_digest(case: Case, section: DatabaseSection) -> str:
    """Digest of all that a hydrodynamic database depends on."""
    inputs: dict[str, Any] = section.model_dump(mode="json", exclude={*MEMORY_KEYS, "compute"})
    sea = (
        case.sea.model_dump(mode="json", include={"density", "gravity", "level", "depth"}) if case.sea else {}
    )
    if case.sea is not None and case.sea.tide is not None:
        sea |= case.sea.model_dump(mode="json", include={"tide"})
    inputs["water"] = [sea, case.gravity and case.gravity.model_dump(mode="json")]
    if section.file is not None:
        path = case.folder / section.file
        beside = sorted(path.parent.glob(f"{path.stem}.*")) if section.file_format == "wamit" else [path]
        inputs["content"] = {item.name: digest_file(item) for item in beside if item.is_file()}
        return _digest("hydrodynamics", inputs)
    assert section.compute is not None
    surfaces = {surface.name: surface for surface in case.surfaces}
    inputs["compute"] = section.compute.model_dump(mode="json", exclude={"processes"})
    inputs["hulls in full"] = {
        name: {
            "body": case.bodies[name].model_dump(mode="json", exclude={"inertia"}),
            "hull": case.hulls[name].model_dump(mode="json", include={"reference", "open_deck"}),
            "surface": surface_digest(case, surfaces[case.hulls[name].surface or ""]),
            "tanks": [tank.model_dump(mode="json") for tank in case.tanks if tank.hull == name],
            "joined": _joined(case, name),
        }
        for name in section.hulls
    }
    return _digest("hydrodynamics", inputs)


def memory_digest(case: Case, section: DatabaseSection) -> str:
    """Digest of all that the exponentials of the memory of a database depend on."""
    fit = section.model_dump(mode="json", include=MEMORY_KEYS - {"drift"})
    return _digest("hydrodynamics", {"database": database_digest(case, section), "fit": fit})


def _joined(case: Case, name: str) -> dict[str, Any]:
    """What joints hold on a hull, which floats as deep as its weight says; meshes of frames and shells do not count.

    Of what lies on something with a line bearing also where: it is carried in part.
    """
    found: dict[str, Any] = {}
    group = connected_to_hull(case, name)[0]
    lying = [one for one in case.forces if one.type == "line_bearing" and group & set(one.between)]
    members = set(group)
    for one in lying:  # a part of it is carried elsewhere, or here
        members |= {one.between[1]} & set(case.bodies)
        held = [joint for joint in case.joints if one.between[1] in joint.between]
        found[one.name] = {
            "points": [one.between, one.points],
            "joints": [joint.model_dump(mode="json", include={"between", "at", "points"}) for joint in held],
        }
    for other in sorted(members - {name}):
        body = case.bodies[other]
        if not body.BODY.DEFORMS:
            found[other] = body.model_dump(mode="json", exclude={"inertia"})
        elif body.BODY.MODAL:
            start = body.model_dump(mode="json", include={"frame", "initial"})
            found[other] = {**start, "mesh": mesh_digest(case, body)}
    return found


def surface_digest(case: Case, surface: SurfaceSection) -> str:
    """Digest of all that the triangles of a surface depend on."""
    section = surface.model_dump(mode="json", exclude={"body", "facets"})
    content = _with_includes(case, surface.file) if surface.file else None
    return _digest("surfaces", {"surface": section, "content": content})


def report_digest(case: Case, folder: OutputFolder) -> str:
    """Digest of all that the report shows: the case, and what the other stages have left in the folder.

    What is there counts, not what should be there: a report of a run that was cut off, or of a damaged
    file, is not the report of the whole run. Manifests stand for what they describe; large files count by
    size and time of change, because reading them would take longer than anything else that is unchanged.
    """
    bodies = {name: body for name, body in case.bodies.items() if body.BODY.MODAL}
    current = [modes_digest(case, body) for body in bodies.values()]
    current += [surface_digest(case, surface) for surface in case.surfaces]
    current += [database_digest(case, section) for section in case.databases.values()]
    if case.simulate is not None:
        current.append(simulate_digest(case))
    found: dict[str, Any] = {
        stage: {
            "items": (read_json(folder.manifest(stage)) or {}).get("items"),
            "files": [_identity(path(name)) for name in bodies],
        }
        for stage, path in (("mesh", folder.model), ("modes", folder.reduced))
    }
    manifest = read_json(folder.manifest("simulate")) or {}
    segments = sorted(folder.segments.glob("segment_*")) if folder.segments.is_dir() else []
    found["simulate"] = {
        "manifest": {
            key: manifest.get(key) for key in ("outcome", "message", "finished", "digest", "details")
        },
        "files": [_identity(path) for path in (folder.results, *segments)],
    }
    if case.surfaces:
        found["surfaces"] = [_identity(folder.surface(surface.name)) for surface in case.surfaces]
    if case.databases:
        found["hydrodynamics"] = [_identity(folder.database(name)) for name in case.databases]
    references = {entry.file: digest_file(case.folder / entry.file) for entry in case.reference}
    return _digest(
        "report",
        {
            "current": current,
            "found": found,
            "document": case.document,
            "name": case.name,
            "references": references,
        },
    )


def _identity(path: Path) -> tuple[str, int, int] | None:
    """Name, size [bytes] and time of the last change [ns] of a file; None if there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return path.name, status.st_size, status.st_mtime_ns
