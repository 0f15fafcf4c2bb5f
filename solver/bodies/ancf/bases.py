"""Bases of a mesh: the vectors at material points through which joints, ropes and forces see it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.kind import POINT_MARKER, TANGENT_MARKER, TRIAD_MARKER, VECTOR_MARKER
from heavylift.solver.bodies.ancf.types import type_of
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.scene.meshes import FrameBody, MeshBody, RodBody, ShellBody

__all__ = ["Base", "Bases", "MarkerEntry", "frame_tangent", "plan_bases"]

TRIAD = (1, 2)
"""Vectors of a shell or a rod that directions turn with: both slopes, or the tangent and the first director."""

ALONG = 1e-6
"""Largest sine of the angle between a direction on a frame and its tangent."""


@dataclass(frozen=True, eq=False)
class Base:
    """A vector at a material point: element, its shape values over the vectors of the nodes of the element."""

    element: int
    shape: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MarkerEntry:
    """Number in the workspace, first base, type, numbers of its own, level."""

    number: int
    base: int
    type: int
    data: NDArray[np.float64]
    level: int


@dataclass
class Bases:
    """Bases of one body, each once, and the markers on them."""

    body: MeshBody
    bases: list[Base] = field(default_factory=list)
    entries: list[MarkerEntry] = field(default_factory=list)
    _known: dict[Any, int] = field(default_factory=dict)

    def add(self, element: int, local: tuple[float, ...], vectors: Sequence[int]) -> int:
        """Number of the first of some bases at a point, which follow each other."""
        place = (element, tuple(round(x, 12) for x in local))
        key = (*place, tuple(vectors))
        pair = self._known.get((*place, TRIAD))
        if pair is not None and len(vectors) == 1 and vectors[0] in TRIAD:
            return pair + TRIAD.index(vectors[0])
        if key not in self._known:
            self._known[key] = len(self.bases)
            values = type_of(self.body).shape_values
            self.bases += [Base(element, values(self.body, element, local, vector)) for vector in vectors]
        return self._known[key]

    def gather(self) -> None:
        """Let those at one point follow each other: the rows of a joint there are then on neighbouring velocities."""
        at: dict[Any, list[int]] = {}
        for key, first in self._known.items():
            at.setdefault(key[:-1], []).extend(range(first, first + len(key[-1])))
        order = [base for together in at.values() for base in together]
        place = {base: i for i, base in enumerate(order)}
        self.bases = [self.bases[base] for base in order]
        self.entries = [replace(entry, base=place[entry.base]) for entry in self.entries]
        self._known = {key: place[first] for key, first in self._known.items()}


def plan_bases(body: MeshBody, markers: BodyMarkers) -> Bases:
    """Find the material points of all markers of a body.

    Parameters
    ----------
    body
        Frame or shell, checked.
    markers
        Points [m] and unit directions in its frame.

    Raises
    ------
    InputError
        If a point is off the mesh, or a direction on a frame is not along its tangent.
    """
    bases = Bases(body)
    of_type = type_of(body)
    given = zip(
        markers.numbers,
        markers.vectors,
        markers.directions,
        markers.levels,
        markers.places,
        markers.slopes,
        strict=True,
    )
    # triads first: single slopes at the same point are then among their bases
    for number, vector, direction, level, place, slope in sorted(
        given, key=lambda one: not one[2] or bool(one[5])
    ):
        element, local = of_type.locate(body, place, body.name, "point")
        data = np.zeros(0)
        if slope:
            base, kind = bases.add(element, local, (slope,)), VECTOR_MARKER
        elif not direction:
            base, kind = bases.add(element, local, (0,)), POINT_MARKER
        elif isinstance(body, FrameBody) and not isinstance(body, RodBody):
            base, kind = bases.add(element, local, (1,)), TANGENT_MARKER
            data = np.array([_sense(body, bases.bases[base], vector)])
        else:
            assert isinstance(body, (RodBody, ShellBody))
            base, kind = bases.add(element, local, TRIAD), TRIAD_MARKER
            coordinates = of_type.start_coordinates(body)[body.elements[element]].reshape(-1, 3)
            a, b = (bases.bases[base + i].shape @ coordinates for i in range(2))
            data = np.array([axis @ vector for axis in _triad(a, b)])
        bases.entries.append(MarkerEntry(number, base, kind, data, level))
    bases.gather()
    return bases


def _triad(a: NDArray[np.float64], b: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """First axis along a, third square to a and b."""
    first, third = a / np.linalg.norm(a), np.cross(a, b)
    third = third / np.linalg.norm(third)
    return first, np.cross(third, first), third


def frame_tangent(body: FrameBody, point: NDArray[np.float64], source: str) -> NDArray[np.float64]:
    """Unit tangent of a frame at a material point [m], in its own axes, unloaded.

    Raises
    ------
    InputError
        If the point is off the frame.
    """
    of_type = type_of(body)
    element, local = of_type.locate(body, np.asarray(point, dtype=np.float64), source, "point")
    return _unit_tangent(body, Base(element, of_type.shape_values(body, element, local, 1)))


def _unit_tangent(body: FrameBody, base: Base) -> NDArray[np.float64]:
    coordinates = type_of(body).start_coordinates(body)[body.elements[base.element]].reshape(-1, 3)
    tangent = np.asarray(base.shape @ coordinates)
    return tangent / np.linalg.norm(tangent)


def _sense(body: FrameBody, base: Base, direction: NDArray[np.float64]) -> float:
    """1 along the tangent, -1 against it."""
    tangent = _unit_tangent(body, base)
    if not np.linalg.norm(np.cross(tangent, direction)) <= ALONG:
        raise InputError(
            f"a direction {np.round(direction, 6).tolist()} on a frame with tangent {np.round(tangent, 6).tolist()}",
            source=body.name,
            key="axis",
            expected="its tangent: a frame has no torsion, so no other direction on it is known",
        )
    return 1.0 if tangent @ direction > 0.0 else -1.0
