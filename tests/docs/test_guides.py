"""The guides are what they say: their commands run, their case files are valid, their links lead somewhere."""

from __future__ import annotations

import functools
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest
from where import ROOT

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.assemble.early_checks import scene_errors
from heavylift.pipeline.case.schema import case_schema
from tests.pipeline.judged import judged_checks, judged_criteria

DOCS = ROOT / "docs"
GUIDES = (
    "getting-started.md",
    "rigging.md",
    "equipment.md",
    "fmi.md",
    "blocks.md",
    "coupling.md",
    "criteria.md",
    "editor.md",
    "benchmarks.md",
    "data_flow.md",
    "glossary.md",
    "inputs.md",
    "inside.md",
    "linearisation.md",
    "interface.md",
    "python.md",
    "transport.md",
)


class Block(NamedTuple):
    """A fenced block of a page."""

    language: str
    text: str


def blocks(page: Path) -> list[Block]:
    """Fenced blocks in their order."""
    found = re.findall(r"^```(\w+)\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return [Block(*each) for each in found]


@pytest.mark.parametrize("name", [*GUIDES, "../README.md", "../cases/README.md"])
def test_links_of_a_page_lead_to_files_and_headings(name):
    page = DOCS / name
    text = page.read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)\s]+)\)", text)
    for link in (link for link in links if not link.startswith("http")):
        file, _, anchor = link.partition("#")
        target = (page.parent / file) if file else page
        assert target.exists(), link
        if anchor:
            headings = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.MULTILINE)
            assert anchor in {re.sub(r"[^\w\- ]", "", h.lower()).replace(" ", "-") for h in headings}, link


def test_every_case_and_every_page_is_linked():
    listed = (ROOT / "cases" / "README.md").read_text(encoding="utf-8")
    families = ("mbs_a", "flexible_pendulum", "zoo")  # of these some are linked
    cases = {file.parent.name for file in (ROOT / "cases").glob("*/case.toml")}
    missing = {name for name in cases if f"({name}/README.md)" not in listed}
    assert {name for name in missing if not name.startswith(families)} == set()
    front = (ROOT / "README.md").read_text(encoding="utf-8")
    assert {page.name for page in DOCS.glob("*.md")} == set(re.findall(r"\]\(docs/([\w-]+\.md)\)", front))
    assert len(front.splitlines()) <= 120


def test_the_front_page_has_the_sling_of_the_case_that_it_shows():
    (block,) = [block.text for block in blocks(ROOT / "README.md") if block.language == "toml"]
    shown = tomllib.loads(block)
    case = tomllib.loads((ROOT / "pipeline" / "templates" / "lift" / "case.toml").read_text(encoding="utf-8"))
    (rope,), (check,) = shown["ropes"], shown["check"]
    own = next(each for each in case["ropes"] if each["name"] == rope["name"])
    assert rope.items() <= own.items()
    other = next(each for each in case["check"] if each["id"] == check["id"])
    assert {key: check[key] for key in ("quantity", "reference", "tolerance")}.items() <= other.items()


def shell(command: str, folder: Path) -> tuple[str, Path]:
    """Output of a command in a folder, and the folder in which it ends."""
    tools = folder.parent / "bin"
    tools.mkdir(exist_ok=True)
    script = tools / "heavylift"
    if not script.exists():  # as installed, but of this interpreter and with whatever paths it has
        script.write_text(
            f"#!{sys.executable}\nfrom heavylift.pipeline.commands.start import main\nmain()\n",
            encoding="utf-8",
        )
        script.chmod(0o755)
    environment = {**os.environ, "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}", "TERM": "dumb"}
    where = folder.parent / "where"
    result = subprocess.run(
        ["bash", "-e", "-c", f"{command}\npwd > {where}"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert result.returncode == 0, f"{command}\n{result.stdout}{result.stderr}"
    return result.stdout + result.stderr, Path(where.read_text(encoding="utf-8").strip())


@pytest.mark.slow
def test_getting_started_runs_as_it_is_written(tmp_path):
    """Every TOML block is added to case.toml, every command run, and said is what the page says."""
    folder = tmp_path / "begin"
    folder.mkdir()
    spec, seen = "", {"sh": 0, "toml": 0, "text": 0}
    for language, text in blocks(DOCS / "getting-started.md"):
        seen[language] += 1
        if language == "toml":
            with (folder / "case.toml").open("a", encoding="utf-8") as file:
                file.write(f"{text}\n")
        elif language == "sh":
            spec, folder = shell(text, folder)
        else:
            for line in text.splitlines():
                assert line in spec, f"{line!r} is not in\n{spec}"
    assert seen == {"sh": 6, "toml": 4, "text": 4}
    assert (folder / "out" / "report" / "scene_end.png").is_file()


@pytest.mark.slow
def test_the_page_on_data_flow_prints_what_it_shows(tmp_path, monkeypatch, capsys):
    """Its Python runs in order, in a folder with the case that the page names."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "pipeline" / "templates" / "lift", tmp_path / "demo")
    names: dict[str, object] = {}
    shown = []
    for language, text in blocks(DOCS / "data_flow.md"):
        if language == "toml":
            own = tomllib.loads((tmp_path / "demo" / "case.toml").read_text(encoding="utf-8"))
            assert tomllib.loads(text)["ropes"][0] == own["ropes"][0]
        elif language == "python":
            capsys.readouterr()
            exec(compile(text, "data_flow.md", "exec"), names)  # noqa: S102
        else:
            assert language == "text"
            assert capsys.readouterr().out == text
            shown.append(text)
    assert len(shown) == 5


def test_the_page_on_inputs_prints_what_it_shows(tmp_path, monkeypatch, capsys):
    """Its case is driven by its Python."""
    monkeypatch.chdir(tmp_path)
    (case,), (python,), (shown,) = (
        [block.text for block in blocks(DOCS / "inputs.md") if block.language == language]
        for language in ("toml", "python", "text")
    )
    (tmp_path / "crane").mkdir()
    (tmp_path / "crane" / "case.toml").write_text(case, encoding="utf-8")
    exec(compile(python, "inputs.md", "exec"), {})  # noqa: S102
    assert capsys.readouterr().out == shown


def test_the_page_on_linearisation_prints_what_it_shows(tmp_path, monkeypatch, capsys):
    """Its commands and its Python run in order."""
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)
    names: dict[str, object] = {}
    said, shown = "", []
    for language, text in blocks(DOCS / "linearisation.md"):
        if language == "sh":
            said, _ = shell(text, folder)
        elif language == "python":
            capsys.readouterr()
            exec(compile(text, "linearisation.md", "exec"), names)  # noqa: S102
            said = capsys.readouterr().out
        else:
            assert text in said
            shown.append(text)
    assert len(shown) == 4


def test_getting_started_ends_with_the_case_that_the_package_brings(tmp_path):
    """The guide and `heavylift new lift` are one scene."""
    text = "\n".join(b.text for b in blocks(DOCS / "getting-started.md") if b.language == "toml")
    guide = tomllib.loads(text)
    brought = tomllib.loads(
        (ROOT / "pipeline" / "templates" / "lift" / "case.toml").read_text(encoding="utf-8")
    )
    del brought["bodies"]["module"]["centre_of_mass"]  # its default
    for key in ("gravity", "bodies", "surfaces", "ropes", "simulate", "title"):
        assert guide[key] == brought[key], key
    ids = {check["id"]: check for check in brought["check"]}
    for check in guide["check"]:
        assert check["quantity"] == ids[check["id"]]["quantity"]


REST = '[simulate]\nstep = "10 ms"\noutput_interval = "0.1 s"\nduration = "1 s"\n'


@functools.cache
def validator():
    """Of the JSON Schema."""
    jsonschema = pytest.importorskip("jsonschema")
    return jsonschema.Draft202012Validator(case_schema())


def pieces(page: str) -> list[str]:
    """Pieces of the case of a page."""
    return [block.text for block in blocks(DOCS / page) if block.language == "toml"]


CASE_PAGES = ("rigging.md", "equipment.md")
COUNTED = [(page, count + 1) for page in CASE_PAGES for count in range(len(pieces(page)))]


@pytest.mark.slow
@pytest.mark.parametrize(("page", "count"), COUNTED)
def test_each_piece_of_a_case_fits_what_stands_before_it(page, count, tmp_path):
    """Valid by the JSON Schema, by the checks of the case, and put together."""
    text = "\n".join(pieces(page)[:count])
    text += "" if "[simulate]" in text else f"\n{REST}"
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    assert [error.message for error in validator().iter_errors(tomllib.loads(text))] == []
    assert scene_errors(load_case(tmp_path)) == []


@pytest.mark.slow
def test_the_case_of_rigging_runs_and_passes(tmp_path):
    (tmp_path / "case.toml").write_text("\n".join(pieces("rigging.md")), encoding="utf-8")
    case = load_case(tmp_path)
    assert run_case(case).outcome is Outcome.COMPLETED
    checks = judged_checks(case, case.output_folder)
    assert [check.id for check in checks if not check.passed] == []
    assert len(checks) == 8
    assert next(check.where for check in checks if check.id == "slings") == "sling_left_1 at 10.3 s"
    judged = judged_criteria(case, case.output_folder)
    assert [one.name for one in judged if not one.passed] == []
    assert len({one.name for one in judged}) == 10


def test_the_case_of_equipment_runs_and_passes(tmp_path):
    (tmp_path / "case.toml").write_text("\n".join(pieces("equipment.md")), encoding="utf-8")
    case = load_case(tmp_path)
    assert run_case(case, stages=("simulate",)).outcome is Outcome.COMPLETED
    checks = judged_checks(case, case.output_folder)
    assert [check.id for check in checks if not check.passed] == []
    assert len(checks) == 6


def test_the_page_on_editors_shows_what_taplo_reads():
    (rule, directive), (setting,) = (
        [block.text for block in blocks(DOCS / "editor.md") if block.language == language]
        for language in ("toml", "json")
    )
    parsed = tomllib.loads(rule)
    assert parsed["rule"][0]["schema"]["path"] == directive.split()[-1] == "./case.schema.json"
    pattern = next(iter(json.loads("{" + setting + "}")["evenBetterToml.schema.associations"]))
    assert re.match(pattern, "/home/me/lift/case.toml")
    assert not re.match(pattern, "/home/me/lift/other.toml")


@pytest.mark.slow
def test_the_road_and_the_transporter_of_the_guide_make_a_scene(tmp_path):
    """The blocks of `transport.md` with a body on them: it stands, and its first steps are made."""
    text = "\n".join(b.text for b in blocks(DOCS / "transport.md") if b.language == "toml")
    body = """
title = "Guide"
gravity = { acceleration = [0, 0, -9.81] }

[bodies.block]
type = "rigid"
mass = "40 t"
inertia = [1e5, 1e5, 1e5]
centre_of_mass = [0, 0, "1.5 m"]
frame = { motion = "free" }

[bodies.barge]
type = "rigid"
mass = "1 t"
inertia = [1e3, 1e3, 1e3]
frame = { motion = "fixed" }

[bodies.frame]
type = "rigid"
mass = "10 t"
inertia = [1e5, 1e5, 1e5]
frame = { motion = "free" }
initial = { position = ["38 m", 0, "1.5 m"] }
"""
    (tmp_path / "survey.csv").write_text(
        "station,offset,height\n60,-5,0\n60,5,0\n70,-5,0\n70,5,0.1\n", encoding="utf-8"
    )
    (tmp_path / "case.toml").write_text(f"{body}\n{text}\n{REST}", encoding="utf-8")
    assert run_case(load_case(tmp_path)).outcome is Outcome.COMPLETED
