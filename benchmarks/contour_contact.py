"""Contact with a contour of a flexible body: run time of the parts and of a whole run, error against run time.

    python benchmarks/contour_contact.py            # surface points, Jacobians, searches; a run with 11 and 100 vectors
    python benchmarks/contour_contact.py --study    # error against run time: table (Markdown) and plot (PNG)

The run is setup A of ``cases/point_mass_on_beam``: 0.5 kg at 200 mm/s on the soft cantilever, hard contact at a
point, no damping, 0.1 s. Times are CPU times of one thread without compilation; errors are those of the velocity of
the mass against the full finite-element model of the same mesh (``full_A.csv`` of the case).
"""

from __future__ import annotations

import argparse
import statistics
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import contact_search
import numpy as np
import nurbs

from heavylift.contours.splines.evaluate import SCRATCH, Evaluation
from heavylift.contours.splines.face_grid import face_grid
from heavylift.contours.splines.modal_sums import modal_data
from heavylift.contours.splines.neutral import NeutralContour, neutral_surface, packed
from heavylift.contours.splines.sample_packing import pack_samples
from heavylift.contours.splines.search_step import ContourSearch
from heavylift.modal import bases
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.reduction import reduce_body
from heavylift.pipeline.assemble.finite_elements import assemble_model
from heavylift.pipeline.case.case_file import load_case
from heavylift.solver.scene.contacts import Contact, Contour
from heavylift.solver.scene.scene import Fixed, FlexibleBody, RigidBody, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from heavylift.modal.reduced import ReducedBody

CASE = Path(__file__).resolve().parents[1] / "cases" / "point_mass_on_beam"
BEAM = "hard_beam_A"
START, SPEED, MASS = np.array([0.235, 0.052, 0.025]), -0.2, 0.5
PLACE = np.array([0.235, 0.05, 0.025])
LOWER, UPPER = np.array([0.22, 0.05, 0.01]), np.array([0.25, 0.05, 0.04])
DURATION = 0.1
STEP = 1e-5
REPEATS = 5

STATICS = ("none", "1 at the point", "49 on the patch")
COUNTS = (10, 20, 50, 100)
STEPS = (1e-4, 1e-5, 1e-6)

SURFACE_TARGETS = {
    "surface point, tangents, second derivatives": 0.4,
    "with control points and Jacobian of 20 modes": 1.0,
    "with control points and Jacobian of 100 modes": 2.5,
    "closest point, warm": 2.5,
    "closest point, cold": 5.0,
}
"""[us]."""

RUN_TARGETS = {"10 eigenmodes and 1 static vector": 0.15, "100 eigenmodes": 0.5}
"""[s]."""


@dataclass(frozen=True)
class Cost:
    """A run of the study: vectors, step [s], velocity at the end and rms error of its history [m/s], CPU time [s]."""

    count: int
    statics: str
    vectors: int
    step: float
    velocity: float
    rms: float
    seconds: float


@cache
def beam() -> tuple[Any, Any, Any]:
    """Model, factorised stiffness and the most eigenmodes of the study."""
    case = load_case(CASE)
    model = assemble_model(case, BEAM, case.bodies[BEAM])  # type: ignore[arg-type]
    flexibility = Flexibility(model, model.node_groups["root"])
    return model, flexibility, eigenmodes(model, max(COUNTS), flexibility=flexibility)


@cache
def patch() -> np.ndarray:
    """Nodes of the contour, shape (7, 7): a face of the mesh around the place."""
    model = beam()[0]
    near = 1e-9
    top = model.node_groups["top"]
    inside = np.all((model.nodes[top] > LOWER - near) & (model.nodes[top] < UPPER + near), axis=1)
    return face_grid(model.nodes, top[inside])


@cache
def reduced(count: int, statics: str) -> ReducedBody:
    """Eigenmodes, and static deflections under normal forces."""
    model, flexibility, modes = beam()
    basis = bases.eigenmode_basis(modes, list(range(1, count + 1)))
    nodes = {
        "none": [],
        "1 at the point": [int(np.argmin(((model.nodes - PLACE) ** 2).sum(axis=1)))],
        "49 on the patch": patch().ravel().tolist(),
    }[statics]
    if nodes:
        basis += bases.static_vectors(flexibility, bases.point_loads(model, nodes, "y"))
    return reduce_body(
        model, basis.vectors, basis.labels, fixed_nodes=model.node_groups["root"], mean_axis=False
    )


def scene(body: ReducedBody) -> Scene:
    """The mass above the beam."""
    nodes = patch()
    top = neutral_surface(body.nodes[nodes], mode_shapes=body.mode_shapes[:, nodes])
    return Scene(
        bodies=(
            FlexibleBody("beam", body, motion=Fixed()),
            RigidBody("mass", MASS, 1e-6 * np.eye(3), position=START, velocity=np.array([0.0, SPEED, 0.0])),
        ),
        contours=(Contour(name="top", body="beam", neutral=top),),
        contacts=(Contact(name="touch", contour="top", body="mass"),),
    )


def run(body: ReducedBody, step: float, repeats: int) -> tuple[np.ndarray, float]:
    """Velocity of the mass every 0.1 ms [m/s], and median CPU time of the whole run [s]."""
    times = []
    for _ in range(repeats):
        simulation = Simulation(scene(body), step, record_every=max(1, round(1e-4 / step)))
        simulation.warm_up()
        before = time.thread_time()
        _, records = simulation.advance(round(DURATION / step))
        times.append(time.thread_time() - before)
        assert not simulation.outcome, simulation.message
    column = next(c.column for c in simulation.channels if c.name == "mass.velocity")
    return records[:, column + 1], statistics.median(times)


def measure_parts() -> None:
    """Surface points and searches beside their targets."""
    generator = np.random.default_rng(1)
    uv = generator.uniform(size=(nurbs.PLACES, 2))
    scratch, out = np.zeros(SCRATCH), Evaluation.one()
    plain = neutral_surface(nurbs.grid())
    table, knots, weights, net = packed([plain])
    found = [nurbs.measured(nurbs.points, (table[0], knots, weights, net, uv, scratch, out), nurbs.PLACES)]
    controls, w = np.zeros(64, dtype=np.int64), np.zeros(192)
    for modes in (20, 100):
        moving = neutral_surface(nurbs.grid(), mode_shapes=generator.normal(size=(modes, *nurbs.COUNTS, 3)))
        arrays = packed([moving])
        q, jacobian = generator.normal(size=modes), np.zeros(3 * modes)
        full = (arrays[0][0], *arrays[1:], uv, scratch, out, controls, w, modal_data(moving), q, jacobian)
        found.append(nurbs.measured(nurbs.jacobians, full, nurbs.PLACES))
    found += search_times(plain, generator)
    for (what, target), seconds in zip(SURFACE_TARGETS.items(), found, strict=True):
        print(f"{what:48s} {1e6 * seconds:8.2f} us   at most {target:g} us")


def search_times(surface: NeutralContour, generator: np.random.Generator) -> list[float]:
    """CPU time of a closest point [s] from a start nearby and from anywhere, of points near the surface."""
    table, knots, weights, net = packed([surface])
    arrays = table[0], knots, weights, net
    count = contact_search.COUNT
    feet = 0.05 + 0.9 * generator.random((count, 2))
    points, normals = np.zeros((count, 3)), np.zeros((count, 3))
    scratch, result, found = np.zeros(SCRATCH), ContourSearch.one(), np.zeros((count, 4))
    contact_search.evaluate(*arrays, feet, scratch, points, normals, Evaluation.one())
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    points += generator.uniform(-0.02, 0.05, (count, 1)) * normals
    starts = feet + 1e-3 * generator.standard_normal((count, 2))
    warm = (*arrays, points, starts, scratch, result, found)
    samples = pack_samples([surface.spaces], table, weights, net, [False])
    cold = (*arrays, points, samples, scratch, result, found)
    return [
        nurbs.measured(contact_search.warm_points, warm, count),
        nurbs.measured(contact_search.cold_points, cold, count),
    ]


def measure_runs() -> None:
    """Setup A with few and many vectors beside the targets."""
    bodies = reduced(10, "1 at the point"), reduced(100, "none")
    for (what, target), body in zip(RUN_TARGETS.items(), bodies, strict=True):
        velocity, seconds = run(body, STEP, REPEATS)
        print(
            f"setup A, {DURATION:g} s, {1e6 * STEP:g} us, {what:34s} {seconds:8.3f} s   at most {target:g} s"
            f"   {1e6 * seconds * STEP / DURATION:6.2f} us a step   v {1e3 * velocity[-1]:.3f} mm/s"
        )


@cache
def reference() -> np.ndarray:
    """Velocity of the full model every 0.1 ms [m/s]."""
    lines = (CASE / "full_A.csv").read_text(encoding="utf-8").splitlines()
    rows = [line.split(",") for line in lines if line[:1].isdigit()]
    return np.array([float(row[1]) for row in rows[1:]])


def study() -> list[Cost]:
    """All bases with all steps."""
    found = []
    for statics in STATICS:
        for count in COUNTS:
            body = reduced(count, statics)
            for step in STEPS:
                velocity, seconds = run(body, step, 1 if step < STEP else REPEATS)
                rms = float(np.sqrt(np.mean((velocity - reference()) ** 2)))
                found.append(Cost(count, statics, body.mode_count, step, float(velocity[-1]), rms, seconds))
    return found


def write_table(costs: list[Cost], file: Path) -> None:
    """Markdown."""
    exact = reference()[-1]
    lines = [
        "# Error against run time: point mass on the beam, setup A",
        "",
        f"Velocity at the end of the full model: {1e3 * exact:.3f} mm/s. CPU time of 0.1 s, one thread.",
        "",
        "| eigenmodes | static vectors | vectors | step | velocity | error | rms error of the history | CPU time |",
        "| ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    lines += [
        f"| {c.count} | {c.statics} | {c.vectors} | {1e6 * c.step:g} us | {1e3 * c.velocity:.3f} mm/s"
        f" | {1e3 * (c.velocity - exact):+.3f} mm/s | {1e3 * c.rms:.3f} mm/s | {c.seconds:.4f} s |"
        for c in costs
    ]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


def draw(costs: list[Cost], file: Path) -> None:
    """Error over CPU time, a line for every basis."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 5.5), layout="constrained")
    axes = figure.subplots()
    styles = dict(zip(STATICS, (":", "--", "-"), strict=True))
    markers = dict(zip(STATICS, ("x", "o", "s"), strict=True))
    for statics in STATICS:
        for number, count in enumerate(COUNTS):
            line = [c for c in costs if c.statics == statics and c.count == count]
            axes.loglog(
                [c.seconds for c in line],
                [1e3 * c.rms for c in line],
                color=f"C{number}",
                linestyle=styles[statics],
                marker=markers[statics],
                label=f"{count} eigenmodes, static vectors: {statics}",
            )
    steps = ", ".join(f"{1e6 * step:g}" for step in STEPS)
    axes.set_xlabel(f"CPU time of 0.1 s, one thread [s]; along each line steps of {steps} us")
    axes.set_ylabel("rms error of the velocity over 0.1 s [mm/s]")
    axes.grid(visible=True, which="both", alpha=0.3)
    figure.legend(loc="outside right center", fontsize="small")
    figure.savefig(file, dpi=150)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])  # type: ignore[union-attr]
    parser.add_argument("--study", action="store_true", help="error against run time")
    parser.add_argument("--out", type=Path, default=Path(), help="folder of the table and the plot")
    options = parser.parse_args()
    if options.study:
        costs = study()
        options.out.mkdir(parents=True, exist_ok=True)
        write_table(costs, options.out / "contour_contact.md")
        draw(costs, options.out / "contour_contact.png")
        return
    measure_parts()
    measure_runs()


if __name__ == "__main__":
    main()
