"""A run: its records, how it stops, how it goes on, what it compiles and imports."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from dataclasses import replace
from pathlib import Path

import numba
import numpy as np
import pytest
from point_masses import Load, System, channels_of, make_cloud
from scenarios import FLEXIBLE, RIGID, start_of

from heavylift.numerics.objects import compiled_units
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver import return_point, scene_checks
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

SYSTEMS = {
    "free": FLEXIBLE["free, loads and dampers"].scene(),
    "driven": FLEXIBLE["driven by tables, shapes with rigid parts"].scene(),
    "fixed": FLEXIBLE["fixed, shapes with rigid parts"].scene(),
    "rigid": RIGID["free, loads"].rigid_scene(),
    "rigid driven": RIGID["driven by tables, loads"].rigid_scene(),
}
STEP = 1e-3
BREAK = np.array([0.0, 0.0198, 0.0199, 1.0])
"""Rows of a table whose last two are bad: the first 20 steps do not see them."""

compiled_only = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")


COMPANY = {
    "free": FLEXIBLE["free, loads and dampers"].scene("free"),
    "driven": FLEXIBLE["driven by tables, shapes with rigid parts"].scene("driven"),
    "fixed": FLEXIBLE["fixed, shapes with rigid parts"].scene("fixed"),
    "rigid": RIGID["free, loads"].rigid_scene("rigid"),
    "rigid driven": RIGID["driven by tables, loads"].rigid_scene("rigid driven"),
}


@pytest.mark.parametrize("integrator", ["dele2", "thesis"])
def test_a_body_has_the_same_bits_alone_and_in_company(integrator: str) -> None:
    """What is compiled of a kind is one function, whatever else is in the scene."""
    scenes = list(COMPANY.values())
    gravity = [force for force in scenes[0].forces if isinstance(force, Gravity)]
    loads = [force for one in scenes for force in one.forces if not isinstance(force, Gravity)]
    together = Scene(tuple(body for one in scenes for body in one.bodies), (*gravity, *loads))
    company = Simulation(together, STEP, integrator, record_every=3)
    _, found = company.advance(60)
    for name, scene in COMPANY.items():
        assert repr([force for force in scene.forces if isinstance(force, Gravity)]) == repr(gravity)
        alone = Simulation(scene, STEP, integrator, record_every=3)
        _, expected = alone.advance(60)
        places = {channel.name: channel for channel in company.channels}
        own = [channel for channel in alone.channels if channel.name.startswith(f"{name}.")]
        assert len(own) >= 4
        for channel in own:
            width = len(channel.components)
            place = places[channel.name].column
            np.testing.assert_array_equal(
                found[:, place : place + width], expected[:, channel.column : channel.column + width]
            )


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("integrator", ["dele2", "thesis"])
def test_a_saved_run_goes_on_bit_for_bit(name: str, integrator: str, tmp_path: Path) -> None:
    """Into the same and into a fresh simulation, through a file."""
    scene = SYSTEMS[name]
    whole = Simulation(scene, STEP, integrator, record_every=3)
    _, expected = whole.advance(60)

    first = Simulation(scene, STEP, integrator, record_every=3)
    _, head = first.advance(25)
    np.savez(tmp_path / "state.npz", **first.state())
    first.advance(13)
    with np.load(tmp_path / "state.npz") as saved:
        state = dict(saved)
    for simulation in (first, Simulation(scene, STEP, integrator, record_every=3)):
        simulation.restore(state)
        assert simulation.step_index == 25
        times, tail = simulation.advance(35)
        np.testing.assert_array_equal(np.concatenate([head, tail]), expected)
        np.testing.assert_array_equal(times, np.arange(27, 61, 3) * STEP)
        for key, value in whole.state().items():
            if key != "cpu_seconds":
                np.testing.assert_array_equal(simulation.state()[key], value)


def test_a_state_before_the_first_step_is_a_state() -> None:
    scene = SYSTEMS["driven"]
    fresh = Simulation(scene, STEP)
    state = fresh.state()
    other = Simulation(scene, STEP)
    other.restore(state)
    np.testing.assert_array_equal(other.record(), fresh.record())
    np.testing.assert_array_equal(other.advance(5)[1], fresh.advance(5)[1])


def test_a_state_is_a_copy() -> None:
    simulation = Simulation(SYSTEMS["free"], STEP)
    state = simulation.state()
    before = {key: value.copy() for key, value in state.items()}
    simulation.advance(3)
    for key, value in state.items():
        np.testing.assert_array_equal(value, before[key])


def test_a_state_of_another_scene_is_refused_and_changes_nothing() -> None:
    simulation = Simulation(SYSTEMS["free"], STEP)
    state = simulation.state()
    other = System(make_cloud(modes=4), start_of(1, 4)).scene()
    with pytest.raises(InputError, match=r"checkpoint: FloatingFrameBodies\.\w+: the state does not fit"):
        simulation.restore(Simulation(other, STEP).state())
    with pytest.raises(InputError, match=r"checkpoint: step_index"):
        simulation.restore({key: value + 1.0 for key, value in state.items() if key != "step_index"})
    for key, value in simulation.state().items():
        np.testing.assert_array_equal(value, state[key])


def test_looking_and_warming_up_change_nothing() -> None:
    quiet, watched = (Simulation(SYSTEMS["free"], STEP) for _ in range(2))
    watched.warm_up()
    for _ in range(5):
        watched.record()
        watched.state()
        watched.advance(4)
        watched.warm_up()
    np.testing.assert_array_equal(watched.record(), quiet.advance(20)[1][-1])


def test_records_are_made_at_multiples_and_times_are_products() -> None:
    step = 0.1 / 3.0 * 1e-2
    simulation = Simulation(SYSTEMS["free"], step, record_every=7)
    found = [simulation.advance(steps) for steps in (10, 11, 3, 0, 4, 1000)]
    indices = [[7], [14, 21], [], [], [28], list(range(35, 1029, 7))]
    for (times, records), expected in zip(found, indices, strict=True):
        assert times.tolist() == [index * step for index in expected]
        assert records.shape == (len(expected), simulation.column_count)
    assert simulation.step_index == 1028
    assert simulation.time == 1028 * step


def test_record_is_the_last_row_and_channels_tile_it() -> None:
    simulation = Simulation(SYSTEMS["driven"], STEP)
    _, records = simulation.advance(3)
    np.testing.assert_array_equal(simulation.record(), records[-1])
    columns = [c.column + i for c in simulation.channels for i in range(len(c.components))]
    assert columns == list(range(simulation.column_count))
    names = [channel.name for channel in simulation.channels]
    assert len(set(names)) == len(names)
    assert all(channel.unit for channel in simulation.channels)
    assert np.all(np.isfinite(records))


@pytest.mark.parametrize("name", ["free", "fixed", "rigid"])
@pytest.mark.parametrize("integrator", ["dele2", "thesis"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_load_that_is_not_finite_stops_the_run(
    name: str, integrator: str, bad: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scene_checks, "check_object", lambda *_, **__: None)  # which refuses the table
    scene = SYSTEMS[name]
    gravity, *loads = scene.forces
    forces = np.array([[1.0, 2.0, 3.0]] * 2 + [[bad, 0.0, -bad]] * 2)
    spoilt = replace(loads[0], times=BREAK, forces=forces)
    simulation = Simulation(replace(scene, forces=(gravity, spoilt, *loads[1:])), STEP, integrator)
    times, records = simulation.advance(100)
    assert simulation.outcome is Outcome.NOT_FINITE
    assert simulation.step_index == len(times) == len(records) == 20
    assert simulation.time == 20 * STEP
    for word in ("not finite", "step 20", "t = 0.02 s", "'body'"):
        assert word in simulation.message
    assert np.all(np.isfinite(records[:-1]))
    assert simulation.advance(10)[0].size == 0, "it does not go on by itself"
    assert simulation.step_index == 20


@pytest.mark.parametrize("integrator", ["dele2", "thesis"])
def test_the_state_after_a_stop_is_the_last_good_one(
    integrator: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scene_checks, "check_object", lambda *_, **__: None)  # which refuses the table
    scene = SYSTEMS["free"]
    gravity, load, _ = scene.forces
    good = replace(load, times=BREAK, forces=np.array([[1.0, 2.0, 3.0]] * 4))
    bad = replace(good, forces=np.array([[1.0, 2.0, 3.0]] * 2 + [[np.nan, 2.0, 3.0]] * 2))
    stopped = Simulation(replace(scene, forces=(gravity, bad)), STEP, integrator)
    stopped.advance(100)
    assert stopped.outcome is Outcome.NOT_FINITE
    sound = Simulation(replace(scene, forces=(gravity, good)), STEP, integrator)
    sound.advance(stopped.step_index)
    for name in ("body.position", "body.modal_position", "body.modal_velocity", "body.velocity"):
        (channel,) = (c for c in sound.channels if c.name == name)
        columns = slice(channel.column, channel.column + len(channel.components))
        np.testing.assert_array_equal(stopped.record()[columns], sound.record()[columns])
    sound.restore(stopped.state())
    sound.advance(10)
    assert sound.outcome is Outcome.COMPLETED


@pytest.mark.parametrize("times", [0.0, np.inf])
@pytest.mark.parametrize("looks", [False, True])
def test_a_run_is_undone_to_its_last_good_step_from_any_point(
    times: float, looks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Repeated from before the call that failed, or from the first of many: state and records have the same bits."""
    monkeypatch.setattr(scene_checks, "check_object", lambda *_, **__: None)  # which refuses the table
    scene = SYSTEMS["driven"]
    gravity, load, *others = scene.forces
    forces = np.array([[1.0, 2.0, 3.0]] * 2 + [[np.nan, 2.0, 3.0]] * 2)
    spoilt = replace(scene, forces=(gravity, replace(load, times=BREAK, forces=forces), *others))
    whole = Simulation(spoilt, STEP, record_every=3)
    _, expected = whole.advance(100)
    monkeypatch.setattr(return_point, "TIMES", times)
    simulation, found = Simulation(spoilt, STEP, record_every=3), []
    for steps in (1, 1, 2, 7, 1, 100):
        found.append(simulation.advance(steps)[1])
        if looks and simulation.outcome is Outcome.COMPLETED:
            simulation.record()
    assert whole.outcome is simulation.outcome is Outcome.NOT_FINITE
    assert (simulation.step_index, simulation.message) == (20, whole.message)
    np.testing.assert_array_equal(np.concatenate(found), expected)
    for key, value in whole.state().items():
        if key != "cpu_seconds":
            np.testing.assert_array_equal(simulation.state()[key], value)


def test_a_state_of_other_bodies_of_the_same_shape_is_refused() -> None:
    scene = SYSTEMS["free"]
    (body,) = scene.bodies
    other = Simulation(replace(scene, bodies=(replace(body, velocity=body.velocity + 1.0),)), STEP)
    with pytest.raises(InputError, match=r"checkpoint: scene: .*digest of these bodies"):
        Simulation(scene, STEP).restore(other.state())


@pytest.mark.parametrize("integrator", ["dele2", "thesis"])
def test_spinning_too_fast_for_the_step_stops_the_run(integrator: str) -> None:
    system = System(make_cloud(), replace(start_of(1), spin=np.array([0.0, 40.0, 0.0])))
    simulation = Simulation(system.scene("wheel"), 1e-2, integrator)
    before = simulation.state()
    simulation.advance(3)
    assert simulation.outcome is Outcome.STEP_TOO_LARGE
    assert simulation.step_index == 0
    for word in ("too large", "step 0", "t = 0 s", "'wheel'", "smaller step"):
        assert word in simulation.message
    for field in ("modal_position", "modal_velocity"):
        (carried,) = (key for key in before if key.endswith(field))
        np.testing.assert_array_equal(simulation.state()[carried], before[carried])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"step": 0.0}, "simulation: step: step 0.0; expected a positive time"),
        ({"step": -1.0}, "simulation: step"),
        ({"step": float("nan")}, "simulation: step"),
        ({"step": float("inf")}, "simulation: step"),
        (
            {"step": 1e-3, "integrator": "euler"},
            "simulation: integrator: 'euler'; expected dele2 or accurate",
        ),
        (
            {"step": 1e-3, "start": "at rest"},
            "simulation: start: 'at rest'; expected check, project, equilibrium or",
        ),
        (
            {"step": 1e-3, "tolerance": -1.0},
            "simulation: tolerance: tolerance -1.0; expected a positive length",
        ),
        (
            {"step": 1e-3, "tolerance": 1e-3, "integrator": "thesis"},
            "simulation: tolerance: 0.001; expected an",
        ),
        ({"step": 1e-3, "record_every": 0}, "simulation: record_every: 0; expected 1 or more"),
    ],
)
def test_bad_arguments(arguments: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Simulation(SYSTEMS["free"], **arguments)


@compiled_only
def test_a_scene_of_known_kinds_compiles_nothing() -> None:
    """Sizes, motions, counts, names and combinations are data."""
    for one in (SYSTEMS["free"], SYSTEMS["driven"]):
        Simulation(one, STEP).record()
    before = set(compiled_units())
    for scene in (
        SYSTEMS["driven"],
        FLEXIBLE["free"].scene("other name"),
        System(
            make_cloud(modes=3), start_of(1, 3), loads=(Load(0, np.zeros(1), np.ones((1, 3))),) * 5
        ).scene(),
        System(make_cloud(modes=0), start_of(1, 0)).scene(),
    ):
        other = Simulation(scene, 2 * STEP, record_every=2)
        other.advance(2)
        other.record()
    assert set(compiled_units()) == before


def test_a_scene_of_all_kinds_moves_like_scenes_of_one() -> None:
    names = {"free": "a", "driven": "b", "fixed": "c", "rigid": "d", "rigid driven": "e"}
    bodies, forces, sensors, alone = [], [], [], {}
    for system, name in names.items():
        scene = SYSTEMS[system]
        bodies.append(replace(scene.bodies[0], name=name))  # type: ignore[type-var]
        forces += [replace(force, body=name) for force in scene.forces[1:]]
        sensors += [replace(sensor, body=name, name=f"{name} sensor") for sensor in scene.sensors]
        single = Simulation(scene, STEP)
        alone[name] = channels_of(single, single.advance(50)[1][-1])
    gravity = SYSTEMS["free"].forces[0]
    assert isinstance(gravity, Gravity)
    mixed = Simulation(Scene(tuple(reversed(bodies)), (*forces, gravity), tuple(sensors)), STEP)
    row = mixed.advance(50)[1][-1]
    for name, expected in alone.items():
        found = channels_of(mixed, row, name)
        for key in ("position", "velocity", "angular_velocity", "modal_position", "reaction_force"):
            if key in expected:
                np.testing.assert_allclose(found[key], expected[key], rtol=1e-10, atol=1e-12)
        np.testing.assert_allclose(
            found[f"{name} sensor.velocity"], expected["sensor.velocity"], rtol=1e-10, atol=1e-12
        )
    totals = channels_of(mixed, row)
    for name in ("energy.kinetic", "energy.balance", "momentum.linear", "momentum.angular"):
        total = sum(values[name] for values in alone.values())
        np.testing.assert_allclose(totals[name], total, rtol=1e-9, atol=1e-9)


def test_a_scene_imports_only_what_it_contains() -> None:
    """A clamped body alone: no code of moving frames, rigid bodies, forces, meshes or pictures."""
    program = """
        import sys
        import numpy as np
        from heavylift.modal.invariants import ShapeIntegrals
        from heavylift.modal.reduced import ReducedBody
        from heavylift.solver.scene.scene import Fixed, FlexibleBody, Scene
        from heavylift.solver.simulation import Simulation

        integrals = ShapeIntegrals(
            1.0, np.zeros(3), np.zeros((3, 1)), np.eye(3), np.zeros((3, 3, 1)), np.zeros((3, 3, 1, 1))
        )
        reduced = ReducedBody(
            np.zeros((1, 3)), np.ones(1), np.zeros((1, 1, 3)), integrals, False, ("1",), np.zeros(1), 0.0
        )
        Simulation(Scene((FlexibleBody("beam", reduced, motion=Fixed()),)), 1e-3)
        names = [name for name in sys.modules]
        unwanted = ("floating_frame_step", "floating_frame_record", "floating_frame_thesis", "floating_frame_kind",
                    "rigid", "forces.gravity", "forces.point", "gmsh", "skfem", "meshio", "pyvista", "matplotlib",
                    "pint", "h5py", "pydantic", "integrate.thesis")
        print([n for n in names if any(n == u or n.endswith("." + u) or u == "rigid" and ".rigid" in n
                                       and n.startswith("heavylift") for u in unwanted)])
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program)], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_scene_without_water_imports_nothing_of_it(tmp_path):
    """A pendulum, from the scene to its first steps, compiled anew: neither hulls nor lines nor what describes them."""
    program = """
        import sys
        import numpy as np
        from heavylift.solver.scene.connections import GROUND
        from heavylift.solver.joints.hinge import Hinge
        from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
        from heavylift.solver.simulation import Simulation

        body = RigidBody("rod", 1.0, np.eye(3), centre_of_mass=np.array([1.0, 0.0, 0.0]))
        weight = Gravity(np.array([0.0, 0.0, -9.81]))
        scene = Scene((body,), (weight,), joints=(Hinge(name="pin", body_a=GROUND, body_b="rod"),))
        Simulation(scene, 1e-3, integrator="dele2").advance(3)
        print([n for n in sys.modules if ".water" in n or n.endswith(("scene.sea", "layout_sea", "hydrodynamics"))])
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program)],
        env=os.environ | {"HEAVYLIFT_CACHE_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "[]"


def _suite_again(tests: list[str], environment: dict[str, str]) -> None:
    here = Path(__file__).resolve()
    done = subprocess.run(
        [
            sys.executable,
            *("-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "--rootdir", str(here.parents[2])),
            *("-m", "slow or not slow"),
            *(str(here.parent / test) for test in tests),
        ],
        env=os.environ | environment,
        cwd=here.parents[2],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-4000:]


@pytest.mark.slow
def test_interpreted_kernels_do_the_same() -> None:
    """Coverage and tracebacks need kernels that run as plain Python."""
    _suite_again(
        [
            "test_simulation.py::test_a_saved_run_goes_on_bit_for_bit",
            "test_simulation.py::test_a_scene_of_all_kinds_moves_like_scenes_of_one",
            "test_floating_frame_inertia.py",
            "test_drive.py",
            "test_kinds.py",
            "../numerics/test_rotation.py",
            "../numerics/test_small.py",
        ],
        {"NUMBA_DISABLE_JIT": "1"},
    )


@pytest.mark.slow
def test_no_kernel_reads_or_writes_beyond_an_array(tmp_path: Path) -> None:
    """Compiled with bounds checks, in a cache of their own."""
    _suite_again(
        [
            "test_simulation.py::test_a_saved_run_goes_on_bit_for_bit",
            "test_simulation.py::test_a_scene_of_all_kinds_moves_like_scenes_of_one",
            "test_floating_frame_inertia.py",
            "test_drive.py",
            "test_kinds.py",
            "water/test_hulls.py::TestHullsAlone::test_goes_on_bit_for_bit",
            "water/test_hulls.py::TestHullsAlone::test_a_state_of_other_water_is_refused",
        ],
        {"NUMBA_BOUNDSCHECK": "1", "HEAVYLIFT_CACHE_DIR": str(tmp_path)},
    )


def test_a_joint_that_opens_is_told() -> None:
    """A load of 1 t on two cranks of a milligram: their rows are too soft for it."""
    side = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])

    def crank(name: str, x: float) -> RigidBody:
        inertia = 1e-6 / 12.0 * np.diag([1.0, 1.0, 0.1])
        return RigidBody(name, 1e-6, inertia, np.array([0.0, 0.0, -0.5]), position=np.array([x, 0.0, 0.0]))

    def hinge(name: str, a: str, b: str, pa: list[float], pb: list[float]) -> Hinge:
        frames = [JointFrame(np.array(point), side) for point in (pa, pb)]
        return Hinge(name=name, body_a=a, body_b=b, frame_a=frames[0], frame_b=frames[1])

    load = RigidBody("load", 1e3, 100.0 * np.eye(3), position=np.array([0.5, 0.0, -1.0]))
    joints = (
        hinge("ground_1", "ground", "crank_1", [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        hinge("ground_2", "ground", "crank_2", [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        hinge("load_1", "crank_1", "load", [0.0, 0.0, -1.0], [-0.5, 0.0, 0.0]),
        hinge("load_2", "crank_2", "load", [0.0, 0.0, -1.0], [0.5, 0.0, 0.0]),
    )
    scene = Scene(
        (load, crank("crank_1", 0.0), crank("crank_2", 1.0)),
        (Gravity(np.array([3.0, 0.0, -9.81])),),
        joints=joints,
    )
    simulation = Simulation(scene, 5e-3)
    simulation.advance(400)
    assert "a joint was open by" in simulation.warning
