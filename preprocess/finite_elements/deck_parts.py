"""Plates, beams, masses and rigid elements of a deck, in its units: what readers of decks leave."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.preprocess.structures.sections import BeamSection
    from heavylift.preprocess.structures.structure import Average, PointMass, RigidLink, Tie

__all__ = [
    "DeckBeams",
    "DeckFrame",
    "DeckPlates",
    "element_sizes",
    "loose_frame",
    "some_elements",
    "with_extra_mass",
]


@dataclass(frozen=True, eq=False)
class DeckPlates:
    """Plates of one property; lengths and masses in units of the deck.

    Attributes
    ----------
    name
        Of the property, as sets of elements call it.
    index
        Numbers of the elements over all blocks of the deck, shape (ne,).
    nodes
        Rows of its points, shape (ne, 3) or (ne, 4).
    material
        Entry of its materials, -1 for none.
    thickness
        NaN where the deck has none, shape (ne,).
    offset
        From the nodes to the mid-surface along the normal, shape (ne,).
    nonstructural_mass
        Per area.
    bends, stretches, bending_factor, shear_factor
        As `Shells`.
    loose
        Whether they have no property, as meshers write groups: plates only if nothing else is there, or the case says.
    file, place
        Where the property stands, for messages.
    """

    name: str
    index: NDArray[np.int64]
    nodes: NDArray[np.int64]
    material: int
    thickness: NDArray[np.float64]
    offset: NDArray[np.float64]
    nonstructural_mass: float = 0.0
    bends: bool = True
    stretches: bool = True
    bending_factor: float = 1.0
    shear_factor: float = 5.0 / 6.0
    loose: bool = False
    file: Path | None = None
    place: str = ""


@dataclass(frozen=True, eq=False)
class DeckBeams:
    """Beams of one property; lengths and masses in units of the deck.

    Attributes
    ----------
    name, index, nodes, material, loose, file, place
        As of `DeckPlates`; two nodes.
    optional
        Whether they are lines of a mesh that has no properties at all: beams only if the case says so.
    section
        None if the deck has none.
    orientation
        As of `Beams`, NaN where the deck has none, shape (ne, 3).
    offset_a, offset_b
        From the nodes to the centroid, axes of the deck, shape (ne, 3).
    released
        As of `Beams`, shape (ne, 12).
    """

    name: str
    index: NDArray[np.int64]
    nodes: NDArray[np.int64]
    material: int
    section: BeamSection | None
    orientation: NDArray[np.float64]
    offset_a: NDArray[np.float64]
    offset_b: NDArray[np.float64]
    released: NDArray[np.bool_]
    loose: bool = False
    optional: bool = False
    file: Path | None = None
    place: str = ""


Part = TypeVar("Part", bound="DeckPlates | DeckBeams")


@dataclass(frozen=True, eq=False)
class DeckFrame:
    """What a deck has besides solids.

    Attributes
    ----------
    plates, beams
        By property.
    masses, links, averages, ties
        Between rows of the points of the deck, in its units.
    refused
        What a structure cannot be made with, in words, e.g. ``"2 composite properties PCOMP (first: line 8)"``.
    notes
        What was read and left out, with counts, one sentence each.
    instead
        Notes of the deck that do not hold for a structure: of what solids alone leave out.
    also
        Types of elements that `masses` and `links` are made of.
    """

    plates: tuple[DeckPlates, ...] = ()
    beams: tuple[DeckBeams, ...] = ()
    masses: tuple[PointMass, ...] = ()
    links: tuple[RigidLink, ...] = ()
    averages: tuple[Average, ...] = ()
    ties: tuple[Tie, ...] = ()
    refused: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    instead: tuple[str, ...] = ()
    also: frozenset[str] = frozenset()


def loose_frame(cells: Sequence[tuple[str, NDArray[np.int64]]]) -> DeckFrame:
    """Plates and beams of cells that have no property: what they are a case says by group.

    Parameters
    ----------
    cells
        Type as meshio calls it and nodes, of all blocks of a deck in their order.
    """
    plates, beams = [], []
    start = 0
    for kind, nodes in cells:
        count = len(nodes)
        index = np.arange(start, start + count)
        start += count
        if kind in {"triangle", "quad"}:
            plates.append(
                DeckPlates(
                    name=kind,
                    index=index,
                    nodes=np.asarray(nodes, dtype=np.int64),
                    material=-1,
                    thickness=np.full(count, np.nan),
                    offset=np.zeros(count),
                    loose=True,
                )
            )
        elif kind == "line":
            zeros = np.zeros((count, 3))
            beams.append(
                DeckBeams(
                    name=kind,
                    index=index,
                    nodes=np.asarray(nodes, dtype=np.int64),
                    material=-1,
                    section=None,
                    orientation=np.full((count, 3), np.nan),
                    offset_a=zeros,
                    offset_b=zeros,
                    released=np.zeros((count, 12), dtype=bool),
                    loose=True,
                    optional=True,
                )
            )
    return DeckFrame(tuple(plates), tuple(beams))


def some_elements(one: Part, own: NDArray[np.bool_]) -> Part:
    """Some elements of a property."""
    keys = ("index", "nodes", "thickness", "offset", "orientation", "offset_a", "offset_b", "released")
    return replace(one, **{key: getattr(one, key)[own] for key in keys if hasattr(one, key)})


def element_sizes(one: DeckPlates | DeckBeams, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Areas of plates or lengths of beams between their nodes, shape (ne,)."""
    corners = points[one.nodes]
    if isinstance(one, DeckBeams):
        return np.asarray(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1))
    a = corners[:, 2] - corners[:, 0]
    b = corners[:, 3] - corners[:, 1] if corners.shape[1] == 4 else corners[:, 1] - corners[:, 0]
    return np.asarray(0.5 * np.linalg.norm(np.cross(a, b), axis=1))


def with_extra_mass(
    plates: list[DeckPlates], beams: list[DeckBeams], extra: NDArray[np.float64]
) -> tuple[list[DeckPlates], list[DeckBeams]]:
    """Plates and beams with more mass per area or length; properties are split where it differs.

    Parameters
    ----------
    plates, beams
        All of them.
    extra
        By number of the element, in units of the deck.
    """
    split: list[DeckPlates] = []
    for plate in plates:
        for value in np.unique(extra[plate.index]):
            part = some_elements(plate, extra[plate.index] == value)
            split.append(replace(part, nonstructural_mass=plate.nonstructural_mass + float(value)))
    bars: list[DeckBeams] = []
    for beam in beams:
        for value in np.unique(extra[beam.index]):
            part_of = some_elements(beam, extra[beam.index] == value)
            section = beam.section
            if section is not None:
                section = replace(section, nonstructural_mass=section.nonstructural_mass + float(value))
            bars.append(replace(part_of, section=section))
    return split, bars
