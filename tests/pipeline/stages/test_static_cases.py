"""Supports and static load cases of a case file: what arrives in the model, what checks and reports say of it."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, InputErrors, Outcome
from heavylift.pipeline import load_case
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.report.bodies import _static_table
from heavylift.pipeline.results.model_io import read_model, read_states
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.stages import run_case

E, NU, RHO = 2.1e11, 0.3, 7850.0

CASE = f"""
title = "A bar that is pulled"

[bodies.bar]
type = "flexible"
material = {{ young_modulus = {E}, poisson_ratio = {NU}, density = {RHO} }}
mesh = {{ element = "hex8", divisions = {{ x = [6], y = [2], z = [2] }} }}
modes = {{ count = 2 }}
frame = {{ motion = "fixed" }}
supports = [
    {{ symmetry = "x" }},
    {{ on = "side", fixed = "y" }},
    {{ from = [0, 0, 0], to = [3, 1, 0], fixed = "z" }},
]

[[bodies.bar.static]]
name = "pull"
loads = [{{ on = "end", pressure = "-2 MPa" }}]

[[bodies.bar.static]]
name = "force"
loads = [{{ on = ["end"], force = ["1 MN", 0, 0] }}, {{ on = "end", traction = ["1 MPa", 0, 0] }}]

[[bodies.bar.static]]
name = "pushed"
loads = [{{ acceleration = ["10 m/s^2", 0, 0] }}]

[bodies.bar.geometry]
type = "blocks"
add = [{{ name = "bar", from = [0, 0, 0], to = [3, 1, 0.5] }}]
groups = {{ side = {{ plane = "y", at = 0 }}, end = {{ plane = "x", at = 3 }} }}

[[sensors]]
name = "tip"
body = "bar"
point = [3, 0.3, 0.2]

[[sensors]]
name = "middle"
body = "bar"
point = [1.7, 0.3, 0.2]
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    return tmp_path


@pytest.fixture
def quantities(folder):
    case = load_case(folder)
    assert run_case(case, stages=("mesh", "modes")).outcome is Outcome.COMPLETED
    return Quantities(case, case.output_folder)


def test_load_cases_have_the_stress_displacement_and_reaction_of_a_bar(quantities):
    number = quantities.number
    assert number("static.bar.pull.stress.middle.xx") == pytest.approx(2e6, rel=1e-9)
    assert number("static.bar.pull.von_mises") == pytest.approx(2e6, rel=1e-9)
    assert number("static.bar.pull.displacement.tip.x") == pytest.approx(2e6 / E * 3.0, rel=1e-9)
    assert number("static.bar.pull.displacement.middle.y") == pytest.approx(-NU * 2e6 / E * 0.3, rel=1e-9)
    assert number("static.bar.pull.reaction.x") == pytest.approx(-2e6 * 0.5, rel=1e-9)
    # 1 MN over 0.5 m2 and 1 MPa
    assert number("static.bar.force.stress.tip.von_mises") == pytest.approx(3e6, rel=1e-9)
    # pushed along x against the plane x = 0: by its mass, and stress by what is beyond
    assert number("static.bar.pushed.reaction.x") == pytest.approx(-RHO * 1.5 * 10.0, rel=1e-9)
    assert number("static.bar.pushed.stress.middle.xx") == pytest.approx(RHO * 10.0 * 1.3, rel=0.02)


def test_natural_frequencies_have_the_same_supports(quantities):
    """The first symmetric stretching mode of a free bar of twice the length: a quarter wave, but for contraction."""
    from heavylift.pipeline.results.model_io import read_reduced

    reduced = read_reduced(OutputFolder(quantities._case.output_folder).reduced("bar"))
    shapes, nodes = reduced.mode_shapes, reduced.nodes
    assert not shapes[:, nodes[:, 0] == 0.0, 0].any()
    assert not shapes[:, nodes[:, 1] == 0.0, 1].any()
    assert not shapes[:, nodes[:, 2] == 0.0, 2].any()
    assert quantities.number("modes.bar.frequency.1") == pytest.approx(np.sqrt(E / RHO) / 12.0, rel=0.03)


def test_a_changed_load_makes_the_states_anew(folder):
    run_case(load_case(folder), stages=("mesh", "modes"))
    case = load_case(folder, ["bodies.bar.static.0.loads.0.pressure=-4 MPa"])
    report = run_case(case, stages=("mesh", "modes"))
    assert [stage.skipped for stage in report.stages] == [True, False]
    states = read_states(OutputFolder(case.output_folder).reduced("bar"))
    assert list(states) == ["force", "pull", "pushed"]
    assert states["pull"].reaction[0] == pytest.approx(-2e6, rel=1e-9)


@pytest.mark.slow
def test_report_shows_supports_and_load_cases(folder):
    case = load_case(folder)
    report = run_case(case)
    assert report.outcome is Outcome.COMPLETED
    text = (report.folder.root / "report" / "report.md").read_text()
    for words in (
        "symmetry, x = 0 m",
        "side: y held",
        "from (0, 0, 0) m to (3, 1, 0) m: z held",
        "pressure -2 MPa on end",
        "acceleration (10, 0, 0) m/s² ",
        "(-1, ",
    ):
        assert words in text, words
    if list((report.folder.root / "report").glob("*.png")):
        assert (report.folder.root / "report" / "bar_stress_static_pull.png").is_file()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            'bodies.bar.supports.1.on="sides"',
            r"supports\.1\.on: group 'sides' does not exist; did you mean 'side'",
        ),
        (
            'bodies.bar.static.0.loads.0.on=["endd"]',
            r"static\.0\.loads\.0\.on\.0: group 'endd' does not exist",
        ),
        ('bodies.bar.supports.1.fixed="a"', "fixed"),
        ("bodies.bar.supports.1.fixed=", "neither 'fixed' nor 'symmetry'"),
        ('bodies.bar.supports.0={symmetry="x", on="side"}', "'symmetry' with a group or box"),
        ('bodies.bar.supports.0={fixed="x"}', "'fixed' without a place"),
        ('bodies.bar.supports.0={on="side", fixed="x", at=1}', "'at' without 'symmetry'"),
        ('bodies.bar.supports.0={from=[0,0,0], fixed="x"}', "'from' without 'to'"),
        ('bodies.bar.supports.0={from=[1,0,0], to=[0,1,1], fixed="x"}', "no smaller than 'from'"),
        ('bodies.bar.static.0.loads.0={on="end"}', "no load"),
        (
            'bodies.bar.static.0.loads.0={on="end", pressure=1, force=[1,0,0]}',
            "'pressure' and 'force' together",
        ),
        ("bodies.bar.static.0.loads.0={pressure=1}", "'pressure' without a place"),
        ('bodies.bar.static.0.loads.0={on="end", acceleration=[1,0,0]}', "it acts on all of the body"),
        ("bodies.bar.static.0.loads=[]", "loads"),
        ('bodies.bar.static.1.name="pull"', "load case 'pull' occurs 2 times"),
        ('bodies.bar.frame.motion="free"', "supports: holds nodes of a body whose frame is free"),
    ],
)
def test_contradictions_are_told_with_key_and_remedy(folder, change, message):
    with pytest.raises(InputErrors, match=message):
        load_case(folder, [change])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("bodies.bar.supports.0.at=-1", r"supports\.0: no node in the plane x = -1 m"),
        ("bodies.bar.supports.0.at=1.5", r"supports\.0: the body is on both sides of the plane x = 1\.5 m"),
        (
            'bodies.bar.supports.0={from=[5,5,5], to=[6,6,6], fixed="x"}',
            r"supports\.0: none of .* in the box",
        ),
        ('bodies.bar.supports=[{symmetry="y"}]', r"static\.0: the supports leave 3 rigid motion"),
        (
            "bodies.bar.static.0.loads.0={from=[0,0,0], to=[3,0,0], pressure=1}",
            r"static\.0\.loads\.0: .* make up no outer face",
        ),
    ],
)
def test_what_only_the_mesh_shows_is_told_with_its_key(folder, change, message):
    with pytest.raises(InputError, match=message):
        run_case(load_case(folder, [change]), stages=("mesh", "modes"))


@pytest.mark.parametrize(
    ("quantity", "message"),
    [
        ("static.bar.pull.stress.tip.yx", "COMPONENT one of von_mises, xx, yy, zz, xy"),
        ("static.bar.pull.stress.nowhere.xx", "'nowhere' is no sensor on 'bar'"),
        ("static.bar.push.von_mises", "one of the static load cases of 'bar': pull, force, pushed"),
        ("static.bar.pull.von_mises.max", "static.BODY.CASE.von_mises"),
        ("static.beam.pull.von_mises", "'beam', which does not exist"),
    ],
)
def test_unknown_quantities_are_refused_with_what_there_is(folder, quantity, message):
    check = f'[[check]]\nid = "a"\nquantity = "{quantity}"\nreference = 0\n'
    check += 'tolerance = { absolute = 1 }\nsource = "b"\n'
    (folder / "case.toml").write_text(CASE + check)
    with pytest.raises(InputErrors, match=message):
        load_case(folder)


def test_a_group_held_in_all_directions_is_a_clamp(small_case):
    """Frequencies and a simulation of the same beam, to the last bit."""
    from heavylift.pipeline.results.histories import load_results

    short = "simulate.duration=1 ms"
    supported = ["bodies.beam.modes.clamp=", 'bodies.beam.supports=[{on="root", fixed="xyz"}]']
    histories = []
    for number, changes in enumerate(([], supported)):
        case, out = load_case(small_case, [short, *changes]), small_case / f"out_{number}"
        assert run_case(case, out=out, stages=("mesh", "modes", "simulate")).outcome is Outcome.COMPLETED
        histories.append(load_results(case, out)["beam.modal_position"])
    np.testing.assert_array_equal(*histories)


def test_a_free_body_bears_loads_that_are_in_balance(folder):
    """Pulled at both ends: stress by force and area, no reaction."""
    both = '[{on="end", pressure=-2e6}, {from=[0,0,0], to=[0,1,1], pressure=-2e6}]'
    free = ["bodies.bar.supports=", "bodies.bar.frame.motion=free", "bodies.bar.static.1.loads=" + both]
    case = load_case(
        folder, [*free, "bodies.bar.static.0.loads=" + both, "bodies.bar.static.2.loads=" + both]
    )
    assert run_case(case, stages=("mesh", "modes")).outcome is Outcome.COMPLETED
    quantities = Quantities(case, case.output_folder)
    assert quantities.number("static.bar.pull.stress.middle.xx") == pytest.approx(2e6, rel=1e-8)
    assert quantities.number("static.bar.pull.von_mises") == pytest.approx(2e6, rel=1e-8)
    assert abs(quantities.number("static.bar.pull.reaction.x")) < 1e-3


COLUMN = f"""
title = "A column"

[bodies.column]
type = "flexible"
material = {{ young_modulus = {E}, poisson_ratio = 0, density = {RHO} }}
mesh = {{ element = "hex8", divisions = {{ x = [20], y = [2], z = [2] }} }}
modes = {{ count = 2, clamp = ["root"] }}
frame = {{ motion = "fixed" }}
static = [
    {{ name = "push", buckling = true, loads = [{{ on = "tip", force = ["-1 kN", 0, 0] }}] }},
    {{ name = "plain", loads = [{{ on = "tip", force = ["-1 kN", 0, 0] }}] }},
]

[bodies.column.geometry]
type = "blocks"
add = [{{ name = "bar", from = [0, 0, 0], to = [1, 0.02, 0.02] }}]
groups = {{ root = {{ plane = "x", at = 0 }}, tip = {{ plane = "x", at = 1 }} }}
"""


def test_buckling_factor_of_a_load_case_that_asks_for_it(tmp_path):
    """``pi^2 E I / 4 L^2`` over 1 kN, as quantity and in the report; the other one says what it lacks."""
    (tmp_path / "case.toml").write_text(COLUMN)
    case = load_case(tmp_path)
    assert run_case(case, stages=("mesh", "modes")).outcome is Outcome.COMPLETED
    quantities = Quantities(case, case.output_folder)
    expected = np.pi**2 * E * 0.02**4 / 12.0 / 4.0 / 1e3
    assert quantities.number("static.column.push.buckling") == pytest.approx(expected, rel=5e-3)
    with pytest.raises(InputError) as caught:
        quantities.number("static.column.plain.buckling")
    assert "buckling = true" in str(caught.value)
    states = read_states(OutputFolder(case.output_folder).reduced("column"))
    rows = _static_table(read_model(OutputFolder(case.output_folder).model("column")), states).rows
    words = {row[0]: row[-1] for row in rows}
    assert words["plain"] == "not asked for"
    assert float(words["push"]) == pytest.approx(expected, rel=5e-3)
