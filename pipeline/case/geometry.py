"""Tables of a case file that describe the finite-element model of a flexible body."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, ValidationInfo, field_validator, model_validator

from heavylift.pipeline.case.fields import InFolder, LengthVector, Name, Positive, Quantity, Section, reject

__all__ = [
    "Block",
    "BlocksGeometry",
    "BoxGroup",
    "FaceGroup",
    "FourFilesGeometry",
    "Geometry",
    "Group",
    "MaterialSection",
    "MatricesGeometry",
    "MeshFileGeometry",
    "MeshSection",
    "PlaneGroup",
    "RefinementSection",
    "StepGeometry",
]

BOX_FACES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")

Count = Annotated[int, Field(ge=1, strict=True)]


class MaterialSection(Section):
    """Linear elastic, isotropic material; all of it, but for what a mesh file with materials brings."""

    young_modulus: Annotated[float, Positive("pressure")] | None = None
    """Young's modulus [Pa]."""
    poisson_ratio: Annotated[float, Quantity("number", minimum=-1.0, maximum=0.5)] | None = None
    """Poisson's ratio, between -1 and 0.5."""
    density: Annotated[float, Positive("density")] | None = None
    """Density [kg/m^3]."""

    def given(self) -> dict[str, float]:
        """Properties that are given."""
        return {key: value for key, value in self.model_dump().items() if value is not None}


class PlaneGroup(Section):
    """Nodes in a plane across a coordinate axis."""

    plane: Literal["x", "y", "z"]
    """Axis that the plane is normal to."""
    at: Annotated[float, Quantity("length")]
    """Coordinate of the plane [m]."""


class BoxGroup(Section):
    """Nodes in an axis-aligned box, its surface included."""

    lower: LengthVector = Field(alias="from")
    """Corner with the smallest coordinates [m]."""
    upper: LengthVector = Field(alias="to")
    """Corner with the largest coordinates [m]."""


class FaceGroup(Section):
    """Nodes of a named face of the geometry."""

    face: str
    """``"BLOCK.x_min"`` ... ``"BLOCK.z_max"``, or the label or ``"face NUMBER"`` of a STEP file."""


Group = PlaneGroup | BoxGroup | FaceGroup


def group_kind(value: object) -> str | None:
    """Tell the three kinds of groups apart by their keys."""
    if isinstance(value, (PlaneGroup, BoxGroup, FaceGroup)):
        return {PlaneGroup: "a plane", BoxGroup: "a box", FaceGroup: "a face"}[type(value)]
    if not isinstance(value, dict):
        return None
    return next(
        (kind for kind, key in (("a face", "face"), ("a box", "from"), ("a box", "to")) if key in value),
        "a plane",
    )


GroupField = Annotated[
    Annotated[PlaneGroup, Tag("a plane")]
    | Annotated[BoxGroup, Tag("a box")]
    | Annotated[FaceGroup, Tag("a face")],
    Discriminator(group_kind),
]


class Block(Section):
    """An axis-aligned block between two corners."""

    name: Name
    """Name, unique in the body; its faces are ``NAME.x_min`` to ``NAME.z_max``."""
    lower: LengthVector = Field(alias="from")
    """Corner with the smallest coordinates [m]."""
    upper: LengthVector = Field(alias="to")
    """Corner with the largest coordinates [m]."""

    @field_validator("upper")
    @classmethod
    def _has_volume(cls, upper: tuple[float, ...], info: ValidationInfo) -> tuple[float, ...]:
        lower = info.data.get("lower")
        if lower is not None and any(a >= b for a, b in zip(lower, upper, strict=True)):
            reject(f"corner {list(upper)} m", f"larger than 'from' = {list(lower)} m in every direction")
        return upper


class BlocksGeometry(Section):
    """Union of blocks minus the union of other blocks."""

    type: Literal["blocks"]
    add: Annotated[tuple[Block, ...], Field(min_length=1)]
    """Blocks that are united."""
    cut: tuple[Block, ...] = ()
    """Blocks that are taken away."""
    groups: dict[Name, GroupField] = Field(default_factory=dict)
    """Named groups of nodes."""

    @model_validator(mode="after")
    def _names_are_unique(self) -> "BlocksGeometry":
        names = [block.name for block in (*self.add, *self.cut)]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            reject(f"block name {twice[0]!r} occurs {names.count(twice[0])} times", "one block a name")
        return self

    @field_validator("groups")
    @classmethod
    def _faces_exist(cls, groups: "dict[str, Group]", info: ValidationInfo) -> "dict[str, Group]":
        blocks = [block.name for key in ("add", "cut") for block in info.data.get(key, ())]
        known = {f"{block}.{face}" for block in blocks for face in BOX_FACES}
        for name, group in groups.items():
            if isinstance(group, FaceGroup) and "add" in info.data and group.face not in known:
                reject(
                    f"group {name!r}: face {group.face!r} is unknown",
                    f"BLOCK.x_min ... BLOCK.z_max with one of the blocks {', '.join(blocks)}",
                )
        return groups


class StepGeometry(Section):
    """Solids of a STEP file."""

    type: Literal["step"]
    file: Annotated[str, InFolder()]
    """STEP file in the case folder; its own unit of length is used."""
    groups: dict[Name, GroupField] = Field(default_factory=dict)
    """Named groups of nodes."""


class MeshFileGeometry(Section):
    """A deck of Abaqus, CalculiX or Nastran, or a mesh file of a format of meshio, with bricks or tet10."""

    type: Literal["mesh"]
    file: Annotated[str, InFolder()]
    """Mesh file in the case folder."""
    length_unit: Annotated[float, Positive("length")] = 1.0
    """Length of one unit of the file, e.g. ``"1 mm"`` (default 1 m)."""
    mass_unit: Annotated[float, Positive("mass")] | None = None
    """Unit of mass of the materials of a deck: ``"1 t"`` with mm, N/mm^2 and t/mm^3; needed beside a `length_unit`."""
    elements: tuple[str, ...] = ()
    """Names of element sets, parts or properties of the file that are the body; all by default."""
    part: Count | None = None
    """Number of the part, among those without a common face in the order of the file; one only by default."""
    merge_nodes: Annotated[float, Positive("length")] | None = None
    """Nodes of the file nearer than this become one: joins parts that touch node on node."""
    ignore_material: bool = False
    """Whether materials of the file are neither used nor compared with the one given."""
    groups: dict[Name, GroupField] = Field(default_factory=dict)
    """Groups of nodes, in addition to those named in the file."""


class FourFilesGeometry(Section):
    """Matrices of a finite-element program: ``u0``, ``mij``, ``modeShapeMatrix``, ``stiffnessMatrix``."""

    type: Literal["four_files"]
    folder: Annotated[str, InFolder(folder=True)]
    """Folder of the four files, in the case folder."""
    length_unit: Annotated[float, Positive("length")] = 1.0
    """Unit of the node positions, e.g. ``"1 mm"``."""
    mass_unit: Annotated[float, Positive("mass")] = 1.0
    """Unit of the nodal masses, e.g. ``"1 t"``; a density in kg/m^3 on lengths in mm gives 1e-9 kg."""
    stiffness_unit: Annotated[float, Positive("stiffness")] = 1.0
    """Unit of the stiffness, e.g. ``"1 N/mm"``; a Young's modulus in Pa on lengths in mm gives 1e-3 N/m."""
    clamped_nodes: tuple[Count, ...] | None = None
    """One-based clamped nodes, if the reader cannot find them in the files; an empty list is a free body."""
    groups: dict[Name, GroupField] = Field(default_factory=dict)
    """Named groups of nodes."""


class MatricesGeometry(Section):
    """Stiffness and mass written by CalculiX (``.sti``, ``.mas``, ``.dof``) or Abaqus (``.mtx``), and the deck."""

    type: Literal["matrices"]
    file: Annotated[str, InFolder()]
    """Deck with the nodes, in the case folder."""
    stiffness: Annotated[str, InFolder()] | None = None
    """Stiffness matrix; by default the file of the deck's name with ``.sti``."""
    mass: Annotated[str, InFolder()] | None = None
    """Mass matrix; by default the file of the deck's name with ``.mas``."""
    degrees: Annotated[str, InFolder()] | None = None
    """What the rows are; by default the file of the deck's name with ``.dof``, if there is one."""
    length_unit: Annotated[float, Positive("length")] = 1.0
    """Unit of the node positions, e.g. ``"1 mm"``."""
    mass_unit: Annotated[float, Positive("mass")] = 1.0
    """Unit of the masses, e.g. ``"1 t"``."""
    stiffness_unit: Annotated[float, Positive("stiffness")] = 1.0
    """Unit of the stiffness, e.g. ``"1 N/mm"``."""
    groups: dict[Name, GroupField] = Field(default_factory=dict)
    """Groups of nodes, in addition to those named in the deck."""

    def matrix_files(self) -> dict[str, str]:
        """Paths of the three files as given or by default, relative to the case folder."""
        stem = self.file.rpartition(".")[0]
        named = {"stiffness": ".sti", "mass": ".mas", "degrees": ".dof"}
        return {key: getattr(self, key) or stem + suffix for key, suffix in named.items()}


Geometry = Annotated[
    BlocksGeometry | StepGeometry | MeshFileGeometry | FourFilesGeometry | MatricesGeometry,
    Field(discriminator="type"),
]


class RefinementSection(Section):
    """Smaller elements along edges of the geometry, where stresses are singular; for tetrahedra."""

    at: str
    """``"re-entrant edges"`` (blocks only), or a group: all edges of the geometry that lie in it."""
    size: Annotated[float, Positive("length")]
    """Edge length of the elements there [m]."""
    growth: Annotated[float, Positive("number")] = 0.5
    """Growth of the edge length with the distance."""


class MeshSection(Section):
    """How the geometry is meshed and the matrices are integrated; for blocks and STEP files."""

    element: Literal["tet10", "hex8"] = "tet10"
    """Quadratic tetrahedra or 8-node bricks."""
    size: Annotated[float, Positive("length")] | None = None
    """Target edge length [m]; chosen from the smallest wall if absent."""
    refine: tuple[RefinementSection, ...] = ()
    """Tetrahedra: places with smaller elements."""
    curved: bool = False
    """STEP files: whether middle nodes go onto curved faces."""
    divisions: dict[Literal["x", "y", "z"], tuple[Count, ...]] = Field(default_factory=dict)
    """For bricks: elements in each interval between the planes of the blocks."""
    formulation: Literal["full", "incompatible", "reduced"] | None = None
    """8-node bricks: incompatible modes (default), full integration, or reduced with hourglass stiffness; 20-node
    bricks of a file: full (default), or reduced, with two bricks or more across every wall."""
    mass: Literal["consistent", "lumped"] = "consistent"
    """Consistent mass, or lumped: HRZ for tetrahedra, V/8 for bricks."""

    @model_validator(mode="after")
    def _fits_the_element(self) -> "MeshSection":
        if self.element == "tet10" and self.divisions:
            reject("'divisions' with element 'tet10'", "element 'hex8', or a target 'size'")
        if self.element == "hex8" and self.refine:
            reject("'refine' with element 'hex8'", "element 'tet10', or finer 'divisions'")
        if self.element == "hex8" and self.formulation == "reduced":
            for axis, counts in self.divisions.items():
                if set(counts) == {1}:
                    reject(
                        f"{list(counts)}: one brick a wall, whose single integration point has no bending stiffness",
                        "2 or more bricks (4 for bending within 7 %), or formulation 'incompatible'",
                        key=f"divisions.{axis}",
                    )
        return self
