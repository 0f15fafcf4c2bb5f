"""Where the velocities of bodies are, and how rows of joints see the bodies they hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.rows.structure import DIAGONAL, FACTORED, PRESCRIBED, Attachment
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.meshes import MeshBody
from heavylift.solver.scene.scene import AnyBody, FlexibleBody, Free, RigidBody

__all__ = [
    "attachments",
    "first_dofs",
    "inverse_masses",
    "inverse_scales",
    "mode_count",
    "velocity_count",
]

NO_BASES: dict[str, int] = {}


def mode_count(body: AnyBody) -> int:
    """Modal coordinates of a body."""
    return body.reduced.mode_count if isinstance(body, FlexibleBody) else 0


def velocity_count(body: AnyBody, bases: Mapping[str, int] = NO_BASES) -> int:
    """Velocities of a body in the workspace: of a mesh, three for each of its bases and moving points."""
    return 3 * bases.get(body.name, 0) if isinstance(body, MeshBody) else 6 + mode_count(body)


def first_dofs(bodies: Sequence[AnyBody], bases: Mapping[str, int] = NO_BASES) -> dict[str, int]:
    """Place of the velocities of each body."""
    widths = [velocity_count(body, bases) for body in bodies]
    starts = np.concatenate([[0], np.cumsum(widths)])
    return {body.name: int(start) for body, start in zip(bodies, starts[:-1], strict=True)}


def attachments(
    bodies: Sequence[AnyBody], dofs: dict[str, int], bases: Mapping[str, int] = NO_BASES
) -> Callable[[str], Attachment]:
    """Where the rows on a body go, by its name."""
    found = {GROUND: Attachment(-1, -1, 0, PRESCRIBED)}
    for number, body in enumerate(bodies):
        holder = PRESCRIBED if not isinstance(body.motion, Free) else DIAGONAL
        if isinstance(body, (FlexibleBody, MeshBody)):
            holder = FACTORED
        width = velocity_count(body, bases)
        found[body.name] = Attachment(number, dofs[body.name], width, holder)
        group = getattr(body, "group", ())
        if group:  # hulls that water couples are one body to joints, the first of them
            first = next(i for i, other in enumerate(bodies) if other.name == group[0])
            found[body.name] = Attachment(first, dofs[group[0]], 6 * len(group), FACTORED)
    return found.__getitem__


def inverse_masses(bodies: Sequence[AnyBody], bases: Mapping[str, int] = NO_BASES) -> NDArray[np.float64]:
    """Of the velocities of free rigid bodies in their principal axes; zero elsewhere."""
    blocks: list[NDArray[np.float64]] = []
    for body in bodies:
        block = np.zeros(velocity_count(body, bases))
        if isinstance(body, RigidBody) and isinstance(body.motion, Free) and not hasattr(body, "group"):
            block[:3] = 1.0 / body.mass
            block[3:] = 1.0 / np.linalg.eigvalsh(body.inertia)
        blocks.append(block)
    return np.concatenate(blocks)


def inverse_scales(bodies: Sequence[AnyBody]) -> Callable[[str], tuple[float, float]]:
    """Inverse mass and smallest inverse inertia by name; zero for prescribed motion."""
    by_name = {body.name: body for body in bodies}

    def scales(name: str) -> tuple[float, float]:
        body = by_name[name]
        if isinstance(body, MeshBody):
            from heavylift.solver.bodies.ancf.packing import mass_and_inertia

            mass, inertia = mass_and_inertia(body)
            return 1.0 / mass, 1.0 / inertia
        if isinstance(body, FlexibleBody):
            integrals = body.reduced.integrals
            largest = float(np.linalg.eigvalsh(integrals.inertia_kl)[1:].sum())
            held = not isinstance(body.motion, Free) and body.reduced.mode_count == 0
            return (0.0, 0.0) if held else (1.0 / integrals.mass, 1.0 / largest)
        if not isinstance(body.motion, Free):
            return 0.0, 0.0
        return 1.0 / body.mass, 1.0 / float(np.linalg.eigvalsh(body.inertia)[2])

    return scales
