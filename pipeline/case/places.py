"""Places in a case file of the components that the solver names, or that are being assembled."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline.case.simulate import SimulateSection
from heavylift.pipeline.case.tables import TABLES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from heavylift.pipeline.case.case_file import Case

__all__ = ["in_case", "located", "places"]


def places(case: Case) -> dict[str, str]:
    """Dotted keys in the case file of what has a name: bodies, contours, joints, surfaces, collisions and so on."""
    found: dict[str, str] = {}
    for table in sorted(TABLES.values(), key=lambda table: table.names == "apart"):
        for key, name, _ in table.entries(case) if table.names != "bodies" else ():
            found.setdefault(name, case.place(key))
    for kind in ("wind", "current"):
        rows = () if case.sea is None else getattr(case.sea, kind)
        for index, row in enumerate(rows):
            found[row.name] = f"sea.{kind}" if len(rows) == 1 else f"sea.{kind}.{index}"
    for name, (index, _) in case.collided.items():
        found[name] = case.place(f"collisions.{index}")
    return found


@contextlib.contextmanager
def in_case(case: Case) -> Iterator[None]:
    """Put the case file, and the place of what is named, into errors that know only names of the scene."""
    try:
        yield
    except InputError as error:
        if str(case.folder) in error.source:
            raise
        known = places(case)
        parts = error.errors if isinstance(error, InputErrors) else [error]
        placed = [_placed(part, known, case) for part in parts]
        raise placed[0] if len(placed) == 1 else InputErrors(placed) from None


def _placed(error: InputError, known: dict[str, str], case: Case) -> InputError:
    """The error at a dotted key of the case file."""
    problem = error.problem
    if error.source in known:
        key = f"{known[error.source]}.{error.key}".removesuffix(".")
    elif error.key in known:
        key = known[error.key]
    elif error.source == "simulation" and error.key in SimulateSection.model_fields:
        key = f"simulate.{error.key}"
    else:
        key = "simulate" if error.source == "simulation" else error.source
        problem = f"{error.key}: {problem}" if error.key else problem
    return InputError(problem, source=case.file, key=key, expected=error.expected)


@contextlib.contextmanager
def located(case: Case, key: str) -> Iterator[None]:
    """Name the place in the case file in errors that know it not."""
    try:
        yield
    except InputError as error:
        if error.source and str(case.folder) in str(error.source):
            raise
        place = case.place(f"{key}.{error.key}".removesuffix("."))
        raise InputError(error.problem, source=case.file, key=place, expected=error.expected) from None
