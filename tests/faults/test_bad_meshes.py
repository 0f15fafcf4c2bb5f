"""Bad frames and shells: one clear error each, before anything runs."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.places import in_case
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.layout import pack_scene


@pytest.fixture
def meshes(tmp_path):
    folder = tmp_path / "meshes"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "pipeline" / "meshes.toml", folder / "case.toml")
    return folder


def complaint(folder, *overrides):
    """The one line of an error in reading the case or assembling its scene."""
    with pytest.raises(InputError) as caught:
        assemble_scene(load_case(folder, overrides), OutputFolder(folder / "out"))
    (line,) = str(caught.value).splitlines()
    return line


BEAM, PLATE = "bodies.beam", "bodies.plate"
QUADRILATERAL = f'{PLATE}.geometry={{type="quadrilateral", elements=[4, 2], corners=[%s]}}'
GRID = f'{PLATE}.geometry={{type="grid", elements=[2, 1], points=[%s]}}'
SPLINE = f'{BEAM}.geometry={{type="spline", elements=4, %s}}'
SPLINE_NODES = f'{BEAM}.geometry={{type="spline", points=[%s]}}'
TWICE = "[0, 0, 0], [0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 1, 0], [2, 1, 0]"
CABLE = f"{BEAM}.section={{density=1, young_modulus=1, %s}}"
UPRIGHT = "[0, 0, 0], [4, 0, 0], [4, 0, 2], [0, 0, 2]"
TILTED = "[0, 0, 0], [4, 0, 0], [4, 2, 1], [0, 2, 1]"


@pytest.mark.parametrize(
    ("override", "key", "problem", "expected"),
    [
        # geometry
        (f"{BEAM}.geometry.end=[0, 0, 0]", "geometry.end", "are both [0.0, 0.0, 0.0] m", "two different"),
        (f"{BEAM}.geometry.elements=0", "geometry.elements", "0 is too small", ">= 1"),
        (f"{BEAM}.geometry.elements=2.5", "geometry.elements", "2.5 is not an integer", "an integer"),
        (f"{BEAM}.geometry.type=circle", "geometry", "type = 'circle'", "'line', 'arc', 'spline'"),
        ("bodies.arch.geometry.radius=-1 m", "geometry.radius", "is too small", "> 0 m"),
        ("bodies.arch.geometry.to=0 deg", "geometry.to", "are both 0 rad", "two different angles"),
        ("bodies.arch.geometry.to=2 m", "geometry.to", "'2 m' is a length", "an angle"),
        ("bodies.arch.model=green-lagrange", "model", "with geometry 'arc'", "model 'exact'"),
        (SPLINE % "points=[[0, 0, 0]]", "geometry.points", "1 points", "two and more"),
        (SPLINE % 'file="line.csv"', "geometry.file", "'line.csv' does not exist", "in the case folder"),
        (SPLINE % "points=[]", "geometry", "neither 'points' nor 'file'", "one of them"),
        (f"{PLATE}.geometry.size=[4, -2]", "geometry.size.1", "-2 is too small", "> 0 m"),
        (f"{PLATE}.geometry.elements=[4]", "geometry.elements", "1 entries", "at least 2"),
        (QUADRILATERAL % "[0, 0, 0], [4, 0, 0], [0, 2, 0]", "geometry.corners", "3 entries", "at least 4"),
        (
            GRID % "[0, 0, 0], [1, 0, 0], [2, 0, 0]",
            "geometry.points",
            "3 points for 2 x 1 elements",
            "6, one",
        ),
        # elements without a length
        (SPLINE_NODES % "[0, 0, 0], [0, 0, 0], [1, 0, 0]", "geometry.points", "at one place", "a distance"),
        (GRID % TWICE, "geometry.points", "two neighbours are at one place", "a distance along x"),
        (
            QUADRILATERAL % "[0, 0, 0], [0, 0, 0], [4, 2, 0], [0, 2, 0]",
            "geometry.corners",
            "two neighbours are at one place",
            "a distance along x",
        ),
        # inverted: the third corner lies inside of the triangle of the others
        (
            QUADRILATERAL % "[0, 0, 0], [4, 0, 0], [1, 0.5, 0], [0, 2, 0]",
            "geometry",
            "inverted",
            "180 degrees",
        ),
        # sections
        (f"{BEAM}.section.diameter=-1", "section.diameter", "-1 is too small", "> 0 m"),
        (f"{BEAM}.section.side=1", "section", "both 'diameter' and 'side'", "one of 'diameter'"),
        (f"{BEAM}.section.diameter=", "section", "no shape", "'area' and 'second_moment'"),
        (f"{BEAM}.sections.tube.wall=0.6", "sections.tube.wall", "exceeds the radius", "0.5 m at most"),
        (CABLE % "area=1", "section.second_moment", "'area' without", "both"),
        (CABLE % "side=1, wall=0.1", "section.wall", "'wall' with 'side'", "with 'diameter'"),
        (CABLE % "area=1, second_moment='1 m^2'", "section.second_moment", "is an area", "[m^4]"),
        (
            f"{BEAM}.section.youngs_modulus=1",
            "section.youngs_modulus",
            "did you mean 'young_modulus'",
            "a key",
        ),
        (f"{PLATE}.section.thickness=-1 mm", "section.thickness", "'-1 mm' is too small", "> 0 m"),
        (f"{PLATE}.section.thickness=0", "section.thickness", "0 is too small", "> 0 m"),
        (f"{PLATE}.section.poisson_ratio=0.5", "section.poisson_ratio", "0.5 is too large", "< 0.5"),
        (f"{PLATE}.section.poisson_ratio=0.6", "section.poisson_ratio", "0.6 is too large", "< 0.5"),
        (f"{PLATE}.section.young_modulus=0", "section.young_modulus", "0 is too small", "> 0 Pa"),
        (f"{PLATE}.section.density=-1", "section.density", "-1 is too small", "> 0 kg/m^3"),
        (f"{PLATE}.sections.doubler.thickness=-1", "sections.doubler.thickness", "too small", "> 0 m"),
        (
            f"{PLATE}.regions.0.section=dubler",
            "regions.0.section",
            "did you mean 'doubler'",
            "one of: doubler",
        ),
        (f"{BEAM}.regions.0.elements=[1, 4]", "regions.0.elements.1", "no element 4", "from 0 to 3"),
        (f"{BEAM}.regions.0.elements=[1, 1]", "regions.0.elements", "occurs 2 times", "each element once"),
        (f"{BEAM}.regions.0.elements=[-1]", "regions.0.elements.0", "-1 is too small", ">= 0"),
        (f"{BEAM}.regions.0.elements=[]", "regions.0", "neither 'elements' nor 'box'", "one of them"),
        (f"{PLATE}.regions.0.box.from=[9, 9, 9]", "regions.0.box", "no element", "around elements"),
        (f"{BEAM}.axial_strain=1e-3", "axial_strain", "both 'axial_force' and 'axial_strain'", "one of them"),
        # supports
        (f"{BEAM}.supports.0.fix=hinged", "supports.0.fix", "'hinged'", "'pinned' or 'clamped'"),
        (f"{BEAM}.supports.0.at=middle", "supports.0.at", "'middle'", "'start' or 'end'"),
        (f"{BEAM}.supports.0.at=", "supports.0", "no place", "one of at, nodes, point, box"),
        (f"{BEAM}.supports.0.nodes=[1]", "supports.0", "both 'at' and 'nodes'", "one of"),
        (f"{BEAM}.supports.0.fix=", "supports.0", "neither 'fix' nor 'fixed'", "'fixed' (axes by vector)"),
        (f"{BEAM}.supports.1.fixed={{}}", "supports.1.fixed", "holds nothing", "axes of some vectors"),
        (f"{BEAM}.supports.1.fixed.position=yx", "supports.1.fixed.position", "'yx'", "text like ^x?y?z?$"),
        (
            f"{BEAM}.supports.1.fixed.slope_x=x",
            "supports.1.fixed.slope_x",
            "unknown key",
            "one of: position, tangent",
        ),
        (f"{BEAM}.supports.1.point=[9, 0, 0]", "supports.1.point", "the nearest one, 4", "place of a node"),
        (f'{BEAM}.supports=[{{nodes=[5], fix="pinned"}}]', "supports.0.nodes.0", "no node 5", "0 to 4"),
        (f"{PLATE}.supports.0.edge=z_min", "supports.0.edge", "'z_min'", "'x_min', 'x_max'"),
        (f"{PLATE}.supports.0.edge=[]", "supports.0.edge", "0 entries", "at least 1"),
        (f"{PLATE}.supports.1.corner=y_min x_max", "supports.1.corner", "'y_min x_max'", "'x_max y_min'"),
        (f"{PLATE}.supports.0.fix=welded", "supports.0.fix", "'welded'", "'pinned', 'hinged' or 'clamped'"),
        (f"{PLATE}.supports.1.fix=hinged", "supports.1.fix", "'hinged' with 'corner'", "only an edge"),
        (f"{PLATE}.supports.1.twist_free=true", "supports.1.twist_free", "without a clamped edge", "'edge'"),
        (
            f'{PLATE}.supports=[{{edge="x_min", fixed={{position="z"}}, sliding=true}}]',
            "supports.0.sliding",
            "with 'fixed'",
            "by vector alone",
        ),
        (
            f'{PLATE}.supports=[{{box={{from=[9, 9, 9], to=[10, 10, 10]}}, fix="pinned"}}]',
            "supports.0.box",
            "no node lies in it",
            "around nodes",
        ),
        # loads
        (f"{BEAM}.loads.0.force=['1 N', 0, 0]", "loads.0.force.0", "'1 N' is a force", "a force per length"),
        (f"{PLATE}.loads.0.force=['1 N/m', 0, 0]", "loads.0.force.0", "is a stiffness", "a pressure [Pa]"),
        (f"{BEAM}.loads.0.factors=[1]", "loads.0", "2 times and 1 factors", "one factor a time"),
        (f"{BEAM}.loads.0.times=[1, 0]", "loads.0", "times [1.0, 0.0]", "increasing times"),
        (f"{BEAM}.loads.0.elements=[4]", "loads.0.elements.0", "no element 4", "from 0 to 3"),
        (f"{BEAM}.loads.1.tangential=0", "loads.1", "neither 'normal' nor 'tangential'", "one of them"),
        (f"{BEAM}.loads.1.axis=[0, 0, 0]", "loads.1.axis", "length zero", "not all zero"),
        (f"{BEAM}.loads.2.at=", "loads.2", "neither 'at' nor 'node'", "one of them"),
        (f"{BEAM}.loads.2.node=3", "loads.2", "both 'at' and 'node'", "one of them"),
        (f"{BEAM}.loads.2.type=pressure", "loads.2", "type = 'pressure'", "'follower_force'"),
        (f"{PLATE}.loads.1.pressure=1 N", "loads.1.pressure", "'1 N' is a force", "a pressure"),
        # the rest
        (f"{BEAM}.damping.viscous=-1", "damping.viscous", "-1 is too small", ">= 0 1/s"),
        (f"{BEAM}.damping.stiffness=1 m", "damping.stiffness", "'1 m' is a length", "a time"),
        (f"{BEAM}.elasticity=implicit", "elasticity", "'implicit'", "'energy-momentum'"),
        (f"{BEAM}.drift_tolerance=0", "drift_tolerance", "0 is too small", "> 0"),
        (f"{PLATE}.gauss_points=2", "gauss_points", "2 is too small", ">= 3"),
        (f"{PLATE}.gauss_points=8", "gauss_points", "8", "less than or equal to 7"),
        (f"{BEAM}.gauss_points=5", "gauss_points", "unknown key", "one of: axial_force"),
        (f"{BEAM}.material.density=1", "material", "unknown key", "one of: axial_force"),
    ],
)
def test_one_mistake_is_one_line_with_key_problem_and_expectation(meshes, override, key, problem, expected):
    line = complaint(meshes, override)
    body = ".".join(override.split(".")[:2])
    assert f": {body}.{key}: " in line or f"{body}.{key} does not exist" in line
    assert problem in line
    assert expected in line.partition("; expected ")[2]


@pytest.mark.parametrize(
    ("override", "key"),
    [
        ("joints.0.points=[['7.5 m', '10 mm', 0], ['2 m', '0.5 m', 0]]", "joints.0.points.0"),
        ("joints.0.points=[['7.5 m', 0, 0], ['4.1 m', '0.5 m', 0]]", "joints.0.points.1"),
        ("sensors.0.point=['2 m', '1 m', '1 mm']", "sensors.0.point"),
        ("forces=[{name='push', body='arch', point=[0, 0, 0], force=[1, 0, 0]}]", "forces.0.point"),
    ],
)
def test_a_point_off_the_mesh(meshes, override, key):
    line = complaint(meshes, override)
    assert f"{meshes / 'case.toml'}: {key}: " in line
    assert " m from the axis" in line or " m away from the shell" in line
    assert "expected a point of " in line


@pytest.mark.parametrize(
    ("override", "key", "problem"),
    [
        (
            'type="hinge", points=[[5, 0, 0], [0, 10, 0]], axes=[[1, 1, 0], [1, 1, 0]]',
            "joints.0.axis",
            "45 deg",
        ),
        (
            'type="universal", at=[0, 10, 0], axis=[1, 0, 0], second_axis=[0, 1, 0]',
            "joints.0.axis",
            "on 'beam'",
        ),
        ('type="slider", at=[0, 10, 0], axis=[1, 0, 0]', "joints.0.axis", "with tangent [1.0, 0.0, 0.0]"),
        ('type="hinge", at=[0, 10, 0], axis=[1, 0, 0], friction=1', "joints.0.friction", "has no angle"),
    ],
)
def test_what_a_frame_cannot_carry(meshes, override, key, problem):
    """It has no torsion: joints that need a direction across its tangent are refused by their names."""
    case = load_case(meshes, [f'joints=[{{name="j", between=["beam", "ground"], {override}}}]'])
    scene = assemble_scene(case, OutputFolder(meshes / "out"))
    with pytest.raises(InputError) as caught, in_case(case):
        pack_scene(scene, "dele2")
    (line,) = str(caught.value).splitlines()
    assert f": {key}: " in line
    assert problem in line
    assert "a small rigid body between" in line.partition("; expected ")[2]


def test_a_pulley_on_a_frame_has_its_axis_along_it(meshes):
    ends = '{body="ground", point=[0, 0, 9]}, {body="ground", point=[5, 5, 9]}'
    first, last = ends.split("}, ")
    stop = '{body="beam", point=[5, 0, 0], radius=0.1, axis=[%s]}'
    rope = (
        'ropes=[{type="wire", name="rope", axial_stiffness=1e5, path=[' + f"{first}}}, {stop}, {last}" + "]}]"
    )
    line = complaint(meshes, rope % "0, 0, 1")
    assert ": ropes.0.path.1.axis: the axis of a pulley on the frame 'beam' is not along its tangent" in line
    assert "expected an axis along the tangent, or a pulley on a small rigid body" in line
    case = load_case(meshes, [rope % "-2, 0, 0"])
    assert len(assemble_scene(case, OutputFolder(meshes / "out")).ropes) == 1


@pytest.mark.parametrize(("corners", "good"), [(UPRIGHT, True), (TILTED, False)])
def test_supports_by_name_need_a_plane_across_an_axis(meshes, corners, good):
    changes = [
        QUADRILATERAL % corners,
        f"{PLATE}.regions=",
        f"{PLATE}.loads=",
        "joints=",
        "sensors=",
        f'{PLATE}.supports=[{{edge="all", fix="hinged", sliding=true}}]',
    ]
    if good:
        scene = assemble_scene(load_case(meshes, changes), OutputFolder(meshes / "out"))
        plate = next(body for body in scene.bodies if body.name == "plate")
        assert {axes for support in plate.supports for axes in support.fixed.values()} == {"y"}
        return
    line = complaint(meshes, *changes)
    assert ": bodies.plate.supports.0.fix: the normal of the mesh" in line
    assert "expected a mesh in the x-y plane that 'initial.orientation' turns, or 'fixed'" in line


@pytest.mark.parametrize(
    ("override", "key", "problem", "expected"),
    [
        ("simulate.start=check", "simulate.duration", "nothing to compute", "start 'equilibrium'"),
        ("simulate.duration=-1 s", "simulate.duration", "'-1 s' is too small", ">= 0 s"),
        ("simulate.duration=1 s", "simulate.output_interval", "is missing", "a value"),
        (
            'check=[{id="a", quantity="mesh.plate.mass", reference=1, tolerance={relative=0.1}, source="b"}]',
            "check.0.quantity",
            "'plate' is a shell",
            "a quantity that the case has",
        ),
        (
            'reference=[{name="a", channel="plate.position", file="case.toml"}]',
            "reference.0.channel",
            "has columns for every node or element",
            "a sensor on the body",
        ),
        (
            'check=[{id="a", quantity="channel.beam.von_mises.end", reference=1, tolerance={absolute=1}, source="b"}]',
            "check.0.quantity",
            "is unknown",
            "axial_stress",
        ),
    ],
)
def test_what_a_case_of_meshes_asks_for(meshes, override, key, problem, expected):
    line = complaint(meshes, override)
    assert f": {key}: " in line
    assert problem in line
    assert expected in line.partition("; expected ")[2]
