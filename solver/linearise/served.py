"""What a linearisation can serve: scenes whose forces change smoothly with positions and velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.connections import controlled, rubbing_places
from heavylift.solver.scene.scene import Scene
from heavylift.solver.scene.sliding_joints import joint_friction

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from heavylift.solver.scene.channels import Channel
    from heavylift.solver.simulation import Simulation

__all__ = ["check_open", "check_served"]


def check_served(simulation: Simulation) -> None:
    """Refuse what has no linear motion about a state.

    Raises
    ------
    InputError
        Names all of it.
    """
    reasons = list(_reasons(simulation.scene))
    if simulation.integrator == "thesis":
        reasons.append("integrator 'thesis' has no accelerations")
    layout = simulation.layout
    inertia = np.zeros(len(layout.work.velocity))
    for kind in layout.bodies:
        kind.survey(np.zeros((len(layout.body_names), 8)), inertia, np.zeros(len(inertia)))
    if not (inertia.any() or any(kind.NODAL for kind in layout.bodies)):
        reasons.append("nothing moves freely")
    if reasons:
        raise InputError(
            "; ".join(reasons),
            source="linearisation",
            key="scene",
            expected="a scene without these, whose forces change smoothly with positions and velocities",
        )


def check_open(scene: Scene, channels: Sequence[Channel], row: NDArray[np.float64], near: float) -> None:
    """Refuse contacts that are closed, or nearly so: they hold on one side only.

    Parameters
    ----------
    scene, channels, row
        What is simulated, and a record of the state.
    near
        Gap [m] below which a contact may close with the displacements of a linearisation.

    Raises
    ------
    InputError
        Names the first of them.
    """
    columns = {channel.name: channel.column for channel in channels}
    touching: tuple[Any, ...] = (*scene.contacts, *scene.collisions)
    for one in touching:
        force, gap = (float(row[columns[f"{one.name}.{what}"]]) for what in ("normal_force", "gap"))
        if force != 0.0 or gap < near:
            raise InputError(
                f"{one.name!r} touches, or is about to, and then holds on one side only",
                source="linearisation",
                key="state",
                expected="a state in which contacts and collisions are open",
            )


def _reasons(scene: Scene) -> Iterator[str]:
    """What cannot be served, in words."""
    if scene.transporters:
        yield f"transporter {scene.transporters[0].name!r} rides on bogies without mass"
    for radiation in () if scene.sea is None else scene.sea.radiation:
        if radiation.memory == "direct":
            yield (
                f"the memory of {radiation.bodies[0]!r} is a convolution over the past: take 'exponentials'"
            )
    for one in (*scene.ropes, *scene.forces):
        if reason := getattr(one, "NOT_LINEAR", ""):
            yield f"{one.name!r} {reason}"
        elif getattr(one, "friction", 0.0) > 0.0:
            yield f"{one.name!r} slides with friction, and sticks at rest"
    for rope in scene.ropes:
        if rubbing_places(rope):
            yield f"rope {rope.name!r} sticks and slides on its sheaves"
        elif controlled(rope):
            yield f"the winch of rope {rope.name!r} is controlled by its tension"
    for joint in scene.joints:
        if any(joint_friction(joint)):
            yield f"joint {joint.name!r} has dry friction, which sticks at rest"
