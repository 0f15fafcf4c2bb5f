"""What is in a netCDF file, read without the library of netCDF.

A netCDF-4 file is an HDF5 file whose axes are "dimension scales"; a netCDF-3 file is read by SciPy (NetCDF file
format specifications, Unidata).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["Variable", "load_variables"]


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
    if h5py.is_hdf5(path):
        with h5py.File(path, "r") as file:
            return (
                {name: _from_hdf5(item) for name, item in file.items() if isinstance(item, h5py.Dataset)},
                {key: _text(value) for key, value in file.attrs.items()},
            )
    from scipy.io import netcdf_file

    try:
        with netcdf_file(path, "r", mmap=False) as classic:
            variables = {
                name: Variable(tuple(item.dimensions), _letters(np.array(item.data)), _attributes_of(item))
                for name, item in classic.variables.items()
            }
            return variables, {key: _text(value) for key, value in classic._attributes.items()}  # noqa: SLF001
    except (TypeError, ValueError) as error:
        raise InputError(f"{error}", source=path, expected="a netCDF file") from None


def _from_hdf5(item: Any) -> Variable:
    """One HDF5 data set: its axes are the scales attached to it, or itself if it is one."""
    values = item.asstr()[()] if item.dtype.kind == "O" else item[()]
    axes = [
        (scales[0] if len(scales) else item).name.rsplit("/", 1)[-1] for scales in item.dims if item.shape
    ]
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
