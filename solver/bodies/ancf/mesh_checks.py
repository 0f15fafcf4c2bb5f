"""What is refused of frames and shells alike before they become numbers: supports, loads, arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.meshes import DistributedLoad, FollowerLoad, MeshBody

__all__ = ["check_finite", "check_load", "check_numbers", "check_supports"]


def check_supports(body: MeshBody, vectors: Sequence[str]) -> None:
    """Nodes and axes of all supports; vectors as of the type of mesh."""
    for i, support in enumerate(body.supports):
        key = f"supports[{i}]"
        check_numbers(body, f"{key}.nodes", np.asarray(support.nodes), len(body.nodes), "node")
        for vector, axes in support.fixed.items():
            if vector not in vectors:
                raise InputError(
                    f"{vector!r}",
                    source=body.name,
                    key=f"{key}.fixed",
                    expected=f"one of {', '.join(vectors)}",
                )
            if not axes or set(axes) - set("xyz") or len(set(axes)) != len(axes):
                raise InputError(
                    f"{axes!r}",
                    source=body.name,
                    key=f"{key}.fixed.{vector}",
                    expected="some of the letters x, y, z",
                )


def check_load(body: MeshBody, number: int, load: DistributedLoad | FollowerLoad) -> None:
    """Numbers, shapes and tables of a load."""
    key = f"loads[{number}]"
    times, factors = np.atleast_1d(load.times), np.atleast_1d(load.factors)
    check_finite(body, f"{key}.times", times, (max(len(times), 1),))
    check_finite(body, f"{key}.factors", factors, times.shape)
    if np.any(np.diff(times) <= 0.0):
        raise InputError(
            f"{times.tolist()}", source=body.name, key=f"{key}.times", expected="increasing times"
        )
    if load.elements is not None:
        count = len(body.elements)  # type: ignore[attr-defined]
        check_numbers(body, f"{key}.elements", np.asarray(load.elements), count, "element")
    if isinstance(load, DistributedLoad):
        check_finite(body, f"{key}.load", np.asarray(load.load), (3,))
        return
    check_finite(body, f"{key}.normal", np.asarray(load.normal), ())
    check_finite(body, f"{key}.tangential", np.asarray(load.tangential), ())
    check_finite(body, f"{key}.axis", np.asarray(load.axis), (3,))
    if load.normal and not np.any(load.axis):
        raise InputError("length zero", source=body.name, key=f"{key}.axis", expected="a direction")
    if load.node is not None:
        check_numbers(body, f"{key}.node", np.asarray([load.node]), len(body.nodes), "node")


def check_finite(body: MeshBody, key: str, value: NDArray[np.float64], shape: tuple[int, ...]) -> None:
    """An array of a shape, with finite numbers."""
    if value.shape != shape:
        raise InputError(f"shape {value.shape}", source=body.name, key=key, expected=f"shape {shape}")
    if not np.all(np.isfinite(value)):
        place = [int(i) for i in np.argwhere(~np.isfinite(value))[0]]
        raise InputError(
            f"{value[tuple(place)]} at {place}", source=body.name, key=key, expected="finite numbers"
        )


def check_numbers(body: MeshBody, key: str, value: NDArray[np.int64], count: int, what: str) -> None:
    """Whole numbers of things that are there."""
    wrong = value[(value < 0) | (value >= count)]
    if value.dtype.kind not in "iu" or wrong.size:
        number = wrong.ravel()[0] if wrong.size else value.dtype
        raise InputError(
            f"there is no {what} {number}",
            source=body.name,
            key=key,
            expected=f"numbers of {what}s, 0 to {count - 1}",
        )
