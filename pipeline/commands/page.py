"""The commands ``draw``, ``export`` and ``view``: the scene of a case before, after and during its run."""

# cyclopts evaluates the annotations of the commands, so the imports below are needed at run time.

from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from heavylift.pipeline.commands.command_line import (
    CaseArgument,
    Force,
    Json,
    Out,
    Quiet,
    Set,
    guarded,
    print_json,
)

if TYPE_CHECKING:
    from heavylift.pipeline.log import Log

__all__ = ["PAGE_COMMANDS"]

Glb = Annotated[bool, Parameter(name="--glb", help="Write NAME.glb, with animation (glTF 2.0).", negative="")]
Vtkhdf = Annotated[
    bool, Parameter(name="--vtkhdf", help="Write NAME.vtkhdf, a time series for ParaView.", negative="")
]
Port = Annotated[int, Parameter(name="--port", help="Port of this machine; a free one if 0.")]


def draw(
    case: CaseArgument, *, out: Out = None, set_: Set = (), quiet: Quiet = False, json: Json = False
) -> int:
    """The assembled scene before a run: a page with names, markers, joints, rope paths and contact surfaces."""

    def command(log: "Log") -> int:
        from heavylift.pipeline.commands.scene_files import draw_case

        file = draw_case(case, out=out, overrides=set_, log=log)
        if json:
            print_json({"file": str(file)})
        return 0

    return guarded(command, quiet=quiet, json=json)


def export(
    case: CaseArgument,
    *,
    glb: Glb = False,
    vtkhdf: Vtkhdf = False,
    out: Out = None,
    set_: Set = (),
    quiet: Quiet = False,
    json: Json = False,
) -> int:
    """Write the scene of a run for other programs, into OUT/export."""

    def command(log: "Log") -> int:
        from heavylift.pipeline.commands.scene_files import export_case

        kinds = [kind for kind, asked in (("glb", glb), ("vtkhdf", vtkhdf)) if asked]
        files = export_case(case, kinds, out=out, overrides=set_, log=log)
        if json:
            print_json({"files": [str(file) for file in files]})
        return 0

    return guarded(command, quiet=quiet, json=json)


def view(
    case: CaseArgument,
    *,
    port: Port = 0,
    out: Out = None,
    set_: Set = (),
    force: Force = False,
    quiet: Quiet = False,
) -> int:
    """Run a case and show its page meanwhile, on this machine only; ends with Ctrl-C."""

    def command(log: "Log") -> int:
        from heavylift.pipeline.commands.live import view_case

        return view_case(case, port=port, out=out, overrides=set_, force=force, log=log)

    return guarded(command, quiet=quiet, json=False)


PAGE_COMMANDS = (draw, export, view)
