"""Plates, beams, rigid elements and masses of decks of Abaqus and CalculiX.

What is read:

* ``S3``, ``S3R``, ``STRI3``, ``S4``, ``S4R``, ``S4R5`` with ``*SHELL SECTION`` or ``*SHELL GENERAL SECTION``:
  ``OFFSET`` (``SPOS``, ``SNEG``, a fraction), ``*NODAL THICKNESS`` (the mean of the nodes);
* ``B31``, ``B33`` with ``*BEAM SECTION`` (RECT, BOX, I, L, CIRC, PIPE) or ``*BEAM GENERAL SECTION``; the direction n1
  of the section or of a third node, ``*CENTROID``, ``*SHEAR CENTER``, ``*TRANSVERSE SHEAR STIFFNESS``;
* ``MASS``, ``ROTARYI``, ``*NONSTRUCTURAL MASS`` with all ``UNITS`` but per volume;
* ``*COUPLING`` with ``*KINEMATIC`` or ``*DISTRIBUTING``, ``*KINEMATIC COUPLING``, ``*RIGID BODY``, ``*MPC`` of types
  BEAM, TIE and PIN.

Axis 2 of a beam is n1 and axis 3 is n2 = t x n1: ``I22``, the integral of x1^2, bends in plane 1.

Source: Abaqus Analysis User's Guide and Keywords Reference Guide.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, Protocol

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import DeckMaterial, deck_number
from heavylift.preprocess.finite_elements.deck_parts import (
    DeckBeams,
    DeckFrame,
    DeckPlates,
    element_sizes,
    with_extra_mass,
)
from heavylift.preprocess.structures.bar_shapes import BAR_SHAPES
from heavylift.preprocess.structures.sections import BeamSection, centroid, rectangles_section, round_section
from heavylift.preprocess.structures.structure import Average, PointMass, RigidLink, Tie

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.deck import ElementBlock

__all__ = ["FRAME_KEYWORDS", "Card", "FrameMaker", "general_key", "general_material"]


@dataclass
class Card:
    """A keyword with its parameters and data lines."""

    keyword: str  # upper case, without blanks
    shown: str
    parameters: dict[str, str]
    file: Path
    line: int
    data: list[tuple[Path, int, list[str]]] = field(default_factory=list)

    def fail(self, problem: str, expected: str, at: tuple[Path, int] | None = None) -> NoReturn:
        """Refuse it.

        Raises
        ------
        InputError
            Always, with file and line.
        """
        file, line = at or (self.file, self.line)
        raise InputError(f"*{self.shown}: {problem}", source=file, key=f"line {line}", expected=expected)

    def reals(self, row: int, count: int = 0) -> list[float]:
        """Numbers of a data line, zeros for empty fields; as many as `count` at least."""
        if row >= len(self.data):
            return [0.0] * count
        file, line, words = self.data[row]
        found = []
        for word in words:
            try:
                found.append(deck_number(word) if word else 0.0)
            except ValueError:
                self.fail(f"{word!r}", "a finite number", (file, line))
        return found + [0.0] * (count - len(found))


SECTIONS = {"SHELLSECTION", "SHELLGENERALSECTION", "BEAMSECTION", "BEAMGENERALSECTION"}
_BESIDE = {"CENTROID", "SHEARCENTER", "TRANSVERSESHEARSTIFFNESS"}  # of the section before
_COUPLINGS = {"KINEMATIC", "DISTRIBUTING"}  # of the coupling before
FRAME_KEYWORDS = (
    SECTIONS
    | _BESIDE
    | _COUPLINGS
    | {
        "NODALTHICKNESS",
        "MASS",
        "ROTARYINERTIA",
        "NONSTRUCTURALMASS",
        "COUPLING",
        "KINEMATICCOUPLING",
        "RIGIDBODY",
        "MPC",
        "TIE",
        "SHELLTOSOLIDCOUPLING",
        "DISTRIBUTINGCOUPLING",
        "EMBEDDEDELEMENT",
    }
)
"""Keywords that a frame is made of."""
_REFUSED = {
    "TIE": "surfaces that are tied",
    "SHELLTOSOLIDCOUPLING": "couplings of shells and solids",
    "DISTRIBUTINGCOUPLING": "couplings by distributing elements",
    "EMBEDDEDELEMENT": "embedded elements",
}
_SHELLS = re.compile(r"(S3R?S?|S4R?S?W?|S4R5|STRI3)$")
_BEAMS = re.compile(r"B3[13]H?$")
# what meshers write surfaces and lines as, without a section
_MESHED_PLATES, _MESHED_BEAMS = re.compile(r"(CPS[34]|CPE[34]|M3D[34])R?$"), re.compile(r"T3D2$")


def general_material(card: Card) -> DeckMaterial:
    """Material of ``*BEAM GENERAL SECTION``: E and G of its third line, ``DENSITY``."""
    E, G = card.reals(2, 2)[:2]
    if not (E > 0.0 and G > 0.0):
        card.fail("no E and G in the third line", "Young's and the shear modulus")
    nu = E / (2.0 * G) - 1.0
    density = card.parameters.get("DENSITY")
    try:
        rho = None if density is None else deck_number(density)
    except ValueError:
        card.fail(f"DENSITY={density}", "a number")
    if not -1.0 < nu < 0.5:  # G of its own: torsion and shear are scaled to it
        nu = 0.3
    return DeckMaterial(f"*BEAM GENERAL SECTION of line {card.line}", E, nu, rho)


class _Section(NamedTuple):
    """A section of shells or beams, and what stands behind it."""

    card: Card
    beside: list[Card]


Scope = Any
"""A part, or a deck without parts, as the reader has it: it goes back to the reader as it came."""


class Assembled(Protocol):
    """What the reader knows of a deck whose instances have been placed: numbers, sets, cards of its parts."""

    reader: Any
    placed: list[Any]
    points: list[NDArray[np.float64]]
    blocks: list[ElementBlock]
    frame_materials: list[DeckMaterial]

    def elements_of(self, scope: Scope, place: int | None, name: str) -> NDArray[np.int64]:
        """Elements of a set by its name as a part says it."""
        ...

    def named_nodes(self, scope: Scope, place: int | None, word: str) -> NDArray[np.int64]:
        """Rows of a node, of a node of an instance or of a set."""
        ...

    def surface_nodes(
        self, scope: Scope, place: int | None, name: str
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Rows of a surface, and the area that belongs to each of them."""
        ...

    def numbered_blocks(self) -> list[tuple[int, ElementBlock]]:
        """First number of each block, and the block."""
        ...

    def element_label(self, index: int) -> str:
        """Number of an element in the file."""
        ...

    def node_label(self, row: int) -> str:
        """Number of a node in the file."""
        ...

    def third_node(self, index: int) -> int | None:
        """Row of the third node of a beam, for its direction."""
        ...

    def point_element(self, index: int, card: Card) -> NDArray[np.int64]:
        """Row of the node of a mass element."""
        ...


class FrameMaker:
    """From what the reader has kept to a frame.

    Parameters
    ----------
    assembler
        Numbers of nodes and elements, sets.
    materials
        Entry of the materials of the deck by upper-case name.
    """

    def __init__(self, assembler: Assembled, materials: dict[str, int]) -> None:
        self.all, self.materials = assembler, materials
        self.said: Counter[str] = Counter()
        self.refused: Counter[str] = Counter()
        self.first: dict[str, int] = {}
        self.count = sum(len(block.labels) for block in assembler.blocks)
        self.types = [block.name for block in assembler.blocks for _ in block.labels]
        self.nodes = [row for block in assembler.blocks for row in block.nodes]
        self.density = {
            index: one.density or 0.0 for index, one in enumerate(assembler.frame_materials) if index >= 0
        }

    def frame(self) -> DeckFrame:
        """Make it."""
        plates: list[DeckPlates] = []
        beams: list[DeckBeams] = []
        done = np.zeros(self.count, dtype=bool)
        thickness = self._nodal_thickness()
        for place, one in enumerate(self.all.placed):
            for section in _sections(one.part.frame_cards):
                index = self.all.elements_of(one.part, place, section.card.parameters.get("ELSET", ""))
                shells = np.array([k for k in index if _SHELLS.match(self.types[k])], dtype=np.int64)
                bars = np.array([k for k in index if _BEAMS.match(self.types[k])], dtype=np.int64)
                done[index] = True
                if section.card.keyword.startswith("SHELL"):
                    plates += self._plates(section, shells, place, thickness)
                elif bars.size:
                    beams.append(self._beams(section, bars, place))
        plates += self._loose_plates(done)
        beams += self._loose_beams(done)
        plates, beams = self._nonstructural(plates, beams)
        links, averages, ties = self._rigid()
        masses = self._masses()
        reader = self.all.reader
        instead = [
            f"left out: *{card.shown} of line {card.line}, set {card.parameters.get('ELSET', '')!r}"
            for one in self.all.placed
            for card in one.part.frame_cards
            if card.keyword == "NONSTRUCTURALMASS"
        ]
        instead.append(reader.constraints_note(lambda _: True))
        without = reader.constraints_note(lambda key: "".join(key.split()) not in FRAME_KEYWORDS)
        refused = tuple(
            f"{n} {_REFUSED[key]} *{key} (first: line {self.first[key]})" for key, n in self.refused.items()
        )
        notes = tuple(f"{n} {words}" for words, n in self.said.items() if n)
        return DeckFrame(
            tuple(plates),
            tuple(beams),
            tuple(masses),
            tuple(links),
            tuple(averages),
            tuple(ties),
            refused,
            tuple(note for note in (*self._words(), without, *notes) if note),
            tuple(instead),
            frozenset({"MASS", "ROTARYI"}),
        )

    def _words(self) -> list[str]:
        """Elements and keywords that are read, with counts."""
        elements = Counter(
            name
            for name in self.types
            if _SHELLS.match(name) or _BEAMS.match(name) or name in {"MASS", "ROTARYI"}
        )
        solids = Counter({block.name: len(block.labels) for block in self.all.blocks if block.kind})
        cards = Counter(f"*{card.shown}" for one in self.all.placed for card in one.part.frame_cards)
        read = {**elements, **solids, **cards}
        words = [f"read: {', '.join(f'{n} {name}' for name, n in sorted(read.items()))}"] if read else []
        left = self.all.reader.unread
        if left:
            words.append(f"left out: {', '.join(f'{n} *{key}' for key, n in sorted(left.items()))}")
        return words

    # -- plates --

    def _nodal_thickness(self) -> dict[int, float]:
        """Thickness by row of the node."""
        found: dict[int, float] = {}
        for place, one in enumerate(self.all.placed):
            for card in one.part.frame_cards:
                if card.keyword != "NODALTHICKNESS":
                    continue
                for file, line, words in card.data:
                    if len(words) < 2:
                        card.fail(f"{words}", "a node or a set of nodes, and a thickness", (file, line))
                    value = self._number(card, words[1], (file, line))
                    for row in self._rows(one.part, place, words[0], card, (file, line)):
                        found[int(row)] = value
        return found

    @staticmethod
    def _number(card: Card, word: str, at: tuple[Path, int]) -> float:
        try:
            return deck_number(word)
        except ValueError:
            card.fail(f"{word!r}", "a number", at)

    def _rows(
        self, scope: Scope, place: int | None, word: str, card: Card, at: tuple[Path, int]
    ) -> NDArray[np.int64]:
        """Rows of a node, of ``instance.node``, or of a set of nodes."""
        found = self.all.named_nodes(scope, place, word)
        if not found.size:
            card.fail(f"no node {word!r}", "a node or a set of nodes", at)
        return found

    def _plates(
        self, section: _Section, index: NDArray[np.int64], place: int, nodal: dict[int, float]
    ) -> list[DeckPlates]:
        card = section.card
        if not index.size:
            return []
        if "COMPOSITE" in card.parameters:
            card.fail("COMPOSITE: layers", "a homogeneous shell: a thickness and a material")
        material = self.materials.get(card.parameters.get("MATERIAL", "").upper(), -1)
        if card.keyword == "SHELLGENERALSECTION" and material < 0:
            card.fail("stiffness by numbers", "a thickness and a MATERIAL")
        for beside in section.beside:
            self.said[f"*{beside.shown} of shells, which is left out: 5/6 of the thickness is sheared"] += 1
        t = card.reals(0, 1)[0]
        whole = "NODALTHICKNESS" in card.parameters
        if not whole and not t > 0.0:
            card.fail(
                "no thickness" if not card.data else f"thickness {t:g}",
                "a positive thickness in the first data line",
            )
        found = []
        for corners in (3, 4):
            own = index[[len(self.nodes[k]) == corners for k in index]]
            if not own.size:
                continue
            nodes = np.array([self.nodes[k] for k in own])
            thickness = np.full(own.size, t)
            if whole:
                missing = [int(row) for row in np.unique(nodes) if int(row) not in nodal]
                if missing:
                    label = self.all.node_label(missing[0])
                    card.fail(
                        f"NODAL THICKNESS, and node {label} has none ({len(missing)} nodes)",
                        "*NODAL THICKNESS of all nodes",
                    )
                values = np.array([[nodal[int(row)] for row in cell] for cell in nodes])
                thickness = values.mean(axis=1)
                self.said["plates with nodes of different thickness have the mean of it"] += int(
                    (np.ptp(values, axis=1) > 1e-9 * thickness).sum()
                )
            found.append(
                DeckPlates(
                    name=self._name(card, place),
                    index=own,
                    nodes=nodes,
                    material=material,
                    thickness=thickness,
                    # from the mid-surface to the nodes, in thicknesses
                    offset=-self._offset(card) * thickness,
                    file=card.file,
                    place=f"line {card.line}",
                )
            )
        return found

    def _name(self, card: Card, place: int) -> str:
        own = self.all.placed[place].name
        return f"{own}.{card.parameters.get('ELSET', '')}" if own else card.parameters.get("ELSET", "")

    def _offset(self, card: Card) -> float:
        word = card.parameters.get("OFFSET", "0").upper()
        if word in {"SPOS", "SNEG"}:
            return 0.5 if word == "SPOS" else -0.5
        try:
            return deck_number(word)
        except ValueError:
            card.fail(f"OFFSET={word}", "SPOS, SNEG or a fraction of the thickness")

    def _loose_plates(self, done: NDArray[np.bool_]) -> list[DeckPlates]:
        """Shells without a section, by type."""
        found = []
        for start, block in self.all.numbered_blocks():
            own = start + np.flatnonzero(~done[start : start + len(block.labels)])
            meshed = _MESHED_PLATES.match(block.name) and block.harmless
            if (_SHELLS.match(block.name) or meshed) and own.size:
                found.append(
                    DeckPlates(
                        name=block.name,
                        index=own,
                        nodes=block.nodes[own - start],
                        material=-1,
                        thickness=np.full(own.size, np.nan),
                        offset=np.zeros(own.size),
                        loose=True,
                    )
                )
        return found

    # -- beams --

    def _loose_beams(self, done: NDArray[np.bool_]) -> list[DeckBeams]:
        found = []
        for start, block in self.all.numbered_blocks():
            own = start + np.flatnonzero(~done[start : start + len(block.labels)])
            meshed = bool(_MESHED_BEAMS.match(block.name)) and block.harmless
            if (_BEAMS.match(block.name) or meshed) and own.size:
                zeros = np.zeros((own.size, 3))
                found.append(
                    DeckBeams(
                        name=block.name,
                        index=own,
                        nodes=block.nodes[own - start][:, :2],
                        material=-1,
                        section=None,
                        orientation=np.full((own.size, 3), np.nan),
                        offset_a=zeros,
                        offset_b=zeros,
                        released=np.zeros((own.size, 12), dtype=bool),
                        loose=True,
                        optional=meshed,
                    )
                )
        return found

    def _beams(self, section: _Section, index: NDArray[np.int64], place: int) -> DeckBeams:
        card = section.card
        made, centroid = self._section(section)
        own = self.all.placed[place]
        n1 = np.array(card.reals(1, 3)[:3]) if len(card.data) > 1 and card.data[1][2] else None
        if n1 is not None and not n1.any():
            n1 = None
        nodes = np.array([self.nodes[k][:2] for k in index])
        points = np.vstack(self.all.points)
        along = points[nodes[:, 1]] - points[nodes[:, 0]]
        length = np.linalg.norm(along, axis=1)
        if not (length > 0.0).all():
            at = self.all.element_label(int(index[np.argmin(length)]))
            card.fail(f"element {at} has no length", "two different ends")
        default = np.array([0.0, 0.0, -1.0]) if n1 is None else n1
        v = np.tile(own.rotation @ default, (index.size, 1))
        for k, number in enumerate(index):
            extra = self.all.third_node(int(number))
            if extra is not None:
                v[k] = points[extra] - points[nodes[k, 0]]
        across = np.linalg.norm(np.cross(along, v), axis=1)
        wrong = np.flatnonzero(~(across > 1e-3 * length * np.linalg.norm(v, axis=1)))
        if wrong.size:
            at = self.all.element_label(int(index[wrong[0]]))
            words = (
                f"the default n1 (0, 0, -1) is along element {at}"
                if n1 is None
                else f"n1 is along element {at}"
            )
            card.fail(words, "a direction n1 across the beam in the second data line")
        types = {self.types[k] for k in index}
        if any(name.startswith("B33") for name in types):
            if len({name[:3] for name in types}) > 1:
                card.fail("elements B31 and B33 at once", "a section for each")
            made = replace(made, shear_area_1=np.inf, shear_area_2=np.inf)
            self.said["beams B33 have no shear flexibility, as in their program"] += int(index.size)
        offset = np.zeros((index.size, 3))
        if centroid.any():
            e1 = along / length[:, None]
            e3 = np.cross(e1, v)
            e3 /= np.linalg.norm(e3, axis=1)[:, None]
            offset = centroid[0] * np.cross(e3, e1) + centroid[1] * e3
        material = card.parameters.get("MATERIAL", "").upper()
        if card.keyword == "BEAMGENERALSECTION":
            material = general_key(card)
        return DeckBeams(
            name=self._name(card, place),
            index=index,
            nodes=nodes,
            material=self.materials.get(material, -1),
            section=made,
            orientation=v,
            offset_a=offset,
            offset_b=offset.copy(),
            released=np.zeros((index.size, 12), dtype=bool),
            file=card.file,
            place=f"line {card.line}",
        )

    def _section(self, section: _Section) -> tuple[BeamSection, NDArray[np.float64]]:
        """Section, and its centroid from the node, axes n1 and n2."""
        card = section.card
        shape = card.parameters.get("SECTION", "GENERAL").upper()
        name = f"{shape} {card.parameters.get('ELSET', '')}"
        values = card.reals(0)
        centroid = np.zeros(2)
        shear = np.zeros(2)
        if shape == "GENERAL":
            if len(values) < 5:
                card.fail(f"{len(values)} constants", "A, I11, I12, I22, J", _first(card))
            A, I11, I12, I22, J = values[:5]
            if any(values[5:]):
                self.said["sections with warping constants, which are left out"] += 1
            if not A > 0.0:
                card.fail(f"the area {A:g}", "a positive area", _first(card))
            made = BeamSection(A, I22, I11, J, product=I12, name=name)
        else:
            try:
                made, centroid = _shaped(shape, values, name)
            except ValueError as error:
                problem = error.problem if isinstance(error, InputError) else str(error)
                card.fail(f"SECTION={shape}: {problem}", "dimensions of such a section", _first(card))
            except KeyError:
                card.fail(f"SECTION={shape}", "RECT, BOX, I, L, CIRC, PIPE or GENERAL")
        G = None
        if card.keyword == "BEAMGENERALSECTION":
            E, given = card.reals(2, 2)[:2]
            material = general_material(card)
            assert material.poisson_ratio is not None
            G = E / (2.0 * (1.0 + material.poisson_ratio))
            ratio = given / G
            made = replace(
                made,
                torsion=ratio * made.torsion,
                shear_area_1=ratio * made.shear_area_1,
                shear_area_2=ratio * made.shear_area_2,
            )
        for beside in section.beside:
            at = np.array(beside.reals(0, 2)[:2])
            if beside.keyword == "CENTROID":
                centroid = at
            elif beside.keyword == "SHEARCENTER":
                shear = at
            else:
                if G is None:
                    index = self.materials.get(card.parameters.get("MATERIAL", "").upper(), -1)
                    one = self.all.frame_materials[index] if index >= 0 else None
                    if one is None or one.young_modulus is None or one.poisson_ratio is None:
                        beside.fail("no material tells G", "*ELASTIC of the material")
                    G = one.young_modulus / (2.0 * (1.0 + one.poisson_ratio))
                # K23, K13: of shear along n2 and n1
                made = replace(made, shear_area_1=at[1] / G, shear_area_2=at[0] / G)
        if any(beside.keyword != "TRANSVERSESHEARSTIFFNESS" for beside in section.beside):
            at = shear - centroid
            made = replace(made, shear_centre=(float(at[0]), float(at[1])))
        return made, centroid

    # -- masses --

    def _nonstructural(
        self, plates: list[DeckPlates], beams: list[DeckBeams]
    ) -> tuple[list[DeckPlates], list[DeckBeams]]:
        """Plates and beams with what ``*NONSTRUCTURAL MASS`` adds; properties are split where it differs."""
        extra = np.zeros(self.count)  # per area or length
        any_found = False
        for place, one in enumerate(self.all.placed):
            for card in one.part.frame_cards:
                if card.keyword != "NONSTRUCTURALMASS":
                    continue
                any_found = True
                index = self.all.elements_of(one.part, place, card.parameters.get("ELSET", ""))
                own = np.zeros(self.count, dtype=bool)
                own[index] = True
                self._add_mass(card, own, plates, beams, extra)
        if not any_found:
            return plates, beams
        return with_extra_mass(plates, beams, extra)

    def _add_mass(
        self,
        card: Card,
        own: NDArray[np.bool_],
        plates: list[DeckPlates],
        beams: list[DeckBeams],
        extra: NDArray[np.float64],
    ) -> None:
        units = "".join(card.parameters.get("UNITS", "").split()).upper()
        value = card.reals(0, 1)[0]
        of_plates = np.zeros(self.count, dtype=bool)
        of_beams = np.zeros(self.count, dtype=bool)
        for plate in plates:
            of_plates[plate.index] = True
        for beam in beams:
            of_beams[beam.index] = True
        if (own & ~of_plates & ~of_beams).any() and units != "TOTALMASS":
            card.fail("elements that are neither shells nor beams", "a set of shells or beams")
        if units == "MASSPERAREA":
            if (own & of_beams).any():
                card.fail("a mass per area of beams", "UNITS=MASS PER LENGTH or TOTAL MASS")
            extra[own] += value
        elif units == "MASSPERLENGTH":
            if (own & of_plates).any():
                card.fail("a mass per length of shells", "UNITS=MASS PER AREA or TOTAL MASS")
            extra[own] += value
        elif units == "TOTALMASS":
            if (own & ~of_plates & ~of_beams).any():
                card.fail("elements that are neither shells nor beams", "a set of shells or beams")
            by_volume = "VOLUME" in card.parameters.get("DISTRIBUTION", "").upper()
            per, size = np.zeros(self.count), np.zeros(self.count)
            points = np.vstack(self.all.points)
            for plate in plates:
                rho = 1.0 if by_volume else self.density.get(plate.material, 0.0)
                per[plate.index] = rho * plate.thickness
                size[plate.index] = element_sizes(plate, points)
            for beam in beams:
                rho = 1.0 if by_volume else self.density.get(beam.material, 0.0)
                per[beam.index] = rho * (beam.section.area if beam.section else 0.0)
                size[beam.index] = element_sizes(beam, points)
            total = float((per * size)[own].sum())
            if not total > 0.0:
                card.fail("its elements have no mass to share it by", "elements with density and thickness")
            extra[own] += value * per[own] / total
        else:
            card.fail(
                f"UNITS={card.parameters.get('UNITS', '')}", "TOTAL MASS, MASS PER AREA or MASS PER LENGTH"
            )

    def _masses(self) -> list[PointMass]:
        mass: dict[int, float] = {}
        inertia: dict[int, NDArray[np.float64]] = {}
        names: dict[int, str] = {}
        for place, one in enumerate(self.all.placed):
            for card in one.part.frame_cards:
                if card.keyword not in {"MASS", "ROTARYINERTIA"}:
                    continue
                name = "MASS" if card.keyword == "MASS" else "ROTARYI"
                index = self.all.elements_of(one.part, place, card.parameters.get("ELSET", ""))
                values = card.reals(0, 6)
                if "ORIENTATION" in card.parameters:
                    card.fail("ORIENTATION: local axes", "global axes, or those of the part")
                tensor = np.array(
                    [
                        [values[0], values[3], values[4]],
                        [values[3], values[1], values[5]],
                        [values[4], values[5], values[2]],
                    ]
                )
                if name == "MASS" and values[0] < 0.0:
                    card.fail(f"mass {values[0]:g}", "a mass above 0", _first(card))
                if name == "ROTARYI" and np.linalg.eigvalsh(tensor)[0] < -1e-9 * abs(tensor).max():
                    card.fail("a tensor with a negative moment", "moments of inertia of a body", _first(card))
                tensor = one.rotation @ tensor @ one.rotation.T
                for number in index:
                    if self.types[number] != name:
                        continue
                    for row in self.all.point_element(int(number), card):
                        names.setdefault(int(row), f"{name} {self.all.element_label(int(number))}")
                        if name == "MASS":
                            mass[int(row)] = mass.get(int(row), 0.0) + values[0]
                        else:
                            inertia[int(row)] = inertia.get(int(row), np.zeros((3, 3))) + tensor
        return [
            PointMass(row, mass.get(row, 0.0), np.zeros(3), inertia.get(row, np.zeros((3, 3))), names[row])
            for row in sorted(names)
        ]

    # -- rigid elements --

    def _rigid(self) -> tuple[list[RigidLink], list[Average], list[Tie]]:
        links: list[RigidLink] = []
        averages: list[Average] = []
        ties: list[Tie] = []
        for place, one in enumerate(self.all.placed):
            coupling: Card | None = None
            cards: list[Card] = one.part.frame_cards
            for card in cards:
                key = card.keyword
                if key in _REFUSED:
                    self.refused[key] += 1
                    self.first.setdefault(key, card.line)
                elif key == "COUPLING":
                    coupling = card
                elif key in _COUPLINGS:
                    if coupling is None:
                        card.fail("no *COUPLING before it", "*COUPLING with REF NODE and SURFACE")
                    self._coupling(one.part, place, coupling, card, links, averages)
                    coupling = None
                elif key == "KINEMATICCOUPLING":
                    self._kinematic(one.part, place, card, links)
                elif key == "RIGIDBODY":
                    self._rigid_body(one.part, place, card, links)
                elif key == "MPC":
                    self._mpc(one.part, place, card, links, ties)
        return links, averages, ties

    def _reference(self, scope: Scope, place: int, card: Card) -> int:
        word = card.parameters.get("REFNODE", "")
        rows = self._rows(scope, place, word, card, (card.file, card.line))
        if rows.size != 1:
            card.fail(f"REF NODE={word}: {rows.size} nodes", "one node")
        return int(rows[0])

    def _coupling(
        self,
        scope: Scope,
        place: int,
        coupling: Card,
        card: Card,
        links: list[RigidLink],
        averages: list[Average],
    ) -> None:
        name = f"*COUPLING {coupling.parameters.get('CONSTRAINTNAME', '')}".strip()
        if "INFLUENCERADIUS" in coupling.parameters:
            coupling.fail("INFLUENCE RADIUS", "a surface with the nodes that are coupled")
        node = self._reference(scope, place, coupling)
        surface = coupling.parameters.get("SURFACE", "")
        rows, areas = self.all.surface_nodes(scope, place, surface)
        areas = areas[rows != node]
        rows = rows[rows != node]
        if not rows.size:
            coupling.fail(f"surface {surface!r} has no nodes", "a surface of faces or nodes")
        components = self._components(card)
        if card.keyword == "KINEMATIC":
            links.append(RigidLink(node, rows, components, name))
            return
        method = "".join(card.parameters.get("WEIGHTINGMETHOD", "UNIFORM").split()).upper()
        if method != "UNIFORM":
            card.fail(f"WEIGHTING METHOD={method}", "UNIFORM")
        if not components[:3].all():
            card.fail(
                "displacements that are not all averaged", "all displacements, or all degrees of freedom"
            )
        averages.append(Average(node, rows, areas, components, name))

    def _components(self, card: Card) -> NDArray[np.bool_]:
        """Degrees of freedom of data lines ``first, last``; all without lines."""
        if not card.data:
            return np.ones(6, dtype=bool)
        found = np.zeros(6, dtype=bool)
        for file, line, words in card.data:
            numbers = [int(word) for word in words if re.fullmatch(r"[1-6]", word)]
            if not numbers or len(numbers) != len([word for word in words if word]):
                card.fail(f"{', '.join(words)!r}", "degrees of freedom 1 to 6: first, last", (file, line))
            found[numbers[0] - 1 : numbers[-1]] = True
        whole = all(part.all() or not part.any() for part in (found[:3], found[3:]))
        if not whole and self.all.reader.unread["TRANSFORM"]:
            card.fail(
                "single directions beside *TRANSFORM", "all displacements or all rotations, or global axes"
            )
        return found

    def _kinematic(self, scope: Scope, place: int, card: Card, links: list[RigidLink]) -> None:
        node = self._reference(scope, place, card)
        by_components: dict[tuple[bool, ...], list[NDArray[np.int64]]] = {}
        for file, line, words in card.data:
            rows = self._rows(scope, place, words[0], card, (file, line))
            some = replace(card, data=[(file, line, words[1:])] if words[1:] else [])
            key = tuple(bool(x) for x in self._components(some))
            by_components.setdefault(key, []).append(rows[rows != node])
        for components, parts in by_components.items():
            links.append(
                RigidLink(
                    node,
                    np.unique(np.concatenate(parts)),
                    np.array(components),
                    f"*KINEMATIC COUPLING {card.line}",
                )
            )

    def _rigid_body(self, scope: Scope, place: int, card: Card, links: list[RigidLink]) -> None:
        node = self._reference(scope, place, card)
        at = (card.file, card.line)
        keys = (("ELSET", 6), ("NSET", 6), ("TIENSET", 6), ("PINNSET", 3))  # NSET: CalculiX
        if not any(key in card.parameters for key, _ in keys):
            card.fail("no set of nodes or elements", "ELSET, TIE NSET or PIN NSET")
        if "ROTNODE" in card.parameters:
            self.said["*RIGID BODY with a ROT NODE: its rotation is that of the REF NODE here"] += 1
        for key, count in keys:
            word = card.parameters.get(key)
            if word is None:
                continue
            if key == "ELSET":
                index = self.all.elements_of(scope, place, word)
                rows = np.unique(np.concatenate([[node], *[self.nodes[k] for k in index]])).astype(np.int64)
            else:
                rows = self._rows(scope, place, word, card, at)
            components = np.arange(6) < count
            rows = rows[rows != node]
            if not rows.size:
                card.fail(f"{key.replace('NSET', ' NSET')}={word} has no nodes", "a set with nodes")
            links.append(RigidLink(node, rows, components, f"*RIGID BODY {word}"))

    def _mpc(self, scope: Scope, place: int, card: Card, links: list[RigidLink], ties: list[Tie]) -> None:
        for file, line, words in card.data:
            kind = words[0].upper() if words else ""
            if kind not in {"BEAM", "TIE", "PIN"} or len(words) < 3:
                card.fail(f"{', '.join(words)!r}", "BEAM, TIE or PIN, and two nodes or sets", (file, line))
            first = self._rows(scope, place, words[1], card, (file, line))
            second = self._rows(scope, place, words[2], card, (file, line))
            if second.size == 1:
                second = np.repeat(second, first.size)
            if first.size != second.size:
                card.fail(
                    f"{first.size} nodes and {second.size} nodes", "sets with as many nodes", (file, line)
                )
            name = f"*MPC {kind} of line {line}"
            for dependent, node in zip(first.tolist(), second.tolist(), strict=True):
                if kind == "BEAM":
                    links.append(RigidLink(node, np.array([dependent]), name=name))
                else:
                    ties.append(Tie(node, dependent, np.arange(6) < (6 if kind == "TIE" else 3), name))


def general_key(card: Card) -> str:
    """Name of the material of a ``*BEAM GENERAL SECTION`` among those of the deck."""
    return f"*BEAM GENERAL SECTION {card.file} {card.line}"


def _sections(cards: list[Card]) -> list[_Section]:
    found: list[_Section] = []
    for card in cards:
        if card.keyword in SECTIONS:
            found.append(_Section(card, []))
        elif card.keyword in _BESIDE:
            if not found:
                card.fail("no section before it", "*BEAM GENERAL SECTION or *BEAM SECTION")
            found[-1].beside.append(card)
    return found


def _first(card: Card) -> tuple[Path, int]:
    return (card.data[0][0], card.data[0][1]) if card.data else (card.file, card.line)


def _shaped(shape: str, values: list[float], name: str) -> tuple[BeamSection, NDArray[np.float64]]:
    """Section of a shape of Abaqus, and its centroid from the node; axes n1 and n2."""
    counts = {"RECT": 2, "BOX": 6, "I": 7, "L": 4, "CIRC": 1, "PIPE": 2}
    count = counts[shape]
    if len(values) < count:
        raise ValueError(f"{len(values)} dimensions, and it has {count}")
    v = values[:count]
    if any(not x > 0.0 for x in (v[1:] if shape == "I" else v)):
        raise ValueError("dimensions that are not positive")
    zero = np.zeros(2)
    if shape == "CIRC":
        return round_section(v[0], name=name), zero
    if shape == "PIPE":
        return round_section(v[0], v[0] - v[1], name=name), zero
    # rectangles between coordinates along n2 and n1, as shapes are described upright
    closed = None
    if shape == "RECT":
        a, b = v
        parts = [(-b / 2, b / 2, -a / 2, a / 2)]
    elif shape == "BOX":
        # a along n1, b along n2; walls at +n1, +n2, -n1, -n2
        a, b, t1, t2, t3, t4 = v
        box = BAR_SHAPES["BOX1"]
        assert box.closed is not None
        dimensions = (a, b, t2, t4, t3, t1)
        parts = [
            (y0 - b / 2, y1 - b / 2, z0 - a / 2, z1 - a / 2) for y0, y1, z0, z1 in box.rectangles(*dimensions)
        ]
        closed = box.closed(*dimensions)
    elif shape == "L":
        # a along n1 and b along n2, thicknesses t1 and t2; the node is where the middle lines meet
        a, b, t1, t2 = v
        parts = [(-t1 / 2, t1 / 2, -t2 / 2, a - t2 / 2), (t1 / 2, b - t1 / 2, -t2 / 2, t2 / 2)]
    else:
        # the node lies l above the lower edge of the flange b1 x t1; height h along n2, upper flange b2 x t2, web t3
        low, h, b1, b2, t1, t2, t3 = v
        parts = [
            (y0 - low, y1 - low, z0, z1)
            for y0, y1, z0, z1 in BAR_SHAPES["I"].rectangles(h, b1, b2, t3, t1, t2)
        ]
    made = rectangles_section(parts, closed, name=name)
    turned = replace(
        made,
        second_moment_1=made.second_moment_2,
        second_moment_2=made.second_moment_1,
        shear_area_1=made.shear_area_2,
        shear_area_2=made.shear_area_1,
        corners=made.corners[:, ::-1],
    )
    return turned, np.array(centroid(parts)[::-1])
