"""Sections of a case file that describe frames and shells: geometry, supports, loads."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from collections import Counter
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    StringConstraints,
    field_validator,
    model_validator,
)

from heavylift.pipeline.case.bodies import (
    BodySection,
    RigidInitialSection,
)
from heavylift.pipeline.case.described import Chosen
from heavylift.pipeline.case.fields import (
    Direction,
    LengthVector,
    Name,
    NodeNumber,
    Positive,
    Quantity,
    Section,
    as_list,
    refuse_unknown,
    reject,
)
from heavylift.pipeline.case.geometry import BoxGroup
from heavylift.solver.scene.mesh_loads import FRAME_LOADS, SHELL_LOADS
from heavylift.solver.scene.mesh_shapes import FRAME_SHAPES, SHELL_SHAPES
from heavylift.solver.scene.meshes import Elasticity, FrameBody, FrameModel, RodBody, ShellBody

__all__ = [
    "CORNERS",
    "EDGES",
    "ElementNumber",
    "FrameBodySection",
    "FrameFixedSection",
    "FrameGeometry",
    "FrameLoad",
    "FrameRegionSection",
    "FrameSectionTable",
    "FrameSupportSection",
    "MeshBodySection",
    "MeshDampingSection",
    "RegionSection",
    "RodBodySection",
    "RodFixedSection",
    "RodSupportSection",
    "ShellBodySection",
    "ShellFixedSection",
    "ShellGeometry",
    "ShellLoad",
    "ShellSectionTable",
    "ShellSupportSection",
    "check_regions",
]

Count = Annotated[int, Field(ge=1, strict=True)]
ElementNumber = Annotated[int, Field(ge=0, strict=True)]
Angle = Annotated[float, Quantity("angle")]

SQUARE_TORSION = 0.1405770
"""J over the fourth power of the side of a square: S. Timoshenko and J. N. Goodier, *Theory of Elasticity*, 109."""


FrameGeometry = Annotated[Any, Chosen(FRAME_SHAPES)]
"""Line of a frame."""
ShellGeometry = Annotated[Any, Chosen(SHELL_SHAPES)]
"""Outline of a shell."""


class _MaterialTable(Section):
    """What every section is made of."""

    density: Annotated[float, Positive("density")]
    """[kg/m^3]."""
    young_modulus: Annotated[float, Positive("pressure")]
    """Young's modulus [Pa]."""


class FrameSectionTable(_MaterialTable):
    """Cross-section and material of a frame: round, a tube, square, or by its numbers."""

    diameter: Annotated[float, Positive("length")] | None = None
    """Outer diameter of a round section [m]."""
    wall: Annotated[float, Positive("length")] | None = None
    """With `diameter`, thickness of the wall of a tube [m]; solid if absent."""
    side: Annotated[float, Positive("length")] | None = None
    """Of a square section [m]; it bends the same about all axes."""
    area: Annotated[float, Positive("area")] | None = None
    """[m^2]."""
    second_moment: Annotated[float, Quantity("second moment of area", minimum=0.0, closed=True)] | None = None
    """With `area`: second moment of area, the same about all axes [m^4]; 0 for a cable."""
    outer_fibre: Annotated[float, Quantity("length", minimum=0.0, closed=True)] | None = None
    """With `area`: distance of the outermost fibre from the axis [m], for bending stresses; 0 if absent."""
    torsion_constant: Annotated[float, Positive("second moment of area")] | None = None
    """Of a rod: J of its torsional stiffness G J [m^4]; by default that of a round section, tube or square."""

    @model_validator(mode="after")
    def _is_one_shape(self) -> Self:
        given = [key for key in ("diameter", "side", "area") if getattr(self, key) is not None]
        shapes = "'diameter' (and 'wall'), 'side', or 'area' and 'second_moment'"
        if len(given) != 1:
            words = f"both {given[0]!r} and {given[1]!r}" if given else "no shape"
            reject(words, f"one of {shapes}")
        for key, owner in (("wall", "diameter"), ("second_moment", "area"), ("outer_fibre", "area")):
            if getattr(self, key) is not None and given != [owner]:
                reject(f"{key!r} with {given[0]!r}", f"{key!r} with {owner!r}", key=key)
        if given == ["area"] and self.second_moment is None:
            reject("'area' without 'second_moment'", "both, or 'diameter' or 'side'", key="second_moment")
        if self.diameter is not None and self.wall is not None and self.wall > 0.5 * self.diameter:
            reject(
                f"wall = {self.wall:g} m exceeds the radius", f"{0.5 * self.diameter:g} m at most", key="wall"
            )
        return self

    @property
    def torsion(self) -> float | None:
        """J of the section [m4]: 2 I of a circle or a ring, 0.1406 a^4 of a square (Saint-Venant); None: not known."""
        if self.torsion_constant is not None:
            return self.torsion_constant
        if self.side is not None:
            return SQUARE_TORSION * self.side**4
        return 2.0 * self.numbers[1] if self.diameter is not None else None

    @property
    def numbers(self) -> tuple[float, float, float]:
        """Area [m2], second moment of area [m4], distance of the outermost fibre [m]."""
        if self.diameter is not None:
            outer = 0.5 * self.diameter
            inner = 0.0 if self.wall is None else outer - self.wall
            return math.pi * (outer**2 - inner**2), 0.25 * math.pi * (outer**4 - inner**4), outer
        if self.side is not None:
            return self.side**2, self.side**4 / 12.0, 0.5 * self.side
        assert self.area is not None
        assert self.second_moment is not None
        return self.area, self.second_moment, self.outer_fibre or 0.0


class ShellSectionTable(_MaterialTable):
    """Thickness and material of a shell."""

    thickness: Annotated[float, Positive("length")]
    """[m]."""
    poisson_ratio: Annotated[float, Quantity("number", minimum=-1.0, maximum=0.5)]
    """Poisson's ratio, between -1 and 0.5."""


class RegionSection(Section):
    """Elements with another section than the others; of several regions with an element the last one counts."""

    elements: tuple[ElementNumber, ...] = ()
    """Their numbers, from 0; those of a shell count along y first, or along x if it has fewer elements."""
    box: BoxGroup | None = None
    """In place of `elements`: those whose centres are in a box, in the frame of the body."""
    section: Name
    """Name of one of the `sections` of the body."""

    @model_validator(mode="after")
    def _has_elements(self) -> Self:
        if bool(self.elements) == (self.box is not None):
            words = "both 'elements' and 'box'" if self.elements else "neither 'elements' nor 'box'"
            reject(words, "one of them")
        return self

    @field_validator("elements")
    @classmethod
    def _are_different(cls, value: tuple[int, ...]) -> tuple[int, ...]:
        number, times = max(Counter(value).items(), key=lambda item: item[1], default=(0, 1))
        if times > 1:
            reject(f"element {number} occurs {times} times", "each element once")
        return value


class FrameRegionSection(RegionSection):
    """Elements of a frame with another section or another pre-stress than the others; the last region counts."""

    section: Name | None = None  # type: ignore[assignment]
    """Name of one of the `sections` of the body; as without the region if absent."""
    axial_strain: Annotated[float, Quantity("number")] | None = None
    """Strain in the given shape; as that of the body if absent."""

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self.section is None and self.axial_strain is None:
            reject("neither 'section' nor 'axial_strain'", "one of them, or both")
        return self


def check_regions(regions: tuple[RegionSection, ...], sections: dict[str, Any]) -> None:
    """Regions name sections that the body has."""
    for index, region in enumerate(regions):
        if region.section is not None:
            refuse_unknown("section", region.section, sections, key=f"regions.{index}.section")


Axes = Annotated[str, StringConstraints(pattern="^x?y?z?$", min_length=1)]

End = Literal["start", "end"]
Edge = Literal["x_min", "x_max", "y_min", "y_max", "all"]
Corner = Literal["x_min y_min", "x_max y_min", "x_max y_max", "x_min y_max", "all"]
EDGES = ("x_min", "x_max", "y_min", "y_max")
CORNERS = ("x_min y_min", "x_max y_min", "x_max y_max", "x_min y_max")


class FrameFixedSection(Section):
    """Which axes of the body are held of each vector of a node, such as ``"xz"``."""

    position: Axes | None = None
    """Of the position."""
    tangent: Axes | None = None
    """Of the tangent."""


class RodFixedSection(FrameFixedSection):
    """Which axes of the body are held of each vector of a node, such as ``"xz"``."""

    normal: Axes | None = None
    """Of the first director of the section."""
    binormal: Axes | None = None
    """Of its second director."""


class ShellFixedSection(Section):
    """Which axes of the body are held of each vector of a node, such as ``"xz"``."""

    position: Axes | None = None
    """Of the position."""
    slope_x: Axes | None = None
    """Of the slope along x of the mesh."""
    slope_y: Axes | None = None
    """Of the slope along y of the mesh."""
    twist: Axes | None = None
    """Of the derivative of the position by both."""


class _SupportSection(Section):
    """What the supports of frames and shells have: where, and what is held there."""

    nodes: tuple[NodeNumber, ...] = ()
    """Numbers of nodes, from 0; those of a shell count along y first, or along x if it has fewer elements."""
    point: LengthVector | None = None
    """In place of `nodes`: the node at a point, in the frame of the body [m]."""
    box: BoxGroup | None = None
    """In place of `nodes`: those in a box, in the frame of the body."""

    def check_place(self, names: tuple[str, ...]) -> str:
        """The one key that says where it is, of the keys that may."""
        given = [name for name in (*names, "nodes", "point", "box") if getattr(self, name) not in (None, ())]
        if len(given) != 1:
            words = f"both {given[0]!r} and {given[1]!r}" if given else "no place"
            reject(words, f"one of {', '.join((*names, 'nodes', 'point', 'box'))}")
        return given[0]

    def check_held(self, fix: str | None, fixed: Section | None) -> None:
        """One of `fix` and `fixed`, which holds something."""
        if (fix is None) == (fixed is None):
            reject(
                "both 'fix' and 'fixed'" if fix else "neither 'fix' nor 'fixed'",
                "'fix' (a kind of support), or 'fixed' (axes by vector)",
            )
        if fixed is not None and all(getattr(fixed, name) is None for name in type(fixed).model_fields):
            reject("holds nothing", "axes of some vectors", key="fixed")


class FrameSupportSection(_SupportSection):
    """Nodes of a frame that are held to the ground."""

    at: Annotated[
        tuple[End, ...], BeforeValidator(as_list, json_schema_input_type=End | list[End]), Field(min_length=1)
    ] = Field(default=())
    """In place of `nodes`: one end or a list of both."""
    fix: Literal["pinned", "clamped"] | None = None
    """``pinned`` holds the position, ``clamped`` the position and the tangent."""
    fixed: FrameFixedSection | None = None
    """In place of `fix`: axes by vector. ``{ position = "xyz", tangent = "yz" }`` clamps the direction of a frame along
    x and leaves its stretch free."""

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        self.check_place(("at",))
        self.check_held(self.fix, self.fixed)
        return self

    @property
    def held(self) -> dict[str, str]:
        """Axes that are held, by vector."""
        if self.fixed is not None:
            return {key: axes for key, axes in self.fixed.model_dump().items() if axes}
        return {"position": "xyz"} | ({"tangent": "xyz"} if self.fix == "clamped" else {})


class RodSupportSection(FrameSupportSection):
    """Nodes of a rod that are held to the ground."""

    fix: Literal["pinned", "clamped"] | None = None
    """``pinned`` holds the position, ``clamped`` the position, the tangent and the section."""
    fixed: RodFixedSection | None = None
    """In place of `fix`: axes by vector. ``{ position = "yz", normal = "xyz", binormal = "xyz" }`` lets it slide along
    x, and holds its section."""

    @property
    def held(self) -> dict[str, str]:
        """Axes that are held, by vector."""
        more = {"normal": "xyz", "binormal": "xyz"} if self.fix == "clamped" else {}
        return super().held | more


class ShellSupportSection(_SupportSection):
    """Nodes of a shell that are held to the ground."""

    edge: Annotated[
        tuple[Edge, ...],
        BeforeValidator(as_list, json_schema_input_type=Edge | list[Edge]),
        Field(min_length=1),
    ] = Field(default=())
    """In place of `nodes`: an edge, a list of edges, or ``all`` of them."""
    corner: Annotated[
        tuple[Corner, ...],
        BeforeValidator(as_list, json_schema_input_type=Corner | list[Corner]),
        Field(min_length=1),
    ] = Field(default=())
    """In place of `nodes`: a corner, a list of corners, or ``all`` of them."""
    fix: Literal["pinned", "hinged", "clamped"] | None = None
    """``pinned``: the nodes do not move. ``hinged``: the whole edge does not. ``clamped``: nor does it turn. Away from
    edges ``clamped`` holds the position and both slopes."""
    sliding: bool = False
    """With `fix`: only what is normal to the plane of the mesh is held, the nodes are free in it."""
    twist_free: bool = False
    """With ``clamped`` on edges: the twist is not held, and the edge turns a little between its nodes."""
    fixed: ShellFixedSection | None = None
    """In place of `fix`: axes by vector."""

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        place = self.check_place(("edge", "corner"))
        self.check_held(self.fix, self.fixed)
        if self.fixed is not None and self.sliding:
            reject("'sliding' with 'fixed'", "'fix', or axes by vector alone", key="sliding")
        if self.fix == "hinged" and place != "edge":
            reject(f"'hinged' with {place!r}", "'edge': only an edge is a hinge", key="fix")
        if self.twist_free and (self.fix != "clamped" or place != "edge"):
            reject("'twist_free' without a clamped edge", "fix 'clamped' with 'edge'", key="twist_free")
        return self

    @property
    def held(self) -> dict[str, str]:
        """Axes that are held, by vector; empty where `fix` says it, for the mesh then decides."""
        if self.fixed is None:
            return {}
        return {key: axes for key, axes in self.fixed.model_dump().items() if axes}


class MeshDampingSection(Section):
    """Damping of a frame or shell."""

    viscous: Annotated[float, Quantity("rate", minimum=0.0, closed=True)] = 0.0
    """Force per mass and velocity [1/s]; it also slows the body as a whole."""
    stiffness: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Stress per rate of stress [s]: damping is this times the stiffness."""


FrameLoad = Annotated[Any, Chosen(FRAME_LOADS)]
"""Load of a frame."""
ShellLoad = Annotated[Any, Chosen(SHELL_LOADS)]
"""Load of a shell."""


class MeshBodySection(BodySection):
    """What frames and shells have."""

    ASSEMBLED_BY: ClassVar = "heavylift.pipeline.assemble.meshes"

    damping: MeshDampingSection = Field(default_factory=MeshDampingSection)
    """Damping; none if absent."""
    elasticity: Elasticity = "auto"
    """How stress enters the step: ``carried`` carries strains, one linear solve a step; ``energy-momentum`` iterates;
    ``auto`` is the first until carried strains drift too far; ``explicit`` has a largest stable step."""
    drift_tolerance: Annotated[float, Positive("number")] = 1e-3
    """Distance of carried strains from those of the shape at which ``auto`` changes over; it does so at 5 % of the
    largest strain, too."""
    initial: RigidInitialSection = Field(default_factory=RigidInitialSection)
    """Initial state: place of the body, and its motion as a rigid body."""


class FrameBodySection(MeshBodySection):
    """A beam, cable or rod of cubic elements with large displacements and rotations; it has no torsion."""

    BODY: ClassVar[type[FrameBody]] = FrameBody
    CHANNELS: ClassVar = FrameBody.CHANNELS

    type: Literal["frame"]
    geometry: FrameGeometry
    """Its line and its elements."""
    section: FrameSectionTable
    """Section of all elements that are in no region."""
    sections: dict[Name, FrameSectionTable] = Field(default_factory=dict)
    """Further sections by name, for `regions`."""
    regions: tuple[FrameRegionSection, ...] = ()
    """Elements with other sections or pre-stress."""
    model: FrameModel = "green-lagrange"
    """``green-lagrange``: axial strain of Green-Lagrange, for straight elements; ``exact``: stretch and material
    curvature, also for curved elements and large strains."""
    axial_force: Annotated[float, Quantity("force")] | None = None
    """Tension in the given shape [N]: it is pre-stressed."""
    axial_strain: Annotated[float, Quantity("number")] | None = None
    """In place of `axial_force`, the strain in the given shape."""
    supports: tuple[FrameSupportSection, ...] = ()
    """What holds it to the ground."""
    loads: tuple[FrameLoad, ...] = ()
    """Loads on its elements, besides gravity and forces on points."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        check_regions(self.regions, self.sections)
        if self.axial_force is not None and self.axial_strain is not None:
            reject("both 'axial_force' and 'axial_strain'", "one of them", key="axial_strain")
        curved = self.geometry.DESCRIBED.CURVED and not self.BODY.HAS_AXES
        if self.model == "green-lagrange" and curved:
            reject(
                f"model 'green-lagrange' with geometry {self.geometry.type!r}",
                "model 'exact': the elements are curved",
                key="model",
            )
        return self


class RodBodySection(FrameBodySection):
    """A frame that twists: sections resist torsion and have rotary inertia, and joints on it pass all moments."""

    BODY: ClassVar[type[FrameBody]] = RodBody
    CHANNELS: ClassVar = RodBody.CHANNELS

    type: Literal["rod"]  # type: ignore[assignment]  # another word
    model: Literal["green-lagrange"] = "green-lagrange"
    """Axial strain of Green-Lagrange."""
    shear_modulus: Annotated[float, Positive("pressure")]
    """G [Pa]."""
    supports: tuple[RodSupportSection, ...] = ()
    """What holds it to the ground."""
    normal: Direction | None = None
    """Direction of the first director at its first node, in axes of the geometry, of which the part across the tangent
    counts; by default the axis of the geometry that is farthest from the tangent."""
    twist: Annotated[float, Quantity("angle")] = 0.0
    """By which the sections are turned from the first node to the last when unloaded, evenly along the length."""

    @model_validator(mode="after")
    def _resists_torsion(self) -> Self:
        for key, section in (
            ("section", self.section),
            *((f"sections.{k}", s) for k, s in self.sections.items()),
        ):
            if section.torsion is None:
                reject(
                    "'area' without 'torsion_constant'",
                    "both: a rod resists torsion",
                    key=f"{key}.torsion_constant",
                )
            if not section.numbers[1] > 0.0:
                reject("0", "a positive second moment of area of a rod", key=f"{key}.second_moment")
        if self.elasticity == "explicit":
            reject("'explicit' of a rod", "another one: its sections are stiff", key="elasticity")
        return self


class ShellBodySection(MeshBodySection):
    """A plate, shell or membrane of bicubic elements with large displacements and rotations, flat when unloaded."""

    BODY: ClassVar = ShellBody
    CHANNELS: ClassVar = ShellBody.CHANNELS

    type: Literal["shell"]
    geometry: ShellGeometry
    """Its outline and its elements."""
    section: ShellSectionTable
    """Section of all elements that are in no region."""
    sections: dict[Name, ShellSectionTable] = Field(default_factory=dict)
    """Further sections by name, for `regions`."""
    regions: tuple[RegionSection, ...] = ()
    """Elements with other sections."""
    gauss_points: Annotated[int, Field(ge=3, le=7, strict=True)] = 5
    """Points along each direction of an element where membrane strains are taken, 3 to 7."""
    supports: tuple[ShellSupportSection, ...] = ()
    """What holds it to the ground."""
    loads: tuple[ShellLoad, ...] = ()
    """Loads on its elements, besides gravity and forces on points."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        check_regions(self.regions, self.sections)
        return self
