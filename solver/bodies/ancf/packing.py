"""Frames or shells of a scene become the arrays of one kind: nodes, elements, structure of the factor, start state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import field
from functools import lru_cache
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.block_pattern import BlockPattern, pack_blocks
from heavylift.numerics.classes import dataclass
from heavylift.numerics.lanes import block_shape
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, filled, filled_rows, records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.numerics.small import aligned
from heavylift.solver.bodies.ancf.at_rest import prepare_mass
from heavylift.solver.bodies.ancf.bases import Bases, plan_bases
from heavylift.solver.bodies.ancf.frame_data import FrameFollower
from heavylift.solver.bodies.ancf.kind import (
    AUTO,
    CARRIED,
    CLEAR_DIAGONAL,
    CLEAR_LANE,
    CLEAR_ROW,
    DEAD_LOAD,
    ENERGY_MOMENTUM,
    EXPLICIT,
    FOLLOWER_ELEMENT,
    FOLLOWER_NODE,
    NODAL_VECTORS,
    STRAIN_VECTORS,
    BaseBlock,
    FixedCoordinate,
    MeshBase,
    MeshElement,
    Meshes,
    MeshLoad,
    MeshMarker,
    MeshNumbers,
    MeshPlaces,
    MeshSensor,
    MovingPoint,
    MovingPoints,
    PointsOfBody,
)
from heavylift.solver.bodies.ancf.mesh_contour import control_vectors
from heavylift.solver.bodies.ancf.types import MeshType, type_of
from heavylift.solver.body_places import BodyPlaces
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.recording import placed
from heavylift.solver.scene.meshes import (
    DistributedLoad,
    DriftOutputs,
    FollowerLoad,
    FrameBody,
    MeshBody,
    RodBody,
)
from heavylift.solver.scene.outputs import Columns

__all__ = [
    "LoadBook",
    "base_blocks",
    "block_ranges",
    "check_mesh",
    "clears",
    "mass_and_inertia",
    "mesh_columns",
    "pack",
    "pack_meshes",
    "pack_moving",
    "point_count",
]


# ---- loads: dead ones as nodal vectors, followers element by element ----


@dataclass
class LoadBook:
    """Rows of the loads of all bodies of a kind; `store` appends to its constants."""

    store: Callable[[NDArray[np.float64]], int]
    rows: list[MeshLoad] = field(default_factory=list)

    def table(self) -> Records[MeshLoad]:
        """All rows."""
        return records(MeshLoad, self.rows)

    def add(
        self,
        body: MeshBody,
        load: DistributedLoad | FollowerLoad,
        rotation: NDArray[np.float64],
        first_node: int,
        first_element: int,
        lanes: int,
    ) -> None:
        """Append a load.

        Parameters
        ----------
        body, load
            What is loaded.
        rotation
            Axes of the body as columns, shape (3, 3).
        first_node, first_element
            Of the body in the kind.
        lanes
            Places of a node.

        Raises
        ------
        InputError
            If a table, an element, a node or an axis does not fit.
        """
        times = np.atleast_1d(np.asarray(load.times, dtype=np.float64))
        factors = np.atleast_1d(np.asarray(load.factors, dtype=np.float64))
        if times.shape != factors.shape or len(times) == 0 or not np.all(np.diff(times) > 0.0):
            raise InputError(
                f"{len(times)} times and {len(factors)} factors",
                source=body.name,
                key="loads",
                expected="one factor a time, times increasing",
            )
        count = len(body.elements)  # type: ignore[attr-defined]
        chosen = np.arange(count) if load.elements is None else np.atleast_1d(np.asarray(load.elements))
        if not (np.all(chosen >= 0) and np.all(chosen < count)):
            raise InputError(
                f"elements {chosen.tolist()}",
                source=body.name,
                key="loads",
                expected=f"numbers from 0 to {count - 1}",
            )
        table = self.store(np.concatenate([times, factors]))
        if isinstance(load, DistributedLoad):
            data = self.store(_dead_load(body, load, rotation, chosen, lanes))
            self._add(DEAD_LOAD, data, table, times, [first_node * lanes])
            return
        if not isinstance(body, FrameBody):
            if load.tangential != 0.0 or load.node is not None:
                raise InputError(
                    "a tangential load or a node",
                    source=body.name,
                    key="loads",
                    expected="a pressure: on a shell a follower acts along the normal",
                )
            data = self.store(np.array([load.normal]))
            self._add(FOLLOWER_ELEMENT, data, table, times, first_element + chosen)
            return
        axis = rotation.T @ np.asarray(load.axis, dtype=np.float64)
        length = float(np.linalg.norm(axis))
        if load.normal != 0.0 and not 0.0 < length < np.inf:
            raise InputError(
                f"axis {np.asarray(load.axis).tolist()}",
                source=body.name,
                key="loads",
                expected="a direction that is not zero",
            )
        given = FrameFollower.one()
        given.normal, given.tangential, given.axis = load.normal, load.tangential, axis / (length or 1.0)
        data = self.store(given.words.copy())
        if load.node is None:
            self._add(FOLLOWER_ELEMENT, data, table, times, first_element + chosen)
            return
        if not 0 <= load.node < len(body.nodes):
            raise InputError(
                f"node {load.node}",
                source=body.name,
                key="loads",
                expected=f"a number from 0 to {len(body.nodes) - 1}",
            )
        self._add(FOLLOWER_NODE, data, table, times, [(first_node + load.node) * lanes])

    def _add(
        self, of_type: int, data: int, table: int, times: NDArray[np.float64], places: Iterable[int]
    ) -> None:
        """Rows of a load, one a place."""
        self.rows += [
            filled(MeshLoad, type=of_type, data=data, table=table, table_length=len(times), place=place)
            for place in places
        ]


def _dead_load(
    body: MeshBody,
    load: DistributedLoad,
    rotation: NDArray[np.float64],
    elements: NDArray[np.int64],
    lanes: int,
) -> NDArray[np.float64]:
    """Consistent nodal forces in body axes, flat over the places of the nodes of the body."""
    of_type = type_of(body)
    vectors = len(of_type.vectors)
    force = rotation.T @ np.asarray(load.load, dtype=np.float64)
    nodal = np.zeros((len(body.nodes), lanes))
    for element in elements:
        shape = np.asarray(of_type.load_shape(body, int(element))).reshape(-1, vectors)
        for node, values in zip(body.elements[element], shape, strict=True):  # type: ignore[attr-defined]
            nodal[node, : 3 * vectors] += np.outer(values, force).ravel()
    return nodal.ravel()


# ---- moving points, and what the control points of their shape are made of ----


def pack_moving(
    bodies: Sequence[MeshBody], table: Records[MeshPlaces], pattern: BlockPattern, lanes: int, per_node: int
) -> MovingPoints:
    """All moving points of a kind of meshes, none of them aimed at anything.

    Parameters
    ----------
    bodies, table
        Bodies, and their rows in the table of the kind.
    pattern
        Of the factor.
    lanes, per_node
        Places and vectors of a node.

    Raises
    ------
    InputError
        If a body with moving points is no line and no rectangle of elements.
    """
    rows = records(PointsOfBody, len(bodies))
    points: list[MovingPoint] = []
    places: list[NDArray[np.int64]] = []
    factors: list[NDArray[np.float64]] = []
    entries = vectors = paths = compliance = controls = count = 0
    for row, body, line in zip(rows, bodies, table, strict=True):
        moving = int(line.moving_count)
        row.first_point, row.compliance, row.first_control = count, compliance, controls
        if moving == 0:
            continue
        entries_each = int(line.node_count) * per_node
        vectors_each = 3 * int(line.node_count + line.base_node_count) * lanes
        path_each = int(line.last_column - line.first_column)
        for _ in range(moving):
            points.append(
                filled(
                    MovingPoint,
                    first_entry=entries,
                    entry_count=0,
                    vectors=vectors,
                    path=paths,
                    path_count=0,
                    live=False,
                    current_set=-1,
                    fresh=False,
                )
            )
            entries, vectors, paths = entries + entries_each, vectors + vectors_each, paths + path_each
        compliance += (3 * moving) ** 2
        count += moving
        made = control_vectors(body)
        node, vector = made.vectors // per_node, made.vectors % per_node
        places.append((line.first_node + node) * lanes + 3 * vector)
        factors.append(made.factors)
        controls += len(made.factors)
    nodes = int((table["node_count"] + table["base_node_count"]).sum())
    column_of = np.full(nodes, -1, dtype=np.int64)
    column_of[pattern.columns["node"]] = np.arange(len(pattern.columns))
    return MovingPoints(
        bodies=rows,
        points=records(MovingPoint, points),
        entries=np.zeros(entries, dtype=np.int64),
        factors=np.zeros(entries),
        vectors=aligned(vectors),
        paths=np.zeros(paths, dtype=np.int64),
        compliance=np.zeros(compliance),
        column_of=column_of,
        marks=np.zeros(nodes, dtype=np.int64),
        control_places=np.vstack([np.zeros((0, 4), dtype=np.int64), *places]),
        control_factors=np.vstack([np.zeros((0, 4)), *factors]),
    )


# ---- where things are in the blocks of the factor ----


ALL_PARTS = (CLEAR_ROW, CLEAR_LANE, CLEAR_DIAGONAL)


def clears(
    pattern: BlockPattern, free: NDArray[np.float64], edges: NDArray[np.int64], groups: NDArray[np.int64]
) -> tuple[Records[FixedCoordinate], NDArray[np.int64]]:
    """Which row or lane of which block is a fixed coordinate, in the order of bodies; their number by body."""
    fixed = free == 0.0
    rows: list[tuple[int, int, int, int]] = []
    on_node: dict[int, list[int]] = {}
    for a, b in edges:
        on_node.setdefault(int(a), []).append(int(b))
        on_node.setdefault(int(b), []).append(int(a))
    base = ~np.isin(np.arange(len(free)), pattern.columns["node"])
    for node in np.flatnonzero(fixed.any(axis=1) & ~base):
        coordinates = np.flatnonzero(fixed[node])
        own, _ = pattern.place(int(node), int(node))
        for other in on_node.get(int(node), []):
            place, earlier = pattern.place(int(node), other)
            part = CLEAR_ROW if earlier else CLEAR_LANE
            rows += [(int(groups[node]), place, part, int(c)) for c in coordinates]
        for c in coordinates:
            rows += [(int(groups[node]), own, part, int(c)) for part in ALL_PARTS]
    rows.sort(key=lambda row: (row[0], row[2] == CLEAR_DIAGONAL))
    counts = np.bincount([row[0] for row in rows], minlength=int(groups.max()) + 1)
    _, blocks, parts, indices = np.array(rows, dtype=np.int64).reshape(-1, 4).T
    return filled_rows(FixedCoordinate, block=blocks, part=parts, index=indices), counts


def base_blocks(pattern: BlockPattern, table: Records[MeshPlaces]) -> Records[BaseBlock]:
    """Body, later base node, earlier one (counted within the body) and place of the blocks of bases, by body."""
    rows = []
    for body, line in enumerate(table):
        first, count = int(line.first_node + line.node_count), int(line.base_node_count)
        rows += [
            filled(BaseBlock, body=body, later=i, earlier=j, place=pattern.place(first + i, first + j)[0])
            for i in range(count)
            for j in range(i + 1)
        ]
    return records(BaseBlock, rows)


def block_ranges(
    pattern: BlockPattern, groups: NDArray[np.int64], base_blocks: Records[BaseBlock], size: int
) -> NDArray[np.int64]:
    """First place and the one behind the last of the blocks of each body, shape (bodies, 2)."""
    of_column = groups[pattern.columns["node"]]
    counts = pattern.columns["lower_count"]
    places = np.concatenate([pattern.columns["pivot"], pattern.lower["place"], base_blocks["place"]])
    owners = np.concatenate([of_column, np.repeat(of_column, counts), base_blocks["body"]])
    ranges = np.array(
        [[places[owners == g].min(), places[owners == g].max() + size] for g in np.unique(groups)]
    )
    if np.any(ranges[1:, 0] < ranges[:-1, 1]):
        raise AssertionError("blocks of bodies overlap")
    return ranges.astype(np.int64)


# ---- the kind ----


SCHEMES = {"carried": CARRIED, "energy-momentum": ENERGY_MOMENTUM, "auto": AUTO, "explicit": EXPLICIT}
SETS = 3


def check_mesh(body: MeshBody) -> None:
    """Refuse a body that cannot be packed.

    Raises
    ------
    InputError
        Names the body, the key, the value and what was expected.
    """
    if body.elasticity not in SCHEMES:
        raise InputError(
            f"{body.elasticity!r}", source=body.name, key="elasticity", expected=" or ".join(SCHEMES)
        )
    for key in ("viscous_damping", "stiffness_damping", "drift_tolerance"):
        value = getattr(body, key)
        if not 0.0 <= value < np.inf or (key == "drift_tolerance" and value == 0.0):
            raise InputError(f"{value}", source=body.name, key=key, expected="a finite number, 0 or more")
    type_of(body).check(body)


@lru_cache(maxsize=64)
def _start(body: MeshBody) -> NDArray[np.float64]:
    return np.asarray(type_of(body).start_coordinates(body), dtype=np.float64)


def mass_and_inertia(body: MeshBody) -> tuple[float, float]:
    """Mass [kg] and largest moment of inertia [kg m2] about the centre of mass of the given shape."""
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    of_type, start = type_of(body), _start(body)
    for data, nodes in zip(of_type.element_data(body), body.elements, strict=True):  # type: ignore[attr-defined]
        x = start[nodes].reshape(-1, 3)
        M = np.asarray(data[: len(x) ** 2]).reshape(len(x), len(x))
        unit = np.zeros(len(x))
        unit[:: len(of_type.vectors)] = 1.0
        mass += unit @ M @ unit
        first += unit @ M @ x
        second += x.T @ M @ x
    second -= np.outer(first, first) / mass
    return float(mass), float(np.linalg.eigvalsh(np.trace(second) * np.eye(3) - second)[2])


def point_count(body: MeshBody, markers: BodyMarkers) -> int:
    """Bases that some markers on a body take."""
    return len(plan_bases(body, markers).bases)


def mesh_columns(body: MeshBody) -> dict[str, tuple[str, ...]]:
    """Components of the channels of a body: of nodal vectors and velocities by node, of results by element."""
    of_type = type_of(body)
    parts = tuple(f"{node}.{axis}" for node in range(len(body.nodes)) for axis in "xyz")
    return dict.fromkeys((*of_type.vectors, "velocity"), parts) | of_type.result_columns(body)


class _Builder:
    """Collects the arrays of one kind, body by body."""

    def __init__(self, of_type: MeshType, bodies: int) -> None:
        self.type = of_type
        self.shape = block_shape(of_type.rows)
        self.lanes = len(self.shape[1])
        self.per_node = len(of_type.vectors)
        self.body_count = 0
        self.table: Records[MeshPlaces] = records(of_type.places, bodies)
        self.body = records(MeshNumbers, bodies)
        self.elements: list[Records[MeshElement]] = []
        self.constants: list[NDArray[np.float64]] = []
        self.constant_count = 0
        self.node_count = 0
        self.strain_count = 0
        self.edges: list[NDArray[np.int64]] = []
        self.last: list[list[int]] = []
        self.coordinates: list[NDArray[np.float64]] = []
        self.start: list[NDArray[np.float64]] = []
        self.speed: list[NDArray[np.float64]] = []
        self.bases: list[MeshBase] = []
        self.markers: list[MeshMarker] = []
        self.sensors: list[MeshSensor] = []
        self.free: list[NDArray[np.float64]] = []
        self.loads = LoadBook(self.store)
        self.moving_count = 0

    def store(self, values: NDArray[np.float64]) -> int:
        """Append to the constants; returns the place."""
        place = self.constant_count
        self.constants.append(np.asarray(values, dtype=np.float64).ravel())
        self.constant_count += len(self.constants[-1])
        return place

    def store_each(self, blocks: Sequence[NDArray[np.float64]]) -> list[int]:
        """Append blocks, each array once; returns the place of each."""
        places: dict[int, int] = {}
        for block in blocks:
            if id(block) not in places:
                places[id(block)] = self.store(block)
        return [places[id(block)] for block in blocks]

    def add(
        self,
        body: MeshBody,
        number: int,
        dof: int,
        columns: Columns,
        bases: Bases,
        sensors: BodyMarkers,
        moving: int = 0,
    ) -> None:
        """Append one body."""
        row, nodes, first_node = self.body_count, len(body.nodes), self.node_count
        base_nodes = -(-len(bases.bases) // self.per_node)
        first_element, count = sum(map(len, self.elements)), len(body.elements)  # type: ignore[attr-defined]
        strains = np.asarray(self.type.strain_counts(body), dtype=np.int64)
        places = self.store_each(self.type.element_data(body))
        elements = records(self.type.element, count)
        global_nodes = first_node + np.asarray(body.elements, dtype=np.int64)  # type: ignore[attr-defined]
        elements["nodes"][:, : self.type.nodes_per_element] = global_nodes * self.lanes
        elements["data"] = places
        elements["strain"] = self.strain_count + np.cumsum(strains) - strains
        self.elements.append(elements)
        self.edges += [global_nodes[:, list(pair)] for pair in self.type.pairs if pair[0] != pair[1]]

        first_base_node, first_base = first_node + nodes, len(self.bases)
        for i, base in enumerate(bases.bases):
            node, slot = first_base_node + i // self.per_node, i % self.per_node
            place = node * self.lanes + 3 * slot
            self.bases.append(
                filled(
                    MeshBase,
                    element=first_element + base.element,
                    shape_values=self.store(base.shape),
                    place=place,
                    blocks=0,
                )
            )
            own = global_nodes[base.element]
            self.edges.append(np.column_stack([np.full(len(own), node), own]))
        for moved in range(self.moving_count, self.moving_count + moving):
            place = 3 * moved  # behind all nodes, whose number is not known yet
            self.bases.append(filled(MeshBase, element=-1, shape_values=0, place=place, blocks=0))
        self.moving_count += moving
        self.last.append(list(range(first_base_node, first_base_node + base_nodes)))
        for entry in bases.entries:
            self.markers.append(
                filled(
                    MeshMarker,
                    number=entry.number,
                    body=row,
                    base=first_base + entry.base,
                    type=entry.type,
                    data=self.store(entry.data),
                    level=entry.level,
                )
            )
        for target, point in zip(sensors.numbers, sensors.vectors, strict=True):
            element, local = self.type.locate(body, point, body.name, "sensor")
            shape = self.type.shape_values(body, element, local, 0)
            self.sensors.append(
                filled(
                    MeshSensor,
                    column=target,
                    body=row,
                    element=first_element + element,
                    shape_values=self.store(shape),
                )
            )

        start = _start(body)
        rotation = rotation_matrix(np.asarray(body.orientation, dtype=np.float64))
        spin = np.asarray(body.angular_velocity, dtype=np.float64)
        speed = np.cross(spin, start)
        speed[:, 0] += rotation.T @ np.asarray(body.velocity, dtype=np.float64)
        free = _free(body, self.type)
        speed *= free
        pad = ((0, base_nodes), (0, 0))
        for rows, values in ((self.start, start), (self.speed, speed), (self.free, free)):
            rows.append(np.pad(values.reshape(nodes, -1), pad))
        middle = start[:, 0].mean(axis=0)
        self.coordinates.append(np.vstack([start[:, 0], np.tile(middle, (base_nodes, 1))]))

        first_load = len(self.loads.rows)
        for load in body.loads:
            self.loads.add(body, load, rotation, first_node, first_element, self.lanes)
        mass, _ = mass_and_inertia(body)
        numbers, line = self.body[row], self.table[row]
        numbers.rotation[:] = rotation
        numbers.origin[:] = body.position
        numbers.viscous_damping, numbers.stiffness_damping = body.viscous_damping, body.stiffness_damping
        numbers.drift_tolerance, numbers.mass = body.drift_tolerance, mass
        numbers.size = float(np.linalg.norm(np.ptp(body.nodes, axis=0)))
        line.number, line.dof = number, dof
        line.drift = columns.at(DriftOutputs)
        self.table["parts"][row] = placed(self.type.outputs, columns)
        line.first_node, line.node_count, line.base_node_count = first_node, nodes, base_nodes
        line.first_element, line.element_count = first_element, count
        line.first_base, line.base_count, line.moving_count = first_base, len(bases.bases), moving
        line.first_load, line.load_count = first_load, len(self.loads.rows) - first_load
        line.first_strain, line.strain_count = self.strain_count, int(strains.sum())
        line.scheme = SCHEMES[body.elasticity]
        line.constants = self.store(self.type.body_constants(body))
        line.base_step = self.store(np.full(1, -1.0))
        self.body_count += 1
        self.node_count += nodes + base_nodes
        self.strain_count += int(strains.sum())

    def finish(self, bodies: Sequence[MeshBody]) -> Meshes:
        """Order the nodes and make the arrays."""
        table = self.table
        edges = np.unique(np.sort(np.vstack(self.edges), axis=1), axis=0)
        edges = edges[edges[:, 0] != edges[:, 1]]
        groups = np.repeat(np.arange(len(table)), table["node_count"] + table["base_node_count"])
        pattern = pack_blocks(
            self.node_count,
            edges,
            self.type.rows,
            last=self.last,
            groups=groups,
            coordinates=np.vstack(self.coordinates),
        )
        table["first_column"], table["last_column"] = pattern.ranges.T
        elements = records(self.type.element, sum(map(len, self.elements)))
        first = 0
        for part in self.elements:
            elements[first : first + len(part)] = part
            first += len(part)
        for p, (i, j) in enumerate(self.type.pairs):
            a, b = elements["nodes"][:, i] // self.lanes, elements["nodes"][:, j] // self.lanes
            elements["blocks"][:, p, 0], elements["blocks"][:, p, 1] = pattern.places(a, b)
        free = np.vstack(self.free)
        fixed, counts = clears(pattern, free, edges, groups)
        table["clear_count"] = counts
        table["first_clear"] = np.cumsum(counts) - counts
        compliance_blocks = base_blocks(pattern, table)
        table["work_place"] = pattern.scratch
        table["first_block"], table["last_block"] = block_ranges(
            pattern, groups, compliance_blocks, len(self.shape[0]) * self.lanes
        ).T
        moving_nodes = -(-3 * self.moving_count // self.lanes)
        places = (self.node_count + moving_nodes) * self.lanes
        nodal = {name: aligned(places) for name in NODAL_VECTORS}
        for name, values in (("position", self.start), ("velocity", self.speed), ("free", self.free)):
            at_nodes = nodal[name][: self.node_count * self.lanes].reshape(self.node_count, self.lanes)
            at_nodes[:, : self.type.rows] = np.vstack(values)
        kind = self.type.kind(
            table=table,
            elements=elements,
            constants=np.concatenate(self.constants),
            body=self.body,
            **nodal,
            **{name: aligned(self.strain_count) for name in STRAIN_VECTORS},
            columns=pattern.columns,
            lower=pattern.lower,
            updates=pattern.updates,
            blocks=aligned(SETS * pattern.size),
            clears=fixed,
            base_blocks=compliance_blocks,
            bases=self._based(pattern, elements),
            markers=_sorted(self.markers),
            sensors=records(MeshSensor, self.sensors),
            loads=self.loads.table(),
            moving=pack_moving(bodies, table, pattern, self.lanes, self.per_node),
        )
        _weigh(kind)
        return kind

    def _based(self, pattern: BlockPattern, elements: Records[MeshElement]) -> Records[MeshBase]:
        """Rows of `bases`, with the blocks that couple them with the nodes of their elements."""
        bases = records(MeshBase, self.bases)
        element, place = bases["element"], bases["place"]
        fixed = element >= 0
        place[~fixed] += self.node_count * self.lanes
        for i in range(self.type.nodes_per_element):
            nodes = elements["nodes"][element[fixed], i] // self.lanes
            bases["blocks"][fixed, i] = pattern.places(place[fixed] // self.lanes, nodes)[0]
        return bases


def _free(body: MeshBody, of_type: MeshType) -> NDArray[np.float64]:
    """1 for free coordinates, 0 for fixed ones, shape (n, vectors, 3)."""
    free = np.ones((len(body.nodes), len(of_type.vectors), 3))
    for support in body.supports:
        for vector, axes in support.fixed.items():
            for axis in axes:
                free[np.asarray(support.nodes), of_type.vectors.index(vector), "xyz".index(axis)] = 0.0
    return free


def _sorted(markers: list[MeshMarker]) -> Records[MeshMarker]:
    return records(MeshMarker, sorted(markers, key=attrgetter("level")))


def _weigh(kind: Meshes) -> None:
    """`nodal_mass`: the mass matrix times a unit acceleration along all three axes."""
    lanes = len(kind.shape[1])
    nodes, vectors = len(kind.ends), len(kind.shape[0]) // 3
    weight = kind.nodal_mass
    for element in kind.elements:
        count = nodes * vectors
        M = kind.constants[element.data : element.data + count * count].reshape(count, count)
        force = M[:, ::vectors].sum(axis=1)
        for i in range(nodes):
            for a in range(vectors):
                place = element.nodes[i] + 3 * a
                weight[place : place + 3] += force[i * vectors + a]
    assert weight.shape[0] % lanes == 0


def pack(bodies: Sequence[MeshBody], places: BodyPlaces) -> Meshes:
    """Make the kind of some frames or shells of a scene, see `pack_meshes`."""
    return pack_meshes(
        bodies,
        places.number,
        places.dofs,
        places.columns,
        places.markers,
        places.sensors,
        places.moving,
    )


def pack_meshes(
    bodies: Sequence[MeshBody],
    first_number: int,
    dofs: Sequence[int],
    columns: Sequence[Columns],
    markers: Sequence[BodyMarkers],
    sensors: Sequence[BodyMarkers],
    moving: Sequence[int] = (),
) -> Meshes:
    """Make a kind of all frames or all shells of a scene.

    Parameters
    ----------
    bodies
        Of one type, checked.
    first_number
        Number of the first of them in the scene; the others follow.
    dofs
        First velocity of each in the workspace.
    columns
        Where each is in a record.
    markers, sensors
        On each.
    moving
        Number of moving points of each; none if empty.

    Raises
    ------
    InputError
        If a marker, sensor or load does not fit its body, or a body with moving points is no line and no rectangle of
        elements.
    """
    for body, count in zip(bodies, moving, strict=False):
        if count and isinstance(body, RodBody):
            raise InputError(
                "something touches a frame with torsion",
                source=body.name,
                expected="a frame without torsion: contacts push at points of an axis, which does not turn with them",
            )
    builder = _Builder(type_of(bodies[0]), len(bodies))
    counts = moving or (0,) * len(bodies)
    for i, (body, dof, place, on_body, watched, count) in enumerate(
        zip(bodies, dofs, columns, markers, sensors, counts, strict=True)
    ):
        builder.add(body, first_number + i, dof, place, plan_bases(body, on_body), watched, count)
    kind = builder.finish(bodies)
    prepare_mass(kind)
    return kind
