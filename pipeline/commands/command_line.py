"""What the commands share: their options, and how they end: one message and an exit code for all a user can cause."""

# cyclopts evaluates the annotations of the commands, so the imports below are needed at run time.

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from heavylift.numerics.outcome import InputError, InputErrors, Outcome
from heavylift.numerics.processors import processors
from heavylift.pipeline.log import say_on

if TYPE_CHECKING:
    from collections.abc import Callable

    from heavylift.pipeline.log import Log

__all__ = [
    "Animate",
    "At",
    "CaseArgument",
    "CasesArgument",
    "Count",
    "Drawn",
    "Export",
    "Force",
    "Inputs",
    "Json",
    "KindNames",
    "NewFolder",
    "NewKind",
    "Out",
    "Outputs",
    "Quiet",
    "SendCommand",
    "Set",
    "complain",
    "guarded",
    "print_json",
    "print_lines",
]

CaseArgument = Annotated[Path, Parameter(help="Case folder, or its case.toml.", show_default=False)]
CasesArgument = Annotated[tuple[Path, ...], Parameter(help="Case folders.", show_default=False)]
Out = Annotated[
    Path | None,
    Parameter(name="--out", help="Folder for the outputs instead of CASE/out.", show_default=False),
]
Set = Annotated[
    tuple[str, ...],
    Parameter(
        name="--set",
        help='Change one key of the case, e.g. simulate.step="0.1 us" or ropes.hoist.length="12 m" (of a list by name '
        "or index); simulate.step= removes it; may be repeated.",
        show_default=False,
        negative="",
    ),
]
Animate = Annotated[
    bool,
    Parameter(
        name="--animate",
        help="Make the animation of the scene, even if the case has no [report.animation].",
        negative="",
    ),
]
Export = Annotated[
    Path | None,
    Parameter(
        name="--export",
        help="Folder for the reduced bodies in formats of other programs: netCDF, SID_FEM, four files.",
        show_default=False,
    ),
]
Force = Annotated[bool, Parameter(name="--force", help="Run even if the inputs are unchanged.", negative="")]
KindNames = Annotated[str, Parameter(help="Component types and loops; all by default.", show_default=False)]
NewKind = Annotated[
    str, Parameter(help="Type of the case; without it the types are listed.", show_default=False)
]
NewFolder = Annotated[
    Path | None,
    Parameter(help="Folder to write to, new or empty; by default the name of the type.", show_default=False),
]
SendCommand = Annotated[
    Literal["continue", "hold", "stop"] | None,
    Parameter(
        name=("--send", "--tell"),
        help="Send this operator command to the run that works in the output folder.",
        show_default=False,
    ),
]
At = Annotated[
    str,
    Parameter(
        name="--at",
        help="'start' of the run; 'rest', where the scene is in static equilibrium; or a time of the run [s].",
    ),
]
Count = Annotated[
    int | None,
    Parameter(name="--count", help="Modes in the table, slowest first; default: all.", show_default=False),
]
Drawn = Annotated[
    tuple[int, ...],
    Parameter(
        name="--draw",
        help="Number of a mode to draw as a page; may be repeated.",
        show_default=False,
        negative="",
    ),
]
Inputs = Annotated[
    tuple[str, ...],
    Parameter(
        name="--input",
        help="An input of B and D; may be repeated; default: all.",
        show_default=False,
        negative="",
    ),
]
Outputs = Annotated[
    tuple[str, ...],
    Parameter(
        name="--output",
        help="An output of C and D, e.g. sling_1.tension or module.position.z; may be repeated; default: none.",
        show_default=False,
        negative="",
    ),
]
Quiet = Annotated[bool, Parameter(name="--quiet", help="Print errors only.", negative="")]
Json = Annotated[
    bool, Parameter(name="--json", help="Print one JSON document on standard output.", negative="")
]


def guarded(command: "Callable[[Log], int]", *, quiet: bool, json: bool) -> int:
    """Run a command; whatever a user can cause ends as one message and an exit code."""
    from heavylift.pipeline.commands.endings import interruption, out_of_memory
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.storage import FULL, StopError

    try:
        processors()  # a wrong number of them is wrong whatever there is to do
        return command(Log(quiet=quiet, stream=sys.stderr if json else None))
    except InputError as error:
        message, outcome = str(error), Outcome.BAD_INPUT
        parts = error.errors if isinstance(error, InputErrors) else [error]
        details = [
            {"source": part.source, "key": part.key, "problem": part.problem, "expected": part.expected}
            for part in parts
        ]
    except StopError as error:
        message, outcome, details = str(error), error.outcome, []
    except KeyboardInterrupt as error:
        message, outcome, details = interruption(error), Outcome.INTERRUPTED, []
    except MemoryError as error:
        message, outcome, details = out_of_memory(error), Outcome.OUT_OF_MEMORY, []
    except RuntimeError as error:
        if type(error).__name__ != "CompileError":  # known only once kernels are imported
            raise
        message, outcome, details = f"cannot compile: {error}", Outcome.BAD_INPUT, []
    except OSError as error:
        full = error.errno in FULL
        if error.filename is None and not full:
            raise
        where = error.filename or ("standard output, or a file" if full else "")
        message = ": ".join(str(part) for part in (where, error.strerror) if part)
        outcome, details = Outcome.DISK_FULL if full else Outcome.BAD_INPUT, []
    complain(message)
    if json:
        print_json({"error": message, "outcome": outcome.name.lower(), "details": details})
    return int(outcome)


def complain(message: str) -> None:
    """Print a line on standard error."""
    say_on(sys.stderr, message)


def print_lines(lines: list[str]) -> None:
    """Print a table on standard output."""
    say_on(sys.stdout, "\n".join(lines), needed=True)


def print_json(document: Any) -> None:
    """Print a document on standard output."""
    import json

    # of what a terminal obeys JSON leaves a single letter as it is
    text = json.dumps(_finite(document), indent=2, default=str).replace("\x7f", "\\u007f")
    say_on(sys.stdout, text, needed=True)


def _finite(value: Any) -> Any:
    """The document with numbers that JSON does not know (nan, infinity) as null."""
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(entry) for entry in value]
    if isinstance(value, float) and value - value != 0.0:
        return None
    return value
