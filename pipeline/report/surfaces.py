"""Surfaces of a case in a report, and the tables of what the case file says of them and of collisions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.collisions import collision_notes
from heavylift.pipeline.report.document import Section, Table, Text, short_table
from heavylift.pipeline.results.words import number_words, numbers_words

if TYPE_CHECKING:
    from heavylift.pipeline.assemble.surfaces import StoredSurface
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["collision_tables", "surface_sections"]


def collision_tables(case: Case) -> list[Table | Text]:
    """Tables of the surfaces and collisions of a case, and what thesis parameters mean; none of what it has not."""
    items: list[Table | Text] = []
    if case.surfaces:
        rows = [_surface_row(surface) for surface in case.surfaces]
        items.append(short_table(("surface", "body", "triangles from", "besides"), rows))
    if case.collisions:
        header = ("collision", "between", "law", "besides")
        items.append(short_table(header, [_collision_row(section) for section in case.collisions]))
    items += [Text(f"Parameters of the thesis, {note}.") for note in collision_notes(case)]
    return items


def _surface_row(surface: Any) -> tuple[str, ...]:
    words = []
    if any(surface.at):
        words.append(f"at {numbers_words(surface.at, 'm')}")
    if surface.turned is not None:
        words.append(
            f"turned by {surface.turned.angle:.6g} rad about {numbers_words(surface.turned.axis, '')}"
        )
    if surface.radius:
        words.append(f"rounded by {number_words(surface.radius, 'm')}")
    words += [
        f"{'without what lies in' if box.keep == 'outside' else 'only what reaches into'} a box of "
        f"{numbers_words(box.size, 'm')} about {numbers_words(box.centre, 'm')}"
        for box in surface.exclude
    ]
    return (surface.name, surface.body, _source(surface), "; ".join(words))


def _source(surface: Any) -> str:
    if surface.file is not None:
        unit = f", in {surface.unit}" if surface.unit else ""
        return f"{surface.file}{unit}"
    if surface.shape is None:
        return f"own surface, {surface.facets or 2} facets a side of an element"
    shape = surface.shape
    size = getattr(shape, "size", None)
    if size is not None:
        return f"{shape.type} {numbers_words(size, 'm')}"
    lengths = [key for key in ("radius", "length") if hasattr(shape, key)]
    return shape.type + "".join(f", {key} {number_words(getattr(shape, key), 'm')}" for key in lengths)


def _collision_row(section: Any) -> tuple[str, ...]:
    words = [f"friction {section.friction:g}"] if section.friction else []
    if section.law == "rigid":
        words.append("impacts split the step" if section.events else "impacts at ends of steps")
    if section.method != "swept":
        words.append(f"found by {section.method.replace('-', ' ')}, which misses some")
    where = " and ".join(section.between) if section.between else f"all of {', '.join(section.among)}"
    return (section.name, where, _law(section), "; ".join(words))


def _law(section: Any) -> str:
    """Law of a collision with its numbers."""
    words = []
    if section.law in {"rigid", "hunt-crossley"}:
        words.append(f"restitution {section.restitution:g}")
    if getattr(section, "rest_speed", 0.0):
        words.append(f"none below {number_words(section.rest_speed, 'm/s')}")
    if hasattr(section, "stiffness"):
        power = {"linear": 1.0, "hertz": 1.5}.get(section.law) or section.exponent
        unit = "N/m" if power == 1.0 else f"N/m^{power:g}"
        words.append(f"stiffness of a patch {section.stiffness:.6g} {unit}")
    if getattr(section, "damping", 0.0):
        words.append(f"damping {number_words(section.damping, 'N s/m')}")
    if section.law == "thesis":
        words.append(f"epsilon {section.epsilon:g} m/N, gamma {section.gamma:g}")
    return ", ".join([section.law, *words])


def surface_sections(case: Case, stages: OutputFolder) -> list[Section]:
    """What the mesh stage found of the surfaces, and warnings of sizes; nothing of what has not been made."""
    from heavylift.pipeline.assemble.surfaces import magnitude_warnings, read_surface_file

    found: dict[str, StoredSurface] = {}
    for surface in case.surfaces:
        try:
            found[surface.name] = read_surface_file(stages.surface(surface.name))
        except InputError:
            continue
    if not found:
        return []
    header = (
        "surface",
        "triangles",
        "points",
        "open edges",
        "edges of 3 and more",
        "wound against neighbours",
        "watertight",
        "excluded",
        "welded, dropped",
        "box",
    )
    rows = [_found_row(name, stored.report) for name, stored in found.items()]
    text = (
        "Collision takes surfaces as they are: open edges, edges of several plates and windings make no difference "
        "to it. Hulls must be closed where they are under water."
    )
    warnings = [
        Text(f"Is the unit right? {warning}", warning=True) for warning in magnitude_warnings(case, found)
    ]
    return [
        Section("Surfaces", (short_table(header, rows, frozenset({1, 2, 3, 4, 5, 7})), Text(text), *warnings))
    ]


def _found_row(name: str, report: dict[str, Any]) -> tuple[str, ...]:
    low, high = np.array(report["bounds"])
    dropped = report.get("dropped")
    words = "–"
    if dropped is not None:
        gone = dropped["degenerate"] + dropped["duplicate"]
        words = f"{dropped['welded']} points, {gone} triangles"
    box = f"{numbers_words(low.tolist(), 'm')} to {numbers_words(high.tolist(), 'm')}"
    if not report["edges"]:
        return (name, "–", "–", "–", "–", "–", "round", "0", words, box)
    return (
        name,
        str(report["triangles"]),
        str(report["points"]),
        str(report["open_edges"]),
        str(report["junction_edges"]),
        str(report["reversed_triangles"]),
        "yes" if report["watertight"] else "no",
        str(report["excluded"]),
        words,
        box,
    )
