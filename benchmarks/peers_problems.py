"""The benchmark mechanisms as joint trees with closed loops, from which every peer builds its own model.

A01 to A05 are problems of the IFToMM library of computational benchmark problems; A03 (Andrews' squeezer,
data of the test set of initial value problems) and A05 in the versions defined there. heavylift itself
takes them from the cases named here, so that peers and heavylift share nothing but the definition.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

__all__ = [
    "GROUND",
    "PROBLEMS",
    "Closure",
    "Link",
    "Mechanism",
    "Problem",
    "Spring",
    "Vector",
    "chain_problem",
    "four_bars_problem",
    "select_problems",
]

GROUND = -1
"""Index of the world in place of a link."""
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Link:
    """A rigid body on its parent by a hinge or slider; its frame sits in the joint.

    Attributes
    ----------
    parent
        Index of an earlier link, or `GROUND`.
    offset
        Joint in the frame of the parent [m].
    axis
        Of the joint; at coordinate zero the frames of parent and link are parallel.
    mass, centre, inertia
        [kg]; centre of mass [m] and principal inertias about it along the axes of the link [kg m2].
    start, rate
        Initial coordinate [rad] or [m], and its rate.
    slides
        A slider instead of a hinge.
    """

    parent: int
    offset: Vector
    axis: Vector
    mass: float
    centre: Vector
    inertia: Vector
    start: float = 0.0
    rate: float = 0.0
    slides: bool = False


@dataclass(frozen=True)
class Closure:
    """Two points that coincide [m], each in the frame of its link; with an axis, a hinge (same on both sides)."""

    links: tuple[int, int]
    points: tuple[Vector, Vector]
    axis: Vector | None = None


@dataclass(frozen=True)
class Spring:
    """Between two points [m]: stiffness [N/m], damping [N s/m], unstretched length [m]."""

    links: tuple[int, int]
    points: tuple[Vector, Vector]
    stiffness: float
    damping: float
    length: float


@dataclass(frozen=True)
class Mechanism:
    """A joint tree, its closed loops, and the point of link `marked` that is compared.

    `torque` [N m] acts on the joint of link 0; gravity [m/s2].
    """

    links: tuple[Link, ...]
    marked: int
    point: Vector
    closures: tuple[Closure, ...] = ()
    springs: tuple[Spring, ...] = ()
    gravity: Vector = (0.0, -9.81, 0.0)
    torque: float = 0.0

    @property
    def planar(self) -> bool:
        """Whether everything moves in the plane z = 0."""
        return all(link.axis == Z and not link.slides for link in self.links) and self.gravity[2] == 0.0

    def start_poses(self) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Rotation matrix (3, 3) and joint position [m] of every link at the start."""
        poses: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
        for link in self.links:
            R, x = (np.eye(3), np.zeros(3)) if link.parent == GROUND else poses[link.parent]
            axis = np.array(link.axis)
            x = x + R @ np.array(link.offset)
            poses.append((R, x + link.start * (R @ axis)) if link.slides else (R @ turn(axis, link.start), x))
        return poses


def turn(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Rotation matrix of a rotation [rad] about a unit axis (Rodrigues)."""
    K = np.cross(np.eye(3), axis)
    return np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K


@dataclass(frozen=True)
class Problem:
    """A benchmark problem.

    Attributes
    ----------
    name
        On the command line and in the tables.
    case, overrides
        Folder of the case, and what to set in it.
    duration
        [s]
    mechanism
        Makes the model for the peers.
    """

    name: str
    case: str
    overrides: tuple[str, ...]
    duration: float
    mechanism: Callable[[], Mechanism]


def pendulum() -> Mechanism:
    """A01: a point mass at 1 m, released horizontally."""
    link = Link(GROUND, (0.0, 0.0, 0.0), Z, 1.0, (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return Mechanism((link,), 0, (-1.0, 0.0, 0.0))


def four_bars(loops: int) -> Mechanism:
    """A02: square loops side by side, rods of 1 m and 1 kg, upright, tips at 1 m/s; all cranks pass the flat pose."""
    slender = 1.0 / 12.0
    links: list[Link] = []
    closures = []
    for i in range(loops + 1):
        offset, inertia = (float(i), 0.0, 0.0), (slender, 0.0, slender)
        crank = len(links)
        links.append(Link(GROUND, offset, Z, 1.0, (0.0, 0.5, 0.0), inertia, rate=-1.0))
        if i > 0:
            closures.append(Closure((crank - 1, crank), (X, Y)))
        if i < loops:
            links.append(Link(crank, Y, Z, 1.0, (0.5, 0.0, 0.0), (0.0, slender, slender), rate=1.0))
    return Mechanism(tuple(links), 0, Y, tuple(closures))


def squeezer() -> Mechanism:
    """A03: Andrews' squeezing mechanism, driven by 0.033 N m."""
    A, B, O = (-0.06934, -0.00227, 0.0), (-0.03635, 0.03273, 0.0), (0.0, 0.0, 0.0)
    # angles of the initial position that closes the loops (test set for IVP solvers)
    beta, theta, gamma, phi, delta, omega, epsilon = (
        -0.0617138900142764496358948458001,
        0.0,
        0.455279819163070380255912382449,
        0.222668390165885884674473185609,
        0.487364979543842550225598953530,
        -0.222668390165885884674473185609,
        1.23054744454982119249735015568,
    )

    def planar(
        parent: int, at: Vector, mass: float, inertia: float, centre: tuple[float, float], start: float
    ) -> Link:
        return Link(parent, at, Z, mass, (*centre, 0.0), (inertia / 2.0, inertia / 2.0, inertia), start)

    links = (
        planar(GROUND, O, 0.04325, 2.194e-6, (0.00092, 0.0), beta),  # 0: OF
        planar(0, (0.007, 0.0, 0.0), 0.00365, 4.410e-7, (-0.0115, 0.0), theta),  # 1: FE
        planar(GROUND, B, 0.02373, 5.255e-6, (0.01043, -0.01874), gamma),  # 2: BDE
        planar(GROUND, A, 0.07050, 1.169e-5, (0.02308, 0.00916), delta),  # 3: AG
        planar(3, (0.04, 0.0, 0.0), 0.00706, 5.667e-7, (0.0, 0.01421 - 0.02), phi),  # 4: GE
        planar(GROUND, A, 0.05498, 1.912e-5, (-0.00449, -0.01228), epsilon),  # 5: AH
        planar(5, (0.0, -0.04, 0.0), 0.00706, 5.667e-7, (0.02 - 0.01421, 0.0), omega),  # 6: HE
    )
    E = (-0.028, 0.0, 0.0)
    others = {2: (0.0, -0.035, 0.0), 4: (0.0, -0.02, 0.0), 6: (0.02, 0.0, 0.0)}
    closures = tuple(Closure((1, link), (E, point)) for link, point in others.items())
    spring = Spring((GROUND, 2), ((0.014, 0.072, 0.0), (0.02, -0.018, 0.0)), 4530.0, 0.0, 0.07785)
    weightless = (0.0, 0.0, 0.0)
    return Mechanism(links, 0, (0.007, 0.0, 0.0), closures, (spring,), weightless, 0.033)


def bricard(width: float) -> Mechanism:
    """A04: five rods of 1 m and 1 kg with square section [m] and six hinges, movable though overconstrained."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]], dtype=float)
    axes = (Y, Z, X, Y, Z, X)
    across, along = (1.0 + width**2) / 12.0, width**2 / 6.0
    links = []
    for i in range(5):
        rod = corners[i + 1] - corners[i]
        offset = corners[i] - corners[max(i - 1, 0)]
        inertia = tuple(along if rod[k] else across for k in range(3))
        links.append(Link(i - 1, _vector(offset), axes[i], 1.0, _vector(rod / 2.0), inertia))  # type: ignore[arg-type]
    end = Closure((4, GROUND), (_vector(corners[5] - corners[4]), _vector(corners[5])), axes[5])
    return Mechanism(tuple(links), 2, _vector(corners[3] - corners[2]), (end,))


def governor() -> Mechanism:
    """A05: flyball governor with stiff, strongly damped rods between slider and arms."""
    width, density = 0.01, 3000.0
    rod, ball = density * width**2, 5.0
    mass = rod + ball
    centre = (0.5 * rod + ball) / mass
    across = rod * (1.0 + width**2) / 12.0 + rod * (centre - 0.5) ** 2 + ball * (1.0 - centre) ** 2
    along = rod * width**2 / 6.0
    rod_across = rod * (1.0 + width**2) / 12.0
    shaft = Link(
        GROUND, (0.0, 0.0, 0.5), Z, rod, (0.0, 0.0, 0.0), (rod_across, rod_across, along), 0.0, math.tau
    )
    cube = density * 0.1**3
    slider = Link(0, (0.0, 0.0, 0.0), Z, cube, (0.0, 0.0, 0.0), (cube * 0.1**2 / 6.0,) * 3, slides=True)
    links, springs = [shaft, slider], []
    for number, (side, start) in enumerate([(0.05, math.pi / 6.0), (-0.05, math.pi * 5.0 / 6.0)]):
        inertia = (along, across, across)
        links.append(Link(0, (side, 0.0, 0.5), Y, mass, (centre, 0.0, 0.0), inertia, start))
        points = ((side, 0.0, 0.0), (0.5, 0.0, 0.0))
        springs.append(Spring((1, 2 + number), points, 8e5, 4e4, 0.5))
    return Mechanism(tuple(links), 1, (0.0, 0.0, 0.0), (), tuple(springs), (0.0, 0.0, -9.81))


def chain(count: int) -> Mechanism:
    """Slender rods of 1 m and 1 kg in a row, released horizontally."""
    slender = 1.0 / 12.0
    links = tuple(
        Link(i - 1, X if i else (0.0, 0.0, 0.0), Z, 1.0, (0.5, 0.0, 0.0), (0.0, slender, slender))
        for i in range(count)
    )
    return Mechanism(links, count - 1, X)


def _vector(values: NDArray[np.float64]) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z


def four_bars_problem(loops: int) -> Problem:
    """A02 with any number of loops."""
    return Problem(f"A02-{loops}", "mbs_a02", (f"parameters.n={loops}",), 10.0, lambda: four_bars(loops))


def chain_problem(links: int) -> Problem:
    """The chain with any number of links."""
    return Problem(f"chain-{links}", "mbs_chain", (f"parameters.n={links}",), 2.0, lambda: chain(links))


PROBLEMS: dict[str, Problem] = {
    problem.name: problem
    for problem in (
        Problem("A01", "mbs_a01", (), 10.0, pendulum),
        *(four_bars_problem(loops) for loops in (1, 2, 5, 10, 20, 40)),
        Problem("A03", "mbs_a03", (), 0.05, squeezer),
        Problem("A04-square", "mbs_a04", (), 10.0, lambda: bricard(0.1)),
        Problem("A04-thin", "mbs_a04_thin", (), 10.0, lambda: bricard(0.0)),
        Problem("A05", "mbs_a05", (), 10.0, governor),
        *(chain_problem(links) for links in (10, 50, 200)),
    )
}
"""Problems by name."""


def select_problems(names: list[str]) -> list[Problem]:
    """Problems by name or by the first part of it (``A02``, ``chain``); all if none is named.

    Raises
    ------
    SystemExit
        If a name is unknown.
    """
    chosen: dict[str, Problem] = {}
    for name in names or PROBLEMS:
        found = {key: problem for key, problem in PROBLEMS.items() if name in {key, key.split("-")[0]}}
        if not found:
            raise SystemExit(f"unknown problem {name!r}; known: {', '.join(PROBLEMS)}")
        chosen |= found
    return list(chosen.values())
