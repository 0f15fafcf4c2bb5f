"""Names of the numbers of a record."""

import doctest

import numpy as np

from heavylift.solver import recorded_numbers as module
from heavylift.solver.recorded_numbers import recorded_numbers
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.simulation import Simulation


def test_examples():
    found = doctest.testmod(module)
    assert found.attempted
    assert not found.failed


def test_each_column_of_a_record_has_one_name():
    simulation = Simulation(Scene((RigidBody("load", mass=2.0, inertia=np.eye(3)),)), 0.1)
    numbers = recorded_numbers(simulation.channels)
    assert sorted(one.column for one in numbers.values()) == list(range(simulation.column_count))
    assert (numbers["load.position.z"].unit, numbers["load.position.z"].channel) == ("m", "load.position")
