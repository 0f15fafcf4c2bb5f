"""Hydrodynamic databases from the ``.h5`` files of BEMIO (the pre-processor of WEC-Sim).

Layout as h5py sees it, for body b of N: ``/body<b>/hydro_coeffs/`` with ``added_mass/all`` (6, 6N, nw),
``added_mass/inf_freq`` (6, 6N), ``radiation_damping/all`` (6, 6N, nw), ``excitation/re`` and ``/im`` (6, nh, nw),
``linear_restoring_stiffness`` (6, 6), perhaps ``mean_drift/<way>/val`` (6, nh, nw), and ``/body<b>/properties/`` with
name, cg, cb, disp_vol. Numbers are divided by rho (mass), rho omega (damping), rho g (forces, stiffness), unless
``simulation_parameters/scaled`` is 1.

Headings are in degrees, time runs as exp(+i omega t) (WAMIT's), rows are forces.

Moments are about the centre of gravity, where WEC-Sim wants the origin of each body: there the restoring has no
terms of weight.

Source: WEC-Sim documentation, "BEMIO"; Ruehl et al., "Preliminary verification and validation of WEC-Sim" (2014).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.hdf5_files import is_hdf5, opened_hdf5
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.hydrodynamics.repairs import repaired

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.preprocess.hydrodynamics.repairs import Repair

__all__ = ["read_bemio"]


def read_bemio(
    path: Path | str,
    *,
    reference_points: ArrayLike | None = None,
    symmetric: bool = False,
    repair: Repair | None = None,
) -> HydrodynamicDatabase:
    """Read a BEMIO file.

    Parameters
    ----------
    path
        File.
    reference_points
        (N, 3) [m] points about which the moments are, if these are not the centres of gravity (then the restoring is
        left out: it is about another point).
    symmetric
        Hulls are symmetric about y = 0 and headings cover 0..180 deg only.
    repair
        What may be repaired.

    Raises
    ------
    InputError
        Not such a file, a data set is missing or of another shape, bodies with elastic modes, bodies computed
        without each other where the file has several, or what `repaired` refuses.
    """
    path = Path(path)
    if not path.is_file() or not is_hdf5(path):
        raise InputError("no such HDF5 file", source=path, expected="a .h5 file of BEMIO")
    with opened_hdf5(path, "a .h5 file of BEMIO", foreign=True) as file:
        density, gravity = (
            _scalar(file, "simulation_parameters/rho"),
            _scalar(file, "simulation_parameters/g"),
        )
        omega = np.ravel(_array(file, "simulation_parameters/w")).astype(np.float64)
        headings = np.deg2rad(np.ravel(_array(file, "simulation_parameters/wave_dir")).astype(np.float64))
        depth = _depth(file)
        in_si = "simulation_parameters/scaled" in file and bool(_scalar(file, "simulation_parameters/scaled"))
        groups = sorted(
            (name for name in file if name.startswith("body") and name[4:].isdigit()),
            key=lambda name: int(name[4:]),
        )
        if not groups:
            raise InputError("no group 'body1'", source=path, expected="a .h5 file of BEMIO")
        if not any(f"{group}/hydro_coeffs/excitation" in file for group in groups):
            headings = headings[:0]  # radiation alone
        count, nw, nh = len(groups), len(omega), len(headings)
        n = 6 * count
        mass, damping = np.zeros((nw, n, n)), np.zeros((nw, n, n))
        infinite = np.full((n, n), np.nan)
        excitation = np.zeros((nw, nh, n), dtype=np.complex128)
        names, centres, buoyancy, volumes, stiffness, drifts = [], [], [], [], [], []
        for b, group in enumerate(groups):
            rows = slice(6 * b, 6 * b + 6)
            body, coefficients = file[group], f"{group}/hydro_coeffs"
            mass[:, rows] = np.moveaxis(_shaped(file, f"{coefficients}/added_mass/all", (6, n, nw)), 2, 0)
            if f"{coefficients}/added_mass/inf_freq" in file:
                infinite[rows] = _shaped(file, f"{coefficients}/added_mass/inf_freq", (6, n))
            damping[:, rows] = np.moveaxis(
                _shaped(file, f"{coefficients}/radiation_damping/all", (6, n, nw)), 2, 0
            )
            if nh:
                real = _shaped(file, f"{coefficients}/excitation/re", (6, nh, nw))
                imaginary = _shaped(file, f"{coefficients}/excitation/im", (6, nh, nw))
                # conjugate: exp(+i omega t) to exp(-i omega t)
                excitation[:, :, rows] = np.transpose(real - 1j * imaginary, (2, 1, 0))
                drifts.append(_mean_drift(file, coefficients, (6, nh, nw)))
            stiffness.append(_shaped(file, f"{coefficients}/linear_restoring_stiffness", (6, 6)))
            centres.append(np.ravel(_array(file, f"{group}/properties/cg")))
            buoyancy.append(np.ravel(_array(file, f"{group}/properties/cb")))
            volumes.append(_scalar(file, f"{group}/properties/disp_vol"))
            names.append(_name(body, group))
    if not in_si:
        mass, infinite = mass * density, infinite * density
        damping = damping * density * omega[:, None, None]
        excitation = excitation * density * gravity
        stiffness = [matrix * density * gravity for matrix in stiffness]
        drifts = [None if values is None else values * density * gravity for values in drifts]
    up, turned = np.argsort(omega), np.argsort(headings)
    references = np.array(centres)
    if reference_points is not None:
        references = np.asarray(reference_points, dtype=np.float64).reshape(count, 3)
    given = [values for values in drifts if values is not None]
    drift = np.concatenate(given, axis=2)[up][:, turned] if len(given) == count else None
    same = np.allclose(references, np.array(centres), atol=1e-6)
    database = HydrodynamicDatabase(
        bodies=tuple(names),
        omega=omega[up],
        headings=headings[turned],
        added_mass=mass[up],
        damping=damping[up],
        added_mass_infinite=infinite,
        excitation=excitation[up][:, turned],
        reference_points=references,
        density=density,
        gravity=gravity,
        depth=depth,
        source=str(path),
        symmetric=symmetric,
        drift=drift,
        volumes=np.array(volumes),
        centres_of_buoyancy=np.array(buoyancy),
        hydrostatic_stiffness=np.array(stiffness) if same else None,
    )
    return repaired(database, repair)


def _array(file: Any, name: str) -> NDArray[np.float64]:
    """A data set, or the error that names it."""
    if name not in file:
        raise InputError(f"there is no '{name}'", source=file.filename, expected="a .h5 file of BEMIO")
    values = np.asarray(file[name][()] if hasattr(file[name], "dtype") else None)
    if values.dtype.kind not in "iuf":
        raise InputError(
            "is a group" if values.dtype.kind == "O" else f"is of type {values.dtype}",
            source=file.filename,
            key=name,
            expected="numbers",
        )
    return values


def _scalar(file: Any, name: str) -> float:
    """A data set of one number."""
    values = np.ravel(_array(file, name))
    if values.size != 1:
        raise InputError(f"{values.size} values", source=file.filename, key=name, expected="one")
    return float(values[0])


def _shaped(file: Any, name: str, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """A data set of exactly this shape."""
    values = _array(file, name).astype(np.float64)
    if values.shape != shape:
        raise InputError(
            f"shape {values.shape}",
            source=file.filename,
            key=name,
            expected=f"{shape}: six rigid motions of each body, all bodies in one computation",
        )
    return values


def _mean_drift(file: Any, coefficients: str, shape: tuple[int, ...]) -> NDArray[np.float64] | None:
    """(nw, nh, 6) mean drift, of the first way in which it was computed: control surface, pressure, momentum."""
    for way in ("control_surface", "pressure_integration", "momentum_conservation"):
        name = f"{coefficients}/mean_drift/{way}/val"
        if name in file:
            return np.transpose(_shaped(file, name, shape), (2, 1, 0))
    return None


def _depth(file: Any) -> float:
    """Depth of the water [m]; deep water is written as a word."""
    value = (
        file["simulation_parameters/water_depth"][()] if "simulation_parameters/water_depth" in file else b""
    )
    text = value.decode() if isinstance(value, bytes) else str(np.ravel(value)[0])
    if text.strip().lower() in {"infinite", "inf"}:
        return float("inf")
    try:
        return float(text)
    except ValueError:
        raise InputError(
            repr(text),
            source=file.filename,
            key="simulation_parameters/water_depth",
            expected="metres or 'infinite'",
        ) from None


def _name(body: Any, group: str) -> str:
    """Name of a body, of its group if it has none."""
    if "properties/name" not in body:
        return group
    value = np.ravel(body["properties/name"][()])[0]
    return value.decode() if isinstance(value, bytes) else str(value)
