"""From the mooring lines and fenders of a case to what the solver integrates."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.places import located
from heavylift.solver.scene.moorings import LineSection, MooringLine

if TYPE_CHECKING:
    from collections.abc import Mapping

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.lines import MooringLineSection

__all__ = ["assemble_lines"]

SLACKEST = 3.0
"""Of the distance of the ends: longest length that is tried for a tension."""


def assemble_lines(case: Case, sides: Mapping[str, Side]) -> tuple[MooringLine, ...]:
    """Lines of a case, those with a given tension with the length that gives it.

    Raises
    ------
    InputError
        If no length gives the tension.
    """
    found = []
    for index, section in enumerate(case.lines):
        with located(case, f"lines.{index}"):
            found.append(_line(case, section, sides))
    return tuple(found)


def _line(case: Case, section: MooringLineSection, sides: Mapping[str, Side]) -> MooringLine:
    a, b = (sides[name] for name in section.between)
    points = a.local(section.points[0]), b.local(section.points[1])
    seabed = section.seabed
    if section.on_seabed:
        seabed = bottom_of(case)
    pieces = tuple(
        LineSection(
            math.nan if piece.length is None else piece.length,
            piece.weight,
            math.inf if piece.axial_stiffness is None else piece.axial_stiffness,
        )
        for piece in section.sections
    )
    line = MooringLine(
        name=section.name,
        body_a=section.between[0],
        point_a=points[0],
        body_b=section.between[1],
        point_b=points[1],
        sections=pieces,
        clumps=section.clumps,
        seabed=seabed,
        friction=section.friction,
        strain_limit=section.strain_limit,
    )
    if section.fairlead_tension is None:
        return line
    span = b.to_world(points[1]) - a.to_world(points[0])
    return _with_tension(line, section.fairlead_tension, math.hypot(span[0], span[1]), float(span[2]))


def _with_tension(line: MooringLine, tension: float, x: float, z: float) -> MooringLine:
    """The line with the length of its one open section that gives a tension [N] at the fairlead, x and z away [m]."""
    from scipy.optimize import brentq

    from heavylift.solver.water.lines.catenary_line import length_for_tension, solve_catenary

    if z < 0.0:
        raise InputError(
            f"the fairlead is {-z:g} m below the anchor",
            key="points",
            expected="the anchor, then the fairlead",
        )
    row = next(i for i, piece in enumerate(line.sections) if math.isnan(piece.length))
    piece = line.sections[row]
    seabed = line.seabed is not None

    def with_length(length: float) -> tuple[LineSection, ...]:
        return (*line.sections[:row], replace(piece, length=length), *line.sections[row + 1 :])

    try:
        if len(line.sections) == 1 and math.isfinite(piece.axial_stiffness):
            length = length_for_tension(
                tension, piece.weight, piece.axial_stiffness, x, z, seabed=seabed, friction=line.friction
            )
            return replace(line, sections=with_length(length))
    except InputError as error:
        raise InputError(error.problem, key="fairlead_tension", expected=error.expected) from None

    def excess(length: float) -> float:
        found = solve_catenary(
            with_length(length), x, z, seabed=seabed, friction=line.friction, clumps=line.clumps
        )
        return found.tension - tension

    # from the length at which the line is straight under the tension, on: the tension falls until it hangs down
    chord = math.hypot(x, z)
    others = [other for other in line.sections if other is not piece]
    strains = [1.0 + tension / other.axial_stiffness for other in others]
    rest = chord - sum(s * other.length for s, other in zip(strains, others, strict=True))
    shortest = max(rest / (1.0 + tension / piece.axial_stiffness) * (1.0 + 1e-9), 1e-6 * chord)
    lengths = shortest + (SLACKEST * chord) * np.linspace(0.0, 1.0, 200)[1:] ** 4
    before = shortest
    for length in lengths:
        if excess(float(length)) <= 0.0:
            root = float(brentq(excess, before, float(length), xtol=1e-12, rtol=1e-14))
            return replace(line, sections=with_length(root))
        before = float(length)
    raise InputError(
        f"{tension:g} N is less than the line has at any length",
        key="fairlead_tension",
        expected="a larger tension, or lengths of all sections",
    )


def bottom_of(case: Case) -> float:
    """Height of the bottom of the sea in the world [m]."""
    assert case.sea is not None
    return case.sea.level - case.sea.water_depth
