"""Tables of a case file that describe contacts: what touches a contour, in which shape, by what law."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from collections.abc import Callable
from functools import cache
from typing import Annotated, Any

from pydantic import Field, ValidationInfo, field_validator, model_validator

from heavylift.numerics.quantity import ByExponent
from heavylift.pipeline.case.channel_kinds import CONTOUR_TYPES
from heavylift.pipeline.case.described import Chosen, make_section, section_of
from heavylift.pipeline.case.fields import (
    GROUND,
    BodyPlace,
    CaseContext,
    LengthVector,
    Positive,
    Section,
    UniqueName,
    refuse_unknown,
    reject,
)
from heavylift.solver.scene.contacts import CONTACT_LAWS, CONTACT_SHAPES, Contact, PointShape, Turn
from heavylift.solver.scene.descriptions import Family, described_fields

__all__ = ["Shape", "TurnSection", "contact_section", "refuse_keys_of_others"]

Shape = Annotated[Any, Chosen(CONTACT_SHAPES)]
"""What touches."""
TurnSection: Any = section_of(Turn)

_ON_SURFACES = frozenset({"circle", "ellipsoid", "box", "capsule", "cylinder"})
"""Shapes that touch surfaces only."""


def refuse_keys_of_others(section: Any, value: Any, family: Family[Any], made: Callable[[Any], Any]) -> None:
    """Reject keys of a table that it would have under another law of a family; `made` is the section of a law."""
    for key in value if isinstance(value, dict) else ():
        if key not in section.model_fields:
            owners = [word for word in family.words if key in made(family.get(word)).model_fields]
            words = " or ".join(map(repr, owners))
            if owners:
                reject(f"{key!r} with law {section.DESCRIBED.WORD!r}", f"law {words}, or no {key!r}", key=key)


class _ContactPlace(Section):
    """Where a contact is."""

    name: UniqueName
    """Name; the first part of its channels."""
    law: str
    """Force or impulse across the contact."""
    between: tuple[str, str]
    """The body that touches, and the contour that it touches."""
    point: BodyPlace | None = None
    """Point of the body that touches, or the middle of its shape [m], in the coordinates of the geometry, or the name
    of an interface; its origin if absent."""
    at: LengthVector | None = None
    """In place of `point`: where it is at the start [m], in the world."""
    shape: Shape = Field(default_factory=lambda: section_of(PointShape).model_validate({"type": "point"}))
    """What touches; the point itself if absent."""

    @model_validator(mode="before")
    @classmethod
    def _has_the_keys_of_its_law(cls, value: Any) -> Any:
        refuse_keys_of_others(cls, value, CONTACT_LAWS, contact_section)
        return value

    @field_validator("between")
    @classmethod
    def _is_a_body_and_a_contour(cls, value: tuple[str, str], info: ValidationInfo) -> tuple[str, str]:
        context = CaseContext.of(info)
        if context is None:
            return value
        bodies, contours = context.names.bodies, context.names.contours
        body, contour = value
        if body in contours and body not in bodies and (contour in bodies or contour == GROUND):
            reject(
                f"{body!r} is a contour and {contour!r} a body",
                f'["{contour}", "{body}"]: the body that touches first',
            )
        if body == GROUND:
            reject(
                "the ground touches nothing", "a body that touches; the ground may have the contour", key="0"
            )
        refuse_unknown("body", body, bodies, key="0")
        refuse_unknown("contour", contour, contours, key="1")
        if contours[contour][1] == body:
            reject(f"{contour!r} is a contour of {body!r}, which would touch itself", "two different bodies")
        return value

    @model_validator(mode="after")
    def _fits(self: Any, info: ValidationInfo) -> Any:
        if self.point is not None and self.at is not None:
            reject("both 'point' and 'at'", "'point' (of the body), or 'at' (in the world)", key="at")
        law, shape = self.law, self.shape.type
        if law == "bilateral" and shape != "point":
            reject(
                f"{shape!r} with law 'bilateral'", "'point': it is on the contour itself", key="shape.type"
            )
        if self.footprint is not None and shape not in {"point", "sphere"}:
            reject(f"'footprint' with shape {shape!r}", "shape 'point' or 'sphere'", key="footprint")
        context = CaseContext.of(info)
        if context is None:
            return self
        kind, owner = context.names.contours[self.between[1]]
        if kind not in CONTOUR_TYPES:  # which is reported with the contour
            return self
        if self.footprint is not None and (kind, context.names.body_types.get(owner)) != (
            "surface",
            "flexible",
        ):
            reject(
                f"a footprint on {self.between[1]!r}, a {kind} of {owner!r}",
                "a contour of type 'surface' of a flexible body",
                key="footprint",
            )
        if kind != "surface" and shape in _ON_SURFACES:
            reject(
                f"{shape!r} on {self.between[1]!r}, a {kind}",
                "'point' or 'sphere', or a contour of type 'surface'",
                key="shape.type",
            )
        if kind == "curve" and law != "bilateral" and shape == "point":
            reject(
                f"a point cannot meet {self.between[1]!r}, a curve without thickness",
                "shape 'sphere', law 'bilateral', or a contour of type 'cylinder' or 'band'",
                key="shape",
            )
        return self


class _BallPlace(_ContactPlace):
    """Of a law whose force is a power of the depth."""

    contact_modulus: Annotated[float, Positive("pressure")] | None = None
    """In place of `stiffness`, of a sphere: E* [Pa] with 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2; the stiffness is
    4/3 E* sqrt(radius), of a ball on a flat surface."""

    @model_validator(mode="after")
    def _has_a_stiffness(self: Any) -> Any:
        """One of `stiffness` and `contact_modulus`, which is for spheres."""
        stiffness, exponent = self.stiffness, getattr(self, "exponent", 1.5)
        if (stiffness is None) == (self.contact_modulus is None):
            problem = "no 'stiffness'" if stiffness is None else "both 'stiffness' and 'contact_modulus'"
            reject(problem, "'stiffness', or 'contact_modulus' of a sphere")
        if self.contact_modulus is not None and self.shape.type != "sphere":
            problem = f"'contact_modulus' with shape {self.shape.type!r}"
            reject(problem, "shape 'sphere', or 'stiffness'", key="contact_modulus")
        if self.contact_modulus is not None and exponent != 1.5:
            problem = f"'contact_modulus' with exponent {exponent:g}"
            reject(problem, "exponent 1.5, or 'stiffness'", key="contact_modulus")
        return self


@cache
def contact_section(law: Any) -> Any:
    """Section of a contact by a law: where it is, what all contacts have, and the keys of the law."""
    of_power = any(field.mark(ByExponent) is not None for field in described_fields(law))
    base = make_section(Contact, _BallPlace if of_power else _ContactPlace)
    return make_section(law, base, optional={"stiffness"} if of_power else ())
