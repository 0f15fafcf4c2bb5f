"""Force elements of a scene become kinds: each names the module that packs it; what none names is not imported.

They are packed in stages (`heavylift.solver.scene.connections.Stage`), and within a stage kind by kind.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError
from heavylift.solver.joints.coordinate import ANGLE, joint_coordinate
from heavylift.solver.scene.connections import ROPES, Stage, rope_components
from heavylift.solver.scene.descriptions import recorded_channels
from heavylift.solver.scene.sliding_joints import joint_friction, joint_stops

if TYPE_CHECKING:
    from collections.abc import Iterable

    from heavylift.solver.force_elements.packing import PackingContext
    from heavylift.solver.scene.channels import ChannelBook
    from heavylift.solver.scene.scene import Scene

__all__ = ["elements_of", "pack_elements", "packing_module"]

ROPE_PACKING = "heavylift.solver.force_elements.rope_packing"
"""Packs ropes whose own module packs nothing: those of one tension, or over sheaves, by their stiffness."""

ORDER = (
    "heavylift.solver.forces.gravity",
    "heavylift.solver.forces.point",
    "heavylift.solver.force_elements.equalized_packing",
    "heavylift.solver.forces.spring",
    "heavylift.solver.forces.motor",
    "heavylift.solver.force_elements.scalar_packing",
    "heavylift.solver.force_elements.line_bearing",
    ROPE_PACKING,
    "heavylift.solver.transport.packing",
)
"""Modules that come first, in this order; others follow as the scene has their things.

It decides how sums of forces on a body are rounded and in which order rows are eliminated, nothing else.
"""


def elements_of(scene: Scene, stage: Stage) -> list[Any]:
    """Things of a scene that are packed in a stage, in the order of their columns."""
    things: list[Any] = [*scene.ropes, *scene.transporters, *scene.forces, *scene.inputs]
    things += [stop for joint in scene.joints for stop in joint_stops(joint)]
    things += [friction for joint in scene.joints for friction in joint_friction(joint)]
    return [thing for thing in things if getattr(thing, "STAGE", Stage.ROWS) is stage]


def packing_module(thing: Any, integrator: str) -> Any:
    """The module that makes the kind of a thing.

    Raises
    ------
    InputError
        If there is none.
    """
    named = getattr(thing, "packed_by", None)
    module = importlib.import_module(type(thing).__module__ if named is None else named(integrator))
    if not hasattr(module, "pack") and _is_rope(thing):
        module = importlib.import_module(ROPE_PACKING)
    if not hasattr(module, "pack"):
        raise InputError(
            f"a {type(thing).__name__}, which nothing packs",
            source=thing.name,
            key="type",
            expected=f"a function 'pack' in {module.__name__}",
        )
    return module


def _is_rope(thing: Any) -> bool:
    """Whether a case file calls it a rope, whatever it is made of."""
    return getattr(thing, "FAMILY", None) is ROPES


def pack_elements(things: Iterable[Any], context: PackingContext, record: ChannelBook) -> None:
    """Add the channels of things, make their kinds, and leave these in the context.

    Raises
    ------
    InputError
        If something does not fit together; see the functions `pack`.
    """
    groups: dict[str, list[Any]] = {}
    modules: dict[str, Any] = {}
    for thing in things:
        module = packing_module(thing, context.integrator)
        modules[module.__name__] = module
        groups.setdefault(module.__name__, []).append(thing)
        _add_channels(thing, context, record)
    known = [name for name in ORDER if name in groups]
    for name in dict.fromkeys((*known, *groups)):
        modules[name].pack(groups[name], context)


def _add_channels(thing: Any, context: PackingContext, record: ChannelBook) -> None:
    """Columns of what a thing records: channels along a joint are those of its coordinate, some have no components."""
    coordinate = ""
    if hasattr(thing, "CHANNEL_BY_COORDINATE") and not hasattr(thing, "CHANNELS"):
        coordinate = "angle" if joint_coordinate(context.joint(thing.joint), thing) == ANGLE else "travel"
    components = getattr(thing, "components", None)
    if components is None and _is_rope(thing):
        components = rope_components(thing)
    kinds = [kind for kind in recorded_channels(type(thing), coordinate) if kind.columns(components)]
    if kinds:
        context.columns[id(thing)] = record.add(thing.name, kinds, components)
