"""Archives of Ansys Mechanical APDL (``.cdb``, written by CDWRITE): nodes, elements, sections, components, materials.

What is read: ``NBLOCK``, ``EBLOCK`` (SOLID format), ``ET``, ``KEYOP``; ``SHELL181`` with ``SECDATA`` and ``SECOFFSET``
of one layer, ``BEAM188`` with its shapes of rectangles and circles or ``ASEC``; ``SOLID185``, ``SOLID186`` and
``SOLID187``; ``MASS21`` with ``R`` or ``RLBLOCK``; ``MPC184`` rigid beams; ``CP``; ``CMBLOCK``; ``MPDATA`` and ``MP``.
Refused, with counts: other elements, layered sections, ``CE`` (also from CERIG and RBE3, which the archive writes so).

Axis 2 of a beam is the z axis of Ansys, which points to the third node, and axis 3 is -y.

Source: Ansys *Mechanical APDL Programmer's Reference*, chapter *The Coded Database File Commands*; *Element Reference*;
*Command Reference*. A package for archives reads nodes, elements and components, but neither sections nor materials nor
couplings, which are most of what a structure needs.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import field, replace
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import (
    Deck,
    DeckMaterial,
    ElementBlock,
    deck_number,
    deck_text,
)
from heavylift.preprocess.finite_elements.deck_parts import DeckBeams, DeckFrame, DeckPlates
from heavylift.preprocess.structures.bar_shapes import BAR_SHAPES, shape_section
from heavylift.preprocess.structures.sections import BeamSection, rectangles_section, round_section
from heavylift.preprocess.structures.structure import PointMass, RigidLink, Tie

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["read_ansys_deck"]

_SOLIDS = {185: ("hex8", 8, "hexahedron"), 186: ("hex20", 20, "hexahedron20"), 187: ("tet10", 10, "tetra10")}
_NAMES = {
    21: "MASS21",
    181: "SHELL181",
    184: "MPC184",
    185: "SOLID185",
    186: "SOLID186",
    187: "SOLID187",
    188: "BEAM188",
}
# what only carries loads and contact
_HARMLESS = {152, 153, 154, 156, 159, 170, 171, 172, 173, 174, 175, 176, 177, 178}
_REMEDY = "SHELL181, BEAM188, SOLID185, SOLID186, SOLID187, MASS21 and MPC184"
_DIRECTIONS = {"UX": 0, "UY": 1, "UZ": 2, "ROTX": 3, "ROTY": 4, "ROTZ": 5}


@dataclass
class _Element:
    label: int
    kind: int  # number of the element, e.g. 181
    type_id: int
    material: int
    real: int
    section: int
    nodes: list[int]
    line: int


@dataclass
class _Section:
    kind: str
    subtype: str
    line: int
    data: list[list[str]] = field(default_factory=list)
    offset: list[str] = field(default_factory=list)


def read_ansys_deck(path: Path) -> Deck:
    """Read an archive of Ansys; see the module for what is understood.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    InputError
        A file that is no archive; a number, node or section that is wrong, with file and line.
    """
    reader = _Reader(path)
    reader.read()
    if not reader.nodes:
        raise InputError("contains no NBLOCK", source=path, expected="an archive that CDWRITE has written")
    return reader.deck()


class _Reader:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.lines = deck_text(path)
        self.at = 0
        self.types: dict[int, int] = {}
        self.options: dict[tuple[int, int], int] = {}
        self.nodes: dict[int, list[float]] = {}
        self.turned = 0
        self.elements: dict[int, _Element] = {}
        self.sections: dict[int, _Section] = {}
        self.section: _Section | None = None
        self.reals: dict[int, list[float]] = {}
        self.components: dict[str, tuple[str, list[tuple[int, int]]]] = {}
        self.properties: dict[int, dict[str, float]] = {}
        self.coupled: dict[int, tuple[str, list[int], int]] = {}
        self.equations: dict[str, int] = {}
        self.counts: Counter[str] = Counter()
        self.left: Counter[str] = Counter()
        self.units = ""
        self.said: Counter[str] = Counter()
        self.last = self.open_couple = 0  # set of constants, of coupled nodes that goes on

    def fail(self, problem: str, expected: str, line: int | None = None) -> NoReturn:
        raise InputError(
            problem, source=self.path, key=f"line {self.at if line is None else line}", expected=expected
        )

    def number(self, word: str) -> float:
        try:
            return deck_number(word) if word else 0.0
        except ValueError:
            self.fail(f"{word!r}", "a number")

    def whole(self, word: str) -> int:
        text = word.strip()
        if not re.fullmatch(r"[+-]?\d{1,18}", text):
            value = self.number(text)
            if value != int(value):
                self.fail(f"{word!r}", "a whole number")
            return int(value)
        return int(text)

    # -- text --

    def read(self) -> None:
        """All lines."""
        while self.at < len(self.lines):
            line = self.lines[self.at]
            self.at += 1
            words = [word.strip() for word in line.partition("!")[0].split(",")]
            key = words[0].upper()
            if not key or key.startswith(("/COM", "C***", "*")):
                continue
            verb = {
                "NBLOCK": self._nodes,
                "EBLOCK": self._elements,
                "ET": self._type,
                "KEYOP": self._option,
                "KEYOPT": self._option,
                "SECTYPE": self._sectype,
                "SECDATA": self._secdata,
                "SECOFFSET": self._secoffset,
                "SECBLOCK": self._secblock,
                "R": self._real,
                "RMORE": self._real_more,
                "RLBLOCK": self._real_block,
                "CMBLOCK": self._component,
                "MPDATA": self._mpdata,
                "MP": self._mp,
                "CP": self._couple,
                "CE": self._equation,
                "/UNITS": self._units,
            }.get(key)
            if verb is not None:
                if key != "CE":
                    self.counts[key] += 1
                least = {"R": 2, "RMORE": 1, "SECDATA": 2, "SECOFFSET": 2}.get(key, 5)
                verb(words + [""] * (least - len(words)))
            elif re.fullmatch(r"[A-Z][A-Z0-9]*", key) and key not in {
                "NUMOFF",
                "N",
                "FINISH",
                "TYPE",
                "MAT",
                "REAL",
            }:
                self.left[key] += 1

    def _format(self) -> tuple[int, int, int, int]:
        """Counts and widths of whole and real fields of a block's format line, e.g. (3i9,6e21.13e3)."""
        text = self.lines[self.at] if self.at < len(self.lines) else ""
        self.at += 1
        match = re.match(r"\s*\((\d+)i(\d+)(?:,(\d+)[eg](\d+))?", text, re.IGNORECASE)
        if match is None:
            self.fail(f"{text.strip()!r}", "the format of a block, e.g. (3i9,6e21.13e3)")
        return int(match[1]), int(match[2]), int(match[3] or 0), int(match[4] or 0)

    def _rows(self) -> Iterator[str]:
        """Lines of a block; an end that is missing is told."""
        while self.at < len(self.lines):
            line = self.lines[self.at]
            self.at += 1
            yield line
        self.fail("the file ends within a block", "a whole file")

    def _nodes(self, words: list[str]) -> None:
        if len(words) > 2 and words[2].upper() not in {"SOLID", ""}:
            self.fail(f"NBLOCK of format {words[2]!r}", "SOLID, as CDWRITE writes it")
        ints, width, reals, wide = self._format()
        start = ints * width
        for line in self._rows():
            if re.match(r"\s*(N,|-1\s*$)", line, re.IGNORECASE):
                return
            label = self.whole(line[:width])
            # zeros at the end are left out
            values = [
                self.number(line[start + k * wide : start + (k + 1) * wide].strip()) for k in range(reals)
            ]
            self.nodes[label] = (values + [0.0] * 3)[:3]
            self.turned += any(values[3:])

    def _elements(self, words: list[str]) -> None:
        if len(words) < 3 or words[2].upper() != "SOLID":
            self.fail("EBLOCK without SOLID", "EBLOCK,19,SOLID, as CDWRITE writes it")
        _, width, *_ = self._format()
        rows = self._rows()
        for line in rows:
            fields = self._fields(line, width)
            if fields and fields[0] == -1:
                return
            if len(fields) < 11:
                self.fail(f"{len(fields)} fields", "11 fields and the nodes of an element")
            material, type_id, real, section = fields[:4]
            count, label, first = fields[8], fields[10], self.at
            nodes = fields[11:]
            while len(nodes) < count:
                nodes += self._fields(next(rows), width)
            kind = self.types.get(type_id, 0)
            if not kind:
                self.fail(
                    f"element {label} has type {type_id}, which no ET defines", "an ET before the elements"
                )
            if label in self.elements:
                self.fail(f"element {label} is defined twice", "every element once", first)
            self.elements[label] = _Element(
                label, kind, type_id, material, real, section, nodes[:count], first
            )

    def _fields(self, line: str, width: int) -> list[int]:
        pieces = [line[k : k + width].strip() for k in range(0, len(line.rstrip()), width)]
        return [self.whole(piece) for piece in pieces if piece]

    def _type(self, words: list[str]) -> None:
        match = re.search(r"(\d+)$", words[2] if len(words) > 2 else "")
        if match is None:
            self.fail(f"ET {','.join(words[1:])}", "the number of a type and of an element, e.g. ET,1,181")
        self.types[self.whole(words[1])] = int(match[1])

    def _option(self, words: list[str]) -> None:
        if len(words) > 3:
            self.options[self.whole(words[1]), self.whole(words[2])] = self.whole(words[3])

    # -- sections, constants, materials --

    def _sectype(self, words: list[str]) -> None:
        label = self.whole(words[1])
        kind = (words[2] if len(words) > 2 else "").upper()
        subtype = (words[3] if len(words) > 3 else "").upper()
        self.section = self.sections[label] = _Section(kind, subtype, self.at)

    def _secdata(self, words: list[str]) -> None:
        if self.section is None:
            self.fail("SECDATA without SECTYPE", "a SECTYPE before it")
        self.section.data.append(words[1:])

    def _secblock(self, words: list[str]) -> None:
        """Layers of a shell section, a line each."""
        if self.section is None:
            self.fail("SECBLOCK without SECTYPE", "a SECTYPE before it")
        for _ in range(self.whole(words[1])):
            self.section.data.append([word.strip() for word in next(self._rows()).split(",")])

    def _secoffset(self, words: list[str]) -> None:
        if self.section is None:
            self.fail("SECOFFSET without SECTYPE", "a SECTYPE before it")
        self.section.offset = [words[1].upper() if len(words) > 1 else "", *words[2:]]

    def _real(self, words: list[str]) -> None:
        if len(words) > 1 and words[1].upper().startswith("R5"):  # R,R5.0,set,location,values
            del words[1]
            words = [words[0], words[1], *words[3:]]
        self.last = self.whole(words[1])
        self.reals[self.last] = [self.number(word) for word in words[2:]]

    def _real_more(self, words: list[str]) -> None:
        self.reals.setdefault(self.last, []).extend(self.number(word) for word in words[1:])

    def _real_block(self, words: list[str]) -> None:
        sets = self.whole(words[1])
        ints, width, reals, wide = self._format()
        second = re.match(r"\s*\((\d+)[eg](\d+)", self.lines[self.at], re.IGNORECASE)
        if second is None:
            self.fail(f"{self.lines[self.at].strip()!r}", "a format, e.g. (7g16.9)")
        self.at += 1
        rows = self._rows()
        for _ in range(sets):
            line = next(rows)
            label, count = (self.whole(line[k * width : (k + 1) * width]) for k in (0, 1))
            start = ints * width
            values = [
                self.number(line[start + k * wide : start + (k + 1) * wide].strip()) for k in range(reals)
            ]
            while len(values) < count:
                line = next(rows)
                values += [
                    self.number(line[k * int(second[2]) : (k + 1) * int(second[2])].strip())
                    for k in range(int(second[1]))
                ]
            self.reals[label] = values[:count]

    def _component(self, words: list[str]) -> None:
        name, kind, count = words[1], words[2].upper(), self.whole(words[3])
        _, width, *_ = self._format()
        items: list[int] = []
        rows = self._rows()
        while len(items) < count:
            items += self._fields(next(rows), width)[: max(count - len(items), 0)]
        found: list[tuple[int, int]] = []  # first and last; a negative number ends a range
        for item in items:
            if item < 0 and found:
                found[-1] = (found[-1][0], -item)
            else:
                found.append((item, item))
        self.components[name] = (kind, found)

    def _mpdata(self, words: list[str]) -> None:
        words = [word for word in words if not word.upper().startswith("R5")] + [""] * 4
        # MPDATA, [number,] label, material, location, values
        if words[1].replace("+", "").isdigit():
            del words[1]
        self._constant(words[1], words[2], words[4:5], first=self.whole(words[3]) == 1)

    def _mp(self, words: list[str]) -> None:
        self._constant(words[1], words[2], words[3:4], first=True)

    def _constant(self, label: str, material: str, values: list[str], *, first: bool) -> None:
        if first and values:
            self.properties.setdefault(self.whole(material), {})[label.upper()] = self.number(values[0])

    def _couple(self, words: list[str]) -> None:
        """CP,R5.0,DEFI,set,count,label and CP,R5.0,NODE,nodes, or CP,set,label,nodes: equal degrees of freedom."""
        words = [word for word in words if not word.upper().startswith("R5")] + [""] * 2
        if words[1].upper() == "DEFI":
            label = words[4].upper() if len(words) > 4 else ""
            self.open_couple = self.whole(words[2])
            self.coupled[self.open_couple] = (label, [], self.at)
        elif words[1].upper() == "NODE":
            if self.open_couple not in self.coupled:
                self.fail("CP of nodes without its definition", "CP,R5.0,DEFI before it")
            self.coupled[self.open_couple][1].extend(self.whole(word) for word in words[2:] if word)
        elif len(words) > 3:  # CP,set,label,nodes
            label, _, line = self.coupled.get(self.whole(words[1]), (words[2].upper(), [], self.at))
            self.coupled.setdefault(self.whole(words[1]), (label, [], line))[1].extend(
                self.whole(word) for word in words[3:] if word
            )

    def _equation(self, words: list[str]) -> None:
        words = [word for word in words if not word.upper().startswith("R5")] + [""] * 2
        if words[1].upper() in {"NODE", "HIGH"}:
            return
        self.equations.setdefault(words[2] if words[1].upper() == "DEFI" else words[1], self.at)

    def _units(self, words: list[str]) -> None:
        self.units = ",".join(filter(None, words[1:]))

    # -- everything together --

    def deck(self) -> Deck:
        """One numbering of nodes and elements."""
        row = {label: k for k, label in enumerate(self.nodes)}
        points = np.array(list(self.nodes.values()), dtype=np.float64).reshape(-1, 3)
        by_type: dict[int, list[_Element]] = {}
        for element in self.elements.values():
            by_type.setdefault(element.kind, []).append(element)
        blocks: list[ElementBlock] = []
        order: list[_Element] = []
        for kind, members in by_type.items():
            order += members
            blocks.append(self._block(kind, members, row))
        numbers = {element.label: k for k, element in enumerate(order)}
        sets: dict[str, list[int]] = {}
        for k, element in enumerate(order):
            if element.kind in _SOLIDS:
                sets.setdefault(f"material {element.material}", []).append(k)
            elif element.kind in {181, 188}:
                sets.setdefault(f"section {element.section}", []).append(k)
        element_sets = {name: np.array(members, dtype=np.int64) for name, members in sets.items()}
        node_sets: dict[str, NDArray[np.int64]] = {}
        for name, (sort, items) in self.components.items():
            known = row if sort.startswith("NODE") else numbers
            found = _in_ranges(known, items)
            if found.size:
                (node_sets if sort.startswith("NODE") else element_sets)[name] = found
        for name, found in element_sets.items():
            nodes = {row[node] for k in found for node in order[k].nodes if node in row}
            node_sets.setdefault(name, np.array(sorted(nodes), dtype=np.int64))
        used = sorted({element.material for element in order})
        materials = {label: k for k, label in enumerate(label for label in used if label in self.properties)}
        notes = [f"the file says /UNITS,{self.units}"] if self.units else []
        return Deck(
            self.path,
            points,
            blocks,
            node_sets,
            element_sets,
            np.array([materials.get(element.material, -1) for element in order], dtype=np.int64),
            [self._material(label) for label in materials],
            tuple(notes),
            node_labels=list(self.nodes),
            make_frame=lambda: self._frame(row, points, numbers, materials),
        )

    def _rows_of(self, element: _Element, count: int, row: dict[int, int]) -> list[int]:
        if len(element.nodes) < count:
            self.fail(
                f"element {element.label} has {len(element.nodes)} nodes", f"{count} nodes", element.line
            )
        missing = next((node for node in element.nodes[:count] if node not in row), None)
        if missing is not None:
            self.fail(
                f"element {element.label}: node {missing} does not exist",
                "nodes that the file defines",
                element.line,
            )
        return [row[node] for node in element.nodes[:count]]

    def _block(self, kind: int, members: list[_Element], row: dict[int, int]) -> ElementBlock:
        marks = np.array([one.label for one in members])
        if kind in _SOLIDS:
            name, count, shape = _SOLIDS[kind]
            table = np.array([self._rows_of(one, count, row) for one in members], dtype=np.int64)
            return ElementBlock(_NAMES[kind], name, marks, table, shape=shape)
        words = {181: "shell elements", 188: "beam elements", 21: "point masses", 184: "rigid elements"}.get(
            kind, "surface and contact elements" if kind in _HARMLESS else "elements"
        )
        nothing = np.empty((len(members), 0), dtype=np.int64)
        if kind == 181:
            nothing = np.array([self._rows_of(one, 4, row) for one in members], dtype=np.int64)
        return ElementBlock(
            _NAMES.get(kind, f"of type {kind}"),
            "",
            marks,
            nothing,
            words,
            _REMEDY,
            kind in _HARMLESS or kind in {21, 184},
            "quad" if kind == 181 else "",
        )

    def _material(self, label: int) -> DeckMaterial:
        found = self.properties[label]
        nu = found.get("PRXY", found.get("NUXY"))
        E = found.get("EX")
        odd = [
            key
            for key in ("EY", "EZ")
            if key in found and abs(found[key] - (E or 0.0)) > 1e-6 * abs(found[key])
        ]
        refused = f"orthotropic ({', '.join(odd)})" if odd else ""
        return DeckMaterial(f"MAT {label}", E, nu, found.get("DENS"), refused)

    # -- plates, beams, masses --

    def _frame(
        self,
        row: dict[int, int],
        points: NDArray[np.float64],
        numbers: dict[int, int],
        materials: dict[int, int],
    ) -> DeckFrame:
        plates: dict[tuple[int, int, int, int], list[tuple[_Element, list[int]]]] = {}
        beams: dict[tuple[int, int, int], list[_Element]] = {}
        masses: list[PointMass] = []
        links: list[RigidLink] = []
        for one in self.elements.values():
            if one.kind == 181:
                nodes = self._rows_of(one, 4, row)
                nodes = nodes[:3] if nodes[2] == nodes[3] else nodes
                plates.setdefault((one.section, one.material, one.type_id, len(nodes)), []).append(
                    (one, nodes)
                )
            elif one.kind == 188:
                beams.setdefault((one.section, one.material, one.type_id), []).append(one)
            elif one.kind == 21:
                masses.append(self._mass(one, row))
            elif one.kind == 184:
                links.append(self._link(one, row))
        made_plates = tuple(
            self._plates(key[0], materials.get(key[1], -1), key[2], members, numbers)
            for key, members in plates.items()
        )
        made_beams = tuple(
            self._beams(key[0], materials.get(key[1], -1), key[2], members, numbers, row, points)
            for key, members in beams.items()
        )
        refused: tuple[str, ...] = ()
        if self.equations:
            first = min(self.equations.values())
            refused = (
                f"{len(self.equations)} constraint equations CE (of CERIG and RBE3 too; first: line {first})",
            )
        read = Counter(_NAMES[one.kind] for one in self.elements.values() if one.kind in _NAMES)
        counted = {**read, "nodes": len(self.nodes), "sections": len(self.sections), "CP": len(self.coupled)}
        notes = [f"read: {', '.join(f'{n} {name}' for name, n in sorted(counted.items()) if n)}"]
        if self.left:
            notes.append(f"left out: {', '.join(f'{n} {name}' for name, n in sorted(self.left.items()))}")
        if self.turned:
            notes.append(
                f"axes of {self.turned} nodes are turned in the file, which matters for couplings alone"
            )
        notes += [f"{n} {words}" for words, n in self.said.items() if n]
        return DeckFrame(
            made_plates,
            made_beams,
            tuple(masses),
            tuple(links),
            ties=self._ties(row),
            refused=refused,
            notes=tuple(notes),
            also=frozenset({"MASS21", "MPC184"}),
        )

    def _of_section(self, label: int, kind: str, user: _Element) -> _Section:
        found = self.sections.get(label)
        if found is None or found.kind != kind:
            have = "does not exist" if found is None else f"is of kind {found.kind}"
            self.fail(f"element {user.label}: section {label} {have}", f"a SECTYPE,{label},{kind}", user.line)
        return found

    def _plates(
        self,
        label: int,
        material: int,
        type_id: int,
        members: list[tuple[_Element, list[int]]],
        numbers: dict[int, int],
    ) -> DeckPlates:
        section = self._of_section(label, "SHELL", members[0][0])
        if len(section.data) != 1:
            self.fail(
                f"section {label} has {len(section.data)} layers",
                "one SECDATA: a homogeneous shell",
                section.line,
            )
        t = self.number(section.data[0][0])
        if not t > 0.0:
            self.fail(f"section {label} has the thickness {t:g}", "a positive thickness", section.line)
        where = section.offset[0] if section.offset else "MID"
        if where not in {"MID", "TOP", "BOT", "USER", ""}:
            self.fail(f"SECOFFSET,{where}", "MID, TOP, BOT or USER", section.line)
        # the command says where in the section the nodes are
        user = self.number(section.offset[1]) if where == "USER" and len(section.offset) > 1 else 0.0
        offset = {"TOP": -0.5 * t, "BOT": 0.5 * t, "USER": -user}.get(where, 0.0)
        return DeckPlates(
            name=f"section {label}",
            index=np.array([numbers[one.label] for one, _ in members]),
            nodes=np.array([nodes for _, nodes in members]),
            material=material,
            thickness=np.full(len(members), t),
            offset=np.full(len(members), offset),
            bends=self.options.get((type_id, 1), 0) != 1,
            file=self.path,
            place=f"line {section.line}",
        )

    def _beams(
        self,
        label: int,
        material: int,
        type_id: int,
        members: list[_Element],
        numbers: dict[int, int],
        row: dict[int, int],
        points: NDArray[np.float64],
    ) -> DeckBeams:
        section = self._of_section(label, "BEAM", members[0])
        made, centroid = self._beam_section(label, section)
        if self.options.get((type_id, 3), 0) == 0:
            self.said[
                "BEAM188 with KEYOPT(3) = 0: linear there, exact beams here; give several elements a span"
            ] += len(members)
        nodes = np.array([self._rows_of(one, 2, row) for one in members])
        along = points[nodes[:, 1]] - points[nodes[:, 0]]
        length = np.linalg.norm(along, axis=1)
        short = np.flatnonzero(~(length > 0.0))
        if short.size:
            one = members[short[0]]
            self.fail(f"element {one.label} has no length", "two different ends", one.line)
        e1 = along / length[:, None]
        # without a third node y is parallel to the global plane x, y; of upright beams along the global y
        upright = np.hypot(e1[:, 0], e1[:, 1]) < 1e-4
        v = np.where(upright[:, None], np.cross(e1, [0.0, 1.0, 0.0]), [0.0, 0.0, 1.0])
        for k, one in enumerate(members):
            if len(one.nodes) > 2 and one.nodes[2] in row:
                v[k] = points[row[one.nodes[2]]] - points[nodes[k, 0]]
                if not np.linalg.norm(np.cross(e1[k], v[k])) > 1e-3 * np.linalg.norm(v[k]):
                    self.fail(
                        f"element {one.label}: its third node is on the beam",
                        "a node beside the beam",
                        one.line,
                    )
        e3 = np.cross(e1, v)
        e3 /= np.linalg.norm(e3, axis=1)[:, None]
        offset = centroid[0] * np.cross(e3, e1) + centroid[1] * e3
        return DeckBeams(
            name=f"section {label}",
            index=np.array([numbers[one.label] for one in members]),
            nodes=nodes,
            material=material,
            section=made,
            orientation=v,
            offset_a=offset,
            offset_b=offset.copy(),
            released=np.zeros((len(members), 12), dtype=bool),
            file=self.path,
            place=f"line {section.line}",
        )

    def _beam_section(self, label: int, section: _Section) -> tuple[BeamSection, NDArray[np.float64]]:
        """Section, and its centroid from the node, axes 2 and 3."""
        values = [self.number(word) for data in section.data for word in data]
        name = f"{section.subtype} section {label}"
        shape = section.subtype
        shear = np.zeros(2)
        centre: NDArray[np.float64] | None = np.zeros(2)  # of the centroid from the origin; None: not known
        if shape == "ASEC":
            A, iyy, iyz, izz, _, J, cgy, cgz, shy, shz = (values + [0.0] * 10)[:10]
            if not A > 0.0:
                self.fail(f"section {label} has the area {A:g}", "a positive area", section.line)
            made = BeamSection(A, iyy, izz, J, product=-iyz, name=name)
            centre = np.array([cgz, -cgy])
            shear = np.array([shz - cgz, cgy - shy])
            made = replace(made, shear_centre=(float(shear[0]), float(shear[1])))
        else:
            try:
                made = _shaped(shape, values, name)
            except KeyError:
                self.fail(
                    f"section {label} of subtype {shape!r}",
                    "RECT, CSOLID, CTUBE, I, T, L, CHAN, HREC or ASEC",
                    section.line,
                )
            except (ValueError, IndexError):
                self.fail(
                    f"section {label}: {shape} of {values}", "dimensions of such a section", section.line
                )
            if shape not in {"RECT", "CSOLID", "CTUBE"}:
                centre = None
        where = section.offset[0] if section.offset else "CENT"
        if where in {"CENT", ""}:
            return made, np.zeros(2)
        if where == "SHRC":
            return made, -np.array(made.shear_centre)
        if centre is None or where not in {"ORIGIN", "USER"}:
            self.fail(
                f"SECOFFSET,{where} of section {label}, {shape}",
                "CENT or SHRC; of RECT, CSOLID, CTUBE and ASEC also ORIGIN and USER",
                section.line,
            )
        y, z = ([self.number(word) for word in section.offset[1:3]] + [0.0, 0.0])[:2]
        node = np.array([z, -y]) if where == "USER" else np.zeros(2)
        return made, centre - node

    def _mass(self, one: _Element, row: dict[int, int]) -> PointMass:
        values = self.reals.get(one.real)
        if values is None:
            self.fail(
                f"element {one.label}: real constants {one.real} do not exist", "R or RLBLOCK", one.line
            )
        kind = self.options.get((one.type_id, 3), 0)
        values = values + [0.0] * 6
        inertia = np.zeros((3, 3))
        mass = values[0]
        if kind == 0:
            if not np.allclose(values[:3], mass, rtol=1e-6):
                self.fail(
                    f"element {one.label}: masses {values[:3]} differ by direction", "one mass", one.line
                )
            inertia = np.diag(values[3:6])
        elif kind not in {2, 4}:
            self.fail(f"element {one.label}: MASS21 with KEYOPT(3) = {kind}", "0 or 2", one.line)
        (node,) = self._rows_of(one, 1, row)
        return PointMass(node, mass, np.zeros(3), inertia, f"MASS21 {one.label}")

    def _link(self, one: _Element, row: dict[int, int]) -> RigidLink:
        if self.options.get((one.type_id, 1), 0) != 1:
            self.fail(f"element {one.label}: MPC184 that is no rigid beam", "KEYOPT(1) = 1", one.line)
        a, b = self._rows_of(one, 2, row)
        return RigidLink(a, np.array([b]), name=f"MPC184 {one.label}")

    def _ties(self, row: dict[int, int]) -> tuple[Tie, ...]:
        pairs: dict[tuple[int, int], NDArray[np.bool_]] = {}
        for label, (direction, nodes, line) in self.coupled.items():
            if direction not in _DIRECTIONS:
                self.fail(f"CP {label} of {direction!r}", f"one of {', '.join(_DIRECTIONS)}", line)
            missing = next((node for node in nodes if node not in row), None)
            if missing is not None:
                self.fail(f"CP {label}: node {missing} does not exist", "nodes that the file defines", line)
            for other in nodes[1:]:
                pair = (row[nodes[0]], row[other])
                pairs.setdefault(pair, np.zeros(6, dtype=bool))[_DIRECTIONS[direction]] = True
        if pairs and self.turned:
            self.said["coupled nodes (CP) are taken along global axes"] += len(pairs)
        return tuple(Tie(a, b, components, "CP") for (a, b), components in pairs.items())


def _in_ranges(known: dict[int, int], ranges: list[tuple[int, int]]) -> NDArray[np.int64]:
    """Rows of the numbers that are in some ranges, ascending."""
    labels, rows = (np.array(list(each), dtype=np.int64) for each in (known.keys(), known.values()))
    order = np.argsort(labels)
    first, last = np.array(ranges, dtype=np.int64).reshape(-1, 2).T
    starts = np.searchsorted(labels[order], first, side="left")
    ends = np.searchsorted(labels[order], last, side="right")
    inside = [order[a:b] for a, b in zip(starts, ends, strict=True)]
    return np.unique(rows[np.concatenate([*inside, np.empty(0, dtype=np.int64)])])


def _shaped(shape: str, values: list[float], name: str) -> BeamSection:
    """Section of a shape of Ansys about its centroid; axis 2 is z, up in its figures, axis 3 is -y."""
    if shape == "CSOLID":
        return round_section(values[0], name=name)
    if shape == "CTUBE":
        return round_section(values[1], values[0], name=name)
    closed = None
    shear: tuple[str, tuple[float, ...]] | None = None
    if shape == "RECT":
        parts = BAR_SHAPES["BAR"].rectangles(values[0], values[1])
    elif shape == "I":
        w1, w2, w3, t1, t2, t3 = values[:6]
        shear = ("I", (w3, w1, w2, t3, t1, t2))
    elif shape == "T":
        w1, w2, t1, t2 = values[:4]
        shear = ("T2", (w1, w2, t1, t2))  # its flange lies below (VM10 of the verification manual)
    elif shape == "L":
        w1, w2, t1, t2 = values[:4]
        shear = ("L", (w1, w2, t1, t2))
    elif shape == "CHAN":
        w1, w2, w3, t1, t2, t3 = values[:6]
        if abs(w1 - w2) > 1e-9 * w1 or abs(t1 - t2) > 1e-9 * t1:
            raise ValueError("flanges that differ")
        shear = ("CHAN", (w1, w3, t3, t1))
    elif shape == "HREC":
        w1, w2, t1, t2, t3, t4 = values[:6]
        box = BAR_SHAPES["BOX1"]
        assert box.closed is not None
        # t1 and t2 stand, t3 and t4 lie
        dimensions = (w1, w2, t4, t3, t1, t2)
        parts, closed = box.rectangles(*dimensions), box.closed(*dimensions)
    else:
        raise KeyError(shape)
    made = shape_section(*shear, name=name) if shear else rectangles_section(parts, closed, name=name)
    # shapes are drawn with y to the right; axis 3 is -y
    return replace(
        made,
        product=-made.product,
        shear_centre=(made.shear_centre[0], -made.shear_centre[1]),
        corners=made.corners * [1.0, -1.0],
    )
