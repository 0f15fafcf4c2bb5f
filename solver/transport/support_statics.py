"""Whether groups of bogies can hold a body upright, and what each of them carries.

To a tilt of the body only the middle (x_k, y_k) of a group counts, where the resultant of its equal forces acts. With
the stiffness ``n_k k_k`` of a group, ``1/k = 1/k_oil + 1/k_tyre`` of a bogie, and the lever h of the weight W over the
road the small motions (heave, roll, pitch) have the stiffness ::

    K = sum n_k k_k J_k J_k^T - diag(0, W h, W h) ,    J_k = (1, y_k, -x_k)

Fewer than three groups, or three in a line, leave a tilt without any: it grows with ``exp(a t)``, ``a^2`` minus the
smallest eigenvalue of ``M^-1 K``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

__all__ = [
    "SupportStatics",
    "Tipping",
    "even_loads",
    "growth_rate",
    "refuse_unstable",
    "small_motions",
    "tipping_angles",
]

IN_LINE = 1e-6
"""Smallest over largest extent of the middles of groups below which they are in a line."""


@dataclass(frozen=True, eq=False)
class SupportStatics:
    """A body on its groups, in axes x along the vehicle, y to the left, z against gravity.

    Attributes
    ----------
    name
        Of the transporter.
    places
        Middles of the groups from the centre of mass [m], shape (n, 3).
    counts
        Bogies of each group, shape (n,).
    stiffness
        Of a bogie of each group, oil and tyre [N/m], shape (n,).
    weight
        [N].
    mass, inertia
        [kg]; about the centre of mass in these axes [kg m2], shape (3, 3).
    groups
        Names, for messages.
    """

    name: str
    places: NDArray[np.float64]
    counts: NDArray[np.int64]
    stiffness: NDArray[np.float64]
    weight: float
    mass: float
    inertia: NDArray[np.float64]
    groups: tuple[str, ...] = ()

    def named(self, number: int) -> str:
        """Name or number of a group."""
        return repr(self.groups[number]) if self.groups else str(number + 1)

    @property
    def height(self) -> float:
        """Of the centre of mass over the road [m]."""
        return -float(self.counts @ self.places[:, 2]) / float(self.counts.sum())


def _levers(stand: SupportStatics) -> NDArray[np.float64]:
    """Rise of each group by heave, roll and pitch, shape (n, 3)."""
    return np.column_stack([np.ones(len(stand.places)), stand.places[:, 1], -stand.places[:, 0]])


def even_loads(stand: SupportStatics) -> NDArray[np.float64]:
    """Forces of a bogie of each group [N] that carry the weight, as near to each other as the balance allows.

    Returns
    -------
    ndarray
        Shape (n,). Of four groups at the corners of a rectangle both diagonals carry the same.

    Raises
    ------
    InputError
        If no forces balance the weight, or one of them would pull.
    """
    mean = stand.weight / float(stand.counts.sum())
    balance = (stand.counts[:, None] * _levers(stand)).T
    missing = np.array([stand.weight, 0.0, 0.0]) - balance @ np.full(len(stand.counts), mean)
    # least squares of the deviations, each bogie counted once
    root = np.sqrt(stand.counts.astype(np.float64))
    change = np.linalg.lstsq(balance / root, missing, rcond=1e-9)[0] / root
    left = missing - balance @ change
    if np.abs(left[1:]).max() > 1e-6 * stand.weight * (1.0 + np.abs(stand.places).max()):
        flat = stand.places[:, :2]
        along = np.linalg.svd(flat - flat.mean(axis=0))[2][0] if len(flat) > 1 else np.zeros(2)
        beside = float(np.linalg.norm(flat[0] - along * (along @ flat[0])))
        raise InputError(
            f"its centre of mass is {beside:.3g} m beside the {'line' if len(flat) > 1 else 'middle'} of its "
            f"{len(flat)} group{'s' * (len(flat) > 1)}, whose forces cannot balance the weight",
            source=stand.name,
            key="groups",
            expected="groups about the centre of mass, or the 'load' of each",
        )
    loads: NDArray[np.float64] = mean + change
    if loads.min() < 0.0:
        raise InputError(
            f"group {stand.named(int(np.argmin(loads)))} would have to pull with {-loads.min():.6g} N a bogie",
            source=stand.name,
            key="groups",
            expected="groups about the centre of mass: it would tip over",
        )
    return loads


def small_motions(stand: SupportStatics) -> NDArray[np.float64]:
    """Squares of the angular frequencies of heave, roll and pitch [1/s2], rising, shape (3,)."""
    J = _levers(stand)
    K = (stand.counts * stand.stiffness * J.T) @ J - np.diag([0.0, 1.0, 1.0]) * stand.weight * stand.height
    M = np.zeros((3, 3))
    M[0, 0], M[1:, 1:] = stand.mass, stand.inertia[:2, :2]
    lower = np.linalg.inv(np.linalg.cholesky(M))
    return np.asarray(np.linalg.eigvalsh(lower @ K @ lower.T), dtype=np.float64)


def growth_rate(stand: SupportStatics) -> float:
    """With which a tilt grows [1/s]; 0 of a body that stands."""
    return math.sqrt(max(0.0, -float(small_motions(stand)[0])))


INDIFFERENT = 1e-12
"""Square of the lowest frequency over that of the highest, of a body that nothing brings back."""


class Tipping(NamedTuple):
    """Tilts of the road at which a vehicle tips over, whichever way it leans [rad].

    Attributes
    ----------
    static
        On rigid groups: the weight acts over a side of the polygon of their middles.
    compliant
        On groups that give way, so that it leans more than the road: the load of a group is gone.
    """

    static: float
    compliant: float


def tipping_angles(stand: SupportStatics, loads: NDArray[np.float64]) -> Tipping:
    """Angles at which a body tips over.

    Parameters
    ----------
    stand
        On level ground.
    loads
        Of a bogie of each group there [N], shape (n,).

    Notes
    -----
    A tilt b along a unit vector e moves the foot of the weight by ``d = h tan(b) e``, and so the loads of groups by
    ``-n_k k_k J_k . K^-1 (0, -W d_y, W d_x)``: along its gradient the load of a group is gone soonest. Both are 0 of a
    body that cannot stand.
    """
    squares = small_motions(stand)
    if not squares[0] > INDIFFERENT * np.abs(squares).max():
        return Tipping(0.0, 0.0)
    J, W, h = _levers(stand), stand.weight, stand.height
    K = (stand.counts * stand.stiffness * J.T) @ J - np.diag([0.0, 1.0, 1.0]) * W * h
    moments = W * h * np.array([[0.0, 0.0], [0.0, -1.0], [1.0, 0.0]])
    changes = (stand.counts * stand.stiffness)[:, None] * (J @ np.linalg.solve(K, moments))
    limits = stand.counts * loads / np.linalg.norm(changes, axis=1)
    corners = stand.places[:, :2]
    sides = [corners[hull] for hull in _hull(corners)]
    distance = min(
        abs(float(a[0] * b[1] - a[1] * b[0])) / float(np.hypot(*(b - a)))
        for a, b in zip(sides, sides[1:] + sides[:1], strict=True)
    )
    return Tipping(math.atan2(distance, h), math.atan(limits.min()))


def _hull(points: NDArray[np.float64]) -> list[int]:
    """Numbers of the corners of the convex hull of points in the plane, anticlockwise.

    Notes
    -----
    A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions", Information Processing Letters 9
    (1979).
    """
    order = [int(number) for number in np.lexsort((points[:, 1], points[:, 0]))]

    def half(numbers: list[int]) -> list[int]:
        found: list[int] = []
        for number in numbers:
            while len(found) > 1:
                a, b = points[found[-1]] - points[found[-2]], points[number] - points[found[-2]]
                if a[0] * b[1] - a[1] * b[0] > 0.0:
                    break
                found.pop()
            found.append(number)
        return found[:-1]

    return half(order) + half(order[::-1])


def refuse_unstable(stand: SupportStatics) -> None:
    """Refuse groups that cannot hold the body upright.

    Raises
    ------
    InputError
        With the rate by which its tilt grows.
    """
    rate = growth_rate(stand)
    if rate == 0.0:
        return
    count = len(stand.counts)
    flat = stand.places[:, :2] - stand.places[:, :2].mean(axis=0)
    extent = np.linalg.svd(flat, compute_uv=False)
    in_line = count > 1 and extent[-1] <= IN_LINE * extent[0]
    if count < 3:
        reason = f"{count} group{'s' * (count > 1)} of bogies with shared oil"
    elif in_line:
        reason = f"{count} groups of bogies in a line"
    else:
        reason = f"{count} groups, too soft or too near to each other for a weight {stand.height:.3g} m over the road,"
    raise InputError(
        f"{reason} cannot hold the body upright: a tilt grows by exp(t {rate:.3g} 1/s)",
        source=stand.name,
        key="groups",
        expected="three groups or more that are not in a line, stiff enough; or 'accept_unstable'",
    )
