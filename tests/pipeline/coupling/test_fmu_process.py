"""An FMU in its process: what it computes, its state, and every way in which it may fail."""

import math
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from made_fmus import library, make_fmu

from heavylift.pipeline.coupling.fmu_file import read_fmu
from heavylift.pipeline.coupling.fmu_process import FmuError, FmuProcess


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("fmus")


def instance(folder, version, *, timeout=20.0, flags=(), outputs=("force", "sum"), **parameters):
    path = folder / f"pd{version}{''.join(flags)}.fmu"
    if not path.is_file():
        make_fmu(path, version, library(folder, version, *flags))
    made = FmuProcess(read_fmu(path), "pd", ("x", "v"), outputs, parameters, timeout)
    made.start({"x": 0.5, "v": 0.0})
    return made


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_computes_with_its_parameters_and_goes_back_to_a_state(folder, version):
    made = instance(folder, version, flags=("-DLAGS",), stiffness=1e4)
    assert made.outputs()["force"] == -0.5 * 1e4 * 0.5  # the mean of the law and of nothing before
    made.set({"x": 1.0, "v": 0.1}, {"x": 2.0, "v": 0.0})
    made.step(0.0, 0.01)
    law = -1e4 * 1.01 - 6e4 * 0.1  # the mean of an input over the step
    assert made.outputs()["force"] == 0.5 * (law - 5e3)
    assert made.outputs()["sum"] == 0.01
    saved, kept = made.save(), (made.serialize(), dict(made.outputs()))
    made.set({"x": 0.0, "v": 0.0}, {"x": 0.0, "v": 0.0})
    made.step(0.01, 0.01)
    after = dict(made.outputs())
    assert after == {"force": 0.5 * law, "sum": 0.02}
    made.restore(saved)
    assert made.outputs() == kept[1]
    made.step(0.01, 0.01)
    assert made.outputs() == after
    other = instance(folder, version, flags=("-DLAGS",), stiffness=5.0)
    other.deserialize(*kept)
    other.set({"x": 0.0, "v": 0.0}, {"x": 0.0, "v": 0.0})
    other.step(0.01, 0.01)
    assert other.outputs() == after
    for one in (made, other):
        process = one._process
        one.close()
        assert process.returncode == 0


FAULTS = {
    1: r"t = 0.04 s: FMU 'pd' \(pd\d.fmu\): crashed with SIGSEGV when asked to make a step",
    2: r"has not answered for 1 s when asked to make a step",
    3: r"cannot make a step: .*error.*; it said: error: the bilge pump is dry at 0.05 s",
    4: r"its output 'force' is nan",
    5: r"ended its process with exit code 9 when asked to make a step; it said: out of hydraulic oil",
}


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("fault", FAULTS)
def test_what_goes_wrong_in_it_is_one_error_and_leaves_no_process(folder, version, fault):
    made = instance(folder, version, timeout=1.0 if fault == 2 else 20.0, fault=fault, place="bilge")
    process = made._process
    for step in range(4):
        made.step(0.01 * step, 0.01)
    with pytest.raises(FmuError, match=FAULTS[fault]):
        made.step(0.04, 0.01)
    assert process.returncode is not None
    with pytest.raises(FmuError, match="its process has ended"):
        made.step(0.05, 0.01)
    made.close()


def test_an_fmu_that_does_not_load_or_instantiate_says_so(folder):
    path = make_fmu(folder / "odd.fmu", 2, library(folder, 3))
    with pytest.raises(FmuError, match=r"cannot be loaded: .*fmi2"):
        FmuProcess(read_fmu(path), "pd", (), (), {}, 20.0)
    path = make_fmu(folder / "token.fmu", 2, library(folder, 2), known_as="another")
    with pytest.raises(FmuError, match="cannot be loaded: Failed to instantiate"):
        FmuProcess(read_fmu(path), "pd", (), (), {}, 20.0)


PARENT = """
import sys, time
sys.path.insert(0, {here!r})
from pathlib import Path
from test_fmu_process import instance
made = instance(Path({folder!r}), 2, fault=2)
print(made._process.pid, made._process.args[-1], flush=True)
for step in range(8):
    made.step(0.01 * step, 0.01)
"""


def test_a_hanging_fmu_ends_with_the_process_that_asked(folder):
    program = PARENT.format(here=str(Path(__file__).parent), folder=str(folder))
    parent = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    child, left = parent.stdout.readline().split()
    child = int(child)
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    parent.stdout.close()
    limit = time.monotonic() + 10.0
    while time.monotonic() < limit and _runs(child):
        time.sleep(0.02)
    assert not _runs(child)
    assert not Path(left).exists()


def _runs(number):
    """Whether a process is there that is not just waiting to be asked how it ended."""
    try:
        words = Path(f"/proc/{number}/stat").read_text(encoding="ascii")
        return words.rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_an_infinite_input_reaches_it_as_it_is(folder):
    made = instance(folder, 3, outputs=("force",))
    made.set({"x": -math.inf, "v": 0.0}, {"x": 0.0, "v": 0.0})
    made.step(0.0, 0.01)
    assert made.outputs() == {"force": 1e5}  # its limit
    made.close()
