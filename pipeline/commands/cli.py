"""The command line: staged commands on a case folder.

Only what is needed to read the command line is imported here; each command imports what it runs.
"""

# cyclopts evaluates the annotations of the commands, so the imports below are needed at run time.

from pathlib import Path
from typing import TYPE_CHECKING, Any

from cyclopts import App

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.commands.command_line import (
    Animate,
    At,
    CaseArgument,
    CasesArgument,
    Count,
    Drawn,
    Export,
    Force,
    Inputs,
    Json,
    KindNames,
    NewFolder,
    NewKind,
    Out,
    Outputs,
    Quiet,
    SendCommand,
    Set,
    complain,
    guarded,
    print_json,
    print_lines,
)
from heavylift.pipeline.commands.couple import COUPLE_COMMANDS
from heavylift.pipeline.commands.exchange import EXCHANGE_COMMANDS
from heavylift.pipeline.commands.fmu import FMU_COMMANDS
from heavylift.pipeline.commands.page import PAGE_COMMANDS
from heavylift.pipeline.commands.sea import SEA_COMMANDS, Seeds

if TYPE_CHECKING:
    from heavylift.pipeline.log import Log

__all__ = ["app"]


def _version() -> str:
    from importlib.metadata import version

    return version("heavylift")


app = App(
    name="heavylift",
    help="Is this lift safe? Case folders in, time histories, pictures and checked numbers out.",
    version=_version,
    version_flags=["--version"],
)


@app.command
def new(
    kind: NewKind = "",
    folder: NewFolder = None,
    /,
    *,
    quiet: Quiet = False,
) -> int:
    """Write a commented example case; without a type, list the types."""

    def command(log: "Log") -> int:
        from heavylift.pipeline.commands.new_case import new_case, template_kinds

        if not kind:
            print_lines([f"{name:14} {title}" for name, title in template_kinds().items()])
            return 0
        written = new_case(kind, folder or Path(kind))
        for file in written:
            log.say(f"new: {file}")
        log.say(f"new: next: heavylift run {written[0].parent}")
        return 0

    return guarded(command, quiet=quiet, json=False)


@app.command
def mesh(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Geometry to finite-element models."""
    return _stages(("mesh",), ("mesh",), case, out, set_, force=force, quiet=quiet, json=json)


@app.command
def modes(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    force: Force = False,
    quiet: Quiet = False,
    export: Export = None,
    json: Json = False,
) -> int:
    """Finite-element models to reduced bodies; meshes first if needed."""
    stages = ("mesh", "modes")
    return _stages(stages, ("modes",), case, out, set_, force=force, quiet=quiet, json=json, export=export)


@app.command
def simulate(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Reduced bodies to time histories; an interrupted run continues where it stopped."""
    stages = ("mesh", "modes", "simulate")
    return _stages(stages, ("simulate",), case, out, set_, force=force, quiet=quiet, json=json)


@app.command
def report(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    animate: Animate = False,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Pictures, plots and tables of the stages that have run."""
    changes = (*set_, "report.animation.enabled=true") if animate else set_
    return _stages(("report",), ("report",), case, out, changes, force=force, quiet=quiet, json=json)


@app.command
def run(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Whatever of mesh, modes, simulate and report the case still needs.

    Exit code: 1 if all has run and a check or criterion failed or could not be evaluated.
    """
    stages = ("mesh", "modes", "simulate", "report")
    return _stages(stages, stages, case, out, set_, force=force, quiet=quiet, json=json)


@app.command
def verify(
    cases: CasesArgument,
    *,
    out: Out = None,
    set_: Set = (),
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Run cases and compare their numbers with the references, and judge them by their criteria.

    Exit code: 0 if every check and criterion passed, 1 if some failed or could not be evaluated, 2 for bad input,
    above 2 if a run stopped before it got to them; of several cases the largest.
    """

    def command(log: "Log") -> int:
        from heavylift.pipeline.commands.verify import check_table, exit_code, verify_case, verify_document

        if not cases:
            raise InputError("no case", source="verify", expected="one or more case folders")
        verdicts = []
        for path in cases:
            folder = out / path.resolve().name if out is not None and len(cases) > 1 else out
            verdicts.append(verify_case(path, out=folder, overrides=set_, force=force, log=log))
            if not json:
                print_lines(check_table(verdicts[-1]))
        if json:
            print_json(verify_document(verdicts))
        return exit_code(verdicts)

    return guarded(command, quiet=quiet, json=json)


@app.command
def criteria(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    force: Force = False,
    seeds: Seeds = None,
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Run a case and judge it by its [[criteria]]: what is used of each limit, when, where, by which clause.

    With seeds the worst of all runs counts, and the distribution of the utilisation is shown.

    Exit code: 0 if every criterion passed, 1 if some failed or could not be evaluated, 2 for bad input, above 2 if the
    run stopped.
    """

    def command(log: "Log") -> int:
        from heavylift.pipeline.commands.criteria import criteria_document, criteria_table, judge_case

        judged = judge_case(case, out=out, overrides=set_, force=force, seeds=seeds, log=log)
        if json:
            print_json(criteria_document(judged))
        else:
            print_lines(criteria_table(judged))
        return int(judged.outcome)

    return guarded(command, quiet=quiet, json=json)


@app.command
def converge(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Refine the parameters of the case's [converge] section; error against CPU time, observed order."""

    def command(log: "Log") -> int:
        from heavylift.pipeline.commands.converge import converge_case, study_table

        study, plot = converge_case(case, out=out, overrides=set_, force=force, log=log)
        if json:
            print_json(study.document())
        else:
            print_lines([*study_table(study), f"plot: {plot}"])
        return 0

    return guarded(command, quiet=quiet, json=json)


@app.command
def scenario(
    case: CaseArgument,
    *,
    out: Out = None,
    set_: Set = (),
    send: SendCommand = None,
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Phases of an operation, and how long its ropes will be, without dynamics; or a command to a run in progress."""

    def command(log: "Log") -> int:
        if send is not None:
            from heavylift.pipeline.commands.scenario import send_command

            print_lines([] if quiet else [send_command(case, send, out=out, overrides=set_)])
            return 0
        from heavylift.pipeline.commands.scenario import scenario_command

        document, words = scenario_command(case, out=out, overrides=set_, log=log)
        if json:
            print_json(document)
        elif not quiet:
            print_lines(words)
        return 0

    return guarded(command, quiet=quiet, json=json)


@app.command
def eigen(
    case: CaseArgument,
    *,
    at: At = "start",
    count: Count = None,
    draw_: Drawn = (),
    input_: Inputs = (),
    output: Outputs = (),
    out: Out = None,
    set_: Set = (),
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Frequencies, damping and shapes of small motions about a state of the whole scene, and its linear system."""

    def command(log: "Log") -> int:
        from heavylift.pipeline.commands.eigen import eigen_command

        document, words = eigen_command(
            case,
            out=out,
            overrides=set_,
            at=at,
            inputs=input_ or None,
            outputs=output,
            count=count,
            drawn=draw_,
            log=log,
        )
        if json:
            print_json(document)
        elif not quiet:
            print_lines(words)
        return 0

    return guarded(command, quiet=quiet, json=json)


for _command in (*PAGE_COMMANDS, *SEA_COMMANDS, *EXCHANGE_COMMANDS, *FMU_COMMANDS, *COUPLE_COMMANDS):
    app.command(_command)


@app.command
def schema(
    section: str = "", /, *, tables: bool = False, python: bool = False, out: Path | None = None
) -> int:
    """Print the keys of a section of case.toml; without one, the JSON Schema for editors.

    Parameters
    ----------
    section
        As ropes, joints.hinge, bodies.geometry; case lists the sections.
    tables
        Tables of all keys in Markdown instead.
    python
        Types of the Python package instead, as heavylift/__init__.pyi.
    out
        With --tables: folder for a page a table and an index, as docs/case_keys.
    """
    if out is not None:

        def write(_log: "Log") -> int:
            from heavylift.pipeline.commands.key_pages import write_pages

            if section or not tables:
                raise InputError(
                    "without '--tables'", source="schema", key="--out", expected="'--tables --out'"
                )
            write_pages(out)
            return 0

        return guarded(write, quiet=True, json=False)
    if section:

        def command(_log: "Log") -> int:
            from shutil import get_terminal_size

            from heavylift.pipeline.case.schema import section_tables

            print_lines([section_tables(section, max(72, min(get_terminal_size((110, 24)).columns, 140)))])
            return 0

        return guarded(command, quiet=True, json=False)
    if python:
        from heavylift.pipeline.model.stub import stub_text

        print_lines([stub_text().removesuffix("\n")])
        return 0
    if tables:
        from heavylift.pipeline.case.schema import key_tables

        print_lines([key_tables()])
        return 0
    from heavylift.pipeline.case.schema import case_schema

    print_json(case_schema())
    return 0


@app.command(name="compile")
def compile_ahead(*kinds: KindNames, force: Force = False, quiet: Quiet = False) -> int:
    """Compile what runs would compile when they need it: everything, or some kinds, as RigidBodies or Ropes."""
    from heavylift.pipeline.commands.compile_kinds import compile_kinds

    return guarded(lambda log: compile_kinds(kinds, log, force=force), quiet=quiet, json=False)


@app.command
def doctor(*, json: Json = False) -> int:
    """What is installed, whether pictures can be drawn, and what to install if not."""
    from heavylift.pipeline.commands.doctor import diagnosis, diagnosis_lines

    found = diagnosis()
    if json:
        print_json(found)
    else:
        print_lines(diagnosis_lines(found))
    return 0 if found["ready"] else 1


def _stages(
    stages: tuple[str, ...],
    own: tuple[str, ...],
    path: Path,
    out: Path | None,
    overrides: tuple[str, ...],
    *,
    force: bool,
    quiet: bool,
    json: bool,
    export: Path | None = None,
) -> int:
    """Run stages of a case; `own` are those that ``--force`` repeats. Reduced bodies are written to `export`."""

    def command(log: "Log") -> int:
        from heavylift.pipeline.stages.stages import load_changed_case, run_case

        case = load_changed_case(path, overrides)
        if own == ("simulate",) and case.simulate is None:
            raise InputError(
                "no [simulate] section",
                source=case.file,
                expected="step or tolerance, output_interval, duration",
            )
        result = run_case(case, out=out, stages=stages, force=own if force else (), log=log)
        outcome, message = result.outcome, result.message
        exported = None
        if export is not None and outcome is Outcome.COMPLETED:
            from heavylift.pipeline.stages.export import export_bodies

            exported = export_bodies(case, result.folder, export, log)
        if outcome is Outcome.COMPLETED and {"simulate", "report"} <= {*own}:  # a whole run is judged
            verdict = result.stages[-1].details["verdict"]
            if not verdict["passed"]:
                outcome, message = Outcome.CHECK_FAILED, verdict["text"]
        if outcome is not Outcome.COMPLETED:
            complain(message)
        if json:
            last = result.stages[-1]
            if own == ("simulate",) and last.stage == "simulate" and last.details:
                print_json({"case": case.name, **last.details})
            else:
                summary = _summary(case.name, result, outcome, message)
                print_json(summary if exported is None else {**summary, "exported": exported})
        return int(outcome)

    return guarded(command, quiet=quiet, json=json)


def _summary(name: str, result: Any, outcome: Outcome, message: str) -> dict[str, Any]:
    """Document of the commands that have no form of their own."""
    return {
        "case": name,
        "outcome": outcome.name.lower(),
        "message": message,
        "out": str(result.folder.root),
        "cpu_s": result.cpu_s,
        "stages": [
            {
                "stage": stage.stage,
                "outcome": stage.outcome.name.lower(),
                "skipped": stage.skipped,
                "cpu_s": stage.cpu_s,
                "details": stage.details,
            }
            for stage in result.stages
        ],
    }
