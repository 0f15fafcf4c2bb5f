"""``heavylift lines``: side views of the mooring lines of a case, and their dynamic tension along a finished run."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.commands.scene import load_sea_case
from heavylift.pipeline.results.storage import replacing, write_json

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.commands.scene import SeaCase
    from heavylift.pipeline.drawn.hanging import HangingLine
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.moordyn.lines import DynamicLine
    from heavylift.pipeline.results.histories import Results
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.water.lines.mooring_lines import MooringLine

__all__ = ["LineEnds", "line_ends", "line_entry", "lines_command", "section_masses"]

STEEL = 7850.0
"""Density of chain and wire [kg/m3]."""

SETTLING = 60.0
"""Time [s] that lines get to forget that they began at rest."""


@dataclass(frozen=True, eq=False)
class LineEnds:
    """Anchor and fairlead in the world over time [m], shape (nt, 3); a single row without a run."""

    times: NDArray[np.float64]
    anchor: NDArray[np.float64]
    fairlead: NDArray[np.float64]


def lines_command(
    path: Path,
    *,
    out: Path | None = None,
    overrides: Sequence[str] = (),
    lines: Sequence[str] = (),
    at: float | None = None,
    dynamic: bool = False,
    after: float | None = None,
    until: float | None = None,
    material: float = STEEL,
    log: Log,
) -> tuple[dict[str, Any], list[str]]:
    """Draw lines at the start, or at a time of a run; compute their dynamics by MoorDyn; write ``lines/``.

    Parameters
    ----------
    path, out, overrides, log
        As of other commands.
    lines
        Names; all of them by default.
    at
        Time of a finished run at which they are drawn [s]; None: the start of the case.
    dynamic
        Compute the lines once more with inertia and drag, along the motion of their ends in the run.
    after, until
        Part of the run for that [s]; by default from the end of the ramp of the sea to the end of the run. MoorDyn
        begins at rest up to `SETTLING` earlier.
    material
        Density of the material of the lines [kg/m3], from which their mass follows.

    Raises
    ------
    InputError
        If the case has no such lines, or there is no run where one is needed.
    """
    from heavylift.pipeline.drawn.hanging import hanging_line
    from heavylift.pipeline.pictures.mooring_lines import profile_picture
    from heavylift.pipeline.results.histories import load_results
    from heavylift.pipeline.stages.lock import locked

    found = load_sea_case(path, out=out, overrides=overrides, log=log, needs="lines")
    chosen = _choose(found, lines)
    results = load_results(found.case, found.folder.root) if dynamic or at is not None else None
    folder = found.folder.stage("lines")
    level = found.sea.water.level
    ends = {line.name: line_ends(found.scene, line, None) for line in chosen}
    moment = "at the start"
    if results is not None and at is not None:
        row = int(np.argmin(np.abs(results.time - at)))
        moment = f"at t = {results.time[row]:.6g} s"
        for line in chosen:
            whole = line_ends(found.scene, line, results)
            ends[line.name] = LineEnds(
                whole.times[row : row + 1], whole.anchor[row : row + 1], whole.fairlead[row : row + 1]
            )
    drawn = [hanging_line(line, ends[line.name].anchor[0], ends[line.name].fairlead[0]) for line in chosen]
    document: dict[str, Any] = {
        "case": found.case.name,
        "moment": moment,
        "lines": [line_entry(one) for one in drawn],
    }
    words = _lines(document)
    dynamics: dict[str, DynamicLine] = {}
    if dynamic:
        assert results is not None
        begin = found.sea.ramp if after is None else after
        if begin - float(results.time[0]) < 0.5 * SETTLING:
            log.say(
                f"lines: MoorDyn begins at rest at t = {results.time[0]:g} s, which its first tensions show"
            )
        for line in chosen:
            log.say(f"lines: {line.name}: MoorDyn along the run")
            dynamics[line.name] = _dynamics(found, line, results, begin, until, material, folder)
        document["dynamic"] = [_dynamic_entry(name, one) for name, one in dynamics.items()]
        words += ["", *_dynamic_lines(document["dynamic"])]
    with locked(found.folder.root):
        files = [folder / "lines.json", folder / "lines.png"]
        with replacing(files[1]) as temporary:
            temporary.write_bytes(
                profile_picture(drawn, level=level, title=f"{found.case.name}: mooring lines {moment}")
            )
        for name, one in dynamics.items():
            files += _write_dynamics(folder, name, one)
        write_json(files[0], document)
    document["files"] = [str(file) for file in files]
    return document, [*words, "", *(f"  written: {file}" for file in files)]


def line_ends(scene: Scene, line: MooringLine, results: Results | None) -> LineEnds:
    """Where a line ends: at the start of a scene, or in a run."""
    bodies = {body.name: body for body in scene.bodies}
    times = np.zeros(1) if results is None else results.time

    def place(name: str, point: NDArray[np.float64]) -> NDArray[np.float64]:
        point = np.asarray(point, dtype=np.float64)
        body = bodies.get(name)
        if body is None:
            return np.tile(point, (len(times), 1))
        if results is None:
            return np.asarray(body.position + rotation_matrix(body.orientation) @ point)[None]
        from scipy.spatial.transform import Rotation

        q = results[f"{name}.orientation"]
        return np.asarray(results[f"{name}.position"] + Rotation.from_quat(q[:, [1, 2, 3, 0]]).apply(point))

    return LineEnds(times, place(line.body_a, line.point_a), place(line.body_b, line.point_b))


def section_masses(line: MooringLine, density: float, material: float, gravity: float) -> tuple[float, ...]:
    """Mass in air of each section [kg/m], from its weight in water and the density of its material.

    Raises
    ------
    InputError
        If a section floats, so that it is of another material.
    """
    if not material > density:
        raise InputError(f"{material:g} kg/m3", source="--material", expected=f"more than {density:g} kg/m3")
    for section in line.sections:
        if section.weight <= 0.0:
            raise InputError(
                f"a section of {section.weight:g} N/m floats",
                source=line.name,
                key="sections",
                expected="sections that sink, of one material, for --moordyn",
            )
    return tuple(section.weight / gravity / (1.0 - density / material) for section in line.sections)


def line_entry(drawn: HangingLine) -> dict[str, Any]:
    """Numbers of a line, SI units."""
    found = drawn.catenary
    return {
        "name": drawn.line.name,
        "length": float(drawn.profile.s[-1]),
        "fairlead_tension": found.tension,
        "horizontal_tension": found.horizontal,
        "anchor_tension": found.anchor_tension,
        "seabed_length": found.on_seabed,
        "anchor": drawn.points[0].tolist(),
        "fairlead": drawn.points[-1].tolist(),
    }


def _choose(found: SeaCase, names: Sequence[str]) -> list[MooringLine]:
    known = {line.name: line for line in found.sea.lines}
    for name in names:
        if name not in known:
            raise InputError(f"no line {name!r}", source="--line", expected=f"one of {', '.join(known)}")
    return [known[name] for name in names or known]


def _dynamics(
    found: SeaCase,
    line: MooringLine,
    results: Results,
    after: float,
    until: float | None,
    material: float,
    folder: Path,
) -> DynamicLine:
    """One line along a part of the run."""
    from heavylift.pipeline.moordyn.input_file import LineDynamics
    from heavylift.pipeline.moordyn.lines import run_moordyn

    water = found.sea.water
    ends = line_ends(found.scene, line, results)
    last = float(results.time[-1]) if until is None else until
    own = (ends.times >= after - SETTLING - 1e-9) & (ends.times <= last + 1e-9)
    masses = section_masses(line, water.density, material, water.gravity)
    fixed = line.body_a not in {body.name for body in found.scene.bodies}
    whole = run_moordyn(
        line,
        LineDynamics(masses=masses),
        ends.times[own],
        ends.fairlead[own],
        anchors=None if fixed else ends.anchor[own],
        level=water.level,
        density=water.density,
        gravity=water.gravity,
        folder=folder / "moordyn",
    )
    window = whole.times >= after - 1e-9
    if np.count_nonzero(window) < 2:
        raise InputError(
            f"no records between {after:g} and {last:g} s",
            source=results.source,
            key="--after",
            expected=f"a part of {results.time[0]:g} to {results.time[-1]:g} s",
        )
    return replace(
        whole,
        times=whole.times[window],
        tension=whole.tension[window],
        anchor_tension=whole.anchor_tension[window],
        force=whole.force[window],
        quasi_static=whole.quasi_static[window],
    )


def _dynamic_entry(name: str, one: DynamicLine) -> dict[str, Any]:
    return {
        "name": name,
        "from": float(one.times[0]),
        "to": float(one.times[-1]),
        "largest_catenary": float(one.quasi_static.max()),
        "largest_dynamic": float(one.tension.max()),
        "smallest_dynamic": float(one.tension.min()),
        "largest_at_anchor": float(one.anchor_tension.max()),
        "amplification": one.amplification,
    }


def _write_dynamics(folder: Path, name: str, one: DynamicLine) -> list[Path]:
    files = [folder / f"{name}_dynamic.csv", folder / f"{name}_dynamic.png"]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time_s", "tension_N", "anchor_tension_N", "catenary_tension_N"])
    table = np.column_stack([one.times, one.tension, one.anchor_tension, one.quasi_static])
    writer.writerows([f"{value:.9g}" for value in row] for row in table)
    with replacing(files[0]) as temporary:
        temporary.write_text(text.getvalue(), encoding="utf-8")
    with replacing(files[1]) as temporary:
        temporary.write_bytes(_plot(name, one))
    return files


def _plot(name: str, one: DynamicLine) -> bytes:
    """Tension by MoorDyn and that of the catenary over time."""
    from matplotlib.figure import Figure

    from heavylift.pipeline.pictures.plots import few_colours, figure_png
    from heavylift.pipeline.results.signals import envelope, scaled_unit

    unit = scaled_unit("N", [one.tension])
    figure = Figure(figsize=(10.0, 4.2), dpi=110, facecolor="white", layout="constrained")
    axes = figure.subplots()
    for values, colour, label in (
        (one.tension, "#b8322a", "fairlead, MoorDyn"),
        (one.quasi_static, "#1f5fa8", "fairlead, catenary"),
    ):
        times, shown = envelope(one.times, values / unit.divisor)
        axes.plot(times, shown, color=colour, lw=1.2, label=label)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"tension [{unit.text}]")
    axes.grid(visible=True, color="#e3e7eb", lw=0.8)
    axes.legend(frameon=False)
    words = name.replace("$", r"\$")
    axes.set_title(
        f"{words}: largest dynamic / quasi-static = {one.amplification:.3f}", loc="left", fontsize=11
    )
    return few_colours(figure_png(figure))


def _lines(document: dict[str, Any]) -> list[str]:
    """Table of the lines."""
    lines = [f"{document['case']}: mooring lines {document['moment']}", ""]
    head = ("fairlead kN", "horizontal kN", "anchor kN", "length m", "on seabed m")
    lines.append(f"  {'line':<24s}" + "".join(f"{word:>15s}" for word in head))
    for one in document["lines"]:
        forces = [1e-3 * one[key] for key in ("fairlead_tension", "horizontal_tension", "anchor_tension")]
        numbers = [*forces, one["length"], one["seabed_length"]]
        lines.append(f"  {one['name']:<24s}" + "".join(f"{value:>15.5g}" for value in numbers))
    return lines


def _dynamic_lines(entries: Sequence[dict[str, Any]]) -> list[str]:
    lines = [
        "  along the run, largest tension at the fairlead:",
        f"  {'line':<24s}{'catenary kN':>15s}{'MoorDyn kN':>15s}{'ratio':>10s}{'at anchor kN':>15s}",
    ]
    lines += [
        f"  {one['name']:<24s}{1e-3 * one['largest_catenary']:>15.5g}{1e-3 * one['largest_dynamic']:>15.5g}"
        f"{one['amplification']:>10.3f}{1e-3 * one['largest_at_anchor']:>15.5g}"
        for one in entries
    ]
    return lines
