"""Criteria of lifts against numbers by hand, and what they refuse."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, InputErrors, Outcome
from heavylift.pipeline import load_case
from heavylift.pipeline.case.criteria.lift_rules import (
    bending_factor,
    capacity_at,
    clause,
    sling_factor,
    table_factor,
)
from heavylift.pipeline.checks import quantities as checks_module
from heavylift.pipeline.checks.judge import judge
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.commands.criteria import criteria_document, criteria_table, judge_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.report.criteria import (
    briefly,
    criteria_section,
    used_words,
    write_criteria,
)
from heavylift.pipeline.report.document import Album
from heavylift.pipeline.report.report import _verdict
from heavylift.pipeline.results.histories import ChannelInfo, Results
from heavylift.pipeline.results.rope_lines import rope_tangents
from tests.pipeline.judged import judged_criteria

TIMES = 0.1 * np.arange(101)
ONES = np.ones(101)
UPRIGHT = np.tile([1.0, 0.0, 0.0, 0.0], (101, 1))
WEIGHT = 3e4  # 3 t, g = 10 m/s^2


@pytest.mark.parametrize(
    ("used", "words"),
    [(None, ""), (0.0, "0.0 %"), (-0.0, "0.0 %"), (-3e-9, "0.0 %"), (0.5, "50.0 %"), (12.0, "> 999 %")],
)
def test_what_is_used_has_a_sign_only_if_it_is_seen(used, words):
    assert used_words(SimpleNamespace(utilisation=used)) == words


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "slings"
    folder.mkdir()
    text = (Path(__file__).parents[1] / "slings.toml").read_text()
    (folder / "case.toml").write_text(text.replace("duration = 0", "duration = 10"))
    return folder


def results(metadata=None, **channels):
    infos, columns = {}, {}
    components = {1: ("",), 3: ("x", "y", "z"), 4: ("q0", "q1", "q2", "q3")}
    for key, values in channels.items():
        name = key.replace("__", ".")
        width = 1 if values.ndim == 1 else values.shape[1]
        forces = ("tension", "force", "plane")
        unit = "N" if any(word in name for word in forces) else "1" if width == 4 or "phase" in name else "m"
        infos[name] = ChannelInfo(name, unit, components[width], len(columns))
        columns[name] = values.reshape(len(values), -1)
    return Results(Path("results.h5"), TIMES, infos, columns, metadata or {"outcome": "completed"})


@pytest.fixture
def judged(folder, monkeypatch):
    """Results of the criteria in a text on some histories."""

    def judge(text, metadata=None, **channels):
        base = {f"sling_{i}__tension": 1e4 * ONES for i in (1, 2, 3)}
        base |= {"load__position": np.zeros((101, 3)), "load__orientation": UPRIGHT}
        found = results(metadata, **(base | channels))
        monkeypatch.setattr(checks_module, "load_results", lambda *_: found)
        with (folder / "case.toml").open("a") as file:
            file.write(text)
        return judged_criteria(load_case(folder), folder / "out")

    return judge


def criterion(**keys):
    lines = [
        f"{key} = {value if isinstance(value, Raw) else json.dumps(value)}" for key, value in keys.items()
    ]
    return "\n[[criteria]]\n" + "\n".join(lines) + "\n"


class Raw(str):
    """TOML as it stands."""

    __slots__ = ()


@pytest.mark.parametrize(
    ("tons", "factors"),
    [
        (100.001, (1.05, 1.12, 1.25)),
        (300.0, (1.05, 1.12, 1.25)),
        (300.001, (1.05, 1.10, 1.20)),
        (1000.0, (1.05, 1.10, 1.20)),
        (2500.0, (1.03, 1.08, 1.15)),
        (9000.0, (1.03, 1.05, 1.10)),
        (100.0, (1.10, 1.12, 1.25)),
        (25.0, (1.10, 1.17, 1.50)),
    ],
)
def test_amplification_factors_are_those_of_the_table(tons, factors):
    found = [table_factor(1000.0 * tons, word) for word in ("onshore", "inshore", "offshore")]
    assert found == pytest.approx(factors, rel=1e-12)


def test_the_table_begins_above_3_tons():
    assert table_factor(4e3, "offshore", 16e3) == pytest.approx(1.625)  # of SHL, not of the gross weight
    for tons in (3.0, 0.5, -1.0, math.nan):
        with pytest.raises(InputError, match=r"no dynamic amplification factor.*more than 3 t"):
            table_factor(1000.0 * tons, "onshore")


def test_factors_of_slings_by_hand():
    assert sling_factor(reduction=1.25) == pytest.approx(1.3 * 1.3 * 1.25 * 1.5)
    assert round(sling_factor(reduction=1.25), 2) == 3.17
    assert sling_factor(reduction=1.25, load=1.0, material=1.35) == pytest.approx(2.3 * 1.25)
    assert sling_factor(reduction=1.0, wear=1.1, twist=1.2) == pytest.approx(1.3 * 1.3 * 1.5 * 1.1 * 1.2)
    assert 1.0 - 1.0 / bending_factor(18.0) == pytest.approx(0.118, abs=5e-4)  # loses 12 %
    assert bending_factor(4.0) == pytest.approx(4.0 / 3.0)


def test_the_crane_curve_is_linear_between_its_rows_and_nothing_outside():
    found = capacity_at(
        [20.0, 30.0, 50.0], [2e6, 1.5e6, 0.5e6], [20.0, 22.0, 30.0, 45.0, 50.0, 19.999, 50.001]
    )
    assert found[:5] == pytest.approx([2e6, 1.9e6, 1.5e6, 0.75e6, 0.5e6])
    assert np.isnan(found[5:]).all()


def test_every_clause_has_a_status_that_is_told():
    assert clause("shackle").text == "0027/ND 8.2.6 [public copy]"
    assert clause("bending of a rope").text == "0027/ND 7.8 [NOT CONFIRMED: from memory]"
    assert "NOT CONFIRMED: seen in a training question" in clause("out-of-plane angle at padeyes").text


def test_tangents_of_many_records_at_once():
    """A rope from a point, under a pulley, to another point: radii at right angles to it, lengths by Pythagoras."""
    left = np.array([[-3.0, 0.0, 4.0], [-5.0, 0.0, 12.0]])
    right, centre = left * [-1.0, 1.0, 1.0], np.zeros((2, 3))
    axis = np.tile([0.0, -1.0, 0.0], (2, 1))
    arrive, leave = rope_tangents([left, centre, right], [0.0, 1.0, 0.0], [axis, axis, axis])
    first, second = arrive[1] - leave[0], arrive[2] - leave[1]
    assert np.sum(first * arrive[1], axis=1) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert np.sum(second * leave[1], axis=1) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert np.linalg.norm(first, axis=1) ** 2 == pytest.approx([24.0, 168.0])
    assert (arrive[1][:, 2] < 0.0).all()  # below the pulley
    assert arrive[1] == pytest.approx(leave[1] * [-1.0, 1.0, 1.0])


SLING = {
    "name": "slings",
    "type": "sling",
    "ropes": ["sling_*"],
    "breaking_load": "60 kN",
    "termination_factor": 1.25,
}


def test_the_worst_sling_governs_by_its_largest_force(judged):
    """12 kN of sling 2 at 4 s, 3.16875 of 60 kN: 63.4 %, 6.935 kN to the limit of 18.935 kN."""
    peak = 1e4 + 2e3 * np.exp(-((TIMES - 4.0) ** 2))
    (row,) = judged(criterion(**SLING), sling_2__tension=peak)
    assert (row.value, row.limit) == (pytest.approx(12e3), pytest.approx(60e3 / 3.16875))
    assert row.utilisation == pytest.approx(12e3 * 3.16875 / 60e3)
    assert row.margin == pytest.approx(60e3 / 3.16875 - 12e3)
    assert (row.where, row.time, row.passed, row.seen) == ("sling_2", pytest.approx(4.0), True, "101 records")
    assert [factor.text for factor in row.factors] == [
        "DAF in the run",
        "gamma_r 1.25 on the limit",
        "gamma_sf 3.169 on the limit",
    ]
    assert "0027/ND 7.4 [NOT CONFIRMED: from memory]" in row.source
    assert row.history is not None
    assert np.nanmax(row.history[1]) == pytest.approx(row.utilisation)


def test_extremes_of_all_steps_count_and_those_before_the_time_do_not(judged):
    """In the interval up to 5 s a step has 15 kN; a criterion from 5 s on has not seen it, one from 4.9 s on has."""
    extremes = np.where(np.isclose(TIMES, 5.0), 15e3, 1e4)
    text = criterion(**SLING) + criterion(**(SLING | {"name": "later", "after": "5 s"}))
    text += criterion(**(SLING | {"name": "before", "after": "4.9 s", "until": "5 s"}))
    found = judged(text, {"sees_every_step": True, "steps": 5000}, sling_1__tension_max=extremes)
    assert [row.value for row in found] == [15e3, 1e4, 15e3]
    assert [row.seen for row in found] == [
        "101 records",
        "51 records",
        "2 records",
    ]  # two of three have no extremes
    assert found[0].time == pytest.approx(5.0)


def test_a_factor_multiplies_the_force_at_rest_and_never_the_largest(judged):
    """At rest 10 kN, later 14 kN: with a factor of 1.2 and skew 1.1 it is 13.2 kN, whatever the run does."""
    tension = np.where(TIMES > 5.0, 14e3, 10e3)
    given = SLING | {"dynamic_factor": 1.2, "static_at": "2 s", "skew_factor": 1.1, "ropes": ["sling_1"]}
    (row,) = judged(criterion(**given), sling_1__tension=tension)
    assert row.value == pytest.approx(1.2 * 1.1 * 1e4)
    assert row.time is None
    assert row.history is None
    assert [factor.text for factor in row.factors[:2]] == ["DAF 1.2 on the value", "skew 1.1 on the value"]


@pytest.mark.parametrize(
    ("when", "value"), [("start", 1e4), ("end", 2e4), ("mean", 1.5e4), ("2.55 s", 12550.0), (7.5, 17500.0)]
)
def test_when_a_force_is_at_rest(judged, when, value):
    given = SLING | {"dynamic_factor": 1.0, "static_at": when, "ropes": ["sling_1"]}
    (row,) = judged(criterion(**given), sling_1__tension=1e4 + 1e3 * TIMES)
    assert row.value == pytest.approx(value, rel=1e-12)


def test_a_rope_that_bends_more_than_its_splice_takes(judged):
    (row,) = judged(criterion(**(SLING | {"bending_ratio": 4.0})))
    assert row.limit == pytest.approx(60e3 / (4.0 / 3.0 * 1.3 * 1.3 * 1.5))
    assert "0027/ND 7.8 [NOT CONFIRMED: from memory]" in row.source


def test_a_value_that_is_no_number_fails(judged):
    (row,) = judged(criterion(**SLING), sling_3__tension=np.where(TIMES > 9.0, np.nan, 1e3))
    assert not row.passed
    assert row.where == "sling_3"
    assert row.row()["value"] is None


CRANE = {
    "name": "crane",
    "type": "crane",
    "load": "sum(sling_*.tension)",
    "curve": Raw('{ radius = ["20 m", "30 m", "40 m"], capacity = ["10 t", "8 t", "4 t"] }'),
}


def test_load_over_the_crane_curve(judged):
    """30 kN and 500 kg of rigging, g = 10: 35 kN at 35 m, where the curve has 6 t: 58.3 %."""
    (row,) = judged(criterion(**(CRANE | {"radius": "35 m", "additional": "500 kg"})))
    assert (row.value, row.limit) == (pytest.approx(35e3), pytest.approx(60e3))
    assert row.utilisation == pytest.approx(35.0 / 60.0)
    assert row.where.endswith("at radius 35 m")


def test_the_crane_governs_where_load_over_capacity_is_largest(judged):
    """The load of 30 kN goes out from 25 to 37 m; 30 kN of 52 kN there; with two parts 60 kN of 52 kN."""
    motion = np.column_stack([25.0 + 1.2 * TIMES, 0.0 * TIMES, 0.0 * TIMES])
    given = CRANE | {
        "reach": Raw(
            '{ centre = { body = "ground", point = [0, 0, 0] }, tip = { body = "load", point = [0, 0, 9] } }'
        )
    }
    text = criterion(**given) + criterion(**(given | {"name": "double", "parts": 2}))
    load, radius, double, _ = judged(text, load__position=motion)
    assert (load.value, load.limit, load.time) == (
        pytest.approx(3e4),
        pytest.approx(5.2e4),
        pytest.approx(10.0),
    )
    assert load.passed
    assert (radius.value, radius.limit, radius.side, radius.passed) == (pytest.approx(37.0), 40.0, "<=", True)
    assert (double.value, double.passed) == (pytest.approx(6e4), False)
    assert double.margin == pytest.approx(-8e3)


def test_a_load_between_two_records_has_the_smaller_capacity_of_both(judged):
    """The crane comes in by 0.1 m a record from 39 m; at 32 m, 7 s, the interval before began at 32.1 m: 7.16 t."""
    motion = np.column_stack([39.0 - TIMES, 0.0 * TIMES, 0.0 * TIMES])
    peak = np.where(np.isclose(TIMES, 7.0), 8e4, 1.0)
    reach = Raw(
        '{ centre = { body = "ground", point = [0, 0, 0] }, tip = { body = "load", point = [0, 0, 0] } }'
    )
    load, _ = judged(
        criterion(**(CRANE | {"reach": reach, "load": "sling_1.tension"})),
        {"sees_every_step": True, "steps": 5000},
        load__position=motion,
        sling_1__tension=ONES,
        sling_1__tension_max=peak,
    )
    assert (load.value, load.limit) == (pytest.approx(8e4), pytest.approx(71.6e3))
    assert (load.time, load.seen, load.passed) == (pytest.approx(7.0), "5,000 steps", False)


def test_a_radius_outside_the_curve_is_a_failure_with_a_name(judged):
    """From 38 m out at 0.5 m/s: 40 m at 4 s, 43 m in the end."""
    motion = np.column_stack([0.0 * TIMES, 38.0 + 0.5 * TIMES, 0.0 * TIMES])
    reach = Raw(
        '{ centre = { body = "ground", point = [0, 0, 0] }, tip = { body = "load", point = [0, 0, 0] } }'
    )
    load, radius = judged(criterion(**(CRANE | {"reach": reach})), load__position=motion)
    assert not radius.passed
    assert (radius.value, radius.time) == (pytest.approx(43.0), pytest.approx(10.0))
    assert radius.note == "outside the crane curve at 60 of 101 records"
    assert load.limit == pytest.approx(4e4)  # the least that it has within the curve
    nearer, far = judged(
        criterion(**(CRANE | {"reach": reach, "name": "all", "after": "5 s"})), load__position=motion
    )[2:]
    assert (nearer.passed, nearer.note) == (False, "no record is within the crane curve")
    assert not far.passed


def test_the_falls_lean_in_and_across_the_plane_of_the_boom(judged):
    """The boom points along y, the hook hangs 20 m below, 1 m farther out and 0.5 m to the side."""
    position = np.tile([0.5, 31.0, -20.0], (101, 1))
    given = CRANE | {
        "reach": Raw(
            '{ centre = { body = "ground", point = [0, 0, 0] }, tip = { body = "ground", point = [0, 30, 0] } }'
        ),
        "hook": Raw('{ body = "load", point = [0, 0, 0] }'),
        "side_lead": "1 deg",
    }
    _, _, off, side = judged(criterion(**given), load__position=position)
    assert off.value == pytest.approx(math.atan(1.0 / 20.0))
    assert (off.limit, off.passed) == (pytest.approx(math.radians(3.0)), True)
    assert off.clauses[0].status == "assumption"
    assert side.value == pytest.approx(math.atan(0.5 / 20.0))
    assert (side.limit, side.passed) == (pytest.approx(math.radians(1.0)), False)
    assert side.clauses[0].status == "case file"


def test_a_crane_that_heels_leans_against_its_falls(judged):
    """Its axes turn by 2 deg about the boom, along x: vertical falls have 2 deg of side-lead and no off-lead."""
    half = math.radians(1.0)
    heeled = np.tile([math.cos(half), math.sin(half), 0.0, 0.0], (101, 1))
    given = CRANE | {
        "reach": Raw(
            '{ centre = { body = "load", point = [0, 0, 0] }, tip = { body = "load", point = [30, 0, 0] } }'
        ),
        "hook": Raw('{ body = "ground", point = [30, 0, -20] }'),
    }
    _, radius, off, side = judged(criterion(**given), load__orientation=heeled)
    assert radius.value == pytest.approx(30.0)
    assert off.value == pytest.approx(0.0, abs=1e-12)
    assert side.value == pytest.approx(math.radians(2.0))


def test_a_fall_that_leaves_its_sheave_vertically_has_no_lead(judged):
    """A sheave of 0.5 m at the tip, 10 m above the hook, which hangs below its rim: the line from its centre leans."""
    rope = """
[[ropes]]
name = "fall"
axial_stiffness = "1 GN"
path = [
    { body = "ground", point = [-5, 0, 9] },
    { body = "ground", point = [0, 0, 10], radius = 0.5, axis = [0, 1, 0] },
    { body = "load", point = [0.5, 0, 0] },
]
"""
    given = CRANE | {
        "reach": Raw(
            '{ centre = { body = "ground", point = [-30, 0, 0] }, tip = { body = "ground", point = [0, 0, 10] } }'
        ),
        "hook": Raw('{ body = "load", point = [0.5, 0, 0] }'),
    }
    text = criterion(**given) + criterion(**(given | {"name": "by_rope", "fall": "fall"}))
    _, _, centre, _, _, _, rim, side = judged(rope + text)
    assert centre.value == pytest.approx(math.atan2(0.5, 10.0))
    assert rim.value == pytest.approx(0.0, abs=1e-9)
    assert side.value == pytest.approx(0.0, abs=1e-9)


def test_amplification_stands_beside_the_table(judged):
    """30 kN at rest and 10 % more: 3 t has no value in the table, 300 t of the same has 1.25 offshore."""
    loads = {f"sling_{i}__tension": 1e6 * (1.0 + 0.1 * np.sin(TIMES)) for i in (1, 2, 3)}
    given = {"name": "daf", "type": "dynamic_factor", "load": "sum(sling_*.tension)", "operation": "offshore"}
    text = criterion(**given, static_load="300 t")
    text += criterion(**(given | {"name": "own", "maximum": 1.05, "static_at": "start"}))
    table, own = judged(text, **loads)
    peak = 1.0 + 0.1 * np.sin(TIMES).max()
    assert (table.value, table.limit, table.passed) == (pytest.approx(peak), 1.25, True)
    assert table.factors[1].text == "DAF of the table, offshore, 1.25 not applied"
    assert (own.limit, own.passed) == (1.05, False)


def test_a_load_below_the_table_is_one_error(judged):
    with pytest.raises(
        InputErrors, match=r"criterion 'daf': no dynamic amplification factor for 3 t.*'maximum'"
    ):
        judged(
            criterion(
                name="daf",
                type="dynamic_factor",
                load="sum(sling_*.tension)",
                operation="inshore",
                static_load="3 t",
            )
        )


def test_angles_of_slings_to_the_horizontal(judged):
    """The hook is 6 m above the lugs, at 4, sqrt 13 and sqrt 5 m: the first one is flattest, 56.3 deg."""
    given = {"name": "angles", "type": "sling_angle", "ropes": ["sling_*"]}
    text = criterion(**given) + criterion(**(given | {"name": "warned", "warning": "57 deg"}))
    text += criterion(**(given | {"name": "refused", "minimum": "57 deg", "warning": "60 deg"}))
    plain, warned, refused = judged(text)
    assert plain.value == pytest.approx(math.atan2(6.0, 4.0), rel=1e-12)
    assert (plain.where, plain.passed, plain.warns) == ("sling_1", True, False)
    assert (warned.passed, warned.warns, warned.note) == (True, True, "below 57 deg")
    assert (refused.passed, refused.warns) == (False, False)


def test_slack_slings_have_no_angle(judged):
    given = criterion(name="angles", type="sling_angle", ropes=["sling_*"])
    (row,) = judged(given, sling_1__tension=0.0 * ONES)
    assert row.value == pytest.approx(math.atan2(6.0, math.sqrt(13.0)))
    assert row.note == "never carries: sling_1"
    slack = {f"sling_{i}__tension": 0.0 * ONES for i in (1, 2, 3)}
    (_, row) = judged(given.replace("angles", "again"), **slack)
    assert not row.passed  # without data there is no pass


LUGS = """
[[lugs]]
name = "eye_1"
body = "load"
rope = "sling_1"
normal = [0, 1, 0]

[[lugs]]
name = "eye_2"
body = "load"
rope = "sling_2"
normal = [1, 0, 0]
"""


def of_lug(name, force, angle, *, more=0.0):
    """Records of a lug, and extremes by a share more between them."""
    found = {"force": force, "in_plane": force * np.cos(angle), "out_of_plane": force * np.sin(angle)}
    found["angle"] = angle + 0.0 * force
    found |= {f"{key}_max": value + more * np.abs(value) for key, value in found.items()}
    found |= {f"{key}_min": found[key] - more * np.abs(found[key]) for key in list(found)[:4]}
    return {f"{name}__{key}": value for key, value in found.items()}


def test_forces_on_lugs_in_their_plane_and_across(judged):
    """10 kN at asin(-2/7) to the plane of an eye, 10 % more between records; 9 kN straight in that of the other one."""
    given = {"type": "lug", "in_plane": "20 kN", "out_of_plane": "2.5 kN"}
    text = LUGS + criterion(name="both", lugs=["eye_*"], **given)
    text += criterion(name="straight", lugs=["eye_1"], maximum_angle="1 deg", **given)
    text += criterion(name="factor", lugs=["eye_2"], dynamic_factor=1.2, static_at="end", **given)
    records = of_lug("eye_1", 9e3 * ONES, 0.0) | of_lug("eye_2", 1e4 * ONES, math.asin(-2.0 / 7.0), more=0.1)
    metadata = {"sees_every_step": True, "steps": 5000}
    angle, inside, across, straight, _, least, _, rest, lateral = judged(text, metadata, **records)
    assert (angle.value, angle.where) == (pytest.approx(1.1 * math.asin(2.0 / 7.0)), "eye_2")
    assert not angle.passed
    assert inside.value == pytest.approx(1.1e4 * math.sqrt(45.0) / 7.0)
    assert (across.value, across.passed) == (pytest.approx(2.2e4 / 7.0), False)
    assert (straight.value, straight.passed) == (pytest.approx(0.0, abs=1e-9), True)
    assert least.value == pytest.approx(270.0)  # 3 % at least
    assert (rest.value, lateral.value) == (
        pytest.approx(1.2e4 * math.sqrt(45.0) / 7.0),
        pytest.approx(2.4e4 / 7.0),
    )
    assert (angle.clauses[0].status, straight.clauses[0].status) == (
        "seen in a training question",
        "case file",
    )


def test_a_lug_whose_rope_never_carries_has_no_angle(judged):
    records = of_lug("eye_1", 9e3 * ONES, 0.02) | of_lug("eye_2", 0.0 * ONES, 0.0)
    one, none = judged(
        LUGS
        + criterion(name="one", type="lug", lugs=["eye_*"])
        + criterion(name="none", type="lug", lugs=["eye_2"]),
        **records,
    )
    assert (one.value, one.note) == (pytest.approx(0.02), "never carries: eye_2")
    assert not none.passed  # without data there is no pass


def test_shackles_by_the_least_of_their_ratings(judged):
    """10 kN at rest, 12 kN at most. WLL 1.1 t = 11 kN, at rest, allows 13.2 kN; MBL 33 kN allows 11 kN."""
    tension = 1e4 + 2e3 * np.exp(-((TIMES - 4.0) ** 2))
    given = {"name": "a", "type": "shackle", "ropes": ["sling_1"], "working_load_limit": "1.1 t"}
    text = criterion(**given)
    text += criterion(**(given | {"name": "b", "static_at": "end"}))
    text += criterion(**(given | {"name": "c", "static_at": "end", "breaking_load": "33 kN"}))
    text += criterion(
        **(given | {"name": "d", "static_at": "end", "dynamic_factor": 1.3, "proof_load": "14 kN"})
    )
    as_it_is, at_rest, breaking, factor = judged(text, sling_1__tension=tension)
    assert (as_it_is.limit, as_it_is.passed) == (pytest.approx(11e3), False)
    assert (at_rest.value, at_rest.limit, at_rest.passed) == (
        pytest.approx(12e3),
        pytest.approx(13.2e3),
        True,
    )
    assert (breaking.limit, breaking.where) == (pytest.approx(11e3), "sling_1 (MBL / 3)")
    assert (factor.value, factor.limit, factor.where) == (pytest.approx(13e3), 14e3, "sling_1 (proof load)")


def test_slack_and_what_dynamics_take_away(judged):
    """10 kN less 9.5 kN at 4 s: never slack, but 95 % are taken away; then 0 from 9 s on."""
    dip = 1e4 - 9.5e3 * np.exp(-((TIMES - 4.0) ** 2))
    given = {"name": "a", "type": "slack", "ropes": ["sling_*"], "static_at": "start"}
    text = criterion(**given) + criterion(**(given | {"name": "b", "minimum": "600 N"}))
    smallest, share, more, _ = judged(text, sling_2__tension=dip)
    assert (smallest.value, smallest.passed, smallest.side) == (pytest.approx(500.0), True, ">")
    assert (share.value, share.limit, share.passed) == (pytest.approx(0.95), 0.9, False)
    assert (more.passed, more.margin) == (False, pytest.approx(-100.0))
    (_, _, _, _, slack) = judged(
        criterion(name="c", type="slack", ropes=["sling_3"]),
        sling_2__tension=dip,
        sling_3__tension=np.where(TIMES > 8.95, 0.0, 1e4),
    )
    assert (slack.value, slack.passed, slack.note) == (0.0, False, "for 1.1 s by records")


def test_the_spread_of_tensions(judged):
    """10 kN (1 + 0.2 sin), 10 kN (1 - 0.2 sin) and 10 kN from 1 s on: 0.4 |sin| of the mean, but for what is slack."""
    wave = 0.2 * np.sin(2.0 * np.pi * TIMES / 10.0)
    lifted = TIMES > 0.95
    tensions = {f"sling_{i}__tension": 1e4 * lifted * (1.0 + s * wave) for i, s in ((1, 1), (2, -1), (3, 0))}
    given = {"type": "spread", "ropes": ["sling_*"]}
    text = criterion(name="alike", maximum=0.35, **given)
    text += criterion(name="later", maximum=0.5, after="5 s", **given)
    text += criterion(name="before", maximum=0.5, until="0.9 s", **given)
    text += criterion(name="two", type="spread", ropes=["sling_3", "sling_1"], maximum=0.25, source="plan")
    alike, later, before, two = judged(text, **tensions)
    assert (alike.value, alike.limit, alike.unit, alike.passed) == (pytest.approx(0.4), 0.35, "1", False)
    assert (alike.time, alike.where) == (pytest.approx(2.5), "sling_1 over sling_2")
    assert (alike.utilisation, alike.seen) == (pytest.approx(0.4 / 0.35), "101 records")
    assert alike.source == "limit of the case file"
    used = alike.history[1]
    assert np.isnan(used[:10]).all()
    assert used[10:] == pytest.approx(2.0 * np.abs(wave[10:]) / 0.35)
    assert (later.value, later.time, later.where) == (
        pytest.approx(0.4),
        pytest.approx(7.5),
        "sling_2 over sling_1",
    )
    assert later.passed
    assert (before.passed, before.note, before.where) == (False, "the ropes never carry", "")
    assert math.isnan(before.value)
    # 10 kN and 8 kN, 2 over 9, are further apart than 12 kN and 10 kN
    assert (two.value, two.passed, two.source) == (pytest.approx(2.0 / 9.0), True, "plan")
    assert (two.time, two.where) == (pytest.approx(7.5), "sling_3 over sling_1")


def test_clearance_and_tilt(judged):
    """The load comes down to 1.4 m and turns by 2 deg about (1, 1, 0)."""
    height = np.column_stack([0.0 * TIMES, 0.0 * TIMES, 1.4 + 0.1 * (TIMES - 6.0) ** 2])
    half = np.radians(1.0) * TIMES / 10.0
    turn = np.column_stack(
        [np.cos(half), np.sin(half) * math.sqrt(0.5), np.sin(half) * math.sqrt(0.5), 0.0 * half]
    )
    given = {"type": "clearance", "distance": "load.position.z"}
    text = criterion(name="under", place="under_load", **given)
    text += criterion(name="near", place="near_final_place", minimum="1 m", **given)
    text += criterion(name="level", type="tilt", body="load", maximum="1.5 deg")
    text += criterion(name="side", type="tilt", body="load", axis=[0, 0, -2], maximum="179 deg")
    under, near, level, side = judged(text, load__position=height, load__orientation=turn)
    assert (under.value, under.limit, under.time) == (pytest.approx(1.4), 3.0, pytest.approx(6.0))
    assert (under.passed, under.utilisation) == (False, pytest.approx(3.0 / 1.4))
    assert under.source == "0027/ND 16.2.2 [public copy]"
    assert (near.limit, near.passed, near.source) == (1.0, True, "limit of the case file")
    assert (level.value, level.time, level.passed) == (
        pytest.approx(math.radians(2.0)),
        pytest.approx(10.0),
        False,
    )
    assert side.value == pytest.approx(math.pi)


def test_any_quantity_within_a_limit(judged):
    """Statistics of a part of the run; a largest value that must be reached; the worst of a group."""
    text = criterion(name="a", type="limit", quantity="channel.sling_*.tension.max", maximum="15 kN")
    text += criterion(
        name="b",
        type="limit",
        quantity="channel.sling_1.tension.mean",
        maximum=14999.0,
        after="5 s",
        until="5 s",
    )
    text = text.replace('until = "5 s"', 'until = "5.05 s"')
    text += criterion(name="c", type="limit", quantity="channel.sling_1.tension.max", minimum="19 kN")
    text += criterion(
        name="d", type="limit", quantity="channel.sling_1.tension.end", minimum="21 kN", source="plan"
    )
    a, b, c, d = judged(text, sling_1__tension=1e4 + 1e3 * TIMES)
    assert (a.value, a.where, a.passed) == (pytest.approx(2e4), "sling_1", False)
    assert (b.value, b.passed, b.time) == (pytest.approx(1.5e4), False, None)
    assert (c.value, c.passed) == (pytest.approx(2e4), True)
    assert (d.value, d.passed, d.source) == (pytest.approx(2e4), False, "plan")


def test_the_phase_in_which_it_governs(judged, folder):
    text = folder / "case.toml"
    phase = np.where(TIMES < 3.95, 1.0, np.where(TIMES < 7.95, 2.0, 3.0))
    peak = 1e4 + 2e3 * np.exp(-((TIMES - 4.0) ** 2))
    (row,) = judged(criterion(**SLING), sling_2__tension=peak, scenario__phase=phase)
    assert row.phase == "phase 2"
    case = load_case(text)
    case._document["scenario"] = {"phases": [{"name": "tensioning"}, {"name": "hoisting"}]}
    (row,) = judged_criteria(case, folder / "out")
    assert row.phase == "hoisting"


def test_a_criterion_of_some_phases(judged, folder):
    """Phases 1, 2, 1 from 3 and 6 s on: in the first, 4 s of 8 kN and 2.9 of 10 kN, and no peak of the second."""
    phase = np.where((TIMES > 2.95) & (TIMES < 5.95), 2.0, 1.0)
    tension = np.where(TIMES > 5.95, 8e3, 1e4) + np.where(np.isclose(TIMES, 4.0), 5e3, 0.0)
    # in the interval in which the first begins again
    extremes = tension + np.where(np.isclose(TIMES, 6.0), 3e3, 0.0)
    metadata = {"sees_every_step": True, "steps": 5000}
    given = SLING | {"phases": ["tensioning"], "ropes": ["sling_1"]}
    with (folder / "case.toml").open("a") as file:
        file.write(criterion(**(given | {"phases": []})))
    case = load_case(folder)
    found = results(metadata, sling_1__tension=tension, sling_1__tension_max=extremes, scenario__phase=phase)
    case._document["scenario"] = {"phases": [{"name": "tensioning"}, {"name": "hoisting"}]}

    def value(**keys):
        (one,) = case.criteria
        return judged_criteria(
            case.model_copy(update={"criteria": (one.model_copy(update=keys),)}), folder, found
        )[0]

    assert value().value == pytest.approx(15e3)
    row = value(phases=("tensioning",))
    assert (row.value, row.time, row.phase) == (pytest.approx(11e3), pytest.approx(6.0), "tensioning")
    assert value(phases=("tensioning",), after=6.0).value == pytest.approx(8e3)
    row = value(phases=("hoisting",))
    assert (row.value, row.time, row.phase) == (pytest.approx(15e3), pytest.approx(4.0), "hoisting")
    # 29 intervals at 10 kN up to 2.9 s, 40 at 8 kN from 6 s on
    mean = value(phases=("tensioning",), dynamic_factor=1.0, static_at="mean")
    assert mean.value == pytest.approx((2.9 * 1e4 + 4.0 * 8e3) / 6.9)
    with pytest.raises(InputError, match=r"criterion 'slings': the run has no 'scenario.phase'"):
        judged_criteria(
            case.model_copy(
                update={"criteria": (case.criteria[0].model_copy(update={"phases": ("hoisting",)}),)}
            ),
            folder,
            results(sling_1__tension=tension),
        )


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (
            SLING | {"phases": ["hoisting"]},
            "phases.0: phase 'hoisting' does not exist; expected one of: none",
        ),
        (
            CRANE | {"radius": "41 m"},
            "radius: 41 m is outside the crane curve; expected a radius from 20 m to 40 m",
        ),
        (CRANE, "no radius; expected one of 'radius', 'radius_channel', 'reach'"),
        (
            CRANE | {"radius": "30 m", "radius_channel": "load.position.x"},
            "both 'radius' and 'radius_channel'",
        ),
        (CRANE | {"radius": "30 kg"}, "radius: '30 kg'"),
        (CRANE | {"radius": "30 m", "fall": "sling_1"}, "'fall' without 'hook'"),
        (CRANE | {"radius": "30 m", "off_lead": "2 deg"}, "'off_lead' without 'hook'"),
        (CRANE | {"radius": "30 m", "load": "load.position.z"}, "load: 'load.position.z' is in m, no force"),
        (
            CRANE | {"radius": "30 m", "load": "slung.tension"},
            "load: 'slung.tension' names 'slung', which does not exist",
        ),
        (CRANE | {"radius": "30 m", "load": "sling_1.tensoin"}, "did you mean 'tension'?"),
        (
            CRANE | {"radius": "30 m", "curve": Raw("{ radius = [20, 40, 30], capacity = [3, 2, 1] }")},
            "curve.radius.2: 30 m is not above 40 m; expected increasing radii",
        ),
        (
            CRANE | {"radius": "30 m", "curve": Raw('{ radius = [20, 40], capacity = ["3 t", "-2 t"] }')},
            "curve.capacity.1: '-2 t' is too small; expected a force or a mass > 0",
        ),
        (
            CRANE | {"radius": "30 m", "curve": Raw('{ radius = [20, 40], capacity = ["3 t", "2 m"] }')},
            "curve.capacity.1: '2 m'",
        ),
        (
            CRANE | {"radius": "30 m", "curve": Raw('{ radius = [20, 40], capacity = ["3 t", "20 kN"] }')},
            "curve.capacity: masses beside forces",
        ),
        (
            CRANE | {"radius": "30 m", "curve": Raw("{ radius = [20, 40], capacity = [3, 2, 1] }")},
            "curve.capacity: 2 radii and 3 capacities",
        ),
        (
            CRANE | {"radius": "30 m", "load": "sling_*.tension"},
            "load: 'sling_*.tension' is of 3 items; expected one number, e.g. 'sum(sling_*.tension)'",
        ),
        (
            SLING | {"ropes": ["slang_*"]},
            "ropes.0: no rope fits 'slang_*'; expected ropes or patterns of ropes: sling_1",
        ),
        (SLING | {"ropes": ["sling_1", "load"]}, "ropes.1: 'load' has no tension"),
        (SLING | {"ropes": ["sling_9"]}, "ropes.0: "),
        (SLING | {"dynamic_factor": 1.1}, "static_at: is missing"),
        (SLING | {"static_at": "end"}, "static_at: 'static_at' without 'dynamic_factor'"),
        (SLING | {"dynamic_factor": 0.9, "static_at": "end"}, "dynamic_factor: 0.9 is too small"),
        (SLING | {"dynamic_factor": 1.1, "static_at": "later"}, "static_at: "),
        (
            SLING | {"dynamic_factor": 1.1, "static_at": "11 s"},
            "static_at: 11 s; expected a time within the run",
        ),
        (SLING | {"after": "5 s", "until": "4 s"}, "until: 4 s is not later than 'after'"),
        (SLING | {"breaking_load": 0}, "breaking_load: 0 is too small"),
        (SLING | {"type": "slings"}, "criteria.0: type = 'slings'; expected one of 'crane', 'sling'"),
        (
            {"name": "a", "type": "spread", "ropes": ["sling_1"], "maximum": 0.1},
            "ropes: 'sling_1' alone; expected two ropes or more",
        ),
        (
            {"name": "a", "type": "limit", "quantity": "channel.sling_1.tensoin.max", "maximum": 1},
            "did you mean 'tension'?",
        ),
        (
            {"name": "a", "type": "limit", "quantity": "channel.sling_1.tension.max", "maximum": "1 m"},
            "maximum: '1 m'",
        ),
        (
            {"name": "a", "type": "limit", "quantity": "channel.sling_1.tension.max"},
            "neither 'maximum' nor 'minimum'",
        ),
        (
            {"name": "a", "type": "limit", "quantity": "mesh.load.mass", "maximum": 1},
            "quantity: 'mesh.load.mass' needs a flexible",
        ),
        (
            {"name": "a", "type": "limit", "quantity": "drift.energy", "maximum": 1, "after": 1},
            "after: 'after' with 'drift.energy'",
        ),
        ({"name": "a", "type": "clearance", "distance": "load.position.z"}, "neither 'place' nor 'minimum'"),
        (
            {"name": "a", "type": "clearance", "distance": "load.position", "minimum": 1},
            "distance: 'load.position' has 3 components",
        ),
        (
            {"name": "a", "type": "tilt", "body": "lode", "maximum": "1 deg"},
            "body: body 'lode' does not exist; did you mean 'load'?",
        ),
        ({"name": "a", "type": "tilt", "body": "load", "maximum": "1 m"}, "maximum: '1 m'"),
        (
            {"name": "a", "type": "sling_angle", "ropes": ["sling_1"], "minimum": "50 deg"},
            "warning: is below 'minimum'",
        ),
        (
            {"name": "a", "type": "dynamic_factor", "load": "sling_1.tension", "operation": "inshore"},
            "neither 'static_load' nor",
        ),
        (
            {"name": "a", "type": "lug", "lugs": ["sling_1"]},
            "lugs.0: 'sling_1' is no lug; expected lugs or patterns of lugs: the case has none",
        ),
    ],
)
def test_what_makes_no_sense_is_one_line(folder, keys, words):
    with (folder / "case.toml").open("a") as file:
        file.write(criterion(**keys))
    with pytest.raises(InputError) as caught:
        load_case(folder)
    (line,) = str(caught.value).splitlines()
    assert "case.toml: criteria.0" in line
    assert words in line


def test_two_criteria_of_one_name(folder):
    with (folder / "case.toml").open("a") as file:
        file.write(criterion(**SLING) + criterion(**SLING))
    with pytest.raises(InputError, match=r"criteria\.1\.name: 'slings' is used before"):
        load_case(folder)


def test_a_mass_needs_gravity(folder):
    with (folder / "case.toml").open("a") as file:
        file.write(criterion(**(SLING | {"breaking_load": "6 t"})))
    load_case(folder)
    with pytest.raises(InputError, match=r"criteria\.0\.breaking_load: a mass without gravity"):
        load_case(folder, ["gravity="])


def test_points_of_what_deforms_need_a_sensor(tmp_path):
    source = Path(__file__).parents[3] / "cases" / "thin_plate_lift" / "case.toml"
    (tmp_path / "case.toml").write_text(
        source.read_text() + criterion(name="a", type="sling_angle", ropes=["rope_1"])
    )
    with pytest.raises(
        InputError, match=r"criteria\.0\.ropes\.0: where the point \(1, 1, 0\) of 'plate' is, is not"
    ):
        load_case(tmp_path)
    sensor = '[[sensors]]\nname = "eye"\nbody = "plate"\npoint = ["1 m", "1 m", 0]\n'
    (tmp_path / "case.toml").write_text((tmp_path / "case.toml").read_text() + sensor)
    assert load_case(tmp_path).criteria[0].ropes == ("rope_1",)


def test_a_run_that_ended_before_the_load_was_at_rest(judged, folder):
    """Records up to 10 s, the case to 20 s: what is at 15 s is not known, and not the last record."""
    text = (folder / "case.toml").read_text().replace("duration = 10", "duration = 20")
    (folder / "case.toml").write_text(text)
    with pytest.raises(
        InputErrors, match=r"the records end at 10 s; expected a run beyond 'static_at', 15 s"
    ):
        judged(criterion(**(SLING | {"dynamic_factor": 1.1, "static_at": "15 s"})))


def test_a_symmetric_lift_from_run_to_exit_code(folder):
    """Three slings at 120 deg, 4 m out, below a hook 6 m up: F = W / (n sin theta), 0.1 % more than the limit fails."""
    angle = math.atan2(6.0, 4.0)
    force = WEIGHT / (3.0 * math.sin(angle))
    text = (folder / "case.toml").read_text()
    text = text.replace("[-2, 3, 0]", f"[-2, {math.sqrt(12.0)}, 0]").replace(
        "[-2, -1, 0]", f"[-2, {-math.sqrt(12.0)}, 0]"
    )
    text = text.replace("duration = 10", "duration = 0")
    breaking = 3.16875 * force * 1.001
    text += criterion(**(SLING | {"breaking_load": breaking}))
    text += criterion(name="angle", type="sling_angle", ropes=["sling_*"])
    text += criterion(**(CRANE | {"radius": "35 m"}))
    (folder / "case.toml").write_text(text)
    verdict = judge_case(folder, out=folder / "out", overrides=[], force=False, log=Log(quiet=True))
    assert verdict.outcome is Outcome.COMPLETED
    sling, flat, crane = verdict.results
    assert sling.value == pytest.approx(force, rel=2e-5)
    assert flat.value == pytest.approx(angle, rel=2e-5)
    assert crane.value == pytest.approx(3.0 * force, rel=2e-5)
    change = f"criteria.0.breaking_load={breaking / 1.002}"
    verdict = judge_case(folder, out=folder / "out", overrides=[change], force=False, log=Log(quiet=True))
    assert verdict.outcome is Outcome.CHECK_FAILED
    assert int(verdict.outcome) == 1
    assert criteria_document(verdict)["criteria"][0]["passed"] is False
    table = criteria_table(verdict)
    assert table[0] == "slings: a criterion failed"
    assert table[1].startswith("  slings")
    assert table[1].endswith("FAILED")


def test_the_criteria_of_the_hoist_by_hand(tmp_path):
    """From the reference of the case, integrated apart from the solver; 3 digits of each line."""
    source = Path(__file__).parents[3] / "cases" / "hoist"
    verdict = judge_case(source, out=tmp_path / "out", overrides=[], force=False, log=Log(quiet=True))
    assert verdict.outcome is Outcome.COMPLETED
    load, radius, off, side, daf, rope, slack, share, rise = verdict.results
    tension = np.loadtxt(source / "tension.csv", delimiter=",", skiprows=1, usecols=1)
    position = np.loadtxt(source / "reference.csv", delimiter=",", skiprows=1, usecols=(1, 3))
    largest, smallest, g = tension.max(), tension.min(), 9.81
    assert load.value == pytest.approx(2.0 * largest + 40e3 * g, rel=1e-3)
    assert load.limit == pytest.approx((1600e3 - 0.6 * 400e3) * g, rel=1e-12)
    assert radius.value == pytest.approx(36.0)
    # both parts lead to the middle of the sheave, up to the square of its radius over the length
    assert off.value == pytest.approx(np.arctan2(abs(position[:, 0]), -position[:, 1]).max(), rel=1e-3)
    assert side.value == pytest.approx(0.0, abs=1e-12)
    assert daf.value == pytest.approx(2.0 * largest / (1000e3 * g), rel=1e-3)
    assert daf.limit == 1.10  # inshore, 300 to 1000 t
    assert rope.limit == pytest.approx(25e6 / (1.3 * 1.3 * 1.25 * 1.5), rel=1e-12)
    assert slack.value == pytest.approx(smallest, rel=1e-3)
    assert share.value == pytest.approx(1.0 - smallest / tension.mean(), abs=1e-3)
    assert rise.value == pytest.approx((position[-1, 1] - position[0, 1]) / 20.0, rel=1e-3)


def test_a_case_without_criteria_is_told(folder):
    with pytest.raises(InputError, match="no criteria"):
        judge_case(folder, out=folder / "out", overrides=[], force=False, log=Log(quiet=True))


def test_files_and_section_of_the_report(judged, folder, tmp_path):
    text = criterion(**SLING)
    text += criterion(
        name="daf", type="dynamic_factor", load="sling_1.tension", operation="inshore", static_load="3 t"
    )
    text += criterion(**(CRANE | {"radius": "39 m", "parts": 2}))
    with pytest.raises(InputErrors):
        judged(text)
    case = load_case(folder)
    out = folder / "out"
    found_results = Quantities(case, out).results
    judged_alone = judge(case, out, found_results)
    found = judged_alone.criteria
    missing = {name: briefly(error) for name, error in judged_alone.open_criteria.items()}
    assert [row.name for row in found] == ["slings", "crane"]
    assert list(missing) == ["daf"]
    assert str(tmp_path.parent) not in missing["daf"], "reports are read elsewhere"
    written = tmp_path / "written"
    written.mkdir()
    write_criteria(written, case, found, missing)
    document = json.loads((written / "criteria.json").read_text())
    assert (document["passed"], list(document["not_evaluated"])) == (False, ["daf"])
    assert document["criteria"][1]["utilisation"] == pytest.approx(60.0 / 44.0)
    assert document["criteria"][0]["sources"][3] == {"source": "0027/ND 7.4", "status": "memory"}
    with (written / "criteria.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["name"] for row in rows] == ["slings", "crane", "daf"]
    assert float(rows[1]["margin"]) == pytest.approx(-16e3)
    (section,) = criteria_section(case, out, found_results, found, missing, Album(written))
    assert list(section.items[0].passed) == [True, False, None]
    assert {path.name for path in written.glob("*.png")} == {
        "criteria.png",
        "crane_crane.png",
        "tensions_1.png",
    }
    verdict = _verdict(case, [], {}, simulated=True, judged=found, open_criteria=missing)
    assert (verdict.text, verdict.passed) == ("Failed: 1 of 3 criteria (crane); not evaluated: daf.", False)
    good = [row for row in found if row.passed]
    assert (
        "1 of 3 criteria (daf) could not"
        in _verdict(case, [], {}, simulated=True, judged=good, open_criteria=missing).text
    )


def test_a_run_that_stopped_has_not_passed(judged, folder, tmp_path):
    found = judged(criterion(**SLING))
    assert all(row.passed for row in found)
    write_criteria(tmp_path, load_case(folder), found, {}, "not_finite")
    assert json.loads((tmp_path / "criteria.json").read_text())["passed"] is False
