"""Universal files (``.unv``) of I-deas, Salome, NX or gmsh: nodes, elements and groups.

What is read: data sets 2411 (nodes, global axes), 2412 (elements) and 2435, 2452, 2467, 2477 (groups of nodes and
elements); of 164 the units are told. The files carry neither thicknesses nor sections: a case gives them by group, and
elements of a table of properties ``n`` are the set ``property n`` too.

Source: SDRC, *Universal File Format*, published by the University of Cincinnati, https://www.ceas3.uc.edu/sdrluff.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import Deck, ElementBlock, deck_number, deck_text
from heavylift.preprocess.finite_elements.deck_parts import loose_frame

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["read_universal_deck"]

# descriptor: cell as meshio calls it, and the places of its nodes; middle nodes stand between the corners in the file
_TET10 = [0, 2, 4, 9, 1, 3, 5, 6, 7, 8]
_HEX20 = [0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11]
_CELLS: dict[int, tuple[str, list[int]]] = {
    **dict.fromkeys((11, 21, 22), ("line", [0, 1])),
    **dict.fromkeys((41, 51, 61, 74, 81, 91), ("triangle", [0, 1, 2])),
    **dict.fromkeys((44, 54, 64, 71, 84, 94), ("quad", [0, 1, 2, 3])),
    111: ("tetra", [0, 1, 2, 3]),
    112: ("wedge", [0, 1, 2, 3, 4, 5]),
    115: ("hexahedron", list(range(8))),
    116: ("hexahedron20", _HEX20),
    118: ("tetra10", _TET10),
}
_BEAMS = {11, 21, 22, 23, 24}  # have a line of their own
_SOLID_KINDS = {"hexahedron": "hex8", "hexahedron20": "hex20", "tetra10": "tet10"}
_LOOSE = {"line", "triangle", "quad"}  # plates and beams if a case gives what they are, else groups
_UNITS = {
    1: "m, N",
    2: "ft, lbf",
    3: "m, kgf",
    4: "ft, pdl",
    5: "mm, mN",
    6: "cm, cN",
    7: "in, lbf",
    8: "mm, kgf",
}


def read_universal_deck(path: Path) -> Deck:
    """Read a universal file; see the module for what is understood.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    InputError
        A file without nodes; a number that is wrong, with file and line.
    """
    return _Reader(path).deck()


class _Reader:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.lines = deck_text(path)
        self.nodes: dict[int, list[float]] = {}
        self.elements: dict[int, tuple[int, int, list[int], int]] = {}
        self.groups: dict[str, tuple[list[int], list[int]]] = {}
        self.notes: list[str] = []
        self.turned = 0
        at = 0
        while at < len(self.lines):
            if self.lines[at].strip() != "-1" or at + 1 >= len(self.lines):
                at += 1
                continue
            end = next(
                (k for k in range(at + 2, len(self.lines)) if self.lines[k].strip() == "-1"), len(self.lines)
            )
            verb = {
                "2411": self._nodes,
                "2412": self._elements,
                "2435": self._groups,
                "2452": self._groups,
                "2467": self._groups,
                "2477": self._groups,
                "164": self._units,
            }.get(self.lines[at + 1].strip())
            if verb is not None:
                verb(at + 2, end)
            at = end + 1

    def fail(self, problem: str, expected: str, line: int) -> NoReturn:
        raise InputError(problem, source=self.path, key=f"line {line + 1}", expected=expected)

    def wholes(self, line: int, least: int) -> list[int]:
        words = self.lines[line].split() if line < len(self.lines) else []
        if len(words) < least or not all(re.fullmatch(r"[+-]?\d{1,18}", word) for word in words):
            self.fail(f"{' '.join(words)!r}", f"{least} or more whole numbers", line)
        return [int(word) for word in words]

    def _nodes(self, at: int, end: int) -> None:
        while at < end:
            label, system, *_ = self.wholes(at, 2)
            words = self.lines[at + 1].split()
            try:
                x = [deck_number(word) for word in words[:3]]
            except ValueError:
                x = []
            if len(x) < 3:
                self.fail(f"{' '.join(words)!r}", "three coordinates", at + 1)
            if label in self.nodes:
                self.fail(f"node {label} is defined twice", "every node once", at)
            self.nodes[label] = x
            self.turned += system > 1
            at += 2

    def _elements(self, at: int, end: int) -> None:
        while at < end:
            label, kind, property_id, _, _, count = self.wholes(at, 6)[:6]
            first = at
            at += 2 if kind in _BEAMS else 1
            nodes: list[int] = []
            while len(nodes) < count and at < end:
                nodes += self.wholes(at, 1)
                at += 1
            if len(nodes) != count:
                self.fail(f"element {label} has {len(nodes)} nodes", f"{count} nodes", first)
            if label in self.elements:
                self.fail(f"element {label} is defined twice", "every element once", first)
            self.elements[label] = (kind, property_id, nodes, first)

    def _groups(self, at: int, end: int) -> None:
        while at < end:
            number, *_, count = self.wholes(at, 8)[:8]
            name = self.lines[at + 1].strip() if at + 1 < end else ""
            at += 2
            nodes, elements = self.groups.setdefault(name or f"group {number}", ([], []))
            found = 0
            while found < count and at < end:
                words = self.wholes(at, 2)
                at += 1
                width = 4 if len(words) % 4 == 0 else 2  # entity and tag, with or without two more numbers
                for k in range(0, len(words) - 1, width):
                    found += 1
                    if words[k] == 7:
                        nodes.append(words[k + 1])
                    elif words[k] == 8:
                        elements.append(words[k + 1])

    def _units(self, at: int, _end: int) -> None:
        match = re.match(r"\s*(\d{1,9})", self.lines[at]) if at < len(self.lines) else None
        code = int(match[1]) if match else 0
        if code in _UNITS:
            self.notes.append(f"the file says its units: {_UNITS[code]}")

    def deck(self) -> Deck:
        """One numbering of nodes and elements."""
        if not self.nodes:
            raise InputError(
                "contains no nodes (data set 2411)", source=self.path, expected="a universal file"
            )
        if self.turned:
            self.notes.append(f"{self.turned} nodes name a coordinate system: taken as global")
        row = {label: k for k, label in enumerate(self.nodes)}
        by_kind: dict[str, list[int]] = {}
        for label, (kind, *_) in self.elements.items():
            shape = _CELLS[kind][0] if kind in _CELLS else f"descriptor {kind}"
            by_kind.setdefault(shape, []).append(label)
        blocks = []
        cells: list[tuple[str, NDArray[np.int64]]] = []
        order: list[int] = []
        for shape, labels in by_kind.items():
            order += labels
            tables = [self._rows(label, row) for label in labels]
            known = not shape.startswith("descriptor")
            nodes = np.array(tables, dtype=np.int64) if known else np.empty((len(labels), 0), dtype=np.int64)
            cells.append((shape, nodes))
            blocks.append(
                ElementBlock(
                    shape if known else shape.removeprefix("descriptor "),
                    _SOLID_KINDS.get(shape, ""),
                    np.array(labels),
                    nodes,
                    ""
                    if shape in {"line", "triangle", "quad"}
                    else "cells of type"
                    if known
                    else "elements of descriptor",
                    "plates of 3 and 4 nodes, bricks of 8 and 20 nodes or 10-node tetrahedra",
                    shape in _LOOSE,
                    shape if known else "",
                )
            )
        number = {label: k for k, label in enumerate(order)}
        node_sets, element_sets = self._sets(row, number, cells)
        return Deck(
            self.path,
            np.array(list(self.nodes.values()), dtype=np.float64),
            blocks,
            node_sets,
            element_sets,
            np.full(len(order), -1, dtype=np.int64),
            (),
            tuple(self.notes),
            node_labels=list(self.nodes),
            make_frame=lambda: loose_frame(cells),
        )

    def _rows(self, label: int, row: dict[int, int]) -> list[int]:
        kind, _, nodes, line = self.elements[label]
        if kind not in _CELLS:
            return []
        shape, places = _CELLS[kind]
        if len(nodes) != len(places):
            self.fail(f"element {label} has {len(nodes)} nodes", f"{len(places)} nodes of {shape}", line)
        missing = next((node for node in nodes if node not in row), None)
        if missing is not None:
            self.fail(f"element {label}: node {missing} does not exist", "nodes that the file defines", line)
        return [row[nodes[k]] for k in places]

    def _sets(
        self, row: dict[int, int], number: dict[int, int], cells: list[tuple[str, NDArray[np.int64]]]
    ) -> tuple[dict[str, NDArray[np.int64]], dict[str, NDArray[np.int64]]]:
        elements: dict[str, list[int]] = {}
        for label, (_, property_id, _, _) in self.elements.items():
            elements.setdefault(f"property {property_id}", []).append(number[label])
        nodes: dict[str, list[int]] = {}
        for name, (of_nodes, of_elements) in self.groups.items():
            elements.setdefault(name, []).extend(number[label] for label in of_elements if label in number)
            nodes.setdefault(name, []).extend(row[label] for label in of_nodes if label in row)
        all_nodes = [cell for _, table in cells for cell in table]
        element_sets = {
            name: np.unique(np.array(members, dtype=np.int64))
            for name, members in elements.items()
            if members
        }
        for name, members in element_sets.items():
            found = np.concatenate([all_nodes[k] for k in members]).tolist()
            nodes[name] = nodes.get(name, []) + found
        node_sets = {
            name: np.unique(np.array(found, dtype=np.int64)) for name, found in nodes.items() if found
        }
        return node_sets, element_sets
