"""A scene in time for other programs: GLB with animation, and VTKHDF time series.

GLB (Khronos, glTF 2.0, sections 3.6 to 3.11): every body is a node that moves, mode shapes are morph targets with modal
coordinates as weights, recorded shapes and ropes are morph targets one after the other. VTKHDF ("PolyData" with
"Steps", VTK file formats): all points of the world at each step, with the stress where there is one.
"""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.drawn.moments import Moment, continued
from heavylift.pipeline.drawn.scene import POSES, SHAPES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.drawn.scene import DrawnScene

__all__ = ["write_glb", "write_vtkhdf"]

MORPHS = 80
"""Recorded shapes, and shapes of ropes, in a GLB at most: each is a morph target."""
STEP_BYTES = 400_000_000
"""Of the points of a VTKHDF file, before compression."""
STEPS = 400
"""Of a VTKHDF file at most."""

_AROUND = 6  # corners of a rope
_FLOAT, _UINT = 5126, 5125  # component types of glTF


# --- GLB


class _Gltf:
    """A document of glTF and its one buffer."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.size = 0
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.materials: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.nodes: list[dict[str, Any]] = []
        self.channels: list[dict[str, Any]] = []
        self.samplers: list[dict[str, Any]] = []
        self.colours: dict[tuple[str, float], int] = {}

    def add(self, values: NDArray[Any], *, indices: bool = False) -> int:
        """Accessor of numbers, vectors or quaternions."""
        kind, name = (np.dtype("<u4"), _UINT) if indices else (np.dtype("<f4"), _FLOAT)
        array = np.ascontiguousarray(values, dtype=kind)
        content = array.tobytes()
        self.views.append({"buffer": 0, "byteOffset": self.size, "byteLength": len(content)})
        self.parts.append(content)
        self.size += len(content)
        shape = "SCALAR" if array.ndim == 1 else {3: "VEC3", 4: "VEC4"}[array.shape[1]]
        entry: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": name,
            "count": len(array),
            "type": shape,
        }
        if len(array) and not indices:
            flat = array.reshape(len(array), -1)
            entry |= {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        self.accessors.append(entry)
        return len(self.accessors) - 1

    def material(self, colour: str, opacity: float) -> int:
        key = (colour, opacity)
        if key not in self.colours:
            # colours of glTF are linear, those of the web are sRGB
            rgb = np.array([int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)])
            linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
            own: dict[str, Any] = {
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*linear.tolist(), opacity],
                    "metallicFactor": 0.0,
                    "roughnessFactor": 0.8,
                },
                "doubleSided": True,
            }
            if opacity < 1.0:
                own["alphaMode"] = "BLEND"
            self.colours[key] = len(self.materials)
            self.materials.append(own)
        return self.colours[key]

    def node(self, name: str, parent: int | None = None, **more: Any) -> int:
        self.nodes.append({"name": name, **more})
        number = len(self.nodes) - 1
        if parent is not None:
            self.nodes[parent].setdefault("children", []).append(number)
        return number

    def mesh(
        self,
        name: str,
        points: NDArray[np.float64],
        triangles: NDArray[np.int64],
        material: int,
        targets: Sequence[NDArray[np.float64]] = (),
    ) -> int:
        primitive: dict[str, Any] = {
            "attributes": {"POSITION": self.add(points)},
            "indices": self.add(triangles.ravel(), indices=True),
            "material": material,
        }
        own: dict[str, Any] = {"name": name, "primitives": [primitive]}
        if targets:
            primitive["targets"] = [{"POSITION": self.add(target)} for target in targets]
            own["weights"] = [0.0] * len(targets)
        self.meshes.append(own)
        return len(self.meshes) - 1

    def animate(self, node: int, path: str, times: int, values: NDArray[np.float64]) -> None:
        self.samplers.append({"input": times, "output": self.add(values), "interpolation": "LINEAR"})
        self.channels.append({"sampler": len(self.samplers) - 1, "target": {"node": node, "path": path}})

    def content(self, generator: str, title: str) -> bytes:
        document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": generator, "extras": {"title": title}},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": self.size}],
        }
        if self.channels:
            document["animations"] = [{"name": "run", "channels": self.channels, "samplers": self.samplers}]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        block = b"".join(self.parts)
        block += bytes(-len(block) % 4)
        total = 12 + 8 + len(text) + 8 + len(block)
        return (
            struct.pack("<4sII", b"glTF", 2, total)
            + struct.pack("<I4s", len(text), b"JSON")
            + text
            + struct.pack("<I4s", len(block), b"BIN\0")
            + block
        )


def write_glb(path: Path, drawn: DrawnScene, *, title: str, generator: str) -> list[str]:
    """Write a scene with its motion as GLB; y is up there, as glTF has it.

    Parameters
    ----------
    path
        Replaced.
    drawn
        The scene; bodies that leave it stand still from then on.
    title, generator
        Told in the file.

    Returns
    -------
    list[str]
        What the file does not have.
    """
    notes: list[str] = []
    out = _Gltf()
    up = drawn.up
    turn = {
        (0.0, 0.0, 1.0): [-np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)],
        (0.0, 0.0, -1.0): [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)],
        (1.0, 0.0, 0.0): [0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)],
        (-1.0, 0.0, 0.0): [0.0, 0.0, -np.sqrt(0.5), np.sqrt(0.5)],
        (0.0, -1.0, 0.0): [0.0, 0.0, 1.0, 0.0],
    }.get((float(up[0]), float(up[1]), float(up[2])))
    root = out.node(title)
    if turn is not None:
        out.nodes[root]["rotation"] = [float(v) for v in turn]
    moves = len(drawn.times[POSES]) > 1
    zero = drawn.times[POSES][0]
    times = out.add(drawn.times[POSES] - zero) if moves else -1
    nodes = []
    for pose in drawn.poses:
        position, orientation = _held(pose.position), _held(continued(pose.orientation))
        turned = orientation / np.linalg.norm(orientation, axis=1, keepdims=True)
        turned = turned[:, [1, 2, 3, 0]]  # the scalar is last in glTF
        node = out.node(pose.name, root, translation=position[0].tolist(), rotation=turned[0].tolist())
        nodes.append(node)
        if moves and np.ptp(position, axis=0).any():
            out.animate(node, "translation", times, position)
        if moves and np.ptp(turned, axis=0).any():
            out.animate(node, "rotation", times, turned)
    chosen = np.unique(np.linspace(0, len(drawn.times[POSES]) - 1, MORPHS).round().astype(np.int64))
    few = drawn.times[POSES][chosen]
    few_times = out.add(few - zero) if moves else -1
    for surface in drawn.solids:
        parent = root if surface.body < 0 else nodes[surface.body]
        material = out.material(surface.colour, surface.opacity)
        if surface.modes is not None and moves:
            assert surface.amplitudes is not None
            mesh = out.mesh(surface.name, surface.points, surface.triangles, material, list(surface.modes))
            node = out.node(surface.name, parent, mesh=mesh, weights=surface.amplitudes[0].tolist())
            out.animate(node, "weights", times, surface.amplitudes.ravel())
            continue
        changes = any(
            part is not None for part in (surface.shapes, surface.offset, surface.size, surface.anchor)
        )
        if changes and moves:
            shapes = [Moment(drawn, float(time)).local(surface) for time in few]
            _morphed(out, surface.name, parent, shapes, surface.triangles, material, few_times)
            continue
        mesh = out.mesh(surface.name, Moment(drawn, float(zero)).local(surface), surface.triangles, material)
        out.node(surface.name, parent, mesh=mesh)
    for line in drawn.lines:
        if not line.radius:
            continue
        shapes = [
            _tube(np.nan_to_num(Moment(drawn, float(time)).line(line)), line.radius)
            for time in (few if moves else few[:1])
        ]
        material = out.material(line.colour, 1.0)
        triangles = _tube_triangles(len(line.on))
        if moves:
            _morphed(out, line.name, root, shapes, triangles, material, few_times)
        else:
            out.node(line.name, root, mesh=out.mesh(line.name, shapes[0], triangles, material))
    if len(few) < len(drawn.times[POSES]):
        notes.append(f"ropes and recorded shapes are those of {len(few)} records, linear between them")
    if drawn.arrows or drawn.water is not None:
        notes.append("water and forces at contacts are not in it")
    path.write_bytes(out.content(generator, title))
    return notes


def _morphed(
    out: _Gltf,
    name: str,
    parent: int,
    shapes: Sequence[NDArray[np.float64]],
    triangles: NDArray[np.int64],
    material: int,
    times: int,
) -> None:
    """A mesh that takes some shapes one after the other, or stands still if they are all alike."""
    first = shapes[0]
    if all(np.array_equal(shape, first) for shape in shapes):
        out.node(name, parent, mesh=out.mesh(name, first, triangles, material))
        return
    targets = [shape - first for shape in shapes[1:]]
    node = out.node(name, parent, mesh=out.mesh(name, first, triangles, material, targets))
    weights = np.vstack([np.zeros(len(targets)), np.eye(len(targets))])
    out.animate(node, "weights", times, weights.ravel())


def _held(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The last finite row in place of those that are not."""
    good = np.isfinite(values).all(axis=1)
    last = np.maximum.accumulate(np.where(good, np.arange(len(values)), 0))
    found: NDArray[np.float64] = values[last]
    return found


def _tube(points: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """Corners around a polyline, shape (6 p, 3)."""
    along = np.gradient(points, axis=0) if len(points) > 1 else np.array([[1.0, 0.0, 0.0]])
    along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    across = np.empty_like(along)
    before = np.eye(3)[int(np.argmin(np.abs(along[0])))]
    for k, t in enumerate(along):
        now = before - (before @ t) * t
        length = float(np.linalg.norm(now))
        before = now / length if length > 1e-9 else np.eye(3)[int(np.argmin(np.abs(t)))]
        across[k] = before
    other = np.cross(along, across)
    turns = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    rings = np.cos(turns)[:, None] * across[:, None] + np.sin(turns)[:, None] * other[:, None]
    corners: NDArray[np.float64] = (points[:, None] + radius * rings).reshape(-1, 3)
    return corners


def _tube_triangles(count: int) -> NDArray[np.int64]:
    ring = np.arange(_AROUND)
    following = (ring + 1) % _AROUND
    one = np.concatenate(
        [
            np.column_stack([ring, following, following + _AROUND]),
            np.column_stack([ring, following + _AROUND, ring + _AROUND]),
        ]
    )
    starts = _AROUND * np.arange(max(count - 1, 0))
    return (one + starts[:, np.newaxis, np.newaxis]).reshape(-1, 3)


# --- VTKHDF


def write_vtkhdf(path: Path, drawn: DrawnScene) -> list[str]:
    """Write a scene as a time series of VTKHDF: surfaces and ropes of the world, and what is known of their points.

    Point data: ``stress`` [Pa], not a number where there is none. Cell data: ``object``, a number among the names in
    the attribute ``object_names`` of the file.

    Parameters
    ----------
    path
        Replaced.
    drawn
        The scene.

    Returns
    -------
    list[str]
        What the file does not have.
    """
    import h5py

    surfaces, lines = drawn.solids, [line for line in drawn.lines if line.radius]
    count = sum(len(one.points) for one in surfaces) + sum(len(one.on) for one in lines)
    most = int(np.clip(STEP_BYTES // max(12 * count, 1), 2, STEPS))
    chosen = np.unique(np.linspace(0, len(drawn.times[POSES]) - 1, most).round().astype(np.int64))
    times = drawn.times[POSES][chosen]
    names = [one.name for one in lines] + [one.name for one in surfaces]
    starts = np.cumsum([0, *(len(one.points) for one in surfaces), *(len(one.on) for one in lines)])
    triangles = np.concatenate(
        [one.triangles + start for one, start in zip(surfaces, starts, strict=False)]
        or [np.empty((0, 3), dtype=np.int64)]
    )
    line_starts = starts[len(surfaces) :]
    rows = [np.arange(len(one.on)) + start for one, start in zip(lines, line_starts, strict=False)]
    owners = [np.full(1, k) for k in range(len(lines))]
    owners += [np.full(len(one.triangles), len(lines) + k) for k, one in enumerate(surfaces)]
    owner = np.concatenate(owners or [np.empty(0)]).astype(np.int32)
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF", track_order=True)
        root.attrs["Version"] = np.array([2, 0], dtype=np.int64)
        root.attrs.create("Type", np.bytes_("PolyData"), dtype=h5py.string_dtype("ascii", 8))
        points = root.create_dataset(
            "Points",
            (len(times) * count, 3),
            dtype="f4",
            chunks=(max(1, min(count, 65536)), 3),
            compression=4,
        )
        root["NumberOfPoints"] = np.array([count], dtype=np.int64)
        stress = root.create_group("PointData").create_dataset(
            "stress", (len(times) * count,), dtype="f4", chunks=(max(1, min(count, 65536)),), compression=4
        )
        cells = {
            "Vertices": ([], []),
            "Lines": (rows, [len(row) for row in rows]),
            "Polygons": (list(triangles), [3] * len(triangles)),
            "Strips": ([], []),
        }
        for name, (connected, sizes) in cells.items():
            group = root.create_group(name)
            flat = np.concatenate(connected) if len(connected) else np.empty(0)
            group["Connectivity"] = flat.astype(np.int64)
            group["Offsets"] = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
            # one topology for all steps
            group["NumberOfConnectivityIds"] = np.array([len(flat)], dtype=np.int64)
            group["NumberOfCells"] = np.array([len(sizes)], dtype=np.int64)
        root.create_group("CellData")["object"] = owner
        root.attrs["object_names"] = json.dumps(names)  # VTK reads no texts of a series
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = np.int64(len(times))
        steps["Values"] = times
        order = np.arange(len(times), dtype=np.int64)
        steps["PartOffsets"] = np.zeros(len(times), dtype=np.int64)
        steps["NumberOfParts"] = np.ones(len(times), dtype=np.int64)
        steps["PointOffsets"] = order * count
        steps["CellOffsets"] = np.zeros((len(times), 4), dtype=np.int64)
        steps["ConnectivityIdOffsets"] = np.zeros((len(times), 4), dtype=np.int64)
        steps.create_group("PointDataOffsets")["stress"] = order * count
        steps.create_group("CellDataOffsets")["object"] = np.zeros(len(times), dtype=np.int64)
        for k, time in enumerate(times):
            now = Moment(drawn, float(time))
            parts = now.all(surfaces, lines)
            values = [
                np.full(len(one.points), np.nan) if one.stress is None else now.value(SHAPES, one.stress)
                for one in surfaces
            ]
            values += [np.full(len(one.on), np.nan) for one in lines]
            here = slice(k * count, (k + 1) * count)
            if count:
                points[here] = np.concatenate(parts)
                stress[here] = np.concatenate(values)
    notes = []
    if len(times) < len(drawn.times[POSES]):
        notes.append(f"{len(times)} of {len(drawn.times[POSES])} placed records are in it")
    if drawn.arrows or drawn.water is not None:
        notes.append("water and forces at contacts are not in it")
    return notes
