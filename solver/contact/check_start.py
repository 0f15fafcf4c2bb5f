"""Contacts at the start: located, met, and refused if they begin where they cannot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.contact.kind import (
    BILATERAL,
    COMPLIANT,
    CURVE,
    EXTENT,
    GAP,
    GAP_2,
    LAW,
    LOST,
    NOT_A_NUMBER,
    SEARCH,
    SIZE,
    TOO_DEEP,
    ContactRows,
)
from heavylift.solver.contact.start import run_start

__all__ = ["check_places", "start_contacts"]

ON_CONTOUR = 1e-3
"""Distance from its contour relative to its size, at which a slider or bead may start: the first steps bring it
there."""

DEEPEST = 0.05
"""Penetration relative to the size of a contour at which a point may start; a ball may by its radius."""


def start_contacts(layout: Any, step: float) -> None:
    """Find out where contacts touch, and what the impacts at the start leave of the velocities.

    Parameters
    ----------
    layout
        Packed scene, started.
    step
        Of the simulation [s].

    Raises
    ------
    InputError
        If something starts too deep inside a contour, or a slider off its own.
    """
    contacts: ContactRows = layout.systems[1]
    run_start(layout.bodies, layout.joints, layout.systems, layout.work, step)
    check_places(contacts, layout.block_names[-len(contacts.table) :])


def check_places(contacts: ContactRows, names: Sequence[str]) -> None:
    """Refuse what starts where it cannot.

    Parameters
    ----------
    contacts
        Located.
    names
        Of the contacts.

    Raises
    ------
    InputError
        As `start_contacts`.
    """
    for name, table, values, state in zip(
        names, contacts.table, contacts.values, contacts.state, strict=True
    ):
        gap, size = float(state[GAP]), float(values[SIZE])
        if LOST <= state[SEARCH] <= NOT_A_NUMBER:
            raise InputError(
                "no nearest point was found on its contour",
                source=name,
                key="between",
                expected="a contour with tangents everywhere, of finite points",
            )
        if table[LAW] in {BILATERAL, CURVE}:
            distance = float(np.hypot(gap, state[GAP_2])) if table[LAW] == CURVE else abs(gap)
            if not distance <= ON_CONTOUR * size:
                raise InputError(
                    f"starts {distance:.4g} m off its contour",
                    source=name,
                    key="point",
                    expected=f"{ON_CONTOUR * size:.4g} m at most",
                )
            continue
        if state[SEARCH] == TOO_DEEP:
            raise InputError(
                f"starts {-gap:.4g} m inside its contour, deeper than its rounding",
                source=name,
                key="shape",
                expected="a start outside, or a larger radius about its core",
            )
        deepest = float(values[EXTENT]) if values[EXTENT] > 0.0 else DEEPEST * size
        if table[LAW] != COMPLIANT:
            deepest *= 0.1
        if not gap >= -deepest:
            raise InputError(
                f"starts {-gap:.4g} m inside its contour",
                source=name,
                key="point",
                expected=f"outside, or at most {deepest:.4g} m inside; or 'flip', if the normal points inwards",
            )
