"""The command ``fmu``: a case as a functional mock-up unit for co-simulation."""

# cyclopts evaluates the annotations of the commands, so the imports below are needed at run time.

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from heavylift.pipeline.commands.command_line import CaseArgument, Quiet, Set, guarded

if TYPE_CHECKING:
    from heavylift.pipeline.log import Log

__all__ = ["FMU_COMMANDS"]

Version = Annotated[Literal["2", "3"], Parameter(name="--fmi", help="Version of the standard: 2 or 3.")]
Unit = Annotated[
    Path | None,
    Parameter(name="--out", help="The file; by default CASE.fmu in the current folder.", show_default=False),
]


def fmu(
    case: CaseArgument,
    *,
    fmi: Version = "3",
    out: Unit = None,
    set_: Set = (),
    quiet: Quiet = False,
) -> int:
    """Write a case as an FMU for co-simulation, which other programs step and connect.

    Exit code: 0, or 2 for bad input.
    """

    def command(log: "Log") -> int:
        from heavylift.pipeline.exchange.fmu_export import export_fmu

        file = export_fmu(case, 2 if fmi == "2" else 3, out=out, overrides=set_)
        log.say(f"fmu: {file}: {file.stat().st_size / 1e3:.0f} kB, FMI {fmi}, co-simulation")
        return 0

    return guarded(command, quiet=quiet, json=False)


FMU_COMMANDS = (fmu,)
