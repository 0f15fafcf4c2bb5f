"""Plates, bars, rigid elements and masses of bulk data of Nastran, and coordinate systems.

What is read:

* ``CORD1R``, ``CORD2R`` and with ``C`` or ``S``: systems of nodes (``CP``), of what is given there (``CD``), of masses;
* ``CQUAD4``, ``CTRIA3``, ``CQUADR``, ``CTRIAR`` with ``PSHELL``: thicknesses of corners (their mean; ``TFLAG``),
  ``ZOFFS``;
* ``CBAR`` (``PBAR``, ``PBARL``, ``BAROR``), ``CBEAM`` (``PBEAM``, ``PBEAML`` of one section, ``BEAMOR``), ``CROD``
  (``PROD``) and ``CONROD``: orientation and offsets in the displacement systems of their nodes, ``OFFT``, pins,
  neutral axis;
* ``CONM2``; ``RBE2``, ``RBE3``, ``RBAR``;
* ``NSM``, ``NSM1``, ``NSML``, ``NSML1``, ``NSMADD`` of plates and beams, if case control selects them.

Source: MSC Nastran Quick Reference Guide, *Bulk Data Entries*.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import deck_number
from heavylift.preprocess.finite_elements.deck_parts import (
    DeckBeams,
    DeckFrame,
    DeckPlates,
    element_sizes,
    with_extra_mass,
)
from heavylift.preprocess.structures.bar_shapes import BAR_SHAPES, ROUND_SHAPES, shape_section
from heavylift.preprocess.structures.sections import BeamSection
from heavylift.preprocess.structures.structure import Average, PointMass, RigidLink

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["Card", "CoordinateSystems", "FrameBuilder", "FrameCards"]


_WHOLE = re.compile(r"[+-]?[0-9]{1,18}")  # what fits 64 bits


@dataclass
class Card:
    """A bulk data entry: its name and the fields behind it."""

    name: str
    fields: list[str]
    file: Path
    line: int

    def fail(self, problem: str, expected: str) -> NoReturn:
        """Refuse it.

        Raises
        ------
        InputError
            Always, with file and line.
        """
        raise InputError(
            f"{self.name}: {problem}", source=self.file, key=f"line {self.line}", expected=expected
        )

    def word(self, index: int) -> str:
        """Text of a field; ``""`` for a blank one."""
        return self.fields[index] if index < len(self.fields) else ""

    def whole(self, index: int, what: str, default: int | None = None) -> int:
        """Whole number of a field."""
        word = self.word(index)
        if not word and default is not None:
            return default
        if not _WHOLE.fullmatch(word):
            self.fail(f"{word!r}", f"a whole number: {what}")
        return int(word)

    def real(self, index: int, what: str) -> float | None:
        """Number of a field; None for a blank one."""
        word = self.word(index)
        if not word:
            return None
        try:
            return deck_number(word)
        except ValueError:
            self.fail(f"{word!r}", f"a number: {what}")


# ---- coordinate systems ----


class CoordinateSystems:
    """Systems by number; 0 is the basic one."""

    def __init__(self) -> None:
        self.cards: dict[int, tuple[Card, int]] = {}
        self.known: dict[int, tuple[str, NDArray[np.float64], NDArray[np.float64]]] = {
            0: ("R", np.zeros(3), np.eye(3))
        }
        self.open: set[int] = set()

    def take(self, card: Card) -> None:
        """``CORD1x``, which may define two systems, or ``CORD2x``."""
        for first in (0, 4) if card.name[4] == "1" else (0,):
            if first and not card.word(first):
                continue
            label = card.whole(first, "number of the coordinate system")
            if label in self.cards and self.cards[label][0].fields != card.fields:
                card.fail(f"coordinate system {label} is defined twice", "every coordinate system once")
            self.cards[label] = (card, first)

    def resolve(self, label: int, user: Card, place: Callable[[int, Card], NDArray[np.float64]]) -> None:
        """Make a system known.

        Parameters
        ----------
        label
            Its number.
        user
            Who names it, for messages.
        place
            Of a node by number, for CORD1x.
        """
        if label in self.known:
            return
        if label not in self.cards:
            user.fail(
                f"coordinate system {label} does not exist", "0 or the number of a CORD1R, CORD2R, ... entry"
            )
        card, first = self.cards[label]
        if label in self.open:
            card.fail(f"coordinate system {label} is defined by itself", "systems without a circle")
        self.open.add(label)
        if card.name[4] == "1":
            points = [place(card.whole(first + k, "a node"), card) for k in (1, 2, 3)]
        else:
            reference = card.whole(1, "the reference system", 0)
            self.resolve(reference, card, place)
            points = [
                self.point(
                    reference, np.array([card.real(2 + 3 * k + i, "a coordinate") or 0.0 for i in range(3)])
                )
                for k in range(3)
            ]
        self.open.discard(label)
        a, b, c = points
        z = b - a
        y = np.cross(z, c - a)
        if not (np.linalg.norm(z) > 0.0 and np.linalg.norm(y) > 1e-9 * np.linalg.norm(z) ** 2):
            card.fail("its three points are on a line", "points that span the plane x, z")
        axes = np.column_stack([np.cross(y, z), y, z])
        self.known[label] = (card.name[5], a, axes / np.linalg.norm(axes, axis=0))

    def point(self, label: int, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Basic coordinates of a point given in a known system."""
        kind, origin, axes = self.known[label]
        if kind == "C":
            angle = np.radians(x[1])
            x = np.array([x[0] * np.cos(angle), x[0] * np.sin(angle), x[2]])
        elif kind == "S":
            t, p = np.radians(x[1:])
            x = x[0] * np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])
        return origin + axes @ x

    def axes(self, label: int, at: NDArray[np.float64]) -> NDArray[np.float64]:
        """Axes of a known system at a place as columns: of round ones those of the place, shape (3, 3)."""
        kind, origin, axes = self.known[label]
        if kind == "R":
            return axes
        x, y, z = axes.T @ (at - origin)
        r = np.hypot(x, y)
        c, s = (x / r, y / r) if r > 0.0 else (1.0, 0.0)
        if kind == "C":
            local = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        else:
            R = np.hypot(r, z)
            st, ct = (r / R, z / R) if R > 0.0 else (0.0, 1.0)
            local = np.array([[st * c, ct * c, -s], [st * s, ct * s, c], [ct, -st, 0.0]])
        return axes @ local


# ---- entries ----


_PLATES = {"CQUAD4": 4, "CQUADR": 4, "CTRIA3": 3, "CTRIAR": 3}
_BEAMS = {"CBAR", "CBEAM", "CROD", "CONROD"}
_SHELL_PROPERTIES, _BAR_PROPERTIES = {"PSHELL"}, {"PBAR", "PBARL", "PBEAM", "PBEAML", "PROD"}
_REFUSED = {
    r"PCOMPG?$": "composite properties",
    r"PBCOMP$": "composite sections",
    r"(RBE1|RBAR1|RROD|RTRPLT1?|RSPLINE|RSSCON|RJOINT)$": "rigid elements that are not read",
    r"CONM1$": "mass matrices of nodes",
}


@cache
def _refused_words(name: str) -> str:
    """What an entry is that a structure cannot have; ``""`` of others."""
    found = (f"{words} {name}" for pattern, words in _REFUSED.items() if re.match(pattern, name))
    return next(found, "")


class FrameCards:
    """Takes entries one after the other, and makes a frame of them when all nodes and properties are known."""

    def __init__(self) -> None:
        self.systems = CoordinateSystems()
        self.properties: dict[tuple[str, int], Card] = {}
        self.elements: dict[int, Card] = {}
        self.masses: dict[int, Card] = {}
        self.rigid: dict[int, Card] = {}
        self.refused: dict[str, list[Card]] = {}
        self.defaults: dict[str, Card] = {}
        self.extra: list[Card] = []  # of nonstructural mass
        self.selected = 0  # set of them, by case control
        self.counts: Counter[str] = Counter()
        self.read: Counter[str] = Counter()

    @property
    def empty(self) -> bool:
        """Whether there is nothing besides solids."""
        return not (self.elements or self.masses or self.rigid or self.refused)

    def take(self, card: Card) -> bool:
        """One entry; whether it is read here."""
        name = card.name
        self.counts[name] += 1
        if name in {"GRID", "CHEXA", "CTETRA"}:  # most of a deck
            return False
        if re.fullmatch(r"CORD[12][RCS]", name):
            self.systems.take(card)
        elif name in _PLATES or name in _BEAMS:
            self._once(self.elements, card, "element")
        elif name in _SHELL_PROPERTIES | _BAR_PROPERTIES:
            family = "PSHELL" if name == "PSHELL" else "PBAR"
            label = card.whole(0, "number of the property")
            known = self.properties.setdefault((family, label), card)
            if known.name != name or known.fields != card.fields:
                card.fail(f"property {label} is defined twice", "every property once")
        elif name == "CONM2":
            self._once(self.masses, card, "element")
        elif name in {"RBE2", "RBE3", "RBAR"}:
            self._once(self.rigid, card, "element")
        elif re.fullmatch(r"NSM(L?1?|ADD)", name):
            self.extra.append(card)
            if not self.selected:
                return False
        elif name in {"BAROR", "BEAMOR"}:
            self.defaults["CBAR" if name == "BAROR" else "CBEAM"] = card
        else:
            words = _refused_words(name)
            if words:
                self.refused.setdefault(words, []).append(card)
            return False
        self.read[name] += 1
        return True

    @staticmethod
    def _once(known: dict[int, Card], card: Card, what: str) -> None:
        label = card.whole(0, f"number of the {what}")
        before = known.setdefault(label, card)
        if before.name != card.name or before.fields != card.fields:
            card.fail(f"{what} {label} is defined twice", f"every {what} once")


class FrameBuilder:
    """From entries to a frame.

    Parameters
    ----------
    cards
        All of them.
    row
        Rows of nodes by number.
    points
        Positions of the nodes, basic axes, shape (n, 3).
    displacement_system
        CD of a node by number.
    materials
        Entry of the materials of the deck by number.
    shear_ratio
        By number of the material: G as given beside E / (2 (1 + nu)).
    weight
        PARAM,WTMASS: factor on masses.
    index
        Number of an element over all blocks of the deck.
    """

    def __init__(
        self,
        cards: FrameCards,
        row: Mapping[int, int],
        points: NDArray[np.float64],
        displacement_system: Callable[[int], int],
        materials: Mapping[int, int],
        shear_ratio: Mapping[int, float],
        weight: float,
        index: Mapping[int, int],
    ) -> None:
        self.cards, self.row, self.points, self.index = cards, row, points, index
        self.cd, self.materials, self.weight = displacement_system, materials, weight
        self.shear_ratio = shear_ratio
        self.said: Counter[str] = Counter()

    def frame(self) -> DeckFrame:
        """Make it."""
        plates: dict[tuple[object, ...], list[tuple[int, Card]]] = {}
        beams: dict[tuple[object, ...], list[tuple[int, Card]]] = {}
        for label, card in self.cards.elements.items():
            if card.name == "CONROD":
                beams.setdefault((card.name, label), []).append((label, card))
                continue
            property_id = card.whole(1, "a property", label)
            if card.name in _PLATES:
                nodes = self._nodes(card, 2, _PLATES[card.name])
                corners = 3 if len(nodes) == 4 and nodes[2] == nodes[3] else len(nodes)
                plates.setdefault((property_id, corners), []).append((label, card))
            else:
                family = "CROD" if card.name == "CROD" else "CBAR"
                default = self.cards.defaults.get(card.name)
                if not card.word(1) and default is not None and default.word(1):
                    property_id = default.whole(1, "a property")
                beams.setdefault((family, property_id), []).append((label, card))
        masses = [self._mass(label, card) for label, card in self.cards.masses.items()]
        links, averages = self._rigid()
        made_plates = tuple(self._plates(int(str(key[0])), members) for key, members in plates.items())
        made_beams = tuple(
            self._beams(str(key[0]), int(str(key[1])), members) for key, members in beams.items()
        )
        if self.cards.selected:
            plates_, beams_ = self._extra_mass(list(made_plates), list(made_beams))
            made_plates, made_beams = tuple(plates_), tuple(beams_)
        refused = tuple(
            f"{len(found)} {words} (first: line {found[0].line} of {found[0].file.name})"
            for words, found in self.cards.refused.items()
        )
        notes = tuple(f"{count} {words}" for words, count in self.said.items() if count)
        return DeckFrame(
            made_plates,
            made_beams,
            tuple(masses),
            tuple(links),
            tuple(averages),
            refused=refused,
            notes=notes,
            also=frozenset({"CONM2"}),
        )

    # -- nodes and axes --

    def _nodes(self, card: Card, first: int, count: int) -> list[int]:
        return [self._node(card, card.whole(first + k, "a node")) for k in range(count)]

    def _node(self, card: Card, label: int) -> int:
        if label not in self.row:
            card.fail(f"node {label} does not exist", "nodes that the deck defines")
        return self.row[label]

    def _place(self, label: int, card: Card) -> NDArray[np.float64]:
        found: NDArray[np.float64] = self.points[self._node(card, label)]
        return found

    def _axes(self, label: int, card: Card, system: int | None = None) -> NDArray[np.float64]:
        """Axes of a system, by default the displacement system, at a node."""
        system = self.cd(label) if system is None else system
        self.cards.systems.resolve(system, card, self._place)
        return self.cards.systems.axes(system, self._place(label, card))

    def _vector(self, card: Card, first: int, what: str) -> NDArray[np.float64]:
        return np.array([card.real(first + k, what) or 0.0 for k in range(3)])

    def _material(self, card: Card, label: int) -> int:
        if label and label not in self.materials:
            card.fail(f"material {label} does not exist", "the number of a MAT1")
        return self.materials.get(label, -1)

    # -- plates --

    def _plates(self, property_id: int, members: list[tuple[int, Card]]) -> DeckPlates:
        corners = 4
        rows = [self._nodes(card, 2, _PLATES[card.name]) for _, card in members]
        if len(rows[0]) == 3 or rows[0][2] == rows[0][3]:
            corners = 3
        self.said["quadrilaterals CQUAD4 with node 3 = node 4 are triangles"] += sum(
            len(row) != corners for row in rows
        )
        card = self.cards.properties.get(("PSHELL", property_id))
        thickness = card.real(2, "the thickness") if card else None
        t = np.full(len(members), np.nan if thickness is None else thickness)
        offset = np.zeros(len(members))
        different = 0
        for k, (_, element) in enumerate(members):
            count = _PLATES[element.name]
            place = 2 + count  # THETA, then ZOFFS
            offset[k] = element.real(place + 1, "ZOFFS") or 0.0
            given = [element.real(10 + i, "a thickness") for i in range(count)]
            if any(value is not None for value in given):
                relative = element.whole(9, "TFLAG", 0) == 1
                base = 1.0 if relative else t[k]
                scale = t[k] if relative else 1.0
                values = [scale * (base if value is None else value) for value in given]
                different += max(values) - min(values) > 1e-9 * max(values)
                t[k] = float(np.mean(values))
        self.said["plates with corners of different thickness have the mean of it"] += different
        for k, (label, element) in enumerate(members):
            if card is not None and not t[k] > 0.0:
                element.fail(
                    f"element {label} has no thickness: neither PSHELL {property_id} nor the element gives one"
                    if np.isnan(t[k])
                    else f"element {label} has the thickness {t[k]:g}",
                    "a positive thickness",
                )
        made = DeckPlates(
            name=f"PSHELL {property_id}",
            index=np.array([self.index[label] for label, _ in members]),
            nodes=np.array([row[:corners] for row in rows]),
            material=-1,
            thickness=t,
            offset=offset,
            loose=card is None,
            file=(card or members[0][1]).file,
            place=f"line {(card or members[0][1]).line}",
        )
        return made if card is None else self._with_property(made, card)

    def _with_property(self, made: DeckPlates, card: Card) -> DeckPlates:
        mid = [card.whole(k, "number of a material", 0) for k in (1, 3, 5)]
        if not mid[0] and not mid[1]:
            card.fail("MID1 and MID2 are blank: neither membrane nor bending", "a material")
        if mid[1] == -1:
            card.fail("MID2 = -1: plane strain", "a shell, with a material or blank")
        if card.whole(10, "MID4", 0):
            card.fail("MID4 couples membrane and bending", "a homogeneous plate with an offset (ZOFFS)")
        indices = [self._material(card, label) for label in mid]
        used = {index for index, label in zip(indices, mid, strict=True) if label}
        if len(used) > 1:
            card.fail(
                f"materials {', '.join(str(label) for label in mid if label)} for membrane, bending and shear",
                "one material",
            )
        t = card.real(2, "the thickness")
        fibres = [card.real(k, "a stress fibre") for k in (8, 9)]
        if t and any(z is not None and abs(abs(z) - t / 2) > 1e-6 * t for z in fibres):
            self.said["PSHELL with Z1, Z2 apart from the surfaces: stress is that of the surfaces"] += 1
        if not mid[1]:
            self.said["PSHELL without MID2: membranes, no bending"] += 1
        if not mid[0]:
            self.said["PSHELL without MID1: bending, no membrane"] += 1
        bending = card.real(4, "12I/T**3")
        shear = card.real(6, "TS/T")
        return replace(
            made,
            material=next(index for index, label in zip(indices, mid, strict=True) if label),
            nonstructural_mass=self.weight * (card.real(7, "NSM") or 0.0),
            bends=bool(mid[1]),
            stretches=bool(mid[0]),
            bending_factor=1.0 if bending is None else bending,
            shear_factor=0.0 if not mid[2] else (5.0 / 6.0 if shear is None else shear),
        )

    # -- beams --

    def _beams(self, family: str, property_id: int, members: list[tuple[int, Card]]) -> DeckBeams:
        first = members[0][1]
        rod = family in {"CROD", "CONROD"}
        card = first if family == "CONROD" else self.cards.properties.get(("PBAR", property_id))
        if card is not None and rod != (card.name in {"PROD", "CONROD"}):
            first.fail(f"has the property {card.name} {property_id}", "PROD" if rod else "PBAR or PBEAM")
        count = len(members)
        at = 1 if family == "CONROD" else 2
        rows = np.array([self._nodes(element, at, 2) for _, element in members])
        section, material, neutral = (None, -1, np.zeros(2)) if card is None else self._section(card)
        orientation = np.full((count, 3), np.nan)
        a, b = np.zeros((count, 3)), np.zeros((count, 3))
        released = np.zeros((count, 12), dtype=bool)
        for k, (label, element) in enumerate(members):
            if rod:
                along = self.points[rows[k, 1]] - self.points[rows[k, 0]]
                orientation[k] = np.eye(3)[np.argmin(np.abs(along))]  # no bending: any will do
                continue
            orientation[k], a[k], b[k], released[k] = self._bar(label, element, rows[k], card is None)
            if neutral.any():
                shift = self._axes_of(rows[k], a[k], b[k], orientation[k], element)[:, 1:] @ neutral
                a[k] += shift
                b[k] += shift
        return DeckBeams(
            name=f"CONROD {property_id}"
            if family == "CONROD"
            else f"{'PROD' if rod else 'PBAR'} {property_id}",
            index=np.array([self.index[label] for label, _ in members]),
            nodes=rows,
            material=material,
            section=section,
            orientation=orientation,
            offset_a=a,
            offset_b=b,
            released=released,
            loose=card is None,
            file=(card or first).file,
            place=f"line {(card or first).line}",
        )

    def _bar(
        self, label: int, card: Card, rows: NDArray[np.int64], loose: bool
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """Orientation, offsets to the end of the element and pins of a CBAR or CBEAM."""
        ga, gb = card.whole(2, "a node"), card.whole(3, "a node")
        default = self.cards.defaults.get(card.name)
        source = card if card.word(4) or card.word(5) or card.word(6) or default is None else default
        flags = (card.word(7) or (default.word(7) if default else "") or "GGG").upper()
        if not re.fullmatch(r"[GB][GO][GO]", flags):
            if re.fullmatch(r"[-+]?\d*\.\d*|0", flags):  # BIT of a p-version beam
                card.fail(f"BIT = {flags}", "OFFT, e.g. GGG")
            card.fail(f"OFFT = {flags}", "GGG, BGG, GGO, BGO, GOG, BOG, GOO or BOO")
        node = source.word(4)
        none = [] if loose else ["neither X1, X2, X3 nor G0"]
        if re.fullmatch(r"[+-]?\d+", node) and not source.word(5) and not source.word(6):
            v = self._place(source.whole(4, "a node or a coordinate"), source) - self.points[rows[0]]
        elif node or source.word(5) or source.word(6):
            v = self._vector(source, 4, "an orientation")
            if flags[0] == "G":
                v = self._axes(ga, card) @ v
        else:
            v = np.full(3, np.nan)
            for problem in none:
                card.fail(f"element {label} has no orientation: {problem}", "a vector in plane 1")
        along = self.points[rows[1]] - self.points[rows[0]]
        ends = []
        for k, (end, flag) in enumerate(zip((ga, gb), flags[1:], strict=True)):
            w = self._vector(card, 10 + 3 * k, "an offset")
            if w.any():
                if flag == "G":
                    w = self._axes(end, card) @ w
                else:
                    zero = np.zeros(3)
                    w = self._axes_of(rows, zero, zero, v, card) @ w
            ends.append(w)
        line = along + ends[1] - ends[0]
        if not loose:
            across = np.linalg.norm(np.cross(line, v))
            if not np.linalg.norm(line) > 0.0:
                card.fail(f"element {label} has no length", "two different ends")
            if not across > 1e-3 * np.linalg.norm(line) * np.linalg.norm(v):
                card.fail(
                    f"element {label} has an orientation along the beam: ({v[0]:g}, {v[1]:g}, {v[2]:g})",
                    "a vector in plane 1, across the beam",
                )
        pins = np.zeros(12, dtype=bool)
        for k in (0, 1):
            for digit in card.word(8 + k):
                if digit not in "123456":
                    card.fail(f"pin flag {card.word(8 + k)!r}", "digits 1 to 6")
                pins[6 * k + int(digit) - 1] = True
        return v, ends[0], ends[1], pins

    def _axes_of(
        self,
        rows: NDArray[np.int64],
        a: NDArray[np.float64],
        b: NDArray[np.float64],
        v: NDArray[np.float64],
        card: Card,
    ) -> NDArray[np.float64]:
        """Axes of an element as columns."""
        e1 = self.points[rows[1]] + b - self.points[rows[0]] - a
        e3 = np.cross(e1, v)
        if not np.linalg.norm(e3) > 0.0:
            card.fail("an orientation along the beam", "a vector in plane 1, across the beam")
        e1, e3 = e1 / np.linalg.norm(e1), e3 / np.linalg.norm(e3)
        return np.column_stack([e1, np.cross(e3, e1), e3])

    def _section(self, card: Card) -> tuple[BeamSection, int, NDArray[np.float64]]:
        """Section, its material, and the centroid beside the shear centre, where offsets go to."""
        mid = card.whole(3 if card.name == "CONROD" else 1, "number of the material")
        material = self._material(card, mid)
        name = f"{card.name} {card.word(0)}"
        if card.name in {"PBARL", "PBEAML"}:
            section, neutral = self._shape(card, name)
        elif card.name in {"PROD", "CONROD"}:
            at = 4 if card.name == "CONROD" else 2
            A, J, nsm = (card.real(at + k, "a constant of the section") or 0.0 for k in (0, 1, 3))
            section = BeamSection(A, 0.0, 0.0, J, nonstructural_mass=nsm, name=name)
            neutral = np.zeros(2)
        elif card.name == "PBAR":
            section, neutral = self._bar_constants(card, name), np.zeros(2)
        else:
            section, neutral = self._beam_constants(card, name)
        if not section.area > 0.0:
            card.fail(f"the area {section.area:g}", "a positive area")
        ratio = self.shear_ratio.get(mid, 1.0)
        return (
            replace(
                section,
                torsion=ratio * section.torsion,
                shear_area_1=ratio * section.shear_area_1,
                shear_area_2=ratio * section.shear_area_2,
                nonstructural_mass=self.weight * section.nonstructural_mass,
            ),
            material,
            neutral,
        )

    def _bar_constants(self, card: Card, name: str) -> BeamSection:
        A, I1, I2, J, nsm = (card.real(2 + k, "a constant of the section") or 0.0 for k in range(5))
        K1, K2 = (card.real(k, "a shear factor") or np.inf for k in (16, 17))  # blank: no shear deformation
        return self._checked(
            card,
            BeamSection(
                area=A,
                second_moment_1=I1,
                second_moment_2=I2,
                torsion=J,
                product=card.real(18, "I12") or 0.0,
                shear_area_1=K1 * A,
                shear_area_2=K2 * A,
                nonstructural_mass=nsm,
                corners=self._corners(card, 8),
                name=name,
            ),
        )

    @staticmethod
    def _corners(card: Card, first: int) -> NDArray[np.float64]:
        found = np.array([card.real(first + k, "a stress point") or 0.0 for k in range(8)]).reshape(4, 2)
        return np.unique(found, axis=0) if found.any() else np.empty((0, 2))

    @staticmethod
    def _checked(card: Card, section: BeamSection) -> BeamSection:
        if section.product**2 > section.second_moment_1 * section.second_moment_2 > 0.0:
            card.fail(f"I12 = {section.product:g}", "I12^2 below I1 I2")
        return section

    def _beam_constants(self, card: Card, name: str) -> tuple[BeamSection, NDArray[np.float64]]:
        constants = [card.real(2 + k, "a constant of the section") or 0.0 for k in range(6)]
        at, stations = 8, []
        corners = np.empty((0, 2))
        if card.word(at).upper() not in {"YES", "YESA", "NO"}:
            corners, at = self._corners(card, 8), 16
        while card.word(at).upper() in {"YES", "YESA", "NO"}:
            values = [card.real(at + 2 + k, "a constant of the section") for k in range(6)]
            stations.append([c if v is None else v for c, v in zip(constants, values, strict=True)])
            at += 16 if card.word(at).upper() == "YES" else 8
        if any(not np.allclose(one, constants, rtol=1e-6, atol=0.0) for one in stations):
            card.fail("its section changes along the beam", "one section; write tapered beams in steps")
        A, I1, I2, I12, J, nsm = constants
        K1, K2 = (1.0 if (k := card.real(at + i, "a shear factor")) is None else k or np.inf for i in (0, 1))
        extra = [card.real(at + k, "a constant of the section") or 0.0 for k in range(2, 16)]
        if any(extra[:10]):
            self.said[
                "PBEAM with shear relief, warping or offset non-structural mass, which are left out"
            ] += 1
        n1a, n2a, n1b, n2b = extra[10:14]
        # blank at B: as at A
        n1b = n1b if card.word(at + 14) else n1a
        n2b = n2b if card.word(at + 15) else n2a
        if (n1a, n2a) != (n1b, n2b):
            card.fail("its neutral axis changes along the beam", "N1 and N2 of both ends equal")
        section = BeamSection(
            area=A,
            second_moment_1=I1,
            second_moment_2=I2,
            torsion=J,
            product=I12,
            shear_area_1=K1 * A,
            shear_area_2=K2 * A,
            shear_centre=(-n1a, -n2a),
            nonstructural_mass=nsm,
            corners=corners - [n1a, n2a] if len(corners) else corners,
            name=name,
        )
        return self._checked(card, section), np.array([n1a, n2a])

    def _shape(self, card: Card, name: str) -> tuple[BeamSection, NDArray[np.float64]]:
        shape = card.word(3).upper()
        made = BAR_SHAPES.get(shape)
        count = ROUND_SHAPES.get(shape) if made is None else made.dimensions
        if count is None:
            card.fail(f"shape {card.word(3)!r}", f"one of {', '.join([*BAR_SHAPES, *ROUND_SHAPES])}")
        dimensions = [card.real(8 + k, "a dimension") for k in range(count)]
        if any(value is None for value in dimensions):
            have = sum(value is not None for value in dimensions)
            card.fail(f"{shape} with {have} dimensions", f"{count} dimensions")
        sizes = tuple(float(value) for value in dimensions if value is not None)
        nsm = card.real(8 + count, "the non-structural mass") or 0.0
        beam = card.name == "PBEAML"
        at = 9 + count
        while beam and card.word(at).upper() in {"YES", "NO"}:  # SO, X/XB, dimensions, NSM
            other = [card.real(at + 2 + k, "a dimension") for k in range(count)]
            if any(v is not None and abs(v - s) > 1e-6 * s for v, s in zip(other, sizes, strict=True)):
                card.fail("its section changes along the beam", "one section; write tapered beams in steps")
            at += 3 + count
        try:
            section = shape_section(
                shape, sizes, nsm, f"{shape} {' x '.join(f'{s:g}' for s in sizes)}", shear_centre=beam
            )
        except InputError as error:
            card.fail(f"{shape}: {error.problem}", "dimensions of a section")
        # a CBEAM ends at its shear centre, a CBAR at its centroid
        return replace(section, name=f"{name} {section.name}"), -np.array(section.shear_centre)

    # -- masses and rigid elements --

    def _extra_mass(
        self, plates: list[DeckPlates], beams: list[DeckBeams]
    ) -> tuple[list[DeckPlates], list[DeckBeams]]:
        """Plates and beams with the nonstructural mass that case control selects."""
        sets = {self.cards.selected}
        for card in self.cards.extra:
            if card.name == "NSMADD" and card.whole(0, "a set") == self.cards.selected:
                sets |= {card.whole(k, "a set") for k in range(1, len(card.fields)) if card.word(k)}
        count = max(self.index.values(), default=-1) + 1
        size, extra = np.zeros(count), np.zeros(count)
        by_property: dict[tuple[str, int], list[NDArray[np.int64]]] = {}
        parts: list[DeckPlates | DeckBeams] = [*plates, *beams]
        for one in parts:
            size[one.index] = element_sizes(one, self.points)
            family, number = one.name.split()
            by_property.setdefault((family, int(number)), []).append(one.index)
        for card in self.cards.extra:
            if card.name == "NSMADD" or card.whole(0, "a set") not in sets:
                continue
            kind = re.sub(r"^P(BARL|BEAML?)$", "PBAR", card.word(1).upper())
            known = {number: parts for (family, number), parts in by_property.items() if family == kind}
            if kind == "ELEMENT":
                known = {label: [np.array([k])] for label, k in self.index.items() if size[k]}
            elif kind not in {"PSHELL", "PBAR", "PROD", "CONROD"}:
                card.fail(f"of {card.word(1)}", "PSHELL, PBAR, PBARL, PBEAM, PBEAML, PROD, CONROD or ELEMENT")
            for value, numbers in self._shares(card, known):
                found = [part for number in numbers for part in known.get(number, [])]
                own = np.concatenate([*found, np.empty(0, dtype=np.int64)])
                if not own.size:
                    card.fail(f"no elements of {kind} {', '.join(map(str, numbers))}", "elements of the deck")
                # per area or length, or in all
                extra[own] += self.weight * (
                    value / size[own].sum() if card.name.startswith("NSML") else value
                )
        return with_extra_mass(plates, beams, extra)

    @staticmethod
    def _shares(card: Card, known: Mapping[int, object]) -> list[tuple[float, list[int]]]:
        """Values and the numbers that each is for."""
        if card.name in {"NSM", "NSML"}:
            places = [k for k in range(2, len(card.fields) - 1, 2) if card.word(k)]
            return [(card.real(k + 1, "a mass") or 0.0, [card.whole(k, "a number")]) for k in places]
        numbers: list[int] = []
        words = [(k, card.word(k).upper()) for k in range(3, len(card.fields)) if card.word(k)]
        for at, (k, word) in enumerate(words):
            if word == "ALL":
                numbers += known
            elif word == "THRU":
                if not numbers or at + 1 >= len(words):
                    card.fail("THRU without numbers", "a number, THRU and a number")
                last = card.whole(words[at + 1][0], "a number")
                numbers += [number for number in known if numbers[-1] < number < last]
            else:
                numbers.append(card.whole(k, "a number, THRU or ALL"))
        return [(card.real(2, "a mass") or 0.0, list(dict.fromkeys(numbers)))]

    def _mass(self, label: int, card: Card) -> PointMass:
        node = card.whole(1, "a node")
        row = self._node(card, node)
        system = card.whole(2, "a coordinate system", 0)
        x = self._vector(card, 4, "a coordinate")
        values = [card.real(8 + k, "a moment of inertia") or 0.0 for k in range(6)]
        i11, i21, i22, i31, i32, i33 = values
        inertia = np.array([[i11, -i21, -i31], [-i21, i22, -i32], [-i31, -i32, i33]])
        if system == -1:
            offset = x - self.points[row] if any(card.word(4 + k) for k in range(3)) else np.zeros(3)
        else:
            self.cards.systems.resolve(system, card, self._place)
            axes = self.cards.systems.axes(system, self.points[row])
            offset, inertia = axes @ x, axes @ inertia @ axes.T
        mass = card.real(3, "a mass") or 0.0
        moments = np.linalg.eigvalsh(inertia)
        if mass < 0.0 or moments[0] < -1e-9 * max(abs(moments[-1]), 1e-300):
            card.fail(
                f"mass {mass:g} with principal moments {', '.join(f'{m:g}' for m in moments)}", "none below 0"
            )
        return PointMass(row, self.weight * mass, offset, self.weight * inertia, f"CONM2 {label}")

    def _components(self, card: Card, index: int, nodes: list[int], default: str = "") -> NDArray[np.bool_]:
        word = card.word(index) or default
        if not word or any(digit not in "123456" for digit in word):
            card.fail(f"components {word!r}", "digits 1 to 6")
        found = np.array([str(k) in word for k in range(1, 7)])
        whole = {bool(part.all() or not part.any()) for part in (found[:3], found[3:])} == {True}
        turned = next((node for node in nodes if self.cd(node)), None)
        if not whole and turned is not None:
            card.fail(
                f"components {word} in the displacement system {self.cd(turned)} of node {turned}",
                "all displacements or all rotations, or nodes with CD 0",
            )
        return found

    def _rigid(self) -> tuple[list[RigidLink], list[Average]]:
        links, averages = [], []
        for label, card in self.cards.rigid.items():
            name = f"{card.name} {label}"
            if card.name == "RBE3":
                averages.append(self._average(card, name))
                continue
            if card.name == "RBAR":
                node, others, components = self._rbar(card)
            else:
                node, others = card.whole(1, "the independent node"), []
                for k in range(3, len(card.fields)):
                    word = card.fields[k]
                    if word.upper() in {"ALPHA", "TREF"} or re.search(r"[.]", word):
                        break
                    if word.upper() == "THRU":
                        others += self._through(card, others, k)[:-1]
                    elif word:
                        others.append(card.whole(k, "a node"))
                components = self._components(card, 2, others)
            if not others:
                card.fail("no dependent node", "one or more")
            if node in others:
                card.fail(f"node {node} depends on itself", "another independent node")
            rows = np.array([self._node(card, other) for other in dict.fromkeys(others)])
            links.append(RigidLink(self._node(card, node), rows, components, name))
        return links, averages

    def _through(self, card: Card, nodes: list[int], k: int) -> list[int]:
        """Nodes behind the last one up to that of the field behind THRU, as far as there are such nodes."""
        if not nodes:
            card.fail("THRU without a node before it", "a node, THRU and a node")
        last = card.whole(k + 1, "a node")
        return [*(label for label in self.row if nodes[-1] < label < last), last]

    def _rbar(self, card: Card) -> tuple[int, list[int], NDArray[np.bool_]]:
        a, b = card.whole(1, "a node"), card.whole(2, "a node")
        independent = ["".join(sorted(card.word(k))) for k in (3, 4)]
        if independent not in (["123456", ""], ["", "123456"]):
            card.fail(
                f"CNA = {independent[0] or 'blank'}, CNB = {independent[1] or 'blank'}",
                "all six degrees of freedom of one end independent",
            )
        first = independent[0] == "123456"
        node, other = (a, b) if first else (b, a)
        return node, [other], self._components(card, 6 if first else 5, [other], "123456")

    def _average(self, card: Card, name: str) -> Average:
        node = card.whole(2, "the reference node")
        components = self._components(card, 3, [node])
        nodes: list[int] = []
        weights: list[float] = []
        weight, k, words = 1.0, 4, card.fields
        turned = False
        while k < len(words):
            word = words[k].upper()
            if word in {"UM", "ALPHA", "TREF"}:
                if word == "UM":
                    self.said["RBE3 with UM: which degrees of freedom depend is chosen here"] += 1
                break
            if not word:
                k += 1
            elif "." in word or not re.fullmatch(r"\d+|THRU", word):
                weight = card.real(k, "a weight") or 0.0
                which = card.word(k + 1)
                if not set("123") <= set(which):
                    card.fail(f"components {which!r} of the averaged nodes", "123, all displacements")
                turned |= which != "123"
                k += 2
            else:
                if word == "THRU":
                    more = self._through(card, nodes, k)
                    k += 1
                else:
                    more = [card.whole(k, "a node")]
                nodes += more
                weights += [weight] * len(more)
                k += 1
        if turned:
            self.said["RBE3 that average rotations too: displacements alone are averaged"] += 1
        if not nodes or not min(weights) > 0.0:
            card.fail(
                "no averaged node" if not nodes else "a weight that is not positive", "nodes and weights"
            )
        rows = np.array([self._node(card, other) for other in nodes])
        return Average(self._node(card, node), rows, np.array(weights), components, name)
