"""Mistakes in the sea of a case: one clear error each, with the key in the file, the value, and what was expected."""

from __future__ import annotations

import importlib.util
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.assemble.hulls import assemble_radiation, hull_surface, resting_position
from heavylift.pipeline.assemble.lines import assemble_lines
from heavylift.pipeline.assemble.sea import make_waves
from heavylift.pipeline.results.storage import OutputFolder

LINEAR = (
    "hulls.barge.linear={volume = 1, centre_of_buoyancy = [0, 0, 0], reference = [0, 0, 0], area = 1, "
    "second_moments = [1, 1, 0]}"
)
PIPELINE = Path(__file__).parents[1] / "pipeline"


def _helper():
    spec = importlib.util.spec_from_file_location("sea_database", PIPELINE / "sea_database.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def database():
    return _helper().smooth_database()


@pytest.fixture
def folder(tmp_path, database, numbers_of_no_hull):
    from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf

    made = tmp_path / "barge"
    made.mkdir()
    shutil.copyfile(PIPELINE / "sea.toml", made / "case.toml")
    write_netcdf(made / "still.nc", database)
    return made


def errors_of(folder, *overrides):
    """All errors of a case with overrides; fails if there are none."""
    with pytest.raises(InputError) as caught:
        load_case(folder, overrides)
    return getattr(caught.value, "errors", [caught.value])


@pytest.mark.parametrize(
    ("overrides", "key", "problem", "expected"),
    [
        (["sea.density=1.025"], "sea.density", "1.025 is too small", "> 500 kg/m^3"),
        (["sea.depth=0"], "sea.depth", "0 is too small", "> 0 m"),
        (["sea.gravity=1.62"], "sea.gravity", "too small", "> 5 m/s^2"),
        (["sea.gravity=9.7"], "sea.gravity", "bodies have 9.81", "the same"),
        (["sea.wind.speed=80"], "sea.wind.speed", "80 m/s", 'in knots "80 knot" is 41.16 m/s'),
        (["sea.wind.speed=-3"], "sea.wind.speed", "too small", ">= 0 m/s"),
        (["sea.wind.direction=45"], "sea.wind.direction", "45 rad is more than a turn", '"45 deg"'),
        (["sea.wind.direction=45 m"], "sea.wind.direction", "is a length", "an angle [rad]"),
        (["sea.wind.averaging_time=2 h"], "sea.wind.averaging_time", "7200 s", "up to an hour"),
        (["sea.wind.gust=3 s"], "sea.wind.gust", "both 'gust' and 'spectrum'", "a constant gust, or"),
        (["sea.wind.exponent=0.1"], "sea.wind.exponent", "profile 'log'", "profile 'power'"),
        (["sea.current.speed=12"], "sea.current.speed", "12 m/s", "in knots"),
        (["sea.current.speed.depths=[3, 1]"], "sea.current.speed.depths", "depths [3.0, 1.0]", "increasing depths"),
        (["sea.waves.type=regulr"], "sea.waves", "type = 'regulr'", "'regular', 'jonswap'"),
        (["sea.waves.significant_height=150"], "sea.waves.significant_height", "150 m", "is it in metres?"),
        (["sea.waves.peak_period=0.2"], "sea.waves.significant_height", "beyond breaking", "at most"),
        (["sea.waves.peak_period=90"], "sea.waves.peak_period", "90 s", "is it in seconds?"),
        (["sea.waves.direction=30"], "sea.waves.direction", "more than a turn", '"30 deg"'),
        (["sea.waves.direction=1000 deg"], "sea.waves.direction", "1000 deg is more than a turn", '"280 deg"'),
        (["sea.waves.direction=-400 deg"], "sea.waves.direction", "-400 deg is more than a turn", '"320 deg"'),
        (["fluid_loads.0.name=wind"], "fluid_loads.0.name", "name of a wind or current", "'name' in [sea.wind]"),
        (["fluid_loads.0.name=current"], "fluid_loads.0.name", "name of a wind or", "'name' in [sea.current]"),
        (["sea.waves.seed=-1"], "sea.waves.seed", "-1 is too small", ">= 0"),
        (["sea.waves.gamma=33"], "sea.waves.gamma", "33 is too large", "<= 10"),
        (["sea.excitation=series", "simulate.duration=0", "simulate.start=equilibrium"], "sea.excitation",
         "without a duration", "'summed'"),
        (["hulls.barge.surface=skn"], "hulls.barge.surface", "did you mean 'skin'?", "one of: skin"),
        (["hulls.barge.restoring=none", "hulls.barge.damping=[1, 2]"], "hulls.barge.damping", "[1, 2]", "6"),
        ([LINEAR], "hulls.barge.linear", "both 'surface' and 'linear'", "must not count"),
        (["hulls.barge.surface="], "hulls.barge", "neither 'surface' nor 'linear'", "restoring 'none'"),
        (["hulls.barge.low_pass=5"], "hulls.barge.low_pass", "5 is too large", "< 1 rad/s"),
        (["bodies.barge.frame.motion=fixed"], "hulls.barge", "is not free", "a fixed joint to the ground"),
        (['databases.still.hulls=["ship"]'], "databases.still.hulls.0", "hull 'ship' does not exist", "barge"),
        (["databases.still.file=nothing.nc"], "databases.still.file", "does not exist", "a file in"),
        (["databases.still.file=case.toml"], "databases.still.file", "unknown ending", ".nc, .h5, .out"),
        (["databases.still.compute={panel_size = 2, frequencies = {first = 0.1, last = 2, count = 9}}"],
         "databases.still", "both 'file' and 'compute'", "one of them"),
        (["databases.still.length_scale=10 m"], "databases.still.length_scale", "format 'netcdf'", "'wamit'"),
        (["databases.still.memory=direct", "simulate.step=", "simulate.tolerance=1e-4"],
         "databases.still.memory", "without a fixed step", "'exponentials'"),
        (["tanks.0.mass=3"], "tanks.0", "both 'mass' and 'times'", "one of them"),
        (["tanks.0.hull=ship"], "tanks.0.hull", "hull 'ship' does not exist", "barge"),
        (["fluid_loads.0.fluid=wnd"], "fluid_loads.0.fluid", "did you mean 'wind'?", "current, wind"),
        (["fluid_loads.0.elements.0.area="], "fluid_loads.0.elements.0", "neither 'area' nor 'areas'", "one"),
        (["fluid_loads.1.cx=[1, 2]"], "fluid_loads.1.angles", "3 angles, 2, 3 and 3", "one cx, cy and cn each"),
        (["lines.0.sections.0.length=10 m"], "lines.0.fairlead_tension", "0 sections without 'length'", "one"),
        (["lines.0.fairlead_tension="], "lines.0.sections.0.length", "is missing", "'fairlead_tension'"),
        (["lines.0.friction=-1"], "lines.0.friction", "too small", ">= 0"),
        (["lines.0.clumps=[10]"], "lines.0.clumps", "1 clumps at 0 joints", "one weight"),
        (["sea.depth="], "lines.0.on_seabed", "deep water", "'depth' in [sea]"),
        (["fenders.0.stiffness="], "fenders.0", "neither 'stiffness' nor", "a table"),
        (["sea=", "fluid_loads="], "hulls", "[hulls] without [sea]", "a [sea] table"),
        (["gravity="], "gravity", "no [gravity] in a case with hulls", "along -z"),
        (["check.0.quantity=channel.barge.wave_power.end"], "check.0.quantity", "unknown", "wave_force"),
    ],
)  # fmt: skip
def test_each_mistake_is_one_error_at_its_key(folder, overrides, key, problem, expected):
    found = errors_of(folder, *overrides)
    assert len(found) == 1, [str(error) for error in found]
    assert found[0].key == key
    assert problem in found[0].problem
    assert expected in found[0].expected


def test_a_misspelt_key_is_told_with_the_right_one(folder, edit):
    edit(folder, ("spectrum = { seed", "spektrum = { seed"))
    (error,) = errors_of(folder)
    assert error.key == "sea.wind.spektrum"
    assert "did you mean 'spectrum'?" in error.problem


def test_several_mistakes_are_told_at_once(folder):
    overrides = ("sea.density=1.025", "sea.wind.speed=80", "lines.0.friction=-1", "tanks.0.hull=ship")
    assert {error.key for error in errors_of(folder, *overrides)} == {
        "sea.density",
        "sea.wind.speed",
        "lines.0.friction",
        "tanks.0.hull",
    }


def test_a_file_of_waves_that_is_none(folder):
    (folder / "record.csv").write_text("t,eta\n0,1\n1,2\n")
    waves = 'sea.waves={type = "elevation", file = "record.csv"}'
    (error,) = errors_of(folder, waves)
    assert error.key == "sea.waves.file"
    assert "'time,elevation'" in error.expected
    (folder / "record.csv").write_text("time,elevation\n0,1\n0,2\n")
    (error,) = errors_of(folder, waves)
    assert "line 3" in error.problem
    assert "increases" in error.expected


def test_an_elevation_with_unequal_steps_names_the_table(folder):
    rows = "".join(f"{t},{0.1 * t}\n" for t in (0, 1, 2, 3, 4, 5, 6, 7.5, 9))
    (folder / "record.csv").write_text(f"time,elevation\n{rows}")
    case = load_case(folder, ['sea.waves={type = "elevation", file = "record.csv"}'])
    with pytest.raises(InputError, match="not equally spaced") as caught:
        make_waves(case)
    assert str(case.file) in str(caught.value.source)
    assert caught.value.key.startswith("sea.waves")


def _radiation(folder):
    with pytest.raises(InputError) as caught:
        assemble_radiation(load_case(folder), OutputFolder(folder / "out"))
    return caught.value


def test_negative_damping_in_a_database(folder):
    import h5py

    with h5py.File(folder / "still.nc", "r+") as file:
        file["radiation_damping"][11, 2, 2] *= -1.0
    error = _radiation(folder)
    assert "1.2 rad/s: negative damping drives heave" in error.problem
    assert error.key == "damping"
    assert "still.nc" in str(error.source)


def test_a_database_of_two_hulls_for_one(folder, database):
    from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf

    n = np.s_[:, :6, :6]
    wide = np.zeros((len(database.omega), 12, 12))
    wide[n], wide[:, 6:, 6:] = database.damping, database.damping
    added = np.kron(np.eye(2), database.added_mass_infinite)
    two = replace(
        database,
        bodies=("a", "b"),
        damping=wide,
        added_mass=np.repeat(added[None], len(wide), axis=0),
        added_mass_infinite=added,
        excitation=np.tile(database.excitation, (1, 1, 2)),
        reference_points=np.zeros((2, 3)),
    )
    write_netcdf(folder / "still.nc", two)
    error = _radiation(folder)
    assert "1 hulls for a database of 2" in error.problem
    assert error.key == "databases.still.hulls"


def _pack(folder, *overrides):
    """What packing the forces of the waves says of a case."""
    from heavylift.solver.water.waves.excitation_packing import pack_summed

    case = load_case(folder, overrides)
    (radiation,) = assemble_radiation(case, OutputFolder(folder / "out"))
    with pytest.raises(InputError) as caught:
        pack_summed(make_waves(case), radiation.database, yaws=np.zeros(1), ramp=0.0, with_drift=False)
    return caught.value


def test_a_wave_period_beyond_the_database(folder):
    error = _pack(folder, 'sea.waves={type = "regular", height = 0.1, period = 1.5}')
    assert "4.19" in error.problem or "1.5" in error.problem
    assert "4 rad/s" in f"{error.problem} {error.expected}"


def test_a_heading_outside_the_database(folder, database):
    from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf

    part = np.s_[:, :10]
    write_netcdf(
        folder / "still.nc",
        replace(
            database,
            headings=database.headings[:10],
            excitation=database.excitation[part],
            symmetric=False,
        ),
    )
    error = _pack(folder, 'sea.waves={type = "regular", height = 1, period = 8, direction = "135 deg"}')
    assert "135" in error.problem or "2.35" in error.problem


def test_a_leaking_hull_and_one_that_is_inside_out(folder):
    # a box without its bottom, and one whose triangles all face inward
    case = load_case(folder)
    surface = hull_surface(case, "barge", OutputFolder(folder / "out"))
    flat = surface.points[surface.triangles][:, :, 2].max(axis=1) < 0.0
    for name, triangles, problem in (
        ("open", surface.triangles[~flat], "open"),
        ("inverted", surface.triangles[:, ::-1], "inside"),
    ):
        text = "".join(
            "facet normal 0 0 0\nouter loop\n"
            + "".join(f"vertex {x!r} {y!r} {z!r}\n" for x, y, z in surface.points[row].tolist())
            + "endloop\nendfacet\n"
            for row in triangles
        )
        (folder / f"{name}.stl").write_text(f"solid {name}\n{text}endsolid {name}\n")
        broken = load_case(folder, ["surfaces.0.shape=", f"surfaces.0.file={name}.stl"])
        with pytest.raises(InputError) as caught:
            resting_position(broken, "barge", OutputFolder(folder / "out"))
        assert problem in f"{caught.value.problem} {caught.value.expected}".lower()


SHORT = ["lines.0.fairlead_tension=", "lines.0.sections.0.length=150 m"]
LONG = ["lines.0.fairlead_tension=", "lines.0.sections.0.length=400 m", "lines.0.on_seabed="]


@pytest.mark.parametrize(
    ("overrides", "key", "problem"),
    [
        (SHORT, "lines.0.sections", "the line of 150 m is shorter than its span of"),
        ([*LONG, "lines.0.seabed=-40"], "lines.0.points", "the anchor at height -49.5 m is 9.5 m below the seabed"),
        ([*LONG, "lines.0.seabed=8"], "lines.0.points", "the anchor at height -49.5 m is 57.5 m below the seabed"),
        (
            [*LONG, "lines.0.seabed=-49.5", "lines.0.seabed_slope={angle = '40 deg'}"],
            "lines.0.points",
            "m below the seabed",
        ),
        (
            [*LONG, "lines.0.seabed=-60", "lines.0.sections.0.weight=-10"],
            "lines.0.sections.0.weight",
            "weight is -10 of a line that hangs over a seabed by both ends",
        ),
    ],
)  # fmt: skip
def test_a_line_that_cannot_hang_is_told_alike_of_a_case_and_of_a_scene(folder, overrides, key, problem):
    """`heavylift lines` assembles lines, `heavylift simulate` packs them as well."""
    from heavylift.pipeline.assemble.described import assemble
    from heavylift.pipeline.assemble.frames import assemble_rigid
    from heavylift.pipeline.assemble.sides import start_sides
    from heavylift.solver.water.lines.packing import pack_mooring_lines

    case = load_case(folder, overrides)
    barge, origin = assemble_rigid("barge", case.bodies["barge"])
    sides = start_sides([barge], {"barge": origin})
    with pytest.raises(InputError) as of_case:
        assemble_lines(case, sides)
    assert of_case.value.key == key
    assert problem in of_case.value.problem
    line = replace(assemble(case.lines[0], sides, case.folder), on_seabed=False)
    if line.seabed is None:
        line = replace(line, seabed=-49.5)  # the sea of the case
    ends = [(line.point_a, barge.position + line.point_b)]
    with pytest.raises(InputError) as of_scene:
        pack_mooring_lines([line], [(0, 1)], [0], ends)
    assert of_scene.value.source == "bow"
    assert of_scene.value.problem == of_case.value.problem
    assert of_scene.value.expected == of_case.value.expected


def test_an_anchor_said_to_be_on_the_bottom_of_the_sea_is_there(folder):
    from heavylift.pipeline.assemble.frames import assemble_rigid
    from heavylift.pipeline.assemble.sides import start_sides

    case = load_case(folder, [*LONG[:2], "sea.depth=80 m"])
    barge, origin = assemble_rigid("barge", case.bodies["barge"])
    with pytest.raises(InputError, match="above the bottom of the sea") as caught:
        assemble_lines(case, start_sides([barge], {"barge": origin}))
    assert caught.value.key == "lines.0.points"


def test_a_tension_that_no_length_gives(folder):
    from heavylift.pipeline.assemble.frames import assemble_rigid
    from heavylift.pipeline.assemble.sides import start_sides

    case = load_case(folder, ["lines.0.fairlead_tension=1 kN"])
    barge, origin = assemble_rigid("barge", case.bodies["barge"])
    with pytest.raises(InputError, match="1000 N is less than") as caught:
        assemble_lines(case, start_sides([barge], {"barge": origin}))
    assert caught.value.key == "lines.0.fairlead_tension"


def test_a_missing_capytaine_names_the_extra(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "capytaine", None)
    compute = "databases.still.compute={panel_size = 2, frequencies = {first = 0.1, last = 2, count = 9}}"
    case = load_case(folder, ["databases.still.file=", compute])
    with pytest.raises(InputError, match="Capytaine is not installed") as caught:
        run_case(case, stages=("mesh",))
    assert "heavylift[hydro]" in caught.value.expected


def test_a_database_that_was_not_computed_says_how(folder):
    compute = "databases.still.compute={panel_size = 2, frequencies = {first = 0.1, last = 2, count = 9}}"
    case = load_case(folder, ["databases.still.file=", compute])
    with pytest.raises(InputError, match="has not been computed") as caught:
        assemble_radiation(case, OutputFolder(folder / "out"))
    assert "heavylift mesh" in caught.value.expected
