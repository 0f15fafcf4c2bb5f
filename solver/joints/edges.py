"""Hinges and clamps along edges of shells become one joint a node, whose rows hold the edge between the nodes too.

Along an element the edge and the slope across it are cubic in the vectors of its two nodes, so conditions on
all four vectors of each node hold everywhere: conditions on nodes and slopes alone leave the edge free between.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.joints.mesh_rows import EdgeSeam, Square, SquareJoint
from heavylift.solver.joints.packing import start_frames
from heavylift.solver.scene.connections import JOINTS, EdgeJoint, Joint, JointFrame
from heavylift.solver.scene.meshes import ShellBody
from heavylift.solver.scene.scene import AnyBody

__all__ = ["EdgeClamp", "EdgeHinge", "expand_edge"]

STRAIGHT = 1e-6
"""Sine of angles, and relative differences of lengths, that are taken for none."""

X, Y, XY = 1, 2, 3
TWIST = XY

# sides of an element: two of its nodes, and the direction of the mesh along them
SIDES = (((0, 1), X), ((3, 2), X), ((0, 3), Y), ((1, 2), Y))


@JOINTS.describe("edge_hinge")
@dataclass(frozen=True, eq=False, kw_only=True)
class EdgeHinge(EdgeJoint):
    """A straight edge of a shell turns about itself on the ground, a body or the edge of another shell."""


@JOINTS.describe("edge_clamp")
@dataclass(frozen=True, eq=False, kw_only=True)
class EdgeClamp(EdgeJoint):
    """An edge of a shell is built in at the ground, a body or the edge of another shell, and keeps its angle.

    Stretch and shear angle of the surface stay free at the edge.
    """


@dataclass(frozen=True)
class _Edge:
    """An edge of a shell as it stands at the start, world axes.

    Attributes
    ----------
    body, rotation, nodes
        The shell, its axes as columns, nodes of the edge.
    along, across
        Numbers of the slopes.
    lengths
        Of its elements, along the edge [m], shape (n - 1,).
    points
        Of the nodes, in axes of the body, shape (n, 3).
    slope, normal_slope
        Along the edge and across it, shape (n, 3).
    sense
        1 if the slopes along the edge point from the first node to the last, else -1.
    normal
        Of the surface in the nodes: along x y, unit, shape (n, 3).
    """

    body: ShellBody
    rotation: NDArray[np.float64]
    nodes: NDArray[np.int64]
    along: int
    across: int
    lengths: NDArray[np.float64]
    points: NDArray[np.float64]
    slope: NDArray[np.float64]
    normal_slope: NDArray[np.float64]
    sense: float
    normal: NDArray[np.float64]

    @property
    def stretch(self) -> NDArray[np.float64]:
        """Factors that make the slopes along the edge unit vectors from the first node to the last."""
        return np.asarray(self.sense / np.linalg.norm(self.slope, axis=1))

    def turn(self, node: int, normal: NDArray[np.float64]) -> tuple[float, float]:
        """Factor of the twist along a normal that makes the turn of the surface per length; skew of the slopes."""
        t = self.stretch[node] * self.slope[node]
        m = self.normal_slope[node]
        arm = float(normal @ np.cross(t, m))
        return float(self.stretch[node]) / arm, float(t @ m) / arm


def expand_edge(joint: EdgeJoint, bodies: Sequence[AnyBody]) -> list[Joint]:
    """One joint for each node of the edge, by the names ``joint.0``, ``joint.1``, ...

    Raises
    ------
    InputError
        If the nodes are no edge of a shell, a hinge is not straight, or the edges of two shells differ.
    """
    by_name: dict[str, Any] = {body.name: body for body in bodies}
    poses = start_frames(Joint(name=joint.name, body_a=joint.body_a, body_b=joint.body_b), bodies)
    a, b = by_name.get(joint.body_a), by_name.get(joint.body_b)
    if a is None or a.SHAPE != "surface":
        raise InputError(
            f"{joint.body_a!r} is no shell",
            source=joint.name,
            key="between",
            expected="a shell on the first side",
        )
    edge = _edge(joint, a, joint.nodes_a, "nodes_a")
    hinge = isinstance(joint, EdgeHinge)
    if b is not None and b.SHAPE == "surface":
        return _seams(joint, edge, _edge(joint, b, joint.nodes_b, "nodes_b"))
    if (b is not None and b.SEEN_AT_POINTS) or len(joint.nodes_b):
        raise InputError(
            f"{joint.body_b!r} is no shell",
            source=joint.name,
            key="nodes_b" if len(joint.nodes_b) else "between",
            expected="the ground, a rigid or floating body, or another shell with nodes_b",
        )
    world = poses[0].point + edge.points @ edge.rotation.T
    if hinge:
        _refuse_bent(joint, edge, world)
    rotation = poses[1].axes
    mean = float(edge.lengths.mean())
    made: list[Joint] = []
    for i, point in enumerate(world):
        frames = JointFrame(edge.points[i]), JointFrame(rotation.T @ (point - poses[1].point))
        up, slope = edge.normal[i], edge.slope[i]
        side = np.cross(up, slope) / np.linalg.norm(slope)
        size = float(np.linalg.norm(slope))
        squares = [
            Square(edge.along, rotation.T @ up, 1.0 / size),
            Square(edge.along, rotation.T @ side, 1.0 / size),
        ]
        if not hinge:
            size = float(np.linalg.norm(edge.normal_slope[i]))
            squares += [
                Square(edge.across, rotation.T @ up, 1.0 / size),
                Square(TWIST, rotation.T @ up, mean / size),
            ]
        made.append(
            SquareJoint(
                name=f"{joint.name}.{i}",
                body_a=joint.body_a,
                body_b=joint.body_b,
                frame_a=frames[0],
                frame_b=frames[1],
                compliance=joint.compliance,
                relaxation=joint.relaxation,
                squares=tuple(squares),
            )
        )
    return made


def _seams(joint: EdgeJoint, a: _Edge, b: _Edge) -> list[Joint]:
    """Two shells, node by node."""
    if len(a.nodes) != len(b.nodes):
        raise InputError(
            f"{len(a.nodes)} nodes and {len(b.nodes)} nodes",
            source=joint.name,
            key="nodes_b",
            expected="the nodes of both edges at the same places, in the same order",
        )
    if isinstance(joint, EdgeHinge):
        _refuse_bent(joint, a, a.points @ a.rotation.T)
    for k in (0, 1):  # at both ends of each element
        sides = [
            edge.lengths * np.linalg.norm(edge.slope[k : len(edge.nodes) - 1 + k], axis=1) for edge in (a, b)
        ]
        if np.any(np.abs(sides[0] - sides[1]) > STRAIGHT * sides[0]):
            worst = int(np.argmax(np.abs(sides[0] - sides[1])))
            raise InputError(
                f"between nodes {worst} and {worst + 1} of the edge the slopes differ, so that the edges would part",
                source=joint.name,
                key="nodes_b",
                expected="meshes that divide the edge in the same way",
            )
    made: list[Joint] = []
    mean = float(a.lengths.mean() * np.linalg.norm(a.slope, axis=1).mean())
    for i in range(len(a.nodes)):
        normal = upright = twist = None
        if isinstance(joint, EdgeClamp):
            of_a, skew_a = a.turn(i, a.normal[i])
            of_b, skew_b = b.turn(i, b.normal[i])
            normal, upright = a.rotation.T @ b.normal[i], a.rotation.T @ a.normal[i]
            # the edge itself bends into the twist of slopes that are not perpendicular to it, more on one side than the
            # other
            flat = abs(abs(a.normal[i] @ b.normal[i]) - 1.0) <= STRAIGHT
            same = abs(skew_a - np.sign(a.normal[i] @ b.normal[i]) * skew_b) <= 1e-3
            if (flat and same) or (abs(skew_a) <= 1e-3 and abs(skew_b) <= 1e-3):
                twist = (mean * of_a, mean * of_b)
        made.append(
            EdgeSeam(
                name=f"{joint.name}.{i}",
                body_a=joint.body_a,
                body_b=joint.body_b,
                frame_a=JointFrame(a.points[i]),
                frame_b=JointFrame(b.points[i]),
                compliance=joint.compliance,
                relaxation=joint.relaxation,
                along=(a.along, b.along),
                across=(a.across, b.across),
                stretch=(float(a.stretch[i]), float(b.stretch[i])),
                normal=normal,
                upright=upright,
                twist=twist,
            )
        )
    return made


def _edge(joint: EdgeJoint, body: ShellBody, nodes: NDArray[np.int64], key: str) -> _Edge:
    """Find the sides of elements between nodes that follow each other."""
    given = np.asarray(nodes)
    count = len(body.nodes)
    good = given.ndim == 1 and len(given) >= 2 and np.issubdtype(given.dtype, np.integer)
    if not (good and len(np.unique(given)) == len(given) and given.min() >= 0 and given.max() < count):
        raise InputError(
            f"nodes {given.tolist()} of {body.name!r}",
            source=joint.name,
            key=key,
            expected=f"two and more different numbers of nodes, 0 to {count - 1}",
        )
    sides: dict[tuple[int, int], tuple[int, float]] = {}
    for element, lengths in zip(np.asarray(body.elements), body.lengths, strict=True):
        for (i, j), direction in SIDES:
            first, second = int(element[i]), int(element[j])
            sides[first, second] = (direction, float(lengths[direction - 1]))
    found = []
    for first, second in zip(given[:-1].tolist(), given[1:].tolist(), strict=True):
        for pair, sense in (((first, second), 1.0), ((second, first), -1.0)):
            if pair in sides:
                found.append((*sides[pair], sense))
                break
        else:
            raise InputError(
                f"nodes {first} and {second} of {body.name!r} are not the ends of a side of an element",
                source=joint.name,
                key=key,
                expected="nodes along an edge, in order",
            )
    if len({(direction, sense) for direction, _, sense in found}) != 1:
        raise InputError(
            f"nodes {given.tolist()} of {body.name!r} go round a corner",
            source=joint.name,
            key=key,
            expected="nodes along one line of the mesh; one joint for each edge",
        )
    along, _, sense = found[0]
    across = X + Y - along
    rotation = rotation_matrix(np.asarray(body.orientation, dtype=np.float64))
    slopes = np.asarray(body.slopes, dtype=np.float64)[given] @ rotation.T
    normal = np.cross(slopes[:, X - 1], slopes[:, Y - 1])
    return _Edge(
        body=body,
        rotation=rotation,
        nodes=given,
        along=along,
        across=across,
        lengths=np.array([length for _, length, _ in found]),
        points=np.asarray(body.nodes, dtype=np.float64)[given],
        slope=slopes[:, along - 1],
        normal_slope=slopes[:, across - 1],
        sense=sense,
        normal=normal / np.linalg.norm(normal, axis=1, keepdims=True),
    )


def _refuse_bent(joint: EdgeJoint, edge: _Edge, points: NDArray[np.float64]) -> None:
    """A hinge needs a straight line."""
    line = points[-1] - points[0]
    size = float(np.linalg.norm(line))
    off = np.linalg.norm(np.cross(points - points[0], line / size), axis=1).max()
    bent = np.linalg.norm(np.cross(edge.slope, line / size), axis=1) / np.linalg.norm(edge.slope, axis=1)
    if off > STRAIGHT * size or bent.max() > STRAIGHT:
        raise InputError(
            f"the edge is bent: a node lies {off:.3g} m beside the line between its ends",
            source=joint.name,
            key="nodes_a",
            expected="a straight edge",
        )
