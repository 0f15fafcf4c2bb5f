"""Cases as FMUs: what FMPy says of them, and that a host gets the bits of a direct run, states included."""

from __future__ import annotations

import locale
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import heavylift as hl
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.exchange.fmu_export import export_fmu, structured_name
from tests.pipeline.exchange.processes import gone, until

fmpy = pytest.importorskip("fmpy")
pytest.importorskip("msgpack")
if shutil.which("cc") is None:
    pytest.skip("no C compiler", allow_module_level=True)

ROOT = Path(__file__).parents[3]
DRIVEN = Path(__file__).parent / "driven"
CASES = (
    "hoist",  # a rope about a sheave
    "three_links_closed",  # joints
    "zoo_driven",  # drives
    "irregular_sea",  # waves on a hull with a database
    "stack",  # collisions
    "flexible_block",  # modes
    "staged_lift",  # a scenario
    "floating_crane_lift",  # a crane on a hull
    "spmt_bump",  # a transporter
    "hanging_cable",  # a cable of elements
)
EXCHANGE = ROOT / "pipeline" / "exchange"
WARNINGS = ("-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wshadow")
CLEAN = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")
WINCH, GUST = 1, 2  # value references of the inputs of the driven hoist


class Host:
    """An FMU as a host of FMPy drives it."""

    def __init__(self, file, folder):
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        self.about = fmpy.read_model_description(str(file))
        place = folder / file.stem
        if not place.is_dir():
            fmpy.extract(str(file), str(place))
        self.version = int(self.about.fmiVersion[0])
        self.said = []
        self.unit = (FMU2Slave if self.version == 2 else FMU3Slave)(
            guid=self.about.guid,
            modelIdentifier=self.about.coSimulation.modelIdentifier,
            unzipDirectory=str(place),
            instanceName="one",
        )
        self.outputs = {
            v.name: v.valueReference for v in self.about.modelVariables if v.causality == "output"
        }
        if self.version == 3:
            self.unit.instantiate(
                logMessage=lambda _place, _status, _kind, text: self.said.append(text.decode())
            )
        else:
            self.unit.instantiate()
        self.begin()

    def begin(self, start=0.0):
        if self.version == 2:
            self.unit.setupExperiment(startTime=start)
            self.unit.enterInitializationMode()
        else:
            self.unit.enterInitializationMode(startTime=start)
        self.unit.exitInitializationMode()

    def get(self, *names):
        read = self.unit.getFloat64 if self.version == 3 else self.unit.getReal
        return read([self.outputs[name] for name in names])

    def set(self, reference, value):
        (self.unit.setFloat64 if self.version == 3 else self.unit.setReal)([reference], [value])

    def end(self):
        self.unit.terminate()
        self.unit.freeInstance()


def children():
    """Processes that this one has started and that are there."""
    found = Path("/proc/self/task").glob("*/children")
    return {int(number) for file in found for number in file.read_text().split() if not gone(int(number))}


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("localedef") is None, reason="no locales can be made")
def test_a_host_may_write_numbers_with_a_comma(tmp_path, monkeypatch):
    """Its locale decides on what functions of C take for a number."""
    made = tmp_path / "de_DE.UTF-8"
    subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", made], check=True)
    file = export_fmu(DRIVEN, 3, out=tmp_path / "driven.fmu", overrides=["inputs.gust.value=0.5"])
    monkeypatch.setenv("LOCPATH", str(tmp_path))
    locale.setlocale(locale.LC_NUMERIC, made.name)
    try:
        assert locale.localeconv()["decimal_point"] == ","
        host = Host(file, tmp_path)
        assert host.unit.getFloat64([WINCH, GUST]) == [0.0, 0.5]
        host.set(GUST, 1.5)
        host.unit.doStep(0.0, 0.1)
        assert host.get("gust.value") == [1.5]
        host.end()
    finally:
        locale.setlocale(locale.LC_NUMERIC, "C")


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_unit_has_the_bits_of_the_case_and_goes_on_from_its_states(tmp_path, fmi):
    from fmpy.validation import validate_fmu

    changes = ["simulate.output_interval=50 ms"]
    file = export_fmu(DRIVEN, fmi, out=tmp_path / "driven.fmu", overrides=changes)
    assert validate_fmu(str(file)) == []
    before = children()
    host, direct = Host(file, tmp_path), hl.Simulation(DRIVEN, overrides=changes)
    variables = {v.name: v for v in host.about.modelVariables}
    assert (variables["gust"].unit, variables["gust"].max) == ("N", "1000000.0")
    names = list(direct.outputs)
    assert list(host.outputs) == [structured_name(name) for name in names]
    columns = direct.columns(names)

    def alike():
        return host.get(*host.outputs) == direct.row[columns].tolist()

    assert alike()

    def advance(first, last):
        for k in range(first, last):
            host.set(GUST, 1e5 * k)
            host.set(WINCH, 0.01 * k)
            host.unit.doStep(0.25 * k, 0.25)
            direct.step(0.25, {"gust": 1e5 * k, "hoisting": 0.01 * k})

    advance(0, 4)
    assert alike()
    state = host.unit.getFMUState()
    data = host.unit.serializeFMUState(state)
    advance(4, 7)
    assert alike()
    after = host.get(*host.outputs)
    for source in (host, Host(file, tmp_path)):
        kept = state if source is host else source.unit.deserializeFMUState(data)
        source.unit.setFMUState(kept)
        for k in range(4, 7):
            source.set(GUST, 1e5 * k)
            source.set(WINCH, 0.01 * k)
            source.unit.doStep(0.25 * k, 0.25)
        assert source.get(*host.outputs) == after
        source.unit.freeFMUState(kept)
        if source is not host:
            source.unit.freeInstance()  # without an end
    host.unit.reset()
    with pytest.raises(fmpy.fmi1.FMICallException):  # its tables of time would be late
        host.begin(start=2.0)
    host.unit.reset()
    host.begin()
    direct = hl.Simulation(DRIVEN, overrides=changes)
    assert alike()
    host.unit.doStep(0.0, 0.5)
    direct.step(0.5)
    assert alike()
    host.end()
    assert children() == before


def test_what_a_host_does_wrong_is_an_error_with_words(tmp_path):
    host = Host(export_fmu(DRIVEN, 3, out=tmp_path / "driven.fmu"), tmp_path)
    for call, words in (
        (lambda: host.unit.doStep(0.0, 0.0123), "0.0123 s is no multiple of 0.01 s"),
        (lambda: host.unit.doStep(0.0, 30.0), "ends at 20 s"),
        (lambda: host.unit.doStep(1.0, 0.01), "a step from t = 1 s, and the unit is at 0 s"),
        (lambda: host.set(GUST, float("nan")), "gust: nan is not finite"),
        (lambda: host.set(999, 0.0), "value reference 999 is not that of an input"),
        (
            lambda: host.unit.setInt32([1], [1]),
            "fmi3SetInt32: this unit has inputs and outputs that are numbers",
        ),
        (lambda: host.unit.deserializeFMUState(b"nothing"), "7 bytes that are no state of this unit"),
        (lambda: [host.set(GUST, 5e6), host.unit.doStep(0.0, 0.1)], "gust"),
    ):
        with pytest.raises(Exception, match="failed with status 3"):
            call()
        assert words in host.said[-1]
    host.set(GUST, 1e5)
    host.unit.doStep(0.0, 0.1)
    assert host.get("gust.value") == [1e5]
    host.end()


PROGRAM = """
import sys, time
from pathlib import Path
sys.path.insert(0, {root!r})
from tests.pipeline.exchange.test_fmu_export import Host, children
host = Host(Path({file!r}), Path({folder!r}))
print(*children(), flush=True)
time.sleep(600)
"""


def test_the_child_of_a_host_that_is_killed_ends(tmp_path):
    file = export_fmu(DRIVEN, 2, out=tmp_path / "driven.fmu")
    program = PROGRAM.format(root=str(ROOT), file=str(file), folder=str(tmp_path))
    host = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    numbers = [int(number) for number in host.stdout.readline().split()]
    assert len(numbers) == 1
    host.kill()
    host.wait()
    host.stdout.close()
    until(lambda: gone(numbers[0]))


@pytest.mark.slow
def test_a_unit_without_a_python_says_so(tmp_path, monkeypatch):
    file = export_fmu(DRIVEN, 3, out=tmp_path / "driven.fmu")
    monkeypatch.setenv("HEAVYLIFT_PYTHON", str(tmp_path / "python"))
    with pytest.raises(Exception, match="Failed to instantiate"):
        Host(file, tmp_path)
    monkeypatch.setenv("HEAVYLIFT_PYTHON", sys.executable)
    Host(file, tmp_path).end()


def test_a_machine_without_a_compiler_is_told(tmp_path, monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(InputError, match="no C compiler 'no-such-compiler' is found"):
        export_fmu(DRIVEN, out=tmp_path / "driven.fmu")
    monkeypatch.setenv("CC", "false")
    with pytest.raises(InputError, match="false does not compile the library: exit code 1"):
        export_fmu(DRIVEN, out=tmp_path / "driven.fmu")
    assert not (tmp_path / "driven.fmu").exists()


@pytest.mark.slow
def test_the_library_touches_no_memory_that_is_not_its_own(tmp_path):
    file, program = export_fmu(DRIVEN, 3, out=tmp_path / "driven.fmu"), tmp_path / "host"
    source = str(Path(__file__).parent / "fmu_host.c")
    command = ["cc", "-std=c99", *WARNINGS, "-DFMI=3", "-I", str(EXCHANGE), source, "-o", str(program), "-lm"]
    if subprocess.run([*command, *CLEAN], capture_output=True, check=False).returncode:
        subprocess.run([*command, "-O2"], check=True)  # a compiler without these checks
    fmpy.extract(str(file), str(tmp_path / "unit"))
    token = fmpy.read_model_description(str(file)).guid
    done = subprocess.run(
        [program, tmp_path / "unit" / "resources", token],
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    assert (done.returncode, done.stderr) == (0, "")
    lines = [line for line in done.stdout.splitlines() if not line.startswith("3 logStatusError")]
    assert lines == ["3 3 3 3 3", "same bits", "none"]
    assert "bytes for a state of" in done.stdout
    assert "the token another is not that of this unit" in done.stdout


def test_the_library_compiles_without_warnings_for_both_versions(tmp_path):
    for fmi in ("2", "3"):
        command = [
            "cc",
            "-c",
            "-fPIC",
            "-std=c99",
            *WARNINGS,
            f"-DFMI={fmi}",
            str(EXCHANGE / "heavylift_fmu.c"),
        ]
        subprocess.run([*command, "-o", str(tmp_path / "unit.o")], check=True)


def test_names_are_structured():
    assert structured_name("module.position.x") == "module.position.x"
    assert structured_name("edge-1.it's.12") == r"'edge-1'.'it\'s'.'12'"


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_case_of_every_sort_is_valid_and_has_its_bits(tmp_path, name, fmi):
    from fmpy.validation import validate_fmu

    case = ROOT / "cases" / name
    file = export_fmu(case, fmi, out=tmp_path / "unit.fmu")
    assert validate_fmu(str(file)) == []
    host, direct = Host(file, tmp_path), hl.Simulation(case)
    columns = direct.columns(list(direct.outputs))
    for k in range(5):
        host.unit.doStep(k * direct.step_size, direct.step_size)
        direct.step()
    assert np.array_equal(host.get(*host.outputs), direct.row[columns], equal_nan=True)
    host.end()
