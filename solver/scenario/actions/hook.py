"""Hooks of falls: their winches haul n times as fast, n the parts of rope."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scenario.actions.winch import LevelKeys, WinchHaul, scaled_limits, winch_action
from heavylift.solver.scene.actions import ACTIONS, NamesOf
from heavylift.solver.scene.signals import Signal, Term

if TYPE_CHECKING:
    from heavylift.solver.scene.actions import Action, Targets

__all__: list[str] = []


@ACTIONS.describe("hook")
@dataclass(frozen=True)
class HookKeys(LevelKeys):
    """What hooks of falls do."""

    ORDER: ClassVar[float] = 2
    TELLS: ClassVar[tuple[str, ...]] = ("distance", "height", "brake", "level")
    CALLED: ClassVar[Mapping[str, str]] = {"winch": "hook"}

    hook: Annotated[str, NamesOf("hooks")]
    """Falls whose hooks move: their winches haul n times as fast, n the parts of rope."""
    height: Annotated[float | None, Quantity("length")] = None
    """In the world, at which the hook stops [m]: it moves by its distance below that height when the phase begins, n
    times as far in rope; elongation of ropes and tilt of cranes meanwhile are not corrected."""

    @classmethod
    def made(cls, given: Any, targets: Targets, group: int) -> tuple[Action, ...]:
        """One for the rope of each hook."""
        hooks = targets.fitting("hook", given.hook, targets.hooks)
        cls.check_group(given, hooks)
        found = []
        for name in hooks:
            rope, hook = targets.rope_of(name), targets.hooks[name]
            if given.height is None:
                found.append(winch_action(rope, given, group, hook))
                continue
            n, place = hook.parts, Signal((Term(f"{name}_block.position", "z"),))
            height = given.height + hook.depth
            limits = scaled_limits(given, n)
            found.append(WinchHaul(rope, height, n * given.speed, given.ramp, place, float(n), **limits))
        return tuple(found)
