"""Dynamic tension of mooring lines by MoorDyn: input, lines along the motion of a simulation, and coupled with it.

Catenaries follow their ends without inertia and drag. Where the ends move with the waves that is not enough, and a
line can be computed with lumped masses by MoorDyn-C (Hall and Goupee, *Ocean Engineering* 104, 2015), an optional
package (``heavylift[moordyn]``) that is imported here alone. The water is still, and the seabed flat.

Coupled, the simulation keeps its catenaries, with their stiffness inside the step. After each exchange interval MoorDyn
moves its lines along with the fairleads, and what its force differs from that of the catenary there acts on the
fairlead, constant, over the next interval. So only that difference lags, by half an interval in the mean.
"""

from __future__ import annotations

import contextlib
import math
import os
import tempfile
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.records import records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.log import flush_output
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.moorings import check_sections
from heavylift.solver.simulation import Simulation
from heavylift.solver.water.lines.bottom import BottomState, solve_lines_over_bottom
from heavylift.solver.water.lines.catenary import LineEnds, LineState, solve_lines
from heavylift.solver.water.lines.catenary_line import over_bottom, pack_sections
from heavylift.solver.water.lines.mooring_lines import MooringState
from heavylift.solver.water.lines.placed_line import hang_line, plane_of_line

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from heavylift.solver.scene.channels import Channel
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.water.lines.mooring_lines import MooringLine

__all__ = [
    "CoupledRun",
    "DynamicLine",
    "LineDynamics",
    "MoorDynLine",
    "couple_moordyn",
    "moordyn_input",
    "moordyn_package",
    "quasi_static_force",
    "run_moordyn",
    "work_folder",
]

SEABED_STIFFNESS, SEABED_DAMPING = 3.0e6, 3.0e5
"""[Pa/m], [Pa s/m]: of MoorDyn's examples."""
DEEP = 1.0e4
"""Depth [m] of a line without a seabed."""
STEP_PART = 0.8
"""Inner time step of MoorDyn times the largest frequency of a segment: explicit, and the damping is large."""
REST_TIME = 60.0
"""Time [s] that a line may take to come to rest at the start."""


@dataclass(frozen=True)
class LineDynamics:
    """What a catenary does not need to know of a line, but its motion does.

    Attributes
    ----------
    masses
        Of each section a length, in air [kg/m]. What a section weighs less in water gives its displaced volume and
        thereby the diameter that drag and added mass refer to.
    drag, axial_drag, added_mass, axial_added_mass
        Coefficients of a cylinder of that diameter, across and along the line: the defaults are those of studless
        chain by DNV-OS-E301 with the diameter of equal volume, 1.8 times that of the bar.
    damping
        Of the elongation, as part of the critical damping of a segment.
    segment
        Longest segment [m].
    """

    masses: tuple[float, ...]
    drag: float = 1.33
    axial_drag: float = 0.64
    added_mass: float = 1.0
    axial_added_mass: float = 0.5
    damping: float = 0.8
    segment: float = 10.0


def quasi_static_force(
    line: MooringLine, anchors: NDArray[np.float64], fairleads: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Force [N] of a catenary on its fairlead along a motion, world axes, shape (nt, 3).

    Parameters
    ----------
    line
        The line.
    anchors, fairleads
        Ends, world [m], shape (nt, 3).
    """
    rows, lines = pack_sections(
        line.sections, line.clumps, on_seabed=line.seabed is not None, friction=line.friction
    )
    ends = records(LineEnds, 1)
    planes = [plane_of_line(line, *pair) for pair in zip(anchors, fairleads, strict=True)]
    over = any(over_bottom(plane.slope, plane.clearance) for plane in planes)
    states: Any = records(BottomState if over else LineState, 1)
    state = states[0]
    forces = np.empty((len(planes), 3))
    for i, (x, z, slope, clearance) in enumerate(planes):
        if over:
            above = -1.0 if clearance is None else max(clearance, 0.0)
            place = np.array([[x, z, slope, above]])
            solve_lines_over_bottom(rows, lines, place, states, ends, np.empty((0, 3)))
        else:
            solve_lines(rows, lines, np.array([[x, z]]), states, ends)
        r = fairleads[i] - anchors[i]
        share = state.horizontal / max(x, 1e-9)
        forces[i] = -share * r[0], -share * r[1], -state.vertical
    return forces


def moordyn_input(
    line: MooringLine,
    dynamics: LineDynamics,
    anchor: NDArray[np.float64],
    fairlead: NDArray[np.float64],
    *,
    level: float = 0.0,
    density: float = 1025.0,
    gravity: float = 9.80665,
    anchor_moves: bool = False,
) -> str:
    """Input file of MoorDyn (version 2) for one line.

    Parameters
    ----------
    line, dynamics
        The line.
    anchor, fairlead
        Its ends at the start, world [m], shape (3,).
    level
        Height of the water [m]; MoorDyn has it at zero.
    density, gravity
        Of the water [kg/m3], [m/s2].
    anchor_moves
        Whether the anchor is on a body.

    Raises
    ------
    InputError
        If the masses do not fit the sections or weigh less in air than the sections in water, one does not stretch, or
        the seabed slopes.

    Notes
    -----
    Joints of sections are free points, which begin where the catenary has them; a clump is a mass without volume
    there, a buoy a volume without mass.
    """
    check_sections(line.sections, line.clumps, friction=line.friction, source=line.name)
    if len(dynamics.masses) != len(line.sections):
        raise InputError(
            f"{len(dynamics.masses)} masses of {len(line.sections)} sections",
            source=line.name,
            key="masses",
            expected="one mass a length [kg/m] a section",
        )
    if line.seabed_slope is not None:
        raise InputError(
            "the seabed slopes",
            source=line.name,
            key="seabed_slope",
            expected="a level seabed, for --moordyn",
        )
    types, points, lines = [], [], []
    step = np.inf
    shift = np.array([0.0, 0.0, level])
    joints = _joints(line, anchor, fairlead)
    for number, (section, mass) in enumerate(zip(line.sections, dynamics.masses, strict=True), start=1):
        displaced = mass - section.weight / gravity
        if not (mass > 0.0 and displaced >= -1e-6 * mass):
            raise InputError(
                f"a mass of {mass:g} kg/m weighs less in air than the section in water, {section.weight:g} N/m",
                source=line.name,
                key=f"masses.{number - 1}",
                expected=f"more than {section.weight / gravity:g} kg/m",
            )
        if not np.isfinite(section.axial_stiffness):
            raise InputError(
                f"section {number} does not stretch",
                source=line.name,
                key=f"sections.{number - 1}.axial_stiffness",
                expected="a finite EA [N]: MoorDyn integrates the waves along the line",
            )
        diameter = max(np.sqrt(4.0 * max(displaced, 0.0) / (np.pi * density)), 1e-4)
        types.append(
            f"type{number} {diameter:.12g} {mass:.12g} {section.axial_stiffness:.12g} {-dynamics.damping:g} 0"
            f" {dynamics.drag:g} {dynamics.added_mass:g} {dynamics.axial_drag:g} {dynamics.axial_added_mass:g}"
        )
        count = max(2, int(np.ceil(section.length / dynamics.segment)))
        step = min(step, 0.5 * STEP_PART * section.length / count * np.sqrt(mass / section.axial_stiffness))
        lines.append(f"{number} type{number} {number} {number + 1} {section.length:.12g} {count} -")
    clumps = [0.0, *(line.clumps or [0.0] * (len(line.sections) - 1)), 0.0]
    places = [anchor, *joints, fairlead]
    kinds = [
        "Coupled" if anchor_moves else "Fixed",
        *(["Free"] * len(joints)),
        "Coupled",
    ]
    for number, (place, kind, clump) in enumerate(zip(places, kinds, clumps, strict=True), start=1):
        x, y, z = np.asarray(place) - shift
        mass, volume = max(clump, 0.0) / gravity, max(-clump, 0.0) / (density * gravity)
        points.append(f"{number} {kind} {x:.12g} {y:.12g} {z:.12g} {mass:.12g} {volume:.12g} 0 0")
    depth = DEEP if line.seabed is None else level - line.seabed
    return "\n".join(
        [
            f"Mooring line {line.name}",
            "---------------------- LINE TYPES ----------------------",
            "Name Diam MassDen EA BA/-zeta EI Cd Ca CdAx CaAx",
            "(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)",
            *types,
            "---------------------- POINTS ----------------------",
            "ID Attachment X Y Z Mass Volume CdA Ca",
            "(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)",
            *points,
            "---------------------- LINES ----------------------",
            "ID LineType AttachA AttachB UnstrLen NumSegs Outputs",
            "(#) (name) (#) (#) (m) (-) (-)",
            *lines,
            "---------------------- OPTIONS ----------------------",
            "0 writeLog",
            "1 disableOutput",
            "1 disableOutTime",
            f"{step:.6g} dtM",
            f"{depth:.12g} WtrDpth",
            f"{density:.12g} WtrDnsty",
            f"{gravity:.12g} gravity",
            f"{SEABED_STIFFNESS:g} kBot",
            f"{SEABED_DAMPING:g} cBot",
            f"{line.friction:g} FrictionCoefficient",
            f"{REST_TIME:g} TmaxIC",
            "0.0001 threshIC",
            "---------------------- OUTPUTS ----------------------",
            "---------------------- END ----------------------",
            "",
        ]
    )


def _joints(
    line: MooringLine, anchor: NDArray[np.float64], fairlead: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Where the catenary has the joints of the sections, world [m]."""
    r = np.asarray(fairlead) - np.asarray(anchor)
    span = float(np.hypot(r[0], r[1]))
    _, profile = hang_line(line, np.asarray(anchor), np.asarray(fairlead))
    at = np.cumsum([section.length for section in line.sections])[:-1]
    x = np.interp(at, profile.s, profile.x) * (span / max(profile.x[-1], 1e-9))
    z = np.interp(at, profile.s, profile.z)
    e = np.array([r[0], r[1], 0.0]) / max(span, 1e-9)
    return [np.asarray(anchor) + xi * e + np.array([0.0, 0.0, zi]) for xi, zi in zip(x, z, strict=True)]


@dataclass(frozen=True, eq=False)
class DynamicLine:
    """Tensions along a motion.

    Attributes
    ----------
    times
        [s], shape (nt,).
    tension, anchor_tension
        At the fairlead and at the anchor, by MoorDyn [N], shape (nt,).
    force
        On the fairlead, world axes [N], shape (nt, 3).
    quasi_static
        Tension at the fairlead of the catenary [N], shape (nt,).
    nodes
        Nodes of the line at the end, from the anchor, world [m], shape (n, 3).
    """

    times: NDArray[np.float64]
    tension: NDArray[np.float64]
    anchor_tension: NDArray[np.float64]
    force: NDArray[np.float64]
    quasi_static: NDArray[np.float64]
    nodes: NDArray[np.float64]

    @property
    def amplification(self) -> float:
        """Largest dynamic tension over the largest one of the catenary."""
        return float(self.tension.max() / self.quasi_static.max())


class MoorDynLine:
    """One line in MoorDyn, with ends that are led.

    Parameters
    ----------
    line, dynamics
        The line.
    anchor, fairlead
        Its ends at the start, world [m], shape (3,).
    folder
        For the input file and the messages.
    level, density, gravity
        As in `moordyn_input`.
    anchor_moves
        Whether the lower end is led too.

    Attributes
    ----------
    force
        On the fairlead, world axes [N], shape (3,).

    Raises
    ------
    InputError
        If the package is not installed, the line does not fit, or MoorDyn finds no start.
    """

    def __init__(
        self,
        line: MooringLine,
        dynamics: LineDynamics,
        anchor: NDArray[np.float64],
        fairlead: NDArray[np.float64],
        folder: Path,
        *,
        level: float = 0.0,
        density: float = 1025.0,
        gravity: float = 9.80665,
        anchor_moves: bool = False,
    ) -> None:
        self._moordyn = moordyn_package()
        text = moordyn_input(
            line,
            dynamics,
            anchor,
            fairlead,
            level=level,
            density=density,
            gravity=gravity,
            anchor_moves=anchor_moves,
        )
        self._name = line.name
        self._file = folder / f"{line.name.replace(' ', '_')}.txt"
        self._file.write_text(text)
        self._shift = np.array([0.0, 0.0, level])
        self._time = 0.0
        start = [anchor, fairlead] if anchor_moves else [fairlead]
        places = np.concatenate([np.asarray(place) - self._shift for place in start])
        with self._messages("w"):
            self._system = self._moordyn.Create(str(self._file))
            code = self._moordyn.Init(self._system, places.tolist(), [0.0] * len(places))
        if code != 0:
            self.close()
            raise self._error()
        count = len(line.sections)
        self._parts = [self._moordyn.GetLine(self._system, number + 1) for number in range(count)]
        self.force = np.array(
            self._moordyn.GetPointForce(self._moordyn.GetPoint(self._system, count + 1)), dtype=np.float64
        )

    def lead(self, start: NDArray[np.float64], end: NDArray[np.float64], duration: float) -> None:
        """Move the ends straight, with constant velocity, in some time [s]; each shape (3,), or (6,) with the anchor.

        Raises
        ------
        InputError
            If MoorDyn stops.
        """
        velocity = ((end - start) / duration).tolist()
        places = (start - np.tile(self._shift, len(start) // 3)).tolist()
        try:
            force = self._moordyn.Step(self._system, places, velocity, self._time, duration)
        except RuntimeError:
            raise self._error() from None
        self._time += duration
        self.force = np.array(force[-3:], dtype=np.float64)  # behind those on a moving anchor
        if not np.all(np.isfinite(self.force)):
            raise self._error()

    @property
    def anchor_tension(self) -> float:
        """At the lower end [N]."""
        return float(np.linalg.norm(self._moordyn.GetLineNodeTen(self._parts[0], 0)))

    @property
    def nodes(self) -> NDArray[np.float64]:
        """Places of the nodes from the anchor, world [m], shape (n, 3)."""
        places = [
            self._moordyn.GetLineNodePos(part, k)
            for number, part in enumerate(self._parts)
            for k in range(min(number, 1), self._moordyn.GetLineN(part) + 1)
        ]
        return np.array(places) + self._shift

    def close(self) -> None:
        """Free what MoorDyn holds."""
        if self._system is not None:
            with self._messages("a"):
                self._moordyn.Close(self._system)
            self._system = None

    def _error(self) -> InputError:
        """With the last message of MoorDyn."""
        log = self._file.with_suffix(".log").read_text(errors="replace")
        words = [text for text in log.splitlines() if text.startswith("ERR")]
        return InputError(
            f"MoorDyn stopped at {self._time:.6g} s{': ' + words[-1] if words else ''}",
            source=self._name,
            key="dynamics",
            expected="a line and a motion that MoorDyn can follow",
        )

    @contextlib.contextmanager
    def _messages(self, mode: str) -> Iterator[None]:
        """Send what the library prints, past Python, into a file beside its input."""
        flush_output()
        kept = os.dup(1), os.dup(2)
        with self._file.with_suffix(".log").open(mode) as out:
            try:
                os.dup2(out.fileno(), 1)
                os.dup2(out.fileno(), 2)
                yield
            finally:
                os.dup2(kept[0], 1)
                os.dup2(kept[1], 2)
                os.close(kept[0])
                os.close(kept[1])


def run_moordyn(
    line: MooringLine,
    dynamics: LineDynamics,
    times: NDArray[np.float64],
    fairleads: NDArray[np.float64],
    *,
    anchors: NDArray[np.float64] | None = None,
    level: float = 0.0,
    density: float = 1025.0,
    gravity: float = 9.80665,
    exchange: float = 0.02,
    folder: Path | None = None,
) -> DynamicLine:
    """Compute a line with lumped masses along the motion of its ends.

    Parameters
    ----------
    line, dynamics
        The line.
    times
        Of the motion [s], increasing, shape (nt,).
    fairleads
        Upper end, world [m], shape (nt, 3); a cubic spline through it is what MoorDyn sees.
    anchors
        Lower end, if it is on a body; None: fixed at `line.point_a`.
    level, density, gravity
        As in `moordyn_input`.
    exchange
        Longest time [s] between two exchanges of velocity, constant in between.
    folder
        Where the input file and MoorDyn's messages stay; None: nowhere.

    Returns
    -------
    DynamicLine
        Tensions at `times`.

    Raises
    ------
    InputError
        If the package is not installed, the motion is not one, or MoorDyn stops.
    """
    times, fairleads = np.asarray(times, dtype=np.float64), np.asarray(fairleads, dtype=np.float64)
    fixed = np.broadcast_to(np.asarray(line.point_a, dtype=np.float64), fairleads.shape)
    low = fixed if anchors is None else np.asarray(anchors, dtype=np.float64)
    fits = times.ndim == 1 and len(times) > 1 and fairleads.shape == low.shape == (len(times), 3)
    if not (
        fits and np.all(np.diff(times) > 0.0) and np.all(np.isfinite(fairleads)) and np.all(np.isfinite(low))
    ):
        raise InputError(
            f"times of shape {times.shape}, ends of shapes {fairleads.shape} and {low.shape}",
            source=line.name,
            key="times",
            expected="two or more increasing times [s], and a finite place [m] of each end a time",
        )
    from scipy.interpolate import CubicSpline

    moves = anchors is not None
    spline = CubicSpline(times, np.hstack([low, fairleads]) if moves else fairleads)
    forces, anchor_tension = np.empty((len(times), 3)), np.empty(len(times))
    with work_folder(folder) as place:
        model = MoorDynLine(
            line,
            dynamics,
            low[0],
            fairleads[0],
            place,
            level=level,
            density=density,
            gravity=gravity,
            anchor_moves=moves,
        )
        try:
            forces[0], anchor_tension[0] = model.force, model.anchor_tension
            for i in range(1, len(times)):
                count = max(1, int(np.ceil((times[i] - times[i - 1]) / exchange - 1e-9)))
                way = spline(np.linspace(times[i - 1], times[i], count + 1))
                for part in range(count):
                    model.lead(way[part], way[part + 1], (times[i] - times[i - 1]) / count)
                forces[i], anchor_tension[i] = model.force, model.anchor_tension
            nodes = model.nodes
        finally:
            model.close()
    static = np.linalg.norm(quasi_static_force(line, low, fairleads), axis=1)
    return DynamicLine(times, np.linalg.norm(forces, axis=1), anchor_tension, forces, static, nodes)


def moordyn_package() -> Any:
    """The optional package.

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        return import_module("moordyn")
    except ImportError:
        raise InputError(
            "the package moordyn is not installed",
            source="mooring",
            key="dynamics",
            expected="pip install 'heavylift[moordyn]', or quasi-static lines",
        ) from None


@contextlib.contextmanager
def work_folder(folder: Path | None) -> Iterator[Path]:
    """A folder that is made, or one that vanishes."""
    if folder is None:
        with tempfile.TemporaryDirectory() as made:
            yield Path(made)
    else:
        Path(folder).mkdir(parents=True, exist_ok=True)
        yield Path(folder)


STATE = "MooringLines.state"
"""Array in the state of a simulation that holds the forces beside the catenaries."""


@dataclass(frozen=True, eq=False)
class CoupledRun:
    """A simulation with dynamic lines.

    Attributes
    ----------
    times
        [s], shape (nt,), the start included.
    records
        Columns of the simulation, shape (nt, columns).
    channels
        Their meaning.
    tension, quasi_static
        At the fairlead of each dynamic line [N], by MoorDyn and of the catenary at the same place, shape (nt,).
    simulation
        At its end: with its outcome and message.
    """

    times: NDArray[np.float64]
    records: NDArray[np.float64]
    channels: tuple[Channel, ...]
    tension: dict[str, NDArray[np.float64]]
    quasi_static: dict[str, NDArray[np.float64]]
    simulation: Simulation


def couple_moordyn(
    scene: Scene,
    dynamics: Mapping[str, LineDynamics],
    step: float,
    duration: float,
    *,
    interval: float = 0.05,
    folder: Path | None = None,
) -> CoupledRun:
    """Simulate a moored scene with some of its lines computed by MoorDyn.

    Parameters
    ----------
    scene
        With a sea that has the lines.
    dynamics
        What MoorDyn needs to know, by name of the line.
    step
        Of the simulation [s], with the default integrator.
    duration
        [s].
    interval
        Between two exchanges, and two records [s]; a whole number of steps. A fifth of it times the largest natural
        frequency of what is moored should be small.
    folder
        For input and messages of MoorDyn; None: nowhere.

    Returns
    -------
    CoupledRun
        Until the duration, or where the simulation stopped.

    Raises
    ------
    InputError
        If the package is not installed, a line is not in the scene or its anchor not on the ground, the interval is
        no whole number of steps, or MoorDyn stops. A coupled run cannot be continued from a checkpoint: the state of
        MoorDyn is not in it.
    """
    sea = scene.sea
    names = [line.name for line in sea.lines] if sea is not None else []
    for name in dynamics:
        if name not in names:
            raise InputError(
                f"there is no line {name!r}",
                source="mooring",
                key="dynamics",
                expected=f"one of {', '.join(names)}" if names else "lines in the scene",
            )
    steps = round(interval / step)
    if steps < 1 or abs(steps * step - interval) > 1e-9 * interval:
        raise InputError(
            f"{interval:g} s between exchanges",
            source="mooring",
            key="interval",
            expected=f"a whole number of steps of {step:g} s",
        )
    assert sea is not None or not dynamics
    lines = [
        (names.index(name), line)
        for name in dynamics
        for line in (sea.lines if sea else ())
        if line.name == name
    ]
    for _, line in lines:
        if line.body_a != GROUND:
            raise InputError(
                f"the anchor is on {line.body_a!r}",
                source=line.name,
                key="body_a",
                expected="an anchor on the ground, for a line that is coupled with MoorDyn",
            )
    moordyn_package()
    simulation = Simulation(scene, step, record_every=steps)
    records = [simulation.record()]
    ends = [np.asarray(line.point_a, dtype=np.float64) for _, line in lines]
    at = [_fairlead(simulation, records[0], line) for _, line in lines]
    with work_folder(folder) as place:
        models: list[MoorDynLine] = []
        try:
            for (_, line), anchor, fairlead in zip(lines, ends, at, strict=True):
                models.append(
                    MoorDynLine(
                        line,
                        dynamics[line.name],
                        anchor,
                        fairlead,
                        place,
                        level=sea.water.level if sea else 0.0,
                        density=sea.water.density if sea else 0.0,
                        gravity=sea.water.gravity if sea else 0.0,
                    )
                )
            tension, static = [], []
            for _ in range(math.ceil(duration / interval - 1e-9)):
                forces = [
                    quasi_static_force(line, a[None], b[None])[0]
                    for (_, line), a, b in zip(lines, ends, at, strict=True)
                ]
                tension.append([np.linalg.norm(model.force) for model in models])
                static.append([np.linalg.norm(force) for force in forces])
                _hold(
                    simulation,
                    [row for row, _ in lines],
                    [m.force - f for m, f in zip(models, forces, strict=True)],
                )
                _, found = simulation.advance(steps)
                if simulation.outcome is not Outcome.COMPLETED:
                    break
                records.append(found[-1])
                before, at = at, [_fairlead(simulation, records[-1], line) for _, line in lines]
                for model, start, end in zip(models, before, at, strict=True):
                    model.lead(start, end, interval)
            else:
                tension.append([np.linalg.norm(model.force) for model in models])
                static.append(
                    [
                        np.linalg.norm(quasi_static_force(line, a[None], b[None]))
                        for (_, line), a, b in zip(lines, ends, at, strict=True)
                    ]
                )
        finally:
            for model in models:
                model.close()
    count = len(records)
    by_line = {line.name: number for number, (_, line) in enumerate(lines)}
    return CoupledRun(
        np.asarray(interval * np.arange(count), dtype=np.float64),
        np.array(records),
        tuple(simulation.channels),
        {name: np.array([row[number] for row in tension[:count]]) for name, number in by_line.items()},
        {name: np.array([row[number] for row in static[:count]]) for name, number in by_line.items()},
        simulation,
    )


def _fairlead(simulation: Simulation, row: NDArray[np.float64], line: MooringLine) -> NDArray[np.float64]:
    """Fairlead of a line in a record, world [m]."""
    if line.body_b == GROUND:
        return np.asarray(line.point_b, dtype=np.float64)
    found = {channel.name: channel.column for channel in simulation.channels}
    position, turn = found[f"{line.body_b}.position"], found[f"{line.body_b}.orientation"]
    rotation = rotation_matrix(row[turn : turn + 4])
    return np.asarray(row[position : position + 3] + rotation @ np.asarray(line.point_b, dtype=np.float64))


def _hold(simulation: Simulation, rows: list[int], forces: list[NDArray[np.float64]]) -> None:
    """Let forces act on fairleads beside the catenaries until they are changed again."""
    state = simulation.state()
    for row, force in zip(rows, forces, strict=True):
        state[STATE].view(MooringState.layout)["extra"][row] = force
    simulation.restore(state)
