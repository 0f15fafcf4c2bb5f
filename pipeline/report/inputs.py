"""What a case file prescribes, in words and numbers for the report: loads, sensors, motion, initial state, mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.report.collisions import collision_tables
from heavylift.pipeline.report.connections import connection_tables
from heavylift.pipeline.report.contacts import contact_tables
from heavylift.pipeline.report.described import described_table, thing_words
from heavylift.pipeline.report.document import Facts, Section, Table, Text, short_table
from heavylift.pipeline.results.words import number_words, numbers_words, profile_words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.simulate import SimulateSection

__all__ = [
    "body_input_rows",
    "described_sections",
    "initial_rows",
    "input_section",
    "integration_words",
    "mesh_input_rows",
    "rigid_sections",
]

_SECTIONS = 4  # rigid bodies with a section of their own at most


def input_section(case: Case) -> Section:
    """Gravity, time integration, overrides, joints, ropes, forces, contacts, collisions and sensors of a case."""
    rows = [
        ("gravity", numbers_words(case.gravity.acceleration, "m/s^2") if case.gravity is not None else "none")
    ]
    if case.simulate is not None:
        rows.append(("time integration", integration_words(case.simulate)))
    if case.parameters:
        rows.append(("parameters", ", ".join(f"{key} = {value:g}" for key, value in case.parameters.items())))
    rows += [("override (--set)", text) for text in case.overrides]
    items: list[Facts | Table | Text] = [Facts(tuple(rows)), *connection_tables(case), *contact_tables(case)]
    items += collision_tables(case)
    if case.sensors:
        items.append(
            short_table(
                ("sensor", "body", "point"),
                [(sensor.name, sensor.body, numbers_words(sensor.point, "m")) for sensor in case.sensors],
            )
        )
    items += described_table("relative motion", case.relative_motions)
    items += described_table("lead", case.leads)
    items += described_table("lug", case.lugs)
    items += described_table("hook load", case.hook_loads)
    items += described_table("rope group", case.rope_groups)
    return Section("Inputs", tuple(items))


def integration_words(settings: SimulateSection) -> str:
    """Integrator, step or tolerance, output interval and duration."""
    start = {
        "check": "",
        "project": ", joints closed before",
        "equilibrium": ", from equilibrium",
        "relax": ", from equilibrium by damped motion",
    }[settings.start]
    if settings.duration == 0.0:
        return f"none: {start.removeprefix(', ')} only"
    words = []
    if settings.step is not None:
        words.append(f"step {number_words(settings.step, 's')}")
    if settings.solver_tolerance is not None:
        words.append(f"tolerance {settings.solver_tolerance:g}")
    words.append(f"output interval {number_words(settings.output_interval, 's')}")
    words.append(f"duration {number_words(settings.duration, 's')}")
    return f"{settings.integrator}: {', '.join(words)}{start}"


def rigid_sections(case: Case) -> list[Section]:
    """Sections on the rigid bodies of a case: one each, or one table of many."""
    rigid = {name: body for name, body in case.bodies.items() if body.has_inertia}
    if len(rigid) <= _SECTIONS:
        return [
            Section(f"Rigid body {name}", (Facts(tuple(body_input_rows(body))),))
            for name, body in rigid.items()
        ]
    header = ("body", "mass [kg]", "centre of mass", "inertia about it", "frame", "initial state")
    rows: list[tuple[str, ...]] = [
        (
            name,
            f"{body.mass:.8g}",
            numbers_words(body.centre_of_mass, "m"),
            _inertia(body.inertia),
            body.frame.motion,
            "; ".join(f"{key.removeprefix('initial ')} {words}" for key, words in initial_rows(body.initial)),
        )
        for name, body in rigid.items()
    ]
    return [Section(f"{len(rigid)} rigid bodies", (short_table(header, rows, frozenset({1})),))]


def described_sections(case: Case) -> list[Section]:
    """Sections on the other bodies that are given in numbers, one each: what their keys say."""
    return [
        Section(
            f"{body.BODY.NOUN.capitalize()} {name}",
            (Facts((("given", "; ".join(thing_words(body))), *initial_rows(body.initial))),),
        )
        for name, body in case.bodies.items()
        if not body.has_inertia and hasattr(body, "DESCRIBED")
    ]


def body_input_rows(body: Any) -> list[tuple[str, str]]:
    """Mass and inertia of a rigid body; motion of the frame and initial state of any body."""
    rows: list[tuple[str, str]] = []
    if body.has_inertia:
        rows += [
            ("mass", f"{body.mass:.8g} kg"),
            ("centre of mass", numbers_words(body.centre_of_mass, "m")),
            ("inertia about the centre of mass", _inertia(body.inertia)),
        ]
    rows.append(("reference frame", f"{body.frame.motion}, origin: {body.frame.origin.replace('_', ' ')}"))
    if body.frame.motion == "driven":
        rows += _drive(body.frame)
    return rows + initial_rows(body.initial)


def mesh_input_rows(body: Any) -> list[tuple[str, str]]:
    """Geometry and meshing that the case file asks for, for a flexible body."""
    given = body.geometry
    place = getattr(given, "file", None) or getattr(given, "folder", None)
    rows = [("geometry", given.type.replace("_", " ") + (f": {place}" if place else ""))]
    if given.type == "blocks":
        words = [f"{len(given.add)} added"] + ([f"{len(given.cut)} cut"] if given.cut else [])
        rows[0] = ("geometry", f"blocks: {', '.join(words)}")
    if given.type in {"four_files", "matrices"}:
        return rows
    mesh = body.mesh
    if given.type != "mesh":
        rows.append(("element size", number_words(mesh.size, "m") if mesh.size else "from the smallest wall"))
        rows += [
            ("refined", f"{r.at}: {number_words(r.size, 'm')}, growth {r.growth:g}") for r in mesh.refine
        ]
        if mesh.divisions:
            parts = (f"{axis}: {', '.join(map(str, mesh.divisions[axis]))}" for axis in mesh.divisions)
            rows.append(("divisions", "; ".join(parts)))
        if mesh.curved:
            rows.append(("curved faces", "middle nodes on the surface"))
        default = "incompatible" if mesh.element == "hex8" else "full"
        rows.append(("element", f"{mesh.element}, {_formulation(mesh.formulation or default)}"))
    else:
        rows.append(("element", _formulation(mesh.formulation) if mesh.formulation else "as in the file"))
    return rows


def _formulation(name: str) -> str:
    return {
        "full": "full integration",
        "incompatible": "incompatible modes",
        "reduced": "reduced integration with hourglass stiffness",
    }[name]


def _inertia(matrix: Sequence[Sequence[float]]) -> str:
    """Principal values of a diagonal tensor, else its six entries."""
    J = np.array(matrix)
    if not np.any(J - np.diag(np.diag(J))):
        return f"diagonal {numbers_words(np.diag(J).tolist(), 'kg m^2')}"
    return f"xx, yy, zz, xy, xz, yz: {numbers_words(J[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist(), 'kg m^2')}"


def _drive(frame: Any) -> list[tuple[str, str]]:
    """Motion profile of a driven frame."""
    rows = [
        (f"driven along {axis}", profile_words(getattr(frame, axis), "m"))
        for axis in ("x", "y", "z")
        if getattr(frame, axis) is not None
    ]
    if frame.angle is not None:
        place = f"axis {numbers_words(frame.axis, '')} through {numbers_words(frame.pivot, 'm')}"
        rows.append(("driven rotation", f"{profile_words(frame.angle, 'rad')}; {place}"))
    return rows or [("driven", "no profile: at rest")]


def initial_rows(initial: Any) -> list[tuple[str, str]]:
    """Initial state as far as it is given; the rest is at rest at the position of the geometry."""
    rows = [
        (f"initial {key.replace('_', ' ')}", numbers_words(value, unit))
        for key, unit in (("position", "m"), ("velocity", "m/s"), ("angular_velocity", "rad/s"))
        if (value := getattr(initial, key)) is not None
    ]
    if initial.orientation is not None:
        turn = initial.orientation
        rows.append(("initial orientation", f"{turn.angle:.6g} rad about {numbers_words(turn.axis, '')}"))
    by_mass = getattr(initial, "modal_scaling", "") == "mass"
    scaling = "mass-normalised shapes" if by_mass else "shapes of largest component 1"
    for key, unit in (("modal_position", "m"), ("modal_velocity", "m/s")):
        values = getattr(initial, key, ())
        if values:
            full = unit.replace("m", "m kg^0.5", 1) if by_mass else unit
            rows.append((f"initial {key.replace('_', ' ')}", f"{numbers_words(values, full)}, {scaling}"))
    return rows or [("initial state", "at rest, in its initial position")]
