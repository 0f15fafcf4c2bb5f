"""A finite element deck of another program: its solids, sets and materials, and the one body that is taken from it.

Readers (`abaqus_deck`, `nastran_deck`, meshes of meshio) fill a `Deck`, in the units of the file. A deck may hold
several parts, element types and materials; `Deck.body` takes one body of one kind of element, or says why not.
"""

from __future__ import annotations

import re
from dataclasses import field
from difflib import get_close_matches
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.model import DENSITY_LIMIT, WAVE_SPEEDS, Material

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.deck_parts import DeckFrame

__all__ = [
    "DECK_SUFFIXES",
    "READ_SUFFIXES",
    "Deck",
    "DeckBody",
    "DeckLines",
    "DeckMaterial",
    "ElementBlock",
    "deck_number",
    "deck_text",
    "included_file",
    "material_of",
]

DECK_SUFFIXES = (".bdf", ".dat", ".fem", ".inp", ".nas")
"""Files of Abaqus, CalculiX (``.inp``) and Nastran."""
READ_SUFFIXES = (*DECK_SUFFIXES, ".cdb", ".unv")
"""Files that are read here, and not by meshio: besides these, archives of Ansys and universal files."""
KINDS = {"hex8": "8-node bricks", "hex20": "20-node bricks", "tet10": "10-node tetrahedra"}
_SOLIDS = "solids: 8-node bricks, 20-node bricks or 10-node tetrahedra"
_SHOWN = 6  # parts, sets or types of a message at most
_AGREE = 1e-3  # relative difference of a material that is given twice


# ---- text ----


_EXPONENT = re.compile(r"^([+-]?(?:\d+\.?\d*|\.\d+))([+-]\d+)$")  # 1.5-3 is 1.5e-3


def deck_number(word: str) -> float:
    """Number as Fortran programs write it: ``1.5e-3``, ``1.5D-3``, ``1.5-3``.

    Raises
    ------
    ValueError
        If it is none, or not finite.
    """
    text = word.strip().upper().replace("D", "E")
    match = _EXPONENT.match(text)
    value = float(f"{match[1]}E{match[2]}" if match else text)
    if not np.isfinite(value):
        raise ValueError(word)
    return value


def deck_text(path: Path) -> list[str]:
    """Lines of a deck.

    Raises
    ------
    InputError
        A file that is missing or no text.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=path, expected="a text file") from error
    if b"\0" in data[:4096]:
        raise InputError("is not a text file", source=path, expected="a deck in text")
    return data.decode("utf-8", errors="replace").splitlines()


def included_file(name: str, deck: Path, root: Path, place: Path, line: int) -> Path:
    """File that a deck includes; relative to the folder of the deck.

    Parameters
    ----------
    name
        As the deck says it.
    deck
        The first file of the deck.
    root
        Folder that is not left, also not through links.
    place, line
        File and line that include it.

    Raises
    ------
    InputError
        A file that does not exist or lies outside `root`.
    """
    target = (deck.parent / name).resolve()
    key = f"line {line}"
    if Path(name).is_absolute() or not target.is_relative_to(root.resolve()):
        raise InputError(
            f"includes {name!r}, which leaves the folder",
            source=place,
            key=key,
            expected="a relative path of a file inside the case folder",
        )
    if not target.is_file():
        raise InputError(
            f"includes {name!r}, which does not exist",
            source=place,
            key=key,
            expected="a file, relative to the folder of the deck",
        )
    return target


MOST_INCLUDES = 5_000
"""Files that a deck includes, each as often as it is included."""
MOST_AGAIN = 2**28
"""Bytes of files that are included a second time and more."""


class DeckLines:
    """Lines of a deck, with the files that it includes in their places.

    Parameters
    ----------
    deck
        The first file.
    root
        Folder that is not left, also not through links.
    spec
        Of a line as it stands: what it says without comments, ``""`` if that is nothing.
    included
        Of a line that says something, its file and number: the name of the file that it includes, or None.
    """

    def __init__(
        self,
        deck: Path,
        root: Path,
        spec: Callable[[str], str],
        included: Callable[[str, Path, int], str | None],
    ) -> None:
        self.deck, self.root = deck, root
        self._spec, self._included = spec, included
        self._count, self._again = 0, 0
        self._known: set[Path] = set()

    def named(self, name: str, place: Path, line: int) -> Path:
        """File that a line names, as `included_file`; all that are named count together.

        Raises
        ------
        InputError
            More files, or more of them again, than a deck that somebody wrote.
        """
        target = included_file(name, self.deck, self.root, place, line)
        self._count += 1
        if target in self._known:
            self._again += target.stat().st_size
        self._known.add(target)
        if self._count > MOST_INCLUDES or self._again > MOST_AGAIN:
            many = self._count > MOST_INCLUDES
            raise InputError(
                f"includes {name!r}, the file number {self._count:,} in all"
                if many
                else f"includes {name!r} again, with {self._again:,} bytes of files that were read before",
                source=place,
                key=f"line {line}",
                expected=f"at most {MOST_INCLUDES:,} files in all"
                if many
                else f"at most {MOST_AGAIN:,} bytes",
            )
        return target

    def of(self, file: Path, above: Path | None = None) -> Iterator[tuple[Path, int, str]]:
        """File, number and text of the lines of a file that say something.

        Parameters
        ----------
        file
            Where to begin.
        above
            A file that must not be included: the one that names this one.

        Raises
        ------
        InputError
            Files that include each other in a circle, or as `named`.
        """
        inside = {file.resolve()} if above is None else {above.resolve(), file.resolve()}
        waiting = [(file, enumerate(deck_text(file), start=1))]
        while waiting:
            place, lines = waiting[-1]
            for number, raw in lines:
                line = self._spec(raw)
                name = self._included(line, place, number) if line else None
                if name is not None:
                    target = self.named(name, place, number)
                    if target in inside:
                        raise InputError(
                            f"{name!r} includes itself",
                            source=place,
                            key=f"line {number}",
                            expected="files that do not include each other in a circle",
                        )
                    inside.add(target)
                    waiting.append((target, enumerate(deck_text(target), start=1)))
                    break
                if line:
                    yield place, number, line
            else:
                waiting.pop()
                inside.discard(place.resolve())


# ---- what a deck holds ----


@dataclass(frozen=True)
class ElementBlock:
    """Elements of one type.

    Parameters
    ----------
    name
        Type as the file calls it, e.g. ``"C3D8R"``.
    kind
        Key of `KINDS`, or ``""`` for what no body is made of.
    labels
        Numbers of the elements in the file, shape (m,).
    nodes
        Rows of `Deck.points`, shape (m, nodes per element); VTK order if there is a kind, else (m, 0) if not known.
    words
        What an element without kind is, e.g. ``"shell"``.
    remedy
        What to do about it.
    harmless
        Whether a body may be taken beside it without a word of the user: masses, springs, cells of groups.
    shape
        What it is as a cell of meshio, e.g. ``"quad8"``; ``""`` if its nodes are not known.
    """

    name: str
    kind: str
    labels: NDArray[np.object_] | NDArray[np.int64]
    nodes: NDArray[np.int64]
    words: str = ""
    remedy: str = ""
    harmless: bool = False
    shape: str = ""


@dataclass(frozen=True)
class DeckMaterial:
    """Material of a deck, in the units of the file; None where it gives no information.

    Parameters
    ----------
    name
        Name in the file.
    young_modulus, poisson_ratio, density
        E, nu, rho.
    refused
        Why it is no linear isotropic material, e.g. ``"orthotropic (*ELASTIC, TYPE=ORTHO)"``.
    notes
        What was left out or chosen, e.g. a row of a table over temperature.
    """

    name: str
    young_modulus: float | None = None
    poisson_ratio: float | None = None
    density: float | None = None
    refused: str = ""
    notes: tuple[str, ...] = ()

    def agrees(self, other: DeckMaterial) -> bool:
        """Whether both mean the same linear material."""
        keys = ("young_modulus", "poisson_ratio", "density", "refused")
        return all(getattr(self, key) == getattr(other, key) for key in keys)


@dataclass(frozen=True)
class DeckBody:
    """One body of a deck, in the units of the file.

    Parameters
    ----------
    mesh
        Checked; node sets, element sets and surfaces of the file are node groups.
    materials
        Its materials; empty if the file says none.
    material_index
        Entry of `materials` of every element of the mesh, shape (ne,); zeros if there is none.
    notes
        What was left out or chosen, one sentence each.
    """

    mesh: Mesh
    materials: tuple[DeckMaterial, ...]
    material_index: NDArray[np.int64]
    notes: tuple[str, ...] = ()

    @property
    def material(self) -> DeckMaterial | None:
        """Its only material, if the file says one.

        Raises
        ------
        InputError
            If it has several.
        """
        if len(self.materials) > 1:
            names = ", ".join(repr(one.name) for one in self.materials[:_SHOWN])
            raise InputError(
                f"has {len(self.materials)} materials: {names}",
                source=self.mesh.name,
                expected="one material",
            )
        return self.materials[0] if self.materials else None


@dataclass(frozen=True)
class Deck:
    """Nodes, elements, sets and materials of a file, in its units.

    Elements are numbered over all `blocks`, one after the other.

    Parameters
    ----------
    source
        The file.
    points
        Positions of the nodes, shape (n, 3).
    blocks
        Elements by type.
    node_sets
        Rows of `points` by name; sets of elements and surfaces too, as far as no set of nodes has the name.
    element_sets
        Element numbers by name.
    material_index
        Entry of `materials` of every element, -1 for none.
    materials
        Materials of sections.
    notes
        What the reader left out.
    node_labels
        Number of every node in the file, ``"INSTANCE.number"`` in an instance; shape (n,).
    held
        Degrees of freedom (3 times the row of the node, plus direction) that the file holds, ascending.
    make_frame
        Makes plates, beams, masses and rigid elements of them; None if there are none.
    """

    source: Path
    points: NDArray[np.float64]
    blocks: Sequence[ElementBlock]
    node_sets: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    element_sets: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    material_index: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    materials: Sequence[DeckMaterial] = ()
    notes: tuple[str, ...] = ()
    node_labels: Sequence[object] = ()
    held: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    make_frame: Callable[[], DeckFrame] | None = None

    @cached_property
    def frame(self) -> DeckFrame | None:
        """Plates, beams, masses and rigid elements, made when somebody asks; None if there are none.

        Raises
        ------
        InputError
            What is wrong with one of them, with file and line.
        """
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is refused with the structure
            return None if self.make_frame is None else self.make_frame()

    def body(
        self,
        *,
        elements: Sequence[str] = (),
        part: int | None = None,
        merge_nodes: float | None = None,
        materials: bool = True,
    ) -> DeckBody:
        """Take one body.

        Parameters
        ----------
        elements
            Names of element sets; all elements by default.
        part
            One-based number of the part among those that share no face, in the order of the file.
        merge_nodes
            Nodes nearer than this become one, in the unit of the file: joins parts that touch node on node.
        materials
            Whether materials of the file count; if not, the body has none.

        Returns
        -------
        DeckBody
            Checked mesh, materials and notes.

        Raises
        ------
        InputError
            An unknown set; shells, beams or solids of other kinds among the elements; several parts, and no choice;
            bricks and tetrahedra at once; collapsed or inverted elements; several materials, and elements without one.
        """
        chosen = self.chosen(elements)
        notes = list(self.notes)
        kept, beside = self._split(chosen)
        self._check_types(beside, bool(len(kept)), part, notes)
        rows = np.arange(len(self.points))
        if merge_nodes is not None:
            rows = self._merged(kept, merge_nodes)
        self._check_collapsed(kept, rows, merge_nodes)
        parts = self._parts(kept, rows)
        if part is not None:
            if part > parts.max() + 1:
                count = parts.max() + 1
                raise InputError(
                    f"{part}",
                    source=self.source,
                    key="part",
                    expected=f"a number from 1 to {count}" if count > 1 else "no part: there is one only",
                )
            kept = kept[parts == part - 1]
        elif parts.max() > 0:
            self._refuse_parts(kept, parts, rows)
        cells = self._cells(kept)
        if len(cells) > 1:
            raise InputError(
                f"contains {' and '.join(KINDS[kind] for kind in cells)} ({self._type_words(kept)})",
                source=self.source,
                expected="one kind of them; choose some with 'elements' or 'part'",
            )
        ((kind, (_, nodes)),) = cells.items()
        found, index = self._materials(kept if materials else kept[:0], notes)
        index = index if materials else np.zeros(kept.size, dtype=np.int64)
        return DeckBody(self._mesh(rows, nodes, kind, kept), found, index, tuple(notes))

    # -- steps of `body` --

    def _starts(self) -> NDArray[np.int64]:
        return np.cumsum([0, *(len(block.labels) for block in self.blocks)])

    def chosen(self, names: Sequence[str]) -> NDArray[np.int64]:
        """Elements of sets by name, ascending numbers over all blocks; all elements without a name.

        Raises
        ------
        InputError
            An unknown set.
        """
        count = int(self._starts()[-1])
        if not names:
            return np.arange(count)
        known = {name.upper(): members for name, members in self.element_sets.items()}
        for name in names:
            if name.upper() not in known:
                near = get_close_matches(name.upper(), known, 1)
                hint = next(
                    (f"; did you mean {have!r}?" for have in self.element_sets if [have.upper()] == near), ""
                )
                listed = ", ".join(repr(have) for have in list(self.element_sets)[:20])
                raise InputError(
                    f"element set {name!r} does not exist{hint}",
                    source=self.source,
                    key="elements",
                    expected=f"one of {listed}" if listed else "a file with element sets",
                )
        return np.unique(np.concatenate([known[name.upper()] for name in names]))

    def _split(
        self, chosen: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], list[tuple[ElementBlock, int, object]]]:
        """Elements that bodies are made of; the others as block, number and first label."""
        kept, beside = [], []
        for block, start in zip(self.blocks, self._starts(), strict=False):
            own = chosen[(chosen >= start) & (chosen < start + len(block.labels))]
            if block.kind:
                kept.append(own)
            elif own.size:
                beside.append((block, own.size, block.labels[own[0] - start]))
        return np.concatenate(kept) if kept else np.empty(0, dtype=np.int64), beside

    def _check_types(
        self,
        beside: list[tuple[ElementBlock, int, object]],
        have_solids: bool,
        part: int | None,
        notes: list[str],
    ) -> None:
        wrong = [entry for entry in beside if not entry[0].harmless]
        if wrong and (part is None or not have_solids):
            first, _, label = wrong[0]
            words = ", ".join(f"{n} {block.words} {block.name}" for block, n, _ in wrong[:_SHOWN])
            ours = [
                name
                for name, members in self.element_sets.items()
                if members.size and not any(not block.harmless for block, *_ in self._split(members)[1])
            ]
            choice = (
                f"; or choose solids of it with 'elements', e.g. {ours[0]!r}" if ours and have_solids else ""
            )
            raise InputError(
                f"contains {words} (first: element {label})",
                source=self.source,
                expected=(first.remedy or _SOLIDS) + choice,
            )
        notes += [f"left out: {n} {block.words} {block.name}" for block, n, _ in beside if block.words]
        if not have_solids:
            raise InputError(
                "contains no solid cell",
                source=self.source,
                expected=_SOLIDS,
            )

    def _cells(self, kept: NDArray[np.int64]) -> dict[str, tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Of each kind the positions in `kept`, ascending numbers of solids, and the nodes of these elements."""
        found: dict[str, list[tuple[NDArray[np.int64], NDArray[np.int64]]]] = {}
        for block, start in zip(self.blocks, self._starts(), strict=False):
            if block.kind:
                places = np.flatnonzero((kept >= start) & (kept < start + len(block.labels)))
                if places.size:
                    found.setdefault(block.kind, []).append((places, block.nodes[kept[places] - start]))
        return {
            kind: (np.concatenate([p for p, _ in pairs]), np.vstack([nodes for _, nodes in pairs]))
            for kind, pairs in found.items()
        }

    def _merged(self, kept: NDArray[np.int64], distance: float) -> NDArray[np.int64]:
        """Row of `points` that each node becomes: the lowest of its cluster."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components
        from scipy.spatial import cKDTree

        used = np.unique(np.concatenate([nodes.ravel() for _, nodes in self._cells(kept).values()]))
        pairs = cKDTree(self.points[used]).query_pairs(distance, output_type="ndarray")
        shape = (used.size, used.size)
        near = coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=shape)
        _, cluster = connected_components(near, directed=False)
        _, first = np.unique(cluster, return_index=True)
        rows = np.arange(len(self.points))
        rows[used] = used[first[cluster]]
        return rows

    def _parts(self, kept: NDArray[np.int64], rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """Zero-based part of every kept element; parts are numbered by their first element."""
        labels = np.zeros(kept.size, dtype=np.int64)
        count = 0
        for kind, (places, nodes) in self._cells(kept).items():
            found = Mesh(self.points, rows[nodes], kind, name=str(self.source)).parts()
            labels[places] = count + found
            count += int(found.max()) + 1
        _, first, part = np.unique(labels, return_index=True, return_inverse=True)
        rank = np.empty(first.size, dtype=np.int64)
        rank[np.argsort(first)] = np.arange(first.size)
        return rank[part.ravel()]

    def _refuse_parts(
        self, kept: NDArray[np.int64], parts: NDArray[np.int64], rows: NDArray[np.int64]
    ) -> NoReturn:
        count = int(parts.max()) + 1
        words = []
        nodes = []
        for number in range(count):
            own = kept[parts == number]
            nodes.append(
                np.unique(np.concatenate([rows[cells].ravel() for _, cells in self._cells(own).values()]))
            )
            if number >= _SHOWN:
                continue
            low, high = self.points[nodes[-1]].min(axis=0), self.points[nodes[-1]].max(axis=0)
            box = ", ".join(f"{axis} {low[k]:.4g} to {high[k]:.4g}" for k, axis in enumerate("xyz"))
            named = [name for name, members in self.element_sets.items() if np.array_equal(members, own)]
            called = f", element set {named[0]!r}" if named else ""
            some = "element" if own.size == 1 else "elements"
            words.append(f"{number + 1} ({own.size} {some} {self._type_words(own)}{called}, {box})")
        joined = np.concatenate(nodes)
        touch = "no face in common" if np.unique(joined).size < joined.size else "no node in common"
        more = f" and {count - _SHOWN} more" if count > _SHOWN else ""
        raise InputError(
            f"falls into {count} parts with {touch}: {'; '.join(words)}{more}",
            source=self.source,
            expected="one body: choose with 'part' or 'elements', or join parts that touch node on node with "
            "'merge_nodes'",
        )

    def _type_words(self, kept: NDArray[np.int64]) -> str:
        starts = self._starts()
        found = np.unique(np.searchsorted(starts, kept, side="right") - 1)
        return ", ".join(dict.fromkeys(self.blocks[index].name for index in found))

    def _label(self, index: int) -> str:
        """Element of the file in words."""
        block = int(np.searchsorted(self._starts(), index, side="right")) - 1
        return (
            f"element {self.blocks[block].labels[index - self._starts()[block]]} ({self.blocks[block].name})"
        )

    def _check_collapsed(
        self, kept: NDArray[np.int64], rows: NDArray[np.int64], merge_nodes: float | None
    ) -> None:
        found = [
            kept[places[(np.diff(np.sort(rows[nodes], axis=1), axis=1) == 0).any(axis=1)]]
            for places, nodes in self._cells(kept).values()
        ]
        twice = np.sort(np.concatenate(found))
        if not twice.size:
            return
        some = f"{twice.size} of {len(kept)} elements"
        if merge_nodes is not None:
            raise InputError(
                f"{merge_nodes:g} collapses {self._label(twice[0])} ({some})",
                source=self.source,
                key="merge_nodes",
                expected="a distance smaller than every edge",
            )
        raise InputError(
            f"has a node twice: a collapsed element ({some})",
            source=self.source,
            key=self._label(twice[0]),
            expected="elements whose nodes are all different: bricks that are no wedges, or 10-node tetrahedra",
        )

    def _materials(
        self, kept: NDArray[np.int64], notes: list[str]
    ) -> tuple[tuple[DeckMaterial, ...], NDArray[np.int64]]:
        """Different materials of elements, and which of them each element has."""
        index = np.full(kept.size, -1, dtype=np.int64)
        found: list[DeckMaterial] = []
        owner = self.material_index[kept] if len(self.materials) else index
        for number in np.unique(owner[owner >= 0]):
            one = self.materials[number]
            place = next((k for k, other in enumerate(found) if other.agrees(one)), len(found))
            if place == len(found):
                found.append(one)
            index[owner == number] = place
        without = kept[index < 0]
        if without.size and len(found) > 1:
            raise InputError(
                f"has no section, and the others have {len(found)} materials ({without.size} such elements)",
                source=self.source,
                key=self._label(without[0]),
                expected="a section for every element; or 'ignore_material', with the material given in the case",
            )
        if without.size and found:
            notes.append(f"{without.size} elements have no section: taken as of {found[0].name}")
        return tuple(found), np.maximum(index, 0)

    def _mesh(
        self, rows: NDArray[np.int64], nodes: NDArray[np.int64], kind: str, kept: NDArray[np.int64]
    ) -> Mesh:
        used, flat = np.unique(rows[nodes], return_inverse=True)
        new_index = np.full(len(self.points), -1, dtype=np.int64)
        new_index[used] = np.arange(used.size)
        own_nodes = np.zeros(len(self.points), dtype=bool)
        own_nodes[nodes] = True  # a node that another one stands for is still in its sets
        groups = {}
        for name, members in self.node_sets.items():
            own = members[own_nodes[members]]
            if own.size:
                groups[name] = new_index[rows[own]]
        mesh = Mesh(
            self.points[used], flat.reshape(nodes.shape), kind, node_groups=groups, name=str(self.source)
        )
        inverted = np.flatnonzero(mesh.smallest_determinants() <= 0.0)
        if inverted.size:
            at = mesh.nodes[mesh.elements[inverted[0]]].mean(axis=0)
            inside = mesh.element_volumes()[inverted[0]] > 0.0
            raise InputError(
                ("distorted beyond use: at a node of it" if inside else "inverted or flat:")
                + f" the Jacobian determinant is not positive ({inverted.size} of {len(kept)} elements)",
                source=self.source,
                key=f"{self._label(kept[inverted[0]])} at ({at[0]:.6g}, {at[1]:.6g}, {at[2]:.6g})",
                expected="the node order of its type and a convex element (no angle of 180 degrees or more)",
            )
        return mesh.check()


# ---- material ----


def material_of(
    found: DeckMaterial | None,
    given: Mapping[str, float],
    *,
    source: object,
    length_unit: float | None = None,
    mass_unit: float | None = None,
) -> Material:
    """Material of a body from what a case gives and what its deck says, which must agree.

    Parameters
    ----------
    found
        Material of the deck, in its units, with the second as unit of time.
    given
        Some of ``young_modulus`` [Pa], ``poisson_ratio``, ``density`` [kg/m3].
    source
        The deck, for messages.
    length_unit, mass_unit
        Metres and kilograms per unit of the deck, if given: stress is in mass / (length s^2), density in
        mass / length^3 (with mm and t: N/mm^2 and t/mm^3).

    Raises
    ------
    InputError
        A material that is not linear and isotropic; a property that nobody gives; two values that differ by more
        than 0.1 %; no unit of mass where one of length is given and stress or density is needed; without given units, a
        material that does not exist (wave speed, density).
    """
    keys = ("young_modulus", "poisson_ratio", "density")
    if found is None:
        found = DeckMaterial("")
    if found.refused:
        raise InputError(
            f"material {found.name!r} is {found.refused}",
            source=source,
            expected="linear isotropic elasticity; 'ignore_material' takes the mesh only, with the material given here",
        )
    units_given = length_unit is not None or mass_unit is not None
    length, mass = length_unit or 1.0, mass_unit or 1.0
    scale_known = mass_unit is not None or length_unit is None
    units = {"young_modulus": mass / length, "poisson_ratio": 1.0, "density": mass / length**3}
    of_file = {key: getattr(found, key) for key in keys if getattr(found, key) is not None}
    missing = [key for key in keys if key not in given and key not in of_file]
    if missing:
        whose = f"material {found.name!r} of the file" if found.name else "the file"
        raise InputError(
            f"no {missing[0]!r}: {whose} has none",
            source=source,
            key=f"material.{missing[0]}",
            expected="a value in the material of the body",
        )
    if not scale_known:
        taken = [key for key in ("young_modulus", "density") if key not in given]
        if taken:
            raise InputError(
                f"no unit of mass for the {taken[0].replace('_', ' ')} {of_file[taken[0]]:g} of the file",
                source=source,
                key="mass_unit",
                expected='"1 t" for mm, N/mm^2 and t/mm^3, "1 kg" for m, Pa and kg/m^3',
            )
        if {"young_modulus", "density"} <= of_file.keys():
            # the unit of mass drops out of E / rho
            ratio = given["young_modulus"] / given["density"]
            of_deck = of_file["young_modulus"] / of_file["density"] * length**2
            if abs(ratio - of_deck) > _AGREE * ratio:
                _disagree("young_modulus / density", ratio, of_deck, "m^2/s^2", found.name, source)
    of_file_si = {key: value * units[key] for key, value in of_file.items()}
    for key, unit in (("young_modulus", "Pa"), ("poisson_ratio", ""), ("density", "kg/m^3")):
        known = scale_known or key == "poisson_ratio"
        if known and key in given and key in of_file:
            here, there = given[key], of_file_si[key]
            if abs(here - there) > _AGREE * max(abs(here), abs(there)):
                _disagree(key, here, there, unit, found.name, source)
    values = {**of_file_si, **given}
    material = Material(**{key: values[key] for key in keys})
    if of_file and not units_given:
        _check_material(material, source)
    return material


def _disagree(key: str, here: float, there: float, unit: str, name: str, source: object) -> NoReturn:
    raise InputError(
        f"{here:.6g} {unit}".strip() + f", and material {name!r} of the file has {there:.6g} {unit}".rstrip(),
        source=source,
        key=f"material.{key}",
        expected="the same (are 'length_unit' and 'mass_unit' those of the file?), no value here, or 'ignore_material'",
    )


def _check_material(material: Material, source: object) -> None:
    """Refuse a material that does not exist: the sign of a deck in other units than SI."""
    speed = float(np.sqrt((material.lame_lambda + 2.0 * material.shear_modulus) / material.density))
    if not WAVE_SPEEDS[0] <= speed <= WAVE_SPEEDS[1] or material.density > DENSITY_LIMIT:
        raise InputError(
            f"young_modulus {material.young_modulus:g} Pa and density {material.density:g} kg/m^3: "
            f"longitudinal waves of {speed:.4g} m/s, no material is like that",
            source=source,
            expected='the units of the file: length_unit = "1 mm" and mass_unit = "1 t" for N/mm^2 and t/mm^3, '
            '"1 m" and "1 kg" if that is intended',
        )
