"""What a result was made from: digests of inputs and sources, versions of what computed it."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

from heavylift.pipeline.storage import digest_file, digest_json

if TYPE_CHECKING:
    from typing import Any

    from heavylift.pipeline.case import Case
    from heavylift.pipeline.case_bodies import FlexibleBodySection

__all__ = ["mesh_digest", "modes_digest", "report_digest", "simulate_digest", "source_digest", "versions"]

PACKAGE = Path(__file__).resolve().parent.parent

STAGE_SOURCES = {
    "mesh": ("numerics", "preprocess", "pipeline/assemble.py", "pipeline/model_io.py", "pipeline/stages.py"),
    "modes": ("modal", "pipeline/assemble.py", "pipeline/model_io.py", "pipeline/stages.py"),
    "simulate": ("solver", "pipeline/assemble_scene.py", "pipeline/advance.py", "pipeline/stage_simulate.py"),
    "report": ("pipeline",),
}
"""Sources, below the package, whose change makes the outputs of a stage stale."""

STAGE_PACKAGES = {
    "mesh": ("numpy", "scipy", "gmsh", "meshio", "scikit-fem"),
    "modes": ("numpy", "scipy", "scikit-sparse", "pypardiso"),
    "simulate": ("numpy", "numba"),
    "report": ("numpy", "matplotlib", "pyvista"),
}
"""Packages whose versions are recorded with the outputs of a stage."""


@cache
def source_digest(stage: str) -> str:
    """Hexadecimal digest of the names and contents of the sources that a stage runs."""
    digest = hashlib.blake2b(digest_size=16)
    for name in STAGE_SOURCES[stage]:
        top = PACKAGE / name
        for path in [top] if top.is_file() else sorted(top.rglob("*.py")):
            digest.update(str(path.relative_to(PACKAGE)).encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


@cache
def versions(stage: str) -> dict[str, str]:
    """Versions of the package and of what a stage uses; absent packages are left out."""
    found = {}
    for name in ("heavylift", *STAGE_PACKAGES[stage]):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


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
    return _digest("mesh", {**sections, "files": _files(case, body)})


def _files(case: Case, body: FlexibleBodySection) -> dict[str, str]:
    """Digests of the files that a geometry names."""
    name = getattr(body.geometry, "file", None) or getattr(body.geometry, "folder", None)
    if name is None:
        return {}
    path = case.folder / name
    paths = sorted(path.glob("*.dat")) if path.is_dir() else [path]
    return {item.name: digest_file(item) for item in paths}


def modes_digest(case: Case, body: FlexibleBodySection) -> str:
    """Digest of all that the reduced body depends on."""
    reduction = body.modes.model_dump(mode="json", exclude={"damping_ratio"})
    return _digest(
        "modes",
        {
            "model": mesh_digest(case, body),
            "modes": reduction,
            "origin": body.frame.origin,
            "free": body.frame.motion == "free",
        },
    )


def simulate_digest(case: Case) -> str:
    """Digest of all that the time histories depend on."""
    bodies: dict[str, Any] = {}
    for name, body in case.bodies.items():
        if body.type == "flexible":
            bodies[name] = {
                "modes": modes_digest(case, body),
                "damping": body.modes.damping_ratio,
                "frame": body.frame.model_dump(mode="json"),
                "initial": body.initial.model_dump(mode="json"),
            }
        else:
            bodies[name] = body.model_dump(mode="json")
    scene = case.model_dump(mode="json", include={"gravity", "forces", "sensors", "simulate"})
    return _digest("simulate", {"bodies": bodies, **scene})


def report_digest(case: Case) -> str:
    """Digest of all that the report shows."""
    upstream = [modes_digest(case, body) for body in case.bodies.values() if body.type == "flexible"]
    if case.simulate is not None:
        upstream.append(simulate_digest(case))
    return _digest("report", {"upstream": upstream, "document": case.document, "name": case.name})
