"""The command ``serve``: a case that other programs drive, over TCP or through the pipes of a parent process."""

# cyclopts evaluates the annotations of the commands, so the imports below are needed at run time.

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from heavylift.pipeline.commands.command_line import CaseArgument, Quiet, Set, guarded

if TYPE_CHECKING:
    from heavylift.pipeline.log import Log

__all__ = ["EXCHANGE_COMMANDS"]

Port = Annotated[
    int | None, Parameter(name="--port", help="TCP port; 0 takes a free one.", show_default=False)
]
Pipe = Annotated[
    bool,
    Parameter(
        name="--pipe", help="Speak with the parent process through standard input and output.", negative=""
    ),
]
Host = Annotated[
    str,
    Parameter(
        name="--host", help="Address that clients connect to; another than this machine's own is not safe."
    ),
]
TokenFile = Annotated[
    Path | None,
    Parameter(
        name="--token-file",
        help="File for host, port and token, which this user alone can read; it is removed at the end.",
        show_default=False,
    ),
]
Wait = Annotated[
    float,
    Parameter(
        name="--wait",
        help="Seconds to wait for a master, at the start and after one has gone; inf is for ever.",
    ),
]
Results = Annotated[
    Path | None,
    Parameter(
        name="--out",
        help="Folder for meshes, modes and the results of the run; without it they are not kept.",
        show_default=False,
    ),
]


def serve(
    case: CaseArgument,
    *,
    port: Port = None,
    pipe: Pipe = False,
    host: Host = "127.0.0.1",
    token_file: TokenFile = None,
    wait: Wait = 600.0,
    out: Results = None,
    set_: Set = (),
    quiet: Quiet = False,
) -> int:
    """Let another program drive a case: it sets inputs, steps, and reads outputs.

    Exit code: 0 if the master has ended the run, 2 for bad input, 5 if it was interrupted or no master came, another
    one if the simulation stopped by itself.
    """

    def command(log: "Log") -> int:
        from heavylift.pipeline.exchange.serving import serve_case

        return serve_case(
            case,
            port=port,
            pipe=pipe,
            host=host,
            token_file=token_file,
            wait=wait,
            out=out,
            overrides=set_,
            log=log,
        )

    return guarded(command, quiet=quiet, json=False)


EXCHANGE_COMMANDS = (serve,)
