"""The table of a case file that describes a flexible body: what it is made from.

It is a geometry, a mesh and a reduction, of which stages make what the solver takes; its section stays one of the
pipeline.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidationInfo, WithJsonSchema, field_validator, model_validator

from heavylift.pipeline.case.bodies import BodySection, Frame, RigidInitialSection, check_initial
from heavylift.pipeline.case.deck_groups import PlateGroupSection, StiffenerGroupSection
from heavylift.pipeline.case.fields import Name, Quantity, parse_list, quantity_schema, reject
from heavylift.pipeline.case.geometry import Geometry, MaterialSection, MeshSection
from heavylift.pipeline.case.interfaces import InterfaceSection
from heavylift.pipeline.case.modes import ModesSection
from heavylift.pipeline.case.panels import PanelsGeometry
from heavylift.pipeline.case.statics import BodySupportSection, StaticCaseSection
from heavylift.pipeline.case.stress import StressSection
from heavylift.solver.scene.bodies import FlexibleBody

__all__ = ["FlexibleBodySection", "InitialSection"]

ModalValues = Annotated[
    tuple[float, ...], WithJsonSchema({"type": "array", "items": quantity_schema()}, mode="validation")
]
"""Numbers in SI or strings whose unit depends on the scaling of the mode shapes."""


class InitialSection(RigidInitialSection):
    """Initial state of a flexible body."""

    modal_scaling: Literal["unit_max", "mass"] = "unit_max"
    """``unit_max``: mode shapes with largest component 1, so that coordinates are lengths; ``mass``: modal mass 1."""
    modal_position: ModalValues = ()
    """Coordinates of the first vectors, in m (``unit_max``) or m kg^0.5 (``mass``); the others are zero."""
    modal_velocity: ModalValues = ()
    """Speeds of the first vectors, in m/s (``unit_max``) or m kg^0.5/s (``mass``); the others are zero."""

    @field_validator("modal_position", "modal_velocity", mode="before")
    @classmethod
    def _in_the_unit_of_the_scaling(cls, values: Any, info: ValidationInfo) -> Any:
        if not isinstance(values, (list, tuple)):
            reject(f"{values!r} is not a list", "a list of numbers or strings with a unit")
        by_mass = info.data.get("modal_scaling") == "mass"
        if info.field_name == "modal_position":
            kind = "modal coordinate" if by_mass else "length"
        else:
            kind = "modal velocity" if by_mass else "velocity"
        return parse_list(Quantity(kind), values)


class FlexibleBodySection(BodySection):
    """A body with a finite-element model that deforms."""

    BODY: ClassVar = FlexibleBody
    ASSEMBLED_BY: ClassVar = "heavylift.pipeline.assemble.flexible"
    CHANNELS: ClassVar = FlexibleBody.CHANNELS

    type: Literal["flexible"]
    geometry: Annotated[Geometry | PanelsGeometry, Field(discriminator="type")]
    """Shape, or matrices of another program."""
    material: MaterialSection | None = None
    """Material; needed unless the geometry brings matrices, or is a mesh file that says it, which must agree."""
    mesh: MeshSection = Field(default_factory=MeshSection)
    """Elements; for geometries that are meshed here."""
    plates: dict[str, PlateGroupSection] = Field(default_factory=dict)
    """Of a mesh file, plates by name of their element set: what the file lacks, or what is otherwise here."""
    stiffeners: dict[str, StiffenerGroupSection] = Field(default_factory=dict)
    """Of a mesh file, beams by name of their element set: what the file lacks, or what is otherwise here."""
    modes: ModesSection
    """Reduction to mode shapes."""
    supports: tuple[BodySupportSection, ...] = ()
    """What is held in single directions, and planes of symmetry; besides `modes.clamp`."""
    static: tuple[StaticCaseSection, ...] = ()
    """Static load cases, solved with the modes."""
    interfaces: dict[Name, InterfaceSection] = Field(default_factory=dict)
    """Places where others are attached, by name; each adds six attachment modes to the basis."""
    stress: StressSection | None = None
    """Stress over the run; none if absent."""
    frame: Frame
    """How the body frame moves."""
    initial: InitialSection = Field(default_factory=InitialSection)
    """Initial state."""

    @property
    def vector_count(self) -> int | None:
        """Vectors of the basis, if its table tells; attachment modes of joints apart.

        Bodies of plates and beams, which panels and mesh files may be, have vectors for all that pulls at them.
        """
        joined = self.interfaces or self.geometry.type in {"mesh", "panels"}
        return None if joined else self.modes.vector_count

    @model_validator(mode="after")
    def _fits(self) -> "FlexibleBodySection":
        given = self.geometry.type
        matrices = given in {"four_files", "matrices"}
        if matrices and self.material is not None:
            reject(f"'material' with geometry {given!r}", "no material: the files hold the matrices")
        if given not in {"four_files", "matrices", "mesh", "panels"} or getattr(
            self.geometry, "ignore_material", False
        ):
            if self.material is None:
                reject("no 'material'", "young_modulus, poisson_ratio and density")
            for key in type(self.material).model_fields:
                if key not in self.material.given():
                    reject(f"no {key!r}", "young_modulus, poisson_ratio and density", key=f"material.{key}")
        if matrices and "mesh" in self.model_fields_set:
            reject(f"'mesh' with geometry {given!r}", "no mesh section: the files hold the matrices")
        if given == "panels":
            if self.mesh.size is None:
                reject("no 'mesh.size'", "edge length of the elements of plates", key="mesh.size")
            extra = sorted(self.mesh.model_fields_set - {"mass", "size"})
            if extra:
                reject(f"'mesh' has {', '.join(extra)} with geometry 'panels'", "only 'size' and 'mass'")
        if given != "step" and self.mesh.curved:
            reject(f"'mesh.curved' with geometry {given!r}", "geometry 'step'")
        if given == "mesh" and self.mesh.model_fields_set - {"mass", "formulation", "element"}:
            keys = ", ".join(sorted(self.mesh.model_fields_set - {"mass", "formulation", "element"}))
            reject(
                f"'mesh' has {keys} with geometry 'mesh'",
                "only 'mass' and 'formulation': the file is the mesh",
            )
        for key in ("plates", "stiffeners"):
            if getattr(self, key) and given != "mesh":
                reject(
                    f"{key!r} with geometry {given!r}",
                    "geometry 'mesh', or 'panels' with its own tables",
                    key=key,
                )
        formulation = self.mesh.formulation
        if given != "mesh" and self.mesh.element == "tet10" and formulation not in {None, "full"}:
            reject(
                f"formulation {formulation!r} with element 'tet10'", "'full', or element 'hex8'", key="mesh"
            )
        if given != "blocks" and self.mesh.divisions:
            reject(f"'mesh.divisions' with geometry {given!r}", "geometry 'blocks'")
        if given == "step" and self.mesh.element != "tet10":
            reject("element 'hex8' with geometry 'step'", "element 'tet10'")
        if self.modes.basis == "stored" and given != "four_files":
            reject(
                f"basis 'stored' with geometry {given!r}", "geometry 'four_files', which brings mode shapes"
            )
        if self.frame.motion == "free" and self.modes.clamp:
            reject(
                f"{list(self.modes.clamp)} holds nodes of a body whose frame is free",
                "no clamp with a free frame (its modes are those of the free body; 'static_points' and "
                "'static_groups' add shapes under loads), or frame motion 'fixed' or 'driven'",
                key="modes.clamp",
            )
        if self.frame.motion == "free" and self.supports:
            reject(
                "holds nodes of a body whose frame is free",
                "no supports with a free frame, or frame motion 'fixed' or 'driven'",
                key="supports",
            )
        if self.modes.basis == "craig_bampton" and not self.modes.interface:
            if not self.interfaces:
                reject(
                    "basis 'craig_bampton' without 'interface'",
                    "at least one group as interface, or interfaces of kind 'rigid'",
                    key="modes",
                )
            for name, interface in self.interfaces.items():
                if interface.kind != "rigid":
                    reject(
                        f"kind {interface.kind!r} with basis 'craig_bampton'",
                        "kind 'rigid', groups in 'modes.interface', or basis 'eigenmodes'",
                        key=f"interfaces.{name}.kind",
                    )
        names = [one.name for one in self.static]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            reject(f"load case {twice[0]!r} occurs {names.count(twice[0])} times", "one a name", key="static")
        count = self.vector_count
        for key, given_count in (
            ("initial.modal_position", len(self.initial.modal_position)),
            ("initial.modal_velocity", len(self.initial.modal_velocity)),
        ):
            if count is not None and given_count > count:
                reject(f"{given_count} values", f"at most {count}, one a mode", key=key)
        if count is not None and 1 < len(self.modes.damping_ratio) < count:  # of joints there may be more
            reject(f"{len(self.modes.damping_ratio)} values", f"1 or {count}", key="modes.damping_ratio")
        check_initial(self.frame, self.initial)
        self._has_stress()
        return self

    def missing_stress(self, name: str, item: str, what: str) -> str:
        """What a quantity of its stress needs and it does not have, as far as is known before it has a mesh."""
        if self.stress is None:
            return f"a table 'stress' of body {name!r}"
        spot = what == "hot_spot"
        if what == "buckling" and not self.stress.panels:
            return f"'panels = true' in the table 'stress' of {name!r}"
        known = [one.name for one in (self.stress.hot_spots if spot else self.stress.groups)]
        if not known and not spot:
            # properties of a structure are known with its mesh only
            known = ["all"] if self.geometry.type in {"blocks", "step"} else [item]
        if item not in known:
            kind = "hot spot" if spot else "group"
            return f"a {kind} of the stress of {name!r}: {', '.join(known) or 'there are none'}"
        return ""

    def _has_stress(self) -> None:
        """Stress needs elements; a grade of steel a thickness, which solids do not have."""
        if self.stress is None:
            return
        given = self.geometry.type
        if given in {"four_files", "matrices"}:
            reject(
                f"with geometry {given!r}, which holds matrices alone",
                "a body with elements between its nodes, or no 'stress'",
                key="stress",
            )
        if given not in {"blocks", "step"}:
            return
        if self.stress.panels:
            reject("true with solids", "a body with plates", key="stress.panels")
        if self.stress.thickness is not None:
            return
        words = "is missing: the strength of {} depends on it, and solids have none"
        if self.stress.grade is not None and not self.stress.groups:
            reject(
                words.format(self.stress.grade),
                "the thickness of the material, or 'yield_strength'",
                key="stress.thickness",
            )
        for index, group in enumerate(self.stress.groups):
            by_grade = group.grade or (self.stress.grade if group.yield_strength is None else None)
            if by_grade is not None and group.thickness is None:
                reject(
                    words.format(by_grade),
                    "the thickness of the material, or 'yield_strength'",
                    key=f"stress.groups.{index}.thickness",
                )
