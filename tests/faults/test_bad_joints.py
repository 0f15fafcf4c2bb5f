"""Bad joints, ropes, springs, motors and reference histories: one clear error each, before anything runs."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder


@pytest.fixture
def linkage(tmp_path):
    folder = tmp_path / "linkage"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "pipeline" / "linkage.toml", folder / "case.toml")
    return folder


def complaint(folder, *overrides):
    """The one line of an error in reading the case or assembling its scene."""
    with pytest.raises(InputError) as caught:
        assemble_scene(load_case(folder, overrides), OutputFolder(folder / "out"))
    (line,) = str(caught.value).splitlines()
    return line


UNIVERSAL = (
    'joints.2={type="universal", name="stay", between=["arm", "trolley"], at=[0, 0, 0], axis=[0, 0, 1]'
)
AXES = 'joints.2={type="%s", name="stay", between=["trolley", "load"], at=[0, 0, 0], axes=[[0, 0, 1], [%s]]}'
SPRING = (
    'forces.1={type="spring", name="buffer", between=["ground", "trolley"], points=[[0, 0, 0], [0, 0, 0]]'
)


@pytest.mark.parametrize(
    ("override", "key", "problem", "expected"),
    [
        (
            'joints.0.between=["arm", "arm"]',
            "joints.0.between",
            "both sides are 'arm'",
            "two different bodies",
        ),
        (
            'joints.0.between=["ground", "ground"]',
            "joints.0.between",
            "both sides are the ground",
            "one body",
        ),
        ('joints.0.between=["ground", "amr"]', "joints.0.between.1", "did you mean 'arm'", "one of: arm"),
        ('joints.0.between=["ground"]', "joints.0.between", "1 entries", "at least 2"),
        ("joints.0.axis=[0, 0, 0]", "joints.0.axis", "length zero", "not all zero"),
        ("joints.0.axis=", "joints.0", "neither 'axis' nor 'axes'", "a direction in the world"),
        ("joints.0.axes=[[0, 0, 1], [0, 0, 1]]", "joints.0", "both 'axis' and 'axes'", "'axis' (a direction"),
        ("joints.0.reference=[0, 0, 1]", "joints.0.reference", "parallel to the axis", "across the axis"),
        ("joints.0.at=", "joints.0", "neither 'at' nor 'points'", "a point in the world"),
        ("joints.0.points=[[0, 0, 0], [0, 0, 0]]", "joints.0", "both 'at' and 'points'", "one a side"),
        ("joints.0.type=hing", "joints.0", "type = 'hing'", "'hinge'"),
        ("joints.0.type=", "joints.0", "key 'type' is missing", "one of 'ball', 'cylindrical'"),
        (
            "bodies.load.type=",
            "bodies.load",
            "key 'type' is missing",
            "'flexible', 'rigid', 'frame', 'rod', 'shell'",
        ),
        ("bodies.load.frame={}", "bodies.load.frame", "key 'motion' is missing", "'free', 'fixed', 'driven'"),
        ("bodies.load.inertia=[1, 2, '3 m']", "bodies.load.inertia.2", "'3 m' is a length", "[kg m^2]"),
        (
            "bodies.load.inertia=[[1, 0, 0], [0, 1, 's'], [0, 0, 1]]",
            "bodies.load.inertia.1.2",
            "'s' is not a number",
            "[kg m^2]",
        ),
        ("forces.2.loads=['-5 N m', 3, '1 kg']", "forces.2.loads.2", "'1 kg' is a mass", "[N m]"),
        ("joints.0.limits.upper=-40 deg", "joints.0.limits", "is not below upper", "lower < upper"),
        ("joints.0.limits.upper=1 m", "joints.0.limits.upper", "'1 m' is a length", "an angle [rad]"),
        ("joints.1.limits.upper=1 rad", "joints.1.limits.upper", "'1 rad' is an angle", "a length [m]"),
        ("joints.1.limits.upper=", "joints.1.limits", "neither 'lower' nor 'upper'", "one of them"),
        ("joints.0.limits.stiffness=1 N/m", "joints.0.limits.stiffness", "is a stiffness", "[N m/rad]"),
        ("joints.1.limits.stiffness=-1", "joints.1.limits.stiffness", "-1 is too small", "> 0 N/m"),
        ("joints.0.friction=10 N", "joints.0.friction", "'10 N' is a force", "[N m]"),
        ("joints.0.compliance=-1", "joints.0.compliance", "-1 is too small", ">= 0 m/N"),
        ("joints.0.compliance=1 N/m", "joints.0.compliance", "is a stiffness", "a compliance [m/N]"),
        ("joints.1.drive.values=[0, '1 deg']", "joints.1.drive.values.1", "is an angle", "a length"),
        ("joints.2.name=foot", "joints.2.name", "'foot' occurs 2 times", "one body, joint, rope"),
        ("joints.2.name=arm", "joints.2.name", "'arm' occurs 2 times", "a name"),
        ("joints.2.name=ground", "joints.2.name", "is the name of the world", "another name"),
        ("sensors.0.name=monitor", "sensors.0.name", "channel of the whole scene", "another name"),
        (
            f"{UNIVERSAL}, second_axis=[0, 0, -3]}}",
            "joints.2.second_axis",
            "[0, 0, -3] is parallel to axis = [0, 0, 1]",
            "perpendicular",
        ),
        (f"{UNIVERSAL}}}", "joints.2", "'axis' without 'second_axis'", "the axis of b"),
        (AXES % ("universal", "0, 0, 1"), "joints.2.axes", "are parallel", "perpendicular to each other"),
        (AXES % ("hinge", "1, 0, 0"), "joints.2.axes", "perpendicular to each other", "axes that agree"),
        ("joints.2.at=[0, 0, 0]", "joints.2.at", "unknown key", "points"),
        ("joints.2.length=0", "joints.2.length", "0 is too small", "> 0 m"),
        ("joints.2.points=[[0, 0, 0], [0, 0, '9 m']]", "joints.2.points", "coincide", "a ball joint"),
        ("bodies.arm.inertia=[1, 1, 3]", "bodies.arm.inertia", "exceeds the sum of the others", "can exist"),
        ("forces.2.joint=foo", "forces.2.joint", "'foo' does not exist; did you mean 'foot'", "one of"),
        ("forces.3.load=20 N m", "forces.3.load", "is a moment or energy", "a force [N]"),
        ("forces.3.times=[0, 1]", "forces.3", "not exactly one of 'load' and a table", "'times' and 'loads'"),
        ("forces.2.stiffness=1", "forces.2", "both 'stiffness' and a table", "'stiffness', or"),
        ("forces.2.deflections=[1, -1]", "forces.2.deflections", "deflections [1.0, -1.0]", "increasing"),
        ("forces.1.stiffness=-2", "forces.1.stiffness", "-2 is too small", ">= 0 N/m"),
        (f"{SPRING}}}", "forces.1", "neither a stiffness nor a damping", "'stiffness', 'damping'"),
        (f"{SPRING}, elongations=[0], forces=[0]}}", "forces.1", "a table of 1 rows", "2 or more"),
        (
            "forces.1.type=spirng",
            "forces.1",
            "type = 'spirng'",
            "'joint_spring', 'line_bearing', 'motor', 'point', 'spring'",
        ),
        ("forces.0.force=[1, 2]", "forces.0.force", "2 entries", "at least 3"),
        ("forces.0.pint=[1, 2, 3]", "forces.0.pint", "does not exist; did you mean 'point'", "a key"),
        ("ropes.0.path=[{body='load', point=[0, 0, 0]}]", "ropes.0.path", "1 entries", "at least 2"),
        ("ropes.0.path.2.body=laod", "ropes.0.path.2.body", "did you mean 'load'", "one of: arm"),
        ("ropes.0.path.1.axis=", "ropes.0.path.1.axis", "a pulley without 'axis'", "the direction"),
        ("ropes.0.path.1.radius=-1", "ropes.0.path.1.radius", "-1 is too small", ">= 0 m"),
        ("ropes.0.path.2.radius=1", "ropes.0.path.2.axis", "a pulley without 'axis'", "the direction"),
        (
            "ropes.0.path.2={body='load', point=[0, 0, 0], radius=1, axis=[1, 0, 0]}",
            "ropes.0.path.2.radius",
            "a pulley at an end",
            "ends without",
        ),
        ("ropes.1.path.1.body=ground", "ropes.1.path", "on the ground", "a point on a body"),
        ("ropes.0.axial_stiffness=0", "ropes.0.axial_stiffness", "0 is too small", "> 0 N"),
        ("ropes.1.stiffness=-1 kN/m", "ropes.1.stiffness", "is too small", "> 0 N/m"),
        ("ropes.0.winch.speeds=[0]", "ropes.0.winch.speeds", "2 times and 1 speeds", "one of speeds"),
        (
            "ropes.0.type=chain",
            "ropes.0",
            "type = 'chain'",
            "one of 'equalized', 'maxwell', 'spring', 'wire'",
        ),
        ("ropes.0.length=0", "ropes.0.length", "0 is too small", "> 0 m"),
        # from (0, 0, 0) over (0, 0.5, 1) to (0, 0, -8) is 1.118 + 9.014 m, less 2 x 0.2 m for the pulley
        (
            "ropes.0.length=6 m",
            "ropes.0.length",
            "at least 9.73191 m by 3.73191 m, a strain of 62.2 %",
            "none",
        ),
    ],
)
def test_one_mistake_is_one_line_with_key_problem_and_expectation(linkage, override, key, problem, expected):
    line = complaint(linkage, override)
    assert f": {key}: " in line or f"{key} does not exist" in line
    assert problem in line
    assert expected in line.partition("; expected ")[2]


@pytest.mark.parametrize("kind", ["ball", "cylindrical"])
def test_a_motor_needs_one_angle_or_one_travel(linkage, kind):
    axis = "" if kind == "ball" else ", axis=[0, 0, 1]"
    joint = f'joints.1={{type="{kind}", name="rail", between=["arm", "trolley"], at=[0, 0, 0]{axis}}}'
    line = complaint(linkage, joint)
    if kind == "cylindrical":
        assert "forces.3.load: joint 'rail' has an angle and a travel; expected 'coordinate'" in line
    else:
        assert f"forces.3.joint: joint 'rail' of type '{kind}' has neither an angle nor a travel" in line


@pytest.mark.parametrize(
    ("stop", "key", "problem"),
    [
        ("body='load', radius=-1", "radius", "-1 is too small"),
        ("body='load', radius=1", "axis", "a pulley without 'axis'"),
        ("body='load', raduis=1", "raduis", "unknown key; did you mean 'radius'?"),
        ("body='laod'", "body", "body 'laod' does not exist"),
    ],
)
def test_a_key_of_a_table_in_lists_of_tables_is_named(linkage, stop, key, problem):
    ends = "{body='ground', point=[0, 0, 9]}", "{body='load', point=[0, 0, 0]}"
    path = f"{ends[0]}, {{point=[0, 0, 1], {stop}}}, {ends[1]}"
    line = complaint(linkage, f"repeat=[{{count=1, ropes=[{{name='r', axial_stiffness=1, path=[{path}]}}]}}]")
    assert f"repeat.0.ropes.0.path.1.{key}: {problem}" in line


@pytest.mark.parametrize("key", ["stiffness", "damping"])
@pytest.mark.parametrize("number", [1, 2])
def test_a_spring_that_is_said_to_be_nothing_is_taken(linkage, number, key):
    """The first run of a sweep."""
    clear = [f"forces.{number}.{name}=" for name in ("deflections", "loads")] if number == 2 else []
    other = f"forces.{number}.{'damping' if key == 'stiffness' else 'stiffness'}="
    case = load_case(linkage, [*clear, other, f"forces.{number}.{key}=0"])
    assemble_scene(case, OutputFolder(linkage / "out"))


def test_a_rope_within_its_strain_is_taken(linkage):
    load_case(linkage, ["ropes.0.length=9.6 m"])
    assemble_scene(load_case(linkage, ["ropes.0.length=9.6 m"]), OutputFolder(linkage / "out"))


HISTORY = "time,x,z\n0,0,0\n0.5,0,1\n1,0,2\n"


@pytest.mark.parametrize(
    ("changes", "key", "problem", "expected"),
    [
        ({"channel": "hook.positon"}, "channel", "did you mean 'position'", "position, velocity"),
        ({"channel": "hok.position"}, "channel", "'hok', which does not exist", "one of"),
        ({"channel": "foot.travel"}, "channel", "'foot.travel' is unknown", "angle"),
        ({"channel": "hook"}, "channel", "'hook' is no channel", "OWNER.CHANNEL"),
        ({"file": "history.txt"}, "file", "'history.txt' does not exist", "a file in the case folder"),
        ({"scale": "1 s"}, "scale", "'1 s' is a time", "a length"),
        ({"scale": 0}, "scale", "0 is too small", "> 0 m"),
        ({"text": HISTORY.replace("time", "t")}, "file", "header 't,x,z'", "time,x,y,z"),
        ({"text": HISTORY.replace("x,z", "x,w")}, "file", "header 'time,x,w'", "time,x,y,z"),
        ({"text": HISTORY.replace("1,0,2", "1,0")}, "file", "line 4: '1,0'", "3 finite numbers"),
        ({"text": HISTORY.replace("1,0,2", "1,0,nan")}, "file", "line 4", "3 finite numbers"),
        ({"text": HISTORY.replace("0.5", "2")}, "file", "do not increase", "increasing times"),
        ({"text": HISTORY + "2,0,0\n"}, "file", "ends at 2 s, the simulation at 1 s", "same duration"),
        ({"until": "500 ms"}, "file", "ends at 1 s, but 'until' is 0.5 s", "'until' for that of a part"),
        ({"until": "2 s"}, "until", "2 s, the simulation ends at 1 s", "within the simulation"),
        (
            {"text": HISTORY.replace("0.5", "0.505")},
            "file",
            "t = 0.505 s, which is not recorded",
            "multiples",
        ),
    ],
)
def test_a_reference_history_that_does_not_fit(linkage, changes, key, problem, expected):
    (linkage / "history.csv").write_text(changes.pop("text", HISTORY))
    entry = {"name": "hook", "channel": "hook.position", "file": "history.csv"} | changes
    inner = ", ".join(f"{k}={v!r}" if isinstance(v, str) else f"{k}={v}" for k, v in entry.items())
    line = complaint(linkage, f"reference=[{{{inner}}}]")
    assert f": reference.0.{key}: " in line
    assert problem in line
    assert expected in line.partition("; expected ")[2]


@pytest.mark.parametrize(
    ("quantity", "problem"),
    [
        ("deviation.tip", "'deviation.tip' is unknown"),
        ("channel.foot.travel.end", "'channel.foot.travel.end' is unknown"),
        ("channel.rail.angle.end", "is unknown"),
        ("channel.load.reaction_force.z.end", "is unknown"),  # nothing holds its frame
        ("channel.push.load.end", "is unknown"),
        ("channel.monitor.violations.max", "did you mean 'monitor.violation'"),
    ],
)
def test_a_check_of_what_is_not_recorded(linkage, quantity, problem):
    check = f'check=[{{id="a", quantity="{quantity}", reference=1, tolerance={{relative=0.1}}, source="b"}}]'
    line = complaint(linkage, check)
    assert ": check.0.quantity: " in line
    assert problem in line


@pytest.mark.parametrize(
    ("override", "key", "problem"),
    [
        ("simulate.tolerance=1e-5", "simulate", "both 'step' and 'tolerance'"),
        ("simulate.step=", "simulate", "neither 'step' nor 'tolerance'"),
        ("simulate.integrator=accurate", "simulate.step", "a fixed step with integrator 'accurate'"),
        ("simulate.tolerance=1 s", "simulate.tolerance", "'1 s' is a time"),
        ("simulate.start=proj", "simulate.start", "'proj'"),
    ],
)
def test_time_integration_that_does_not_fit(linkage, override, key, problem):
    line = complaint(linkage, override)
    assert f": {key}: " in line
    assert problem in line


def test_a_tolerance_for_the_published_integrator(linkage):
    line = complaint(linkage, "simulate.integrator=thesis", "simulate.tolerance=1e-5", "simulate.step=")
    assert "simulate.tolerance: a tolerance with integrator 'thesis'" in line
    assert "simulate.step: integrator 'thesis' without 'step'" in complaint(
        linkage, "simulate.integrator=thesis", "simulate.step="
    )


def test_outer_loads_and_joints_to_the_ground_change_the_momentum(linkage):
    check = 'check=[{id="a", quantity="drift.momentum", reference=0, tolerance={absolute=0.1}, source="b"}]'
    line = complaint(linkage, check)
    for cause in ("force 'push'", "force 'buffer'", "joint 'foot'", "rope 'fall'", "gravity"):
        assert cause in line
    for inner in ("detent", "puller", "rail"):
        assert inner not in line
