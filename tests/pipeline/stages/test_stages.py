"""Stages run when their inputs change, and only then; numbers of a small beam against closed forms."""

from __future__ import annotations

import json
import math
import subprocess
import sys

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.model_io import read_reduced
from heavylift.pipeline.results.storage import OutputFolder
from tests.pipeline.judged import judged_checks

COMPUTED = ("mesh", "modes", "simulate")


class Lines(Log):
    """A log that remembers."""

    def __init__(self):
        super().__init__()
        self.lines = []

    def say(self, text):
        self.lines.append(text)

    def about(self, stage):
        return [line for line in self.lines if line.startswith(f"{stage}:")]


def run(folder, *overrides, stages=COMPUTED, **options):
    log = Lines()
    report = run_case(load_case(folder, overrides), stages=stages, log=log, **options)
    return report, log


def test_the_beam_rings_at_the_frequencies_of_its_reduced_body(small_case):
    report, _ = run(small_case)
    assert report.outcome is Outcome.COMPLETED
    checks = {check.id: check for check in judged_checks(load_case(small_case), report.folder.root)}
    assert checks["mass"].value == pytest.approx(0.312, rel=1e-12)
    assert checks["ringdown_1"].error < 1e-4
    assert all(check.passed for check in checks.values())
    # Euler-Bernoulli cantilever, first bending about the weak axis; eight bricks come within 2 %
    area, inertia = 0.02 * 0.01, 0.02 * 0.01**3 / 12
    exact = 1.875104**2 / (2 * math.pi) * math.sqrt(210e9 * inertia / (7800.0 * area * 0.2**4))
    assert checks["ringdown_1"].reference == pytest.approx(exact, rel=0.02)
    results = load_results(load_case(small_case))
    assert results.time[-1] == pytest.approx(20e-3)
    assert len(results.time) == 1001
    # sensor: the tip moves as modes 1 and 2, which start with 0.1 and 0.05 m/s at their largest component
    assert np.abs(results["tip.velocity"]).max() < 0.3
    details = report.stage("simulate").details
    assert details["steps"] == 20000
    assert details["outcome"] == "completed"
    assert abs(details["energy_drift"]) < 1e-9


@pytest.mark.slow
def test_unchanged_stages_are_skipped_and_changed_ones_are_not(small_case):
    short = "simulate.duration=1 ms"
    run(small_case, short)
    report, log = run(small_case, short)
    assert all("unchanged, skipped" in line for line in log.lines)
    assert len(log.lines) == 3
    assert all(stage.skipped for stage in report.stages)
    for change, fresh in (
        ("sensors.0.point.0=150 mm", {"simulate"}),
        ("bodies.beam.modes.count=4", {"modes", "simulate"}),
        ("bodies.beam.material.density=7801", {"mesh", "modes", "simulate"}),
        ("title=other", set()),
        ("report.modes=[2]", set()),
    ):
        _, log = run(small_case, short, change)
        made = {line.partition(":")[0] for line in log.lines if "skipped" not in line} - {"run"}
        assert made == fresh, change
        run(small_case, short)
    report, log = run(small_case, short, force=("modes",))
    assert [stage.skipped for stage in report.stages] == [True, False, True]


def test_damaged_outputs_are_made_anew(small_case):
    short = "simulate.duration=1 ms"
    folder = run(small_case, short)[0].folder
    reference = load_results(folder.root)["beam.modal_position"]
    for path, stage in (
        (folder.model("beam"), "mesh"),
        (folder.reduced("beam"), "modes"),
        (folder.results, "simulate"),
    ):
        path.write_bytes(path.read_bytes()[:1000])
        report, log = run(small_case, short)
        assert "damaged" in log.about(stage)[0]
        assert not report.stage(stage).skipped
    assert np.array_equal(load_results(folder.root)["beam.modal_position"], reference)


def test_meshes_and_modes_of_another_folder_are_reused(small_case, tmp_path):
    run(small_case, stages=("mesh", "modes"))
    report, log = run(
        small_case, "simulate.duration=1 ms", out=tmp_path / "other", reuse=[small_case / "out"]
    )
    assert "taken from" in log.about("mesh")[0]
    assert "taken from" in log.about("modes")[0]
    assert report.outcome is Outcome.COMPLETED


def test_initial_speeds_are_those_of_the_largest_component(small_case):
    folder = run(small_case, stages=("mesh", "modes"))[0].folder
    scene = assemble_scene(load_case(small_case), folder)
    body = scene.bodies[0]
    velocity = np.tensordot(body.modal_velocity[:1], body.reduced.mode_shapes[:1], axes=1)
    assert velocity.ravel()[np.abs(velocity).argmax()] == pytest.approx(0.1, rel=1e-12)
    by_mass = load_case(
        small_case, ["bodies.beam.initial.modal_scaling=mass", "bodies.beam.initial.modal_velocity=[2]"]
    )
    assert np.array_equal(assemble_scene(by_mass, folder).bodies[0].modal_velocity, [2.0, 0.0, 0.0])


def test_a_body_about_its_centre_of_mass_is_where_it_was_drawn(small_case):
    free = ("bodies.beam.frame={motion='free', origin='centre_of_mass'}", "bodies.beam.modes.clamp=[]")
    folder = run(small_case, *free, stages=("mesh", "modes"))[0].folder
    scene = assemble_scene(load_case(small_case, free), folder)
    assert scene.bodies[0].position == pytest.approx([0.1, 0.01, 0.005], rel=1e-12)
    assert scene.sensors[0].point == pytest.approx([0.1, 0.01, 0.005], rel=1e-12)
    reduced = read_reduced(folder.reduced("beam"))
    assert reduced.mean_axis
    assert reduced.integrals.first_moment == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)


def test_static_vectors_make_a_point_stiffness_exact(small_case):
    from heavylift.pipeline.results.model_io import read_model

    overrides = (
        "bodies.beam.modes.static_points=[['200 mm', 0, 0]]",
        "bodies.beam.modes.static_directions=z",
    )
    folder = run(small_case, *overrides, stages=("mesh", "modes"))[0].folder
    reduced, model = read_reduced(folder.reduced("beam")), read_model(folder.model("beam"))
    node = int(np.argmin(np.linalg.norm(reduced.nodes - [0.2, 0.0, 0.0], axis=1)))
    compliance = np.sum(reduced.mode_shapes[:, node, 2] ** 2 / reduced.eigenvalues)
    free = np.setdiff1d(
        np.arange(3 * model.node_count), 3 * model.node_groups["root"][:, None] + np.arange(3)
    )
    load = np.zeros(3 * model.node_count)
    load[3 * node + 2] = 1.0
    dense = model.stiffness.toarray()[np.ix_(free, free)]
    assert compliance == pytest.approx(np.linalg.solve(dense, load[free]) @ load[free], rel=1e-9)


@pytest.mark.parametrize(
    ("quantity", "words"),
    [
        ("channel.tip.position.q.end", "a component: x, y, z"),
        ("drift.momentum", "momentum.linear that is not zero"),
        ("channel.beam.modal_position.7.max", "a component: 1, 2, 3"),
    ],
)
def test_quantities_that_results_do_not_have(small_case, quantity, words):
    case = load_case(small_case, ["simulate.duration=1 ms", "bodies.beam.initial.modal_velocity=[0]"])
    folder = run_case(case, stages=COMPUTED).folder
    with pytest.raises(InputError, match=words):
        Quantities(case, folder.root).number(quantity)


def test_statistics_of_channels(small_case):
    case = load_case(small_case, ["simulate.duration=1 ms"])
    folder = run_case(case, stages=COMPUTED).folder
    history = load_results(folder.root)["tip.position"]
    quantities = Quantities(case, folder.root)
    assert quantities.number("channel.tip.position.y.max") == history[:, 1].max()
    assert quantities.number("channel.tip.position.z.rms") == pytest.approx(
        np.sqrt(np.mean(history[:, 2] ** 2))
    )
    assert np.array_equal(quantities.evaluate("channel.tip.position.end"), history[-1])
    assert (
        quantities.number("channel.energy.kinetic.min") == load_results(folder.root)["energy.kinetic"].min()
    )
    assert quantities.number("modes.beam.orthogonality") < 1e-12


@pytest.mark.slow
def test_a_second_look_imports_no_heavy_library(small_case):
    run(small_case, "simulate.duration=1 ms")
    code = (
        "import sys\n"
        "from heavylift.pipeline import load_case, run_case\n"
        f"case = load_case({str(small_case)!r}, ['simulate.duration=1 ms'])\n"
        f"report = run_case(case, stages={COMPUTED!r})\n"
        "assert all(stage.skipped for stage in report.stages), report\n"
        "heavy = {'numba', 'scipy', 'gmsh', 'skfem', 'pyvista', 'matplotlib', 'pint', 'h5py', 'meshio'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_manifests_say_what_was_used(small_case):
    folder = OutputFolder(small_case / "out")
    run(small_case, "simulate.duration=1 ms")
    manifest = json.loads(folder.manifest("simulate").read_text())
    assert manifest["outcome"] == "completed"
    assert manifest["overrides"] == ["simulate.duration=1 ms"]
    assert "numba" in manifest["versions"]
    assert len(manifest["digest"]) == 32
    assert not folder.segments.exists()
