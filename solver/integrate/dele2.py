"""The default integrator: second order, one linear solve and one projection a step.

The idea of the discrete Euler-Lagrange equation of "Integrated simulation ... (2018)", eq. 49, at the
midpoint of the step: everything stiff enters one symmetric solve, momenta are carried, and no second
derivative of anything is needed. What a body does in each call is in its own files, what joints add in
`row_stage`.

Contacts may find an impact within the step, and a scenario something to do: then it is taken back and repeated up to
that time.

With a tolerance the step follows the distance of the midpoint velocity from its extrapolation, which
costs no solve: the local error of a second-order step is proportional to it. One that was cut, by an event or a record,
does not shorten those behind it.
"""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.outcome import Outcome
from heavylift.solver.contact.system_interface import after_step, before_advance, go_back
from heavylift.solver.integrate.loop import evaluate_forces, write_record
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    advance,
    check,
    complete,
    correct,
    estimate_error,
    factor,
    finish,
    iterate,
    predict,
    solve_again,
    solve_midpoint,
    watch_forces,
    watch_motions,
)
from heavylift.solver.rows.stage import end_step
from heavylift.solver.scenario.interface import direct, keep_state, take_back

__all__ = ["run"]

ACCEPTED, SAFETY, SMALLEST_FACTOR, LARGEST_FACTOR = 1.5, 0.85, 0.3, 2.0
STEP_TOO_SMALL = int(Outcome.STEP_TOO_SMALL)
NOT_CONVERGED = int(Outcome.NOT_CONVERGED)
SLIVER = 1e-2
"""Of the step that was wanted, below which one that was cut gives no information on its error."""

SHORTEST_PART = 1.5 / 256.0
"""Of a fixed step, to which it is halved while an iteration does not converge."""

SMALLEST_STEP = 1e-9
"""Of the output interval, below which an adaptive run gives up."""


@kernel(internal=True)
def _to_corner(work: Workspace, time: float, close: float) -> float:
    """Time to the next corner [s]; passes over those that lie behind."""
    corner = int(work.control.corner)
    while corner < work.corners.shape[0] and work.corners[corner] <= time + close:
        corner += 1
    work.control.corner = corner
    return work.corners[corner] - time if corner < work.corners.shape[0] else math.inf


@kernel(inline=True, internal=True)
def _next_step(h: float, wanted: float, error: float) -> float:
    """Step after one of the length h, of which a longer one was wanted where it was cut, by its error.

    What was cut to a sliver has no error that tells anything.
    """
    if error <= ACCEPTED and h < SLIVER * wanted:
        return wanted
    factor = max(SAFETY * (error + 1e-12) ** (-1.0 / 3.0), SMALLEST_FACTOR)
    most = LARGEST_FACTOR * h if error > ACCEPTED else max(LARGEST_FACTOR * h, wanted)
    return min(h * factor, most)


@kernel(internal=True)
def refine(
    bodies: Bodies,
    systems: Systems,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
) -> None:
    """Rounds of iteration of the bodies with nonlinear stress, until none of them moves any more."""
    again = False
    while work.status.outcome == 0:
        work.control.changed = 0
        iterate(bodies, bodies, systems, joints, work, time, step)
        if work.control.changed == 0:
            break
        again = True
    if again:
        complete(bodies, systems, True, step, work)  # bodies that carry strains feel the joints of the others


@entry  # eleven parameters: the scene is five; which steps, how exact and where records go are six
def run(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    step: float,
    tolerance: float,
    first: int,
    last: int,
    every: int,
    records: Floats2,
) -> int:
    """Step from index `first` to `last`; time is the index times the step, so it never drifts.

    Parameters
    ----------
    bodies, forces, joints, systems
        Tuples of kinds.
    work
        Shared arrays.
    step
        [s].
    tolerance
        Of the displacement in a step [m]: each index is then as many steps as it takes. 0: one step an index.
    first, last
        Indices.
    every
        A record is written after each index that is divisible by this.
    records
        Receives them, shape (rows, columns).

    Returns
    -------
    int
        Last index that was completed; `work.status` says why if it is not `last`.

    Notes
    -----
    Arguments are the tables and shared arrays that every operation takes, and what a call from Python says anew: it
    is made once for a stretch of records, so nothing would be gained by packing these numbers.
    """
    control = work.control
    row = 0
    split = 0.0
    struck = False
    for index in range(first, last):
        control.interval = index // every + 1
        done = 0.0
        while done < step:
            time = index * step + done
            interval = step - done
            h = interval
            if tolerance > 0.0:
                close = 1e-9 * step
                rest = _to_corner(work, time, close)
                if rest > interval - close:
                    rest = interval
                h = rest / max(1.0, math.ceil(rest / control.next_step - 1e-6))
            elif control.next_step < interval:  # after an iteration that did not converge
                h = interval / math.ceil(interval / control.next_step - 1e-6)
            nominal = h if tolerance > 0.0 else step
            if split > 0.0:  # an impact ends the step before its time
                h = split
            predict(bodies, time, h)
            evaluate_forces(bodies, forces, work, time + 0.5 * h, True, FORCES)
            factor(bodies, h, work)
            solve_midpoint(systems, systems, bodies, joints, work, time, h, nominal)
            control.changed = 0
            correct(bodies, h, work)
            if control.changed > 0:
                solve_again(systems, systems, joints, work, time, h)
            complete(bodies, systems, True, h, work)
            refine(bodies, systems, joints, work, time, h)
            if work.status.outcome == 0:
                check(bodies, h, work)
            if tolerance > 0.0:
                control.error = 0.0
                estimate_error(bodies, h, work)
                error = control.error / tolerance
                if work.status.outcome != 0:
                    error = 1e3  # too large a step: nothing has been changed yet
                proposed = _next_step(h, control.next_step, error)
                if error > ACCEPTED and h > SMALLEST_STEP * step:
                    control.next_step = proposed
                    work.status.outcome = work.status.block = 0
                    split = 0.0
                    continue
                control.next_step = proposed
                if error > ACCEPTED and work.status.outcome == 0:
                    work.status.outcome = STEP_TOO_SMALL  # `estimate_error` left the body
            elif work.status.outcome == NOT_CONVERGED and h > SHORTEST_PART * step:
                control.next_step = 0.5 * h  # nothing has been changed yet
                work.status.outcome = work.status.block = 0
                split = 0.0
                continue
            if work.status.outcome != 0:
                return index
            before_advance(systems, bodies, work, h)
            keep_state(forces)
            advance(bodies, time, h, work)
            end_step(systems, bodies, joints, work, time, h)
            if control.split > 0.0 and work.status.outcome == 0:
                go_back(systems)
                split, control.split, struck = control.split, 0.0, True
                continue
            watch_forces(forces, work)
            finish(bodies, h, work)
            if work.status.outcome != 0:
                return index
            recorded = h == interval and (index + 1) % every == 0
            direct(forces, forces, bodies, joints, systems, work, time, h, recorded)
            if control.split > 0.0:  # something begins within the step
                go_back(systems)
                after_step(systems, bodies, work, h, False)
                take_back(forces)
                split, control.split, struck = control.split, 0.0, False
                continue
            if tolerance == 0.0 and split == 0.0:
                # the rest behind something that a scenario does gives no information; behind an impact it is grown from
                wanted = 2.0 * h if struck else max(2.0 * h, control.next_step)
                control.next_step, struck = min(wanted, step), False
            natural = tolerance > 0.0 and split == 0.0
            split = 0.0
            control.last_step = h
            control.step_count += 1
            done = step if h == interval else done + h
            after_step(systems, bodies, work, h, natural or done == step)
            watch_motions(forces, bodies, work)
        if (index + 1) % every == 0:
            write_record(bodies, forces, joints, systems, work, (index + 1) * step, records[row])
            row += 1
        if work.status.outcome != 0:  # an operation ends, and all that has been done is good
            return index + 1
    return last
