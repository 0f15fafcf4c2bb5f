"""Islands at rest sleep: they stay exactly where they are, and wake as if they had never slept."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from mesh_contact_scenes import DOWN, MASS, G, body, scene

from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.forces.point import PointForce
from heavylift.solver.scene.bodies import Driven, Fixed, Harmonic, Profile
from heavylift.solver.scene.contacts import LinearLaw
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from heavylift.solver.contact.kind import ContactRows

CUBE, FLOOR, STEP = box_surface(1.0), plane_surface(60.0), 0.01
NEXT = 60
"""Steps after which what was put down at rest is asleep."""


def with_bodies(made: Scene, **changes: Any) -> Scene:
    return Scene(**{**vars(made), **changes})


def stacks(*heights: int, above: float = 0.0, **options: Any) -> Scene:
    """Boxes on each other, a little to the side; the last one of all begins higher."""
    bodies, pairs = [], []
    for k, height in enumerate(heights):
        for i in range(height):
            name = f"{'abc'[k]}{i}"
            up = above if (k, i) == (len(heights) - 1, height - 1) else 0.0
            bodies.append((body(name, (3.0 * k + 0.03 * i, 0.02 * i, 0.5 + i + up)), CUBE))
            pairs.append(("floor" if i == 0 else f"{'abc'[k]}{i - 1}", name))
    return scene(bodies, FLOOR, pairs, **{"friction": 0.5, "most_contacts": 64, "recorded": 4, **options})


def contacts_of(simulation: Simulation) -> ContactRows:
    simulation.warm_up()
    return next(system for system in simulation._layout.systems if hasattr(system, "tally"))


def islands(simulation: Simulation) -> list[int]:
    return [int(value) for value in contacts_of(simulation).slept["island"]]


def both(made: Scene, steps: int, **options: Any) -> tuple[Simulation, Any, Any, dict[str, slice]]:
    """Records of a run in which islands sleep, and of one in which they may not."""
    sleeping, awake = Simulation(made, STEP, **options), Simulation(made, STEP, **options)
    contacts_of(awake).sleepers["allowed"] = False
    found = [simulation.advance(steps)[1] for simulation in (sleeping, awake)]
    assert not sleeping.outcome, sleeping.message
    assert not any(islands(awake))
    columns = {c.name: slice(c.column, c.column + len(c.components)) for c in sleeping.channels}
    return sleeping, found[0], found[1], columns


def test_what_sleeps_does_not_move_and_records_what_it_did():
    """Every channel is that of a run without sleep; positions do not change in any bit, impulses go on."""
    simulation, found, expected, columns = both(stacks(3), 200)
    assert islands(simulation) == [1, 1, 1]
    for name, at in columns.items():
        # how four corners share a load that three could bear is not more exact
        shares = ".contact_" in name or name.endswith((".point", ".largest_force"))
        size = max(1.0, float(np.abs(expected[:, at]).max()))
        np.testing.assert_allclose(
            found[:, at], expected[:, at], atol=size * (1e-4 if shares else 1e-8), err_msg=name
        )
    for name in ("a0.position", "a2.position", "a2.orientation", "energy.balance", "floor-a0.normal_force"):
        assert np.ptp(found[NEXT:, columns[name]], axis=0).max() == 0.0, name
    assert np.all(found[NEXT:, columns["a1.velocity"]] == 0.0)
    pushed = np.diff(found[NEXT:, columns["floor-a0.impulse"]][:, 0])
    np.testing.assert_allclose(pushed, 3 * MASS * G * STEP, rtol=1e-9)


def test_a_blow_wakes_the_whole_stack_that_it_meets():
    """A box falls on one of two stacks that sleep; the other one sleeps on; all is as if none had slept."""
    made = stacks(3, 3, above=4.0)
    simulation, found, expected, columns = both(made, 180)
    assert islands(simulation)[:3] == [1, 1, 1]
    blows = found[:, columns["b1-b2.impacts"]][:, 0]
    assert NEXT < int(np.argmax(blows > 0.0)) < 95  # sqrt(8 m / g) is 0.903 s
    for name in ("b0", "b1", "b2", "a2"):
        at = columns[f"{name}.position"]
        np.testing.assert_allclose(found[:, at], expected[:, at], atol=1e-9, err_msg=name)
    at = columns["b1-b2.impact_impulse"]
    np.testing.assert_allclose(found[:, at], expected[:, at], rtol=1e-9)
    borne = np.diff(found[:, columns["floor-b0.impulse"]][:, 0])
    assert borne.max() > 0.9 * MASS * np.sqrt(8.0 * G)  # by the ground, through all of the stack


def test_another_load_wakes_in_the_step_in_which_it_comes():
    """A push to the side of a tenth of what friction bears, then of twice that, and it slides as without sleep."""
    made = stacks(1)
    times, force = np.array([0.0, 0.8, 0.81, 1.2, 1.21]), np.zeros((5, 3))
    force[2:4, 0], force[4, 0] = 0.05 * MASS * G, MASS * G
    push = PointForce(name="push", body="a0", point=np.zeros(3), times=times, forces=force)
    simulation, found, expected, columns = both(
        with_bodies(made, forces=(Gravity(np.array(DOWN)), push)), 180
    )
    at = columns["a0.position"]
    np.testing.assert_allclose(found[:, at], expected[:, at], atol=1e-9)
    assert found[-1, at][0] > 0.5
    sheared = found[:, columns["floor-a0.force"]][:, 0]
    np.testing.assert_allclose(sheared[100], -0.05 * MASS * G, rtol=1e-6)  # at 1.01 s it stands again
    np.testing.assert_allclose(sheared[-1], -0.5 * MASS * G, rtol=1e-6)
    assert not any(islands(simulation))


@pytest.mark.parametrize("cut", [30, 65, 110, 139, 150])
def test_a_saved_run_goes_on_bit_for_bit(cut: int):
    """Before it sleeps, while it sleeps, and around the blow that wakes it."""
    made = stacks(2, 2, above=9.0)
    whole, first = Simulation(made, STEP), Simulation(made, STEP)
    _, expected = whole.advance(220)
    first.advance(cut)
    again = Simulation(made, STEP)
    again.restore(first.state())
    np.testing.assert_array_equal(again.advance(220 - cut)[1], expected[cut:])
    found = again.state()
    for name, value in whole.state().items():
        if name not in {"cpu_seconds", "watch"}:
            np.testing.assert_array_equal(found[name], value, err_msg=name)


def test_what_rests_on_what_moves_or_yields_does_not_sleep():
    """On a driven table, or with compliance; on a fixed one it does."""
    top, asleep = box_surface((4.0, 4.0, 1.0)), {}
    for name, motion in (("fixed", Fixed()), ("driven", Driven(z=Profile(harmonics=(Harmonic(1e-3, 1.0),))))):
        table = RigidBody(**{**vars(body("table", (0.0, 0.0, -0.5), size=(4.0, 4.0, 1.0))), "motion": motion})
        made = scene([(table, top), (body("a", (0.0, 0.1, 0.5)), CUBE)], None, [("table", "a")], recorded=0)
        simulation = Simulation(made, STEP)
        simulation.advance(NEXT)
        asleep[name] = any(islands(simulation))
    assert asleep == {"fixed": True, "driven": False}
    yielding = Simulation(stacks(1, law=LinearLaw(1e6, 3e4)), STEP)
    yielding.advance(3 * NEXT)
    assert not any(islands(yielding))
