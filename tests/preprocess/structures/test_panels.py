"""Panels: plates, stiffeners, openings and lugs become shells and beams."""

from dataclasses import replace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.structures.panels import (
    Lug,
    Opening,
    Plate,
    Stiffener,
    mesh_panels,
    repeated,
)
from heavylift.preprocess.structures.sections import BeamSection

STEEL = Material(206e9, 0.3, 7850.0)
FLAT = BeamSection(area=0.15 * 0.012, second_moment_1=3.375e-6, second_moment_2=2.16e-8, torsion=8.2e-8)


def _area(structure, name):
    total = 0.0
    for part in structure.shells:
        if part.name == name:
            x = structure.nodes[part.elements]
            total += 0.5 * np.linalg.norm(np.cross(x[:, 2] - x[:, 0], x[:, -1] - x[:, 1]), axis=1).sum()
    return total


def _length(structure, name):
    return sum(
        np.linalg.norm(np.diff(structure.nodes[part.elements], axis=1), axis=2).sum()
        for part in structure.beams
        if part.name == name
    )


def _double_bottom():
    """Plates and stiffeners of a double bottom of 12 x 10 x 2 m."""
    plates = [
        Plate("bottom", STEEL, 0.025, repeated([[0, -5, 0], [0, 5, 0], [12, 5, 0], [12, -5, 0]])),
        Plate("tank_top", STEEL, 0.022, repeated([[0, -5, 2], [12, -5, 2], [12, 5, 2], [0, 5, 2]])),
        Plate(
            "girders",
            STEEL,
            0.018,
            repeated([[0, -5, 0], [12, -5, 0], [12, -5, 2], [0, -5, 2]], [[0, 2, 0]], [6]),
        ),
        Plate(
            "floors", STEEL, 0.018, repeated([[0, -5, 0], [0, 5, 0], [0, 5, 2], [0, -5, 2]], [[2, 0, 0]], [7])
        ),
    ]
    bars = [
        Stiffener(
            "bars",
            STEEL,
            FLAT,
            repeated([[0, -4.5, 0], [12, -4.5, 0]], [[0, 0.5, 0], [0, 2, 0]], [3, 5]),
            np.array([0.0, 0.0, 1.0]),
            plate="bottom",
            foot=(0.075, 0.01),
            flange=np.array([0.0, 1.0, 0.0]),
        )
    ]
    return plates, bars


def test_plates_and_stiffeners_of_a_double_bottom_meet_node_on_node():
    plates, bars = _double_bottom()
    found = mesh_panels(plates, bars, size=0.5)
    # of a regular grid those on plates
    grid = {
        (i, j, k)
        for i in range(25)
        for j in range(21)
        for k in range(5)
        if k in {0, 4} or i % 4 == 0 or j % 4 == 0
    }
    assert found.node_count == len(grid)
    assert all(part.elements.shape[1] == 4 for part in found.shells)
    for name, area in (("bottom", 120.0), ("tank_top", 120.0), ("girders", 144.0), ("floors", 140.0)):
        assert _area(found, name) == pytest.approx(area, rel=1e-12)
    assert _length(found, "bars") == pytest.approx(15 * 12.0, rel=1e-12)
    (beams,) = found.beams
    assert beams.offset_a == pytest.approx(
        np.tile([0.0, 0.01, 0.0125 + 0.075], (len(beams.elements), 1)), abs=1e-15
    )
    assert np.array_equal(np.unique(found.nodes[found.node_groups["tank_top"], 2]), [2.0])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_stiffener_stands_on_the_surface_of_a_plate_whose_middle_is_off_its_corners(sign):
    top = Plate("top", STEEL, 0.02, repeated(SQUARE), offset=0.05)
    bar = replace(BAR, web=np.array([0.0, 0.0, sign]), foot=(0.075, 0.0))
    (beams,) = mesh_panels([top], [bar], size=0.5).beams
    wanted = [0.0, 0.0, 0.05 + sign * (0.01 + 0.075)]
    assert beams.offset_a == pytest.approx(np.tile(wanted, (len(beams.elements), 1)), abs=1e-14)


def test_normals_are_those_of_the_polygons():
    plates, _ = _double_bottom()
    found = mesh_panels(plates, size=1.0)
    wanted = {"bottom": [0, 0, -1], "tank_top": [0, 0, 1], "girders": [0, -1, 0], "floors": [1, 0, 0]}
    for part in found.shells:
        x = found.nodes[part.elements]
        normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        assert normal == pytest.approx(np.tile(wanted[part.name], (len(normal), 1)), abs=1e-9)


def test_openings_take_their_area_out():
    web = Plate(
        "web",
        STEEL,
        0.012,
        repeated([[0, 0, 0], [4, 0, 0], [4, 0, 1.6], [0, 0, 1.6]]),
        openings=(
            Opening(np.array([1.0, 0.0, 0.8]), 0.8, 0.6, np.array([1.0, 0.0, 0.0])),
            Opening(np.array([3.0, 0.0, 0.8]), 0.6, 0.6),
        ),
    )
    exact = 4 * 1.6 - 0.2 * 0.6 - 2 * np.pi * 0.3**2
    errors = [_area(mesh_panels([web], size=size), "web") / exact - 1.0 for size in (0.1, 0.05)]
    assert 0.0 < errors[0] < 5e-3  # chords cut off a part of a round opening, of second order
    assert errors[1] / errors[0] == pytest.approx(0.25, abs=0.12)


def test_a_lug_stands_on_its_plate_with_a_pin_hole():
    top = Plate("top", STEEL, 0.02, repeated([[0, -1, 0], [4, -1, 0], [4, 1, 0], [0, 1, 0]]))
    lug = Lug(
        "lug",
        STEEL,
        0.05,
        foot=np.array([2.0, 0.0, 0.0]),
        direction=np.array([1.0, 0.0, 0.0]),
        normal=np.array([0.0, 0.0, 1.0]),
        length=0.5,
        height=0.25,
        radius=0.15,
        hole=0.12,
        bracket=0.2,
    )
    found = mesh_panels([top], lugs=[lug], size=0.1)
    rim = found.nodes[found.node_groups["lug"]] - [2.0, 0.0, 0.25]
    assert len(rim) == 16
    assert np.linalg.norm(rim, axis=1) == pytest.approx(np.full(16, 0.06))
    assert rim.mean(axis=0) == pytest.approx(np.zeros(3), abs=1e-6)
    foot = np.intersect1d(found.node_groups["lug_plate"], found.node_groups["top"])
    assert np.ptp(found.nodes[foot, 0]) == pytest.approx(0.5)
    with pytest.raises(
        InputError, match=r"lugs\.lug: its foot at \(3900, 0, 0\) mm leaves the plates at \(4150, 0, 0\)"
    ):
        mesh_panels([top], lugs=[replace(lug, foot=np.array([3.9, 0.0, 0.0]))], size=0.1)
    with pytest.raises(InputError, match=r"lugs\.lug: its foot at \(2000, 0, 300\) mm stands on no plate"):
        mesh_panels([top], lugs=[replace(lug, foot=np.array([2.0, 0.0, 0.3]))], size=0.1)


def test_repeated_steps_multiply():
    lines = repeated([[0, 0, 0], [1, 0, 0]], [[0, 0.5, 0], [0, 2, 0]], [3, 5])
    assert sorted(line[0, 1] for line in lines) == [2 * j + 0.5 * i for j in range(5) for i in range(3)]


SQUARE = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
TOP = Plate("top", STEEL, 0.02, repeated(SQUARE))
BAR = Stiffener("bar", STEEL, FLAT, repeated([[0.2, 1, 0], [1.8, 1, 0]]), np.array([0.0, 0, 1]), plate="top")


@pytest.mark.parametrize(
    ("plates", "stiffeners", "message"),
    [
        ([TOP, replace(TOP, name="other")], [], "plates 'top' and 'other' lie on each other around"),
        ([TOP, TOP], [], "'top' is given twice"),
        (
            [replace(TOP, polygons=repeated([*SQUARE[:3], [0, 2, 0.1]]))],
            [],
            r"plates\.top\.corners: corner .* off the plane",
        ),
        ([replace(TOP, polygons=repeated([[0, 0, 0], [1, 0, 0], [2, 0, 0]]))], [], "enclose no area"),
        (
            [TOP],
            [replace(BAR, lines=repeated([[0.2, 1, 0], [2.4, 1, 0]]))],
            r"stiffeners\.bar: it leaves the plate 'top'",
        ),
        ([TOP], [replace(BAR, plate="deck")], "plate 'deck' is unknown"),
        ([TOP], [replace(BAR, web=np.array([1.0, 0, 0]))], r"stiffeners\.bar\.web: its web is at 90 deg"),
        ([TOP], [BAR, replace(BAR, name="again")], r"stiffeners\.again: it lies on 'bar' around"),
        ([TOP], [replace(BAR, lines=BAR.lines * 2)], r"stiffeners\.bar: it lies on 'bar' around"),
        (
            [TOP],
            [replace(BAR, web=np.array([0.0, 1, 0]))],
            r"stiffeners\.bar\.web: its web is at 90 deg to the normal",
        ),
        (
            [replace(TOP, openings=(Opening(np.array([1.9, 1, 0]), 0.3, 0.3),))],
            [],
            r"plates\.top\.openings\.0: it leaves the plate at",
        ),
        (
            [replace(TOP, openings=(Opening(np.array([5.0, 1, 0]), 0.3, 0.3),))],
            [],
            r"plates\.top\.openings\.0: its centre \(5000, 1000, 0\) mm lies on none",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_place(plates, stiffeners, message):
    with pytest.raises(InputError, match=message):
        mesh_panels(plates, stiffeners, size=0.5)


def _step_of_surfaces(path, faces):
    """A STEP file of rectangles, as OpenCASCADE writes it, in mm."""
    from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session

    with gmsh_session("test") as gmsh:
        occ = gmsh.model.occ
        for corners in faces:
            points = [occ.addPoint(*(1e3 * np.array(corner, dtype=float))) for corner in corners]
            lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
            occ.addPlaneSurface([occ.addCurveLoop(lines)])
        occ.synchronize()
        gmsh.write(str(path))


def test_plates_are_faces_of_a_step_file(tmp_path):
    path = tmp_path / "box.step"
    upright = [[[0, 0, 0], [2, 0, 0], [2, 0, 1], [0, 0, 1]], [[0, 2, 0], [2, 2, 0], [2, 2, 1], [0, 2, 1]]]
    _step_of_surfaces(path, [SQUARE, *upright])
    deck = Plate("deck", STEEL, 0.02, across=np.array([0.0, 0.0, 1.0]))
    sides = Plate("sides", STEEL, 0.01, across=np.array([0.0, 1.0, 0.0]))
    found = mesh_panels([deck, sides], size=0.5, file=path)
    assert _area(found, "deck") == pytest.approx(4.0)
    assert _area(found, "sides") == pytest.approx(4.0)
    assert found.node_count == 25 + 2 * 10
    one = replace(sides, at=(2.0,))
    with pytest.raises(InputError, match=r"1 of 3 faces of box\.step are of no plate; face 2 at"):
        mesh_panels([deck, one], size=0.5, file=path)
    with pytest.raises(InputError, match=r"no face of box\.step is of it"):
        mesh_panels([deck, replace(sides, at=(7.0,))], size=0.5, file=path)
    with pytest.raises(InputError, match=r"no face 'hull' in box\.step"):
        mesh_panels([deck, Plate("sides", STEEL, 0.01, faces=("hull",))], size=0.5, file=path)
    # the same numbers, understood as metres
    large = mesh_panels([deck, sides], size=500.0, file=path, scale=1e3)
    assert _area(large, "deck") == pytest.approx(4e6)
