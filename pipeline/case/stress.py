"""Table of a case file that asks for the stress of a flexible body over the run."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, ClassVar, Literal

from pydantic import StringConstraints, ValidationInfo, field_validator, model_validator

from heavylift.pipeline.case.fields import (
    Direction,
    LengthVector,
    Name,
    Positive,
    Quantity,
    Section,
    refuse_unknown,
    reject,
)
from heavylift.pipeline.case.steel import steel_grades, thickest

__all__ = ["HotSpotSection", "PropertyName", "StressGroupSection", "StressSection"]

PropertyName = Annotated[str, StringConstraints(pattern=r"^[^\s.][^.]*$", max_length=200)]
"""Name of a group of nodes, or of a property as decks have it: ``"PSHELL 3"``; without dots, being part of names."""


class _StrengthSection(Section):
    """What stress is compared with."""

    grade: str | None = None
    """Grade of structural steel by EN 10025-2, as ``"S355"``, whose yield strength depends on the thickness."""
    yield_strength: Annotated[float, Positive("pressure")] | None = None
    """Yield strength [Pa], in place of `grade`."""
    thickness: Annotated[float, Positive("length")] | None = None
    """Of the material [m], by which a grade has its yield strength, where plates do not say it: of solids and beams."""

    @field_validator("grade")
    @classmethod
    def _is_known(cls, grade: str | None) -> str | None:
        if grade is not None:
            refuse_unknown("grade", grade, steel_grades())
        return grade

    @model_validator(mode="after")
    def _has_one_strength(self) -> "_StrengthSection":
        if self.grade is not None and self.yield_strength is not None:
            reject("both 'grade' and 'yield_strength'", "one of them", key="yield_strength")
        if self.grade is not None and self.thickness is not None and self.thickness > thickest(self.grade):
            reject(
                f"{1e3 * self.thickness:g} mm of {self.grade}",
                f"up to {1e3 * thickest(self.grade):g} mm, or 'yield_strength'",
                key="thickness",
            )
        return self

    @property
    def has_strength(self) -> bool:
        """Whether a strength is given."""
        return self.grade is not None or self.yield_strength is not None


class StressGroupSection(_StrengthSection):
    """Points of a flexible body whose largest stress is told."""

    name: PropertyName
    """Group of plates or beams, by the name of their property, or of nodes."""


class HotSpotSection(Section):
    """A weld toe whose structural stress is extrapolated from two points before it."""

    AT: ClassVar = (0.5, 1.5)
    """Distances of both points from the toe, in thicknesses."""

    name: Name
    """Unique in the body."""
    toe: LengthVector
    """Point on the weld toe [m], coordinates of the geometry."""
    direction: Direction
    """Away from the toe along the surface, square to the weld, in axes of the geometry: the stress is the normal one
    along it."""
    thickness: Annotated[float, Positive("length")]
    """Thickness of the plate t [m]: the points are 0.5 t and 1.5 t away from the toe."""
    side: Literal["top", "bottom"] | None = None
    """Of a plate: on which side the weld is, ``top`` being that of its normal."""


class StressSection(_StrengthSection):
    """Stress of a flexible body over the run: of groups at each record, and the envelope at all points."""

    groups: tuple[StressGroupSection, ...] = ()
    """Groups that are told; of structures all properties if empty, of solids the whole body."""
    gamma_M: Annotated[float, Quantity("number", minimum=1.0, closed=True)] = 1.0  # noqa: N815  as in EN 1993
    """Partial factor: the utilisation is the von Mises stress times it over the yield strength."""
    correction: bool = True
    """Whether weight and inertia of the frame, which no mode may follow, act by their static answer too."""
    hot_spots: tuple[HotSpotSection, ...] = ()
    """Weld toes, as at lugs."""
    panels: bool = False
    """Whether plates between stiffeners and other plates are told with their utilisation by buckling, by mean
    stresses."""

    buckling: bool = False
    """Whether the factor is told by which all stress may grow until the body buckles, at the record with the largest
    elastic energy: linear buckling of the whole model, restrained by `modes.clamp` and `supports` alone."""

    @field_validator("groups", "hot_spots")
    @classmethod
    def _one_each(cls, entries: tuple[Any, ...], info: ValidationInfo) -> tuple[Any, ...]:
        names = [one.name for one in entries]
        for index, name in enumerate(names):
            if name in names[:index]:
                what = "group" if info.field_name == "groups" else "hot spot"
                reject(f"{name!r} is used before", f"one {what} a name", key=f"{index}.name")
        return entries

    @property
    def names(self) -> tuple[str, ...]:
        """Groups that are named; of hot spots see `hot_spots`."""
        return tuple(one.name for one in self.groups)
