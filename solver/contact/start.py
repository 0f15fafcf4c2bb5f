"""Contacts before time starts: where they touch, and impacts of what touches and approaches already."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.interface import pose_contours, settle_points
from heavylift.solver.contact.kind import BILATERAL, COMPLIANT, CURVE, RIGID, ContactRows
from heavylift.solver.contact.search.contact_kinematics import locate
from heavylift.solver.contact.solve.asleep import wake_all
from heavylift.solver.contact.solve.delassus import contact_rates
from heavylift.solver.contact.solve.events import gap_tolerance
from heavylift.solver.contact.solve.impacts import REST, count_rough, pressed_force
from heavylift.solver.contact.triangles.interface import search_surfaces
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Joints,
    Systems,
    Workspace,
    complete,
    end_velocity,
    fill_markers,
    finish,
    forget_accelerations,
    set_velocity,
    solve_end,
)

__all__ = ["run_start"]


@entry
def run_start(
    contacts: ContactRows, bodies: Bodies, joints: Joints, systems: Systems, work: Workspace, step: float
) -> None:
    """Locate all contacts; velocities after the impacts at t = 0.

    Notes
    -----
    The same projection as at the end of a step: what is closed and approaches obeys Newton's law, sliders and
    beads take velocities that keep them where they are.
    """
    end_velocity(bodies, step, work)
    fill_markers(bodies, False, FORCES, work)
    _locate_all(contacts, bodies, work, step)
    solve_end(systems, systems, bodies, joints, work, -step, step)
    complete(bodies, systems, False, step, work)
    set_velocity(bodies, step, work)
    finish(bodies, step, work)
    forget_accelerations(bodies)
    _close(contacts, step, work)


@kernel(internal=True)
def _locate_all(contacts: ContactRows, bodies: Bodies, work: Workspace, step: float) -> None:
    """Search from everywhere; sliders and beads are closed from the start."""
    contacts.control.nominal_step, contacts.control.part = step, 1.0
    wake_all(contacts)
    pose_contours(bodies, False, contacts)
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        locate(contacts, bodies, c, True, work)
        state.gap, state.second_gap, state.sleep = state.end_gap, state.second_end_gap, state.end_gap
        state.present = False
        state.closed = contacts.table[c].law == BILATERAL or contacts.table[c].law == CURVE
    search_surfaces(contacts.meshes, contacts, bodies, work, step, True)
    settle_points(bodies, (), False, work)


@kernel(internal=True)
def _close(contacts: ContactRows, step: float, work: Workspace) -> None:
    """What has met without restitution stays closed, and what rests; impulses and forces are none yet.

    A body that is put onto another one has gaps of rounding errors, and whether it bears must not be theirs to say. A
    closed contact pushes and never pulls, so one that does not bear is open again after the first step.
    """
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        after = contact_rates(contacts, c, work.velocity)[0]
        if state.new and after <= REST * abs(state.rate):
            state.closed = True
        tolerance = gap_tolerance(contacts, c, after)
        if contacts.table[c].law == RIGID and state.gap <= tolerance and after * step <= tolerance:
            state.closed = True
        state.rate, state.recent_impacts = after, 0
        if contacts.table[c].law == COMPLIANT:
            force = pressed_force(contacts, c, after)
            state.normal_force = force
            contacts.rows[c].reaction[0] = force
            for k in range(3):
                state.force[k] = force * state.normal[k]
    contacts.control.impact = False
    count_rough(contacts)
