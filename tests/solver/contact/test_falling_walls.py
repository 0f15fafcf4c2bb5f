"""A wall that comes apart has steps whose impulses no solver finds exactly: it falls, and the run says how well."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
import pytest
from mesh_contact_scenes import body, scene

from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from heavylift.solver.contact.kind import ContactRows
    from heavylift.solver.scene.scene import Scene

BRICK = (0.4, 0.2, 0.2)


def wall(rows: int, width: int) -> Scene:
    """Bricks 8 mm apart in rows of a width and one less in turn; the upper ends overhang by 4 mm."""
    skin = box_surface(BRICK)
    counts = [width - row % 2 for row in range(rows)]
    places = [
        ((k - (n - 1) / 2) * 0.408, 0.0, 0.2 * (row + 0.5)) for row, n in enumerate(counts) for k in range(n)
    ]
    bodies = [(body(f"b{i}", place, mass=10.0, size=BRICK), skin) for i, place in enumerate(places)]
    pairs = combinations(["floor", *(one.name for one, _ in bodies)], 2)
    return scene(bodies, plane_surface(60.0), pairs, friction=0.6, most_contacts=32, recorded=0)


def contacts_of(simulation: Simulation) -> ContactRows:
    simulation.warm_up()
    return next(system for system in simulation._layout.systems if hasattr(system, "tally"))


def test_a_wall_goes_on_from_any_record_bit_for_bit():
    """Impulses of the step before, taken as they are or corrected, and counts are carried."""
    scene_of = wall(4, 3)
    through = Simulation(scene_of, 0.005, record_every=5)
    _, expected = through.advance(40)
    first = Simulation(scene_of, 0.005, record_every=5)
    first.advance(15)
    second = Simulation(scene_of, 0.005, record_every=5)
    second.restore(first.state())
    _, found = second.advance(25)
    np.testing.assert_array_equal(found, expected[3:])
    assert contacts_of(second).tally.tobytes() == contacts_of(through).tally.tobytes()


@pytest.mark.slow
def test_a_wall_that_falls_goes_on_with_the_best_impulses():
    """61 bricks in rows of six and five; the upper ends overhang by 4 mm, turn, and wedge what is below."""
    simulation = Simulation(wall(11, 6), 0.005, record_every=4)
    first = simulation.record()
    _, records = simulation.advance(180)
    assert not simulation.outcome, simulation.message
    column = {channel.name: channel.column for channel in simulation.channels}
    balance = records[:, column["energy.balance"]]
    given = first[column["energy.potential"]] - records[:, column["energy.potential"]].min()
    assert given > 10.0  # it falls
    assert balance.max() - first[column["energy.balance"]] < 1e-4 * given
    contacts = contacts_of(simulation)
    tally = contacts.tally[0]
    assert tally.deepest < 1e-4
    assert tally.roughest < 1e-3
    assert (tally.rough > 0) == (0.0 < tally.roughest_time <= 0.9)
    count = contact_count(contacts)
    normal, across = contacts.state["normal_force"][:count], contacts.state["friction_force"][:count]
    assert normal.min() >= 0.0
    assert np.all(across <= 0.6 * normal * (1.0 + 1e-9))
