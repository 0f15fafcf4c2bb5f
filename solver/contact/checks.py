"""Bad contacts, refused before anything is simulated."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.connections import GROUND
from heavylift.solver.contact.kind import LARGEST_CONTROLS
from heavylift.solver.contacts import (
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
from heavylift.solver.scene import FlexibleBody, Scene

if TYPE_CHECKING:
    from heavylift.solver.contacts import Contour

__all__ = ["check_contact"]


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
        Unknown contour or body, both on one body, nothing that can move, or numbers of law and shape out of range.
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
    other = 0.0 if contour.body == GROUND else scales(contour.body)[0]
    if scales(contact.body)[0] + other == 0.0:
        _refuse(
            contact,
            "between",
            f"neither {contact.body!r} nor {contour.body!r} can move",
            "at least one free body",
        )
    point = np.asarray(contact.point, dtype=np.float64)
    if point.shape != (3,) or not np.all(np.isfinite(point)):
        _refuse(contact, "point", f"{contact.point!r}", "three finite coordinates [m]")
    if not 0.0 <= contact.friction < math.inf:
        _refuse(contact, "friction", f"{contact.friction}", "0 or more")
    _check_law(contact)
    _check_shape(contact, contour)
    _check_footprint(contact, contour, bodies.get(contour.body))


def _check_law(contact: Contact) -> None:
    law: Any = contact.law
    if isinstance(law, RigidLaw):
        if not 0.0 <= law.restitution <= 1.0:
            _refuse(contact, "restitution", f"{law.restitution}", "0 to 1")
        if not 0.0 <= law.rest_speed < math.inf:
            _refuse(contact, "rest_speed", f"{law.rest_speed} m/s", "0 or more")
        return
    if isinstance(law, BilateralLaw):
        return
    assert isinstance(law, LinearLaw | HertzLaw | HuntCrossleyLaw)
    if not 0.0 < law.stiffness < math.inf:
        _refuse(contact, "stiffness", f"{law.stiffness}", "a positive number")
    if isinstance(law, LinearLaw) and not 0.0 <= law.damping < math.inf:
        _refuse(contact, "damping", f"{law.damping} N s/m", "0 or more")
    if isinstance(law, HuntCrossleyLaw):
        if not 0.0 < law.restitution <= 1.0:
            _refuse(contact, "restitution", f"{law.restitution}", "above 0, up to 1")
        if not 1.0 <= law.exponent <= 3.0:
            _refuse(contact, "exponent", f"{law.exponent}", "1 to 3")


def _check_shape(contact: Contact, contour: Contour) -> None:
    shape: Any = contact.shape
    curve = contour.neutral is not None and len(contour.neutral.spaces) == 1
    if isinstance(contact.law, BilateralLaw) and not isinstance(shape, PointShape):
        _refuse(contact, "shape", "a bilateral contact of more than a point", "a point")
    if isinstance(shape, SphereShape) and not 0.0 < shape.radius < math.inf:
        _refuse(contact, "shape.radius", f"{shape.radius} m", "a positive length")
    if isinstance(shape, CircleShape) and not 0.0 < shape.radius < math.inf:
        _refuse(contact, "shape.radius", f"{shape.radius} m", "a positive length")
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


def _check_footprint(contact: Contact, contour: Contour, body: Any) -> None:
    if contact.footprint == 0.0:
        return
    if not 0.0 < contact.footprint < math.inf:
        _refuse(contact, "footprint", f"{contact.footprint} m", "0 or more")
    surface = contour.neutral is not None and len(contour.neutral.spaces) == 2
    if not (surface and isinstance(body, FlexibleBody)):
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
