"""From the sea of a case to the solver: waves, wind, lines, hulls and databases are what the case says."""

from __future__ import annotations

import csv
import importlib.util
import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.assemble.frames import assemble_rigid
from heavylift.pipeline.assemble.hulls import (
    assemble_radiation,
    database_manifest,
    hull_surface,
    linear_restoring,
    resting_position,
    stored_database,
)
from heavylift.pipeline.assemble.sea import assemble_sea, make_waves, sea_provenance
from heavylift.pipeline.assemble.sides import start_sides
from heavylift.pipeline.assemble.water import water_of
from heavylift.pipeline.case.hulls import DatabaseSection
from heavylift.pipeline.case.sea import SeaSection
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.log import Log
from heavylift.pipeline.report.sea import sea_sections
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.preprocess.surfaces.refinement import refined_triangles
from heavylift.solver.scene.sea import Radiation, Water
from heavylift.solver.water.wind.packing import fluid_pieces

pytestmark = pytest.mark.usefixtures("numbers_of_no_hull")

HERE = Path(__file__).parents[1]
CASES = HERE.parents[1] / "cases"
L, B, D = 40.0, 15.0, 5.0
MASS, DENSITY = 1.23e6, 1025.0
T = MASS / (DENSITY * L * B)


def _helper():
    spec = importlib.util.spec_from_file_location("sea_database", HERE / "sea_database.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "barge"
    made.mkdir()
    shutil.copyfile(HERE / "sea.toml", made / "case.toml")
    _helper().write_smooth_database(made / "still.nc")
    return made


def sides_of(case):
    bodies = [assemble_rigid(name, body) for name, body in case.bodies.items()]
    return start_sides([b for b, _ in bodies], {b.name: origin for b, origin in bodies})


def sea_of(folder, *overrides):
    case = load_case(folder, overrides)
    return assemble_sea(case, sides_of(case), OutputFolder(folder / "out"))


def test_water_waves_and_their_seed(folder):
    sea = sea_of(folder)
    assert (sea.water.density, sea.water.gravity, sea.water.level, sea.water.depth) == (
        1025.0,
        9.81,
        0.5,
        50.0,
    )
    assert (sea.ramp, sea.excitation, sea.duration) == (10.0, "summed", 20.0)
    assert sea.waves.seeds == (4,)
    assert sea.waves.significant_height == pytest.approx(1.5, rel=1e-6)
    assert np.all(sea.waves.direction == math.radians(30.0))
    # omega^2 = g k tanh(k h) of the water of the case
    k = sea.waves.wavenumber
    assert np.allclose(sea.waves.omega**2, 9.81 * k * np.tanh(50.0 * k), rtol=1e-10)
    again = make_waves(load_case(folder))
    assert np.array_equal(again.phase, sea.waves.phase)


def test_defaults_of_the_case_are_those_of_the_solver():
    for key in ("memory", "memory_length", "fit_error", "drift"):
        assert DatabaseSection.model_fields[key].default == Radiation.__dataclass_fields__[key].default
    for key in ("density", "level"):
        assert SeaSection.model_fields[key].default == Water.__dataclass_fields__[key].default


def test_trains_go_through_each_other(folder):
    both = (
        'sea.waves=[{type = "regular", height = 2, period = 9}, {type = "regular", height = 1, period = 6}]'
    )
    waves = make_waves(load_case(folder, [both]))
    assert waves.amplitude.tolist() == [1.0, 0.5]
    assert np.allclose(waves.omega, 2.0 * np.pi / np.array([9.0, 6.0]), rtol=1e-14)


def test_a_positive_phase_has_the_crest_at_the_origin_earlier(folder):
    table = 'sea.waves={type = "regular", height = 3, period = 8, phase = "90 deg", direction = "30 deg"}'
    waves = make_waves(load_case(folder, [table]))
    assert float(waves.elevation(0.0, 0.0, -2.0)) == pytest.approx(
        1.5, abs=1e-12
    )  # a quarter of a period before
    assert float(waves.elevation(0.0, 0.0, 0.0)) == pytest.approx(0.0, abs=1e-12)
    x, y, t = 7.0, -4.0, 3.3
    k, w = float(waves.wavenumber[0]), 2.0 * math.pi / 8.0
    along = x * math.cos(math.radians(30.0)) + y * math.sin(math.radians(30.0))
    expected = 1.5 * math.cos(k * along - w * t - math.radians(90.0))
    assert float(waves.elevation(x, y, t)) == pytest.approx(expected, abs=1e-12)


def test_a_measured_elevation_comes_back_at_its_place(folder):
    t = 0.5 * np.arange(64)
    eta = 0.7 * np.cos(2.0 * np.pi * 4 * t / 32.0 + 0.3) + 0.2 * np.sin(2.0 * np.pi * 9 * t / 32.0)
    rows = "\n".join(f"{a!r},{b!r}" for a, b in zip(t.tolist(), eta.tolist(), strict=True))
    (folder / "record.csv").write_text(f"# a gauge\ntime,elevation\n{rows}\n")
    table = 'sea.waves={type = "elevation", file = "record.csv", place = [12, -3], direction = "20 deg"}'
    waves = make_waves(load_case(folder, [table]))
    assert np.allclose(waves.elevation(12.0, -3.0, t), eta, atol=1e-12)


def test_a_spectrum_over_hertz_is_that_over_radians_a_second(folder):
    w = np.linspace(0.3, 2.5, 60)
    S = 0.4 * np.exp(-(((w - 0.9) / 0.2) ** 2))
    found = []
    for header, first, density in (
        ("omega,density", w, S),
        ("frequency,density", w / (2.0 * np.pi), 2.0 * np.pi * S),
    ):
        rows = "\n".join(f"{a!r},{b!r}" for a, b in zip(first.tolist(), density.tolist(), strict=True))
        (folder / "s.csv").write_text(f"{header}\n{rows}\n")
        found.append(
            make_waves(load_case(folder, ['sea.waves={type = "spectrum", file = "s.csv", seed = 1}']))
        )
    # 4 sqrt of the area under straight lines between the rows
    assert found[0].significant_height == pytest.approx(4.0 * math.sqrt(np.trapezoid(S, w)), rel=1e-9)
    assert np.allclose(found[0].amplitude, found[1].amplitude, rtol=1e-9)
    assert np.allclose(found[0].omega, found[1].omega, rtol=1e-12)


def test_wind_current_and_loads(folder):
    wind, current = sea_of(folder).fields
    assert wind.direction == pytest.approx(math.pi / 2.0)
    assert wind.fluctuation.seed == 7
    assert wind.fluctuation.duration >= 20.0
    assert current.speed.depths.tolist() == [0.0, 10.0]
    assert current.speed.speeds.tolist() == [1.0, 0.2]
    house, aft, under = fluid_pieces(sea_of(folder).loads)
    assert (house.name, house.area, house.coefficient) == ("house", 30.0, 1.1)
    assert (aft.name, aft.area, aft.extent) == ("house", (10.0, 12.0, 4.0), 3.0)
    assert (under.fluid, under.symmetric, under.length) == ("current", True, 40.0)
    assert np.transpose([under.cx, under.cy, under.cn]).tolist() == [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.05],
        [-1.0, 0.0, 0.0],
    ]
    assert np.allclose(under.angles, [0.0, np.pi / 2.0, np.pi])


def test_coefficients_may_stand_in_a_file_in_degrees(folder):
    (folder / "c.csv").write_text("angle_deg,cx,cy,cn\n0,1,0,0\n90,0,1,0.05\n180,-1,0,0\n")
    overrides = [f"fluid_loads.1.{key}=" for key in ("angles", "cx", "cy", "cn")]
    filed = sea_of(folder, *overrides, "fluid_loads.1.file=c.csv").loads[1]
    inline = sea_of(folder).loads[1]
    assert np.allclose(filed.angles, inline.angles, rtol=1e-15)
    for key in ("cx", "cy", "cn"):
        assert np.array_equal(getattr(filed, key), getattr(inline, key))


def test_points_of_tanks_lines_and_fenders_are_in_the_frames_of_bodies(folder):
    sea = sea_of(folder, "bodies.barge.frame.origin=centre_of_mass")  # 1 m above the origin of the geometry
    assert sea.tanks[0].point.tolist() == [15.0, 0.0, -2.0]
    assert sea.tanks[0].contents(1.0, sea.water)[1] == (1025.0 * 20.0, 1025.0 * 40.0)
    assert sea.lines[0].point_a.tolist() == [230.0, 0.0, -49.5]
    assert sea.lines[0].point_b.tolist() == [20.0, 0.0, 0.0]
    assert sea.lines[0].seabed == -49.5
    assert sea.fenders[0].point_b.tolist() == [-20.0, 0.0, 0.0]
    assert sea.hulls[0].reference.tolist() == [0.0, 0.0, -1.5]


def test_a_line_cut_in_two_has_the_length_of_the_whole(folder):
    """Two equal pieces, one of them of known length: the other one is what is left."""
    whole = sea_of(folder).lines[0].sections[0].length
    piece = 'weight = "800 N/m", axial_stiffness = "300 MN"'
    two = sea_of(folder, f'lines.0.sections=[{{length = "90 m", {piece}}}, {{{piece}}}]').lines[0]
    assert two.sections[0].length == 90.0
    assert two.sections[1].length == pytest.approx(whole - 90.0, rel=1e-9)


def test_linear_restoring_of_a_box_is_its_closed_form(folder):
    case = load_case(folder, ["tanks=", "hulls.barge.restoring=linear"])
    linear = linear_restoring(case, "barge", OutputFolder(folder / "out"))
    level = T - 0.5 * D  # of the water above the middle of the box
    assert linear.volume == pytest.approx(L * B * T, rel=1e-9)
    assert np.allclose(linear.reference, [0.0, 0.0, level], atol=1e-9)
    assert np.allclose(linear.centre_of_buoyancy, [0.0, 0.0, 0.5 * T - 0.5 * D], atol=1e-9)
    expected = [L * B, 0.0, 0.0, B * L**3 / 12.0, L * B**3 / 12.0, 0.0]
    assert np.allclose(linear.waterplane, expected, rtol=1e-9, atol=1e-6)


def test_a_hull_with_a_list_has_no_linear_restoring(folder):
    case = load_case(folder, ["tanks=", "bodies.barge.centre_of_mass=[0, 0.3, 1]"])
    with pytest.raises(InputError, match="floats with a list of"):
        linear_restoring(case, "barge", OutputFolder(folder / "out"))


def test_figures_of_a_floating_box_as_quantities(folder):
    case = load_case(folder, ["tanks="])
    found = Quantities(case, folder / "out")
    GM = 0.5 * T + B**2 / (12.0 * T) - (0.5 * D + 1.0)
    for name, value in (
        ("volume", L * B * T),
        ("draft", T),
        ("KB", 0.5 * T),
        ("GM_T", GM),
        ("displacement", MASS),
    ):
        assert found.number(f"hydrostatics.barge.{name}") == pytest.approx(value, rel=1e-9)
    assert found.number("hydrostatics.barge.origin_z") == pytest.approx(0.5 + 0.5 * D - T, rel=1e-9)


def test_righting_arms_of_the_box_case_are_those_of_its_section():
    from heavylift.preprocess.hydrodynamics.hull_surface import check_hull
    from heavylift.solver.water.hulls.hydrostatics import righting_arm_curve

    folder = CASES / "box_hydrostatics"
    lines = [s for s in (folder / "righting_arms.csv").read_text().splitlines() if not s.startswith("#")]
    rows = np.array([[float(v) for v in row] for row in list(csv.reader(lines))[1:]])
    case = load_case(folder)
    hull = check_hull(hull_surface(case, "barge", OutputFolder(folder / "nowhere")))
    body = case.bodies["barge"]
    water = water_of(case)
    curve = righting_arm_curve(
        hull,
        body.mass,
        body.centre_of_mass,
        np.radians(rows[:, 0]),
        density=water.density,
        gravity=water.gravity,
    )
    assert np.allclose(curve.arms, rows[:, 1], atol=1e-6)


@pytest.mark.slow
def test_databases_are_stored_once_and_read_again(folder):
    case = load_case(folder)
    first = run_case(case, stages=("mesh",))
    assert not first.stage("mesh").skipped
    about = database_manifest(first.folder)["still"]["properties"]
    assert about["source"] == "still.nc"
    assert about["frequency_range"] == [pytest.approx(0.1), pytest.approx(4.0)]
    assert about["memory"]["error"] <= 2.5e-3
    assert run_case(case, stages=("mesh",)).stage("mesh").skipped
    stored = stored_database(case, "still", first.folder)
    original = _helper().smooth_database()
    for key in ("omega", "added_mass", "damping", "excitation", "headings"):
        assert np.array_equal(getattr(stored, key), getattr(original, key))
    assert stored.source == "still.nc"
    # another memory is fitted anew, another file is read anew
    fewer = run_case(load_case(folder, ["databases.still.fit_error=0.05"]), stages=("mesh",))
    poles = database_manifest(fewer.folder)["still"]["properties"]["memory"]["poles"]
    assert fewer.stage("mesh").skipped
    assert poles < about["memory"]["poles"]
    content = (folder / "still.nc").read_bytes()
    (folder / "still.nc").write_bytes(content + b"\0")
    assert not run_case(case, stages=("mesh",)).stage("mesh").skipped


@pytest.mark.slow
def test_the_fit_of_the_mesh_stage_is_what_the_simulation_takes(folder, monkeypatch):
    from heavylift.preprocess.hydrodynamics import memory_fit

    case = load_case(folder, ["tanks="])
    out = run_case(case, stages=("mesh",)).folder
    (stored,) = assemble_radiation(case, out)
    again = memory_fit.fit_memory(stored.database, tolerance=stored.fit_error)
    np.testing.assert_array_equal(stored.fit.poles, again.poles)
    np.testing.assert_array_equal(stored.fit.residues, again.residues)
    # nothing is fitted again, in simulations neither
    monkeypatch.setattr(memory_fit, "fit_memory", None)
    run_case(case, stages=("mesh", "simulate"))
    # a memory of another length is another fit, and a file that is gone is made again
    longer = load_case(folder, ["tanks=", "databases.still.memory_length=70 s"])
    assert assemble_radiation(longer, out)[0].fit is None
    monkeypatch.undo()
    out.memory("still").unlink()
    run_case(case, stages=("mesh",))
    assert out.memory("still").is_file()


@pytest.mark.slow
def test_databases_and_fits_of_another_folder_are_reused(folder, tmp_path, monkeypatch):
    """Runs of a study, each in a folder of its own."""
    from heavylift.preprocess.hydrodynamics import memory_fit

    first = run_case(load_case(folder, ["tanks="]), stages=("mesh",)).folder
    monkeypatch.setattr("heavylift.pipeline.stages.hydrodynamics.fit_memory", None)
    monkeypatch.setattr("heavylift.pipeline.stages.hydrodynamics.read_database_source", None)
    monkeypatch.setattr(memory_fit, "fit_memory", None)
    finer = load_case(folder, ["tanks=", "simulate.duration=1 s"])
    run = run_case(finer, out=tmp_path / "finer", stages=("mesh", "simulate"), reuse=[first.root])
    assert database_manifest(run.folder) == database_manifest(first)
    assert run.folder.memory("still").samefile(first.memory("still"))


class Heard(Log):
    """What was said."""

    def __init__(self):
        super().__init__(quiet=True)
        self.lines = []

    def say(self, text):
        self.lines.append(text)


@pytest.mark.slow
def test_a_database_is_computed_only_if_its_panels_changed(folder, monkeypatch):
    """The method itself is another module's; here it is a function that counts its calls."""
    from heavylift.preprocess.hydrodynamics import bem

    calls = []

    def computed(inputs, **_options):
        calls.append(len(inputs.hulls[0].panels))
        return _helper().smooth_database()

    monkeypatch.setattr(bem, "compute_database", computed)
    monkeypatch.setattr(bem, "capytaine_version", lambda: "0")
    compute = "databases.still.compute={panel_size = 5, frequencies = {first = 0.1, last = 1, count = 4}}"
    overrides = ["tanks=", "databases.still.file=", compute]
    log = Heard()
    first = run_case(load_case(folder, overrides), stages=("mesh",), log=log)
    assert len(calls) == 1
    (line,) = [line for line in log.lines if "headings: about" in line]
    assert f"{calls[0]} panels and" in line
    assert line.endswith("s by estimate")
    assert database_manifest(first.folder)["still"]["properties"]["source"] == "smooth functions"
    assert run_case(load_case(folder, overrides), stages=("mesh",)).stage("mesh").skipped
    # it starts elsewhere: the inputs of the case are others, those of the method are not
    moved = [*overrides, "bodies.barge.initial.position=[20, 5, -0.5]"]
    assert not run_case(load_case(folder, moved), stages=("mesh",)).stage("mesh").skipped
    assert len(calls) == 1
    run_case(load_case(folder, [*overrides, "databases.still.compute.panel_size=4"]), stages=("mesh",))
    assert len(calls) == 2
    assert calls[1] > calls[0]


def test_panels_of_a_box_are_what_it_wets(folder):
    from heavylift.pipeline.assemble.hulls import bem_inputs
    from heavylift.preprocess.hydrodynamics.hull_panels import hydrostatics

    compute = "{panel_size = 2.5, symmetric = true, frequencies = {first = 0.2, last = 2, count = 10}}"
    case = load_case(folder, ["tanks=", "databases.still.file=", f"databases.still.compute={compute}"])
    inputs = bem_inputs(case, case.databases["still"], OutputFolder(folder / "out"))
    still = hydrostatics(inputs.hulls[0], DENSITY, 9.81, inputs.reference_points[0])
    assert still.volume == pytest.approx(L * B * T, rel=1e-9)
    assert np.allclose(still.centre_of_buoyancy, [0.0, 0.0, -0.5 * T], atol=1e-9)
    assert inputs.hulls[0].longest_side <= 2.5 * (1.0 + 1e-9)
    assert np.allclose(inputs.omega, 0.2 * np.arange(1, 11))
    assert np.allclose(np.rad2deg(inputs.headings), 10.0 * np.arange(19))
    # the reference point is half a metre below the middle of the box, which is 0.5 D - T above the water
    assert np.allclose(inputs.reference_points, [[0.0, 0.0, 0.5 * D - T - 0.5]], atol=1e-9)
    assert (inputs.depth, inputs.density, inputs.gravity) == (50.0, 1025.0, 9.81)
    # the same hull as triangles, cut at the water and refined
    whole = load_case(
        folder,
        [
            "tanks=",
            "databases.still.file=",
            f"databases.still.compute={compute}",
            'surfaces.0.turned={axis = [0, 0, 1], angle = "0 deg"}',
        ],
    )
    spec = []
    again = bem_inputs(whole, whole.databases["still"], OutputFolder(folder / "out"), say=spec.append)
    cut = again.hulls[0]
    assert hydrostatics(cut, DENSITY, 9.81, np.zeros(3)).volume == pytest.approx(L * B * T, rel=1e-9)
    assert cut.longest_side <= 2.5 * (1.0 + 1e-9)
    # as many panels as a grid has: 16 x 6 below, 16 or 6 x 1 on the sides
    assert len(cut.panels) == 16 * 6 + 2 * 16 + 2 * 6
    (sentence,) = spec
    assert sentence.startswith("barge: 140 panels of 2.5 m; volume +0.00% and water plane +0.00%")
    assert "WARNING" not in sentence
    (lid,) = again.lids
    a, b, c = (lid.points[lid.triangles[:, i]] for i in range(3))
    assert 0.5 * np.cross(b - a, c - a)[:, 2].sum() == pytest.approx(-L * B, rel=1e-9)
    assert again.method == "indirect"


@pytest.mark.slow
def test_refined_triangles_keep_shape_winding_and_neighbours():
    corners = np.array([[0.0, 0.0, 0.0], [7.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 3.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    points, triangles = refined_triangles(corners, faces, 0.8)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0 == pytest.approx(7.0 * 5.0 * 3.0 / 6.0, rel=1e-12)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    assert max(np.linalg.norm(points[i] - points[j]) for i, j in edges) <= 0.8 * (1.0 + 1e-9)
    # every edge is run through once in each direction: closed, and nothing hangs in the middle of a side
    assert {(i, j) for i, j in edges.tolist()} == {(j, i) for i, j in edges.tolist()}
    assert len({(i, j) for i, j in edges.tolist()}) == len(edges)
    with pytest.raises(InputError, match="more than 200000"):
        refined_triangles(corners, faces, 1e-3)


def test_provenance_has_seeds_and_lengths(folder):
    sea = sea_of(folder)
    found = sea_provenance(sea)
    assert found["waves"]["seeds"] == [4]
    assert found["waves"]["components"] == 200
    assert found["waves"]["repeat_period"] is None
    assert found["wind_seeds"] == {"wind": 7}
    assert found["line_lengths"]["bow"] == [sea.lines[0].sections[0].length]
    assert found["databases"] == {"barge": str(folder / "still.nc")} or found["databases"] == {
        "barge": "still.nc"
    }
    assert sea_provenance(None) == {}


def test_a_case_without_a_sea_has_none(small_case):
    case = load_case(small_case)
    assert assemble_sea(case, {}, OutputFolder(small_case / "out")) is None
    assert sea_sections(case, OutputFolder(small_case / "out"), None) == []


@pytest.mark.slow
def test_the_report_says_what_the_sea_is(folder):
    case = load_case(folder)
    stages = run_case(case, stages=("mesh",)).folder
    (section,) = sea_sections(case, stages, None)
    cells = " ".join(cell for item in section.items for row in getattr(item, "rows", ()) for cell in row)
    for words in (
        "jonswap",
        "1.5",
        "NPD spectrum",
        "still.nc",
        "fairlead tension 150 kN",
        "1 MN/m",
        "40: 0.1 to 4",
    ):
        assert words in cells
    position = resting_position(case, "barge", stages)
    assert f"{position.GM_T:.6g}" in cells


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_moored_barge_in_wind_waves_and_current_runs(folder):
    """Every force at once; what is exact at the start is exact in the records."""
    from heavylift.pipeline.results.histories import load_results

    case = load_case(folder)
    report = run_case(case)
    assert report.outcome.name == "COMPLETED", report.message
    results = load_results(case)
    # the box is wetted from 3 m below its origin, which is 1 m below the water, up to the water: 1.5 m
    assert results["barge.displaced_volume"][0] == pytest.approx(L * B * 3.5, rel=1e-12)
    assert results["barge.ballast"][-1] == pytest.approx(5e4 / 3.0, rel=1e-12)
    assert results["bow.tension"][0] == pytest.approx(150e3, rel=1e-9)
    assert results["wind.direction"][-1] == pytest.approx(math.pi / 2.0, rel=1e-12)
    assert results["current.speed"][-1] == pytest.approx(1.0, rel=1e-12)
    # the gauge of the hull is that of its low-passed place, which moves little
    at = results["barge.position"][0]
    t = results.time[-1]
    eta = make_waves(case).elevation(at[0], at[1], t)
    assert results["barge.wave_elevation"][-1] == pytest.approx(float(eta), abs=0.1)
    assert results.metadata["sea"]["waves"]["seeds"] == [4]
    # longer than the straight line under 150 kN, shorter than one that hangs straight down to the bottom
    assert (
        math.hypot(200.0, 50.0) / (1.0 + 150e3 / 3e8)
        < Quantities(case, report.folder.root).number("lines.bow.length")
        < 250.0
    )
    text = (report.folder.root / "report" / "report.md").read_text()
    assert "Hs = 1.5 m" in text
    assert run_case(case).stage("simulate").skipped


def test_a_file_in_the_other_first_column_is_told_how_it_is_read(tmp_path, monkeypatch):
    """HAMS writes frequencies [rad/s] where WAMIT writes periods: numbers of a floating sphere in its way."""
    from types import SimpleNamespace

    from heavylift.pipeline.assemble import hulls
    from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
    from heavylift.preprocess.hydrodynamics.repairs import Repair

    known = read_netcdf(Path(__file__).parents[3] / "cases" / "sphere_decay" / "sphere.nc")
    rows = [
        f"{w:.6e} {i + 1} {j + 1} {A[i, j] / known.density:.6e} {B[i, j] / (known.density * w):.6e}"
        for w, A, B in zip(known.omega, known.added_mass, known.damping, strict=True)
        for i in range(6)
        for j in range(6)
        if A[i, j] or B[i, j]
    ]
    (tmp_path / "s.1").write_text("\n".join(rows) + "\n")
    water = SimpleNamespace(density=known.density, gravity=known.gravity, depth=known.depth)
    monkeypatch.setattr(hulls, "water_of", lambda _case: water)
    keys = {
        "file": "s.1",
        "file_format": "wamit",
        "hulls": ("ball",),
        "length_scale": None,
        "symmetric": None,
    }
    keys |= {"reference_points": known.reference_points.tolist(), "repair": Repair(), "first_column": None}
    case = SimpleNamespace(folder=tmp_path)
    with pytest.raises(InputError, match="read as periods") as caught:
        hulls.read_database_source(case, SimpleNamespace(**keys))
    assert "'first_column = \"frequency\"', with which the file is sound" in caught.value.expected
    found = hulls._read(case, SimpleNamespace(**{**keys, "first_column": "frequency"}))
    np.testing.assert_allclose(found.omega, known.omega, rtol=1e-5)
    np.testing.assert_allclose(found.added_mass[:, 2, 2], known.added_mass[:, 2, 2], rtol=1e-5)
