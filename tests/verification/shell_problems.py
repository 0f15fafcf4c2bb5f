"""Published problems of plates and shells as structures: nodes, elements, supports, loads."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.finite_elements.model import FEModel
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.sections import profile
from heavylift.preprocess.structures.stress import shell_stress
from heavylift.preprocess.structures.structure import Beams, Shells, Structure


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


def grid(
    nx: int, ny: int, *, triangles: bool = False, rising: bool = False
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Unit square in nx x ny cells: parameters (n, 2), and quadrilaterals or, cut along one diagonal, triangles."""
    s, t = np.meshgrid(np.linspace(0.0, 1.0, nx + 1), np.linspace(0.0, 1.0, ny + 1), indexing="ij")
    index = np.arange(s.size).reshape(s.shape)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    halves = ([0, 1, 2], [0, 2, 3]) if rising else ([0, 1, 3], [1, 2, 3])
    elements = np.concatenate([quads[:, half] for half in halves]) if triangles else quads
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
    p, elements = grid(n, n, triangles=triangles, rising=True)
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


# ---- frequencies ----


NAFEMS_STEEL = Material(200e9, 0.3, 8000.0)
"""Of the benchmarks FV: NAFEMS report R0015, *Selected Benchmarks for Natural Frequency Analysis*."""


def flat_plate(
    corners: list[tuple[float, float]], nx: int, ny: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Plate in the plane z = 0 between four corners, in turn: nodes and quadrilaterals."""
    p, elements = grid(nx, ny)
    s, t = p[:, :1], p[:, 1:]
    a, b, c, d = (np.array([*corner, 0.0]) for corner in corners)
    return (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d, elements


def edges_of(nx: int, ny: int) -> NDArray[np.bool_]:
    """Nodes of `grid` at its four edges."""
    p, _ = grid(nx, ny)
    return ((p == 0.0) | (p == 1.0)).any(axis=1)


def square_plate(n: int, *, mass: str) -> Problem:
    """FV12 and FV16: 10 x 10 x 0.05 m, moving across its plane only."""
    nodes, elements = flat_plate([(0, 0), (10, 0), (10, 10), (0, 10)], n, n)
    found = plate_problem(nodes, elements, NAFEMS_STEEL, 0.05, mass=mass)
    found.hold(np.ones(len(nodes), dtype=bool), "xyZ")
    return found


def free_square(n: int, *, mass: str) -> NDArray[np.float64]:
    """FV12: frequencies 4 to 9 [Hz]."""
    return square_plate(n, mass=mass).frequencies(9, 1.0)[3:]


def cantilever_square(n: int, *, mass: str) -> NDArray[np.float64]:
    """FV16: frequencies 1 to 6 [Hz]."""
    found = square_plate(n, mass=mass)
    found.hold(found.nodes[:, 0] == 0.0)
    return found.frequencies(6, 1.0)


def rhombic_plate(n: int, *, mass: str) -> NDArray[np.float64]:
    """FV22: clamped thick rhombus of 10 m, 45 degrees, 1 m thick: frequencies 1 to 6 [Hz]."""
    c = 10.0 * np.sqrt(0.5)
    nodes, elements = flat_plate([(0, 0), (10, 0), (10 + c, c), (c, c)], n, n)
    found = plate_problem(nodes, elements, NAFEMS_STEEL, 1.0, mass=mass)
    found.hold(np.ones(len(nodes), dtype=bool), "xyZ")
    found.hold(edges_of(n, n))
    return found.frequencies(6, 1e4)


def tapered_membrane(n: int, *, mass: str) -> NDArray[np.float64]:
    """FV32: cantilever in its plane, 10 m long, 5 m at the root, 1 m at the tip, 2 n x n elements [Hz]."""
    nodes, elements = flat_plate([(0, -2.5), (10, -0.5), (10, 0.5), (0, 2.5)], 2 * n, n)
    found = plate_problem(nodes, elements, NAFEMS_STEEL, 0.05, mass=mass)
    found.hold(np.ones(len(nodes), dtype=bool), "zXY")
    found.hold(nodes[:, 0] == 0.0)
    return found.frequencies(6, 1e4)


def leissa_free_square(n: int, *, mass: str) -> NDArray[np.float64]:
    """Free square plate, nu 0.3, t/a 0.01: omega a^2 sqrt(rho t / D) of the first six bending modes."""
    nodes, elements = flat_plate([(0, 0), (1, 0), (1, 1), (0, 1)], n, n)
    material = Material(2.1e11, 0.3, 7850.0)
    found = plate_problem(nodes, elements, material, 0.01, mass=mass)
    found.hold(np.ones(len(nodes), dtype=bool), "xyZ")
    D = 2.1e11 * 1e-6 / (12.0 * (1.0 - 0.09))
    return 2.0 * np.pi * found.frequencies(9, 1e4)[3:] * np.sqrt(7850.0 * 0.01 / D)


# ---- plates with stiffeners, stresses ----


def stiffened_panel(n: int, *, webs: str, held: bool) -> NDArray[np.float64]:
    """First five frequencies [Hz] of a plate of 3.0 x 2.4 x 0.01 m with three flat bars 200 x 12 along it.

    Square elements of 2.4 m / (4 n); bars are beams beside the plate, or plates of six rows. Held along z at its edges,
    or free.
    """
    steel = Material(2.1e11, 0.3, 7850.0)
    nx, ny = 5 * n, 4 * n
    p, elements = grid(nx, ny)
    nodes = np.column_stack([3.0 * p[:, 0], 2.4 * p[:, 1], np.zeros(len(p))])
    index = np.arange(len(p)).reshape(nx + 1, ny + 1)
    parts = [Shells("plate", elements, steel, 0.01)]
    bars: tuple[Beams, ...] = ()
    lines = [index[:, k * n] for k in (1, 2, 3)]
    if webs == "beams":
        pairs = np.concatenate([np.column_stack([line[:-1], line[1:]]) for line in lines])
        section = profile("flat", height=0.2, thickness=0.012).section
        offset = np.array([0.0, 0.0, -0.105])
        bars = (
            Beams("bars", pairs, steel, section, np.array([0.0, 0, 1]), offset_a=offset, offset_b=offset),
        )
    else:
        # from the middle of the plate, with the area of the bar
        height, thickness, rows = 0.205, 0.012 * 200.0 / 205.0, 6
        own = []
        for line in lines:
            below = [line]
            for row in range(1, rows + 1):
                below.append(len(nodes) + np.arange(nx + 1))
                nodes = np.concatenate([nodes, nodes[line] - [0.0, 0.0, height * row / rows]])
            b = np.array(below)
            own.append(np.stack([b[:-1, :-1], b[:-1, 1:], b[1:, 1:], b[1:, :-1]], axis=-1).reshape(-1, 4))
        parts.append(Shells("bars", np.concatenate(own), steel, thickness))
    found = Problem(assemble_structure(Structure(nodes, shells=tuple(parts), beams=bars)))
    if held:
        edge = np.zeros(len(nodes), dtype=bool)
        edge[: len(p)] = edges_of(nx, ny)
        found.hold(edge, "z")
        return found.frequencies(8, 1e3)[3:]
    return found.frequencies(11, 1e2)[6:]


def clamped_square(n: int) -> tuple[float, float]:
    """w D / (p a^4) and M / (p a^2) at the middle of a clamped square plate, t/a 0.01, under the pressure p."""
    nodes, elements = flat_plate([(0, 0), (1, 0), (1, 1), (0, 1)], n, n)
    material = Material(2.1e11, 0.3, 7850.0)
    found = plate_problem(nodes, elements, material, 0.01)
    found.hold(edges_of(n, n))
    weight = found.model.mass.diagonal()[2 : 3 * len(nodes) : 3] / (7850.0 * 0.01)
    found.push(np.arange(len(nodes)), "z", weight)
    u = found.solve()
    structure = found.model.structure
    assert structure is not None
    stress = shell_stress(structure, structure.shells[0], found.model)
    middle = int(np.argmin(np.linalg.norm(nodes - [0.5, 0.5, 0.0], axis=1)))
    at = int(np.flatnonzero(stress.nodes == middle)[0])
    moment = (stress.bending @ u)[3 * at] * 0.01**2 / 6.0
    D = 2.1e11 * 1e-6 / (12.0 * 0.91)
    return float(u[3 * middle + 2] * D), float(abs(moment))


def z_section(n: int) -> float:
    """NAFEMS LE5: axial stress on the edge of a flange at x = 2.5 m of a Z-section cantilever under torsion [MPa].

    10 m long, web 2 m, flanges 1 m, 0.1 m thick, E 210 GPa, nu 0.3; a couple of 0.6 MN along the flanges at the tip. n
    square elements a flange. The strain of the edge times E.
    """
    h = 1.0 / n
    nx = 10 * n
    # across: flange from (y, z) = (1, -1) to (0, -1), web up to (0, 1), flange on to (-1, 1)
    s = np.arange(4 * n + 1) * h
    y = np.where(s < 1.0, 1.0 - s, np.where(s > 3.0, 3.0 - s, 0.0))
    z = np.clip(s - 2.0, -1.0, 1.0)
    p, elements = grid(nx, 4 * n)
    column = np.round(p[:, 1] * 4 * n).astype(int)
    nodes = np.column_stack([10.0 * p[:, 0], y[column], z[column]])
    found = plate_problem(nodes, elements, Material(210e9, 0.3, 7850.0), 0.1)
    found.hold(p[:, 0] == 0.0)
    share = np.full(n + 1, 1.0 / n)
    share[[0, -1]] *= 0.5
    tip = np.flatnonzero(p[:, 0] == 1.0)
    found.push(tip[: n + 1], "y", 0.6e6 * share)
    found.push(tip[-n - 1 :], "y", -0.6e6 * share)
    u = found.solve()
    edge = np.flatnonzero(p[:, 1] == 0.0)
    after = edge[np.searchsorted(nodes[edge, 0], 2.5 + 1e-9) + np.array([-2, -1, 0])]
    if n % 2 == 0:  # 2.5 is a node: one element to either side
        first, last = after[0], after[2]
    else:
        first, last = after[1], after[2]
    return float((u[3 * last] - u[3 * first]) / (nodes[last, 0] - nodes[first, 0]) * 210e9 * 1e-6)
