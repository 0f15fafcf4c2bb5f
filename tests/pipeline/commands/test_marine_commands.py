"""Commands of what floats: hydrostatics, database, rao, lines, statistics, with their documents and messages."""

from __future__ import annotations

import csv
import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.commands.cli import app
from heavylift.pipeline.commands.hydrostatics import linear_figures
from heavylift.pipeline.commands.lines import line_ends, section_masses
from heavylift.pipeline.commands.response_operators import response_in_trains, separate_modes
from heavylift.pipeline.commands.statistics import seed_keys
from heavylift.pipeline.results.histories import ChannelInfo, Results
from heavylift.pipeline.results.statistics import chosen_columns, column_statistics, run_statistics
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.moorings import LineSection
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.scene.sea import LinearRestoring
from heavylift.solver.water.lines.mooring_lines import MooringLine

DATABASE = Path(__file__).parents[3] / "cases" / "transport_barge" / "barge.nc"
LENGTH, BREADTH, DRAFT = 97.5, 36.0, 4.5
MASS, LOAD, BALLAST = 15.8e6, 2.0e5, 1.0e5

CASE = """
title = "moored barge"
sources = ["a test"]

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[bodies.barge]
type = "rigid"
mass = "15800 t"
inertia = ["2.5e9 kg m^2", "9.6e9 kg m^2", "9.6e9 kg m^2"]
centre_of_mass = [0, 0, "1 m"]
frame = { motion = "free" }

[bodies.cargo]
type = "rigid"
mass = "200 t"
inertia = ["2e6 kg m^2", "2e6 kg m^2", "2e6 kg m^2"]
centre_of_mass = [0, 0, "8 m"]
frame = { motion = "free" }

[[joints]]
name = "seafastening"
type = "fixed"
between = ["barge", "cargo"]
at = [0, 0, "5 m"]

[[surfaces]]
name = "plating"
body = "barge"
shape = { type = "box", size = ["97.5 m", "36 m", "9 m"] }

[hulls.barge]
surface = "plating"

[databases.water]
file = "barge.nc"
hulls = ["barge"]

[sea]
ramp = "20 s"

[sea.waves]
type = "jonswap"
significant_height = "2 m"
peak_period = "9 s"
direction = "40 deg"
seed = 7

[[tanks]]
name = "peak"
hull = "barge"
point = [0, 0, "-3 m"]
mass = "100 t"
free_surface = [3000, 4000]

[[lines]]
name = "bow"
between = ["ground", "barge"]
points = [[700, 0, -100], [48.75, 0, 4.5]]
seabed = -100
sections = [{ length = "680 m", weight = "1200 N/m", axial_stiffness = "600 MN" }]

[[lines]]
name = "stern"
between = ["ground", "barge"]
points = [[-700, 0, -100], [-48.75, 0, 4.5]]
seabed = -100
sections = [{ length = "680 m", weight = "1200 N/m", axial_stiffness = "600 MN" }]

[simulate]
step = "0.1 s"
integrator = "dele2"
output_interval = "0.5 s"
duration = "600 s"
start = "equilibrium"
"""


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The case with its surface and database, which every command would make."""
    folder = tmp_path_factory.mktemp("prepared") / "barge"
    folder.mkdir()
    (folder / "case.toml").write_text(CASE)
    shutil.copyfile(DATABASE, folder / "barge.nc")
    assert app(["mesh", str(folder), "--quiet"], result_action="return_value") == 0
    return folder


@pytest.fixture
def barge(tmp_path: Path, prepared: Path) -> Path:
    return Path(shutil.copytree(prepared, tmp_path / "barge"))


@pytest.fixture
def heavylift(capsys):
    def run(*tokens):
        capsys.readouterr()
        code = app([str(token) for token in tokens], result_action="return_value")
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


def table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_hydrostatics_counts_what_is_joined_and_the_tanks(heavylift, barge: Path) -> None:
    code, out, _ = heavylift("hydrostatics", barge, "--json")
    assert code == 0
    (hull,) = json.loads(out)["hulls"]
    assert (hull["hull"], hull["carries"]) == ("barge", ["cargo"])
    assert hull["left_out"] == ["line bow", "line stern"]
    figures = hull["figures"]
    mass = MASS + LOAD + BALLAST
    draft = mass / (1025.0 * LENGTH * BREADTH)
    kg = 4.5 + (MASS * 1.0 + LOAD * 8.0 - BALLAST * 3.0) / mass
    lost = 1025.0 * 3000.0 / mass
    assert figures["displacement"] == pytest.approx(mass, rel=1e-12)
    assert figures["draft"] == pytest.approx(draft, rel=1e-9)
    assert figures["KG"] == pytest.approx(kg, rel=1e-9)
    assert figures["GM_T"] == pytest.approx(draft / 2.0 + BREADTH**2 / 12.0 / draft - kg - lost, rel=1e-6)
    files = {Path(file).name for file in hull["files"]}
    endings = ("hydrostatics.json", "hydrostatics.csv", "righting_arms.csv", "righting_arms.png")
    assert files == {f"barge_{ending}" for ending in endings}
    assert all((barge / "out" / "hydrostatics" / name).stat().st_size > 100 for name in files)


@pytest.mark.slow
def test_hydrostatics_of_linear_hulls_still_uses_their_surface(heavylift, barge: Path) -> None:
    arms = []
    for kind in ("clipped", "linear"):
        code, out, _ = heavylift("hydrostatics", barge, "--set", f"hulls.barge.restoring={kind}", "--json")
        assert code == 0
        arms.append(json.loads(out)["hulls"][0]["figures"]["largest_arm"])
    assert arms[0] == pytest.approx(arms[1], rel=1e-12)


@pytest.mark.slow
def test_what_is_missing_is_one_message(heavylift, barge: Path, small_case: Path) -> None:
    for command, key in (
        ("hydrostatics", "hulls"),
        ("rao", "hulls"),
        ("database", "hulls"),
        ("lines", "lines"),
    ):
        code, _, error = heavylift(command, small_case)
        assert code == 2
        assert f"no {key}" in error
        assert len(error.strip().splitlines()) == 1
    code, _, error = heavylift("hydrostatics", barge, "--hull", "boat")
    assert code == 2
    assert "no hull 'boat'; expected one of barge" in error
    code, _, error = heavylift("lines", barge, "--line", "port")
    assert code == 2
    assert "no line 'port'; expected one of bow, stern" in error
    code, _, error = heavylift("lines", barge, "--moordyn")
    assert code == 2
    assert "no results" in error
    under_water = ("--set", "hulls.barge.restoring=none", "--set", "hulls.barge.surface=")
    code, _, error = heavylift("hydrostatics", barge, *under_water)
    assert code == 2
    assert "no hull with buoyancy" in error
    code, out, _ = heavylift("statistics", barge, "--json")
    assert code == 2
    assert "heavylift simulate" in json.loads(out)["error"]
    code, _, error = heavylift("statistics", barge, "--seeds", "2")
    assert code == 2
    assert "expected 3 runs or more" in error
    code, _, error = heavylift("database", barge, "--set", "databases=")
    assert code == 2
    assert "no databases" in error


MISFITS = {
    "depth": (["sea.depth=30 m"], "expected those of the sea: 1025, 9.81, 30"),
    "density": (["sea.density=1000"], "expected those of the sea: 1000"),
    "reference": (["hulls.barge.reference=[0, 5, 0]"], "its centre of buoyancy at y = -5 m"),
    "hull": (['surfaces.0.shape.size=["36 m", "97.5 m", "9 m"]'], "turned by 90 degrees"),
    "draught": (["bodies.barge.mass=9000 t", "lines="], "43% less than the 15795 m3"),
}


@pytest.mark.parametrize("name", MISFITS)
@pytest.mark.parametrize("command", ["rao", "hydrostatics", "lines", "database", "simulate", "draw"])
def test_every_command_refuses_a_database_that_does_not_fit(
    heavylift, barge: Path, command: str, name: str
) -> None:
    """A barge of 97.5 x 36 m with a draught of 4.5 m in deep water of 1025 kg/m3: 15,795 m3."""
    changes, words = MISFITS[name]
    if command == "lines" and "lines=" in changes:
        return  # it has none
    code, _, err = heavylift(command, barge, *(token for change in changes for token in ("--set", change)))
    assert code == 2
    assert words in err.splitlines()[-1]


def test_what_ballast_is_to_fill_is_told_and_not_refused(heavylift, barge: Path) -> None:
    """9,000 t, 200 t of cargo and an empty tank, of 16,190 t that the database has: the plan finds the rest."""
    file = barge / "case.toml"
    tank = 'name = "wing"\nhull = "barge"\nfloor = [0, 0, -4]\nsize = [60, 30, 8]\nmass = 0\n'
    plan = f'\n[[tanks]]\n{tank}\n[ballast]\nhull = "barge"\ntanks = ["wing"]\nstages = [{{ name = "a" }}]\n'
    file.write_text(file.read_text() + plan)
    code, out, err = heavylift("hydrostatics", barge, "--set", "bodies.barge.mass=9000 t", "--set", "lines=")
    assert code == 0
    assert (
        "43% less than the 15795 m3 of its database (barge.nc); not counted: what [ballast] fills"
        in out + err
    )


@pytest.mark.slow
def test_the_database_is_drawn(heavylift, barge: Path) -> None:
    code, out, _ = heavylift("database", barge, "--json")
    assert code == 0
    (entry,) = json.loads(out)["databases"]
    assert (entry["name"], entry["hulls"], entry["depth"]) == ("water", ["barge"], None)
    assert entry["omega"] == pytest.approx([0.05, 3.0, 60])
    assert [Path(file).suffix for file in entry["files"]] == [".json", ".png", ".png", ".png"]


def test_lines_hang_where_the_case_begins(heavylift, barge: Path) -> None:
    code, out, _ = heavylift("lines", barge, "--line", "bow", "--json")
    assert code == 0
    (line,) = json.loads(out)["lines"]
    assert line["fairlead"] == pytest.approx([48.75, 0.0, 4.5], abs=1e-6)
    # an inextensible catenary on the seabed: T - H = w h, and what hangs is s = h sqrt(1 + 2 H / (w h))
    rise, weight = 104.5, 1200.0
    H = line["horizontal_tension"]
    assert line["fairlead_tension"] - H == pytest.approx(weight * rise, rel=1e-3)
    assert 680.0 - line["seabed_length"] == pytest.approx(
        rise * math.sqrt(1.0 + 2.0 * H / (weight * rise)), rel=2e-3
    )


def test_lines_lie_on_a_slope(heavylift, barge: Path) -> None:
    """The bottom falls away from the anchor of the bow: what lies there hangs on it."""
    case = barge / "case.toml"
    case.write_text(
        case.read_text().replace(
            "seabed = -100", "seabed = -100\nseabed_slope = { angle = '3 deg', downhill = '180 deg' }", 1
        )
    )
    code, out, _ = heavylift("lines", barge, "--json")
    assert code == 0
    bow, stern = json.loads(out)["lines"]
    slope, weight = math.radians(3.0), 1200.0
    assert bow["seabed_length"] > 200.0
    # from the touch-down to the anchor the weight along the slope, to the fairlead that of the height between
    touch = bow["horizontal_tension"] / math.cos(slope)
    assert bow["anchor_tension"] - touch == pytest.approx(
        weight * math.sin(slope) * bow["seabed_length"], rel=1e-6
    )
    low = -100.0 - math.sin(slope) * bow["seabed_length"]
    assert bow["fairlead_tension"] - touch == pytest.approx(weight * (4.5 - low), rel=2e-3)  # inextensible
    assert stern["anchor_tension"] == pytest.approx(stern["horizontal_tension"])
    text = case.read_text()
    case.write_text(text.replace("seabed = -100", "seabed = -80", 1))
    for command in ("lines", "simulate"):
        code, _, error = heavylift(command, barge)
        assert code == 2
        assert "lines.0.points: the anchor at height -100 m is 20 m below the seabed" in error


def test_masses_in_air_follow_from_the_weight_in_water() -> None:
    def line(weight: float) -> MooringLine:
        sections = (LineSection(100.0, weight, 1e8),)
        return MooringLine(
            name="l", body_a=GROUND, point_a=np.zeros(3), body_b=GROUND, point_b=np.ones(3), sections=sections
        )

    mass = 150.0
    weight = mass * 9.81 * (1.0 - 1025.0 / 7850.0)
    assert section_masses(line(weight), 1025.0, 7850.0, 9.81) == pytest.approx((mass,))
    with pytest.raises(InputError, match="floats"):
        section_masses(line(-5.0), 1025.0, 7850.0, 9.81)
    with pytest.raises(InputError, match="material"):
        section_masses(line(5.0), 1025.0, 900.0, 9.81)


def test_a_float_plane_has_metacentric_heights() -> None:
    volume = LENGTH * BREADTH * DRAFT
    restoring = LinearRestoring(
        volume=volume,
        centre_of_buoyancy=np.array([0.0, 0.0, -2.25]),
        reference=np.zeros(3),
        area=LENGTH * BREADTH,
        second_moments=(BREADTH * LENGTH**3 / 12.0, LENGTH * BREADTH**3 / 12.0, 0.0),
    )
    figures = linear_figures(
        restoring, restoring.centre_of_buoyancy, np.array([0.0, 0.0, 2.0]), 1025.0 * volume, (), 1025.0
    )
    assert figures["GM_T"] == pytest.approx(BREADTH**2 / 12.0 / DRAFT - 2.25 - 2.0, rel=1e-12)
    assert figures["GM_L"] == pytest.approx(LENGTH**2 / 12.0 / DRAFT - 2.25 - 2.0, rel=1e-12)


def recorded(columns: dict[str, tuple[str, tuple[str, ...], np.ndarray]], times: np.ndarray) -> Results:
    channels = {name: ChannelInfo(name, unit, parts, 0) for name, (unit, parts, _) in columns.items()}
    arrays = {name: np.atleast_2d(values.T).T for name, (_, _, values) in columns.items()}
    return Results(Path("results.h5"), times, channels, arrays, {"outcome": "completed"})


def test_columns_by_name_and_angles_of_a_body() -> None:
    from scipy.spatial.transform import Rotation

    times = 0.1 * np.arange(4000)
    roll, pitch, yaw = 0.1 * np.sin(0.9 * times), 0.05 * np.cos(0.7 * times), 3.0 + 0.01 * times
    q = Rotation.from_euler("ZYX", np.column_stack([yaw, pitch, roll])).as_quat()[:, [3, 0, 1, 2]]
    run = recorded(
        {
            "hull.position": ("m", ("x", "y", "z"), np.outer(times, [1.0, 2.0, 3.0])),
            "hull.orientation": ("1", ("q0", "q1", "q2", "q3"), q),
            "hull.wave_elevation": ("m", ("wave_elevation",), np.sin(times)),
            "bow.tension": ("N", ("tension",), 5.0 + np.sin(times)),
            "bow.anchor_tension": ("N", ("anchor_tension",), np.ones(len(times))),
        },
        times,
    )
    names = [column.name for column in chosen_columns(run, ())]
    assert names == [
        *(f"hull.position.{axis}" for axis in "xyz"), "hull.roll", "hull.pitch", "hull.yaw",
        "hull.wave_elevation", "bow.tension",
    ]  # fmt: skip
    for name, expected in (("hull.roll", roll), ("hull.pitch", pitch), ("hull.position.y", 2.0 * times)):
        (column,) = chosen_columns(run, (name,))
        assert column.read(run) == pytest.approx(expected, abs=1e-12)
    (turning,) = chosen_columns(run, ("hull.yaw",))  # goes on past pi
    assert np.diff(turning.read(run)) == pytest.approx(np.diff(yaw), abs=1e-9)
    with pytest.raises(InputError, match="does not exist"):
        chosen_columns(run, ("hull.heave",))


def test_statistics_begin_when_told_and_average_over_runs() -> None:
    times = 0.1 * np.arange(20000)
    runs = []
    for scale in (1.0, 2.0, 3.0):
        x = np.where(times < 100.0, 50.0, 10.0 + scale * np.sin(0.8 * times))
        runs.append(recorded({"a.force": ("N", ("force",), x)}, times))
    (column,) = chosen_columns(runs[0], ("a.force",))
    found = column_statistics(column, [run_statistics(column, run, 100.0) for run in runs])
    entry = found.entry()
    assert entry["maximum"] == pytest.approx(13.0, abs=1e-3)
    assert entry["minimum"] == pytest.approx(7.0, abs=1e-3)
    assert entry["standard_deviation"] == pytest.approx(math.sqrt((1.0 + 4.0 + 9.0) / 6.0), rel=2e-3)
    assert entry["significant_by_cycles"] == pytest.approx(4.0, rel=1e-3)  # mean of 2, 4 and 6
    assert entry["mean_period"] == pytest.approx(2.0 * math.pi / 0.8, rel=1e-4)
    # maxima 11, 12, 13: moments of a Gumbel distribution lie near
    assert 11.0 < entry["maxima"]["mode"] < 12.0 < entry["maxima"]["quantile_0.9"]
    assert entry["minima"]["mode"] == pytest.approx(20.0 - entry["maxima"]["mode"], abs=1e-3)
    assert found.spectrum is not None
    energy = np.trapezoid(found.spectrum.density, found.spectrum.frequency)
    assert energy == pytest.approx(entry["standard_deviation"] ** 2, rel=0.02)


def test_seeds_are_found_where_the_file_has_them(barge: Path) -> None:
    assert seed_keys(load_case(barge)) == {"sea.waves.seed": 7}
    text = CASE.replace("[sea.waves]", "[[sea.waves]]") + (
        '\n[[sea.waves]]\ntype = "jonswap"\nsignificant_height = 1\npeak_period = 14\nseed = 40\n'
    )
    (barge / "case.toml").write_text(text)
    keys = seed_keys(load_case(barge))
    assert keys == {"sea.waves.0.seed": 7, "sea.waves.1.seed": 40}
    changed = load_case(barge, [f"{key}={seed + 1}" for key, seed in keys.items()])
    assert list(seed_keys(changed).values()) == [8, 41]


def test_ends_of_lines_follow_their_bodies() -> None:
    body = RigidBody("b", 1.0, np.eye(3), position=np.array([5.0, 0.0, 0.0]))
    line = MooringLine(
        name="l", body_a=GROUND, point_a=np.array([1.0, 2.0, 3.0]), body_b="b", point_b=np.array([0.0, 1.0, 0.0]),
        sections=(LineSection(10.0, 1.0, 1e6),),
    )  # fmt: skip
    ends = line_ends(Scene(bodies=(body,)), line, None)
    assert ends.fairlead == pytest.approx(np.array([[5.0, 1.0, 0.0]]))
    half = math.sqrt(0.5)
    run = recorded(
        {
            "b.position": ("m", ("x", "y", "z"), np.array([[5.0, 0.0, 0.0], [6.0, 0.0, 0.0]])),
            "b.orientation": ("1", ("q0", "q1", "q2", "q3"), np.array([[1.0, 0, 0, 0], [half, 0, 0, half]])),
        },
        np.array([0.0, 1.0]),
    )
    ends = line_ends(Scene(bodies=(body,)), line, run)
    assert ends.fairlead == pytest.approx(np.array([[5.0, 1.0, 0.0], [5.0, 0.0, 0.0]]), abs=1e-12)
    assert ends.anchor == pytest.approx(np.array([[1.0, 2.0, 3.0]] * 2))


def test_response_to_one_train_is_half_the_square_of_its_operator() -> None:
    from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
    from heavylift.solver.water.hulls.frequency_domain import linear_hulls, motion_operators
    from heavylift.solver.water.waves.wave_trains import regular_wave

    database = read_netcdf(DATABASE)
    mass = np.diag([1.6e7] * 3 + [2.5e9, 9e9, 9e9])
    stiffness = np.diag([1e5, 1e5, 3.5e7, 3e9, 2.7e10, 1e9])
    hulls = linear_hulls(database, mass, stiffness)
    wave = regular_wave(3.0, 2.0 * math.pi / 0.7, math.radians(75.0), depth=math.inf, gravity=9.81)
    found = response_in_trains(hulls, wave, math.radians(30.0))
    expected = motion_operators(hulls, headings=[math.radians(45.0)], omega=[0.7]).amplitude[0, 0]
    assert found.standard_deviation == pytest.approx(1.5 * expected / math.sqrt(2.0), rel=1e-9)
    assert found.mean_period[expected > 1e-6] == pytest.approx(2.0 * math.pi / 0.7)


def test_equal_hulls_that_do_not_feel_each_other_have_modes_of_their_own() -> None:
    from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
    from heavylift.solver.scene.sea import Radiation
    from heavylift.solver.water.hulls.frequency_domain import linear_hulls, natural_modes
    from heavylift.solver.water.hulls.linearise import joined_database

    database = read_netcdf(DATABASE)
    mass = np.diag([1.6e7] * 3 + [2.5e9, 9e9, 9e9])
    stiffness = np.diag([1e5, 1e5, 3.5e7, 3e9, 2.7e10, 1e9])
    one = natural_modes(linear_hulls(database, mass, stiffness))
    both = [Radiation(bodies=(name,), database=database) for name in ("a", "b")]
    points = np.array([[0.0, 0.0, 0.0], [0.0, 500.0, 0.0]])
    joined = joined_database(both, ("a", "b"), np.zeros(2), points)
    two = np.kron(np.eye(2), mass), np.kron(np.eye(2), stiffness)
    found = separate_modes(linear_hulls(joined, *two))
    assert [mode.coordinate for mode in found] == [k + mode.coordinate for k in (0, 6) for mode in one]
    assert [mode.period for mode in found] == pytest.approx([mode.period for mode in one] * 2, rel=1e-9)
    assert not found[0].shape[6:].any()
    rigid = np.hstack([np.eye(6), -np.eye(6)])  # joined they are one of the double mass
    tied = separate_modes(linear_hulls(joined, *two, constraint_jacobian=rigid))
    assert [mode.period for mode in tied] == pytest.approx([mode.period for mode in one], rel=1e-9)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_operators_and_simulated_seas_agree(heavylift, barge: Path) -> None:
    code, out, _ = heavylift("rao", barge, "--heading", "0", "--heading", "40", "--json")
    assert code == 0
    document = json.loads(out)
    assert document["bodies"] == ["barge", "cargo"]
    periods = {mode["coordinate"]: mode["period"] for mode in document["natural_modes"]}
    assert "barge.surge" in periods  # the lines hold it; nothing holds sway
    assert periods["barge.surge"] > 60.0
    rows = table(barge / "out" / "rao" / "rao.csv")
    assert {float(row["heading_deg"]) for row in rows} == {0.0, 40.0}
    longest = next(row for row in rows if row["body"] == "barge")
    assert float(longest["heave_m_per_m"]) == pytest.approx(1.0, abs=0.01)  # follows long waves
    forces = table(barge / "out" / "rao" / "joint_forces.csv")
    assert {(row["joint"], row["body"]) for row in forces} == {("seafastening", "cargo")}

    channels = ("barge.position.z", "barge.pitch", "bow.tension")
    code, out, _ = heavylift("statistics", barge, "--seeds", "3", "--channels", *channels, "--json")
    assert code == 0
    found = json.loads(out)
    assert (found["seeds"], found["after"]) == ([7, 8, 9], 20.0)
    response = document["responses"]["waves of the case"]
    heave, pitch, tension = found["channels"]
    for one, name in ((heave, "barge.heave"), (pitch, "barge.pitch")):
        # of three records of 580 s, about 190 cycles
        assert one["standard_deviation"] == pytest.approx(response[name]["standard_deviation"], rel=0.1)
        assert one["mean_period"] == pytest.approx(response[name]["mean_period"], rel=0.05)
    assert tension["minimum"] > 0.0
    # every seed once: the second time nothing is simulated
    _, out, _ = heavylift("statistics", barge, "--seeds", "3")
    assert out.count("simulate: unchanged, skipped") == 3
    extremes = table(barge / "out" / "statistics" / "extremes.csv")
    assert [row["seed"] for row in extremes] == ["7", "8", "9"]
    assert len({row["barge.pitch maximum"] for row in extremes}) == 3


def test_what_only_watches_hangs_on_no_hull():
    """Relative motions, angles of ropes and the like have no force; springs and tuggers are called what they are."""
    from heavylift.pipeline.commands.hydrostatics import _ropes
    from heavylift.solver.forces.spring import Spring
    from heavylift.solver.forces.tugger import Tugger
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.sensors.relative_motions import RelativeMotion

    ends = {"body_a": "barge", "body_b": "ground"}
    watches = object.__new__(RelativeMotion)
    spring, tugger = object.__new__(Spring), object.__new__(Tugger)
    for one, name in ((watches, "airgap"), (spring, "soft"), (tugger, "tag")):
        for key, value in {"name": name, **ends}.items():
            object.__setattr__(one, key, value)
    scene = object.__new__(Scene)
    object.__setattr__(scene, "ropes", ())
    object.__setattr__(scene, "forces", (watches, spring, tugger))
    assert _ropes(scene, {"barge"}) == ["spring soft", "tugger tag"]
