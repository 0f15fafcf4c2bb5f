"""The report of contacts: what happened at each, pictures with the force where it acts, and surfaces that close."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.drawn.contours import contour_shape
from heavylift.pipeline.pictures.parts import force_arrow
from heavylift.pipeline.pictures.render import RenderingUnavailableError, rendering_backend
from heavylift.pipeline.report.report import write_report
from heavylift.pipeline.report.scene import scene_view
from heavylift.pipeline.results.histories import FORMAT, load_results
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.scene import contacts as c

RECORDS = 11


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "contacts"
    folder.mkdir()
    text = (Path(__file__).parents[1] / "contacts.toml").read_text()
    (folder / "case.toml").write_text(text.partition("[[check]]")[0])
    return folder


@pytest.fixture
def rigid(folder):
    """The same without frames and shells, and what is attached to them."""
    text = (folder / "case.toml").read_text()
    for first, last in (
        ("[bodies.rope]", "[contours.floor]"),
        ("[contours.cable]", "[[contacts]]"),
        ('[[contacts]]\nname = "squeeze"', '[[contacts]]\nname = "foot"'),
    ):
        head, _, rest = text.partition(first)
        text = head + last + rest.partition(last)[2]
    (folder / "case.toml").write_text(text)
    return load_case(folder)


@pytest.fixture
def out(rigid, tmp_path):
    """Results of a ball that falls, touches in record 5 with 250 N, and rises."""
    folder = OutputFolder(tmp_path / "out")
    time = 0.1 * np.arange(RECORDS)
    height = 0.1 + np.abs(time - 0.5)
    push = np.where(np.arange(RECORDS) == 5, 250.0, 0.0)
    zero, upright = np.zeros((RECORDS, 1)), np.tile([1.0, 0.0, 0.0, 0.0], (RECORDS, 1))
    path = np.column_stack([0 * time + 0.5, 0 * time + 0.5, height])
    channels = {
        "ball.position": ("m", "xyz", path),
        "ball.orientation": ("", "wxyz", upright),
        "block.position": ("m", "xyz", 0 * path + [1.0, 1.0, 0.1]),
        "block.orientation": ("", "wxyz", upright),
        "landing.gap": ("m", "g", (height - 0.1 - 1e-6 * (push > 0))[:, None]),
        "landing.force": ("N", "xyz", np.outer(push, [0.0, 0.0, 1.0])),
        "landing.normal_force": ("N", "n", push[:, None]),
        "landing.friction_force": ("N", "f", zero),
        "landing.impulse": ("N s", "p", np.cumsum(push)[:, None] * 0.1),
        "landing.impacts": ("1", "i", (time >= 0.5)[:, None] * 1.0),
        "landing.slip_path": ("m", "s", zero),
        "landing.dissipated": ("J", "d", (time >= 0.5)[:, None] * 3.5),
        "landing.point": ("m", "xyz", path * [1.0, 1.0, 0.0]),
        "bead.force": ("N", "xyz", 0 * path),
        "bead.normal_force": ("N", "n", zero),
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
    return tmp_path / "out"


@pytest.fixture
def drawing():
    try:
        rendering_backend()
    except RenderingUnavailableError as error:
        pytest.skip(str(error))


def table_row(text, first):
    """Cells of the row of a Markdown table that begins with a word."""
    rows = [line for line in text.splitlines() if line.startswith(f"| {first} |")]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


@pytest.mark.slow
def test_the_report_says_what_happened_at_each_contact(rigid, out, tmp_path):
    files = write_report(rigid, tmp_path / "report", out)
    text = (tmp_path / "report" / "report.md").read_text()
    inputs, happened = table_row(text, "landing")
    assert inputs[3:5] == ["sphere, radius 100 mm", "rigid, restitution 0.5, none below 1 mm/s"]
    assert "friction 0.3" in inputs[5]
    assert happened[3:] == ["250 N, 500 ms", "25 N s", "1", "1 µm", "0 m", "3.5 J"]
    assert table_row(text, "bead")[1][6] == "–"  # of what never leaves its curve
    assert table_row(text, "skid")[0][1:4] == ["band", "block", "5 points"]
    assert table_row(text, "rail")[0][3:] == ["circle, radius 500 mm, centre (0, 0, 1) m", "degree 3; closed"]
    names = {path.name for path in files}
    assert {"contact_landing_normal_force.png", "contact_landing_gap.png"} <= names
    assert "contact_bead_gap.png" not in names


@pytest.mark.slow
def test_the_picture_is_of_the_largest_force(rigid, out, drawing, tmp_path):
    files = write_report(rigid, tmp_path / "report", out)
    assert "contacts.png" in {path.name for path in files}
    text = (tmp_path / "report" / "report.md").read_text()
    assert "The scene at 500 ms, largest normal force: landing, 250 N, true to scale." in text


@pytest.mark.slow
def test_of_impacts_alone_the_largest_is_pictured_and_the_impulse_plotted(rigid, out, drawing, tmp_path):
    with h5py.File(OutputFolder(out).results, "r+") as file:
        file["channels/landing.normal_force"][:] = 0.0
        file["channels/landing.force"][:] = 0.0
    files = {path.name for path in write_report(rigid, tmp_path / "report", out)}
    text = (tmp_path / "report" / "report.md").read_text()
    assert "The scene at 500 ms, largest impulse: landing, 25 N s" in text
    assert table_row(text, "landing")[1][3] == "none recorded"
    assert "contact_landing_impulse.png" in files
    assert "contact_landing_normal_force.png" not in files


def test_the_force_is_drawn_at_the_touched_point_and_only_while_it_acts(rigid, out):
    results = load_results(rigid, out)
    others = scene_view(rigid, OutputFolder(out), results, [4, 5])
    red = [[line for line in others.seen(record).lines if line.colour == "#c62828"] for record in (4, 5)]
    assert not red[0]
    (arrow,) = red[1]
    np.testing.assert_allclose(arrow.points[0], [0.5, 0.5, 0.0], atol=1e-15)
    np.testing.assert_allclose(arrow.points[1, :2], [0.5, 0.5], atol=1e-15)
    # the largest of the run has a fifth of the size of the scene
    assert arrow.points[1, 2] == pytest.approx(0.2 * others.scene.size, rel=1e-12)


def test_shapes_are_drawn_with_their_sizes():
    ball = c.SphereShape(2.0).outline
    np.testing.assert_allclose(np.linalg.norm(ball.points, axis=1), 2.0, rtol=1e-14)
    box = c.BoxShape(np.array([3.0, 5.0, 7.0]), 0.5).outline
    np.testing.assert_allclose(np.ptp(box.points, axis=0), [3.0, 5.0, 7.0])
    capsule = c.CapsuleShape(0.5, 2.0, np.array([1.0, 0.0, 0.0])).outline
    np.testing.assert_allclose(np.ptp(capsule.points, axis=0)[0], 3.0, rtol=1e-12)
    drum = c.CylinderShape(1.0, 3.0, 0.1, np.array([0.0, 1.0, 0.0])).outline
    np.testing.assert_allclose(np.ptp(drum.points, axis=0), [2.0, 3.0, 2.0], rtol=1e-12)
    ring = c.CircleShape(0.5, np.array([0.0, 0.0, 3.0])).outline
    np.testing.assert_allclose(np.linalg.norm(ring.points, axis=1), 0.5, rtol=1e-14)


def volume(patch):
    """Enclosed by a closed surface of triangles."""
    a, b, d = patch.points[patch.triangles].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, d))) / 6.0


def test_a_cylinder_about_a_circle_is_a_closed_torus_and_a_band_a_ribbon(folder):
    scene = assemble_scene(load_case(folder), OutputFolder(folder / "out"))
    rail = next(contour for contour in scene.contours if contour.name == "rail")
    tube = c.Contour(name="tube", body="ground", neutral=rail.neutral, radius=0.1)
    patch = contour_shape(tube)
    # 2 pi^2 R r^2; the polygon of 24 corners has sin(15 deg) / 15 deg of the area of its circle
    polygon = 24 / (2 * np.pi) * np.sin(2 * np.pi / 24)
    assert abs(volume(patch)) == pytest.approx(2 * np.pi**2 * 0.5 * 0.01 * polygon, rel=2e-3)
    edges = np.sort(np.concatenate([patch.triangles[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
    assert np.all(np.unique(edges, axis=0, return_counts=True)[1] == 2)
    band = c.Contour(
        name="band", body="ground", neutral=rail.neutral, width=0.2, director=np.array([0.0, 0.0, 1.0])
    )
    ribbon = contour_shape(band)
    # its width is along the axis of the circle, its radius that of the curve
    np.testing.assert_allclose(np.hypot(ribbon.points[:, 0], ribbon.points[:, 1]), 0.5, rtol=1e-5)
    np.testing.assert_allclose([ribbon.points[:, 2].min(), ribbon.points[:, 2].max()], [0.9, 1.1], rtol=1e-12)


def test_an_arrow_points_along_the_force():
    arrow = force_arrow(np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.0, -2.0]))
    np.testing.assert_allclose(arrow.points[1], [1.0, 2.0, 1.0])
    assert np.all(arrow.points[2:, 2] > 1.0)
