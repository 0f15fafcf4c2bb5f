"""A structure from a deck: which elements, in which units, of which materials, with what a case gives by group."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import DeckMaterial, material_of
from heavylift.preprocess.finite_elements.deck_parts import DeckBeams, DeckPlates, some_elements
from heavylift.preprocess.structures.structure import (
    Average,
    Beams,
    PointMass,
    RigidLink,
    Shells,
    Solids,
    Structure,
    Tie,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.deck import Deck, ElementBlock
    from heavylift.preprocess.finite_elements.model import Material
    from heavylift.preprocess.structures.sections import BeamSection

__all__ = [
    "BeamProperty",
    "PlateProperty",
    "PropertyMass",
    "UnitSystem",
    "has_structure",
    "property_masses",
    "structure_of",
]


# ---- units ----


class UnitSystem(NamedTuple):
    """Units of a deck: metres, kilograms and seconds per unit, and how it is called."""

    length: float
    mass: float
    time: float
    name: str


_SYSTEMS = (
    UnitSystem(1.0, 1.0, 1.0, "m, kg, s, N"),
    UnitSystem(1e-3, 1e3, 1.0, "mm, t, s, N"),
    UnitSystem(1e-3, 1.0, 1e-3, "mm, kg, ms, kN"),
    UnitSystem(1e-3, 1.0, 1.0, "mm, kg, s, mN"),
    UnitSystem(1.0, 1e3, 1.0, "m, t, s, kN"),
    UnitSystem(0.0254, 175.126835, 1.0, "in, lbf s2/in, s, lbf"),
)
# speed of waves in rods, sqrt(E / rho): steel 5172, aluminium 5090, titanium 5060; bronze and concrete are slower [m/s]
_SPEEDS = (3000.0, 6500.0)
_DENSITIES = (1500.0, 12000.0)


def recognised_units(materials: Sequence[DeckMaterial], source: object) -> UnitSystem:
    """Units in which materials of a deck are like metals: by the speed of waves in rods and the density.

    Raises
    ------
    InputError
        No such system; materials that tell different ones.
    """
    told: UnitSystem | None = None
    teller = ""
    for one in materials:
        E, rho = one.young_modulus or 0.0, one.density or 0.0
        if not (E > 0.0 and rho > 0.0):
            continue
        fits = [
            system
            for system in _SYSTEMS
            if _SPEEDS[0] <= np.sqrt(E / rho) * system.length / system.time <= _SPEEDS[1]
            and _DENSITIES[0] <= rho * system.mass / system.length**3 <= _DENSITIES[1]
        ]
        if len(fits) != 1:
            raise InputError(
                f"material {one.name!r} has E = {E:g} and rho = {rho:g}, "
                f"sqrt(E/rho) = {np.sqrt(E / rho):.4g}: like no metal in any usual system",
                source=source,
                key="length_unit",
                expected="'length_unit' and 'mass_unit' of the file (steel has 5172 in m and s)",
            )
        if told is not None and fits[0] != told:
            raise InputError(
                f"material {teller!r} is in {told.name}, material {one.name!r} in {fits[0].name}: mixed units",
                source=source,
                key="length_unit",
                expected="one system of units in a deck",
            )
        told, teller = fits[0], one.name
    if told is None:
        raise InputError(
            "no material with a density tells the units of the file",
            source=source,
            key="length_unit",
            expected="'length_unit' and 'mass_unit' of the file",
        )
    return told


# ---- what a case gives by group ----


@dataclass(frozen=True)
class PlateProperty:
    """What a case says of the plates of a group; None leaves it to the deck.

    Attributes
    ----------
    thickness, offset
        [m]; the offset from the nodes to the mid-surface along the normal.
    nonstructural_mass
        [kg/m2].
    material
        Of the group.
    """

    thickness: float | None = None
    offset: float | None = None
    nonstructural_mass: float | None = None
    material: Material | None = None


@dataclass(frozen=True)
class BeamProperty:
    """What a case says of the beams of a group; None leaves it to the deck.

    Attributes
    ----------
    section
        In SI units.
    orientation
        Vector in plane 1, shape (3,).
    flange
        Direction in which axis 3 points; beams that have it otherwise are turned end for end, shape (3,).
    offset
        From the nodes to the centroid, along axes 2 and 3 [m].
    material
        Of the group.
    """

    section: BeamSection | None = None
    orientation: tuple[float, float, float] | None = None
    flange: tuple[float, float, float] | None = None
    offset: tuple[float, float] | None = None
    material: Material | None = None


# ---- from deck to structure ----


def has_structure(deck: Deck, elements: Sequence[str], named: Sequence[str] = ()) -> bool:
    """Whether chosen elements of a deck make a structure: plates, beams, masses or rigid elements are among them.

    Parameters
    ----------
    deck
        It.
    elements
        Names of sets; all by default.
    named
        Groups that the case gives plates or beams for.
    """
    frame = deck.frame
    if frame is None and named:
        raise InputError(
            f"has no plates and no beams, and the case has {named[0]!r}",
            source=deck.source,
            expected="no tables of plates and stiffeners for a body of solids",
        )
    if frame is None:
        return False
    if named:
        return True
    chosen = deck.chosen(elements)
    own = np.zeros(int(sum(len(block.labels) for block in deck.blocks)), dtype=bool)
    own[chosen] = True
    parts = _parts(frame.plates, frame.beams)
    solid = _solid_elements(deck, own)
    if any(own[part.index].any() and (not part.loose or not solid.any()) for part in parts):
        return True
    nodes = np.zeros(len(deck.points), dtype=bool)
    for block, start in _blocks(deck):
        if block.kind:
            nodes[block.nodes[own[start : start + len(block.labels)]]] = True
    touched = [np.append(link.dependent, link.node) for link in frame.links]
    touched += [np.append(one.nodes, one.node) for one in frame.averages]
    touched += [np.array([tie.node, tie.dependent]) for tie in frame.ties]
    touched += [np.array([mass.node]) for mass in frame.masses]
    return any(nodes[some].any() for some in touched)


def _parts(plates: Sequence[DeckPlates], beams: Sequence[DeckBeams]) -> tuple[DeckPlates | DeckBeams, ...]:
    return (*plates, *beams)


def _blocks(deck: Deck) -> list[tuple[ElementBlock, int]]:
    starts = np.cumsum([0, *(len(block.labels) for block in deck.blocks)])
    return list(zip(deck.blocks, starts.tolist(), strict=False))


def _solid_elements(deck: Deck, own: NDArray[np.bool_]) -> NDArray[np.bool_]:
    found = np.zeros(own.size, dtype=bool)
    for block, start in _blocks(deck):
        if block.kind:
            found[start : start + len(block.labels)] = own[start : start + len(block.labels)]
    return found


def structure_of(
    deck: Deck,
    *,
    elements: Sequence[str] = (),
    part: int | None = None,
    merge_nodes: float | None = None,
    given: Mapping[str, float] | None = None,
    ignore_material: bool = False,
    length_unit: float | None = None,
    mass_unit: float | None = None,
    plates: Mapping[str, PlateProperty] | None = None,
    beams: Mapping[str, BeamProperty] | None = None,
    source: object = "",
) -> Structure:
    """Structure of chosen elements of a deck, in SI units.

    Parameters
    ----------
    deck
        With a frame.
    elements
        Names of element sets; all elements by default.
    part
        One-based number of the part among those without a common node, in the order of the file.
    merge_nodes
        Nodes nearer than this become one [m].
    given
        Material that the case gives: some of ``young_modulus``, ``poisson_ratio``, ``density``.
    ignore_material
        Whether materials of the deck do not count.
    length_unit, mass_unit
        Metres and kilograms per unit of the deck; None for both: as its materials tell.
    plates, beams
        What the case gives by name of an element set.
    source
        Of `given`, for messages.

    Raises
    ------
    InputError
        Elements that a structure cannot have; plates without thickness, beams without section or orientation; units
        that nobody tells; masses and rigid elements that hang on nothing; materials as `material_of`.
    """
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        made = _Maker(
            deck, given or {}, ignore_material, length_unit, mass_unit, plates or {}, beams or {}, source
        ).structure(elements, part, merge_nodes)
        _check_numbers(made)
    return made


_LARGEST, _SMALLEST = 1e30, 1e-20
_FARTHEST = 1e9
"""Positions beyond are slips of exponents [m]."""


def _check_numbers(made: Structure) -> None:
    """Refuse what slips of exponents and signs make: numbers beyond all bounds, and constants that nothing has."""
    found: list[tuple[str, dict[str, object], dict[str, float]]] = [
        (
            part.name,
            {"thickness": part.thickness, "offset": part.offset},
            {
                "nonstructural mass": part.nonstructural_mass,
                "bending factor": part.bending_factor,
                "shear factor": part.shear_factor,
                "Young's modulus": part.material.young_modulus,
            },
        )
        for part in made.shells
    ]
    for beams in made.beams:
        one = beams.section
        free: dict[str, object] = {
            "orientation": beams.orientation,
            "offset": (beams.offset_a, beams.offset_b),
        }
        free |= {"product": one.product, "shear centre": one.shear_centre}
        moments = {"second moment 1": one.second_moment_1, "second moment 2": one.second_moment_2}
        moments["Young's modulus"] = beams.material.young_modulus
        positive = {**moments, "torsion constant": one.torsion, "nonstructural mass": one.nonstructural_mass}
        found.append((beams.name, free, positive))
        for key, area in (("area", one.area), ("shear area", min(one.shear_area_1, one.shear_area_2))):
            if not area > _SMALLEST:
                raise InputError(
                    f"{beams.name}: {key} {area:g} m2", source=made.name, expected="a positive area"
                )
    found += [
        (one.name, {"offset": one.offset, "inertia": one.inertia}, {"mass": one.mass}) for one in made.masses
    ]
    for name, free, positive in found:
        for key, value in {**free, **positive}.items():
            if not (np.abs(np.asarray(value, dtype=np.float64)) < _LARGEST).all():
                raise InputError(
                    f"{name}: {key} is beyond all bounds",
                    source=made.name,
                    expected=f"a number below {_LARGEST:g}",
                )
        for key, number in positive.items():
            if number < 0.0:
                raise InputError(f"{name}: {key} {number:g}", source=made.name, expected="none below 0")
    for beams in made.beams:
        one = beams.section
        if one.product**2 > one.second_moment_1 * one.second_moment_2 * (1.0 + 1e-9):
            raise InputError(
                f"{beams.name}: product {one.product:g} m4 of second moments {one.second_moment_1:g} and "
                f"{one.second_moment_2:g} m4",
                source=made.name,
                expected="a product whose square is below that of the second moments",
            )
    if np.abs(made.nodes).max() > _FARTHEST:
        raise InputError(
            f"a node is {np.abs(made.nodes).max():g} m from the origin",
            source=made.name,
            expected=f"positions within {_FARTHEST:g} m",
        )
    if not np.isfinite(sum(one.mass for one in property_masses(made))):
        raise InputError("the mass is beyond all bounds", source=made.name, expected="numbers of a structure")


class _Maker:
    def __init__(
        self,
        deck: Deck,
        given: Mapping[str, float],
        ignore_material: bool,
        length_unit: float | None,
        mass_unit: float | None,
        plates: Mapping[str, PlateProperty],
        beams: Mapping[str, BeamProperty],
        source: object,
    ) -> None:
        if deck.frame is None:
            raise InputError(
                "has no plates, beams, masses or rigid elements",
                source=deck.source,
                expected="elements of a structure",
            )
        self.deck, self.frame, self.source = deck, deck.frame, source
        self.given, self.ignore_material = given, ignore_material
        self.plate_wishes, self.beam_wishes = plates, beams
        self.count = int(sum(len(block.labels) for block in deck.blocks))
        self.labels = np.concatenate(
            [np.asarray(block.labels, dtype=object) for block in deck.blocks] or [np.empty(0, dtype=object)]
        )
        self.units = self._units(length_unit, mass_unit)
        self.materials: dict[int, Material] = {}
        self.notes = [note for note in deck.notes if note not in deck.frame.instead] + list(deck.frame.notes)

    # -- units and materials --

    def _units(self, length: float | None, mass: float | None) -> UnitSystem:
        used = [] if self.ignore_material else list(self.deck.materials)
        if length is None and mass is None:
            if used:
                return recognised_units(used, self.deck.source)
            return _SYSTEMS[0]
        if mass is None:
            frame = self.frame
            heavy = bool(frame.masses) or any(p.nonstructural_mass for p in frame.plates)
            heavy |= any(b.section is not None and b.section.nonstructural_mass for b in frame.beams)
            if used or heavy:
                raise InputError(
                    "no unit of mass beside the unit of length",
                    source=self.source or self.deck.source,
                    key="mass_unit",
                    expected='"1 t" for mm, N/mm^2 and t/mm^3, "1 kg" for m, Pa and kg/m^3; or neither of both, and '
                    "the materials tell",
                )
        found = UnitSystem(length or 1.0, mass or 1.0, 1.0, "as given")
        for one in used:
            if (one.young_modulus or 0.0) > 0.0 and (one.density or 0.0) > 0.0:
                try:
                    told = recognised_units([one], self.deck.source)
                except InputError:
                    continue
                # same lengths and masses in another time: kN and ms
                if np.allclose(told[:2], found[:2], rtol=1e-6):
                    return told
        return found

    def _material(self, index: int) -> Material:
        if index not in self.materials:
            self.materials[index] = self._made_material(index)
        return self.materials[index]

    def _made_material(self, index: int) -> Material:
        units = self.units
        found = DeckMaterial("") if index < 0 or self.ignore_material else self.deck.materials[index]
        if found.density is None and found.young_modulus is not None and "density" not in self.given:
            self.notes.append(f"material {found.name!r} has no density: what is made of it has no mass")
            found = replace(found, density=0.0)
        if found.young_modulus is not None:
            found = replace(found, young_modulus=found.young_modulus / units.time**2)
        self.notes += found.notes
        return material_of(
            found,
            self.given,
            source=self.source or self.deck.source,
            length_unit=units.length,
            mass_unit=units.mass,
        )

    # -- choice --

    def structure(self, elements: Sequence[str], part: int | None, merge_nodes: float | None) -> Structure:
        deck, frame = self.deck, self.frame
        if frame.refused:
            raise InputError(
                f"contains {'; '.join(frame.refused)}",
                source=deck.source,
                expected="plates (CQUAD4, S4), beams, solids, point masses and rigid elements that are read; see the "
                "table of entries in the guide on solids",
            )
        own = np.zeros(self.count, dtype=bool)
        own[deck.chosen(elements)] = True
        plates, beams = self._wished()
        solid = _solid_elements(deck, own)
        # elements without property carry groups of solids, unless other plates and beams have one
        groups = solid.any() and not any(
            own[one.index].any() and not one.loose for one in _parts(frame.plates, frame.beams)
        )
        plates = [one for one in plates if own[one.index].any() and not (groups and one.loose)]
        # plates without any property are a mesh: its lines are groups too
        mesh = bool(plates) and all(one.loose for one in _parts(frame.plates, frame.beams))
        beams = [
            one
            for one in beams
            if own[one.index].any() and not (one.loose and (groups or mesh or one.optional))
        ]
        taken = solid.copy()
        for one in _parts(plates, beams):
            taken[one.index] = own[one.index]
        self._refuse_others(own & ~taken, bool(solid.any()))
        rows = self._merged(own & taken, plates, beams, merge_nodes)
        if part is not None:
            taken = self._part(taken & own, plates, beams, rows, part)
        return self._structure(taken & own, plates, beams, rows)

    def _wished(self) -> tuple[list[DeckPlates], list[DeckBeams]]:
        """Plates and beams, those of groups that the case names apart."""
        plates, beams = list(self.frame.plates), list(self.frame.beams)
        for wishes, kind in ((self.plate_wishes, "plates"), (self.beam_wishes, "stiffeners")):
            for name in wishes:
                members = self._group(name, kind)
                parts: list[DeckPlates | DeckBeams] = list(plates if kind == "plates" else beams)
                split: list[DeckPlates | DeckBeams] = []
                for one in parts:
                    inside = members[one.index]
                    if inside.all():
                        split.append(replace(one, name=name, loose=False))
                    elif inside.any():
                        split += [some_elements(one, ~inside)]
                        split.append(replace(some_elements(one, inside), name=name, loose=False))
                    else:
                        split.append(one)
                if not any(one.name == name for one in split):
                    raise InputError(
                        f"group {name!r} has no {'plates' if kind == 'plates' else 'beams'}",
                        source=self.deck.source,
                        key=f"{kind}.{name}",
                        expected="a set of such elements",
                    )
                if kind == "plates":
                    plates = [one for one in split if isinstance(one, DeckPlates)]
                else:
                    beams = [one for one in split if isinstance(one, DeckBeams)]
        return plates, beams

    def _group(self, name: str, kind: str) -> NDArray[np.bool_]:
        known = {have.upper(): members for have, members in self.deck.element_sets.items()}
        if name.upper() not in known:
            listed = ", ".join(repr(have) for have in list(self.deck.element_sets)[:20])
            raise InputError(
                f"element set {name!r} does not exist",
                source=self.deck.source,
                key=f"{kind}.{name}",
                expected=f"one of {listed}" if listed else "a file with element sets",
            )
        members = np.zeros(self.count, dtype=bool)
        members[known[name.upper()]] = True
        return members

    def _refuse_others(self, others: NDArray[np.bool_], have_solids: bool) -> None:
        wrong = []
        for block, start in _blocks(self.deck):
            own = np.flatnonzero(others[start : start + len(block.labels)])
            # of meshes without properties: plates with middle nodes, where they are no groups of solids
            curved = not have_solids and re.fullmatch(r"'?(triangle[67]|quad[89])'?", block.name)
            if own.size and (curved or (not block.harmless and not self._is_loose(start + own))):
                wrong.append((block, own.size, block.labels[own[0]]))
            elif own.size and block.name.strip("'") in {"line", "T3D2", "B31", "CBAR"}:
                self.notes.append(f"left out: {own.size} lines without a section, which are groups")
            elif own.size and block.words and block.name not in self.frame.also:
                self.notes.append(f"left out: {own.size} {block.words} {block.name}")
        if wrong:
            words = ", ".join(f"{n} {block.words or 'cells'} {block.name}" for block, n, _ in wrong)
            raise InputError(
                f"contains {words} (first: element {wrong[0][2]})",
                source=self.deck.source,
                expected="plates of 3 and 4 nodes, beams, 8-node and 20-node bricks and 10-node tetrahedra; or choose "
                "with 'elements'",
            )

    def _is_loose(self, index: NDArray[np.int64]) -> bool:
        loose = np.zeros(self.count, dtype=bool)
        for one in _parts(self.frame.plates, self.frame.beams):
            loose[one.index] = one.loose
        return bool(loose[index].all())

    def _cells(
        self, taken: NDArray[np.bool_], plates: list[DeckPlates], beams: list[DeckBeams]
    ) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """Numbers and nodes of all elements that are taken."""
        cells = []
        for block, start in _blocks(self.deck):
            if block.kind:
                own = np.flatnonzero(taken[start : start + len(block.labels)])
                if own.size:
                    cells.append((start + own, block.nodes[own]))
        for one in _parts(plates, beams):
            inside = taken[one.index]
            if inside.any():
                cells.append((one.index[inside], one.nodes[inside]))
        return cells

    def _merged(
        self,
        taken: NDArray[np.bool_],
        plates: list[DeckPlates],
        beams: list[DeckBeams],
        distance: float | None,
    ) -> NDArray[np.int64]:
        """Row of the points that each node becomes: the lowest of its cluster."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components
        from scipy.spatial import cKDTree

        rows = np.arange(len(self.deck.points))
        if distance is None:
            return rows
        used = np.unique(np.concatenate([nodes.ravel() for _, nodes in self._cells(taken, plates, beams)]))
        pairs = cKDTree(self.deck.points[used]).query_pairs(
            distance / self.units.length, output_type="ndarray"
        )
        shape = (used.size, used.size)
        near = coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=shape)
        _, cluster = connected_components(near, directed=False)
        _, first = np.unique(cluster, return_index=True)
        rows[used] = used[first[cluster]]
        self.notes.append(f"{used.size - first.size} nodes joined with others within {distance:g} m")
        return rows

    def _part(
        self,
        taken: NDArray[np.bool_],
        plates: list[DeckPlates],
        beams: list[DeckBeams],
        rows: NDArray[np.int64],
        part: int,
    ) -> NDArray[np.bool_]:
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        pairs = [
            np.column_stack([np.repeat(rows[nodes[:, 0]], nodes.shape[1]), rows[nodes].ravel()])
            for _, nodes in self._cells(taken, plates, beams)
        ]
        pairs += [
            np.column_stack([np.full(len(link.dependent), link.node), link.dependent])
            for link in self.frame.links
        ]
        pairs += [np.array([[tie.node, tie.dependent]]) for tie in self.frame.ties]
        edges = np.concatenate(pairs)
        n = len(self.deck.points)
        graph = coo_array((np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), shape=(n, n))
        _, cluster = connected_components(graph, directed=False)
        of_element = np.full(self.count, -1, dtype=np.int64)
        for index, nodes in self._cells(taken, plates, beams):
            of_element[index] = cluster[rows[nodes[:, 0]]]
        found, first = np.unique(of_element[of_element >= 0], return_index=True)
        order = found[np.argsort(first)]
        if part > len(order):
            raise InputError(
                f"{part}",
                source=self.deck.source,
                key="part",
                expected=f"a number from 1 to {len(order)}"
                if len(order) > 1
                else "no part: there is one only",
            )
        return taken & (of_element == order[part - 1])

    # -- everything together --

    def _structure(
        self,
        taken: NDArray[np.bool_],
        plates: list[DeckPlates],
        beams: list[DeckBeams],
        rows: NDArray[np.int64],
    ) -> Structure:
        deck, frame, length = self.deck, self.frame, self.units.length
        cells = self._cells(taken, plates, beams)
        if not cells:
            there = ", ".join(f"{len(one.labels)} {one.words or 'cells'} {one.name}" for one in deck.blocks)
            raise InputError(
                f"contains {there or 'no element'}, of which none is taken",
                source=deck.source,
                expected="plates of 3 and 4 nodes, beams, 8-node and 20-node bricks or 10-node tetrahedra",
            )
        used = np.zeros(len(deck.points), dtype=bool)
        for _, nodes in cells:
            used[rows[nodes]] = True
        foreign = np.zeros(len(deck.points), dtype=bool)
        for one in _parts(frame.plates, frame.beams):
            foreign[rows[one.nodes[~taken[one.index]]]] = True
        for block, start in _blocks(deck):
            if block.kind:
                foreign[rows[block.nodes[~taken[start : start + len(block.labels)]]]] = True
        foreign &= ~used
        links, averages, ties = self._joined(rows, used, foreign)
        masses = self._hung(rows, used, foreign)
        new = np.full(len(deck.points), -1, dtype=np.int64)
        kept = np.flatnonzero(used)
        new[kept] = np.arange(kept.size)
        made = Structure(
            nodes=length * deck.points[kept],
            shells=tuple(
                self._shells(one, taken[one.index], new, rows) for one in plates if taken[one.index].any()
            ),
            beams=tuple(
                self._beams(one, taken[one.index], new, rows) for one in beams if taken[one.index].any()
            ),
            solids=self._solids(taken, new, rows),
            masses=tuple(replace(one, node=int(new[one.node])) for one in masses),
            links=tuple(replace(one, node=int(new[one.node]), dependent=new[one.dependent]) for one in links),
            averages=tuple(replace(one, node=int(new[one.node]), nodes=new[one.nodes]) for one in averages),
            ties=tuple(
                replace(one, node=int(new[one.node]), dependent=int(new[one.dependent])) for one in ties
            ),
            node_groups={
                name: np.unique(new[rows[members]][new[rows[members]] >= 0])
                for name, members in deck.node_sets.items()
                if (new[rows[members]] >= 0).any()
            },
            numbers=self._node_numbers(kept),
            name=str(deck.source),
        )
        return replace(made, notes=tuple(dict.fromkeys([*self.notes, *self._told(made)])))

    def _told(self, made: Structure) -> list[str]:
        parts = property_masses(made)
        total = sum(one.mass for one in parts)
        low, high = made.nodes.min(axis=0), made.nodes.max(axis=0)
        box = ", ".join(f"{axis} {low[k]:.6g} to {high[k]:.6g}" for k, axis in enumerate("xyz"))
        words = [f"units of the file: {self.units.name}; box {box} m"]
        if total > 0.0:
            centre = np.sum([one.mass * one.centre for one in parts], axis=0) / total
            at = ", ".join(f"{x:.6f}" for x in centre)
            words.append(f"mass {total:.7g} kg, centre ({at}) m")
            by_name: dict[str, float] = {}
            for one in parts:  # quadrilaterals and triangles of a property
                by_name[one.name] = by_name.get(one.name, 0.0) + one.mass
            shares = (f"{name} {mass:.6g} kg" for name, mass in by_name.items())
            words.append(f"mass by property: {', '.join(shares)}")
        return words

    def _node_numbers(self, kept: NDArray[np.int64]) -> NDArray[np.int64]:
        labels = [str(self.deck.node_labels[k]) for k in kept] if len(self.deck.node_labels) else []
        if not labels or not all(label.isdecimal() for label in labels):
            return np.empty(0, dtype=np.int64)
        return np.array([int(label) for label in labels], dtype=np.int64)

    def _element_numbers(self, index: NDArray[np.int64]) -> NDArray[np.int64]:
        labels = self.labels[index]
        if not all(str(label).isdecimal() for label in labels):
            return np.empty(0, dtype=np.int64)
        return np.array([int(label) for label in labels], dtype=np.int64)

    def _joined(
        self, rows: NDArray[np.int64], used: NDArray[np.bool_], foreign: NDArray[np.bool_]
    ) -> tuple[list[RigidLink], list[Average], list[Tie]]:
        """Rigid elements between nodes that are used; nodes that hang on them are used from then on."""
        links: list[RigidLink] = []
        averages: list[Average] = []
        ties: list[Tie] = []
        waiting: list[RigidLink | Average | Tie] = [
            *(
                replace(one, node=int(rows[one.node]), dependent=rows[one.dependent])
                for one in self.frame.links
            ),
            *(replace(one, node=int(rows[one.node]), nodes=rows[one.nodes]) for one in self.frame.averages),
            *(
                replace(one, node=int(rows[one.node]), dependent=int(rows[one.dependent]))
                for one in self.frame.ties
            ),
        ]
        apart = 0
        while waiting:
            later: list[RigidLink | Average | Tie] = []
            for one in waiting:
                others = np.atleast_1d(one.nodes if isinstance(one, Average) else one.dependent)
                if foreign[one.node] or foreign[others].all():
                    apart += 1
                    continue
                keep = ~foreign[others]
                if not used[one.node] and not used[others].any():
                    later.append(one)
                    continue
                used[one.node] = True
                used[others[keep]] = True
                if isinstance(one, RigidLink):
                    links.append(replace(one, dependent=others[keep]))
                elif isinstance(one, Average):
                    averages.append(replace(one, nodes=others[keep], weights=one.weights[keep]))
                else:
                    ties.append(one)
            if len(later) == len(waiting):
                first = later[0]
                raise InputError(
                    f"{first.name or 'a rigid element'} joins nodes of no element",
                    source=self.deck.source,
                    expected="rigid elements that hang on plates, beams or solids",
                )
            waiting = later
        if apart:
            self.notes.append(f"left out: {apart} rigid elements of other parts of the file")
        return links, averages, ties

    def _hung(
        self, rows: NDArray[np.int64], used: NDArray[np.bool_], foreign: NDArray[np.bool_]
    ) -> list[PointMass]:
        found = []
        units = self.units
        apart = 0
        for one in self.frame.masses:
            node = int(rows[one.node])
            if foreign[node]:
                apart += 1
                continue
            if not used[node]:
                raise InputError(
                    f"{one.name or 'a point mass'} of {one.mass:g} hangs on a node of no element",
                    source=self.deck.source,
                    expected="masses at nodes of plates, beams, solids or rigid elements",
                )
            found.append(
                replace(
                    one,
                    node=node,
                    mass=units.mass * one.mass,
                    offset=units.length * np.asarray(one.offset),
                    inertia=units.mass * units.length**2 * np.asarray(one.inertia),
                )
            )
        if apart:
            self.notes.append(f"left out: {apart} point masses of other parts of the file")
        return found

    def _solids(
        self, taken: NDArray[np.bool_], new: NDArray[np.int64], rows: NDArray[np.int64]
    ) -> tuple[Solids, ...]:
        found = []
        owner = self.deck.material_index
        for block, start in _blocks(self.deck):
            own = np.flatnonzero(taken[start : start + len(block.labels)])
            if not block.kind or not own.size:
                continue
            index = owner[start + own] if len(owner) else np.full(own.size, -1)
            for number in np.unique(index):
                some = own[index == number]
                name = self.deck.materials[number].name if number >= 0 else block.name
                found.append(
                    Solids(
                        name=f"{block.name} {name}".strip(),
                        elements=new[rows[block.nodes[some]]],
                        element_type=block.kind,
                        material=self._material(int(number)),
                        numbers=self._element_numbers(start + some),
                    )
                )
        return tuple(found)

    def _fail(
        self, one: DeckPlates | DeckBeams, index: int, problem: str, key: str, expected: str
    ) -> InputError:
        return InputError(
            f"{one.name}: {problem} (element {self.labels[index]})",
            source=one.file or self.deck.source,
            key=one.place or key,
            expected=expected,
        )

    def _shells(
        self, one: DeckPlates, own: NDArray[np.bool_], new: NDArray[np.int64], rows: NDArray[np.int64]
    ) -> Shells:
        wish = self.plate_wishes.get(one.name, PlateProperty())
        units = self.units
        t = units.length * one.thickness[own]
        if wish.thickness is not None:
            t = np.full(t.size, wish.thickness)
        bad = np.flatnonzero(~(t > 0.0))
        if bad.size:
            raise self._fail(
                one,
                int(one.index[own][bad[0]]),
                "no thickness" if np.isnan(t[bad[0]]) else f"thickness {t[bad[0]]:g}",
                f"plates.{one.name}.thickness",
                f"a property with a thickness, or plates.{one.name!r}.thickness in the case",
            )
        offset = units.length * one.offset[own]
        if wish.offset is not None:
            offset = np.full(t.size, wish.offset)
        nsm = units.mass / units.length**2 * one.nonstructural_mass
        nodes = new[rows[one.nodes[own]]]
        twice = np.flatnonzero((np.diff(np.sort(nodes, axis=1), axis=1) == 0).any(axis=1))
        if twice.size:
            raise self._fail(
                one,
                int(one.index[own][twice[0]]),
                "has a node twice: a collapsed element",
                "elements",
                "plates whose nodes are all different",
            )
        return Shells(
            name=one.name,
            elements=nodes,
            material=wish.material or self._material(one.material),
            thickness=t,
            offset=offset,
            nonstructural_mass=nsm if wish.nonstructural_mass is None else wish.nonstructural_mass,
            bends=one.bends,
            stretches=one.stretches,
            bending_factor=one.bending_factor,
            shear_factor=one.shear_factor,
            numbers=self._element_numbers(one.index[own]),
        )

    def _beams(
        self, one: DeckBeams, own: NDArray[np.bool_], new: NDArray[np.int64], rows: NDArray[np.int64]
    ) -> Beams:
        wish = self.beam_wishes.get(one.name, BeamProperty())
        section = wish.section or (None if one.section is None else _scaled(one.section, self.units))
        first = int(one.index[own][0])
        if section is None:
            raise self._fail(
                one,
                first,
                "no section",
                f"stiffeners.{one.name}.section",
                f"a property of beams, or stiffeners.{one.name!r}.section in the case",
            )
        orientation = one.orientation[own]
        if wish.orientation is not None:
            orientation = np.tile(np.asarray(wish.orientation, dtype=np.float64), (own.sum(), 1))
        missing = np.flatnonzero(np.isnan(orientation).any(axis=1))
        if missing.size:
            raise self._fail(
                one,
                int(one.index[own][missing[0]]),
                "no orientation",
                f"stiffeners.{one.name}.web",
                f"a vector across the beam, or stiffeners.{one.name!r}.web in the case",
            )
        ends = one.nodes[own]
        a, b = self.units.length * one.offset_a[own], self.units.length * one.offset_b[own]
        released = one.released[own]
        if wish.flange is not None:
            line = self.deck.points[ends[:, 1]] - self.deck.points[ends[:, 0]]
            turned = np.cross(line, orientation) @ np.asarray(wish.flange) < 0.0
            ends = np.where(turned[:, None], ends[:, ::-1], ends)
            a, b = np.where(turned[:, None], b, a), np.where(turned[:, None], a, b)
            released = np.where(turned[:, None], np.roll(released, 6, axis=1), released)
        line = self.units.length * (self.deck.points[ends[:, 1]] - self.deck.points[ends[:, 0]])
        if wish.offset is not None:
            third = np.cross(line, orientation)
            second = np.cross(third, line)
            lengths = [np.maximum(np.linalg.norm(one, axis=1), 1e-300)[:, None] for one in (second, third)]
            a = b = wish.offset[0] * second / lengths[0] + wish.offset[1] * third / lengths[1]
        along = line + b - a
        size = np.linalg.norm(along, axis=1)
        across = np.linalg.norm(np.cross(along, orientation), axis=1)
        wrong = np.flatnonzero(~(across > 1e-3 * size * np.linalg.norm(orientation, axis=1)))
        if wrong.size:
            v = orientation[wrong[0]]
            raise self._fail(
                one,
                int(one.index[own][wrong[0]]),
                f"orientation ({v[0]:g}, {v[1]:g}, {v[2]:g}) along the beam"
                if size[wrong[0]]
                else "no length",
                f"stiffeners.{one.name}.web",
                "a vector across the beam",
            )
        return Beams(
            name=one.name,
            elements=new[rows[ends]],
            material=wish.material or self._material(one.material),
            section=section,
            orientation=orientation,
            offset_a=a,
            offset_b=b,
            released=released,
            numbers=self._element_numbers(one.index[own]),
        )


def _scaled(section: BeamSection, units: UnitSystem) -> BeamSection:
    """Section in SI units."""
    s = units.length
    return replace(
        section,
        area=s**2 * section.area,
        second_moment_1=s**4 * section.second_moment_1,
        second_moment_2=s**4 * section.second_moment_2,
        torsion=s**4 * section.torsion,
        product=s**4 * section.product,
        shear_area_1=s**2 * section.shear_area_1,
        shear_area_2=s**2 * section.shear_area_2,
        shear_centre=(s * section.shear_centre[0], s * section.shear_centre[1]),
        nonstructural_mass=units.mass / s * section.nonstructural_mass,
        corners=s * section.corners,
    )


# ---- mass by property ----


class PropertyMass(NamedTuple):
    """Mass [kg] and centre [m] of what has one property."""

    name: str
    mass: float
    centre: NDArray[np.float64]


def property_masses(structure: Structure) -> list[PropertyMass]:
    """Mass and centre by property, without an assembly: what a deck is compared with other programs by.

    Plates count with their area in the plane of their diagonals, solids with their volume, beams with their length
    between the ends of offsets; offsets move centres.
    """
    from heavylift.preprocess.finite_elements.mesh import Mesh

    x = structure.nodes
    found = []
    for shell in structure.shells:
        corners = x[shell.elements]
        if corners.shape[1] == 4:
            normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
            middle = _quad_centres(corners)
        else:
            normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            middle = corners.mean(axis=1)
        area = 0.5 * np.linalg.norm(normal, axis=1)
        unit = normal / np.maximum(2.0 * area, 1e-300)[:, None]
        thickness = np.broadcast_to(shell.thickness, area.shape)
        offset = np.broadcast_to(shell.offset, area.shape)
        mass = area * (shell.material.density * thickness + shell.nonstructural_mass)
        found.append(_sum(shell.name, mass, middle + offset[:, None] * unit))
    for beam in structure.beams:
        a, b = (
            x[beam.elements[:, k]] + np.broadcast_to(off, (len(beam.elements), 3))
            for k, off in ((0, beam.offset_a), (1, beam.offset_b))
        )
        per_length = beam.material.density * beam.section.area + beam.section.nonstructural_mass
        found.append(_sum(beam.name, per_length * np.linalg.norm(b - a, axis=1), 0.5 * (a + b)))
    for solid in structure.solids:
        mesh = Mesh(x, solid.elements, solid.element_type, name=structure.name)
        mass = solid.material.density * mesh.element_volumes()
        corners = x[solid.elements[:, : 4 if solid.element_type == "tet10" else 8]]
        found.append(_sum(solid.name, mass, corners.mean(axis=1)))
    if structure.masses:
        mass = np.array([one.mass for one in structure.masses])
        places = np.array([x[one.node] + one.offset for one in structure.masses])
        found.append(_sum("point masses", mass, places))
    return found


def _quad_centres(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Centres of area of flat quadrilaterals, shape (ne, 3)."""
    halves = []
    for i, j, k in ((0, 1, 2), (0, 2, 3)):
        normal = np.cross(corners[:, j] - corners[:, i], corners[:, k] - corners[:, i])
        halves.append((np.linalg.norm(normal, axis=1), corners[:, [i, j, k]].mean(axis=1)))
    (a, p), (b, q) = halves
    centres: NDArray[np.float64] = (a[:, None] * p + b[:, None] * q) / np.maximum(a + b, 1e-300)[:, None]
    return centres


def _sum(name: str, mass: NDArray[np.float64], places: NDArray[np.float64]) -> PropertyMass:
    total = float(mass.sum())
    weights = mass if total else np.ones(len(mass))
    return PropertyMass(name, total, np.average(places, axis=0, weights=weights))
