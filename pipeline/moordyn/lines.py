"""Dynamic tension of mooring lines by MoorDyn along the motion of a simulation.

Catenaries follow their ends without inertia and drag. Where the ends move with the waves that is not enough, and a
line can be computed with lumped masses by MoorDyn-C (Hall and Goupee, *Ocean Engineering* 104, 2015), an optional
package (``heavylift[moordyn]``) that is imported here alone. The water is still, and the seabed flat.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records
from heavylift.pipeline.log import flush_output
from heavylift.pipeline.moordyn.input_file import moordyn_input
from heavylift.solver.water.lines.bottom import BottomState, solve_lines_over_bottom
from heavylift.solver.water.lines.catenary import LineEnds, LineState, solve_lines
from heavylift.solver.water.lines.catenary_line import over_bottom, pack_sections
from heavylift.solver.water.lines.placed_line import plane_of_line

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from heavylift.pipeline.moordyn.input_file import LineDynamics
    from heavylift.solver.water.lines.mooring_lines import MooringLine

__all__ = [
    "DynamicLine",
    "MoorDynLine",
    "moordyn_package",
    "quasi_static_force",
    "run_moordyn",
    "work_folder",
]


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
