"""Words that say what files of hydrodynamic databases mean: one list each, for readers and case files."""

from __future__ import annotations

from typing import Literal

__all__ = ["ExcitingForces", "FileFormat", "FirstColumn", "TimeConvention"]

FirstColumn = Literal["period", "frequency"]
"""Of WAMIT's numeric files: periods [s], where 0 is infinite and a negative one zero frequency; or angular frequencies
[rad/s] (`IPEROUT` = 2), where 0 is zero and a negative one infinite frequency."""

ExcitingForces = Literal["diffraction", "haskind"]
"""Which of the two sets in a listing of WAMIT: of the diffracted waves, or from those that the hull radiates."""

TimeConvention = Literal["exp(-i omega t)", "exp(+i omega t)"]
"""What complex amplitudes mean; the first is that of databases here."""

FileFormat = Literal["netcdf", "bemio", "wamit", "wamit-out"]
"""Of files of databases."""
