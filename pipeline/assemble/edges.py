"""From joints along edges of shells in a case to those that the solver takes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.mesh_shapes import Place, shell_mesh
from heavylift.solver.joints.edges import expand_edge

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.solver.scene.connections import EdgeJoint, Joint
    from heavylift.solver.scene.scene import AnyBody

__all__ = ["assemble_edge", "joints_of_edge"]

NEAR = 1e-6
"""Distance of two nodes that are meant to be at one place, relative to the length of the edge."""


def assemble_edge(case: Case, joint: Any, sides: Mapping[str, Side]) -> EdgeJoint:
    """Hinge or clamp of a case.

    Nodes of the second edge are put in the order of the first.

    Raises
    ------
    InputError
        If a node is not there, or the edges of two shells do not coincide; its key is below the joint.
    """
    given: list[NDArray[np.int64]] = []
    places: list[NDArray[np.float64]] = []
    names = joint.edges or ((joint.edge,) if joint.edge else ())
    for number in range(len(names) or len(joint.node_lists)):
        body = joint.between[number]
        table = case.meshes[body]
        assert table.type == "shell"
        mesh = shell_mesh(Place(case, body), table.geometry)
        nodes = mesh.edges[names[number]] if names else np.array(joint.node_lists[number], dtype=np.int64)
        if nodes.max() >= len(mesh.nodes):
            raise InputError(
                f"there is no node {nodes.max()} in {body!r}",
                key=_key(joint, number),
                expected=f"numbers from 0 to {len(mesh.nodes) - 1}",
            )
        side = sides[body]
        given.append(nodes)
        places.append(side.position + mesh.nodes[nodes] @ side.rotation.T)
    if len(given) == 2:
        given[1] = _matched(joint, given[1], places)
    return joint.DESCRIBED(
        name=joint.name,
        body_a=joint.between[0],
        body_b=joint.between[1],
        nodes_a=given[0],
        nodes_b=given[1] if len(given) == 2 else np.zeros(0, dtype=np.int64),
        compliance=joint.compliance,
        relaxation=joint.relaxation,
    )


def _matched(
    joint: Any, nodes: NDArray[np.int64], places: Sequence[NDArray[np.float64]]
) -> NDArray[np.int64]:
    """Nodes of the second edge in the order of the first."""
    first, second = places
    if len(first) != len(second):
        raise InputError(
            f"{len(first)} nodes of {joint.between[0]!r} and {len(second)} of {joint.between[1]!r}",
            key=_key(joint),
            expected="edges that are divided into the same elements",
        )
    ways = [np.linalg.norm(first - other, axis=1) for other in (second, second[::-1])]
    turned = ways[1].max() < ways[0].max()
    distances = ways[int(turned)]
    if distances.max() > NEAR * np.linalg.norm(np.diff(first, axis=0), axis=1).sum():
        worst = int(np.argmax(distances))
        raise InputError(
            f"the edges do not coincide: node {worst} along them is {1e3 * distances[worst]:.6g} mm from the other one",
            key=_key(joint),
            expected="two edges at one place at the start; 'initial' places a body",
        )
    return nodes[::-1].copy() if turned else nodes


def joints_of_edge(joint: Any, made: EdgeJoint, bodies: Sequence[AnyBody]) -> list[Joint]:
    """Joints of its nodes, as the solver makes them; what it refuses is told by keys of the case."""
    try:
        return expand_edge(made, bodies)
    except InputError as error:
        number = {"nodes_a": 0, "nodes_b": 1}.get(error.key)
        key = error.key if number is None else _key(joint, number)
        raise InputError(error.problem, key=key, expected=error.expected) from None


def _key(joint: Any, number: int | None = None) -> str:
    """Key of the edges of a joint, or of one of them."""
    if joint.edge:
        return "edge"
    key = "edges" if joint.edges else "nodes"
    return key if number is None or (key == "nodes" and len(joint.node_lists) == 1) else f"{key}.{number}"
