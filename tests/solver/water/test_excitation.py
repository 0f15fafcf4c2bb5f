"""Wave forces on hulls that move, turn or stay, against the complex closed form of each component."""

import math

import numpy as np
import pytest

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.solver.water.waves.excitation import interpolate_series, ramp_factor, sum_excitation
from heavylift.solver.water.waves.excitation_packing import catmull_rom_error, pack_series, pack_summed
from heavylift.solver.water.waves.spectra import dispersion, jonswap
from heavylift.solver.water.waves.wave_trains import irregular_waves, regular_wave, superposition
from heavylift.solver.water.waves.wave_transfer import excitation_at

DEPTH = 30.0
ONE = ((3.0, 0.0, 0.0),)
TWO = ((3.0, 0.0, 0.0), (60.0, -14.0, 0.0))
SEA = irregular_waves(
    jonswap(1.65, 6.12), seed=3, direction=0.3, depth=DEPTH, frequency_range=(0.6, 3.0), spreading=20.0
)


@kernel
def summed(excitation, time, place, out):
    sum_excitation(excitation, time, place, out)


@kernel
def interpolated(excitation, time, out):
    interpolate_series(excitation, time, out)


@kernel
def ramp(time, start, length):
    return ramp_factor(time, start, length)


def force_of(hull, w, beta):
    """A smooth force relative to the reference point of a hull, with the symmetry of a ship about y = 0."""
    c, s = np.cos(beta), np.sin(beta)
    shapes = (c, s * (1.0 + 0.2 * c), 1.0 + 0.3 * c, s, c + 0.2 * c * c, s * c)
    return [
        1e5 * (1 + hull) * np.exp(-(w**2)) * shape * np.exp(1j * (0.3 * j + 0.2 * w * c))
        for j, shape in enumerate(shapes)
    ]


def drift_of(hull, w, beta):
    c, s = np.cos(beta), np.sin(beta)
    return [1e4 * (1 + hull) * w * shape for shape in (c, s, 0.1 + 0.0 * c, s * c, c * c, -s * c)]


def make(references, *, headings=None, symmetric=False, depth=DEPTH, drift=False):
    points = np.array(references)
    n = 6 * len(points)
    w = np.linspace(0.1, 3.0, 60)
    if headings is None:
        headings = np.arange(0.0, 181.0 if symmetric else 360.0, 10.0)
    b = np.deg2rad(np.asarray(headings, dtype=float))
    k = dispersion(w, depth)[:, None]
    W, beta = np.meshgrid(w, b, indexing="ij")
    force = []
    for hull, point in enumerate(points):
        along = k * (point[0] * np.cos(beta) + point[1] * np.sin(beta))
        force += [one * np.exp(1j * along) for one in force_of(hull, W, beta)]
    slow = np.stack([one for hull in range(len(points)) for one in drift_of(hull, W, beta)], axis=-1)
    return HydrodynamicDatabase(
        bodies=tuple(f"hull {i}" for i in range(len(points))),
        omega=w,
        headings=b,
        added_mass=np.tile(1e6 * np.eye(n), (60, 1, 1)),
        damping=np.tile(1e5 * np.eye(n), (60, 1, 1)),
        added_mass_infinite=1e6 * np.eye(n),
        excitation=np.stack(force, axis=-1),
        reference_points=points,
        density=1025.0,
        gravity=9.81,
        depth=depth,
        source="closed form",
        symmetric=symmetric,
        drift=slow if drift else None,
    )


def closed_form(trains, hulls, place, time):
    """Sum over components with the forces themselves, none interpolated."""
    total = []
    for hull in range(hulls):
        x, y, yaw = place[hull]
        theta = (
            trains.wavenumber * (np.cos(trains.direction) * x + np.sin(trains.direction) * y)
            - trains.omega * time
            - trains.phase
        )
        forces = force_of(hull, trains.omega, trains.direction - yaw)
        total += [np.sum((trains.amplitude * one * np.exp(1j * theta)).real) for one in forces]
    return np.array(total)


def scale_of(trains, hulls):
    """Sum of the amplitudes of all components, the largest force there can be."""
    biggest = [np.abs(one) for hull in range(hulls) for one in force_of(hull, trains.omega, trains.direction)]
    return max(float(np.sum(trains.amplitude * one)) for one in biggest)


def test_regular_wave_at_frequencies_and_headings_of_the_database_is_exact():
    database = make(TWO)
    w = database.omega[17]
    wave = regular_wave(1.0, 2.0 * math.pi / w, math.radians(70.0), phase=0.4, depth=DEPTH)
    place = np.array([[11.0, -5.0, math.radians(20.0)], [-300.0, 70.0, math.radians(-40.0)]])
    packed = pack_summed(wave, database, yaws=np.zeros(2))
    out = np.empty(12)
    for time in (0.0, 3.3, 12345.6):
        summed(packed, time, place, out)
        exact = closed_form(wave, 2, place, time)
        assert np.max(np.abs(out - exact)) < 1e-9 * scale_of(wave, 2)


def test_force_has_the_phase_of_the_database_and_of_the_place():
    database = make(ONE)
    w = database.omega[17]
    wave = regular_wave(2.0, 2.0 * math.pi / w, 0.0, depth=DEPTH)
    heave = force_of(0, w, 0.0)[2]
    out = np.empty(6)
    # where X exp(i k x) is real and positive at t = 0 the force has its maximum, a quarter wave on it is zero
    k = wave.wavenumber[0]
    for shift, value in ((0.0, abs(heave)), (0.5 * math.pi, 0.0), (math.pi, -abs(heave))):
        place = np.array([[(shift - np.angle(heave)) / k, 40.0, 0.0]])
        summed(pack_summed(wave, database, yaws=[0.0]), 0.0, place, out)
        assert out[2] == pytest.approx(value, abs=1e-9 * abs(heave))


@pytest.mark.parametrize("references", [ONE, TWO])
def test_irregular_sea_on_moved_and_turned_hulls_between_the_headings(references):
    n = len(references)
    packed = pack_summed(SEA, make(references), yaws=np.zeros(n))
    out = np.empty(6 * n)
    rng = np.random.default_rng(1)
    for _ in range(10):
        place = rng.uniform(-200.0, 200.0, (n, 3)) * [1.0, 1.0, 0.05]
        time = float(rng.uniform(0.0, 10_000.0))
        summed(packed, time, place, out)
        exact = closed_form(SEA, n, place, time)
        assert np.max(np.abs(out - exact)) < 2e-5 * scale_of(SEA, n)


def test_hull_that_feels_the_elevation_reads_it_at_its_place():
    """With X = 1 at the reference point the heave force is the elevation there."""
    database = make(TWO)
    k = dispersion(database.omega, DEPTH)[:, None]
    for hull, point in enumerate(TWO):
        along = k * (point[0] * np.cos(database.headings) + point[1] * np.sin(database.headings))
        database.excitation[:, :, 6 * hull + 2] = np.exp(1j * along)
    packed = pack_summed(SEA, database, yaws=np.zeros(2))
    place = np.array([[5.0, 6.0, 0.3], [-70.0, 33.0, 2.9]])
    out = np.empty(12)
    for time in (0.0, 100.0, 50_000.0):
        summed(packed, time, place, out)
        assert out[[2, 8]] == pytest.approx(SEA.elevation(place[:, 0], place[:, 1], time), abs=1e-9)


def test_half_circle_of_a_symmetric_hull_is_the_full_circle():
    full = pack_summed(SEA, make(ONE, drift=True), yaws=[0.0], with_drift=True)
    half = pack_summed(SEA, make(ONE, drift=True, symmetric=True), yaws=[0.0], with_drift=True)
    one, two = np.empty(6), np.empty(6)
    for yaw in np.linspace(-7.0, 7.0, 23):
        place = np.array([[4.0, 5.0, yaw]])
        summed(full, 77.0, place, one)
        summed(half, 77.0, place, two)
        assert np.max(np.abs(one - two)) < 1e-8 * scale_of(SEA, 1)


def test_mirrored_wave_mirrors_the_force():
    database = make(ONE, symmetric=True)
    out, mirrored = np.empty(6), np.empty(6)
    for sign, target in ((1.0, out), (-1.0, mirrored)):
        wave = regular_wave(1.0, 7.0, sign * 0.77, depth=DEPTH)
        summed(pack_summed(wave, database, yaws=[0.0]), 2.0, np.array([[8.0, sign * 3.0, 0.0]]), target)
    assert mirrored == pytest.approx(out * [1.0, -1.0, 1.0, -1.0, 1.0, -1.0], rel=1e-9)


def test_unequal_headings_are_brought_onto_a_grid():
    headings = np.concatenate([np.arange(0.0, 90.0, 5.0), np.arange(90.0, 360.0, 7.5)])
    packed = pack_summed(SEA, make(ONE, headings=headings), yaws=[0.0])
    out = np.empty(6)
    place = np.array([[4.0, 5.0, 0.9]])
    summed(packed, 10.0, place, out)
    assert np.max(np.abs(out - closed_form(SEA, 1, place, 10.0))) < 2e-5 * scale_of(SEA, 1)


def test_series_of_hulls_that_stay_is_the_sum_within_the_stated_error():
    database = make(TWO)
    place = np.array([[4.0, 5.0, 0.9], [50.0, 3.0, -0.2]])
    series = pack_series(SEA, database, places=place, duration=600.0)
    packed = pack_summed(SEA, database, yaws=place[:, 2])
    times = np.random.default_rng(2).uniform(0.0, 600.0, 2000)
    exact, found = np.empty((2000, 12)), np.empty((2000, 12))
    for i, time in enumerate(times):
        summed(packed, time, place, exact[i])
        interpolated(series, time, found[i])
    error = np.sqrt(np.mean((found - exact) ** 2, axis=0))
    assert np.all(error < 2.2e-4 * np.std(exact, axis=0))
    assert np.all(error > 1e-6 * np.std(exact, axis=0))  # interpolated, not summed
    for time in (0.0, 600.0):
        interpolated(series, time, found[0])
        assert np.all(np.isfinite(found[0]))
    for time in (-2.0, 610.0, math.nan):
        interpolated(series, time, found[0])
        assert np.all(np.isnan(found[0]))


def test_interpolation_error_is_of_third_order():
    angle = np.array([0.02, 0.04, 0.08])
    error = catmull_rom_error(angle)
    # central differences for the slopes are wrong by f''' / 6, which Hermite's cubic passes on as s (1 - s) (1 - 2 s);
    # the mean square of that is 1 / 210
    assert error == pytest.approx(angle**3 / (6.0 * math.sqrt(210.0)), rel=0.01)


def test_ramp_is_smooth_and_complete():
    assert ramp(10.0, 10.0, 12.0) == 0.0
    assert ramp(-5.0, 10.0, 12.0) == 0.0
    assert ramp(16.0, 10.0, 12.0) == pytest.approx(0.5, rel=1e-14)
    assert ramp(22.0, 10.0, 12.0) == 1.0
    assert ramp(0.0, 0.0, 0.0) == 1.0
    assert ramp(10.001, 10.0, 12.0) < 1e-7  # no jump of the rate
    packed = pack_summed(SEA, make(ONE), yaws=[0.0], ramp=12.0, ramp_start=10.0)
    out = np.empty(6)
    place = np.zeros((1, 3))
    summed(packed, 10.0, place, out)
    assert np.all(out == 0.0)
    summed(packed, 16.0, place, out)
    exact = closed_form(SEA, 1, place, 16.0)
    assert np.max(np.abs(out - 0.5 * exact)) < 2e-5 * scale_of(SEA, 1)


def test_drift_of_one_wave_is_steady_and_of_two_waves_slow():
    database = make(ONE, drift=True)
    w = database.omega[[14, 17]]
    waves = [
        regular_wave(2.0 * a, 2.0 * math.pi / one, 0.0, depth=DEPTH)
        for a, one in zip((0.5, 0.7), w, strict=True)
    ]
    place = np.array([[20.0, 3.0, math.radians(-30.0)]])
    D = np.array([drift_of(0, one, math.radians(30.0)) for one in w])
    out, plain = np.empty(6), np.empty(6)
    for time in (0.0, 1.7, 400.0):
        for trains, exact in (
            (waves[0], 0.25 * D[0]),
            (
                superposition(waves),
                0.25 * D[0]
                + 0.49 * D[1]
                + 0.35
                * (D[0] + D[1])
                * math.cos((waves[0].wavenumber[0] - waves[1].wavenumber[0]) * 20.0 - (w[0] - w[1]) * time),
            ),
        ):
            summed(pack_summed(trains, database, yaws=[0.0], with_drift=True), time, place, out)
            summed(pack_summed(trains, database, yaws=[0.0]), time, place, plain)
            assert np.max(np.abs(out - plain - exact)) < 1e-9 * scale_of(superposition(waves), 1)


def test_database_that_does_not_cover_the_sea_is_refused_with_both_ranges():
    database = make(ONE)
    with pytest.raises(InputError, match=r"1\.5 s.*lies outside.*2\.09 to 62\.8 s"):
        pack_summed(regular_wave(0.1, 1.5, depth=DEPTH), database, yaws=[0.0])
    with pytest.raises(InputError, match="depth"):
        pack_summed(regular_wave(0.5, 10.0, depth=12.0), database, yaws=[0.0])
    with pytest.raises(InputError, match="drift"):
        pack_summed(SEA, database, yaws=[0.0], with_drift=True)
    with pytest.raises(InputError, match="yaw"):
        pack_summed(SEA, database, yaws=[0.0, 0.0])
    with pytest.raises(InputError, match="duration"):
        pack_series(SEA, database, places=[[0.0, 0.0, 0.0]], duration=0.0)
    with pytest.raises(InputError, match="rad/s"):
        excitation_at(database, [3.5], 0.0)


def test_energy_beyond_the_range_is_left_out_if_it_is_little():
    sea = irregular_waves(jonswap(1.65, 6.12), seed=3, depth=DEPTH)  # to 3.67 rad/s
    assert sea.omega.max() > 3.0
    packed = pack_summed(sea, make(ONE), yaws=[0.0])
    assert len(packed.omega) == np.count_nonzero(sea.omega <= 3.0)


def test_headings_outside_the_database_are_refused_and_stop_a_hull_that_turns_there():
    database = make(ONE, headings=np.arange(-30.0, 31.0, 10.0))
    with pytest.raises(InputError, match=r"headings.*60\.0.*-30\.0 to 30\.0 deg"):
        pack_summed(regular_wave(0.5, 8.0, math.radians(60.0), depth=DEPTH), database, yaws=[0.0])
    wave = regular_wave(0.5, 8.0, math.radians(20.0), depth=DEPTH)
    packed = pack_summed(wave, database, yaws=[0.0])
    out, held = np.empty(6), np.empty(6)
    summed(packed, 1.0, np.array([[0.0, 0.0, math.radians(-10.0)]]), held)
    summed(packed, 1.0, np.array([[0.0, 0.0, math.radians(-13.0)]]), out)
    assert out == pytest.approx(held, rel=2e-3)  # the bend at the end is rounded within a cell
    for bad in (math.radians(-16.0), math.radians(170.0), math.nan):
        summed(packed, 1.0, np.array([[0.0, 0.0, bad]]), out)
        assert np.all(np.isnan(out))
    single = make(ONE, headings=[0.0])
    summed(pack_summed(regular_wave(0.5, 8.0, depth=DEPTH), single, yaws=[0.0]), 1.0, np.zeros((1, 3)), out)
    assert np.all(np.isfinite(out))
