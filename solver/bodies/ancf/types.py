"""Frames and shells side by side: what their packing modules offer under common names, what is refused of both."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.kind import (
    FRAME_PAIRS,
    SHELL_PAIRS,
    FrameMeshes,
    FramePlaces,
    MeshElement,
    Meshes,
    MeshPlaces,
    RodMeshes,
    RodPlaces,
    ShellMeshElement,
    ShellMeshes,
    ShellPlaces,
)
from heavylift.solver.scene.meshes import (
    FRAME_VECTORS,
    ROD_VECTORS,
    SHELL_VECTORS,
    DistributedLoad,
    FollowerLoad,
    FrameBody,
    FrameMeshOutputs,
    MeshBody,
    RodBody,
    RodMeshOutputs,
    ShellMeshOutputs,
)
from heavylift.solver.scene.outputs import Parts

__all__ = [
    "MeshType",
    "check_finite",
    "check_load",
    "check_numbers",
    "check_supports",
    "type_of",
]


@dataclass(frozen=True)
class MeshType:
    """A type of mesh: its kind, places, outputs, elements, nodal vectors, pairs of nodes, functions of its packing."""

    kind: type[Meshes]
    places: type[MeshPlaces]
    outputs: type[Parts]
    element: type[MeshElement]
    vectors: tuple[str, ...]
    nodes_per_element: int
    pairs: tuple[tuple[int, int], ...]
    check: Callable[[Any], None]
    element_data: Callable[[Any], Any]
    strain_counts: Callable[[Any], Any]
    start_coordinates: Callable[[Any], Any]
    locate: Callable[[Any, Any, str, str], tuple[int, tuple[float, ...]]]
    shape_values: Callable[[Any, int, tuple[float, ...], int], Any]
    load_shape: Callable[[Any, int], Any]
    body_constants: Callable[[Any], Any]
    result_columns: Callable[[Any], dict[str, tuple[str, ...]]]

    @property
    def rows(self) -> int:
        """Coordinates of a node."""
        return 3 * len(self.vectors)


def type_of(body: MeshBody) -> MeshType:
    """The type of a body; imports what serves it."""
    name = "rod" if isinstance(body, RodBody) else "frame" if isinstance(body, FrameBody) else "shell"
    module = importlib.import_module(f"heavylift.solver.bodies.ancf.{name}_packing")
    kinds: dict[str, tuple[type[Meshes], type[MeshPlaces], type[Parts], tuple[str, ...]]] = {
        "frame": (FrameMeshes, FramePlaces, FrameMeshOutputs, FRAME_VECTORS),
        "rod": (RodMeshes, RodPlaces, RodMeshOutputs, ROD_VECTORS),
        "shell": (ShellMeshes, ShellPlaces, ShellMeshOutputs, SHELL_VECTORS),
    }
    kind, places, outputs, vectors = kinds[name]
    line = name != "shell"
    return MeshType(
        kind=kind,
        places=places,
        outputs=outputs,
        element=MeshElement if line else ShellMeshElement,
        vectors=vectors,
        nodes_per_element=2 if line else 4,
        pairs=FRAME_PAIRS if line else SHELL_PAIRS,
        check=getattr(module, f"check_{name}"),
        element_data=module.element_data,
        strain_counts=module.strain_counts,
        start_coordinates=module.start_coordinates,
        locate=module.locate,
        shape_values=module.shape_values,
        load_shape=module.load_shape,
        body_constants=module.body_constants,
        result_columns=module.result_columns,
    )


# ---- what is refused of both ----


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
