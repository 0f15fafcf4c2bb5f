"""Published problems of plates and shells as structures: nodes, elements, supports, loads."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.finite_elements.model import FEModel
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.structure import Shells, Structure


@dataclass
class Problem:
    """A model with what is held and what pulls."""

    model: FEModel
    held: NDArray[np.bool_] = field(init=False)
    load: NDArray[np.float64] = field(init=False)

    def __post_init__(self) -> None:
        self.held = np.zeros(self.model.dof_count, dtype=bool)
        self.held[self.model.fixed_dofs] = True
        self.load = np.zeros(self.model.dof_count)

    @property
    def nodes(self) -> NDArray[np.float64]:
        return self.model.nodes

    def dofs(self, nodes: NDArray[np.bool_] | NDArray[np.int64], components: str) -> NDArray[np.int64]:
        """Of some nodes; components of "xyz" (displacements) and "XYZ" (rotations)."""
        index = np.flatnonzero(nodes) if np.asarray(nodes).dtype == bool else np.atleast_1d(nodes)
        found = [3 * index + "xyz".index(c) for c in components if c in "xyz"]
        found += [self.model.rotation_dofs[index] + "XYZ".index(c) for c in components if c in "XYZ"]
        return np.concatenate(found)

    def hold(self, nodes: NDArray[np.bool_] | NDArray[np.int64], components: str = "xyzXYZ") -> None:
        self.held[self.dofs(nodes, components)] = True

    def push(
        self, nodes: NDArray[np.bool_] | NDArray[np.int64], component: str, force: NDArray[np.float64] | float
    ) -> None:
        self.load[self.dofs(nodes, component)] += force

    def solve(self, load: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """Displacements and rotations, shape (N,)."""
        free = np.flatnonzero(~self.held)
        u = np.zeros(self.model.dof_count)
        K = self.model.stiffness[free][:, free].tocsc()
        u[free] = splu(
            K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        ).solve((self.load if load is None else load)[free])
        return u

    def frequencies(self, count: int, shift: float) -> NDArray[np.float64]:
        """Lowest natural frequencies [Hz], by shift and invert about a negative eigenvalue -shift [1/s2]."""
        from scipy.sparse.linalg import LinearOperator, eigsh

        free = np.flatnonzero(~self.held)
        K, M = (matrix[free][:, free].tocsc() for matrix in (self.model.stiffness, self.model.mass))
        factor = splu(
            K + shift * M, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
        inverse = LinearOperator(K.shape, matvec=factor.solve, dtype=float)
        start = M @ np.random.default_rng(0).normal(size=len(free))
        values = eigsh(
            K, count, M, sigma=-shift, OPinv=inverse, v0=factor.solve(start), return_eigenvectors=False
        )
        return np.sqrt(np.maximum(np.sort(values), 0.0)) / (2.0 * np.pi)


def grid(nx: int, ny: int, *, triangles: bool = False) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Unit square in nx x ny cells: parameters (n, 2), and quadrilaterals or, cut along one diagonal, triangles."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, nx + 1), np.linspace(0.0, 1.0, ny + 1), indexing="ij")
    index = np.arange(s.size).reshape(s.shape)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    elements = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]) if triangles else quads
    return np.column_stack([s.ravel(), t.ravel()]), elements


def plate_problem(
    nodes: NDArray[np.float64],
    elements: NDArray[np.int64],
    material: Material,
    thickness: float,
    *,
    mass: str = "lumped",
) -> Problem:
    structure = Structure(nodes, shells=(Shells("plate", elements, material, thickness),))
    return Problem(assemble_structure(structure, mass=mass))


def scordelis_lo(n: int, *, triangles: bool = False) -> float:
    """Deflection of the middle of the free edge of the roof, a quarter of it by n x n elements [published unit].

    Radius 25, length 50, half angle 40 degrees, thickness 0.25, E 4.32e8, nu 0, weight 90 an area; diaphragms at the
    ends: T. Belytschko et al., Comput. Meth. Appl. Mech. Engng 51 (1985) 221.
    """
    p, elements = grid(n, n, triangles=triangles)
    angle, x = np.radians(40.0) * p[:, 0], 25.0 * p[:, 1]
    nodes = np.column_stack([25.0 * np.sin(angle), x, 25.0 * np.cos(angle)])
    found = plate_problem(nodes, elements, Material(4.32e8, 0.0, 1.0), 0.25)
    found.hold(p[:, 1] == 1.0, "xz")
    found.hold(p[:, 1] == 0.0, "yXZ")  # middle of the length
    found.hold(p[:, 0] == 0.0, "xYZ")  # crown
    weight = found.model.points
    assert weight is not None
    # the lumped mass of unit density and 0.25 thickness is 0.25 an area
    down = weight.operator.T @ (np.repeat(weight.masses, 3) * np.tile([0.0, 0.0, -1.0], len(weight.masses)))
    found.load = 90.0 / 0.25 * down
    corner = np.flatnonzero((p[:, 0] == 1.0) & (p[:, 1] == 0.0))
    return -float(found.solve()[found.dofs(corner, "z")][0])


def pinched_cylinder(n: int, *, triangles: bool = False) -> float:
    """Deflection under one of two forces 1 on a cylinder between diaphragms, an eighth of it by n x n elements.

    Radius 300, length 600, thickness 3, E 3e6, nu 0.3 (Belytschko et al. 1985).
    """
    p, elements = grid(n, n, triangles=triangles)
    angle, y = 0.5 * np.pi * p[:, 0], 300.0 * p[:, 1]
    nodes = np.column_stack([300.0 * np.sin(angle), y, 300.0 * np.cos(angle)])
    found = plate_problem(nodes, elements, Material(3e6, 0.3, 1.0), 3.0)
    found.hold(p[:, 1] == 1.0, "xz")
    found.hold(p[:, 1] == 0.0, "yXZ")
    found.hold(p[:, 0] == 0.0, "xYZ")
    found.hold(p[:, 0] == 1.0, "zXY")
    at = np.flatnonzero((p[:, 0] == 0.0) & (p[:, 1] == 0.0))
    found.push(at, "z", -0.25)
    return -float(found.solve()[found.dofs(at, "z")][0])


def hemisphere(n: int, *, triangles: bool = False) -> float:
    """Deflection under forces +-2 on the equator of a hemisphere with an 18 degree hole, a quarter by n x n elements.

    Radius 10, thickness 0.04, E 6.825e7, nu 0.3: R. H. MacNeal and R. L. Harder, Finite Elem. Anal. Des. 1 (1985) 3.
    """
    p, elements = grid(n, n, triangles=triangles)
    around, up = 0.5 * np.pi * p[:, 0], np.radians(72.0) * p[:, 1]
    nodes = 10.0 * np.column_stack([np.cos(around) * np.cos(up), np.sin(around) * np.cos(up), np.sin(up)])
    found = plate_problem(nodes, elements, Material(6.825e7, 0.3, 1.0), 0.04)
    found.hold(p[:, 0] == 0.0, "yXZ")
    found.hold(p[:, 0] == 1.0, "xYZ")
    equator = p[:, 1] == 0.0
    a, b = np.flatnonzero(equator & (p[:, 0] == 0.0)), np.flatnonzero(equator & (p[:, 0] == 1.0))
    found.hold(a, "z")
    found.push(a, "x", 1.0)
    found.push(b, "y", -1.0)
    return float(found.solve()[found.dofs(a, "x")][0])


def twisted_beam(nx: int, ny: int, thickness: float, *, triangles: bool = False) -> tuple[float, float]:
    """Deflections of the tip of a cantilever twisted by 90 degrees, in the plane of the tip and out of it, each by 1.

    Length 12, width 1.1, E 29e6, nu 0.22 (MacNeal and Harder 1985). Times 1e-6 is what is published for 0.0032.
    """
    p, elements = grid(nx, ny, triangles=triangles)
    angle, across = 0.5 * np.pi * p[:, 0], 1.1 * (p[:, 1] - 0.5)
    nodes = np.column_stack([12.0 * p[:, 0], across * np.cos(angle), across * np.sin(angle)])
    found = plate_problem(nodes, elements, Material(29e6, 0.22, 1.0), thickness)
    found.hold(p[:, 0] == 0.0)
    tip = np.flatnonzero(p[:, 0] == 1.0)
    share = np.full(len(tip), 1.0 / (len(tip) - 1))
    share[[0, -1]] *= 0.5
    middle = tip[len(tip) // 2]
    results = []
    for component in "zy":  # the width of the tip lies along z
        found.load[:] = 0.0
        found.push(tip, component, share)
        results.append(float(found.solve()[found.dofs(middle, component)][0]))
    return results[0], results[1]


def raasch_hook(nx: int, ny: int, *, triangles: bool = False) -> float:
    """Deflection of the tip of the hook along its width [in] under a shear force of 1 lb.

    Arcs of radius 14 in over 60 degrees and 46 in over 150 degrees the other way, width 20 in, thickness 2, E 3300 psi,
    nu 0.35: N. F. Knight, AIAA J. 35 (1997) 1637; Abaqus Benchmarks Manual 2.3.6.
    """
    p, elements = grid(nx, ny, triangles=triangles)
    length1, length2 = 14.0 * np.radians(60.0), 46.0 * np.radians(150.0)
    # elements are shared out between the arcs as 2 to 5, their angles
    cells1 = round(nx * 2 / 7)
    i = np.round(p[:, 0] * nx)
    s = np.where(i <= cells1, i / cells1 * length1, length1 + (i - cells1) / (nx - cells1) * length2)
    # from the clamped end at the origin, along the first arc about (14, 0), then about a centre on the other side
    first = s / 14.0
    turned = np.radians(60.0)
    joint = np.array([14.0 - 14.0 * np.cos(turned), 14.0 * np.sin(turned)])
    outward = np.array([-np.cos(turned), np.sin(turned)])
    centre2 = joint + 46.0 * outward
    back = (s - length1) / 46.0
    direction = np.arctan2(-outward[1], -outward[0]) + back
    inner = np.column_stack([14.0 - 14.0 * np.cos(first), 14.0 * np.sin(first)])
    outer = centre2 + 46.0 * np.column_stack([np.cos(direction), np.sin(direction)])
    plane = np.where((s <= length1)[:, None], inner, outer)
    nodes = np.column_stack([plane, 20.0 * p[:, 1]])
    found = plate_problem(nodes, elements, Material(3300.0, 0.35, 1.0), 2.0)
    found.hold(p[:, 0] == 0.0)
    tip = np.flatnonzero(p[:, 0] == 1.0)
    share = np.full(len(tip), 1.0 / (len(tip) - 1))
    share[[0, -1]] *= 0.5
    found.push(tip, "z", share)
    return float(share @ found.solve()[found.dofs(tip, "z")])
