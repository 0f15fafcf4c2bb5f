"""A load-out in a scene that is turned about the vertical: pushes and reactions turn too, and nothing is redundant."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.results.storage import OutputFolder, read_json

CASE = """
title = "A module drives from a quay over link beams onto a barge"

[gravity]
acceleration = [0, 0, -9.81]
[sea]

[bodies.barge]
type = "rigid"
mass = 2.4e6
inertia = [1.2e8, 7e8, 8e8]
frame = {{ motion = "free" }}
initial = {{ position = {barge}, orientation = {turned} }}
[[surfaces]]
name = "plating"
body = "barge"
shape = {{ type = "box", size = [60, 20, 6] }}
at = [0, 0, 1]
[hulls.barge]
surface = "plating"
damping = [2e6, 2e6, 2e7, 1e9, 2e10, 2e9]

[bodies.module]
type = "rigid"
mass = 1.2e5
inertia = [1e6, 2e6, 2e6]
centre_of_mass = [0.1, 0.1, 4]
frame = {{ motion = "free" }}
initial = {{ position = {module}, orientation = {turned} }}

[[decks]]
name = "quay"
origin = [0, 0, 4]
direction = {along}
stations = [-60, 0]
heights = [0, 0]
sides = [-12, 12]
[[decks]]
name = "barge_deck"
body = "barge"
origin = [-30, 0, 4]
stations = [0, 60]
heights = [0, 0]
sides = [-10, 10]

[[link_beams]]
name = "link_1"
hinged_on = "barge"
hinge = [-30, 2, 4]
rests_on = "ground"
edge = {edge_1}
along = {back}
length = 4
breadth = 3
mass = 6e3
[[link_beams]]
name = "link_2"
hinged_on = "barge"
hinge = [-30, -2, 4]
rests_on = "ground"
edge = {edge_2}
along = {back}
length = 4
breadth = 3
mass = 6e3

[[transporters]]
name = "spmt"
body = "module"
wheel_radius = 0.37
tyre_stiffness = 3e6
tyre_damping = 15e3
line_damping = 20e3
legs = [{{ steering = "all", points = [[12, 0]], speed = 0.1, acceleration = 0.02 }}]
groups = [
    {{ name = "a", oil_stiffness = 9.7e6, bogies = [[0.7, 2, 0], [2.1, 2, 0], [3.5, 2, 0]] }},
    {{ name = "b", oil_stiffness = 9.7e6, bogies = [[0.7, -2, 0], [2.1, -2, 0], [3.5, -2, 0]] }},
    {{ name = "c", oil_stiffness = 9.7e6, bogies = [[-0.7, 2, 0], [-2.1, 2, 0], [-3.5, 2, 0]] }},
    {{ name = "d", oil_stiffness = 9.7e6, bogies = [[-0.7, -2, 0], [-2.1, -2, 0], [-3.5, -2, 0]] }},
]

{moorings}

[simulate]
step = 0.05
output_interval = 0.05
duration = 120
"""


def turned_case(folder: Path, degrees: float) -> Path:
    angle = math.radians(degrees)
    c, s = math.cos(angle), math.sin(angle)

    def world(x: float, y: float, z: float) -> list[float]:
        return [c * x - s * y, s * x + c * y, z]

    moorings = ""
    for i in range(4):
        sx, sy = 1 - 2 * (i % 2), 1 - 2 * (i // 2)
        moorings += f'[[forces]]\nname = "mooring_{i}"\ntype = "spring"\nbetween = ["ground", "barge"]\n'
        moorings += f"points = [{world(31 + 70 * sx, 40 * sy, 2)}, [{28 * sx}, {9 * sy}, 2]]\n"
        moorings += "stiffness = 1e6\ndamping = 5e5\n"
    folder.mkdir()
    (folder / "case.toml").write_text(
        CASE.format(
            barge=world(31, 0, 0),
            module=world(-5, 0, 4),
            turned=f'{{ axis = [0, 0, 1], angle = "{degrees} deg" }}',
            along=world(1, 0, 0),
            back=world(-1, 0, 0),
            edge_1=world(0, 2, 4),
            edge_2=world(0, -2, 4),
            moorings=moorings,
        )
    )
    return folder


def histories(folder: Path, degrees: float):
    case = load_case(turned_case(folder, degrees))
    run_case(case, stages=("mesh", "simulate"))
    results = load_results(case, case.output_folder)
    angle = math.radians(degrees)
    R = np.array(
        [[math.cos(angle), -math.sin(angle), 0.0], [math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]]
    )
    found = {
        name: np.asarray(results[f"spmt.{name}"]) for name in ("push_along", "push_across", "push_turning")
    }
    for hinge in ("link_1_hinge", "link_2_hinge"):
        for what in ("reaction_force", "reaction_moment"):
            found[f"{hinge}.{what}"] = np.asarray(results[f"{hinge}.{what}"]) @ R
    details = read_json(OutputFolder(case.output_folder).manifest("simulate"))["details"]
    return found, details


@pytest.mark.slow
def test_pushes_and_reactions_turn_with_the_scene(tmp_path):
    """By 37 and 60 degrees, to 1e-6 of their ranges; the path holds nothing twice and leaves 24 - 10 - 3 motions."""
    straight, details = histories(tmp_path / "straight", 0.0)
    assert details["redundant"] == []
    assert details["degrees_of_freedom"] == 11
    assert np.ptp(straight["push_along"]) > 1e3
    for degrees in (37.0, 60.0):
        turned, about = histories(tmp_path / f"by_{degrees:g}", degrees)
        assert about["degrees_of_freedom"] == 11
        for name, values in straight.items():
            later = slice(1, None)  # the start itself is found to rounding of all weights
            scale = max(np.ptp(values[later]), 1.0)
            np.testing.assert_allclose(
                turned[name][later], values[later], rtol=0.0, atol=1e-6 * scale, err_msg=name
            )
