"""What a user should know of a run: why it stopped by itself and what may help, and how meshes were stepped."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from heavylift.numerics.outcome import Outcome
from heavylift.solver.interface import STIFFENED
from heavylift.solver.layout import Layout

__all__ = [
    "contact_warning",
    "drive_warning",
    "energy_remedy",
    "force_warning",
    "hull_warning",
    "loop_warning",
    "mesh_warning",
    "stop_message",
]

LARGEST_TWIST = 0.48
"""Sine of the twist of an element of a rod from which its torsion is 4 % too soft."""

COMPLIANT_LAW = "a compliant law ('linear') where bodies wedge or are pressed together"
"""Helps where a smaller step and less friction do not: what has no compliance bears any load without giving way."""


def stop_message(layout: Layout, when: str) -> str:
    """Sentence on the outcome that stands in the status of a scene.

    Parameters
    ----------
    layout
        Packed scene.
    when
        Time, as words.
    """
    status = layout.work.status
    outcome = Outcome(int(status.outcome))
    if outcome is Outcome.LIMIT_REACHED:  # that of a scenario has its own words
        return f"stopped at {when}: {_tank_limit(layout)}"
    remedy, part = {
        Outcome.NOT_FINITE: ("a smaller step, or loads and initial values of a sensible size", "body"),
        Outcome.STEP_TOO_LARGE: (
            _explicit_limit(layout) or f"a smaller step{_softer(layout)}: the body turns too far in one step",
            "body",
        ),
        Outcome.STEP_TOO_SMALL: ("a larger tolerance, or 'dele2' for a stiff scene", "body"),
        Outcome.NOT_CLOSED: (
            "a smaller step or tolerance, loads of a sensible size, a rope that is not hauled in whole",
            "joint",
        ),
        Outcome.STRAINS_LOST: ("a smaller step, or elasticity 'auto' or 'energy-momentum'", "body"),
        Outcome.NOT_CONVERGED: ("a smaller step, or softer stops and ropes", "joint"),
        Outcome.TOO_MANY_CONTACTS: ("a larger 'most_contacts' or 'patch_size'", "collision"),
        Outcome.OUTSIDE_DATABASE: ("a database that covers the motion", "body"),
        Outcome.OFF_ROAD: ("a longer or wider deck, ramps at its edges, or a shorter run", "transporter"),
        Outcome.LINE_OVERSTRETCHED: ("a longer or stronger line, or a larger 'strain_limit'", "line"),
    }[outcome]
    reason = vehicle = ""
    if outcome is Outcome.OUTSIDE_DATABASE:
        from heavylift.solver.water.hulls.checks import left_because

        happened, remedy = left_because(layout.bodies, int(status.body))
        reason = f": {happened}" if happened else ""
    if outcome is Outcome.STEP_TOO_SMALL:
        reason = _creeping(layout)
    if outcome is Outcome.NOT_CLOSED:
        parted = _parted(layout, int(status.block))
        if parted[0]:
            part, reason, remedy = parted
    if outcome is Outcome.OFF_ROAD:
        vehicle, reason = _where_off_road(layout)
        if "tipped over" in reason:
            remedy = "groups farther apart, a lower load, or a smoother path"
    thrown, jolt = _jolt(layout) if outcome is Outcome.STEP_TOO_LARGE else ("", "")
    if jolt:
        part, reason, vehicle = "transporter", jolt, thrown
        remedy = "a smaller step, softer oil or tyres, lower speed, or a ramp"
    if status.block == STIFFENED:
        part, reason = "body", ": its stiffening by loads takes a shorter step"
        remedy = "a smaller step, fewer static vectors of high frequency, or smaller loads along it"
    of_mesh = STIFFENED < status.block < 0
    if of_mesh and part == "joint":  # the iteration of a mesh
        remedy, part = "a smaller step", "body"
    if outcome is Outcome.NOT_CONVERGED and part == "joint":
        contact = int(status.block) - _first_contact(layout)
        if contact >= 0:
            part = "contact"
            reason, remedy = _contact_remedy(layout, contact)
    rope = _hauled_in(layout) if outcome in {Outcome.NOT_CLOSED, Outcome.NOT_FINITE} else ""
    if rope:
        reason = f": rope {rope!r} is hauled in whole by its winch"
        remedy = "a winch that stops before, or a longer rope"
    names = {"body": layout.body_names, "line": layout.line_names}.get(part, layout.block_names)
    number = int(status.body if part in {"body", "line"} else status.block)
    element = f", element {-1 - int(status.block)}" if of_mesh else ""
    # other rows of the same step may have left their number after a wheel ended the run
    name = vehicle if part == "transporter" and vehicle else names[number]
    return f"{outcome.text} at {when}, {part} {name!r}{element}{reason}; try {remedy}"


def loop_warning(layout: Layout, tolerance: float) -> str:
    """Rows that follow from others, and open by more than positions may be wrong [m]; empty without."""
    progress = getattr(layout.systems[-1], "progress", None) if layout.systems else None
    if progress is None or not progress.left_open > tolerance:
        return ""
    return (
        f"joints of a loop contradict each other: some of what they hold follows from the rest but for"
        f" {progress.left_open:.3g} m or rad, by which it has opened, and the loop moves as if it were not there; give"
        " its axes and points with more digits, or leave the joint out that holds it twice"
    )


def _creeping(layout: Layout) -> str:
    """How many steps have led to no record, if there were too many; empty without."""
    progress = layout.systems[-1].progress
    if progress.steps < progress.most_steps:
        return ""
    return f": {progress.steps:,} steps since the last record, the last one of {layout.work.control.last_step:.3g} s"


def _parted(layout: Layout, block: int) -> tuple[str, str, str]:
    """What a law is called whose positions have left the elongation that it carries, how far, and what may help."""
    for kind in layout.joints:
        uses = ("lines", "line") if "lines" in kind._fields else ("table", "state")
        if uses[0] not in kind._fields or "largest_drift" not in (getattr(kind, uses[0]).dtype.names or ()):
            continue
        entries, states = (getattr(kind, field) for field in uses)
        for entry, state in zip(entries, states, strict=True):
            if entry["block"] == block:
                if "overlap" in (states.dtype.names or ()) and not state["overlap"] > 0.0:
                    side = "left" if entry["left"] else "right"
                    reason = f": the {side} end of its line has slid off the deck"
                    return (
                        "line bearing",
                        reason,
                        "a longer body or deck, or something that holds its sides at their distance",
                    )
                names = states.dtype.names or ()
                word, unit = ("rope", " m") if {"rest", "depth"} & set(names) else ("law of", "")
                reason = f": positions have left the integrated elongation of its force, by {state['drift']:.3g}{unit}"
                return word, reason, "a smaller step: a third of a period of what hangs on it is too long"
    return "", "", ""


def _whose(layout: Layout, kind: Any, number: int) -> str:
    """Name of the transporter that a bogie belongs to."""
    groups = kind.groups
    group = next(g for g in groups if g["first"] <= number < g["first"] + g["count"])
    return layout.block_names[int(group["block"])]


def _jolt(layout: Layout) -> tuple[str, str]:
    """Which transporter has a bogie that is thrown up within a step, and which bogie; empty if none is."""
    from heavylift.solver.transport.transporters import JOLT

    for kind in layout.joints:
        if "bogie_state" not in kind._fields or "vehicles" not in kind._fields:
            continue
        for number in np.flatnonzero(kind.bogie_state["failure"] == JOLT):
            vehicle = next(v for v in kind.vehicles if v.first_bogie <= number < v.first_bogie + v.bogies)
            return _whose(layout, kind, int(number)), (
                f": the load of bogie {number - int(vehicle.first_bogie) + 1} changes by "
                f"{kind.bogie_state[number].station:.3g} times that at rest within a step"
            )
    return "", ""


def _where_off_road(layout: Layout) -> tuple[str, str]:
    """Which transporter has a bogie without road, or that meets what it cannot climb; which bogie, and where."""
    from heavylift.solver.transport.transporters import TIPPED, WALL

    for kind in layout.joints:
        if "bogie_state" not in kind._fields:
            continue
        failed = np.flatnonzero(kind.bogie_state["failure"])
        if not failed.size:
            continue
        number = int(failed[0])
        state = kind.bogie_state[number]
        vehicle = next(v for v in kind.vehicles if v.first_bogie <= number < v.first_bogie + v.bogies)
        happened = {
            WALL: "meets a step that it cannot climb",
            TIPPED: "leans by more than 60 degrees, its vehicle has tipped over",
        }.get(int(state.failure), "has no deck below it")
        return _whose(layout, kind, number), (
            f": bogie {number - int(vehicle.first_bogie) + 1} {happened}, at station {state.station:.6g} m and offset "
            f"{state.offset:.6g} m of deck {layout.deck_names[int(state.deck)]!r}"
        )
    return "", ""


def _tank_limit(layout: Layout) -> str:
    """Which tank runs over or dry, and what may help."""
    for kind in layout.bodies:
        if not kind.FLOATS:
            continue
        over = kind.tanks["mass"] - kind.tanks["capacity"]
        for number in np.flatnonzero((over > 0.0) | (kind.tanks["mass"] < 0.0)):
            tank, name = kind.tanks[number], layout.tank_names[number]
            if tank.mass < 0.0:
                return f"tank {name!r} runs dry while a pump draws from it; try more water in it, or a shorter plan"
            return f"tank {name!r} overflows, it holds {tank.capacity:.6g} kg; try less water in it, or a shorter plan"
    return "a tank overflows or runs dry"


def _hauled_in(layout: Layout) -> str:
    """Name of a rope of which nothing is left; empty if there is none."""
    for kind in layout.joints:
        if "winches" in kind._fields:
            for entry, state in zip(kind.table, kind.state, strict=True):
                if entry.block >= 0 and not state.fresh and not state.next_rest > 0.0:
                    return layout.block_names[entry.block]
    return ""


def _first_contact(layout: Layout) -> int:
    """Number of the first block that is a contact; behind the last block if there is none."""
    for system in _contacts(layout):
        return int(system.counts.first_block)
    return len(layout.block_names)


def _contacts(layout: Layout) -> list[Any]:
    """The system of the contacts, if there is one."""
    return [system for system in layout.systems if "contours" in system._fields]


def energy_remedy(layout: Layout) -> str:
    """What may help where steps make or lose energy, beside a smaller step or tolerance; empty if nothing.

    Parameters
    ----------
    layout
        Packed scene.
    """
    laws = any("monitor" in system._fields and system.laws for system in layout.systems)
    return (", or damping in stops and ropes" if laws else "") + _softer(layout)


def _has_rigid(layout: Layout) -> bool:
    """Whether contacts push that have no compliance."""
    systems = _contacts(layout)
    if not systems:
        return False
    from heavylift.solver.contact.kind import RIGID

    (contacts,) = systems
    laws = [contacts.table["law"][: contacts.counts.of_contours], *(m.pairs["law"] for m in contacts.meshes)]
    return any(bool(np.any(law == RIGID)) for law in laws)


def _softer(layout: Layout) -> str:
    """A compliant law, as one more remedy where contacts have none."""
    return f", or {COMPLIANT_LAW}" if _has_rigid(layout) else ""


def _contact_remedy(layout: Layout, contact: int) -> tuple[str, str]:
    """Why a contact ended the run, if no other message says so, and what may help."""
    from heavylift.solver.contact.kind import NO_END, NO_IMPULSES, PRESSED_IN, RIGID

    (contacts,) = _contacts(layout)
    why = int(contacts.control.failure)
    if why == NO_END:
        return ": it and the laws of ropes and stops do not converge together", "softer stops and ropes"
    if why == NO_IMPULSES:
        reason = ": no impulses satisfy the laws of this and all other contacts, nor in shorter steps"
        return reason, COMPLIANT_LAW if _has_rigid(layout) else "a smaller step, or less friction"
    if why == PRESSED_IN:
        stiffer = "" if contacts.table[contact].law == RIGID else " a stiffer law"
        deeper = "it is deeper inside its contour than its rounding"
        return "", f"a smaller step,{stiffer} or a larger radius: {deeper}"
    return "", "a smaller step, or a contour with more evenly spaced control points"


LARGEST_MISS = 0.01
"""Of the largest recorded force of a rope or spring: how far one may be from that of its elongation."""


def force_warning(layout: Layout) -> str:
    """Ropes and springs whose recorded forces are not those of their elongations, as a sentence; empty if none."""
    parts = []
    for kind in layout.joints:
        if "state" not in kind._fields or "agreement" not in (kind.state.dtype.names or ()):
            continue
        for entry, found in zip(kind.table, kind.state["agreement"], strict=True):
            if found["miss"] > LARGEST_MISS * found["largest"]:
                parts.append(
                    f"{layout.block_names[entry.block]!r} has a recorded force of {found['force']:.6g} at"
                    f" t = {found['time']:.6g} s where its elongation and the rates of the steps give"
                    f" {found['expected']:.6g}: take a smaller step"
                )
    return "; ".join(parts)


BEYOND = 1.0 + 1e-6
"""Utilisation of wheels, drives and brakes from which on there is a warning."""


def drive_warning(layout: Layout) -> str:
    """Transporters that are driven, or held, by more than wheels, motors and brakes can, as a sentence; empty if none.

    Parameters
    ----------
    layout
        Packed scene after a run. Paths are followed whatever it takes, so nothing else would tell.
    """
    parts = []
    for kind in layout.joints:
        if "plan_state" not in kind._fields:
            continue
        if "wheel_state" in kind._fields:
            parts += _tyres_at_their_limit(layout, kind)
            continue
        for path, state in zip(kind.table, kind.state, strict=True):
            uses = (
                (state.most_traction, "times the friction that a driven bogie has: its wheels would slip"),
                (state.most_power, "times the force of its drives at their speed"),
                (state.most_brake, "times the force of its brakes at rest"),
            )
            words = [
                f"up to {most.value:.3g} {what} (at t = {most.time:.6g} s)"
                for most, what in uses
                if most.value > BEYOND
            ]
            if words:
                name = layout.block_names[int(path.block)]
                parts.append(f"{name!r} follows its path, and needs {', '.join(words)}")
    return "; ".join(parts)


AT_LIMIT = 1.0 - 1e-9
"""Utilisation of tyres, motors and brakes from which on there is a warning."""


def _tyres_at_their_limit(layout: Layout, kind: Any) -> list[str]:
    """Vehicles on tyres that slid, or were slower than planned."""
    parts = []
    for path, state in zip(kind.paths.table, kind.state, strict=True):
        name = layout.block_names[int(path.block)]
        if state.most_traction.value > AT_LIMIT:
            parts.append(
                f"{name!r} slides: some of its wheels use all their friction (first at t = "
                f"{state.most_traction.time:.6g} s)"
            )
        if state.wait > 0.0:
            parts.append(
                f"{name!r} is slower than its plan, by {state.wait:.4g} s in all: motors or friction at their limit"
            )
    return parts


LARGEST_RINGING = 0.05
"""Energy of what rings over the largest of the motion that is worth a warning."""

SMALLEST_RINGING = 1e-6
"""The same over the elastic energy: forces change by a thousandth of those that bend the body. Less is what is left
of a search for its rest."""


TOLD_DRIFT = 0.1
"""Of the drift at which integrated strains are abandoned, from which to warn: as a rule 1e-4, 20 MPa in steel."""

TOLD_SHARE = 0.02
"""Of the largest strain, from which a drift is reported."""


def mesh_warning(layout: Layout) -> str:
    """Meshes that ring, or whose carried strains drifted too far, as a sentence; empty if none.

    Parameters
    ----------
    layout
        Packed scene after a run. Scenes without meshes import nothing for this.
    """
    parts = []
    for kind in layout.bodies:
        if not kind.NODAL:
            continue
        from heavylift.solver.bodies.ancf.kind import AUTO, CARRIED

        for line, numbers in zip(kind.table, kind.body, strict=True):
            name = layout.body_names[line.number]
            least = max(LARGEST_RINGING * numbers.largest_motion, SMALLEST_RINGING * numbers.elastic_energy)
            if numbers.largest_ringing > least:
                share = numbers.largest_ringing / numbers.largest_motion
                parts.append(
                    f"{name!r} rings: velocities at the ends of steps change their sign from step to step, with up to"
                    f" {share:.1%} of the largest energy of its motion; recorded velocities and kinetic energies have"
                    " it, reactions of its joints may have some, its path has not: take a smaller step, or more"
                    " damping"
                )
            if numbers.largest_twist > LARGEST_TWIST:
                parts.append(
                    f"an element of {name!r} twists until the sine of the angle is {numbers.largest_twist:.3g}, which"
                    f" measures its torsion well below {LARGEST_TWIST:.2g}: take more elements"
                )
            if numbers.changed_over:
                parts.append(
                    f"{name!r} changed over to the energy-momentum scheme at t = {numbers.change_time:.6g} s,"
                    f" where its integrated strains had drifted by {numbers.largest_drift:.3g}, which is"
                    f" {numbers.largest_share:.1%} of the largest strain"
                )
            elif (
                line.scheme in {AUTO, CARRIED}
                and max(
                    numbers.largest_drift / (TOLD_DRIFT * numbers.drift_tolerance),
                    numbers.largest_share / TOLD_SHARE,
                )
                > 1.0
            ):
                parts.append(
                    f"the integrated strains of {name!r} drifted by up to {numbers.largest_drift:.3g} from those of its"
                    f" shape, up to {numbers.largest_share:.1%} of the largest strain: its stresses are wrong by as"
                    " much times the modulus; take a smaller step, or elasticity 'energy-momentum'"
                )
    return "; ".join(parts)


LARGEST_TILT = math.radians(20.0)
"""Of a hull, beyond which a warning lists what its database neglects: potential theory is one of small motions."""


def hull_warning(layout: Layout) -> str:
    """Hulls with a database that tilted far, as a sentence; empty if none.

    Parameters
    ----------
    layout
        Packed scene after a run.
    """
    parts = []
    for kind in layout.bodies:
        if not kind.FLOATS:
            continue
        for entry, hull, state in zip(kind.table, kind.hulls, kind.state, strict=True):
            tilt = math.acos(max(-1.0, 1.0 - state.tipped))
            if hull.radiates and tilt > LARGEST_TILT:
                parts.append(
                    f"{layout.body_names[entry.number]!r} tilts by up to {math.degrees(tilt):.3g} deg: its added mass,"
                    " radiation and wave forces are those of the upright hull, along axes that follow its heading only"
                )
    return "; ".join(parts)


DEEPEST = 0.01
"""Of its size, by which a contact without compliance that bears may be inside what it touches."""


def contact_warning(layout: Layout) -> str:
    """Steps in which impacts had no end, impulses were found roughly, or contacts acted as none can, as a sentence.

    Empty if there were none.

    Parameters
    ----------
    layout
        Packed scene after a run.
    """
    parts = []
    for system in _contacts(layout):
        tally = system.tally[0]
        if tally.exhausted_steps:
            parts.append(
                f"in {tally.exhausted_steps} steps impacts of contacts followed each other without end: the rest of"
                " these steps was taken without restitution"
            )
        if tally.deepest > DEEPEST:
            parts.append(
                f"contacts without compliance that bear are inside each other by up to {tally.deepest:.2g} of their"
                f" size: bodies are crushed, or come too far in a step; try {COMPLIANT_LAW}, or a smaller step"
            )
        if tally.rough:
            parts.append(
                f"{tally.rough} times the impulses of contacts were found with a residual of up to"
                f" {tally.roughest:.1g} of the largest rate (at {tally.roughest_time:.6g} s) only: try"
                f" {COMPLIANT_LAW if _has_rigid(layout) else 'a smaller step, or less friction'}"
            )
        parts += _contact_faults(layout, system)
    return "; ".join(parts)


CONTACT_FAULTS = {
    "pulls": "contacts between its surfaces pull",
    "turned": "contacts push into a closed surface from its wrong side",
    "opposed": "contacts push the ends of an edge from both sides of one face, through which it has gone",
}
"""What the watch of pairs of surfaces of triangles has seen."""


def _contact_faults(layout: Layout, contacts: Any) -> list[str]:
    """Pairs of surfaces with contacts that act as none can, a sentence each."""
    if not contacts.meshes:
        return []
    from heavylift.solver.contact.triangles.kind import gone_contacts

    first, parts = int(contacts.counts.first_block + contacts.counts.of_contours), []
    for meshes in contacts.meshes:
        count = len(meshes.pairs)
        for pair, sums in enumerate(contacts.placed[-1 - count : -1]):
            gone = gone_contacts(sums, 0)
            for name, what in CONTACT_FAULTS.items():
                fault = getattr(gone, name)
                if fault.count:
                    force = f" with up to {fault.force:.4g} N" if fault.force > 0.0 else ""
                    parts.append(
                        f"collision {layout.block_names[first + pair]!r}: {what}{force}, first at {fault.first:.6g} s,"
                        f" counted {fault.count} times: its forces are wrong there; take a smaller step, a law that is"
                        " stiff enough for what hits, or give what has no thickness a 'radius'"
                    )
    return parts


def _explicit_limit(layout: Layout) -> str:
    """What would have helped the body that stopped, if its step was explicit; empty if not.

    Parameters
    ----------
    layout
        Packed scene whose status names the body.
    """
    for kind in layout.bodies:
        if not kind.NODAL:
            continue

        for line, numbers in zip(kind.table, kind.body, strict=True):
            if line.number == layout.work.status.body:
                return f"a step below {numbers.step_limit:.3g} s, the limit of explicit elastic forces"
    return ""
