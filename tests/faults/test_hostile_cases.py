"""Case files that no person writes: too deep, too long, too large, or of numbers that no machine holds."""

from __future__ import annotations

import os
import time

import pytest

from heavylift.numerics.outcome import Outcome

DENSITY = '"7800 kg/m^3"'


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ('"1 km^400"', "exponent 400"),
        ('"1 GPa^20 GPa^20"', "beyond all numbers"),
        ('"1 kg/m^3/(nm^20 nm^20)"', "beyond all numbers"),
        ('"1 dB"', "is logarithmic"),
        ('"1 dimensionless"', "is a number"),
        ('"1 ' + "m" * 10**6 + '"', "1,000,002 characters"),
        ('"1' + " " * 10**6 + 'm"', "1,000,002 characters"),
        ('"1 ' + "(" * 5000 + '"', "5,002 characters"),
        ('"1' + "0" * 180 + ' km^20"', "is a quantity in m^20"),
        ("1" + "0" * 400, "bits"),
        ("1" + "0" * 5000, "Exceeds the limit"),
        ("0x" + "f" * 9000, "36000 bits"),
        ("-9223372036854775809", "64 bits"),
        ("[" * 5000 + "]" * 5000, "nested too deeply"),
        ("{a=" * 3000 + "1" + "}" * 3000, "nested too deeply"),
        ('"7800\\n\\u0007kg/m^3\\n\\u2028x"', "density"),
    ],
    ids=lambda value: value[:24],
)
def test_a_value_that_nobody_writes(heavylift, small_case, edit, value, words):
    edit(small_case, (DENSITY, value))
    begin = time.monotonic()
    result = heavylift("mesh", small_case)
    assert time.monotonic() - begin < 5.0
    assert result.code == Outcome.BAD_INPUT
    (line,) = result.error.splitlines()
    assert words in line
    assert str(small_case / "case.toml") in line
    assert len(line) < 2000
    assert "expected" in line


@pytest.mark.parametrize("name", ["a." * 4000 + "b", '"' + "k" * 10**6 + '"', '"two\\nlines"', '"\\u0000"'])
def test_a_key_that_nobody_writes(heavylift, small_case, name):
    with (small_case / "case.toml").open("a") as file:
        file.write(f"\n[more.{name}]\nx = 1\n")
    result = heavylift("mesh", small_case)
    assert result.code == Outcome.BAD_INPUT
    (line,) = result.error.splitlines()
    assert len(line) < 2000


@pytest.mark.parametrize(
    "change",
    [
        "bodies.beam.material.density=1" + "0" * 400,
        "sensors." + "9" * 5000 + ".name=a",
        "title=" + "[" * 9000,
    ],
    ids=["digits", "index", "depth"],
)
def test_an_override_that_nobody_writes(heavylift, small_case, change):
    result = heavylift("mesh", small_case, "--set", change)
    if not change.startswith("title"):  # a text
        assert result.code == Outcome.BAD_INPUT
        assert len(result.error.splitlines()) == 1


@pytest.mark.parametrize("how", ["folder", "pipe", "device", "loop", "large", "link"])
def test_a_case_file_that_is_none(heavylift, small_case, how):
    file = small_case / "case.toml"
    file.unlink()
    match how:
        case "folder":
            file.mkdir()
        case "pipe":
            os.mkfifo(file)
        case "device":
            file.symlink_to("/dev/zero")
        case "loop":
            file.symlink_to(file)
        case "large":
            with file.open("wb") as stream:
                stream.truncate(2**40)
        case "link":
            file.symlink_to("/nowhere")
    result = heavylift("mesh", small_case)
    assert result.code == Outcome.BAD_INPUT
    (line,) = result.error.splitlines()
    assert line.count(str(file)) == 1


@pytest.mark.parametrize("name", ["x" * 5000, "a\\u0000b", "loop", "pipe"])
def test_a_file_of_a_case_that_is_none(heavylift, small_case, edit, name):
    (small_case / "loop").symlink_to(small_case / "loop")
    os.mkfifo(small_case / "pipe")
    blocks = 'type = "blocks"\nadd = [{ name = "bar", from = [0, 0, 0], to = ["200 mm", "20 mm", "10 mm"] }]'
    edit(small_case, (blocks, f'type = "step"\nfile = "{name}"'), ('"hex8"', '"tet10"'), ("divisions", "# "))
    result = heavylift("mesh", small_case)
    assert result.code == Outcome.BAD_INPUT
    (line,) = result.error.splitlines()
    assert "bodies.beam.geometry.file" in line


def test_a_box_that_is_flat_against_its_length(heavylift, small_case, edit):
    """Planes nearer than a thousand-millionth of the body are one: nothing is left between them."""
    edit(
        small_case,
        ('["200 mm", "20 mm", "10 mm"] }', '["200 km", "20 nm", "10 nm"] }'),
        ("divisions = { x = [8], y = [1], z = [1] }", ""),
    )
    result = heavylift("mesh", small_case)
    assert result.code == Outcome.BAD_INPUT
    (line,) = result.error.splitlines()
    assert "bodies.beam.geometry.add: along y all boxes are thinner" in line
