"""A wall that comes apart has steps whose impulses no solver finds exactly: it falls, and the run says how well."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from mesh_contact_scenes import body, scene

from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.simulation import Simulation

BRICK = (0.4, 0.2, 0.2)


@pytest.mark.slow
def test_a_wall_that_falls_goes_on_with_the_best_impulses():
    """61 bricks in rows of six and five; the upper ends overhang by 4 mm, turn, and wedge what is below."""
    skin = box_surface(BRICK)
    places = [
        ((k - (count - 1) / 2) * 0.408, 0.0, 0.2 * (row + 0.5))
        for row in range(11)
        for count in (6 - row % 2,)
        for k in range(count)
    ]
    bodies = [(body(f"b{i}", place, mass=10.0, size=BRICK), skin) for i, place in enumerate(places)]
    pairs = combinations(["floor", *(one.name for one, _ in bodies)], 2)
    wall = scene(bodies, plane_surface(60.0), pairs, friction=0.6, most_contacts=32, recorded=0)
    simulation = Simulation(wall, 0.005, record_every=4)
    first = simulation.record()
    _, records = simulation.advance(180)
    assert not simulation.outcome, simulation.message
    column = {channel.name: channel.column for channel in simulation.channels}
    balance = records[:, column["energy.balance"]]
    given = first[column["energy.potential"]] - records[:, column["energy.potential"]].min()
    assert given > 10.0  # it falls
    assert balance.max() - first[column["energy.balance"]] < 1e-4 * given
    contacts = next(system for system in simulation._layout.systems if hasattr(system, "tally"))
    tally = contacts.tally[0]
    assert tally.deepest < 1e-4
    assert tally.roughest < 1e-3
    assert (tally.rough > 0) == (0.0 < tally.roughest_time <= 0.9)
    count = contact_count(contacts)
    normal, across = contacts.state["normal_force"][:count], contacts.state["friction_force"][:count]
    assert normal.min() >= 0.0
    assert np.all(across <= 0.6 * normal * (1.0 + 1e-9))
