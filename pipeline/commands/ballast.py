"""``heavylift ballast``: fillings of tanks for the stages of an operation, and the hull girder at each."""

from __future__ import annotations

import csv
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.case.places import located
from heavylift.pipeline.commands.hydrostatics import hull_loading
from heavylift.pipeline.commands.scene import load_sea_case
from heavylift.pipeline.results.storage import replacing, write_json
from heavylift.solver.water.hulls.ballast_plan import (
    Girder,
    Load,
    Stage,
    StagePlan,
    Weight,
    girder,
    plan_stages,
)

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.pipeline.assemble.loading import Loading
    from heavylift.pipeline.commands.scene import SeaCase
    from heavylift.pipeline.log import Log
    from heavylift.preprocess.hydrodynamics.hull_surface import HullSurface
    from heavylift.solver.scene.sea import Tank

__all__ = ["ballast_command"]

LEVER = 0.01
"""Of the length of a hull, by which the centre of a table of its weights may be off its centre of mass."""

TON_PER_HOUR = 1000.0 / 3600.0


def ballast_command(
    path: Path, *, out: Path | None = None, overrides: Sequence[str] = (), log: Log
) -> tuple[dict[str, Any], list[str]]:
    """Plan the ballast of a case and write ``ballast/``.

    Returns
    -------
    tuple
        Document of all stages, and the tables for a person.

    Raises
    ------
    InputError
        If the case has no [ballast], the hull no surface, or a stage no filling.
    """
    from heavylift.pipeline.assemble.hulls import frame_origin, hull_surface
    from heavylift.pipeline.pictures.ballast_plots import ballast_plot
    from heavylift.pipeline.stages.lock import locked
    from heavylift.preprocess.hydrodynamics.hull_surface import check_hull
    from heavylift.preprocess.surfaces.triangle_surface import placed

    found = load_sea_case(path, out=out, overrides=overrides, log=log)
    section = found.case.ballast
    if section is None:
        raise InputError(
            "no [ballast]", source=found.case.file, key="ballast", expected="a table [ballast] with 'stages'"
        )
    name, water = section.hull, found.sea.water
    if found.case.hulls[name].surface is None:
        raise InputError(
            f"{name!r} has no surface",
            source=found.case.file,
            key=f"hulls.{name}.surface",
            expected="a hull with a surface, whose sections the girder needs",
        )
    origin = frame_origin(found.case, name)
    surface = placed(hull_surface(found.case, name, found.folder), position=origin)
    deck = found.case.hulls[name].open_deck
    hull = check_hull(surface, open_deck=deck, key=f"surface of hull {name}")
    loading = _without(found, hull_loading(found.scene, found.sea, name))
    own = [tank for tank in found.sea.tanks if tank.hull == name]
    moved = [tank for tank in own if not section.tanks or tank.name in section.tanks]
    still = [tank for tank in own if tank not in moved]
    kept = [
        Load(tank.start_mass, tuple((tank.contents(tank.start_mass, water)[0] + origin).tolist()))
        for tank in still
        if tank.start_mass > 0.0
    ]
    stages = [
        Stage(
            stage.name,
            (*(Load(load.mass, load.point, load.length) for load in stage.loads), *kept),
            section.heel if stage.heel is None else stage.heel,
            section.trim if stage.trim is None else stage.trim,
            section.draft if stage.draft is None else stage.draft,
            stage.time,
        )
        for stage in section.stages
    ]
    centre = loading.centre + origin
    with located(found.case, "ballast"):
        plans = plan_stages(hull, loading.mass, centre, moved, stages, water, origin)
        lightship = _lightship(found, hull, loading.mass, float(centre[0]), float(centre[2]))
    girders = [
        girder(
            hull,
            plan.position.pose,
            [*lightship, *_weights(plan, moved)],
            water.density,
            water.gravity,
        )
        for plan in plans
    ]
    folder = found.folder.stage("ballast")
    document = _document(found, plans, girders, moved, loading.left_out)
    with locked(found.folder.root):
        write_json(folder / f"{name}_ballast.json", document)
        _write_plan(folder / f"{name}_ballast.csv", document)
        _write_girders(folder / f"{name}_girder.csv", plans, girders)
        with replacing(folder / f"{name}_ballast.png") as temporary:
            temporary.write_bytes(ballast_plot(f"{name}: ballast", document, girders))
    return document, _lines(document)


def _without(found: SeaCase, loading: Loading) -> Loading:
    """What a hull carries, less the bodies that are not to be counted."""
    section = found.case.ballast
    assert section is not None
    bodies: dict[str, Any] = {body.name: body for body in found.scene.bodies}
    hull = bodies[section.hull]
    mass, moment = loading.mass, loading.mass * loading.centre
    for index, name in enumerate(section.apart):
        body = bodies.get(name)
        if name not in loading.bodies or body is None or body.DEFORMS:
            raise InputError(
                f"{name!r} is no rigid body that joints hold on {section.hull!r}",
                source=found.case.file,
                key=f"ballast.apart.{index}",
                expected=f"one of {', '.join(loading.bodies) or 'none'}",
            )
        place = body.position + rotation_matrix(body.orientation) @ body.centre_of_mass - hull.position
        whole = body.mass, rotation_matrix(hull.orientation).T @ place
        counted, centre = loading.parts.get(name, whole)
        mass -= counted
        moment = moment - counted * centre
    left = tuple(one for one in loading.bodies if one not in section.apart)
    return replace(loading, mass=mass, centre=moment / mass, bodies=left)


def _lightship(found: SeaCase, hull: HullSurface, mass: float, x: float, z: float) -> list[Weight]:
    """Weight of the hull with all that joints hold on it, along it."""
    section = found.case.ballast
    assert section is not None
    if section.lightship is None:
        low, high = hull.surface.bounds[:, 0].tolist()
        slope = 12.0 * (x - 0.5 * (low + high)) / (high - low)
        if abs(slope) > 2.0:
            raise InputError(
                f"the centre of mass at x = {x:g} m is beyond the middle third of the hull, from {low:g} to {high:g} m",
                key="lightship",
                expected="a table of its weights along it",
            )
        return [Weight(mass, low, high, z, slope)]
    stations, shares = np.array(section.lightship.stations), np.array(section.lightship.weights)
    means, lengths = 0.5 * (shares[1:] + shares[:-1]), np.diff(stations)
    whole = float(means @ lengths)
    pieces = [
        Weight(mass * mean * length / whole, a, a + length, z, (right - left) / mean)
        for a, length, mean, left, right in zip(
            stations[:-1], lengths, means, shares[:-1], shares[1:], strict=True
        )
        if mean > 0.0
    ]
    at = sum(one.mass * (0.5 + one.slope / 12.0) * (one.end - one.start) for one in pieces)
    at = (at + sum(one.mass * one.start for one in pieces)) / mass
    if abs(at - x) > LEVER * float(np.ptp(hull.surface.bounds[:, 0])):
        raise InputError(
            f"its centre is at x = {at:.6g} m, that of the hull with what joints hold on it at {x:.6g} m",
            key="lightship.weights",
            expected="the same, within 1 % of the length of the hull",
        )
    return pieces


def _weights(plan: StagePlan, tanks: Sequence[Tank]) -> list[Weight]:
    """Loads and water along the hull; water in a tank by a table acts at its centre."""
    found = []
    for load in plan.stage.loads:
        x, _, z = load.point
        found.append(Weight(load.mass, x - 0.5 * load.length, x + 0.5 * load.length, z))
    for tank, liquid in zip(tanks, plan.liquids, strict=True):
        x, _, z = liquid.point
        half = 0.0 if tank.size is None else 0.5 * float(tank.size[0])
        if liquid.mass > 0.0:
            found.append(Weight(liquid.mass, x - half, x + half, z))
    return found


def _document(
    found: SeaCase,
    plans: Sequence[StagePlan],
    girders: Sequence[Girder],
    tanks: Sequence[Tank],
    left_out: Sequence[str],
) -> dict[str, Any]:
    """All that is found, in SI."""
    before = {tank.name: tank.start_mass for tank in tanks}
    capacity = {tank.name: tank.capacity(found.sea.water) for tank in tanks}
    time: float | None = None
    stages = []
    for plan, beam in zip(plans, girders, strict=True):
        masses = dict(zip(before, plan.masses.tolist(), strict=True))
        changes = {name: masses[name] - before[name] for name in masses}
        now, span = plan.stage.time, None
        if now is not None and time is not None:
            span = now - time
        rates = {} if span is None else {name: change / span for name, change in changes.items()}
        top, low = int(beam.bending.argmax()), int(beam.bending.argmin())
        sheared = int(np.abs(beam.shear).argmax())
        position = plan.position
        stages.append(
            {
                "stage": plan.stage.name,
                "time": now,
                "tanks": masses,
                "changes": changes,
                "rates": rates,
                "short": _short(found, rates),
                "pumped": float(sum(map(abs, changes.values()))),
                "displacement": position.mass,
                "draft_aft": position.draft_aft,
                "draft": position.draft,
                "draft_forward": position.draft_forward,
                "trim": position.pose.trim,
                "list": position.pose.list,
                "GM_T": position.GM_T,
                "GM_L": position.GM_L,
                "shear": {"value": float(beam.shear[sheared]), "x": float(beam.stations[sheared])},
                "sagging": {"value": float(beam.bending[top]), "x": float(beam.stations[top])},
                "hogging": {"value": float(beam.bending[low]), "x": float(beam.stations[low])},
                "closure": list(map(float, beam.closure)),
            }
        )
        before = masses
        time = time if now is None else now
    return {
        "case": found.case.name,
        "hull": found.case.ballast.hull if found.case.ballast else "",
        "capacity": {name: one if math.isfinite(one) else None for name, one in capacity.items()},
        "left_out": list(left_out),
        "stages": stages,
    }


def _short(found: SeaCase, rates: dict[str, float]) -> dict[str, float]:
    """Flow that the pumps of a tank can give [kg/s], where that is less than its rate; of tanks that have pumps."""
    given = {}
    for name, rate in rates.items():
        serving = [
            (1.0 if pump.target == name else -1.0, pump)
            for pump in found.sea.pumps
            if name in (pump.source, pump.target)
        ]
        flow = sum(pump.rate for way, pump in serving if way * rate > 0.0 or pump.reversible)
        if serving and flow < abs(rate) * (1.0 - 1e-9):
            given[name] = flow
    return given


def _write_plan(path: Path, document: dict[str, Any]) -> None:
    """A row a stage."""
    names = list(document["capacity"])
    plain = ("pumped", "displacement", "draft_aft", "draft", "draft_forward", "trim", "list", "GM_T", "GM_L")
    units = ("kg", "kg", "m", "m", "m", "rad", "rad", "m", "m")
    beams = ("shear", "sagging", "hogging")
    header = [
        "stage", "time_s", *(f"{name}_kg" for name in names), *(f"{name}_rate_kg_s" for name in names),
        *(f"{key}_{unit}" for key, unit in zip(plain, units, strict=True)),
        *(f"{key}_{'N' if key == 'shear' else 'Nm'}" for key in beams), *(f"{key}_x_m" for key in beams),
    ]  # fmt: skip
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        for row in document["stages"]:
            rates = [repr(row["rates"][name]) if row["rates"] else "" for name in names]
            writer.writerow(
                [
                    row["stage"],
                    "" if row["time"] is None else repr(row["time"]),
                    *(repr(row["tanks"][name]) for name in names),
                    *rates,
                    *(repr(row[key]) for key in plain),
                    *(repr(row[key]["value"]) for key in beams),
                    *(repr(row[key]["x"]) for key in beams),
                ]
            )


def _write_girders(path: Path, plans: Sequence[StagePlan], girders: Sequence[Girder]) -> None:
    """Shear force and bending moment over x at each stage."""
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["stage", "x_m", "shear_N", "bending_Nm"])
        for plan, beam in zip(plans, girders, strict=True):
            for row in zip(beam.stations.tolist(), beam.shear.tolist(), beam.bending.tolist(), strict=True):
                writer.writerow([plan.stage.name, *map(repr, row)])


def _lines(document: dict[str, Any]) -> list[str]:
    """Tables for a person."""
    names = list(document["capacity"])
    wide = max(5, *(len(row["stage"]) for row in document["stages"]))
    cells = [max(10, len(name)) for name in names]
    lines = [f"{document['hull']}: water in the tanks [t], and pumped water", ""]
    lines.append(
        f"  {'stage':<{wide}s}"
        + "".join(f"  {n:>{w}s}" for n, w in zip(names, cells, strict=True))
        + "      pumped"
    )
    for row in document["stages"]:
        water = "".join(f"  {row['tanks'][n] * 1e-3:>{w}.2f}" for n, w in zip(names, cells, strict=True))
        lines.append(f"  {row['stage']:<{wide}s}{water}  {row['pumped'] * 1e-3:>10.2f}")
    lines += ["", f"{document['hull']}: floating position, and hull girder in still water", ""]
    lines.append(
        f"  {'stage':<{wide}s}  {'aft':>7s}  {'draft':>7s}  {'forward':>7s}  {'trim':>7s}  {'list':>7s}  {'GM_T':>7s}"
        f"  {'GM_L':>8s}  {'shear':>9s}  {'sagging':>9s}  {'hogging':>9s}"
    )
    lines.append(
        f"  {'':<{wide}s}  {'m':>7s}  {'m':>7s}  {'m':>7s}  {'deg':>7s}  {'deg':>7s}  {'m':>7s}  {'m':>8s}  {'MN':>9s}"
        f"  {'MN m':>9s}  {'MN m':>9s}"
    )
    for row in document["stages"]:
        deg = [0.0 if abs(row[key]) < 1e-9 else math.degrees(row[key]) for key in ("trim", "list")]
        lines.append(
            f"  {row['stage']:<{wide}s}  {row['draft_aft']:7.3f}  {row['draft']:7.3f}  {row['draft_forward']:7.3f}"
            f"  {deg[0]:7.3f}  {deg[1]:7.3f}  {row['GM_T']:7.2f}  {row['GM_L']:8.2f}"
            f"  {row['shear']['value'] * 1e-6:9.3f}  {row['sagging']['value'] * 1e-6:9.2f}"
            f"  {row['hogging']['value'] * 1e-6:9.2f}"
        )
    too_small = [
        f"  {row['stage']}: {name} needs {abs(row['rates'][name]) / TON_PER_HOUR:.0f} t/h, its pumps give"
        f" {flow / TON_PER_HOUR:.0f} t/h"
        for row in document["stages"]
        for name, flow in row["short"].items()
    ]
    lines += ["", *too_small] if too_small else []
    if document["left_out"]:
        lines += ["", f"  not counted: {', '.join(document['left_out'])}"]
    return lines
