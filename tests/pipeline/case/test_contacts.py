"""Contours and contacts in case files: what they mean in SI, and the names that checks may use of them."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.case.channel_kinds import all_channels, channel_components
from heavylift.pipeline.case.tables import declared
from heavylift.pipeline.results.provenance import simulate_digest

CONTACT = {
    "gap": "m",
    "force": "N",
    "normal_force": "N",
    "friction_force": "N",
    "impulse": "kg m/s",
    "slip": "m/s",
    "slip_path": "m",
    "coordinate": "1",
    "point": "m",
    "dissipated": "N m",
    "impacts": "1",
}


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "contacts"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "contacts.toml", folder / "case.toml")
    return folder


def test_quantities_of_contacts_are_in_si(folder):
    case = load_case(folder)
    landing, bead, squeeze, pad, foot = case.contacts
    assert (landing.restitution, landing.rest_speed, landing.friction, landing.events) == (
        0.5,
        1e-3,
        0.3,
        True,
    )
    assert bead.law == "bilateral"
    assert bead.shape.type == "point"
    assert squeeze.contact_modulus == 1e7
    # 1 kN/mm^1.5 = 1e3 N / (1e-3 m)^1.5
    assert pad.stiffness == pytest.approx(1e3 * 1e-3**-1.5, rel=1e-14)
    assert (foot.footprint, foot.stiffness, foot.damping) == (None, 1e6, 10.0)


def test_the_unit_of_a_stiffness_follows_the_exponent(folder):
    case = load_case(folder, ["contacts.3.exponent=2", "contacts.3.stiffness=1 N/mm^2"])
    assert case.contacts[3].stiffness == pytest.approx(1e6, rel=1e-14)
    with pytest.raises(InputError, match=r"contacts\.3\.stiffness: '1 N/mm' is a stiffness; .*\[N/m\^2\]"):
        load_case(folder, ["contacts.3.exponent=2", "contacts.3.stiffness=1 N/mm"])


def test_one_degree_is_that_of_both_directions(folder):
    assert load_case(folder).contours["floor"].degree == (3, 3)
    assert load_case(folder, ["contours.floor.degree=5"]).contours["floor"].degree == (5, 5)
    assert load_case(folder, ["contours.floor.degree=[3, 4]"]).contours["floor"].degree == (3, 4)
    assert load_case(folder, ["contours.floor.closed=[false, true]"]).contours["floor"].closed == (
        False,
        True,
    )


@pytest.mark.parametrize("name", CONTACT)
def test_checks_may_name_every_channel_of_a_contact_in_its_unit(folder, name):
    case = load_case(folder)
    component = {"force": ".x", "coordinate": ".u", "point": ".z"}.get(name, "")
    quantity = case.quantity(f"channel.landing.{name}{component}.max")
    assert quantity.kind.unit == CONTACT[name]
    assert quantity.item == f"landing.{name}"
    assert name in all_channels()


def test_a_contact_has_no_other_channels_and_a_contour_has_none(folder):
    with pytest.raises(InputError, match=r"did you mean 'normal_force'\?"):
        load_case(folder).quantity("channel.landing.normal_froce.max")
    with pytest.raises(InputError, match="a channel of 'floor': none"):
        load_case(folder).quantity("channel.floor.gap.max")


def test_components_of_a_force_depend_on_whose_it_is():
    assert channel_components("force") is None
    assert channel_components("coordinate") == ("u", "v")
    assert channel_components("point") == ("x", "y", "z")
    assert channel_components("gap") == ("gap",)


def test_contours_are_declared_with_type_and_body():
    document = {
        "contours": {"a": {"type": "surface", "body": "b"}, "broken": 3},
        "contacts": [{"name": "c"}, {"nome": "d"}],
        "bodies": {"b": {"type": "rigid"}},
    }
    names = declared(document)
    assert names.contours == {"a": ("surface", "b"), "broken": ("", "")}
    assert names.body_types == {"b": "rigid"}
    assert sorted(names.names) == ["a", "b", "broken", "c"]


def test_results_belong_to_the_contacts_and_to_the_points_in_files(folder):
    (folder / "line.csv").write_text("0, 0, 1\n1, 0, 1\n2, 0, 1\n3, 0, 1\n")
    change = ["contours.rail.circle=", "contours.rail.file=line.csv"]
    digests = [
        simulate_digest(load_case(folder)),
        simulate_digest(load_case(folder, ["contacts.0.friction=0.2"])),
        simulate_digest(load_case(folder, ["contours.cable.radius=11 mm"])),
        simulate_digest(load_case(folder, change)),
    ]
    (folder / "line.csv").write_text("0, 0, 1\n1, 0, 1\n2, 0, 1\n4, 0, 1\n")
    digests.append(simulate_digest(load_case(folder, change)))
    assert len(set(digests)) == len(digests)
    assert simulate_digest(load_case(folder)) == digests[0]


REPEATED = """
title = "Balls on steps"

[[repeat]]
count = 3
shift = [0, "2 m", "1 m"]

[repeat.bodies."ball{i}"]
type = "rigid"
mass = 1
inertia = [1, 1, 1]
frame = { motion = "free" }

[repeat.contours."step{i}"]
body = "ground"
type = "surface"
points = [
    [[0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 3, 0]],
    [[1, 0, 0], [1, 1, 0], [1, 2, 0], [1, 3, 0]],
    [[2, 0, 0], [2, 1, 0], [2, 2, 0], [2, 3, 0]],
    [[3, 0, 0], [3, 1, 0], [3, 2, 0], [3, 3, 0]],
]

[repeat.contours."rail{i}"]
body = "ground"
type = "curve"
circle = { axis = [0, 0, 1], radius = 1 }

[[repeat.contacts]]
name = "touch{i}"
between = ["ball{i}", "step{i}"]
at = [1, 1, "10 cm"]
law = "rigid"
"""


def test_contours_and_contacts_repeat_with_their_places(tmp_path):
    (tmp_path / "case.toml").write_text(REPEATED)
    case = load_case(tmp_path)
    assert [contact.between for contact in case.contacts] == [(f"ball{i}", f"step{i}") for i in range(3)]
    assert case.contacts[2].at == pytest.approx((1.0, 5.0, 2.1))
    assert case.contours["step2"].points[1][0] == pytest.approx((1.0, 4.0, 2.0))
    assert case.contours["rail1"].circle.centre == pytest.approx((0.0, 2.0, 1.0))
    assert case.place("contours.step2.points") == "repeat.0.contours.step{i}.points"
    assert math.isclose(case.contours["rail1"].circle.radius, 1.0)
    with pytest.raises(InputError, match=r"repeat\.0\.contacts\.0: law = 'rgid' \(i = 0\)"):
        load_case(tmp_path, ["repeat.0.contacts.0.law=rgid"])
