"""Where the mass of plates, beams, solids and rigid masses is, as points that move with the nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.preprocess.finite_elements.elasticity import consistent_mass_rule, mass_matrix
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.structures.beam import beam_shapes, principal_angle, skew

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from heavylift.preprocess.structures.beam import BeamOperators
    from heavylift.preprocess.structures.shell_operators import ShellOperators
    from heavylift.preprocess.structures.structure import Beams, PointMass, Shells, Solids, Structure

__all__ = ["NodePoints", "beam_points", "rigid_points", "shell_points", "solid_points"]

_GAUSS_BEAM = 4  # points along a beam: exact for products of cubic shape functions
_GAUSS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) / np.sqrt(3.0)


class NodePoints(NamedTuple):
    """Points that move with some nodes each.

    Attributes
    ----------
    nodes
        Shape (m, k).
    positions
        [m], shape (m, 3).
    masses
        [kg], shape (m,).
    blocks
        Displacements from displacements and rotations of the nodes, axes of the structure, shape (m, 3, k, 6).
    """

    nodes: NDArray[np.int64]
    positions: NDArray[np.float64]
    masses: NDArray[np.float64]
    blocks: NDArray[np.float64]


def shell_points(
    structure: Structure,
    shells: Shells,
    elements: NDArray[np.int64],
    operators: ShellOperators,
    thickness: NDArray[np.float64],
    offset: NDArray[np.float64],
    *,
    consistent: bool,
) -> NodePoints:
    """Mass of shells as pairs of points on both sides of the mid-surface.

    Pairs at ``+-t / (2 sqrt 3)`` have the second moment ``t^3 / 12`` of the thickness; non-structural mass, which has
    none, brings them closer. Nothing turns about the normal.

    Parameters
    ----------
    structure, shells
        The plates are of.
    elements
        Nodes, shape (ne, 3) or (ne, 4).
    operators
        Of these elements.
    thickness, offset
        [m], shape (ne,).
    consistent
        Points of integration that move as all nodes of the element do: four, or the three middles of the edges, which
        integrate products of shape functions exactly. Else at the nodes, with ``int N_a dm`` each.
    """
    ne, width = elements.shape
    plate = shells.material.density * thickness
    whole = plate + shells.nonstructural_mass
    side = thickness / np.sqrt(12.0) * np.sqrt(plate / whole)
    if consistent:
        shape = operators.shape
        share = operators.area * whole[:, None]
    else:
        shape = np.eye(width)
        share = np.matmul(operators.area, operators.shape) * whole[:, None]
    points = shape.shape[0]
    places = np.matmul(shape, structure.nodes[elements])  # (ne, points, 3)
    normal = operators.axes[:, 2]
    sides = offset[:, None] + side[:, None] * np.array([-1.0, 1.0])  # (ne, 2)
    arms = sides[..., None] * normal[:, None]
    motion = np.concatenate([np.broadcast_to(np.eye(3), (ne, 2, 3, 3)), -skew(arms)], axis=3)  # (ne, 2, 3, 6)
    positions = places[:, :, None] + arms[:, None]
    masses = np.repeat(0.5 * share[:, :, None], 2, axis=2)
    if not consistent:
        nodes = np.repeat(elements[:, :, None], 2, axis=2)
        blocks = np.broadcast_to(motion[:, None], (ne, points, 2, 3, 6))
        return NodePoints(
            nodes.reshape(-1, 1), positions.reshape(-1, 3), masses.ravel(), blocks.reshape(-1, 3, 1, 6)
        )
    nodes = np.broadcast_to(elements[:, None, None], (ne, points, 2, width))
    blocks = np.einsum("pa,esij->epsiaj", shape, motion)
    return NodePoints(
        nodes.reshape(-1, width), positions.reshape(-1, 3), masses.ravel(), blocks.reshape(-1, 3, width, 6)
    )


def beam_points(beams: Beams, operators: BeamOperators, *, consistent: bool) -> NodePoints:
    """Mass of beams as four points in each of some sections, whose second moments are those of the section.

    Parameters
    ----------
    beams
        Of one section.
    operators
        Of all of them.
    consistent
        Sections at four points of Gauss that move by the static shape functions, which integrates the mass matrix
        exactly. Else half of the mass at each end.

    Notes
    -----
    A pair at ``+-a`` on a principal axis with half of the mass has the second moment ``m a^2 / 2 = rho I L``.
    Non-structural mass is taken at the centroid.
    """
    section, ne = beams.section, len(beams.elements)
    density = beams.material.density * section.area
    line = density + section.nonstructural_mass
    if consistent:
        at, weights = np.polynomial.legendre.leggauss(_GAUSS_BEAM)
        at, weights = 0.5 * (1.0 + at), 0.5 * weights
    else:
        at, weights = np.array([0.0, 1.0]), np.array([0.5, 0.5])
    shapes = beam_shapes(beams.material, section, operators.length, at)
    arms = _section_points(beams, line)
    motion = np.concatenate([np.broadcast_to(np.eye(3), (4, 3, 3)), -skew(arms)], axis=2)  # (4, 3, 6)
    local = np.einsum("kij,emjc->emkic", motion, shapes)
    # along the axes of the structure, from the nodes
    blocks = np.einsum(
        "eji,emkjc,ecd->emkid", operators.axes, local, operators.ends_from_nodes, optimize=True
    )
    centres = (1.0 - at)[:, None] * operators.ends[:, :1] + at[:, None] * operators.ends[:, 1:]
    positions = centres[:, :, None] + np.matmul(arms, operators.axes)[:, None]
    masses = 0.25 * line * operators.length[:, None, None] * weights[None, :, None]
    points = len(at) * 4
    return NodePoints(
        np.repeat(beams.elements, points, axis=0),
        positions.reshape(-1, 3),
        np.broadcast_to(masses, (ne, len(at), 4)).ravel(),
        blocks.reshape(-1, 3, 2, 6),
    )


def _section_points(beams: Beams, line: float) -> NDArray[np.float64]:
    """Four places in a section relative to its centroid, along the axes of the beam [m], shape (4, 3)."""
    section = beams.section
    angle = principal_angle(section)
    c, s = float(np.cos(angle)), float(np.sin(angle))
    I1, I2, I12 = section.second_moment_1, section.second_moment_2, section.product
    along = np.array([[0.0, c, s], [0.0, -s, c]])
    moments = np.array(
        [c * c * I1 + s * s * I2 + 2.0 * c * s * I12, s * s * I1 + c * c * I2 - 2.0 * c * s * I12]
    )
    distance = np.sqrt(2.0 * beams.material.density * moments / line) if line > 0.0 else np.zeros(2)
    return np.concatenate([distance[:, None] * along, -distance[:, None] * along])


def rigid_points(structure: Structure, masses: tuple[PointMass, ...]) -> NodePoints:
    """Rigid masses as seven points each: a pair on each principal axis of their inertia, and the rest at the centre.

    With J the principal moments the second moment along axis k is ``(J_i + J_j - J_k) / 2``.
    """
    nodes, positions, shares, arms = [], [], [], []
    for one in masses:
        J, axes = np.linalg.eigh(np.asarray(one.inertia, dtype=np.float64))
        second = 0.5 * J.sum() - J
        largest = float(np.abs(second).max())
        distance = np.sqrt(3.0 * largest / one.mass) if one.mass > 0.0 and largest > 0.0 else 1.0
        pairs = second / (2.0 * distance**2)
        local = np.concatenate([distance * axes.T, -distance * axes.T, np.zeros((1, 3))])
        share = np.concatenate([pairs, pairs, [one.mass - 2.0 * pairs.sum()]])
        used = share != 0.0
        arms.append((np.asarray(one.offset) + local)[used])
        shares.append(share[used])
        nodes.append(np.full(int(used.sum()), one.node))
    arm = np.concatenate(arms)
    node = np.concatenate(nodes)
    positions = structure.nodes[node] + arm
    blocks = np.concatenate([np.broadcast_to(np.eye(3), (len(arm), 3, 3)), -skew(arm)], axis=2)
    return NodePoints(node[:, None], positions, np.concatenate(shares), blocks[:, :, None])


def solid_points(structure: Structure, solids: Solids, *, consistent: bool) -> Iterator[NodePoints]:
    """Mass of solids: at points of integration, or at the nodes, as `mass_matrix` lumps it."""
    mesh = Mesh(structure.nodes, solids.elements, solids.element_type, name=structure.name)
    still = np.concatenate([np.eye(3), np.zeros((3, 3))], axis=1)
    if not consistent:
        lumps = mass_matrix(mesh, solids.material.density, kind="lumped").diagonal()
        nodes = np.flatnonzero(lumps)
        blocks = np.broadcast_to(still[None, :, None], (len(nodes), 3, 1, 6))
        yield NodePoints(nodes[:, None], structure.nodes[nodes], lumps[nodes], blocks)
        return
    for elements, shape, volumes in consistent_mass_rule(mesh):
        positions = np.matmul(shape, structure.nodes[elements])
        ne, points = volumes.shape
        blocks = np.einsum("pa,ij->piaj", shape, still)
        yield NodePoints(
            np.repeat(elements, points, axis=0),
            positions.reshape(-1, 3),
            solids.material.density * volumes.ravel(),
            np.broadcast_to(blocks, (ne, *blocks.shape)).reshape(-1, *blocks.shape[1:]),
        )
