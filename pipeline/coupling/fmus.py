"""The FMUs of a case: checked against what it says of them."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.places import located
from heavylift.pipeline.coupling.fmu_file import REALS, WHOLE, read_fmu

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.fmus import FmuSection
    from heavylift.pipeline.coupling.fmu_file import FmuFile, FmuVariable

__all__ = ["check_fmu", "read_fmus"]

SHOWN = 20
"""Names of a list in a message at most."""


def _found(fmu: FmuFile, name: str, causalities: Collection[str], key: str) -> FmuVariable:
    """A variable by its name, of one of some causalities."""
    fitting = [one.name for one in fmu.variables.values() if one.causality in causalities]
    words = " or ".join(sorted(causalities))
    shown = f"one of: {', '.join(fitting[:SHOWN])}" if fitting else f"nothing, since it has no {words}"
    more = f" and {len(fitting) - SHOWN} more" if len(fitting) > SHOWN else ""
    if name not in fmu.variables:
        near = get_close_matches(name, fitting, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise InputError(f"{fmu.title} has no variable {name!r}{hint}", key=key, expected=shown + more)
    found = fmu.variables[name]
    if found.causality not in causalities:
        raise InputError(
            f"{name!r} is of causality {found.causality}", key=key, expected=f"{words}: {shown}{more}"
        )
    if not found.scalar:
        raise InputError(f"{name!r} is an array", key=key, expected="a variable that is one number")
    return found


def _check_real(variable: FmuVariable, key: str) -> None:
    if variable.type not in REALS:
        raise InputError(
            f"{variable.name!r} is of type {variable.type}", key=key, expected=" or ".join(REALS)
        )


def _check_parameter(variable: FmuVariable, value: Any, key: str) -> None:
    """See that a value has the type of its parameter."""
    kind = variable.type
    if kind in REALS:
        fits, words = isinstance(value, (int, float)) and not isinstance(value, bool), "a number"
    elif kind in WHOLE:
        fits, words = isinstance(value, int) and not isinstance(value, bool), "an integer"
    elif kind == "Boolean":
        fits, words = isinstance(value, bool), "true or false"
    elif kind == "String":
        fits, words = isinstance(value, str), "a text"
    else:
        raise InputError(
            f"{variable.name!r} is of type {kind}", key=key, expected="a number, a truth value or a text"
        )
    if not fits:
        raise InputError(f"{value!r} for {variable.name!r} of type {kind}", key=key, expected=words)


def check_fmu(section: FmuSection, folder: Path) -> FmuFile:
    """Read the FMU of a case and compare it with what the case says of it; nothing of it runs.

    Parameters
    ----------
    section
        An entry of ``[[fmus]]``.
    folder
        Of the case.

    Raises
    ------
    InputError
        With the key of the entry that does not fit.
    """
    if section.file.endswith(".xml") and (folder / section.file).resolve().parent == folder.resolve():
        raise InputError(
            f"{section.file!r} stands in the folder of the case",
            key="file",
            expected="a folder of its own for an FMU",
        )
    try:
        fmu = read_fmu(folder / section.file)
    except InputError as error:
        where = f"{section.file}: {error.key}: " if error.key else f"{section.file}: "
        raise InputError(f"{where}{error.problem}", key="file", expected=error.expected) from None
    for name in section.reads:
        _check_real(_found(fmu, name, {"input"}, f"reads.{name}"), f"reads.{name}")
    for name in section.writes:
        _check_real(_found(fmu, name, {"output"}, f"writes.{name}"), f"writes.{name}")
    for name, value in section.parameters.items():
        _check_parameter(_found(fmu, name, {"parameter"}, f"parameters.{name}"), value, f"parameters.{name}")
    if section.coupling == "iterated" and not fmu.gets_state:
        raise InputError(
            f"'iterated' with {section.file}, which cannot get and set its state",
            key="coupling",
            expected="'sequential', or an FMU with canGetAndSetFMUState",
        )
    count = section.sample_time / fmu.fixed_step if fmu.fixed_step else 1.0
    if count < 0.5 or abs(count - round(count)) > 1e-6 * count:
        raise InputError(
            f"{section.sample_time:g} s is {count:.9g} times the fixed step of {section.file}",
            key="sample_time",
            expected=f"a multiple of {fmu.fixed_step:g} s",
        )
    return fmu


def read_fmus(case: Case) -> list[tuple[FmuSection, FmuFile]]:
    """The FMUs of a case with their files.

    Raises
    ------
    InputError
        With the place in the case file of what does not fit.
    """
    found = []
    for index, section in enumerate(case.fmus):
        with located(case, f"fmus.{index}"):
            found.append((section, check_fmu(section, case.folder)))
    return found
