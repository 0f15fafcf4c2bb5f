"""Where everything lives: a scene of user objects becomes tables of kinds, a workspace and named channels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.coordinates import attachments, first_dofs, mode_count, velocity_count
from heavylift.solver.interface import (
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
)
from heavylift.solver.kinds import STEP
from heavylift.solver.layout_rows import pack_connections, point_forces
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.scene.channels import (
    Channel,
    ChannelBook,
    EnergyOutputs,
    MomentumOutputs,
    PhaseOutputs,
    TrackOutputs,
)
from heavylift.solver.scene.meshes import FrameBody, MeshBody, ShellBody
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.scene import (
    AnyBody,
    Driven,
    Fixed,
    FlexibleBody,
    Gravity,
    Profile,
    RigidBody,
    Scene,
)
from heavylift.solver.scene.speed_profiles import overshoot, speed_pieces
from heavylift.solver.scene_checks import check_scene

__all__ = ["Channel", "Layout", "pack_scene", "scene_corners"]


@dataclass(frozen=True, eq=False)
class Layout:
    """A packed scene.

    Attributes
    ----------
    bodies, forces, joints, systems
        Tuples of kinds; only kinds that have members. The system of the rows is there if there are joints.
    work
        Shared arrays.
    channels
        Meaning of the columns of a record.
    column_count
        Length of a record.
    body_names, block_names, line_names, deck_names, tank_names
        Names by number of the body, the block of rows, the mooring line, the deck and the tank, for messages.
    notes
        What the user should know of the scene.
    sequencer
        The scenario, if there is one; it is among the forces.
    controllers
        Those of ballast, if there are any; they are among the forces.
    """

    bodies: Bodies
    forces: Forces
    joints: Joints
    systems: Systems
    work: Workspace
    channels: tuple[Channel, ...]
    column_count: int
    body_names: tuple[str, ...]
    block_names: tuple[str, ...]
    line_names: tuple[str, ...] = ()
    deck_names: tuple[str, ...] = ()
    tank_names: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    sequencer: Any = None
    controllers: Any = None


def pack_scene(scene: Scene, integrator: str = "dele2", step: float = 0.0) -> Layout:
    """Turn a scene into kinds. A kind without members is not imported and not run.

    Parameters
    ----------
    scene
        The scene.
    integrator
        Name of the integrator: only the default one takes springs as rows of its step.
    step
        Length of all steps [s], 0 if they vary.

    Raises
    ------
    InputError
        If names repeat, a force or sensor names a body that is not there, or a value does not fit.
    """
    check_scene(scene)
    if scene.scenario is not None:
        from heavylift.solver.scenario.packing import with_drives

        scene = with_drives(scene)
    if scene.sea is not None:
        from heavylift.solver.layout_sea import float_bodies

        scene = float_bodies(scene)
    ordered = [body for group, _ in _groups(scene) for body in group]
    gravity = [force for force in scene.forces if isinstance(force, Gravity)]
    points = point_forces(scene)

    record = ChannelBook()
    places: dict[str, Columns] = {}
    for body in ordered:
        recorded = (*body.CHANNELS, *body.motion.CHANNELS)
        places[body.name] = record.add(body.name, recorded, _chosen(body))
    sensors: dict[str, list[tuple[int, Any]]] = {body.name: [] for body in ordered}
    for sensor in scene.sensors:
        columns = record.add(sensor.name, sensor.CHANNELS)
        sensors[sensor.body].append((columns, np.asarray(sensor.point, dtype=np.float64)))
    made = pack_connections(scene, ordered, record, integrator, _moving(scene))
    book, record = made.book, made.record
    dofs = first_dofs(ordered, made.bases)
    of_ballast: dict[str, Columns] = {}
    if scene.sea is not None:
        for one in (*scene.sea.tanks, *scene.sea.pumps, *scene.sea.controllers):
            of_ballast[one.name] = record.add(one.name, one.CHANNELS, getattr(one, "components", None))
    phases = Columns(record.width, ())
    if scene.scenario is not None:
        tracks = {"track_phase": tuple(track.name for track in scene.scenario.tracks)}
        beside = TrackOutputs.CHANNELS if scene.scenario.tracks else ()
        phases = record.add("scenario", (*PhaseOutputs.CHANNELS, *beside), tracks)
    record.add("energy", EnergyOutputs.CHANNELS)
    record.add("momentum", MomentumOutputs.CHANNELS)
    channels, width = record.channels, record.width

    notes: list[str] = [] if made.sea is None else list(made.sea.notes)
    notes += [*made.notes, *_overshoots(scene)]
    bodies: list[Any] = []
    number = 0
    for group, pack in _groups(scene):
        names = [body.name for body in group]
        place: Any = dofs[names[0]]
        pack_group = pack
        if isinstance(group[0], MeshBody):
            place = [dofs[name] for name in names]  # bodies without bases have no velocities
            pack_group = partial(pack, moving=[made.moving.get(name, 0) for name in names])
        elif made.sea is not None and _floats(group[0]):
            ends = made.sea.line_ends
            pack_group = partial(
                pack,
                sea=scene.sea,
                tangents=made.sea.tangents,
                rate_tangents=made.sea.rate_tangents,
                line_ends=ends,
                step=0.0 if scene.touches else step,
                notes=notes,
                columns=of_ballast,
            )
        of_sensors = _of_sensors(sensors, group)
        in_record = [places[name] for name in names]
        bodies.append(pack_group(group, number, place, in_record, book.of(names), of_sensors))
        number += len(group)
    forces: list[Any] = []
    if gravity:
        from heavylift.solver.forces.gravity import pack_gravity

        forces.append(pack_gravity(gravity))
    if points:
        from heavylift.solver.forces.point import pack_point_forces

        forces.append(pack_point_forces(points, made.first_markers))
    forces += made.forces
    if made.sea is not None:
        forces += made.sea.forces
    velocities = sum(velocity_count(body, made.bases) for body in ordered)
    if step > 0.0 and integrator == "dele2":
        from heavylift.solver.sensors.step_counts import pack_step_counts

        forces.append(pack_step_counts(step, velocities))
    widths = [end.width for end in map(attachments(ordered, dofs, made.bases), dofs)]
    work = Workspace.empty(
        velocities,
        book.count,
        max(6, *widths),
        scene_corners(scene),
    )
    for marker, vector in book.fixed:
        work.markers[marker].point[:] = vector
    kinds: tuple[Any, ...] = (tuple(bodies), tuple(made.joints), tuple(made.systems))
    if scene.scenario is not None:
        from heavylift.solver.scenario.packing import reserve_tables, share_profiles

        moving, profiles = share_profiles(reserve_tables(kinds[:2], scene, channels), scene.scenario)
        kinds = (*moving, kinds[2])
    if (
        scene.touches or scene.scenario is not None
    ):  # steps are taken back where something hits, or is to be done
        from heavylift.solver.carried import share_state

        kinds, carried = share_state(kinds)
    if scene.touches:
        contacts = kinds[2][-1]._replace(carried=carried, saved=carried.copy())
        kinds = (kinds[0], kinds[1], (*kinds[2][:-1], contacts))
    groups = {STEP, "record", integrator} | ({"contact"} if scene.touches else set())
    sequencer = None
    if scene.scenario is not None:
        from heavylift.solver.scenario.interface import SCENARIO
        from heavylift.solver.scenario.packing import pack_scenario

        copied = np.zeros(0) if scene.touches else carried
        sequencer = pack_scenario(scene, kinds, made.block_names, channels, phases, width, copied, profiles)
        forces.append(sequencer)
        groups |= {SCENARIO}
    controllers = None
    if scene.sea is not None and scene.sea.controllers:
        from heavylift.solver.scenario.interface import SCENARIO
        from heavylift.solver.water.hulls.controllers import pack_controllers

        names = [body.name for body in ordered if _floats(body)]
        hulls = next(kind for kind in kinds[0] if "hulls" in kind._fields)
        controllers = pack_controllers(scene.sea, hulls, names, of_ballast, step)
        forces.append(controllers)
        groups |= {SCENARIO}
    return Layout(
        bodies=Bodies(kinds[0], groups),
        forces=Forces(forces, groups),
        joints=Joints(kinds[1], groups),
        systems=Systems(kinds[2], groups),
        work=work,
        channels=tuple(channels),
        column_count=width,
        body_names=tuple(body.name for body in ordered),
        block_names=made.block_names,
        notes=tuple(notes),
        line_names=() if made.sea is None else made.sea.line_names,
        deck_names=tuple(deck.name for deck in scene.decks),
        tank_names=() if scene.sea is None else tuple(tank.name for tank in scene.sea.tanks_of(ordered)),
        sequencer=sequencer,
        controllers=controllers,
    )


def _moving(scene: Scene) -> dict[str, int]:
    """Points of frames and shells that contacts touch."""
    if not scene.touches:
        return {}
    from heavylift.solver.contact.moving_points import count_moving

    return count_moving(scene)


def _groups(scene: Scene) -> list[tuple[list[Any], Callable[..., Any]]]:
    """Bodies by kind with the function that packs them; only kinds with members are imported."""
    flexible = [body for body in scene.bodies if isinstance(body, FlexibleBody)]
    flexible.sort(key=lambda body: isinstance(body.motion, Fixed))
    rigid = [body for body in scene.bodies if isinstance(body, RigidBody) and not _floats(body)]
    hulls = [body for body in scene.bodies if _floats(body)]
    groups: list[tuple[list[Any], Callable[..., Any]]] = []
    if flexible:
        from heavylift.solver.bodies.floating_frame.packing import pack_floating_frames

        groups.append((flexible, pack_floating_frames))
    if rigid:
        from heavylift.solver.bodies.rigid.packing import pack_rigid_bodies

        groups.append((rigid, pack_rigid_bodies))
    if hulls:
        from heavylift.solver.water.hulls.packing import pack_hulls

        groups.append((hulls, pack_hulls))
    for of_type in (FrameBody, ShellBody):
        meshes = [body for body in scene.bodies if isinstance(body, of_type)]
        if meshes:
            from heavylift.solver.bodies.ancf.packing import pack_meshes

            groups.append((meshes, pack_meshes))
    return groups


def _chosen(body: AnyBody) -> dict[str, tuple[str, ...]]:
    """Components of the channels that have as many as a body has modes, nodes or elements."""
    if isinstance(body, MeshBody):
        from heavylift.solver.bodies.ancf.packing import mesh_columns

        return mesh_columns(body)
    modes = tuple(str(i + 1) for i in range(mode_count(body)))
    return {"modal_position": modes, "modal_velocity": modes}


def _floats(body: AnyBody) -> bool:
    """Whether a body is a hull."""
    return hasattr(body, "hull")


def _of_sensors(sensors: dict[str, list[tuple[int, Any]]], bodies: list[Any]) -> list[BodyMarkers]:
    return [
        BodyMarkers(
            tuple(column for column, _ in sensors[body.name]),
            tuple(point for _, point in sensors[body.name]),
            (False,) * len(sensors[body.name]),
        )
        for body in bodies
    ]


def _overshoots(scene: Scene) -> list[str]:
    """Drives that leave the values of their tables in between, as sentences."""
    drives = [(f"the drive of {joint.name!r}", getattr(joint, "drive", None)) for joint in scene.joints]
    for body in scene.bodies:
        if isinstance(body.motion, Driven):
            named = (f"the drive {key} of {body.name!r}" for key in ("x", "y", "z", "angle"))
            drives += zip(named, body.motion.profiles, strict=True)
    sentences = []
    for words, profile in drives:
        if profile is None:
            continue
        beyond, time = overshoot(profile)
        if beyond > 0.0:
            sentences.append(
                f"{words} leaves the values of its table by {beyond:.3g} at {time:.6g} s: take 'speeds', or"
                " interpolation 'monotone'"
            )
    return sentences


def scene_corners(scene: Scene) -> NDArray[np.float64]:
    """Positive times [s], increasing: rows of load, motor, winch and pump tables, ends of the tables of drives."""
    times: list[float] = []
    for force in scene.forces:
        times += list(np.ravel(getattr(force, "times", ())))
    for rope in scene.ropes:
        winch = getattr(rope, "winch", None)
        times += [] if winch is None or not len(winch.times) else list(winch.plan[:, 0])
    pumps = [
        group.pump for vehicle in scene.transporters for group in vehicle.groups if group.pump is not None
    ]
    times += [time for pump in pumps for time in pump.times]
    for body in scene.bodies:
        if isinstance(body, MeshBody):
            times += [time for load in body.loads for time in np.ravel(load.times)]
    if scene.sea is not None:
        times += [time for tank in scene.sea.tanks for time in tank.schedule[0]]
        times += [time for pump in scene.sea.pumps for time in pump.times]
        times += [] if scene.sea.water.tide is None else list(scene.sea.water.tide.times)
        turns = [field.direction for field in scene.sea.fields]
        times += [time for turn in turns if hasattr(turn, "times") for time in turn.times]
        times.append(scene.sea.ramp)
    profiles: list[Profile | None] = [getattr(joint, "drive", None) for joint in scene.joints]
    for body in scene.bodies:
        if isinstance(body.motion, Driven):
            profiles += body.motion.profiles
    for profile in profiles:
        if profile is None or not len(profile.times):
            continue
        if len(profile.speeds):
            times += list(
                speed_pieces(profile.times, profile.speeds, profile.acceleration, profile.jerk)[1:, 0]
            )
        elif profile.interpolation == "monotone":
            times += list(profile.times)
        else:
            times += [profile.times[0], profile.times[-1]]
    return np.unique([time for time in times if time > 0.0])
