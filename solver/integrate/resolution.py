"""Whether a fixed step resolves what moves: periods that a scene is known to have, and steps in a period of its motion.

Before the run the shortest periods are reported: of the waves, and of ropes, springs and stops with what hangs on them.
They do not tell what moves. A rope that only carries may have any of them: the step takes it implicitly. So a warning
waits for the run, which has measured how its bodies moved (`heavylift.solver.sensors.step_counts`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.solver.contact.layout import LINEAR
from heavylift.solver.integrate.ramps import short_ramps
from heavylift.solver.rows.structure import PRESCRIBED

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from heavylift.solver.layout import Layout

__all__ = ["ENOUGH", "period_words", "prepare_counts", "step_warning"]

ENOUGH = 20.0
"""Steps in a period from which on there is no warning: the midpoint rule is then off by pi^2/3/N^2, a hundredth of the
phase a radian."""

SMALLEST_SHARE = 1e-3
"""Of the energy of all motion, below which a body is not looked at, unless it moves fast."""

FAST_SHARE = 1e-2
"""Of the largest energy of a mass [J/kg]: a body that moves a tenth as fast as the fastest is looked at, however light
it is beside others. A load on a crane has a thousandth of the energy of the ship that carries both."""

SUDDEN_SHARE = 0.1
"""Energy that a rope, spring or stop stores, of that of the motion of the lightest body that it holds, from which on it
matters how it takes it up."""

SHORT_WAVES = 0.02
"""Part of the variance of the elevation that shorter waves may have."""

NAMED = 3
"""Bodies and periods that a sentence names."""


def _counts(layout: Layout) -> Any:
    """The kind that counts; None without fixed steps."""
    return next((kind for kind in layout.forces if "tally" in kind._fields), None)


def _owners(layout: Layout) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Body and inertia of each velocity; of frames alone, since modes and nodes have watches of their own."""
    count = len(layout.work.velocity)
    places, inertia = np.zeros((len(layout.body_names), 8)), np.zeros(count)
    for kind in layout.bodies:
        kind.survey(places, inertia, np.zeros(count))
    owner, judged = np.zeros(count, dtype=np.int64), np.zeros(count)
    for kind in layout.bodies:
        if not kind.FRAMES:
            continue
        for number in kind.table["number"]:
            of_frame = int(places[number, 0]) + np.arange(6)
            owner[of_frame], judged[of_frame] = number, inertia[of_frame]
    return owner, judged


def prepare_counts(layout: Layout) -> None:
    """Tell the kind that counts how heavy the bodies are, when they are where they start."""
    counts = _counts(layout)
    if counts is not None:
        counts.inertia[:] = _owners(layout)[1]


def _law_periods(layout: Layout) -> dict[int, float]:
    """Period [s] of each rope, spring and stop with the masses at its ends alone, by block."""
    system = next((system for system in layout.systems if "monitor" in system._fields), None)
    if system is None:
        return {}
    found = {}
    for kind in layout.joints:
        names = kind.table.dtype.names if "table" in kind._fields else ()
        if "stiffness" not in names or "block" not in names:
            continue
        for entry in kind.table:
            stiffness, block = float(entry["stiffness"]), int(entry["block"])
            if "axial_stiffness" in names and stiffness == 0.0:
                stiffness = float(entry["axial_stiffness"] / entry["start_length"])
            if stiffness == 0.0 and "count" in names and entry["count"] > 1:
                curve = kind.curves[entry["first"] : entry["first"] + entry["count"]]
                stiffness = float((np.diff(curve[:, 1]) / np.diff(curve[:, 0])).max())
            softness = float(system.rows["scale"][block, 0]) if block >= 0 else 0.0
            sides = int(entry["attachments"]) if "attachments" in names else 2
            holders = system.attachments["holder"][2 * block : 2 * block + sides]
            if stiffness * softness > 0.0 and np.any(
                holders != PRESCRIBED
            ):  # between held bodies nothing swings
                found[block] = 2.0 * math.pi / math.sqrt(stiffness * softness)
    return found


def period_words(layout: Layout, sea: Any) -> str:
    """Steps in the shortest periods that a scene is known to have, as a sentence; empty if it has none.

    Parameters
    ----------
    layout
        Packed scene.
    sea
        Its sea, or None. Of its waves those count that have all but `SHORT_WAVES` of the variance.
    """
    counts = _counts(layout)
    if counts is None:
        return ""
    known = [(period, repr(layout.block_names[block])) for block, period in _law_periods(layout).items()]
    known = sorted(known)[:NAMED]
    if sea is not None and sea.waves is not None and len(sea.waves.omega):
        order = np.argsort(sea.waves.omega)
        below = np.cumsum(sea.waves.amplitude[order] ** 2)
        place = int(np.searchsorted(below, (1.0 - SHORT_WAVES) * below[-1]))
        known.append((2.0 * math.pi / float(sea.waves.omega[order][place]), "short waves"))
    if not known:
        return ""
    words = [f"{_count(period / counts.step)} of {name} ({period:.2g} s)" for period, name in sorted(known)]
    return f"steps in a period: {', '.join(words)}"


def _count(steps: float) -> str:
    return f"{steps:.2g}" if steps < 100.0 else f"{steps:.0f}"


def _stores(layout: Layout) -> Iterator[tuple[str, Any, float, NDArray[np.int64]]]:
    """What stores energy from step to step: name, store, own period [s] and first velocities of what it holds.

    Of fenders these are all: they may hold any body.
    """
    counts, periods = _counts(layout), _law_periods(layout)
    moving = np.flatnonzero(counts.inertia > 0.0)
    for kind in layout.joints:
        if "state" not in kind._fields or "store" not in (kind.state.dtype.names or ()):
            continue
        system = next(system for system in layout.systems if "monitor" in system._fields)
        for entry, state in zip(kind.table, kind.state, strict=True):
            block = int(entry["block"])
            sides = int(entry["attachments"]) if "attachments" in kind.table.dtype.names else 2
            dofs = system.attachments["dof"][2 * block : 2 * block + sides]
            yield layout.block_names[block], state["store"], periods.get(block, math.inf), dofs
    for contacts in (system for system in layout.systems if "contours" in system._fields):
        for c in range(int(contacts.counts.of_contours)):
            store, values = contacts.state[c]["store"], contacts.values[c]
            if not store["change"] > 0.0:
                continue
            name = layout.block_names[int(contacts.counts.first_block) + c]
            # of a half sine; forces that do not grow with the depth alone have periods by how hard they are hit
            period = 2.0 * math.pi * float(store["largest"] / store["change"]) * counts.step
            dofs = contacts.attachments["dof"][2 * c : 2 * c + 2]
            masses = [counts.inertia[dof] for dof in dofs if dof >= 0 and counts.inertia[dof] > 0.0]
            if contacts.table[c]["force_law"] == LINEAR and masses:
                period = 2.0 * math.pi / math.sqrt(values["stiffness"] * sum(1.0 / mass for mass in masses))
            yield name, store, period, dofs
    owners = {channel.column: channel.name.rpartition(".")[0] for channel in layout.channels}
    for kind in layout.forces:  # fenders, which belong to no rows
        if "state" in kind._fields and "store" in (kind.state.dtype.names or ()):
            for entry, state in zip(kind.table, kind.state, strict=True):
                if (store := state["store"])["change"] > 0.0:
                    period = 2.0 * math.pi * float(store["largest"] / store["change"]) * counts.step
                    yield owners[int(entry["column"])], store, period, moving


def _sudden(
    layout: Layout, owner: NDArray[np.int64], energy: NDArray[np.float64], floor: float
) -> list[tuple[str, float]]:
    """Ropes, springs, stops, contacts that take up a motion within a few steps: name and steps in a period, by these.

    Of an oscillation with N steps in a period the stored energy changes by 2 pi/N of its largest value in a step.
    """
    counts = _counts(layout)
    found: dict[str, float] = {}
    for name, store, period, dofs in _stores(layout):
        steps = period / counts.step
        if steps >= ENOUGH or store["change"] <= 2.0 * math.pi / ENOUGH * store["largest"]:
            continue
        held = [energy[owner[dof]] for dof in dofs if dof >= 0 and counts.inertia[dof] > 0.0]
        if held and store["largest"] > max(floor, SUDDEN_SHARE * min(held)):
            found[name] = min(steps, found.get(name, math.inf))
    return sorted(found.items(), key=lambda item: item[1])


def _turning(layout: Layout, floor: float) -> list[tuple[str, float]]:
    """Ropes over sheaves with friction whose speed there turns within a few steps: name and steps in a period.

    Friction follows the sense of the speed and the ways it has gone, so what a step makes of them stays in the
    tensions. The squares of the changes of the speed are over those of the speed itself, not of its spread: what rings
    beside a speed that keeps its sense changes nothing. Looked at are ropes whose friction has taken as much
    energy as matters beside what they store.
    """
    found = []
    for kind in layout.joints:
        if "sheave_state" not in kind._fields:
            continue
        for entry, chain, rope in zip(kind.table, kind.chains, kind.state, strict=True):
            sheaves = kind.sheave_state[chain["first"] : chain["first"] + chain["count"]]
            squares, changes = float(sheaves["squares"].sum()), float(sheaves["changes"].sum())
            lost = float(np.abs(sheaves["loss"]).sum())
            if not lost > max(floor, SUDDEN_SHARE * float(rope["store"]["largest"])) or not changes > 0.0:
                continue
            steps = math.pi / math.asin(min(1.0, math.sqrt(0.25 * changes / squares)))
            if steps < ENOUGH:
                found.append((layout.block_names[int(entry["block"])], steps))
    return sorted(found, key=lambda item: item[1])


def step_warning(layout: Layout, floor: float) -> str:
    """What moved too fast for the step, and drives that changed their speed within one, as a sentence; empty if none.

    Parameters
    ----------
    layout
        Packed scene after a run.
    floor
        Energy [J] below which nothing moves.
    """
    counts = _counts(layout)
    if counts is None:
        return ""
    owner, inertia = _owners(layout)
    periods, energy = counts.of_bodies(owner, len(layout.body_names))
    parts, steps = [], []
    mass = np.zeros(len(energy))
    np.maximum.at(mass, owner, inertia)
    specific = np.divide(energy, mass, out=np.zeros_like(energy), where=mass > 0.0)
    counted = (energy > SMALLEST_SHARE * energy.sum()) | (specific > FAST_SHARE * specific.max(initial=0.0))
    counted &= (energy > floor) & (periods < ENOUGH)
    fast = [(layout.body_names[i], float(periods[i])) for i in np.argsort(periods) if counted[i]]
    if fast:
        steps.append(fast[0][1])
        parts.append(
            f"steps of {counts.step:.3g} s are long for what moves: {_listed(fast)} steps in a period of its velocities"
        )
    sudden = _sudden(layout, owner, energy, floor)
    if sudden:
        steps.append(sudden[0][1])
        parts.append(
            f"a motion is taken up within a few steps by {_listed(sudden)} steps in a period with the mass that it"
            " holds: peaks of its force, and the motion afterwards, depend on the step"
        )
    turning = _turning(layout, floor)
    if turning:
        steps.append(turning[0][1])
        parts.append(
            f"the speed over sheaves with friction turns within few steps: {_listed(turning)} steps in a period:"
            " the sliding directions, and with them the remaining tensions, depend on the step"
        )
    words = []
    if parts:
        words.append(
            f"{'; '.join(parts)}: {ENOUGH:.0f} steps in a period are needed, with a step of"
            f" {_round(counts.step * min(steps) / ENOUGH):g} s or less"
        )
    ramps = short_ramps(layout, counts.step, counts.step * float(layout.work.control.step_count))
    if ramps:
        words.append(
            f"ramps of drives are passed in a step or two of {counts.step:.3g} s, by {_listed(ramps)} steps in a ramp:"
            " the driven motion starts and stops within these steps instead"
        )
    return "; ".join(words)


def _listed(found: list[tuple[str, float]]) -> str:
    """Names with steps in a period, worst first."""
    more = f" and {len(found) - NAMED} more" if len(found) > NAMED else ""
    return ", ".join(f"{name!r} with {steps:.2g}" for name, steps in found[:NAMED]) + more


def _round(step: float) -> float:
    """Down to one digit."""
    size = 10.0 ** math.floor(math.log10(step))
    return math.floor(step / size) * size
