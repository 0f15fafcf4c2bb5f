"""Reference histories: the table of a case file that names one, and the file that holds it."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from pydantic import Field, ValidationInfo, WithJsonSchema, field_validator

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.channel_kinds import channel_components
from heavylift.pipeline.case.columns import finite_rows, read_lines
from heavylift.pipeline.case.fields import (
    CaseContext,
    InFolder,
    Positive,
    Quantity,
    RecordedChannel,
    ReferenceName,
    Section,
    quantity_schema,
    reject,
)
from heavylift.pipeline.case.quantity_names import channel_kind

__all__ = ["ReferenceHistory", "ReferenceSection", "read_reference"]


class ReferenceSection(Section):
    """A recorded history to compare a channel with: quantities ``deviation.NAME``, ``deviation.NAME.rms``."""

    name: ReferenceName
    """Its name."""
    channel: RecordedChannel
    """The channel it is of, e.g. ``"tip.position"``."""
    file: Annotated[str, InFolder()]
    """Its file in the case folder, SI: comma-separated with the header ``time`` and names of components, as in
    ``time,x,y,z``; components that it does not have are not compared."""
    scale: (
        Annotated[float, WithJsonSchema(quantity_schema(exclusiveMinimum=0.0), mode="validation")] | None
    ) = None
    """Divides the distance, which then is a pure number; in the unit of the channel."""
    until: Annotated[float, Positive("time")] | None = None
    """Time [s] at which the history ends, if the simulation continues; both end together if absent."""
    changes: Annotated[bool, Field(strict=True)] = False
    """Compare what has changed since the first time of the file, not the values themselves."""

    @field_validator("channel")
    @classmethod
    def _is_of_one_point(cls, name: str, info: ValidationInfo) -> str:
        context = CaseContext.of(info)
        if context and name.partition(".")[0] in context.names.meshes:
            reject(f"{name!r} has columns for every node or element", "the position of a sensor on the body")
        return name

    @field_validator("scale", mode="before")
    @classmethod
    def _has_the_unit_of_the_channel(cls, value: Any, info: ValidationInfo) -> Any:
        channel = info.data.get("channel")
        if channel is None or value is None:
            return None
        context = CaseContext.of(info)
        kind = channel_kind(channel, channel, None if context is None else context.names)
        return Quantity(kind.name, minimum=0.0).parse(value)

    @property
    def components(self) -> tuple[str, ...] | None:
        """Components the channel may have; None if only the scene tells, or the terms of a combination."""
        if "(" in self.channel:
            return None
        given = channel_components(self.channel.rpartition(".")[2])
        return ("value", *given) if given is not None and len(given) == 1 else given


class ReferenceHistory(NamedTuple):
    """Content of a reference file.

    Attributes
    ----------
    times
        [s], increasing.
    columns
        Values by component, one a time.
    """

    times: tuple[float, ...]
    columns: dict[str, tuple[float, ...]]


def read_reference(file: Path, components: tuple[str, ...] | None) -> ReferenceHistory:
    """Read a reference file; lines that begin with ``#`` are comments.

    Parameters
    ----------
    file
        Comma-separated, with a header.
    components
        Names that columns may have besides ``time``; any if None.

    Raises
    ------
    InputError
        If the header has another form, a row is not one finite number a column, or times do not increase.
    """
    header, lines = read_lines(file)
    known = "time," + ",".join(components or ("1", "2", "..."))
    named = len(header) >= 2 and header[0] == "time" and len(set(header)) == len(header)
    if not named or (components is not None and not {*header[1:]} <= {*components}):
        raise InputError(
            f"header {','.join(header)!r}", source=file, expected=f"{known} (some of these, time first)"
        )
    rows = [row for _, row in finite_rows(lines, len(header), file)]
    if len(rows) < 2 or any(b[0] <= a[0] for a, b in pairwise(rows)):
        raise InputError("times that do not increase", source=file, expected="two or more increasing times")
    columns = list(zip(*rows, strict=True))
    return ReferenceHistory(columns[0], dict(zip(header[1:], columns[1:], strict=True)))
