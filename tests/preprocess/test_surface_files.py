"""Surfaces from files of every kind."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.files import SURFACE_SUFFIXES, read_triangles
from heavylift.preprocess.surfaces.report import report_surface
from heavylift.preprocess.surfaces.triangle_surface import clean

SIZE = np.array([1.0, 2.0, 3.0])


def read_surface(path, **options):
    """Welded, as a case has it."""
    raw = read_triangles(path, **options)
    return clean(raw.points, raw.triangles, name=str(path))[0]


def check_box(surface, unit=1.0):
    report = report_surface(surface)
    assert report.watertight
    assert report.area == pytest.approx(22.0 * unit**2, rel=1e-6)
    np.testing.assert_allclose(np.ptp(surface.bounds, axis=0), SIZE * unit, rtol=1e-6)


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
@pytest.mark.parametrize("unit", [1.0, 1e-3])
def test_triangles_of_a_box(tmp_path, suffix, unit):
    import trimesh

    path = tmp_path / f"box.{suffix}"
    trimesh.creation.box(SIZE).export(path)
    surface = read_surface(path, scale=unit)
    check_box(surface, unit)
    assert (len(surface.points), len(surface.triangles), surface.name) == (8, 12, str(path))


def test_text_stl_and_upper_case_suffix(tmp_path):
    path = tmp_path / "ONE.STL"
    path.write_text(
        "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
        "endfacet\nendsolid one\n",
        encoding="utf-8",
    )
    np.testing.assert_array_equal(read_surface(path).points, [[0, 0, 0], [1, 0, 0], [0, 1, 0]])


def test_all_parts_of_an_obj_file(tmp_path):
    """Two objects, the second a quadrilateral far off."""
    path = tmp_path / "two.obj"
    path.write_text(
        "mtllib missing.mtl\no a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        "o b\nusemtl red\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 5 6 7\n",
        encoding="utf-8",
    )
    assert report_surface(read_surface(path)).area == pytest.approx(1.5)


def write_cells(path, cells, points):
    import meshio

    meshio.write_points_cells(path, points, [(kind, np.array(rows)) for kind, rows in cells])


CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0], [0, 0, 3], [1, 0, 3], [1, 2, 3], [0, 2, 3]], dtype=float
)
QUADS = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


@pytest.mark.parametrize("suffix", ["vtk", "vtu", "inp", "msh", "bdf"])
@pytest.mark.parametrize(
    "cells",
    [
        [("quad", QUADS)],
        [("quad", QUADS[1:]), ("triangle", [[0, 3, 2], [0, 2, 1]])],
        [("hexahedron", [list(range(8))])],
        [("tetra", [[0, 1, 3, 4], [1, 2, 3, 6], [1, 3, 4, 6], [3, 4, 6, 7], [1, 4, 5, 6]])],
    ],
    ids=["quads", "quads_and_triangles", "brick", "tetrahedra"],
)
def test_meshes_give_their_faces(tmp_path, suffix, cells):
    path = tmp_path / f"box.{suffix}"
    write_cells(path, cells, CORNERS)
    check_box(read_surface(path, scale=1e-3), 1e-3)


def test_a_deck_with_continued_lines_gives_its_faces(tmp_path):
    nodes = "".join(f"{k}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(CORNERS, 1))
    (tmp_path / "box.inp").write_text(f"*NODE\n{nodes}*ELEMENT, TYPE=C3D8R\n1, 1, 2, 3,\n4, 5, 6,\n7, 8,\n")
    check_box(read_surface(tmp_path / "box.inp", scale=1e-3), 1e-3)
    skin = "".join(f"{e}, {', '.join(str(k + 1) for k in quad)},\n" for e, quad in enumerate(QUADS, 1))
    (tmp_path / "skin.inp").write_text(f"*NODE\n{nodes}*ELEMENT, TYPE=S4R, ELSET=Skin\n{skin}")
    check_box(read_surface(tmp_path / "skin.inp", scale=1e-3), 1e-3)


def test_faces_of_two_bricks_leave_out_what_is_between(tmp_path):
    path = tmp_path / "two.vtu"
    points = np.vstack([CORNERS, CORNERS[4:] + np.array([0, 0, 3])])
    write_cells(path, [("hexahedron", [[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]])], points)
    report = report_surface(read_surface(path))
    assert report.watertight
    assert report.flipped_edges == 0
    assert (report.triangles, report.area) == (20, pytest.approx(40.0))


@pytest.mark.parametrize(("kind", "pieces"), [("quad8", 6), ("quad9", 8)])
def test_middle_nodes_are_corners_of_pieces(tmp_path, kind, pieces):
    """A quadrilateral of 2 x 2 m whose middle nodes lie half a metre higher, at the height of its shape there."""
    path = tmp_path / "face.vtu"
    points = np.array(
        [
            [0, 0, 0],
            [2, 0, 0],
            [2, 2, 0],
            [0, 2, 0],
            [1, 0, 0.5],
            [2, 1, 0.5],
            [1, 2, 0.5],
            [0, 1, 0.5],
            [1, 1, 1],
        ]
    )
    write_cells(path, [(kind, [list(range(int(kind[4])))])], points)
    surface = read_surface(path)
    report = report_surface(surface)
    assert (report.triangles, report.open_edges, report.flipped_edges) == (pieces, 8, 0)
    # seen from above the pieces cover the square once
    a, b, c = np.moveaxis(surface.points[surface.triangles][..., :2], 1, 0)
    u, v = b - a, c - a
    np.testing.assert_allclose((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum(), 8.0)


def test_second_order_triangle_becomes_four(tmp_path):
    path = tmp_path / "face.vtu"
    points = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    write_cells(path, [("triangle6", [list(range(6))])], points)
    report = report_surface(read_surface(path))
    assert (report.triangles, report.open_edges, report.flipped_edges) == (4, 6, 0)
    assert report.area == pytest.approx(2.0)


def test_a_warped_quadrilateral_is_cut_along_its_shorter_diagonal(tmp_path):
    path = tmp_path / "warped.vtu"
    points = np.array([[0.0, 0, 0], [1, 0, 0], [3, 3, 0], [0, 1, 0.2]])
    write_cells(path, [("quad", [[0, 1, 2, 3]])], points)
    surface = read_surface(path)
    common = set(surface.triangles[0]) & set(surface.triangles[1])
    found = np.sort(surface.points[list(common)], axis=0)
    np.testing.assert_allclose(found, np.sort(points[[1, 3]], axis=0))


@pytest.fixture(scope="module")
def solids(tmp_path_factory):
    """Box in STEP, IGES and BREP, in millimetres."""
    from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session

    folder = tmp_path_factory.mktemp("solids")
    with gmsh_session("test") as gmsh:
        gmsh.model.occ.addBox(0, 0, 0, *(1e3 * SIZE))
        gmsh.model.occ.synchronize()
        for suffix in ("step", "brep", "iges"):
            gmsh.write(str(folder / f"box.{suffix}"))
    return folder


@pytest.mark.parametrize(("suffix", "scale"), [("step", None), ("iges", None), ("brep", 1e-3)])
def test_cad_geometry_is_meshed_in_metres(solids, suffix, scale):
    coarse = read_surface(solids / f"box.{suffix}", scale=scale, size=1.0)
    check_box(coarse)
    fine = read_surface(solids / f"box.{suffix}", scale=scale, size=0.25)
    check_box(fine)
    longest = max(
        np.linalg.norm(
            fine.points[fine.triangles] - fine.points[np.roll(fine.triangles, 1, 1)], axis=2
        ).ravel()
    )
    assert longest < 0.25 * 1.5
    assert len(fine.triangles) > 8 * len(coarse.triangles)


def test_default_size_is_a_twentieth(solids):
    surface = read_surface(solids / "box.step")
    check_box(surface)
    # equilateral triangles of 0.15 m on 22 m2
    assert len(surface.triangles) == pytest.approx(22.0 / (0.15**2 * np.sqrt(3.0) / 4.0), rel=0.2)


def test_a_triangle_that_names_no_point(tmp_path):
    for suffix in ("vtk", "vtu"):
        path = tmp_path / f"bad.{suffix}"
        write_cells(path, [("triangle", [[0, 1, 8]])], CORNERS)
        with pytest.raises(
            InputError, match=rf"bad.{suffix}: triangle 1: point 8; expected numbers from 0 to 7"
        ):
            read_surface(path)
    path = tmp_path / "bad.vtu"
    write_cells(path, [("quad", [[0, 1, 2, 8]])], CORNERS)
    with pytest.raises(InputError, match=r"bad.vtu: a cell names point 8"):
        read_surface(path)


TEXTS = {
    "empty.stl": ("", "contains no triangle"),
    "words.stl": ("solid a\nendsolid a\n", "contains no triangle"),
    "nan.stl": (
        "solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex nan 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid x\n",
        "point 2: position .nan",
    ),
    "bad.obj": ("v 0 0 0\nv 1 0 0\nf 1 2 7\n", "cannot be read"),
    "bad.ply": ("ply\nformat", "cannot be read"),
    "bad.step": ("junk", "is not a STEP file"),
    "bad.brep": ("junk", "is not a BREP file"),
    "bad.igs": ("junk", "is not an IGES file"),
    "bad.vtu": ("junk", "cannot be read as a mesh"),
    "bad.xyz": ("junk", "suffix '.xyz' is unknown; expected .* .stl .obj .ply .step"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_bad_files_are_named(tmp_path, name):
    text, spec = TEXTS[name]
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=rf"{name}: (.*: )?{spec}"):
        read_surface(path)


def test_missing_files_and_options_that_do_not_fit(tmp_path):
    with pytest.raises(InputError, match=r"no.stl: does not exist"):
        read_surface(tmp_path / "no.stl")
    for suffix, options, spec in (
        ("stl", {"size": 0.1}, "size: 0.1; expected no size"),
        ("step", {"scale": 1e-3}, "scale: 0.001; expected no scale"),
        ("stl", {"scale": -1.0}, "scale: -1.0; expected a positive number"),
        ("step", {"size": np.nan}, "size: nan; expected a positive number"),
    ):
        path = tmp_path / f"a.{suffix}"
        path.write_text("", encoding="utf-8")
        with pytest.raises(InputError, match=spec):
            read_triangles(path, **options)


def test_lines_only(tmp_path):
    path = tmp_path / "wire.vtu"
    write_cells(path, [("line", [[0, 1]])], CORNERS)
    with pytest.raises(InputError, match=r"wire.vtu: contains no face \(but line\)"):
        read_surface(path)


def test_suffixes_are_lower_case():
    assert all(suffix == suffix.lower() and suffix[0] == "." for suffix in SURFACE_SUFFIXES)
