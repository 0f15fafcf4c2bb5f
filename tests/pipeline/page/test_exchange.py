"""Files for other programs, read by readers of others: nodes of a GLB, points of a VTKHDF series."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
from made_pages import TIMES, lift_motion

from heavylift.pipeline.page.exchange import write_glb, write_vtkhdf


@pytest.fixture(scope="module")
def lift(tmp_path_factory):
    return lift_motion(tmp_path_factory.mktemp("lift") / "lift")


def read_glb(path):
    """Document and buffer of a GLB, by section 4.4 of glTF 2.0."""
    content = path.read_bytes()
    magic, version, total = struct.unpack_from("<4sII", content)
    assert (magic, version, total) == (b"glTF", 2, len(content))
    length, kind = struct.unpack_from("<I4s", content, 12)
    assert kind == b"JSON"
    document = json.loads(content[20 : 20 + length])
    size, kind = struct.unpack_from("<I4s", content, 20 + length)
    assert kind == b"BIN\0"
    return document, content[28 + length : 28 + length + size]


def accessor(document, buffer, number):
    entry = document["accessors"][number]
    view = document["bufferViews"][entry["bufferView"]]
    kind = {5126: "<f4", 5125: "<u4"}[entry["componentType"]]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[entry["type"]]
    values = np.frombuffer(buffer, kind, entry["count"] * width, view["byteOffset"])
    return values.reshape(-1, width) if width > 1 else values


def test_nodes_of_a_glb_move_as_the_records_do(lift, tmp_path):
    case, results, motion = lift
    path = tmp_path / "lift.glb"
    notes = write_glb(path, motion, title=case.title, generator="test")
    document, buffer = read_glb(path)
    names = [node["name"] for node in document["nodes"]]
    module = names.index("module")
    (animation,) = document["animations"]
    moved = {}
    for channel in animation["channels"]:
        if channel["target"]["node"] == module:
            sampler = animation["samplers"][channel["sampler"]]
            moved[channel["target"]["path"]] = sampler
    times = accessor(document, buffer, moved["translation"]["input"])
    np.testing.assert_allclose(times, TIMES, atol=1e-6)
    found = accessor(document, buffer, moved["translation"]["output"])
    np.testing.assert_allclose(found, results["module.position"], atol=1e-5)
    q = accessor(document, buffer, moved["rotation"]["output"])  # x, y, z, w
    np.testing.assert_allclose(q[:, 2], np.sin(0.05 * TIMES), atol=1e-6)
    np.testing.assert_allclose(q[:, 3], np.cos(0.05 * TIMES), atol=1e-6)
    assert notes == [] or "records" in notes[0]


def test_a_glb_opens_elsewhere_with_y_up(lift, tmp_path):
    """Read by trimesh: the module is a box of 12 x 8 x 4 m whose height is along y."""
    import trimesh

    case, _, motion = lift
    path = tmp_path / "lift.glb"
    write_glb(path, motion, title=case.title, generator="test")
    scene = trimesh.load(path)
    (transform, name), *_ = [
        scene.graph[node] for node in scene.graph.nodes_geometry if node.startswith("module")
    ]
    points = scene.geometry[name].vertices @ transform[:3, :3].T + transform[:3, 3]
    np.testing.assert_allclose(np.ptp(points, axis=0), [12.0, 4.0, 8.0], atol=1e-5)
    assert points[:, 1].mean() == pytest.approx(2.0)


def test_vtk_reads_the_series_at_its_times(lift, tmp_path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    _, results, motion = lift
    path = tmp_path / "lift.vtkhdf"
    write_vtkhdf(path, motion)
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == len(TIMES)
    number = next(k for k, one in enumerate(motion.surfaces) if one.name == "module")
    first = sum(len(one.points) for one in motion.surfaces[:number])
    for step in (0, 40, 80):
        reader.SetStep(step)
        reader.Update()
        found = reader.GetOutput()
        points = vtk_to_numpy(found.GetPoints().GetData())[
            first : first + len(motion.surfaces[number].points)
        ]
        np.testing.assert_allclose(points.mean(axis=0), results["module.position"][step], atol=1e-4)
        assert found.GetNumberOfPolys() == sum(len(one.triangles) for one in motion.surfaces)
        assert found.GetNumberOfLines() == 5
