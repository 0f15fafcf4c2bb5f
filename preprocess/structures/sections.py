"""Cross-sections of beams."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["BeamSection"]


@dataclass(frozen=True, eq=False)
class BeamSection:
    """Constants of a section in its axes 2 and 3, axis 2 lying in plane 1 of the beam.

    Attributes
    ----------
    area
        A [m2].
    second_moment_1
        Of bending in plane 1, about axis 3 through the centroid [m4] (Nastran I1).
    second_moment_2
        Of bending in plane 2, about axis 2 [m4] (Nastran I2).
    product
        Integral of the product of both coordinates [m4] (Nastran I12).
    torsion
        J [m4].
    shear_area_1, shear_area_2
        Of shear in planes 1 and 2 [m2]; infinite without shear flexibility.
    shear_centre
        From the centroid, axes 2 and 3 [m].
    nonstructural_mass
        [kg/m].
    corners
        Points at which stress is evaluated, relative to the centroid, axes 2 and 3 [m], shape (m, 2); may be empty.
    name
        For the report, e.g. ``"HP 300 x 13"``.
    """

    area: float
    second_moment_1: float
    second_moment_2: float
    torsion: float
    product: float = 0.0
    shear_area_1: float = np.inf
    shear_area_2: float = np.inf
    shear_centre: tuple[float, float] = (0.0, 0.0)
    nonstructural_mass: float = 0.0
    corners: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 2)))
    name: str = ""
