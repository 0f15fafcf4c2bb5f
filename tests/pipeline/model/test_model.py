"""Models: built, run, saved, loaded and changed, they are the case that a file would be; errors name line and key."""

from __future__ import annotations

import pickle
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import heavylift as hl
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.model.components import class_of_row
from heavylift.pipeline.model.toml_text import case_text
from heavylift.pipeline.results.provenance import simulate_digest

CASES = Path(__file__).parents[3] / "cases"
ALL = sorted(file.parent.name for file in CASES.glob("*/case.toml"))
SOME = ["hoist", "zoo_loads", "mbs_a02", "irregular_sea", "staged_lift"]
FREE = {"motion": "free"}


def pendulum() -> hl.Model:
    """A mass of 1 kg on a hinge at the origin, 1 m below it; a rope that is slack, and a force on it."""
    model = hl.Model("A pendulum", sources=["none"])
    model.add(hl.Gravity(acceleration=[0, 0, -9.81]))
    model.add(
        hl.RigidBody(
            "bob",
            mass=1.0,
            inertia=np.full(3, 0.1),
            frame=FREE,
            initial={"position": (0.0, 0.0, -1.0)},
        ),
        hl.Hinge("pin", between=["ground", "bob"], at=[0, 0, 0], axis=[0, 1, 0]),
        hl.PointForce(
            "push", body="bob", point=[0, 0, 0], times=[0.0, "0.1 s"], forces=[["1 N", 0, 0], [0, 0, 0]]
        ),
        hl.Rope(
            "line",
            path=[{"body": "ground", "point": [0, 0, 2]}, {"body": "bob", "point": [0, 0, 0]}],
            axial_stiffness="1 kN",
            length="4 m",
        ),
        hl.Simulate(step="10 ms", duration="0.5 s", output_interval="0.1 s"),
    )
    return model


def test_a_model_runs_as_the_case_that_it_saves_and_as_the_model_that_is_loaded_from_it(tmp_path):
    model = pendulum()
    run = model.run()
    assert run.completed
    folder = run.out
    assert folder.is_dir()
    file = model.save(tmp_path / "case")
    hl.run_case(load_case(file), stages=("simulate",))
    saved = hl.load_results(tmp_path / "case")
    loaded = hl.load(file)
    again = loaded.run(out=tmp_path / "kept")
    assert loaded.document == model.document == tomllib.loads(file.read_text(encoding="utf-8"))
    for name in saved:
        assert run[name].tobytes() == saved[name].tobytes() == again[name].tobytes(), name
    # it is pushed by 0.05 N s at 1 m below the pin: I = 1.1 kg m^2, so 0.045 rad/s, and swings
    assert 0.005 < run["bob.position"][-1, 0] < 0.02
    assert again.out == tmp_path / "kept"
    del run
    assert not folder.exists()


@pytest.mark.parametrize(
    "name", [*SOME, *(pytest.param(one, marks=pytest.mark.slow) for one in ALL if one not in SOME)]
)
def test_a_case_made_of_components_and_saved_is_the_case(name, tmp_path):
    """Text for people, and the digest of all that the histories depend on, files included."""
    loaded = hl.load(CASES / name)
    made = hl.Model(loaded.title, folder=loaded.folder)
    for component in loaded:
        keys = dict(component._row)
        first = component._own_name if component.TABLE.form == "named" or component.TABLE.label else None
        if component.TABLE.label:
            keys.pop(component.TABLE.label)
        made.add(type(component)(*([first] if first is not None else []), **keys))
    rest = {key: loaded.document[key] for key in ("sources", "parameters") if key in loaded.document}
    assert {**made.document, **rest} == loaded.document
    for key, value in rest.items():
        made._document[key] = value
    assert tomllib.loads(case_text(made.document)) == loaded.document
    file = made.save(tmp_path / "copy")
    assert simulate_digest(load_case(file)) == simulate_digest(load_case(CASES / name))


def test_a_loaded_case_that_is_saved_unchanged_is_the_same_text(tmp_path):
    file = hl.load(CASES / "hoist").save(tmp_path)
    assert file.read_bytes() == (CASES / "hoist" / "case.toml").read_bytes()
    assert (tmp_path / "reference.csv").is_file()


def test_changes_keep_comments_and_are_those_of_the_command_line(tmp_path):
    model = hl.load(CASES / "hoist")
    model.set("ropes.fall.length", "101 m")
    model.set("simulate.step", 0.02)
    model["load"].mass = "999 t"
    model.remove("rise")
    model.set("converge", None)
    model.add(hl.Sensor("corner", body="load", point=[1, 0, 0]))
    file = model.save(tmp_path)
    text = file.read_text(encoding="utf-8")
    assert "# 100 m in one rope about the sheave; the winch takes 0.1 m/s" in text
    assert "# what the crane that hangs the fall must fulfil" in text
    other = load_case(
        CASES / "hoist", ["ropes.0.length=101 m", "simulate.step=0.02", "bodies.load.mass=999 t"]
    )
    saved = load_case(file)
    assert saved.ropes == other.ropes
    assert saved.bodies == other.bodies
    assert saved.simulate == other.simulate
    assert [one.name for one in saved.criteria] == [one.name for one in other.criteria if one.name != "rise"]
    assert [one.name for one in saved.sensors] == ["corner"]
    assert saved.converge is None


def test_what_python_takes_for_equal_is_written_as_it_is(tmp_path):
    model = hl.load(CASES / "hoist")
    assert model.document["converge"]["relative"] is False
    model.set("converge.relative", 0)
    model.set("check.error.reference", 0)  # was 0.0
    file = model.save(tmp_path)
    text = file.read_text(encoding="utf-8")
    assert "relative = 0\n" in text
    assert "reference = 0\n" in text
    assert repr(hl.load(file).document) == repr(model.document)


def test_what_a_program_changed_of_a_case_is_told_with_its_line():
    model = hl.load(CASES / "hoist")
    model["load"].frame = {"motion": "fixed"}
    model.set("ropes.fall.path.1.body", "laod")
    model.remove("reference.tension")
    lines = message(model.case).splitlines()
    assert re.match(r"test_model.py:\d+: Rope\('fall'\).path.1.body: body 'laod' does not exist", lines[0])
    assert str(CASES / "hoist" / "case.toml") in lines[1]  # a check of the history that is gone


def test_errors_of_the_start_are_told_with_the_line_too():
    model = pendulum()
    model["line"].length = "2 m"
    for run in (model.run, lambda: hl.Simulation(model)):
        assert re.match(r"test_model.py:\d+: Rope\('line'\).length: .*shorter", message(run))


def test_entries_of_lists_are_set_by_name_on_the_command_line_too():
    case = load_case(CASES / "hoist", ["ropes.fall.length=101 m", "check.error.reference=1"])
    assert case.ropes[0].length == 101.0
    assert case.check[0].reference == 1.0
    with pytest.raises(
        hl.InputError,
        match=r"ropes.fal does not exist; did you mean 'fall'\?; expected an index from 0 to 0, or",
    ):
        load_case(CASES / "hoist", ["ropes.fal.length=101 m"])


def test_components_are_found_changed_and_taken_out():
    model = pendulum()
    assert [one._own_name for one in model] == ["bob", None, "pin", "line", "push", None]
    assert "bob" in model
    assert "rope" not in model
    assert model["line"] is model["ropes.line"] is model["ropes.0"]
    assert model["simulate"].step == "10 ms"
    assert model["line"].damping == 0.0  # the default of a case
    assert model["line"].winch is None
    twin = model.copy()
    twin["line"].length = 3.0
    assert (model["line"].length, twin["line"].length) == ("4 m", 3.0)
    found = model.remove("line")
    assert "line" not in model
    assert "ropes" not in model.document
    found.length = "5 m"
    assert twin["line"].length == 3.0
    assert model.add(found) is found
    other = hl.Model("Another")
    assert other.add(found) is not found  # a copy, since it is in a model
    with pytest.raises(
        hl.InputError,
        match=r"test_model.py:\d+: 'lines' does not exist; did you mean 'line'\?; expected one of: bob, gravity, pin",
    ):
        model["lines"]


def message(call) -> str:
    """What is wrong."""
    with pytest.raises(hl.InputError) as caught:
        call()
    return str(caught.value)


BAD = [
    ({"masss": 1.0}, r"RigidBody\('b'\).masss: unknown key; did you mean 'mass'\?"),
    ({"mass": "1 m"}, r"RigidBody\('b'\).mass: '1 m' is a length; expected a mass"),
    ({"mass": float("nan")}, r"RigidBody\('b'\).mass: nan"),
    ({"mass": None}, r"RigidBody\('b'\).mass: is missing"),
    ({"mass": -1.0}, r"RigidBody\('b'\).mass: -1.0"),
    (
        {"mass": object()},
        r"RigidBody\('b'\).mass: <object object at .*> is a object; expected a number, a text, a list",
    ),
    ({"frame": {"motion": "fre"}}, r"RigidBody\('b'\).frame: motion = 'fre'; expected one of"),
]


@pytest.mark.parametrize(("change", "expected"), BAD)
def test_a_wrong_key_is_told_where_it_is_written(change, expected):
    keys = {"mass": 1.0, "inertia": [1, 1, 1], "frame": FREE, **change}
    text = message(lambda: hl.RigidBody("b", **keys))
    assert re.match(rf"test_model.py:\d+: {expected}", text), text


def test_what_does_not_fit_together_is_told_at_the_lines_that_wrote_it():
    model = pendulum()
    text = message(lambda: model.add(hl.RigidBody("pin", mass=1.0, inertia=[1, 1, 1], frame=FREE)))
    assert "RigidBody('pin'): 'pin' is the name of a Hinge already, of test_model.py:" in text
    assert "already" in message(lambda: model.add(hl.Gravity(acceleration=[0, 0, 0])))
    for foreign in (3, {"name": "a"}, hl.RigidBody, "rope"):
        assert "expected a component such as heavylift.RigidBody" in message(
            lambda foreign=foreign: model.add(foreign)
        )
    hinge = hl.Hinge("other", between=["bob", "bab"], at=[0, 0, 0], axis=[0, 1, 0])
    model.add(hinge, hl.Sensor("tip", body="bib", point=[0, 0, 0]))
    lines = message(model.case).splitlines()
    assert len(lines) == 2
    assert all("test_model.py:" in line and "did you mean 'bob'?" in line for line in lines)
    assert "Hinge('other').between.1: body 'bab' does not exist" in lines[0]
    assert "Sensor('tip').body: body 'bib' does not exist" in lines[1]
    nothing = message(hl.Model("Nothing").case)
    assert "Model('Nothing'): bodies: is missing" in nothing


def test_a_change_that_is_wrong_changes_nothing():
    model = pendulum()
    before = model.document
    bob, line = model["bob"], model["line"]
    for key, value in (
        ("ropes.line.lenght", 3.0),
        ("ropes.line.length", "3 s"),
        ("ropes.rope.length", 3.0),
        ("simulate.step", object()),
        ("simulate.step.part", 1),
        ("gravity", 9.81),
    ):
        assert re.match(r"test_model.py:\d+: ", message(lambda key=key, value=value: model.set(key, value)))
    for key, value in (("mass", "1 m"), ("mas", 1.0), ("mass", None), ("name", "other")):
        assert re.match(
            r"test_model.py:\d+: ", message(lambda key=key, value=value: setattr(bob, key, value))
        )
    assert model.document == before
    assert (bob.mass, line.length) == (1.0, "4 m")
    with pytest.raises(AttributeError, match="did you mean 'mass'"):
        _ = bob.mas


def test_a_case_that_is_there_is_replaced_only_if_that_is_wanted(tmp_path):
    model = pendulum()
    file = model.save(tmp_path)
    model.set("simulate.duration", "1 s")
    assert "is there already; expected another folder, or overwrite=True" in message(
        lambda: model.save(tmp_path)
    )
    assert "0.5 s" in file.read_text(encoding="utf-8")
    assert model.save(tmp_path, overwrite=True) == file
    assert load_case(file).simulate.duration == 1.0
    (tmp_path / "a_file").write_text("", encoding="utf-8")
    assert "expected a folder that can be written" in message(
        lambda: model.save(tmp_path / "a_file" / "case")
    )


def test_a_file_that_is_missing_is_told(tmp_path):
    model = hl.Model("A surface", folder=tmp_path)
    model.add(hl.RigidBody("b", mass=1.0, inertia=[1, 1, 1], frame=FREE))
    model.add(hl.Surface("s", body="b", file="no.stl"))
    assert "Surface('s').file: file 'no.stl' does not exist" in message(model.case)
    assert "Surface('s').file" in message(lambda: model.save(tmp_path / "case"))
    assert not (tmp_path / "case").exists()
    with pytest.raises(hl.InputError, match="does not exist"):
        hl.load(tmp_path / "nowhere")
    (tmp_path / "no.stl").write_text("no triangles", encoding="utf-8")
    model.add(hl.Simulate(step="10 ms", duration="1 s", output_interval="0.1 s"))
    assert "Surface('s').file: no.stl: contains no triangle" in message(model.run)


def test_a_model_without_a_run_has_no_records_but_a_verdict():
    model = pendulum()
    model.remove("simulate")
    run = model.run()
    assert (run.completed, len(run.time), run.names) == (True, 0, ())
    assert "there are no records" in message(run.page)


def test_every_row_of_a_table_has_its_class():
    for name, row in (
        ("joints", {"type": "hinge"}),
        ("ropes", {}),
        ("forces", {"type": "tugger"}),
        ("bodies", {"type": "rod"}),
    ):
        made = class_of_row(name, row)
        word = row.get("type", "wire")
        assert made.SECTION.model_fields["type"].default == word or word in str(
            made.SECTION.model_fields["type"].annotation
        )


def test_a_component_is_renamed_with_all_that_names_it():
    model = hl.load(CASES / "hoist")
    fall = model["fall"]
    assert model.rename("fall", "hoist") is fall
    model.rename("load", "module")
    case = model.case()
    assert list(case.bodies) == ["module"]
    assert case.ropes[0].path[1].body == "module"
    assert [one.channel for one in case.reference] == ["module.position", "hoist.tension"]
    assert model.document["criteria"][0]["load"] == "hoist.tension"
    assert model.document["criteria"][0]["fall"] == "hoist"
    assert model.document["criteria"][4]["quantity"] == "channel.module.position.z.rate"
    assert model["reference.load"].channel == "module.position"
    before = model.document
    for new, words in (("hoist", "is the name of a Rope already"), ("a b", "letters, digits")):
        assert words in message(lambda new=new: model.rename("module", new))
    assert model.document == before
    assert "has no name" in message(lambda: model.rename("simulate", "other"))


def test_what_equipment_writes_is_renamed_with_it():
    model = hl.load(CASES / "floating_crane_lift")
    model.rename("crane", "lifter")
    model.rename("hull", "barge")
    case = model.case()
    assert "lifter_boom" in case.bodies
    assert list(case.hulls) == ["barge"]
    assert case.criteria[0].reach.tip.body == "lifter_boom"
    assert "lifter_hook_1_rope" in {rope.name for rope in case.ropes}


def test_a_model_goes_through_a_pickle_with_its_components():
    model = pendulum()
    other = pickle.loads(pickle.dumps(model))  # noqa: S301
    assert other.document == model.document
    assert type(other["line"]) is hl.Rope
    other["line"].length = "5 m"
    assert (other.case().ropes[0].length, model["line"].length) == (5.0, "4 m")
    assert "test_model.py:" in message(lambda: other.add(hl.Sensor("line", body="bob", point=[0, 0, 0])))
    other.add(hl.Sensor("a", body="no", point=[0, 0, 0]), hl.Sensor("b", body="none", point=[0, 0, 0]))
    with pytest.raises(hl.InputError) as caught:
        other.case()
    assert len(str(caught.value).splitlines()) == 2
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)  # noqa: S301
