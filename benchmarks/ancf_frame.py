"""CPU time of an element of a frame: strains, forces, forces and tangent, by model.

Run with ``python benchmarks/ancf_frame.py [elements]``. Each number is the median of measurements of process time; the
blocks of the tangent are written. Elements are equal, as in most frames, so that they share their constants.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent.parent))
sys.path.append(str(Path(__file__).resolve().parent.parent / "tests" / "solver" / "ancf"))

from typing import TYPE_CHECKING

import frame_meshes

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf import elements as generics
from heavylift.solver.scene.meshes import FrameBody, FrameSection

if TYPE_CHECKING:
    from collections.abc import Callable

REPEATS = 21
SECONDS = 0.02  # of one measurement


@kernel
def strains(kind, count):  # type: ignore[no-untyped-def]
    for _ in range(count):
        generics.find_strains((kind,), 0, kind.position, kind.strain)


@kernel
def rates(kind, count):  # type: ignore[no-untyped-def]
    for _ in range(count):
        generics.add_strain_rates((kind,), 0, kind.position, kind.velocity, kind.shape_strain, 1e-9)


@kernel
def forces(kind, count):  # type: ignore[no-untyped-def]
    for _ in range(count):
        generics.add_stress_forces((kind,), 0, kind.position, kind.strain, kind.external_force, 1e-9)


@kernel
def tangent(kind, count):  # type: ignore[no-untyped-def]
    for _ in range(count):
        generics.add_stiffness((kind,), 0, kind.position, kind.strain, kind.right_hand_side, 1e-9, 1e-9, 0.0)


@kernel
def full_tangent(kind, count):  # type: ignore[no-untyped-def]
    for _ in range(count):
        generics.add_stiffness((kind,), 0, kind.position, kind.strain, kind.right_hand_side, 1e-9, 1e-9, 1.0)


def frame(count: int, model: str, *, curved: bool) -> FrameBody:
    """A straight line or an arc of a circle."""
    a = np.linspace(0.0, 1.5, count + 1)
    nodes, tangents = np.zeros((count + 1, 3)), np.zeros((count + 1, 3))
    if curved:
        nodes[:, 0], nodes[:, 1] = 10.0 * np.sin(a), 10.0 * (1.0 - np.cos(a))
        tangents[:, 0], tangents[:, 1] = np.cos(a), np.sin(a)
    else:
        nodes[:, 0], tangents[:, 0] = 10.0 * a, 1.0
    ends = np.arange(count)
    section = FrameSection(7800.0, 2.1e11, 1e-3, 1e-7, 0.02)
    return FrameBody(
        name="frame",
        nodes=nodes,
        tangents=tangents,
        elements=np.column_stack((ends, ends + 1)),
        sections=(section,),
        model=model,  # type: ignore[arg-type]
    )


def element_time(run: Callable[..., None], kind: object, elements: int) -> float:
    """Time of one element [ns]."""
    run(kind, 1)
    begin = time.process_time()
    run(kind, 100)
    rounds = max(1, int(100 * SECONDS / max(time.process_time() - begin, 1e-6)))
    measured = []
    for _ in range(REPEATS):
        begin = time.process_time()
        run(kind, rounds)
        measured.append((time.process_time() - begin) / rounds / elements)
    return 1e9 * statistics.median(measured)


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 40
    what = (strains, rates, forces, tangent, full_tangent)
    print(f"{count} elements, ns/element:", ", ".join(run.__name__ for run in what))
    for model, curved in (("green-lagrange", False), ("exact", False), ("exact", True)):
        kind = frame_meshes.pack(frame(count, model, curved=curved))
        rng = np.random.default_rng(0)
        for nodal in (kind.position, kind.velocity):
            q = frame_meshes.get(nodal)
            frame_meshes.put(nodal, q + 1e-3 * rng.normal(size=q.shape))
        strains(kind, 1)
        numbers = " ".join(f"{element_time(run, kind, count):8.1f}" for run in what)
        print(f"  {model + (', curved' if curved else ''):>20} {numbers}")


if __name__ == "__main__":
    main()
