"""Stiffness of a hull with ballast and a load on springs, at rest: all bodies one after the other, all loads anew."""

from __future__ import annotations

import numpy as np
import pytest
from start_scenes import rows_of

from heavylift.numerics.rotation import quaternion_from_rotation_vector
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Sea, Tank, Water
from heavylift.solver.statics.forces import StaticForces

RHO, G, AREA, DRAFT = 1025.0, 9.81, 600.0, 2.0


def afloat() -> Scene:
    """A barge of 30 x 20 m, turned, with a tank; a load on four springs over its deck, another one below it."""
    turn = quaternion_from_rotation_vector(np.array([0.04, -0.03, 0.5]))
    mass = 0.9 * RHO * AREA * DRAFT
    inertia = np.diag(mass * np.array([36.0, 80.0, 100.0]))
    barge = RigidBody("barge", mass, inertia, position=np.array([0.3, 0.2, 0.1]), orientation=turn)
    loads = [
        RigidBody(name, 3e4, np.diag([1e5, 2e5, 3e5]), position=np.array([1.0, 0.5, z]), orientation=turn)
        for name, z in (("upper", 8.0), ("lower", -9.0))
    ]
    springs = tuple(
        Spring(
            name=f"{load.name}_{k}",
            body_a=load.name,
            point_a=np.array([0.5 * x, 0.5 * y, 0.0]),
            body_b="barge",
            point_b=np.array([8.0 * x, 6.0 * y, 0.2 * x]),
            length=9.0,
            stiffness=4e5,
        )
        for load in loads
        for k, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1)))
    )
    restoring = LinearRestoring(
        volume=AREA * DRAFT,
        centre_of_buoyancy=np.array([0.0, 0.0, -1.0]),
        reference=np.zeros(3),
        area=AREA,
        second_moments=(2e4, 4.5e4, 0.0),
    )
    tank = Tank(name="ballast", hull="barge", point=np.array([5.0, -4.0, -1.0]), mass=5e4)
    sea = Sea(
        water=Water(density=RHO, gravity=G), hulls=(Hull(body="barge", restoring=restoring),), tanks=(tank,)
    )
    return Scene((barge, *loads), (Gravity(np.array([0.0, 0.0, -G])), *springs), sea=sea)


@pytest.mark.parametrize("dense", [True, False])
def test_bodies_that_stay_change_no_load_of_their_own(dense: bool) -> None:
    rows = rows_of(afloat())
    forces = StaticForces(rows, dense=dense)
    load, matrix, _ = forces.evaluate()
    found = forces.stiffness(forces.balance(load, matrix)[0])
    K = found if dense else found.toarray()
    before, step, count = rows.snapshot(), 1e-5, len(rows.inertia)
    expected = np.zeros((count, count))
    for k in rows.free:
        sides = []
        for sign in (step, -step):
            rows.move(sign * np.eye(count)[k])
            sides.append(forces.evaluate()[0])
            rows.restore(before)
        expected[:, k] = (sides[1] - sides[0]) / (2.0 * step)
    assert np.abs(K - expected[np.ix_(rows.free, rows.free)]).max() < 1e-6 * np.abs(expected).max()
    assert all(np.array_equal(array, content) for array, content in before)
