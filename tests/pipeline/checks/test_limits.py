"""Checks with limits, groups of quantities, and combinations of channels."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case
from heavylift.pipeline.checks import quantities as checks_module
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.commands.verify import check_table, verify_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.report.report import _check_section, _verdict
from heavylift.pipeline.results.histories import ChannelInfo, Results
from heavylift.pipeline.results.statistics import chosen_columns, run_statistics
from tests.pipeline.judged import judged_checks

TIMES = 0.1 * np.arange(101)
TENSIONS = {  # peaks of 10 kN, 30 kN and 20 kN at 1 s, 4 s and 9 s
    "sling_1.tension": 1e4 * np.exp(-((TIMES - 1.0) ** 2)),
    "sling_2.tension": 3e4 * np.exp(-((TIMES - 4.0) ** 2)),
    "sling_3.tension": 2e4 * np.exp(-((TIMES - 9.0) ** 2)),
}
EYE = np.column_stack([np.cos(TIMES), np.sin(TIMES), 5.0 + 0.0 * TIMES])


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "slings"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "slings.toml", folder / "case.toml")
    return folder


def results(metadata=None, **more):
    channels = {**TENSIONS, "eye.position": EYE, "eyelet.position": 3.0 * EYE, **more}
    infos, columns = {}, {}
    for name, values in channels.items():
        unit = "m" if values.ndim == 2 else "N"
        parts = ("x", "y", "z") if values.ndim == 2 else (name.partition(".")[2],)
        infos[name] = ChannelInfo(name, unit, parts, len(columns))
        columns[name] = values.reshape(len(values), -1)
    return Results(Path("results.h5"), TIMES, infos, columns, metadata or {})


def appended(folder, text):
    """The case with some more tables."""
    with (folder / "case.toml").open("a") as file:
        file.write(text)
    return load_case(folder)


@pytest.fixture
def checked(folder, monkeypatch):
    """Results of the checks in a text, on the histories above."""
    monkeypatch.setattr(checks_module, "load_results", lambda *_: results())

    def check(text):
        case = appended(folder, text)
        return case, judged_checks(case, folder / "out")

    return check


def entry(**keys):
    return "[[check]]\n" + "".join(f"{key} = {value}\n" for key, value in keys.items())


def quoted(**keys):
    return entry(**{key: json.dumps(value) for key, value in keys.items()})


@pytest.mark.parametrize(
    ("limits", "passed", "governing", "margin", "used"),
    [
        ({"maximum": "40 kN"}, True, "maximum", 1e4, 0.75),
        ({"maximum": 3e4}, True, "maximum", 0.0, 1.0),
        ({"maximum": "25 kN"}, False, "maximum", -5e3, 1.2),
        ({"maximum": -1.0}, False, "maximum", -30001.0, None),
        ({"minimum": "20 kN"}, True, "minimum", 1e4, None),
        ({"minimum": "31 kN"}, False, "minimum", -1e3, None),
        ({"minimum": "28 kN", "maximum": "35 kN"}, True, "minimum", 2e3, None),
        ({"minimum": "20 kN", "maximum": "35 kN"}, True, "maximum", 5e3, 3e4 / 3.5e4),
        ({"minimum": "10 kN", "maximum": "20 kN"}, False, "maximum", -1e4, 1.5),
    ],
)
def test_a_value_is_within_its_limits(checked, limits, passed, governing, margin, used):
    _, (check,) = checked(quoted(id="peak", quantity="channel.sling_2.tension.max", **limits))
    assert check.value == pytest.approx(3e4, rel=1e-12)
    assert (check.passed, check.governing[0]) == (passed, governing)
    assert check.margin == pytest.approx(margin, abs=1e-6)
    assert check.utilisation == (None if used is None else pytest.approx(used, rel=1e-12))
    assert check.where == "at 4 s"
    row = check.row()
    assert (row["reference"], row["error"], row["margin"]) == (None, None, check.margin)


def test_the_worst_of_a_group_is_named(checked):
    """Largest for a maximum, smallest for a minimum, farthest from a reference."""
    peaks = "channel.sling_*.tension.max"
    text = quoted(id="strong", quantity=peaks, maximum="25 kN")
    text += quoted(id="tight", quantity=peaks, minimum="5 kN")
    text += quoted(
        id="some", quantity="channel.sling_[13].tension.max", maximum="25 kN", source="certificate"
    )
    text += quoted(id="not_one", quantity="channel.sling_[!1].tension.max", minimum="15 kN")
    text += entry(
        id='"alike"', quantity=f'"{peaks}"', reference='"18 kN"', tolerance="{ relative = 0.5 }", source='"s"'
    )
    case, (strong, tight, some, not_one, alike) = checked(text)
    assert (strong.value, strong.passed, strong.where) == (3e4, False, "sling_2 at 4 s")
    assert (tight.value, tight.passed, tight.where) == (1e4, True, "sling_1 at 1 s")
    assert (some.value, some.passed, some.where) == (2e4, True, "sling_3 at 9 s")
    assert (not_one.value, not_one.where) == (2e4, "sling_3 at 9 s")
    assert (alike.where, alike.passed) == ("sling_2 at 4 s", False)
    assert alike.error == pytest.approx(12.0 / 18.0)
    checks = [strong, tight, some, not_one, alike]
    verdict = _verdict(case, checks, {}, simulated=True)
    assert verdict.text == "Failed: 2 of 5 checks (strong: sling_2 at 4 s, alike: sling_2 at 4 s)."
    fine = _verdict(case, [tight, some], {}, simulated=True)
    assert "at most 80 % of a limit is used, some: sling_3 at 9 s" in fine.text
    compared, limited = _check_section(checks, {}).items
    assert compared.rows[0][0] == "alike"
    assert limited.rows[0] == (
        "strong", "30000", "≤ 25000", "N", "120.0 %", "-5000", "sling_2 at 4 s", "(largest of 101 records)", "FAILED",
    )  # fmt: skip
    assert limited.passed == (False, True, True, True)


def test_members_of_a_group_without_an_extreme_are_named_alone(checked):
    _, (check,) = checked(quoted(id="mean", quantity="channel.sling_?.tension.mean", maximum="1 MN"))
    assert check.where == "sling_2"
    assert check.value == pytest.approx(TENSIONS["sling_2.tension"].mean(), rel=1e-12)


@pytest.mark.parametrize(
    ("quantity", "value"),
    [
        # at 1 s: the peak of the first less what the second has then
        ("channel.difference(sling_1.tension, sling_2.tension).max", 1e4 * (1.0 - 3.0 * math.exp(-9.0))),
        ("channel.ratio(sling_2.tension, sling_1.tension).end", 3.0 * math.exp(81.0 - 36.0)),
        ("channel.sum(sling_1.tension, sling_2.tension).end", 1e4 * math.exp(-81) + 3e4 * math.exp(-36)),
        ("channel.ratio(difference(sling_2.tension, sling_2.tension), sling_2.tension).max", 0.0),
        ("channel.difference(eyelet.position, eye.position).norm.max", 2.0 * math.sqrt(26.0)),
        ("channel.difference(eyelet.position, eye.position).z.min", 10.0),
        ("channel.difference(eyelet.position.z, eye.position.x).max", 15.0 - math.cos(9.4)),
        ("channel.ratio(eyelet.position, eye.position).x.min", 3.0),
        ("frequency.difference(eyelet.position, eye.position).x", 1.0 / (2.0 * math.pi)),
    ],
)
def test_combinations_of_channels(checked, quantity, value):
    _, (check,) = checked(quoted(id="combined", quantity=quantity, maximum=1e30))
    assert check.value == pytest.approx(value, rel=1e-6, abs=1e-12)
    assert check.unit == (
        "1" if "ratio" in quantity else "Hz" if "freq" in quantity else "m" if "eye" in quantity else "N"
    )


def test_shares_of_all_slings(checked):
    quantity = "channel.ratio(sling_*.tension, sum(sling_*.tension)).max"
    _, (check,) = checked(quoted(id="share", quantity=quantity, maximum="99.99 %"))
    total = sum(TENSIONS.values())
    shares = {name: (values / total).max() for name, values in TENSIONS.items()}
    assert check.value == pytest.approx(max(shares.values()), rel=1e-12)
    assert check.where.startswith(max(shares, key=shares.get).partition(".")[0])


@pytest.mark.parametrize(
    ("keys", "place", "words"),
    [
        ({"maximum": "25 kN", "reference": 3.0}, "maximum", "both 'reference' and 'maximum'"),
        ({"maximum": "25 kN", "tolerance": {"relative": 0.1}}, "maximum", "both 'tolerance' and 'maximum'"),
        ({"maximum": "25 m"}, "maximum", "'25 m' is a length"),
        ({"minimum": "3 kN", "maximum": "2 kN"}, "minimum", "3000 is not below the maximum, 2000"),
        ({}, "", "neither a reference nor a limit"),
        ({"reference": 3.0, "source": "s"}, "tolerance", "is missing"),
        ({"reference": 3.0, "tolerance": {"relative": 0.1}}, "source", "is missing"),
        ({"quantity": "channel.slng_*.tension.max"}, "quantity", "nearest are: sling_"),
        ({"quantity": "channel.sling_*.tnsion.max"}, "quantity", "did you mean 'tension'"),
        ({"quantity": "channel.*.position.x.max", "maximum": 1.0}, "maximum", ""),
        ({"quantity": "channel.ratio(sling_*.tension, ey*.position).max"}, "quantity", "2 patterns"),
        (
            {"quantity": "channel.difference(sling_1.tension, eye.position).max"},
            "quantity",
            "combines N with m",
        ),
        (
            {"quantity": "channel.difference(eye.position, eye.position.x).x.max"},
            "quantity",
            "combines 'eye.position', of components x, y, z, with 'eye.position.x', of one number",
        ),
        (
            {"quantity": "channel.difference(eye.position.x, eye.position).max"},
            "quantity",
            "combines 'eye.position.x', of one number, with 'eye.position', of components x, y, z",
        ),
        ({"quantity": "channel.difference(sling_1.tension).max"}, "quantity", "has 1 terms"),
        (
            {"quantity": "channel.diference(sling_1.tension, sling_2.tension).max"},
            "quantity",
            "mean 'difference'",
        ),
        ({"quantity": "channel.sum(sling_1.tension, sling_2.tension.max"}, "quantity", ""),
        (
            {"quantity": "channel.sum(sling_1.tension, sling_9.tension).max"},
            "quantity",
            "did you mean 'sling_",
        ),
        ({"quantity": "channel.eye.position.max"}, "quantity", "has 3 components"),
        ({"quantity": "channel.ey*.position.w.max"}, "quantity", "a component: x, y, z; or largest"),
        ({"quantity": "channel.sling_1.tension.x.max"}, "quantity", "which is one number"),
        (
            {"quantity": "channel.difference(eye.position.w, eye.position.x).max"},
            "quantity",
            "'eye.position' has no 'w'",
        ),
        ({"after": "3 s", "until": "3 s", "maximum": 1.0}, "until", "3 s is not later than 'after'"),
        ({"after": "3 N", "maximum": 1.0}, "after", "'3 N' is a force"),
        ({"quantity": "drift.energy", "after": 3.0, "maximum": 1.0}, "after", "a time with 'drift.energy'"),
        ({"quantity": "mesh.*.mass"}, "quantity", "no name fits '*'"),
        ({"quantity": "mesh.load.mass"}, "quantity", "a flexible body"),
        ({"quantity": "mesh.eye.mass"}, "quantity", "'eye' is no body"),
        ({"quantity": "ringdown.sling_1.1"}, "quantity", "'sling_1' is no body"),
    ],
)
def test_what_makes_no_sense_is_one_line(folder, keys, place, words):
    keys = {"id": "c", "quantity": "channel.sling_1.tension.max"} | keys
    limit = (
        {} if {"reference", "tolerance", "maximum", "source"} & set(keys) or not place else {"maximum": 1.0}
    )
    text = ", ".join(
        f"{key} = {{ relative = 0.1 }}" if key == "tolerance" else f"{key} = {json.dumps(value)}"
        for key, value in (keys | limit).items()
    )
    if words == "" and place == "maximum":
        load_case(folder, [f"check=[{{{text}}}]"])  # a pattern takes those that have the channel
        return
    with pytest.raises(InputError) as caught:
        load_case(folder, [f"check=[{{{text}}}]"])
    (line,) = str(caught.value).splitlines()
    assert f": check.0{'.' if place else ''}{place}: " in line
    assert words in line


def test_a_reference_is_one_number(folder):
    check = (
        'check=[{id="c", quantity="channel.sling_1.tension.max", source="s", tolerance={relative=0.1}, '
        'reference={quantity="channel.sling_*.tension.max"}}]'
    )
    with pytest.raises(InputError, match=r"check\.0\.reference.*is of 3 items.*one number"):
        load_case(folder, [check])


def test_the_deviation_of_a_combination_is_largest_at_some_time(checked, folder):
    """Compared with the rule ``2 cos t`` of the x of both eyes, but for a bump of 10 cm at 3 s."""
    rule = 2.0 * np.cos(TIMES) + np.where(np.isclose(TIMES, 3.0), 0.1, 0.0)
    rows = "".join(f"{t},{x}\n" for t, x in zip(TIMES.tolist(), rule.tolist(), strict=True))
    (folder / "rule.csv").write_text("time,x\n" + rows)
    text = (folder / "case.toml").read_text().replace("duration = 0", "duration = 10")
    (folder / "case.toml").write_text(text.replace('output_interval = "10 ms"', 'output_interval = "0.1 s"'))
    named = {"name": "rule", "channel": "difference(eyelet.position, eye.position)", "file": "rule.csv"}
    reference = quoted(**named).replace("[[check]]", "[[reference]]")
    case, (largest, mean) = checked(
        reference
        + quoted(id="largest", quantity="deviation.rule", maximum="11 cm")
        + quoted(id="mean", quantity="deviation.rule.rms", maximum="1 mm")
    )
    assert case.quantity("deviation.rule").kind.unit == "m"
    assert (largest.value, largest.where) == (pytest.approx(0.1, rel=1e-9), "at 3 s")
    assert (mean.value, mean.where) == (pytest.approx(0.1 / math.sqrt(101.0), rel=1e-9), "")
    assert not mean.passed


def test_a_study_of_a_group_has_a_reference_of_as_many(folder):
    study = (
        'converge={parameter="simulate.step", values=[0.002, 0.001], quantity="channel.sling_*.tension.max", '
    )
    load_case(folder, [study + "reference={run=0.0005}}"])
    with pytest.raises(InputError, match=r"converge\.reference: one value for a quantity of 3 items"):
        load_case(folder, [study + 'reference="3 kN"}'])


def test_a_ratio_that_divides_by_zero_says_when(checked):
    zero = np.where(TIMES > 4.95, 0.0, 1.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(checks_module, "load_results", lambda *_: results(**{"sling_1.tension": zero}))
        with pytest.raises(InputError, match=r"5 s.*divides by zero"):
            checked(
                quoted(id="c", quantity="channel.ratio(sling_2.tension, sling_1.tension).max", maximum=1.0)
            )


def test_the_largest_of_a_group_of_steps_is_when_its_interval_ended(folder):
    """The largest of all steps stands beside the records: at the record that ends its interval."""
    peak = np.where(np.isclose(TIMES, 6.0), 7e4, TENSIONS["sling_1.tension"])
    found = results({"sees_every_step": True, "steps": 10000}, **{"sling_1.tension_max": peak})
    quantities = Quantities(load_case(folder), folder / "out")
    quantities.__dict__["results"] = found
    assert quantities.number("channel.sling_1.tension.max") == 7e4
    assert quantities.time_of_extreme("channel.sling_1.tension.max") == pytest.approx(6.0)
    assert quantities.seen("channel.sling_1.tension.max") == "largest of 10,000 steps"
    assert quantities.time_of_extreme("channel.sling_1.tension.mean") is None
    assert quantities.evaluate("channel.sling_*.tension.max").tolist() == [7e4, 3e4, 2e4]


def test_a_check_of_a_part_of_the_run(checked):
    """Means, ends and rates of records within a time, both ends included; extremes there, and when."""
    values, inside = TENSIONS["sling_2.tension"], (TIMES > 4.95) & (TIMES < 8.05)
    span = {"after": "5 s", "until": "8000 ms"}
    expected = {
        "mean": values[inside].mean(),
        "end": values[80],
        "max": values[50],
    }
    text = "".join(
        quoted(id=word, quantity=f"channel.sling_2.tension.{word}", maximum="1 MN", **span)
        for word in expected
    )
    text += quoted(id="group", quantity="channel.sling_[23].tension.max", maximum="1 MN", until=3.0)
    text += quoted(id="later", quantity="channel.sling_2.tension.min", minimum=-1.0, after="9.95 s")
    reference = '{ quantity = "channel.sling_1.tension.max" }'
    text += entry(
        id='"pair"', quantity='"channel.sling_2.tension.end"', reference=reference,
        tolerance="{ relative = 0.9 }", source='"s"', until=0.5,
    )  # fmt: skip
    text += quoted(id="speed", quantity="channel.eye.position.x.rate", maximum=1.0, **span)
    _, found = checked(text)
    assert [check.value for check in found[:3]] == pytest.approx(list(expected.values()), rel=1e-12)
    largest, group, later, pair, speed = found[2:]
    assert speed.value == pytest.approx((np.cos(8.0) - np.cos(5.0)) / 3.0, rel=1e-12)
    assert (largest.where, largest.seen) == ("at 5 s", "largest of 101 records from 5 s to 8 s")
    assert found[0].seen == "from 5 s to 8 s"
    assert (group.where, group.seen) == ("sling_2 at 3 s", "largest of 101 records to 3 s")
    assert later.value == values[100]
    assert pair.reference == TENSIONS["sling_1.tension"][5]


def test_what_was_before_the_time_of_a_check_does_not_count(folder):
    """The interval that ends as it begins has an extreme of before; those between later records count."""
    peaks = np.where(np.isclose(TIMES, 6.0), 7e4, np.where(np.isclose(TIMES, 6.5), 6e4, 0.0))
    found = results({"sees_every_step": True, "steps": 10000}, **{"sling_1.tension_max": peaks})
    text = quoted(id="c", quantity="channel.sling_1.tension.max", maximum=1.0, after=6.0)
    case = appended(folder, text)
    quantities = Quantities(case, folder / "out")
    quantities.__dict__["results"] = found
    within = quantities.within(case.check[-1])
    assert within.number("channel.sling_1.tension.max") == 6e4
    assert within.time_of_extreme("channel.sling_1.tension.max") == pytest.approx(6.5)
    assert quantities.number("channel.sling_1.tension.max") == 7e4


def test_a_ratio_may_divide_by_zero_before_the_time_of_a_check(folder, monkeypatch):
    zero = np.where(TIMES < 2.0, 0.0, 2.0)
    monkeypatch.setattr(checks_module, "load_results", lambda *_: results(**{"sling_3.tension": zero}))
    ratio = "channel.ratio(sling_2.tension, sling_3.tension).max"
    case = appended(folder, quoted(id="c", quantity=ratio, maximum=1e9, after="2 s"))
    (check,) = judged_checks(case, folder / "out")
    assert check.value == pytest.approx(1.5e4, rel=1e-12)


def test_a_check_without_records_says_so(checked):
    with pytest.raises(InputError, match=r"c: there is no record from 11 s; .* which end at 10 s"):
        checked(quoted(id="c", quantity="channel.sling_1.tension.max", maximum=1.0, after="11 s"))


def test_the_report_plots_all_that_fits(folder):
    case = load_case(
        folder,
        ['report.channels=["sling_*.tension", "sum(sling_*.tension)", "sling_2.tension", "ey?.position"]'],
    )
    slings = tuple(f"sling_{i}.tension" for i in (1, 2, 3))
    assert case.report.channels == (*slings, "sum(sling_*.tension)", "eye.position")
    for given, words in (
        ('"slang_*.tension"', "nearest are: sling_"),
        ('"ratio(eye.position, sling_1.tension)"', "combines m with N"),
        ('"sling_*.tensoin"', "did you mean 'tension'"),
    ):
        with pytest.raises(InputError) as caught:
            load_case(folder, [f'report.channels=["load.position", {given}]'])
        assert ": report.channels.1: " in str(caught.value)
        assert words in str(caught.value)


def test_statistics_of_patterns_and_combinations():
    found = chosen_columns(
        results(), ["sling_*.tension", "sum(sling_*.tension)", "difference(eyelet.position, eye.position).z"]
    )
    assert [one.name for one in found] == [
        *TENSIONS,
        "sum(sling_*.tension)",
        "difference(eyelet.position, eye.position).z",
    ]
    assert [one.unit for one in found] == ["N"] * 4 + ["m"]
    for name, words in (
        ("ratio(sling_1.tension, eye.position)", "combines N with m"),
        ("slung_*.tension", "nearest are: sling_"),
        ("difference(eye.position, eyelet.position).w", "does not exist"),
        ("ratio(eye.position.z, eye.position.y)", "divides by zero at 0 s"),
    ):
        with pytest.raises(InputError, match=words):
            run_statistics(chosen_columns(results(), [name])[0], results(), 0.0)
    mean = run_statistics(found[3], results(), 0.0).record.mean
    assert mean == pytest.approx(sum(np.trapezoid(v, TIMES) for v in TENSIONS.values()) / TIMES[-1], rel=1e-3)


def test_static_shares_of_three_slings(folder):
    """Tensions over lengths of slings below one hook are as the barycentric coordinates of the centre of mass.

    The eyes are at (4, 0), (-2, 3) and (-2, -1), so the coordinates of the origin are 1/3, 1/6 and 1/2; the hook is 6 m
    above, the vertical forces are the weight of 30 kN times these. The slings stretch by 2e-5.
    """
    lengths = np.sqrt(36.0 + np.array([16.0, 13.0, 5.0]))
    tensions = 3e4 / 6.0 * np.array([1.0 / 3.0, 1.0 / 6.0, 0.5]) * lengths
    shares = tensions / tensions.sum()
    assert np.argmax(shares) == 2
    with (folder / "case.toml").open("a") as file:
        file.write(quoted(id="heavy", quantity="channel.sling_*.tension.end", maximum=1.01 * tensions[2]))
        share = "channel.ratio(sling_*.tension, sum(sling_*.tension)).end"
        file.write(
            quoted(
                id="share", quantity=share, minimum=float(shares[1]) - 1e-5, maximum=float(shares[2]) + 1e-5
            )
        )
        file.write(quoted(id="strict", quantity=share, maximum=float(shares[2]) - 1e-5))
    verdict = verify_case(folder, out=folder / "out", overrides=[], force=False, log=Log(quiet=True))
    assert verdict.outcome is Outcome.CHECK_FAILED
    heavy, share, strict = verdict.checks
    assert heavy.value == pytest.approx(tensions[2], rel=1e-5)
    assert heavy.utilisation == pytest.approx(1.0 / 1.01, rel=1e-5)
    assert (heavy.passed, share.passed, strict.passed) == (True, True, False)
    assert strict.value == pytest.approx(shares[2], abs=5e-6)
    lines = check_table(verdict)
    assert any(line.split()[0] == "strict" and line.endswith("FAILED  (sling_3)") for line in lines)


SWINGS = {"sling_1.tension": 3e4 * np.sin(TIMES) - 1e4}
"""Between -40 kN and 20 kN."""


def test_an_amount_has_no_sign(folder, monkeypatch):
    """Largest at 4.7 s, where the sine is -1: 40 kN; of the records nearest to it."""
    monkeypatch.setattr(checks_module, "load_results", lambda *_: results(**SWINGS))
    text = quoted(id="amount", quantity="channel.sling_1.tension.absolute", maximum="30 kN")
    text += quoted(id="early", quantity="channel.sling_1.tension.absolute", maximum="30 kN", until="2 s")
    text += quoted(id="least", quantity="channel.sling_1.tension.absolute", minimum="39 kN")
    amount, early, least = judged_checks(appended(folder, text), folder / "out")
    assert amount.value == pytest.approx(4e4, rel=1e-3)
    assert (amount.passed, amount.where) == (False, "at 4.7 s")
    assert early.value == pytest.approx(3e4 * np.sin(1.6) - 1e4, rel=1e-3)
    assert (early.passed, least.passed) == (True, True)


@pytest.mark.parametrize(
    ("statistic", "limit", "told"),
    [
        ("max", {"maximum": "25 kN"}, "the smallest is -399"),
        ("max", {"maximum": "45 kN"}, ""),
        ("min", {"minimum": "-45 kN"}, ""),
        ("min", {"minimum": "-15 kN"}, "the largest is 199"),
        ("max", {"maximum": "25 kN", "minimum": "-50 kN"}, ""),
        ("absolute", {"maximum": "25 kN"}, ""),
        ("max", {"minimum": "10 kN"}, ""),
    ],
)
def test_a_limit_on_one_side_tells_of_the_other(folder, monkeypatch, statistic, limit, told):
    monkeypatch.setattr(checks_module, "load_results", lambda *_: results(**SWINGS))
    text = quoted(id="one", quantity=f"channel.sling_1.tension.{statistic}", **limit)
    (check,) = judged_checks(appended(folder, text), folder / "out")
    assert check.note.startswith(told) if told else not check.note
    assert ("'absolute' judges both sides" in check.note) == bool(told)


def test_a_criterion_judges_amounts_and_tells_of_the_other_side(folder, monkeypatch):
    from heavylift.pipeline.checks.judge import judge

    monkeypatch.setattr(checks_module, "load_results", lambda *_: results(**SWINGS))
    text = ""
    for name, statistic in (("side", "max"), ("amount", "absolute")):
        keys = {
            "name": name,
            "type": "limit",
            "quantity": f"channel.sling_1.tension.{statistic}",
            "maximum": "30 kN",
        }
        text += "[[criteria]]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())
    side, amount = judge(appended(folder, text), folder / "out", checks=False).criteria
    assert (side.passed, amount.passed) == (True, False)
    assert "'absolute' judges both sides" in side.note
    assert amount.value == pytest.approx(4e4, rel=1e-3)
    assert amount.time == pytest.approx(4.7)
