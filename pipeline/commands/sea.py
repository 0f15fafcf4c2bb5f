"""The commands of what floats; each imports what it runs."""

# cyclopts evaluates the annotations of the commands, so the imports below are needed at run time.

import math
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from heavylift.pipeline.commands.command_line import (
    CaseArgument,
    Json,
    Out,
    Quiet,
    Set,
    guarded,
    print_json,
    print_lines,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from heavylift.pipeline.log import Log

__all__ = ["SEA_COMMANDS"]

Hulls = Annotated[
    tuple[str, ...],
    Parameter(name="--hull", help="Only this hull; may be repeated.", show_default=False, negative=""),
]
Headings = Annotated[
    tuple[float, ...],
    Parameter(
        name="--heading",
        help="Direction [deg] in which waves travel, relative to the first hull, anticlockwise; may be repeated.",
        show_default=False,
        negative="",
    ),
]
Channels = Annotated[
    tuple[str, ...],
    Parameter(
        name="--channels",
        help="E.g. barge.position.z, barge.roll, bow_*.tension or sum(bow_*.tension); several after each other. By"
        " default motions of hulls and tensions of lines.",
        show_default=False,
        negative="",
        consume_multiple=True,
    ),
]
Seeds = Annotated[
    int | None,
    Parameter(
        name="--seeds",
        help="Simulate so many times, with seeds that count up from those of the case; fit Gumbel's distribution.",
        show_default=False,
    ),
]
After = Annotated[
    float | None,
    Parameter(
        name="--after",
        help="Leave out records before this time [s]; default: the ramp of the sea.",
        show_default=False,
    ),
]
Lines = Annotated[
    tuple[str, ...],
    Parameter(name="--line", help="Only this line; may be repeated.", show_default=False, negative=""),
]


def hydrostatics(
    case: CaseArgument,
    *,
    hull: Hulls = (),
    out: Out = None,
    set_: Set = (),
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """How hulls float with their tanks, and their righting arms."""

    def command(log: "Log") -> tuple[dict[str, Any], list[str]]:
        from heavylift.pipeline.commands.hydrostatics import hydrostatics_command

        return hydrostatics_command(case, out=out, overrides=set_, hulls=hull, log=log)

    return _answered(command, quiet=quiet, json=json)


def ballast(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Fillings of tanks that pump least for the stages of [ballast], with drafts, stability and the hull girder."""

    def command(log: "Log") -> tuple[dict[str, Any], list[str]]:
        from heavylift.pipeline.commands.ballast import ballast_command

        return ballast_command(case, out=out, overrides=set_, log=log)

    return _answered(command, quiet=quiet, json=json)


def database(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Added mass, damping and excitation of hulls, as pictures."""

    def command(log: "Log") -> tuple[dict[str, Any], list[str]]:
        from heavylift.pipeline.commands.database import database_command

        return database_command(case, out=out, overrides=set_, log=log)

    return _answered(command, quiet=quiet, json=json)


def rao(
    case: CaseArgument,
    *,
    heading: Headings = (),
    out: Out = None,
    set_: Set = (),
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Response operators and natural periods of moored hulls, in the frequency domain."""

    def command(log: "Log") -> tuple[dict[str, Any], list[str]]:
        from heavylift.pipeline.commands.response_operators import rao_command

        headings = [math.radians(angle) for angle in heading]
        return rao_command(case, out=out, overrides=set_, headings=headings, log=log)

    return _answered(command, quiet=quiet, json=json)


def lines(
    case: CaseArgument,
    *,
    line: Lines = (),
    at: Annotated[
        float | None,
        Parameter(help="Time [s] of a finished run; default: the start of the case.", show_default=False),
    ] = None,
    moordyn: Annotated[
        bool,
        Parameter(
            help="Dynamic tension by MoorDyn along the motion of a finished run (extra: heavylift[moordyn]).",
            negative="",
        ),
    ] = False,
    after: Annotated[
        float | None,
        Parameter(
            help="Begin of that part of the run [s]; default: the ramp of the sea.", show_default=False
        ),
    ] = None,
    until: Annotated[
        float | None, Parameter(help="Its end [s]; default: the end of the run.", show_default=False)
    ] = None,
    material: Annotated[
        float, Parameter(help="Density [kg/m3] of the lines: gives MoorDyn their mass in air.")
    ] = 7850.0,
    out: Out = None,
    set_: Set = (),
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Side views and tensions of mooring lines."""

    def command(log: "Log") -> tuple[dict[str, Any], list[str]]:
        from heavylift.pipeline.commands.lines import lines_command

        return lines_command(
            case,
            out=out,
            overrides=set_,
            lines=line,
            at=at,
            dynamic=moordyn,
            after=after,
            until=until,
            material=material,
            log=log,
        )

    return _answered(command, quiet=quiet, json=json)


def statistics(
    case: CaseArgument,
    *,
    channels: Channels = (),
    seeds: Seeds = None,
    after: After = None,
    out: Out = None,
    set_: Set = (),
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Mean, significant values, spectra and extremes of channels of a finished run, or over seeds."""

    def command(log: "Log") -> tuple[dict[str, Any], list[str]]:
        from heavylift.pipeline.commands.statistics import statistics_command

        return statistics_command(
            case, out=out, overrides=set_, channels=channels, seeds=seeds, after=after, log=log
        )

    return _answered(command, quiet=quiet, json=json)


def _answered(
    command: "Callable[[Log], tuple[dict[str, Any], list[str]]]", *, quiet: bool, json: bool
) -> int:
    """Run a command, and print its document or its tables."""

    def run(log: "Log") -> int:
        document, words = command(log)
        if json:
            print_json(document)
        elif not quiet:
            print_lines(words)
        return 0

    return guarded(run, quiet=quiet, json=json)


SEA_COMMANDS = (hydrostatics, ballast, database, rao, lines, statistics)
"""In the order in which they are listed."""
