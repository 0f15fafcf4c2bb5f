"""What reaches a terminal is text: nothing of it is obeyed, whoever wrote it."""

from __future__ import annotations

import io
import json
import os
import pty
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from heavylift.numerics.outcome import InputError, visible
from heavylift.pipeline.commands.command_line import print_json
from heavylift.pipeline.log import Log, say_on

MAIN = "from heavylift.pipeline.commands.start import main; main()"
CLEAR, TITLE, C1, RIGHT_TO_LEFT = "\x1b[2J", "\x1b]0;mine\x07", "\x9b31m", "\u202e"
HOSTILE = f"{CLEAR}{TITLE}{C1}{RIGHT_TO_LEFT}\r\x08\x7f\u200b"


def obeyed(text: str) -> list[str]:
    """Letters that a terminal obeys or does not show, by their Unicode categories."""
    import unicodedata

    return [c for c in text if unicodedata.category(c) in {"Cc", "Cf", "Zl", "Zp"} and c not in "\n\t"]


def test_all_that_a_terminal_obeys_is_shown_as_an_escape() -> None:
    assert len(obeyed(HOSTILE)) == 9
    assert obeyed(visible(HOSTILE)) == []
    assert visible(CLEAR + "x") == r"\x1b[2Jx"
    for plain in ("", "Kräne – 5 m², ±3°", "荷物\n\ttab", "№ 5 → “a”"):
        assert visible(plain) is plain or visible(plain) == plain
    # what is left are signs that belong to scripts and music, and are drawn with their letters
    every = "".join(map(chr, [*range(0xD800), *range(0xE000, 0x110000)]))
    assert not [c for c in obeyed(visible(every)) if ord(c) < 0x600 or 0x2000 <= ord(c) < 0x3000]


def test_streams_get_text_alone() -> None:
    stream = io.StringIO()
    say_on(stream, f"a{HOSTILE}\nb")
    assert obeyed(stream.getvalue()) == []
    assert stream.getvalue().count("\n") == 2


def test_a_message_of_several_lines_does_not_look_like_several_messages() -> None:
    stream = io.StringIO()
    Log(stream=stream).say("simulate: note\nrun: all checks passed")
    assert stream.getvalue() == "simulate: note\n  run: all checks passed\n"


def test_documents_stay_what_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    print_json({"note": HOSTILE})
    out = capsys.readouterr().out
    assert obeyed(out) == []
    assert json.loads(out) == {"note": HOSTILE}


def test_errors_show_what_is_wrong_in_a_line() -> None:
    error = InputError(HOSTILE, source=HOSTILE, key=HOSTILE, expected=HOSTILE)
    assert obeyed(str(error)) == []
    assert "\n" not in str(error)


CASE = """
title = "a {hostile}"
[gravity]
acceleration = [0, 0, -9.81]
[bodies.load]
type = "rigid"
mass = 1.0
inertia = [1.0, 1.0, 1.0]
frame = {{ motion = "free" }}
[[scenario.phases]]
name = "fall"
actions = [{{ note = "words {hostile}" }}]
until = {{ time = 0.01 }}
[simulate]
step = 0.001
output_interval = 0.01
duration = 0.02
[[check]]
id = "fallen"
quantity = "channel.load.position.z.end"
reference = 0.0
tolerance = {{ absolute = 1.0 }}
source = "hand {hostile}"
"""


def on_terminal(folder: Path, *tokens: str) -> tuple[int, str]:
    """Exit code of a command, and what its terminal gets; standard error too."""
    main, process = pty.openpty()
    child = subprocess.Popen(
        [sys.executable, "-c", MAIN, *tokens], cwd=folder, stdin=process, stdout=process, stderr=process
    )
    os.close(process)
    spec = b""
    while True:
        try:
            more = os.read(main, 4096)
        except OSError:
            break
        if not more:
            break
        spec += more
    os.close(main)
    return child.wait(60), spec.decode()


@pytest.mark.slow
@pytest.mark.parametrize(
    "tokens", [("run", "."), ("scenario", "."), ("verify", "."), ("run", ".", "--json"), ("draw", ".")]
)
def test_no_word_of_a_case_is_obeyed_by_a_terminal(tmp_path: Path, tokens: Any) -> None:
    hostile = "".join(f"\\u{ord(c):04x}" for c in f"{TITLE}{C1}{RIGHT_TO_LEFT}")
    (tmp_path / "case.toml").write_text(CASE.format(hostile=hostile))
    code, spec = on_terminal(tmp_path, *tokens)
    assert code in {0, 1}, spec
    for word in (TITLE, C1, RIGHT_TO_LEFT):
        assert word not in spec
    # a bar is drawn by escapes of its own
    assert "]0;" not in spec.replace("\\x1b]0;", "").replace("\\u001b]0;", "")


@pytest.mark.parametrize("token", [f"--fo{TITLE}", f"run{TITLE}", f"{C1}"])
def test_nor_is_a_word_of_the_command_line(tmp_path: Path, token: str) -> None:
    """File names come from elsewhere too, as in `heavylift run *`."""
    done = subprocess.run(
        [sys.executable, "-c", MAIN, "run", token, token],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode in {1, 2}
    assert obeyed(done.stdout + done.stderr) == []
