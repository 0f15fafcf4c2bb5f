"""STEP and mesh files: units, groups, and files that must be refused."""

from __future__ import annotations

import subprocess
import sys

import meshio
import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.geometry import STEP_SUFFIXES, read_mesh, read_step
from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session
from heavylift.preprocess.finite_elements.groups import OnFace, OnPlane

RADIUS, HEIGHT = 5.0, 20.0  # mm
MILLIMETRE, METRE = "SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)"


@pytest.fixture(scope="module")
def cylinder_step(tmp_path_factory):
    path = tmp_path_factory.mktemp("step") / "cylinder.step"
    with gmsh_session("cylinder") as gmsh:
        gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, HEIGHT, RADIUS)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    return path


def _meshio_cells(mesh):
    return {"hex8": "hexahedron", "tet10": "tetra10"}[mesh.element_type]


@pytest.mark.parametrize("unit", [1e-3, 1.0])
def test_step_files_carry_their_unit(cylinder_step, tmp_path, unit):
    text = cylinder_step.read_text()
    assert MILLIMETRE in text
    path = tmp_path / "cylinder.stp"
    path.write_text(text if unit == 1e-3 else text.replace(MILLIMETRE, METRE))
    mesh = read_step(path, size=4 * unit, groups=[OnPlane("lid", "z", HEIGHT * unit)])
    extent = np.ptp(mesh.nodes, axis=0)
    np.testing.assert_allclose(extent, np.array([2 * RADIUS, 2 * RADIUS, HEIGHT]) * unit, rtol=1e-2)
    np.testing.assert_allclose(mesh.nodes[mesh.node_groups["lid"], 2], HEIGHT * unit, rtol=1e-9)


def test_volume_of_a_cylinder_converges_with_straight_and_curved_edges(cylinder_step):
    exact = np.pi * RADIUS**2 * HEIGHT * 1e-9
    sizes = [4e-3, 2e-3]
    straight = [read_step(cylinder_step, size=h).volume / exact - 1 for h in sizes]
    curved = [read_step(cylinder_step, size=h, curved=True).volume / exact - 1 for h in sizes]
    # chords lie inside: order 2; parabolas through middle nodes on the circle: order 4
    assert straight[0] < straight[1] < 0
    assert np.log2(straight[0] / straight[1]) == pytest.approx(2.0, abs=0.7)
    assert abs(curved[0]) < 1e-2 * abs(straight[0])
    assert abs(curved[1]) < 0.2 * abs(curved[0])


def test_faces_of_a_step_file_can_be_named(cylinder_step):
    mesh = read_step(cylinder_step, size=5e-3, groups=[OnFace("shell", "face 1")])
    assert len(mesh.node_groups["shell"]) > 20
    with pytest.raises(InputError, match="'lid': face 'nowhere' is unknown; expected one of 'face 1'"):
        read_step(cylinder_step, size=5e-3, groups=[OnFace("lid", "nowhere")])


@pytest.mark.parametrize("suffix", [".vtu", ".msh", ".inp", ".bdf", ".vtk"])
@pytest.mark.parametrize("name", ["distorted_bricks", "straight_tetrahedra"])
def test_mesh_files_come_back_whole(suffix, name, request, tmp_path):
    mesh = request.getfixturevalue(name)
    path = tmp_path / f"body{suffix}"
    file_format = "gmsh" if suffix == ".msh" else None  # the suffix is also ANSYS's
    meshio.Mesh(1e3 * mesh.nodes, [(_meshio_cells(mesh), mesh.elements)]).write(path, file_format)
    back = read_mesh(path, length_unit=1e-3)
    assert back.element_type == mesh.element_type
    # formats in text keep seven digits at least
    np.testing.assert_allclose(back.nodes, mesh.nodes, atol=1e-6)
    np.testing.assert_array_equal(back.elements, mesh.elements)


def test_node_sets_of_abaqus_and_flags_of_vtu_become_groups(distorted_bricks, tmp_path):
    mesh = distorted_bricks
    foot = np.flatnonzero(mesh.nodes[:, 2] == 0)
    cells = [("hexahedron", mesh.elements)]
    meshio.Mesh(mesh.nodes, cells, point_sets={"foot": foot}).write(tmp_path / "body.inp")
    flags = np.isin(np.arange(mesh.node_count), foot).astype(np.int32)
    meshio.Mesh(mesh.nodes, cells, point_data={"foot": flags}).write(tmp_path / "body.vtu")
    for path in (tmp_path / "body.inp", tmp_path / "body.vtu"):
        np.testing.assert_array_equal(read_mesh(path).node_groups["foot"], foot)


@pytest.mark.parametrize("version", [2.2, 4.1])
def test_physical_groups_of_gmsh_become_groups_and_stray_nodes_go(tmp_path, version):
    path = tmp_path / "bar.msh"
    with gmsh_session("bar") as gmsh:
        gmsh.model.occ.addBox(0, 0, 0, 4, 1, 1)
        gmsh.model.occ.addPoint(9, 9, 9)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1], name="bar")
        ends = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(-0.1, -1, -1, 0.1, 2, 2, 2)]
        gmsh.model.addPhysicalGroup(2, ends, name="end")
        gmsh.model.addPhysicalGroup(0, [9], name="camera")
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.ElementOrder", 2)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(path))
    mesh = read_mesh(path, groups=[OnPlane("tip", "x", 4.0), OnFace("root", "end")])
    assert mesh.volume == pytest.approx(4.0, rel=1e-9)
    np.testing.assert_array_equal(mesh.node_groups["end"], np.flatnonzero(np.isclose(mesh.nodes[:, 0], 0)))
    np.testing.assert_array_equal(mesh.node_groups["root"], mesh.node_groups["end"])
    assert len(mesh.node_groups["bar"]) == mesh.node_count
    assert "camera" not in mesh.node_groups
    assert "tip" in mesh.node_groups


def test_linear_tetrahedra_are_refused_with_a_remedy(straight_tetrahedra, tmp_path):
    path = tmp_path / "linear.vtu"
    meshio.Mesh(straight_tetrahedra.nodes, [("tetra", straight_tetrahedra.elements[:, :4])]).write(path)
    with pytest.raises(
        InputError, match=r"linear.vtu: contains \d+ cells of type 'tetra' .* element order to 2"
    ):
        read_mesh(path)


def test_other_cells_are_refused(distorted_bricks, straight_tetrahedra, tmp_path):
    bricks, tets = distorted_bricks, straight_tetrahedra
    path = tmp_path / "body.vtu"
    meshio.Mesh(bricks.nodes, [("wedge", bricks.elements[:, :6])]).write(path)
    with pytest.raises(InputError, match=r"'wedge' \(first: element 1\); expected bricks"):
        read_mesh(path)
    meshio.Mesh(bricks.nodes, [("quad", bricks.elements[:, :4])]).write(path)
    with pytest.raises(InputError, match="no solid cell"):
        read_mesh(path)
    both = [("hexahedron", bricks.elements), ("tetra10", tets.elements + bricks.node_count)]
    meshio.Mesh(np.vstack([bricks.nodes, tets.nodes]), both).write(path)
    with pytest.raises(
        InputError, match=r"2 parts with no node in common: 1 .27 elements hexahedron.*; 2 .* tetra10"
    ):
        read_mesh(path)
    assert read_mesh(path, part=1).element_type == "hex8"
    assert read_mesh(path, part=2).element_type == "tet10"


def test_inverted_and_disconnected_elements_are_named(distorted_bricks, tmp_path):
    path = tmp_path / "body.vtu"
    elements = distorted_bricks.elements.copy()
    elements[6] = elements[6, [4, 5, 6, 7, 0, 1, 2, 3]]
    meshio.Mesh(distorted_bricks.nodes, [("hexahedron", elements)]).write(path)
    with pytest.raises(
        InputError, match=r"body.vtu: element 7 \(hexahedron\) at .*determinant is not positive"
    ):
        read_mesh(path)
    # the last element on nodes of its own: merged in the picture, loose in the mesh
    elements = distorted_bricks.elements.copy()
    nodes = np.vstack([distorted_bricks.nodes, distorted_bricks.nodes[elements[-1]]])
    elements[-1] = distorted_bricks.node_count + np.arange(8)
    meshio.Mesh(nodes, [("hexahedron", elements)]).write(path)
    with pytest.raises(InputError, match=r"falls into 2 parts .* 2 \(1 element .*'merge_nodes'"):
        read_mesh(path)
    whole = read_mesh(path, merge_nodes=1e-6)
    assert (whole.element_count, whole.node_count) == (27, distorted_bricks.node_count)
    assert whole.volume == pytest.approx(distorted_bricks.volume, rel=1e-12)


def test_missing_and_unreadable_files_are_named(tmp_path, capfd):
    def read(path):
        return (read_step if path.suffix in STEP_SUFFIXES else read_mesh)(path)

    for name in ("none.step", "none.vtu"):
        with pytest.raises(InputError, match=rf"{name}: does not exist; expected a"):
            read(tmp_path / name)
    (tmp_path / "folder.step").mkdir()
    with pytest.raises(InputError, match="is a folder"):
        read(tmp_path / "folder.step")
    for name in ("bad.step", "bad.vtu", "bad.msh", "bad.inp", "bad.bdf"):
        (tmp_path / name).write_text("not a body\n")
        with pytest.raises(InputError, match=name):
            read(tmp_path / name)
    # a report in JSON shares the terminal: nothing else may appear on it
    assert capfd.readouterr() == ("", "")


def test_broken_and_empty_step_files_are_refused(cylinder_step, tmp_path):
    path = tmp_path / "cut.step"
    text = cylinder_step.read_text()
    path.write_text(text[: len(text) // 2])
    with pytest.raises(InputError, match=r"cut.step: "):
        read_step(path)
    surface = tmp_path / "surface.step"
    with gmsh_session("sheet") as gmsh:
        gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
        gmsh.model.occ.synchronize()
        gmsh.write(str(surface))
    with pytest.raises(InputError, match=r"surface.step: contains no solid"):
        read_step(surface)


def test_sizes_and_units_that_are_none_are_refused(cylinder_step, distorted_bricks, tmp_path):
    with pytest.raises(InputError, match="size: 0"):
        read_step(cylinder_step, size=0.0)
    path = tmp_path / "body.vtu"
    meshio.Mesh(distorted_bricks.nodes, [("hexahedron", distorted_bricks.elements)]).write(path)
    with pytest.raises(InputError, match="length_unit: -1"):
        read_mesh(path, length_unit=-1)


def test_gmsh_does_not_let_a_broken_pipe_end_the_process():
    """Whoever stops reading, of a page that is served or of what is printed, is an error that can be caught."""
    program = (
        "import socket; from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session\n"
        "with gmsh_session('nothing'): pass\n"
        "ours, theirs = socket.socketpair(); theirs.close()\n"
        "try: ours.sendall(b'x'); ours.sendall(b'x')\n"
        "except OSError: print('an error')\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout.strip()) == (0, "an error"), ended.stderr
