"""Motions in the axes of another body against closed forms and rotation matrices of another library."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.sensors.relative_motions import RelativeMotion
from heavylift.solver.simulation import Simulation

STEP, STEPS = 1e-2, 200
A0, VA, WA, PA = (
    np.array(v) for v in ((1.0, -2.0, 0.5), (0.3, 0.1, -0.2), (0.2, -0.4, 0.9), (0.5, 1.0, -0.5))
)
B0, VB, WB, PB = (
    np.array(v) for v in ((-3.0, 1.0, 2.0), (0.1, 0.5, 0.4), (-0.7, 0.3, 0.5), (0.2, -0.3, 1.5))
)


def balls(**more) -> Scene:
    """Two free bodies without loads that spin about fixed axes, as their inertias are those of balls."""
    bodies = (
        RigidBody("a", 2.0, 3.0 * np.eye(3), position=A0, velocity=VA, angular_velocity=WA),
        RigidBody("b", 5.0, 4.0 * np.eye(3), position=B0, velocity=VB, angular_velocity=WB),
    )
    spec = {"body_a": "a", "point_a": PA, "body_b": "b", "point_b": PB} | more
    return Scene(bodies, forces=(RelativeMotion(name="seen", **spec),))


def histories(scene: Scene, **options):
    run = Simulation(scene, step=STEP, record_every=1, **options)
    times, records = run.advance(STEPS)
    found = {c.name: records[:, c.column : c.column + len(c.components)] for c in run.channels}
    return times, {name: values for name, values in found.items() if name.startswith("seen.")}


def expected(times, *, on_ground=False):
    """Position, velocity, turn and spin of b in the axes of a."""
    turn_a = Rotation.from_rotvec(np.outer(times, 0.0 * WA if on_ground else WA))
    turn_b = Rotation.from_rotvec(np.outer(times, WB))
    point_a = np.tile(PA, (len(times), 1)) if on_ground else A0 + np.outer(times, VA) + turn_a.apply(PA)
    speed_a = 0.0 * point_a if on_ground else VA + np.cross(WA, turn_a.apply(PA))
    r = B0 + np.outer(times, VB) + turn_b.apply(PB) - point_a
    rate = VB + np.cross(WB, turn_b.apply(PB)) - speed_a
    spin = np.zeros(3) if on_ground else WA
    back = turn_a.inv()
    return back.apply(r), back.apply(rate - np.cross(spin, r)), back * turn_b, back.apply(WB - spin)


@pytest.mark.parametrize("on_ground", [False, True])
def test_two_balls_that_spin_and_drift(on_ground):
    times, found = histories(balls(**({"body_a": GROUND} if on_ground else {})))
    position, velocity, turn, spin = expected(times, on_ground=on_ground)
    close = {"rtol": 0.0, "atol": 1e-9}
    np.testing.assert_allclose(found["seen.position"], position, **close)
    np.testing.assert_allclose(found["seen.velocity"], velocity, **close)
    np.testing.assert_allclose(found["seen.distance"][:, 0], np.linalg.norm(position, axis=1), **close)
    np.testing.assert_allclose(found["seen.rotation"], turn.as_euler("ZYX")[:, ::-1], **close)
    np.testing.assert_allclose(found["seen.angle"][:, 0], turn.magnitude(), **close)
    np.testing.assert_allclose(found["seen.tilt"][:, 0], np.arccos(turn.as_matrix()[:, 2, 2]), atol=1e-7)
    np.testing.assert_allclose(found["seen.angular_velocity"], spin, **close)


def test_what_watches_changes_nothing():
    watched = Simulation(balls(), step=STEP, record_every=10)
    alone = Simulation(Scene(balls().bodies), step=STEP, record_every=10)
    seen, free = watched.advance(STEPS)[1], alone.advance(STEPS)[1]
    columns = [c for c in alone.channels if c.name.startswith(("a.", "b."))]
    for c in columns:
        part = slice(c.column, c.column + len(c.components))
        np.testing.assert_array_equal(seen[:, part], free[:, part])


def test_the_other_integrators_record_it():
    times, found = histories(balls(), integrator="accurate", tolerance=1e-10)
    np.testing.assert_allclose(found["seen.position"], expected(times)[0], atol=1e-7)
    np.testing.assert_allclose(found["seen.velocity"], expected(times)[1], atol=1e-7)


@pytest.mark.parametrize("every", [7, 50])
def test_extremes_are_those_of_all_steps_between_records(every):
    """Bit for bit those of a run that records every step, interval by interval; records alone miss them."""
    dense, sparse = Simulation(balls(), step=STEP), Simulation(balls(), step=STEP, record_every=every)
    start = dense.record()
    count = 4 * every
    all_steps, some = np.vstack([start, dense.advance(count)[1]]), sparse.advance(count)[1]
    columns = {c.name: slice(c.column, c.column + len(c.components)) for c in sparse.channels}
    missed = 0
    for name in [name for name in columns if f"{name}_max" in columns]:
        at = columns[name]
        seen = all_steps[1:, at].reshape(4, every, -1)
        np.testing.assert_array_equal(some[:, columns[f"{name}_max"]], seen.max(axis=1))
        np.testing.assert_array_equal(some[:, columns[f"{name}_min"]], seen.min(axis=1))
        missed += int((some[:, at].max(axis=0) < seen.max(axis=(0, 1))).sum())
    assert missed > 0
