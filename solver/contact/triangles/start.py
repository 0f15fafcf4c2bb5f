"""Surfaces that already cross each other before time starts are refused: nobody knows which side is which."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.triangles.overlap import find_overlap
from heavylift.numerics.outcome import InputError
from heavylift.solver.contact.kind import COMPLIANT, ContactRows

__all__ = ["check_overlaps"]

DEEPEST = 1e-4
"""Of the size of the smaller surface: what is less deep is pushed out gently."""


def check_overlaps(contacts: ContactRows, names: Sequence[str]) -> None:
    """Refuse pairs of surfaces that cross each other.

    Parameters
    ----------
    contacts
        With the poses of the start.
    names
        Of the collisions.

    Raises
    ------
    InputError
        With depth and place of the deepest crossing.
    """
    (meshes,) = contacts.meshes
    for name, pair, values in zip(names, meshes.pairs, meshes.pair_values, strict=True):
        first, second = contacts.poses[pair.poses[0]], contacts.poses[pair.poses[1]]
        R = first.rotation.reshape(3, 3)
        turned = R.T @ second.rotation.reshape(3, 3)
        moved = R.T @ (second.origin - first.origin)
        found = find_overlap(meshes.surfaces, int(pair.surfaces[0]), int(pair.surfaces[1]), turned, moved)
        allowed = DEEPEST * values.length_scale
        if pair.law == COMPLIANT:  # what is round may begin under load
            allowed = max(allowed, pair.radii)
        if found.triangle_a >= 0 and found.depth > allowed:
            _refuse(name, found.depth, first.origin + R @ found.place)


def _refuse(name: str, depth: float, at: NDArray[np.float64]) -> None:
    raise InputError(
        f"the surfaces cross each other at the start, {depth:.4g} m deep at "
        f"({at[0]:.4g}, {at[1]:.4g}, {at[2]:.4g}) m",
        source=name,
        key="between",
        expected="bodies apart, or an exclusion box where they overlap on purpose",
    )
