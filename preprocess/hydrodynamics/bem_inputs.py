"""What a hydrodynamic database is computed from, and whether that can give one.

Nothing here needs the program that computes it.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import wave_numbers

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.hull_panels import HullPanels

__all__ = ["BemInputs", "database_digest", "input_warnings"]

PANELS_PER_WAVELENGTH = 6.0
FEWEST_PANELS_PER_WAVELENGTH = 2.0
LEAST_DEPTH = 0.15  # of k h: below, the Green function of finite depth has no series of exponentials
WIDEST_SPACING = np.deg2rad(10.0)
DIGEST_VERSION = 2


@dataclass(frozen=True, eq=False)
class BemInputs:
    """What a database depends on.

    Attributes
    ----------
    hulls
        Panels of each hull, all in the axes of the database (z = 0 the still water).
    omega
        (nw,) frequencies [rad/s], increasing, > 0.
    headings
        (nh,) directions of propagation [rad], increasing.
    reference_points
        (N, 3) [m].
    density, gravity, depth
        [kg/m^3], [m/s^2], [m] (``inf``: deep water).
    symmetric
        Hulls are symmetric about y = 0: headings of 0..pi are enough.
    lid
        Cover the water inside the hulls, which removes irregular frequencies.
    only_at_headings
        True: the database will be used at these headings alone, so their spacing does not matter.
    """

    hulls: tuple[HullPanels, ...]
    omega: NDArray[np.float64]
    headings: NDArray[np.float64]
    reference_points: NDArray[np.float64]
    density: float = 1025.0
    gravity: float = 9.81
    depth: float = float("inf")
    symmetric: bool = False
    lid: bool = True
    only_at_headings: bool = False


def database_digest(inputs: BemInputs) -> str:
    """A key that changes when anything changes that the database depends on (SHA-256, 64 hex digits)."""
    digest = hashlib.sha256(f"bem {DIGEST_VERSION}".encode())
    for hull in inputs.hulls:
        digest.update(hull.name.encode())
        digest.update(np.ascontiguousarray(hull.points, dtype=np.float64).tobytes())
        digest.update(np.ascontiguousarray(hull.panels, dtype=np.int64).tobytes())
    for values in (inputs.omega, inputs.headings, inputs.reference_points):
        array = np.ascontiguousarray(values, dtype=np.float64)
        digest.update(f"{array.shape}".encode())
        digest.update(array.tobytes())
    rest = (inputs.density, inputs.gravity, inputs.depth, inputs.symmetric, inputs.lid)
    digest.update(repr(rest).encode())
    return digest.hexdigest()


def input_warnings(inputs: BemInputs) -> tuple[str, ...]:
    """Refuse inputs that cannot give a database; sentences for what makes it less exact.

    Raises
    ------
    InputError
        No hull, frequencies out of order, headings more than 10 deg apart, panels longer than half of
        the shortest wave, a hull that reaches the bottom of the sea.
    """
    omega = np.asarray(inputs.omega, dtype=np.float64)
    headings = np.asarray(inputs.headings, dtype=np.float64)
    if not inputs.hulls:
        raise InputError("no hulls", source="hydrodynamics", expected="panels of at least one")
    if omega.size == 0 or not np.all(np.isfinite(omega)) or omega[0] <= 0.0 or np.any(np.diff(omega) <= 0.0):
        raise InputError(
            "frequencies are not increasing from above 0",
            source="hydrodynamics",
            key="omega",
            expected="[rad/s]; the limit of infinite frequency is computed by itself",
        )
    if (
        headings.size == 0
        or np.any(np.diff(headings) <= 0.0)
        or np.max(np.abs(headings)) > 2.0 * np.pi + 1e-9
    ):
        raise InputError(
            "headings are not increasing within one turn",
            source="hydrodynamics",
            key="headings",
            expected="directions of propagation [rad]",
        )
    spacing = float(np.max(np.diff(headings), initial=0.0))
    if spacing > WIDEST_SPACING * (1.0 + 1e-9) and not inputs.only_at_headings:
        raise InputError(
            f"headings are {np.rad2deg(spacing):.3g} deg apart",
            source="hydrodynamics",
            key="headings",
            expected="at most 10 deg: cubic interpolation over 15 deg errs by 1 % where the hull is one "
            "wavelength long and by 25 % at two",
        )
    if np.shape(inputs.reference_points) != (len(inputs.hulls), 3):
        raise InputError(
            f"shape {np.shape(inputs.reference_points)}",
            source="hydrodynamics",
            key="reference_points",
            expected=f"({len(inputs.hulls)}, 3)",
        )
    for hull in inputs.hulls:
        if hull.points[:, 2].max() > 1e-6:
            raise InputError(
                "panels reach above the water", source=hull.name, expected="z <= 0: clip the hull"
            )
        if hull.points[:, 2].min() <= -inputs.depth:
            raise InputError(
                f"the draft is {-hull.points[:, 2].min():g} m",
                source=hull.name,
                expected=f"less than the depth of the water, {inputs.depth:g} m",
            )
    _check_depth(inputs, omega)
    return (*_resolution_warnings(inputs, omega), *_irregular_warnings(inputs, omega))


def _check_depth(inputs: BemInputs, omega: NDArray[np.float64]) -> None:
    """Waves are not too long for the depth."""
    if not np.isfinite(inputs.depth):
        return
    longest = float(wave_numbers(omega[:1], inputs.gravity, inputs.depth)[0]) * inputs.depth
    if longest < LEAST_DEPTH:
        lowest = np.sqrt(inputs.gravity * LEAST_DEPTH / inputs.depth * np.tanh(LEAST_DEPTH))
        raise InputError(
            f"at {omega[0]:.4g} rad/s the wave number times the depth is {longest:.3g}",
            source="hydrodynamics",
            key="omega",
            expected=f"at least {LEAST_DEPTH}: frequencies from {lowest:.3g} rad/s in {inputs.depth:g} m of water",
        )


def _resolution_warnings(inputs: BemInputs, omega: NDArray[np.float64]) -> tuple[str, ...]:
    """Panels against the shortest wave, frequencies against the waves a box would shut in."""
    warnings: list[str] = []
    shortest = 2.0 * np.pi / float(wave_numbers(omega[-1:], inputs.gravity, inputs.depth)[0])
    for hull in inputs.hulls:
        size = hull.characteristic_size
        if size * FEWEST_PANELS_PER_WAVELENGTH > shortest:
            raise InputError(
                f"panels of {size:.3g} m, waves of {shortest:.3g} m at {omega[-1]:.3g} rad/s",
                source=hull.name,
                key="panel size",
                expected=f"at most a sixth of the shortest wave, {shortest / PANELS_PER_WAVELENGTH:.3g} m",
            )
        if size * PANELS_PER_WAVELENGTH > shortest:
            resolved = np.sqrt(
                inputs.gravity
                * (k := 2.0 * np.pi / (PANELS_PER_WAVELENGTH * size))
                * (np.tanh(k * inputs.depth) if np.isfinite(inputs.depth) else 1.0)
            )
            warnings.append(
                f"{hull.name}: panels of {size:.3g} m are a sixth of a wave up to {resolved:.3g} rad/s; "
                f"above it, to {omega[-1]:.3g} rad/s, the coefficients are less exact"
            )
    return tuple(warnings)


def _irregular_warnings(inputs: BemInputs, omega: NDArray[np.float64]) -> tuple[str, ...]:
    """The lowest frequency at which water shut in the hull would slosh, omega^2 = g k coth(k T) of its box.

    There, and in a band about it, integral equations without a lid have no unique solution (Faltinsen, Sea Loads,
    chapter 4, "irregular frequencies").
    """
    if inputs.lid:
        return ()
    warnings = []
    for hull in inputs.hulls:
        length, breadth, draft = np.ptp(hull.points, axis=0)
        k = np.pi * np.hypot(1.0 / length, 1.0 / breadth)
        irregular = float(np.sqrt(inputs.gravity * k / np.tanh(k * draft)))
        if omega[-1] > 0.9 * irregular:
            warnings.append(
                f"{hull.name}: without a lid the first irregular frequency is near {irregular:.3g} rad/s; "
                "coefficients about it and above it are wrong in places"
            )
    return tuple(warnings)
