"""From the sea of a case to what the solver integrates: water, waves, wind and current, hulls, loads."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from heavylift.pipeline.assemble.described import assemble, assemble_list
from heavylift.pipeline.assemble.lines import assemble_lines
from heavylift.pipeline.assemble.water import has_sea, water_of
from heavylift.pipeline.case.places import located
from heavylift.solver.scene import sea as seas

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene.wind_loads import (
        CurrentField,
        FluctuationRecord,
        WindField,
    )
    from heavylift.solver.water.waves.wave_trains import WaveTrains

__all__ = ["assemble_sea", "make_waves", "sea_provenance"]


def assemble_sea(case: Case, sides: Mapping[str, Side], folder: OutputFolder) -> seas.Sea | None:
    """Sea of a case, or None if it has none.

    Parameters
    ----------
    case
        The case.
    sides
        Where its bodies are at the start, by name.
    folder
        Output folder: surfaces and databases that the mesh stage has stored are read, if they are of the same inputs.

    Raises
    ------
    InputError
        If waves, databases or hulls cannot be made; with the key in the case file.
    """
    if not has_sea(case):
        return None
    section = case.sea
    duration = 0.0 if case.simulate is None else case.simulate.duration
    hulls: tuple[seas.Hull, ...] = ()
    radiation: tuple[seas.Radiation, ...] = ()
    if case.hulls:
        from heavylift.pipeline.assemble.hulls import assemble_hulls, assemble_radiation

        hulls, radiation = assemble_hulls(case, sides, folder), assemble_radiation(case, folder)
    return seas.Sea(
        water=water_of(case),
        hulls=hulls,
        radiation=radiation,
        tanks=tuple(assemble_list(case, "tanks", sides)),
        pumps=tuple(assemble_list(case, "pumps", sides)),
        controllers=tuple(_beside(one, sides) for one in assemble_list(case, "controllers", sides)),
        waves=make_waves(case),
        ramp=0.0 if section is None else section.ramp,
        excitation="summed" if section is None else section.excitation,
        duration=duration,
        fields=_fields(case, duration),
        loads=tuple(assemble_list(case, "fluid_loads", sides)),
        lines=assemble_lines(case, sides),
        fenders=tuple(assemble_list(case, "fenders", sides)),
    )


def _beside(controller: Any, sides: Mapping[str, Side]) -> Any:
    """A controller with the points of other hulls in their frames."""
    levels = [
        level if level.beside is None else replace(level, beside=sides[level.of].local(level.beside))
        for level in controller.levels
    ]
    return replace(controller, levels=tuple(levels))


def make_waves(case: Case) -> WaveTrains | None:
    """All components of the waves of a case; None without waves."""
    if case.sea is None or not case.sea.waves:
        return None
    from heavylift.solver.water.waves.wave_trains import superposition

    water, trains = water_of(case), []
    for index, section in enumerate(case.sea.waves):
        key = "sea.waves" if len(case.sea.waves) == 1 else f"sea.waves.{index}"
        with located(case, key):
            trains.append(assemble(section, {}, case.folder).trains(water.depth, water.gravity))
    return superposition(trains)


def _fields(case: Case, duration: float) -> tuple[WindField | CurrentField, ...]:
    """Winds and currents."""
    if case.sea is None or not (case.sea.wind or case.sea.current):
        return ()
    found: list[WindField | CurrentField] = []
    for index, wind in enumerate(case.sea.wind):
        key = "sea.wind" if len(case.sea.wind) == 1 else f"sea.wind.{index}"
        with located(case, key):
            found.append(
                assemble(wind, {}, case.folder, fluctuation=_fluctuation(wind, duration, case.folder))
            )
    return (*found, *(assemble(current, {}, case.folder) for current in case.sea.current))


def _fluctuation(wind: Any, duration: float, folder: Path) -> FluctuationRecord | None:
    """Turbulence over the whole simulation."""
    if wind.spectrum is None or not duration:
        return None
    from heavylift.solver.water.wind.spectrum import hourly_mean

    record: FluctuationRecord = assemble(wind.spectrum, {}, folder).record(
        hourly_mean(wind.speed, wind.averaging_time), duration
    )
    return record


def sea_provenance(sea: seas.Sea | None) -> dict[str, Any]:
    """What the results say of a sea, as plain values: waves with their seeds, wind, databases, lengths of lines."""
    if sea is None:
        return {}
    found: dict[str, Any] = {}
    if sea.waves is not None:
        waves = sea.waves
        found["waves"] = {
            "description": waves.description,
            "seeds": list(waves.seeds),
            "components": len(waves.omega),
            "significant_height": waves.significant_height,
            "peak_period": waves.peak_period,
            "repeat_period": waves.repeat_period if math.isfinite(waves.repeat_period) else None,
        }
    records = {one.name: getattr(one, "fluctuation", None) for one in sea.fields}
    seeds = {name: record.seed for name, record in records.items() if record is not None}
    if seeds:
        found["wind_seeds"] = seeds
    if sea.radiation:
        found["databases"] = {" ".join(one.bodies): one.database.source for one in sea.radiation}
    if sea.lines:
        found["line_lengths"] = {
            line.name: [section.length for section in line.sections] for line in sea.lines
        }
    return found
