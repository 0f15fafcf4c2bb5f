"""Rest of scenes with contacts: a motion in frozen time that loses its velocities whenever its kinetic energy falls.

Contacts, friction and impacts act as in any step, so nothing of them is said twice. Where the kinetic energy has passed
a peak the forces have gone through their balance; a start anew from there, at rest, is nearer to it (kinetic damping:
P. A. Cundall, 1976; M. R. Barnes, Int. J. Space Structures 14, 1999). With friction there is no single place of rest:
it is one to which the scene comes from its start.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.start.consistent_start import project_start
from heavylift.solver.start.rows import StartRows

__all__ = ["settle_contacts"]

RESTED = 1e-12
"""Kinetic energy of a peak, over the weight of all bodies times their lengths, that counts as rest."""

MOST_STEPS = 100_000

RUNAWAY = 20.0
"""Distance from the start, in extents of the scene, beyond which nothing seems to hold a body."""


def settle_contacts(
    rows: StartRows, arrays: Callable[[], Any], advance: Callable[[], str], weight: float
) -> str:
    """Bring a scene with contacts to rest; contacts have to be met anew afterwards.

    Parameters
    ----------
    rows
        The scene, its joints closed, its contacts met.
    arrays
        Gives names and arrays of everything that a step writes, of which a settled scene has its poses only.
    advance
        Makes a step from time 0; says why if it cannot.
    weight
        Weights of all bodies, each times its length [J].

    Returns
    -------
    str
        What was done.

    Raises
    ------
    InputError
        If a step fails, or the scene does not come to rest.
    """
    before = {name: array.copy() for name, array in arrays()}
    begin, start = rows.survey()[0][:, 1:4].copy(), [kind.poses() for kind in rows.layout.bodies]
    extent = max(float(np.ptp(begin, axis=0).max(initial=0.0)), 1.0)
    still = np.zeros(len(rows.inertia))
    last = steps = peaks = 0.0
    while True:
        problem = advance()
        steps += 1
        _, inertia, velocity = rows.survey()
        energy = 0.5 * float(inertia @ velocity**2)
        moved = float(np.abs(rows.survey()[0][:, 1:4] - begin).max(initial=0.0))
        if problem or steps == MOST_STEPS or not moved <= RUNAWAY * extent:
            raise InputError(
                f"the scene does not come to rest with its contacts in {int(steps)} steps"
                + (f": {problem}" if problem else f": bodies moved by up to {moved:.3g} m"),
                source="simulation",
                key="start",
                expected="contacts, joints, springs or ropes that hold all bodies; 'check' or 'project'",
            )
        if energy >= last and energy > 0.0:
            last = energy
            continue
        peaks += 1
        rows.put_velocity(still)
        if last <= RESTED * weight:
            break
        last = 0.0
    increment = np.zeros_like(still)
    for kind, first in zip(rows.layout.bodies, start, strict=True):
        kind.put_increment(first, kind.poses(), increment)
    for name, array in arrays():
        array[...] = before[name]
    rows.start()
    rows.move(increment)
    project_start(rows)
    rows.put_velocity(still)
    moved = float(np.linalg.norm(rows.survey()[0][:, 1:4] - begin, axis=1).max(initial=0.0))
    return (
        f"at rest with its contacts after {int(steps)} steps in frozen time, {int(peaks)} of them from rest;"
        f" bodies moved by up to {moved:.3g} m"
    )
