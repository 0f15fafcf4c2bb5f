"""Pictures: what they show as data is right, and what is drawn is there."""

import io

import numpy as np
import pytest

from heavylift.pipeline.drawn.outer_surface import surface_from_mesh, surface_from_nodes
from heavylift.pipeline.drawn.scales import deformation_scale, round_down
from heavylift.pipeline.pictures import render as picture_render
from heavylift.pipeline.pictures.annotations import add_heading, emptiest_corner
from heavylift.pipeline.pictures.bodies import Painter
from heavylift.pipeline.pictures.camera import View, choose_view, fit_camera
from heavylift.pipeline.pictures.drawings import (
    mesh_drawing,
    mode_drawing,
    stress_bands,
    stress_drawing,
    stress_limit,
)
from heavylift.pipeline.pictures.render import Drawing, Renderer, RenderingUnavailableError, rendering_backend
from heavylift.preprocess.finite_elements.mesh import Mesh

LENGTH, WIDTH, HEIGHT = 0.4, 0.1, 0.05


def brick_mesh(pocket=False):
    """Bar of 8 x 2 x 2 bricks along x; with a pocket that is open towards -y."""
    counts = (8, 2, 2)
    axes = [np.linspace(0.0, size, n + 1) for size, n in zip((LENGTH, WIDTH, HEIGHT), counts, strict=True)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    ids = np.arange(len(nodes)).reshape([n + 1 for n in counts])
    i, j, k = (index.ravel() for index in np.indices(counts))
    if pocket:
        keep = ~((j == 0) & (i > 1) & (i < 6) & (k == 1))
        i, j, k = i[keep], j[keep], k[keep]
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    elements = np.column_stack([ids[i + a, j + b, k + c] for a, b, c in corners])
    used, elements = np.unique(elements, return_inverse=True)
    nodes = nodes[used]
    clamped = np.flatnonzero(nodes[:, 0] == 0.0)
    return Mesh(nodes, elements.reshape(-1, 8), "hex8", {"clamped": clamped}).check()


@pytest.fixture(scope="module")
def mesh():
    return brick_mesh()


@pytest.fixture(scope="module")
def surface(mesh):
    return surface_from_mesh(mesh)


@pytest.fixture(scope="module")
def renderer():
    try:
        rendering_backend()
    except RenderingUnavailableError as error:
        pytest.skip(str(error))
    with Renderer() as drawer:
        yield drawer


def pixels(png):
    from PIL import Image

    with Image.open(io.BytesIO(png)) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def coloured_share(image):
    """Share of pixels that are neither white nor a grey."""
    return float(np.mean(np.ptp(image, axis=2) > 40))


def test_surface_of_a_box_has_its_faces_edges_and_no_diagonals(surface):
    # 8x2, 8x2 and 2x2 quads, twice each; a closed surface of quads has two edges a quad
    assert len(surface.triangles) == 2 * 2 * (16 + 16 + 4)
    assert len(surface.element_edges) == 2 * 2 * (16 + 16 + 4)
    edges = surface.nodes[surface.feature_edges]
    length = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum()
    assert length == pytest.approx(4 * (LENGTH + WIDTH + HEIGHT), rel=1e-12)
    assert len(surface.nodes) == len(surface.node_indices) < 9 * 3 * 3


def test_faces_of_a_node_group_are_coloured(mesh, surface):
    drawing = mesh_drawing(surface, {"clamped": mesh.node_groups["clamped"]})
    colours = drawing.triangle_colours
    centres = drawing.points[drawing.triangles].mean(axis=1)
    marked = np.any(colours != colours[np.argmax(centres[:, 0])], axis=1)
    assert np.array_equal(marked, centres[:, 0] < 1e-12)
    assert len(drawing.marks[0].points) == 9


def test_mode_is_drawn_with_its_largest_displacement_as_the_given_share(mesh, surface):
    shape = np.zeros_like(mesh.nodes)
    shape[:, 2] = 7.0 * (mesh.nodes[:, 0] / LENGTH) ** 2
    drawing = mode_drawing(surface, shape, scale=1e3, share=0.2)
    moved = np.linalg.norm(drawing.points - 1e3 * surface.nodes, axis=1)
    assert moved.max() == pytest.approx(0.2 * 1e3 * np.hypot(np.hypot(LENGTH, WIDTH), HEIGHT), rel=1e-12)
    expected = (surface.nodes[:, 0] / LENGTH) ** 2
    np.testing.assert_allclose(drawing.values, expected, atol=1e-14)


def test_stress_reaches_the_renderer_in_megapascals_at_the_right_nodes(mesh, surface):
    stress = 80.0e6 * mesh.nodes[:, 0] / LENGTH  # linear along the bar
    displacement = np.zeros_like(mesh.nodes)
    displacement[:, 1] = 1e-5
    drawing = stress_drawing(surface, displacement, stress, factor=100.0, scale=1e3)
    np.testing.assert_allclose(drawing.values, 80.0 * surface.nodes[:, 0] / LENGTH, atol=1e-12)
    assert drawing.limits == (0.0, 80.0)
    assert len(drawing.colours) == 8  # bands of 10 MPa
    np.testing.assert_allclose(
        drawing.points - 1e3 * surface.nodes, [[0.0, 1.0, 0.0]] * len(surface.nodes), atol=1e-9
    )


def test_colour_scale_is_round_and_ignores_a_singular_corner():
    assert stress_bands(104.9) == (110.0, 11)
    assert stress_bands(40.0) == (40.0, 8)
    assert stress_bands(7.3e-4)[0] == pytest.approx(8e-4)
    for limit in np.geomspace(1e-3, 1e3, 200):
        end, count = stress_bands(limit)
        assert limit * (1 - 1e-9) <= end <= 1.2 * limit
        assert 6 <= count <= 12
    field = np.full(1000, 10.0)
    field[0] = 400.0
    assert stress_limit(field) == 10.0
    assert stress_limit(np.linspace(0.0, 50.0, 100)) == 50.0
    assert stress_limit(np.zeros(5)) == 1.0


def test_round_scales():
    assert [round_down(v) for v in (1.0, 1.99, 2.0, 49.0, 0.007)] == [1.0, 1.0, 2.0, 20.0, 0.005]
    assert deformation_scale(np.array([[0.0, 3e-4, 0.0]]), 1.0) == 200.0  # 0.06 <= 0.1
    assert deformation_scale(np.zeros((4, 3)), 1.0) == 1.0


def test_fitted_camera_has_all_points_within_the_margin_and_touches_it():
    generator = np.random.default_rng(3)
    for _ in range(20):
        points = generator.normal(size=(40, 3)) * generator.uniform(0.1, 5.0, 3) + generator.normal(size=3)
        view = View.looking(generator.normal(size=3), generator.normal(size=3))
        camera = fit_camera(view, points, 1.6, margin=0.05)
        x, y, distance = camera.project(points).T
        assert (distance > 0.0).all()
        free = min(x.min(), y.min(), (1 - x).min(), (1 - y).min())
        assert free == pytest.approx(0.05, abs=1e-9)


def test_view_looks_into_the_pocket():
    view = choose_view(surface_from_mesh(brick_mesh(pocket=True)), up=(0.0, 0.0, 1.0))
    assert view.towards[1] < -0.3  # the pocket is open towards -y
    assert view.up[2] > 0.5
    assert np.linalg.det(view.matrix) == pytest.approx(1.0)


def test_renderer_draws_where_the_camera_projects(renderer):
    """A red triangle before a white ground: its pixels are those inside the projected corners."""
    corners = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.3], [0.5, 1.5, -0.2]])
    view = View.looking((0.3, -0.2, 1.0), (0.0, 1.0, 0.0))
    size = (240, 160)
    camera = fit_camera(view, corners, size[0] / size[1], margin=0.1)
    red = np.array([[255, 0, 0]], dtype=np.uint8)
    image = renderer.render(Drawing(corners, np.array([[0, 1, 2]]), triangle_colours=red), camera, size)
    assert image.shape == (160, 240, 3)
    drawn = np.argwhere(image[:, :, 1] < 128)
    (x, y), expected = camera.project(corners)[:, :2].T, np.zeros((160, 240), dtype=bool)
    column, row = np.meshgrid((np.arange(240) + 0.5) / 240, 1.0 - (np.arange(160) + 0.5) / 160)
    sides = [
        (x[j] - x[i]) * (row - y[i]) - (y[j] - y[i]) * (column - x[i]) for i, j in ((0, 1), (1, 2), (2, 0))
    ]
    expected = np.all(np.array(sides) >= 0, axis=0)
    assert expected.sum() == pytest.approx(len(drawn), rel=0.03)
    assert expected[drawn[:, 0], drawn[:, 1]].mean() > 0.97


@pytest.mark.slow
def test_pictures_have_their_size_and_show_something(renderer, mesh, surface):
    painter = Painter(renderer, surface, size=(640, 420))
    shape = np.zeros_like(mesh.nodes)
    shape[:, 2] = (mesh.nodes[:, 0] / LENGTH) ** 2
    stress = 2.0e8 * (1.0 - mesh.nodes[:, 0] / LENGTH)
    pictures = {
        "mesh": painter.mesh(title="bar", note="32 bricks", marks={"clamped": mesh.node_groups["clamped"]}),
        "mode": painter.mode(shape, title="mode 1"),
        "stress": painter.stress(1e-3 * shape, stress, title="at t = 1 s, cost 5 $ and 3 $"),
    }
    images = {name: pixels(png) for name, png in pictures.items()}
    for name, image in images.items():
        assert image.shape == (420, 640, 3)
        white = np.mean((image > 250).all(axis=2))
        assert 0.3 < white < 0.95, name
    assert coloured_share(images["mode"]) > 0.05
    assert coloured_share(images["stress"]) > 0.05
    assert not np.array_equal(images["mode"], images["stress"])
    # a picture does not depend on what was drawn before it
    assert painter.mode(shape, title="mode 1") == pictures["mode"]


def test_stress_picture_states_maximum_place_and_scale(renderer, mesh, surface, monkeypatch):
    from matplotlib.figure import Figure

    written = []
    original = Figure.text
    monkeypatch.setattr(
        Figure, "text", lambda self, x, y, s, **k: written.append(s) or original(self, x, y, s, **k)
    )
    stress = np.full(len(mesh.nodes), 1.0e8)
    corner = np.argmin(np.linalg.norm(mesh.nodes - [LENGTH, WIDTH, HEIGHT], axis=1))
    stress[corner] = 1.23e8
    shape = np.zeros_like(mesh.nodes)
    shape[:, 2] = 1e-4 * mesh.nodes[:, 0] / LENGTH
    Painter(renderer, surface, size=(640, 420)).stress(shape, stress, title="bar", note="t = 2 s")
    assert written[0] == "bar"
    assert written[1].startswith("t = 2 s · largest 123 MPa at (400, 100, 50) mm · deformation × 200")


def test_contact_sheet_has_one_tile_a_mode(renderer, mesh, surface):
    shapes = [mesh.nodes * factor for factor in (1.0, -1.0, 0.5, 2.0)]
    sheet = pixels(Painter(renderer, surface).contact_sheet(shapes, ["1", "2", "3", "4"], columns=3))
    rows, columns = 2, 3
    height, width = sheet.shape[0] // rows, sheet.shape[1] // columns
    shares = [
        coloured_share(sheet[r * height : (r + 1) * height, c * width : (c + 1) * width])
        for r in range(rows)
        for c in range(columns)
    ]
    assert all(share > 0.1 for share in shares[:4])
    assert shares[4] == shares[5] == 0.0


def test_bare_nodes_are_drawn_as_points(renderer, mesh):
    shape = np.zeros_like(mesh.nodes)
    shape[:, 1] = mesh.nodes[:, 0]
    image = pixels(
        Painter(renderer, surface_from_nodes(mesh.nodes), size=(500, 400)).mode(shape, title="nodes")
    )
    assert coloured_share(image[84:, :370]) > 0.005


def test_missing_library_is_a_message_with_the_packages_to_install(monkeypatch):
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkNoSuchRenderWindow")
    monkeypatch.setattr(picture_render, "_PROBE", "import os; os.abort()")
    monkeypatch.setattr(picture_render.sys, "platform", "linux")
    with pytest.raises(RenderingUnavailableError, match="apt-get install -y libegl1"):
        rendering_backend.__wrapped__()


@pytest.mark.parametrize("words", [6, 8, 9, 10, 11, 12, 60])
def test_a_heading_stays_within_its_picture(words):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 7.6), dpi=100)
    add_heading(figure, " ".join(["Bunnies"] * words), "t = 1 s", taken=200.0)
    renderer = FigureCanvasAgg(figure).get_renderer()
    title, note = (text.get_window_extent(renderer) for text in figure.texts)
    assert title.x1 <= 1200 - 200 - 18 + 1
    assert title.y0 >= note.y1
    assert (figure.texts[0].get_text().endswith("...")) == (words == 60)


def test_axes_stand_on_a_floor_rather_than_on_a_body():
    pixels = np.full((400, 600, 3), 200, dtype=np.uint8)  # a floor that fills the picture
    pixels[:150, :150:2] = 90
    pixels[-150:, ::3] = 90
    assert emptiest_corner(pixels) == (600 - 80, 400 - 80)


def test_what_is_behind_the_camera_does_not_turn_it_round(renderer):
    """A small square in front of the camera, and a large one far behind it."""
    square = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    camera = fit_camera(View.looking([0.0, 0, 1], [0.0, 1, 0]), square, 1.5)
    points = np.concatenate([square, 2.0 * square + [60.0, 0.0, 500.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    pixels = renderer.render(Drawing(points, triangles), camera, (90, 60))
    assert pixels[30, 45].max() < 250
