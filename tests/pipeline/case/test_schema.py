"""The JSON Schema for editors: it takes what the project takes and refuses what the project refuses."""

from __future__ import annotations

import copy
import functools
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.schema import case_schema, key_pages, key_tables, section_tables

jsonschema = pytest.importorskip("jsonschema")

FOLDER = Path(__file__).parents[1]
FILES = [
    *sorted((FOLDER.parents[1] / "cases").glob("*/case.toml")),
    FOLDER / "small_beam.toml",
    FOLDER / "linkage.toml",
    FOLDER / "contacts.toml",
]


@functools.cache
def validator() -> Any:
    """Validator of case files."""
    schema = case_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def document(file: Path = FOLDER / "small_beam.toml", **changes: Any) -> dict[str, Any]:
    """A case file with some values changed; ``__`` parts the keys."""
    result = copy.deepcopy(tomllib.loads(file.read_text(encoding="utf-8")))
    for path, value in changes.items():
        *above, last = (int(key) if key.isdecimal() else key for key in path.split("__"))
        node: Any = result
        for key in above:
            node = node[key]
        node[last] = value
    return result


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES, ids=lambda file: f"{file.parent.name}/{file.name}")
def test_every_case_of_the_project_is_valid(file):
    assert [error.message for error in validator().iter_errors(document(file))] == []


GOOD = [
    {"bodies__beam__initial__modal_position": ["1 mm", 0.0]},
    {"bodies__beam__modes__damping_ratio": 0.01},
    {"bodies__beam__modes__damping_ratio": [0.01, "2 %", 0]},
    {"check__0__reference": 0.312},
    {"check__0__tolerance": {"absolute": "1 mg"}},
    {"check__0": {"id": "m", "quantity": "mesh.beam.mass", "maximum": "1 kg"}},
    {"check__0": {"id": "m", "quantity": "mesh.*.mass", "maximum": 1.0, "minimum": 0, "source": "crane"}},
    {"report__channels": ["tip.position", "ti*.position", "difference(tip.position, tip.position)"]},
    {"converge__reference": {"run": "0.5 us"}},
    {"converge__reference": "50 Hz"},
    {"gravity": {"acceleration": [0, 0, "-9.81 m/s^2"]}},
]
BAD = [
    {"bodies__beam__material__densty": "7800 kg/m^3"},
    {"bodies__beam__material__density": True},
    {"bodies__beam__material__density": "steel"},
    {"bodies__beam__material__density": -7800},
    {"bodies__beam__modes__count": "3"},
    {"bodies__beam__modes__damping_ratio": "high"},
    {"bodies__beam__initial__modal_velocity": "0.1 m/s"},
    {"bodies__beam__initial__modal_velocity": [True]},
    {"bodies__beam__initial__modal_velocity": ["fast"]},
    {"bodies__beam__frame__motion": "loose"},
    {"bodies__beam__geometry__add": []},
    {"check__0__reference": True},
    {"check__0__reference": "heavy"},
    {"check__0__reference": {"run": 1}},
    {"check__1__reference": {"quantty": "modes.beam.frequency.1"}},
    {"check__0__tolerance": {"absolute": True}},
    {"check__0__tolerance": {"absolute": -1.0}},
    {"check__0__tolerance": {"relative": 1.0}},
    {"check__0__source": ""},
    {"check__0__maximum": "1 kg"},
    {"check__0": {"id": "m", "quantity": "mesh.beam.mass"}},
    {"check__0": {"id": "m", "quantity": "mesh.beam.mass", "minimum": "light"}},
    {"check__0": {"id": "m", "quantity": "mesh.beam.mass", "maximum": 1, "tolerance": {"relative": 0.1}}},
    {"check__0": {"id": "m", "quantity": "mesh.beam.mass", "reference": 1, "source": "scales"}},
    {"simulate__integrator": "euler"},
    {"title": 3},
]


@pytest.mark.parametrize("changes", GOOD, ids=str)
def test_what_a_case_may_hold_is_valid(changes):
    assert [error.message for error in validator().iter_errors(document(**changes))] == []


@pytest.mark.parametrize("changes", BAD, ids=str)
def test_what_a_case_may_not_hold_is_invalid(changes):
    assert not validator().is_valid(document(**changes))


def test_a_missing_key_is_invalid():
    case = document()
    del case["simulate"]["step"]
    assert not validator().is_valid(case)


LINKAGE = FOLDER / "linkage.toml"


@pytest.mark.parametrize(
    "changes",
    [
        {"joints__0__limits__lower": -0.5},
        {"joints__0__compliance": "1e-9 rad/(N m)"},
        {"forces__0__type": "point"},
        {"ropes__0__type": "wire"},
        {"simulate": {"integrator": "accurate", "output_interval": 0.1, "duration": 1}},
        {"simulate": {"tolerance": 1e-5, "output_interval": 0.1, "duration": 1, "start": "project"}},
        {"parameters": {"n": 3}, "repeat": [{"count": "n + 1", "bodies": {"link_{i}": {}}}]},
        {
            "converge": {
                "quantity": "drift.energy",
                "reference": 0,
                "series": [{"name": "a", "parameter": "simulate.step", "values": [1], "set": {"a.b": ""}}],
            }
        },
    ],
    ids=str,
)
def test_joints_and_series_are_valid(changes):
    assert [error.message for error in validator().iter_errors(document(LINKAGE, **changes))] == []


@pytest.mark.parametrize(
    "changes",
    [
        {"joints__0__type": "hing"},
        {"joints__0__between": ["arm"]},
        {"joints__0__friction": -1},
        {"joints__2__at": [0, 0, 0]},
        {"ropes__0__axial_stiffness": 0},
        {"ropes__0__path": []},
        {"forces__1__stiffness": -1},
        {"simulate": {"output_interval": 0.1, "duration": 1}},
        {"simulate": {"integrator": "thesis", "output_interval": 0.1, "duration": 1}},
        {"converge": {"quantity": "drift.energy", "reference": 0}},
        {"repeat": [{"bodies": {}}]},
    ],
    ids=str,
)
def test_wrong_joints_and_series_are_invalid(changes):
    assert not validator().is_valid(document(LINKAGE, **changes))


CONTACTS = FOLDER / "contacts.toml"


@pytest.mark.parametrize(
    "changes",
    [
        {"contours__floor__degree": 5},
        {"contours__floor__degree": [3, 7]},
        {"contours__floor__closed": False},
        {"contours__floor__closed": [True, False]},
        {"contacts__3__stiffness": "1 N/mm^1.5"},
        {"contacts__3__exponent": 2},
        {"contacts__0__shape": {"type": "box", "size": [1, 1, 1], "rounding": "1 mm"}},
    ],
    ids=str,
)
def test_contacts_are_valid(changes):
    assert [error.message for error in validator().iter_errors(document(CONTACTS, **changes))] == []


@pytest.mark.parametrize(
    "changes",
    [
        {"contours__floor__degree": 2},
        {"contours__skid__degree": 2},
        {"contours__floor__degree": [3, 2]},
        {"contours__floor__type": "plane"},
        {"contours__cable__radius": 0},
        {"contours__rail__radius": 1},
        {"contacts__0__law": "rgid"},
        {"contacts__0__restitution": 2},
        {"contacts__0__damping": 1},
        {"contacts__0__friction": -0.1},
        {"contacts__0__shape__axis": [1, 0, 0]},
        {"contacts__0__between": ["ball"]},
    ],
    ids=str,
)
def test_bad_contacts_are_invalid(changes):
    assert not validator().is_valid(document(CONTACTS, **changes))


def test_the_tables_of_keys_in_the_docs_are_those_of_the_schema():
    folder = Path(__file__).parents[3] / "docs" / "case_keys"
    written = {file.name: file.read_text(encoding="utf-8") for file in folder.iterdir()}
    assert written == key_pages(), "heavylift schema --tables --out docs/case_keys; `git rm` what is gone"


def test_pages_have_all_tables_once_and_links_lead_to_them():
    pages = key_pages()
    places = {
        (name, heading_anchor(line))
        for name, page in pages.items()
        for line in page.splitlines()
        if line.startswith("## ")
    }
    tables = [line for line in key_tables().splitlines() if line.startswith("## ")]
    paged = [line for page in pages.values() for line in page.splitlines() if line.startswith("## ")]
    assert sorted(paged) == sorted(line for line in tables if "Channels of the whole scene" not in line)
    links = [
        (other or name, anchor)
        for name, page in pages.items()
        for other, anchor in re.findall(r"\]\(([\w.]*)#([^)]+)\)", page)
    ]
    assert len(links) > 200
    assert not set(links) - places
    assert "(ropes.md#ropes-type--wire)" in pages["README.md"]
    assert "`energy.kinetic`" in pages["channels.md"]


def heading_anchor(line):
    """As Markdown viewers make it from a heading."""
    return re.sub(r"[^\w-]", "", line.removeprefix("## ").lower().replace(" ", "-"))


def test_every_section_has_a_table_of_its_own_with_a_sentence_for_each_key():
    text = key_tables()
    headings = [line for line in text.splitlines() if line.startswith("## ")]
    assert len(headings) == len(set(headings)) > 100
    silent = [line for line in text.splitlines() if line.startswith("| `") and line.endswith("|  |")]
    assert {line.split("`")[1] for line in silent} <= {"type", "motion", "law"}


def test_a_joint_brings_its_keys_and_channels():
    text = key_tables()
    screw = text[text.index('## joints, type = "screw"') :].partition("\n## ")[0]
    assert (
        "| `lead` | length [m] |  | Travel a turn [m], not zero; positive for a right-handed thread. |"
        in screw
    )
    assert "| `NAME.thread_force` | N |" in screw


def test_channels_stand_below_what_records_them():
    text = key_tables()
    hit = text[text.index('## collisions, law = "rigid"') :].partition("\n## ")[0]
    assert "| `NAME.force` | N | `x`, `y`, `z` | force on the second surface, world axes |" in hit
    assert "| `NAME.contact_1.force` | N |  | force of the contact along its normal |" in hit
    beam = text[text.index('## bodies.NAME, type = "frame"') :].partition("\n## ")[0]
    assert "| `NAME.bending_moment` | N m | several | bending moment at both ends of every element |" in beam
    assert "| `energy.kinetic` | J |" in text


SECTION = section_tables("ropes", 100)


def test_a_section_shows_what_the_docs_say_of_its_keys():
    """The terminal and docs/case_keys have the same keys, quantities, defaults and sentences."""
    shown = " ".join(SECTION.split())
    for text in (
        'ropes, type = "wire" A wire rope through any number of points',
        "axial_stiffness force [N] > 0; needed EA [N]: modulus times area.",
        "length length [m] > 0 Unstretched length at the start [m]; the initial geometric length if absent.",
        "ropes.winch How a winch hauls in",
        "NAME.segment_tension",
    ):
        assert text in shown, text
    table = key_tables()
    for heading in ("## ropes.path", "## ropes.winch"):
        keys = re.findall(r"^\| `(\w+)` ", table.partition(heading)[2].partition("\n## ")[0], re.MULTILINE)
        assert keys
        part = SECTION.partition(f"\n{heading[3:]}\n")[2]
        assert [key for key in keys if not re.search(rf"^  {key} ", part, re.MULTILINE)] == []


@pytest.mark.parametrize("width", [72, 100, 140])
def test_a_section_fits_the_terminal(width):
    for name in ("ropes", "bodies", "joints", "sea", "simulate", "case"):
        assert max(map(len, section_tables(name, width).splitlines())) <= width, name


def test_sections_are_found_by_short_and_by_full_names():
    hinge = section_tables("joints.hinge", 100)
    assert hinge.startswith('joints, type = "hinge"')
    assert 'type = "slider"\n' not in hinge.partition("joints.limits")[0]
    assert section_tables("bodies.NAME.mesh", 100) == section_tables("bodies.mesh", 100)
    assert section_tables("case.toml", 100) == section_tables("case", 100)


@pytest.mark.slow
def test_an_unknown_section_is_one_line_with_all_of_them():
    with pytest.raises(InputError) as caught:
        section_tables("rops", 100)
    line = str(caught.value)
    assert "\n" not in line
    assert line.startswith("schema: section: 'rops', perhaps 'ropes'; expected one of case, ")
    tables = set(case_schema()["properties"]) - {"title", "sources", "parameters"}
    assert tables <= set(line.partition("expected one of ")[2].split(", "))


def test_links_of_the_guides_to_pages_of_keys_lead_somewhere():
    root = Path(__file__).parents[3]
    pages = key_pages()
    found = [
        link
        for file in (*sorted((root / "docs").glob("*.md")), root / "README.md")
        for link in re.findall(r"\]\((?:docs/)?case_keys/([\w.]+)(?:#([^)]+))?\)", file.read_text("utf-8"))
    ]
    assert len(found) > 10
    for page, anchor in found:
        headings = {heading_anchor(line) for line in pages[page].splitlines() if line.startswith("## ")}
        assert not anchor or anchor in headings, (page, anchor)


@pytest.mark.slow
def test_pages_are_written_with_tables_alone(tmp_path, heavylift):
    assert heavylift("schema", "--tables", "--out", tmp_path / "keys").code == 0
    assert (tmp_path / "keys" / "README.md").read_text("utf-8") == key_pages()["README.md"]
    (tmp_path / "file").write_text("")
    for words in (("--out", tmp_path / "x"), ("ropes", "--tables", "--out", tmp_path / "x")):
        run = heavylift("schema", *words)
        assert run.code == 2
        assert "--out" in run.stderr
    assert heavylift("schema", "--tables", "--out", tmp_path / "file").code == 2
