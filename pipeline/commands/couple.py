"""The command ``couple``: scenes that run apart and exchange forces and positions."""

# cyclopts evaluates the annotations of the commands, so the imports below are needed at run time.

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from heavylift.pipeline.commands.command_line import (
    Json,
    Out,
    Quiet,
    complain,
    guarded,
    print_json,
    print_lines,
)

if TYPE_CHECKING:
    from heavylift.pipeline.log import Log

__all__ = ["COUPLE_COMMANDS"]

CouplingArgument = Annotated[
    Path, Parameter(help="Folder with a coupling.toml, or that file.", show_default=False)
]
MethodOption = Annotated[
    Literal["held", "sequential", "extrapolated", "iterated"] | None,
    Parameter(name="--method", help="In place of the method of the file.", show_default=False),
]
Interval = Annotated[
    str | None,
    Parameter(
        name="--interval",
        help='Time between exchanges in place of that of the file: "5 ms".',
        show_default=False,
    ),
]


def couple(
    coupling: CouplingArgument,
    *,
    method: MethodOption = None,
    interval: Interval = None,
    out: Out = None,
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Run scenes side by side that exchange forces and positions, each a case or a process of its own.

    Exit code: 0, or 1 if a check of a scene failed, 2 for bad input or an exchange that is not stable, another one if a
    scene stopped by itself.
    """

    def command(log: "Log") -> int:
        from heavylift.numerics.outcome import Outcome
        from heavylift.pipeline.checks.judge import judge
        from heavylift.pipeline.commands.verify import check_table, exit_code, judged_verdict
        from heavylift.pipeline.coupled.coupling_file import load_coupling
        from heavylift.pipeline.coupled.run import coupled_document, run_coupled
        from heavylift.pipeline.stages.stages import load_changed_case

        given = {"method": method, "interval": interval}
        made = load_coupling(coupling, {key: value for key, value in given.items() if value is not None})
        report = run_coupled(made, out or made.folder / "out", log)
        verdicts = []
        if report.outcome is Outcome.COMPLETED:
            for name, section in made.scenes.items():
                if name not in report.folders:
                    log.say(f"couple: {name}: its results are with its server, and not judged here")
                    continue
                case = load_changed_case(made.folder / section.case, section.set)
                if case.check or case.criteria:
                    found = judge(case, report.folders[name], log=log)
                    verdicts.append(judged_verdict(name, case, found, report.cpu_s[name]))
        if json:
            print_json(coupled_document(made, report) | {"cases": [one.row() for one in verdicts]})
        else:
            for verdict in verdicts:
                print_lines(check_table(verdict))
        if report.outcome is not Outcome.COMPLETED:
            complain(f"couple: {report.message}")
            return int(report.outcome)
        return exit_code(verdicts)

    return guarded(command, quiet=quiet, json=json)


COUPLE_COMMANDS = (couple,)
