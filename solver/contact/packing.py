"""Contours and contacts of a scene become one kind."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.splines.convex import BOX, CAPSULE, CYLINDER, ELLIPSOID, RING, Primitive, shape_row
from heavylift.numerics.classes import dataclass
from heavylift.numerics.joined import joined
from heavylift.numerics.lanes import block_shape
from heavylift.numerics.records import Records, lane_records, records
from heavylift.solver.contact import layout
from heavylift.solver.contact.checks import check_contact
from heavylift.solver.contact.contour_packing import PackedContours, pack_contours
from heavylift.solver.contact.kind import (
    BILATERAL,
    CIRCLE,
    COMPLIANT,
    CONVEX,
    CURVE,
    DENSE,
    LARGEST_CONTROLS,
    OF_MODES,
    POINT,
    RIGID,
    ContactContour,
    ContactEntry,
    ContactRows,
    ContactState,
    ContactValues,
    ContourPose,
    Counts,
    Events,
    Features,
    HeldContact,
    Reduced,
    Scratch,
    Slept,
    StoodPair,
    Tally,
)
from heavylift.solver.contact.laws.packing import force_law, put_law
from heavylift.solver.contact.moving_points import moving_points
from heavylift.solver.contact.packed_collisions import moves_rigidly, no_collisions
from heavylift.solver.contact.search.features import (
    Curves,
    Deforming,
    Footprints,
    Primitives,
    Rings,
    Surfaces,
    SurfaceWeights,
)
from heavylift.solver.contact.solve.newton import ContactSolvers, NonsmoothNewton
from heavylift.solver.contact.solve.problem import make_work
from heavylift.solver.interface import FORCES
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import FACTORED, PRESCRIBED, Attachment, Row, Side
from heavylift.solver.scene.connections import axes_about
from heavylift.solver.scene.contacts import (
    BilateralLaw,
    BoxShape,
    CapsuleShape,
    CircleShape,
    Contact,
    CylinderShape,
    EllipsoidShape,
    PointShape,
    RigidLaw,
    SphereShape,
)
from heavylift.solver.scene.scene import Scene

if TYPE_CHECKING:
    from heavylift.solver.contact.packed_collisions import PackedCollisions
    from heavylift.solver.contact.triangles.kind import PairSide
    from heavylift.solver.scene.scene import AnyBody

__all__ = ["contact_markers", "pack_contacts"]

ROWS = 3


@dataclass(frozen=True)
class ContactMarkers:
    """Markers of one contact: its point, and three directions of its body or -1."""

    centre: int
    axes: int


def contact_markers(scene: Scene, book: MarkerBook) -> list[ContactMarkers]:
    """Points and directions of what touches."""
    found = []
    for contact in scene.contacts:
        point = np.asarray(contact.point, dtype=np.float64)
        centre = book.point(contact.body, point, FORCES)
        axes = -1
        # a ball without friction does not feel how its body turns
        plain = isinstance(contact.shape, PointShape) or (
            isinstance(contact.shape, SphereShape) and contact.friction == 0.0
        )
        if not plain:
            axes = book.direction(contact.body, np.eye(3)[0], FORCES, at=point)
            for axis in np.eye(3)[1:]:
                book.direction(contact.body, axis, FORCES, at=point)
        found.append(ContactMarkers(centre, axes))
    return found


def pack_contacts(
    scene: Scene,
    ordered: Sequence[AnyBody],
    columns: Sequence[int],
    of_collisions: Sequence[tuple[int, Sequence[int]]],
    markers: Sequence[ContactMarkers],
    attachment: Callable[[str], Attachment],
    dofs: Mapping[str, int],
    inverse_mass: NDArray[np.float64],
    scales: Callable[[str], tuple[float, float]],
    block_count: int,
    linked: Records[Side],
) -> ContactRows:
    """Make the kind.

    Parameters
    ----------
    scene, ordered
        The scene, and its bodies in the order of their kinds.
    columns
        First record column of each contact.
    of_collisions
        Of each collision, and of those of its contacts that are recorded.
    markers
        From `contact_markers`.
    attachment, dofs, inverse_mass, scales
        Where the rows of a body go, its first velocity, inverse masses by velocity, inverse mass and inertia by name.
    block_count
        Blocks of the rows of the joints, which come first in messages.
    linked
        Sides of the rows of joints and ropes, which connect bodies too.

    Raises
    ------
    InputError
        What `check_contact` refuses.
    """
    packed = pack_contours(scene, ordered, dofs)
    if not scene.collisions:
        collided = no_collisions()
    else:
        from heavylift.solver.contact.triangles.packing import pack_collisions

        collided = pack_collisions(scene, ordered, of_collisions, attachment, dofs, scales, len(packed.rows))
    count = len(scene.contacts) + collided.most
    numbers = {contour.name: i for i, contour in enumerate(scene.contours)}
    table, values, state = (
        records(ContactEntry, count),
        records(ContactValues, count),
        records(ContactState, count),
    )
    sides: list[Attachment] = []
    slots: dict[str, int] = {}
    for i, (contact, column, marker) in enumerate(zip(scene.contacts, columns, markers, strict=True)):
        check_contact(contact, scene, scales)
        contour = scene.contours[numbers[contact.contour]]
        sides += [attachment(contour.body), attachment(contact.body)]
        size = packed.sizes[numbers[contact.contour]]
        kind, extent, radius, primitive_kind, primitive = _shape(contact)
        table[i].contour, table[i].shape_kind = numbers[contact.contour], kind
        table[i].law, table[i].force_law = _law(contact, packed.is_curve[numbers[contact.contour]])
        table[i].centre, table[i].axes, table[i].column = marker.centre, marker.axes, column
        table[i].events = isinstance(contact.law, RigidLaw) and contact.law.events
        table[i].slot = slots.get(contour.body, 0)
        slots[contour.body] = slots.get(contour.body, 0) + moving_points(contour)
        table[i].primitive_kind = primitive_kind
        values[i].friction, values[i].footprint = contact.friction, contact.footprint
        values[i].radius, values[i].extent = radius, extent
        values[i].length_scale = extent if extent > 0.0 else size
        values[i].primitive.words[:] = primitive.words
        put_law(contact.law, values[i])
        state[i].normal[:], state[i].tangent[:] = packed.start_normals[numbers[contact.contour]]
        state[i].touch_damping = -1.0
    pairs = [side for meshes in collided.meshes for side in meshes.sides]
    islands = _islands([*sides, *pairs], linked, len(inverse_mass))
    return _kind(packed, collided, sides, table, values, state, inverse_mass, block_count, islands, linked)


def _islands(
    sides: Sequence[Attachment | PairSide], linked: Records[Side], velocity_count: int
) -> NDArray[np.int64]:
    """Number of the island of each contact and pair of surfaces, two sides each; what cannot move connects nothing.

    Bodies, known by their first velocities, blocks of rows and contacts are the nodes of a graph.
    """
    first = velocity_count + 1 + int(linked["owner"].max(initial=-1))
    dof = np.append(linked["dof"], [side.dof for side in sides]).astype(np.int64)
    holder = np.append(linked["holder"], [side.holder for side in sides])
    by = np.append(velocity_count + linked["owner"], first + np.arange(len(sides)) // 2).astype(np.int64)
    moves = holder != PRESCRIBED
    size = first + len(sides) // 2
    label = joined(size, np.column_stack([dof[moves], by[moves]]))
    return np.unique(label[first:], return_inverse=True)[1].astype(np.int64)


def _kind(
    packed: PackedContours,
    collided: PackedCollisions,
    sides: Sequence[Attachment],
    table: Records[ContactEntry],
    values: Records[ContactValues],
    state: Records[ContactState],
    inverse_mass: NDArray[np.float64],
    block_count: int,
    islands: NDArray[np.int64],
    linked: Records[Side],
) -> ContactRows:
    """Allocate everything that a step needs."""
    count, of_contours = len(table), len(table) - collided.most
    modes = [*packed.mode_counts, *collided.modal.rows["modes"]]
    rigid_only = collided.all_rigid and all(moves_rigidly(side) for side in sides)
    own = min(count, DENSE) if rigid_only else count
    shape = block_shape(ROWS)
    lanes = len(shape[1])
    window = max([collided.widest, *(side.width for side in sides)])
    touched = [*sides, *collided.sides] if rigid_only else []
    factored = sorted({int(side.dof) for side in touched if side.holder == FACTORED})
    ends = 2 * (count + len(factored))
    attachments = records(Side, ends)
    attachments["panel"] = np.arange(ends) * window * lanes
    attachments["owner"] = np.minimum(np.arange(ends) // 2, count)
    attachments["dof"], attachments["holder"] = -1, PRESCRIBED
    for i, side in enumerate(sides):
        given = attachments[i]
        given.dof, given.width, given.holder = side.dof, side.width, side.holder
    panels = np.zeros(2 * ends * window * lanes)
    for i, end in enumerate(attachments[2 * count :]):
        end.dof, end.width, end.holder = factored[i // 2], 6, FACTORED
        for r in range(ROWS):
            panels[end.panel + (3 * (i % 2) + r) * lanes + r] = 1.0
    rows = lane_records(Row, count + 1, lanes)
    rows["scale"][:, :ROWS] = 1.0
    counts = Counts.one()
    counts.first_block, counts.all_rigid = block_count, rigid_only
    counts.total = counts.of_contours = of_contours
    bodies = len({side.dof for side in sides if side.width} | set(collided.contours["dof"]) - {-1})
    size = 6 * bodies if rigid_only else 0
    delassus, rates = np.zeros((3 * own, 3 * own)), np.zeros((3, 3 * count))
    dense = layout.Problem(
        counts=layout.ProblemSize.one(),
        kinds=records(layout.RowKind, count),
        parameters=records(layout.RowParameters, count),
        ends=np.zeros((0, 4), dtype=np.int64),
        blocks=np.zeros((0, 36)),
        start=rates[0],
        B=delassus,
        head=np.zeros(0, dtype=np.int64),
        past=np.zeros(0, dtype=np.int64),
        p=rates[1],
        y=rates[2],
        work=make_work(count, max(3 * own, size)),
        solution=layout.Solution.one(),
    )
    reduced = _reduced(dense, count if rigid_only else 0, size, len(inverse_mass) if rigid_only else 0)
    reduced.units[factored] = 2 * (count + np.arange(len(factored)))
    if rigid_only:
        reduced.joined[linked["dof"][linked["holder"] != PRESCRIBED]] = 1
    sleepers = collided.sleepers
    sleepers["allowed"] &= ~np.isin(sleepers["dof"], [*linked["dof"], *(side.dof for side in sides)])
    control = Events.one()
    control.watched = control.joins = -1
    return ContactRows(
        features=_features(packed, table[:of_contours], values[:of_contours]),
        lanes=lanes,
        attachments=attachments,
        panels=panels,
        rows=rows,
        inverse_mass=np.ascontiguousarray(inverse_mass, dtype=np.float64),
        table=table,
        values=values,
        state=state,
        contours=records(ContactContour, [*packed.rows, *collided.contours]),
        poses=_joined(packed.poses, collided.poses),
        constants=packed.constants,
        net=packed.net,
        samples=packed.samples,
        delassus=delassus,
        laws=dense.parameters,
        kinds=dense.kinds,
        rates=rates,
        column=np.zeros(len(inverse_mass)),
        scratch=Scratch.one(),
        shapes=np.zeros(6 * max([1, *modes])),
        places=np.zeros(LARGEST_CONTROLS, dtype=np.int64),
        counts=counts,
        present=np.zeros(count, dtype=np.int64),
        joining=np.zeros(count, dtype=np.int64),
        control=control,
        tally=records(Tally, 1),
        islands=islands,
        island_loss=np.zeros(1 + int(islands.max(initial=-1))),
        solvers=ContactSolvers((NonsmoothNewton(),)),
        dense=dense,
        solution=dense.solution,
        reduced=reduced,
        meshes=collided.meshes,
        facets=collided.facets,
        modal=collided.modal,
        placed=collided.placed,
        stood=records(StoodPair, sum(len(meshes.pairs) for meshes in collided.meshes)),
        sleepers=collided.sleepers,
        slept=records(Slept, len(collided.sleepers)),
        held=records(HeldContact, count),
        carried=np.zeros(0),
        saved=np.zeros(0),
    )


def _joined(first: Records[ContourPose], second: Records[ContourPose]) -> Records[ContourPose]:
    """Those of contours, then those of surfaces."""
    both = records(ContourPose, len(first) + len(second))
    both[: len(first)], both[len(first) :] = first, second
    return both


def _reduced(dense: layout.Problem, contact_count: int, size: int, velocity_count: int) -> Reduced:
    """Room for some contacts on some velocities of bodies; none of either where contacts are not solved so."""
    problem = dense._replace(
        counts=layout.ProblemSize.one(),
        ends=np.zeros((contact_count, 4), dtype=np.int64),
        blocks=np.zeros((contact_count, 36)),
        start=np.zeros(size),
        B=np.zeros((size, size)),
        head=np.zeros(size, dtype=np.int64),
        past=np.zeros(size, dtype=np.int64),
        y=np.zeros(size),
    )
    return Reduced(
        problem=problem,
        ends=problem.ends,
        blocks=problem.blocks,
        matrix=problem.B,
        start=problem.start,
        found=problem.y,
        columns=np.full(velocity_count, -1, dtype=np.int64),
        velocities=np.zeros(size, dtype=np.int64),
        units=np.full(velocity_count, -1, dtype=np.int64),
        joined=np.zeros(velocity_count, dtype=np.int64),
        of_bodies=np.zeros((2, velocity_count), dtype=np.int64),
        of_contacts=np.zeros((2, contact_count), dtype=np.int64),
    )


def _features(
    packed: PackedContours, table: Records[ContactEntry], values: Records[ContactValues]
) -> Features:
    """Kinds of contact that are there."""
    on_curve = np.array([packed.is_curve[i] for i in table["contour"]], dtype=bool)
    deforms = packed.rows["owner"][table["contour"]] >= OF_MODES
    counts = {
        # puts the samples where they are before the others begin a search at them
        Deforming: np.count_nonzero(packed.samples.grids["points"] == 0),
        Surfaces: np.count_nonzero(~on_curve & (table["shape_kind"] == POINT)),
        SurfaceWeights: np.count_nonzero(~on_curve & deforms),
        Curves: np.count_nonzero(on_curve),
        Rings: np.count_nonzero(table["shape_kind"] == CIRCLE),
        Primitives: np.count_nonzero(table["shape_kind"] == CONVEX),
        Footprints: np.count_nonzero(values["footprint"] > 0.0),
    }
    return Features(feature(members=int(count)) for feature, count in counts.items() if count)


def _law(contact: Contact, of_curve: bool) -> tuple[int, int]:
    """Law, and force law of a compliant one."""
    law = contact.law
    if isinstance(law, RigidLaw):
        return RIGID, 0
    if isinstance(law, BilateralLaw):
        return (CURVE if of_curve else BILATERAL), 0
    return COMPLIANT, force_law(law)


def _shape(contact: Contact) -> tuple[int, float, float, int, Primitive]:
    """What touches: kind, largest distance from its point, radius of a ball, kind and record of a primitive."""
    shape: Any = contact.shape
    if isinstance(shape, PointShape):
        return POINT, 0.0, 0.0, -1, Primitive.one()
    if isinstance(shape, SphereShape):
        return POINT, shape.radius, shape.radius, -1, Primitive.one()
    if isinstance(shape, CircleShape):
        row = shape_row(RING, [shape.radius])
        return CIRCLE, shape.radius, 0.0, RING, _turned(row, axes_about(shape.axis, source=contact.name))
    if isinstance(shape, EllipsoidShape):
        row = shape_row(ELLIPSOID, list(map(float, shape.half_axes)))
        return CONVEX, float(max(shape.half_axes)), 0.0, ELLIPSOID, _turned(row, shape.axes)
    if isinstance(shape, BoxShape):
        row = shape_row(BOX, list(map(float, shape.core)), shape.rounding)
        reach = float(np.linalg.norm(shape.core)) + shape.rounding
        return CONVEX, reach, 0.0, BOX, _turned(row, shape.axes)
    axes = axes_about(shape.axis, source=contact.name)
    if isinstance(shape, CapsuleShape):
        row = shape_row(CAPSULE, [0.5 * shape.length], shape.radius)
        return CONVEX, 0.5 * shape.length + shape.radius, 0.0, CAPSULE, _turned(row, axes)
    assert isinstance(shape, CylinderShape)
    row = shape_row(CYLINDER, list(shape.core), shape.rounding)
    return CONVEX, float(np.hypot(*shape.core)) + shape.rounding, 0.0, CYLINDER, _turned(row, axes)


def _turned(primitive: Primitive, axes: NDArray[np.float64]) -> Primitive:
    """A primitive whose axes are given in the frame of its body."""
    primitive.axes[:] = np.asarray(axes, dtype=np.float64).reshape(3, 3)
    return primitive
