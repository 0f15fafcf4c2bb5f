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

    from numpy.typing import NDArray

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
        If no length gives the tension, or a line cannot hang between its ends, as of `pack_mooring_lines`.
    """
    found: list[MooringLine] = []
    for index, section in enumerate(case.lines):
        with located(case, f"lines.{index}"):
            found.append(assemble_line(case, section, sides))
    return tuple(found)


def assemble_line(case: Case, section: Any, sides: Mapping[str, Side]) -> MooringLine:
    """One of them, from its section."""
    from heavylift.solver.water.lines.placed_line import check_ends, check_line

    made: MooringLine = assemble(section, sides, case.folder)
    on_seabed = made.on_seabed
    anchor, fairlead = (
        sides[body].to_world(point)
        for body, point in ((made.body_a, made.point_a), (made.body_b, made.point_b))
    )
    if on_seabed:
        assert case.sea is not None
        made = replace(made, on_seabed=False, seabed=case.sea.level - case.sea.water_depth)
    if made.seabed_slope is not None and made.seabed_slope.point is None:
        made = replace(made, seabed_slope=replace(made.seabed_slope, point=anchor[:2]))
    try:
        check_ends(made, anchor, fairlead, on_seabed=on_seabed)
        if made.fairlead_tension is not None:
            made = _with_tension(made, made.fairlead_tension, anchor, fairlead)
        check_line(made, anchor, fairlead)
    except InputError as error:
        raise InputError(error.problem, key=error.key, expected=error.expected) from None
    return made


def _with_tension(
    line: MooringLine, tension: float, anchor: NDArray[np.float64], fairlead: NDArray[np.float64]
) -> MooringLine:
    """The line with the length of its one open section that gives a tension [N] at the fairlead."""
    from scipy.optimize import brentq

    from heavylift.solver.water.lines.catenary_line import length_for_tension, over_bottom, solve_catenary
    from heavylift.solver.water.lines.placed_line import plane_of_line

    x, z, slope, clearance = plane_of_line(line, anchor, fairlead)
    if z < 0.0 and not over_bottom(slope, clearance):
        raise InputError(
            f"the fairlead is {-z:g} m below the anchor",
            key="points",
            expected="the anchor, then the fairlead",
        )
    row = next(i for i, piece in enumerate(line.sections) if math.isnan(piece.length))
    piece = line.sections[row]
    bottom: dict[str, Any] = {
        "seabed": line.seabed is not None,
        "friction": line.friction,
        "slope": slope,
        "clearance": clearance,
    }

    def with_length(length: float) -> tuple[LineSection, ...]:
        return (*line.sections[:row], replace(piece, length=length), *line.sections[row + 1 :])

    try:
        if len(line.sections) == 1 and math.isfinite(piece.axial_stiffness):
            length = length_for_tension(tension, piece.weight, piece.axial_stiffness, x, z, **bottom)
            return replace(line, sections=with_length(length), fairlead_tension=None)
    except InputError as error:
        raise InputError(error.problem, key="fairlead_tension", expected=error.expected) from None

    def excess(length: float) -> float:
        return solve_catenary(with_length(length), x, z, clumps=line.clumps, **bottom).tension - tension

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
