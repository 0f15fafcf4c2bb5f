"""Blocks are written out as if by hand, and what is wrong in them is told where the user wrote it."""

from __future__ import annotations

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case

CHAIN = """
title = "Chain of {n}"
sources = ["made for {tests}"]

[parameters]
n = 3
pitch = 0.5

[[repeat]]
count = "n"
first = 1
shift = ["50 cm", 0, 0]

[repeat.bodies."link_{i}"]
type = "rigid"
mass = "{2*i} kg"
inertia = [1, 1, 1]
frame = { motion = "free" }

[[repeat.sensors]]
name = "end_{i}"
body = "link_{i}"
point = ["{pitch} m", 0, 0]

[[repeat]]
count = "n - 1"
first = 1
shift = ["0.5 m", 0, 0]

[[repeat.joints]]
type = "ball"
name = "pin_{i}"
between = ["link_{i}", "link_{i+1}"]
at = ["0.5 m", 0, 0]

[[joints]]
type = "ball"
name = "root"
between = ["ground", "link_1"]
at = [0, 0, 0]
"""


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "chain"
    folder.mkdir()
    (folder / "case.toml").write_text(CHAIN)
    return folder


def lines(folder, *overrides):
    with pytest.raises(InputError) as caught:
        load_case(folder, overrides)
    return str(caught.value).splitlines()


def test_a_block_is_what_one_would_write_by_hand(folder):
    case = load_case(folder)
    assert case.title == "Chain of 3"
    assert case.sources == ("made for {tests}",)  # braces in prose may mean nothing
    assert list(case.bodies) == ["link_1", "link_2", "link_3"]
    assert [body.mass for body in case.bodies.values()] == [2.0, 4.0, 6.0]
    assert [body.initial.position[0] for body in case.bodies.values()] == [0.5, 1.0, 1.5]
    assert [joint.name for joint in case.joints] == ["root", "pin_1", "pin_2"]
    assert [joint.between for joint in case.joints[1:]] == [("link_1", "link_2"), ("link_2", "link_3")]
    assert [joint.at[0] for joint in case.joints] == [0.0, 1.0, 1.5]
    assert [sensor.point[0] for sensor in case.sensors] == [0.5, 0.5, 0.5]


def test_counts_and_templates_can_be_overridden(folder):
    assert len(load_case(folder, ["parameters.n=40"]).bodies) == 40
    assert len(load_case(folder, ["repeat.1.count=1"]).joints) == 2
    case = load_case(folder, ["repeat.0.bodies.link_{i}.mass=7", "repeat.1.joints.0.compliance=1e-9 m/N"])
    assert {body.mass for body in case.bodies.values()} == {7.0}
    assert [joint.compliance for joint in case.joints] == [0.0, 1e-9, 1e-9]
    assert load_case(folder, ["repeat.0.count=2*n - 3"]).repeat[0].count == 3


def test_a_shift_moves_places_in_the_world_only(folder):
    more = (
        'repeat.1.ropes=[{name="rope_{i}", axial_stiffness=1, path=['
        '{body="ground", point=[1, 2, 3]}, {body="link_{i}", point=[1, 2, 3]}]}]'
    )
    joint = (
        'repeat.1.joints.0={type="ball", name="pin_{i}", between=["link_{i}", "ground"], '
        "points=[[1, 0, 0], [1, 0, 0]]}"
    )
    spring = (
        'repeat.1.forces=[{type="spring", name="spring_{i}", between=["ground", "link_{i}"], stiffness=1, '
        "points=[[1, 0, 0], [1, 0, 0]]}]"
    )
    case = load_case(folder, [more, joint, spring, 'repeat.1.shift=["10 cm", 0, "1 m"]'])
    assert [stop.point for stop in case.ropes[1].path] == [(1.2, 2.0, 5.0), (1.0, 2.0, 3.0)]
    assert case.joints[2].points == ((1.0, 0.0, 0.0), (1.2, 0.0, 2.0))
    assert case.forces[1].points == ((1.2, 0.0, 2.0), (1.0, 0.0, 0.0))
    driven = (
        'repeat.0.bodies.link_{i}.frame={motion="driven", origin="centre_of_mass", '
        "angle={harmonics=[{amplitude=1, frequency=1}]}}"
    )
    body = load_case(folder, [driven, "repeat.0.bodies.link_{i}.centre_of_mass=[0, 0.1, 0]"]).bodies["link_2"]
    assert body.initial.position == (1.0, 0.1, 0.0)
    assert body.frame.pivot == (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        ("repeat.0.bodies.link_{i}.mass=-1", "repeat.0.bodies.link_{i}.mass", "-1 is too small (i = 1)"),
        ('repeat.0.bodies.link_{i}.mass="{2*j} kg"', "repeat.0.bodies.link_{i}.mass", "'j' is not known"),
        ("repeat.1.count=n", "repeat.1.joints.0.between.1", "body 'link_4' does not exist"),
        ("repeat.1.joints.0.name=pin", "repeat.1.joints.0.name", "'pin' occurs 2 times (i = 2)"),
        ("repeat.1.joints.0.axis=[0, 0, 1]", "repeat.1.joints.0.axis", "unknown key"),
        ("repeat.0.count=many", "repeat.0.count", "'many' is not known"),
        ("repeat.0.count=-1", "repeat.0.count", "-1 is too small"),
        ("repeat.0.count=2.5", "repeat.0.count", "2.5 is not an integer"),
        ("repeat.0.count=n/2", "repeat.0.count", "1.5 is not an integer"),
        ("repeat.0.count=1/0", "repeat.0.count", "divides by zero"),
        ("repeat.0.shift=[1, 2]", "repeat.0.shift", "2 entries"),
        ("repeat.0.cuont=3", "repeat.0.cuont", "does not exist; did you mean 'count'"),
        ("parameters.n=three", "parameters.n", "'three' is not a number"),
        ("parameters.n='3 m'", "parameters.n", "'3 m' is not a number"),
        ("parameters={n=3, pitch=1, i=3}", "parameters.i", "index of a repeat block"),
    ],
)
def test_what_is_wrong_is_told_once_at_the_place_in_the_file(folder, override, key, words):
    (line,) = lines(folder, override)
    assert key in line
    assert words in line
    assert f"--set {override.partition('=')[0]}" in line or str(folder / "case.toml") in line


def test_a_body_made_twice_is_refused(folder):
    text = (folder / "case.toml").read_text().replace('"link_{i}"]', '"link"]')
    (folder / "case.toml").write_text(text)
    (line, *_) = lines(folder)
    assert "repeat.0.bodies.link: 'link' (i = 2) is already made by repeat.0.bodies.link (i = 1)" in line
    assert "expected a name with {i}" in line


def test_parameters_go_into_texts_anywhere(folder, tmp_path):
    (folder / "history_3.csv").write_text("time,x\n0,0\n1,1\n")
    case = load_case(
        folder,
        [
            'reference=[{name="end", channel="end_{n}.position", file="history_{n}.csv"}]',
            "simulate={step=0.1, output_interval=0.5, duration=1}",
        ],
    )
    assert case.reference[0].channel == "end_3.position"
    assert case.reference[0].file == "history_3.csv"
    (line,) = lines(folder, 'sensors=[{name="a", body="link_{m}", point=[0, 0, 0]}]')
    assert "sensors.0.body" in line
    assert "'m' is not known" in line
