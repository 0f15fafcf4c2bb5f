"""Rest of scenes with contacts: a motion in frozen time that loses its velocities whenever its kinetic energy falls.

Contacts, friction and impacts act as in any step, so nothing of them is defined twice. Where the kinetic energy has
passed a peak the forces have gone through their balance; a start anew from there, at rest, is nearer to it (kinetic
damping: P. A. Cundall, 1976; M. R. Barnes, Int. J. Space Structures 14, 1999).

The steps are its own. A swing of frequency w that begins at rest is left after the first step with the part
``(1 - s^2) / (1 + s^2)``, s = w h / 2, if the step h is long for it, and goes to its peak if h is short: steps of
several lengths in turn reach all swings. So that no length of them shows, the way is gone again with shorter steps,
until two ways end at the same place. Without friction they do; with friction there is no single place of rest, and how
far apart two such searches end is reported.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.start.consistent_start import project_start
from heavylift.solver.start.rows import StartRows

__all__ = ["ContactRest", "settle_contacts"]

RESTED = 1e-12
"""Kinetic energy of a peak, over the weight of all bodies times their lengths, that counts as rest."""

UNBALANCED = 1e-4
"""Acceleration from rest, relative to that of the loads, that a scene at rest may have: what creeps in strong dampers
has little energy, too."""

MOST_STEPS = 100_000

ROUNDS = 200
"""Rounds of steps of all lengths without less energy than in any before, after which nothing more is expected."""

RUNAWAY = 20.0
"""Distance from the start, in extents of the scene, beyond which nothing seems to hold a body."""

LONGEST = 0.1
"""Longest step, relative to the time in which the loads move a body by its length."""

LENGTHS, RATIO = 4, 4.0
"""Of steps that are taken in turn, each so much shorter than the one before."""

PATIENCE = 40
"""Steps of the shorter lengths without a peak, after which the velocities are taken away all the same."""

SHORTER, WAYS = 3.0, 4
"""Factor between the steps of two ways, and how many there are at most."""

PROBE = 1e-3
"""First step of a scene without gravity, from which its accelerations are known [s]."""

TRIES = 6
"""How often steps are made shorter by `RATIO` where one fails."""

SAME = 1e-5
"""Distance of two places of rest, relative to the length of a body, that is none."""

TOLD = 5e-3
"""The same with friction, from which a warning stands beside the results."""


@dataclass(frozen=True)
class ContactRest:
    """What was found.

    Attributes
    ----------
    text
        What was done, in a sentence.
    warning
        What the user should know; empty if nothing.
    """

    text: str
    warning: str


@dataclass(frozen=True)
class _Way:
    """One way to rest.

    Attributes
    ----------
    poses
        Where it ended, by kind.
    steps, peaks
        How many there were.
    longest
        Step [s].
    unbalanced
        Acceleration that is left, relative to that of the loads.
    """

    poses: list[Any]
    steps: int
    peaks: int
    longest: float
    unbalanced: float


def settle_contacts(
    rows: StartRows,
    arrays: Callable[[], Any],
    advance: Callable[[float], str],
    meet: Callable[[], None],
    restored: Callable[[], None],
    touching: Callable[[], Callable[[], None]],
    weight: float,
    gravity: float,
    *,
    rubs: bool,
) -> ContactRest:
    """Bring a scene with contacts to rest; contacts have to be met anew afterwards.

    Parameters
    ----------
    rows
        The scene, its joints closed.
    arrays
        Gives names and arrays of everything that a step writes, of which a settled scene has its poses only.
    advance
        Makes a step of a length [s] from time 0; says why if it cannot.
    meet
        Lets contacts meet at the start of a way.
    restored
        Brings what follows from the arrays up to date after they have been written over.
    touching
        Notes what touches, and gives what makes contacts of it again.
    weight
        Weights of all bodies, each times its length [J].
    gravity
        [m/s2].
    rubs
        Whether contacts have friction, which may leave the place of rest open.

    Raises
    ------
    InputError
        If a step fails, however short, or the scene does not come to rest.
    """
    meet()
    before = {name: array.copy() for name, array in arrays()}
    search = _Search(rows, advance, weight, gravity)

    def begin_again() -> None:
        for name, array in arrays():
            array[...] = before[name]
        restored()
        rows.start()

    longest = search.longest_step()
    found: _Way | None = None
    apart, far, total = np.inf, 0, 0
    for _ in range(WAYS):
        begin_again()
        way = search.go(longest, begin_again)
        total += way.steps
        last, found, longest = found, way, way.longest / SHORTER
        if last is None:
            continue
        apart, far = search.distance(last.poses, way.poses)
        if rubs or apart <= SAME:
            break
    assert found is not None
    name, length = rows.layout.body_names[far], search.lengths[far]
    increment = np.zeros(len(rows.inertia))
    for kind, first, last_pose in zip(rows.layout.bodies, search.start, found.poses, strict=True):
        kind.put_increment(first, last_pose, increment)
    touch = touching()
    begin_again()
    rows.move(increment)
    project_start(rows)
    rows.put_velocity(np.zeros(len(rows.inertia)))
    touch()
    text = (
        f"at rest with its contacts after {total} steps in frozen time, {found.peaks} of them from rest;"
        f" bodies moved by up to {search.moved():.3g} m"
    )
    notes = []
    if apart > SAME:
        notes.append(
            f"{'friction' if rubs else 'what holds it'} leaves the position of rest undetermined: two searches end with"
            f" {name!r} {apart * length:.2g} m apart"
        )
    if found.unbalanced > UNBALANCED:
        notes.append(f"a fraction of {found.unbalanced:.1g} of the loads is not balanced yet")
    worth = apart > TOLD or found.unbalanced > UNBALANCED
    return ContactRest("; ".join([text, *notes]), "at the start " + ", ".join(notes) if worth else "")


class _Search:
    """What the ways of a scene to its rest have in common."""

    def __init__(
        self, rows: StartRows, advance: Callable[[float], str], weight: float, gravity: float
    ) -> None:
        self.rows, self.advance, self.weight, self.load = rows, advance, weight, gravity
        places, inertia, _ = rows.survey()
        self.begin = places[:, 1:4].copy()
        self.start = [kind.poses() for kind in rows.layout.bodies]
        self.extent = max(float(np.ptp(self.begin, axis=0).max(initial=0.0)), 1.0)
        count = len(places)
        self.lengths, self._mass = np.ones(count), np.ones(count)
        for kind in rows.layout.bodies:
            self.lengths[kind.table["number"]] = kind.frame["reach"]
            self._mass[kind.table["number"]] = kind.frame["mass"]
        self.moves = np.bincount(rows.owner, weights=inertia, minlength=count) > 0.0
        self._moving_mass = max(float(self._mass[self.moves].sum()), 1e-300)
        self._still = np.zeros(len(inertia))

    def longest_step(self) -> float:
        """Of the first way [s]; a probe from rest tells what the loads do besides gravity."""
        if self.load == 0.0 and not self.advance(PROBE):
            self.load = self._acceleration(PROBE)
        length = float(self.lengths[self.moves].min(initial=np.inf))
        return LONGEST * np.sqrt(length / self.load) if self.load > 0.0 and np.isfinite(length) else PROBE

    def go(self, longest: float, begin_again: Callable[[], None]) -> _Way:
        """From the start to rest, with shorter steps where one fails."""
        failed = 0, ""
        for _ in range(TRIES):
            found = self._go(longest)
            if isinstance(found, _Way):
                return found
            failed = found
            begin_again()
            longest /= RATIO
        raise self._failure(*failed)

    def _go(self, longest: float) -> _Way | tuple[int, str]:
        """A way with steps of some length, or after how many of them one failed, and why."""
        rows = self.rows
        steps = peaks = rested = turn = 0
        left = least = np.inf
        most, rounds = 0.0, 0
        while True:
            h, last, k = longest / RATIO**turn, 0.0, 0
            while True:
                problem = self.advance(h)
                steps, k = steps + 1, k + 1
                _, inertia, velocity = rows.survey()
                energy = 0.5 * float(inertia @ velocity**2)
                if k == 1 and turn == LENGTHS - 1:
                    left = self._acceleration(h) / self.load if self.load > 0.0 else 0.0
                if problem:
                    return steps, problem
                if steps == MOST_STEPS or not self.moved() <= RUNAWAY * self.extent:
                    raise self._failure(steps)
                if (energy < last or energy == 0.0) or (turn and k == PATIENCE):
                    break
                last = energy
            peaks += 1
            most = max(most, last, energy)
            if turn == LENGTHS - 1:
                rounds = 0 if most < least else rounds + 1
                least, most = min(least, most), 0.0
                if rounds == ROUNDS and least > RESTED * self.weight:
                    raise self._failure(steps, self._moving(inertia, velocity))
            rows.put_velocity(self._still)
            rested = rested + 1 if max(last, energy) <= RESTED * self.weight else 0
            turn = (turn + 1) % LENGTHS
            if rested >= LENGTHS and (left <= UNBALANCED or rested >= 10 * LENGTHS):
                return _Way([kind.poses() for kind in rows.layout.bodies], steps, peaks, longest, left)

    def _acceleration(self, step: float) -> float:
        """Root mean square over all that moves, in a step from rest [m/s2]."""
        _, inertia, velocity = self.rows.survey()
        return float(np.sqrt(inertia @ velocity**2 / self._moving_mass)) / step

    def _moving(self, inertia: NDArray[np.float64], velocity: NDArray[np.float64]) -> str:
        """Which body has most of the energy of a motion that does not end."""
        energy = np.bincount(self.rows.owner, weights=inertia * velocity**2, minlength=len(self._mass))
        name = self.rows.layout.body_names[int(np.argmax(np.where(self.moves, energy, -1.0)))]
        return f"a motion continues that nothing damps, most of it of {name!r}"

    def moved(self) -> float:
        """Largest displacement of a body since the start [m]."""
        moved = np.linalg.norm(self.rows.survey()[0][:, 1:4] - self.begin, axis=1)
        return float(moved.max(initial=0.0))

    def distance(self, one: list[Any], other: list[Any]) -> tuple[float, int]:
        """Largest root mean square displacement between two places, in lengths of its body; number of that body."""
        increment = np.zeros(len(self._still))
        for kind, a, b in zip(self.rows.layout.bodies, one, other, strict=True):
            kind.put_increment(a, b, increment)
        inertia = self.rows.survey()[1]
        count = len(self._mass)
        square = np.bincount(self.rows.owner, weights=inertia * increment**2, minlength=count) / self._mass
        apart = np.where(self.moves, np.sqrt(square) / self.lengths, 0.0)
        worst = int(np.argmax(apart))
        return float(apart[worst]), worst

    def _failure(self, steps: int, problem: str = "") -> InputError:
        """Nothing comes to rest."""
        return InputError(
            f"the scene does not come to rest with its contacts in {steps} steps"
            + (f": {problem}" if problem else f": bodies moved by up to {self.moved():.3g} m"),
            source="simulation",
            key="start",
            expected="contacts, joints, springs or ropes that hold all bodies; 'check' or 'project'",
        )
