"""A start that fits its joints: check it, or close the joints first.

Positions are closed by Newton's method in the metric of the mass, which moves the bodies as little as
possible; velocities by one projection. Redundant rows are welcome as long as they agree.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.start.rows import StartRows, listed

__all__ = ["StartReport", "check_start", "close_positions", "close_velocities", "project_start"]

LARGEST_VIOLATION = 1e-6
"""Of a position row that a start may have [m] or [rad]."""

CLOSED = 1e-11
"""Relative to the size of the scene [m], or absolute [rad]: positions are closed."""

QUICK_ITERATIONS, ITERATIONS = 15, 100
FIRST_SOFTNESS, LEAST_SOFTNESS = 1e-3, 1e-12
HARDLY = 1e4
"""Softness of unit rows in units of the unit mass: at first, at last, and where it does no longer help."""

NEEDLE = 1e-2
"""Smallest moment of inertia relative to the largest with which positions are closed."""

LARGEST_TURN = 0.3
"""Of a body in one iteration [rad]."""

CONSISTENT = 1e-9
"""What may remain of a violation of velocities, relative to the velocities."""


@dataclass(frozen=True)
class StartReport:
    """How a start was made to fit.

    Attributes
    ----------
    violation
        Largest violation of a position row that was found [m] or [rad].
    moved, turned
        Largest displacement [m] and turn [rad] of a body.
    velocity_change
        Largest change of a velocity [m/s] or [rad/s].
    text
        All of it in a sentence; empty if there is nothing to say.
    """

    violation: float = 0.0
    moved: float = 0.0
    turned: float = 0.0
    velocity_change: float = 0.0
    text: str = ""


def check_start(rows: StartRows) -> StartReport:
    """Refuse joints that are open at the start; project velocities that do not fit.

    Parameters
    ----------
    rows
        The scene.

    Raises
    ------
    InputError
        If a position row is violated by more than 1e-6 m or rad, or no velocity fits all joints.
    """
    rows.fill()
    violation = _largest(rows.residual, rows.rigid)
    if not violation <= LARGEST_VIOLATION:
        raise InputError(
            f"the joints do not fit at the start: {_amounts(rows)}",
            source="simulation",
            key="start",
            expected=f'at most {LARGEST_VIOLATION:g} m or rad, or start = "project", which closes them',
        )
    change, text = close_velocities(rows)
    return StartReport(violation=violation, velocity_change=change, text=text)


def project_start(rows: StartRows) -> StartReport:
    """Close all joints with the smallest displacement, then project the velocities.

    Parameters
    ----------
    rows
        The scene.

    Raises
    ------
    InputError
        If the joints cannot be closed all together; names those that stay open.
    """
    rows.fill()
    violation = _largest(rows.residual, rows.rigid)
    before = rows.survey()[0]
    if not close_positions(rows):
        raise InputError(
            f"the joints cannot be closed together; these stay open: {_amounts(rows)}",
            source="simulation",
            key="start",
            expected="dimensions and start positions for which all joints fit",
        )
    after = rows.survey()[0]
    moved = np.linalg.norm(after[:, 1:4] - before[:, 1:4], axis=1)
    turned = 2.0 * np.arccos(np.clip(np.abs(np.sum(after[:, 4:] * before[:, 4:], axis=1)), 0.0, 1.0))
    change, text = close_velocities(rows)
    if violation > LARGEST_VIOLATION:
        far, round_ = int(np.argmax(moved)), int(np.argmax(turned))
        names = rows.layout.body_names
        text = (
            f"joints closed, which were open by up to {violation:.3g} m or rad: {names[far]!r} moved"
            f" {moved[far]:.3g} m, {names[round_]!r} turned {turned[round_]:.3g} rad, others less; " + text
        ).rstrip("; ")
    return StartReport(violation, float(moved.max()), float(turned.max()), change, text)


def close_positions(rows: StartRows, tolerance: float = CLOSED, *, quick: bool = False) -> bool:
    """Newton's method in the metric of the mass; returns whether all rigid rows are closed.

    Parameters
    ----------
    rows
        The scene; its bodies move, its rows are those of the last state.
    tolerance
        What counts as closed, relative to the size of the scene [m], or absolute [rad].
    quick
        Try plain steps before damped ones, and not after them: for bodies that were displaced a moment ago.

    Notes
    -----
    Open joints make redundant rows nearly independent, and Newton's method would take their small contradictions
    for large displacements. So rows are as soft as they are open (D. W. Marquardt, J. SIAM 11, 1963).
    """
    size = 1.0 + float(np.ptp(rows.survey()[0][:, 1:4], axis=0).max())
    inertia = rows.inertia.copy()  # with needles made thicker: they would turn about themselves to no avail
    for k in range(3, 6):
        spins = rows.frame_starts + k
        largest = np.max([rows.inertia[rows.frame_starts + j] for j in range(3, 6)], axis=0)
        inertia[spins] = np.maximum(inertia[spins], NEEDLE * largest)
    rows.start()
    rows.fill()
    rigid = rows.rigid
    goal = max(tolerance * size, 1e-3 * LARGEST_VIOLATION)
    begin = rows.snapshot()
    for method in (_quick_newton, _damped_newton) if quick else (_damped_newton, _quick_newton):
        violation = method(rows, rigid, inertia, tolerance * size)
        if violation <= goal:
            break
        if method is _quick_newton:  # it may have gone anywhere
            rows.restore(begin)
            rows.fill()
    rows.start()
    rows.fill()
    return violation <= goal


def _quick_newton(
    rows: StartRows, rigid: NDArray[np.bool_], inertia: NDArray[np.float64], goal: float
) -> float:
    """A few plain steps, which need not go downhill: the way round a bend is often shorter uphill."""
    for _ in range(QUICK_ITERATIONS):
        violation = _largest(rows.residual, rigid)
        if not violation > 1e-3 * goal:
            break
        _shift(rows, rows.matrix(), rigid, inertia, min(LEAST_SOFTNESS * 1e3, violation**2 + LEAST_SOFTNESS))
        last = violation
        violation = _largest(rows.residual, rigid)
        if not np.isfinite(violation) or (violation <= goal and violation > 0.3 * last):
            break
    violation = _largest(rows.residual, rigid)
    return violation if np.isfinite(violation) else np.inf


def _damped_newton(
    rows: StartRows, rigid: NDArray[np.bool_], inertia: NDArray[np.float64], goal: float
) -> float:
    """Steps that always go downhill, with rows as soft as that takes; returns the largest violation left."""
    G = rows.matrix()
    violation = _largest(rows.residual, rigid)
    lengths = rows.unit_rows(G, rigid, inertia)[1]
    total = float(np.linalg.norm(rows.residual[rigid] / lengths))
    softness = min(FIRST_SOFTNESS, violation**2)
    for _ in range(ITERATIONS):
        if not violation > 1e-3 * goal:
            break
        before, last = rows.snapshot(), (violation, total, G)
        _shift(rows, G, rigid, inertia, softness)
        violation, G = _largest(rows.residual, rigid), rows.matrix()
        total = float(np.linalg.norm(rows.residual[rigid] / lengths))
        if total < last[1]:
            softness = max(softness * (0.01 if total < 0.3 * last[1] else 0.1), LEAST_SOFTNESS)
            continue
        rows.restore(before)
        rows.fill()
        violation, total, G = last
        if violation <= goal or softness > HARDLY:
            break
        softness *= 30.0
    return violation


def _shift(
    rows: StartRows, G: Any, rigid: NDArray[np.bool_], inertia: NDArray[np.float64], softness: float
) -> None:
    """One step of Newton's method, shortened to the largest turn."""
    change, _ = rows.closing(G, rigid, inertia, softness)(-rows.residual[rigid])
    turns = [change[rows.frame_starts + k] for k in range(3, 6)]
    turn = float(np.sqrt(np.sum(np.square(turns), axis=0)).max(initial=0.0))
    rows.move(change * min(1.0, LARGEST_TURN / turn if turn > 0.0 else 1.0))
    rows.fill()


def close_velocities(rows: StartRows) -> tuple[float, str]:
    """Project the velocities onto the rigid rows, in the metric of the mass.

    Returns
    -------
    change
        Largest change of a velocity [m/s] or [rad/s].
    text
        What was changed, in a sentence; empty if nothing.

    Raises
    ------
    InputError
        If drives or prescribed motions contradict each other.
    """
    rows.fill()
    rigid = rows.rigid
    if not rigid.any():
        return 0.0, ""
    velocity, target = rows.survey()[2], rows.column("target")
    scale = float(np.abs(velocity).max(initial=0.0)) + float(np.abs(target).max(initial=0.0))
    if scale == 0.0:  # at rest nothing is to be changed
        return 0.0, ""
    G = rows.matrix()
    wanted = target - G @ velocity
    wanted[~rigid] = 0.0
    if not _largest(wanted, rigid) > 1e-14 * scale:
        return 0.0, ""
    worst = rows.worst(wanted, rigid)
    change, _ = rows.closing(G, rigid)(wanted[rigid])
    left = wanted - G @ change
    if _largest(left, rigid) > CONSISTENT * max(scale, float(np.abs(change).max())):
        open_rows = rows.worst(left, rigid)
        raise InputError(
            "the prescribed motions contradict each other in "
            + listed(
                [f"{rows.names[rows.block[row]]!r} by {abs(left[row]):.3g} m/s or rad/s" for row in open_rows]
            ),
            source="simulation",
            key="start",
            expected="drives that the joints allow",
        )
    rows.put_velocity(velocity + change)
    largest = float(np.abs(change).max())
    if largest <= 1e-9 * scale:
        return largest, ""
    places = rows.survey()[0]
    speeds = [np.linalg.norm(change[int(first) : int(first) + 3]) for first in places[:, 0]]
    spins = [np.linalg.norm(change[int(first) + 3 : int(first) + 6]) for first in places[:, 0]]
    names = rows.layout.body_names
    fast, round_ = int(np.argmax(speeds)), int(np.argmax(spins))
    return largest, (
        f"start velocities did not fit {listed([repr(rows.names[rows.block[row]]) for row in worst])} and were"
        f" projected: {names[fast]!r} changed by {speeds[fast]:.3g} m/s, {names[round_]!r} by"
        f" {spins[round_]:.3g} rad/s, others less"
    )


def _largest(values: NDArray[np.float64], rows: NDArray[np.bool_]) -> float:
    return float(np.abs(values[rows]).max(initial=0.0))


def _amounts(rows: StartRows) -> str:
    """The worst joints with their violations."""
    g, G = rows.residual, rows.matrix()
    return listed(
        [
            f"{rows.names[rows.block[row]]!r} by {abs(g[row]):.3g} {rows.unit(row, G)}"
            for row in rows.worst(g, rows.rigid)
        ]
    )
