"""The simulate stage: reduced bodies to time histories, resumable at any moment."""

from __future__ import annotations

import contextlib
import math
import shutil
from typing import TYPE_CHECKING, Any

from heavylift.numerics.memory import amount_of_bytes
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.results.histories import ChannelInfo, merge_segments, remove_segments
from heavylift.pipeline.results.mesh_results import save_meshes
from heavylift.pipeline.results.provenance import simulate_digest, source_digest, versions
from heavylift.pipeline.results.storage import StopError, read_json, stored, unchanged, write_json
from heavylift.pipeline.stages.advance import Advancer, stop_requests
from heavylift.pipeline.stages.operator_commands import OperatorCommands, words_there
from heavylift.pipeline.stages.work import StageReport

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.histories import Results, SegmentMark
    from heavylift.pipeline.results.mesh_results import MeshShape
    from heavylift.pipeline.stages.work import Work
    from heavylift.solver.scenario.operation import Operation
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.simulation import Simulation

__all__ = [
    "conclude",
    "diagnosis",
    "diagnosis_lines",
    "operation_log",
    "provenance",
    "simulate_stage",
    "steps_taken",
]

_SHOWN = 5  # sentences of a kind at most


def diagnosis(simulation: Any) -> dict[str, Any]:
    """Plain values for the manifest.

    Parameters
    ----------
    simulation
        A `heavylift.solver.simulation.Simulation`; its attributes ``integrator``, ``choice`` and ``diagnosis``
        are used as far as it has them.

    Returns
    -------
    dict
        ``integrator``, ``choice`` (why, if it was chosen), ``start`` (what was done to it), ``periods`` (steps in the
        shortest that are known), and of a scene
        with joints ``degrees_of_freedom``, ``redundant`` and ``free_motions`` (sentences that name joints).
    """
    found: dict[str, Any] = {
        "integrator": str(getattr(simulation, "integrator", "")),
        "choice": str(getattr(simulation, "choice", "") or ""),
        "start": str(getattr(simulation, "start_text", "") or ""),
        "periods": str(getattr(simulation, "periods", "") or ""),
    }
    about = getattr(simulation, "diagnosis", None)
    if about is not None:
        found |= {
            "degrees_of_freedom": int(about.degrees_of_freedom),
            "redundant": [str(text) for text in about.redundant],
            "free_motions": [str(text) for text in about.free_motions],
        }
    return found


def diagnosis_lines(found: Mapping[str, Any]) -> list[str]:
    """Lines for a person; none for a scene without joints whose integrator is the one asked for."""
    lines = [found[key] for key in ("choice", "start", "periods") if found.get(key)]
    if "degrees_of_freedom" in found:
        count = found["degrees_of_freedom"]
        words = [f"{count} degree{'' if count == 1 else 's'} of freedom"]
        if found["redundant"]:
            words.append(f"redundant: {_listed(found['redundant'])}")
        if found["free_motions"]:
            words.append(f"free: {_listed(found['free_motions'])}")
        lines.append("; ".join(words))
    return lines


def _listed(sentences: Sequence[str]) -> str:
    more = f" and {len(sentences) - _SHOWN} more" if len(sentences) > _SHOWN else ""
    return ", ".join(text.rstrip(".") for text in sentences[:_SHOWN]) + more


def operation_log(operation: Operation) -> dict[str, Any]:
    """Names of the phases, what happened, and what was heard, as plain values."""
    tones = [[line.time, line.tone] for line in operation.log if line.tone]
    found: dict[str, Any] = {
        "phases": [phase.name for phase in operation.scenario.all_phases],
        "first_track": len(operation.scenario.phases),
        "log": [[line.time, line.phase, line.event, line.what, line.value] for line in operation.log],
    }
    return found | {"tones": tones} if tones else found


def steps_taken(simulation: Any) -> int:
    """Steps the integrator made; with a tolerance more or fewer than it recorded states."""
    return int(getattr(simulation, "solver_steps", simulation.step_index))


def simulate_stage(work: Work) -> StageReport:
    """Integrate over the whole duration, continuing the results of an earlier run if they fit."""
    folder, log = work.folder, work.log
    digest = simulate_digest(work.case)
    manifest = read_json(folder.manifest("simulate")) or {}
    forced = "simulate" in work.force
    driven = manifest.get("digest") != digest and _driven(manifest) == digest
    current = driven or manifest.get("digest") == digest
    if not forced and current and manifest.get("finished") and _says_all(manifest):
        if unchanged(folder.results, manifest):
            remove_segments(folder.segments)  # of a run that was killed when all was done
            outcome = Outcome[manifest["outcome"].upper()]
            note = "" if outcome is Outcome.COMPLETED else f"; it ended: {manifest['message']}"
            if driven:
                note += "; its inputs were driven from outside, --force simulates it without"
            log.say(f"simulate: unchanged, skipped{note}")
            if manifest["details"].get("warning"):
                log.say(f"simulate: WARNING: {manifest['details']['warning']}")
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
        OperatorCommands.forget(folder.root)
    cut_off = bool(manifest) and not manifest.get("finished")
    return _simulate(work, digest, cut_off=cut_off)


def provenance(scene: Scene, simulation: Simulation, log: Log) -> dict[str, Any]:
    """What the manifest says of a run before it begins: diagnosis, sea, and where transporters tip over."""
    about = diagnosis(simulation)
    if scene.sea is not None:
        from heavylift.pipeline.assemble.sea import sea_provenance

        sea = sea_provenance(scene.sea)
        about |= {"sea": sea} if sea else {}
    if scene.transporters:
        about |= {"tipping": _tipping(scene, log)}
    return about


def _tipping(scene: Any, log: Log) -> dict[str, dict[str, float]]:
    """Tilts at which transporters tip over [rad], reported before they move."""
    from heavylift.solver.transport.packing import vehicle_tipping

    found = vehicle_tipping(scene)
    for name, angles in found.items():
        log.say(
            f"simulate: {name} tips over at {math.degrees(angles.static):.4g} degrees on rigid groups, at "
            f"{math.degrees(angles.compliant):.4g} degrees of the road on compliant groups"
        )
    return {name: angles._asdict() for name, angles in found.items()}


def _driven(manifest: Mapping[str, Any]) -> str:
    """Digest of the case of a run whose inputs were driven from outside; empty of another one."""
    details = manifest.get("details")
    return str(details.get("driven", "")) if isinstance(details, dict) else ""


def _says_all(manifest: Mapping[str, Any]) -> bool:
    """Whether the manifest of a run that has ended tells how."""
    details, outcome = manifest.get("details"), manifest.get("outcome")
    return (
        isinstance(details, dict)
        and isinstance(details.get("cpu_s"), (int, float))
        and isinstance(manifest.get("size"), int)
        and isinstance(manifest.get("message"), str)
        and isinstance(outcome, str)
        and outcome.upper() in Outcome.__members__
    )


def _simulate(work: Work, digest: str, *, cut_off: bool) -> StageReport:
    """Simulate; `cut_off` tells that an earlier run in this folder had begun and did not end."""
    from heavylift.pipeline.case.places import in_case
    from heavylift.pipeline.stages.prepared import compile_parts, prepare_run, release

    section, folder, log = work.case.simulate, work.folder, work.log
    assert section is not None
    old_words = words_there(folder.root)
    scene, simulation, meshes = prepare_run(work.case, folder, log)
    _refuse_beyond_disk(work, simulation)
    with contextlib.suppress(FileNotFoundError):
        folder.results.unlink()  # from here on it would belong to other inputs
    save_meshes(folder.meshes, meshes)
    # before compiling, which may take long: a kill from here on leaves word that a run had begun
    _write_manifest(work, digest, "unfinished", "", finished=False, details={})
    compile_s = compile_parts(simulation, log)
    with in_case(work.case):
        simulation.warm_up()
    compile_s += simulation.compile_seconds
    about = provenance(scene, simulation, log)
    for line in diagnosis_lines(about):
        log.say(f"simulate: {line}")
    # of the simulation, not of the case: an integrator that was chosen may take its steps itself
    count = section.interval_count * simulation.record_every
    adaptive = section.step is None or simulation.integrator == "accurate"
    advancer = Advancer(simulation, folder.segments, digest, count, adaptive=adaptive)
    advancer.begins_again = getattr(simulation, "not_kept", "")
    done = advancer.resume()
    if done:
        where = "record" if adaptive else "step"
        reached = done * simulation.step
        log.say(f"simulate: resumed from the checkpoint at t = {reached:.9g} s, {where} {done}")
        if advancer.loss:
            log.say(f"simulate: WARNING: {advancer.loss}: something else has changed the files of the run")
    elif advancer.restart_reason or cut_off:
        forced = "--force" if "simulate" in work.force else "nothing had been written"
        log.say(f"simulate: restarted from t = 0: {advancer.restart_reason or forced}")
    if simulation.operation is not None:
        advancer.commands = OperatorCommands(folder.root, digest, simulation.operation, old_words)
    try:
        with stop_requests() as stop, log.progress("simulate", count, done) as progress:
            outcome, message = advancer.run(stop, progress)
        return conclude(
            work, simulation, advancer.segments, digest, outcome, message, about, meshes, compile_s
        )
    except StopError as error:
        with contextlib.suppress(StopError):
            _write_manifest(work, digest, error.outcome.name.lower(), str(error), finished=False, details={})
        raise
    finally:
        release(simulation)


def conclude(
    work: Work,
    simulation: Simulation,
    segments: Sequence[SegmentMark],
    digest: str,
    outcome: Outcome,
    message: str,
    about: dict[str, Any],
    meshes: list[MeshShape],
    compile_s: float,
) -> StageReport:
    """End a run whose segments are on disk: merge them unless it was interrupted, and say in the manifest how it ended.

    Parameters
    ----------
    work
        Case, folder and log.
    simulation
        That has run.
    segments, digest
        Its segments, and the digest of its inputs.
    outcome, message
        How its steps ended.
    about
        What the manifest is to say beside, see `diagnosis`; completed here.
    meshes
        Shapes of frames and shells.
    compile_s
        CPU time of compiling [s].

    Raises
    ------
    StopError
        If the disk is full.
    """
    folder, log = work.folder, work.log
    if outcome is Outcome.COMPLETED:
        outcome, message = simulation.verdict
    about["warning"] = simulation.warning
    if simulation.operation is not None:
        about |= {"scenario": operation_log(simulation.operation)}
    finished = outcome is not Outcome.INTERRUPTED
    if finished:
        results = _merge(work, simulation, segments, digest, outcome, message, about, meshes)
    for event in simulation.operation.log if simulation.operation is not None else ():
        log.say(f"simulate: {event.text}")
    steps = steps_taken(simulation)
    drift = simulation.energy_drift if simulation.step_index else math.nan
    details: dict[str, Any] = {
        "outcome": outcome.name.lower(),
        "steps": steps,
        "step_us": 1e6 * simulation.cpu_seconds / steps if steps else None,
        "cpu_s": simulation.start_seconds + simulation.cpu_seconds,
        "start_s": simulation.start_seconds,
        "compile_s": compile_s,
        "energy_drift": drift if math.isfinite(drift) else None,
        **about,
    }
    if finished:
        from heavylift.pipeline.checks.hanging import hanging_warnings

        hanging = hanging_warnings(work.case, results)
        details["warning"] = "; ".join(filter(None, (about["warning"], *hanging)))
    _write_manifest(work, digest, details["outcome"], message, finished=finished, details=details)
    if finished:
        remove_segments(folder.segments)
    log.say(f"simulate: {outcome.text}: {_words(details)}")
    if details["warning"]:
        log.say(f"simulate: WARNING: {details['warning']}")
    return StageReport(
        "simulate", outcome, skipped=False, cpu_s=details["cpu_s"], message=message, details=details
    )


def _refuse_beyond_disk(work: Work, simulation: Simulation) -> None:
    """Refuse histories that the disk cannot hold: segments while they grow, and the file that they are merged into."""
    section = work.case.simulate
    assert section is not None
    records = section.interval_count + 1
    width = 1 + sum(len(channel.components) for channel in simulation.channels)
    needed, free = 2.0 * 8.0 * records * width, shutil.disk_usage(work.folder.root).free
    if needed <= free:
        return
    raise InputError(
        f"{records:,} records of {width:,} numbers, {amount_of_bytes(needed)} while they are written",
        source=work.case.file,
        key="simulate.output_interval",
        expected=f"a longer interval or a shorter duration: {amount_of_bytes(free)} of {work.folder.root} are free",
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


def _merge(
    work: Work,
    simulation: Simulation,
    segments: Sequence[SegmentMark],
    digest: str,
    outcome: Outcome,
    message: str,
    about: dict[str, Any],
    meshes: list[MeshShape],
) -> Results:
    """Merge the segments into the result file."""
    channels = [ChannelInfo(c.name, c.unit, tuple(c.components), c.column) for c in simulation.channels]
    section = work.case.simulate
    assert section is not None
    metadata = {
        "title": work.case.title,
        "case": work.case.name,
        "digest": digest,
        "outcome": outcome.name.lower(),
        "message": message,
        "step": simulation.step,
        "tolerance": section.solver_tolerance or 0.0,
        "output_interval": section.output_interval,
        "steps": steps_taken(simulation),
        "sees_every_step": bool(getattr(simulation, "sees_every_step", False)),
        "energy_drift": simulation.energy_drift,
        **about,
        "cpu_s": simulation.start_seconds + simulation.cpu_seconds,
        "start_s": simulation.start_seconds,
        "sources": list(work.case.sources),
        "versions": versions("simulate"),
        "overrides": list(work.case.overrides),
    }
    return merge_segments(
        work.folder.segments,
        work.folder.results,
        channels,
        {channel.name: channel.sentence for channel in simulation.channels},
        metadata,
        meshes,
        expected=segments,
    )


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
            **(stored(results) if finished else {}),
            "details": details,
        },
    )
