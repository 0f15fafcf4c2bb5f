"""Makes the kind of wind and current loads from what a user says, and checks it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, filled_rows, records
from heavylift.solver.interface import FORCES
from heavylift.solver.markers import MarkerBook
from heavylift.solver.scene.channels import ChannelBook
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.wind_loads import (
    CurrentField,
    CurrentOutputs,
    CurrentProfile,
    DragElement,
    FluctuationRecord,
    FluidField,
    FluidLoad,
    LoadOutputs,
    Veering,
    WindField,
    WindOutputs,
)
from heavylift.solver.water.wind.coefficients import CoefficientLoad, coefficient_curves
from heavylift.solver.water.wind.forces import (
    BOX,
    COEFFICIENTS,
    LOG,
    POWER,
    SAME_ALL_ROUND,
    TABLE,
    CurvePiece,
    FieldData,
    FluidLoads,
    LoadData,
    PresentFlow,
    TablePoint,
)
from heavylift.solver.water.wind.spectrum import (
    HOUR,
    REFERENCE_HEIGHT,
    gust_coefficient,
    hourly_mean,
    profile_slope,
)

__all__ = ["add_fluid_channels", "fluid_markers", "fluid_pieces", "pack_fluid_loads", "put_wind"]

INTENSITY_EXPONENT = -0.22
"""Of the turbulence intensity over the height, ISO 19901-1."""

Array = NDArray[np.float64]


def fluid_pieces(loads: Sequence[FluidLoad]) -> list[Any]:
    """Tables of coefficients and elements with drag that loads are made of."""
    return [piece for load in loads for piece in load.pieces()]


def fluid_markers(book: MarkerBook, loads: Sequence[Any]) -> list[tuple[int, int]]:
    """New markers of each load: its point, and its heading or -1 where that does not matter."""
    made = []
    for load in loads:
        point = np.asarray(load.point, dtype=np.float64)
        number = book.point(load.body, point, FORCES)
        if isinstance(load, DragElement) and np.ndim(load.area) == 0:
            made.append((number, -1))
            continue
        axis = np.asarray(load.axis, dtype=np.float64)
        length = float(np.linalg.norm(axis)) if axis.shape == (3,) else 0.0
        if not 0.0 < length < np.inf:
            raise InputError(
                f"axis {axis.tolist()}",
                source=load.name,
                key="axis",
                expected="three numbers, a direction that is not zero",
            )
        made.append((number, book.direction(load.body, axis / length, FORCES, at=point)))
    return made


def add_fluid_channels(
    record: ChannelBook, fields: Sequence[FluidField], loads: Sequence[FluidLoad]
) -> dict[str, Columns]:
    """Append the channels of each field, then of each name of loads; where they are, by name."""
    columns = {one.name: record.add(one.name, one.CHANNELS) for one in fields}
    for name in dict.fromkeys(load.name for load in loads):
        kinds = dict.fromkeys(kind for load in loads if load.name == name for kind in load.CHANNELS)
        columns[name] = record.add(name, kinds)
    return columns


def pack_fluid_loads(
    fields: Sequence[FluidField],
    loads: Sequence[Any],
    markers: Sequence[tuple[int, int]],
    columns: Mapping[str, Columns],
    *,
    level: float = 0.0,
    ramp: float = 0.0,
    water_density: float = 1025.0,
) -> FluidLoads:
    """Make the kind.

    Parameters
    ----------
    fields
        Winds and currents, names of their own.
    loads
        What they push on, from `fluid_pieces`.
    markers
        Of each load, from `fluid_markers`.
    columns
        From `add_fluid_channels`.
    level
        Height of the still water [m].
    ramp
        Time [s] in which speeds grow from zero, as ``(1 - cos(pi t / ramp)) / 2``.
    water_density
        [kg/m3].

    Raises
    ------
    InputError
        If a number makes no sense, a table does not fit, or a load names a field that does not exist.
    """
    names = [one.name for one in fields]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError(f"two fields named {twice!r}", source="wind and current", key="name", expected="one")
    profiles, turns, fluctuations, curves = _Rows(2), _Rows(2), _Rows(1), _Rows(13)
    _check_water(level, ramp, water_density)
    field_rows, load_rows = records(FieldData, len(fields)), records(LoadData, len(loads))
    for data, one in zip(field_rows, fields, strict=True):
        data.turn_first, data.turn_count = turns.add(_direction(one))
        profile, record = put_wind(one, data) if isinstance(one, WindField) else _current(one, data)
        data.profile_first, data.profile_count = profiles.add(profile)
        data.record_first, data.record_count = fluctuations.add(record)
        data.column = columns[one.name].at(WindOutputs if isinstance(one, WindField) else CurrentOutputs)
        data.level, data.ramp = level, ramp
        if isinstance(one, CurrentField):
            data.density = water_density
    for row, load, (point, heading) in zip(load_rows, loads, markers, strict=True):
        _check_load(load, names)
        row.field, row.marker, row.heading = names.index(load.fluid), point, heading
        row.column = columns[load.name].at(LoadOutputs)
        if isinstance(load, CoefficientLoad):
            row.sort = COEFFICIENTS
            row.curve_first, row.curve_count = curves.add(coefficient_curves(load))
        else:
            row.sort = SAME_ALL_ROUND if heading < 0 else BOX
            areas = np.zeros(3)
            areas[: np.size(load.area)] = load.area
            row.area[:] = load.coefficient * areas
            row.extent, row.vertical = load.extent, load.vertical
    return FluidLoads(
        field_rows,
        _points(profiles.table()),
        _points(turns.table()),
        fluctuations.table().ravel(),
        records(PresentFlow, len(fields)),
        load_rows,
        _pieces(curves.table()),
    )


def _points(table: Array) -> Records[TablePoint]:
    """Points of functions, of columns with arguments and values."""
    at, value = table.T
    return filled_rows(TablePoint, at=at, value=value)


def _pieces(table: Array) -> Records[CurvePiece]:
    """Pieces of curves, of columns with arguments and the coefficients of three cubics."""
    at, x, y, turn = np.split(table, [1, 5, 9], axis=1)
    return filled_rows(CurvePiece, at=at[:, 0], x=x, y=y, turn=turn)


class _Rows:
    """Tables one below the other."""

    def __init__(self, width: int) -> None:
        self._blocks = [np.zeros((0, width))]

    def add(self, block: Array) -> tuple[int, int]:
        """First row and number of rows of a new one."""
        first = sum(map(len, self._blocks))
        self._blocks.append(block)
        return first, len(block)

    def table(self) -> Array:
        """All of them."""
        return np.ascontiguousarray(np.vstack(self._blocks))


def put_wind(wind: WindField, data: FieldData) -> tuple[Array, Array]:
    """Fill the numbers of a field; rows of the profile and of the fluctuation."""
    speed = hourly_mean(wind.speed, wind.averaging_time) if wind.averaging_time < HOUR else wind.speed
    sorts = {"log": LOG, "power": POWER, "uniform": TABLE}
    if wind.profile not in sorts:
        raise InputError(
            f"profile {wind.profile!r}", source=wind.name, key="profile", expected="log, power or uniform"
        )
    sort = sorts[wind.profile]
    shape = profile_slope(speed) if sort == LOG else wind.exponent
    gust = 0.0
    if wind.gust is not None:
        if wind.fluctuation is not None:
            raise InputError(
                "a gust and a fluctuation",
                source=wind.name,
                key="gust",
                expected="one of them: gusts are part of it",
            )
        gust = gust_coefficient(wind.gust, speed)
    record, step = np.zeros((0, 1)), 1.0
    if wind.fluctuation is not None:
        record, step = _record(wind.fluctuation, wind.name), wind.fluctuation.step
    exponent = 0.0 if sort == TABLE else INTENSITY_EXPONENT
    data.profile, data.density, data.side, data.speed, data.shape = sort, wind.density, 1.0, speed, shape
    data.gust, data.gust_exponent = gust, exponent
    data.record_step, data.recorded_height = step, REFERENCE_HEIGHT
    profile = np.array([[0.0, speed]]) if sort == TABLE else np.zeros((0, 2))
    return profile, record


def _current(current: CurrentField, data: FieldData) -> tuple[Array, Array]:
    """As `put_wind`."""
    rows = np.array([[0.0, current.speed]])
    if isinstance(current.speed, CurrentProfile):
        # heights above the still water, increasing
        rows = np.column_stack([-np.asarray(current.speed.depths), current.speed.speeds])[::-1]
    data.profile, data.side, data.record_step = TABLE, -1.0, 1.0
    return rows, np.zeros((0, 1))


def _check_water(level: float, ramp: float, density: float) -> None:
    _positive(density, "water", "density", "kg/m3")
    if not math.isfinite(level):
        raise InputError(f"level {level:g} m", source="water", key="level", expected="a height")
    if not 0.0 <= ramp < math.inf:
        raise InputError(f"ramp {ramp:g} s", source="sea", key="ramp", expected="a time, or 0 for none")


def _positive(value: float, source: str, key: str, unit: str, largest: float = math.inf) -> None:
    if not (0.0 < value <= largest and math.isfinite(value)):
        limit = "" if math.isinf(largest) else f" up to {largest:g} {unit}"
        raise InputError(f"{value:g} {unit}", source=source, key=key, expected=f"a positive number{limit}")


def _direction(one: FluidField) -> Array:
    """Rows of time and angle."""
    if isinstance(one.direction, Veering):
        return np.column_stack([one.direction.times, one.direction.angles])
    return np.array([[0.0, one.direction]])


def _record(record: FluctuationRecord, source: str) -> Array:
    values = np.asarray(record.values, dtype=np.float64)
    if values.ndim != 1 or len(values) < 2 or not np.all(np.isfinite(values)):
        raise InputError(
            f"record of shape {values.shape}",
            source=source,
            key="fluctuation",
            expected="two or more finite speeds",
        )
    _positive(record.step, source, "fluctuation", "s")
    return values[:, None]


def _check_load(load: Any, fields: Sequence[str]) -> None:
    if load.fluid not in fields:
        raise InputError(
            f"there is no field {load.fluid!r}",
            source=load.name,
            key="fluid",
            expected=f"one of {', '.join(fields)}" if fields else "a wind or a current in the scene",
        )
    _finite(load.point, 3, load.name, "point")
    if isinstance(load, CoefficientLoad):
        for key in ("area_x", "area_y", "length"):
            _positive(getattr(load, key), load.name, key, "m" if key == "length" else "m2")
        return
    if np.size(load.area) not in {1, 3} or not np.all(
        (np.asarray(load.area) >= 0.0) & np.isfinite(load.area)
    ):
        raise InputError(
            f"area {load.area}",
            source=load.name,
            key="area",
            expected="one area, or three along x, y and z, in m2",
        )
    if not 0.0 <= load.coefficient < math.inf:
        raise InputError(
            f"coefficient {load.coefficient:g}",
            source=load.name,
            key="coefficient",
            expected="a number from 0",
        )
    if not 0.0 <= load.extent < math.inf:
        raise InputError(
            f"extent {load.extent:g} m", source=load.name, key="extent", expected="a height, or 0"
        )


def _finite(values: ArrayLike, count: int, source: str, key: str) -> None:
    given = np.asarray(values, dtype=np.float64)
    if given.shape != (count,) or not np.all(np.isfinite(given)):
        raise InputError(f"{given.tolist()}", source=source, key=key, expected=f"{count} finite numbers")
