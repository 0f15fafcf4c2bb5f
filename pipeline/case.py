"""A case: one folder with a case.toml that describes an operation, its checks and its sources."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import tomllib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PrivateAttr, ValidationError, model_validator

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline.case_bodies import Body
from heavylift.pipeline.case_errors import group_errors, input_errors
from heavylift.pipeline.case_overrides import apply_overrides
from heavylift.pipeline.case_sections import (
    CheckSection,
    ConvergeSection,
    GravitySection,
    PointForceSection,
    QuantityReference,
    ReportSection,
    SensorSection,
    SimulateSection,
)
from heavylift.pipeline.fields import CaseContext, Section, UniqueName, reject
from heavylift.pipeline.quantity_names import QuantityName, parse_quantity_name

__all__ = ["CASE_FILE", "Case", "load_case"]

CASE_FILE = "case.toml"


class Case(Section):
    """The content of a case file in SI units; made by `load_case`."""

    title: str
    """One line that says what is simulated."""
    sources: tuple[str, ...] = ()
    """Where the numbers come from."""
    bodies: Annotated[dict[UniqueName, Body], Field(min_length=1)]
    """Bodies by name."""
    gravity: GravitySection | None = None
    """Uniform gravity; none if absent."""
    forces: tuple[PointForceSection, ...] = ()
    """Applied forces."""
    sensors: tuple[SensorSection, ...] = ()
    """Material points whose motion is recorded."""
    simulate: SimulateSection | None = None
    """Time integration; a case without it ends with its modes."""
    report: ReportSection = Field(default_factory=ReportSection)
    """Pictures and plots."""
    converge: ConvergeSection | None = None
    """Convergence study."""
    check: tuple[CheckSection, ...] = ()
    """Reference values."""

    _file: Path = PrivateAttr(default=Path(CASE_FILE))
    _document: dict[str, Any] = PrivateAttr(default_factory=dict)
    _overrides: tuple[str, ...] = PrivateAttr(default=())

    @model_validator(mode="after")
    def _checks_can_be_computed(self) -> "Case":
        """Modes and coordinates that checks name must exist, and a simulation if they need one."""
        for index, check in enumerate(self.check):
            texts = {f"check.{index}.quantity": check.quantity}
            if isinstance(check.reference, QuantityReference):
                texts[f"check.{index}.reference.quantity"] = check.reference.quantity
            for key, text in texts.items():
                quantity = parse_quantity_name(text)
                problem = self._missing_for(quantity)
                if problem:
                    reject(f"{text!r} needs {problem}", "a quantity that the case has", key=key)
                if quantity.family == "drift" and quantity.item in {"momentum", "angular_momentum"}:
                    self._conserves_momentum(text, key)
        return self

    def _conserves_momentum(self, text: str, key: str) -> None:
        """The drift of a momentum is an error of the integration only if nothing outside acts on the scene."""
        held = [name for name, body in self.bodies.items() if body.frame.motion != "free"]
        causes = [f"the {self.bodies[name].frame.motion} frame of {name!r}" for name in held]
        causes += [f"force {force.name!r}" for force in self.forces]
        if self.gravity is not None and any(self.gravity.acceleration):
            causes.append("gravity")
        if causes:
            reject(
                f"{text!r}: {', '.join(causes)} changes the momentum",
                "only free frames and no outer force, or 'drift.energy'",
                key=key,
            )

    def _missing_for(self, quantity: QuantityName) -> str:
        """What a quantity needs and the case does not have; empty if nothing."""
        if quantity.stage == "simulate" and self.simulate is None:
            return "a [simulate] section"
        if quantity.family in {"mesh", "modes", "ringdown"}:
            body = self.bodies[quantity.owner]
            if body.type != "flexible":
                return f"a flexible body, and {quantity.owner!r} is rigid"
            count = body.modes.vector_count
            if quantity.component and count is not None and int(quantity.component) > count:
                return f"vector {quantity.component} of {count}"
        return ""

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
        """Name of the case folder."""
        return self._file.resolve().parent.name

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
        """Where results go unless another folder is chosen."""
        return self.folder / "out"


def load_case(path: Path | str, overrides: Sequence[str] = ()) -> Case:
    """Read and check a case.

    Parameters
    ----------
    path
        A case folder, or its ``case.toml``.
    overrides
        Changes such as ``"simulate.step=0.1 us"``: dotted key, ``=``, a TOML value or plain text.

    Raises
    ------
    InputError
        If the file is missing or is no TOML.
    InputErrors
        Everything that is wrong with its content, one line each.
    """
    file = Path(path)
    if file.is_dir():
        file = file / CASE_FILE
    document = read_document(file)
    document, changed = apply_overrides(document, overrides, Case)
    errors = group_errors(document, file)
    try:
        case = Case.model_validate(document, context=_context(document, file.parent))
    except ValidationError as error:
        errors = input_errors(error, document, Case, file, changed) + errors
    if errors:
        raise InputErrors(errors)
    case._file = file  # noqa: SLF001
    case._document = document  # noqa: SLF001
    case._overrides = tuple(overrides)  # noqa: SLF001
    return case


def read_document(file: Path) -> dict[str, Any]:
    """Read a TOML file; a syntax error is one line with its place."""
    try:
        return tomllib.loads(file.read_bytes().decode("utf-8"))
    except FileNotFoundError:
        raise InputError(
            "does not exist", source=file, expected=f"a case folder with a {CASE_FILE}"
        ) from None
    except (IsADirectoryError, NotADirectoryError, PermissionError) as error:
        raise InputError(str(error.strerror), source=file, expected=f"a readable {CASE_FILE}") from None
    except UnicodeDecodeError as error:
        raise InputError(f"byte {error.start} is no UTF-8", source=file, expected="text in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(str(error), source=file, expected="TOML") from None


def _context(document: dict[str, Any], folder: Path) -> CaseContext:
    """Names that a document declares, whatever else may be wrong with it."""

    def listed(key: str, name: str) -> list[str]:
        rows = document.get(key, [])
        found = [row.get(name) for row in rows if isinstance(row, dict)] if isinstance(rows, list) else []
        return [value for value in found if isinstance(value, str)]

    bodies = document.get("bodies", {})
    bodies = list(bodies) if isinstance(bodies, dict) else []
    return CaseContext(
        folder=folder,
        names=Counter([*bodies, *listed("sensors", "name"), *listed("forces", "name")]),
        bodies=frozenset(bodies),
        check_ids=Counter(listed("check", "id")),
    )
