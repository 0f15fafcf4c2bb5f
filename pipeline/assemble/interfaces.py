"""From the interfaces of a flexible body in a case to groups of nodes with weights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.flexible import StartedBody
from heavylift.pipeline.case.interfaces import holding_joints, pulled_points, pulling_joints
from heavylift.pipeline.case.places import located

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.modal.interfaces import Fit
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.flexible_bodies import FlexibleBodySection
    from heavylift.pipeline.case.interfaces import InterfaceSection
    from heavylift.preprocess.finite_elements.model import FEModel

__all__ = ["arm_notes", "held_places", "interface_fits", "pulled_places"]

_SAME = 1e-6  # of the size of a body: points that coincide
_ARM = 0.5  # of the extent of a group: a reference point farther from its nodes is told


def interface_fits(
    model: FEModel,
    sections: Mapping[str, InterfaceSection],
    nodes_of: Callable[[str, str], NDArray[np.int64]],
) -> dict[str, Fit]:
    """Groups of the interfaces of a body.

    Parameters
    ----------
    model
        Finite-element model.
    sections
        By name.
    nodes_of
        Nodes of a group, from its name and the key that names it.

    Raises
    ------
    InputError
        A group without nodes, one that does not determine a rotation, interfaces that coincide; keys are below the
        body.
    """
    from heavylift.modal.interfaces import fit, group_weights, outer_nodes, place_fit, refuse_coincident

    source, found = model.name, {}
    for name, section in sections.items():
        key = f"interfaces.{name}"
        if section.group is not None:
            nodes = nodes_of(section.group, f"{key}.group")
        elif section.radius is not None:
            nodes = _within(model, outer_nodes(model), section, f"{key}.radius")
        else:
            assert section.at is not None
            found[name] = place_fit(model, section.at, source=source, key=f"{key}.at")
            continue
        weights = group_weights(model, nodes)
        point = weights @ model.nodes[nodes] if section.at is None else np.asarray(section.at)
        given = "radius" if section.group is None else "group"
        found[name] = fit(model, point, nodes, weights, source=source, key=f"{key}.{given}")
    try:
        refuse_coincident(found, float(np.ptp(model.nodes, axis=0).max()))
    except InputError as error:
        raise InputError(
            error.problem, source=source, key=f"interfaces.{error.source}", expected=error.expected
        ) from None
    return found


def held_places(
    case: Case,
    name: str,
    body: FlexibleBodySection,
    model: FEModel,
    origin: NDArray[np.float64],
    known: Iterable[Fit],
) -> dict[str, Fit]:
    """Places where joints of the case hold directions of a body, by names of joints; those of interfaces apart.

    Parameters
    ----------
    case, name, body
        The case, and the body.
    model
        Finite-element model.
    origin
        Of the frame, in coordinates of the geometry [m].
    known
        Its interfaces.

    Raises
    ------
    InputError
        A place that is not on the body.
    """
    from heavylift.modal.interfaces import is_at, place_fit

    found: dict[str, Fit] = {}
    size = float(np.ptp(model.nodes, axis=0).max())
    for index, joint, point in _joint_points(name, body, origin, holding_joints(case.joints, name)):
        if any(is_at(one, point, size) for one in (*known, *found.values())):
            continue
        with located(case, f"joints.{index}"):
            found[joint.name] = place_fit(model, point, source="", key="at" if joint.at else "points")
    return found


def pulled_places(
    case: Case,
    name: str,
    body: FlexibleBodySection,
    model: FEModel,
    origin: NDArray[np.float64],
    known: Iterable[Fit],
) -> list[NDArray[np.float64]]:
    """Points where ropes, forces and joints of points pull at a body, each once; those of interfaces apart.

    Parameters and errors as those of `held_places`; points in coordinates of the geometry [m].
    """
    from heavylift.modal.interfaces import is_at
    from heavylift.preprocess.finite_elements.mesh import find_place

    joints = pulling_joints(case.joints, name)
    points = [
        (key, np.asarray(point)) for key, point in pulled_points(case.ropes, case.forces, name, case.inputs)
    ]
    points += [
        (f"joints.{index}.{'at' if joint.at else 'points'}", point)
        for index, joint, point in _joint_points(name, body, origin, joints)
    ]
    size = float(np.ptp(model.nodes, axis=0).max())
    known = list(known)
    found: list[NDArray[np.float64]] = []
    for key, point in points:
        beside = any(np.linalg.norm(point - other) <= _SAME * size for other in found)
        if not beside and not any(is_at(one, point, size) for one in known):
            find_place(model.nodes, model.elements, point, source=case.file, key=case.place(key))
            found.append(point)
    return found


def _joint_points(
    name: str,
    body: FlexibleBodySection,
    origin: NDArray[np.float64],
    joints: Sequence[tuple[int, Any]],
) -> Iterator[tuple[int, Any, NDArray[np.float64]]]:
    """Numbers of joints, the joints and their points on a body, in coordinates of its geometry [m]."""
    from heavylift.pipeline.assemble.frames import motion_of, start_of_frame
    from heavylift.pipeline.assemble.sides import start_sides

    if not joints:
        return
    start = start_of_frame(body.initial, origin)
    placed = StartedBody(name, motion_of(body.frame), start["position"], start["orientation"])
    side = start_sides([placed], {name: origin})[name]
    for index, joint in joints:
        if getattr(joint, "at", None) is not None:
            yield index, joint, side.from_world(joint.at) + origin
        else:
            yield index, joint, np.asarray(joint.points[joint.between.index(name)])


def _within(
    model: FEModel, nodes: NDArray[np.int64], section: InterfaceSection, key: str
) -> NDArray[np.int64]:
    """Those of some nodes that are within the radius of an interface."""
    assert section.radius is not None
    distances = np.linalg.norm(model.nodes[nodes] - np.asarray(section.at), axis=1)
    chosen = nodes[distances <= section.radius * (1.0 + 1e-9)]
    if not chosen.size:
        nearest = nodes[int(np.argmin(distances))]
        where = ", ".join(f"{1e3 * x:.6g}" for x in model.nodes[nearest])
        raise InputError(
            f"no node is within {1e3 * section.radius:.6g} mm of the point",
            source=model.name,
            key=key,
            expected=f"at least {1e3 * distances.min():.6g} mm, the distance of the nearest node of the surface, at "
            f"({where}) mm; or a point on the body",
        )
    return chosen


def arm_notes(model: FEModel, fits: Mapping[str, Fit]) -> list[str]:
    """Sentences on interfaces whose reference point is far from their nodes, which nothing but a rigid arm joins."""
    sentences = []
    for name, found in fits.items():
        group = model.nodes[found.nodes]
        distance = float(np.linalg.norm(group - found.point, axis=1).min())
        extent = float(np.linalg.norm(np.ptp(group, axis=0)))
        if distance > _ARM * extent and distance > 1e-9:
            sentences.append(
                f"interface {name!r}: a rigid arm of {1e3 * distance:.6g} mm joins its point with the nearest node of "
                f"its group, which extends over {1e3 * extent:.6g} mm"
            )
    return sentences
