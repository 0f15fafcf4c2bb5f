"""Trees of rigid bodies: which joints carry bodies, what is constant of them, and their coordinates in a state vector.

A joint of a tree is no row: its coordinates are unknowns of the integrator, so it never opens. With
the *joint point* of a body, on its side of the joint to its parent, everything of a body refers to that
point and to world axes::

    hinge    q = q_p o t o (cos a/2, s sin a/2),    x = x_p + R_p r            one angle a about s
    slider   q = q_p o t,                           x = x_p + R_p (r + d s)    one travel d along s
    ball     q free,                                x = x_p + R_p r            a quaternion and a spin
    fixed    q = q_p o t,                           x = x_p + R_p r            nothing
    free     q free,                                x free                     a pose and six velocities
    distance q free,                                x = x_p + R_p r + L e      a direction, a quaternion, their rates

Quaternions and spins are absolute: a ball joint passes a force alone, a distance one along its direction e, which
is absolute too. Spins are in principal axes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Ints1
from heavylift.numerics.jit import in_python
from heavylift.numerics.records import Quaternion, Record, Records, Vector, Vector6, records
from heavylift.numerics.rotation import quaternion_from_matrix, quaternion_product, rotation_matrix
from heavylift.solver.drive import DRIVEN, FREE
from heavylift.solver.interface import FORCES, RECORD, Bodies, Forces, Joints, Systems, Workspace, begin_stage
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.bodies import GROUND

if TYPE_CHECKING:
    from heavylift.solver.layout import Layout
    from heavylift.solver.scene.connections import Joint
    from heavylift.solver.scene.scene import Scene

__all__ = [
    "BALL",
    "DISTANCE",
    "FIXED",
    "FLOATING",
    "GROUNDED",
    "HINGE",
    "SLIDER",
    "Forest",
    "JointRecord",
    "LoopRow",
    "TreeBody",
    "make_forest",
    "stepped",
]

HINGE, SLIDER, FIXED, BALL, FLOATING, DISTANCE = range(6)
"""Joints to the parent; what floats has none. The first two have one coordinate, from `BALL` on there is a quaternion,
from `FLOATING` on with a vector before it."""

GROUNDED = -1
"""Parent of a body whose joint is on the ground."""

PARALLEL, SQUARE = ("parallel", "z"), ("square", "x", "y")
KNOWN = {
    "hinge": (HINGE, (("point",), PARALLEL)),
    "slider": (SLIDER, (("travel", "x"), ("travel", "y"), PARALLEL, SQUARE)),
    "ball": (BALL, (("point",),)),
    "distance": (DISTANCE, ()),
    "fixed": (FIXED, (("point",), PARALLEL, SQUARE)),
}
"""Joints that can carry a body, by their words, and the rows whose reactions are found."""

PLACES = (1, 1, 0, 4, 7, 7)
SPEEDS = (1, 1, 0, 3, 6, 6)
"""Coordinates and velocities of the joints."""

MOST_ROWS = 30
"""Of joints that are not in trees."""

SERVED = True
"""Whether trees are looked for; tests compare with rows."""

Matrix9 = Annotated[NDArray[np.float64], (9,)]


class TreeBody(Record, whole_lines=True):
    """A body of a tree: constants, then the scratch of an evaluation in world axes.

    Attributes
    ----------
    parent, joint
        Its parent in the forest, or `GROUNDED`; and the joint to it.
    place, speed
        Of its coordinates and velocities in a state vector.
    dof, pose
        Of its velocities and of its pose in the vector of all bodies.
    block, sign
        Block of the joint, -1 without; 1 if this body is its b, -1 if that is the parent.
    turned, alone
        Whether `turn` is more than unity; whether its centre of mass is its joint point, with a quaternion and nothing
        hanging on it: then its turning is that of a body alone.
    number
        Of the body in the scene.
    offset, centre
        From the joint point of the parent to that of this body, axes of the parent; from the joint point to the centre
        of mass, principal axes [m].
    axis
        Of a hinge in principal axes, of a slider in axes of the parent.
    turn
        Constant part of the rotation.
    x, y
        Axes of the joint frame of b in principal axes of b.
    mass, inertia, reach, length
        [kg]; principal [kg m2]; distance of what is attached, and that of a distance joint [m].
    R, q
        Rotation of the principal axes.
    arm, along, moving, to_centre
        From the joint point of the parent, without the length of a distance; axis or direction, and the rate of the
        latter; to the centre of mass.
    spin, position, velocity
        The latter of the joint point; filled if somebody looks at bodies.
    A, B, M, moment, force
        Articulated inertia and bias: ``n = A alpha + B a + moment``, ``f = B^T alpha + M a + force``; A and M as
        xx, xy, xz, yy, yz, zz.
    hinge_moment, hinge_force, compliance, drive
        Inertia times axis; inverse of its part along the axis; what moves the coordinate.
    inverse, inverse_mass
        Of A, and for what floats of the mass that is left.
    turning, shifting
        Velocity-product accelerations.
    alpha, a
        Accelerations of the body and its joint point.
    error5, error3
        Errors of the velocity of the joint point and of the spin.
    row_moment, row_force, row_drive, row_alpha, row_a
        As `moment`, `force`, `drive`, `alpha` and `a`, of a single row.
    """

    parent: int
    joint: int
    place: int
    speed: int
    dof: int
    pose: int
    block: int
    turned: int
    alone: int
    number: int
    sign: float
    mass: float
    reach: float
    length: float
    offset: Vector
    centre: Vector
    axis: Vector
    turn: Quaternion
    x: Vector
    y: Vector
    inertia: Vector
    R: Matrix9
    q: Quaternion
    arm: Vector
    along: Vector
    moving: Vector
    to_centre: Vector
    spin: Vector
    A: Vector6
    B: Matrix9
    M: Vector6
    moment: Vector
    force: Vector
    hinge_moment: Vector
    hinge_force: Vector
    compliance: float
    drive: float
    inverse: Vector6
    inverse_mass: Vector6
    turning: Vector
    shifting: Vector
    alpha: Vector
    a: Vector
    position: Vector
    velocity: Vector
    error5: Vector6
    error3: Vector6
    row_moment: Vector
    row_force: Vector
    row_drive: float
    row_alpha: Vector
    row_a: Vector


class LoopRow(Record):
    """A row that no joint of a tree replaces.

    Attributes
    ----------
    block, row
        Where it is in the system.
    a, b
        Its bodies in the forest, or `GROUNDED`.
    first, last, second, end
        Ranges of the bodies in their trees; the latter is empty if there is one tree only.
    path, path_end
        Where its bodies and all that they hang on stand in the paths, the last ones first.
    kept
        Whether it does not follow from others; -1 as long as nobody knows.
    force_a, moment_a, force_b, moment_b
        What a unit of it exerts on the bodies, about their joint points, world axes.
    target, pull, own, inverse, rest
        What it wants, and the force that gives it; its part of the matrix of the rows, of the inverse factor, and of a
        right-hand side.
    """

    block: int
    row: int
    a: int
    b: int
    first: int
    last: int
    second: int
    end: int
    path: int
    path_end: int
    kept: int
    force_a: Vector
    moment_a: Vector
    force_b: Vector
    moment_b: Vector
    target: float
    pull: float
    own: float
    inverse: float
    rest: float


class JointRecord(Record):
    """What a joint of a tree records, where no rows are needed for it.

    Attributes
    ----------
    reaction, turn, slide
        Record columns, -1 for what it does not have.
    offset
        Of the coordinate from the recorded angle [rad]: whole turns.
    force, moment
        On side b at its point, world axes.
    coordinate, rate
        Angle or travel, and its rate.
    """

    reaction: int
    turn: int
    slide: int
    offset: float
    force: Vector
    moment: Vector
    coordinate: float
    rate: float


class Forest(Arrays):
    """All trees of a scene, and the rows that hold them together.

    Attributes
    ----------
    bodies
        Parents before their children.
    poses
        State vector of all bodies as their kind reads it: velocities, then poses.
    velocities, coordinates
        How many a state vector of the trees begins with, and how many follow.
    spun
        Whether there are quaternions, whose steps must not turn too far.
    loaded
        Whether forces act on markers.
    rows
        Those of the joints, which the trees give their reactions.
    seen
        The bodies with the markers that evaluations need: not those of the joints of trees.
    pushed
        Numbers of all markers but the latter.
    joints
        Those that are not in trees; where trees record theirs, what records beside joints.
    recorded
        What the joint of each body records; none where rows are needed for it: with loops, or bodies that are held.
    violation
        Record column of the largest violation, behind which are the smallest pivot and the largest drift of a law.
    loops
        Rows of the joints that are not in trees.
    paths
        Bodies of these rows, see there.
    order
        Numbers of the rows that are kept, and at the end how many these are.
    answers
        Accelerations of all coordinates by each row that is kept, then the matrix of these rows; flat.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("loops", "recorded")

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.integrate.trees.stage",
        "heavylift.solver.integrate.trees.record",
    )

    bodies: Records[TreeBody]
    poses: Floats1
    velocities: int
    coordinates: int
    spun: bool
    loaded: bool
    rows: RowArrays
    seen: Bodies
    pushed: Ints1
    joints: Joints
    recorded: Records[JointRecord]
    violation: int
    loops: Records[LoopRow]
    paths: Ints1
    order: Ints1
    answers: Floats1

    def keep_rows(self, rows: NDArray[np.int64], kept: NDArray[np.bool_]) -> None:
        """Leave rows out that follow from others; as of `Integration`."""
        chosen = dict(zip(rows.tolist(), kept.tolist(), strict=True))
        self.loops["kept"] = [
            chosen[place] for place in self.loops["block"] * self.rows.lanes + self.loops["row"]
        ]

    def write_tree_state(self, kinds: Bodies, values: Floats1) -> None:
        """Coordinates and velocities of the carried state of bodies into a state vector."""
        _clear_pivots(self.rows)
        for kind in kinds:
            kind.write_state(self.poses)
        ground = (np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
        states = []
        for one in self.bodies:
            pose, twist = self.poses[one.pose : one.pose + 7], self.poses[one.dof : one.dof + 6]
            q = pose[3:] / math.sqrt(float(pose[3:] @ pose[3:]))
            R = rotation_matrix(q)
            spin, arm = R @ twist[3:], R @ one.centre
            own = (R, pose[:3] - arm, twist[:3] - np.cross(spin, arm), spin, q)
            states.append(own)
            parent = ground if one.parent == GROUNDED else states[one.parent]
            place, speed = self.velocities + one.place, one.speed
            if one.joint == DISTANCE:
                arm = parent[0] @ one.offset
                values[place : place + 3] = (own[1] - parent[1] - arm) / one.length
                values[place + 3 : place + 7] = q
                values[speed : speed + 3] = (own[2] - parent[2] - np.cross(parent[3], arm)) / one.length
                values[speed + 3 : speed + 6] = twist[3:]
            if one.joint in (BALL, FLOATING):
                count = SPEEDS[one.joint]
                values[place : place + count + 1] = np.concatenate([pose[:3], q])[-count - 1 :]
                values[speed : speed + count] = twist[-count:]
            if one.joint >= BALL:
                continue
            base = in_python(quaternion_product)(tuple(parent[4].tolist()), tuple(one.turn.tolist()))
            back = (base[0], -base[1], -base[2], -base[3])
            turn = np.array(in_python(quaternion_product)(back, tuple(q.tolist())))
            if one.joint == HINGE:  # up to a whole turn, for the quaternion to get its sign
                values[place] = 2.0 * math.atan2(float(one.axis @ turn[1:]), turn[0])
                if len(self.recorded):
                    self.recorded[len(states) - 1].offset = math.tau * round(values[place] / math.tau)
                values[speed] = (R @ one.axis) @ (spin - parent[3])
            elif turn[0] < 0.0:
                one.turn[:], one.turned = -one.turn, 1
            if one.joint == SLIDER:
                along, arm = parent[0] @ one.axis, own[1] - parent[1]
                values[place] = along @ (arm - parent[0] @ one.offset)
                values[speed] = along @ (own[2] - parent[2] - np.cross(parent[3], arm))


def _length(joint: Any, kind: Any, names: dict[str, int]) -> float:
    """What a distance joint keeps [m]: as at the start if nothing is given."""
    if joint.length is not None:
        return float(joint.length)
    ends = []
    for name, frame in ((joint.body_a, joint.frame_a), (joint.body_b, joint.frame_b)):
        if names[name] == GROUNDED:
            ends.append(frame.point)
            continue
        one = kind.frame[names[name]]
        arm = rotation_matrix(one.axes).T @ (frame.point - one.centre)
        ends.append(one.position + rotation_matrix(one.orientation) @ arm)
    return float(np.linalg.norm(ends[1] - ends[0]))


def _clear_pivots(system: Any) -> None:
    """Joints of trees are no equations, so there is no pivot smaller than the characteristic inverse mass."""
    for column in system.columns:
        places = column.pivot + np.arange(system.lanes) * (system.lanes + 1)
        scale = system.rows[column.node].scale
        system.blocks[places] = 1.0 / np.where(scale > 0.0, scale, 1.0)


def make_forest(scene: Scene, layout: Layout) -> Forest | None:
    """Trees of the bodies of a scene; None without any, or where something needs all rows.

    Parameters
    ----------
    scene, layout
        The scene as described, which knows the types of joints, and packed.
    """
    joints = scene.joints
    blocks = sum(len(system.attachments) // 2 for system in layout.systems)
    if not SERVED or not joints or blocks != len(joints) or len(layout.bodies) != 1:
        return None
    kind = layout.bodies[0]
    if not begin_stage.serves(type(kind)) or kind.NODAL or (kind.table["motion"] == DRIVEN).any():
        return None
    return _plant(joints, layout, kind)


def _carries(joint: Joint) -> bool:
    """Whether a joint can be one of a tree: rigid, of a known type, without a drive."""
    known = KNOWN.get(joint.WORD)
    fits = known is not None and known[1] == joint.ROWS
    return fits and joint.compliance == 0.0 and getattr(joint, "drive", None) is None


def _moves(joint: Joint, names: dict[str, int], free: NDArray[np.bool_]) -> bool:
    """Whether a joint has a body that is free."""
    return any(names[name] >= 0 and bool(free[names[name]]) for name in (joint.body_a, joint.body_b))


def _plant(joints: Sequence[Joint], layout: Layout, kind: Any) -> Forest | None:
    """Grow trees from the ground, then from the heaviest body of what is left, each as low as it can be.

    The rows of all other joints are solved for together, densely: of more than some, those of all joints are cheaper.
    """
    names = {name: number for number, name in enumerate(layout.body_names)} | {GROUND: GROUNDED}
    block = {name: number for number, name in enumerate(layout.block_names)}
    free = kind.table["motion"] == FREE
    at: dict[int, list[tuple[Joint, int]]] = {}
    for joint in filter(_carries, joints):
        ends = [names[name] for name in (joint.body_a, joint.body_b)]
        ends = [end if end >= 0 and free[end] else GROUNDED for end in ends]
        for end, other in (ends, ends[::-1]):
            at.setdefault(end, []).append((joint, other))
    axes = [rotation_matrix(q) for q in kind.frame["axes"]]
    found: dict[int, tuple[int, int, Joint | None]] = {GROUNDED: (GROUNDED, GROUNDED, None)}
    weight = np.argsort(-kind.frame["mass"], kind="stable").tolist()
    for root in (GROUNDED, *(number for number in weight if free[number])):
        if root not in found:
            found[root] = (root, GROUNDED, None)
        elif root != GROUNDED:
            continue
        for parent in (layer := [root]):
            for joint, child in at.get(parent, ()):
                if child not in found:
                    tree = child if parent == GROUNDED else found[parent][0]
                    found[child] = (tree, parent, joint)
                    layer.append(child)
    used = {joint.name for _, _, joint in found.values() if joint is not None}
    rest = {block[joint.name] for joint in joints if joint.name not in used}
    if any(joint.name not in used and not _moves(joint, names, free) for joint in joints):
        return None
    system = layout.systems[0]
    count = sum(int(np.count_nonzero(system.rows[one].scale)) for one in rest)
    if not used or count > MOST_ROWS or (rest and any(hasattr(one, "profiles") for one in layout.joints)):
        return None
    of_tree: dict[int, list[int]] = {}
    for number, (tree, _, _) in found.items():
        if number != GROUNDED:
            of_tree.setdefault(tree, []).append(number)
    place_of: dict[int, int] = {GROUNDED: GROUNDED}
    range_of: dict[int, tuple[int, int]] = {GROUNDED: (0, 0)}
    bodies: list[Any] = []
    for numbers in of_tree.values():
        ends_of_tree = len(bodies), len(bodies) + len(numbers)
        for number in numbers:
            _, parent, carrying = found[number]
            if carrying is None:
                body = _body(kind, number, FLOATING)
            else:
                on = bodies[place_of[parent]] if parent >= 0 else None
                body = _hang(carrying, kind, axes, names, parent, number, on)
                body.block = block[carrying.name]
            body.parent = place_of[parent]
            place_of[number], range_of[number] = len(bodies), ends_of_tree
            bodies.append(body)
    place = speed = 0
    for body in bodies:
        body.place, body.speed = place, speed
        place, speed = place + PLACES[body.joint], speed + SPEEDS[body.joint]
    coordinates, end = kind.place_coordinates(len(layout.work.velocity))
    for body in bodies:
        body.dof, body.pose = coordinates[body.number]["velocity"], coordinates[body.number]["place"]
    made = records(TreeBody, bodies)
    if not rest:
        at_centre = (made["joint"] >= BALL) & ~made["centre"].any(axis=1)
        made["alone"] = at_centre & ~np.isin(np.arange(len(made)), made["parent"])
    loops: list[LoopRow] = []
    paths: list[int] = []
    for joint in joints:
        if joint.name in used:
            continue
        ends = [names[name] for name in (joint.body_a, joint.body_b)]
        ends = [end if end >= 0 and free[end] else GROUNDED for end in ends]
        ranges = sorted({range_of[end] for end in ends if end != GROUNDED})
        (first, last), (second, beyond) = ranges[0], ranges[1] if len(ranges) > 1 else (0, 0)
        path: set[int] = set()
        for number in ends:
            above = place_of[number]
            while above != GROUNDED:
                path.add(above)
                above = int(made[above].parent)
        begin = len(paths)
        paths += sorted(path, reverse=True)
        for row in np.flatnonzero(system.rows[block[joint.name]].scale).tolist():
            made_row = LoopRow.one()
            made_row.block, made_row.row, made_row.kept = block[joint.name], row, -1
            made_row.a, made_row.b = place_of[ends[0]], place_of[ends[1]]
            made_row.first, made_row.last, made_row.second, made_row.end = first, last, second, beyond
            made_row.path, made_row.path_end = begin, len(paths)
            loops.append(made_row)
    blocks = {block[name] for name in used}
    carried_by = {place_of[number]: joint for number, (_, _, joint) in found.items()}
    recorded: list[JointRecord] = []
    if not rest and free.all():
        column_of = {channel.name: channel.column for channel in layout.channels}
        recorded = [_recorded(carried_by[i], column_of) for i in range(len(made))]
        left = [one for one in layout.joints if not _markers_of(one, blocks)]
    else:
        left = [one for one in (_of_blocks(one, rest) for one in layout.joints) if one is not None]
    own = {marker for one in layout.joints for marker in _markers_of(one, blocks)}
    if recorded:
        own |= {marker for one in layout.joints if one not in left for marker in _watched_by(one)}
    markers = kind.markers[~np.isin(kind.markers["number"], list(own))]
    if not recorded:
        markers = markers[markers["level"] != RECORD]
    count = len(loops)
    return Forest(
        bodies=made,
        poses=np.zeros(end),
        velocities=speed,
        coordinates=place,
        spun=bool((made["joint"] >= BALL).any()),
        loaded=bool((kind.markers["level"] == FORCES).any()),
        rows=system,
        seen=Bodies(
            [kind._replace(markers=records(kind.markers.dtype.type, list(markers)))], layout.bodies.groups
        ),
        pushed=np.array(sorted(set(range(len(layout.work.markers))) - own), dtype=np.int64),
        joints=Joints(left, layout.joints.groups),
        recorded=records(JointRecord, recorded),
        violation=system.monitor,
        loops=records(LoopRow, loops),
        paths=np.array(paths, dtype=np.int64),
        order=np.zeros(count + 1, dtype=np.int64),
        answers=np.zeros(count * (speed + count + 1)),
    )


MARKERS = ("a", "b", "c", "point_a", "point_b")
"""Fields of the rows of joints that trees can have: numbers of markers, -1 for none."""


def _markers_of(kind: Any, blocks: set[int]) -> set[int]:
    """Markers that serve some blocks of rows alone."""
    found: set[int] = set()
    for name in kind._fields:
        value = getattr(kind, name)
        if isinstance(value, Arrays):
            found |= _markers_of(value, blocks)
        elif isinstance(value, np.ndarray) and "block" in (value.dtype.names or ()):
            rows = value[np.isin(value["block"], list(blocks))]
            for field in set(MARKERS) & set(value.dtype.names or ()):
                found |= set(rows[field].tolist())
    return found - {-1}


def _watched_by(kind: Any) -> set[int]:
    """Markers of the angles and travels that a kind of joints records: those of an entry are a record in it."""
    found: set[int] = set()
    for value in kind:
        for field in getattr(value, "dtype", np.dtype(float)).names or ():
            markers = value[field]
            found |= {number for name in markers.dtype.names or () for number in markers[name].tolist()}
    return found


def _recorded(joint: Joint | None, columns: dict[str, int]) -> JointRecord:
    """Where the joint of a body records, by the columns of all channels; nowhere without one."""
    one = JointRecord.one()
    one.reaction, one.turn, one.slide = (
        -1 if joint is None else columns.get(f"{joint.name}.{channel}", -1)
        for channel in ("reaction_force", "angle", "travel")
    )
    return one


def stepped(layout: Layout) -> tuple[Bodies, Forces, Joints, Systems, Workspace]:
    """The tables that the integrator steps and records: where trees record their joints, these are no rows."""
    for place, forest in enumerate(layout.systems):
        if isinstance(forest, Forest) and len(forest.recorded):
            systems = Systems(layout.systems.kinds[place:], layout.systems.groups)
            return forest.seen, layout.forces, forest.joints, systems, layout.work
    return layout.bodies, layout.forces, layout.joints, layout.systems, layout.work


def _of_blocks(kind: Any, rest: set[int]) -> Any:
    """A kind of joints with those of some blocks alone; None without any. What only records is left as it is."""
    changes: dict[str, Any] = {}
    kept = False
    for name in kind._fields:
        value = getattr(kind, name)
        if isinstance(value, Arrays):
            part = _of_blocks(value, rest)
            kept |= part is not None
            changes[name] = part
        elif isinstance(value, np.ndarray) and "block" in (value.dtype.names or ()):
            wanted = np.isin(value["block"], list(rest))
            kept |= bool(wanted.any())
            if not wanted.all():
                changes[name] = records(value.dtype.type, list(value[wanted]))
    if not kept:
        return None
    return kind._replace(
        **{name: getattr(kind, name) if value is None else value for name, value in changes.items()}
    )


def _body(kind: Any, number: int, joint: int) -> TreeBody:
    """What is known of a body without its joint."""
    frame, one = kind.frame[number], TreeBody.one()
    one.number, one.joint, one.parent, one.block = number, joint, GROUNDED, -1
    one.mass, one.reach, one.inertia[:] = frame.mass, frame.reach, frame.principal_inertia
    one.turn[0] = 1.0
    return one


def _hang(
    joint: Joint,
    kind: Any,
    axes: Sequence[NDArray[np.float64]],
    names: dict[str, int],
    parent: int,
    child: int,
    above: TreeBody | None,
) -> TreeBody:
    """A body on its parent, or on the ground or a body that is held."""
    type_of = KNOWN[joint.WORD][0]
    body = _body(kind, child, type_of)
    own, other, on, body.sign = joint.frame_b, joint.frame_a, joint.body_a, 1.0
    if names[joint.body_b] != child:
        own, other, on, body.sign = joint.frame_a, joint.frame_b, joint.body_b, -1.0
    T, frame = axes[child], kind.frame[child]
    to_own, point = T.T @ own.axes, T.T @ (own.point - frame.centre)
    if above is not None:
        T, frame = axes[parent], kind.frame[parent]
        to_other = T.T @ other.axes
        offset = T.T @ (other.point - frame.centre) + above.centre
    elif names[on] == GROUNDED:
        to_other, offset = other.axes, other.point
    else:  # a body that is held: the ground, from its principal axes
        held = names[on]
        T, frame = axes[held], kind.frame[held]
        R = rotation_matrix(frame.orientation)
        to_other = R @ T.T @ other.axes
        offset = frame.position + R @ T.T @ (other.point - frame.centre)
    body.centre[:], body.offset[:] = -point, offset
    if type_of == DISTANCE:
        body.length = _length(joint, kind, names)
    body.turn[:] = quaternion_from_matrix(to_other @ to_own.T)
    body.turned = int(np.abs(body.turn[1:]).max() > 0.0)
    of_b = to_own if body.sign > 0.0 else to_other
    body.x[:], body.y[:] = of_b[:, 0], of_b[:, 1]
    body.axis[:] = to_other[:, 2] if type_of == SLIDER else to_own[:, 2]
    return body
