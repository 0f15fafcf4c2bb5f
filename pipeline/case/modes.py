"""The table of a case file for the reduction of a flexible body, and for static vectors of contact in it."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, StringConstraints, model_validator

from heavylift.pipeline.case.fields import (
    GroupName,
    LengthVector,
    Name,
    NoDefault,
    Positive,
    Quantity,
    Section,
    reject,
)

__all__ = ["ContactPatchSection", "ModesSection"]

Index = Annotated[int, Field(ge=1, strict=True)]
DampingRatio = Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)]


ContactDirections = Annotated[str, StringConstraints(pattern="^(normal|x?y?z?)$", min_length=1)]
"""``"normal"``, or some of the letters x, y, z in this order."""


class ContactPatchSection(Section):
    """Where something may touch a flexible body: nodes of a face, or a smooth footprint on it."""

    on: Name
    """Group of the nodes of a face."""
    lower: LengthVector | None = Field(default=None, alias="from")
    """Corner of a box with the smallest coordinates [m]; nodes outside of the box are left out."""
    upper: LengthVector | None = Field(default=None, alias="to")
    """Corner of a box with the largest coordinates [m]."""
    centre: LengthVector | None = None
    """Centre of a disc on the face [m]; nodes farther than the radius are left out."""
    radius: Annotated[float, Positive("length")] | None = None
    """Radius R of the disc [m]."""
    footprint: bool = False
    """One load with the weight (1 - r^2/R^2)^2 over the disc, in place of one load a node."""
    directions: ContactDirections = "normal"
    """Along the outward normal of the face (default), or x, y, z: all three where friction acts."""

    @model_validator(mode="after")
    def _is_one_region(self) -> Self:
        for first, second in (("lower", "upper"), ("centre", "radius")):
            if (getattr(self, first) is None) != (getattr(self, second) is None):
                names = {"lower": "from", "upper": "to"}
                given, absent = (first, second) if getattr(self, second) is None else (second, first)
                given, absent = names.get(given, given), names.get(absent, absent)
                reject(f"{given!r} without {absent!r}", f"both, or a patch without {given!r}", key=absent)
        if self.lower is not None and self.upper is not None:
            if any(a > b for a, b in zip(self.lower, self.upper, strict=True)):
                reject(
                    f"corner {list(self.upper)} m",
                    f"no smaller than 'from' = {list(self.lower)} m in any direction",
                    key="to",
                )
            if self.footprint:
                reject("'from' and 'to' with 'footprint'", "'centre' and 'radius'", key="footprint")
        if self.footprint and self.radius is None:
            reject("'footprint' without a disc", "'centre' and 'radius'", key="footprint")
        return self


def _listed(value: Any) -> Any:
    """A single value as a list of one."""
    return value if isinstance(value, (list, tuple)) else [value]


class ModesSection(Section):
    """Reduction of a finite-element model to a few deformation shapes."""

    basis: Literal["eigenmodes", "craig_bampton", "krylov", "stored"] = "eigenmodes"
    """``eigenmodes``; ``craig_bampton``: constraint modes of `interface` and modes with it held; ``krylov``:
    moment-matching vectors of the static loads; ``stored``: the shapes of geometry ``four_files``."""
    count: Annotated[int, Field(ge=0, strict=True), NoDefault()] = 0
    """Number of eigenmodes: needed for ``eigenmodes`` without `up_to`, with held interface for ``craig_bampton``."""
    up_to: Annotated[float, Positive("frequency")] | None = None
    """All eigenmodes up to this frequency [Hz], `count` at most if that is given: a plated block has a few global modes
    below a crowd of modes of its panels, which no count tells apart."""
    clamp: tuple[GroupName, ...] = ()
    """Groups of nodes that are held; none gives the modes of the free body."""
    select: tuple[Index, ...] = ()
    """One-based numbers of the eigenmodes or stored shapes that are kept; all if empty."""
    interface: tuple[GroupName, ...] = ()
    """For ``craig_bampton``: groups of the nodes where other bodies are attached."""
    static_points: tuple[LengthVector, ...] = ()
    """Points [m], in coordinates of the geometry; unit loads there add static vectors."""
    static_groups: tuple[GroupName, ...] = ()
    """Groups on each of which unit loads, spread evenly, add static vectors."""
    static_directions: Annotated[str, StringConstraints(pattern="^x?y?z?$", min_length=1)] = "xyz"
    """Directions of the unit loads."""
    attach: Literal["contour"] | None = None
    """``"contour"``: static vectors for forces on the nodes of all contours of the body, or of `patches`."""
    attach_directions: ContactDirections | None = None
    """Of these forces: ``"normal"`` (default on surfaces), or some of x, y, z (default on curves: all three)."""
    patches: tuple[ContactPatchSection, ...] = ()
    """With `attach`: where the surface may be touched, in place of the contours."""
    order: Index = 1
    """For ``krylov``: number of blocks of vectors K^-1 b, K^-1 M K^-1 b, ..."""
    stiffening: bool = False
    """Whether inertia and weight along the body stiffen or soften it, as centrifugal forces stiffen a blade."""
    damping_ratio: Annotated[
        tuple[DampingRatio, ...],
        BeforeValidator(_listed, json_schema_input_type=DampingRatio | list[DampingRatio]),
    ] = (0.0,)
    """Of critical: one number, or a list with one number a vector of the basis."""
    stiffness_damping: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Damping matrix over stiffness matrix [s], added to `damping_ratio`: half of this times omega, of critical."""

    @model_validator(mode="after")
    def _fits(self) -> "ModesSection":
        if self.basis not in {"eigenmodes", "craig_bampton"} and self.up_to is not None:
            reject(f"'up_to' with basis {self.basis!r}", "basis 'eigenmodes' or 'craig_bampton'", key="up_to")
        if self.select and self.up_to is not None:
            reject("'select' with 'up_to'", "numbers of modes, or a frequency", key="up_to")
        if self.basis == "eigenmodes" and self.count == 0 and self.up_to is None:
            reject(
                "is missing" if "count" not in self.model_fields_set else "0",
                "1 or more eigenmodes, or 'up_to' a frequency",
                key="count",
            )
        if self.basis in {"eigenmodes", "craig_bampton"} and max(self.select, default=0) > self.count:
            reject(f"'select' requests mode {max(self.select)}", f"numbers up to count = {self.count}")
        if len(set(self.select)) < len(self.select):
            reject(f"'select' = {list(self.select)} repeats a mode", "each mode once")
        if self.basis != "craig_bampton" and self.interface:
            reject(f"'interface' with basis {self.basis!r}", "basis 'craig_bampton'")
        if self.basis == "krylov" and not self.has_static:
            reject("basis 'krylov' without loads", "'static_points', 'static_groups' or 'attach'")
        for key in ("patches", "attach_directions"):
            if getattr(self, key) and self.attach is None:
                reject(f"{key!r} without 'attach'", 'attach = "contour"', key="attach")
        if self.patches and self.attach_directions:
            reject(
                "'attach_directions' with 'patches'", "'directions' of each patch", key="attach_directions"
            )
        if self.basis not in {"eigenmodes", "stored"} and self.select:
            reject(f"'select' with basis {self.basis!r}", "basis 'eigenmodes' or 'stored'")
        return self

    @property
    def has_static(self) -> bool:
        """Whether static loads are given."""
        return bool(self.static_points or self.static_groups or self.attach)

    @property
    def vector_count(self) -> int | None:
        """Vectors of the basis, if the case file tells; static vectors may turn out to be dependent."""
        if self.basis != "eigenmodes" or self.has_static or self.up_to is not None:
            return None
        return len(self.select) or self.count
