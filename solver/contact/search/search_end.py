"""How a search ended: noted for the end of the step, and what the step does about it.

A search in a trial step that is taken back does no harm, so its end is judged when the step stands.
"""

from __future__ import annotations

from heavylift.contours.splines.evaluate import surface_point
from heavylift.contours.splines.search_step import CONVERGED
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.solver.contact.counts import block_of, contact_count
from heavylift.solver.contact.kind import (
    FOUND,
    LOST,
    NO_PLACE,
    NOT_A_NUMBER,
    PRESSED_IN,
    TOO_DEEP,
    ContactRows,
)
from heavylift.solver.interface import Workspace

__all__ = ["judge_searches", "mark_failure", "note_search"]

NOT_CONVERGED = int(Outcome.NOT_CONVERGED)


@kernel(internal=True)
def mark_failure(contacts: ContactRows, contact: int, reason: int, work: Workspace) -> None:
    """Say that place or impulses of a contact were not found, and why; its block comes after those of the joints."""
    contacts.control.failure = reason
    work.status.outcome = NOT_CONVERGED
    work.status.block = block_of(contacts, contact)


@kernel(internal=True)
def note_search(contacts: ContactRows, c: int, status: int) -> None:
    """Keep the status of a search over a surface; one that found nothing leaves the last place."""
    state, scratch = contacts.state[c], contacts.scratch
    state.search = FOUND
    if status != CONVERGED:
        contour = contacts.contours[contacts.table[c].contour]
        result, evaluate = scratch.result, scratch.evaluation
        u, v, knots = state.u, state.v, contacts.constants
        surface_point(contour, knots, knots, contacts.net, u, v, evaluate, result)
        result.u, result.v, result.flags = u, v, 0
        state.search = status


@kernel(internal=True)
def judge_searches(contacts: ContactRows, at_end: bool, work: Workspace) -> None:
    """Count what found nothing; stop where a closed contact did, or a primitive is pressed in deeper than its rounding.

    In the middle of a step only what takes part has been searched, and a depth there may still be pushed out.
    """
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        if not at_end and not state.present:
            continue
        if LOST <= state.search <= NOT_A_NUMBER:
            state.search = FOUND
            state.failures += 1
            if state.closed:
                mark_failure(contacts, c, NO_PLACE, work)
        elif at_end and state.search == TOO_DEEP:
            mark_failure(contacts, c, PRESSED_IN, work)
