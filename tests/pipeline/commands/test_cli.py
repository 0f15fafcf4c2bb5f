"""The command line: documents on standard output, words elsewhere, exit codes."""

from __future__ import annotations

import json
import os
import re
import resource
import statistics
import subprocess
import sys
import time

import pytest

from heavylift.pipeline.commands.cli import app

MAIN = "from heavylift.pipeline.commands.start import main; main()"


@pytest.fixture
def heavylift(capsys):
    def run(*tokens):
        capsys.readouterr()
        code = app([str(token) for token in tokens], result_action="return_value")
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


@pytest.mark.parametrize("count", ["0", "-1", "abc", "1.5"])
def test_a_wrong_number_of_processes_ends_a_command_that_needs_none(heavylift, monkeypatch, count):
    monkeypatch.setenv("HEAVYLIFT_PROCESSES", count)
    code, out, error = heavylift("new")
    assert (code, out) == (2, "")
    assert f"environment: HEAVYLIFT_PROCESSES: '{count}'; expected 1 or more processes" in error


def test_simulate_json_is_the_documented_report(heavylift, small_case):
    code, out, error = heavylift("simulate", small_case, "--json")
    document = json.loads(out)
    assert code == 0
    for key in ("outcome", "steps", "step_us", "cpu_s", "compile_s", "energy_drift"):
        assert key in document
    assert document["outcome"] == "completed"
    assert document["steps"] == 20000
    assert "mesh: beam" in error
    again = json.loads(heavylift("simulate", small_case, "--json")[1])
    assert again == document  # a skipped stage reports what it took when it ran


def test_verify_json_is_the_documented_document(heavylift, small_case):
    code, out, _ = heavylift("verify", small_case, "--json")
    assert code == 0
    document = json.loads(out)
    assert list(document) == ["cases"]
    (row,) = document["cases"]
    assert list(row) == ["case", "outcome", "cpu_s", "checks"]
    assert (row["case"], row["outcome"]) == ("small_beam", "completed")
    assert row["cpu_s"] > 0.0
    for check in row["checks"]:
        assert list(check) == ["id", "value", "reference", "error", "tolerance", "unit", "source", "passed"]
        assert check["passed"] is True
        assert check["error"] <= check["tolerance"]
    assert [check["unit"] for check in row["checks"]] == ["kg", "Hz"]


def test_a_failed_check_is_exit_code_one(heavylift, small_case):
    code, out, _ = heavylift("verify", small_case, "--set", 'check.0.reference="0.4 kg"', "--json")
    assert code == 1
    (row,) = json.loads(out)["cases"]
    assert row["outcome"] == "check_failed"
    assert [check["passed"] for check in row["checks"]] == [False, True]
    assert row["checks"][0]["error"] == pytest.approx(0.22, rel=1e-9)
    code, out, _ = heavylift("verify", small_case, "--set", 'check.0.reference="0.4 kg"')
    assert code == 1
    assert "FAILED" in out


def test_criteria_end_with_the_code_of_checks(heavylift, small_case):
    def judge(maximum, *more):
        one = f'criteria=[{{name="mass", type="limit", quantity="mesh.beam.mass", maximum="{maximum}"}}]'
        return heavylift("criteria", small_case, "--set", one, *more)

    code, out, _ = judge("0.5 kg", "--json")
    assert code == 0
    document = json.loads(out)
    assert list(document) == ["case", "outcome", "criteria"]
    (row,) = document["criteria"]
    assert (row["name"], row["limit"], row["side"], row["unit"]) == ("mass", 0.5, "<=", "kg")
    assert row["utilisation"] == pytest.approx(row["value"] / 0.5)
    code, out, _ = judge("0.1 kg")
    assert code == 1
    assert "a criterion failed" in out
    assert "FAILED" in out
    code, _, error = judge("0.1 m")
    assert code == 2
    assert "criteria.0.maximum: '0.1 m'" in error
    code, _, error = heavylift("criteria", small_case)
    assert code == 2
    assert "no criteria" in error


@pytest.mark.slow
def test_converge_shows_the_order_of_the_integrator(heavylift, small_case):
    code, out, _ = heavylift("converge", small_case, "--json")
    assert code == 0
    document = json.loads(out)
    assert list(document) == ["case", "parameter", "rows", "order"]
    assert [row["value"] for row in document["rows"]] == [2e-5, 1e-5, 5e-6]
    assert all(list(row) == ["value", "error", "cpu_s"] for row in document["rows"])
    assert document["order"] == pytest.approx(2.0, abs=0.15)
    plot = small_case / "out" / "converge" / "converge.png"
    assert plot.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    code, out, _ = heavylift("converge", small_case, "--quiet")
    assert "observed order" in out


@pytest.mark.slow
def test_converge_with_a_run_as_reference(heavylift, small_case):
    study = (
        'converge={parameter="simulate.step", values=["20 us", "10 us", "5 us"],'
        ' quantity="channel.tip.position.end", reference={run="1 us"}}'
    )
    code, out, _ = heavylift("converge", small_case, "--set", study, "--json")
    assert code == 0
    document = json.loads(out)
    assert len(document["rows"]) == 3
    assert document["order"] > 1.7


def test_converge_without_a_study_and_with_a_bad_value(heavylift, small_case):
    code, _, error = heavylift("converge", small_case, "--set", 'converge.values=["20 us", "3 kg"]')
    assert code == 2
    assert "is a mass" in error
    text = (small_case / "case.toml").read_text()
    start, end = text.index("[converge]"), text.index("[[check]]")
    (small_case / "case.toml").write_text(text[:start] + text[end:])
    code, _, error = heavylift("converge", small_case)
    assert code == 2
    assert "no [converge] section" in error


def test_mesh_and_modes_json_name_their_stages(heavylift, small_case):
    code, out, _ = heavylift("modes", small_case, "--json")
    assert code == 0
    document = json.loads(out)
    assert [stage["stage"] for stage in document["stages"]] == ["mesh", "modes"]
    assert document["stages"][1]["details"]["beam"]["properties"]["vector_count"] == 3


def test_run_makes_everything_and_then_nothing(heavylift, small_case):
    code, out, _ = heavylift("run", small_case, "--set", "simulate.duration=1 ms")
    assert code == 0
    assert (small_case / "out" / "report" / "report.md").is_file()
    code, out, _ = heavylift("run", small_case, "--set", "simulate.duration=1 ms")
    assert code == 0
    assert out.count("unchanged, skipped") == 4
    code, out, _ = heavylift("run", small_case, "--set", "simulate.duration=1 ms", "--quiet")
    assert (code, out) == (0, "")


@pytest.mark.slow
def test_schema_accepts_the_keys_of_the_cases(heavylift):
    code, out, _ = heavylift("schema")
    assert code == 0
    schema = json.loads(out)
    assert schema["$schema"].endswith("2020-12/schema")
    assert schema["additionalProperties"] is False
    assert {"title", "bodies", "simulate", "check"} <= set(schema["properties"])
    density = schema["$defs"]["MaterialSection"]["properties"]["density"]
    quantity, absent = density["anyOf"]
    assert absent == {"type": "null"}
    assert {"type": "number", "exclusiveMinimum": 0.0} in quantity["anyOf"]
    assert any(option["type"] == "string" for option in quantity["anyOf"])


@pytest.mark.slow
def test_doctor_reports_what_is_there(heavylift):
    code, out, _ = heavylift("doctor", "--json")
    found = json.loads(out)
    assert code == (0 if found["ready"] else 1)
    assert found["packages"]["numpy"]
    assert found["cache"]["folder"]
    assert "superlu" in " ".join(found["factorisations"]).lower()
    for key in ("gmsh", "drawing"):
        assert found[key]["works"] or found[key]["remedy"] or found[key]["detail"]


def children_cpu() -> float:
    """CPU time of all processes that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def test_help_is_quick():
    environment = {**os.environ, "COLUMNS": "100"}
    times = []
    for _ in range(3):
        begin = children_cpu()
        result = subprocess.run(
            [sys.executable, "-c", MAIN, "--help"],
            capture_output=True,
            text=True,
            check=True,
            env=environment,
        )
        times.append(children_cpu() - begin)
    for command in ("mesh", "modes", "simulate", "report", "run", "verify", "converge", "schema", "doctor"):
        assert command in result.stdout
    assert statistics.median(times) < 1.0  # 0.2 s on an idle machine; the margin is for a busy one


def test_importing_the_command_line_imports_no_library_it_does_not_need():
    unwanted = "{'numpy', 'pydantic', 'numba', 'h5py'}"
    code = f"import sys, heavylift.pipeline.commands.cli; print(sorted({unwanted} & set(sys.modules)))"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


SHORT = ("--set", "simulate.duration=1 ms")


@pytest.mark.slow
def test_the_report_follows_what_the_other_stages_have_left(heavylift, small_case):
    report = small_case / "out" / "report" / "report.md"
    heavylift("modes", small_case, *SHORT)
    heavylift("report", small_case, *SHORT)
    early = report.read_text()
    _, out, _ = heavylift("run", small_case, *SHORT)
    assert "report: unchanged" not in out
    whole = report.read_text()
    assert "1 ms" in whole
    assert whole != early
    results = small_case / "out" / "simulate" / "results.h5"
    results.write_bytes(results.read_bytes()[:5000])
    _, out, _ = heavylift("report", small_case, *SHORT)
    assert "unchanged" not in out
    assert "results.h5" in report.read_text()
    _, out, _ = heavylift("run", small_case, *SHORT)
    assert "report: unchanged" not in out
    begin = time.perf_counter()
    _, out, _ = heavylift("run", small_case, *SHORT)
    assert time.perf_counter() - begin < 0.5
    assert out.count("unchanged, skipped") == 4


def test_progress_without_a_terminal_is_lines_on_standard_error(heavylift, small_case, monkeypatch):
    from heavylift.pipeline import log

    monkeypatch.setattr(log, "PROGRESS_SECONDS", 0.0)
    code, out, error = heavylift("simulate", small_case)
    assert code == 0
    lines = [line for line in error.splitlines() if line.startswith("simulate: t = ")]
    assert lines
    assert all(re.fullmatch(r"simulate: t = \S+ s, \d+\.\d %, about \d+ s left", line) for line in lines)
    assert "% " not in out
    assert heavylift("simulate", small_case, "--force", "--quiet") == (0, "", "")


@pytest.mark.parametrize("place", ["taken", "taken/below"])
def test_an_output_folder_that_is_a_file(heavylift, small_case, place):
    (small_case / "taken").write_text("mine")
    for command in ("mesh", "verify", "report"):
        code, out, error = heavylift(command, small_case, "--out", small_case / place)
        assert code == 2
        assert "taken is a file; expected a folder" in out + error
        assert "--out" in out + error
    assert (small_case / "taken").read_text() == "mine"


def test_a_contradiction_that_an_override_made_names_the_override(heavylift, small_case):
    file = small_case / "case.toml"
    file.write_text(file.read_text().replace('"ringdown.beam.1"', '"ringdown.beam.3"'))
    override = "bodies.beam.modes.count=2"
    code, _, error = heavylift("mesh", small_case, *SHORT, "--set", override)
    assert code == 2
    assert "vector 3 of 2" in error
    assert f"case.toml with --set {override}" in error
    assert "duration" not in error
    file.write_text(file.read_text().replace('"ringdown.beam.3"', '"ringdown.beam.7"'))
    _, _, error = heavylift("mesh", small_case, *SHORT)
    assert "vector 7 of 3" in error
    assert "--set" not in error


def test_a_case_without_checks_says_so(heavylift, small_case):
    code, out, _ = heavylift("verify", small_case, "--set", "check=[]")
    assert code == 0
    assert "no checks" in out
    assert "no checks" not in heavylift("verify", small_case)[1]


def test_of_several_cases_the_largest_code_counts(heavylift, small_case):
    code, out, _ = heavylift("verify", small_case, small_case / "none", "--json")
    assert code == 2
    assert [row["outcome"] for row in json.loads(out)["cases"]] == ["completed", "bad_input"]


@pytest.mark.slow
def test_a_reader_that_closes_early_sees_no_traceback() -> None:
    command = (
        f"{sys.executable} -c 'from heavylift.pipeline.commands.start import main; main()' schema | head -n 1"
    )
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert done.stdout.startswith("{")
    assert done.stderr == ""
