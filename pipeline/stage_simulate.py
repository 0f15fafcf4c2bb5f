"""The simulate stage: reduced bodies to time histories, resumable at any moment."""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.advance import Advancer, stop_requests
from heavylift.pipeline.provenance import simulate_digest, source_digest, versions
from heavylift.pipeline.results import ChannelInfo, load_results, merge_segments
from heavylift.pipeline.segments import remove_segments
from heavylift.pipeline.stages import StageReport
from heavylift.pipeline.storage import StopError, read_json, write_json

if TYPE_CHECKING:
    from heavylift.pipeline.stages import Work

__all__ = ["CHANNEL_DESCRIPTIONS", "simulate_stage"]

CHANNEL_DESCRIPTIONS = {
    "position": "position in the world",
    "orientation": "unit quaternion from body to world axes, scalar first",
    "velocity": "velocity in world axes",
    "angular_velocity": "angular velocity in body axes",
    "modal_position": "coordinates of the mass-normalised mode shapes",
    "modal_velocity": "speeds of the mass-normalised mode shapes",
    "reaction_force": "force that holds or drives the frame",
    "reaction_moment": "moment that holds or drives the frame",
    "momentum.linear": "linear momentum, world axes",
    "momentum.angular": "angular momentum about the world origin, world axes",
    "energy.kinetic": "kinetic energy",
    "energy.elastic": "elastic energy",
    "energy.potential": "potential energy of gravity",
    "energy.external_work": "work of applied forces",
    "energy.drive_work": "work of driven frames",
    "energy.dissipated": "energy lost to damping",
    "energy.balance": "kinetic + elastic + potential - works + dissipated; constant in exact arithmetic",
}


def simulate_stage(work: Work) -> StageReport:
    """Integrate over the whole duration, going on from what an earlier run left if it fits."""
    folder, log = work.folder, work.log
    digest = simulate_digest(work.case)
    manifest = read_json(folder.manifest("simulate")) or {}
    forced = "simulate" in work.force
    if not forced and manifest.get("digest") == digest and manifest.get("finished"):
        if folder.results.is_file() and folder.results.stat().st_size == manifest["size"]:
            outcome = Outcome[manifest["outcome"].upper()]
            note = "" if outcome is Outcome.COMPLETED else f"; it ended: {manifest['message']}"
            log.say(f"simulate: unchanged, skipped{note}")
            return StageReport(
                "simulate",
                outcome,
                skipped=True,
                cpu_s=manifest["details"]["cpu_s"],
                message=manifest["message"],
                details=manifest["details"],
            )
        state = "damaged" if folder.results.is_file() else "missing"
        log.say(f"simulate: {folder.results} is {state}, simulated again")
    if forced:
        remove_segments(folder.segments)
    cut_off = bool(manifest) and not manifest.get("finished")
    return _simulate(work, digest, cut_off=cut_off)


def _simulate(work: Work, digest: str, *, cut_off: bool) -> StageReport:
    """Simulate; `cut_off` tells that an earlier run in this folder had begun and did not end."""
    from heavylift.pipeline.assemble_scene import assemble_scene
    from heavylift.solver.simulation import Simulation

    section, folder, log = work.case.simulate, work.folder, work.log
    assert section is not None
    scene = assemble_scene(work.case, folder)
    simulation = Simulation(scene, section.step, section.integrator, record_every=section.record_every)
    with contextlib.suppress(FileNotFoundError):
        folder.results.unlink()  # from here on it would belong to other inputs
    # before compiling, which may take long: a kill from here on leaves word that a run had begun
    _write_manifest(work, digest, "unfinished", "", finished=False, details={})
    simulation.warm_up()
    compile_s = simulation.compile_seconds
    advancer = Advancer(simulation, folder.segments, digest, section.step_count)
    done = advancer.resume()
    if done:
        log.say(f"simulate: resumed from the checkpoint at t = {done * section.step:.9g} s, step {done}")
    elif advancer.restart_reason or cut_off:
        forced = "--force" if "simulate" in work.force else "nothing had been written"
        log.say(f"simulate: restarted from t = 0: {advancer.restart_reason or forced}")
    try:
        with stop_requests() as stop, log.progress("simulate", section.step_count, done) as progress:
            outcome, message = advancer.run(stop, progress)
    except StopError as error:
        with contextlib.suppress(StopError):
            _write_manifest(work, digest, error.outcome.name.lower(), str(error), finished=False, details={})
        raise
    details: dict[str, Any] = {
        "outcome": outcome.name.lower(),
        "steps": simulation.step_index,
        "step_us": 1e6 * simulation.cpu_seconds / simulation.step_index if simulation.step_index else None,
        "cpu_s": simulation.cpu_seconds,
        "compile_s": compile_s,
        "energy_drift": None,
    }
    finished = outcome is not Outcome.INTERRUPTED
    if finished:
        _merge(work, advancer, digest, outcome, message)
    if simulation.step_index:
        drift = _energy_drift(work)
        details["energy_drift"] = drift if math.isfinite(drift) else None
    _write_manifest(work, digest, details["outcome"], message, finished=finished, details=details)
    if finished:
        remove_segments(folder.segments)
    log.say(f"simulate: {outcome.text}: {_words(details)}")
    return StageReport(
        "simulate", outcome, skipped=False, cpu_s=details["cpu_s"], message=message, details=details
    )


def _words(details: dict[str, Any]) -> str:
    """Numbers of a run for a person; those that mean nothing, as the speed of no step, are left out."""
    words = [f"{details['steps']} steps"]
    if details["step_us"] is not None:
        words.append(f"{details['step_us']:.2f} us a step")
    words += [f"{details['cpu_s']:.2f} s CPU", f"compile {details['compile_s']:.2f} s"]
    if details["energy_drift"] is not None:
        words.append(f"energy drift {details['energy_drift']:.1e}")
    return ", ".join(words)


def _merge(work: Work, advancer: Advancer, digest: str, outcome: Outcome, message: str) -> None:
    """Merge the segments into the result file."""
    channels = [
        ChannelInfo(c.name, c.unit, tuple(c.components), c.column) for c in advancer.simulation.channels
    ]
    section = work.case.simulate
    assert section is not None
    metadata = {
        "title": work.case.title,
        "case": work.case.name,
        "digest": digest,
        "outcome": outcome.name.lower(),
        "message": message,
        "integrator": section.integrator,
        "step": section.step,
        "output_interval": section.output_interval,
        "steps": advancer.simulation.step_index,
        "cpu_s": advancer.simulation.cpu_seconds,
        "sources": list(work.case.sources),
        "versions": versions("simulate"),
        "overrides": list(work.case.overrides),
    }
    merge_segments(work.folder.segments, work.folder.results, channels, CHANNEL_DESCRIPTIONS, metadata)


def _energy_drift(work: Work) -> float:
    from heavylift.pipeline.quantities import energy_drift

    return energy_drift(load_results(work.case, work.folder.root))


def _write_manifest(
    work: Work, digest: str, outcome: str, message: str, *, finished: bool, details: dict[str, Any]
) -> None:
    results = work.folder.results
    write_json(
        work.folder.manifest("simulate"),
        {
            "stage": "simulate",
            "outcome": outcome,
            "message": message,
            "finished": finished,
            "case": work.case.name,
            "overrides": work.case.overrides,
            "digest": digest,
            "sources_digest": source_digest("simulate"),
            "versions": versions("simulate"),
            "size": results.stat().st_size if finished else 0,
            "details": details,
        },
    )
