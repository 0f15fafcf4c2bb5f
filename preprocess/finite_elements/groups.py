"""Named node groups: which nodes of a mesh carry a name, given by plane, by box or by face."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

__all__ = ["InBox", "NodeSelector", "OnFace", "OnPlane", "select_nodes"]

AXES = {"x": 0, "y": 1, "z": 2}
RELATIVE_TOLERANCE = 1e-6
"""How far from a plane a node may lie, in diagonals of the body."""


@dataclass(frozen=True)
class OnPlane:
    """Nodes with one coordinate equal to a value.

    Parameters
    ----------
    name
        Name of the group.
    axis
        ``"x"``, ``"y"`` or ``"z"``.
    value
        Coordinate of the plane [m].
    """

    name: str
    axis: str
    value: float
    kind: ClassVar[str] = "plane"


@dataclass(frozen=True)
class InBox:
    """Nodes inside an axis-aligned box, its surface included.

    Parameters
    ----------
    name
        Name of the group.
    lower, upper
        Opposite corners [m].
    """

    name: str
    lower: tuple[float, float, float]
    upper: tuple[float, float, float]
    kind: ClassVar[str] = "box"


@dataclass(frozen=True)
class OnFace:
    """Nodes of a named face of the geometry.

    Parameters
    ----------
    name
        Name of the group.
    face
        Name of the face: ``"BOX.x_min"`` (or ``x_max`` ... ``z_max``) for parametric blocks, the label or
        ``"face NUMBER"`` for a STEP file.
    """

    name: str
    face: str
    kind: ClassVar[str] = "face"


NodeSelector = OnPlane | InBox | OnFace


def select_nodes(
    nodes: NDArray[np.float64],
    selectors: Sequence[NodeSelector],
    *,
    faces: Mapping[str, NDArray[np.int64]] | None = None,
    source: str = "mesh",
) -> dict[str, NDArray[np.int64]]:
    """Find the nodes of each group.

    Parameters
    ----------
    nodes
        Positions [m], shape (n, 3).
    selectors
        What to select.
    faces
        Node indices of the faces that have a name.
    source
        Named in messages.

    Returns
    -------
    dict
        Sorted node indices by group name.

    Raises
    ------
    InputError
        A group without nodes, a name given twice, an unknown axis or face, a box upside down.
    """
    extent = np.ptp(nodes, axis=0)
    tolerance = RELATIVE_TOLERANCE * float(np.linalg.norm(extent))
    groups: dict[str, NDArray[np.int64]] = {}
    for selector in selectors:
        key = f"node group {selector.name!r}"
        if selector.name in groups:
            raise InputError("is given twice", source=source, key=key, expected="one group a name")
        if isinstance(selector, OnPlane):
            if selector.axis not in AXES:
                raise InputError(
                    f"axis {selector.axis!r}", source=source, key=key, expected="'x', 'y' or 'z'"
                )
            distance = np.abs(nodes[:, AXES[selector.axis]] - selector.value)
            found = np.flatnonzero(distance <= tolerance)
            words = f"no node at {selector.axis} = {selector.value:.9g} m"
        elif isinstance(selector, InBox):
            lower, upper = np.asarray(selector.lower), np.asarray(selector.upper)
            if (lower > upper).any():
                raise InputError(
                    f"lower {lower.tolist()} exceeds upper {upper.tolist()}",
                    source=source,
                    key=key,
                    expected="lower <= upper in every direction",
                )
            inside = (nodes >= lower - tolerance) & (nodes <= upper + tolerance)
            found = np.flatnonzero(inside.all(axis=1))
            words = f"no node in the box {lower.tolist()} to {upper.tolist()} m"
        else:
            found = _face_nodes(selector, faces or {}, source)
            words = f"face {selector.face!r} has no node"
        if found.size == 0:
            low, high = nodes.min(axis=0), nodes.max(axis=0)
            raise InputError(
                words,
                source=source,
                key=key,
                expected="at least one node; the body spans "
                + ", ".join(f"{axis} {low[k]:.6g} to {high[k]:.6g}" for axis, k in AXES.items())
                + " m",
            )
        groups[selector.name] = found.astype(np.int64)
    return groups


def _face_nodes(selector: OnFace, faces: Mapping[str, NDArray[np.int64]], source: str) -> NDArray[np.int64]:
    if selector.face not in faces:
        known = ", ".join(repr(name) for name in sorted(faces)[:40])
        raise InputError(
            f"face {selector.face!r} is unknown",
            source=source,
            key=f"node group {selector.name!r}",
            expected=f"one of {known}" if known else "a geometry with named faces",
        )
    return np.unique(faces[selector.face])
