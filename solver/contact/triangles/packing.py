"""Surfaces and collisions of a scene become the kind of pairs of surfaces, and room for their contacts."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.contours.triangles.surface_layout import RelativeMotion, RelativePose
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.contact.checks import check_law, check_motion
from heavylift.solver.contact.kind import (
    COMPLIANT,
    NEVER_MOVES,
    OF_FACETS,
    OF_GROUND,
    OF_RIGID,
    RIGID,
    Colliding,
    ContactContour,
    ContactState,
    ContactValues,
    ContourPose,
    Sleeper,
)
from heavylift.solver.contact.laws.packing import force_law, put_law
from heavylift.solver.contact.moving_points import count_moving, count_slots, most_of
from heavylift.solver.contact.packed_collisions import PackedCollisions, moves_rigidly
from heavylift.solver.contact.triangles.clearance import make_clearances
from heavylift.solver.contact.triangles.facet_kind import FacetSurface, FacetSurfaces
from heavylift.solver.contact.triangles.kind import (
    PLACED_WIDTH,
    Clearing,
    PairSide,
    SurfacePair,
    SurfacePairs,
)
from heavylift.solver.contact.triangles.modal_packing import ModalBook, pack_modal, pack_modal_surface
from heavylift.solver.contact.triangles.outside import closed_parts, outside_of
from heavylift.solver.rows.structure import Attachment
from heavylift.solver.scene.bodies import Fixed, Free, RigidBody
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.contacts import BilateralLaw, RigidLaw
from heavylift.solver.scene.meshes import MeshBody
from heavylift.solver.scene.scene import Scene

if TYPE_CHECKING:
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.records import Records
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
    from heavylift.solver.bodies.ancf.mesh_contour import FacetBook
    from heavylift.solver.contact.triangles.outside import ClosedParts
    from heavylift.solver.scene.collisions import Collision, CollisionSurface
    from heavylift.solver.scene.scene import AnyBody

__all__ = ["pack_collisions"]

METHODS = {"swept": 0, "position-difference": 1}

EDGES_OF_PATCH = 1.5
"""Mean edges of the smaller surface in a patch, at least: the diagonal of a square face is 1.41 of its edges."""

BORDER = 1e-9
"""Of the size: beyond the border by less a contact is still on its face."""

BORDER_ON_MODES = 1e-4
"""The same where a surface swings with its modes, and a corner on the side of two triangles would change to and fro."""

FOUND_AT_A_POINT = 4
"""Features that a search may find for each point of a surface that deforms: all of it may lie on something."""

MOST_AT_ALL = 100_000
"""Contacts at once, of all collisions: each takes some kilobytes."""

MOST_DENSE = 2048
"""The same where not all that is touched has six velocities: the matrix of all rows of contacts is solved."""

FOUND_AT_ONCE = 16
"""Features that a search may find for each contact that there may be: those of one patch make few contacts."""


def pack_collisions(
    scene: Scene,
    ordered: Sequence[AnyBody],
    columns: Sequence[tuple[int, Sequence[int]]],
    attachment: Callable[[str], Attachment],
    dofs: Mapping[str, int],
    scales: Callable[[str], tuple[float, float]],
    first_pose: int,
) -> PackedCollisions:
    """Make the kind.

    Parameters
    ----------
    scene, ordered
        The scene, and its bodies in the order of their kinds.
    columns
        First record column of each collision, and of those of its contacts that are recorded.
    attachment, dofs, scales
        As of `pack_contacts`.
    first_pose
        Contours, whose poses come first.

    Raises
    ------
    InputError
        What the checks of collisions refuse.
    """
    from heavylift.contours.triangles.feature_gap import FeatureTouch
    from heavylift.contours.triangles.feature_report import make_contact_list
    from heavylift.contours.triangles.pair_list import make_pair_lists
    from heavylift.contours.triangles.patches import EXTREMES, patch_scratch_size
    from heavylift.contours.triangles.surface_pack import pack_surfaces
    from heavylift.solver.contact.triangles.feature_search import FeatureSearch, FeatureSearches, FoundCount

    by_name = {body.name: body for body in ordered}
    contours = records(ContactContour, len(scene.surfaces))
    poses, moved = [], []
    facets: dict[int, FacetBook] = {}
    modal: dict[int, ModalBook] = {}
    for i, one in enumerate(scene.surfaces):
        contours[i], pose, surface, book = _pack_surface(one, by_name, dofs)
        poses.append(pose)
        moved.append(surface)
        if isinstance(book, ModalBook):
            modal[i] = book
        elif book is not None:
            facets[i] = book
    deforming = {*facets, *modal}
    numbers = {one.name: i for i, one in enumerate(scene.surfaces)}
    count = len(scene.collisions)
    pairs, sides = records(SurfacePair, count), records(PairSide, 2 * count)
    values = records(ContactValues, count)
    recorded: list[int] = []
    for i, (collision, (column, of_contacts)) in enumerate(zip(scene.collisions, columns, strict=True)):
        _check(collision, scene, scales)
        first, second = (numbers[name] for name in collision.surfaces)
        pair, law = pairs[i], collision.law
        pair.surfaces[:] = first, second
        pair.poses[:] = first_pose + first, first_pose + second
        pair.law = RIGID if isinstance(law, RigidLaw) else COMPLIANT
        pair.force_law = 0 if isinstance(law, RigidLaw) else force_law(law)
        pair.events = isinstance(law, RigidLaw) and law.events
        pair.method = METHODS[collision.method]
        pair.column, pair.first_recorded, pair.recorded = column, len(recorded), len(of_contacts)
        recorded += of_contacts
        pair.most = most_of(collision, scene)
        pair.deforms = first in deforming or second in deforming
        pair.keeps = not pair.deforms
        if pair.deforms and isinstance(law, RigidLaw) and law.restitution == 0.0:
            pair.events = False  # each impact sends waves, and each wave opens and closes others
        held = [attachment(scene.surfaces[k].body) for k in (first, second)]
        for side, given in zip(sides[2 * i : 2 * i + 2], held, strict=True):
            side.dof, side.width, side.holder = given.dof, given.width, given.holder
        size = min(_extent(moved[first]), _extent(moved[second]))
        if not size > 0.0:
            _refuse(collision, "between", "a surface that is a single point", "a radius, or more points")
        of_contact = values[i]
        put_law(law, of_contact)
        of_contact.friction, of_contact.length_scale, of_contact.extent = collision.friction, size, 0.0
        inverse = [0.0 if name == GROUND else scales(name)[0] for name in _bodies(collision, scene)]
        of_contact.inverse_mass = sum(inverse)
        pair.patch_cosine = math.cos(collision.patch_angle)
        pair.patch_size = collision.patch_size or _patch_size(min(moved[first], moved[second], key=_extent))
        pair.radii = moved[first].radius + moved[second].radius
        pair.border = size * (BORDER_ON_MODES if first in modal or second in modal else BORDER)
    sleepers = _sleepers(scene, by_name, pairs, contours, poses, deforming, first_pose)
    packed = pack_surfaces(moved, [surface.body for surface in scene.surfaces])
    all_rigid = not deforming and all(moves_rigidly(side) for side in sides)
    most = _most_at_once(pairs, all_rigid)
    room = FOUND_AT_ONCE * max(2, int(pairs["most"].max()))
    room = max([room, *(FOUND_AT_A_POINT * len(moved[i].points) for i in deforming)])
    items = room + most
    placed = records(ContourPose, len(poses))
    for i, pose in enumerate(poses):
        placed[i] = pose
    pairs["first_member"] = pairs["last_member"] = -1
    asked_for = _asked_for(scene)
    pairs["measured"] = asked_for
    parts = closed_parts(packed, deforming)
    _put_outside(pairs, packed, parts, poses)
    places = len(scene.contacts) + most
    search = FeatureSearch(
        surfaces=packed,
        lists=make_pair_lists(packed, [(int(pair.surfaces[0]), int(pair.surfaces[1])) for pair in pairs]),
        found=make_contact_list(room),
        counts=FoundCount.one(),
    )
    meshes = SurfacePairs(
        surfaces=packed,
        searches=FeatureSearches((search,)),
        pairs=pairs,
        sides=sides,
        recorded_columns=np.array(recorded, dtype=np.int64),
        pair_values=values,
        relative=records(RelativePose, count),
        motions=records(RelativeMotion, count),
        found=search.found,
        counts=search.counts,
        touch=FeatureTouch.one(),
        points=np.zeros((items, 3)),
        normals=np.zeros((items, 3)),
        depths=np.zeros(items),
        active=np.zeros(items, dtype=np.int64),
        owners=np.zeros(items, dtype=np.int64),
        patch_of=np.zeros(items, dtype=np.int64),
        keeps=np.zeros(room, dtype=np.int64),
        chosen=np.zeros((items, EXTREMES), dtype=np.int64),
        sums=np.zeros(items),
        grid=np.zeros(patch_scratch_size(items), dtype=np.int64),
        next_member=np.full(places, -1, dtype=np.int64),
        slots=np.full(1 << (2 * most - 1).bit_length(), -1, dtype=np.int64),
        chains=np.zeros(places, dtype=np.int64),
        entered=np.zeros(places + 1, dtype=np.int64),
        kept=records(ContactState, places),
        outward=parts.outward,
        edge_outward=parts.edge_outward,
        clearances=Clearing(make_clearances(packed, asked_for)),
    )
    return PackedCollisions(
        meshes=Colliding((meshes,)),
        facets=_pack_facets(scene, packed, facets, dofs, first_pose),
        modal=pack_modal(modal, packed, search.lists, len(scene.surfaces), first_pose),
        contours=contours,
        poses=placed,
        placed=np.zeros((len(moved) + count + 1, PLACED_WIDTH)),
        most=most,
        all_rigid=all_rigid,
        sides=[side for side in sides if side.width],
        sleepers=sleepers,
        widest=max(6, int(sides["width"].max())),
    )


def _sleepers(
    scene: Scene,
    by_name: Mapping[str, AnyBody],
    pairs: Records[SurfacePair],
    contours: Records[ContactContour],
    poses: Sequence[ContourPose],
    deforming: Collection[int],
    first_pose: int,
) -> Records[Sleeper]:
    """Free rigid bodies all of whose pairs are without compliance; their numbers go into the pairs."""
    found: dict[str, Sleeper] = {}
    numbers = []
    for i, surface in enumerate(scene.surfaces):
        body = by_name.get(surface.body)
        number = 0
        if surface.body == GROUND or (type(body) is RigidBody and isinstance(body.motion, Fixed)):
            number = NEVER_MOVES
        elif type(body) is RigidBody and isinstance(body.motion, Free) and i not in deforming:
            if surface.body not in found:
                one = found[surface.body] = Sleeper.one()
                one.dof, one.pose, one.size, one.allowed = (
                    contours[i].dof,
                    first_pose + i,
                    poses[i].reach,
                    True,
                )
            number = 1 + list(found).index(surface.body)
        numbers.append(number)
    sleepers = records(Sleeper, list(found.values()))
    for pair in pairs:
        pair.sleepers[:] = [numbers[k] for k in pair.surfaces]
        if pair.law != RIGID or pair.deforms:
            sleepers["allowed"][[number - 1 for number in pair.sleepers if number > 0]] = False
    return sleepers


def _most_at_once(pairs: Records[SurfacePair], all_rigid: bool) -> int:
    """Contacts at once of all collisions together.

    Pairs grow with the square of the number of surfaces, and what touches at once does not: there is room for as many
    as each surface may have with one other.
    """
    of_surface = np.zeros(1 + int(pairs["surfaces"].max()), dtype=np.int64)
    np.maximum.at(of_surface, pairs["surfaces"].ravel(), np.repeat(pairs["most"], 2))
    most = min(int(pairs["most"].sum()), int(of_surface.sum()), MOST_AT_ALL if all_rigid else MOST_DENSE)
    return max(most, int(pairs["most"].max()))


def _put_outside(
    pairs: Records[SurfacePair],
    packed: CollisionSurfaces,
    parts: ClosedParts,
    poses: Sequence[ContourPose],
) -> None:
    """Where both surfaces of each pair begin, as seen from the other."""
    turns, places = [one.rotation.reshape(3, 3) for one in poses], [one.origin for one in poses]
    for pair in pairs:
        for side in range(2):
            a, b = int(pair.surfaces[side]), int(pair.surfaces[1 - side])
            R, p = turns[a].T @ turns[b], turns[a].T @ (places[b] - places[a])
            pair.outside[side] = outside_of(packed, parts, a, b, R, p)


def _asked_for(scene: Scene) -> list[bool]:
    """Whether somebody asks for the gap of each collision: the user, or a phase that waits for it."""
    signals = () if scene.scenario is None else scene.scenario.signals
    waited = {term.channel for signal in signals for term in signal.terms}
    return [
        one.clearance or not waited.isdisjoint((f"{one.name}.gap", f"{one.name}.gap_min"))
        for one in scene.collisions
    ]


def _pack_facets(
    scene: Scene,
    packed: CollisionSurfaces,
    deforming: Mapping[int, FacetBook],
    dofs: Mapping[str, int],
    first_pose: int,
) -> FacetSurfaces:
    """The surfaces that deform."""
    if not deforming:
        return FacetSurfaces.none()
    slots, moving = count_slots(scene), count_moving(scene)
    rows = records(FacetSurface, len(deforming))
    row_of = np.full(first_pose + len(scene.surfaces), -1, dtype=np.int64)
    point = 0
    for k, (i, book) in enumerate(deforming.items()):
        body, row_of[first_pose + i] = scene.surfaces[i].body, k
        row = rows[k]
        row.surface, row.dof, row.pose = i, dofs[body], first_pose + i
        row.own_point, row.points = point, len(book.counts)
        row.first_point = packed.surfaces[i].first_point
        row.last_slot = moving.get(body, 0)
        row.first_slot = row.last_slot - slots.get(body, 0)
        point += len(book.counts)
    counts = np.concatenate([book.counts for book in deforming.values()])
    return FacetSurfaces(
        rows=rows,
        row_of=row_of,
        points=packed.points,
        first=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        entries=np.concatenate([book.entries for book in deforming.values()]),
        factors=np.concatenate([book.factors for book in deforming.values()]),
        corners=np.zeros(3, dtype=np.int64),
        shares=np.zeros(3),
    )


def _bodies(collision: Collision, scene: Scene) -> list[str]:
    by_name = {one.name: one.body for one in scene.surfaces}
    return [by_name[name] for name in collision.surfaces]


def _extent(surface: TriangleSurface) -> float:
    """Largest extension, rounding included [m]."""
    return float(np.ptp(surface.points, axis=0).max()) + 2.0 * surface.radius


def _patch_size(surface: TriangleSurface) -> float:
    """A tenth of a surface, but so much that the corners of a coarse face belong together [m]."""
    corners = surface.points[surface.triangles]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    return max(0.1 * _extent(surface), EDGES_OF_PATCH * float(edges.mean()))


def _pack_surface(
    one: CollisionSurface, by_name: Mapping[str, AnyBody], dofs: Mapping[str, int]
) -> tuple[ContactContour, ContourPose, TriangleSurface, FacetBook | ModalBook | None]:
    """Row and pose of a surface, its triangles in the axes in which its body is measured, and how they deform."""
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

    if one.body != GROUND and one.body not in by_name:
        raise InputError(
            f"there is no body {one.body!r}",
            source=one.name,
            key="body",
            expected=f"{GROUND} or one of {', '.join(sorted(by_name))}",
        )
    body: Any = by_name.get(one.body)
    if body is not None and body.SHAPE:
        return _pack_own_surface(one, body, list(by_name).index(one.body), dofs)
    if body is not None and body.MODAL:
        return pack_modal_surface(one, body, list(by_name).index(one.body), dofs[one.body])
    if one.surface is None or not (body is None or body.CONTOURS == "rigid"):
        raise InputError(
            f"no triangles on {one.body!r}" if one.surface is None else f"triangles on {one.body!r}",
            source=one.name,
            key="body",
            expected=(
                "a rigid body, a body with modes or the ground with triangles, a frame or shell without"
            ),
        )
    origin, axes = body.contour_frame() if body is not None else (np.zeros(3), np.eye(3))
    surface = TriangleSurface(
        (one.surface.points - origin) @ axes, one.surface.triangles, one.surface.radius, one.name
    )
    row = ContactContour.one()
    row.owner = OF_GROUND if body is None else OF_RIGID
    row.dof = -1 if body is None else dofs[one.body]
    row.body = -1 if body is None else list(by_name).index(one.body)
    pose = ContourPose.one()
    pose.rotation[:] = np.eye(3).ravel()
    if body is not None:
        R = rotation_matrix(body.orientation)
        pose.rotation[:] = (R @ axes).ravel()
        pose.origin[:] = body.position + R @ origin
    pose.reach = float(np.linalg.norm(surface.points, axis=1).max()) + surface.radius
    return row, pose, surface, None


def _pack_own_surface(
    one: CollisionSurface, body: MeshBody, number: int, dofs: Mapping[str, int]
) -> tuple[ContactContour, ContourPose, TriangleSurface, FacetBook]:
    """The same of a frame or shell: axes are those in which it was placed, and stand still."""
    from heavylift.solver.bodies.ancf.mesh_contour import facet_surface

    if one.surface is not None:
        raise InputError(
            "triangles of its own",
            source=one.name,
            key="surface",
            expected=f"none: {one.body!r} touches with its own surface, in 'facets'",
        )
    if one.facets < 1:
        raise InputError(f"{one.facets}", source=one.name, key="facets", expected="1 or more")
    book = facet_surface(body, one.facets, one.name)
    row = ContactContour.one()
    row.owner, row.dof, row.body = OF_FACETS, dofs[one.body], number
    pose = ContourPose.one()
    pose.rotation[:] = rotation_matrix(np.asarray(body.orientation, dtype=np.float64)).ravel()
    pose.origin[:] = body.position
    pose.reach = float(np.linalg.norm(book.surface.points, axis=1).max()) + book.surface.radius
    return row, pose, book.surface, book


def _check(collision: Collision, scene: Scene, scales: Callable[[str], tuple[float, float]]) -> None:
    """Refuse a collision that cannot be."""
    by_name = {one.name: one for one in scene.surfaces}
    for name in collision.surfaces:
        if name not in by_name:
            _refuse(
                collision, "between", f"there is no surface {name!r}", f"one of {', '.join(sorted(by_name))}"
            )
    bodies = _bodies(collision, scene)
    if bodies[0] == bodies[1]:
        _refuse(collision, "between", f"{bodies[0]!r} touches itself", "surfaces of two bodies")
    check_motion(collision.name, bodies[0], bodies[1], scales)
    if isinstance(collision.law, BilateralLaw):
        _refuse(
            collision,
            "law",
            "bilateral, between surfaces whose contacts open and close",
            "a law that can open",
        )
    check_law(collision.name, collision.law, collision.friction)
    if collision.method not in METHODS:
        _refuse(collision, "method", f"{collision.method!r}", " or ".join(map(repr, METHODS)))
    if not 0.0 < collision.patch_angle <= math.pi:
        _refuse(collision, "patch_angle", f"{collision.patch_angle} rad", "above 0, up to pi")
    if not 0.0 <= collision.patch_size < math.inf:
        _refuse(collision, "patch_size", f"{collision.patch_size} m", "0 or more")
    for key, value, least in (
        ("most_contacts", collision.most_contacts, 1),
        ("recorded", collision.recorded, 0),
    ):
        if value < least:
            _refuse(collision, key, f"{value}", f"{least} or more")


def _refuse(collision: Collision, key: str, problem: str, expected: str) -> None:
    raise InputError(problem, source=collision.name, key=key, expected=expected)
