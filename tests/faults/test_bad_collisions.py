"""Bad surfaces and collisions: one clear error each, before anything runs."""

from __future__ import annotations

import shutil
import struct
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder


@pytest.fixture
def collisions(tmp_path):
    folder = tmp_path / "collisions"
    folder.mkdir()
    here = Path(__file__).parents[1] / "pipeline"
    shutil.copyfile(here / "collisions.toml", folder / "case.toml")
    shutil.copyfile(here / "tank.stl", folder / "tank.stl")
    (folder / "empty.stl").write_bytes(b"nothing".ljust(80) + struct.pack("<I", 0))
    corners = np.array([[0, 0, 1, 0, 0, 0, 1, 0, 0, 0, np.nan, 0]], dtype="<f4")
    (folder / "nan.stl").write_bytes(
        b"not a number".ljust(80) + struct.pack("<I", 1) + corners.tobytes() + b"\0\0"
    )
    (folder / "line.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
    (folder / "words.stl").write_text("these are words, and no triangles\n")
    (folder / "part.step").write_text("no STEP\n")
    (folder / "notes.txt").write_text("notes\n")
    return folder


def complaint(folder, overrides):
    """The one line of an error in reading the case or assembling its scene."""
    with pytest.raises(InputError) as caught:
        assemble_scene(load_case(folder, overrides), OutputFolder(folder / "out"))
    (line,) = str(caught.value).splitlines()
    return line


LAND, PLATE, FLOOR = "collisions.0", "surfaces.0", "surfaces.1"


@pytest.mark.parametrize(
    ("overrides", "key", "problem", "expected"),
    [
        # surfaces and pairs
        (
            [f'{LAND}.between=["flor", "plating"]'],
            f"{LAND}.between.0",
            "did you mean 'floor'",
            "one of: bollard",
        ),
        (
            [f'{LAND}.between=["floor", "tank"]'],
            f"{LAND}.between.1",
            "is a body, not a surface",
            "surfaces: plating",
        ),
        ([f'{LAND}.between=["floor", "floor"]'], f"{LAND}.between.1", "'floor' twice", "different surfaces"),
        ([f'{LAND}.between=["floor"]'], f"{LAND}.between", "1 entries", "at least 2"),
        (
            [f'{LAND}.between=["floor", "bollard"]'],
            f"{LAND}.between",
            "neither 'ground' nor 'quay'",
            "free frame",
        ),
        ([f"{FLOOR}.body=tank"], f"{LAND}.between", "are both surfaces of 'tank'", "of two bodies"),
        ([f"{LAND}.between="], LAND, "neither 'between' nor 'among'", "'between' two"),
        ([f'{LAND}.among=["floor", "skin"]'], LAND, "both 'between' and 'among'", "'between' two"),
        (['collisions.1.among=["floor", "bollard"]'], "collisions.1.among", "no pair of these", "free frame"),
        (
            ['collisions.1.among=["floor", "skni"]'],
            "collisions.1.among.1",
            "did you mean 'skin'",
            "one of: boll",
        ),
        (
            ["collisions.1.name=ball"],
            "collisions.1.name",
            "'ball' occurs 2 times",
            "contour or contact a name",
        ),
        (
            ["collisions.2.name=bump_3"],
            "collisions.2.name",
            "'bump_3' occurs 2 times",
            "contour or contact a name",
        ),
        (["collisions.2.name=energy"], "collisions.2.name", "a channel of the whole scene", "another name"),
        ([f"{PLATE}.body=tnk"], f"{PLATE}.body", "did you mean 'tank'", "one of: ball"),
        # sources of triangles
        ([f"{PLATE}.file="], PLATE, "neither 'file' nor 'shape'", "one of them"),
        ([f"{FLOOR}.file=tank.stl"], FLOOR, "both 'file' and 'shape'", "one of them"),
        ([f"{PLATE}.file=tnk.stl"], f"{PLATE}.file", "file 'tnk.stl' does not exist", "in the case folder"),
        ([f"{PLATE}.file=../tank.stl"], f"{PLATE}.file", "leaves the case folder", "inside the case folder"),
        ([f"{PLATE}.unit=cm"], f"{PLATE}.unit", "'cm'", "'m' or 'mm'"),
        ([f"{PLATE}.size=1 m"], f"{PLATE}.size", "'size' with 'tank.stl'", "a STEP, IGES or BREP file"),
        ([f"{FLOOR}.unit=mm"], f"{FLOOR}.unit", "'unit' with 'shape'", "'file'"),
        ([f"{PLATE}.file=part.step"], f"{PLATE}.unit", "'unit' with 'part.step'", "no 'unit'"),
        (
            [f"{PLATE}.file=part.step", f"{PLATE}.unit="],
            f"{PLATE}.file",
            "is not a STEP file",
            "ISO-10303-21",
        ),
        ([f"{PLATE}.file=empty.stl"], f"{PLATE}.file", "empty.stl: ", "triangle"),
        ([f"{PLATE}.file=words.stl"], f"{PLATE}.file", "words.stl: ", "triangle"),
        ([f"{PLATE}.file=nan.stl"], f"{PLATE}.file", "nan", "three finite coordinates"),
        ([f"{PLATE}.file=line.obj"], f"{PLATE}.file", "all 1 triangles are points or lines", "with an area"),
        ([f"{PLATE}.file=notes.txt"], f"{PLATE}.file", "suffix '.txt' is unknown", ".stl"),
        ([f"{FLOOR}.shape.type=plain"], f"{FLOOR}.shape", "type = 'plain'", "'plane', 'box', 'sphere'"),
        ([f"{FLOOR}.shape.size=[1, 0]"], f"{FLOOR}.shape.size.1", "0 is too small", "> 0 m"),
        ([f"{FLOOR}.facets=3"], f"{FLOOR}.facets", "'facets' of 'ground'", "a frame or shell"),
        (["surfaces.2.radius=200 mm"], "surfaces.2.radius", "rounds all of the shape off", "less than 0.2 m"),
        (
            ["surfaces.3.radius=1 mm"],
            "surfaces.3.radius",
            "'radius' with shape 'sphere'",
            "of the shape alone",
        ),
        (["surfaces.2.shape.sides=2"], "surfaces.2.shape.sides", "2 is too small", ">= 3"),
        (["surfaces.4.file=tank.stl"], "surfaces.4.file", "'file' of the frame 'rope'", "its own surface"),
        # exclusion
        ([f"{PLATE}.exclude.0.size=[1, 1, 0]"], f"{PLATE}.exclude.0.size.2", "0 is too small", "> 0 m"),
        ([f"{PLATE}.exclude.0.keep=above"], f"{PLATE}.exclude.0.keep", "'above'", "'outside' or 'inside'"),
        (
            [f"{PLATE}.exclude.0.centre=[0, 0, 0]"],
            f"{PLATE}.exclude",
            "all 12 triangles are excluded",
            "leave",
        ),
        (
            ["surfaces.3.exclude=[{centre=[0, 0, 0], size=[1, 1, 1]}]"],
            "surfaces.3.exclude",
            "has no triangles",
            "no 'exclude'",
        ),
        # laws
        ([f"{LAND}.law="], LAND, "key 'law' is missing", "one of 'rigid', 'linear'"),
        (
            [f"{LAND}.law=bilateral"],
            LAND,
            "law = 'bilateral'",
            "'rigid', 'linear', 'hertz', 'hunt-crossley', 'thesis'",
        ),
        (
            [f"{LAND}.stiffness=1"],
            f"{LAND}.stiffness",
            "'stiffness' with law 'rigid'",
            "law 'linear' or 'hertz'",
        ),
        ([f"{LAND}.restitution=1.1"], f"{LAND}.restitution", "1.1 is too large", "<= 1"),
        ([f"{LAND}.friction=-1"], f"{LAND}.friction", "-1 is too small", ">= 0"),
        ([f"{LAND}.peak_stiffness=1 N"], f"{LAND}.peak_stiffness", "'1 N' is a force", "[N/m]"),
        ([f"{LAND}.method=fast"], f"{LAND}.method", "'fast'", "'swept' or 'position-difference'"),
        ([f"{LAND}.patch_angle=0"], f"{LAND}.patch_angle", "0 is too small", "> 0 rad"),
        ([f"{LAND}.most_contacts=4"], f"{LAND}.recorded", "8 of 4 contacts", "no more than 'most_contacts'"),
        (
            ["collisions.2.peak_stiffness=1"],
            "collisions.2.peak_stiffness",
            "with law 'linear'",
            "law 'rigid'",
        ),
        (["collisions.2.stiffness=0"], "collisions.2.stiffness", "0 is too small", "> 0 N/m"),
        (["collisions.1.stiffness=1 N/m"], "collisions.1.stiffness", "'1 N/m' is a stiffness", "[N/m^1.5]"),
        (["collisions.1.stiffness="], "collisions.1.stiffness", "is missing", "a value"),
        (["collisions.1.restitution=0"], "collisions.1.restitution", "infinite damping", "law 'rigid'"),
        (["collisions.3.gamma=0"], "collisions.3.gamma", "infinite damping", "above 0, up to 1"),
        (["collisions.3.gamma=1.5"], "collisions.3.gamma", "1.5 is too large", "<= 1"),
        (["collisions.3.epsilon=1 N/m"], "collisions.3.epsilon", "'1 N/m' is a stiffness", "[m/N]"),
        (
            ["simulate.step=", "simulate.tolerance=1e-6"],
            "collisions.3.law",
            "'thesis' without a fixed step",
            "law 'linear'",
        ),
        (
            ["simulate.integrator=thesis"],
            "simulate.integrator",
            "'thesis' with collisions",
            "'dele2' or 'auto'",
        ),
        (
            ["check.0.quantity=channel.bump_2.contact_3.force.max"],
            "check.0.quantity",
            "'bump_2' has no 'contact_3'",
            "contact_1 to contact_2",
        ),
    ],
)
def test_one_mistake_is_one_line_with_key_problem_and_expectation(
    collisions, overrides, key, problem, expected
):
    line = complaint(collisions, overrides)
    assert f"{key}: " in line
    assert problem in line.partition(f"{key}: ")[2].partition("; expected ")[0]
    assert expected in line.partition("; expected ")[2]


def test_other_triangles_of_a_flexible_body_are_refused(collisions):
    text = (collisions / "case.toml").read_text()
    quay = text[text.index("[bodies.quay]") : text.index("[bodies.rope]")]
    bar = """[bodies.quay]
type = "flexible"
geometry = { type = "mesh", file = "notes.txt" }
material = { young_modulus = 1, poisson_ratio = 0.3, density = 1 }
modes = { count = 1 }
frame = { motion = "fixed" }

"""
    (collisions / "case.toml").write_text(text.replace(quay, bar))
    line = complaint(collisions, [])
    assert "surfaces.2.at: 'at' of the flexible 'quay'" in line
    assert "its own surface takes part, with 'exclude' at most" in line


def test_collisions_with_the_ground_change_the_momentum(collisions):
    (collisions / "case.toml").write_text(
        (collisions / "case.toml")
        .read_text()
        .replace('[gravity]\nacceleration = [0, 0, "-9.81 m/s^2"]\n', "")
        .replace('"channel.landing.contact_1.impulse.max"', '"drift.momentum"')
        .replace('"10 N s"', "1", 1)
    )
    line = complaint(collisions, [])
    assert "check.0.quantity: 'drift.momentum'" in line
    assert "collision 'landing'" in line
    assert "collision 'bump_1'" in line
    assert "collision 'soft'" not in line
