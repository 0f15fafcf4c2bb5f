"""Surfaces and collisions in case files: what they mean in SI, which pairs they are, names that checks may use."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.case.channel_kinds import COLLISION_CONTACT, all_channels, channel_components
from heavylift.pipeline.case.places import places
from heavylift.pipeline.case.tables import declared
from heavylift.pipeline.results.provenance import simulate_digest
from heavylift.solver.scene.contacts import ThesisLaw

COLLISION = {
    "gap": "m",
    "contacts": "1",
    "patches": "1",
    "force": "N",
    "normal_force": "N",
    "largest_force": "N",
    "impulse": "kg m/s",
    "point": "m",
    "slip": "m/s",
    "dissipated": "N m",
    "impacts": "1",
}
RECORDED = {
    "point": "m",
    "normal": "1",
    "gap": "m",
    "force": "N",
    "friction": "N",
    "impulse": "kg m/s",
    "patch": "1",
}


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "collisions"
    folder.mkdir()
    here = Path(__file__).parents[1]
    shutil.copyfile(here / "collisions.toml", folder / "case.toml")
    shutil.copyfile(here / "tank.stl", folder / "tank.stl")
    return folder


def test_quantities_of_collisions_are_in_si(folder):
    landing, bump, fender, soft = load_case(folder).collisions
    assert (landing.restitution, landing.rest_speed, landing.friction) == (0.5, 0.05, 0.3)
    assert (landing.events, landing.method, landing.peak_stiffness) == (True, "swept", 1e8)
    # 1 kN/mm^1.5 = 1e3 N / (1e-3 m)^1.5
    assert bump.stiffness == pytest.approx(1e3 * 1e-3**-1.5, rel=1e-14)
    assert (fender.stiffness, fender.damping, fender.patch_size) == (1e6, 1e4, 0.3)
    assert fender.patch_angle == pytest.approx(math.radians(25.0), rel=1e-15)
    assert landing.patch_angle == pytest.approx(math.pi / 10.0, rel=1e-15)
    assert (soft.epsilon, soft.gamma) == (1e-6, 0.8)


@pytest.mark.parametrize("gamma", [1.0, 0.8, 0.25])
def test_the_parameters_of_the_thesis_are_a_spring_and_a_damper(folder, gamma):
    """The softening 4 Gamma epsilon / h^2 of a row at the step h is that of a spring and damper in one step."""
    step = 2e-3
    section = load_case(folder, [f"collisions.3.gamma={gamma}"]).collisions[3]
    law = ThesisLaw(section.epsilon, section.gamma)
    k, tau, c = law.at_step(step).stiffness, law.time_constant(step), law.at_step(step).damping
    assert k == pytest.approx(1e6, rel=1e-14)
    assert c == pytest.approx(k * tau, rel=1e-14)
    assert gamma == pytest.approx(1.0 / (1.0 + 4.0 * tau / step), rel=1e-14)
    # p = -h (k (g + h (u - u0) / 4) + c u + ...): the coefficient of u in p is h (h k / 4 + c)
    assert step * (0.25 * step * k + c) == pytest.approx(
        1.0 / (4.0 * gamma * section.epsilon / step**2), rel=1e-14
    )


def test_among_is_every_pair_on_two_bodies_of_which_one_gives_way(folder):
    case = load_case(folder)
    assert case.collided["landing"] == (0, ("floor", "plating"))
    bumps = {name: pair for name, (index, pair) in case.collided.items() if index == 1}
    # the floor and the bollard of a fixed body cannot touch
    assert bumps == {
        "bump_1": ("floor", "skin"),
        "bump_2": ("floor", "strand"),
        "bump_3": ("bollard", "skin"),
        "bump_4": ("bollard", "strand"),
        "bump_5": ("skin", "strand"),
    }
    assert places(case)["bump_3"] == "collisions.1"
    assert places(case)["bollard"] == "surfaces.2"


@pytest.mark.parametrize("name", COLLISION)
def test_checks_may_name_every_channel_of_a_collision_in_its_unit(folder, name):
    component = ".z" if name in {"force", "point"} else ""
    quantity = load_case(folder).quantity(f"channel.landing.{name}{component}.max")
    assert quantity.kind.unit == COLLISION[name]
    assert quantity.item == f"landing.{name}"
    assert name in all_channels()


@pytest.mark.parametrize("name", RECORDED)
def test_checks_may_name_every_channel_of_a_recorded_contact(folder, name):
    component = ".x" if name in {"normal", "point"} else ""
    quantity = load_case(folder).quantity(f"channel.bump_4.contact_2.{name}{component}.min")
    assert quantity.kind.unit == RECORDED[name]
    assert (quantity.item, quantity.component) == (f"bump_4.contact_2.{name}", component.strip("."))
    assert name in COLLISION_CONTACT


def test_collisions_have_no_other_channels_and_surfaces_none(folder):
    case = load_case(folder)
    with pytest.raises(InputError, match=r"'bump_1' has no 'contact_3'; expected contact_1 to contact_2"):
        case.quantity("channel.bump_1.contact_3.force.max")
    with pytest.raises(InputError, match=r"did you mean 'normal'\?"):
        case.quantity("channel.landing.contact_1.nornal.max")
    with pytest.raises(InputError, match="a channel of 'floor': none"):
        case.quantity("channel.floor.gap.max")
    with pytest.raises(InputError, match="'tank' has no 'contact_1'"):
        case.quantity("channel.tank.contact_1.force.max")
    assert channel_components("normal") == ("x", "y", "z")


def test_a_broken_document_still_declares_what_it_can():
    names = declared(
        {
            "bodies": {"a": {"type": "rigid", "frame": {"motion": "free"}}, "b": 3},
            "surfaces": [{"name": "s", "body": "a"}, {"nome": "t"}, {"name": "g", "body": "ground"}],
            "collisions": [
                {"name": "c", "between": ["s", 4]},
                {"name": "d", "among": ["s", "g"], "recorded": "no"},
            ],
        }
    )
    assert names.surfaces == {"s": "a", "g": "ground"}
    assert names.yielding == {"a"}
    assert names.collisions == {"c": 8, "d_1": 8}
    assert sorted(names.names) == ["a", "b", "c", "d", "d_1", "g", "s"]


REPEATED = """
title = "Boxes on steps"

[[repeat]]
count = 3
shift = [0, "2 m", "1 m"]

[repeat.bodies."box{i}"]
type = "rigid"
mass = 1
inertia = [1, 1, 1]
frame = { motion = "free" }

[[repeat.surfaces]]
name = "step{i}"
body = "ground"
shape = { type = "plane", size = [1, 1] }
at = [0, 0, 1]

[[repeat.surfaces.exclude]]
centre = [9, 9, 9]
size = [1, 1, 1]

[[repeat.surfaces]]
name = "hull{i}"
body = "box{i}"
shape = { type = "box", size = [1, 1, 1] }
at = [0, 0, 1]

[[repeat.collisions]]
name = "touch{i}"
between = ["step{i}", "hull{i}"]
law = "rigid"
"""


def test_surfaces_and_collisions_repeat_and_only_those_of_the_ground_move(tmp_path):
    (tmp_path / "case.toml").write_text(REPEATED)
    case = load_case(tmp_path)
    surfaces = {surface.name: surface for surface in case.surfaces}
    assert surfaces["step2"].at == pytest.approx((0.0, 4.0, 3.0))
    assert surfaces["step2"].exclude[0].centre == pytest.approx((9.0, 13.0, 11.0))
    assert surfaces["hull2"].at == (0.0, 0.0, 1.0)
    assert list(case.collided) == ["touch0", "touch1", "touch2"]
    with pytest.raises(InputError, match=r"repeat\.0\.collisions\.0: law = 'rgid' \(i = 0\)"):
        load_case(tmp_path, ["repeat.0.collisions.0.law=rgid"])


@pytest.mark.parametrize(
    ("text", "asked"),
    [
        ("", set()),
        (
            '[[criteria]]\nname = "near"\ntype = "clearance"\ndistance = "landing.gap"\nminimum = "1 m"\n',
            {"landing"},
        ),
        ('[[check]]\nid = "near"\nquantity = "channel.bump_2.gap_min.min"\nminimum = "1 m"\n', {"bump_2"}),
        ('[report]\nchannels = ["*.gap", "tank.position"]\n', None),
        ('[report]\nchannels = ["landing.contact_1.gap", "bump_1.force"]\n', set()),
        (
            '[scenario]\nphases = [{ name = "wait", until = { quantity = "soft.gap", above = 0 } }]\n',
            {"soft"},
        ),
    ],
)
def test_a_gap_that_a_table_names_is_measured(folder, text, asked):
    """By a criterion, a check, the report or a phase; and the results of a run that did not are others."""
    file = folder / "case.toml"
    plain = simulate_digest(load_case(folder))
    file.write_text(f"{file.read_text()}\n{text}")
    case = load_case(folder)
    assert case.measured_gaps == (set(case.collided) if asked is None else asked)
    assert (simulate_digest(case) == plain) == (asked == set())
