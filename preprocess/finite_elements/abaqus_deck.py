"""Input decks of Abaqus and CalculiX (``.inp``): nodes, solid elements, sets, parts and linear materials.

What is understood:

* *text*: keywords in any case and with or without inner blanks; comments ``**``; blank lines; a keyword line goes
  on after a comma at its end; lines of elements, constants and sets continue as long as numbers are missing; commas at
  the end of a line; numbers like 1.5D-3; quoted names; ``*INCLUDE``, and ``INPUT=`` of nodes, elements, sets and the
  like (`INPUT_IS_DATA`), of files below the case folder;
* *mesh*: ``*NODE`` (``NSET``, ``SYSTEM=R|C|S``) and ``*SYSTEM``; ``*ELEMENT`` (``TYPE``, ``ELSET``), of which C3D8,
  C3D20 and C3D10 with all letters behind (R, I, H, M, T ...) become bricks and tetrahedra; numbers behind the nodes
  of an element are passed over;
* *sets*: ``*NSET``, ``*ELSET`` with ``GENERATE``, sets of sets, ``*NSET, ELSET=``; ``*SURFACE`` of faces or nodes;
* *parts*: ``*PART``, ``*ASSEMBLY``, ``*INSTANCE`` with translation and rotation; a set ``S`` of an instance ``I`` is
  called ``I.S``, and ``S`` too if no other instance has one; an instance is a set of elements;
* *materials*: ``*MATERIAL`` with ``*ELASTIC`` (isotropic; of a table over temperature the first row) and
  ``*DENSITY``; ``*SOLID SECTION``. Plastic, viscous and thermal properties are left out, and reported.

Plates, beams, masses and rigid elements are read by `abaqus_frame`.

Left out, and reported: constraints, contacts and loads; springs, dashpots and gaps; beside solids, shells, beams and
plane elements without a section, which meshers write for groups; sections of no set. What is refused when a body of
solids is taken, with type and number: shells, beams, trusses, membranes, plane and axisymmetric elements, solids with
4, 5, 6, 15 or 27 nodes, orthotropic and hyperelastic materials.

Sources: Abaqus Analysis User's Guide, *Input syntax rules*; G. Dhondt, *CalculiX CrunchiX User's Manual*, version 2.21.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import field, replace
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.abaqus_frame import (
    FRAME_KEYWORDS,
    Card,
    FrameMaker,
    general_key,
    general_material,
)
from heavylift.preprocess.finite_elements.deck import (
    Deck,
    DeckLines,
    DeckMaterial,
    ElementBlock,
    deck_number,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.deck_parts import DeckFrame

__all__ = ["INPUT_IS_DATA", "read_abaqus_deck"]

INPUT_IS_DATA = frozenset(
    {"NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "SYSTEM", "BOUNDARY", "ELASTIC", "DENSITY"}
)
"""Keywords whose ``INPUT=`` names a file with their data lines; that of others is read by other programs alone."""


# ---- text ----


_FIELD = re.compile(r'(?:[^,"]|"[^"]*")+')
# a line that continues with a keyword: parameters, and no data as it is
_PARAMETERS = re.compile(r"[A-Za-z][A-Za-z ]*=|(GENERATE|INTERNAL|UNSORTED)\s*(,|$)", re.IGNORECASE)


def _cards(deck: Path, root: Path) -> Iterator[Card]:
    """Keywords of a file and of what it includes, in order."""
    card: Card | None = None
    goes_on = False
    lines = DeckLines(deck, root, _without_comments, _included)
    for file, number, line in lines.of(deck):
        if line.startswith("*"):
            if card is not None:
                yield card
            card = _header(line, file, number)
            goes_on = line.endswith(",")
            if "INPUT" in card.parameters and card.keyword in INPUT_IS_DATA:
                target = lines.named(card.parameters["INPUT"], file, number)
                card.data = [
                    (target, at, _fields(text))
                    for _, at, text in lines.of(target, deck)
                    if text[0] != "*" and _fields(text)
                ]
        elif card is not None and goes_on and _PARAMETERS.match(line):
            card.parameters |= _header(f"*,{line}", file, number).parameters
            goes_on = line.endswith(",")
        elif card is not None:
            goes_on = False
            words = _fields(line)
            if words:
                card.data.append((file, number, words))
    if card is not None:
        yield card


def _without_comments(raw: str) -> str:
    line = raw.strip()
    return "" if line.startswith("**") else line


def _included(line: str, file: Path, number: int) -> str | None:
    """File that ``*INCLUDE`` names."""
    if line[0] == "*" and re.match(r"\*\s*include\b", line, re.IGNORECASE):
        return _header(line, file, number).parameters.get("INPUT", "")
    return None


def _header(text: str, file: Path, line: int) -> Card:
    shown, *parameters = [part.strip() for part in _FIELD.findall(" " + text.lstrip("*"))]
    found = {}
    for parameter in parameters:
        key, _, value = parameter.partition("=")
        found["".join(key.split()).upper()] = value.strip().strip('"').strip()
    return Card("".join(shown.split()).upper(), " ".join(shown.split()).upper(), found, file, line)


def _fields(line: str) -> list[str]:
    """Words between commas; without the empty ones at the end."""
    words = [word.strip() for word in line.split(",")]
    while words and not words[-1]:
        words.pop()
    return words


# ---- elements ----


_SOLID = re.compile(r"^C3D(\d+)[A-Z]*$")
_KIND_OF = {8: "hex8", 10: "tet10", 20: "hex20"}
_CELLS = {8: "hexahedron", 10: "tetra10", 20: "hexahedron20"}
_FLAT = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8", 9: "quad9"}
_SOLID_WORDS = {
    4: "4-node tetrahedra",
    5: "5-node pyramids",
    6: "6-node wedges",
    15: "15-node wedges",
    27: "27-node bricks",
}
_TET_REMEDY = "10-node tetrahedra (C3D10): 4-node ones lock; write the mesh with quadratic elements"
_BRICK_REMEDY = "solids: bricks (C3D8, C3D20) or 10-node tetrahedra (C3D10); write the mesh with these"
# what else stands in decks, by the beginning of its type; the first that fits
_OTHERS = (
    (r"(MASS|ROTARYI)", "point masses", True),
    (
        r"(SPRING|DASHPOT|GAP|CONN|JOINTC|DCOUP|ITT|ITS|SFM|ISL|IRS|PSI)",
        "springs, dashpots, gaps or couplings",
        True,
    ),
    (r"(DC3D|DC2D|DCAX|DCC|DS\d)", "heat transfer elements", False),
    (r"(F3D|FC3D|FD|D$|AC)", "fluid elements", False),
    (r"(CPS|CPE|CAX|CGAX|CPEG)", "plane or axisymmetric elements", False),
    (r"(COH)", "cohesive elements", False),
    (r"(SC\d|S\d|STRI|SAX|US\d)", "shell elements", False),
    (r"(M3D|MAX|MCL)", "membrane elements", False),
    (r"(B\d|PIPE|ELBOW|FRAME)", "beam elements", False),
    (r"(T2D|T3D)", "truss elements", False),
    (r"(R3D|R2D|RAX|RB)", "rigid elements", True),
    (r"(SFM3D|SFMAX)", "surface elements", True),
    (r"(CSS|CCL|CIN|EC3D|EMC|Q3D|U|Z)", "special elements", False),
)
# nodes of the faces S1 ... S6 of the element types, as positions
_FACES = {
    "hex8": ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    "hex20": (
        (0, 1, 2, 3, 8, 9, 10, 11),
        (4, 5, 6, 7, 12, 13, 14, 15),
        (0, 1, 5, 4, 8, 17, 12, 16),
        (1, 2, 6, 5, 9, 18, 13, 17),
        (2, 3, 7, 6, 10, 19, 14, 18),
        (3, 0, 4, 7, 11, 16, 15, 19),
    ),
    "tet10": ((0, 1, 2, 4, 5, 6), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 2, 3, 6, 9, 7)),
}


def _node_count(name: str) -> int | None:
    """Nodes of a solid element; None for others."""
    match = _SOLID.match(name)
    return int(match[1]) if match else None


def _numbers_of(name: str) -> int | None:
    """Nodes of any element as far as its type tells them; else a line is an element."""
    solid = _node_count(name)
    if solid is not None:
        return solid
    if name.startswith("STRI65"):
        return 6
    if match := re.match(r"(?:B|PIPE)[23]([123])", name):
        return 3 if match[1] == "2" else 2
    match = re.match(
        r"(?:S|STRI|SC|M3D|MAX|MCL|CPS|CPE|CAX|T[23]D|DC[23]D|DCAX|F3D|R3D|COH[23]D|DS|AC[23]D)(\d+)", name
    )
    return int(match[1]) if match else None


def _block(name: str, labels: list[object], nodes: NDArray[np.int64]) -> ElementBlock:
    """Elements of one type, and what they are."""
    marks = np.array(labels, dtype=object)
    count = _node_count(name)
    if count in _KIND_OF:
        return ElementBlock(name, _KIND_OF[count], marks, nodes, shape=_CELLS[count])
    if count is not None:
        remedy = _TET_REMEDY if count == 4 else _BRICK_REMEDY
        shape = "tetra" if count == 4 else ""
        return ElementBlock(
            name, "", marks, nodes, _SOLID_WORDS.get(count, "solid elements"), remedy, shape=shape
        )
    for pattern, words, harmless in _OTHERS:
        if re.match(pattern, name):
            flat = words.startswith(("shell", "membrane", "plane", "rigid", "surface"))
            shape = _FLAT.get(nodes.shape[1], "") if flat else ""
            return ElementBlock(name, "", marks, nodes, words, _BRICK_REMEDY, harmless, shape)
    return ElementBlock(name, "", marks, nodes, "elements", _BRICK_REMEDY)


# ---- what a part says ----


@dataclass
class _Set:
    """Members of a set as they are written: (first, last, step), or the name of another set."""

    name: str
    items: list[tuple[int, int, int] | str] = field(default_factory=list)
    of_elements: list[str] = field(default_factory=list)  # node sets: those of the nodes of element sets
    instance: str = ""


@dataclass
class Scope:
    """A part, or a deck without parts."""

    name: str = ""
    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, tuple[int, ...]]] = field(default_factory=dict)
    node_sets: dict[str, list[_Set]] = field(default_factory=dict)
    element_sets: dict[str, list[_Set]] = field(default_factory=dict)
    surfaces: dict[str, tuple[str, list[list[str]]]] = field(default_factory=dict)
    sections: list[tuple[str, str]] = field(default_factory=list)  # set of elements, material of solids
    frame_cards: list[Card] = field(default_factory=list)  # of plates, beams, masses and rigid elements
    third_nodes: dict[int, int] = field(default_factory=dict)  # of beams, for their direction n1
    point_nodes: dict[int, str] = field(default_factory=dict)  # of masses: a node, or one of an instance


Named = tuple[Scope, int | None, str]
"""A set as another one names it: its scope, the instance there, its name."""

SetKey = tuple[int, int | None, str, bool]
"""By which it is known."""


@dataclass
class _Instance:
    """A part where it stands."""

    name: str
    part: Scope
    rotation: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    offset: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))


def _add(sets: dict[str, list[_Set]], name: str, instance: str = "") -> _Set:
    """Set of that name to put members into; one for each instance."""
    pieces = sets.setdefault(name.upper(), [])
    for piece in pieces:
        if piece.instance == instance:
            return piece
    pieces.append(_Set(name, instance=instance))
    return pieces[-1]


def _joined(first: dict[str, list[_Set]], second: dict[str, list[_Set]]) -> dict[str, list[_Set]]:
    """Sets of both, in lists of their own."""
    return {name: [*first.get(name, []), *second.get(name, [])] for name in [*first, *second]}


# ---- materials ----


_NONLINEAR = {
    "PLASTIC": "plasticity",
    "CREEP": "creep",
    "VISCOELASTIC": "viscoelasticity",
    "VISCO": "viscosity",
    "MOHRCOULOMB": "Mohr-Coulomb plasticity",
    "DRUCKERPRAGER": "Drucker-Prager plasticity",
    "CAPPLASTICITY": "cap plasticity",
    "CYCLICHARDENING": "cyclic hardening",
    "RATEDEPENDENT": "rate dependence",
    "CONCRETEDAMAGEDPLASTICITY": "concrete damage",
    "DAMAGEINITIATION": "damage",
    "DAMPING": "damping",
}
_NOT_LINEAR = {
    "HYPERELASTIC": "hyperelastic",
    "HYPERFOAM": "a hyperfoam",
    "DEFORMATIONPLASTICITY": "of deformation plasticity",
    "USERMATERIAL": "a user material",
    "UMAT": "a user material",
    "NOCOMPRESSION": "without compression",
    "NOTENSION": "without tension",
    "POROUSELASTIC": "porous elastic",
    "HYPOELASTIC": "hypoelastic",
    "FLUIDCONSTANTS": "a fluid",
    "EOS": "a fluid",
}
_ANISOTROPIC = {
    "ORTHO": "orthotropic",
    "ORTHOTROPIC": "orthotropic",
    "ENGINEERINGCONSTANTS": "orthotropic",
    "LAMINA": "orthotropic",
    "ANISO": "anisotropic",
    "ANISOTROPIC": "anisotropic",
    "TRACTION": "a traction law",
    "COUPLEDTRACTION": "a traction law",
    "SHEAR": "of a shear modulus only",
}


@dataclass
class _Material:
    name: str
    elastic: list[float] | None = None
    density: float | None = None
    refused: str = ""
    notes: list[str] = field(default_factory=list)


# ---- the reader ----


_CONSTRAINTS = {
    "BOUNDARY",
    "CONTACT",
    "CONTACTPAIR",
    "COUPLING",
    "CYCLICSYMMETRYMODEL",
    "DISTRIBUTING",
    "DISTRIBUTINGCOUPLING",
    "EMBEDDEDELEMENT",
    "EQUATION",
    "KINEMATIC",
    "KINEMATICCOUPLING",
    "MPC",
    "PRETENSIONSECTION",
    "RIGIDBODY",
    "SHELLTOSOLIDCOUPLING",
    "SUBMODEL",
    "TIE",
}
# what says nothing of a body
_SILENT = {
    "HEADING",
    "PREPRINT",
    "STEP",
    "ENDSTEP",
    "RESTART",
    "OUTPUT",
    "NODEOUTPUT",
    "ELEMENTOUTPUT",
    "NODEFILE",
    "ELFILE",
}
# generators and other ways to say a mesh, which are not read
_GENERATORS = {
    "NGEN": "nodes",
    "NFILL": "nodes",
    "NCOPY": "nodes",
    "NMAP": "nodes",
    "ELGEN": "elements",
    "ELCOPY": "elements",
    "TFILL": "elements",
    "SUBSTRUCTURE": "elements",
    "PARAMETER": "parameters",
    "IMPORT": "instances of another analysis",
    "SYMMETRICMODELGENERATION": "nodes and elements",
    "IMPERFECTION": "shifts of nodes",
}


def read_abaqus_deck(path: Path, root: Path | None = None) -> Deck:
    """Read a deck of Abaqus or CalculiX; see the module for what is understood.

    Parameters
    ----------
    path
        The first file.
    root
        Folder that included files do not leave; by default that of the deck.

    Raises
    ------
    InputError
        A file that is no deck; a number, name or node that is wrong, with file and line; a file outside `root`; nodes
        or elements that are generated (``*NGEN``, ``*ELGEN`` ...); a node, element or material that is defined twice
        and differently.
    """
    reader = _Reader()
    count = 0
    for card in _cards(path, root or path.parent):
        count += 1
        reader.take(card)
    if not count:
        raise InputError(
            "contains no keyword", source=path, expected="a deck of Abaqus or CalculiX: lines with *NODE ..."
        )
    return reader.deck(path)


class _Reader:
    """Takes one keyword after the other."""

    def __init__(self) -> None:
        self.flat = Scope()
        self.parts: dict[str, Scope] = {}
        self.assembly = Scope()
        self.instances: dict[str, _Instance] = {}
        self.instance: _Instance | None = None
        self.on_instance: list[Card] = []  # sections and surfaces within the present one
        self.scope = self.flat
        self.materials: dict[str, _Material] = {}
        self.material: _Material | None = None
        # the latter, the earlier material of its name, and this one
        self.redefined: list[tuple[Card, _Material, _Material]] = []
        self.left_out: list[str] = []
        self.constraints: Counter[str] = Counter()
        self.held: list[tuple[str, int, int]] = []
        self.sectors = ""
        self.extra: Counter[str] = Counter()
        self.unread: Counter[str] = Counter()
        self.unknown_sets: dict[str, None] = {}
        self.system: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
        self.in_steps = False
        self.verbs: dict[str, Callable[[Card], None]] = {
            "NODE": self._node,
            "ELEMENT": self._element,
            "NSET": self._node_set,
            "ELSET": self._element_set,
            "SURFACE": self._surface,
            "PART": self._part,
            "ENDPART": self._end_part,
            "ASSEMBLY": self._begin_assembly,
            "ENDASSEMBLY": self._end_part,
            "INSTANCE": self._instance,
            "ENDINSTANCE": self._end_instance,
            "SYSTEM": self._system,
            "SOLIDSECTION": self._section,
            "MATERIAL": self._begin_material,
            "ELASTIC": self._elastic,
            "DENSITY": self._density,
        }

    def take(self, card: Card) -> None:
        """One keyword."""
        key = card.keyword
        if key in _CONSTRAINTS:
            self.constraints[card.shown] += 1
            if key == "CYCLICSYMMETRYMODEL":
                self.sectors = card.parameters.get("N", "")
        if key == "BOUNDARY":
            self._hold(card)
        if key == "RESTART" and "READ" in card.parameters:
            card.fail(
                "the mesh stands in the restart file of another run",
                "a deck that lists its nodes and elements",
            )
        if key == "STEP":
            self.in_steps = True
        of_material = self.material is not None and key in {*_NONLINEAR, *_NOT_LINEAR}
        known = key in self.verbs or key in FRAME_KEYWORDS or of_material
        if (self.in_steps or not known) and key not in _CONSTRAINTS | _SILENT:
            self.unread[card.shown] += 1
        if self.in_steps:
            return
        if key in _GENERATORS:
            card.fail(
                f"{_GENERATORS[key]} are generated by the program that the deck is for",
                "a deck that lists its nodes and elements",
            )
        if key in FRAME_KEYWORDS:
            self.scope.frame_cards.append(card)
        if key in self.verbs:
            self.verbs[key](card)
        elif key in {"MATRIXINPUT", "MATRIXASSEMBLE"}:
            self.left_out.append(f"left out: *{card.shown} of line {card.line}")
        elif key == "NONSTRUCTURALMASS":
            whose = card.parameters.get("ELSET", "")
            self.left_out.append(f"left out: *{card.shown} of line {card.line}, set {whose!r}")
        elif key.endswith("SECTION") and "ELSET" in card.parameters:  # of shells, beams, ...
            self.scope.sections.append((card.parameters["ELSET"], ""))
        elif self.material is not None and key in _NONLINEAR:
            self.material.notes.append(f"{_NONLINEAR[key]} is left out")
        elif self.material is not None and key in _NOT_LINEAR:
            self.material.refused = self.material.refused or f"{_NOT_LINEAR[key]} (*{card.shown})"

    # -- mesh --

    def _node(self, card: Card) -> None:
        system = card.parameters.get("SYSTEM", "R").upper()
        if system not in {"R", "C", "S"}:
            card.fail(f"SYSTEM={system}", "R (Cartesian), C (cylindrical) or S (spherical)")
        members = (
            None if "NSET" not in card.parameters else _add(self.scope.node_sets, card.parameters["NSET"])
        )
        for file, line, words in card.data:
            label = _whole(card, words[:1], (file, line), "a node number")[0]
            x = _reals(card, words[1:4], (file, line))
            x += [0.0] * (3 - len(x))
            position = self._placed(x, system)
            if self.scope.nodes.setdefault(label, position) != position:
                card.fail(f"node {label} is defined twice", "every node once", (file, line))
            if members is not None:
                members.items.append((label, label, 1))

    def _placed(self, x: list[float], system: str) -> tuple[float, float, float]:
        if system == "C":
            x = [x[0] * np.cos(np.radians(x[1])), x[0] * np.sin(np.radians(x[1])), x[2]]
        elif system == "S":
            theta, phi = np.radians(x[1:])
            x = [x[0] * np.cos(theta) * np.cos(phi), x[0] * np.sin(theta) * np.cos(phi), x[0] * np.sin(phi)]
        if self.system is not None:
            origin, axes = self.system
            x = (origin + np.array(x) @ axes).tolist()
        return (float(x[0]), float(x[1]), float(x[2]))

    def _system(self, card: Card) -> None:
        """Local axes of the nodes that follow: origin, a point of the x axis, a point near the y axis."""
        values = [value for file, line, words in card.data for value in _reals(card, words, (file, line))]
        if not values:
            self.system = None
            return
        values += [0.0] * (3 - len(values) % 3 if len(values) % 3 else 0)
        points = np.array(values).reshape(-1, 3)
        if len(points) == 1:
            self.system = (points[0], np.eye(3))
            return
        x = points[1] - points[0]
        y = (points[2] - points[0]) if len(points) > 2 else np.array([-x[1], x[0], 0.0])
        z = np.cross(x, y)
        if not np.linalg.norm(z) > 0.0:
            card.fail("the three points are on a line", "points that span a plane")
        axes = np.array([x, np.cross(z, x), z])
        self.system = (points[0], axes / np.linalg.norm(axes, axis=1)[:, None])

    def _element(self, card: Card) -> None:
        name = card.parameters.get("TYPE", "").upper()
        if not name:
            card.fail("no TYPE", "TYPE=C3D8 or TYPE=C3D10")
        width = _numbers_of(name)
        members = (
            None
            if "ELSET" not in card.parameters
            else _add(self.scope.element_sets, card.parameters["ELSET"])
        )
        pending: list[str] = []
        at = (card.file, card.line)
        for file, line, words in card.data:
            at = at if pending else (file, line)
            pending += [word for word in words if word]
            if width is not None and len(pending) < width + 1:
                continue
            if width is not None and len(pending) > width + 1 and _SOLID.match(name):
                self.extra[name] += 1
            if width is not None and len(pending) > width + 1 and name.startswith("B3"):
                label, third = _whole(
                    card, [pending[0], pending[width + 1]], at, "whole numbers: element and nodes"
                )
                self.scope.third_nodes[label] = third
            self._one_element(card, name, pending[: None if width is None else width + 1], at, members)
            pending = []
        if pending:
            card.fail(
                f"element {pending[0]} has {len(pending) - 1} nodes",
                f"{width} nodes of {name}",
                at,
            )

    def _one_element(
        self, card: Card, name: str, words: list[str], at: tuple[Path, int], members: _Set | None
    ) -> None:
        # couplings and the like may name other items than nodes: their number is enough
        named = _numbers_of(name) is not None
        label, *nodes = _whole(
            card, words if named else words[:1], at, f"whole numbers: element and nodes of {name}"
        )
        if name in {"MASS", "ROTARYI"} and len(words) > 1:
            self.scope.point_nodes[label] = words[1].strip('"')
        known = self.scope.elements.get(label)
        if known is not None and known != (name, tuple(nodes)):
            card.fail(f"element {label} is defined twice", "every element once", at)
        self.scope.elements[label] = (name, tuple(nodes))
        if members is not None:
            members.items.append((label, label, 1))

    # -- sets --

    def _node_set(self, card: Card) -> None:
        name = card.parameters.get("NSET", "")
        if not name:
            card.fail("no name", "NSET=...")
        found = _add(self.scope.node_sets, name, card.parameters.get("INSTANCE", "").upper())
        if "ELSET" in card.parameters:
            found.of_elements.append(card.parameters["ELSET"])
        self._members(card, found)

    def _element_set(self, card: Card) -> None:
        name = card.parameters.get("ELSET", "")
        if not name:
            card.fail("no name", "ELSET=...")
        self._members(card, _add(self.scope.element_sets, name, card.parameters.get("INSTANCE", "").upper()))

    def _members(self, card: Card, found: _Set) -> None:
        for file, line, words in card.data:
            if "GENERATE" in card.parameters and words and _is_whole(words[0]):
                numbers = _whole(card, words[:3], (file, line), "whole numbers: first, last and step")
                first, last = numbers[0], numbers[min(1, len(numbers) - 1)]
                step = numbers[2] if len(numbers) > 2 else 1
                if step == 0:
                    card.fail("a step of 0", "a step of 1 or more", (file, line))
                found.items.append((first, last, step))
                continue
            for word in filter(None, words):
                if _is_whole(word):
                    found.items.append((int(word), int(word), 1))
                else:
                    found.items.append(word.strip('"').strip())

    def _surface(self, card: Card) -> None:
        name = card.parameters.get("NAME", "")
        kind = card.parameters.get("TYPE", "ELEMENT").upper()
        if self.instance is not None:
            self.on_instance.append(card)
        if name and kind in {"ELEMENT", "NODE"}:
            rows = self.scope.surfaces.setdefault(name, (kind, []))[1]
            rows += [[word.strip('"').strip() for word in words] for _, _, words in card.data if words]

    def _hold(self, card: Card) -> None:
        """Directions that the file holds; kinds of supports by name as far as they hold displacements."""
        named = {"ENCASTRE": (1, 3), "PINNED": (1, 3), "XSYMM": (1, 1), "YSYMM": (2, 2), "ZSYMM": (3, 3)}
        for _, _, words in card.data:
            if len(words) < 2:
                continue
            first, last = named.get(words[1].upper(), (0, -1))
            if _is_whole(words[1]):
                first = int(words[1])
                last = int(words[2]) if len(words) > 2 and _is_whole(words[2]) else first
            if first <= min(last, 3):
                self.held.append((words[0].strip('"'), max(first, 1), min(last, 3)))

    # -- parts --

    def _part(self, card: Card) -> None:
        name = card.parameters.get("NAME", "")
        if name.upper() in self.parts:
            card.fail(f"part {name!r} is defined twice", "every part once")
        self.scope = self.parts[name.upper()] = Scope(name)

    def _end_part(self, _card: Card) -> None:
        self.scope = self.flat
        self.system = None

    def _begin_assembly(self, _card: Card) -> None:
        self.scope = self.assembly

    def _instance(self, card: Card) -> None:
        name, part = card.parameters.get("NAME", ""), card.parameters.get("PART", "")
        if part.upper() not in self.parts:
            known = ", ".join(repr(one.name) for one in self.parts.values())
            problem = f"part {part!r} does not exist" if part else "no PART"
            card.fail(problem, f"one of {known}" if known else "a *PART before")
        if name.upper() in self.instances:
            card.fail(f"instance {name!r} is defined twice", "every instance once")
        whole = self.parts[part.upper()]
        made = _Instance(name, whole)
        rows = [_reals(card, words, (file, line)) for file, line, words in card.data]
        if rows:
            made.offset = np.array((rows[0] + [0.0] * 3)[:3])
        if len(rows) > 1:
            values = rows[1] + [0.0] * (7 - len(rows[1]))
            a, b = np.array(values[:3]), np.array(values[3:6])
            if not np.linalg.norm(b - a) > 0.0:
                card.fail("the axis of the rotation has no length", "two different points and an angle")
            # translated first, then turned about the axis through a
            made.rotation = _turn(b - a, np.radians(values[6]))
            made.offset = a + made.rotation @ (made.offset - a)
        self.instances[name.upper()] = made
        self.instance, self.scope = made, Scope(name)
        self.on_instance = []

    def _end_instance(self, _card: Card) -> None:
        made, own = self.instance, self.scope
        if made is not None and (own.nodes or own.elements):  # an independent instance has the mesh itself
            made.part = own
        elif made is not None:
            for card in self.on_instance:
                card.fail(
                    f"in instance {made.name!r}, which has no mesh of its own",
                    f"it in *PART {made.part.name!r}, for all its instances, or a mesh in the instance",
                )
            # sets of an instance are its own, and the part serves others too
            made.part = replace(
                made.part,
                node_sets=_joined(made.part.node_sets, own.node_sets),
                element_sets=_joined(made.part.element_sets, own.element_sets),
                frame_cards=[*made.part.frame_cards, *own.frame_cards],
            )
        self.instance, self.scope = None, self.assembly

    # -- materials --

    def _section(self, card: Card) -> None:
        elements, material = card.parameters.get("ELSET", ""), card.parameters.get("MATERIAL", "")
        if self.instance is not None:
            self.on_instance.append(card)
        if elements:
            self.scope.sections.append((elements, material))
        else:
            note = f"left out: *{card.shown} of line {card.line}, material {material!r}: it has no ELSET"
            self.left_out.append(note)

    def _begin_material(self, card: Card) -> None:
        name = card.parameters.get("NAME", "")
        earlier = self.materials.get(name.upper())
        self.material = self.materials[name.upper()] = _Material(name)
        if earlier is not None:
            self.redefined.append((card, earlier, self.material))

    def _elastic(self, card: Card) -> None:
        if self.material is None:
            return
        kind = "".join(card.parameters.get("TYPE", "ISO").split()).upper()
        if kind not in {"ISO", "ISOTROPIC"}:
            words = _ANISOTROPIC.get(kind, "not isotropic")
            self.material.refused = f"{words} (*{card.shown}, TYPE={card.parameters['TYPE']})"
            return
        rows = [_reals(card, words, (file, line)) for file, line, words in card.data if words]
        if not rows or len(rows[0]) < 2:
            card.fail(
                f"{len(rows[0]) if rows else 0} constants",
                "Young's modulus and Poisson's ratio",
                _first_place(card),
            )
        self.material.elastic = rows[0]
        self._say_row(rows, 2, "elasticity")

    def _density(self, card: Card) -> None:
        if self.material is None:
            return
        rows = [_reals(card, words, (file, line)) for file, line, words in card.data if words]
        if not rows:
            card.fail("no value", "a density", _first_place(card))
        self.material.density = rows[0][0]
        self._say_row(rows, 1, "density")

    def _say_row(self, rows: list[list[float]], width: int, what: str) -> None:
        assert self.material is not None
        if len(rows) > 1:
            at = f", of temperature {rows[0][width]:g}" if len(rows[0]) > width else ""
            self.material.notes.append(f"{what} is the first row of {len(rows)}{at}")

    # -- everything together --

    def deck(self, path: Path) -> Deck:
        """Put parts into place and resolve sets."""
        for card, earlier, latter in self.redefined:
            if not _deck_material(earlier).agrees(_deck_material(latter)):
                card.fail(f"material {latter.name!r} is defined twice", "every material once")
        placed = list(self.instances.values())
        if self.flat.nodes or self.flat.elements or not placed:
            placed.insert(0, _Instance("", self.flat))
        if self.parts and not self.instances:  # parts of which nobody says where they stand
            placed += [_Instance(part.name, part) for part in self.parts.values()]
        own = self.assembly
        if not any(one.part is self.flat for one in placed):  # behind the assembly
            own.frame_cards += self.flat.frame_cards
        if (
            own.frame_cards
            or own.nodes
            or own.elements
            or own.element_sets
            or own.node_sets
            or own.surfaces
            or own.sections
        ):
            placed.append(_Instance("", self.assembly))
        return Assembler(self, placed).deck(path)

    def constraints_note(self, which: Callable[[str], bool]) -> str:
        """What of constraints and contacts is left out; ``""`` if nothing is."""
        words = ", ".join(f"{n} *{key}" for key, n in self.constraints.items() if which(key))
        return words and f"constraints and contacts of the file are left out, the case has its own: {words}"


MOST_PLACED = 50_000_000
"""Nodes and elements of all instances of a deck."""


class Assembler:
    """From parts in place to one numbering of nodes and elements."""

    def __init__(self, reader: _Reader, placed: list[_Instance]) -> None:
        self.reader = reader
        self.placed = placed
        self.points: list[NDArray[np.float64]] = []
        self.node_row: list[dict[int, int]] = []
        self.element_row: list[dict[int, int]] = []
        self.blocks: list[ElementBlock] = []
        self.node_of: list[NDArray[np.int64]] = []
        self.kind_of: list[str] = []
        self.flat: list[bool] = []
        self.owners: dict[int, tuple[int, int]] = {}
        self.material_names: dict[str, int] = {}
        self.frame_materials: list[DeckMaterial] = []
        self.known_sets: dict[SetKey, NDArray[np.int64]] = {}
        self.listed_sets: dict[SetKey, tuple[NDArray[np.int64], list[Named]]] = {}

    def deck(self, path: Path) -> Deck:
        self._number_nodes(path)
        self._number_elements(path)
        self.node_of = [row for block in self.blocks for row in block.nodes]
        self.kind_of = [block.kind for block in self.blocks for _ in block.labels]
        self.flat = [block.shape in {"triangle", "quad"} for block in self.blocks for _ in block.labels]
        element_sets, node_sets = self._sets()
        index, materials = self._materials()
        self._without_section()
        held = self._held()
        reader = self.reader
        notes = []
        notes += [reader.constraints_note(lambda _: True)] if reader.constraints else []
        if reader.sectors:
            notes.append(f"cyclic symmetry is left out: the body is one sector of {reader.sectors}")
        notes += reader.left_out
        notes += [
            f"numbers behind the nodes of {n} elements {name} are left out"
            for name, n in reader.extra.items()
        ]
        if reader.unknown_sets:
            notes.append(f"sets that do not exist are left out: {', '.join(reader.unknown_sets)}")
        notes += [
            f"types with {name} are integrated as the case says, not as in the program of the file"
            for name in sorted(
                {block.name for block in self.blocks if block.kind and block.name[-1].isalpha()}
            )
        ]
        points = np.vstack(self.points) if self.points else np.empty((0, 3))
        labels = [
            f"{one.name}.{label}" if one.name else label for one in self.placed for label in one.part.nodes
        ]
        return Deck(
            path,
            points,
            self.blocks,
            node_sets,
            element_sets,
            index,
            materials,
            tuple(notes),
            node_labels=labels,
            held=held,
            make_frame=self._frame_maker(),
        )

    # -- for plates, beams, masses and rigid elements --

    def _frame_maker(self) -> Callable[[], DeckFrame] | None:
        """Make the frame, when somebody asks; None if there is nothing for one."""
        some = any(one.part.frame_cards for one in self.placed)
        some |= any(block.words.startswith(("shell", "beam")) for block in self.blocks)
        some |= any(
            block.harmless and block.nodes.size for block in self.blocks
        )  # of meshers, without section
        return (lambda: FrameMaker(self, self.material_names).frame()) if some else None

    def elements_of(self, scope: Scope, place: int | None, name: str) -> NDArray[np.int64]:
        """Elements of a set by its name as a part says it."""
        return self._elements(scope, place, name)

    def named_nodes(self, scope: Scope, place: int | None, word: str) -> NDArray[np.int64]:
        """Rows of a node, of a node of an instance or of a set."""
        word = word.strip('"').strip()
        if _is_whole(word):
            return self._surface_members(scope, place, word, nodes=True)
        elsewhere = self._elsewhere(word, place)
        if elsewhere is not None and _is_whole(elsewhere[2]):
            return self._surface_members(elsewhere[0], elsewhere[1], elsewhere[2], nodes=True)
        if elsewhere is None and word.upper() not in scope.node_sets:
            return np.empty(0, dtype=np.int64)
        whose, inside, name = elsewhere or (scope, place, word)
        return self._nodes(whose, inside, name)

    def surface_nodes(
        self, scope: Scope, place: int | None, name: str
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Rows of a surface, and the area that belongs to each of them (1 of surfaces of nodes)."""
        whose, inside, tail = self._elsewhere(name, place) or (scope, place, name)
        surface = next((one for have, one in whose.surfaces.items() if have.upper() == tail.upper()), None)
        if surface is None:
            return np.empty(0, dtype=np.int64), np.empty(0)
        faces = self._faces(whose, inside, surface)
        if surface[0] == "NODE":
            rows = _unique(faces)
            return rows, np.ones(rows.size)
        points = np.vstack(self.points)
        area = np.zeros(len(points))
        for face in faces:
            corners = points[face[:4] if len(face) in {4, 8} else face[:3]]
            a = corners[2] - corners[0]
            b = corners[3] - corners[1] if len(corners) == 4 else corners[1] - corners[0]
            area[face] += 0.5 * np.linalg.norm(np.cross(a, b)) / len(face)
        rows = _unique(faces)
        return rows, area[rows]

    def numbered_blocks(self) -> list[tuple[int, ElementBlock]]:
        """First number of each block, and the block."""
        starts = np.cumsum([0, *(len(block.labels) for block in self.blocks)])
        return list(zip(starts.tolist(), self.blocks, strict=False))

    def element_label(self, index: int) -> str:
        """Number of an element in the file."""
        start, block = next(pair for pair in reversed(self.numbered_blocks()) if pair[0] <= index)
        return str(block.labels[index - start])

    def node_label(self, row: int) -> str:
        """Number of a node in the file."""
        for one, known in zip(self.placed, self.node_row, strict=True):
            for label, at in known.items():
                if at == row:
                    return f"{one.name}.{label}" if one.name else str(label)
        return str(row)

    def _owner(self, index: int) -> tuple[int, int]:
        """Place and number in its part of an element."""
        if not self.owners:
            self.owners = {
                row: (place, label)
                for place, known in enumerate(self.element_row)
                for label, row in known.items()
            }
        return self.owners[index]

    def third_node(self, index: int) -> int | None:
        """Row of the third node of a beam, for its direction."""
        place, label = self._owner(index)
        third = self.placed[place].part.third_nodes.get(label)
        return None if third is None else self.node_row[place].get(third)

    def point_element(self, index: int, card: Card) -> NDArray[np.int64]:
        """Row of the node of a mass element."""
        place, label = self._owner(index)
        part = self.placed[place].part
        word = part.point_nodes.get(label, "")
        found = self.named_nodes(part, place, word)
        if not found.size:
            card.fail(f"element {label}: node {word!r} does not exist", "nodes that the deck defines")
        return found

    def _held(self) -> NDArray[np.int64]:
        """Degrees of freedom that the file holds."""
        found = [np.empty(0, dtype=np.int64)]
        scopes: list[tuple[Scope, int | None]] = [
            (one.part, place) for place, one in enumerate(self.placed) if not one.name
        ]
        for word, first, last in self.reader.held:
            for scope, place in scopes or [(self.reader.assembly, None)]:
                elsewhere = None if _is_whole(word) else self._elsewhere(word, place)
                if elsewhere is not None and _is_whole(elsewhere[2]):
                    row = self.node_row[elsewhere[1] or 0].get(int(elsewhere[2]))
                    rows = np.array([] if row is None else [row], dtype=np.int64)
                elif _is_whole(word):
                    rows = self._surface_members(scope, place, word, nodes=True)
                elif elsewhere is not None or word.upper() in scope.node_sets:
                    whose, inside, name = elsewhere or (scope, place, word)
                    rows = self._nodes(whose, inside, name)
                else:
                    continue
                found += [3 * rows + axis - 1 for axis in range(first, last + 1)]
        return np.unique(np.concatenate(found))

    def _number_nodes(self, path: Path) -> None:
        count = sum(len(one.part.nodes) + len(one.part.elements) for one in self.placed)
        if count > MOST_PLACED:
            raise InputError(
                f"{len(self.placed):,} instances have {count:,} nodes and elements",
                source=path,
                expected=f"at most {MOST_PLACED:,}",
            )
        start = 0
        for one in self.placed:
            positions = np.array(list(one.part.nodes.values()), dtype=np.float64).reshape(-1, 3)
            self.points.append(positions @ one.rotation.T + one.offset)
            self.node_row.append({label: start + k for k, label in enumerate(one.part.nodes)})
            start += len(positions)

    def _number_elements(self, path: Path) -> None:
        by_type: dict[str, list[tuple[int, int]]] = {}
        for place, one in enumerate(self.placed):
            for label, (name, _) in one.part.elements.items():
                by_type.setdefault(name, []).append((place, label))
        self.element_row = [{} for _ in self.placed]
        row = 0
        for name, members in by_type.items():
            rows = []
            labels: list[object] = []
            for place, label in members:
                one = self.placed[place]
                self.element_row[place][label] = row
                row += 1
                labels.append(f"{one.name}.{label}" if one.name else label)
                if _numbers_of(name) is not None:
                    known = self.node_row[place]
                    try:
                        rows.append([known[node] for node in one.part.elements[label][1]])
                    except KeyError as error:
                        raise InputError(
                            f"node {error.args[0]} does not exist",
                            source=path,
                            key=f"element {labels[-1]} ({name})",
                            expected="nodes that the deck defines",
                        ) from None
            self.blocks.append(_block(name, labels, np.array(rows, dtype=np.int64).reshape(len(labels), -1)))

    # -- sets --

    def _sets(self) -> tuple[dict[str, NDArray[np.int64]], dict[str, NDArray[np.int64]]]:
        """Element sets and node sets by the names that a case may use."""
        elements: dict[str, NDArray[np.int64]] = {}
        nodes: dict[str, NDArray[np.int64]] = {}
        faces: dict[str, NDArray[np.int64]] = {}
        for place, one in enumerate(self.placed):
            prefix = f"{one.name}." if one.name else ""
            for name in one.part.element_sets:
                shown = one.part.element_sets[name][0].name
                elements[prefix + shown] = self._elements(one.part, place, name)
            for name in one.part.node_sets:
                nodes[prefix + one.part.node_sets[name][0].name] = self._nodes(one.part, place, name)
            for name, surface in one.part.surfaces.items():
                faces[prefix + name] = self._surface(one.part, place, surface)
            if one.name and self.element_row[place]:
                elements[one.name] = np.array(sorted(self.element_row[place].values()), dtype=np.int64)
        _short_names(elements)
        _short_names(nodes)
        _short_names(faces)
        for name, members in faces.items():
            nodes.setdefault(name, members)
        for name, members in elements.items():
            if members.size and name.upper() not in {have.upper() for have in nodes}:
                nodes[name] = _unique([self.node_of[index] for index in members])
        return elements, {name: members for name, members in nodes.items() if members.size}

    def _place(self, instance: str) -> int | None:
        for place, one in enumerate(self.placed):
            if one.name and one.name.upper() == instance.upper():
                return place
        return None

    def _elsewhere(self, word: str, place: int | None) -> tuple[Scope, int | None, str] | None:
        """Scope of a name ``instance.name``, as sets of an assembly use it."""
        instance, dot, name = word.rpartition(".")
        found = self._place(instance) if dot else None
        return None if found is None or found == place else (self.placed[found].part, found, name)

    def _elements(self, scope: Scope, place: int | None, name: str) -> NDArray[np.int64]:
        return self._resolve(scope, place, name, nodes=False)

    def _nodes(self, scope: Scope, place: int | None, name: str) -> NDArray[np.int64]:
        return self._resolve(scope, place, name, nodes=True)

    def _resolve(self, scope: Scope, place: int | None, name: str, *, nodes: bool) -> NDArray[np.int64]:
        """Members of a set as rows; what does not exist is passed over, as ranges may have holes.

        A set has the members of all that it names, however often and in whatever circle. Sets that others name come
        first, so that each set meets members that are known: a chain of sets takes as long as it has sets.
        """
        wanted: Named = (scope, place, name)
        waiting, entered = [wanted], set()
        while waiting:
            one = waiting[-1]
            key = _key(one, nodes)
            if key not in self.known_sets and key not in entered:
                entered.add(key)
                waiting += [
                    other for other in self._listed(one, nodes)[1] if _key(other, nodes) not in entered
                ]
                continue
            waiting.pop()
            if key not in self.known_sets:
                self.known_sets[key] = self._closure(one, nodes)
        return self.known_sets[_key(wanted, nodes)]

    def _closure(self, wanted: Named, nodes: bool) -> NDArray[np.int64]:
        """Members of a set and of all that it names, as far as no set on the way has its members known."""
        found: list[NDArray[np.int64]] = []
        waiting, seen = [wanted], {_key(wanted, nodes)}
        while waiting:
            one = waiting.pop()
            known = self.known_sets.get(_key(one, nodes))
            if known is not None:
                found.append(known)
                continue
            rows, named = self._listed(one, nodes)
            found.append(rows)
            for other in named:
                if _key(other, nodes) not in seen:
                    seen.add(_key(other, nodes))
                    waiting.append(other)
        return _unique(found)

    def _listed(self, wanted: Named, nodes: bool) -> tuple[NDArray[np.int64], list[Named]]:
        """Rows that a set lists itself, and the sets that it names, each once."""
        key = _key(wanted, nodes)
        if key not in self.listed_sets:
            scope, place, name = wanted
            pieces = (scope.node_sets if nodes else scope.element_sets).get(name.upper())
            rows: list[NDArray[np.int64]] = []
            named: dict[SetKey, Named] = {}
            if pieces is None:
                other = self._elsewhere(name, place)
                if other is None:
                    self.reader.unknown_sets[name] = None
                else:
                    named[_key(other, nodes)] = other
            for piece in pieces or ():
                of_piece, names = self._members(scope, place, piece, nodes=nodes)
                rows.append(of_piece)
                named |= {_key(one, nodes): one for one in names}
            self.listed_sets[key] = _unique(rows), list(named.values())
        return self.listed_sets[key]

    def _members(
        self, scope: Scope, place: int | None, piece: _Set, *, nodes: bool
    ) -> tuple[NDArray[np.int64], list[tuple[Scope, int | None, str]]]:
        """Rows that a piece of a set lists itself, and the sets that it names."""
        inside = self._place(piece.instance) if piece.instance else place
        whose = self.placed[inside].part if piece.instance and inside is not None else scope
        numbered = self.node_row if nodes else self.element_row
        known = {} if inside is None else numbered[inside]
        rows: list[int] = []
        named: list[tuple[Scope, int | None, str]] = []
        for item in piece.items:
            if isinstance(item, str):
                instance, dot, label = item.rpartition(".")
                at = self._place(instance) if dot and _is_whole(label) else None
                if at is not None:
                    row = numbered[at].get(int(label))
                    rows += [] if row is None else [row]
                else:
                    named.append((whose, inside, item))
                continue
            first, last, step = item
            if first == last:
                row = known.get(first)
                rows += [] if row is None else [row]
                continue
            span = range(first, last + (1 if step > 0 else -1), step)
            if len(span) > len(known):
                rows += [known[label] for label in known if label in span]
            else:
                rows += [known[label] for label in span if label in known]
        of_elements = [
            self.node_of[index]
            for elements in piece.of_elements
            for index in self._elements(whose, inside, elements)
        ]
        return _unique([np.array(rows, dtype=np.int64), *of_elements]), named

    def _surface(
        self, scope: Scope, place: int | None, surface: tuple[str, list[list[str]]]
    ) -> NDArray[np.int64]:
        return _unique(self._faces(scope, place, surface))

    def _faces(
        self, scope: Scope, place: int | None, surface: tuple[str, list[list[str]]]
    ) -> list[NDArray[np.int64]]:
        """Nodes of the faces of a surface; of shells all nodes, of nodes these."""
        kind, rows = surface
        found = []
        for words in rows:
            members = self._surface_members(scope, place, words[0], nodes=kind == "NODE")
            if kind == "NODE":
                found.append(members)
                continue
            side = words[1].upper() if len(words) > 1 else ""
            for index in members:
                faces = _FACES.get(self.kind_of[index])
                if faces is not None and re.fullmatch(r"S[1-6]", side) and int(side[1]) <= len(faces):
                    found.append(self.node_of[index][list(faces[int(side[1]) - 1])])
                elif faces is None and side in {"", "SPOS", "SNEG"} and self.flat[index]:
                    found.append(self.node_of[index])
        return found

    def _surface_members(
        self, scope: Scope, place: int | None, word: str, *, nodes: bool
    ) -> NDArray[np.int64]:
        if _is_whole(word):
            known = {} if place is None else (self.node_row if nodes else self.element_row)[place]
            row = known.get(int(word))
            return np.array([] if row is None else [row], dtype=np.int64)
        return self._resolve(scope, place, word, nodes=nodes)

    # -- materials --

    def _without_section(self) -> None:
        """Shells, plane elements, beams without properties, only with nodes: meshers write groups so."""
        found = [np.empty(0, dtype=np.int64)]
        for place, one in enumerate(self.placed):
            found += [self._elements(one.part, place, elements) for elements, _ in one.part.sections]
        sectioned = np.concatenate(found)
        start = 0
        for k, block in enumerate(self.blocks):
            end = start + len(block.labels)
            silent = not ((sectioned >= start) & (sectioned < end)).any()
            if silent and not (block.kind or block.harmless or _SOLID.match(block.name)):
                self.blocks[k] = replace(block, words=f"{block.words} without section", harmless=True)
            start = end

    def _materials(self) -> tuple[NDArray[np.int64], list[DeckMaterial]]:
        count = sum(len(block.labels) for block in self.blocks)
        index = np.full(count, -1, dtype=np.int64)
        names: dict[str, int] = {}
        for place, one in enumerate(self.placed):
            for elements, material in one.part.sections:
                if material.upper() in self.reader.materials:
                    number = names.setdefault(material.upper(), len(names))
                    index[self._elements(one.part, place, elements)] = number
        made = [_deck_material(self.reader.materials[name]) for name in names]
        for one in self.placed:  # of plates and beams, behind those of solids
            for card in one.part.frame_cards:
                name = card.parameters.get("MATERIAL", "").upper()
                if card.keyword == "BEAMGENERALSECTION":
                    name = general_key(card)
                    if name not in names:
                        names[name] = len(made)
                        made.append(general_material(card))
                elif card.keyword.endswith("SECTION") and name in self.reader.materials and name not in names:
                    names[name] = len(made)
                    made.append(_deck_material(self.reader.materials[name]))
        self.material_names, self.frame_materials = names, made
        return index, made


def _deck_material(spec: _Material) -> DeckMaterial:
    young, poisson = (None, None) if spec.elastic is None else spec.elastic[:2]
    notes = tuple(f"material {spec.name}: {note}" for note in dict.fromkeys(spec.notes))
    return DeckMaterial(spec.name, young, poisson, spec.density, spec.refused, notes)


def _short_names(sets: dict[str, NDArray[np.int64]]) -> None:
    """Sets of an instance also without its name, if only one has it."""
    tails: dict[str, list[str]] = {}
    for name in sets:
        if "." in name:
            tails.setdefault(name.partition(".")[2], []).append(name)
    for tail, names in tails.items():
        if len(names) == 1 and tail not in sets:
            sets[tail] = sets[names[0]]


def _key(named: Named, nodes: bool) -> SetKey:
    scope, place, name = named
    return id(scope), place, name.upper(), nodes


def _unique(arrays: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    return np.unique(np.concatenate([*arrays, np.empty(0, dtype=np.int64)])).astype(np.int64)


def _turn(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Rotation about an axis (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)


def _first_place(card: Card) -> tuple[Path, int]:
    return (card.data[0][0], card.data[0][1]) if card.data else (card.file, card.line)


_WHOLE = re.compile(r"[+-]?[0-9]{1,18}")  # what fits 64 bits


def _is_whole(word: str) -> bool:
    return _WHOLE.fullmatch(word) is not None


def _whole(card: Card, words: list[str], at: tuple[Path, int], expected: str) -> list[int]:
    if not words:
        card.fail("an empty line", expected, at)
    for word in words:
        if not _is_whole(word):
            card.fail(f"{word!r}", expected, at)
    return [int(word) for word in words]


def _reals(card: Card, words: list[str], at: tuple[Path, int]) -> list[float]:
    """Numbers of a data line; a field between two commas is zero."""
    found = []
    for word in words:
        try:
            found.append(deck_number(word) if word else 0.0)
        except ValueError:
            card.fail(f"{word!r}", "a finite number", at)
    return found
