"""Sections of a report on the simulation: how the run ended, time histories, spectra, where it all came from."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.checks.deviation import deviation_history
from heavylift.pipeline.checks.quantities import energy_drift
from heavylift.pipeline.pictures.plots import Series, constant_parts, energy_plot, history_plot, spectrum_plot
from heavylift.pipeline.report.document import Facts, Figure, Section, Table, Text
from heavylift.pipeline.report.inputs import integration_words
from heavylift.pipeline.report.operation import phase_bands
from heavylift.pipeline.results.histories import Results, load_results
from heavylift.pipeline.results.signals import scaled_unit
from heavylift.pipeline.results.storage import read_json

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["history_section", "load_finite_results", "provenance_section", "run_ending", "run_section"]

_SENTENCES = 10  # of a diagnosis at most
_STAGES = ("mesh", "modes", "simulate")
_CURVES = 6  # modal coordinates in one plot at most
_MANY = 16  # components of other channels; of more, the smallest and the largest are drawn
_PLOTS = 8  # histories chosen at most
_SAMPLES = 16  # fewest samples of a spectrum
_EXCITED = 1.0e-4  # amplitude of a mode that counts as excited, relative to the largest of its body
_FAST = ("modal_position", "modal_velocity")


def load_finite_results(case: Case, folder: Path) -> tuple[Results | None, str]:
    """Time histories of a case, cut off before the first value that is not finite; and what is wrong with them."""
    if case.simulate is None:
        return None, ""
    try:
        results = load_results(case, folder)
        if not len(results.time):
            return results, "No time histories: the run ended before its first record."
        finite = np.isfinite(results.time)
        unknown = {f"{name}.{kind}" for name in case.collided for kind in ("gap", "gap_min")}
        for name in results:
            if name in unknown:  # no number where nobody asked for it
                continue
            finite &= np.isfinite(results[name].reshape(len(results.time), -1)).all(axis=1)
    except InputError as error:
        return None, f"No time histories: {error}"
    if finite.all():
        return results, ""
    count = int(np.argmin(finite))
    channels = {name: results.channel(name) for name in results}
    columns = {name: results[name].reshape(len(results.time), -1)[:count] for name in results}
    message = f"Values are not finite from t = {results.time[count]:.6g} s on; what is shown ends before."
    if not count:
        return None, message
    cut = Results(
        results.source, results.time[:count], channels, columns, results.metadata, results.mesh_file
    )
    return cut, message


def run_ending(stages: OutputFolder, results: Results | None) -> tuple[Outcome | None, str]:
    """How the simulation ended and its message; no outcome if it has not run."""
    manifest = read_json(stages.manifest("simulate"))
    known = manifest if isinstance(manifest, dict) else {}
    if results is not None and results.metadata.get("outcome"):
        known = results.metadata
    if known.get("outcome") == "unfinished":
        return Outcome.INTERRUPTED, "The run was interrupted or still continues"
    try:
        return Outcome[str(known.get("outcome", "")).upper()], str(known.get("message") or "")
    except KeyError:
        return None, ""


def run_section(case: Case, stages: OutputFolder, results: Results | None) -> list[Section]:
    """How the simulation ended, and what it cost."""
    if case.simulate is None:
        return []
    manifest = _flat(read_json(stages.manifest("simulate")) or {})
    known: dict[str, Any] = {**manifest, **(_flat(results.metadata) if results is not None else {})}
    if not known:
        return []
    rows = [("outcome", " ".join(str(known[key]) for key in ("outcome", "message") if known.get(key)))]
    statics = case.simulate.duration == 0.0
    if not statics:
        rows.append(("integrator", integration_words(case.simulate)))
    rows += _diagnosis_rows(known)
    if results is not None and len(results.time) and not statics:
        rows.append(
            ("simulated time", f"{_with_unit(float(results.time[-1]), 's')}, {len(results.time)} records")
        )
    for label, keys, words in (
        ("steps", ("steps", "step_count", "step_index"), "{:.0f}"),
        ("CPU time", ("cpu_s", "cpu_seconds"), "{:.3g} s"),
        ("CPU time of the start", ("start_s",), "{:.3g} s"),
        ("CPU time of one step", ("step_us",), "{:.3g} µs"),
        ("compile time", ("compile_s", "compile_seconds"), "{:.3g} s"),
    ):
        value = next((known[key] for key in keys if isinstance(known.get(key), (int, float))), None)
        if (
            value is not None
            and math.isfinite(value)
            and not ((statics or "start_s" in keys) and value == 0.0)
        ):
            rows.append((label, words.format(value)))
    if results is not None and len(results.time) > 1 and "energy.balance" in results:
        rows.append(("largest drift of the energy balance", f"{energy_drift(results):.2e}, relative"))
    return [Section("Simulation", (Facts(tuple(row for row in rows if row[1])),))]


def _diagnosis_rows(known: dict[str, Any]) -> list[tuple[str, str]]:
    """What the solver found about the scene: chosen integrator, degrees of freedom, redundant joints, free motions."""
    rows = [(key, str(known.get(key) or "")) for key in ("choice", "start")]
    rows.append(("steps in a period", str(known.get("periods") or "").removeprefix("steps in a period: ")))
    for label, key in (
        ("degrees of freedom", "degrees_of_freedom"),
        ("redundant joints", "redundant"),
        ("free motions", "free_motions"),
    ):
        value = known.get(key)
        if isinstance(value, str) and value.startswith("["):  # a list, as attributes of a result file hold it
            value = json.loads(value)
        if isinstance(value, list):
            more = [f"{len(value) - _SENTENCES} more"] if len(value) > _SENTENCES else []
            value = "; ".join([*(str(text) for text in value[:_SENTENCES]), *more])
        rows.append((label, "" if value is None else str(value)))
    return rows


def history_section(case: Case, stages: OutputFolder, results: Results | None, album: Album) -> list[Section]:
    """Plots of time histories and spectra."""
    if results is None or len(results.time) < 2:
        return []
    items: list[Figure | Text] = []
    energies = {name.partition(".")[2]: results[name] for name in results if name.startswith("energy.")}
    if energies:
        content = energy_plot(results.time, energies)
        caption = (
            "Energies, and the drift of their balance relative to the largest kinetic plus elastic energy, or the "
            "largest of all if both are zero."
        )
        subtracted = [
            f"{name.replace('_', ' ')} {_with_unit(v, 'J')}" for name, v in constant_parts(energies).items()
        ]
        if subtracted:
            caption += f" What does not change is subtracted: {', '.join(subtracted)}."
        items.append(Figure(album.add("energy", content), caption))
    wanted = case.report.channels or _chosen_channels(case, results)
    spectra = case.report.spectra or tuple(name for name in results if name.endswith(".modal_position"))
    items += [
        Text(f"Channel {name!r} is not recorded; the case requests its plot.", warning=True)
        for name in dict.fromkeys((*wanted, *spectra))
        if name not in results
    ]
    items += [_history_figure(results, name, album) for name in wanted if name in results]
    items += _deviation_items(case, results, album)
    fast = {name: _unresolved(results, name, stages) for name in case.bodies}
    items += [
        Text(_alias_words(name, *modes, _nyquist(results)), warning=bool(modes[1]))
        for name, modes in fast.items()
        if modes[0]
    ]
    for name in (name for name in spectra if name in results):
        figure = _spectrum_figure(case, results, name, stages, fast, album)
        if figure is not None:
            items.append(figure)
    return [Section("Time histories", tuple(items))] if items else []


def provenance_section(case: Case, stages: OutputFolder) -> list[Section]:
    """Digests of the inputs and versions of what computed the results, stage by stage."""
    rows: list[tuple[str, ...]] = []
    for stage in _STAGES:
        manifest = read_json(stages.manifest(stage))
        if not isinstance(manifest, dict):
            rows.append((stage, "not run", "", "", ""))
            continue
        versions = ", ".join(f"{key} {value}" for key, value in (_find(manifest, "versions") or {}).items())
        for name, part in _parts(manifest):
            outcome = str(part.get("outcome", manifest.get("outcome", "")))
            cpu = _find(part, "cpu_s")
            seconds = f"{cpu:.3g} s" if isinstance(cpu, (int, float)) else ""
            rows.append(
                (f"{stage} {name}".strip(), outcome, seconds, str(_find(part, "digest") or ""), versions)
            )
    items: list[Facts | Table] = [
        Table(("stage", "outcome", "CPU time", "digest of its inputs", "versions"), tuple(rows))
    ]
    facts = [("source", text) for text in case.sources]
    if facts:
        items.insert(0, Facts(tuple(facts)))
    return [Section("Provenance", tuple(items))]


def _parts(manifest: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Entries of a manifest by body, or the manifest itself."""
    parts = manifest.get("items")
    if isinstance(parts, dict) and parts:
        return [(str(name), part if isinstance(part, dict) else {}) for name, part in parts.items()]
    return [("", manifest)]


def _find(document: dict[str, Any], key: str) -> Any:
    """First value of a key, in the document or in the tables in it."""
    if key in document:
        return document[key]
    for value in document.values():
        if isinstance(value, dict):
            found = _find(value, key)
            if found is not None:
                return found
    return None


def _flat(document: dict[str, Any]) -> dict[str, Any]:
    """Plain values of a document and of the tables in it; the outermost wins."""
    flat: dict[str, Any] = {}
    for value in document.values():
        if isinstance(value, dict):
            flat = {**_flat(value), **flat}
    plain = (str, int, float, list)
    return {**flat, **{key: value for key, value in document.items() if isinstance(value, plain)}}


def _with_unit(value: float, unit: str) -> str:
    scaled = scaled_unit(unit, [np.array([value])])
    return f"{value / scaled.divisor:.6g} {scaled.text}"


def _chosen_channels(case: Case, results: Results) -> tuple[str, ...]:
    """Modal coordinates, sensors, vehicles, waves, ropes, lines, what joints do, motion of bodies, reactions of others.

    With joints, bodies are shown by their sensors, if there are any, and by how well the joints are closed.
    """
    owners = [f"{sensor.name}.position" for sensor in case.sensors]
    owners += [f"{row.name}.{kind}" for row in case.transporters for kind in ("roll", "pitch", "wheel_load")]
    modal = [f"{name}.modal_position" for name in case.bodies]
    owners = [*owners, *modal] if case.joints or case.ropes else [*modal, *owners]
    owners += [f"{name}.wave_elevation" for name in list(case.hulls)[:1]]
    owners += [f"{row.name}.tension" for row in (*case.ropes, *case.lines)]
    owners += [
        f"{joint.name}.{kind}"
        for joint in case.joints
        if getattr(joint, "drive", None) is not None
        for kind in ("angle", "travel")
    ]
    owners += [
        f"{name}.{kind}" for name in case.meshes for kind in ("axial_stress", "von_mises", "strain_drift")
    ]
    if not (case.joints and case.sensors):
        for name in (name for name in case.bodies if name not in case.meshes):
            owners += [f"{name}.{kind}" for kind in ("position", "angular_velocity", "reaction_force")]
    chosen = [name for name in owners if name in results and np.any(np.ptp(results[name], axis=0))]
    monitor = ["monitor.violation"] if case.joints and "monitor.violation" in results else []
    return (*chosen[: _PLOTS - len(monitor)], *monitor)


def _deviation_items(case: Case, results: Results, album: Album) -> list[Figure | Text]:
    """Plots of the distances from reference histories."""
    items: list[Figure | Text] = []
    for reference in case.reference:
        try:
            times, distances = deviation_history(case, reference, results)
        except InputError as error:
            items.append(Text(f"No deviation {reference.name!r}: {error}", warning=True))
            continue
        unit = "" if reference.scale else results.unit(reference.channel)
        title = f"{reference.channel}: deviation from {reference.file}"
        curve = Series(reference.name, distances)
        content = history_plot(times, [curve], title=title, unit=unit)
        largest = f"{distances.max():.3g} {unit}".strip()
        caption = (
            f"Distance of {reference.channel} from the reference {reference.file}; the largest is {largest}."
        )
        items.append(Figure(album.add(f"deviation_{reference.name}", content), caption))
    return items


def _curves(results: Results, name: str) -> list[Series]:
    """Components of a channel; of modal coordinates the largest few, in their order; of very many their range."""
    history = results[name].reshape(len(results.time), -1)
    components = results.components(name)
    chosen: NDArray[np.int64] = np.arange(history.shape[1])
    modal = ".modal_" in name
    if modal:
        largest = np.abs(history).max(axis=0)
        chosen = np.flatnonzero(largest > 1.0e-9 * largest.max())  # the others are at rest, but for rounding
    if not modal and len(components) > _MANY:
        return [Series("smallest", history.min(axis=1)), Series("largest", history.max(axis=1))]
    if modal and len(chosen) > _CURVES:
        chosen = np.sort(np.argsort(-largest, kind="stable")[:_CURVES])
    words = "mode {}" if modal else "{}"
    return [
        Series(words.format(components[column]) if components[column] else name, history[:, column])
        for column in chosen
    ]


def _history_figure(results: Results, name: str, album: Album) -> Figure:
    curves = _curves(results, name)
    unit = results.unit(name)
    ranges = [float(np.ptp(curve.values)) for curve in curves]
    together = np.ptp(np.concatenate([curve.values for curve in curves]))
    # curves that differ much in size or in level hide each other's detail in one system of axes
    stacked = len(curves) > 1 and ("modal_" in name or max(ranges) < 0.2 * together)
    bands = phase_bands(results)
    content = history_plot(results.time, curves, title=_words(name), unit=unit, stacked=stacked, bands=bands)
    return Figure(album.add(f"history_{name}", content), f"{_words(name)} over time.")


def _nyquist(results: Results) -> float:
    """Half the rate of the records [Hz]; faster oscillations appear at false frequencies."""
    return 0.5 / float(np.diff(results.time).mean())


def _unresolved(results: Results, body: str, stages: OutputFolder) -> tuple[dict[str, float], list[str]]:
    """Modes of a body that are too fast for the records, with their frequencies [Hz]; and which are excited."""
    limit = _nyquist(results)
    fast = {mode: f for mode, f in _reduced_frequencies(stages, body).items() if f > limit}
    channel = f"{body}.modal_position"
    if not fast or channel not in results:
        return fast, []
    ranges = np.ptp(results[channel].reshape(len(results.time), -1), axis=0)
    size = dict(zip(results.components(channel), ranges, strict=True))
    return fast, [mode for mode in fast if size.get(mode, 0.0) > _EXCITED * ranges.max(initial=0.0)]


def _alias_words(body: str, fast: dict[str, float], excited: list[str], limit: float) -> str:
    """Warning on natural frequencies above half the rate of the records."""
    count, lowest = len(fast), min(fast.values())
    text = (
        f"{body}: {count} natural {'frequencies exceed' if count > 1 else 'frequency exceeds'} "
        f"{_with_unit(limit, 'Hz')}, half the rate of the records (1/(2 output_interval)); the lowest is "
        f"{_with_unit(lowest, 'Hz')}."
    )
    if not excited:
        return f"{text} None of these modes is excited."
    shown = ", ".join(excited[:10]) + (f" and {len(excited) - 10} more" if len(excited) > 10 else "")
    return (
        f"{text} Of these, {'modes' if len(excited) > 1 else 'mode'} {shown} "
        f"{'are' if len(excited) > 1 else 'is'} excited: histories and spectra show them at false, lower "
        "frequencies (aliasing). A shorter output_interval resolves them."
    )


def _aliased_curves(
    case: Case,
    name: str,
    curves: list[Series],
    fast: dict[str, tuple[dict[str, float], list[str]]],
) -> list[Series]:
    """Curves of a channel, those marked that oscillate faster than the records resolve.

    A modal coordinate is marked if its own frequency is too high; any other quantity contains all modes that
    are excited in its body, or in any body if it belongs to none.
    """
    owner, _, kind = name.partition(".")
    if owner in fast and kind in _FAST:
        return [c._replace(aliased=c.label.removeprefix("mode ") in fast[owner][0]) for c in curves]
    owners = {sensor.name: sensor.body for sensor in case.sensors}
    body = owners.get(owner, owner)
    bodies = [body] if body in case.bodies else list(fast)
    aliased = any(fast[b][1] for b in bodies if b in fast)
    return [c._replace(aliased=aliased) for c in curves]


def _spectrum_figure(
    case: Case,
    results: Results,
    name: str,
    stages: OutputFolder,
    fast: dict[str, tuple[dict[str, float], list[str]]],
    album: Album,
) -> Figure | None:
    interval = float(np.diff(results.time).mean())
    curves = [curve for curve in _curves(results, name) if np.ptp(curve.values) > 0.0]
    if not curves or len(results.time) < _SAMPLES:
        return None
    curves = _aliased_curves(case, name, curves, fast)
    lines = _reduced_frequencies(stages, name.partition(".")[0])
    owner, _, kind = _words(name).partition(": ")
    title = f"{owner}: amplitude spectrum of {kind}" if kind else f"{owner}: amplitude spectrum"
    content = spectrum_plot(interval, curves, title=title, unit=results.unit(name), lines=lines)
    caption = f"Amplitude spectrum of {_words(name)} (Hann window)."
    aliased = [curve.label for curve in curves if curve.aliased]
    if aliased:
        which = "all curves" if len(aliased) == len(curves) else ", ".join(aliased)
        caption += (
            f" Aliased: {which}; natural frequencies above {_with_unit(_nyquist(results), 'Hz')}, half the rate "
            "of the records, appear at false frequencies and are not labelled."
        )
    if lines:
        caption += " Dashed: natural frequencies of the reduced body, by number."
    return Figure(album.add(f"spectrum_{name}", content), caption)


def _reduced_frequencies(stages: OutputFolder, body: str) -> dict[str, float]:
    from heavylift.pipeline.results.model_io import open_hdf5

    try:
        with open_hdf5(stages.reduced(body), "") as file:
            eigenvalues = file["eigenvalues"][:]
    except (InputError, KeyError):
        return {}
    frequencies: Sequence[float] = np.sqrt(np.maximum(eigenvalues, 0.0)) / (2.0 * np.pi)
    return {str(number): float(value) for number, value in enumerate(frequencies, start=1)}


def _words(name: str) -> str:
    if "(" in name:  # a combination of channels
        return name
    owner, _, kind = name.partition(".")
    return (
        f"{owner}: {kind.replace('_', ' ').replace('modal position', 'modal coordinates')}" if kind else owner
    )
