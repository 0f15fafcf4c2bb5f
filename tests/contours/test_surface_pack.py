"""Packed surfaces against edges, owners and neighbours that are found triangle by triangle."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pytest

from heavylift.contours.triangles.surface_layout import IS_FACE, OWNS_A, OWNS_AB
from heavylift.contours.triangles.surface_pack import pack_surfaces
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface


def grid(count: int, name: str = "grid") -> TriangleSurface:
    """A bent sheet of 2 count^2 triangles with an open rim, every third triangle wound the other way."""
    u, v = np.meshgrid(np.arange(count + 1.0), np.arange(count + 1.0), indexing="ij")
    points = np.stack([u, v, 0.1 * u * v + 0.3 * np.sin(u)], axis=2).reshape(-1, 3)
    number = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    rows = np.concatenate([np.stack([a, b, c], 2).reshape(-1, 3), np.stack([a, c, d], 2).reshape(-1, 3)])
    rows[::3] = rows[::3, ::-1]
    return TriangleSurface(points, rows, name=name)


def fan(blades: int) -> TriangleSurface:
    """Plates that share one edge, as where many plates of a block meet."""
    angle = 2.0 * np.pi * np.arange(blades) / blades
    tips = np.stack([np.cos(angle), np.sin(angle), np.full(blades, 0.5)], axis=1)
    points = np.concatenate([[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]], tips])
    rows = np.stack([np.zeros(blades), np.ones(blades), 2 + np.arange(blades)], axis=1).astype(np.int64)
    rows[1::2] = rows[1::2, [1, 0, 2]]
    return TriangleSurface(points, rows)


def sphere(radius: float = 0.4) -> TriangleSurface:
    return TriangleSurface(np.array([[1.0, 2.0, 3.0]]), np.array([[0, 0, 0]]), radius)


def capsule(radius: float = 0.2) -> TriangleSurface:
    return TriangleSurface(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]]), np.array([[0, 1, 1]]), radius)


SCENES = {
    "sheet": [grid(7)],
    "fan": [fan(5)],
    "all": [sphere(), grid(4), capsule(), fan(3), grid(2)],
}


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_edges_join_the_points_of_their_triangles_and_are_those_of_the_mesh(scene):
    packed = pack_surfaces(scene)
    expected = set()
    offset = 0
    for surface in scene:
        for row in surface.triangles + offset:
            expected |= {
                frozenset(pair) for pair in zip(row, np.roll(row, -1), strict=True) if len(set(pair)) == 2
            }
        offset += len(surface.points)
    ends = packed.edges["ends"]
    assert len(ends) == len(expected)
    assert {frozenset(pair) for pair in ends.tolist()} == expected
    for row in packed.triangles:
        for side in range(3):
            pair = {row.corners[side], row.corners[(side + 1) % 3]}
            edge = row.edges[side]
            if edge >= 0:
                assert set(ends[edge]) == pair
            else:
                assert len(pair) == 1 or not row.flags & IS_FACE
    for edge, row in enumerate(packed.edges):
        assert edge in packed.triangles[row.triangle].edges


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_every_point_and_every_edge_is_owned_once(scene):
    packed = pack_surfaces(scene)
    points = np.zeros(len(packed.points), dtype=int)
    edges = np.zeros(len(packed.edges), dtype=int)
    for row in packed.triangles:
        for k in range(3):
            points[row.corners[k]] += bool(row.flags & (OWNS_A << k))
            if row.flags & (OWNS_AB << k):
                assert row.edges[k] >= 0
                edges[row.edges[k]] += 1
    assert (points == 1).all()
    assert (edges == 1).all()


def test_a_point_of_no_triangle_is_owned_by_none():
    surface = grid(2)
    packed = pack_surfaces(
        [TriangleSurface(np.vstack([[[9.0, 9.0, 9.0]], surface.points]), surface.triangles + 1)]
    )
    assert not (packed.triangles["corners"] == 0).any()
    assert packed.vertex_first[0] == packed.vertex_first[1]
    assert packed.reaches[0] < 9.0


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_neighbours_are_the_other_ends_of_edges(scene):
    packed = pack_surfaces(scene)
    expected = defaultdict(set)
    for a, b in packed.edges["ends"]:
        expected[a].add(b)
        expected[b].add(a)
    for i in range(len(packed.points)):
        rows = packed.vertex_neighbours[packed.vertex_first[i] : packed.vertex_first[i + 1]]
        assert set(rows) == expected[i]
        assert len(rows) == len(expected[i])
    assert packed.vertex_first[-1] == len(packed.vertex_neighbours) == 2 * len(packed.edges)


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_inward_directions_lie_in_the_faces_of_the_edge(scene):
    packed = pack_surfaces(scene)
    faces_at = defaultdict(list)
    for t, row in enumerate(packed.triangles):
        if row.flags & IS_FACE:
            for k in range(3):
                faces_at[row.edges[k]].append((t, row.corners[(k + 2) % 3]))
    for e, (a, b) in enumerate(packed.edges["ends"]):
        rows = range(packed.edge_first[e], packed.edge_first[e + 1])
        assert sorted(packed.edge_opposite[j] for j in rows) == sorted(c for _, c in faces_at[e])
        along = packed.points[b] - packed.points[a]
        for j in rows:
            inward = packed.edge_inward[j]
            face = next(t for t, c in faces_at[e] if c == packed.edge_opposite[j])
            assert np.linalg.norm(inward) == pytest.approx(1.0, abs=1e-14)
            assert abs(inward @ along) < 1e-14 * np.linalg.norm(along)
            assert abs(inward @ packed.normals[face]) < 1e-14
            assert inward @ (packed.points[packed.edge_opposite[j]] - packed.points[a]) > 0.0
    assert (
        packed.edge_first[-1]
        == len(packed.edge_inward)
        == 3 * (packed.triangles["flags"] & IS_FACE > 0).sum()
    )


def test_rows_of_a_surface_are_its_own_and_keep_their_geometry():
    scene = SCENES["all"]
    packed = pack_surfaces(scene)
    for s, (surface, row) in enumerate(zip(scene, packed.surfaces, strict=True)):
        rows = slice(row.first_triangle, row.first_triangle + row.triangle_count)
        triangles = packed.triangles[rows]
        assert (triangles["surface"] == s).all()
        assert row.point_count == len(surface.points)
        assert sorted(packed.order[rows]) == list(range(len(surface.triangles)))
        given = surface.points[surface.triangles[packed.order[rows]]]
        np.testing.assert_array_equal(packed.points[triangles["corners"]], given)
        np.testing.assert_array_equal(
            triangles["corners"] - row.first_point, surface.triangles[packed.order[rows]]
        )
        np.testing.assert_array_equal(triangles["flags"] & IS_FACE > 0, surface.faces[packed.order[rows]])
        boxes = packed.triangle_boxes[rows]
        np.testing.assert_allclose(boxes["centre"] - boxes["half"], given.min(axis=1), atol=1e-14)
        np.testing.assert_allclose(boxes["centre"] + boxes["half"], given.max(axis=1), atol=1e-14)
        assert packed.radii[s] == surface.radius
        assert packed.reaches[s] == pytest.approx(np.linalg.norm(surface.points, axis=1).max(), rel=1e-15)
        assert triangles["edges"].max() >= row.first_edge or not len(surface.points) > 1
        assert packed.nodes[row.root].count == len(surface.triangles)


def test_normals_stand_on_faces_and_round_shapes_have_none():
    packed = pack_surfaces([grid(5), capsule(), sphere()])
    for row, normal in zip(packed.triangles, packed.normals, strict=True):
        a, b, c = packed.points[row.corners]
        if row.flags & IS_FACE:
            assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-14)
            assert np.cross(b - a, c - a) @ normal == pytest.approx(np.linalg.norm(np.cross(b - a, c - a)))
        else:
            np.testing.assert_array_equal(normal, 0.0)


def test_a_triangle_without_height_keeps_its_edges_but_is_no_face():
    points = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [3.0, 3.0, 3.0]])
    packed = pack_surfaces([TriangleSurface(points, np.array([[0, 1, 2]]))])
    assert not packed.triangles[0].flags & IS_FACE
    assert len(packed.edges) == 3
    assert len(packed.edge_inward) == 0


def test_lone_points_and_segments():
    packed = pack_surfaces([sphere(), capsule()])
    np.testing.assert_array_equal(packed.triangles[0].edges, -1)
    np.testing.assert_array_equal(packed.triangles[1].edges, [0, -1, -1])
    assert packed.triangles[0].flags == OWNS_A
    np.testing.assert_array_equal(packed.edges["ends"], [[1, 2]])
    np.testing.assert_array_equal(packed.edges["triangle"], [1])


def test_edges_of_a_closed_mesh_are_those_of_trimesh():
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=3)
    packed = pack_surfaces([TriangleSurface(mesh.vertices, mesh.faces)])
    mine = np.sort(packed.edges["ends"], axis=1)
    theirs = np.sort(mesh.edges_unique, axis=1)
    np.testing.assert_array_equal(mine[np.lexsort(mine.T)], theirs[np.lexsort(theirs.T)])
    # Euler: a closed surface without holes
    assert len(packed.points) - len(packed.edges) + len(packed.triangles) == 2
    assert (np.diff(packed.edge_first) == 2).all()
    np.testing.assert_allclose(packed.normals, mesh.face_normals[packed.order], atol=1e-12)


def test_a_scene_without_surfaces_has_empty_arrays():
    packed = pack_surfaces([])
    assert packed.points.shape == (0, 3)
    assert packed.triangles.shape == (0,)
    assert packed.edge_first.tolist() == [0]
