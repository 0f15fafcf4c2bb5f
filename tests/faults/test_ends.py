"""How a command ends: whatever is in the way of its words, its memory or its time, in a line and with a code."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from heavylift.numerics.outcome import Outcome

MAIN = "from heavylift.pipeline.commands.start import main; main()"
SHORT = ("--set", "simulate.duration=1 ms")


def command(*tokens, code=MAIN, **options):
    """Run the command line in a process of its own."""
    given = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "timeout": 120} | options
    found = subprocess.run(
        [sys.executable, "-c", code, *(os.fsencode(t) for t in tokens)], check=False, **given
    )
    assert b"Traceback" not in (found.stderr or b"")
    return found


@pytest.mark.slow
@pytest.mark.parametrize("how", ["output", "both", "closed"])
def test_a_run_ends_as_if_it_could_speak(small_case, how):
    """A full disk under the words of a run does not end it; without any stream it is silent."""
    with Path("/dev/full").open("wb") as full:
        if how == "closed":
            found = command(
                "simulate",
                small_case,
                *SHORT,
                stdout=None,
                stderr=None,
                preexec_fn=lambda: [os.close(k) for k in (1, 2)],
            )
        else:
            streams = {"stdout": full} | ({"stderr": full} if how == "both" else {})
            found = command("simulate", small_case, *SHORT, **streams)
    assert found.returncode == 0
    if how == "output":
        assert found.stderr.decode().splitlines() == [
            "output is lost: No space left on device; the run itself continues"
        ]
    manifest = json.loads((small_case / "out" / "simulate" / "manifest.json").read_text())
    assert manifest["outcome"] == "completed"


@pytest.mark.slow
@pytest.mark.parametrize("tokens", [("verify",), ("verify", "--json"), ("simulate", "--json")])
def test_a_table_that_cannot_be_written_is_no_success(small_case, tokens):
    with Path("/dev/full").open("wb") as full:
        found = command(*tokens, small_case, *([] if "verify" in tokens else SHORT), stdout=full)
    assert found.returncode == Outcome.DISK_FULL
    assert b"output is lost" in found.stderr


@pytest.mark.slow
def test_a_reader_that_has_enough_does_not_end_a_run(small_case):
    """As in ``heavylift verify CASE CASE | head -1``: the second case is run, and the code is that of all checks."""
    other = small_case.parent / "other"
    shutil.copytree(small_case, other)
    text = (other / "case.toml").read_text()
    (other / "case.toml").write_text(text.replace('reference = "0.312 kg"', 'reference = "0.4 kg"'))
    reader, writer = os.pipe()
    os.close(reader)
    found = command("verify", small_case, other, stdout=writer)
    os.close(writer)
    assert found.returncode == Outcome.CHECK_FAILED
    assert found.stderr == b""


@pytest.mark.slow
def test_folders_that_are_no_utf_8(small_case):
    """Their names are shown with escapes; files with them can be read again."""
    folder = Path(os.fsdecode(bytes(small_case.parent / "caf") + b"\xe9"))
    small_case.rename(folder)
    for environment in ({"LC_ALL": "C"}, {"LC_ALL": "C.UTF-8"}, {"PYTHONIOENCODING": "ascii"}):
        found = command("simulate", folder, *SHORT, "--force", "--json", env={**os.environ, **environment})
        assert found.returncode == 0, found.stderr
        assert json.loads(found.stdout)["case"] == "caf\\udce9"
    found = command("simulate", folder / "nowhere", env={**os.environ, "LC_ALL": "C.UTF-8"})
    assert found.returncode == Outcome.BAD_INPUT
    assert len(found.stderr.splitlines()) == 1


SLOW_IMPORT = """
import sys, time
sys.path.insert(0, {folder!r})
from heavylift.pipeline.commands import start
import heavylift.pipeline.commands.cli as cli
def command(*tokens):
    import slow_module
    print("loaded" if slow_module.whole else "half", flush=True)
    while {waits}:
        time.sleep(0.01)
cli.app.command(command, name="slow")
sys.argv = ["heavylift", "slow"]
start.main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_while_a_module_loads_waits_for_its_end(tmp_path, number):
    """Half loaded libraries of C have ended the process with a segmentation fault later."""
    (tmp_path / "slow_module.py").write_text(
        "import time\nprint('begins', flush=True)\ntime.sleep(0.5)\nwhole = True\nprint('whole', flush=True)\n"
    )
    code = SLOW_IMPORT.format(folder=str(tmp_path), waits=True)
    process = subprocess.Popen(
        [sys.executable, "-c", code, "slow"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "begins\n"
    process.send_signal(number)
    out, error = process.communicate(timeout=30)
    assert process.returncode == Outcome.INTERRUPTED
    assert out.startswith("whole\n")
    (line,) = error.splitlines()
    assert ("SIGTERM" in line) == (number == signal.SIGTERM)
    assert "results so far are kept" in line


def test_a_signal_where_python_cannot_raise_is_not_lost(tmp_path):
    """As in the callback of a weak reference, or where an object is thrown away."""
    (tmp_path / "slow_module.py").write_text("whole = True\n")
    code = SLOW_IMPORT.format(folder=str(tmp_path), waits=True).replace(
        'print("loaded"', "Thrown(); print('loaded'"
    )
    thrown = (
        "import os, signal\nclass Thrown:\n"
        "    def __del__(self):\n        os.kill(os.getpid(), signal.SIGTERM); 1 + 1\n"
    )
    found = command("slow", code=thrown + code)
    assert found.returncode == Outcome.INTERRUPTED
    assert b"SIGTERM" in found.stderr
    assert len(found.stderr.splitlines()) == 1


FAULTY = """
from heavylift.pipeline.commands import start
import heavylift.pipeline.commands.cli as cli
from heavylift.pipeline.case import case_file
def fails(*_arguments, **_options):
    raise {error}
case_file.load_case = fails
start.main()
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("error", "outcome", "words"),
    [
        ("KeyError('nodes')", Outcome.FAULT, "KeyError: 'nodes'"),
        ("RuntimeError('two\\nlines')", Outcome.FAULT, r"two\nlines"),
        ("SystemError()", Outcome.FAULT, "SystemError"),
        ("MemoryError('Unable to allocate 8 TiB')", Outcome.OUT_OF_MEMORY, "Unable to allocate 8 TiB"),
        ("OSError(28, 'No space left on device')", Outcome.DISK_FULL, "No space left on device"),
        ("OSError(28, 'No space left on device', 'a.h5')", Outcome.DISK_FULL, "a.h5: No space left"),
        ("OSError(13, 'Permission denied', 'a.h5')", Outcome.BAD_INPUT, "a.h5: Permission denied"),
    ],
)
@pytest.mark.parametrize("writable", [True, False])
def test_what_nobody_expected_is_a_line_and_a_file(small_case, tmp_path, error, outcome, words, writable):
    place = tmp_path / "place"
    place.mkdir()
    if not writable:
        (tmp_path / "gone").mkdir()
    code = FAULTY.format(error=error)
    if not writable:
        code = "import os\nos.rmdir(os.getcwd())\n" + code  # nothing can be written in a folder that is gone
    found = command(
        "mesh", small_case, "--json", code=code, cwd=place if writable else tmp_path / "gone",
        env={**os.environ, "TMPDIR": str(tmp_path)},
    )  # fmt: skip
    assert found.returncode == outcome
    (line,) = found.stderr.decode().splitlines()
    assert words in line
    document = json.loads(found.stdout)
    assert (document["outcome"], document["error"]) == (outcome.name.lower(), line)
    files = [*place.glob("heavylift-fault-*.txt"), *tmp_path.glob("heavylift-fault-*.txt")]
    assert len(files) == (outcome is Outcome.FAULT)
    for file in files:
        assert str(file) in line
        assert "Traceback" in file.read_text()
        assert "case_file" in file.read_text() or "fails" in file.read_text()


@pytest.mark.slow
def test_a_signal_in_a_stage_outside_the_time_loop(small_case):
    """SIGTERM while a mesh is made: a line, the code of an interruption, and nothing half written."""
    code = MAIN.replace(
        "; main()",
        "\nimport time\nfrom heavylift.pipeline.results import model_io\n"
        "def slow(*_): print('meshing', flush=True); time.sleep(60)\n"
        "model_io.write_model = slow\nmain()",
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, "mesh", str(small_case)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout.readline() == "meshing\n"
    begin = time.monotonic()
    process.send_signal(signal.SIGTERM)
    _, error = process.communicate(timeout=30)
    assert time.monotonic() - begin < 10.0
    assert process.returncode == Outcome.INTERRUPTED
    assert error == "SIGTERM: stopped; results so far are kept\n"
    assert not list((small_case / "out").rglob("*.h5"))
