"""From the mooring lines of a case to what the solver integrates: the lengths that follow from tensions."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.described import assemble
from heavylift.pipeline.case.places import located

if TYPE_CHECKING:
    from collections.abc import Mapping

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.solver.scene.moorings import LineSection
    from heavylift.solver.water.lines.mooring_lines import MooringLine

__all__ = ["assemble_line", "assemble_lines"]

SLACKEST = 3.0
"""Of the distance of the ends: longest length that is tried for a tension."""


def assemble_lines(case: Case, sides: Mapping[str, Side]) -> tuple[MooringLine, ...]:
    """Lines of a case, with the bottom that they lie on, and those with a given tension with the length that gives it.

    Raises
    ------
    InputError
        If no length gives the tension.
    """
    found: list[MooringLine] = []
    for index, section in enumerate(case.lines):
        with located(case, f"lines.{index}"):
            found.append(assemble_line(case, section, sides))
    return tuple(found)


def assemble_line(case: Case, section: Any, sides: Mapping[str, Side]) -> MooringLine:
    """One of them, from its section."""
    made: MooringLine = assemble(section, sides, case.folder)
    if made.on_seabed:
        assert case.sea is not None
        made = replace(made, on_seabed=False, seabed=case.sea.level - case.sea.water_depth)
    if made.fairlead_tension is None:
        return made
    anchor, fairlead = (
        sides[body].to_world(point)
        for body, point in ((made.body_a, made.point_a), (made.body_b, made.point_b))
    )
    span = fairlead - anchor
    return _with_tension(made, made.fairlead_tension, math.hypot(span[0], span[1]), float(span[2]))


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
            return replace(line, sections=with_length(length), fairlead_tension=None)
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
            return replace(line, sections=with_length(root), fairlead_tension=None)
        before = float(length)
    raise InputError(
        f"{tension:g} N is less than the line has at any length",
        key="fairlead_tension",
        expected="a larger tension, or lengths of all sections",
    )
