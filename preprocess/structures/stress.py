"""Stress of plates and beams as sparse operators on the degrees of freedom of a model.

Plates: ``sigma(z) = D (eps + z kappa)``, the membrane part that of the mid-surface, the bending part that of the
side of the normal; top is their sum and bottom their difference. Strains are those of the elements, incompatible modes
included. At nodes they are extrapolated from the points of integration, turned to common axes and averaged over the
elements of one property that join there smoothly; where the thickness or the normal jumps a node has several points.

Beams: normal stress at the corners of the section at both ends, from normal force and both moments, and the mean shear
stress of plane 1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.preprocess.structures.assemble import dofs_of, shell_chunks
from heavylift.preprocess.structures.beam import beam_operators
from heavylift.preprocess.structures.shell_operators import BENDING, MEMBRANE, plane_stress

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.model import FEModel
    from heavylift.preprocess.structures.structure import Beams, Shells, Structure

__all__ = ["SMOOTH", "BeamStress", "ShellStress", "beam_stress", "shell_stress"]

SMOOTH = np.radians(20.0)
"""Angle between the normals of neighbours up to which their stresses are averaged [rad]."""

_TRIANGLE = np.array(
    [[1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, 1.0]]
)  # corners from middles 12, 23, 31
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
# corners from 2 x 2 points: bilinear at sqrt(3) times their distance
_QUADRILATERAL = 0.25 * (1.0 + np.sqrt(3.0) * _CORNERS[:, None] * _CORNERS[None]).prod(axis=2)
_LESS_STEEP = 0.9  # cosine between a normal and the x axis from which axis 1 of the stress follows y


class ShellStress(NamedTuple):
    """Stress of plates of one property at some points.

    Attributes
    ----------
    positions
        Mid-surface [m], shape (m, 3).
    nodes
        That each point belongs to, shape (m,); -1 at centres of elements.
    elements
        Zero-based element of the property at each point, shape (m,): one of those that are averaged.
    thickness
        [m], shape (m,).
    axes
        Rows are the axes of the stress and the normal, shape (m, 3, 3): axis 1 is the x axis of the structure, laid
        into the plate, or y where the plate faces x.
    membrane, bending
        xx, yy, xy of each point in turn [Pa], sparse (3 m, N); top is ``membrane + bending``.
    """

    positions: NDArray[np.float64]
    nodes: NDArray[np.int64]
    elements: NDArray[np.int64]
    thickness: NDArray[np.float64]
    axes: NDArray[np.float64]
    membrane: csr_array
    bending: csr_array


class BeamStress(NamedTuple):
    """Stress of beams of one section at its corners, at both ends.

    Attributes
    ----------
    positions
        [m], shape (m, 3).
    nodes
        That each end belongs to, shape (m,).
    elements
        Zero-based beam of the property, shape (m,).
    corners
        Which corner of the section, shape (m,).
    normal
        Along the beam [Pa], tension positive, sparse (m, N).
    shear
        Mean one of the shear area in plane 1 [Pa], sparse (m, N); zero where the section has none.
    forces
        N, V_1, V_2 [N] and T, M_2, M_3 [N m] on the positive face, at the first end, then the second, of all beams,
        sparse (12 ne, N).
    """

    positions: NDArray[np.float64]
    nodes: NDArray[np.int64]
    elements: NDArray[np.int64]
    corners: NDArray[np.int64]
    normal: csr_array
    shear: csr_array
    forces: csr_array


def shell_stress(structure: Structure, shells: Shells, model: FEModel, *, at: str = "nodes") -> ShellStress:
    """Stress of the plates of a property.

    Parameters
    ----------
    structure
        That the model was assembled from.
    shells
        One of its properties.
    model
        Of the structure.
    at
        ``"nodes"`` or ``"centres"`` of the elements.
    """
    from scipy.sparse import csr_array

    elements = shells.elements
    ne, width = elements.shape
    corner = _QUADRILATERAL if width == 4 else _TRIANGLE
    chunks = list(_chunks(structure, shells))
    axes = np.concatenate([chunk.axes for chunk in chunks])
    thickness = np.concatenate([chunk.thickness for chunk in chunks])
    offset = np.concatenate([chunk.offset for chunk in chunks])
    if at == "nodes":
        point, count = _smooth_points(elements, axes[:, 2], thickness)
        first = np.full(count, -1, dtype=np.int64)
        first[point.ravel()[::-1]] = np.arange(ne * width)[::-1]
        owner, nodes = first // width, elements.ravel()[first]
        weights, here = corner, structure.nodes[nodes]
    else:
        point, count = np.arange(ne)[:, None], ne
        owner, nodes = np.arange(ne), np.full(ne, -1)
        weights = np.full((1, corner.shape[0]), 1.0 / corner.shape[0])
        here = structure.nodes[elements].mean(axis=1)
    normal = np.zeros((count, 3))
    np.add.at(normal, point.ravel(), np.repeat(axes[:, 2], point.shape[1], axis=0))
    common = _common_axes(normal / np.linalg.norm(normal, axis=1, keepdims=True))
    share = 1.0 / np.bincount(point.ravel(), minlength=count)

    matrices = []
    for kind in (0, 1):
        data = np.concatenate([chunk.stress[kind] for chunk in chunks])  # (ne, points, 3, 6 nodes)
        at_points = np.einsum("aq,eqsj->easj", weights, data, optimize=True)
        turned = np.matmul(_turn(axes[:, None], common[point]), at_points) * share[point][..., None, None]
        rows = np.broadcast_to(3 * point[..., None, None] + np.arange(3)[:, None], turned.shape)
        columns = np.broadcast_to(dofs_of(model, elements)[:, None, None], turned.shape)
        used = columns >= 0
        matrix = csr_array((turned[used], (rows[used], columns[used])), shape=(3 * count, model.dof_count))
        matrices.append(matrix)
    return ShellStress(
        positions=here + offset[owner][:, None] * axes[owner, 2],
        nodes=nodes,
        elements=owner,
        thickness=thickness[owner],
        axes=common,
        membrane=matrices[0],
        bending=matrices[1],
    )


def beam_stress(structure: Structure, beams: Beams, model: FEModel) -> BeamStress:
    """Stress of the beams of a section; at its centroid if its corners are not known.

    Notes
    -----
    ``sigma = N/A - y k_3 + z k_2`` with ``(k_3, k_2) = ((I_2, I_12), (I_12, I_1)) (M_3, M_2) / (I_1 I_2 - I_12^2)``.
    """
    from scipy.sparse import csr_array

    section = beams.section
    operators = beam_operators(structure.nodes, beams, source=structure.name or "structure")
    ne = len(beams.elements)
    forces = np.matmul(operators.local, operators.ends_from_nodes)  # (ne, 12, 12)
    forces[:, :6] *= -1.0  # on the positive face
    I1, I2, I12 = section.second_moment_1, section.second_moment_2, section.product
    corners = section.corners if len(section.corners) else np.zeros((1, 2))
    y, z = corners.T
    determinant = I1 * I2 - I12**2
    rows = np.zeros((len(corners), 6))
    rows[:, 0] = 1.0 / section.area
    rows[:, 5] = (-y * I2 + z * I12) / determinant
    rows[:, 4] = (-y * I12 + z * I1) / determinant
    by_end = forces.reshape(ne, 2, 6, 12)
    normal = np.matmul(rows, by_end)  # (ne, 2, corners, 12)
    shear = np.repeat(by_end[:, :, 1:2] / section.shear_area_1, len(corners), axis=2)
    places = np.concatenate([np.zeros((len(corners), 1)), corners], axis=1)
    positions = operators.ends[:, :, None] + np.matmul(places, operators.axes)[:, None]
    columns = dofs_of(model, beams.elements)

    def sparse(values: NDArray[np.float64]) -> csr_array:
        count = values.size // 12
        index = np.repeat(columns, count // max(ne, 1), axis=0)
        return csr_array(
            (values.ravel(), index.ravel(), np.arange(0, 12 * count + 1, 12)), shape=(count, model.dof_count)
        )

    each = len(corners)
    return BeamStress(
        positions=positions.reshape(-1, 3),
        nodes=np.repeat(beams.elements.ravel(), each),
        elements=np.repeat(np.arange(ne), 2 * each),
        corners=np.tile(np.arange(each), 2 * ne),
        normal=sparse(normal),
        shear=sparse(shear),
        forces=sparse(forces),
    )


def _chunks(structure: Structure, shells: Shells) -> Iterator[_Chunk]:
    """Yield what stress is made of, some elements at a time."""
    C = plane_stress(shells.material)
    for _, _, operators, thickness, offset in shell_chunks(structure, shells):
        membrane = np.matmul(C, operators.strain[:, :, MEMBRANE])
        bending = np.matmul(C, operators.strain[:, :, BENDING]) * (0.5 * thickness)[:, None, None, None]
        yield _Chunk((membrane, bending), operators.axes, thickness, offset)


class _Chunk(NamedTuple):
    """Membrane and bending stress at the points of integration (ne, points, 3, 6 nodes); axes, thickness, offset."""

    stress: tuple[NDArray[np.float64], NDArray[np.float64]]
    axes: NDArray[np.float64]
    thickness: NDArray[np.float64]
    offset: NDArray[np.float64]


def _smooth_points(
    elements: NDArray[np.int64], normals: NDArray[np.float64], thickness: NDArray[np.float64]
) -> tuple[NDArray[np.int64], int]:
    """Point of every corner of every element (ne, width), and their number.

    Corners at one node are one point if a chain of elements joins them, each with a common edge at the node, the same
    thickness and nearly the same normal as the next.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ne, width = elements.shape
    here = np.arange(width)
    after = (here + 1) % width
    a, b = elements.ravel(), elements[:, after].ravel()
    edge = np.minimum(a, b) * (int(elements.max()) + 1) + np.maximum(a, b)
    order = np.argsort(edge, kind="stable")
    pairs = []
    # elements at an edge are neighbours in this order; of three or more at one edge all pairs count
    for step in range(1, int(np.bincount(np.unique(edge, return_inverse=True)[1]).max())):
        first, second = order[:-step], order[step:]
        same = edge[first] == edge[second]
        pairs.append(np.stack([first[same], second[same]]))
    one, other = np.concatenate([np.empty((2, 0), dtype=np.int64), *pairs], axis=1)
    e, f = one // width, other // width
    close = np.einsum("pi,pi->p", normals[e], normals[f]) >= np.cos(SMOOTH)
    close &= thickness[e] == thickness[f]
    one, other, e, f = one[close], other[close], e[close], f[close]
    # both ends of the edge, whichever way the neighbour runs along it
    turned = a[one] != a[other]
    one_ends = np.stack([one, e * width + (one % width + 1) % width])
    other_ends = np.stack([other, f * width + (other % width + 1) % width])
    other_ends = np.where(turned, other_ends[::-1], other_ends)
    i, j = one_ends.ravel(), other_ends.ravel()
    graph = coo_array((np.ones(len(i)), (i, j)), shape=(ne * width, ne * width))
    count, label = connected_components(graph, directed=False)
    return label.reshape(ne, width).astype(np.int64), int(count)


def _common_axes(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Axes in plates of given normals (m, 3) that do not depend on elements, shape (m, 3, 3)."""
    along = np.where((np.abs(normal[:, 0]) > _LESS_STEEP)[:, None], np.eye(3)[1], np.eye(3)[0])
    e1 = along - np.einsum("mi,mi->m", along, normal)[:, None] * normal
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    return np.stack([e1, np.cross(normal, e1), normal], axis=1)


def _turn(axes: NDArray[np.float64], common: NDArray[np.float64]) -> NDArray[np.float64]:
    """Stress xx, yy, xy along common axes from that along axes of an element, shape (..., 3, 3).

    Stress stays in the plate: of a plate that is inclined to the mean one the turn about the normal alone is taken, the
    rotation next to the projection.
    """
    R = np.matmul(common[..., :2, :], np.swapaxes(axes, -1, -2)[..., :2])
    angle = np.arctan2(R[..., 0, 1] - R[..., 1, 0], R[..., 0, 0] + R[..., 1, 1])
    c, s = np.cos(angle), np.sin(angle)
    rows = [[c * c, s * s, 2.0 * c * s], [s * s, c * c, -2.0 * c * s], [-c * s, c * s, c * c - s * s]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))
