"""Interfaces of a flexible body in a case: their groups, their modes, and what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.finite_elements import assemble_model
from heavylift.pipeline.assemble.modes import reduce_model, reduced_properties
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.results.provenance import modes_digest

CASE = """
title = "bar"
[bodies.bar]
type = "flexible"
material = { young_modulus = "210 GPa", poisson_ratio = 0.0, density = "7850 kg/m^3" }
frame = { motion = "MOTION", origin = "centre_of_mass" }
[bodies.bar.geometry]
type = "blocks"
add = [{ name = "bar", from = [0, "-10 mm", "-10 mm"], to = ["1 m", "10 mm", "10 mm"] }]
groups = { root = { plane = "x", at = 0 }, tip = { plane = "x", at = "1 m" } }
[bodies.bar.mesh]
element = "hex8"
divisions = { x = [20], y = [2], z = [2] }
[bodies.bar.modes]
MODES
[bodies.bar.interfaces.ROOT]
group = "root"
[bodies.bar.interfaces.TIP]
at = ["1 m", 0, "50 mm"]
radius = "55 mm"
[simulate]
step = "1 ms"
output_interval = "1 ms"
duration = "1 ms"
"""


@pytest.fixture
def reduced(tmp_path):
    def make(modes, *changes, motion="free"):
        text = CASE.replace("MODES", modes).replace("MOTION", motion)
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        file = tmp_path / "case.toml"
        file.write_text(text, encoding="utf-8")
        case = load_case(file)
        body = case.bodies["bar"]
        return reduce_model(case, body, assemble_model(case, "bar", body), None)

    return make


def test_attachment_modes_of_interfaces_join_the_eigenmodes(reduced):
    found = reduced('up_to = "700 Hz"')
    body = found.body
    assert body.mode_count == 6 + 12  # three pairs of bending, and six loads at both ends
    np.testing.assert_allclose(body.interfaces["ROOT"].point, [-0.5, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(body.interfaces["TIP"].point, [0.5, 0.0, 0.05], atol=1e-12)
    assert min(one.captured for one in body.interfaces.values()) == pytest.approx(1.0, abs=1e-9)
    assert any("a rigid arm of 40 mm joins its point" in note for note in found.notes)
    assert reduced_properties(found)["interfaces"]["ROOT"] == "100 % of its static compliance captured"
    # what an interface reads of a mode is the mean of its nodes
    nodes = body.interfaces["ROOT"].nodes
    read = np.einsum("alk,mal->mk", body.interfaces["ROOT"].forces[:, :, :3], body.mode_shapes[:, nodes])
    np.testing.assert_allclose(read, body.interfaces["ROOT"].displacement, atol=1e-12)


def test_rigid_interfaces_are_those_of_craig_bampton(reduced):
    rigid = ('group = "root"', 'group = "root"\nkind = "rigid"'), ('"55 mm"', '"52 mm"\nkind = "rigid"')
    body = reduced('basis = "craig_bampton"\ncount = 4', *rigid).body
    assert body.mode_count == 12 + 4 - 6
    nodes = body.interfaces["ROOT"].nodes
    arms = body.nodes[nodes] - body.interfaces["ROOT"].point
    moved = body.interfaces["ROOT"].displacement[:, None] + np.cross(
        body.interfaces["ROOT"].rotation[:, None], arms
    )
    np.testing.assert_allclose(body.mode_shapes[:, nodes], moved, atol=1e-10 * np.abs(moved).max())


@pytest.mark.parametrize("basis", ["eigenmodes", "craig_bampton"])
def test_count_beside_a_frequency_is_the_largest_number(reduced, basis):
    rigid = ('group = "root"', 'group = "root"\nkind = "rigid"'), ('"55 mm"', '"52 mm"\nkind = "rigid"')
    modes = f'basis = "{basis}"\nup_to = "2 kHz"\ncount = COUNT'
    few, many = (reduced(modes.replace("COUNT", count), *rigid) for count in ("3", "50"))
    assert few.notes[0].startswith("WARNING: count = 3 ends before up_to = 2000 Hz")
    assert not any("ends before" in note for note in many.notes)
    assert many.body.mode_count > few.body.mode_count


def test_interfaces_change_the_digest(tmp_path):
    digests = []
    for radius in ("55 mm", "60 mm"):
        file = tmp_path / "case.toml"
        text = CASE.replace("MODES", "count = 2").replace("MOTION", "free").replace("55 mm", radius)
        file.write_text(text, encoding="utf-8")
        case = load_case(file)
        digests.append(modes_digest(case, case.bodies["bar"]))
    assert digests[0] != digests[1]


@pytest.mark.parametrize(
    ("modes", "change", "words"),
    [
        ("count = 2", ('"root"\n', '"rot"\n'), "interfaces.ROOT.group: group 'rot' does not exist"),
        ("count = 2", ('"55 mm"', '"10 mm"'), "interfaces.TIP.radius: no node is within 10 mm of the point"),
        ("count = 2", ('at = ["1 m", 0, "50 mm"]', "at = [0, 0, 0]"), "in common with interface 'ROOT'"),
        ("count = 2", ('radius = "55 mm"', ""), "TIP.at: point (1000, 0, 50) mm is not on the body"),
        ("count = 2", ('group = "root"', 'radius = "1 m"'), "ROOT.at: neither 'at' nor 'group'"),
        ("count = 2", ('"55 mm"', '"55 mm"\ngroup = "tip"'), "TIP.radius: 'group' and 'radius'"),
        ('basis = "craig_bampton"', ("", ""), "ROOT.kind: kind 'average' with basis 'craig_bampton'"),
        ('basis = "stored"\nup_to = "1 Hz"', ("", ""), "up_to: 'up_to' with basis 'stored'"),
        (
            'up_to = "1 Hz"',
            ("", ""),
            "modes.up_to: no mode up to 1 Hz; expected at least the first frequency",
        ),
    ],
)
def test_what_is_refused(reduced, modes, change, words):
    with pytest.raises(InputError, match=re.escape(words)):
        reduced(modes, change)


def test_rigid_interface_of_clamped_nodes_is_refused(reduced):
    with pytest.raises(InputError, match=r"interfaces\.ROOT\.kind: node 0 is held or follows others"):
        reduced(
            'count = 2\nclamp = ["root"]',
            ('group = "root"', 'group = "root"\nkind = "rigid"'),
            motion="fixed",
        )


BUILT_IN = """
[bodies.arm]
type = "rigid"
mass = "1 kg"
inertia = [1, 1, 1]
frame = { motion = "free" }
initial = { position = [0, 0, "2 m"] }
[[joints]]
type = "fixed"
name = "built_in"
between = ["arm", "bar"]
at = [AT, 0, "2 m"]
"""


def bar_joined_to_an_arm(reduced, at, *, motion="free", modes="count = 3"):
    """The bar turned by a right angle and moved, joined to an arm at a distance from its start along the world's x."""
    start = (
        '\ninitial = { position = ["0.5 m", 0, "2 m"], orientation = { axis = [1, 0, 0], angle = "90 deg" } }'
    )
    frame = f'frame = {{ motion = "{motion}", origin = "centre_of_mass" }}'
    nothing = ('[bodies.bar.interfaces.ROOT]\ngroup = "root"\n', "")
    tip = ('[bodies.bar.interfaces.TIP]\nat = ["1 m", 0, "50 mm"]\nradius = "55 mm"', "")
    joint = ("[simulate]", BUILT_IN.replace("AT", at) + "[simulate]")
    return reduced(modes, nothing, tip, (frame, frame + start), joint, motion=motion)


def test_joint_that_holds_directions_gets_attachment_modes_unasked(reduced):
    found = bar_joined_to_an_arm(reduced, '"1 m"')
    assert found.body.mode_count == 3 + 6
    assert "'built_in'" in found.notes[0]
    # held at its end by the arm it bends as a cantilever, whatever its frame does: EI / L of a moment there
    body = found.body
    end = np.argmin(np.linalg.norm(body.nodes - [0.5, 0.0, 0.0], axis=1))
    place = body.motion_at(body.nodes[end])
    stiffness = 2.1e11 * 0.02**4 / 12.0
    compliance = np.sum(place.rotation[:, 1] ** 2 / body.eigenvalues)
    # a free bar under a moment M at its end, balanced by its inertia: turn relative to its mean motion 13 M L / 35 EI
    assert compliance == pytest.approx(13.0 / 35.0 / stiffness, rel=2e-3)


def test_joint_where_the_body_is_clamped_adds_nothing(reduced):
    found = bar_joined_to_an_arm(reduced, "0", motion="fixed", modes='count = 3\nclamp = ["root"]')
    assert found.body.mode_count == 3


def test_joint_at_an_interface_adds_nothing(reduced):
    at = ('radius = "55 mm"', "")
    joint = ("[simulate]", BUILT_IN.replace("AT", '"1 m"').replace('"2 m"', "0") + "[simulate]")
    found = reduced("count = 3", at, ('["1 m", 0, "50 mm"]', '["1 m", 0, 0]'), joint)
    assert found.body.mode_count == 3 + 12
    assert found.body.interfaces["TIP"].captured == pytest.approx(1.0, abs=1e-9)
