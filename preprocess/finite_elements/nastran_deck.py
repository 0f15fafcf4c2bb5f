"""Bulk data of Nastran and OptiStruct (``.bdf``, ``.nas``, ``.dat``, ``.fem``): nodes, solids, properties, materials.

What is understood:

* *text*: small fields of 8 columns, large fields of 16 (``*``) and free fields with commas, mixed from line to line;
  continuation lines that follow their card, with or without names; comments ``$``; numbers like 1.5-3;
  ``INCLUDE 'file'`` of files below the case folder; what stands before ``BEGIN BULK`` (but
  ``PARAM, WTMASS`` and ``NSM``) and after ``ENDDATA`` is passed over;
* *mesh*: ``GRID`` in any coordinate system, with ``GRDSET``; ``CHEXA`` of 8 and 20 and ``CTETRA`` of 10 nodes;
* plates, bars, masses and rigid elements: `nastran_frame`;
* *sets*: the elements of a ``PSOLID`` are the set ``PSOLID n``; nodes of ``SPC`` and ``SPC1`` are the group
  ``SPC n``, those of ``SET1`` the group ``SET1 n``;
* *materials*: ``MAT1``, with ``PARAM, WTMASS`` on its density.

What is refused as text: replicated entries (``=``, ``=(n)``), superelements (``BEGIN SUPER``).
Left out, and reported: constraints, contacts, springs; beside solids, shells and bars without a property, which meshers
write for groups. What is refused when a body of solids is taken, with type and number: shells, bars, rods, plane
elements, solids of other numbers of nodes, anisotropic and hyperelastic materials.

Source: MSC Nastran Quick Reference Guide, *Bulk Data Entries*.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import (
    Deck,
    DeckLines,
    DeckMaterial,
    ElementBlock,
)
from heavylift.preprocess.finite_elements.nastran_frame import Card, FrameBuilder, FrameCards

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.deck_parts import DeckFrame

__all__ = ["read_nastran_deck"]


# ---- text ----


_LONG = 9  # fields behind the name, of a line in free format: eight of data and the name of the continuation
_SELECTED = "CASE.NSM"  # what case control says of nonstructural masses, as an entry


def _cards(deck: Path, root: Path) -> Iterator[Card]:
    """Entries of the bulk data, with their continuations."""
    card: Card | None = None
    for file, number, line in _bulk(deck, root):
        name, fields = _fields(line)
        if name.startswith(("=", "*(")):
            raise InputError(
                f"{name!r} replicates the entry before",
                source=file,
                key=f"line {number}",
                expected="a deck that writes every entry out",
            )
        if len(fields) > _LONG and fields[-1].startswith("+"):
            raise InputError(
                f"{name!r} has {len(fields) + 1} fields, and the last names a continuation",
                source=file,
                key=f"line {number}",
                expected="ten fields at most: the name, eight of data and that of the continuation",
            )
        if name and name[0] not in "+*":
            if card is not None:
                yield card
            # meshio writes CTETRA_ for ten nodes
            card = Card(name.rstrip("*_ ").upper(), fields, file, number)
        elif card is not None:
            card.fields += fields
    if card is not None:
        yield card


def _fields(line: str) -> tuple[str, list[str]]:
    """First field of a line, and its data: eight, or four large ones."""
    if "," in line:
        words = [word.strip() for word in line.split(",")]
        name, data = words[0], words[1:]
        count = 4 if name.endswith("*") or name.startswith("*") else 8
        # the field behind the data names the continuation
        return name, (data + [""] * count)[: max(count, len(data) if len(data) > count + 1 else 0)]
    name = line[:8].strip()
    width, count = (16, 4) if name.endswith("*") or name.startswith("*") else (8, 8)
    return name, [line[8 + width * k : 8 + width * (k + 1)].strip() for k in range(count)]


def _bulk(deck: Path, root: Path) -> Iterator[tuple[Path, int, str]]:
    """Lines of the bulk data, behind the factor on masses if the case control section gives it."""
    lines = list(DeckLines(deck, root, _without_comments, _included).of(deck))
    begin = next(
        (k + 1 for k, (*_, line) in enumerate(lines) if re.match(r"\s*BEGIN\b", line, re.IGNORECASE)), 0
    )
    for file, number, line in lines[:begin]:
        if match := re.match(r"\s*PARAM[\s,]+WTMASS[\s,=]+([^\s,]+)", line, re.IGNORECASE):
            yield file, number, f"PARAM,WTMASS,{match[1]}"
        if match := re.match(r"\s*NSM\s*=\s*(\d+)", line, re.IGNORECASE):
            yield file, number, f"{_SELECTED},{match[1]}"
    for file, number, line in lines[max(begin - 1, 0) :]:
        if re.match(r"ENDDATA\b", line, re.IGNORECASE):
            return
        if re.match(r"\s*BEGIN\b", line, re.IGNORECASE):
            if re.search(r"\bSUPER\b", line, re.IGNORECASE):
                raise InputError(
                    f"{line.strip()}: a superelement",
                    source=file,
                    key=f"line {number}",
                    expected="one section of bulk data, BEGIN BULK",
                )
            continue
        yield file, number, line


def _without_comments(raw: str) -> str:
    """A line without its comment."""
    return raw.partition("$")[0].expandtabs(8).rstrip()


def _included(line: str, _file: Path, _number: int) -> str | None:
    match = re.match(r"""\s*INCLUDE\s+['"]?([^'"]+)""", line, re.IGNORECASE)
    return match[1].strip() if match else None


# ---- elements ----


_SOLIDS = {"CHEXA": (8, 20), "CPENTA": (6, 15), "CPYRAM": (5, 13), "CPYRA": (5, 13), "CTETRA": (4, 10)}
_KIND_OF = {("CHEXA", 8): "hex8", ("CHEXA", 20): "hex20", ("CTETRA", 10): "tet10"}
# middle nodes: bottom, upright, top; in VTK upright ones come last
_HEX20 = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]
_WORDS = {
    "CHEXA": "bricks",
    "CPENTA": "wedges",
    "CPYRAM": "pyramids",
    "CPYRA": "pyramids",
    "CTETRA": "tetrahedra",
}
_REMEDY = "solids: bricks of 8 or 20 nodes (CHEXA) or 10-node tetrahedra (CTETRA); write the mesh with these"
_TET_REMEDY = "10-node tetrahedra (CTETRA): 4-node ones lock; write the mesh with quadratic elements"
_OTHERS = (
    (r"C(QUAD[48R]?|TRIA[36R]?|SHEAR|QUADX?\d?)$", "shell elements", False),
    (r"C(BAR|BEAM3?|BEND|TUBE)$", "beam elements", False),
    (r"(CROD|CONROD)$", "truss elements", False),
    (r"C(TRIAX\d?|TRAX\d|QUADX\d|TRIAR?X)$", "plane or axisymmetric elements", False),
    (r"(CONM[12]|CMASS\d)$", "point masses", True),
    (r"C(ELAS\d|DAMP\d|BUSH\w*|GAP|VISC|FAST|WELD|SEAM)$", "springs, dashpots, gaps or couplings", True),
)
_CONSTRAINTS = re.compile(
    r"(SPC|SPC1|SPCD|SPCADD|MPC|MPCADD|RBE1|RBE2|RBE3|RBAR|RROD|RSPLINE|RJOINT|BCONTACT|BCTSET|SUPORT)$"
)
_PROPERTIES = re.compile(r"P(SHELL|COMPG?|SHEAR|PLANE|BARL?|BEAML?|BCOMP|BEND|ROD|TUBE)$")
# nodes behind number and property
_NODES = {
    "CTRIA3": 3,
    "CTRIAR": 3,
    "CTRIA6": 6,
    "CQUAD4": 4,
    "CQUADR": 4,
    "CQUAD8": 8,
    "CBAR": 2,
    "CBEAM": 2,
    "CROD": 2,
    "CONROD": 2,
}
_FLAT = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8"}
_CELLS = {
    ("CHEXA", 8): "hexahedron",
    ("CHEXA", 20): "hexahedron20",
    ("CTETRA", 4): "tetra",
    ("CTETRA", 10): "tetra10",
}
_ANISOTROPIC = {
    "MAT2": "of plates",
    "MAT3": "orthotropic",
    "MAT8": "orthotropic",
    "MAT9": "anisotropic",
    "MAT10": "a fluid",
    "MAT11": "orthotropic",
    "MATHE": "hyperelastic",
    "MATHP": "hyperelastic",
}
_NONLINEAR = {
    "MATS1": "nonlinear",
    "MATT1": "temperature dependent",
    "MATVE": "viscoelastic",
    "MATEP": "plastic",
}


# entries that are read besides those of `FrameCards`
_READ = {"GRID", "GRDSET", "PSOLID", "PLSOLID", "MAT1", "PARAM", "SPC", "SPC1", "SET1"}


def read_nastran_deck(path: Path, root: Path | None = None) -> Deck:
    """Read bulk data of Nastran; see the module for what is understood.

    Parameters
    ----------
    path
        The first file.
    root
        Folder that included files do not leave; by default that of the deck.

    Raises
    ------
    InputError
        A file that is no deck; a number, name or node that is wrong, with file and line; nodes in coordinate systems;
        replicated entries, superelements; a node, element, material or WTMASS that is given twice and differently;
        a file outside `root`.
    """
    reader = _Reader()
    for card in _cards(path, root or path.parent):
        if card.name == _SELECTED:
            selected = card.whole(0, "a set of nonstructural masses")
            if reader.frame.selected not in {0, selected}:
                card.fail(f"NSM = {reader.frame.selected} and {selected}", "one set of nonstructural masses")
            reader.frame.selected = selected
            continue
        reader.take(card)
    if not reader.nodes and not reader.solids and not reader.others:
        raise InputError("contains no GRID", source=path, expected="bulk data of Nastran")
    return reader.deck(path)


class _Reader:
    """Takes one entry after the other."""

    def __init__(self) -> None:
        self.nodes: dict[int, tuple[list[float], Card]] = {}
        self.default_systems = [0, 0]
        self.grid_set: Card | None = None
        self.solids: dict[int, tuple[str, int, list[int]]] = {}
        self.others: dict[tuple[str, int], list[tuple[int, int, list[int]]]] = {}
        self.other_properties: set[int] = set()
        self.properties: dict[int, int] = {}
        self.materials: dict[int, DeckMaterial] = {}
        self.material_notes: dict[int, list[str]] = {}
        self.refused: dict[int, str] = {}
        self.groups: dict[str, list[tuple[int, int]]] = {}
        self.constraints: Counter[str] = Counter()
        self.masses: Counter[str] = Counter()
        self.weight = 1.0
        self.weight_said = False
        self.frame = FrameCards()
        self.shear_ratio: dict[int, float] = {}
        self.parameters: dict[str, str] = {}
        self.verbs: dict[str, Callable[[Card], None]] = {
            "GRID": self._grid,
            "GRDSET": self._grid_defaults,
            "PSOLID": self._property,
            "PLSOLID": self._property,
            "MAT1": self._material,
            "PARAM": self._parameter,
            "SPC": self._spc,
            "SPC1": self._spc1,
            "SET1": self._set1,
        }

    def take(self, card: Card) -> None:
        """One entry."""
        self.frame.take(card)
        if _CONSTRAINTS.match(card.name):
            self.constraints[card.name] += 1
        if re.match(r"NSM(L?1?|ADD)$", card.name):
            self.masses[card.name] += 1
        if card.name in self.verbs:
            self.verbs[card.name](card)
        elif card.name in _SOLIDS:
            self._solid(card)
        elif card.name in _ANISOTROPIC:
            self.refused[card.whole(0, "number of the material")] = f"{_ANISOTROPIC[card.name]} ({card.name})"
        elif card.name in _NONLINEAR:
            note = f"its {card.name} is left out: {_NONLINEAR[card.name]}"
            self.material_notes.setdefault(card.whole(0, "number of the material"), []).append(note)
        elif any(re.match(pattern, card.name) for pattern, *_ in _OTHERS):
            self._other(card)
        elif _PROPERTIES.match(card.name):
            self.other_properties.add(card.whole(0, "number of the property"))

    def _grid_defaults(self, card: Card) -> None:
        self.grid_set = card
        self.default_systems = [card.whole(1, "coordinate system", 0), card.whole(5, "coordinate system", 0)]

    def _grid(self, card: Card) -> None:
        label = card.whole(0, "number of the node")
        x = [card.real(k, "a coordinate") or 0.0 for k in (2, 3, 4)]
        if label in self.nodes:
            before, known = self.nodes[label]
            systems = [
                [one.whole(k, "a coordinate system", self.default_systems[k > 1]) for k in (1, 5)]
                for one in (known, card)
            ]
            if before != x or systems[0] != systems[1]:
                card.fail(f"node {label} is defined twice", "every node once")
        self.nodes[label] = (x, card)

    def _solid(self, card: Card) -> None:
        label = card.whole(0, "number of the element")
        # blank fields are middle nodes that an element does not have
        words = card.fields[2:]
        while words and not words[-1]:
            words = words[:-1]
        corners, most = _SOLIDS[card.name]
        nodes = [card.whole(2 + k, "a node") for k, word in enumerate(words[:most]) if word]
        if len(nodes) < corners:
            card.fail(f"element {label} has {len(nodes)} nodes", f"{corners} or {most} nodes")
        known = self.solids.get(label)
        property_id = card.whole(1, "a property", label)
        if known is not None and known != (card.name, property_id, nodes):
            card.fail(f"element {label} is defined twice", "every element once")
        self.solids[label] = (card.name, property_id, nodes)

    def _other(self, card: Card) -> None:
        """An element that is no solid, with its nodes if its name tells their number."""
        label, count = card.whole(0, "number of the element"), _NODES.get(card.name, 0)
        if self.frame.elements.get(label, card) is not card:
            return  # the same once more
        rod = card.name == "CONROD"  # has its property itself
        nodes = [card.whole(1 + k if rod else 2 + k, "a node") for k in range(count)]
        property_id = card.whole(1, "a property", label) if count and not rod else label if rod else 0
        if rod:
            self.other_properties.add(label)
        self.others.setdefault((card.name, count), []).append((label, property_id, nodes))

    def _property(self, card: Card) -> None:
        label, material = card.whole(0, "number of the property"), card.whole(1, "number of the material", 0)
        before = self.properties.setdefault(label, material)
        if before != material:
            card.fail(
                f"property {label} is defined twice, of material {before} and {material}",
                "every property once",
            )

    def _material(self, card: Card) -> None:
        label = card.whole(0, "number of the material")
        E, G, nu, rho = (card.real(k, "a constant of the material") for k in (1, 2, 3, 4))
        if E is None and G is not None and nu is not None:
            E = 2.0 * G * (1.0 + nu)
        elif nu is None and E is not None and G is not None:
            nu = E / (2.0 * G) - 1.0
        if G is not None and E and nu is not None:
            ratio = G * 2.0 * (1.0 + nu) / E
            if abs(ratio - 1.0) > 0.01:
                self.material_notes.setdefault(label, []).append(
                    f"G = {G:g} is {ratio:.4g} times E / (2 (1 + nu)): plates and solids take E and nu, beams take G"
                )
                self.shear_ratio[label] = ratio
        made = DeckMaterial(f"MAT1 {label}", E, nu, rho)
        if self.materials.setdefault(label, made) != made:
            card.fail(f"material {label} is defined twice", "every material once")

    def _parameter(self, card: Card) -> None:
        if card.word(0).upper() == "WTMASS":
            weight = card.real(1, "a factor on masses") or 1.0
            if self.weight_said and weight != self.weight:
                card.fail(f"WTMASS is {self.weight:g} and {weight:g}", "one factor on masses")
            self.weight, self.weight_said = weight, True
        else:
            self.parameters[card.word(0).upper()] = card.word(1)

    def _spc(self, card: Card) -> None:
        name = f"SPC {card.word(0)}"
        for k in (1, 4):
            if card.word(k):
                label = card.whole(k, "a node")
                self.groups.setdefault(name, []).append((label, label))

    def _spc1(self, card: Card) -> None:
        self._ranges(card, f"SPC {card.word(0)}", 2)

    def _set1(self, card: Card) -> None:
        self._ranges(card, f"SET1 {card.word(0)}", 1)

    def _ranges(self, card: Card, name: str, first: int) -> None:
        """Numbers from a field on, with ``a THRU b``."""
        found = self.groups.setdefault(name, [])
        places = [k for k in range(first, len(card.fields)) if card.fields[k]]
        through = False
        for k in places:
            if card.fields[k].upper() == "THRU":
                through = True
                continue
            label = card.whole(k, "a node, or THRU")
            if through and found:
                found[-1] = (found[-1][0], label)
            else:
                found.append((label, label))
            through = False

    # -- everything together --

    def deck(self, path: Path) -> Deck:
        """One numbering of nodes and elements."""
        row = {label: k for k, label in enumerate(self.nodes)}
        points = self._points()
        blocks, sets, index = self._blocks(path, row)
        node_sets = {}
        for name, ranges in self.groups.items():
            members = [row[label] for label in row if any(a <= label <= b for a, b in ranges)]
            if members:
                node_sets[name] = np.array(sorted(members), dtype=np.int64)
        nodes_of = [nodes for block in blocks for nodes in block.nodes]
        for name, elements in sets.items():
            node_sets[name] = np.unique(np.concatenate([nodes_of[k] for k in elements])).astype(np.int64)
        of_beams = {
            card.whole(3 if card.name == "CONROD" else 1, "number of the material", 0)
            for card in self.frame.properties.values()
        }
        of_beams |= {
            card.whole(3, "a material", 0) for card in self.frame.elements.values() if card.name == "CONROD"
        }
        of_plates = {
            card.whole(k, "number of a material", 0)
            for card in self.frame.properties.values()
            if card.name == "PSHELL"
            for k in (1, 3, 5)
        }
        materials, number = self._materials(set(index) | of_beams | of_plates)
        notes = []
        notes += [self._constraints(set())] if self.constraints else []
        extra = [f"left out: {n} nonstructural masses {key}" for key, n in self.masses.items()]
        notes += extra
        if self.weight != 1.0:
            notes.append(f"densities are multiplied by WTMASS = {self.weight:g}")
        material_index = np.array([number.get(key, -1) for key in index], dtype=np.int64)
        numbers = [int(label) for block in blocks for label in block.labels]

        def frame() -> DeckFrame:
            builder = FrameBuilder(
                self.frame,
                row,
                points,
                self._displacement_system,
                number,
                self.shear_ratio,
                self.weight,
                {label: k for k, label in enumerate(numbers)},
            )
            made = builder.frame()
            notes = [*self._words(), self._constraints(set(self.frame.read)), *made.notes]
            return replace(
                made, notes=tuple(note for note in notes if note), instead=(self._constraints(set()), *extra)
            )

        return Deck(
            path,
            points,
            blocks,
            node_sets,
            {name: members for name, members in sets.items() if members.size},
            material_index,
            materials,
            tuple(notes),
            node_labels=list(self.nodes),
            make_frame=None if self.frame.empty else frame,
        )

    def _constraints(self, read: set[str]) -> str:
        """What of constraints is left out, besides some that are read; ``""`` if nothing is."""
        words = ", ".join(f"{n} {key}" for key, n in self.constraints.items() if key not in read)
        return words and f"constraints and contacts of the file are left out, the case has its own: {words}"

    def _words(self) -> list[str]:
        """What of the file is read, what is not, by entry and count, for a structure."""
        counts = self.frame.counts
        read = {name: n for name, n in counts.items() if name in self.frame.read or name in _READ}
        read |= {name: n for name, n in counts.items() if name in _SOLIDS}
        left = {name: n for name, n in counts.items() if name not in read and name != "ENDDATA"}
        words = [f"read: {', '.join(f'{n} {name}' for name, n in sorted(read.items()))}"]
        if left:
            words.append(f"left out: {', '.join(f'{n} {name}' for name, n in sorted(left.items()))}")
        for key, what in (("K6ROT", "drilling stiffness"), ("COUPMASS", "the kind of mass")):
            if key in self.parameters:
                words.append(f"PARAM,{key},{self.parameters[key]} is left out: {what} is chosen here")
        if self.masses and not self.frame.selected:
            words.append("case control selects no NSM: entries of nonstructural mass do not count")
        return words

    def _points(self) -> NDArray[np.float64]:
        """Positions of all nodes, basic axes, shape (n, 3)."""
        systems = self.frame.systems
        found: dict[int, NDArray[np.float64]] = {}

        def place(label: int, user: Card) -> NDArray[np.float64]:
            if label not in self.nodes:
                user.fail(f"node {label} does not exist", "nodes that the deck defines")
            x, card = self.nodes[label]
            system = card.whole(1, "a coordinate system", self.default_systems[0])
            system = max(system, 0)  # -1 takes back a default
            if system:
                systems.resolve(system, card, place)
                return systems.point(system, np.array(x))
            return np.array(x)

        for label in self.nodes:
            x, card = self.nodes[label]
            plain = not card.word(1) and not self.default_systems[0]
            found[label] = np.array(x) if plain else place(label, card)
        for label in self.nodes:
            system = self._displacement_system(label)
            if system:
                systems.resolve(system, self.nodes[label][1], place)
        return np.array(list(found.values()), dtype=np.float64).reshape(-1, 3)

    def _displacement_system(self, label: int) -> int:
        """CD of a node; 0 of one that does not exist, which is said where it is looked for."""
        if label not in self.nodes:
            return 0
        card = self.nodes[label][1]
        if not card.word(5):
            return max(self.default_systems[1], 0)
        return max(card.whole(5, "a coordinate system"), 0)

    def _blocks(
        self, path: Path, row: dict[int, int]
    ) -> tuple[list[ElementBlock], dict[str, NDArray[np.int64]], list[int]]:
        """Elements by type, the sets of properties, and the material of every element."""
        by_type: dict[tuple[str, int], list[int]] = {}
        for label, (name, _, nodes) in self.solids.items():
            by_type.setdefault((name, len(nodes)), []).append(label)
        blocks: list[ElementBlock] = []
        index: list[int] = []
        sets: dict[str, list[int]] = {}
        for (name, count), labels in by_type.items():
            kind = _KIND_OF.get((name, count), "")
            cells = []
            for label in labels:
                _, property_id, nodes = self.solids[label]
                sets.setdefault(f"PSOLID {property_id}", []).append(len(index))
                index.append(self.properties.get(property_id, 0))
                if kind or count == 4:
                    cells.append(self._rows(path, row, nodes, f"element {label} ({name})"))
            marks = np.array(labels)
            if kind == "hex20":
                cells = [[cell[k] for k in _HEX20] for cell in cells]
            table = np.array(cells, dtype=np.int64).reshape(len(labels), -1)
            remedy = _TET_REMEDY if (name, count) == ("CTETRA", 4) else _REMEDY
            words = f"{count}-node {_WORDS[name]}"
            shape = _CELLS.get((name, count), "")
            blocks.append(ElementBlock(name, kind, marks, table, words, remedy, shape=shape))
        for (name, count), members in self.others.items():
            words, harmless = next((w, h) for pattern, w, h in _OTHERS if re.match(pattern, name))
            family = "PBAR" if words.startswith("beam") else "PROD" if words.startswith("truss") else "PSHELL"
            if count and not any(property_id in self.other_properties for _, property_id, _ in members):
                words, harmless = f"{words} without property", True  # meshers write groups so
            cells = []
            for label, property_id, nodes in members:
                if count:
                    sets.setdefault(f"{family} {property_id}", []).append(len(index))
                index.append(0)
                cells.append(self._rows(path, row, nodes, f"element {label} ({name})"))
            marks = np.array([label for label, *_ in members])
            table = np.array(cells, dtype=np.int64).reshape(len(members), -1)
            shape = _FLAT.get(count, "") if words.startswith("shell") else ""
            blocks.append(ElementBlock(name, "", marks, table, words, _REMEDY, harmless, shape))
        return blocks, {name: np.array(members, dtype=np.int64) for name, members in sets.items()}, index

    @staticmethod
    def _rows(path: Path, row: dict[int, int], nodes: list[int], key: str) -> list[int]:
        """Rows of the nodes of an element."""
        missing = next((node for node in nodes if node not in row), None)
        if missing is not None:
            raise InputError(
                f"node {missing} does not exist", source=path, key=key, expected="nodes that the deck defines"
            )
        return [row[node] for node in nodes]

    def _materials(self, used: set[int]) -> tuple[list[DeckMaterial], dict[int, int]]:
        """Materials of properties, and their place by number."""
        found: list[DeckMaterial] = []
        number: dict[int, int] = {}
        for label in sorted(used & (self.materials.keys() | self.refused.keys())):
            one = self.materials.get(label, DeckMaterial(f"material {label}"))
            density = None if one.density is None else self.weight * one.density
            notes = tuple(f"{one.name}: {note}" for note in self.material_notes.get(label, []))
            number[label] = len(found)
            found.append(
                DeckMaterial(
                    one.name,
                    one.young_modulus,
                    one.poisson_ratio,
                    density,
                    self.refused.get(label, ""),
                    notes,
                )
            )
        return found, number
