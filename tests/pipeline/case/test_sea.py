"""The sea in case files: what it means in SI, and names that checks may use."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS
from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.water import sea_gravity
from heavylift.pipeline.case.places import places
from heavylift.pipeline.case.tables import declared

HERE = Path(__file__).parents[1]


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "barge"
    made.mkdir()
    shutil.copyfile(HERE / "sea.toml", made / "case.toml")
    (made / "still.nc").write_bytes(b"read later")
    return made


def test_quantities_of_the_sea_are_in_si(folder):
    case = load_case(folder)
    assert (case.sea.density, case.sea.level, case.sea.water_depth) == (1025.0, 0.5, 50.0)
    assert sea_gravity(case) == 9.81  # of the bodies
    (wind,) = case.sea.wind
    assert wind.speed == pytest.approx(20.0 * 1852.0 / 3600.0, rel=1e-15)
    assert (wind.name, wind.averaging_time) == ("wind", 600.0)
    assert wind.direction == pytest.approx(math.pi / 2.0, rel=1e-15)
    assert case.sea.current[0].speed.speeds == (1.0, 0.2)
    damping = case.hulls["barge"].damping
    assert [damping[i][i] for i in range(6)] == [1e4, 1e4, 0.0, 0.0, 0.0, 1e6]
    assert sum(map(sum, damping)) == pytest.approx(1.02e6, rel=1e-14)
    assert case.hulls["barge"].kind == "clipped"
    assert case.tanks[0].masses == (0.0, 5e4)
    assert case.lines[0].sections[0].axial_stiffness == 3e8
    assert case.databases["still"].file_format == "netcdf"


def test_a_single_table_of_waves_is_a_list_of_one(folder):
    one = load_case(folder)
    text = (folder / "case.toml").read_text().replace("[sea.waves]", "[[sea.waves]]")
    (folder / "case.toml").write_text(text)
    assert load_case(folder).sea.waves == one.sea.waves
    assert one.sea.waves[0].gamma == 3.3


def test_gravity_of_water_is_its_own_or_the_standard_one(folder):
    assert sea_gravity(load_case(folder, ["sea.gravity=9.80665"])) == 9.80665
    bare = folder / "case.toml"
    bare.write_text(
        'title = "air"\n[bodies.a]\ntype = "rigid"\nmass = 1\ninertia = [1, 1, 1]\nframe = { motion = "free" }\n'
    )
    assert sea_gravity(load_case(folder)) == 9.80665


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("barge.displaced_volume", "m^3"),
        ("barge.buoyancy_centre", "m"),
        ("barge.ballast", "kg"),
        ("barge.wave_elevation", "m"),
        ("barge.wave_force", "N"),
        ("barge.radiation_moment", "N m"),
        ("barge.position", "m"),
        ("bow.seabed_length", "m"),
        ("bow.tension", "N"),
        ("pile.compression", "m"),
        ("wind.speed", "m/s"),
        ("current.direction", "rad"),
        ("house.force", "N"),
        ("underwater.yaw_moment", "N m"),
    ],
)
def test_channels_have_kinds(folder, name, unit):
    case = load_case(folder)
    assert case.quantity(f"channel.{name}.end").kind.unit == unit
    assert KINDS["volume"].unit == "m^3"


def test_channels_that_are_not_there_are_refused(folder):
    case = load_case(folder)
    for text in ("channel.house.yaw_moment.end", "channel.bow.force.end", "channel.peak.ballast.end"):
        with pytest.raises(InputError, match="unknown"):
            case.quantity(text)


def test_names_of_the_sea_are_declared():
    names = declared(
        {
            "bodies": {"a": {"type": "rigid", "frame": {"motion": "free"}}},
            "hulls": {"a": {}, "b": {}},
            "sea": {"wind": [{"name": "gale"}, {}], "current": {"speed": 1.0}},
            "lines": [{"name": "bow"}],
            "tanks": [{"name": "peak"}],
        }
    )
    assert names.hulls == {"a"}
    assert names.fluids == {"gale", "wind", "current"}
    assert names.lines == {"bow"}
    assert names.names["peak"] == names.names["gale"] == names.names["a"] == 1


def test_two_winds_need_names(folder):
    text = (folder / "case.toml").read_text()
    (folder / "case.toml").write_text(text.replace("[sea.wind]", "[[sea.wind]]\nspeed = 3\n\n[[sea.wind]]"))
    with pytest.raises(InputError, match="'wind' is the name of a wind or current"):
        load_case(folder)


def test_places_in_the_file_are_known(folder):
    found = places(load_case(folder))
    assert found["wind"] == "sea.wind"
    assert found["bow"] == "lines.0"
    assert found["underwater"] == "fluid_loads.1"
    assert found["barge"] == "bodies.barge"
    assert found["still"] == "databases.still"


def test_quantities_of_lines_hulls_and_checks_have_units(folder):
    case = load_case(folder)
    assert case.quantity("lines.bow.length").kind.unit == "m"
    assert case.quantity("hydrostatics.barge.GM_T").kind.unit == "m"
    assert case.quantity("hydrostatics.barge.volume").stage == "mesh"
    for text in ("lines.stern.length", "hydrostatics.barge.speed", "errors.nothing"):
        with pytest.raises(InputError, match="unknown"):
            case.quantity(text)


def test_blocks_write_out_hulls_and_lines(folder):
    text = (folder / "case.toml").read_text()
    block = """
[[repeat]]
count = 2
shift = [0, "100 m", 0]

[repeat.bodies."float{i}"]
type = "rigid"
mass = "615 t"
inertia = ["1e7 kg m^2", "1e7 kg m^2", "1e7 kg m^2"]
frame = { motion = "free" }

[[repeat.surfaces]]
name = "side{i}"
body = "float{i}"
shape = { type = "box", size = ["20 m", "15 m", "5 m"] }

[repeat.hulls."float{i}"]
surface = "side{i}"

[[repeat.lines]]
name = "quay{i}"
between = ["ground", "float{i}"]
points = [[0, "30 m", "5 m"], [0, "7 m", "2 m"]]
sections = [{ length = "30 m", weight = "20 N/m" }]
"""
    (folder / "case.toml").write_text(text + block)
    case = load_case(folder)
    assert [*case.hulls] == ["barge", "float0", "float1"]
    assert case.lines[2].points[0] == (0.0, 130.0, 5.0)
    assert case.lines[2].points[1] == (0.0, 7.0, 2.0)


@pytest.mark.slow
def test_reading_a_case_with_a_sea_imports_no_heavy_library(folder):
    code = (
        "import sys\n"
        "from heavylift.pipeline import load_case\n"
        f"load_case({str(folder)!r})\n"
        "heavy = {'numba', 'scipy', 'h5py', 'capytaine', 'xarray', 'matplotlib', 'pint'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"
