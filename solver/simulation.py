"""A running simulation: steps a packed scene in compiled pieces, records, stops, saves and restores itself."""

from __future__ import annotations

import hashlib
import importlib
import math
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import compile_clock
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.words import check_word
from heavylift.solver.carried import carried_words
from heavylift.solver.compiling import compile_units, missing_units
from heavylift.solver.inputs.ports import InputPorts
from heavylift.solver.integrate.choice import check_integrator, choose_integrator, stiff_part
from heavylift.solver.integrate.lone_extremes import LoneExtremes
from heavylift.solver.integrate.loop import start_scene, write_record
from heavylift.solver.integrate.resolution import period_words, prepare_counts, step_warning
from heavylift.solver.integrate.run_watch import STATE, RunWatch
from heavylift.solver.interface import Systems
from heavylift.solver.layout import Channel, Layout, pack_scene
from heavylift.solver.recording import check_written, unwritten
from heavylift.solver.return_point import ReturnPoint
from heavylift.solver.scene.contacts import RigidLaw
from heavylift.solver.scene.scene import Scene, Start
from heavylift.solver.stop_message import (
    contact_warning,
    drive_warning,
    energy_remedy,
    force_warning,
    hull_warning,
    loop_warning,
    mesh_warning,
    stop_message,
)

if TYPE_CHECKING:
    from heavylift.numerics.objects import Unit
    from heavylift.solver.bodies.floating_frame.modal_range import ModalRange
    from heavylift.solver.scenario.operation import Operation
    from heavylift.solver.start.diagnosis import Diagnosis
    from heavylift.solver.start.kept import StartStore

__all__ = ["INTEGRATORS", "Simulation"]

INTEGRATORS = {
    "dele2": "heavylift.solver.integrate.dele2",
    "accurate": "heavylift.solver.integrate.accurate",
    "thesis": "heavylift.solver.integrate.thesis",
}
"""Integrators by name; each module has one compiled `run`."""

DEFAULT_TOLERANCES = {"dele2": 1e-5, "accurate": 1e-7}
"""[m]; of the displacement in a step."""

SMALLEST_WEIGHT = 1e-3
"""Weight times length [J] that a scene without gravity is taken for."""

AT_REST = ("equilibrium", "relax")
"""Starts in static equilibrium."""

ROUNDING = 1e-12
"""Of a number of steps."""
FIRST_STEP = 1e-3
"""Of the output interval: the first step that is tried with a tolerance."""
PROBE_STEP, SMALLEST_PROBE = 1e-4, 1e-8
"""Length of the probe that finds the first reactions: relative to the step, and least [s]."""


class Simulation:
    """The state of a scene and its way through time.

    Parameters
    ----------
    scene
        What is simulated.
    step
        Time step [s]; with a tolerance, the time between records.
    integrator
        A key of `INTEGRATORS`, or ``"auto"``: see `choice`.
    record_every
        Steps between two records.
    tolerance
        Of the displacement in a step [m]: the step is then chosen by the integrator, and `step_index` counts
        records. None: the step is `step`; the accurate integrator always has a tolerance.
    start
        ``"check"``: joints that do not close at the start are an error; ``"project"``: they are closed;
        ``"equilibrium"``: the scene is brought to rest in static equilibrium first; ``"relax"``: the same by a
        dissipative motion.
    starts
        Keeps equilibria: one that was found for the same scene is taken, with the same bits.

    Attributes
    ----------
    channels, column_count
        Meaning of the columns of a record.
    integrator, choice
        Name of the integrator, and a sentence that says why if it was chosen here.
    start_text
        What was done to the start, as a sentence; empty if nothing.
    diagnosis
        Degrees of freedom, redundant joints and free motions; None without joints.
    step_index
        Steps or records done; time is this count times the step, so it never drifts.
    outcome, message
        How it stands; the message says when and which part if it stopped by itself. The state is then
        that of the last good step.
    operation
        Its scenario on its way, with its log; None without one.
    stop_asked
        Asked where a call of the integrator comes back before its end: whether `advance` is to do so too.
    inputs
        What may be set from outside, by name; see `set_input`.
    ended
        Whether its scenario has ended it, with all phases done: time goes no further.
    cpu_seconds, start_seconds, compile_seconds
        CPU time of all `advance` calls, of bringing the bodies to the start, and of compiling or loading the kernels
        and looking at the scene.

    Raises
    ------
    InputError
        If the step is not positive, the integrator is unknown or does not suit the scene, or the scene does
        not fit together.
    """

    def __init__(
        self,
        scene: Scene,
        step: float,
        integrator: str = "dele2",
        *,
        record_every: int = 1,
        tolerance: float | None = None,
        start: Start = "check",
        starts: StartStore | None = None,
    ) -> None:
        _check_positive("step", step, "a positive time [s]")
        if integrator not in {*INTEGRATORS, "auto"}:
            raise InputError(
                f"{integrator!r}",
                source="simulation",
                key="integrator",
                expected=" or ".join([*INTEGRATORS, "auto"]),
            )
        if record_every < 1:
            raise InputError(f"{record_every}", source="simulation", key="record_every", expected="1 or more")
        self.choice = ""
        if integrator == "auto":
            integrator, self.choice = choose_integrator(scene, step * record_every)
            if integrator == "accurate":
                step, record_every, tolerance = (
                    step * record_every,
                    1,
                    tolerance or DEFAULT_TOLERANCES["accurate"],
                )
        check_integrator(scene, integrator)
        if integrator == "accurate" and tolerance is None:
            tolerance = DEFAULT_TOLERANCES["accurate"]
        if tolerance is not None:
            _check_positive("tolerance", tolerance, "a positive length [m]")
            if integrator == "thesis" or record_every != 1:
                raise InputError(
                    f"{tolerance}",
                    source="simulation",
                    key="tolerance",
                    expected="an integrator with step control, and a record at every interval",
                )
        self.step = float(step)
        self.integrator = integrator
        self.record_every = int(record_every)
        self.tolerance = float(tolerance or 0.0)
        scene = replace(scene, at_rest=start in AT_REST)
        if scene.sea is not None and start in AT_REST:
            scene = replace(scene, sea=replace(scene.sea, at_rest=True))
        self._layout = pack_scene(scene, integrator, 0.0 if self.tolerance else self.step)
        self._stiff = integrator == "dele2" and bool(stiff_part(scene, step * record_every))
        check_word(start, Start, source="simulation", key="start")
        self._touches = scene.touches
        if start in AT_REST and any(not isinstance(pair.law, RigidLaw) for pair in scene.collisions):
            raise InputError(
                f"{start!r} with compliant collisions, whose surfaces would cross each other at rest",
                source="simulation",
                key="start",
                expected="law 'rigid' of collisions, compliant contacts with contours, or 'check'",
            )
        frameless = any(not kind.FRAMES for kind in self._layout.bodies)
        if self._touches and start in AT_REST and (frameless or integrator != "dele2"):
            with_what = "bodies without a frame: frames, shells or cables" if frameless else repr(integrator)
            raise InputError(
                f"{start!r} with contacts and {with_what}",
                source="simulation",
                key="start",
                expected="'check' or 'project': contacts come to rest during the run",
            )
        self._start_mode, self._scene, self._starts = start, scene, starts
        self._fits_tensions = start in AT_REST and any(getattr(rope, "tension", 0.0) for rope in scene.ropes)
        self.start_text = self._unsettled = ""
        module = importlib.import_module(INTEGRATORS[integrator])
        self._run = module.run
        if integrator == "accurate":
            self._layout = _with_integration(scene, self._layout, module)
        self.channels: tuple[Channel, ...] = self._layout.channels
        self.column_count: int = self._layout.column_count
        self.diagnosis: Diagnosis | None = None
        self.step_index = 0
        self.outcome = Outcome.COMPLETED
        self.message = ""
        self.ended = False
        self.operation: Operation | None = None
        self.stop_asked: Callable[[], object] = bool
        if scene.scenario is not None:
            from heavylift.solver.scenario.operation import Operation

            self.operation = Operation(self._layout.sequencer, scene.scenario, self.channels)
        self.inputs = InputPorts(
            self._layout.inputs,
            self.step,
            whole_steps=self.tolerance == 0.0,
            corners=self._layout.work.corners,
            clock=lambda: self.time,
        )
        self.cpu_seconds = 0.0
        self.start_seconds = 0.0
        self.compile_seconds = 0.0
        remedy = energy_remedy(self._layout)
        self._watch = RunWatch(
            self.channels,
            self._size(),
            self._weight(scene),
            remedy,
            touches=scene.touches,
            mass=sum(float(mass.sum()) for mass, _ in self._bodies()),
        )
        self._range: ModalRange | None = None
        modal = [body for body in scene.bodies if body.mode_count]
        if modal:
            from heavylift.solver.bodies.floating_frame.modal_range import ModalRange

            self._range = ModalRange(modal, self.channels, scene.joints)
        self._lone = None if self.operation is None else LoneExtremes(self.channels)
        self._return, self._heard = ReturnPoint(), 0
        self._recorded = -1
        self._anew: Callable[[float], object] | None = None
        self._views: tuple[Any, dict[str, NDArray[Any]]] = (None, {})
        self._counts = True
        self._calls: tuple[Any, Callable[..., Any], Callable[..., Any]] = (None, self._run, write_record)
        self._compiled = self._warm = False
        self._started = False
        self._scene_digest = self._digest()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.step_index * self.step

    @property
    def scene(self) -> Scene:
        """What is simulated."""
        return self._scene

    @property
    def layout(self) -> Layout:
        """The packed scene, in its present state."""
        return self._layout

    def missing_units(self) -> list[Unit]:
        """What has to be compiled for this scene because it is not on disk: kinds that nobody has used yet."""
        layout = self._layout
        units = {
            unit.name: unit
            for table in (layout.bodies, layout.forces, layout.joints, layout.systems)
            for unit in table.units()
        }
        entries = [self._run, start_scene, write_record]
        if self.operation is not None:
            from heavylift.solver.scenario.sequencer import begin_scenario

            entries.append(begin_scenario)
        if self.inputs and self.integrator == "accurate":
            from heavylift.solver.integrate.accurate import begin_anew

            entries.append(begin_anew)
        units |= {entry.unit.name: entry.unit for entry in entries}
        missing = missing_units(list(units.values()))
        self._compiled = not missing
        return missing

    def warm_up(self) -> None:
        """Compile what is missing, load the rest, without changing the state."""
        if self._warm:
            return
        missing = [] if self._compiled else self.missing_units()
        if missing:
            compile_units(missing, lambda _name, _seconds: None)
        begin, found = clock.thread_time(), self.start_seconds
        self._start()
        records = np.empty((0, self.column_count))
        self._call(0, 0, 1, records)
        row = unwritten(self.column_count)
        self._write(row)
        check_written(row, self.channels)
        self.compile_seconds += clock.thread_time() - begin - (self.start_seconds - found)
        self._warm = True

    def _start(self) -> None:
        if self._started:
            return
        self._started = True
        layout = self._layout
        start_scene(layout.bodies, layout.work, 0.0)
        layout.work.control.next_step = FIRST_STEP * self.step if self.tolerance else self.step
        if layout.joints or self._start_mode in AT_REST:
            self._fit_joints()
        if self.integrator == "accurate":
            integration = layout.systems[-1]
            integration.take_start(layout.bodies, layout.systems)
            if integration.loops:
                self._choose_rows(integration)
            for forest in layout.systems[1:-1]:
                if len(forest.loops):
                    self._choose_rows(forest, np.unique(forest.bodies["block"]).tolist())
        if self._touches:
            from heavylift.solver.contact.check_start import start_contacts

            settled = self._start_mode in AT_REST
            if settled:
                self._settle_contacts()
                self._check_strains()
            start_contacts(layout, self.step, settled=settled)
        if layout.block_names and self.integrator == "dele2":
            self._probe()
        if self._start_mode in AT_REST:
            self._check_draughts()
        prepare_counts(layout)
        if layout.controllers is not None:
            from heavylift.solver.water.hulls.controllers import begin_controllers

            assert self._scene.sea is not None
            begin_controllers(layout.controllers, [one.name for one in self._scene.sea.controllers])
        self.inputs.begin()
        if self.operation is not None:
            self._begin_scenario(self.operation)

    def _check_draughts(self) -> None:
        """Hulls with databases lie at rest as these have them."""
        sea, layout = self._scene.sea, self._layout
        if sea is None or not sea.radiation:
            return
        from heavylift.solver.layout_sea import floating_hulls
        from heavylift.solver.water.hulls.database_fit import check_rest

        notes = check_rest(
            layout.bodies, layout.body_names, floating_hulls(self._scene), sea, self._scene.scenario
        )
        self._layout = replace(layout, notes=(*layout.notes, *notes))

    def _begin_scenario(self, operation: Operation) -> None:
        """Do what the first phase begins with; a phase that is over before it begins is a mistake."""
        from heavylift.solver.scenario.sequencer import begin_scenario

        layout = self._layout
        begin_scenario(
            operation.sequencer, layout.forces, layout.bodies, layout.joints, layout.systems, layout.work
        )
        operation.check_begun()

    def _fit_joints(self) -> None:
        """Bring the joints to a start that fits, and find out what they leave free."""
        from heavylift.solver.start.consistent_start import check_start, project_start
        from heavylift.solver.start.diagnosis import diagnose
        from heavylift.solver.start.rows import StartRows
        from heavylift.solver.statics.equilibrium import find_equilibrium

        rows = StartRows(self._layout)
        ways: dict[str, Any] = {
            "check": check_start,
            "project": project_start,
            "equilibrium": find_equilibrium,
            "relax": _relax,
        }
        begin = clock.thread_time()
        settles = self._touches and self._start_mode in AT_REST  # after contacts have been met

        def search() -> str:
            text: str = ways["project" if settles else self._start_mode](rows).text
            if self._fits_tensions and not settles:
                from heavylift.solver.statics.start_tensions import fit_start_tensions

                text = fit_start_tensions(rows, ways[self._start_mode], text)
            return text

        with compile_clock() as compiling:
            if self._start_mode in AT_REST and not settles:
                (self.start_text,) = self._known_start(rows, lambda: (search(),))
            else:
                self.start_text = search()
        if self._start_mode in AT_REST and not settles:
            self._check_strains()
        if any(kind.FLOATS for kind in self._layout.bodies):
            from heavylift.solver.water.hulls.packing import check_series

            check_series(self._layout.bodies)
        self.start_seconds += clock.thread_time() - begin - compiling.seconds
        if self._layout.joints:
            self.diagnosis = diagnose(rows)
            if self._stiff and not self.diagnosis.redundant:
                self._straighten()

    def _choose_rows(self, holder: Any, first: Sequence[int] = ()) -> None:
        """Leave rows of loops out that follow from others, if a choice is known; those of some blocks stay."""
        from heavylift.solver.start.independent_rows import independent_rows
        from heavylift.solver.start.rows import StartRows

        rows = StartRows(self._layout)
        kept = independent_rows(rows, first)
        if kept is not None:
            holder.keep_rows(rows.places, kept)

    def _known_start(
        self, rows: Any, search: Callable[[], tuple[str, ...]], *words: object
    ) -> tuple[str, ...]:
        """Bring the scene to rest by a search that sees the scene and some words, or as it was found to rest before."""
        if self._starts is None:
            return search()
        from heavylift.solver.start.kept import known_start

        seen = (self._start_mode, self._fits_tensions, self.integrator, self.step, self.tolerance, *words)
        return known_start(rows, self._starts, seen, search)

    def _check_strains(self) -> None:
        """Refuse ropes that are too short for where the scene has come to rest."""
        if self._scene.ropes:
            from heavylift.solver.force_elements.rope_packing import check_strains_at_rest
            from heavylift.solver.statics.forces import STEP
            from heavylift.solver.statics.rows_at_rest import fill_at_rest

            layout = self._layout
            fill_at_rest(
                layout.bodies, layout.forces, layout.joints, layout.systems, layout.work, self.time, STEP
            )
            check_strains_at_rest((*layout.joints, *layout.forces), layout.channels)

    def _settle_contacts(self) -> None:
        """Bring the scene to rest with what it touches."""
        from heavylift.solver.contact.check_start import keep_touching, restore, start_contacts
        from heavylift.solver.start.rows import StartRows
        from heavylift.solver.statics.contact_rest import ContactRest, settle_contacts
        from heavylift.solver.statics.stopped_drives import StoppedDrives

        records = np.empty((0, self.column_count))

        scene, layout = self._scene, self._layout

        def advance(step: float) -> str:
            layout.work.control.next_step = step
            with drives:
                done = self._run(
                    layout.bodies, layout.forces, layout.joints, layout.systems, layout.work,
                    step, 0.0, 0, 1, 2, records,
                )  # fmt: skip
            if done == 1:
                return ""
            message = stop_message(layout, "a step to rest")
            layout.work.status.words[:] = 0.0
            return message

        def meet() -> None:
            start_contacts(layout, self.step, settled=bool(self.start_text))

        def restored() -> None:
            restore(layout.systems[1])

        def touching() -> Callable[[], None]:
            return keep_touching(layout.systems[1])

        def search(rows: Any) -> ContactRest:
            found = settle_contacts(
                rows, self._arrays, advance, meet, restored, touching, weight, gravity, rubs=rubs
            )
            self._unsettled = found.warning
            return found

        begin = clock.thread_time()
        drives = StoppedDrives(layout.bodies, layout.joints)
        weight = max(self._weight(scene), SMALLEST_WEIGHT)
        rubs = any(pair.friction for pair in scene.contacts) or any(
            pair.friction for pair in scene.collisions
        )
        rows, self.start_text = StartRows(self._layout), ""

        def settle() -> tuple[str, ...]:
            self.start_text = search(rows).text
            if self._fits_tensions:
                from heavylift.solver.statics.start_tensions import FITTED_WITH_CONTACTS, fit_start_tensions

                self.start_text = fit_start_tensions(rows, search, self.start_text, FITTED_WITH_CONTACTS)
            return self.start_text, self._unsettled

        gravity = float(np.linalg.norm(scene.gravity))
        self.start_text, self._unsettled = self._known_start(rows, settle, weight, rubs, gravity)
        self.start_seconds += clock.thread_time() - begin

    def _straighten(self) -> None:
        """Take midpoints along straight lines.

        Stiff springs make accelerations that give no information on the next step: errors of the stiff governor are a
        quarter of those along arcs. Redundant loops need arcs, whose midpoints are nearer to the constraints.
        """
        for kind in self._layout.bodies:
            kind.straighten()

    def _probe(self) -> None:
        """Reactions at the start, and forces of what is in contact there, from one step that is taken back.

        Its accelerations are not kept: those of a stiff spring that is not at rest would mislead the first step. It is
        tiny, but with contacts: what keeps those without compliance closed is the impulse of a whole step, and a step
        with impacts tells no forces.
        """
        layout = self._layout
        before = {name: array.copy() for name, array in self._arrays()}
        length = max(PROBE_STEP * self.step, min(self.step, SMALLEST_PROBE))
        if self._touches:
            layout.work.control.next_step = self.step  # a whole one, also where steps of other lengths follow
        self._run(
            layout.bodies, layout.forces, layout.joints, layout.systems, layout.work,
            self.step if self._touches else length, 0.0, 0, 1, 2, np.empty((0, self.column_count)),
        )  # fmt: skip
        system = layout.systems[0]
        found = system.rows["last_reaction"].copy()
        good = layout.work.status.outcome == 0
        layout.work.status.words[:] = 0.0
        if self._touches:
            from heavylift.solver.contact.check_start import forget_trials, put_forces, resting_forces

            contacts = layout.systems[1]
            forces = resting_forces(contacts)
            for name, array in self._arrays():
                array[...] = before[name]
            forget_trials(layout)
            if good and forces is not None:
                put_forces(contacts, forces)
            else:
                good = False
        else:
            for name, array in self._arrays():
                array[...] = before[name]
        if good:
            if self.diagnosis is not None and self.diagnosis.redundant:
                from heavylift.solver.start.rows import StartRows
                from heavylift.solver.start.shared_reactions import share_reactions

                rows = StartRows(layout)
                flat = found.reshape(-1)
                flat[rows.places] = share_reactions(rows, flat[rows.places])
            system.rows["reaction"] = system.rows["last_reaction"] = found

    @property
    def solver_steps(self) -> int:
        """Steps that were taken, whatever `step_index` counts."""
        return int(self._layout.work.control.step_count)

    @property
    def sees_every_step(self) -> bool:
        """Whether channels of extremes hold every step; where forces act at instants only, they hold records."""
        return self.integrator == "dele2"

    def record(self) -> NDArray[np.float64]:
        """Record of the present state, shape (column_count,); no trace is left but by one of the run."""
        self.warm_up()
        row = np.empty(self.column_count)
        if self.step_index % self.record_every or self.step_index == self._recorded:
            arrays = self._arrays_in_use
            kept = [array.copy() for array in arrays]
            self._write(row)
            for array, before in zip(arrays, kept, strict=True):
                array[:] = before
            return row
        self._write(row)
        self._recorded = self.step_index
        if self._counts:  # whole turns, from record to record
            self._return.forget()
        return row

    def advance(self, steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Make a number of steps without returning to Python in between.

        Parameters
        ----------
        steps
            Fewer are made if the simulation stops by itself, see `outcome`, or is asked to, see `stop_asked`.

        Returns
        -------
        times
            Of the records [s], shape (rows,).
        records
            Shape (rows, column_count), one after every step whose index is divisible by `record_every`.
        """
        self.warm_up()
        first, last = self.step_index, self.step_index + steps
        every = self.record_every
        records = np.empty((last // every - first // every, self.column_count))
        if self.outcome is not Outcome.COMPLETED or self.ended or steps <= 0:
            return np.empty(0), records[:0]
        if not self._watch.begun:
            begun = self.record()[np.newaxis]
            self._watch.add(begun)
            if self._left_range(begun) >= 0:
                return np.empty(0), records[:0]
        heard = self.inputs.heard + (0 if self.operation is None else self.operation.heard)
        if heard != self._heard or self._return.is_due(self.cpu_seconds):
            self._return.take(self._arrays_in_use, first, self.cpu_seconds)
            self._heard = heard
        begin, done = clock.thread_time(), first
        while (last := self._last_possible(done, first + steps)) > done:
            rows = records[done // every - first // every :]
            done = int(self._call(done, last, every, rows, self.stop_asked))
            if done < last or last == first + steps or self._layout.work.status.outcome != 0:
                break
        self.cpu_seconds += clock.thread_time() - begin
        self.step_index = done
        status = int(self._layout.work.status.outcome)
        if self.operation is not None and status == int(self.operation.sequencer.state.outcome) != 0:
            self.outcome, self.message = self.operation.end  # behind a step that is good
            self.ended = self.outcome is Outcome.COMPLETED
            self._layout.work.status.words[:] = 0.0
        elif status != 0:
            self._stop()
            self._back_to(first, done, records)
        elif done == last < first + steps:  # as far as an input can drive what it drives
            self.outcome = Outcome.LIMIT_REACHED
            self.message = f"stopped at t = {self.time:.9g} s: {self.inputs.ends[1]}"
        if self.step_index % every == 0:
            self._recorded = self.step_index
        count = int(done) // every - first // every
        beyond = self._left_range(records[:count], first // every + 1)
        if beyond >= 0:
            count = beyond + 1
            self.ended = False
            self._back_to(first, (first // every + count) * every, records)
        self._watch.add(records[:count])
        if self._lone is not None:
            self._lone.add(records[:count])
        begin_row = first // every + 1
        times = np.arange(begin_row, begin_row + count, dtype=np.float64)
        if every > 1:
            times *= every
        times *= self.step
        return times, records[:count]

    def set_input(self, name: str, value: float, rate: float = 0.0, until: float = math.inf) -> None:
        """Set an input, from the present time on.

        It is ``value + rate (t - time)`` until a time, and held from there on. What it was set to is part of the state.

        Parameters
        ----------
        name
            Of `inputs`.
        value
            In its SI unit. Of an input that is a place or a length, which cannot jump: where it is.
        rate
            Its change [1/s].
        until
            When it is held [s]: the end of a step, if all steps have one length.

        Raises
        ------
        InputError
            If there is no such input, a number is not finite, lies or leads beyond the limits of the input, would make
            a place jump or run a rope out, `until` is not later or lies within a step, or the run has ended; then
            nothing is changed.

        Examples
        --------
        >>> from heavylift.solver.inputs.force import ForceInput
        >>> from heavylift.solver.scene.scene import RigidBody, Scene
        >>> body = RigidBody("load", mass=2.0, inertia=np.eye(3))
        >>> push = ForceInput(name="push", body="load", point=np.zeros(3))
        >>> simulation = Simulation(Scene((body,), inputs=(push,)), step=0.1)
        >>> simulation.set_input("push", 4.0)
        >>> _, records = simulation.advance(10)
        >>> simulation.inputs.value("push")
        (4.0, 0.0)
        """
        self.set_inputs([(name, value, rate, until)])

    def set_inputs(self, settings: Sequence[tuple[str, float, float, float]]) -> None:
        """Set several inputs from the present time on, all or none.

        Parameters
        ----------
        settings
            Name, value, rate, and when it is held, as of `set_input`.

        Raises
        ------
        InputError
            If one of them is not possible; then nothing is changed.
        """
        self.warm_up()
        if settings and (self.outcome is not Outcome.COMPLETED or self.ended):
            raise InputError(
                f"the run has ended at t = {self.time:.9g} s",
                source="inputs",
                key=str(settings[0][0]),
                expected="settings before its end",
            )
        if self.inputs.put(settings, self.time):
            self._layout.work.control.corner = 0
            if self._anew is not None:
                self._anew(self.time)

    def _last_possible(self, first: int, last: int) -> int:
        """Last step up to which inputs can drive what they drive, at a record."""
        if not self.inputs.ends[0] < last * self.step:
            return last
        self.inputs.refresh()  # a brake that has slipped gives more rope
        end, every = self.inputs.ends[0], self.record_every
        whole = math.floor(end / (self.step * every) * (1.0 + ROUNDING))
        return max(first, min(last, whole * every))

    def _left_range(self, records: NDArray[np.float64], number: int = 0) -> int:
        """Number of the record at which a body has left the range of its modes, with which the run ends; or -1.

        The first of the records is the one with a `number` of the run.
        """
        if self._range is None or not self._watch.finite:  # energies that are no numbers say enough
            return -1
        beyond = self._range.add(records)
        if beyond >= 0:
            when = f"t = {(number + beyond) * self.record_every * self.step:.9g} s"
            self.outcome, self.message = Outcome.MODES_LEFT, self._range.message(when)
        return beyond

    @property
    def _entries(self) -> tuple[Callable[..., Any], Callable[..., Any]]:
        """Steps and record of this scene, whose tables are looked at once."""
        layout = self._layout
        if self._calls[0] is not layout:
            scene = layout.bodies, layout.forces, layout.joints, layout.systems, layout.work
            if self.integrator == "accurate":
                from heavylift.solver.integrate.trees.forest import stepped

                scene = stepped(layout)
                self._counts = scene[3] is layout.systems or any(
                    words.size for kind in (*scene[1], *scene[2]) for _, words in carried_words(kind)
                )
            self._calls = layout, self._run.with_first(*scene), write_record.with_first(*scene)
            if self.inputs and self.integrator == "accurate":
                from heavylift.solver.integrate.accurate import begin_anew

                self._anew = begin_anew.with_first(*scene)
        return self._calls[1:]

    def _call(
        self,
        first: int,
        last: int,
        every: int,
        records: NDArray[np.float64],
        stop: Callable[[], object] = bool,
    ) -> int:
        """Last step that was completed, with its records; a call that has come back before goes on unless stopped."""
        status, done = self._layout.work.status, first
        while True:
            rows = records[done // every - first // every :]
            done = int(self._entries[0](self.step, self.tolerance, done, last, every, rows))
            if done == last or status.outcome != 0 or stop():
                return done

    def _write(self, row: NDArray[np.float64]) -> None:
        self._entries[1](self.time, row)

    def _stop(self) -> None:
        self.outcome = Outcome(int(self._layout.work.status.outcome))
        self.message = stop_message(self._layout, f"t = {self.time:.9g} s (step {self.step_index})")

    def _back_to(self, first: int, done: int, records: NDArray[np.float64]) -> None:
        """Repeat what was good: a step that fails at its end leaves no good state behind it."""
        at, every = self._return.index, self.record_every
        self._return.put_back(list(self._carried.values()))
        self._begin_again()
        if at < first:
            self._call(at, first, every, np.empty((first // every - at // every, self.column_count)))
        self._call(first, done, every, records)
        self._layout.work.status.words[:] = 0.0
        self.step_index = done

    @property
    def energy_drift(self) -> float:
        """Largest change of the energy balance over the energy turned over; not a number where records have none."""
        return self._watch.drift

    @property
    def periods(self) -> str:
        """Steps in the shortest periods that the scene is known to have, as a sentence; empty with steps that vary."""
        return period_words(self._layout, self._scene.sea)

    @property
    def verdict(self) -> tuple[Outcome, str]:
        """Whether the energy balance of a completed run is credible, and a message why not."""
        if not self._watch.begun:  # nothing but a start
            self._left_range(self.record()[np.newaxis])
        if self.outcome is Outcome.MODES_LEFT:
            return self.outcome, self.message
        outcome, message = self._watch.verdict
        if outcome is Outcome.COMPLETED and self.operation is not None and self.operation.unfinished:
            outcome = Outcome.PHASES_LEFT
            message = f"{outcome.text} at t = {self.time:.9g} s: {self.operation.unfinished}"
        return outcome, message

    @property
    def warning(self) -> str:
        """What the user should know of a run that went well otherwise; empty if nothing."""
        layout = self._layout
        seen = (force_warning, mesh_warning, hull_warning, contact_warning, drive_warning)
        steps = step_warning(layout, self._watch.floor)
        modes = "" if self._range is None or self._range.left else self._range.warning
        words = [
            self._unsettled,
            modes,
            self._watch.warning,
            steps,
            loop_warning(layout, self.tolerance),
            self._lone_extremes,
            *(look(layout) for look in seen),
        ]
        found = list(filter(None, words))
        if not found and self.integrator == "accurate":
            from heavylift.solver.integrate.integration import stiffness_seen

            if stiffness_seen(self._layout.systems[-1]):
                meshes = any(kind.NODAL for kind in self._layout.bodies)
                where = "faster where coarse results are enough" if meshes else "faster"
                found = [f"stability, not accuracy, limited the steps: integrator 'dele2' will be {where}"]
        return "; ".join([*found, *self._layout.notes])

    @property
    def _lone_extremes(self) -> str:
        """Of extremes that stand alone where a phase has ended; empty without."""
        if self._lone is None or self.operation is None:
            return ""
        times = (line.time for line in self.operation.log)
        return self._lone.warning(times, self.step, self.record_every, steps_vary=self.tolerance > 0.0)

    def state(self) -> dict[str, NDArray[Any]]:
        """Everything that a bitwise identical continuation needs: arrays by name, copied."""
        self._start()
        arrays = {name: array.copy() for name, (array, _) in self._in_use.items()}
        arrays["step_index"] = np.array(self.step_index, dtype=np.int64)
        arrays["cpu_seconds"] = np.array(self.cpu_seconds)
        arrays["watch"] = self._watch.state
        if self._range is not None:
            arrays["modal_range"] = self._range.state.copy()
        if self._lone is not None:
            arrays["extremes"] = self._lone.state
        arrays["scene"] = self._scene_digest.copy()
        return arrays

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Continue from what `state` returned.

        Raises
        ------
        InputError
            If the state belongs to another scene.
        """
        self._start()  # what is derived from the start state and not carried
        shapes = {name: array.shape for name, array in self._carried.items()}
        for name, (_, words) in self._in_use.items():
            length = np.size(state[name]) if words > 0 and name in state else -1
            if 0 <= length <= shapes[name][0] and length % words == 0:
                shapes[name] = (length,)  # the last rows were not in use
        own = self._scene_digest
        for name, shape in {
            **shapes,
            "step_index": (),
            "cpu_seconds": (),
            "watch": (STATE,),
            **({} if self._range is None else {"modal_range": self._range.state.shape}),
            **({} if self._lone is None else {"extremes": self._lone.state.shape}),
            "scene": own.shape,
        }.items():
            foreign = name == "scene" and name in state and not np.array_equal(state[name], own)
            if name not in state or np.shape(state[name]) != shape or foreign:
                raise InputError(
                    "the state does not fit this scene",
                    source="checkpoint",
                    key=name,
                    expected="the digest of these bodies" if foreign else f"an array of shape {shape}",
                )
        for name, array in self._carried.items():
            array[: len(state[name])] = state[name]
        self.step_index = int(state["step_index"])
        self.cpu_seconds = float(state["cpu_seconds"])
        self._watch.state = state["watch"]
        self._recorded = self.step_index if self._watch.begun else -1
        if self._range is not None:
            self._range.state = state["modal_range"].copy()
        if self._lone is not None:
            self._lone.state = state["extremes"]
        self.outcome, self.message = Outcome.COMPLETED, ""
        ended = self.operation is not None and int(self.operation.sequencer.state.outcome) < 0
        self.ended = ended and self.step_index % self.record_every == 0  # it continues to its next record
        self._started = True
        self.inputs.refresh()
        self._begin_again()
        self._return.take(self._arrays_in_use, self.step_index, self.cpu_seconds)

    def _begin_again(self) -> None:
        """Forget what belongs to a state that is there no more."""
        self._layout.work.status.words[:] = 0.0
        if self._touches:
            from heavylift.solver.contact.check_start import forget_trials

            forget_trials(self._layout)

    def _bodies(self) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Masses [kg] and lengths [m] of the bodies of each kind: reach of a frame, extension of a mesh."""
        for kind in self._layout.bodies:
            yield kind.lengths()

    def _size(self) -> float:
        """Length of the largest body [m]."""
        return max((float(length.max(initial=0.0)) for _, length in self._bodies()), default=0.0)

    def _weight(self, scene: Scene) -> float:
        """Weights of all bodies, each times its length [J]."""
        return float(np.linalg.norm(scene.gravity)) * sum(
            float(mass @ length) for mass, length in self._bodies()
        )

    def _digest(self) -> NDArray[np.uint8]:
        """Digest of what the bodies were packed into, and of names of inputs: equal shapes do not make equal bodies.

        Forces may change, but not the loads that belong to a frame or shell.
        """
        digest = hashlib.blake2b(digest_size=16)
        for kind in (*self._layout.bodies, *self._layout.joints, *self._layout.systems):
            for value in kind:
                if isinstance(value, np.ndarray | np.void):  # of numbers or records, or one record
                    digest.update(value.tobytes())
        for one in self._scene.inputs:  # whose settings are carried by number
            digest.update(f"{type(one).__name__} {one.name};".encode())
        return np.frombuffer(digest.digest(), dtype=np.uint8)

    @property
    def _carried(self) -> dict[str, NDArray[Any]]:
        """The same by name, found once."""
        if self._views[0] is not self._layout:
            self._views = self._layout, dict(self._arrays())
        return self._views[1]

    @property
    def _in_use(self) -> dict[str, tuple[NDArray[Any], int]]:
        """What of them is in use, and the words in a row of what there may be more of."""
        found = {name: (array, 0) for name, array in self._carried.items()}
        if self._touches:
            from heavylift.solver.contact.in_use import words_in_use

            found |= words_in_use(self._layout.systems[1], self._carried)
        return found

    @property
    def _arrays_in_use(self) -> list[NDArray[Any]]:
        """The arrays of these alone."""
        if not self._touches:
            return list(self._carried.values())
        return [array for array, _ in self._in_use.values()]

    def _arrays(self) -> Iterator[tuple[str, NDArray[Any]]]:
        """Arrays that the step writes, by kind and field."""
        layout = self._layout
        yield "control", layout.work.control.words
        for kind in (*layout.bodies, *layout.joints, *layout.systems, *layout.forces):
            for field, words in carried_words(kind):
                yield f"{type(kind).__name__}.{field}", words


def _check_positive(key: str, value: float, expected: str) -> None:
    if not (value > 0.0 and math.isfinite(value)):
        raise InputError(f"{key} {value!r}", source="simulation", key=key, expected=expected)


def _with_integration(scene: Scene, layout: Layout, module: Any) -> Layout:
    """The layout with what the accurate integrator carries among its systems, and with its trees before."""
    from heavylift.solver.integrate.trees.forest import make_forest

    forest = make_forest(scene, layout)
    trees = () if forest is None else (forest,)
    sizes = None if forest is None else (forest.velocities, forest.coordinates)
    own = module.make_integration(layout.bodies, layout.joints, layout.systems, layout.work, sizes)
    return replace(layout, systems=Systems((*layout.systems, *trees, own), layout.systems.groups))


def _relax(rows: Any) -> Any:
    """Equilibrium by a dissipative motion; imported when it is asked for."""
    from heavylift.solver.statics.mesh_statics import relax_to_equilibrium

    return relax_to_equilibrium(rows)
