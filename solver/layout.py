"""Where everything lives: a scene of user objects becomes tables of kinds, a workspace and named channels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.solver.body_places import BodyPlaces, SeaPlaces
from heavylift.solver.coordinates import attachments, first_dofs, velocity_count
from heavylift.solver.interface import (
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
)
from heavylift.solver.kinds import STEP
from heavylift.solver.layout_rows import pack_connections
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.scene.channels import (
    Channel,
    ChannelBook,
    EnergyOutputs,
    MomentumOutputs,
    PhaseOutputs,
    TrackOutputs,
)
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.scene import (
    Driven,
    Profile,
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
    inputs
        What inputs drive, `heavylift.solver.inputs.targets.BoundInputs`, if there are any; their kind is among the
        forces.
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
    inputs: Any = None


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
    driving = any(one.DRIVES for one in scene.inputs)
    if scene.scenario is not None or driving:
        from heavylift.solver.scenario.packing import with_drives

        scene = with_drives(scene)
    if scene.sea is not None:
        from heavylift.solver.layout_sea import float_bodies

        scene = float_bodies(scene)
    groups_of_bodies = _kind_groups(scene)
    ordered = [body for group in groups_of_bodies for body in group]

    record = ChannelBook()
    places: dict[str, Columns] = {}
    for body in ordered:
        recorded = (*body.CHANNELS, *body.motion.CHANNELS)
        places[body.name] = record.add(body.name, recorded, body.components)
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
    afloat: SeaPlaces | None = None
    if scene.sea is not None and made.sea is not None:
        afloat = SeaPlaces(
            scene.sea,
            made.sea.tangents,
            made.sea.rate_tangents,
            made.sea.line_ends,
            of_ballast,
            0.0 if scene.touches else step,
            notes,
        )
    for group in groups_of_bodies:
        names = [body.name for body in group]
        where = BodyPlaces(
            number,
            [dofs[name] for name in names],
            [places[name] for name in names],
            book.of(names),
            _of_sensors(sensors, group),
            [made.moving.get(name, 0) for name in names],
            afloat,
        )
        bodies.append(group[0].kind_module.pack(group, where))
        number += len(group)
    forces: list[Any] = list(made.forces)
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
    profiles = np.zeros(0)
    if scene.scenario is not None or driving:
        from heavylift.solver.scenario.packing import reserve_tables, share_profiles

        moving, profiles = share_profiles(reserve_tables(kinds[:2], scene, channels), scene)
        # ropes that are forces are among the joints too, for their records
        changed = {id(old): new for old, new in zip(kinds[1], moving[1], strict=True)}
        forces = [changed.get(id(kind), kind) for kind in forces]
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

        names = [body.name for body in ordered if body.FLOATS]
        hulls = next(kind for kind in kinds[0] if kind.FLOATS)
        controllers = pack_controllers(scene.sea, hulls, names, of_ballast, step)
        forces.append(controllers)
        groups |= {SCENARIO}
    inputs = None
    if scene.inputs:
        from heavylift.solver.inputs.targets import bind_inputs

        inputs = bind_inputs(scene, kinds, forces, controllers, channels, profiles)
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
        inputs=inputs,
    )


def _moving(scene: Scene) -> dict[str, int]:
    """Points of frames and shells that contacts touch."""
    if not scene.touches:
        return {}
    from heavylift.solver.contact.moving_points import count_moving

    return count_moving(scene)


def _kind_groups(scene: Scene) -> list[list[Any]]:
    """Bodies by kind, in the order of the kinds; only modules of those that a scene has are imported."""
    groups: dict[tuple[int, str], list[Any]] = {}
    for body in scene.bodies:
        groups.setdefault((body.ORDER, body.KIND_MODULE), []).append(body)
    return [sorted(groups[key], key=lambda body: body.place_in_kind) for key in sorted(groups)]


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
        times += body.times
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
    # where an input stops to change, or cannot drive what it drives any more, is a corner too: two places each, behind
    # all others until they are used
    return np.append(
        np.unique([time for time in times if time > 0.0]), np.full(2 * len(scene.inputs), np.inf)
    )
