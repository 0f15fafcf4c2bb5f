"""Bad contacts, refused before anything is simulated."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.contact.kind import LARGEST_CONTROLS
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.contacts import (
    BilateralLaw,
    CircleShape,
    Contact,
    HertzLaw,
    HuntCrossleyLaw,
    LinearLaw,
    PointShape,
    RigidLaw,
    SphereShape,
)
from heavylift.solver.scene.descriptions import check_object
from heavylift.solver.scene.scene import Scene

if TYPE_CHECKING:
    from heavylift.solver.scene.contacts import Contour

__all__ = ["check_about_curve", "check_contact", "check_law", "check_motion"]

NEARLY_ALONG = 1e-3
"""Sine of the angle between a curve and the director of a band, from which on that lies across."""


def check_contact(contact: Contact, scene: Scene, scales: Callable[[str], tuple[float, float]]) -> None:
    """Refuse a contact that cannot be.

    Parameters
    ----------
    contact, scene
        The contact and all that is there.
    scales
        Inverse mass and inertia of a body by name, 0 if its motion is prescribed.

    Raises
    ------
    InputError
        Unknown contour or body, both on one body, nothing that can move, sharp edges, a shape that the contour does not
        take, or numbers of law and shape out of range.
    """
    contours = {contour.name: contour for contour in scene.contours}
    bodies = {body.name: body for body in scene.bodies}
    if contact.contour not in contours:
        _refuse(contact, "between", f"there is no contour {contact.contour!r}", _names(contours))
    if contact.body not in bodies:
        _refuse(contact, "between", f"there is no body {contact.body!r}", _names(bodies))
    contour = contours[contact.contour]
    if contour.body == contact.body:
        _refuse(contact, "between", f"{contact.body!r} touches itself", "a contour of another body")
    check_motion(contact.name, contact.body, contour.body, scales)
    point = np.asarray(contact.point, dtype=np.float64)
    if point.shape != (3,) or not np.all(np.isfinite(point)):
        _refuse(contact, "point", f"{contact.point!r}", "three finite coordinates [m]")
    check_law(contact.name, contact.law, contact.friction)
    _check_shape(contact, contour, bodies.get(contour.body))
    _check_footprint(contact, contour, bodies.get(contour.body))


def check_motion(name: str, first: str, second: str, scales: Callable[[str], tuple[float, float]]) -> None:
    """Refuse what touches nothing that can move.

    Parameters
    ----------
    name
        Of the contact, for the message.
    first, second
        Bodies, or the ground.
    scales
        As of `check_contact`.

    Raises
    ------
    InputError
        If neither is free.
    """
    if sum(0.0 if body == GROUND else scales(body)[0] for body in (first, second)) == 0.0:
        raise InputError(
            f"neither {first!r} nor {second!r} can move",
            source=name,
            key="between",
            expected="at least one free body",
        )


def check_law(name: str, law: Any, friction: float) -> None:
    """Refuse numbers of a law that are out of range.

    Parameters
    ----------
    name
        Of the contact, for the message.
    law, friction
        The law, and Coulomb's coefficient.

    Raises
    ------
    InputError
        For such a number.
    """

    def refuse(key: str, problem: str, expected: str) -> None:
        raise InputError(problem, source=name, key=key, expected=expected)

    if not 0.0 <= friction < math.inf:
        refuse("friction", f"{friction}", "0 or more")
    if isinstance(law, RigidLaw):
        if not 0.0 <= law.restitution <= 1.0:
            refuse("restitution", f"{law.restitution}", "0 to 1")
        if not 0.0 <= law.rest_speed < math.inf:
            refuse("rest_speed", f"{law.rest_speed} m/s", "0 or more")
        return
    if isinstance(law, BilateralLaw):
        return
    assert isinstance(law, LinearLaw | HertzLaw | HuntCrossleyLaw)
    if not 0.0 < law.stiffness < math.inf:
        refuse("stiffness", f"{law.stiffness}", "a positive number")
    if isinstance(law, LinearLaw) and not 0.0 <= law.damping < math.inf:
        refuse("damping", f"{law.damping} N s/m", "0 or more")
    if isinstance(law, HuntCrossleyLaw):
        if not 0.0 < law.restitution <= 1.0:
            refuse("restitution", f"{law.restitution}", "above 0, up to 1")
        if not 1.0 <= law.exponent <= 3.0:
            refuse("exponent", f"{law.exponent}", "1 to 3")


def _check_shape(contact: Contact, contour: Contour, body: Any) -> None:
    shape: Any = contact.shape
    curve = (body is not None and body.SHAPE == "curve") or (
        contour.neutral is not None and len(contour.neutral.spaces) == 1
    )
    if isinstance(contact.law, BilateralLaw) and not isinstance(shape, PointShape):
        _refuse(contact, "shape", "a bilateral contact of more than a point", "a point")
    _check_numbers(contact)
    if isinstance(shape, CircleShape) and contour.flip:
        _refuse(
            contact,
            "shape",
            f"a ring on {contour.name!r}, whose normal is flipped",
            "a contour without 'flip', its rows of points in the opposite order",
        )
    if curve and not isinstance(shape, PointShape | SphereShape):
        _refuse(contact, "shape", f"a {type(shape).__name__} on a curve", "a point or a sphere")
    unilateral = curve and not isinstance(contact.law, BilateralLaw)
    if unilateral and contour.radius == 0.0 and contour.width == 0.0 and isinstance(shape, PointShape):
        _refuse(
            contact,
            "law",
            "a point on a bare curve has no side",
            "'bilateral', or a contour with a radius or width",
        )


def _check_numbers(contact: Contact) -> None:
    """Those of the shape, by its description."""
    try:
        check_object(contact.shape, source=contact.name)
    except InputError as error:
        _refuse(contact, f"shape.{error.key}", error.problem, error.expected)


def check_about_curve(contour: Contour, is_curve: bool) -> None:
    """Refuse a cylinder or band about a curve that cannot be.

    Parameters
    ----------
    contour
        The contour.
    is_curve
        Whether it is a curve.

    Raises
    ------
    InputError
        Lengths below 0, both at once, either on a surface, or a director that does not point across the curve.
    """
    for key, value in {"radius": contour.radius, "width": contour.width}.items():
        if not 0.0 <= value < math.inf:
            raise InputError(f"{value} m", source=contour.name, key=key, expected="0 or more")
        if value > 0.0 and not is_curve:
            raise InputError(
                f"{value} m on a surface", source=contour.name, key=key, expected="a curve, or 0"
            )
    if contour.radius > 0.0 and contour.width > 0.0:
        raise InputError(
            "a cylinder and a band about one curve",
            source=contour.name,
            key="width",
            expected="one of the two",
        )
    if contour.width > 0.0:
        director = np.asarray(contour.director, dtype=np.float64)
        across = math.inf
        if contour.neutral is not None:
            chords = np.diff(contour.neutral.control, axis=0)
            chords = chords[np.linalg.norm(chords, axis=1) > 0.0]
            sine = np.linalg.norm(np.cross(chords, director), axis=1) / np.linalg.norm(chords, axis=1)
            across = float(sine.min(initial=math.inf))
        if not (np.linalg.norm(director) > 0.0 and across > NEARLY_ALONG * float(np.linalg.norm(director))):
            raise InputError(
                f"{director.tolist()}",
                source=contour.name,
                key="director",
                expected="a vector across the curve everywhere: along the width of the band",
            )


def _check_footprint(contact: Contact, contour: Contour, body: Any) -> None:
    if contact.footprint == 0.0:
        return
    if not 0.0 < contact.footprint < math.inf:
        _refuse(contact, "footprint", f"{contact.footprint} m", "0 or more")
    if not isinstance(contact.shape, PointShape | SphereShape):
        _refuse(contact, "footprint", f"of a {type(contact.shape).__name__}", "a point or a sphere")
    surface = contour.neutral is not None and len(contour.neutral.spaces) == 2
    if not (surface and body is not None and body.MODAL):
        _refuse(
            contact, "footprint", f"{contact.footprint} m on {contour.name!r}", "a surface of a flexible body"
        )
    if len(contour.neutral.control) > LARGEST_CONTROLS - 2:  # type: ignore[union-attr]
        _refuse(
            contact,
            "footprint",
            f"{len(contour.neutral.control)} control points of {contour.name!r}",  # type: ignore[union-attr]
            f"{LARGEST_CONTROLS - 2} at most",
        )


def _names(named: dict[str, Any]) -> str:
    return "one of " + ", ".join(sorted(named)) if named else "there are none"


def _refuse(contact: Contact, key: str, problem: str, expected: str) -> None:
    raise InputError(problem, source=contact.name, key=key, expected=expected)
