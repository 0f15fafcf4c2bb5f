"""Stiffness, mass and constraints of a structure of plates, beams, solids, masses and rigid elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.elasticity import BlockMatrix, NodePattern, stiffness_matrix
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.model import FEModel, MassPoints
from heavylift.preprocess.structures.beam import beam_operators
from heavylift.preprocess.structures.checks import check_structure
from heavylift.preprocess.structures.constraints import constraint_matrix, node_words
from heavylift.preprocess.structures.mass_points import (
    NodePoints,
    beam_points,
    rigid_points,
    shell_points,
    solid_points,
)
from heavylift.preprocess.structures.quadrilateral import quadrilateral_operators
from heavylift.preprocess.structures.shell_operators import BENDING, MEMBRANE, SHEAR, shell_stiffness
from heavylift.preprocess.structures.triangle import triangle_operators

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.structures.shell_operators import ShellOperators
    from heavylift.preprocess.structures.structure import Shells, Structure

__all__ = [
    "CHUNK",
    "MASS_KINDS",
    "assemble_structure",
    "blocks_of",
    "dofs_of",
    "element_motion",
    "rotating_nodes",
    "shell_chunks",
    "shell_groups",
    "shell_operators",
]

MASS_KINDS = ("lumped", "consistent")
CHUNK = 2048
"""Elements handled at once, so that memory does not grow with the structure."""
_RIGID_SHEAR = 1e3
"""Of the ordinary shear stiffness: plates without shear flexibility."""
_NOTHING = 1e-14
"""Of the largest stiffness of its sort: of a degree of freedom that nothing holds."""
_INCLINED = 1e-12
"""Of the largest stiffness of a node against rotation: about an axis that nothing holds."""


def assemble_structure(structure: Structure, *, mass: str = "lumped") -> FEModel:
    """Assemble the finite element model of a structure.

    Parameters
    ----------
    structure
        Plates, beams, solids, masses and what links their nodes.
    mass
        ``"lumped"``: of plates at their nodes, of beams half at each end, with the inertia of thickness and section.
        ``"consistent"``: by the shape functions.

    Returns
    -------
    FEModel
        With rotations of the nodes of plates and beams, its mass as points, and a constraint where nodes follow others.

    Raises
    ------
    InputError
        An unknown kind of mass, plates without thickness, beams without orientation, nodes that nothing holds, links
        that contradict each other, and all that `check_structure` refuses.
    """
    if mass not in MASS_KINDS:
        raise InputError(
            f"{mass!r} is not a kind of mass matrix of structures",
            source=structure.name or "structure",
            key="mass",
            expected="one of " + ", ".join(repr(kind) for kind in MASS_KINDS),
        )
    told = check_structure(structure)
    rotating = rotating_nodes(structure)
    n = structure.node_count
    rotation_dofs = np.full(n, -1, dtype=np.int64)
    rotation_dofs[rotating] = 3 * (n + np.arange(len(rotating)))
    size = 3 * (n + len(rotating))
    parts = _Parts(structure, rotation_dofs, size)
    parts.add_shells(consistent=mass == "consistent")
    parts.add_beams(consistent=mass == "consistent")
    parts.add_solids(consistent=mass == "consistent")
    if structure.masses:
        parts.add_points(rigid_points(structure, structure.masses))
    points = parts.points()
    stiffness = parts.stiffness()
    following = constraint_matrix(structure, rotation_dofs, size)
    fixed, notes = _without_stiffness(structure, rotation_dofs, stiffness, points, following)
    return FEModel(
        nodes=structure.nodes,
        stiffness=stiffness,
        mass=points.matrix(),
        node_groups=structure.node_groups,
        fixed_dofs=fixed,
        name=structure.name,
        notes=(*structure.notes, *told, *notes),
        rotating=rotating,
        points=points,
        constraint=None if following is None else following[0],
        structure=structure,
    )


def rotating_nodes(structure: Structure) -> NDArray[np.int64]:
    """Sorted nodes with rotations: of plates that bend, of beams, of rigid masses beside their node, of rigid links."""
    turning = np.zeros(structure.node_count, dtype=bool)
    for shells in structure.shells:
        if shells.bends:
            turning[shells.elements] = True
    for beams in structure.beams:
        turning[beams.elements] = True
    for one in structure.masses:
        if np.any(one.offset) or np.any(one.inertia):
            turning[one.node] = True
    for average in structure.averages:
        if np.any(average.components[3:]):
            turning[average.node] = True
    # nodes that only links, averages and ties hold pass rotations on
    bare = np.ones(structure.node_count, dtype=bool)
    for elements in [part.elements for part in structure.shells] + [
        part.elements for part in structure.solids
    ]:
        bare[elements] = False
    count = -1
    while count != (count := int(turning.sum())):
        for link in structure.links:
            dependent = link.dependent
            apart = structure.nodes[dependent] != structure.nodes[link.node]
            if apart.any() or turning[dependent].any():
                turning[link.node] = True
            if turning[link.node] and np.any(link.components[3:]):
                turning[dependent[bare[dependent]]] = True
        for tie in structure.ties:
            pair = np.array([tie.node, tie.dependent])
            if np.any(tie.components[3:]) and turning[pair].any():
                turning[pair[bare[pair]]] = True
    return np.flatnonzero(turning)


def shell_groups(structure: Structure) -> list[list[Shells]]:
    """Properties whose matrices have one pattern: quadrilaterals or triangles, that bend or do not."""
    groups: dict[tuple[int, bool], list[Shells]] = {}
    for part in structure.shells:
        if len(part.elements):
            groups.setdefault((part.elements.shape[1], part.bends), []).append(part)
    return list(groups.values())


def shell_operators(
    nodes: NDArray[np.float64],
    shells: Shells,
    elements: NDArray[np.int64],
    thickness: NDArray[np.float64],
    offset: NDArray[np.float64],
) -> ShellOperators:
    """Strains of some elements of a property, given with their thickness and offset [m], shape (ne,).

    A membrane has neither bending nor drilling and does not feel rotations; a plate that only bends has no strain
    of its mid-surface.
    """
    nu = shells.material.poisson_ratio
    if elements.shape[1] == 4:
        found = quadrilateral_operators(nodes[elements], offset, nu)
    else:
        found = triangle_operators(nodes[elements], offset, nu, thickness)
    if not shells.stretches:
        found.strain[:, :, MEMBRANE] = 0.0
        found.drilling[:] = 0.0
    if not shells.bends:
        found.strain[:, :, BENDING] = found.strain[:, :, SHEAR] = 0.0
        found.strain.reshape(*found.strain.shape[:3], -1, 6)[..., 3:] = 0.0
        found.drilling[:] = 0.0
    return found


def shell_chunks(
    structure: Structure, shells: Shells
) -> Iterator[tuple[slice, NDArray[np.int64], ShellOperators, NDArray[np.float64], NDArray[np.float64]]]:
    """Yield which elements, their nodes, operators, thickness and offset [m], `CHUNK` elements at a time.

    Raises
    ------
    InputError
        A thickness that is not positive.
    """
    count = len(shells.elements)
    thickness = np.broadcast_to(np.asarray(shells.thickness, dtype=np.float64), (count,))
    offset = np.broadcast_to(np.asarray(shells.offset, dtype=np.float64), (count,))
    wrong = np.flatnonzero(~(np.isfinite(thickness) & (thickness > 0.0) & np.isfinite(offset)))
    if wrong.size:
        i = int(wrong[0])
        number = int(shells.numbers[i]) if shells.numbers.size else i + 1
        x, y, z = structure.nodes[shells.elements[i]].mean(axis=0)
        raise InputError(
            f"thickness {thickness[i]:g} m, offset {offset[i]:g} m ({wrong.size} such plates)",
            source=structure.name or "structure",
            key=f"plate {number} of {shells.name} at ({x:.6g}, {y:.6g}, {z:.6g}) m",
            expected="a positive thickness and a finite offset",
        )
    for start in range(0, count, CHUNK):
        part = slice(start, min(start + CHUNK, count))
        elements = shells.elements[part]
        operators = shell_operators(structure.nodes, shells, elements, thickness[part], offset[part])
        yield part, elements, operators, thickness[part], offset[part]


def blocks_of(model: FEModel, elements: NDArray[np.int64], rotations: bool = True) -> NDArray[np.int64]:
    """Blocks of three degrees of freedom of the nodes of elements (ne, k): displacement, rotation in turn, (ne, 2 k).

    Without rotations the nodes themselves.
    """
    return _blocks(model.rotation_dofs, elements) if rotations else elements


def _blocks(rotation_dofs: NDArray[np.int64], elements: NDArray[np.int64]) -> NDArray[np.int64]:
    ne, width = elements.shape
    return np.stack([elements, rotation_dofs[elements] // 3], axis=2).reshape(ne, 2 * width)


def dofs_of(model: FEModel, elements: NDArray[np.int64]) -> NDArray[np.int64]:
    """Degrees of freedom of the nodes of elements (ne, k), six a node, -1 for rotations not there, (ne, 6 k)."""
    ne, width = elements.shape
    first = model.rotation_dofs[elements]
    index = np.stack([3 * elements, first], axis=2)[..., None] + np.arange(3)
    index[first < 0, 1] = -1
    return index.reshape(ne, 6 * width)


def element_motion(
    model: FEModel, elements: NDArray[np.int64], displacements: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Displacements and rotations of the nodes of elements (ne, k) from those of the model (N,), shape (ne, 6 k).

    Rotations of nodes without any are zero.
    """
    index = dofs_of(model, elements)
    return np.where(index >= 0, displacements[index], 0.0)


class _Parts:
    """Sums of matrices and points of a structure."""

    def __init__(self, structure: Structure, rotation_dofs: NDArray[np.int64], size: int) -> None:
        self.structure, self.rotation_dofs, self.size = structure, rotation_dofs, size
        self._matrices: list[csr_array] = []
        self._operators: list[csr_array] = []
        self._positions: list[NDArray[np.float64]] = []
        self._masses: list[NDArray[np.float64]] = []

    def add_shells(self, *, consistent: bool) -> None:
        """Add all plates."""
        for group in shell_groups(self.structure):
            elements = np.concatenate([part.elements for part in group])
            blocks = _blocks(self.rotation_dofs, elements) if group[0].bends else elements
            matrix = BlockMatrix(NodePattern(blocks, self.size // 3))
            first = 0
            for shells in group:
                self._add_property(matrix, first, shells, consistent=consistent)
                first += len(shells.elements)
            self._matrices.append(matrix.tocsr())

    def _add_property(self, matrix: BlockMatrix, first: int, shells: Shells, *, consistent: bool) -> None:
        for part, elements, operators, thickness, offset in shell_chunks(self.structure, shells):
            K = shell_stiffness(
                operators,
                shells.material,
                thickness,
                bending_factor=shells.bending_factor,
                shear_factor=shells.shear_factor or _RIGID_SHEAR,
            )
            if not shells.bends:
                ne, columns, _ = K.shape
                K = K.reshape(ne, columns // 6, 2, 3, columns // 6, 2, 3)[:, :, 0, :, :, 0]
                K = K.reshape(ne, columns // 2, columns // 2)
            matrix.add(first + part.start, K)
            self.add_points(
                shell_points(
                    self.structure, shells, elements, operators, thickness, offset, consistent=consistent
                )
            )

    def add_beams(self, *, consistent: bool) -> None:
        """Add all beams."""
        beams = [part for part in self.structure.beams if len(part.elements)]
        if not beams:
            return
        pattern = NodePattern(
            _blocks(self.rotation_dofs, np.concatenate([part.elements for part in beams])), self.size // 3
        )
        matrix = BlockMatrix(pattern)
        first = 0
        for part in beams:
            operators = beam_operators(self.structure.nodes, part, source=self.structure.name or "structure")
            matrix.add(first, operators.stiffness)
            first += len(part.elements)
            self.add_points(beam_points(part, operators, consistent=consistent))
        self._matrices.append(matrix.tocsr())

    def add_solids(self, *, consistent: bool) -> None:
        """Add all solids."""
        for solids in self.structure.solids:
            mesh = Mesh(self.structure.nodes, solids.elements, solids.element_type, name=self.structure.name)
            K = stiffness_matrix(mesh, solids.material)
            K.resize((self.size, self.size))
            self._matrices.append(K)
            for points in solid_points(self.structure, solids, consistent=consistent):
                self.add_points(points)

    def add_points(self, points: NodePoints) -> None:
        """Add points of mass."""
        from scipy.sparse import csr_array

        count, width = points.nodes.shape
        columns = np.empty((count, width, 6), dtype=np.int64)
        columns[..., :3] = 3 * points.nodes[..., None] + np.arange(3)
        columns[..., 3:] = self.rotation_dofs[points.nodes][..., None] + np.arange(3)
        blocks = points.blocks.reshape(count, 3, width * 6)
        used = (blocks != 0.0) & np.repeat(
            np.stack([np.ones_like(points.nodes, dtype=bool), self.rotation_dofs[points.nodes] >= 0], axis=2),
            3,
            axis=2,
        ).reshape(count, 1, width * 6)
        index = np.broadcast_to(columns.reshape(count, 1, width * 6), blocks.shape)[used]
        starts = np.concatenate([[0], np.cumsum(used.sum(axis=2).ravel())])
        self._operators.append(csr_array((blocks[used], index, starts), shape=(3 * count, self.size)))
        self._positions.append(points.positions)
        self._masses.append(points.masses)

    def points(self) -> MassPoints:
        """All points of mass."""
        from scipy.sparse import csr_array, vstack

        operator = (
            csr_array(vstack(self._operators, format="csr")) if self._operators else csr_array((0, self.size))
        )
        operator.sort_indices()
        return MassPoints(
            np.concatenate([np.empty((0, 3)), *self._positions]),
            np.concatenate([np.empty(0), *self._masses]),
            operator,
        )

    def stiffness(self) -> csr_array:
        """Sum of all matrices."""
        from scipy.sparse import csr_array

        total = csr_array((self.size, self.size))
        for matrix in self._matrices:
            total = matrix if total.nnz == 0 else csr_array(total + matrix)
        return total


def _without_stiffness(
    structure: Structure,
    rotation_dofs: NDArray[np.int64],
    stiffness: csr_array,
    points: MassPoints,
    following: tuple[csr_array, NDArray[np.int64]] | None,
) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """Rotations that nothing holds and that carry no inertia: held, and told. Refuses all others.

    Raises
    ------
    InputError
        Displacements that nothing holds; rotations of rigid masses, or about an inclined axis, that nothing holds.
    """
    n = structure.node_count
    free = np.arange(stiffness.shape[0])
    constraint = None
    diagonal = stiffness.diagonal()
    squares = points.operator.power(2)
    if following is not None:
        constraint, free = following
        diagonal = np.asarray((constraint * (stiffness @ constraint)).sum(axis=0)).ravel()
        squares = (points.operator @ constraint).power(2)
    turns = free >= 3 * n
    loose = np.zeros(len(free), dtype=bool)
    for sort in (turns, ~turns):
        loose[sort] = diagonal[sort] <= _NOTHING * diagonal[sort].max(initial=0.0)
    _refuse_inclined(structure, rotation_dofs, stiffness, constraint, free, loose)
    if not loose.any():
        return np.empty(0, dtype=np.int64), ()
    inertia = np.asarray(squares.T @ np.repeat(np.abs(points.masses), 3)).ravel()
    node_of = np.concatenate([np.repeat(np.arange(n), 3), np.repeat(np.flatnonzero(rotation_dofs >= 0), 3)])
    wrong = np.flatnonzero(loose & (~turns | (inertia > 0.0)))
    if wrong.size:
        node, moves = node_of[free[wrong[0]]], "turns" if turns[wrong[0]] else "moves"
        raise InputError(
            f"nothing holds {np.unique(node_of[free[wrong]]).size} nodes against all motions",
            source=structure.name or "structure",
            key=f"{node_words(structure, node)}, which {moves} freely along axis {free[wrong[0]] % 3 + 1}",
            expected="every node in a plate, a beam or a solid, or following such nodes by a rigid link, an average or "
            "a tie; rigid masses with inertia on nodes that have rotations",
        )
    held = free[loose]
    note = (
        f"{len(held)} rotations of {np.unique(node_of[held]).size} nodes are held, as nothing else holds them"
    )
    return held, (note,)


def _refuse_inclined(
    structure: Structure,
    rotation_dofs: NDArray[np.int64],
    stiffness: csr_array,
    constraint: csr_array | None,
    free: NDArray[np.int64],
    loose: NDArray[np.bool_],
) -> None:
    """Refuse nodes that turn freely about an inclined axis, as those that rigid links join to a line of solid nodes.

    `loose` are the free degrees of freedom that have no stiffness at all.
    """
    suspect = rotation_dofs >= 0
    for shells in structure.shells:
        if shells.bends:
            suspect[shells.elements] = False
    for beams in structure.beams:
        if not np.any(beams.released):
            suspect[beams.elements] = False
    place = np.full(stiffness.shape[0], -1, dtype=np.int64)
    place[free] = np.arange(len(free))
    nodes = np.flatnonzero(suspect)
    columns = place[rotation_dofs[nodes][:, np.newaxis] + np.arange(3)]
    nodes, columns = nodes[(columns >= 0).all(axis=1)], columns[(columns >= 0).all(axis=1)]
    if not len(nodes):
        return
    flat = columns.ravel()
    own = stiffness[free[flat]][:, free[flat]]
    if constraint is not None:
        motion = constraint[:, flat]
        own = motion.T @ (stiffness @ motion)
    blocks = np.empty((len(nodes), 3, 3))
    first = 3 * np.arange(len(nodes))
    for i in range(3):
        for j in range(3):
            blocks[:, i, j] = np.asarray(own[first + i, first + j]).ravel()
    largest = np.maximum(np.einsum("nii->ni", blocks).max(axis=1), np.finfo(np.float64).tiny)
    idle = loose[columns]
    blocks[idle] = 0.0
    blocks.transpose(0, 2, 1)[idle] = 0.0
    blocks[:, np.arange(3), np.arange(3)] += idle * largest[:, np.newaxis]
    values, axes = np.linalg.eigh(blocks)
    wrong = np.flatnonzero(values[:, 0] <= _INCLINED * largest)
    if wrong.size:
        axis = ", ".join(f"{x:.3g}" for x in axes[wrong[0], :, 0])
        raise InputError(
            f"turns freely about the axis ({axis}) ({wrong.size} such nodes)",
            source=structure.name or "structure",
            key=node_words(structure, int(nodes[wrong[0]])),
            expected="a rigid link to nodes that are not on one line, or to nodes of plates and beams",
        )
