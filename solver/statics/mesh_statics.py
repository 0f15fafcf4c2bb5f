"""Equilibrium of scenes with frames and shells, before time starts.

Loads grow in steps. Where steps come to an end, at a limit point, the path is followed over it by its arc length;
what bifurcates is pushed to a stable branch and settles there; what is held by nothing but its weight settles from
the start. The last resort is relaxation in a dissipative motion.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.start.consistent_start import close_velocities
from heavylift.solver.start.free_motions import FreeMotions, find_free_motions
from heavylift.solver.start.rows import StartRows, plural
from heavylift.solver.statics.arc_length import trace_path
from heavylift.solver.statics.load_steps import follow_load, promise
from heavylift.solver.statics.mesh_system import MeshSystem
from heavylift.solver.statics.newton import Progress, stiffness
from heavylift.solver.statics.problem import Equilibrium, unstable_count
from heavylift.solver.statics.relaxation import relax
from heavylift.solver.statics.settling import settle

__all__ = ["find_mesh_equilibrium", "relax_to_equilibrium"]

SLACK = 100.0
"""Displacement, in units of a large one, that the stiffness without loads promises: of membranes, which find their
stiffness on the way. They settle in fewer iterations than load steps take."""


@dataclass
class _Search:
    """A scene on its way, and where it began."""

    system: MeshSystem
    progress: Progress
    begin: Any
    coordinates: list[NDArray[np.float64]]
    places: NDArray[np.float64]
    way: str = ""

    def restart(self) -> None:
        """Back to the start."""
        self.system.restore(self.begin)
        self.progress.multipliers = np.zeros_like(self.progress.multipliers)
        self.progress.factor = 0.0


def _search(rows: StartRows) -> tuple[_Search, FreeMotions]:
    system = MeshSystem(rows)
    system.stop()
    motions = find_free_motions(system)
    if motions.sinking:
        raise InputError(
            f"there is no static equilibrium: {motions.sinking}, and the loads drive that",
            source="simulation",
            key="start",
            expected="supports, joints, springs or ropes that hold all bodies",
        )
    begin = system.snapshot()
    coordinates = [kind.position.copy() for kind in system.meshes]
    progress = Progress(np.zeros(system.joints()[0].shape[0]))
    return _Search(system, progress, begin, coordinates, rows.survey()[0]), motions


def find_mesh_equilibrium(rows: StartRows) -> Equilibrium:
    """Bring a scene with meshes to rest in a stable equilibrium, with the reactions that belong to it.

    Parameters
    ----------
    rows
        The scene. Driven bodies and drives stay as they are at the start.

    Raises
    ------
    InputError
        If a free motion is loaded, or no equilibrium is found; says which bodies can move how.
    """
    search, motions = _search(rows)
    system, progress = search.system, search.progress
    found = False
    if motions.count == 0 and promise(system, progress) <= SLACK:
        found = _along_path(search)
        if found and not _is_stable(search):
            search.way += ", pushed to a stable branch"
            found = settle(system, progress)
        if not found:
            search.restart()
    if not found:
        search.way = "settled"
        found = settle(system, progress)
    if not found:
        search.restart()
        motion = relax(system, progress)
        search.way = f"relaxed in {motion.time:.3g} s"
        found = motion.at_rest
    if not found:
        raise _failure(progress, motions)
    return _finish(search, motions)


def relax_to_equilibrium(rows: StartRows) -> Equilibrium:
    """As `find_mesh_equilibrium`, by a dissipative motion under all loads from the start.

    Parameters
    ----------
    rows
        The scene, with meshes or without.

    Raises
    ------
    InputError
        If a free motion is loaded, or the scene does not come to rest.
    """
    search, motions = _search(rows)
    motion = relax(search.system, search.progress)
    if not motion.at_rest:
        raise _failure(search.progress, motions)
    search.progress.steps = motion.steps
    search.way = (
        f"relaxed in {motion.time:.3g} s, {motion.dissipated:.3g} J dissipated, energy never grew by more than"
        f" {max(motion.balance, 0.0):.1%} in a step"
    )
    return _finish(search, motions)


def _along_path(search: _Search) -> bool:
    """Load steps, and the arc length where they end."""
    system, progress = search.system, search.progress
    if follow_load(system, progress):
        return True
    limit = progress.factor
    search.way = f", over a limit point near {limit:.3g} of the loads"
    return limit > 0.0 and trace_path(system, progress).reached


def _is_stable(search: _Search) -> bool:
    K, now, shift = stiffness(search.system, search.progress)
    return unstable_count(search.system, K, now.G, shift) == 0


def _finish(search: _Search, motions: FreeMotions) -> Equilibrium:
    """Velocities, strains, reactions and a report."""
    system, progress, rows = search.system, search.progress, search.system.rows
    system.stop()
    reactions = system.reactions(progress.multipliers)
    close_velocities(rows)
    rows.put_reactions(reactions)
    moved = float(np.linalg.norm(rows.survey()[0][:, 1:4] - search.places[:, 1:4], axis=1).max(initial=0.0))
    for kind, matrices, before in zip(system.meshes, system.matrices, search.coordinates, strict=True):
        change = (kind.position - before).reshape(-1, matrices.lanes)[:, :3]
        nodes = np.unique(matrices.all_places // matrices.lanes)
        moved = max(moved, float(np.linalg.norm(change[nodes], axis=1).max(initial=0.0)))
    way = search.way if search.way.startswith(",") else f", {search.way}" if search.way else ""
    loaded = bool(system.external_force().any())
    residual = progress.residual if loaded else 0.0
    text = (
        f"equilibrium in {plural(progress.steps, 'step')}, {plural(progress.iterations, 'iteration')}{way}: largest"
        f" displacement {moved:.4g} m, " + (f"{residual:.1e} of the loads is left" if loaded else "no loads")
    )
    if progress.rounded and loaded:
        text += ", which is rounding of much larger stiff forces"
    if motions.count:
        text += f"; beside their weight nothing holds this: {motions.text}"
    return Equilibrium(residual, progress.iterations, moved, True, text)


def _failure(progress: Progress, motions: FreeMotions) -> InputError:
    """What to tell the user."""
    loose = f": {motions.text}, and nothing holds that" if motions.count else ""
    return InputError(
        f"no static equilibrium found after {progress.iterations} iterations{loose}",
        source="simulation",
        key="start",
        expected="supports and joints that carry all loads, loads below collapse, or a start nearer to the equilibrium",
    )
