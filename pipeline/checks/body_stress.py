"""Stress of flexible bodies over a run: computed once, kept in a file, and shown by report, page, checks and criteria.

Stress is superposed of the modes, and of the static answer to loads that they do not follow: weight and inertia forces
of the frame (`heavylift.modal.static_correction`). Loads at places are in the modes, which have static vectors for
them.
"""

from __future__ import annotations

import json
from functools import cache, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.derived import derived
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.modes import flexibility_of
from heavylift.pipeline.case.steel import STEEL_SOURCE, thickest, yield_strengths
from heavylift.pipeline.case.stress import HotSpotSection, StressGroupSection
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.model_io import read_header, read_model, read_reduced
from heavylift.pipeline.results.provenance import mesh_digest, modes_digest, source_digest
from heavylift.pipeline.results.storage import digest_bytes, digest_json
from heavylift.pipeline.results.stress_io import (
    BodyStress,
    GroupStress,
    PanelStress,
    PartEnvelope,
    read_stress,
    stress_digest_of,
    write_stress,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from heavylift.modal.flexibility import Flexibility
    from heavylift.modal.reduced import ReducedBody
    from heavylift.modal.stress_history import Envelope, GroupHistory
    from heavylift.modal.stress_points import StressPoints
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.flexible_bodies import FlexibleBodySection
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.preprocess.finite_elements.model import FEModel
    from heavylift.preprocess.structures.structure import Beams, Shells, Solids

__all__ = ["ALL", "CENTRE_SIDE", "body_stress", "check_stress_tables", "model_columns"]

CENTRE_SIDE = "centre"
"""Side of plates that is their membrane stress at the centres of elements."""
ALL = "all"
"""Name of the only group of a solid whose case names none."""
_SLIGHT = (
    1e-4  # of gravity: accelerations that strain a body no more than its weight does by a ten-thousandth
)
_MISSED = 0.02  # of the strain energy of a force: what modes may not have of it without a word
_SAME = 1e-6  # of the size of a body: a point that is an interface
_EXCITED = 0.01  # of the elastic energy: kinetic energy of a mode that vibrates
_RECORDS = 5  # a period of the highest mode that vibrates


def body_stress(
    case: Case, name: str, folder: OutputFolder, results: Results, log: Log | None = None
) -> BodyStress:
    """Stress of a flexible body of a run, from its file, or computed and kept there.

    Parameters
    ----------
    case, name
        The case, and the name of a flexible body with a table ``stress``.
    folder
        Output folder with its model and modes.
    results
        Its time histories.
    log
        Told how far it is.

    Raises
    ------
    InputError
        A body without elements, a group that does not exist, a solid with a grade and no thickness.
    """
    path, digest = folder.stress(name), _digest(case, name, results)
    if stress_digest_of(path) != digest:
        write_stress(path, _computed(case, name, folder, results, log), digest)
    return read_stress(path)


def check_stress_tables(case: Case, folder: OutputFolder) -> None:
    """Groups, strengths and hot spots that cannot be evaluated are told before a run, not after it.

    Raises
    ------
    InputError
        The first of them, with its key.
    """
    for name, body in case.bodies.items():
        section: Any = body
        if getattr(body, "stress", None) is None or not folder.model(name).is_file():
            continue

        def check(_: str, name: str = name, section: Any = section) -> _Sound:
            model = read_model(folder.model(name))
            groups = _groups(case, name, section, model, _parts(case, name, section, model))
            still = np.zeros((model.dof_count, 1))
            for index, spot in enumerate(section.stress.hot_spots):
                _hot_spot(case, name, index, spot, model, still)
            return _Sound(len(groups), len(section.stress.hot_spots))

        # where all was sound there is nothing to tell of the same tables and the same model
        asked = {"model": mesh_digest(case, section), "stress": section.stress.model_dump(mode="json")}
        derived(_Sound, check, digest_json({"sources": source_digest("stress"), **asked}))


class _Sound(NamedTuple):
    """How many groups and hot spots can be evaluated: all."""

    groups: int
    hot_spots: int


def _digest(case: Case, name: str, results: Results) -> str:
    """Of all that the stress depends on: what a run has recorded counts, not what it should have."""
    body: Any = case.bodies[name]
    channels = [
        f"{name}.{kind}" for kind in ("modal_position", "orientation", "velocity", "angular_velocity")
    ]
    return digest_json(
        {
            "sources": source_digest("stress"),
            "modes": modes_digest(case, body),
            "stress": body.stress.model_dump(mode="json"),
            "gravity": case.gravity and case.gravity.model_dump(mode="json"),
            "motion": body.frame.motion,
            "records": digest_bytes(
                results.time.tobytes(),
                *(np.ascontiguousarray(results[channel]).tobytes() for channel in channels),
            ),
        }
    )


@dataclass(frozen=True, eq=False)
class _Group:
    """A group of the body: points by number of the part, and strengths there."""

    name: str
    points: dict[int, NDArray[np.int64]]
    strength: dict[int, NDArray[np.float64]]


def _computed(case: Case, name: str, folder: OutputFolder, results: Results, log: Log | None) -> BodyStress:
    from heavylift.modal.stress_history import PointGroup, recover_stress

    body: Any = case.bodies[name]
    model, reduced = read_model(folder.model(name)), read_reduced(folder.reduced(name))
    parts = _parts(case, name, body, model)
    groups = _groups(case, name, body, model, parts)
    shapes = model_columns(reduced)
    modal = results[f"{name}.modal_position"].reshape(len(results.time), -1)
    lost = ~np.isfinite(modal).all(axis=1)
    if lost.any():
        raise InputError(
            f"the modal coordinates of {name!r} are not finite from {results.time[lost][0]:.6g} s on",
            source=results.source,
            expected="a run that stays finite",
        )
    correction, loads, notes = np.empty((len(shapes), 0)), np.empty((len(modal), 0)), list[str]()
    flexibility = cache(partial(flexibility_of, body, model))  # made when something needs it
    notes += _places(case, name, folder, reduced, shapes, flexibility)
    if body.stress.correction:
        correction, loads, more = _correction(
            case, name, folder, model, reduced, shapes, results, flexibility
        )
        notes += more
        shapes, modal = np.hstack([shapes, correction]), np.hstack([modal, loads])
    notes += _too_few_records(name, reduced, results)
    panels, more = _panels(case, name, body, model, shapes, modal)
    notes += more
    if body.stress.buckling:
        energy = 0.5 * modal[:, : reduced.mode_count] ** 2 @ reduced.eigenvalues
        record = int(energy.argmax())
        notes.append(_buckling(case, name, flexibility(), shapes @ modal[record], results.time[record]))
    found: list[list[GroupHistory]] = []
    envelopes: list[PartEnvelope] = []
    total, done = sum(map(len, parts)), 0
    log = log or Log(quiet=True)
    with log.progress(f"stress: {name}", total) as update:
        for number, points in enumerate(parts):
            asked = [
                PointGroup(group.name, group.points[number], group.strength.get(number))
                for group in groups
                if number in group.points
            ]

            def tell(share: float, before: int = done, own: int = len(points)) -> None:
                update(before + share * own, "points")

            histories, envelope = recover_stress(points, shapes, modal, asked, progress=tell)
            found.append(histories)
            envelopes.append(_part_envelope(points, envelope))
            done += len(points)
    log.say(f"stress: {name}: {total:,} points, {len(modal):,} records")
    return BodyStress(
        times=results.time,
        groups={group.name: _merged(group, groups, parts, found) for group in groups},
        hot_spots={
            spot.name: modal @ _hot_spot(case, name, index, spot, model, shapes)
            for index, spot in enumerate(body.stress.hot_spots)
        },
        parts=tuple(envelopes),
        correction=correction,
        loads=loads,
        notes=tuple(notes),
        panels=panels,
    )


def _buckling(
    case: Case, name: str, flexibility: Flexibility, displacements: NDArray[np.float64], time: float
) -> str:
    """Sentence on the factor by which the stress of some displacements, shape (N,), may grow until the body buckles."""
    from heavylift.modal.buckling import buckling
    from heavylift.modal.stress_stiffness import stress_stiffness

    key = case.place(f"bodies.{name}.stress.buckling")
    geometric = stress_stiffness(flexibility.model, key=key)(displacements)
    factor = buckling(flexibility, geometric, source=str(case.file), key=key).factor
    grows = f"by a factor of {factor:.4g}" if np.isfinite(factor) else "without end"
    held = (
        "its clamp and supports hold it"
        if flexibility.rigid_count == 0
        else "ropes and joints do not restrain it"
    )
    return (
        f"Buckling at {time:.6g} s, with the largest elastic energy: all stress may grow {grows} until the body "
        f"buckles (linear buckling of the whole model, in which {held})."
    )


def _panels(
    case: Case,
    name: str,
    body: FlexibleBodySection,
    model: FEModel,
    shapes: NDArray[np.float64],
    coordinates: NDArray[np.float64],
) -> tuple[PanelStress | None, list[str]]:
    """Plate panels at all records, and sentences on them; None if they are not asked for."""
    assert body.stress is not None
    if not body.stress.panels:
        return None, []
    if model.structure is None:
        raise InputError(
            f"{name!r} has no plates",
            source=str(case.file),
            key=case.place(f"bodies.{name}.stress.panels"),
            expected="a body with plates, or false",
        )
    from heavylift.modal.plate_panels import panel_use, plate_panels

    properties = _properties(model)
    own = {one.name: one for one in body.stress.groups}
    named = set(own) if own and set(own) <= set(properties) else None
    found = plate_panels(model, named)
    strength = np.full(len(found.group), np.nan)
    for number, group in enumerate(found.group):
        owner = own[group] if group in own and own[group].has_strength else body.stress
        if owner.yield_strength is not None:
            strength[number] = owner.yield_strength
        elif owner.grade is not None:
            strength[number] = yield_strengths(owner.grade, found.thickness[number])
    modal = np.asarray(found.operator @ shapes)
    stress = (coordinates @ modal.T).reshape(len(coordinates), len(found.group), 5)
    notes = []
    if found.others:
        notes.append(
            f"{found.others} plane parts of plates are no rectangles and have no buckling stress here."
        )
    return PanelStress(
        found.group,
        found.centre,
        found.length,
        found.width,
        found.thickness,
        stress[..., [0, 2, 4]].astype(np.float32),
        panel_use(found, body.stress.gamma_M * stress, strength).astype(np.float32),
    ), notes


def model_columns(reduced: ReducedBody) -> NDArray[np.float64]:
    """Mode shapes of displacements and rotations in the layout of the model, shape (N, nf)."""
    shapes = reduced.mode_shapes.transpose(1, 2, 0).reshape(3 * reduced.node_count, -1)
    if reduced.mode_rotations is None:
        return np.ascontiguousarray(shapes)
    turns = reduced.mode_rotations[:, reduced.rotating].transpose(1, 2, 0)
    return np.vstack([shapes, turns.reshape(3 * len(reduced.rotating), -1)])


def _parts(case: Case, name: str, body: FlexibleBodySection, model: FEModel) -> list[StressPoints]:
    """Points of the groups that are asked for, by part of the body."""
    from heavylift.modal.stress_points import solid_points

    assert body.stress is not None
    asked = [one.name for one in body.stress.groups]
    if model.structure is not None:
        from heavylift.modal.structure_stress import structure_points

        known = _properties(model)
        for index, group in enumerate(asked):
            if group not in known:
                _node_group(case, name, index, group, model)
        by_property = asked and all(group in known for group in asked)
        return structure_points(model, asked if by_property else None)
    if model.mesh is None or model.material is None:
        raise InputError(
            f"{name!r} has no stress: its model has no elements, or not one material",
            source=str(case.file),
            key=case.place(f"bodies.{name}.stress"),
            expected="a body with elements between its nodes",
        )
    nodes = None
    if asked:
        nodes = np.concatenate(
            [_node_group(case, name, index, group, model) for index, group in enumerate(asked)]
        )
    return [solid_points(model.mesh, model.material, nodes, name=name)]


def _properties(model: FEModel) -> tuple[str, ...]:
    """Names of the properties of a structure, each once."""
    structure = model.structure
    if structure is None:
        return ()
    parts: tuple[Shells | Beams | Solids, ...] = (*structure.shells, *structure.beams, *structure.solids)
    return tuple(dict.fromkeys(part.name for part in parts if len(part.elements)))


def _node_group(case: Case, name: str, index: int, group: str, model: FEModel) -> NDArray[np.int64]:
    if group not in model.node_groups:
        known = sorted({*model.node_groups, *_properties(model)})
        raise InputError(
            f"group {group!r} does not exist",
            source=str(case.file),
            key=case.place(f"bodies.{name}.stress.groups.{index}.name"),
            expected=f"one of: {', '.join(known) or 'none'}",
        )
    return np.asarray(model.node_groups[group])


def _groups(
    case: Case, name: str, body: FlexibleBodySection, model: FEModel, parts: Sequence[StressPoints]
) -> list[_Group]:
    """Groups that are told, with the strengths of their points."""
    assert body.stress is not None
    properties = _properties(model)
    asked = body.stress.groups or tuple(StressGroupSection(name=one) for one in properties or (ALL,))
    found = []
    for index, group in enumerate(asked):
        if group.name in properties:
            points = {
                number: np.arange(len(part)) for number, part in enumerate(parts) if part.name == group.name
            }
        else:
            nodes = (
                _node_group(case, name, index, group.name, model)
                if body.stress.groups
                else np.arange(model.node_count)
            )
            points = {number: np.flatnonzero(np.isin(part.nodes, nodes)) for number, part in enumerate(parts)}
        points = {number: chosen for number, chosen in points.items() if chosen.size}
        if not points:
            raise InputError(
                f"no plate, beam or solid has a node of group {group.name!r}",
                source=str(case.file),
                key=case.place(f"bodies.{name}.stress.groups.{index}.name"),
                expected="a group of nodes of elements",
            )
        strength = {}
        for number, chosen in points.items():
            known = _strength(case, name, index, body, group, parts[number].thickness[chosen])
            if known is not None:
                strength[number] = known
        found.append(_Group(group.name, points, strength))
    return found


def _strength(
    case: Case,
    name: str,
    index: int,
    body: FlexibleBodySection,
    group: StressGroupSection,
    thickness: NDArray[np.float64],
) -> NDArray[np.float64] | None:
    """Yield strength over the partial factor at points of some thickness [Pa]; None if none is given."""
    assert body.stress is not None
    owner = group if group.has_strength else body.stress
    if owner.yield_strength is not None:
        return np.full(len(thickness), owner.yield_strength / body.stress.gamma_M)
    if owner.grade is None:
        return None
    other = group.thickness or body.stress.thickness
    given = np.where(np.isnan(thickness), np.nan if other is None else other, thickness)
    found = yield_strengths(owner.grade, given)
    if not np.isfinite(found).all():
        unknown = bool(np.isnan(given).any())
        raise InputError(
            f"group {group.name!r} has parts without a thickness"
            if unknown
            else f"group {group.name!r} has {1e3 * given.max():g} mm of {owner.grade}",
            source=str(case.file),
            key=case.place(f"bodies.{name}.stress.groups.{index}.thickness")
            if body.stress.groups
            else case.place(f"bodies.{name}.stress.thickness"),
            expected="the thickness of beams and solids by which the grade has its yield strength, or 'yield_strength'"
            if unknown
            else f"up to {1e3 * thickest(owner.grade):g} mm ({STEEL_SOURCE}), or 'yield_strength'",
        )
    return found / body.stress.gamma_M


def _part_envelope(points: StressPoints, envelope: Envelope) -> PartEnvelope:
    return PartEnvelope(
        name=points.name,
        sides=points.sides,
        total=points.total,
        positions=points.positions,
        nodes=points.nodes,
        thickness=points.thickness,
        largest=envelope.largest,
        record=envelope.record,
        highest=envelope.highest,
        lowest=envelope.lowest,
    )


def _merged(
    group: _Group, groups: Sequence[_Group], parts: Sequence[StressPoints], found: list[list[GroupHistory]]
) -> GroupStress:
    """A group over all parts that it has points of."""
    sides: dict[str, bool] = {}
    for number in group.points:
        sides |= dict(zip(parts[number].sides, parts[number].total.tolist(), strict=True))
    records = len(next(iter(found))[0].largest)
    shape = (records, len(sides))
    known = len(group.strength) == len(group.points)
    largest, place = np.full(shape, -1.0), np.zeros((*shape, 3))
    used, used_place = np.full(shape, -1.0), np.zeros((*shape, 3))
    for number, points in enumerate(parts):
        if number not in group.points:
            continue
        members = [one for one in groups if number in one.points]
        history = found[number][members.index(group)]
        for column, side in enumerate(points.sides):
            at = list(sides).index(side)
            _take(
                largest[:, at],
                place[:, at],
                history.largest[:, column],
                points.positions[history.point[:, column]],
            )
            if known and history.utilisation is not None and history.used_point is not None:
                where = points.positions[history.used_point[:, column]]
                _take(used[:, at], used_place[:, at], history.utilisation[:, column], where)
    strength = np.concatenate([np.empty(0), *group.strength.values()]) if known else np.empty(0)
    return GroupStress(
        name=group.name,
        sides=tuple(sides),
        total=np.array(list(sides.values())),
        largest=largest,
        place=place,
        strength=np.array([strength.min(), strength.max()]) if strength.size else strength,
        utilisation=used if strength.size else np.empty((0, 0)),
        used_place=used_place if strength.size else np.empty((0, 0, 3)),
    )


def _take(
    largest: NDArray[np.float64],
    place: NDArray[np.float64],
    values: NDArray[np.float32],
    where: NDArray[np.float64],
) -> None:
    higher = values > largest
    largest[higher] = values[higher]
    place[higher] = where[higher]


def _hot_spot(
    case: Case, name: str, index: int, spot: HotSpotSection, model: FEModel, shapes: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Structural stress at a weld toe by modal coordinate, shape (nf,).

    Notes
    -----
    ``sigma_hs = 1.5 sigma(0.5 t) - 0.5 sigma(1.5 t)`` of the normal stress along the direction: linear extrapolation of
    surface stresses of a mesh with elements of t x t (A. Hobbacher, *Recommendations for fatigue design of welded
    joints and components*, IIW-2259-15; DNV-RP-C203).
    """
    from heavylift.modal.stress_points import solid_points
    from heavylift.preprocess.finite_elements.mesh import find_place

    d = np.array(spot.direction, dtype=np.float64)
    d /= np.linalg.norm(d)
    key = case.place(f"bodies.{name}.stress.hot_spots.{index}")
    plates = model.structure is not None and bool(model.structure.shells)
    if plates != (spot.side is not None):
        raise InputError(
            "is missing" if plates else f"{spot.side!r} of a solid",
            source=str(case.file),
            key=f"{key}.side",
            expected="'top' (the side of the normal) or 'bottom'" if plates else "no 'side'",
        )
    found = []
    for share in spot.AT:
        place = np.array(spot.toe) + share * spot.thickness * d
        if plates:
            found.append(_plate_stress(model, place, d, spot, shapes, str(case.file), key))
            continue
        if model.mesh is None or model.material is None:
            raise InputError(
                "is on a body of solids with masses, rigid elements or several materials",
                source=str(case.file),
                key=key,
                expected="a body of one solid material, or plates",
            )
        nodes, weights = find_place(model.nodes, model.mesh, place, source=case.file, key=f"{key}.toe")
        points = solid_points(model.mesh, model.material, nodes)
        columns = points.columns(shapes, np.searchsorted(points.nodes, nodes))[:, 0]
        along = [d[0] ** 2, d[1] ** 2, d[2] ** 2, 2.0 * d[0] * d[1], 2.0 * d[1] * d[2], 2.0 * d[2] * d[0]]
        found.append(np.einsum("a,c,acf->f", weights, along, columns))
    first, second = spot.AT
    span = second - first
    return np.asarray((second * found[0] - first * found[1]) / span)


def _plate_stress(
    model: FEModel,
    place: NDArray[np.float64],
    direction: NDArray[np.float64],
    spot: HotSpotSection,
    shapes: NDArray[np.float64],
    source: str,
    key: str,
) -> NDArray[np.float64]:
    """Normal stress on a side of a plate by modal coordinate, shape (nf,)."""
    from heavylift.modal.structure_stress import plate_rows

    assert model.structure is not None
    nodes, weights, distance = model.structure.nearest_place(place)
    if distance > spot.thickness:
        raise InputError(
            f"the plate is {1e3 * distance:.4g} mm away from a point before it",
            source=source,
            key=f"{key}.toe",
            expected=f"a toe on a plate, to its thickness, that {spot.AT[1]:g} thicknesses along 'direction' are on it "
            "too",
        )
    try:
        return np.asarray(plate_rows(model, nodes, weights, direction, spot.side or "top") @ shapes)
    except InputError as error:
        raise InputError(error.problem, source=source, key=key, expected=error.expected) from None


# ---- static correction ----


def _correction(
    case: Case,
    name: str,
    folder: OutputFolder,
    model: FEModel,
    reduced: ReducedBody,
    shapes: NDArray[np.float64],
    results: Results,
    flexibility: Callable[[], Flexibility],
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[str]]:
    """Shapes by unit load (N, k), loads at each record (records, k), and sentences on them."""
    from heavylift.modal.flexibility import apply_mass
    from heavylift.modal.static_correction import inertia_fields, static_correction

    body: Any = case.bodies[name]
    free = body.frame.motion == "free"
    origin = np.array(json.loads(read_header(folder.reduced(name))["frame_origin"]))
    places = model.nodes if model.points is None else model.points.positions
    names, fields = inertia_fields(places - origin, free=free)
    loads = _field_loads(case, name, names, results, free=free)
    size = np.where([len(one) == 2 for one in names], reduced.size, 1.0)
    gravity = 0.0 if case.gravity is None else float(np.linalg.norm(case.gravity.acceleration))
    acting = np.flatnonzero(np.abs(loads).max(axis=0, initial=0.0) * size > _SLIGHT * gravity)
    if not acting.size:
        return np.empty((len(shapes), 0)), np.empty((len(loads), 0)), []
    fields = fields[:, :, acting].reshape(-1, len(acting))
    if model.points is None:
        forces = apply_mass(model.mass, fields)
    else:
        forces = model.points.operator.T @ (np.repeat(model.points.masses, 3)[:, np.newaxis] * fields)
    found = static_correction(flexibility(), shapes, reduced.eigenvalues, forces)
    notes = []
    if found.loads.size:
        modal = results[f"{name}.modal_position"].reshape(len(results.time), -1)
        elastic = float((0.5 * modal**2 @ reduced.eigenvalues).max())
        added = found.energy * (loads[:, acting[found.loads]] ** 2).max(axis=0)
        worst = int(added.argmax())
        field = names[acting[found.loads[worst]]]
        share = added[worst] / max(elastic + added[worst], np.finfo(np.float64).tiny)
        what = f"acceleration along {field}" if len(field) == 1 else f"field {field} of rotation"
        notes.append(
            "Weight and inertia of the frame act by their static answer besides the modes, which miss up to "
            f"{100.0 * share:.2g} % of the elastic energy by it ({what})."
        )
        if body.frame.motion == "driven":
            notes.append(
                "The acceleration of the driven frame is that of differences of its recorded velocity."
            )
    return found.shapes, loads[:, acting[found.loads]], notes


def _places(
    case: Case,
    name: str,
    folder: OutputFolder,
    reduced: ReducedBody,
    shapes: NDArray[np.float64],
    flexibility: Callable[[], Flexibility],
) -> list[str]:
    """Sentences on places where joints, ropes and forces act, of which the modes have no static vectors."""
    from heavylift.modal.bases import place_loads
    from heavylift.modal.static_correction import static_correction
    from heavylift.pipeline.assemble.scene import assemble_scene, points_on
    from heavylift.pipeline.case.interfaces import holding_joints

    if not (case.joints or case.ropes or case.forces):
        return []
    joints = assemble_scene(case, folder).joints
    origin = np.array(json.loads(read_header(folder.reduced(name))["frame_origin"]))
    # joints that hold directions have static vectors
    held = {index for index, _ in holding_joints(case.joints, name)}
    acting = points_on(
        case,
        [None if index in held else joint for index, joint in enumerate(joints)],
        [None] * len(case.contacts),
        name,
        origin,
    )
    known = [one.point + origin for one in reduced.interfaces.values()]
    notes: list[str] = []
    seen: list[NDArray[np.float64]] = []
    for key, point in acting:
        place = np.asarray(point, dtype=np.float64)
        near = any(np.linalg.norm(place - at) <= _SAME * reduced.size for at in (*known, *seen))
        if near or key.startswith(("sensors.", "relative_motions.", "leads.")):
            continue
        seen.append(place)
        loads = place_loads(flexibility().model, [place.tolist()], key=key)
        missing = static_correction(flexibility(), shapes, reduced.eigenvalues, loads.forces).missing
        worst = int(missing.argmax())
        if missing[worst] > _MISSED:
            notes.append(
                f"{key}: the modes miss {100.0 * missing[worst]:.3g} % of the strain energy of a force there along "
                f"{'xyz'[worst]}, and its stress around: give it an interface, or 'modes.static_points'."
            )
    return notes


def _field_loads(
    case: Case, name: str, names: Sequence[str], results: Results, *, free: bool
) -> NDArray[np.float64]:
    """Accelerations that load the body at each record, by field, shape (records, fields)."""
    from scipy.spatial.transform import Rotation

    body: Any = case.bodies[name]
    count = len(results.time)
    q = results[f"{name}.orientation"].reshape(count, 4)
    to_body = Rotation.from_quat(q[:, [1, 2, 3, 0]]).inv()
    gravity = np.zeros(3) if case.gravity is None else np.array(case.gravity.acceleration, dtype=np.float64)
    spin = results[f"{name}.angular_velocity"].reshape(count, 3)
    rate, moved = np.zeros((count, 3)), np.zeros((count, 3))
    # the last record of a run that was stopped may be there twice
    times, first, again = np.unique(results.time, return_index=True, return_inverse=True)
    if body.frame.motion == "driven" and len(times) > 2:
        velocity = results[f"{name}.velocity"].reshape(count, 3)
        rate, moved = (
            np.asarray(np.gradient(one[first], times, axis=0, edge_order=2))[again.ravel()]
            for one in (spin, velocity)
        )
    turning, faster = (np.cross(one[:, np.newaxis], np.eye(3)).transpose(0, 2, 1) for one in (spin, rate))
    A = np.matmul(turning, turning) + (0.0 if free else faster)
    pull = to_body.apply(gravity - moved)
    axes = {axis: k for k, axis in enumerate("xyz")}
    return np.column_stack(
        [pull[:, axes[one]] if len(one) == 1 else -A[:, axes[one[0]], axes[one[1]]] for one in names]
    )


def _too_few_records(name: str, reduced: ReducedBody, results: Results) -> list[str]:
    """That records are too far apart for the highest mode that vibrates: it has kinetic energy."""
    if len(results.time) < 3:
        return []
    position, speed = (
        results[f"{name}.{kind}"].reshape(len(results.time), -1)
        for kind in ("modal_position", "modal_velocity")
    )
    kinetic = 0.5 * np.mean(speed**2, axis=0)
    elastic = 0.5 * float(np.mean(position**2, axis=0) @ reduced.eigenvalues)
    excited = np.flatnonzero(kinetic > _EXCITED * elastic)
    if not excited.size:
        return []
    highest = int(excited.max())
    period = 1.0 / float(reduced.frequencies[highest])
    interval = float(np.diff(results.time).max())
    if interval * _RECORDS <= period:
        return []
    words = (
        f"Records are {interval:.4g} s apart: {_RECORDS} a period of vector {highest + 1} "
        f"({1.0 / period:.4g} Hz), the highest that vibrates with 1 % of the elastic energy, would be "
        f"{period / _RECORDS:.3g} s; between them stresses may be larger."
    )
    return [words]
