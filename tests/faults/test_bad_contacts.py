"""Bad contours and contacts: one clear error each, before anything runs."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder


@pytest.fixture
def contacts(tmp_path):
    folder = tmp_path / "contacts"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "pipeline" / "contacts.toml", folder / "case.toml")
    (folder / "points.csv").write_text("0, 0, 0\n1, 0, 0\n2, 0, 0\n")
    (folder / "words.csv").write_text("0, 0, 0\n1, zero, 0\n")
    return folder


def complaint(folder, overrides):
    """The one line of an error in reading the case or assembling its scene."""
    with pytest.raises(InputError) as caught:
        assemble_scene(load_case(folder, overrides), OutputFolder(folder / "out"))
    (line,) = str(caught.value).splitlines()
    return line


LAND = "contacts.0"
FOLDED = [[[9 if (i, j) == (1, 0) else i, j, 0] for j in range(4)] for i in range(4)]
BOX = '{type="box", size=[1, 1, 1], rounding=%s}'
KNOTS = "[0, 0, 0, 0, 1, 1, 1, 1]"
CURVE = "{control=[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], knots=%s}"


@pytest.mark.parametrize(
    ("overrides", "key", "problem", "expected"),
    [
        # names
        ([f'{LAND}.between=["ball", "flor"]'], f"{LAND}.between.1", "did you mean 'floor'", "one of: cable"),
        ([f'{LAND}.between=["bal", "floor"]'], f"{LAND}.between.0", "did you mean 'ball'", "one of: ball"),
        ([f'{LAND}.between=["floor", "ball"]'], f"{LAND}.between", "is a contour", '["ball", "floor"]'),
        ([f'{LAND}.between=["ball"]'], f"{LAND}.between", "1 entries", "at least 2"),
        (
            [f'{LAND}.between=["ground", "floor"]'],
            f"{LAND}.between.0",
            "the ground touches nothing",
            "may have",
        ),
        (['contacts.3.between=["plate", "tray"]'], "contacts.3.between", "touch itself", "two different"),
        (["contacts.4.name=ball"], "contacts.4.name", "'ball' occurs 2 times", "contour or contact a name"),
        (["contacts.4.name=floor"], "contacts.4.name", "'floor' occurs 2 times", "contour or contact a name"),
        (["contacts.4.name=energy"], "contacts.4.name", "a channel of the whole scene", "another name"),
        (["contours.skid.body=blok"], "contours.skid.body", "did you mean 'block'", "one of: ball"),
        # laws
        ([f"{LAND}.law="], LAND, "key 'law' is missing", "one of 'rigid', 'bilateral'"),
        (
            [f"{LAND}.law=rgid"],
            LAND,
            "law = 'rgid'",
            "'rigid', 'bilateral', 'linear', 'hertz', 'hunt-crossley'",
        ),
        ([f"{LAND}.restitution=1.01"], f"{LAND}.restitution", "1.01 is too large", "<= 1"),
        ([f"{LAND}.restitution=-0.1"], f"{LAND}.restitution", "-0.1 is too small", ">= 0"),
        ([f"{LAND}.restitution=1 m"], f"{LAND}.restitution", "'1 m' is a length", "a number"),
        ([f"{LAND}.rest_speed=-1"], f"{LAND}.rest_speed", "-1 is too small", ">= 0 m/s"),
        ([f"{LAND}.rest_speed=1 mm"], f"{LAND}.rest_speed", "'1 mm' is a length", "a velocity"),
        ([f"{LAND}.friction=-0.3"], f"{LAND}.friction", "-0.3 is too small", ">= 0"),
        ([f"{LAND}.events=maybe"], f"{LAND}.events", "'maybe' is neither true nor false", "true or false"),
        (
            [f"{LAND}.stiffness=1"],
            f"{LAND}.stiffness",
            "'stiffness' with law 'rigid'",
            "law 'linear' or 'hertz'",
        ),
        ([f"{LAND}.damping=1"], f"{LAND}.damping", "'damping' with law 'rigid'", "law 'linear', or no"),
        (
            ["contacts.1.restitution=1"],
            "contacts.1.restitution",
            "with law 'bilateral'",
            "law 'rigid' or 'hunt",
        ),
        (["contacts.2.damping=1"], "contacts.2.damping", "'damping' with law 'hertz'", "law 'linear'"),
        (["contacts.2.stiffness=1"], "contacts.2", "both 'stiffness' and 'contact_modulus'", "of a sphere"),
        (["contacts.2.contact_modulus="], "contacts.2", "no 'stiffness'", "or 'contact_modulus'"),
        (["contacts.2.contact_modulus=0"], "contacts.2.contact_modulus", "0 is too small", "> 0 Pa"),
        (
            ["contacts.3.stiffness=", "contacts.3.contact_modulus=1 GPa"],
            "contacts.3.contact_modulus",
            "with shape 'box'",
            "shape 'sphere', or 'stiffness'",
        ),
        (["contacts.3.stiffness=1 N/m"], "contacts.3.stiffness", "'1 N/m' is a stiffness", "[N/m^1.5]"),
        (["contacts.3.stiffness=0"], "contacts.3.stiffness", "0 is too small", "> 0 N/m^1.5"),
        (["contacts.3.exponent=0.5"], "contacts.3.exponent", "0.5 is too small", ">= 1"),
        (
            ["contacts.3.restitution=0"],
            "contacts.3.restitution",
            "infinite damping",
            "above 0, or law 'rigid'",
        ),
        (["contacts.3.restitution=1.2"], "contacts.3.restitution", "1.2 is too large", "<= 1"),
        (["contacts.4.stiffness="], "contacts.4.stiffness", "is missing", "a value"),
        (["contacts.4.stiffness=-1"], "contacts.4.stiffness", "-1 is too small", "> 0 N/m"),
        # shapes
        ([f"{LAND}.shape.type=shpere"], f"{LAND}.shape", "type = 'shpere'", "'point', 'sphere'"),
        ([f"{LAND}.shape.radius=0"], f"{LAND}.shape.radius", "0 is too small", "> 0 m"),
        ([f"{LAND}.shape.axis=[1, 0, 0]"], f"{LAND}.shape.axis", "unknown key", "one of: radius, type"),
        ([f"{LAND}.shape={BOX % 0.5}"], f"{LAND}.shape.rounding", "0.5 m rounds all", "less than 0.5 m"),
        ([f"{LAND}.shape={BOX % 0}"], f"{LAND}.shape.rounding", "0 is too small", "> 0 m"),
        (
            [f'{LAND}.shape={{type="circle", radius=1, axis=[0, 0, 0]}}'],
            f"{LAND}.shape.axis",
            "length zero",
            "not all zero",
        ),
        (
            ['contacts.1.shape={type="sphere", radius=1}'],
            "contacts.1.shape.type",
            "'sphere' with law 'bilateral'",
            "'point'",
        ),
        (
            ['contacts.1.shape={type="circle", radius=1, axis=[1, 0, 0]}'],
            "contacts.1.shape.type",
            "'circle' with law 'bilateral'",
            "'point'",
        ),
        (
            ["contacts.2.contact_modulus=", "contacts.2.stiffness=1", f"contacts.2.shape={BOX % 0.1}"],
            "contacts.2.shape.type",
            "'box' on 'cable', a cylinder",
            "a contour of type 'surface'",
        ),
        (["contacts.1.law=rigid"], "contacts.1.shape", "a curve without thickness", "law 'bilateral'"),
        (["contacts.2.footprint=1 mm"], "contacts.2.footprint", "on 'cable', a cylinder", "type 'surface'"),
        (["contacts.1.footprint=1 mm"], "contacts.1.footprint", "on 'rail', a curve", "type 'surface'"),
        (
            ["contacts.3.footprint=1 mm"],
            "contacts.3.footprint",
            "with shape 'box'",
            "shape 'point' or 'sphere'",
        ),
        (["contacts.4.footprint=0"], "contacts.4.footprint", "0 is too small", "> 0 m"),
        (["contacts.4.footprint=1 mm"], "contacts.4.footprint", "a surface of 'ground'", "a flexible body"),
        (["contacts.1.point=[0, 0, 0]"], "contacts.1.at", "both 'point' and 'at'", "in the world"),
        # contours
        (
            ["contours.floor.type=plane"],
            "contours.floor",
            "type = 'plane'",
            "'surface', 'curve', 'cylinder', 'band'",
        ),
        (["contours.floor.degree=2"], "contours.floor.degree", "no continuous curvature", "3 to 7"),
        (["contours.floor.degree=[3, 1]"], "contours.floor.degree.1", "no continuous curvature", "3 to 7"),
        (["contours.skid.degree=2"], "contours.skid.degree", "no continuous curvature", "3 to 7"),
        (["contours.skid.degree=8"], "contours.skid.degree", "8 is too large", "3 to 7"),
        (["contours.skid.degree=3.5"], "contours.skid.degree", "3.5 is not an integer", "3 to 7"),
        (["contours.skid.degree=5"], "contours.skid.points", "5 points for degree 5", "at least 6"),
        (["contours.floor.degree=[3, 4]"], "contours.floor.points", "4 points for degree 4", "lower degree"),
        (
            ["contours.floor.closed=true"],
            "contours.floor.closed",
            "does not give the direction",
            "[true, false]",
        ),
        (["contours.rail.closed=false"], "contours.rail.closed", "false with 'circle'", "a circle is"),
        (["contours.floor.points="], "contours.floor", "no points of the ground", "points, file, spline"),
        (
            ["contours.skid.points="],
            "contours.skid",
            "no points of the rigid body",
            "points, file, circle, spline",
        ),
        (
            ["contours.skid.file=points.csv"],
            "contours.skid",
            "both 'points' and 'file'",
            "one of nodes, line",
        ),
        (
            ["contours.skid.points=", "contours.skid.nodes=points.csv"],
            "contours.skid.nodes",
            "'nodes' of the rigid body 'block'",
            "one of points, file, circle, spline",
        ),
        (
            ["contours.skid.points=", "contours.skid.file=points.csv"],
            "contours.skid.file",
            "3 points for degree 4",
            "at least 5",
        ),
        (
            ["contours.skid.points=", "contours.skid.file=words.csv"],
            "words.csv: line 2",
            "zero",
            "x,y,z in m",
        ),
        (
            ["contours.skid.points=", "contours.skid.file=none.csv"],
            "contours.skid.file",
            "does not exist",
            "a file",
        ),
        (
            ["contours.floor.points=", "contours.floor.file=points.csv"],
            "contours.floor.columns",
            "'file' without 'columns'",
            "rows of so many points",
        ),
        (
            ["contours.floor.points=", "contours.floor.file=points.csv", "contours.floor.columns=2"],
            "contours.floor.columns",
            "3 points in points.csv",
            "rows of 2 points",
        ),
        (
            ["contours.floor.points.1=[[1, 0, 0]]"],
            "contours.floor.points",
            "rows of 1 and of 4",
            "one length",
        ),
        (
            ["contours.skid.points.2=[-0.1, 0, 0]"],
            "contours.skid.points",
            "points 2 and 3 are both",
            "different",
        ),
        (
            [f"contours.floor.points={FOLDED}"],
            "contours.floor.points",
            "fold",
            "order",
        ),
        (["contours.cable.radius="], "contours.cable.radius", "is missing", "a value"),
        (["contours.cable.radius=0"], "contours.cable.radius", "0 is too small", "> 0 m"),
        (["contours.skid.width="], "contours.skid.width", "is missing", "a value"),
        (["contours.skid.normal="], "contours.skid", "neither 'across' nor 'normal'", "along the width"),
        (
            ["contours.skid.across=[0, 1, 0]"],
            "contours.skid",
            "both 'across' and 'normal'",
            "along the width",
        ),
        (["contours.skid.flip=true"], "contours.skid.flip", "'flip' with 'normal'", "the opposite"),
        (
            ["contours.skid.points.4=[0.2, 0, 0]", "contours.skid.normal=[1, 0, 0]"],
            "contours.skid.normal",
            "along the start of the curve",
            "across",
        ),
        (["contours.rail.radius=1"], "contours.rail.radius", "unknown key", "one of: body"),
        (["contours.cable.degree=3"], "contours.cable.degree", "of the frame 'rope'", "its own shape"),
        (["contours.cable.file=points.csv"], "contours.cable.file", "of the frame 'rope'", "its own shape"),
        (["contours.cable.body=plate"], "contours.cable.type", "'cylinder' of the shell", "'surface'"),
        (["contours.tray.body=rope"], "contours.tray.type", "'surface' of the frame", "'cylinder' or 'band'"),
        (
            ["contours.rail.circle=", f"contours.rail.spline={CURVE % '[0, 0, 0, 1, 1, 1]'}"],
            "contours.rail.spline.knots",
            "6 knots for 4 control points",
            "8",
        ),
        (
            ["contours.rail.circle=", f"contours.rail.spline={CURVE % '[0, 0, 0, 0, 1, 1, 1, 0.9]'}"],
            "contours.rail.spline.knots",
            "knot",
            "knots",
        ),
        (
            ["contours.rail.degree=3", "contours.rail.circle=", f"contours.rail.spline={CURVE % KNOTS}"],
            "contours.rail.degree",
            "'degree' with 'spline'",
            "of the spline",
        ),
        (
            [
                "contours.rail.circle=",
                f"contours.rail.spline={CURVE % KNOTS}",
                "contours.rail.spline.weights=[1]",
            ],
            "contours.rail.spline.weights",
            "1 weights for 4 control points",
            "one a control point",
        ),
        (
            ["simulate.integrator=thesis"],
            "simulate.integrator",
            "'thesis' with contacts",
            "'dele2' or 'auto'",
        ),
        (
            ["simulate.integrator=accurate", "simulate.step="],
            "simulate.integrator",
            "'accurate' with contacts",
            "'dele2' or 'auto'",
        ),
        (
            ["check.0.quantity=channel.landing.normal_froce.max"],
            "check.0.quantity",
            "did you mean 'normal_force'",
            "a channel of 'landing': gap",
        ),
    ],
)
def test_one_mistake_is_one_line_with_key_problem_and_expectation(
    contacts, overrides, key, problem, expected
):
    line = complaint(contacts, overrides)
    assert f"{key}: " in line
    assert problem in line.partition(f"{key}: ")[2].partition("; expected ")[0]
    assert expected in line.partition("; expected ")[2]


def test_contacts_with_the_ground_change_the_momentum(contacts):
    (contacts / "case.toml").write_text(
        (contacts / "case.toml")
        .read_text()
        .replace('[gravity]\nacceleration = [0, 0, "-9.81 m/s^2"]\n', "")
        .replace('"channel.landing.normal_force.max"', '"drift.momentum"')
        .replace('"10 N"', "1", 1)
    )
    line = complaint(contacts, [])
    assert "check.0.quantity: 'drift.momentum'" in line
    assert "contact 'landing'" in line
    assert "contact 'squeeze'" not in line
