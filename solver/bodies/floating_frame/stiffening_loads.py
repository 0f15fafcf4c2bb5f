"""Forces at places of bodies that stiffen: what finds them in generalised forces, and places that are not known."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.modal.stiffening import HERE
from heavylift.numerics.outcome import InputError
from heavylift.solver.interface import FORCES
from heavylift.solver.scene.bodies import Free

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.markers import BodyMarkers
    from heavylift.solver.scene.bodies import FlexibleBody

__all__ = ["find_loads", "refuse_other_places"]

SMALLEST = 1e-6
"""Singular value of unit loads, relative to the largest, below which they are not told apart."""

_STILL = 1e-9  # of the largest displacement of a mode: of a point that is held


def find_loads(body: FlexibleBody) -> NDArray[np.float64]:
    """Matrix from force, moment about the origin and modal forces to the loads at its places, shape (m, 6 + nf).

    Raises
    ------
    InputError
        If different loads are the same to its modes.

    Notes
    -----
    The loads with the generalised forces that act, by least squares in the metric of the strain energy. What joints do
    to a frame that does not move freely is not known, and is not needed.
    """
    reduced = body.reduced
    assert reduced.stiffening is not None
    mass, size = reduced.integrals.mass, reduced.size
    free = isinstance(body.motion, Free)
    lowest = float(reduced.eigenvalues.min(initial=np.inf))
    frame = np.repeat([1.0 / (mass * lowest), 1.0 / (mass * size**2 * lowest)], 3) if free else np.zeros(6)
    weight = np.sqrt(np.concatenate([frame, 1.0 / reduced.eigenvalues]))
    unit = reduced.stiffening.generalised * weight
    forces = np.linalg.norm(reduced.stiffening.generalised[:, :3], axis=1) > 0.5
    lengths = np.where(forces, 1.0, size)
    scaled = (unit / lengths[:, None]).T
    left, singular, right = np.linalg.svd(scaled, full_matrices=False)
    if len(singular) < scaled.shape[1] or singular[-1] < SMALLEST * singular[0]:
        parts = np.abs(np.linalg.svd(scaled)[2][-1])
        names = ", ".join(reduced.stiffening.labels[k] for k in np.flatnonzero(parts > 0.1 * parts.max()))
        raise InputError(
            f"its modes do not tell apart the loads that stiffen it: {names}",
            source=body.name,
            key="modes.stiffening",
            expected="static vectors of each of them (interfaces, 'modes.static_points'), or fewer places",
        )
    inverse = (right.T / singular) @ left.T
    return np.ascontiguousarray(inverse * weight / lengths[:, None])


def refuse_other_places(body: FlexibleBody, markers: BodyMarkers) -> None:
    """Refuse forces and joints at points whose stress a stiffening does not know, but for those that are held.

    Raises
    ------
    InputError
        With the point.
    """
    reduced = body.reduced
    assert reduced.stiffening is not None
    largest = float(np.abs(reduced.mode_shapes).max(initial=0.0))
    for place, level in zip(markers.places, markers.levels, strict=True):
        if level > FORCES:
            continue
        distances = np.linalg.norm(reduced.stiffening.places - place, axis=1)
        if distances.min(initial=np.inf) <= HERE * reduced.size:
            continue
        shapes = reduced.shapes_at(*reduced.locate(place, source=body.name))
        if not isinstance(body.motion, Free) and np.abs(shapes).max(initial=0.0) <= _STILL * largest:
            continue
        at = ", ".join(f"{1e3 * x:.6g}" for x in place)
        raise InputError(
            f"something acts at ({at}) mm in its frame, and how far that stiffens it is not known",
            source=body.name,
            key="modes.stiffening",
            expected="an interface at that point, or the point in 'modes.static_points'",
        )
