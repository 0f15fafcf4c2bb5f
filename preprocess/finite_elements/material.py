"""Linear elastic material."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, InputErrors

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["DENSITY_LIMIT", "WAVE_SPEEDS", "Material"]

WAVE_SPEEDS = (10.0, 30e3)
"""Longitudinal waves of all materials [m/s]: soft rubber to beyond diamond."""
DENSITY_LIMIT = 25e3
"""Above osmium [kg/m3]."""


@dataclass(frozen=True)
class Material:
    """Linear, isotropic, homogeneous material.

    Parameters
    ----------
    young_modulus
        E [Pa], positive.
    poisson_ratio
        nu [-], -1 < nu < 0.5.
    density
        rho [kg/m3], positive; zero for parts of a structure that only stiffen it.

    Raises
    ------
    InputErrors
        Every property out of its range, at once.
    """

    young_modulus: float
    poisson_ratio: float
    density: float

    def __post_init__(self) -> None:
        errors = []
        for key, unit in (("young_modulus", "Pa"), ("density", "kg/m3")):
            value = getattr(self, key)
            none = key == "density" and value == 0.0
            if not (np.isfinite(value) and (value > 0.0 or none)):
                errors.append(
                    InputError(
                        f"{value!r}", source="material", key=key, expected=f"a positive number of {unit}"
                    )
                )
        if not -1.0 < self.poisson_ratio < 0.5:
            errors.append(
                InputError(
                    f"{self.poisson_ratio!r}",
                    source="material",
                    key="poisson_ratio",
                    expected="a number between -1 and 0.5 (0.5, incompressible, makes K singular)",
                )
            )
        if errors:
            raise InputErrors(errors)

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)) [Pa], the second Lame constant mu."""
        return self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def lame_lambda(self) -> float:
        """First Lame constant lambda = E nu / ((1 + nu)(1 - 2 nu)) [Pa]."""
        nu = self.poisson_ratio
        return self.young_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))

    def elasticity_matrix(self) -> NDArray[np.float64]:
        """Return D [Pa], shape (6, 6), order xx, yy, zz, xy, yz, zx, engineering shear strains."""
        D = np.zeros((6, 6))
        D[:3, :3] = self.lame_lambda
        D[np.arange(6), np.arange(6)] = self.shear_modulus
        D[np.arange(3), np.arange(3)] = self.lame_lambda + 2.0 * self.shear_modulus
        return D
