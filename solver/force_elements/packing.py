"""What a scene has beside its joints: ropes, springs, stops, friction and motors, made into kinds and rows.

The default integrator takes springs as rows and everything with a corner as a row with a law. The accurate one
takes springs and ropes as forces, and none of the others; the first-order one takes linear springs as rows and
tables as forces.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import filled, records
from heavylift.solver.force_elements.line_bearing import LineBearing, pack_bearings
from heavylift.solver.force_elements.system import LawBlock
from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.forces.spring import JointSpring, Spring
from heavylift.solver.interface import FORCES, ROWS
from heavylift.solver.joints.coordinate import (
    ANGLE,
    DISTANCE,
    TRAVEL,
    joint_coordinate,
    joint_markers,
    spring_markers,
)
from heavylift.solver.joints.packing import start_frames
from heavylift.solver.joints.registry import largest_opening
from heavylift.solver.markers import MarkerBook
from heavylift.solver.scene.channels import ChannelBook
from heavylift.solver.scene.connections import (
    GROUND,
    ControlOutputs,
    Joint,
    Limits,
    as_joint,
    controlled,
    rubbing_places,
)
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.sliding_joints import joint_friction, joint_stops

if TYPE_CHECKING:
    from heavylift.solver.force_elements.watched import WatchedRopes
    from heavylift.solver.rows.structure import Attachment
    from heavylift.solver.scene.scene import Scene

__all__ = ["STOP_RATE", "PackedLaws", "add_law_channels", "law_owners", "pack_laws"]

STOP_RATE = 400.0
"""Frequency [rad/s] on the characteristic mass of the joint that a stop gets if no stiffness is given."""

SLOWEST_RATE = 1e-9
"""Stiffness over damping [1/s] of a row that is a damper only."""


@dataclass
class PackedLaws:
    """Kinds for the tables of joints and of forces, the blocks of their rows, whether any is fitted."""

    joints: list[Any] = field(default_factory=list)
    forces: list[Any] = field(default_factory=list)
    blocks: list[LawBlock] = field(default_factory=list)
    fitted: bool = False

    @property
    def block_names(self) -> tuple[str, ...]:
        """Whom each block belongs to."""
        return tuple(block.name for block in self.blocks for _ in range(block.block_count))


def law_owners(scene: Scene) -> list[Any]:
    """Ropes, transporters, springs, motors and bearings: what has channels of its own, in their order."""
    return [
        *scene.ropes,
        *scene.transporters,
        *(f for f in scene.forces if isinstance(f, (Spring, JointSpring, JointMotor, LineBearing))),
    ]


def add_law_channels(owner: Any, joints: Mapping[str, Joint], record: ChannelBook) -> Columns:
    """Append the channels of one of them."""
    if isinstance(owner, (JointSpring, JointMotor)):
        turns = joint_coordinate(joints[owner.joint], owner) == ANGLE
        load = owner.CHANNEL_BY_COORDINATE["angle" if turns else "travel"]
        return record.add(owner.name, [load])
    parts = len(owner.path) - 1 if hasattr(owner, "path") else 1
    rubbing = tuple(str(place) for place in rubbing_places(owner))
    segments = tuple(str(i + 1) for i in range(parts))
    chosen = {
        "segment_tension": segments,
        **dict.fromkeys(("segment_tension_max", "segment_tension_min"), segments if rubbing else ()),
        "sheave_speed": rubbing,
        "sheave_state": rubbing,
    }
    chosen = getattr(owner, "components", chosen)
    absent = () if controlled(owner) else ControlOutputs.CHANNELS
    kinds = [kind for kind in owner.CHANNELS if kind not in absent and kind.columns(chosen)]
    return record.add(owner.name, kinds, chosen)


@dataclass
class _Packing:
    """What all parts need while a scene is packed."""

    scene: Scene
    columns: dict[str, Columns]
    book: MarkerBook
    attachment: Callable[[str], Attachment]
    scales: Callable[[str], tuple[float, float]]
    first_block: int
    made: PackedLaws = field(default_factory=PackedLaws)
    block_count: int = 0

    def add(self, block: LawBlock) -> int:
        """Number of a new block."""
        number = self.first_block + self.block_count
        self.made.blocks.append(block)
        self.block_count += block.block_count
        return number

    def scale(self, bodies: Sequence[str], *, turns: bool) -> float:
        """Characteristic inverse mass or inertia."""
        return sum(self.scales(name)[1 if turns else 0] for name in bodies if name != GROUND)


def pack_laws(
    scene: Scene,
    columns: dict[str, Columns],
    book: MarkerBook,
    attachment: Callable[[str], Attachment],
    scales: Callable[[str], tuple[float, float]],
    watched: WatchedRopes,
    *,
    first_block: int,
    integrator: str,
) -> PackedLaws:
    """Make kinds and rows.

    Parameters
    ----------
    scene
        Checked for names.
    columns
        First record column of each of `law_owners`.
    book, attachment, scales
        As for joints.
    watched
        Ropes whose pulls something watches.
    first_block
        Number of blocks that joints take.
    integrator
        Name: it decides which springs are rows.

    Raises
    ------
    InputError
        If something has no stiffness, a falling or empty table, coincident ends, or a joint without angle or travel.
    """
    packing = _Packing(scene, columns, book, attachment, scales, first_block)
    made = packing.made
    shared = [rope for rope in scene.ropes if rope.WORD == "equalized"]
    if shared:
        from heavylift.solver.force_elements.equalized_packing import pack_equalized

        groups = [[rope for rope in shared if (rope.efficiency < 1.0) is rubs] for rubs in (False, True)]
        for group in filter(None, groups):
            lines = pack_equalized(
                group,
                [columns[rope.name] for rope in group],
                book,
                attachment,
                scales,
                scene.bodies,
                packing.add,
                watched,
                integrator=integrator,
            )
            made.joints.append(lines)
        made.fitted = True
        scene = replace(scene, ropes=tuple(rope for rope in scene.ropes if rope not in shared))
    springs: list[tuple[Spring | JointSpring, NDArray[np.float64], bool]] = []
    cornered: list[tuple[Spring | JointSpring, NDArray[np.float64]]] = []
    for force in scene.forces:
        if isinstance(force, (Spring, JointSpring)):
            table = _table(force)
            _check_spring(force, scene)
            if integrator == "dele2" and len(table):
                cornered.append((force, table))
            else:
                as_row = integrator != "accurate" and not len(table) and (force.stiffness or force.damping)
                springs.append((force, table, bool(as_row)))  # nothing at all is no row
    if springs:
        _pack_springs(packing, springs)
    motors = [force for force in scene.forces if isinstance(force, JointMotor)]
    if motors:
        from heavylift.solver.forces.motor import pack_motors

        driving = pack_motors([(motor, _motor(packing, motor)) for motor in motors])
        made.forces.append(driving)
        made.joints.append(driving)
    _pack_scalar_laws(packing, cornered)
    bearings = [force for force in scene.forces if isinstance(force, LineBearing)]
    if bearings:
        places = [columns[bearing.name] for bearing in bearings]
        made.joints.append(
            pack_bearings(bearings, places, scene.bodies, book, attachment, scales, packing.add)
        )
        made.fitted = True
    for ropes in _rope_groups(scene):
        from heavylift.solver.force_elements.rope_packing import pack_ropes

        kind, blocks = pack_ropes(
            ropes,
            [columns[rope.name] for rope in ropes],
            first_block + packing.block_count,
            book,
            attachment,
            scales,
            scene.bodies,
            {rope.name: rope for rope in scene.ropes},
            watched,
            as_forces=integrator == "accurate",
            at_rest=scene.at_rest,
        )
        made.joints.append(kind)
        made.blocks += blocks
        packing.block_count += sum(block.block_count for block in blocks)
        if integrator == "accurate":
            made.forces.append(kind)
        else:
            made.fitted = True
    if scene.transporters:
        from heavylift.solver.transport.packing import pack_transporters

        kinds, blocks = pack_transporters(
            scene,
            [columns[vehicle.name] for vehicle in scene.transporters],
            first_block + packing.block_count,
            book,
            attachment,
            scales,
        )
        made.joints += kinds
        made.blocks += blocks
        made.fitted = True
    return made


def _rope_groups(scene: Scene) -> list[list[Any]]:
    """Ropes that are planned, those with sheaves that rub, and those with a control: a kind each, if there are any."""
    groups: tuple[list[Any], list[Any], list[Any]] = [], [], []
    for rope in scene.ropes:
        groups[1 if rubbing_places(rope) else 2 if controlled(rope) else 0].append(rope)
    return [group for group in groups if group]


def _table(force: Spring | JointSpring) -> NDArray[np.float64]:
    """Rows (elongation, force), shape (n, 2); none of a linear spring."""
    x, y = (np.asarray(column, dtype=np.float64) for column in force.curve)
    if np.any(np.diff(y) < 0.0):
        i = int(np.argmax(np.diff(y) < 0.0))
        raise InputError(
            f"the force falls from {y[i]:g} to {y[i + 1]:g} between {x[i]:g} and {x[i + 1]:g}",
            source=force.name,
            key="forces" if isinstance(force, Spring) else "loads",
            expected="a force that does not fall with the elongation",
        )
    return np.column_stack([x, y])


def _check_spring(force: Spring | JointSpring, scene: Scene) -> None:
    """Refuse ends of a spring between points that coincide."""
    if not isinstance(force, Spring):
        return
    ends = start_frames(as_joint(force), scene.bodies)
    distance = float(np.linalg.norm(ends[1].point - ends[0].point))
    if not distance > 1e-9 * (1.0 + float(np.abs(ends[0].point).max())):
        raise InputError(
            f"its ends are {distance:.3g} m apart at the start",
            source=force.name,
            key="points",
            expected="ends apart from each other: a spring has no direction there",
        )


def _sides(packing: _Packing, force: Any) -> tuple[int, Joint]:
    """Coordinate on which a spring or motor acts, and its joint or what stands for it."""
    if isinstance(force, Spring):
        return DISTANCE, as_joint(force)
    joint = next(joint for joint in packing.scene.joints if joint.name == force.joint)
    return joint_coordinate(joint, force), joint


def _spring(
    packing: _Packing, force: Spring | JointSpring, first: int, count: int, *, as_row: bool
) -> dict[str, Any]:
    """Fields of the entry of a spring, whose curve has a first row and a number of rows."""
    coordinate, joint = _sides(packing, force)
    level = FORCES if force.damping > 0.0 or not as_row else ROWS
    if isinstance(force, Spring):
        markers, rest = spring_markers(packing.book, force, level), force.length
    else:
        markers, rest = joint_markers(packing.book, joint, coordinate, level), force.rest
    block = -1
    if as_row:
        k, c = (1.0, 0.0) if count else (force.stiffness, force.damping)  # a table is fitted by iteration
        k = max(k, SLOWEST_RATE * c)
        block = _block(packing, force.name, joint, coordinate, 1.0 / k, c / k)
    return {
        **_along(coordinate, markers, packing.columns[force.name]),
        "block": block,
        "rest": float(rest),
        "stiffness": force.stiffness,
        "damping": force.damping,
        "first": first,
        "count": count,
    }


def _along(coordinate: int, markers: tuple[int, int, int], column: int) -> dict[str, Any]:
    """Fields of a `CoordinateEntry`."""
    a, b, c = markers
    return {"coordinate": coordinate, "a": a, "b": b, "c": c, "column": column}


def _block(
    packing: _Packing,
    name: str,
    joint: Joint,
    coordinate: int,
    compliance: float = 1.0,
    relaxation: float = 0.0,
) -> int:
    """Number of a new block of one row between the bodies of a joint."""
    names = (joint.body_a, joint.body_b)
    sides = (packing.attachment(names[0]), packing.attachment(names[1]))
    scale = packing.scale(names, turns=coordinate == ANGLE)
    return packing.add(LawBlock(name, sides, scale, compliance, relaxation))


def _pack_springs(
    packing: _Packing, springs: Sequence[tuple[Spring | JointSpring, NDArray[np.float64], bool]]
) -> None:
    """Springs that are linear rows, and those that are forces: whether each is a row."""
    from heavylift.solver.forces.spring import SpringEntry, Springs, SpringState

    rows: list[SpringEntry] = []
    curves = [np.zeros((0, 2))]
    for force, curve, as_row in springs:
        entry = _spring(packing, force, sum(map(len, curves)), len(curve), as_row=as_row)
        rows.append(filled(SpringEntry, **entry))
        curves.append(curve)
    table, state = records(SpringEntry, rows), records(SpringState, len(rows))
    state["value"] = table["rest"]
    kind = Springs(table, np.vstack(curves), state)
    packing.made.joints.append(kind)
    if not all(as_row for _, _, as_row in springs):
        packing.made.forces.append(kind)


def _motor(packing: _Packing, motor: JointMotor) -> dict[str, Any]:
    """Fields of its entry but for its table."""
    coordinate, joint = _sides(packing, motor)
    markers = joint_markers(packing.book, joint, coordinate, FORCES)
    a, b = packing.attachment(joint.body_a), packing.attachment(joint.body_b)
    return {
        **_along(coordinate, markers, packing.columns[motor.name]),
        "dof_a": a.dof,
        "width_a": a.width,
        "dof_b": b.dof,
        "width_b": b.width,
    }


def _pack_scalar_laws(packing: _Packing, springs: Sequence[tuple[Any, NDArray[np.float64]]]) -> None:
    """Rows of tabulated springs, stops and friction."""
    limited = [(joint, *stop) for joint in packing.scene.joints for stop in joint_stops(joint)]
    rubbing = [(joint, *one) for joint in packing.scene.joints for one in joint_friction(joint)]
    if not (springs or limited or rubbing):
        return
    from heavylift.solver.force_elements.scalar_laws import (
        FRICTION,
        SPRING,
        STOP,
        ScalarLaw,
        ScalarLaws,
        ScalarLawState,
    )

    rows: list[ScalarLaw] = []
    curves: list[NDArray[np.float64]] = []
    expected: list[float] = []
    for force, curve in springs:
        entry = _spring(packing, force, sum(map(len, curves)), len(curve), as_row=True)
        coordinate, joint = _sides(packing, force)
        drift = largest_opening(joint, packing.scales, turns=coordinate == ANGLE)
        rows.append(
            filled(ScalarLaw, **entry, law=SPRING, lower=0.0, upper=0.0, largest=0.0, largest_drift=drift)
        )
        curves.append(curve)
        expected.append(float(force.length if isinstance(force, Spring) else force.rest))
    for joint, key, along, limits in limited:
        entry = _joint_row(packing, joint, along)
        _check_limits(joint, key, limits)
        rows.append(
            filled(
                ScalarLaw,
                **entry,
                stiffness=limits.stiffness or STOP_RATE**2 / packing.made.blocks[-1].scale,
                damping=limits.damping,
                law=STOP,
                lower=limits.lower,
                upper=limits.upper,
                largest=0.0,
                largest_drift=largest_opening(joint, packing.scales, turns=along == "angle"),
            )
        )
        ends = [end for end in (limits.lower, limits.upper) if np.isfinite(end)]
        expected.append(sum(ends) / len(ends) if ends else 0.0)
    for joint, key, along, friction in rubbing:
        if not 0.0 < friction < np.inf:
            raise InputError(f"{friction}", source=joint.name, key=key, expected="0 or more")
        rows.append(
            filled(
                ScalarLaw,
                **_joint_row(packing, joint, along),
                stiffness=0.0,
                damping=0.0,
                law=FRICTION,
                lower=0.0,
                upper=0.0,
                largest=friction,
                largest_drift=np.inf,
            )
        )
        expected.append(0.0)
    state = records(ScalarLawState, len(rows))
    state["fresh"], state["value"] = True, expected
    packing.made.joints.append(
        ScalarLaws(records(ScalarLaw, rows), np.vstack([np.zeros((0, 2)), *curves]), state)
    )
    packing.made.fitted = True


def _joint_row(packing: _Packing, joint: Any, along: str) -> dict[str, Any]:
    """Fields of a row on the angle or travel of a joint: it records nothing and has no table."""
    coordinate = ANGLE if along == "angle" else TRAVEL
    markers = joint_markers(packing.book, joint, coordinate, ROWS)
    block = _block(packing, joint.name, joint, coordinate)
    return {**_along(coordinate, markers, -1), "block": block, "rest": 0.0, "first": 0, "count": 0}


def _check_limits(joint: Any, place: str, limits: Limits) -> None:
    """Refuse stops of a joint that are none."""
    if not limits.lower < limits.upper:
        raise InputError(
            f"lower {limits.lower}, upper {limits.upper}",
            source=joint.name,
            key=place,
            expected="lower below upper",
        )
    for key in ("stiffness", "damping"):
        value = getattr(limits, key)
        if not 0.0 <= value < np.inf:
            raise InputError(f"{value}", source=joint.name, key=f"{place}.{key}", expected="0 or more")
