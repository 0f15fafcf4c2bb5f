"""Contacts before time starts: where they touch, and impacts of what touches and approaches already."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.delassus import contact_rates
from heavylift.solver.contact.ends import REST, pressed_force
from heavylift.solver.contact.interface import forget_accelerations, pose_contours, settle_points
from heavylift.solver.contact.kind import (
    BILATERAL,
    CLOSED,
    COMPLIANT,
    CURVE,
    END_GAP,
    END_GAP_2,
    FORCE,
    GAP,
    GAP_2,
    IMPACT,
    LAW,
    NEW,
    NOMINAL,
    NORMAL,
    NORMAL_FORCE,
    PRESENT,
    RATE,
    RECENT,
    SLEEP,
    ContactRows,
)
from heavylift.solver.contact.locate import locate
from heavylift.solver.contact.mesh_interface import find_first_contacts
from heavylift.solver.contact.system_interface import close_start, locate_start, project_contacts
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
    set_velocity,
    solve_end,
)
from heavylift.solver.kinds import implement

__all__ = ["run_start"]


@entry
def run_start(
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    step: float,
) -> None:
    """Locate all contacts; velocities after the impacts at t = 0.

    Notes
    -----
    The same projection as at the end of a step: what is closed and approaches obeys Newton's law, sliders and
    beads take velocities that keep them where they are.
    """
    end_velocity(bodies, step, work)
    fill_markers(bodies, False, FORCES, work)
    locate_start(systems, bodies, work, step)
    solve_end(systems, bodies, joints, work, -step, step)
    project_contacts(systems, bodies, systems, joints, work, 0.0, step)
    complete(bodies, systems, False, step, work)
    set_velocity(bodies, step, work)
    finish(bodies, step, work)
    forget_accelerations(bodies)
    close_start(systems, work)


@implement(locate_start, ContactRows)
@kernel(internal=True)
def locate_contact_start(contacts: ContactRows, bodies: Bodies, work: Workspace, step: float) -> None:
    """Search from everywhere; sliders and beads are closed from the start."""
    contacts.control[NOMINAL] = step
    pose_contours(bodies, False, contacts)
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        locate(contacts, bodies, c, True, work)
        state[GAP], state[GAP_2], state[SLEEP] = state[END_GAP], state[END_GAP_2], state[END_GAP]
        state[PRESENT] = 0.0
        state[CLOSED] = 1.0 if contacts.table[c, LAW] == BILATERAL or contacts.table[c, LAW] == CURVE else 0.0
    find_first_contacts(contacts.meshes, contacts, bodies, work, step)
    settle_points(bodies, (), False, work)


@implement(close_start, ContactRows)
@kernel(internal=True)
def close_contact_start(contacts: ContactRows, work: Workspace) -> None:
    """What has met without restitution stays closed; impulses and forces are none yet."""
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        after = contact_rates(contacts, c, work.velocity)[0]
        if state[NEW] > 0.0 and after <= REST * abs(state[RATE]):
            state[CLOSED] = 1.0
        state[RATE], state[RECENT] = after, 0.0
        if contacts.table[c, LAW] == COMPLIANT:
            force = pressed_force(contacts, c, after)
            state[NORMAL_FORCE] = force
            contacts.rows[c].reaction[0] = force
            for k in range(3):
                state[FORCE + k] = force * state[NORMAL + k]
    contacts.control[IMPACT] = 0.0
