"""Islands of bodies at rest are asleep: they are neither searched nor solved until something reaches them.

An island is made of free rigid bodies that touch each other, the ground and fixed bodies, and nothing else. It falls
asleep when all of its bodies have stood for `LONG` whole steps: each one within `STILL` of one pose, under one load
without contacts, and with contacts that leave it no velocity. From then on its bodies have the velocity zero, which is
what the contacts would give them, and the contacts keep their forces, gaps and sides; so nothing creeps, and no energy
changes.

What may wake it is measured, not listed. The velocity that a body would have without contacts tells its load, whatever
makes that up (gravity, springs, wind, drives, a blow): another load, and all of the island is awake in this very step.
A contact with what is awake, as soon as there is one that touches, comes near or hits, does the same, and the step is
repeated. Bodies on joints or ropes do not sleep, nor do those that touch what deforms, is driven or floats, or has a
contact with compliance or with a contour.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.triangles.feature_gap import copy_pose
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.interface import keep_places
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.triangles.still import is_at
from heavylift.solver.interface import Bodies, Workspace

__all__ = [
    "both_rest",
    "hold_places",
    "let_sleep",
    "note_balance",
    "note_loads",
    "rests",
    "stop_asleep",
    "wake_all",
    "wake_reached",
    "wake_touched",
]

LONG = 50
"""Whole steps in which all of an island has stood before it sleeps."""

STEADY = 1e-9
"""Of the load of a body, without contacts, by which it changes at most, and by which contacts fail to bear it."""

REACHED = 1e-6
"""Of the size of a contact: a gap below is near enough to wake what sleeps."""


@kernel(inline=True, internal=True)
def _sleeps(contacts: ContactRows, sleeper: int) -> bool:
    """Whether one side of a contact, numbered as in `ContactEntry.sleepers`, is asleep."""
    return sleeper > 0 and contacts.slept[sleeper - 1].island > 0


@kernel(inline=True, internal=True)
def rests(contacts: ContactRows, c: int) -> bool:
    """Whether a contact is between two bodies that sleep, or one and what never moves."""
    return both_rest(contacts, contacts.table[c].sleepers[0], contacts.table[c].sleepers[1])


@kernel(inline=True, internal=True)
def both_rest(contacts: ContactRows, a: int, b: int) -> bool:
    """The same of two sides, numbered as in `ContactEntry.sleepers`."""
    if a == 0 or b == 0 or (a < 0 and b < 0):
        return False
    return (a < 0 or contacts.slept[a - 1].island > 0) and (b < 0 or contacts.slept[b - 1].island > 0)


@kernel(internal=True)
def _wake(contacts: ContactRows, sleeper: int) -> None:
    """The island of a body that sleeps."""
    island = contacts.slept[sleeper].island
    for i in range(contacts.slept.shape[0]):
        if contacts.slept[i].island == island:
            contacts.slept[i].island = contacts.slept[i].still = 0


@kernel(internal=True)
def wake_all(contacts: ContactRows) -> None:
    """Where all begins anew."""
    for i in range(contacts.slept.shape[0]):
        contacts.slept[i].island = contacts.slept[i].still = 0


@kernel(internal=True)
def _wake_sides(contacts: ContactRows, c: int) -> bool:
    """What sleeps of the sides of a contact that is not all at rest; whether there was anything."""
    woken = False
    if not rests(contacts, c):
        for side in range(2):
            sleeper = contacts.table[c].sleepers[side]
            if _sleeps(contacts, sleeper):
                _wake(contacts, sleeper - 1)
                woken = True
    return woken


@kernel(inline=True, internal=True)
def _largest(load: NDArray[np.float64], size: float) -> float:
    """Of accelerations [m/s2], with angular ones at a size."""
    largest = 0.0
    for k in range(3):
        largest = max(largest, abs(load[k]), size * abs(load[3 + k]))
    return largest


@kernel(internal=True)
def _is_steady(contacts: ContactRows, i: int) -> bool:
    """Whether the load of a body is the one it has stood under."""
    load, before, size = contacts.sleepers[i].load, contacts.slept[i].load, contacts.sleepers[i].size
    change = 0.0
    for k in range(3):
        change = max(change, abs(load[k] - before[k]), size * abs(load[3 + k] - before[3 + k]))
    return change <= STEADY * _largest(before, size)


@kernel(internal=True)
def note_loads(contacts: ContactRows, work: Workspace, step: float) -> None:
    """Accelerations of the bodies without contacts, in the middle of a step; what sleeps wakes under another load."""
    for i in range(contacts.sleepers.shape[0]):
        dof, load = contacts.sleepers[i].dof, contacts.sleepers[i].load
        for k in range(6):
            load[k] = 2.0 / step * work.velocity[dof + k]
        if contacts.slept[i].island > 0 and not _is_steady(contacts, i):
            _wake(contacts, i)


@kernel(internal=True)
def wake_touched(contacts: ContactRows, count: int) -> bool:
    """Wake what is asleep and touches something of those that take part; whether anything was."""
    woken = False
    if contacts.slept.shape[0] > 0:
        for j in range(count):
            woken = _wake_sides(contacts, contacts.present[j]) or woken
    return woken


@kernel(internal=True)
def stop_asleep(contacts: ContactRows, velocity: NDArray[np.float64]) -> None:
    """What sleeps has no velocity."""
    for i in range(contacts.slept.shape[0]):
        if contacts.slept[i].island > 0:
            dof = contacts.sleepers[i].dof
            for k in range(6):
                velocity[dof + k] = 0.0


@kernel(internal=True)
def note_balance(contacts: ContactRows, work: Workspace, step: float) -> None:
    """Whether contacts bear the loads of the bodies in the middle of the step."""
    for i in range(contacts.sleepers.shape[0]):
        sleeper = contacts.sleepers[i]
        moves = _largest(work.velocity[sleeper.dof : sleeper.dof + 6], sleeper.size)
        sleeper.balanced = moves <= STEADY * 0.5 * step * _largest(sleeper.load, sleeper.size)


@kernel(internal=True)
def hold_places(contacts: ContactRows, bodies: Bodies) -> None:
    """What sleeps is where it was, whatever rounding has done to its orientation."""
    for i in range(contacts.slept.shape[0]):
        if contacts.slept[i].island > 0:
            keep_places(bodies, contacts, True)
            return


@kernel(inline=True, internal=True)
def _reaches(contacts: ContactRows, c: int) -> bool:
    """Whether both sides of a contact touch, or might in this step or the next one."""
    state = contacts.state[c]
    near = state.end_gap <= REACHED * contacts.values[c].length_scale
    return state.closed or state.hit > 0 or state.passed > 0.0 or near


@kernel(internal=True)
def wake_reached(contacts: ContactRows) -> bool:
    """Wake what is asleep and has been reached at the end of the step; whether anything was."""
    woken = False
    if contacts.slept.shape[0] > 0:
        for c in range(contacts.counts.of_contours, contact_count(contacts)):
            if _reaches(contacts, c):
                woken = _wake_sides(contacts, c) or woken
    return woken


@kernel(internal=True)
def let_sleep(contacts: ContactRows, bodies: Bodies) -> None:
    """After a whole step that stands: count how long each body has stood, and find islands that all have."""
    ready = False
    for i in range(contacts.sleepers.shape[0]):
        sleeper, slept = contacts.sleepers[i], contacts.slept[i]
        if slept.island > 0 or not sleeper.allowed:
            continue
        pose = contacts.poses[sleeper.pose]
        if sleeper.balanced and _is_steady(contacts, i) and is_at(pose, slept.pose, sleeper.size):
            slept.still += 1
            ready = ready or slept.still >= LONG
            continue
        slept.still = 0
        copy_pose(pose, slept.pose)
        for k in range(6):
            slept.load[k] = sleeper.load[k]
    if ready and _put_to_sleep(contacts):
        keep_places(bodies, contacts, False)


@kernel(internal=True)
def _root(contacts: ContactRows, i: int) -> int:
    """First body of the group of one, as far as it is known."""
    while contacts.sleepers[i].group != i:
        i = contacts.sleepers[i].group
    return i


@kernel(internal=True)
def _put_to_sleep(contacts: ContactRows) -> bool:
    """Bodies that touch, directly or through others, form a group; one that is ready as a whole sleeps as an island."""
    count = contacts.sleepers.shape[0]
    for i in range(count):
        contacts.sleepers[i].group = i
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        a, b = contacts.table[c].sleepers[0], contacts.table[c].sleepers[1]
        if a > 0 and b > 0 and _reaches(contacts, c):
            first, second = _root(contacts, a - 1), _root(contacts, b - 1)
            contacts.sleepers[max(first, second)].group = min(first, second)
    for i in range(count):
        contacts.sleepers[i].blocked = False
    for i in range(count):
        slept = contacts.slept[i]
        if slept.island > 0 or slept.still < LONG:
            contacts.sleepers[_root(contacts, i)].blocked = True
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        for side in range(2):
            one, other = contacts.table[c].sleepers[side], contacts.table[c].sleepers[1 - side]
            if one > 0 and other == 0 and _reaches(contacts, c):
                contacts.sleepers[_root(contacts, one - 1)].blocked = True
    found = False
    for i in range(count):
        root = _root(contacts, i)
        if not contacts.sleepers[root].blocked:
            contacts.slept[i].island = 1 + root
            found = True
    return found
