"""``heavylift rao``: response operators of the moored hulls of a case, in the frequency domain."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.commands.scene import check_databases, load_sea_case
from heavylift.pipeline.report.response_operators import rao_document, write_rao_report
from heavylift.pipeline.results.storage import replacing, write_json
from heavylift.preprocess.hydrodynamics.database import COORDINATES
from heavylift.solver.water.hulls.frequency_domain import (
    NaturalMode,
    ResponseStatistics,
    motion_operators,
    natural_modes,
    resonant_frequencies,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from heavylift.pipeline.log import Log
    from heavylift.solver.water.hulls.frequency_domain import LinearHulls, MotionOperators
    from heavylift.solver.water.hulls.linearise import LinearScene
    from heavylift.solver.water.waves.wave_trains import WaveTrains

__all__ = ["joint_force_rows", "rao_command", "response_in_trains", "separate_modes"]

HEADINGS = tuple(math.radians(angle) for angle in (0.0, 45.0, 90.0, 135.0, 180.0))
"""Directions of travel relative to the first hull [rad], if none are given."""

LONGEST_PERIOD = 40.0
"""Of waves [s]; natural periods of moorings are longer, and their operators mean nothing."""

FREQUENCIES = 300

TIED = 1e-9
"""Coupling of two bodies that ties their motions, relative to the largest of all."""

THIS_SEA = "waves of the case"


def rao_command(
    path: Path,
    *,
    out: Path | None = None,
    overrides: Sequence[str] = (),
    headings: Sequence[float] = (),
    log: Log,
) -> tuple[dict[str, Any], list[str]]:
    """Linearise a case about its equilibrium and write ``rao/``.

    Parameters
    ----------
    path, out, overrides, log
        As of other commands.
    headings
        Directions in which the waves travel, relative to the first hull [rad].

    Returns
    -------
    tuple
        Document, and tables for a person.

    Raises
    ------
    InputError
        If there are no hulls with databases, no equilibrium, headings that the databases do not have, or a database
        that does not fit.
    """
    from heavylift.pipeline.case.places import in_case
    from heavylift.pipeline.stages.lock import locked
    from heavylift.solver.water.hulls.linearise import linear_group, linearise

    found = load_sea_case(path, out=out, overrides=overrides, log=log)
    check_databases(found)
    with in_case(found.case):
        linear = linearise(found.scene)
        hulls = linear_group(found.scene, linear)
    log.say(f"rao: {linear.text}")
    for note in linear.notes:
        log.say(f"rao: NOTE: {note}")
    in_waves = hulls.database.has_excitation
    if not in_waves:
        if headings:
            raise InputError(
                "no exciting forces, radiation alone",
                source=hulls.database.source,
                key="excitation",
                expected="a database with exciting forces; without --heading natural periods are given",
            )
        log.say(
            f"rao: {hulls.database.source}: no exciting forces, radiation alone: natural periods, no operators"
        )
    resonant = resonant_frequencies(hulls)
    if len(resonant):
        log.say(
            f"rao: NOTE: mass and added mass together are negative between {resonant[0]:.4g} and {resonant[-1]:.4g} "
            "rad/s, where water between the hulls resonates: natural periods there are those of hulls and water, and "
            "operators are as large as panels without friction make them"
        )
    if found.scene.touches:
        log.say("rao: contacts and collisions are left out")
    low, high = float(hulls.database.omega[0]), float(hulls.database.omega[-1])
    # finer than databases are, as resonances are narrow; no wind wave is longer
    omega = np.linspace(min(max(low, 2.0 * math.pi / LONGEST_PERIOD), high), high, FREQUENCIES)
    chosen = (headings or _available(hulls)) if in_waves else ()
    operators = motion_operators(hulls, headings=chosen, omega=omega)
    modes = separate_modes(hulls)
    responses = {}
    if in_waves and found.sea.waves is not None:
        try:
            responses[THIS_SEA] = response_in_trains(hulls, found.sea.waves, float(linear.headings[0]))
        except InputError as error:  # the operators are right without
            log.say(f"rao: no response in the waves of the case: {error}")
    folder = found.folder.stage("rao")
    with locked(found.folder.root):
        files = write_rao_report(folder, operators, modes=modes, responses=responses)
        files.append(folder / "matrices.json")
        write_json(files[-1], _matrices(linear))
        if linear.row_names and in_waves:
            files.append(folder / "joint_forces.csv")
            text = io.StringIO()
            csv.writer(text, lineterminator="\n").writerows(joint_force_rows(linear, operators))
            with replacing(files[-1]) as temporary:
                temporary.write_text(text.getvalue(), encoding="utf-8")
    document = rao_document(operators, modes, responses)
    document = {
        "case": found.case.name,
        "equilibrium": linear.text,
        **document,
        "files": [str(file) for file in files],
    }
    return document, [*_lines(document), "", *(f"  written: {file}" for file in files)]


def response_in_trains(hulls: LinearHulls, waves: WaveTrains, heading: float) -> ResponseStatistics:
    """Response to a sum of wave trains, short-crested ones too: each component has half its square as variance.

    Parameters
    ----------
    hulls
        Linearised.
    waves
        With directions in the world.
    heading
        Of the first hull [rad].

    Raises
    ------
    InputError
        If more than 1 % of the energy lies outside of the frequencies of the database, or a heading is missing.
    """
    low, high = hulls.database.omega[0], hulls.database.omega[-1]
    energy = 0.5 * waves.amplitude**2
    inside = (waves.omega >= low) & (waves.omega <= high)
    lost = 1.0 - float(energy[inside].sum()) / max(float(energy.sum()), 1e-300)
    if lost > 0.01:
        raise InputError(
            f"{lost:.1%} of the energy of the waves lies outside of {low:.3g} to {high:.3g} rad/s",
            source=hulls.database.source,
            key="omega",
            expected="a database over all of the sea, at most 1 % outside",
        )
    omega, energy = waves.omega[inside], energy[inside]
    direction = np.round(np.angle(np.exp(1j * (waves.direction[inside] - heading))), 12)
    power = np.zeros((len(omega), len(hulls.mass)))
    for beta in np.unique(direction):
        own = np.flatnonzero(direction == beta)
        grid, place = np.unique(omega[own], return_inverse=True)
        motion = motion_operators(hulls, headings=[float(beta)], omega=grid).amplitude[place, 0]
        power[own] = energy[own, None] * motion**2
    deviation = np.sqrt(power.sum(axis=0))
    rate = np.sqrt((omega[:, None] ** 2 * power).sum(axis=0))
    period = 2.0 * math.pi * deviation / np.where(rate > 0.0, rate, math.inf)
    edges = np.linspace(
        float(omega.min()) - 1e-9, float(omega.max()) + 1e-9, max(2, min(60, len(omega) // 3))
    )
    width = edges[1] - edges[0]
    density = np.stack([np.histogram(omega, edges, weights=column)[0] / width for column in power.T], axis=1)
    return ResponseStatistics(0.5 * (edges[1:] + edges[:-1]), density, deviation, 2.0 * deviation, period)


def joint_force_rows(linear: LinearScene, operators: MotionOperators) -> list[list[object]]:
    """Table of the forces of joints on the later one of the bodies they join, with a header row.

    Returns
    -------
    list
        Rows: joint, body, heading [deg], omega [rad/s], period [s], then amplitude [N/m] and phase [deg] of the force
        along the coordinates surge, sway and heave of that body.
    """
    header: list[object] = ["joint", "body", "heading_deg", "omega_rad_s", "period_s"]
    for name in COORDINATES[:3]:
        header += [f"{name}_force_N_per_m", f"{name}_phase_deg"]
    table = [header]
    names = np.array(linear.row_names)
    for joint in dict.fromkeys(linear.row_names):
        rows = np.flatnonzero(names == joint)
        G = linear.jacobian[rows]
        moved = np.abs(G).reshape(len(rows), -1, 6).max(axis=(0, 2)) > 0.0
        body = int(np.flatnonzero(moved)[-1])
        force = operators.constraint_force[:, :, rows] @ G[:, 6 * body : 6 * body + 3]
        for h, heading in enumerate(operators.headings):
            for k, w in enumerate(operators.omega):
                row: list[object] = [joint, linear.bodies[body], f"{math.degrees(heading):.6g}", f"{w:.9g}"]
                row.append(f"{2.0 * math.pi / w:.9g}")
                for value in force[k, h]:
                    row += [f"{abs(value):.9g}", f"{math.degrees(np.angle(value)):.6g}"]
                table.append(row)
    return table


def separate_modes(hulls: LinearHulls) -> list[NaturalMode]:
    """Natural modes of bodies that move independently of each other, one group after another, then by period.

    Equal periods of equal hulls would otherwise be those of mixtures of their motions.
    """
    from scipy.sparse.csgraph import connected_components

    database, count = hulls.database, hulls.database.body_count
    G = hulls.constraint_jacobian
    joined = np.abs(G).T @ np.abs(G) if len(G) else np.zeros(hulls.mass.shape)
    tied = np.zeros((count, count), dtype=bool)
    scale = 1.0 / np.sqrt(np.diag(hulls.mass))
    for matrix in (hulls.mass, hulls.stiffness, np.abs(database.added_mass).max(axis=0), joined):
        size = np.abs(scale[:, None] * matrix * scale).reshape(count, 6, count, 6).max(axis=(1, 3))
        tied |= size > TIED * size.max()
    found = []
    for group in range(connected_components(tied)[0]):
        bodies = np.flatnonzero(connected_components(tied)[1] == group)
        own = (6 * bodies[:, None] + np.arange(6)).ravel()
        block = np.ix_(own, own)
        part = replace(
            hulls,
            database=replace(
                database,
                bodies=tuple(database.bodies[body] for body in bodies),
                added_mass=database.added_mass[:, own][:, :, own],
                damping=database.damping[:, own][:, :, own],
                added_mass_infinite=database.added_mass_infinite[block],
                excitation=database.excitation[:, :, own],
                reference_points=database.reference_points[bodies],
            ),
            mass=hulls.mass[block],
            stiffness=hulls.stiffness[block],
            damping=hulls.damping[block],
            constraint_jacobian=G[np.abs(G[:, own]).max(axis=1, initial=0.0) > 0.0][:, own],
        )
        for mode in natural_modes(part):
            shape = np.zeros(6 * count)
            shape[own] = mode.shape
            found.append(NaturalMode(mode.period, shape, int(own[mode.coordinate])))
    return found


def _available(hulls: LinearHulls) -> list[float]:
    """Those of `HEADINGS` that the databases have; if they have none of them, their own."""
    from heavylift.solver.water.waves.wave_transfer import excitation_at

    found = []
    for heading in HEADINGS:
        try:
            excitation_at(hulls.database, hulls.database.omega[:1], heading)
        except InputError:
            continue
        found.append(heading)
    return found or [float(heading) for heading in hulls.database.headings]


def _matrices(linear: LinearScene) -> dict[str, Any]:
    """What the operators were made of, SI units."""
    return {
        "bodies": list(linear.bodies),
        "coordinates": list(COORDINATES),
        "headings": linear.headings.tolist(),
        "reference_points": linear.points.tolist(),
        "mass": linear.mass.tolist(),
        "stiffness": linear.stiffness.tolist(),
        "damping": linear.damping.tolist(),
        "joints": list(linear.row_names),
        "constraint_jacobian": linear.jacobian.tolist(),
        "asymmetry_of_stiffness": linear.asymmetry,
    }


def _lines(document: Mapping[str, Any]) -> list[str]:
    """Natural periods, largest amplitudes, response in the waves of the case."""
    lines = [f"{document['case']}: response operators", f"  {document['equilibrium']}", ""]
    lines.append("  natural periods (undamped):")
    lines += [f"    {mode['period']:>10.4g} s   {mode['coordinate']}" for mode in document["natural_modes"]]
    if not document["natural_modes"]:
        lines.append("    none: no restoring force")
    if not document["headings"]:
        return [*lines, "", "  no response operators: the databases have no exciting forces"]
    lines += [
        "",
        f"  {'largest amplitude':<28s}{'':>12s}  {'unit':<7s}{'period [s]':>11s}{'heading [deg]':>15s}",
    ]
    for one in document["largest"]:
        factor, unit = _unit(one["coordinate"])
        lines.append(
            f"    {one['coordinate']:<26s}{factor * one['amplitude']:>12.5g}  {unit + '/m':<7s}{one['period']:>11.4g}"
            f"{math.degrees(one['heading']):>15.4g}"
        )
    for sea, response in document["responses"].items():
        lines += ["", f"  response in the {sea}: standard deviation, significant amplitude, mean period"]
        for name, one in response.items():
            factor, unit = _unit(name)
            period = f"{one['mean_period']:.4g} s" if one["mean_period"] else "-"
            lines.append(
                f"    {name:<26s}{factor * one['standard_deviation']:>12.5g}"
                f"{factor * one['significant_amplitude']:>12.5g}  {unit:<5s}{period:>10s}"
            )
    return lines


def _unit(coordinate: str) -> tuple[float, str]:
    """Factor and unit in which a person reads a coordinate."""
    turns = coordinate.rpartition(".")[2] in COORDINATES[3:]
    return (180.0 / math.pi, "deg") if turns else (1.0, "m")
