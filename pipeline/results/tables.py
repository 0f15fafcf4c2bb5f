"""Records of a run as xarray and pandas have tables: with names, units and components."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Records", "data_frame", "dataset"]


class Records(Protocol):
    """Results, as far as tables are made of them: see `heavylift.pipeline.results.histories.Results`."""

    time: NDArray[np.float64]
    metadata: dict[str, Any]

    def __getitem__(self, name: str) -> NDArray[np.float64]: ...

    def channel(self, name: str) -> Any:
        """Unit and components of a channel."""


def dataset(results: Records, names: Sequence[str]) -> Any:
    """An `xarray.Dataset` of some channels over ``time``.

    Parameters
    ----------
    results
        Records of a run.
    names
        Channels, or combinations of them.

    Returns
    -------
    xarray.Dataset
        A variable for each, with its ``units``; those of several components have a dimension for them, whose
        coordinates are their names.

    Raises
    ------
    InputError
        If a channel does not exist, or xarray is not installed.
    """
    xarray = _library("xarray", "to_xarray")
    dimensions: dict[tuple[str, ...], str] = {}
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {"time": ("time", results.time.copy(), {"units": "s"})}
    for name in names:
        info, values = results.channel(name), results[name].copy()
        if values.ndim == 1:
            variables[name] = ("time", values, {"units": info.unit})
            continue
        if info.components not in dimensions:
            dimension = (
                "".join(info.components) if all(len(one) == 1 for one in info.components) else "component"
            )
            taken = set(dimensions.values())
            dimensions[info.components] = dimension if dimension not in taken else f"{dimension}_{len(taken)}"
        dimension = dimensions[info.components]
        coordinates[dimension] = (dimension, list(info.components))
        variables[name] = (("time", dimension), values, {"units": info.unit})
    attributes = {key: str(results.metadata[key]) for key in ("title", "outcome") if key in results.metadata}
    return xarray.Dataset(variables, coordinates, attributes)


def data_frame(results: Records, names: Sequence[str]) -> Any:
    """A `pandas.DataFrame` of some channels: a column for each component, the index is the time [s].

    Parameters
    ----------
    results
        Records of a run.
    names
        Channels, or combinations of them.

    Returns
    -------
    pandas.DataFrame
        Columns ``"hoist.tension"``, ``"load.position.x"``, ...; their units are ``frame.attrs["units"]``.

    Raises
    ------
    InputError
        If a channel does not exist, or pandas is not installed.
    """
    pandas = _library("pandas", "to_pandas")
    columns, units = {}, {}
    for name in names:
        info, values = results.channel(name), results[name].copy()
        parts = [name] if values.ndim == 1 else [f"{name}.{one}" for one in info.components]
        for part, column in zip(parts, values.reshape(len(values), -1).T, strict=True):
            columns[part], units[part] = column, info.unit
    frame = pandas.DataFrame(columns, index=pandas.Index(results.time.copy(), name="time"))
    frame.attrs["units"] = units
    return frame


def _library(name: str, key: str) -> Any:
    from importlib import import_module

    try:
        return import_module(name)
    except ImportError:
        raise InputError(
            f"the package {name} is not installed", key=key, expected='it: `pip install "heavylift[data]"`'
        ) from None
