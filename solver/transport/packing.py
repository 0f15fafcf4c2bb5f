"""Decks and transporters of a scene become one kind: loads at the start, whether they can stand, markers, rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import filled, records
from heavylift.solver.force_elements.system import ElementBlock
from heavylift.solver.interface import FORCES
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.guide import Guide
from heavylift.solver.recording import placed
from heavylift.solver.rows.structure import MOVES
from heavylift.solver.scene.bodies import Body
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.connectivity import connected_bodies
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.scene import Free, Scene
from heavylift.solver.scene.transport import BogieParts, LevellingParts, TransporterOutputs
from heavylift.solver.transport.decks import Deck, corner_table
from heavylift.solver.transport.levelling_growth import LevelledBogies, refuse_growing_levelling
from heavylift.solver.transport.path_packing import PathPacking, steering_at_start
from heavylift.solver.transport.places import Places
from heavylift.solver.transport.support_statics import (
    SupportStatics,
    Tipping,
    even_loads,
    refuse_unstable,
    tipping_angles,
)
from heavylift.solver.transport.transporters import (
    GAS_EXPONENT,
    GROUPS_A_BLOCK,
    BogieData,
    BogieState,
    DeckData,
    GroupData,
    GroupState,
    PumpRow,
    Transporter,
    Transporters,
    VehicleData,
    VehicleState,
)
from heavylift.solver.transport.tyre_packing import TyrePacking

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext
    from heavylift.solver.markers import MarkerBook

__all__ = ["pack", "vehicle_tipping"]


FAR_TOO_MUCH = 2.0
"""Loads over the weight that are taken for those of groups."""

LEAST_RISE = 0.5
"""Cosine of the angle of the normal of a deck to the vertical: steeper ones carry no wheels."""

ALIKE = 1e-3
"""Difference of heights of decks, and widths of overlaps, that are none [m]."""

SAMPLES = 25
"""Along and across an overlap of two decks."""


def pack(transporters: Sequence[Transporter], context: PackingContext) -> None:
    """Make the kinds and their rows.

    Raises
    ------
    InputError
        If a wheel has no road below it at the start, or too much load; a deck is too steep for a wheel; the groups
        cannot hold the body upright; or no load is given for a body whose weight is not known.
    """
    scene, book, attachment = context.scene, context.book, context.attachment
    decks: Sequence[Deck] = scene.decks
    _refuse_soft_decks(scene)
    corners, grids, deck_places = corner_table(decks)
    of_decks = records(DeckData, len(decks))
    for of_deck, deck, place in zip(of_decks, decks, deck_places, strict=True):
        of_deck.origin, of_deck.x, of_deck.y, of_deck.z = _deck_markers(deck, book)
        of_deck.first, of_deck.count, of_deck.across = place
        of_deck.begin, of_deck.end, of_deck.right, of_deck.left = deck.borders
    vehicles = records(VehicleData, len(transporters))
    groups: list[Any] = []
    bogies: list[Any] = []
    pumps: list[PumpRow] = []
    sides: list[list[int]] = []
    starts: list[list[float]] = []
    stands_on: list[int] = []
    strokes: list[float] = []
    blocks: list[ElementBlock] = []
    block = free_block = context.next_block
    paths, tyres = PathPacking(scene, book), TyrePacking(scene, book)
    gravity = scene.gravity
    for transporter in transporters:
        _check_names(transporter)
        for deck in decks:
            deck.check_radius(transporter.wheel_radius)
    all_places = [Places(transporter, scene) for transporter in transporters]
    _refuse_overturned(decks, all_places[0])
    _refuse_overlaps(decks, all_places[0])
    asks = any(deck.grid is not None for deck in decks)
    all_steerings = [
        steering_at_start(places.transporter, places) if asks else np.zeros(len(places.points))
        for places in all_places
    ]
    on_decks = [
        [places.on_decks(number, decks, steering) for number, steering in enumerate(steerings)]
        for places, steerings in zip(all_places, all_steerings, strict=True)
    ]
    loads_of = {
        places.transporter.name: loads
        for party in _parties(scene, all_places)
        for places, loads in zip(party, _start_loads(party, gravity), strict=True)
    }
    for v, (places, of_vehicle) in enumerate(zip(all_places, on_decks, strict=True)):
        vehicle, outputs = vehicles[v], context.column(places.transporter)
        transporter, loads = places.transporter, loads_of[places.transporter.name]
        weight = transporter.bogie_mass * float(np.linalg.norm(gravity))
        _check_loads(transporter, loads, weight)
        if weight and any(deck.body != GROUND for deck in decks):
            raise InputError(
                f"{transporter.bogie_mass:g} kg on a road with a deck on body "
                f"{next(deck.body for deck in decks if deck.body != GROUND)!r}",
                source=transporter.name,
                key="bogie_mass",
                expected="no 'bogie_mass' there: the mass of bogies belongs to the body that rides on them",
            )
        held = [
            transporter.body,
            *dict.fromkeys(d.body for d in decks if d.body not in {GROUND, transporter.body}),
        ]
        ends = list(dict.fromkeys(attachment(name) for name in held))
        scale = sum(context.scales(name)[0] for name in held)
        first_bogie = len(bogies)
        counts_of = [len(group.bogies) for group in transporter.groups]
        vehicle.first_group, vehicle.groups = len(groups), len(transporter.groups)
        vehicle.first_bogie, vehicle.bogies = first_bogie, len(places.points)
        vehicle.column = outputs.at(TransporterOutputs)
        vehicle.parts = placed(BogieParts, outputs)
        vehicle.x, vehicle.y, vehicle.z = (
            book.direction(transporter.body, axis, FORCES, at=places.points[0], turning=False)
            for axis in places.axes
        )
        vehicle.radius, vehicle.tyre = transporter.wheel_radius, transporter.tyre_stiffness
        vehicle.pipe, vehicle.rubber = transporter.line_damping, transporter.tyre_damping
        vehicle.low, vehicle.high = transporter.stops
        vehicle.weight = weight
        vehicle.driven, vehicle.speed = transporter.travel_speed is not None, transporter.travel_speed or 0.0
        vehicle.tyred = transporter.tyres is not None
        vehicle.start_height = float(places.world[:, 2].mean())
        vehicle.rest = float(np.repeat(loads, counts_of).mean()) or np.inf
        _fill_levelling(vehicle, transporter, outputs)
        level = (places.world - places.world.mean(axis=0)) @ places.level.T
        stands_on += [deck for deck, _, _ in of_vehicle]
        starts += [place for _, _, place in of_vehicle]
        lifts = [lift for _, lift, _ in of_vehicle]
        # see `heavylift.solver.transport.transporters`
        apart = places.body.mesh_nodes is not None and (
            transporter.line_damping + transporter.tyre_damping > 0.0
        )
        law = ElementBlock(transporter.name, tuple(ends), scale)
        for number, (group, load) in enumerate(zip(transporter.groups, loads, strict=True)):
            count = len(group.bogies)
            row_count, lane = (count, 0) if apart else (1, number % GROUPS_A_BLOCK)
            if lane == 0:
                shared = min(len(transporter.groups) - number, GROUPS_A_BLOCK)
                laws = [law] * count if apart else [replace(law, rows=shared)]
                block, free_block = free_block, free_block + len(laws) * law.block_count
                blocks += laws
            rows = (
                []
                if group.pump is None
                else list(zip(group.pump.times, count * group.pump.lifts, strict=True))
            )
            data = GroupData.one()
            data.vehicle, data.first, data.count = v, len(bogies), count
            data.block, data.lane, data.attachments = block, lane, len(ends)
            data.rows, data.apart = row_count, law.block_count
            data.stiffness, data.gas = group.oil_stiffness / count, group.gas_length * count
            data.start_force, data.constant, data.relief = load, group.constant_force, group.relief_force
            data.first_pump, data.pumps = len(pumps), len(rows)
            data.leak = count * group.leak_speed / load if group.leak_speed and load > 0.0 else 0.0
            data.ahead, data.aside = level[len(bogies) - first_bogie :][:count, :2].mean(axis=0)
            groups.append(data)
            if load >= group.relief_force:
                raise InputError(
                    f"{load:.6g} N of a cylinder of group {group.name!r} at the start",
                    source=transporter.name,
                    key="relief_force",
                    expected=f"a load below that at which its valve opens, {group.relief_force:.6g} N",
                )
            if group.leak_speed and not load > 0.0:
                raise InputError(
                    f"group {group.name!r} carries nothing at the start",
                    source=transporter.name,
                    key="leak_speed",
                    expected="a load at which it leaks",
                )
            pumps += [filled(PumpRow, time=time, lift=lift) for time, lift in rows]
            own = slice(len(bogies) - first_bogie, len(bogies) - first_bogie + count)
            # with the loads of the start every tyre is as it is drawn, and the stroke is what the road lifts
            strokes.append(sum(lifts[own]) + (float(np.interp(0.0, *np.transpose(rows))) if rows else 0.0))
            side = 2 * block + ends.index(attachment(transporter.body))
            step = 2 * law.block_count if row_count > 1 else 0
            for i, point in enumerate(np.asarray(group.bogies, dtype=np.float64)):
                place_of_bogie = places.pack(book, point)
                bogies.append(filled(BogieData, place=place_of_bogie, side=side + step * i, start_force=load))
            sides.append(
                [
                    -1 if deck.body == GROUND else 2 * block + ends.index(attachment(deck.body))
                    for deck in decks
                ]
            )
        on_path = np.repeat(loads, counts_of), weight
        if transporter.tyres is not None:
            # a block of three rows a body with decks, one of the drive
            made = tyres.add(
                transporter,
                places,
                (free_block, outputs),
                (first_bogie, stands_on[first_bogie:], *on_path),
                law,
                attachment,
            )
            blocks += made
            free_block += sum(law.block_count for law in made)
        else:
            tyres.skip(len(places.points))
        if transporter.legs and transporter.tyres is None:
            block = free_block
            side_of = {body: 2 * block + ends.index(attachment(body)) for body in held}
            on = stands_on[first_bogie:]
            paths.add(transporter, places, (block, len(ends), outputs), side_of, first_bogie, (on, *on_path))
            blocks.append(
                ElementBlock(
                    transporter.name, tuple(ends), scale, compliance=0.0, rows=3, vectors=(MOVES, MOVES, 0)
                )
            )
            free_block += blocks[-1].block_count
        else:
            paths.skip(len(places.points))
    state, of_bogies = records(GroupState, len(groups)), records(BogieState, len(bogies))
    of_groups = records(GroupData, groups)
    state["fresh"] = True
    state["force"], state["strokes"] = of_groups["start_force"], strokes
    of_bogies["deck"], of_bogies["weight"] = stands_on, 1.0
    kind = Transporters(
        of_decks,
        vehicles,
        of_groups,
        records(BogieData, bogies),
        records(PumpRow, pumps),
        corners,
        grids,
        np.array(sides, dtype=np.int64).reshape(len(groups), len(decks)),
        np.array(starts, dtype=np.float64).reshape(len(bogies), 2 * len(decks)),
        np.column_stack([np.concatenate(all_steerings), np.zeros(len(bogies))]),
        records(VehicleState, len(vehicles)),
        state,
        of_bogies,
    )
    context.add_blocks(*blocks)
    context.add_rows(kind, *paths.kinds(of_bogies, kind.steering), *tyres.kinds(kind))


def _fill_levelling(vehicle: VehicleData, transporter: Transporter, outputs: Columns) -> None:
    """What a vehicle keeps of its levelling."""
    spec = transporter.levelling
    vehicle.levelling, vehicle.period = placed(LevellingParts, outputs), 1.0
    if spec is not None:
        vehicle.levels, vehicle.period, vehicle.rate = True, spec.period, 1.0 / spec.time_constant
        vehicle.fastest, vehicle.dead = spec.speed, spec.dead_angle
        vehicle.roll, vehicle.pitch = spec.roll, spec.pitch


def _deck_markers(deck: Deck, book: MarkerBook) -> tuple[int, int, int, int]:
    """Markers of origin and axes."""
    origin = np.asarray(deck.origin, dtype=np.float64)
    point = book.point(deck.body, origin, FORCES)
    x, y, z = (book.direction(deck.body, axis, FORCES, at=origin) for axis in deck.axes())
    return point, x, y, z


def _refuse_soft_decks(scene: Scene) -> None:
    """Refuse decks on bodies that deform: a deck is stiff, and its load would act on the shapes of one point."""
    rigid = {body.name for body in scene.bodies if not body.DEFORMS} | {GROUND}
    for deck in scene.decks:
        if deck.body not in rigid:
            raise InputError(
                f"it is on body {deck.body!r}, which deforms",
                source=deck.name,
                key="body",
                expected="a rigid body, or 'ground'",
            )


def _refuse_overturned(decks: Sequence[Deck], places: Places) -> None:
    """Refuse decks on whose other side wheels would stand."""
    for deck in decks:
        up = (places.frame(deck.body, deck.origin).axes @ deck.axes().T)[:, 2]
        if up[2] < LEAST_RISE:
            raise InputError(
                f"{np.asarray(deck.normal).tolist()} points {'down' if up[2] < 0.0 else 'sideways'} at the start",
                source=deck.name,
                key="normal",
                expected="the direction away from the ground, to the side on which wheels stand",
            )


def _refuse_overlaps(decks: Sequence[Deck], places: Places) -> None:
    """Refuse decks of two bodies that lie over each other at one height, where none is the uppermost."""
    frames = []
    for deck in decks:
        frame = places.frame(deck.body, deck.origin)
        frames.append((frame.point, frame.axes @ deck.axes().T))
    for b, second in enumerate(decks):
        for a, first in enumerate(decks[:b]):
            if first.body == second.body:
                continue
            origin, axes = frames[a]
            of_first, of_second = np.reshape(first.borders, (2, 2)), np.reshape(second.borders, (2, 2))
            corners = [(x, y, 0.0) for x in of_second[0] for y in of_second[1]]
            seen = (np.array(corners) @ frames[b][1].T + frames[b][0] - origin) @ axes
            low = np.maximum(seen.min(axis=0)[:2], of_first[:, 0])
            high = np.minimum(seen.max(axis=0)[:2], of_first[:, 1])
            if np.any(high - low < ALIKE):
                continue
            x, y = (grid.ravel() for grid in np.meshgrid(*np.linspace(low, high, SAMPLES).T))
            z = first.heights_at(x, y)
            world = np.column_stack([x, y, z]) @ axes.T + origin
            u, v, w = ((world - frames[b][0]) @ frames[b][1]).T
            under = np.all((np.column_stack([u, v]) >= of_second[:, 0]), axis=1)
            under &= np.all((np.column_stack([u, v]) <= of_second[:, 1]), axis=1)
            alike = under & (np.abs(w - second.heights_at(u, v)) < ALIKE)
            if np.count_nonzero(alike) > SAMPLES:
                raise InputError(
                    f"it overlaps deck {first.name!r} of body {first.body!r} at the same height, from station "
                    f"{u[alike].min():.6g} to {u[alike].max():.6g} m",
                    source=second.name,
                    key="stations",
                    expected="decks of two bodies beside each other, or one clearly over the other",
                )


def _parties(scene: Scene, all_places: Sequence[Places]) -> list[list[Places]]:
    """Transporters that carry one stiff thing together: one body, or bodies that fixed joints hold together."""
    pairs = [(joint.body_a, joint.body_b) for joint in scene.joints if isinstance(joint, FixedJoint)]
    parties: dict[frozenset[str], list[Places]] = {}
    for places in all_places:
        group, _ = connected_bodies(places.body.name, _free(scene), pairs, _apart(scene))
        places.carried = group
        parties.setdefault(group, []).append(places)
    return list(parties.values())


def _free(scene: Scene) -> set[str]:
    return {body.name for body in scene.bodies if isinstance(body.motion, Free)}


def _apart(scene: Scene) -> set[str]:
    """Bodies that something else carries: those with decks, and those that float."""
    floating = () if scene.sea is None else scene.sea.hulls
    return {deck.body for deck in scene.decks} | {hull.body for hull in floating}


def _stand(party: Sequence[Places], gravity: float) -> SupportStatics:
    """What transporters carry, on all their groups.

    Raises
    ------
    InputError
        If its weight is not known.
    """
    first = party[0]
    scene, apart = first.scene, _apart(first.scene)
    pairs = [(joint.body_a, joint.body_b) for joint in scene.joints if not isinstance(joint, Guide)]
    hanging = connected_bodies(first.body.name, _free(scene), pairs, apart)[0] - first.carried
    carried = [body for body in scene.bodies if body.name in first.carried]
    parts = [_mass_of(body, first) for body in carried if body.mass_properties is not None]
    problem = ""
    if hanging:
        problem = f"body {min(hanging)!r} hangs on it by a joint that is not fixed"
    elif len(parts) < len(carried):
        problem = f"body {next(b.name for b in carried if b.mass_properties is None)!r} is a mesh"
    elif first.body.name in apart:
        problem = f"body {first.body.name!r} floats, or has a deck"
    if problem:
        raise InputError(
            problem,
            source=first.transporter.name,
            key="groups",
            expected="the 'load' of each group, and 'accept_unstable': what weighs on them is not known",
        )
    mass = sum(part[0] for part in parts)
    centre = np.sum([part[0] * part[1] for part in parts], axis=0) / mass
    inertia = np.zeros((3, 3))
    for own, place, about in parts:
        d = place - centre
        inertia += about + own * (d @ d * np.eye(3) - np.outer(d, d))
    names, oil, counts, middles = [], [], [], []
    for places in party:
        begin = 0
        for of_group in places.transporter.groups:
            end = begin + len(of_group.bogies)
            names.append(of_group.name if len(party) == 1 else f"{places.transporter.name}.{of_group.name}")
            oil.append(of_group.oil_stiffness)
            counts.append(end - begin)
            middles.append(places.world[begin:end].mean(axis=0))
            begin = end
    return SupportStatics(
        first.transporter.name,
        (np.array(middles) - centre) @ first.level.T,
        np.array(counts),
        np.array(oil),
        mass * gravity,
        mass,
        first.level @ inertia @ first.level.T,
        tuple(names),
    )


def _mass_of(body: Body, places: Places) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Mass [kg], centre in the world at the start [m] and inertia about it in world axes [kg m2]."""
    known = body.mass_properties
    assert known is not None
    mass, centre, inertia = known
    frame = places.frame(body.name, centre)
    return mass, frame.point, frame.axes @ inertia @ frame.axes.T


def _start_loads(party: Sequence[Places], gravity: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Forces of a bogie of each group of transporters that carry one thing [N]; refuses what does not stand."""
    counts = [len(places.transporter.groups) for places in party]
    given_loads = np.array(
        [group.load for places in party for group in places.transporter.groups], dtype=np.float64
    )
    parts = np.cumsum(counts)[:-1]
    name, accepted = party[0].transporter.name, all(places.transporter.accept_unstable for places in party)
    if np.all(np.isfinite(given_loads)) and accepted:
        return np.split(given_loads, parts)
    down = float(-gravity[2])
    if not down > 0.0 or float(np.abs(gravity[:2]).max()) > 1e-9 * down:
        raise InputError(
            f"gravity {gravity.tolist()}",
            source=name,
            key="gravity",
            expected="gravity along -z: a transporter stands by its weight",
        )
    stand = _stand(party, down)
    if not np.all(np.isfinite(given_loads)):
        if np.any(np.isfinite(given_loads)):
            named = [group.name for places in party for group in places.transporter.groups]
            raise InputError(
                f"group {named[int(np.argmin(np.isfinite(given_loads)))]!r} has none",
                source=name,
                key="load",
                expected="a 'load' of all, or none",
            )
        given_loads = even_loads(stand)
    elif given_loads @ stand.counts > FAR_TOO_MUCH * stand.weight:
        raise InputError(
            f"groups push with {given_loads @ stand.counts:.6g} N in all on a weight of {stand.weight:.6g} N",
            source=name,
            key="load",
            expected="the force of a single bogie of the group, or none: then they carry the weight",
        )
    if not accepted:
        refuse_unstable(_on_tyres(stand, party, given_loads))
        if any(places.transporter.levelling is not None for places in party):
            refuse_growing_levelling(stand, _levelled(stand, party, given_loads))
    return np.split(given_loads, parts)


def _oil_stiffness(party: Sequence[Places], loads: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of oil or gas of each group, a bogie of it, at the start [N/m]."""
    groups = [group for places in party for group in places.transporter.groups]
    return np.array(
        [
            0.0 if group.constant_force else (group.oil_stiffness or GAS_EXPONENT * load / group.gas_length)
            for group, load in zip(groups, loads, strict=True)
        ]
    )


def _levelled(stand: SupportStatics, party: Sequence[Places], loads: NDArray[np.float64]) -> LevelledBogies:
    """Bogies of transporters that carry one thing, and how they are levelled; looks of all are as far apart as any."""
    vehicles = [places.transporter for places in party]
    of_bogies = np.repeat(np.arange(len(party)), [len(places.points) for places in party])
    group = np.repeat(np.arange(len(stand.counts)), stand.counts)
    first = party[0]
    flat = [(places.world - party[0].world[0]) @ first.level.T for places in party]
    middles = [np.array([place[own == k].mean(axis=0) for k in np.unique(own)]) for place, own in
               zip(flat, (group[of_bogies == v] for v in range(len(party))), strict=True)]  # fmt: skip
    offset = stand.places[0] - middles[0][0]
    arms = np.vstack([middle - place.mean(axis=0) for middle, place in zip(middles, flat, strict=True)])
    spec = [vehicle.levelling for vehicle in vehicles]
    rates = [0.0 if levelling is None else 1.0 / levelling.time_constant for levelling in spec]
    return LevelledBogies(
        places=(np.vstack(flat) + offset)[:, :2],
        group=group,
        tyre=np.array([vehicle.tyre_stiffness for vehicle in vehicles])[of_bogies],
        rubber=np.array([vehicle.tyre_damping for vehicle in vehicles])[of_bogies],
        pipe=np.array([vehicle.line_damping for vehicle in vehicles])[of_bogies],
        oil=_oil_stiffness(party, loads),
        ahead=arms[:, 0],
        aside=arms[:, 1],
        rate=np.repeat(rates, [len(vehicle.groups) for vehicle in vehicles]),
        period=max(levelling.period for levelling in spec if levelling is not None),
        held=any(len(vehicle.legs) > 0 for vehicle in vehicles),
    )


def _on_tyres(stand: SupportStatics, party: Sequence[Places], loads: NDArray[np.float64]) -> SupportStatics:
    """A body on its groups with the stiffness of oil or gas and tyres in a row."""
    groups = [(group, places.transporter) for places in party for group in places.transporter.groups]
    tyre = np.array([transporter.tyre_stiffness for _, transporter in groups])
    oil = _oil_stiffness(party, loads)
    return replace(stand, stiffness=oil * tyre / (oil + tyre))


def vehicle_tipping(scene: Scene) -> dict[str, Tipping]:
    """Tilts at which the transporters of a scene tip over, by name: of those whose weight is known.

    Raises
    ------
    InputError
        As `pack`.
    """
    gravity = scene.gravity
    found: dict[str, Tipping] = {}
    if not float(-gravity[2]) > 0.0:
        return found
    for party in _parties(scene, [Places(transporter, scene) for transporter in scene.transporters]):
        loads = np.concatenate(_start_loads(party, gravity))
        try:
            stand = _stand(party, float(-gravity[2]))
        except InputError:
            continue
        tipping = tipping_angles(_on_tyres(stand, party, loads), loads)
        found |= {places.transporter.name: tipping for places in party}
    return found


def _check_names(transporter: Transporter) -> None:
    """Groups have names of their own."""
    names = [group.name for group in transporter.groups]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(
            f"two groups {twice!r}",
            source=transporter.name,
            key="groups",
            expected="a name of its own for each",
        )


def _check_loads(transporter: Transporter, loads: NDArray[np.float64], weight: float) -> None:
    """Refuse a load beyond the limit of a bogie."""
    worst = int(np.argmax(loads))
    if loads[worst] + weight > transporter.load_limit:
        raise InputError(
            f"{loads[worst] + weight:.6g} N on each bogie of group {transporter.groups[worst].name!r} at the start",
            source=transporter.name,
            key="load_limit",
            expected=f"at most {transporter.load_limit:.6g} N: more bogies, or less load",
        )
