"""From a case to a simulation that can start: the scene, what it is integrated with, and what is certain to fail."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from heavylift.pipeline.case.places import in_case
from heavylift.pipeline.results.mesh_results import MeshShape, mesh_shape

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scenario.operation import Operation
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.simulation import Simulation

__all__ = ["PreparedRun", "compile_parts", "new_simulation", "prepare_run", "release"]


class PreparedRun(NamedTuple):
    """What a run needs before its first step.

    Attributes
    ----------
    scene
        Of the case.
    simulation
        At its start, nothing compiled yet.
    meshes
        Shapes of frames and shells.
    """

    scene: Scene
    simulation: Simulation
    meshes: list[MeshShape]


def prepare_run(case: Case, folder: OutputFolder, log: Log) -> PreparedRun:
    """Assemble the scene of a case, whose meshes and modes are in its folder, and refuse what is certain to fail.

    Raises
    ------
    InputError
        If the scene does not fit together, or its operation cannot be done.
    """
    from heavylift.pipeline.assemble.collisions import collision_notes
    from heavylift.pipeline.assemble.scene import assemble_scene
    from heavylift.solver.simulation import AT_REST

    section = case.simulate
    assert section is not None
    scene = assemble_scene(case, folder)
    if any(getattr(body, "stress", None) for body in case.bodies.values()):
        from heavylift.pipeline.checks.body_stress import check_stress_tables

        check_stress_tables(case, folder)
    for note in collision_notes(case):
        log.say(f"simulate: {note}")
    if case.databases and section.start not in AT_REST:  # an equilibrium tells it better
        from heavylift.pipeline.assemble.afloat import draught_notes

        for note in draught_notes(case, scene):
            log.say(f"simulate: NOTE: {note}")
    meshes = [mesh_shape(body) for body in scene.bodies if body.SHAPE]
    simulation = new_simulation(case, folder, scene)
    if simulation.operation is not None:
        _check_plan(case, scene, simulation.operation)
    return PreparedRun(scene, simulation, meshes)


def new_simulation(case: Case, folder: OutputFolder, scene: Scene) -> Simulation:
    """Simulation of the scene of a case, as its table [simulate] says."""
    from heavylift.solver.simulation import AT_REST, Simulation

    section = case.simulate
    assert section is not None
    options: dict[str, Any] = {"record_every": section.record_every}
    if section.solver_tolerance is not None:
        options["tolerance"] = section.solver_tolerance
    if section.start != "check":
        options["start"] = section.start
    if section.start in AT_REST:
        from heavylift.pipeline.results.kept_start import KeptStart

        options["starts"] = KeptStart(folder.start)
    with in_case(case):
        if case.fmus:
            from heavylift.pipeline.coupling.coupled import CoupledSimulation
            from heavylift.pipeline.coupling.fmus import read_fmus

            options["fmus"] = read_fmus(case)
            return CoupledSimulation(scene, section.solver_step, section.integrator, **options)
        return Simulation(scene, section.solver_step, section.integrator, **options)


def release(simulation: Simulation) -> None:
    """End what a simulation has beside itself: the processes of its FMUs."""
    close = getattr(simulation, "close", None)
    if close is not None:
        close()


def _check_plan(case: Case, scene: Scene, operation: Operation) -> None:
    """Refuse an operation that is certain to fail."""
    from heavylift.pipeline.assemble.operation_plan import check_hooks, check_plan, plan, routes_of, starts_of

    starts = starts_of(scene, operation)
    check_plan(case, plan(operation.scenario, starts, routes_of(scene, operation)), starts)
    check_hooks(case, scene)


def compile_parts(simulation: Simulation, log: Log) -> float:
    """Compile what no run before has, and say so; returns the CPU time of all processes [s]."""
    missing = simulation.missing_units()
    if not missing:
        return 0.0
    from heavylift.solver.compiling import compile_units

    names = ", ".join(
        sorted({unit.name.partition(".")[0] if unit.owner[2] else "the time loop" for unit in missing})
    )
    log.say(f"simulate: compiling {len(missing)} parts that are used for the first time: {names}")
    spent: list[float] = []
    with log.progress("compile", len(missing)) as progress:

        def tell(name: str, seconds: float) -> None:
            spent.append(seconds)
            progress(len(spent), name)

        compile_units(missing, tell)
    return sum(spent)
