"""The report of collisions: surfaces, impulses, which numbers are forces, pictures of what touches."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.checks.collision_regime import effective_mass, linear_restitution, peak_estimate
from heavylift.pipeline.drawn.triangles import clip_triangles
from heavylift.pipeline.pictures.collisions import Touching, TouchingSurface, collision_picture
from heavylift.pipeline.pictures.render import Renderer, RenderingUnavailableError, rendering_backend
from heavylift.pipeline.report.collisions import touching_surfaces
from heavylift.pipeline.report.report import write_report
from heavylift.pipeline.report.scene import scene_view
from heavylift.pipeline.results.histories import FORMAT, load_results
from heavylift.pipeline.results.mesh_results import mesh_shape, write_meshes
from heavylift.pipeline.results.storage import OutputFolder

RECORDS = 21
IMPULSE = 3000.0  # N s
PUSH = 250.0  # N


@pytest.fixture
def case(tmp_path):
    """Tank, quay and ball of `collisions.toml`, without the rope."""
    folder = tmp_path / "collisions"
    folder.mkdir()
    here = Path(__file__).parents[1]
    text = (here / "collisions.toml").read_text().partition("[[check]]")[0]
    for first, last in (
        ("[bodies.rope]", "[[surfaces]]"),
        ('[[surfaces]]\nname = "strand"', "[[collisions]]"),
    ):
        head, _, rest = text.partition(first)
        text = head + last + rest.partition(last)[2]
    (folder / "case.toml").write_text(text.replace(', "strand"]', "]"))
    shutil.copyfile(here / "tank.stl", folder / "tank.stl")
    return load_case(folder)


def contact(name, place, normal, force, impulse):
    """Channels of one recorded contact; the place, normal, force and impulse at each record."""
    none = np.zeros((RECORDS, 1))
    prefix = f"{name}.contact_1"
    return {
        f"{prefix}.point": ("m", "xyz", place),
        f"{prefix}.normal": ("1", "xyz", normal),
        f"{prefix}.gap": ("m", "g", none),
        f"{prefix}.force": ("N", "f", force[:, None]),
        f"{prefix}.friction": ("N", "f", none),
        f"{prefix}.impulse": ("N s", "p", impulse[:, None]),
        f"{prefix}.patch": ("1", "n", np.where(np.any(normal, axis=1), 0.0, -1.0)[:, None]),
    }


def collision(name, *, force, impulse, impacts, gap):
    """Channels of a collision."""
    one = {
        "gap": ("m", gap),
        "contacts": ("1", 1.0 * (force > 0.0)),
        "patches": ("1", 1.0 * (force > 0.0)),
        "normal_force": ("N", force),
        "largest_force": ("N", force),
        "impulse": ("N s", impulse),
        "impacts": ("1", impacts),
        "impact_impulse": ("N s", impulse * (impacts > 0.0)),
        "dissipated": ("J", 0.0 * force),
    }
    return {f"{name}.{key}": (unit, "v", values[:, None]) for key, (unit, values) in one.items()}


@pytest.fixture
def out(case, tmp_path):
    """Surfaces of the mesh stage, and results: the tank hits the floor at record 10 and the quay at 5, the ball it."""
    folder = OutputFolder(tmp_path / "out")
    run_case(case, out=folder.root, stages=("mesh",))
    k = np.arange(RECORDS)
    time, zero = 0.01 * k, np.zeros(RECORDS)
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (RECORDS, 1))
    # centre of mass above the lowest point of the tank by 0.25 m
    path = np.column_stack([zero, zero, 0.25 + np.abs(time - 0.1)])
    up = np.outer(k == 10, [0.0, 0.0, 1.0])
    push = np.where(k == 5, PUSH, 0.0)
    channels = {
        "tank.position": ("m", "xyz", path),
        "tank.orientation": ("", "wxyz", upright),
        "ball.position": ("m", "xyz", 0 * path + [3.0, 0.0, 1.0]),
        "ball.orientation": ("", "wxyz", upright),
        "quay.position": ("m", "xyz", 0 * path),
        "quay.orientation": ("", "wxyz", upright),
        **collision(
            "landing",
            force=zero,
            impulse=IMPULSE * (k >= 10),
            impacts=1.0 * (k >= 10),
            gap=path[:, 2] - 0.25 - 1e-6 * (k == 10),
        ),
        **contact("landing", path * [1.0, 1.0, 0.0], up, zero, IMPULSE * (k == 10)),
        **collision(
            "fender", force=push, impulse=0.01 * np.cumsum(push), impacts=zero, gap=0.1 - 1e-4 * push
        ),
        **collision("soft", force=push, impulse=0.01 * np.cumsum(push), impacts=zero, gap=0.1 - 1e-4 * push),
    }
    folder.results.parent.mkdir(parents=True)
    with h5py.File(folder.results, "w") as file:
        file.attrs.update(
            {"format": FORMAT, "outcome": "completed", "channel_order": json.dumps(list(channels))}
        )
        file["time"] = time
        for name, (unit, components, data) in channels.items():
            dataset = file.create_dataset(f"channels/{name}", data=data)
            dataset.attrs.update({"unit": unit, "components": json.dumps(list(components)), "column": 0})
    return folder.root


@pytest.fixture
def drawing():
    try:
        rendering_backend()
    except RenderingUnavailableError as error:
        pytest.skip(str(error))


def table_rows(text, first):
    """Cells of the rows of Markdown tables that begin with a word."""
    rows = [line for line in text.splitlines() if line.startswith(f"| {first} |")]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


@pytest.mark.slow
def test_the_report_tells_impulses_and_what_its_forces_are(case, out, tmp_path):
    files = write_report(case, tmp_path / "report", out)
    text = (tmp_path / "report" / "report.md").read_text()
    law, happened, means = table_rows(text, "landing")
    assert law[1:3] == ["floor and plating", "rigid, restitution 0.5, none below 50 mm/s"]
    assert happened[1:] == [
        "floor and plating",
        "1",
        "3 kN s",
        "0 in 0",
        "1 µm",
        "impulse only",
        "0 N",
        "0 J",
    ]
    # p = (1 + e) m v: v = 1 m/s, and v sqrt(k m) = sqrt(1e8 x 2000) N
    assert means[2:4] == ["100 MN/m", "2000 kg"]
    assert f"= {1e-3 * math.sqrt(1e8 * 2000.0):.6g} kN, from an approach of 1 m/s" in means[7]
    fender, soft = table_rows(text, "fender")[1:], table_rows(text, "soft")[1:]
    # omega h of 1 MN/m on 2 t, and on 10 kg in series with 2 t, at 1 ms
    assert fender[0][6].startswith("250 N, 50 ms")
    assert fender[1][5] == f"{math.sqrt(1e6 / 2000.0) * 1e-3:.3g}"
    assert fender[1][7].startswith("a force")
    assert soft[0][6] == "not resolved"
    assert soft[1][5] == f"{math.sqrt(1e6 * (1 / 10.0 + 1 / 2000.0)) * 1e-3:.3g}"
    assert soft[1][7].startswith("NO force")
    assert "gamma = 0.8 is no restitution coefficient" in text
    names = {path.name for path in files}
    assert {"collision_landing.png", "collision_fender.png", "collision_soft.png"} <= names


@pytest.mark.slow
def test_the_report_has_the_surfaces(case, out, tmp_path):
    write_report(case, tmp_path / "report", out)
    text = (tmp_path / "report" / "report.md").read_text()
    inputs, found = table_rows(text, "plating")
    assert inputs[2] == "tank.stl, in mm"
    # a box without its top, which lies in the box that excludes: 10 of 12 triangles, 4 open edges
    assert found[1:8] == ["10", "8", "4", "0", "0", "no", "2"]
    assert found[8] == "28 points, 0 triangles"
    assert table_rows(text, "skin")[1][6] == "round"


@pytest.mark.slow
def test_each_collision_is_pictured_at_its_largest_impact_or_at_the_times_asked_for(
    case, out, drawing, tmp_path
):
    files = {path.name for path in write_report(case, tmp_path / "report", out)}
    text = (tmp_path / "report" / "report.md").read_text()
    assert "collision_landing_picture.png" in files
    assert "landing: floor and plating at 100 ms, 1 recorded contact, true to scale." in text
    assert "the longest arrow of the run is 3 kN s. Grey: excluded triangles." in text
    asked = load_case(case.folder, ["report.collision_times=[0.03]"])
    write_report(asked, tmp_path / "report", out)
    text = (tmp_path / "report" / "report.md").read_text()
    assert "landing: floor and plating at 30 ms, no contact, true to scale." in text


def test_surfaces_are_where_their_bodies_are(case, out):
    results = load_results(case, out)
    seen = touching_surfaces(case, OutputFolder(out), results, "landing", 10)
    floor, plating = seen.surfaces
    assert (floor.label, plating.label) == ("floor", "plating")
    # the tank of 2 m x 1 m x 0.5 m turned by 90 degrees, on the floor
    box = plating.points[plating.triangles.ravel()]
    np.testing.assert_allclose([box.min(axis=0), box.max(axis=0)], [[-0.5, -1, 0], [0.5, 1, 0.5]], atol=1e-12)
    np.testing.assert_allclose(plating.points[plating.excluded.ravel()][:, 2], 0.5, atol=1e-12)
    np.testing.assert_allclose(seen.places, [[0.0, 0.0, 0.0]], atol=1e-15)
    np.testing.assert_allclose(seen.arrows, [[0.0, 0.0, 1.0]], atol=1e-15)
    before = touching_surfaces(case, OutputFolder(out), results, "landing", 9)
    assert len(before.places) == 0
    ball = touching_surfaces(case, OutputFolder(out), results, "soft", 5).surfaces[0]
    np.testing.assert_allclose(np.linalg.norm(ball.points[ball.triangles.ravel()] - [3, 0, 1], axis=1), 0.2)


def test_a_frame_is_pictured_as_its_own_surface(case, tmp_path):
    shutil.copyfile(Path(__file__).parents[1] / "collisions.toml", case.file)
    case = load_case(case.folder)
    folder = OutputFolder(tmp_path / "rope")
    scene = assemble_scene(case, folder)
    (rope,) = [body for body in scene.bodies if body.name == "rope"]
    sunk = rope.nodes - [0.0, 0.0, 1.0]
    folder.results.parent.mkdir(parents=True)
    channels = {
        "rope.position": np.tile(sunk.ravel(), (2, 1)),
        "rope.tangent": np.tile(rope.tangents.ravel(), (2, 1)),
    }
    with h5py.File(folder.results, "w") as file:
        file.attrs.update({"format": FORMAT, "channel_order": json.dumps(list(channels))})
        file["time"] = np.array([0.0, 0.1])
        write_meshes(file, [mesh_shape(rope)])
        for name, data in channels.items():
            dataset = file.create_dataset(f"channels/{name}", data=data)
            components = [str(k) for k in range(data.shape[1])]
            dataset.attrs.update({"unit": "m", "components": json.dumps(components), "column": 0})
    seen = touching_surfaces(case, folder, load_results(case, folder.root), "bump_2", 1)
    floor, strand = seen.surfaces
    assert (floor.label, strand.label) == ("floor", "strand")
    # a bar of 20 mm from (0, 0, 4) to (2, 0, 4) m that has sunk by 1 m
    used = strand.points[strand.triangles.ravel()]
    np.testing.assert_allclose(
        [used.min(axis=0), used.max(axis=0)], [[0, -0.01, 2.99], [2, 0.01, 3.01]], atol=1e-6
    )


def test_pictures_of_scenes_have_the_surfaces_of_bodies_and_no_wide_floor(case, out):
    results = load_results(case, out)
    patches = scene_view(case, OutputFolder(out), results, [10]).seen(10).patches
    boxes = sorted(np.ptp(patch.points, axis=0).round(9).tolist() for patch in patches)
    assert boxes == [
        [0.4, 0.4, 0.4],
        [0.4, 0.4, 1.0],
        [1.0, 2.0, 0.5],
    ]  # ball, bollard, tank; no floor of 20 m
    tank = next(patch for patch in patches if np.ptp(patch.points[:, 1]) > 1.5)
    assert tank.points[:, 2].min() == pytest.approx(0.0, abs=1e-12)


def test_arrows_are_seen_through_what_hides_them(drawing):
    box = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (0.0, 1.0)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, d, e in sides for t in ((a, b, d), (a, d, e))])
    none = np.empty((0, 3), dtype=np.int64)
    floor = np.array([[-50.0, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]])
    surfaces = (
        TouchingSurface(floor, np.array([[0, 1, 2], [0, 2, 3]]), none, "floor"),
        TouchingSurface(box, triangles, none, "box"),
    )
    from matplotlib.image import imread

    red = []
    for places in (np.empty((0, 3)), np.zeros((1, 3))):  # below the middle of the box
        seen = Touching(surfaces, places, np.tile([0.0, 0.0, 1.0], (len(places), 1)))
        with Renderer() as renderer:
            content = collision_picture(renderer, seen, title="Box", up=[0, 0, 1])
        import io

        image = imread(io.BytesIO(content))[100:680]
        red.append(int(np.sum((image[..., 0] > 0.6) & (image[..., 1] < 0.3) & (image[..., 2] < 0.3))))
    assert red[1] > red[0] + 100


def test_an_inclined_floor_hides_what_is_below_it():
    """Its bounding box encloses the box on it; yet it is no container to look through."""
    box = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (0.0, 2.0)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, d, e in sides for t in ((a, b, d), (a, d, e))])
    none = np.empty((0, 3), dtype=np.int64)
    floor = np.array([[-9.0, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]])
    c, s = math.cos(0.6), math.sin(0.6)
    R = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    surfaces = (
        TouchingSurface(floor @ R.T, np.array([[0, 1, 2], [0, 2, 3]]), none, "floor"),
        TouchingSurface(box @ R.T, triangles, none, "box"),
    )
    drawn = []

    class Sketch:
        def render(self, drawing, _camera, size):
            drawn.append(drawing)
            return np.full((size[1], size[0], 3), 255, dtype=np.uint8)

    collision_picture(Sketch(), Touching(surfaces, np.empty((0, 3)), np.empty((0, 3))), title="Incline")
    assert not drawn[0].patches  # which are seen through


def test_a_large_triangle_is_cut_to_a_box():
    points = np.array(
        [[-10.0, -10, 0.5], [30, -10, 0.5], [-10, 30, 0.5], [0.2, 0.2, 0.2], [0.4, 0.2, 0.2], [0.2, 0.4, 0.2]]
    )
    triangles = np.array([[0, 1, 2], [3, 4, 5]])
    found, faces, source = clip_triangles(points, triangles, np.array([[0.0, 0, 0], [1, 1, 1]]))
    area = {0: 0.0, 1: 0.0}
    for face, number in zip(faces, source, strict=True):
        a, b, c = found[face]
        area[int(number)] += 0.5 * np.linalg.norm(np.cross(b - a, c - a))
    assert area[0] == pytest.approx(1.0, rel=1e-12)  # the square that it shares with the box
    assert area[1] == pytest.approx(0.02, rel=1e-12)
    assert found.min() >= 0.0
    assert found.max() <= 1.0


@pytest.mark.parametrize("zeta", [0.05, 0.3, 0.7, 0.99, 1.0, 1.2, 3.0])
def test_restitution_of_a_spring_and_damper_that_do_not_pull(zeta):
    k, m = 400.0, 4.0
    c = 2.0 * zeta * math.sqrt(k * m)

    def rate(_, y):
        return [y[1], -(k * y[0] + c * y[1]) / m]

    def released(_, y):
        return k * y[0] + c * y[1]

    released.terminal, released.direction = True, -1.0
    run = solve_ivp(rate, (0.0, 10.0), [0.0, 1.0], events=released, rtol=1e-11, atol=1e-13)
    assert linear_restitution(k, c, m) == pytest.approx(-run.y_events[0][0, 1], rel=1e-7)


def test_an_undamped_spring_has_the_estimated_peak_force():
    m, e, k, v = 7.0, 1.0, 2e5, 1.5
    peak = peak_estimate((1.0 + e) * m * v, e, k, m)
    assert peak.speed == pytest.approx(v, rel=1e-14)
    # energy: k d^2 = m v^2, F = k d
    assert peak.force == pytest.approx(k * math.sqrt(m * v * v / k), rel=1e-14)


def test_the_effective_mass_at_the_end_of_a_rod_is_a_quarter(case, out):
    """Of a rod of inertia m l^2 / 12 hit at its end, across it."""
    results = load_results(case, out)
    text = case.file.read_text().replace("inertia = [400, 500, 600]", "inertia = [1, 600, 600]")
    case.file.write_text(text)
    rod = load_case(case.folder)
    length = math.sqrt(12.0 * 600.0 / 2000.0)
    end = results["tank.position"][3] + [0.5 * length, 0.0, 0.0]
    up = np.array([0.0, 0.0, 1.0])
    pair = ("floor", "plating")
    assert effective_mass(rod, results, pair, 3) == pytest.approx(2000.0, rel=1e-14)
    assert effective_mass(rod, results, pair, 3, end, up) == pytest.approx(500.0, rel=1e-12)
