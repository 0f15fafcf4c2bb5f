"""Hydrodynamic databases as netCDF files: our own, and those that Capytaine writes.

A netCDF-4 file is an HDF5 file whose axes are "dimension scales"; h5py writes and reads these, so that no
other package is needed; a netCDF-3 file is read by SciPy (NetCDF file format specifications, Unidata). Names of axes
and variables are Capytaine's, so one reader serves both, and both open with xarray. Ours adds what Capytaine
leaves to the reader: time convention, reference of the phase, units, the limit of infinite frequency.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np

from heavylift.numerics.hdf5_files import is_hdf5, opened_hdf5, reported_of_file
from heavylift.numerics.outcome import InputError
from heavylift.numerics.words import check_word
from heavylift.preprocess.hydrodynamics.database import (
    COORDINATES,
    HydrodynamicDatabase,
    check_database,
)
from heavylift.preprocess.hydrodynamics.repairs import repaired
from heavylift.preprocess.hydrodynamics.words import TimeConvention

if TYPE_CHECKING:
    from collections.abc import Mapping

    import h5py
    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.repairs import Repair

__all__ = [
    "Variable",
    "load_variables",
    "read_digest",
    "read_netcdf",
    "write_netcdf",
    "write_variables",
]


class Variable(NamedTuple):
    """One variable: names of its axes, values (text as `str`), attributes such as ``units``."""

    axes: tuple[str, ...]
    values: NDArray[Any]
    attributes: dict[str, Any]


def load_variables(path: Path) -> tuple[dict[str, Variable], dict[str, Any]]:
    """Variables with the names of their axes, and the attributes of the file.

    Raises
    ------
    InputError
        There is no such file, or it is none of netCDF-4 and netCDF-3.
    """
    import h5py

    if not path.is_file():
        raise InputError("no such file", source=path, expected="a netCDF file")
    if is_hdf5(path):
        with opened_hdf5(path, "a netCDF file", foreign=True) as file:
            return (
                {
                    name: _from_hdf5(name, item, path)
                    for name, item in file.items()
                    if isinstance(item, h5py.Dataset)
                },
                {key: _text(value) for key, value in file.attrs.items()},
            )
    from scipy.io import netcdf_file

    with reported_of_file(path, "a netCDF file"), netcdf_file(path, "r", mmap=False) as classic:
        variables = {
            name: Variable(tuple(item.dimensions), _letters(np.array(item.data)), _attributes_of(item))
            for name, item in classic.variables.items()
        }
        return variables, {key: _text(value) for key, value in classic._attributes.items()}  # noqa: SLF001


def _from_hdf5(name: str, item: Any, path: Path) -> Variable:
    """One HDF5 data set: its axes are the scales attached to it, or itself if it is one."""
    values = item.asstr()[()] if item.dtype.kind == "O" else item[()]
    scales = [(along[0] if len(along) else item).name for along in item.dims if item.shape]
    if None in scales:
        raise InputError(
            f"the scale of its axis {scales.index(None)} is not in the file",
            source=path,
            key=name,
            expected="a netCDF file, which has a variable for each axis",
        )
    axes = [scale.rsplit("/", 1)[-1] for scale in scales]
    hidden = ("REFERENCE_LIST", "DIMENSION_LIST", "CLASS", "NAME")
    attributes = {key: _text(item.attrs[key]) for key in item.attrs if key not in hidden}
    return Variable(tuple(axes), np.asarray(values), attributes)


def _attributes_of(item: Any) -> dict[str, Any]:
    """Attributes of one variable of a classic file."""
    return {key: _text(value) for key, value in item._attributes.items()}  # noqa: SLF001


def _letters(values: NDArray[Any]) -> NDArray[Any]:
    """Names, which a classic file keeps as rows of single letters."""
    if values.dtype.kind != "S":
        return values
    return np.array([b"".join(row).decode().rstrip("\0 ") for row in np.atleast_2d(values)])


def _text(value: Any) -> Any:
    """Bytes as text; anything else as it is."""
    return value.decode() if isinstance(value, bytes) else value


TIME_CONVENTION, OPPOSITE_CONVENTION = get_args(TimeConvention)
HEADING_CONVENTION = "direction of propagation, anticlockwise from +x seen from above"
PHASE_CONVENTION = "crest of the incident wave at the origin (0, 0) at t = 0"
FORMAT = "heavylift hydrodynamic database 1"

UNITS = {
    "omega": "rad/s",
    "wave_direction": "rad",
    "rho": "kg/m^3",
    "g": "m/s^2",
    "water_depth": "m",
    "rotation_center": "m",
    "added_mass": "kg, kg m, kg m^2",
    "added_mass_infinite": "kg, kg m, kg m^2",
    "radiation_damping": "kg/s, kg m/s, kg m^2/s",
    "excitation_force": "N/m, N",
    "drift_force": "N/m^2, N/m",
    "volume": "m^3",
    "center_of_buoyancy": "m",
    "hydrostatic_stiffness_without_weight": "N/m, N, N m",
}


def write_netcdf(
    path: Path | str, database: HydrodynamicDatabase, *, digest: str = "", checked: bool = True
) -> None:
    """Write ``database``, compressed, double precision.

    Parameters
    ----------
    path
        File, overwritten.
    database
        As `check_database` accepts it.
    digest
        Key of the inputs it was computed from, stored as the attribute ``digest``.
    checked
        False: of a database that is kept though it is refused.

    Raises
    ------
    InputError
        From `check_database`.
    """
    import h5py

    if checked:
        check_database(database)
    dofs = [f"{body}__{name.capitalize()}" for body in database.bodies for name in COORDINATES]
    n = len(dofs)
    axes: dict[str, Any] = {
        "omega": database.omega,
        "wave_direction": database.headings,
        "radiating_dof": dofs,
        "influenced_dof": dofs,
        "body": list(database.bodies),
        "space_coordinate": ["x", "y", "z"],
        "complex": ["re", "im"],
        "force": list(COORDINATES),
        "motion": list(COORDINATES),
    }
    square = ("influenced_dof", "radiating_dof")
    excitation = np.stack([database.excitation.real, database.excitation.imag])
    variables: dict[str, tuple[tuple[str, ...], Any]] = {
        "added_mass": (("omega", *square), database.added_mass),
        "radiation_damping": (("omega", *square), database.damping),
        "added_mass_infinite": (square, database.added_mass_infinite.reshape(n, n)),
        "excitation_force": (
            ("complex", "omega", "wave_direction", "influenced_dof"),
            excitation if database.has_excitation else None,
        ),
        "rotation_center": (("body", "space_coordinate"), database.reference_points),
        "rho": ((), database.density),
        "g": ((), database.gravity),
        "water_depth": ((), database.depth),
        "drift_force": (("omega", "wave_direction", "influenced_dof"), database.drift),
        "volume": (("body",), database.volumes),
        "center_of_buoyancy": (("body", "space_coordinate"), database.centres_of_buoyancy),
        "hydrostatic_stiffness_without_weight": (
            ("body", "force", "motion"),
            database.hydrostatic_stiffness,
        ),
    }
    with h5py.File(path, "w", track_order=True) as file:
        for key, text in (
            ("Conventions", "CF-1.8"),
            ("title", FORMAT),
            ("source", database.source),
            ("time_convention", TIME_CONVENTION),
            ("heading_convention", HEADING_CONVENTION),
            ("phase_convention", PHASE_CONVENTION),
            ("digest", digest),
        ):
            file.attrs[key] = np.bytes_(text.encode("utf-8", "backslashreplace"))
        file.attrs["symmetric"] = np.int32(database.symmetric)
        if database.repairs:
            file.attrs["repairs"] = np.bytes_("\n".join(database.repairs).encode("utf-8", "backslashreplace"))
        write_variables(file, axes, variables, UNITS)


def write_variables(
    file: h5py.File,
    axes: Mapping[str, Any],
    variables: Mapping[str, tuple[tuple[str, ...], Any]],
    units: Mapping[str, str],
) -> None:
    """Write axes (numbers, or lists of text) and variables along them, those of more than two compressed; not None."""
    import h5py

    for name, values in axes.items():
        is_text = isinstance(values, list)
        scale = file.create_dataset(name, data=values, dtype=h5py.string_dtype() if is_text else np.float64)
        scale.make_scale(name)
        if name in units:
            scale.attrs["units"] = np.bytes_(units[name].encode())
    for name, (along, values) in variables.items():
        if values is None:
            continue
        array = np.asarray(values)
        array = array if array.dtype.kind == "i" else array.astype(np.float64)
        packed = {"compression": "gzip", "compression_opts": 9, "shuffle": True} if len(along) > 2 else {}
        data = file.create_dataset(name, data=array, **packed)
        for place, axis in enumerate(along):
            data.dims[place].attach_scale(file[axis])
        data.attrs["units"] = np.bytes_(units[name].encode())


def read_netcdf(
    path: Path | str,
    *,
    time_convention: TimeConvention | None = None,
    reference_points: NDArray[np.float64] | None = None,
    checked: bool = True,
    repair: Repair | None = None,
) -> HydrodynamicDatabase:
    """Read a file of `write_netcdf` or of Capytaine (netCDF-4, or netCDF-3 as xarray writes without its library).

    Without diffraction there are no exciting forces: such a database serves motions in still water.

    Parameters
    ----------
    path
        File.
    time_convention
        Of a file of another program that does not state it, see `words.TimeConvention`.
    reference_points
        (N, 3) [m] for a file that does not state them (``rotation_center``).
    checked
        False: as it is in the file, also if it is to be refused.
    repair
        What may be repaired.

    Raises
    ------
    InputError
        Not such a file, something is missing (a variable, one of six coordinates, the time convention, the reference
        points), units other than SI, a forward speed, or what `repaired` refuses.
    """
    if time_convention is not None:
        check_word(time_convention, TimeConvention, source=str(path), key="time_convention")
    variables, attributes = load_variables(Path(path))
    with reported_of_file(Path(path), "variables with the axes and types of a hydrodynamic database"):
        database = _database_of(variables, attributes, str(path), time_convention, reference_points)
    return repaired(database, repair) if checked else database


def _database_of(
    variables: dict[str, Variable],
    attributes: dict[str, Any],
    source: str,
    time_convention: TimeConvention | None,
    reference_points: NDArray[np.float64] | None,
) -> HydrodynamicDatabase:
    """What the variables of a file say, in our order."""
    convention = time_convention or _convention(attributes, source)
    bodies, order = _coordinates(variables, source)
    n = len(order)
    _check_declared_units(variables, source)
    speed = variables.get("forward_speed")
    if speed is not None and np.any(np.asarray(speed.values, dtype=float) != 0.0):
        raise InputError("a forward speed", source=source, key="forward_speed", expected="0")
    steps = _named(variables, "omega", source)
    omega = np.atleast_1d(_numbers(variables, "omega", source))
    along = (
        steps.axes[0] if steps.axes else "omega"
    )  # Capytaine has periods or wave numbers there if asked for them
    finite = np.flatnonzero(np.isfinite(omega) & (omega > 0.0))
    finite = finite[np.argsort(omega[finite])]
    square = (along, "influenced_dof", "radiating_dof")
    mass = _arranged(variables, "added_mass", square, source)[:, order][:, :, order]
    damping = _arranged(variables, "radiation_damping", square, source)[:, order][:, :, order]
    infinite = _infinite(variables, omega, mass, order, source)
    waves = ("complex", along, "wave_direction", "influenced_dof")
    excitation, turned = np.zeros((len(finite), 0, n), dtype=np.complex128), np.zeros(0, dtype=np.int64)
    headings = np.zeros(0)
    repairs = tuple(str(attributes.get("repairs", "")).splitlines())
    parts: tuple[str, ...] = ("Froude_Krylov_force", "diffraction_force")
    if "excitation_force" in variables:
        parts = ("excitation_force",)
    elif len(set(parts) & variables.keys()) == 1:
        repairs = (*repairs, "Froude-Krylov force or diffraction alone are no exciting forces: left out")
    if all(part in variables for part in parts):
        headings = np.atleast_1d(_numbers(variables, "wave_direction", source))
        turned = np.argsort(headings)
        real, imaginary = np.sum([_arranged(variables, part, waves, source) for part in parts], axis=0)
        excitation = (real + 1j * imaginary)[finite][:, turned][:, :, order]
    if convention == OPPOSITE_CONVENTION:
        excitation = excitation.conj()
    references = _reference_points(variables, reference_points, len(bodies), source)
    drift = None
    if len(headings) and "drift_force" in variables and attributes.get("title") == FORMAT:
        drift = _arranged(variables, "drift_force", waves[1:], source)[finite][:, turned][:, :, order]
    constants = {key: _scalar(variables, key, source) for key in ("rho", "g", "water_depth")}
    volumes, centres = _displaced(variables, len(bodies), constants["rho"], source)
    return HydrodynamicDatabase(
        bodies=bodies,
        omega=omega[finite],
        headings=headings[turned],
        added_mass=mass[finite],
        damping=damping[finite],
        added_mass_infinite=infinite.reshape(n, n),
        excitation=excitation,
        reference_points=references,
        density=constants["rho"],
        gravity=constants["g"],
        depth=constants["water_depth"],
        source=source,
        symmetric=bool(attributes.get("symmetric", 0)),
        drift=drift,
        volumes=volumes,
        centres_of_buoyancy=centres,
        hydrostatic_stiffness=_stiffness(variables, order, references, constants["g"], source),
        repairs=repairs,
    )


def read_digest(path: Path | str) -> str:
    """Key of the inputs a file of `write_netcdf` was computed from, "" if it has none or is not readable."""
    try:
        return str(load_variables(Path(path))[1].get("digest", ""))
    except InputError:
        return ""


def _convention(attributes: dict[str, Any], source: str) -> str:
    """Time convention that the file states, or Capytaine's."""
    stated = str(attributes.get("time_convention", ""))
    if stated in {TIME_CONVENTION, OPPOSITE_CONVENTION}:
        return stated
    if not stated and "capytaine_version" in attributes:
        return TIME_CONVENTION
    raise InputError(
        f"the time convention is {stated!r}" if stated else "the time convention is not stated",
        source=source,
        key="time_convention",
        expected=f"'{TIME_CONVENTION}' or '{OPPOSITE_CONVENTION}'",
    )


def _named(variables: dict[str, Variable], name: str, source: str) -> Variable:
    """The variable, or the error that names it."""
    if name not in variables:
        raise InputError(f"there is no '{name}'", source=source, expected="a hydrodynamic database")
    return variables[name]


def _numbers(variables: dict[str, Variable], name: str, source: str) -> NDArray[np.float64]:
    """Values of a variable that has numbers."""
    values = _named(variables, name, source).values
    if values.dtype.kind not in "iuf":
        raise InputError(f"is of type {values.dtype}", source=source, key=name, expected="numbers")
    return values.astype(np.float64)


def _scalar(variables: dict[str, Variable], name: str, source: str) -> float:
    """One number, of an array of one if need be."""
    values = np.ravel(_numbers(variables, name, source))
    if values.size != 1:
        raise InputError(f"{values.size} values", source=source, key=name, expected="one")
    return float(values[0])


def _arranged(
    variables: dict[str, Variable], name: str, axes: tuple[str, ...], source: str
) -> NDArray[np.float64]:
    """The variable with its axes in this order; an axis that was left out has the length one."""
    variable, numbers = _named(variables, name, source), _numbers(variables, name, source)
    extra = [
        axis
        for axis in variable.axes
        if axis not in axes and variable.values.shape[variable.axes.index(axis)] > 1
    ]
    if extra:
        raise InputError(
            f"axes {', '.join(variable.axes)}", source=source, key=name, expected=f"{', '.join(axes)}"
        )
    present = [axis for axis in axes if axis in variable.axes]
    rest = [axis for axis in variable.axes if axis not in axes]
    values = np.transpose(numbers, [variable.axes.index(a) for a in (*present, *rest)]).reshape(
        [variable.values.shape[variable.axes.index(a)] for a in present]
    )
    for place, axis in enumerate(axes):
        if axis not in present:
            values = np.expand_dims(values, place)
    if "complex" in axes and values.shape[0] != 2:
        raise InputError(
            "no axis of real and imaginary part", source=source, key=name, expected="complex = re, im"
        )
    return values


def _coordinates(variables: dict[str, Variable], source: str) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Names of the bodies, and where their surge .. yaw stand among the coordinates of the file."""
    forces = [str(v) for v in np.atleast_1d(_named(variables, "influenced_dof", source).values)]
    motions = [str(v) for v in np.atleast_1d(_named(variables, "radiating_dof", source).values)]
    if forces != motions:
        raise InputError(
            f"{', '.join(motions)}",
            source=source,
            key="radiating_dof",
            expected=f"the same as influenced_dof: {', '.join(forces)}",
        )
    split = [name.rsplit("__", 1) if "__" in name else ["", name] for name in forces]
    bodies = list(dict.fromkeys(body for body, _ in split))
    places = {(body, name.lower()): i for i, (body, name) in enumerate(split)}
    if len(forces) != 6 * len(bodies) or any((b, c) not in places for b in bodies for c in COORDINATES):
        raise InputError(
            f"coordinates {', '.join(forces)}",
            source=source,
            key="influenced_dof",
            expected="Surge, Sway, Heave, Roll, Pitch, Yaw of each hull",
        )
    if bodies == [""]:
        given = variables.get("body", variables.get("body_name"))
        bodies = [str(np.ravel(given.values)[0]) if given is not None else "hull"]
        return tuple(bodies), np.array([places["", c] for c in COORDINATES])
    return tuple(bodies), np.array([places[b, c] for b in bodies for c in COORDINATES])


def _check_declared_units(variables: dict[str, Variable], source: str) -> None:
    """Units that a file states are ours."""
    for name, unit in UNITS.items():
        if name not in variables:
            continue
        stated = str(variables[name].attributes.get("units", unit))
        if stated != unit:
            raise InputError(f"the unit is '{stated}'", source=source, key=name, expected=f"'{unit}'")


def _infinite(
    variables: dict[str, Variable],
    omega: NDArray[np.float64],
    mass: NDArray[np.float64],
    order: NDArray[np.int64],
    source: str,
) -> NDArray[np.float64]:
    """Added mass of infinite frequency: its own variable, or one of the frequencies, or NaN."""
    if "added_mass_infinite" in variables:
        values = _arranged(variables, "added_mass_infinite", ("influenced_dof", "radiating_dof"), source)
        return values[order][:, order]
    at = np.flatnonzero(np.isinf(omega))
    return mass[at[0]] if at.size else np.full(mass.shape[1:], np.nan)


def _reference_points(
    variables: dict[str, Variable], given: NDArray[np.float64] | None, count: int, source: str
) -> NDArray[np.float64]:
    """Points about which moments are taken: those of the file; given ones must agree."""
    stated = variables.get("rotation_center")
    if stated is None and given is None:
        raise InputError(
            "the reference point of moments is not stated",
            source=source,
            key="rotation_center",
            expected="'reference_points = [[x, y, z]]', the point of each hull about which its moments are (of "
            "Capytaine's most often the centre of mass)",
        )
    read = given if stated is None else _numbers(variables, "rotation_center", source)
    points = np.asarray(read, dtype=np.float64).reshape(-1, 3)
    if points.shape != (count, 3):
        raise InputError(
            f"{len(points)} reference points", source=source, key="rotation_center", expected=f"{count}"
        )
    if (
        stated is not None
        and given is not None
        and not np.allclose(points, np.reshape(given, (-1, 3)), atol=1e-6)
    ):
        raise InputError(
            f"{points.tolist()}",
            source=source,
            key="rotation_center",
            expected=f"the reference points {np.reshape(given, (-1, 3)).tolist()}",
        )
    return points


def _displaced(
    variables: dict[str, Variable], count: int, density: float, source: str
) -> tuple[NDArray[np.float64] | None, NDArray[np.float64] | None]:
    """Volumes and centres of buoyancy, where the file has them."""
    volumes = centres = None
    if "volume" in variables:
        volumes = _numbers(variables, "volume", source).reshape(count)
    elif "disp_mass" in variables:
        volumes = _numbers(variables, "disp_mass", source).reshape(count) / density
    if "center_of_buoyancy" in variables:
        centres = _numbers(variables, "center_of_buoyancy", source).reshape(count, 3)
    return volumes, centres


def _stiffness(
    variables: dict[str, Variable],
    order: NDArray[np.int64],
    references: NDArray[np.float64],
    gravity: float,
    source: str,
) -> NDArray[np.float64] | None:
    """(N, 6, 6) without the terms of weight; those of Capytaine have them, from its mass and its centre."""
    count = len(references)
    if "hydrostatic_stiffness_without_weight" in variables:
        return _numbers(variables, "hydrostatic_stiffness_without_weight", source)
    needed = ("hydrostatic_stiffness", "inertia_matrix", "center_of_mass")
    if any(name not in variables for name in needed):
        return None
    whole = _numbers(variables, "hydrostatic_stiffness", source)[np.ix_(order, order)]
    inertia = _numbers(variables, "inertia_matrix", source)[np.ix_(order, order)]
    arms = _numbers(variables, "center_of_mass", source).reshape(count, 3) - references
    stiffness = np.zeros((count, 6, 6))
    for body, (x, y, z) in enumerate(arms):
        block = slice(6 * body, 6 * body + 6)
        weight = float(inertia[6 * body, 6 * body]) * gravity
        stiffness[body] = whole[block, block]
        stiffness[body, 3, 3] += weight * z
        stiffness[body, 4, 4] += weight * z
        stiffness[body, 3, 5] -= weight * x
        stiffness[body, 4, 5] -= weight * y
    return stiffness
