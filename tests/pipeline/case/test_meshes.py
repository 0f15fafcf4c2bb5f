"""Frames and shells of case files arrive in the solver as they were meant, and in the results as they were drawn."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.case.schema import case_schema
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.report.document import Document, to_markdown
from heavylift.pipeline.report.meshes import mesh_sections
from heavylift.pipeline.results.histories import ChannelInfo, Results
from heavylift.pipeline.results.mesh_results import mesh_shape, read_meshes, save_meshes
from heavylift.pipeline.results.provenance import simulate_digest
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.scene.meshes import DistributedLoad, FollowerLoad


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "meshes"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "meshes.toml", folder / "case.toml")
    return folder


def bodies(folder, *overrides):
    """Bodies of the scene by name."""
    case = load_case(folder, overrides)
    return {body.name: body for body in assemble_scene(case, OutputFolder(folder / "out")).bodies}


ALONE = ("joints=", "sensors=")


def test_sections_by_measures_are_those_of_mechanics(folder):
    solid, tube = bodies(folder)["beam"].sections
    assert (solid.area, solid.second_moment) == pytest.approx((math.pi / 4, math.pi / 64))
    # a tube is the difference of two circles, 1 m and 0.8 m across
    assert tube.area == pytest.approx(math.pi * (1.0 - 0.64) / 4)
    assert tube.second_moment == pytest.approx(math.pi * (1.0 - 0.8**4) / 64)
    assert (solid.outer_fibre, tube.outer_fibre) == (0.5, 0.5)
    square = bodies(folder, "bodies.beam.section.diameter=", "bodies.beam.section.side=2 m")["beam"]
    assert (square.sections[0].area, square.sections[0].second_moment) == pytest.approx((4.0, 16.0 / 12.0))


def test_a_pre_tension_is_the_same_force_in_every_section(folder):
    beam = bodies(folder)["beam"]
    np.testing.assert_array_equal(beam.element_sections, [0, 1, 1, 0])
    chosen = [beam.sections[number] for number in beam.element_sections]
    stiffness = np.array([section.youngs_modulus * section.area for section in chosen])
    np.testing.assert_allclose(stiffness * beam.axial_strains, 1e6)


def test_a_region_has_its_own_pre_strain(folder):
    region = (
        "{elements=[0, 3], axial_strain=-1e-4}, {box={from=[7, -1, -1], to=[11, 1, 1]}, axial_strain=2e-4}"
    )
    changed = f"bodies.beam.regions=[{region}]"
    beam = bodies(folder, changed)["beam"]
    stiffness = beam.sections[0].youngs_modulus * beam.sections[0].area
    np.testing.assert_allclose(beam.axial_strains, [-1e-4, 1e6 / stiffness, 1e6 / stiffness, 2e-4])
    np.testing.assert_array_equal(beam.element_sections, 0)
    slack = bodies(folder, changed, "bodies.beam.axial_force=")["beam"]
    np.testing.assert_allclose(slack.axial_strains, [-1e-4, 0.0, 0.0, 2e-4])
    with pytest.raises(
        InputError, match="neither 'section' nor 'axial_strain'; expected one of them, or both"
    ):
        bodies(folder, "bodies.beam.regions=[{elements=[0]}]")
    with pytest.raises(InputError, match="axial_strain: unknown key"):
        bodies(folder, "bodies.plate.regions.0.axial_strain=1e-4")


def test_an_arch_lies_on_its_circle(folder):
    arch = bodies(folder)["arch"]
    np.testing.assert_allclose(np.linalg.norm(arch.nodes, axis=1), 2.0)
    np.testing.assert_allclose(arch.nodes[[0, 3, 6]], [[2, 0, 0], [0, 0, 2], [-2, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(np.einsum("ij,ij->i", arch.nodes, arch.tangents), 0.0, atol=1e-15)
    np.testing.assert_allclose(arch.tangents[0], [0, 0, 1], atol=1e-15)


def test_regions_of_a_shell_are_where_their_box_is(folder):
    plate = bodies(folder)["plate"]
    centres = plate.nodes[plate.elements].mean(axis=1)
    doubled = (centres[:, 0] < 2.0) & (centres[:, 1] < 1.0)
    assert doubled.sum() == 2
    np.testing.assert_array_equal(plate.element_sections, doubled)
    assert plate.sections[1].thickness == 0.04


def test_loads_arrive_with_their_tables_and_directions(folder):
    scene = bodies(folder)
    spread, along, tip = scene["beam"].loads
    assert isinstance(spread, DistributedLoad)
    np.testing.assert_array_equal(spread.load, [0, 0, -1000])
    np.testing.assert_array_equal(spread.elements, [0, 1])
    np.testing.assert_array_equal([spread.times, spread.factors], [[0, 1], [0, 1]])
    assert isinstance(along, FollowerLoad)
    assert (along.normal, along.tangential, along.node, along.elements) == (0.0, 10.0, None, None)
    assert (tip.normal, tip.node) == (5.0, 4)
    pressure = scene["plate"].loads[1]
    assert (pressure.normal, list(pressure.elements)) == (1000.0, [7])


def held(folder, support, *more, body="plate"):
    """Coordinates that one support holds, as a set of (node, vector, axis)."""
    name = f"bodies.{body}.supports"
    made = bodies(folder, *ALONE, *more, f"{name}=[{support}]")[body]
    shape = mesh_shape(made)
    vectors = ("position", "slope_x", "slope_y", "twist") if body == "plate" else ("position", "tangent")
    places = [tuple(np.round(node, 9)) for node in shape.nodes]
    return {(places[node], vectors[vector], "xyz"[axis]) for node, vector, axis in np.argwhere(shape.fixed)}


# what the edge y = 0 of the plate, along x, holds: the slope along it is r_x, that across r_y
EDGE = {
    "pinned": {"position": "xyz"},
    "hinged": {"position": "xyz", "slope_x": "xyz"},
    "clamped": {"position": "xyz", "slope_x": "xyz", "slope_y": "z", "twist": "z"},
    "pinned sliding": {"position": "z"},
    "hinged sliding": {"position": "z", "slope_x": "z"},
    "clamped sliding": {"position": "z", "slope_x": "z", "slope_y": "z", "twist": "z"},
    "clamped twist_free": {"position": "xyz", "slope_x": "xyz", "slope_y": "z"},
    "clamped sliding twist_free": {"position": "z", "slope_x": "z", "slope_y": "z"},
}


@pytest.mark.parametrize("kind", EDGE)
def test_an_edge_holds_what_its_kind_says(folder, kind):
    fix, *flags = kind.split()
    words = ", ".join([f'edge="y_min", fix="{fix}"', *(f"{flag}=true" for flag in flags)])
    expected = {
        ((x, 0.0, 0.0), vector, axis)
        for x in (0.0, 1.0, 2.0, 3.0, 4.0)
        for vector, axes in EDGE[kind].items()
        for axis in axes
    }
    assert held(folder, f"{{{words}}}") == expected


def test_edges_along_y_change_the_two_slopes(folder):
    along_x = held(folder, '{edge="y_max", fix="hinged"}')
    along_y = held(folder, '{edge="x_max", fix="hinged"}')
    assert {(node[1], vector) for node, vector, _ in along_x} == {(2.0, "position"), (2.0, "slope_x")}
    assert {(node[0], vector) for node, vector, _ in along_y} == {(4.0, "position"), (4.0, "slope_y")}
    both = held(folder, '{edge=["x_max", "y_max"], fix="hinged"}')
    assert both == along_x | along_y
    assert len({node for node, _, _ in held(folder, '{edge="all", fix="pinned"}')}) == 12


@pytest.mark.parametrize(
    ("place", "points"),
    [
        ('corner="x_max y_min"', {(4.0, 0.0, 0.0)}),
        ('corner="all"', {(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (4.0, 2.0, 0.0), (0.0, 2.0, 0.0)}),
        ("point=['2 m', '1 m', 0]", {(2.0, 1.0, 0.0)}),
        ("box={from=[1, 0, 0], to=['2 m', '1 m', 0]}", {(x, y, 0.0) for x in (1.0, 2.0) for y in (0.0, 1.0)}),
    ],
)
def test_nodes_of_a_shell_are_held_where_they_are(folder, place, points):
    pinned = held(folder, f'{{{place}, fix="pinned"}}')
    assert pinned == {(point, "position", axis) for point in points for axis in "xyz"}
    assert held(folder, f'{{{place}, fixed={{twist="y"}}}}') == {(point, "twist", "y") for point in points}


@pytest.mark.parametrize(
    ("support", "count"),
    [
        ('{at="start", fix="pinned"}', 3),
        ('{at=["start", "end"], fix="clamped"}', 12),
        ('{nodes=[2], fixed={tangent="yz"}}', 2),
    ],
)
def test_supports_of_a_frame(folder, support, count):
    assert len(held(folder, support, body="beam")) == count


def test_a_standing_quadrilateral_is_held_across_its_own_plane(folder):
    corners = "[0, 0, 0], [4, 0, 0], [4, 0, 2], [0, 0, 2]"
    change = f'bodies.plate.geometry={{type="quadrilateral", elements=[4, 2], corners=[{corners}]}}'
    drop = "bodies.plate.regions="
    found = held(folder, '{edge="y_min", fix="clamped", sliding=true}', change, drop)
    assert {axis for _, _, axis in found} == {"y"}
    assert len(found) == 5 * 4


def test_a_grid_of_points_is_the_rectangle_it_was_taken_from(folder):
    plain = bodies(folder)["plate"]
    rows = "\n".join(f"{x},{y},0  # node" for y in (0, 1, 2) for x in (0, 1, 2, 3, 4))
    (folder / "grid.csv").write_text("# x, y, z\n" + rows + "\n")
    change = 'bodies.plate.geometry={type="grid", file="grid.csv", elements=[4, 2]}'
    grid = bodies(folder, change)["plate"]
    for key in ("nodes", "slopes", "elements", "lengths"):
        np.testing.assert_allclose(getattr(grid, key), getattr(plain, key), atol=1e-14)
    before = simulate_digest(load_case(folder, [change]))
    (folder / "grid.csv").write_text(rows.replace("# node", ""))
    assert simulate_digest(load_case(folder, [change])) != before  # a changed file makes results stale
    (folder / "grid.csv").write_text(rows.replace("4,2,0", "4,2"))
    with pytest.raises(InputError, match=r"grid.csv: line 15: '4,2  # node'; expected x,y,z"):
        bodies(folder, change)
    (folder / "grid.csv").write_text(rows + "\n5,5,0\n")
    with pytest.raises(
        InputError, match=r"geometry.file: 16 points for 4 x 2 elements; expected 15, one more"
    ):
        bodies(folder, change)


def test_the_body_goes_where_its_initial_state_says(folder):
    shape = mesh_shape(bodies(folder)["beam"])
    # turned by 90 degrees about z and moved by 5 m along y
    np.testing.assert_allclose(shape.world_nodes()[-1], [0, 15, 0], atol=1e-14)
    moved = bodies(folder, "bodies.beam.initial.angular_velocity=[0, 0, '2 rad/s']")["beam"]
    np.testing.assert_array_equal(moved.angular_velocity, [0, 0, 2])


def test_places_of_joints_on_meshes(folder):
    scene = assemble_scene(load_case(folder), OutputFolder(folder / "out"))
    (pin,) = scene.joints
    np.testing.assert_allclose(pin.frame_a.point, [7.5, 0, 0])
    np.testing.assert_allclose(pin.frame_b.point, [2.0, 0.5, 0])
    # given in the world: where the beam is at the start
    change = 'joints=[{type="ball", name="pin", between=["ground", "beam"], at=[0, "12.5 m", 0]}]'
    scene = assemble_scene(load_case(folder, [change]), OutputFolder(folder / "out"))
    np.testing.assert_allclose(scene.joints[0].frame_b.point, [7.5, 0, 0], atol=1e-14)


def test_elements_are_refined_by_an_override(folder):
    fine = bodies(folder, "bodies.beam.geometry.elements=9", "bodies.beam.regions=", *ALONE)["beam"]
    assert len(fine.elements) == 9
    square = bodies(
        folder, "bodies.plate.geometry.elements=3", "bodies.plate.loads=", "bodies.plate.regions=", *ALONE
    )["plate"]
    assert len(square.elements) == 9
    points = "points=[[0, 0, 0], [1, 1, 0], [2, 1, 0], [3, 0, 0]]"
    exact = (*ALONE, "bodies.arch.model=exact")
    curve = bodies(folder, f'bodies.arch.geometry={{type="spline", {points}}}', *exact)["arch"]
    np.testing.assert_allclose(curve.nodes[1], [1, 1, 0], atol=1e-15)
    finer = bodies(folder, f'bodies.arch.geometry={{type="spline", {points}, elements=8}}', *exact)["arch"]
    assert len(finer.elements) == 8


def test_a_written_mesh_is_read_back(folder, tmp_path):
    shapes = [mesh_shape(body) for body in bodies(folder).values()]
    save_meshes(tmp_path / "meshes.h5", shapes)
    with h5py.File(tmp_path / "meshes.h5") as file:
        found = read_meshes(file)
    assert sorted(found) == ["arch", "beam", "plate"]
    for shape in shapes:
        other = found[shape.name]
        assert (other.type, other.model, other.elasticity) == (shape.type, shape.model, shape.elasticity)
        for key in ("nodes", "elements", "vectors", "lengths", "sections", "element_sections", "fixed"):
            np.testing.assert_array_equal(getattr(other, key), getattr(shape, key))
    # lengths: of the arch a sixth of its half circle, but for the cubic that stands for the arc
    np.testing.assert_allclose(found["arch"].lengths[:, 0], math.pi * 2.0 / 6.0, rtol=1e-3)
    np.testing.assert_allclose(found["plate"].section("thickness").min(), 0.02)
    save_meshes(tmp_path / "meshes.h5", [])
    assert not (tmp_path / "meshes.h5").exists()


@pytest.fixture
def swung(folder, tmp_path):
    """Results of a beam whose end went up by 1 m at 1 s and back by half at 2 s."""
    beam = mesh_shape(bodies(folder)["beam"])
    save_meshes(tmp_path / "meshes.h5", [beam])
    positions = np.repeat(beam.world_nodes()[np.newaxis], 3, axis=0)
    positions[1:, -1, 2] += [1.0, 0.5]
    parts = tuple(f"{node}.{axis}" for node in range(5) for axis in "xyz")
    stress = np.array([[0.0, 0.0, 0.0, 0.0], [1e6, 2e6, 3e6, 4e6], [-5e6, 0.0, 0.0, 0.0]])
    channels = {
        "beam.position": ChannelInfo("beam.position", "m", parts, 0),
        "beam.axial_stress": ChannelInfo("beam.axial_stress", "Pa", tuple("0123"), 15),
    }
    columns = {"beam.position": positions.reshape(3, -1), "beam.axial_stress": stress}
    time = np.array([0.0, 1.0, 2.0])
    return Results(tmp_path, time, channels, columns, {}, tmp_path / "meshes.h5")


def test_one_component_or_the_largest_of_all(folder, swung):
    case = load_case(folder)
    quantities = Quantities(case, folder / "out")
    quantities.results = swung
    assert quantities.number("channel.beam.position.4.z.max") == 1.0
    assert quantities.number("channel.beam.position.4.z.end") == 0.5
    assert quantities.number("channel.beam.axial_stress.largest.max") == 4e6
    assert quantities.number("channel.beam.axial_stress.smallest.end") == -5e6
    assert case.quantity("channel.beam.bending_moment.0.end").kind.unit == "N m"
    assert case.quantity("channel.plate.bending_moment.0.end").kind.unit == "N m/m"
    with pytest.raises(InputError, match="expected a component: 0, 1, 2, 3; or largest, smallest"):
        quantities.number("channel.beam.axial_stress.9.max")


def test_the_report_tells_extremes_and_ends_not_every_node(folder, swung):
    case = load_case(folder)
    text = to_markdown(Document("t", "s", tuple(mesh_sections(case, swung))))
    assert "## Frame beam" in text
    assert "## Shell plate" in text
    assert "4 elements, 5 nodes, 30 coordinates, 9 of them held" in text
    assert "| end (node 4) | 0, 15, 0 | 0, 15, 0 | 0, 15, 0.5 |" in text
    assert "farthest from its place (node 4) | 1 m at 1 s" in text
    assert "-5 (element 0), 2 s | 4 (element 3), 1 s" in text
    assert "edge x\\_min, y\\_max: clamped" in text
    assert len(text.splitlines()) < 90


@pytest.mark.slow
def test_a_case_of_meshes_fits_the_schema(folder):
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft202012Validator(case_schema())
    document = load_case(folder).document
    assert [error.message for error in validator.iter_errors(document)] == []
    for bodies_change in (
        {"geometry": {"type": "line"}},
        {"section": {"density": 1}},
        {"supports": [{"at": "middle", "fix": "pinned"}]},
        {"model": "linear"},
        {"thickness": 1},
    ):
        beam = {**document["bodies"]["beam"], **bodies_change}
        assert not validator.is_valid({**document, "bodies": {"beam": beam}})
    simulate = {"start": "equilibrium", "duration": "0.5 s"}
    assert not validator.is_valid({**document, "simulate": simulate})


def test_what_a_scene_of_meshes_conserves(folder):
    check = 'check=[{id="a", quantity="drift.momentum", reference=0, tolerance={absolute=0.1}, source="b"}]'
    with pytest.raises(InputError) as caught:
        load_case(folder, [check])
    text = str(caught.value)
    for cause in ("supports of 'beam'", "loads of 'plate'", "viscous damping of 'beam'", "gravity"):
        assert cause in text
    assert "loads of 'arch'" not in text


@pytest.mark.slow
def test_an_equilibrium_alone_is_one_record(tmp_path):
    """Tip of a cantilever under a small load, ``q l^4 / 8 E I``, through all stages."""
    from heavylift.pipeline import load_results, run_case

    (tmp_path / "case.toml").write_text(
        """
        title = "Cantilever"
        [bodies.beam]
        type = "frame"
        geometry = { type = "line", start = [0, 0, 0], end = ["10 m", 0, 0], elements = 4 }
        section = { density = 1000, young_modulus = "1 GPa", diameter = "1 m" }
        supports = [{ at = "start", fix = "clamped" }]
        loads = [{ force = [0, 0, "-1 N/m"] }]
        [[sensors]]
        name = "tip"
        body = "beam"
        point = ["10 m", 0, 0]
        [simulate]
        start = "equilibrium"
        duration = 0
        [[check]]
        id = "tip"
        quantity = "channel.tip.position.z.end"
        reference = -2.5464790894703255e-5
        tolerance = { relative = 1e-6 }
        source = "q l^4 / 8 E I"
        """
    )
    case = load_case(tmp_path)
    report = run_case(case)
    results = load_results(case)
    assert report.message == ""
    assert len(results.time) == 1
    deflection = 1.0 * 10.0**4 / (8.0 * 1e9 * math.pi / 64.0)
    assert results["tip.position"][0, 2] == pytest.approx(-deflection, rel=1e-6)
    assert results.meshes["beam"].elements.shape == (4, 2)
    text = (report.folder.stage("report") / "report.md").read_text()
    assert "Passed: the only check" in text
    assert "none: from equilibrium only" in text
    assert all(stage.skipped for stage in run_case(case).stages)
