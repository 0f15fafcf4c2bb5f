"""The sea of a case in a report: water, waves, wind and current, hulls, databases, lines."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.report.described import described_table
from heavylift.pipeline.report.document import Facts, Section, Table, Text, short_table
from heavylift.pipeline.results.provenance import database_digest
from heavylift.pipeline.results.storage import read_json
from heavylift.pipeline.results.words import number_words, numbers_words

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["sea_sections"]

_NONE = "–"


def sea_sections(case: Case, stages: OutputFolder, results: Results | None) -> list[Section]:
    """Tables of what water and air do in a case; none for a case without them."""
    from heavylift.pipeline.assemble.water import has_sea

    if not has_sea(case):
        return []

    known: dict[str, Any] = results.metadata.get("sea", {}) if results is not None else {}
    items: list[Facts | Table | Text] = []
    if case.sea is not None:
        items += [Facts(tuple(_water(case))), *_waves(case, known), *_flows(case)]
    items += [
        *_hulls(case, stages),
        *_databases(case, stages),
        *_tanks(case),
        *_pumps(case),
        *described_table("load", case.fluid_loads),
    ]
    items += [*_lines(case, known), *described_table("fender", case.fenders)]
    return [Section("Sea" if case.sea is not None else "Lines", tuple(items))]


def _water(case: Case) -> list[tuple[str, str]]:
    from heavylift.pipeline.assemble.water import sea_gravity

    sea = case.sea
    assert sea is not None
    depth = "deep" if sea.depth is None else number_words(sea.depth, "m")
    rows = [
        ("density", f"{sea.density:g} kg/m^3"),
        ("gravity", f"{sea_gravity(case):.6g} m/s^2"),
        ("depth", depth),
    ]
    rows += [("still water at", number_words(sea.level, "m"))] if sea.level else []
    rows += [("ramp at the start", number_words(sea.ramp, "s"))] if sea.ramp else []
    if sea.waves and case.databases:
        words = {
            "summed": "summed at the low-passed place and heading of each hull",
            "series": "tabulated at the place and heading of the start",
        }
        rows.append(("forces of waves", words[sea.excitation]))
    return rows


def _waves(case: Case, known: dict[str, Any]) -> list[Table | Text]:
    """What was asked for, and what was made of it."""
    assert case.sea is not None
    if not case.sea.waves:
        return []
    rows = []
    for waves in case.sea.waves:
        height, period, words = waves.DESCRIBED.summary(waves)
        rows.append(
            (
                waves.type,
                _NONE if height is None else f"{height:g}",
                _NONE if period is None else f"{period:g}",
                f"{math.degrees(waves.direction):g}",
                str(getattr(waves, "seed", _NONE)),
                "; ".join(words),
            )
        )
    header = ("waves", "H or Hs [m]", "T or Tp [s]", "going to [deg]", "seed", "besides")
    items: list[Table | Text] = [short_table(header, rows, frozenset({1, 2, 3, 4}))]
    made = known.get("waves")
    if made:
        repeat = made.get("repeat_period")
        again = f"repeat after {repeat:.6g} s" if repeat else "do not repeat"
        items.append(
            Text(
                f"Together {made['components']} components with Hs = {made['significant_height']:.6g} m and "
                f"Tp = {made['peak_period']:.6g} s, which {again}."
            )
        )
    return items


def _flows(case: Case) -> list[Table]:
    """Winds and currents."""
    assert case.sea is not None
    rows = []
    for wind in case.sea.wind:
        words = [f"profile {wind.profile}"]
        if wind.averaging_time != 3600.0:
            words.append(f"mean over {number_words(wind.averaging_time, 's')}")
        if wind.gust is not None:
            words.append(f"constant gust of {number_words(wind.gust, 's')}")
        if wind.spectrum is not None:
            words.append(f"NPD spectrum of {wind.spectrum.height:g} m, seed {wind.spectrum.seed}")
        rows.append(
            (wind.name, "wind at 10 m", f"{wind.speed:g}", _heading(wind.direction), "; ".join(words))
        )
    for current in case.sea.current:
        speed, words = f"{current.speed}", []
        if isinstance(current.speed, float):
            speed = f"{current.speed:g}"
        else:
            speed = f"{max(current.speed.speeds):g}"
            words = [f"{len(current.speed.depths)} depths, the largest speed is shown"]
        rows.append((current.name, "current", speed, _heading(current.direction), "; ".join(words)))
    header = ("name", "of", "speed [m/s]", "going to [deg]", "besides")
    return [short_table(header, rows, frozenset({2}))] if rows else []


def _heading(direction: Any) -> str:
    if isinstance(direction, float):
        return f"{math.degrees(direction):g}"
    first, last = math.degrees(direction.angles[0]), math.degrees(direction.angles[-1])
    return f"{first:g} to {last:g}, table"


def _hulls(case: Case, stages: OutputFolder) -> list[Table | Text]:
    """Hulls, and how they float by themselves where a surface says it."""
    rows, problems = [], []
    for name, hull in case.hulls.items():
        figures: list[str] = [_NONE] * 5
        if hull.surface is not None:
            from heavylift.pipeline.assemble.hulls import resting_position

            try:
                found = resting_position(case, name, stages)
                pose = found.pose
                figures = [
                    f"{found.volume:.8g}",
                    f"{found.draft:.6g}",
                    f"{found.GM_T:.6g}",
                    f"{found.GM_L:.6g}",
                ]
                figures.append(f"{math.degrees(pose.list):.3g}, {math.degrees(pose.trim):.3g}")
            except InputError as error:
                problems.append(Text(f"{name} by itself: {error.problem}.", warning=True))
        elif hull.linear is not None:
            figures[0] = f"{hull.linear.volume:.8g}"
        rows.append((name, hull.kind, *figures))
    header = ("hull", "restoring", "volume [m^3]", "draft [m]", "GM_T [m]", "GM_L [m]", "list, trim [deg]")
    return [short_table(header, rows, frozenset({2, 3, 4, 5})), *problems] if rows else []


def _databases(case: Case, stages: OutputFolder) -> list[Table | Text]:
    """What the mesh stage found of the databases, and why it refused what it has computed."""
    from heavylift.pipeline.assemble.hulls import database_manifest

    items, rows = database_manifest(stages), []
    refused: list[Text] = []
    repaired: list[Text] = []
    for name, section in case.databases.items():
        about = items.get(name, {}).get("properties")
        refusal = read_json(stages.refused_database(name).with_suffix(".json")) or {}
        if refusal.get("digest") == database_digest(case, section):
            about = None
            problems = "; ".join(refusal["problems"])
            refused.append(Text(f"{name} was computed and is refused: {problems}.", warning=True))
            refused += [Text(f"What to set: {refusal['remedy']}.")] if refusal["remedy"] else []
        if not about:
            rows.append((name, ", ".join(section.hulls), section.file or "computed", *[_NONE] * 4))
            continue
        repairs = about.get("repairs", [])
        repaired += [Text(f"{name} was repaired: {sentence}.", warning=True) for sentence in repairs]
        low, high = about["frequency_range"]
        headings = "radiation alone"
        if about["headings"]:
            first, last = (math.degrees(angle) for angle in about["heading_range"])
            headings = (
                f"{about['headings']}: {first:.4g} to {last:.4g}{', mirrored' if about['symmetric'] else ''}"
            )
        fit, memory = about.get("memory"), str(section.memory)
        if fit:
            memory = f"{fit['poles']} poles over {fit['length']:.3g} s, error {fit['error']:.1e}"
        rows.append(
            (
                name,
                ", ".join(section.hulls),
                about["source"],
                f"{about['frequencies']}: {low:.4g} to {high:.4g}",
                headings,
                "deep" if about["depth"] is None else f"{about['depth']:g}",
                memory,
            )
        )
    header = ("database", "hulls", "source", "frequencies [rad/s]", "headings [deg]", "depth [m]", "memory")
    return [short_table(header, rows), *repaired, *refused] if rows else []


def _tanks(case: Case) -> list[Table]:
    rows = []
    for tank in case.tanks:
        water = (
            f"{tank.mass:g}" if tank.mass is not None else f"{tank.masses[0]:g} to {tank.masses[-1]:g}, table"
        )
        if tank.point is not None:
            place, room = numbers_words(tank.point, "m"), "a point mass"
        elif tank.size is not None:
            place, room = f"floor at {numbers_words(tank.floor, 'm')}", numbers_words(tank.size, "m")
        else:
            place, room = "by a table", f"{tank.volumes[-1]:g} m^3"
        rows.append((tank.name, tank.hull, place, room, water))
    return [short_table(("tank", "hull", "at", "holds", "water [kg]"), rows)] if rows else []


def _pumps(case: Case) -> list[Table]:
    """Pumps, and what commands them."""
    refusal = {pump: one.name for one in case.controllers for pump in one.pumps}
    rows = [
        (
            pump.name,
            f"{pump.source} {'to and from' if pump.reversible else 'to'} {pump.target}",
            f"{pump.rate:g}",
            f"{pump.lag:g}",
            f"{'a plan; ' * bool(len(pump.times))}{refusal.get(pump.name, '')}".rstrip("; "),
        )
        for pump in case.pumps
    ]
    header = ("pump", "from, to", "at most [kg/s]", "lag [s]", "commanded by")
    return [short_table(header, rows)] if rows else []


def _lines(case: Case, known: dict[str, Any]) -> list[Table]:
    """Mooring lines, with the lengths that were found for given tensions."""
    lengths: dict[str, list[float]] = known.get("line_lengths", {})
    more = {
        line.name: [f"{sum(lengths[line.name]):.8g} m in all"] for line in case.lines if line.name in lengths
    }
    return described_table("line", case.lines, more=more)
