"""What a case file prescribes, in words and numbers for the report: loads, sensors, motion, initial state, mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.report_document import Facts, Section, Table
from heavylift.pipeline.signals import scaled_unit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.pipeline.case import Case

__all__ = ["body_input_rows", "input_section", "mesh_input_rows"]

_SHOWN = 12  # numbers of a list at most


def input_section(case: Case) -> Section:
    """Gravity, time integration, overrides, forces and sensors of a case."""
    rows = [("gravity", _numbers(case.gravity.acceleration, "m/s^2") if case.gravity is not None else "none")]
    if case.simulate is not None:
        settings = case.simulate
        times = ", ".join(
            f"{key.replace('_', ' ')} {_number(getattr(settings, key), 's')}"
            for key in ("step", "output_interval", "duration")
        )
        rows.append(("time integration", f"{settings.integrator}: {times}"))
    rows += [("override (--set)", text) for text in case.overrides]
    items: list[Facts | Table] = [Facts(tuple(rows))]
    if case.forces:
        header = ("force", "body", "point", "axes", "value")
        items.append(
            Table(
                header,
                tuple((f.name, f.body, _numbers(f.point, "m"), f.frame, _force(f)) for f in case.forces),
            )
        )
    if case.sensors:
        items.append(
            Table(
                ("sensor", "body", "point"),
                tuple((s.name, s.body, _numbers(s.point, "m")) for s in case.sensors),
            )
        )
    return Section("Inputs", tuple(items))


def body_input_rows(body: Any) -> list[tuple[str, str]]:
    """Mass and inertia of a rigid body; motion of the frame and initial state of any body."""
    rows: list[tuple[str, str]] = []
    if body.type == "rigid":
        rows += [
            ("mass", f"{body.mass:.8g} kg"),
            ("centre of mass", _numbers(body.centre_of_mass, "m")),
            ("inertia about the centre of mass", _inertia(body.inertia)),
        ]
    rows.append(("reference frame", f"{body.frame.motion}, origin: {body.frame.origin.replace('_', ' ')}"))
    if body.frame.motion == "driven":
        rows += _drive(body.frame)
    return rows + _initial(body.initial)


def mesh_input_rows(body: Any) -> list[tuple[str, str]]:
    """Geometry and meshing that the case file asks for, for a flexible body."""
    given = body.geometry
    place = getattr(given, "file", None) or getattr(given, "folder", None)
    rows = [("geometry", given.type.replace("_", " ") + (f": {place}" if place else ""))]
    if given.type == "blocks":
        words = [f"{len(given.add)} added"] + ([f"{len(given.cut)} cut"] if given.cut else [])
        rows[0] = ("geometry", f"blocks: {', '.join(words)}")
    if given.type == "four_files":
        return rows
    mesh = body.mesh
    if given.type != "mesh":
        rows.append(("element size", _number(mesh.size, "m") if mesh.size else "from the smallest wall"))
        rows += [("refined", f"{r.at}: {_number(r.size, 'm')}, growth {r.growth:g}") for r in mesh.refine]
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


def _number(value: float, unit: str) -> str:
    scaled = scaled_unit(unit, [np.array([value])])
    return f"{value / scaled.divisor:.6g} {scaled.text}".strip()


def _numbers(values: Sequence[float], unit: str) -> str:
    """Components in brackets with one unit."""
    scaled = scaled_unit(unit, [np.array(values, dtype=float)])
    shown = ", ".join(f"{value / scaled.divisor + 0.0:.6g}" for value in values[:_SHOWN])
    more = f", … {len(values) - _SHOWN} more" if len(values) > _SHOWN else ""
    return f"({shown}{more}) {scaled.text}".strip()


def _force(force: Any) -> str:
    """A constant force, or the ranges of its table."""
    if force.force is not None:
        return f"constant {_numbers(force.force, 'N')}"
    table = np.array(force.forces)
    return (
        f"table of {len(force.times)} points, {_range(force.times, 's')}; "
        f"smallest {_numbers(table.min(axis=0).tolist(), 'N')}, largest {_numbers(table.max(axis=0).tolist(), 'N')}"
    )


def _range(values: Sequence[float], unit: str) -> str:
    scaled = scaled_unit(unit, [np.array(values, dtype=float)])
    return f"{min(values) / scaled.divisor:.6g} to {max(values) / scaled.divisor:.6g} {scaled.text}".strip()


def _inertia(matrix: Sequence[Sequence[float]]) -> str:
    """Principal values of a diagonal tensor, else its six entries."""
    J = np.array(matrix)
    if not np.any(J - np.diag(np.diag(J))):
        return f"diagonal {_numbers(np.diag(J).tolist(), 'kg m^2')}"
    return f"xx, yy, zz, xy, xz, yz: {_numbers(J[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist(), 'kg m^2')}"


def _drive(frame: Any) -> list[tuple[str, str]]:
    """Motion profile of a driven frame."""
    rows = [
        (f"driven along {axis}", _profile(getattr(frame, axis), "m"))
        for axis in ("x", "y", "z")
        if getattr(frame, axis) is not None
    ]
    if frame.angle is not None:
        place = f"axis {_numbers(frame.axis, '')} through {_numbers(frame.pivot, 'm')}"
        rows.append(("driven rotation", f"{_profile(frame.angle, 'rad')}; {place}"))
    return rows or [("driven", "no profile: at rest")]


def _profile(profile: Any, unit: str) -> str:
    parts = []
    if profile.times:
        parts.append(
            f"table of {len(profile.times)} points, {_range(profile.times, 's')}: {_range(profile.values, unit)}"
        )
    parts += [
        f"{_number(h.amplitude, unit)} sine at {_number(h.frequency, 'Hz')}, phase {h.phase:.6g} rad"
        for h in profile.harmonics
    ]
    return " + ".join(parts)


def _initial(initial: Any) -> list[tuple[str, str]]:
    """Initial state as far as it is given; the rest is at rest where the geometry was drawn."""
    rows = [
        (f"initial {key.replace('_', ' ')}", _numbers(value, unit))
        for key, unit in (("position", "m"), ("velocity", "m/s"), ("angular_velocity", "rad/s"))
        if (value := getattr(initial, key)) is not None
    ]
    if initial.orientation is not None:
        turn = initial.orientation
        rows.append(("initial orientation", f"{turn.angle:.6g} rad about {_numbers(turn.axis, '')}"))
    by_mass = getattr(initial, "modal_scaling", "") == "mass"
    scaling = "mass-normalised shapes" if by_mass else "shapes of largest component 1"
    for key, unit in (("modal_position", "m"), ("modal_velocity", "m/s")):
        values = getattr(initial, key, ())
        if values:
            full = unit.replace("m", "m kg^0.5", 1) if by_mass else unit
            rows.append((f"initial {key.replace('_', ' ')}", f"{_numbers(values, full)}, {scaling}"))
    return rows or [("initial state", "at rest, as drawn")]
