"""A case: one folder with a case.toml that describes an operation, its checks and its sources."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, PrivateAttr, ValidationError
from pydantic_core import PydanticCustomError

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline.case.channel_kinds import Declared
from heavylift.pipeline.case.collisions import collision_pairs
from heavylift.pipeline.case.criteria_table import Criteria
from heavylift.pipeline.case.described import Later
from heavylift.pipeline.case.equipment import Equipped, equip
from heavylift.pipeline.case.errors import group_errors, input_errors
from heavylift.pipeline.case.fields import CaseContext, Section, reject
from heavylift.pipeline.case.interface_names import put_interface_points
from heavylift.pipeline.case.lugs import with_lug_interfaces
from heavylift.pipeline.case.overrides import apply_overrides
from heavylift.pipeline.case.quantity_names import (
    ACROSS,
    QuantityName,
    parse_quantity_name,
    single_components,
)
from heavylift.pipeline.case.reference import ReferenceSection, read_reference
from heavylift.pipeline.case.repeat import Expansion, Parameters, RepeatSection, expand
from heavylift.pipeline.case.report import ReportSection
from heavylift.pipeline.case.simulate import SimulateSection, multiple
from heavylift.pipeline.case.tables import TABLES, SceneTables, declared
from heavylift.pipeline.equipment.builders import BUILDERS
from heavylift.solver.scene.actions import Hook
from heavylift.solver.scene.inputs import check_inputs
from heavylift.solver.scene.operation_state import Movable, drives_of, helpers_of, releases_of
from heavylift.solver.scene.scenario import Scenario, check_scenario

if TYPE_CHECKING:
    from heavylift.pipeline.case.checks import CheckSection
    from heavylift.pipeline.case.meshes import FrameBodySection, ShellBodySection
    from heavylift.pipeline.case.scenario import Known

__all__ = ["ASKING", "CASE_FILE", "Case", "check_values", "load_case", "make_case", "read_document"]

CASE_FILE = "case.toml"
_HERE = "heavylift.pipeline.case"

ASKING = {"check", "converge", "criteria", "reference", "report", "scenario"}
"""Tables that name channels to judge or show them, or to wait for them."""
GAP = re.compile(r"([^\s.,()]+)\.gap(?:_min)?(?!\w)")
"""Owner, or pattern of owners, of a gap in the name of a quantity or channel, or in a combination of them."""
_NO_ELEMENTS = "elements and a material, and the four files of {!r} hold matrices alone"


class _CaseHeading(Section):
    """What a case says before its scene."""

    title: str
    """One line that describes the case."""
    sources: tuple[str, ...] = ()
    """Where the numbers come from."""
    parameters: Parameters = Field(default_factory=dict)
    """Named numbers, for counts and for ``{...}`` in texts."""
    repeat: tuple[RepeatSection, ...] = ()
    """Blocks of tables that are copied with an index."""


class Case(SceneTables, _CaseHeading):
    """The content of a case file in SI units; made by `load_case`.

    Examples
    --------
    >>> import heavylift as hl
    >>> case = hl.load_case("cases/hoist")
    >>> case.ropes[0].length, case.simulate.step
    (100.0, 0.01)
    """

    reference: tuple[ReferenceSection, ...] = ()
    """Recorded histories to compare with."""
    ballast: Annotated[Any, Later(f"{_HERE}.ballast", "BallastSection")] | None = None
    """Stages for which tanks are to be filled."""
    simulate: SimulateSection | None = None
    """Time integration; a case without it ends with its modes."""
    report: ReportSection = Field(default_factory=ReportSection)
    """Pictures and plots."""
    converge: Annotated[Any, Later(f"{_HERE}.checks", "ConvergeSection")] | None = None
    """Convergence study."""
    check: tuple[Annotated[Any, Later(f"{_HERE}.checks", "CheckSection")], ...] = ()
    """Reference values."""
    criteria: Criteria = ()
    """Criteria that the operation is judged by: cranes, slings, clearances."""

    _file: Path = PrivateAttr(default=Path(CASE_FILE))
    _document: dict[str, Any] = PrivateAttr(default_factory=dict)
    _expansion: Expansion = PrivateAttr(default_factory=lambda: Expansion({}))
    _equipped: Equipped = PrivateAttr(default_factory=lambda: Equipped({}))
    _names: Declared = PrivateAttr(default_factory=Declared)
    _overrides: tuple[str, ...] = PrivateAttr(default=())

    def _misfits(self) -> Iterator[InputError]:
        """Tables that are right by themselves and do not fit together: everything that is wrong with them."""
        parts: list[Callable[[], None]] = [
            *(partial(self._check_can_be_computed, *entry) for entry in enumerate(self.check)),
            *(partial(self._criterion_can_be_computed, *entry) for entry in enumerate(self.criteria)),
            self._fits_the_sea,
            *(partial(self._reference_fits, *entry) for entry in enumerate(self.reference)),
            self._integrates_contacts,
            self._has_an_operation,
            self._has_inputs,
            self._plans_ballast,
            self._exchanges,
            *(partial(self._has_a_run, name) for name in self.bodies),
            *(partial(self._has_axes, index) for index in range(len(self.relative_motions))),
        ]
        for part in parts:
            try:
                part()
            except PydanticCustomError as error:
                told = error.context or {}
                yield InputError(
                    told["problem"], source=self.file, key=told["key"] or "case", expected=told["expected"]
                )

    def _check_can_be_computed(self, index: int, check: "CheckSection") -> None:
        """Modes and coordinates that a check names must exist, and a simulation if it needs one."""
        from heavylift.pipeline.case.checks import QuantityReference

        texts = {f"check.{index}.quantity": check.quantity}
        if isinstance(check.reference, QuantityReference):
            texts[f"check.{index}.reference.quantity"] = check.reference.quantity
        self._can_be_computed(texts)

    def _criterion_can_be_computed(self, index: int, criterion: Any) -> None:
        """What a criterion looks at must exist."""
        key = f"criteria.{index}"
        criterion.check_case(self, key)
        self._can_be_computed({f"{key}.{own}": text for own, text in criterion.quantities().items()})

    def _can_be_computed(self, texts: Mapping[str, str]) -> None:
        """Refuse quantities, by the keys that name them, that the case cannot have."""
        for key, text in texts.items():
            quantity = self.quantity(text)
            for member in dict(quantity.members).values() or (text,):
                one = self.quantity(member)
                problem = self._missing_for(one)
                if problem:
                    reject(f"{member!r} needs {problem}", "a quantity that the case has", key=key)
                whole = (
                    one.family in {"channel", "frequency", "angular_frequency", "growth"}
                    and not one.component
                )
                components = single_components(one.item, self._names) if whole else None
                if components is not None and len(components) > 1:
                    expected = f"one of its components: {', '.join(components)}; or {', '.join(ACROSS)}"
                    reject(f"{member!r} has {len(components)} components", expected, key=key)
            if quantity.family == "drift" and quantity.item in {"momentum", "angular_momentum"}:
                self._conserves_momentum(text, key)

    def _conserves_momentum(self, text: str, key: str) -> None:
        """The drift of a momentum is an error of the integration only if nothing outside acts on the scene."""
        causes = [
            f"the {entry.frame.motion} frame of {name!r}" if key == "bodies" else f"{table.one} {name!r}"
            for key, table in TABLES.items()
            for name, entry in table.outer(self)
        ]
        for name, mesh in self.meshes.items():
            causes += [f"{key} of {name!r}" for key in ("supports", "loads") if getattr(mesh, key)]
            causes += [f"viscous damping of {name!r}"] if mesh.damping.viscous else []
        if self.gravity is not None and any(self.gravity.acceleration):
            causes.append("gravity")
        if causes:
            reject(
                f"{text!r}: {', '.join(causes)} changes the momentum",
                "only free frames and no outer force, or 'drift.energy'",
                key=key,
            )

    def _fits_the_sea(self) -> None:
        """What floats, blows and holds fits together."""
        from heavylift.pipeline.case.sea_tables import check_sea

        check_sea(
            self.sea,
            gravity=self.gravity,
            simulate=self.simulate,
            surfaces=self.surfaces,
            hulls=self.hulls,
            databases=self.databases,
            tanks=self.tanks,
            pumps=self.pumps,
            controllers=self.controllers,
            fluid_loads=self.fluid_loads,
            lines=self.lines,
        )

    def _has_axes(self, index: int) -> None:
        """A rotation is seen of what has three axes."""
        for name in self.relative_motions[index].between:
            if name in self.bodies and not self.bodies[name].BODY.HAS_AXES:
                reject(
                    f"{name!r} is a {self.bodies[name].BODY.NOUN}, which has a tangent and no torsion",
                    "bodies with three axes; sensors, and differences of their positions, on a frame",
                    key=f"relative_motions.{index}.between",
                )

    def _reference_fits(self, index: int, reference: ReferenceSection) -> None:
        """A reference file has the columns of its channel, and times that the simulation records."""
        key = f"reference.{index}"
        if self.simulate is None or not self.simulate.duration:
            reject("needs a [simulate] section with a duration", "a history to compare with", key=key)
        try:
            times = read_reference(self.folder / reference.file, reference.components).times
        except InputError as error:
            where = f"{reference.file}: {error.key}: " if error.key else f"{reference.file}: "
            reject(f"{where}{error.problem}", error.expected, key=f"{key}.file")
        step, duration = self.simulate.output_interval, self.simulate.duration
        end, what = duration, "the simulation at"
        if reference.until is not None:
            end, what = reference.until, "but 'until' is"
        if end > duration + 0.5 * step:
            reject(
                f"{end:.9g} s, the simulation ends at {duration:.9g} s",
                "a time within the simulation",
                key=f"{key}.until",
            )
        if abs(times[-1] - end) > 0.5 * step:
            reject(
                f"{reference.file} ends at {times[-1]:.9g} s, {what} {end:.9g} s",
                "a history of the same duration, or 'until' for that of a part",
                key=f"{key}.file",
            )
        odd = next((t for t in times if t != 0.0 and multiple(abs(t), step) is None), None)
        if odd is not None or times[0] < 0.0:
            reject(
                f"{reference.file} has t = {times[0] if odd is None else odd:.9g} s, which is not recorded",
                f"times that are multiples of output_interval = {step:.9g} s",
                key=f"{key}.file",
            )

    def _integrates_contacts(self) -> None:
        """Contacts and collisions need the integrator whose steps know impulses; some laws its step."""
        if self.simulate is None:
            return
        what = "contacts" if self.contacts else "collisions"
        if (self.contacts or self.collisions) and self.simulate.integrator not in {"dele2", "auto"}:
            reject(
                f"{self.simulate.integrator!r} with {what}", "'dele2' or 'auto'", key="simulate.integrator"
            )
        if (self.contacts or self.collisions) and self.begins_at_rest:
            self._rests_with_contacts(what)
        for index, collision in enumerate(self.collisions):
            if collision.law == "thesis" and self.simulate.step is None:
                reject(
                    "'thesis' without a fixed step, on which 'gamma' depends",
                    "'step' in [simulate], or law 'linear'",
                    key=f"collisions.{index}.law",
                )

    def _has_an_operation(self) -> None:
        """Phases end, and act on ropes that are there; only the default integrator meets their events."""
        if self.scenario is None:
            return
        from heavylift.pipeline.case.scenario import key_as_given, scenario_of

        if self.simulate is None:
            reject("needs a [simulate] section", "a simulation that it can run", key="scenario")
        if self.simulate.integrator not in {"dele2", "auto"}:
            reject(
                f"{self.simulate.integrator!r} with a scenario",
                "'dele2' or 'auto'",
                key="simulate.integrator",
            )
        try:
            operation = scenario_of(self.scenario, self._known)
        except InputError as error:
            reject(error.problem, error.expected, key=f"scenario.{error.key}")
        try:
            check_scenario(operation, Movable(**self._movable, duration=self.simulate.duration or math.inf))
        except InputError as error:
            key = key_as_given(self.scenario, self._known, error.key)
            reject(error.problem, error.expected, key=f"scenario.{key}")

    def _has_inputs(self) -> None:
        """Inputs drive what is there, and nothing else drives it."""
        if not self.inputs:
            return
        if self.simulate is None:
            reject("needs a [simulate] section", "a simulation that they can act on", key="inputs")
        fluids = self._names.fluids
        controllers = {one.name: one for one in self.controllers}
        try:
            check_inputs(self.inputs, self.operation, Movable(**self._movable), controllers, fluids)
        except InputError as error:
            reject(error.problem, error.expected, key=error.key)

    def _has_a_run(self, name: str) -> None:
        """Stress over the run needs one."""
        if getattr(self.bodies[name], "stress", None) is not None and self.simulate is None:
            reject(
                "needs a [simulate] section",
                "a run; static load cases have stress without this table",
                key=f"bodies.{name}.stress",
            )

    def _plans_ballast(self) -> None:
        """Stages, tanks and hull of a ballast plan fit together."""
        if self.ballast is not None:
            from heavylift.pipeline.case.ballast import check_plan

            check_plan(self.ballast, self.tanks)

    def _exchanges(self) -> None:
        """FMUs have their places in the run, read channels that are recorded and write inputs that are there."""
        if not self.fmus:
            return
        from heavylift.pipeline.case.fmus import check_fmus

        check_fmus(self.fmus, self.simulate, [one.name for one in self.inputs])
        for index, fmu in enumerate(self.fmus):
            for variable, name in fmu.reads.items():
                key, quantity = f"fmus.{index}.reads.{variable}", f"channel.{name}.end"
                try:
                    self._can_be_computed({key: quantity})
                except InputError as error:
                    problem = error.problem.replace(quantity, name).replace("quantity", "channel")
                    reject(problem, error.expected, key=key)

    @property
    def begins_at_rest(self) -> bool:
        """Whether it comes to rest before time starts."""
        return self.simulate is not None and self.simulate.start in {"equilibrium", "relax"}

    @property
    def operation(self) -> Scenario | None:
        """The scenario for the solver."""
        if self.scenario is None:
            return None
        from heavylift.pipeline.case.scenario import scenario_of

        return scenario_of(self.scenario, self._known)

    @property
    def _movable(self) -> dict[str, Any]:
        """What can be commanded."""
        frames = {name: body.frame for name, body in self.bodies.items() if body.has_frame}
        return {
            "ropes": {rope.name: rope for rope in self.ropes},
            "tanks": frozenset(tank.name for tank in self.tanks),
            "drives": drives_of(self.joints, frames),
            "pumped": {end: pump.name for pump in self.pumps for end in (pump.source, pump.target)},
            "vehicles": {one.name: one for one in self.transporters if one.legs},
            "releases": releases_of(self.joints, (*self.forces, *self.inputs)),
            "helpers": helpers_of(self.pumps, self.controllers, self.transporters),
        }

    @property
    def _known(self) -> "Known":
        """What a scenario can name."""
        from heavylift.pipeline.case.scenario import Known

        movable = self._movable
        ropes = movable["ropes"]
        wire = [name for name, rope in ropes.items() if rope.DESCRIBED.WORD == "wire"]
        others = tuple(name for name in ropes if name not in wire)
        hooks = {one.name: Hook(one.parts, one.block.hook_depth) for one in self.falls}
        tanks = tuple(tank.name for tank in self.tanks)
        together: dict[str, tuple[str, ...]] = {}
        girders: dict[str, tuple[str, float]] = {}
        for crane in self.gantry_cranes:
            parts = [f"{crane.name}_girder"]
            parts += [f"{crane.name}_trolley_{i + 1}" for i in range(len(crane.trolleys))]
            for axis in "yz":
                every = [f"{part}.{axis}" for part in parts]
                together |= {one: tuple(other for other in every if other != one) for one in every}
            together[f"{parts[0]}.x"] = tuple(f"{part}.x" for part in parts[1:])
            girders |= dict.fromkeys(parts[1:], (parts[0], 0.5 * crane.span))
        return Known(
            names=self._names,
            ropes=tuple(wire),
            tanks=tanks,
            drives=tuple(movable["drives"]),
            hooks=hooks,
            other_ropes=others,
            together=together,
            paths=tuple(movable["vehicles"]),
            girders=girders,
            joints=tuple(movable["releases"]),
            helpers={
                **{pump.name: "pump" for pump in self.pumps},
                **{one.name: "levelling" for one in self.transporters if one.levelling is not None},
            },
            controllers={one.name: tuple(one.pumps) for one in self.controllers},
        )

    def _rests_with_contacts(self, what: str) -> None:
        """Contacts of bodies with frames come to rest before time starts, if no surfaces of triangles cross there."""
        assert self.simulate is not None
        meshes = list(self.meshes)
        if meshes:
            reject(
                f"{self.simulate.start!r} with {what} and {meshes[0]!r}, a frame or shell",
                "'check' or 'project': contacts come to rest during the run",
                key="simulate.start",
            )
        soft = next((i for i, collision in enumerate(self.collisions) if collision.law != "rigid"), None)
        if soft is not None:
            reject(
                f"{self.simulate.start!r} with law {self.collisions[soft].law!r}, by which surfaces cross at rest",
                "law 'rigid', or start 'check' or 'project'",
                key=f"collisions.{soft}.law",
            )

    def _missing_for(self, quantity: QuantityName) -> str:
        """What a quantity needs and the case does not have; empty if nothing."""
        if quantity.stage == "simulate" and self.simulate is None:
            return "a [simulate] section"
        if quantity.family in {"mesh", "modes", "ringdown", "static"}:
            from heavylift.pipeline.case.interfaces import holding_joints

            body = self.bodies.get(quantity.owner)
            if body is None:
                return f"a flexible body, and {quantity.owner!r} is no body"
            if not body.BODY.MODAL:
                return f"a flexible body, and {quantity.owner!r} is a {body.BODY.NOUN}"
            if quantity.family == "static":
                asked = quantity.component.partition(".")[0]
                if body.geometry.type == "four_files" and asked in {"stress", "von_mises"}:
                    return _NO_ELEMENTS.format(quantity.owner)
                cases = [one.name for one in body.static]
                known = f"one of the static load cases of {quantity.owner!r}: {', '.join(cases) or 'there are none'}"
                return "" if quantity.item in cases else known
            joined = holding_joints(self.joints, quantity.owner)
            count = None if joined else body.vector_count
            if quantity.component and count is not None and int(quantity.component) > count:
                return f"vector {quantity.component} of {count}"
        if quantity.family == "stress":
            owner = next((one.body for one in self.sensors if one.name == quantity.owner), quantity.owner)
            body = self.bodies[owner]
            if body.BODY.MODAL and body.geometry.type == "four_files":
                return _NO_ELEMENTS.format(owner)
            if quantity.item:
                return body.missing_stress(quantity.owner, quantity.item, quantity.component)
        if quantity.family == "hydrostatics" and self.hulls[quantity.owner].surface is None:
            return f"a hull with a surface, and {quantity.owner!r} has none"
        return ""

    def quantity(self, text: str) -> QuantityName:
        """A quantity string taken apart, with the kind that it has in this case."""
        return parse_quantity_name(text, self._names)

    def place(self, key: str) -> str:
        """Dotted key in the case file of a dotted key of this model: that of the block or builder that wrote it."""
        return self._expansion.locate(self._equipped.locate(key)[0])[0]

    @property
    def meshes(self) -> "dict[str, FrameBodySection | ShellBodySection]":
        """Frames and shells by name."""
        return {name: body for name, body in self.bodies.items() if body.BODY.SHAPE}

    @cached_property
    def collided(self) -> dict[str, tuple[int, tuple[str, str]]]:
        """Collisions by the first part of their channels: number of the table, and names of both surfaces."""
        surfaces = {surface.name: surface.body for surface in self.surfaces}
        yielding = {name for name, body in self.bodies.items() if _yields(body)}
        return {
            name: (index, pair)
            for index, entry in enumerate(self.collisions)
            for name, pair in collision_pairs(
                entry.name, entry.between, entry.among, surfaces, yielding
            ).items()
        }

    @cached_property
    def measured_gaps(self) -> frozenset[str]:
        """Collisions whose gap is named by what judges or shows results: it is measured however far they are apart."""
        if not self.collisions:
            return frozenset()
        shown = self.model_dump(include=ASKING)
        owners = {owner for text in _texts_in(shown) for owner in GAP.findall(text)}
        return frozenset(name for name in self.collided if any(fnmatchcase(name, owner) for owner in owners))

    @property
    def file(self) -> Path:
        """The case file."""
        return self._file

    @property
    def folder(self) -> Path:
        """The case folder."""
        return self._file.parent

    @property
    def name(self) -> str:
        """Name of the case folder, with that of a file other than ``case.toml``.

        Letters that are no UTF-8 are escapes, so that every file can hold it.
        """
        file = self._file.resolve()
        name = file.parent.name if file.name == CASE_FILE else f"{file.parent.name}_{file.stem}"
        return name.encode("utf-8", "backslashreplace").decode()

    @property
    def document(self) -> dict[str, Any]:
        """The case file as it was read, with overrides applied but units not converted."""
        return self._document

    @property
    def overrides(self) -> tuple[str, ...]:
        """The ``key=value`` overrides this case was loaded with."""
        return self._overrides

    @property
    def output_folder(self) -> Path:
        """Where results go unless another folder is chosen: a folder each for case files beside each other."""
        out = self.folder / "out"
        return out if self._file.name == CASE_FILE else out / self._file.stem


def _yields(body: Any) -> bool:
    """Whether a body gives way to a force."""
    return bool(body.is_free or body.BODY.DEFORMS)


def load_case(
    path: Path | str,
    overrides: Sequence[str] = (),
    *,
    further: Callable[[Case], list[InputError]] | None = None,
) -> Case:
    """Read and check a case.

    Parameters
    ----------
    path
        A case folder, or a case file: its ``case.toml``, or one of several with other names.
    overrides
        Changes such as ``"simulate.step=0.1 us"``: dotted key, ``=``, a TOML value or plain text; without a value
        the key is removed.
    further
        What else can be wrong with a case whose tables are right by themselves; asked if they do not fit together, so
        that all errors are reported at once.

    Raises
    ------
    InputError
        If the file is missing or is no TOML.
    InputErrors
        Everything that is wrong with its content, one line each.

    Examples
    --------
    >>> import heavylift as hl
    >>> hl.load_case("cases/hoist", ["ropes.fall.length=101 m"]).ropes[0].length
    101.0
    """
    file = Path(path)
    if file.is_dir():
        file = file / CASE_FILE
    document = read_document(file)
    check_values(document, file)
    document, changed = apply_overrides(document, overrides, Case)
    if overrides:
        check_values(document, file)
    return make_case(document, file, overrides, changed, further=further)


def make_case(
    document: dict[str, Any],
    file: Path,
    overrides: Sequence[str] = (),
    changed: Mapping[str, str] | None = None,
    *,
    further: Callable[[Case], list[InputError]] | None = None,
) -> Case:
    """Check a document that is in memory, as `load_case` checks that of a file.

    Parameters
    ----------
    document
        As read from TOML, with values that `check_values` has found sound; it is not changed.
    file
        The case file that it is, or would be: names of files are relative to its folder, messages name it.
    overrides
        Changes that are made already.
    changed
        Dotted keys that they set, with the text of the override.
    further
        As for `load_case`.

    Raises
    ------
    InputErrors
        Everything that is wrong with it, one line each.
    """
    expansion = expand(document, file)
    placed, unplaced = put_interface_points(with_lug_interfaces(expansion.document), file)
    equipped = equip(placed, file)
    names = declared(equipped.document)
    errors = [*expansion.errors, *unplaced, *equipped.errors, *group_errors(equipped.document, file)]
    more: list[InputError] = []
    try:
        case = Case.model_validate(equipped.document, context=CaseContext(file.parent, names))
    except ValidationError as error:
        errors += input_errors(error, equipped.document, Case, file)
    else:
        case._file = file  # noqa: SLF001
        case._document = document  # noqa: SLF001
        case._expansion = expansion  # noqa: SLF001
        case._equipped = equipped  # noqa: SLF001
        case._names = names  # noqa: SLF001
        case._overrides = tuple(overrides)  # noqa: SLF001
        errors += case._misfits()  # noqa: SLF001
        if errors and further is not None and not equipped.errors:
            more = further(case)
    # errors of a block, a parameter or a builder are reported alone: others would follow from them
    errors = [*expansion.errors, *(e for e in errors if _in_block(e.key))] or errors
    errors = [e for e in errors if _in_builder(e.key)] or errors
    if errors:
        raise InputErrors([*expansion.told(equipped.told(errors), changed or {}), *more])
    return case


def _in_builder(key: str) -> bool:
    """Whether a key is that of the table of a builder of equipment."""
    return key.partition(".")[0] in BUILDERS


def _in_block(key: str) -> bool:
    """Whether a key is that of the parameters, or of a block itself."""
    return key.partition(".")[0] in {"parameters", "repeat"}


LARGEST_FILE = 64 * 2**20
"""Bytes of a case file; histories and meshes are files of their own."""
DEEPEST = 60
"""Tables and lists within each other."""
LARGEST_INTEGER = 2**63 - 1
"""What TOML asks of those who read it; a larger number is written with a point or an exponent."""


def _check_file(file: Path) -> None:
    """See that it is a file, and one that a person may have written."""
    if file.exists() and not file.is_file():
        raise InputError(
            "is a folder" if file.is_dir() else "is no regular file",
            source=file,
            expected=f"a readable {CASE_FILE}",
        )
    size = file.stat().st_size
    if size > LARGEST_FILE:
        raise InputError(
            f"has {size:,} bytes",
            source=file,
            expected=f"at most {LARGEST_FILE:,}; histories and meshes in files of their own",
        )


def read_document(file: Path) -> dict[str, Any]:
    """Read a TOML file; a syntax error is one line with its place."""
    try:
        _check_file(file)
        return tomllib.loads(file.read_bytes().decode("utf-8"))
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(
            "does not exist",
            source=file,
            expected=f"a case folder with a {CASE_FILE}; `heavylift new` writes an example",
        ) from None
    except OSError as error:
        raise InputError(str(error.strerror), source=file, expected=f"a readable {CASE_FILE}") from None
    except UnicodeDecodeError as error:
        raise InputError(f"byte {error.start} is not UTF-8", source=file, expected="text in UTF-8") from None
    except RecursionError:
        raise InputError(
            "is nested too deeply", source=file, expected=f"at most {DEEPEST} tables within each other"
        ) from None
    except ValueError as error:  # no TOML, an integer of thousands of digits, a NUL in the name
        raise InputError(str(error), source=file, expected="TOML") from None


def check_values(document: dict[str, Any], file: Path) -> None:
    """See that a document has values that numbers of the machine hold, and a depth that can be walked.

    Raises
    ------
    InputErrors
        One for each integer beyond 64 bits; the first key that is too deep.
    """
    errors: list[InputError] = []
    waiting: list[tuple[Any, tuple[str, ...]]] = [(document, ())]
    while waiting:
        node, keys = waiting.pop()
        if isinstance(node, (dict, list)):
            if len(keys) >= DEEPEST:
                raise InputError(
                    "is nested too deeply",
                    source=file,
                    key=".".join(keys),
                    expected=f"at most {DEEPEST} tables within each other",
                )
            pairs = node.items() if isinstance(node, dict) else enumerate(node)
            waiting += [(value, (*keys, str(key))) for key, value in pairs]
        elif isinstance(node, int) and abs(node) > LARGEST_INTEGER:
            errors.append(
                InputError(
                    f"an integer of {node.bit_length()} bits",
                    source=file,
                    key=".".join(keys),
                    expected="at most 64 bits; a larger number with a point or an exponent",
                )
            )
    if errors:
        raise InputErrors(errors[::-1])


def _texts_in(node: Any) -> Iterator[str]:
    """All texts in tables and lists."""
    if isinstance(node, str):
        yield node
        return
    below = node.values() if isinstance(node, Mapping) else node if isinstance(node, (list, tuple)) else ()
    for entry in below:
        yield from _texts_in(entry)
