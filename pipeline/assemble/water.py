"""Whether a case has water, and what it is: density, weight, level and depth."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.pipeline.assemble.described import assemble
from heavylift.pipeline.case.sea_tables import STANDARD_GRAVITY

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case
    from heavylift.solver.scene.sea import Water

__all__ = ["has_sea", "sea_gravity", "water_of"]


def has_sea(case: Case) -> bool:
    """Whether there is anything of water, air or mooring in a case."""
    return case.sea is not None or bool(case.lines or case.fenders)


def sea_gravity(case: Case) -> float:
    """Gravity of the water [m/s^2]: its own, or that of the case."""
    if case.sea is not None and case.sea.gravity is not None:
        return case.sea.gravity
    if case.gravity is not None and any(case.gravity.acceleration):
        return math.hypot(*case.gravity.acceleration)
    return STANDARD_GRAVITY


def water_of(case: Case) -> Water:
    """Still water of a case."""
    from heavylift.solver.scene.sea import Water

    if case.sea is None:
        return Water(gravity=sea_gravity(case))
    tide = None if case.sea.tide is None else assemble(case.sea.tide, {}, case.folder)
    return Water(
        density=case.sea.density,
        gravity=sea_gravity(case),
        level=case.sea.level + (0.0 if tide is None else tide.at_start),
        depth=case.sea.water_depth,
        tide=tide,
    )
