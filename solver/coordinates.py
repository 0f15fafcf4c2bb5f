"""Where the velocities of bodies are, and how rows of joints see the bodies they hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.rows.structure import DIAGONAL, FACTORED, PRESCRIBED, Attachment
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.scene import AnyBody

__all__ = [
    "attachments",
    "first_dofs",
    "inverse_masses",
    "inverse_scales",
    "velocity_count",
]

NO_BASES: dict[str, int] = {}

HOLDERS = {"diagonal": DIAGONAL, "factored": FACTORED, "prescribed": PRESCRIBED}
"""What rows find of the mass of a body, as systems of rows know it."""


def velocity_count(body: AnyBody, bases: Mapping[str, int] = NO_BASES) -> int:
    """Velocities of a body in the workspace: of a mesh, three for each of its bases and moving points."""
    return body.velocity_count(bases.get(body.name, 0))


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
        width = velocity_count(body, bases)
        found[body.name] = Attachment(number, dofs[body.name], width, HOLDERS[body.holder])
        group = body.group_names
        if group:  # hulls that water couples are one body to joints, the first of them
            first = next(i for i, other in enumerate(bodies) if other.name == group[0])
            found[body.name] = Attachment(first, dofs[group[0]], 6 * len(group), FACTORED)
    return found.__getitem__


def inverse_masses(bodies: Sequence[AnyBody], bases: Mapping[str, int] = NO_BASES) -> NDArray[np.float64]:
    """Of the velocities of free rigid bodies in their principal axes; zero elsewhere."""
    blocks: list[NDArray[np.float64]] = []
    for body in bodies:
        known = body.inverse_masses
        blocks.append(np.zeros(velocity_count(body, bases)) if known is None else known)
    return np.concatenate(blocks)


def inverse_scales(bodies: Sequence[AnyBody]) -> Callable[[str], tuple[float, float]]:
    """Inverse mass and smallest inverse inertia by name; zero for prescribed motion."""
    by_name = {body.name: body for body in bodies}

    def scales(name: str) -> tuple[float, float]:
        return by_name[name].inverse_scales()

    return scales
