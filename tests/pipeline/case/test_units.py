"""Quantities with units: the table agrees with pint, dimensions are checked."""

from __future__ import annotations

import math
import subprocess
import sys

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS, UNITS, parse_quantity, parse_unit

OURS = {"te", "ton", "tons", "tonf", "ton_force", "tonne_force", "Nm", "mNm", "kNm", "MNm", "GNm"}
"""Words that pint reads otherwise, or not: a ton there has 2000 lb."""


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("20 tons", "mass", 20e3),
        ("20 ton", "mass", 20e3),
        ("20 te", "mass", 20e3),
        ("2 mNm", "moment or energy", 2e-3),
        ("20 tonnes", "mass", 20e3),
        ("20 metric_tons", "mass", 20e3),
        ("1 short_ton", "mass", 2000 * 0.45359237),
        ("1 long_ton", "mass", 2240 * 0.45359237),
        ("1 ton_force", "force", 9806.65),
        ("1 tf/m", "force per length", 9806.65),
        ("3 kNm", "moment or energy", 3000.0),
        ("1 nautical_mile", "length", 1852.0),
        ("1 kt", "velocity", 1852.0 / 3600.0),
        ("1 lb", "mass", 0.45359237),
        ("1 long_hundredweight", "mass", 112 * 0.45359237),
        ("1 imperial_gallon", "volume", 4.54609e-3),
    ],
)
def test_words_of_weight_and_volume_mean_what_a_yard_means(text, kind, value):
    assert parse_quantity(text, KINDS[kind]) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    "text",
    [
        "20 mt",
        "1 Mt",
        "1 kiloton",
        "1 force_ton",
        "3 miles",
        "2 gallons",
        "4 hundredweight",
        "1 cwt",
        "5 bbl",
    ],
)
def test_words_that_differ_between_countries_are_refused(text):
    with pytest.raises(InputError, match="may mean several units; expected"):
        parse_unit(text.split()[1])


FEET = {
    f"{name}{plural}": (feet, "foot")
    for name, feet in (("fathom", 6.0), ("chain", 66.0), ("furlong", 660.0))
    for plural in ("", "s")
}


def test_every_unit_of_the_table_has_the_factor_and_dimension_of_pint():
    pint = pytest.importorskip("pint")
    registry = pint.UnitRegistry()
    for name, (factor, dimension) in UNITS.items():
        if name in {"1", "%"} or name in OURS:
            continue
        # versions of pint disagree on what is measured in feet, international ones or those of the American survey
        base = registry.Quantity(*FEET.get(name, (1.0, name))).to_base_units()
        assert base.magnitude == pytest.approx(factor, rel=1e-14), name
        exponents = {str(unit): power for unit, power in base.unit_items()}
        names = ("meter", "kilogram", "second", "radian")
        assert tuple(exponents.get(unit, 0.0) for unit in names) == tuple(dimension), name


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("95 mm", "length", 0.095),
        ("0.2 us", "time", 2e-7),
        ("7987 kg/m^3", "density", 7987.0),
        ("7.987e-9 t/mm^3", "density", 7987.0),
        ("210 GPa", "pressure", 210e9),
        ("210000 N/mm**2", "pressure", 210e9),
        ("0.25 km/h", "velocity", 0.25 / 3.6),
        ("3 t", "mass", 3000.0),
        ("-9.80665 m/s^2", "acceleration", -9.80665),
        ("60 rpm", "angular velocity", 2.0 * math.pi),
        ("180 deg", "angle", math.pi),
        ("2 N m", "moment or energy", 2.0),
        ("1.5 m kg^0.5 / s", "modal velocity", 1.5),
        ("4 N/(mm^2)", "pressure", 4e6),
        ("5 %", "number", 0.05),
        ("7", "number", 7.0),
        (3, "length", 3.0),
        ("10 fathom", "length", 18.288),  # whatever the version of pint
        ("2 furlong", "length", 402.336),
        ("2 light_year", "length", 2 * 299792458.0 * 365.25 * 86400.0),  # pint knows it, the table does not
        ("1 arcmin", "angle", math.pi / 10800.0),
    ],
)
def test_quantities_are_si(text, kind, value):
    assert parse_quantity(text, KINDS[kind]) == pytest.approx(value, rel=4e-16, abs=0.0) or parse_quantity(
        text, KINDS[kind]
    ) == pytest.approx(value, rel=1e-13)


def test_decimal_prefixes_round_once():
    assert parse_quantity("0.2 us", KINDS["time"]) == 2e-7
    assert parse_quantity("34.22 mm", KINDS["length"]) == 0.03422


@pytest.mark.parametrize(
    ("value", "kind", "words"),
    [
        ("3 s", "length", ["'3 s' is a time", "length [m]"]),
        ("50 Hz", "angular velocity", ["is a frequency", "an angular velocity [rad/s]"]),
        ("steel", "density", ["'steel' is not a number"]),
        ("3", "length", ["has no unit", "3 m"]),
        ("3 mmm", "length", ["'mmm' is not a unit"]),
        ("3 kg/m^", "density", ["not understood"]),
        ("3 kg/(m", "density", ["parentheses"]),
        ("3 degC", "length", ["kelvin"]),
        ("nan", "length", ["not finite"]),
        ("1e999 m", "length", ["not finite"]),
        ("1e300 m", "length", ["'1e300 m' is too large", "a length [m] up to 1e+100 m"]),
        (-1e155, "length", ["too large"]),
        (math.nan, "length", ["not finite"]),
        (math.inf, "time", ["not finite"]),
        (True, "number", ["not a number"]),
        (None, "mass", ["not a number"]),
        ([1.0], "mass", ["not a number"]),
    ],
)
def test_what_is_no_such_quantity_is_refused_with_what_was_expected(value, kind, words):
    with pytest.raises(InputError) as caught:
        parse_quantity(value, KINDS[kind])
    for word in words:
        assert word in str(caught.value)


def test_units_of_the_kinds_have_their_dimension():
    for kind in KINDS.values():
        factor, dimension = parse_unit(kind.unit)
        assert dimension == kind.dimension
        assert factor == 1.0


def test_common_units_do_not_import_pint():
    code = (
        "import sys; from heavylift.numerics.units import KINDS, parse_quantity;"
        "parse_quantity('7987 kg/m^3', KINDS['density']); sys.exit('pint' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
