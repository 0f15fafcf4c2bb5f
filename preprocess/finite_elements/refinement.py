"""Finer tetrahedra where the stress is singular: along re-entrant edges and the borders of clamped faces.

Frequencies of quadratic tetrahedra of even size converge slowly when the body has such edges. Elements whose
size grows linearly with the distance from them give the same accuracy with a fraction of the nodes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.groups import AXES, InBox, OnFace, OnPlane

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.groups import NodeSelector

__all__ = ["RE_ENTRANT", "CurveSize", "Refinement", "curves_of_groups", "refine_near"]

RE_ENTRANT = "re-entrant edges"
"""Name, in `Refinement.at`, of all edges with material on three sides."""


@dataclass(frozen=True)
class Refinement:
    """A smaller element size along edges of the geometry.

    Parameters
    ----------
    at
        ``"re-entrant edges"`` (blocks only), or the name of a node group: all edges of the geometry that lie
        wholly in it, for a clamped plane the border of the clamped faces.
    size
        Edge length of the elements at these edges [m].
    growth
        Growth of the edge length with the distance from them [-], up to the size of the mesh.

    Raises
    ------
    InputError
        A size or growth that is not positive.
    """

    at: str
    size: float
    growth: float = 0.5

    def __post_init__(self) -> None:
        for key in ("size", "growth"):
            value = getattr(self, key)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(
                    f"{value!r}", source=f"refinement at {self.at!r}", key=key, expected="a positive number"
                )


class CurveSize(NamedTuple):
    """Element size along curves of gmsh, in units of its model."""

    curves: list[int]
    size: float
    growth: float


def refine_near(gmsh: Any, wishes: Sequence[CurveSize], largest: float) -> None:
    """Let the element size grow from the curves of each wish, up to `largest`; the smallest wish counts."""
    field = gmsh.model.mesh.field
    thresholds = []
    for wish in wishes:
        longest = 0.0
        for tag in wish.curves:
            box = np.array(gmsh.model.getBoundingBox(1, tag))
            longest = max(longest, float(np.linalg.norm(box[3:] - box[:3])))
        distance = field.add("Distance")
        field.setNumbers(distance, "CurvesList", wish.curves)
        # two samples an element, within reason
        field.setNumber(distance, "Sampling", int(np.clip(2.0 * longest / wish.size, 20, 2000)))
        threshold = field.add("Threshold")
        field.setNumber(threshold, "InField", distance)
        field.setNumber(threshold, "SizeMin", min(wish.size, largest))
        field.setNumber(threshold, "SizeMax", largest)
        field.setNumber(threshold, "DistMin", 0.0)
        field.setNumber(threshold, "DistMax", max(largest - wish.size, 1e-6 * largest) / wish.growth)
        thresholds.append(threshold)
    smallest = field.add("Min")
    field.setNumbers(smallest, "FieldsList", thresholds)
    field.setAsBackgroundMesh(smallest)
    # sizes of the surface mesh must not spread into the body: the field is the whole truth
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)


def curves_of_groups(
    boxes: Mapping[int, NDArray[np.float64]],
    refine: Sequence[Refinement],
    groups: Sequence[NodeSelector],
    face_curves: Mapping[str, Sequence[int]],
    re_entrant: Sequence[int] | None,
    source: str,
) -> list[tuple[list[int], Refinement]]:
    """Find the curves that each refinement speaks of.

    Parameters
    ----------
    boxes
        Bounding box (6,) of every curve [m]: lower corner, upper corner.
    refine, groups
        Refinements, and the selectors whose names they use.
    face_curves
        Border curves of the faces that have a name.
    re_entrant
        Re-entrant curves; None where they are unknown.
    source
        Named in messages.

    Raises
    ------
    InputError
        An unknown group, or one that contains no edge.
    """
    corners = np.array(list(boxes.values()))
    tolerance = 1e-6 * float(np.linalg.norm(corners[:, 3:].max(axis=0) - corners[:, :3].min(axis=0)))
    selectors = {selector.name: selector for selector in groups}
    found = []
    for item in refine:
        key = f"refine at {item.at!r}"
        if item.at == RE_ENTRANT:
            if re_entrant is None:
                raise InputError(
                    "re-entrant edges are known for parametric blocks only",
                    source=source,
                    key=key,
                    expected="the name of a node group",
                )
            curves = list(re_entrant)
        elif item.at in selectors:
            selector = selectors[item.at]
            if isinstance(selector, OnFace):
                curves = list(face_curves.get(selector.face, []))
            else:
                lower, upper = _bounds(selector)
                curves = [
                    tag
                    for tag, box in boxes.items()
                    if (box[:3] >= lower - tolerance).all() and (box[3:] <= upper + tolerance).all()
                ]
        else:
            known = ", ".join(repr(name) for name in (RE_ENTRANT, *selectors))
            raise InputError("is unknown", source=source, key=key, expected=f"one of {known}")
        if not curves:
            raise InputError(
                "contains no edge of the geometry", source=source, key=key, expected="at least one edge"
            )
        found.append((curves, item))
    return found


def _bounds(selector: OnPlane | InBox) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if isinstance(selector, InBox):
        return np.asarray(selector.lower, dtype=float), np.asarray(selector.upper, dtype=float)
    lower, upper = np.full(3, -np.inf), np.full(3, np.inf)
    lower[AXES[selector.axis]] = upper[AXES[selector.axis]] = selector.value
    return lower, upper
