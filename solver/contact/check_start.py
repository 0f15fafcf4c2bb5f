"""Contacts at the start: located, met, and refused if they begin where they cannot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.contact.kind import (
    BILATERAL,
    COMPLIANT,
    CURVE,
    LOST,
    NOT_A_NUMBER,
    TOO_DEEP,
    ContactRows,
    Events,
)
from heavylift.solver.contact.start import run_start

__all__ = [
    "check_places",
    "forget_trials",
    "keep_touching",
    "put_forces",
    "resting_forces",
    "restore",
    "start_contacts",
]

ON_CONTOUR = 1e-3
"""Distance from its contour relative to its size, at which a slider or bead may start: the first steps bring it
there."""

TOUCHING = 1e-6
"""Gap relative to its size, at which a contact that nothing has moved yet touches."""

DEEPEST = 0.05
"""Penetration relative to the size of a contour at which a point may start; a ball may by its radius."""


def start_contacts(layout: Any, step: float, *, settled: bool = False) -> None:
    """Find out where contacts touch, and what the impacts at the start leave of the velocities.

    Parameters
    ----------
    layout
        Packed scene, started.
    step
        Of the simulation [s].
    settled
        The scene has come to rest with its contacts, as deep as their laws let it: nothing is refused.

    Raises
    ------
    InputError
        If something starts too deep inside a contour, or a slider off its own.
    """
    contacts: ContactRows = layout.systems[1]
    first, count = contacts.counts.first_block, contacts.counts.of_contours
    run_start(contacts, layout.bodies, layout.joints, layout.systems, layout.work, step)
    restore(contacts)
    if settled:
        return
    if contacts.meshes:
        from heavylift.solver.contact.triangles.start import check_overlaps

        check_overlaps(contacts, layout.block_names[first + count :])
        if layout.work.status.outcome == int(Outcome.TOO_MANY_CONTACTS):
            raise InputError(
                "more contacts at the start than there is room for",
                source=layout.block_names[int(layout.work.status.block)],
                key="most_contacts",
                expected="more of them, or a larger 'patch_size'",
            )
    check_places(contacts, layout.block_names[first : first + count])


def forget_trials(layout: Any) -> None:
    """After a state has been restored, brackets of impacts of an unfinished step mean nothing, and contacts are others.

    Parameters
    ----------
    layout
        Packed scene.
    """
    contacts: ContactRows = layout.systems[1]
    restore(contacts)
    control: Events = contacts.control
    control.low = control.low_gap = control.high = control.high_gap = control.high_rate = 0.0
    control.impact, control.exhausted, control.splits = False, False, 0
    control.watched = control.joins = -1
    control.effort = 0.0
    layout.work.control.split = 0.0


def resting_forces(contacts: ContactRows) -> dict[tuple[int, ...], NDArray[np.void]] | None:
    """What contacts without compliance have borne in the first step, by what touches; nothing if it had impacts.

    Parameters
    ----------
    contacts
        After the step, with the counts of impacts since the start.
    """
    state: Any = contacts.state[: int(contacts.counts.total)]
    if not contacts.control.uncut or np.any(state["impacts"] > 0):
        return None
    return {
        _features(contacts, c): state[c].copy()
        for c in range(len(state))
        if state[c].closed and state[c].present and contacts.table[c].law != COMPLIANT
    }


def put_forces(contacts: ContactRows, forces: dict[tuple[int, ...], NDArray[np.void]]) -> None:
    """Give contacts that touch at the start the forces of their first step, for the record of the start.

    Parameters
    ----------
    contacts
        At the start.
    forces
        Of `resting_forces`.
    """
    for c in range(int(contacts.counts.total)):
        touches = (
            contacts.state[c].closed or contacts.state[c].gap <= TOUCHING * contacts.values[c].length_scale
        )
        found = forces.get(_features(contacts, c))
        if touches and found is not None:
            for name in ("normal_force", "friction_force", "force"):
                contacts.state[name][c] = found[name]


def _features(contacts: ContactRows, c: int) -> tuple[int, ...]:
    """What a contact is between: its number on contours; pair and features between triangles, whose numbers change."""
    state = contacts.state[c]
    if c < contacts.counts.of_contours:
        return (c,)
    return (int(state.pair), int(state.feature_kind), int(state.feature), int(state.other_feature))


def restore(contacts: ContactRows) -> None:
    """What follows from the carried state of contacts between triangles."""
    for meshes in contacts.meshes:
        from heavylift.solver.contact.triangles.slots import restore_contacts

        restore_contacts(meshes, contacts)


def keep_touching(contacts: ContactRows) -> Callable[[], None]:
    """What touches now where surfaces deform with modes: the function makes contacts of it again.

    What carries a face that bends does not follow from where it lies: other points of it would carry it elsewhere.
    """
    first, count = contacts.counts.of_contours, int(contacts.counts.total)
    held = contacts.state[first:count].copy()

    def put_back() -> None:
        for meshes in contacts.meshes if len(contacts.modal.rows) else ():
            from heavylift.solver.contact.triangles.slots import hold_contacts

            hold_contacts(meshes, contacts, held, len(held))

    return put_back


def check_places(contacts: ContactRows, names: Sequence[str]) -> None:
    """Refuse what starts where it cannot.

    Parameters
    ----------
    contacts
        Located.
    names
        Of the contacts with contours.

    Raises
    ------
    InputError
        As `start_contacts`.
    """
    for i, name in enumerate(names):
        table, values, state = contacts.table[i], contacts.values[i], contacts.state[i]
        gap, size = float(state.gap), float(values.length_scale)
        if LOST <= state.search <= NOT_A_NUMBER:
            raise InputError(
                "no nearest point was found on its contour",
                source=name,
                key="between",
                expected="a contour with tangents everywhere, of finite points",
            )
        if table.law in {BILATERAL, CURVE}:
            distance = float(np.hypot(gap, state.second_gap)) if table.law == CURVE else abs(gap)
            if not distance <= ON_CONTOUR * size:
                raise InputError(
                    f"starts {distance:.4g} m off its contour",
                    source=name,
                    key="point",
                    expected=f"{ON_CONTOUR * size:.4g} m at most",
                )
            continue
        if state.search == TOO_DEEP:
            raise InputError(
                f"starts {-gap:.4g} m inside its contour, deeper than its rounding",
                source=name,
                key="shape",
                expected="a start outside, or a larger radius about its core",
            )
        deepest = float(values.extent) if values.extent > 0.0 else DEEPEST * size
        if table.law != COMPLIANT:
            deepest *= 0.1
        if not gap >= -deepest:
            raise InputError(
                f"starts {-gap:.4g} m inside its contour",
                source=name,
                key="point",
                expected=f"outside, or at most {deepest:.4g} m inside; or 'flip', if the normal points inwards",
            )
