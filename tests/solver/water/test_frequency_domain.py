"""Response operators against closed forms: one coordinate, joints, weight, natural periods, responses in a sea."""

import math
from dataclasses import replace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.solver.water.hulls.frequency_domain import (
    linear_hulls,
    motion_operators,
    natural_modes,
    resonant_frequencies,
    rigid_body_mass,
)

W = np.linspace(0.2, 3.0, 57)
HEADINGS = np.deg2rad(np.arange(0.0, 360.0, 10.0))
MASS = np.array([2e6, 2e6, 2e6, 3e8, 9e8, 9e8])
STIFFNESS = np.array([1e5, 1e5, 4e6, 2e8, 6e8, 1e7])


def make(references=((0.0, 0.0, 0.0),), *, slope=0.0):
    """Diagonal coefficients, the added mass in heave with a slope; forces (1 + 0.1 j) 1e6 exp(0.2 i j)."""
    points = np.array(references, dtype=float)
    n = 6 * len(points)
    A = np.tile(np.diag(np.tile(0.5 * MASS, len(points))), (len(W), 1, 1))
    A[:, 2, 2] *= 1.0 + slope * W
    B = np.tile(np.diag(np.tile(0.1 * MASS, len(points))), (len(W), 1, 1))
    j = np.arange(n)
    own = (1.0 + 0.1 * j) * 1e6 * np.exp(0.2j * j)
    k = W**2 / 9.81
    along = np.cos(HEADINGS)[:, None] * points[:, 0] + np.sin(HEADINGS)[:, None] * points[:, 1]
    moved = np.repeat(np.exp(1j * k[:, None, None] * along), 6, axis=2)
    return HydrodynamicDatabase(
        bodies=tuple("ab"[: len(points)]),
        omega=W,
        headings=HEADINGS,
        added_mass=A,
        damping=B,
        added_mass_infinite=A[-1],
        excitation=own * moved,
        reference_points=points,
        density=1025.0,
        gravity=9.81,
        depth=np.inf,
        source="closed form",
    ), own


def test_uncoupled_motion_is_that_of_six_oscillators():
    database, own = make()
    extra = 2e5
    hulls = linear_hulls(database, np.diag(MASS), np.diag(STIFFNESS), damping=extra * np.eye(6))
    found = motion_operators(hulls, headings=[0.0, 0.77])
    w = W[:, None]
    exact = own / (STIFFNESS - w**2 * 1.5 * MASS - 1j * w * (0.1 * MASS + extra))
    for h in range(2):
        assert found.motion[:, h] == pytest.approx(exact, rel=1e-9)
    assert found.amplitude[:, 0] == pytest.approx(np.abs(exact), rel=1e-9)


def test_phase_is_the_lag_of_the_time_history():
    database, _ = make()
    found = motion_operators(linear_hulls(database, np.diag(MASS), np.diag(STIFFNESS)), headings=[0.0])
    # heave integrated over many periods, until the start is forgotten
    w = W[10]
    M, C, B = 1.5 * MASS[2], STIFFNESS[2], 0.1 * MASS[2]
    X = database.excitation[10, 0, 2]
    from scipy.integrate import solve_ivp

    def rates(t, y):
        return [y[1], ((X * np.exp(-1j * w * t)).real - B * y[1] - C * y[0]) / M]

    period = 2.0 * math.pi / w
    t = np.linspace(60.0 * period, 61.0 * period, 400)
    z = solve_ivp(rates, (0.0, 61.0 * period), [0.0, 0.0], t_eval=t, rtol=1e-9, atol=1e-9).y[0]
    exact = found.amplitude[10, 0, 2] * np.cos(w * t - found.phase[10, 0, 2])
    assert z == pytest.approx(exact, abs=2e-3 * found.amplitude[10, 0, 2])


def test_hulls_apart_feel_the_same_wave_later():
    database, own = make(((0.0, 0.0, 0.0), (50.0, 20.0, 0.0)))
    hulls = linear_hulls(database, np.diag(np.tile(MASS, 2)), np.diag(np.tile(STIFFNESS, 2)))
    beta = math.radians(40.0)
    found = motion_operators(hulls, headings=[beta]).motion[:, 0, 6:]
    lag = W[:, None] ** 2 / 9.81 * (50.0 * math.cos(beta) + 20.0 * math.sin(beta))
    w = W[:, None]
    exact = own[6:] * np.exp(1j * lag) / (STIFFNESS - w**2 * 1.5 * MASS - 0.1j * w * MASS)
    assert found == pytest.approx(exact, rel=1e-8)


def test_joint_in_heave_makes_one_oscillator_and_gives_its_force():
    database, _ = make(((0.0, 0.0, 0.0), (50.0, 0.0, 0.0)))
    masses = np.concatenate([MASS, 3.0 * MASS])
    stiffness = np.concatenate([STIFFNESS, 0.5 * STIFFNESS])
    G = np.zeros((1, 12))
    G[0, 2], G[0, 8] = 2.0, -2.0  # any scale of the row
    hulls = linear_hulls(database, np.diag(masses), np.diag(stiffness), constraint_jacobian=G)
    found = motion_operators(hulls, headings=[0.0])
    X = database.excitation[:, 0]  # the first reference point is the origin of the database
    A, B = database.added_mass[0].diagonal(), database.damping[0].diagonal()
    Z = stiffness - W[:, None] ** 2 * (masses + A) - 1j * W[:, None] * B
    together = (X[:, 2] + X[:, 8]) / (Z[:, 2] + Z[:, 8])
    assert found.motion[:, 0, 2] == pytest.approx(together, rel=1e-8)
    assert found.motion[:, 0, 8] == pytest.approx(together, rel=1e-8)
    force = (Z[:, 2] * together - X[:, 2]) / 2.0
    assert found.constraint_force[:, 0, 0] == pytest.approx(force, rel=1e-7)


def test_natural_periods_follow_the_added_mass_of_their_own_frequency():
    slope = 0.3
    database, _ = make(slope=slope)
    stiffness = STIFFNESS.copy()
    stiffness[[0, 1, 5]] = 0.0  # not moored
    modes = natural_modes(linear_hulls(database, np.diag(MASS), np.diag(stiffness)))
    assert sorted(mode.coordinate for mode in modes) == [2, 3, 4]
    for mode in modes:
        w = 2.0 * math.pi / mode.period
        added = 0.5 * MASS[mode.coordinate] * (1.0 + (slope * w if mode.coordinate == 2 else 0.0))
        assert w**2 * (MASS[mode.coordinate] + added) == pytest.approx(stiffness[mode.coordinate], rel=1e-8)
        assert mode.shape[mode.coordinate] == 1.0
    assert [mode.period for mode in modes] == sorted((mode.period for mode in modes), reverse=True)


def test_mass_about_another_point_has_the_kinetic_energy_of_the_body():
    rng = np.random.default_rng(0)
    m, c = 7.0, rng.normal(size=3)
    J = np.diag([3.0, 4.0, 5.0]) + 0.1
    M = rigid_body_mass(m, c, J)
    v, w = rng.normal(size=3), rng.normal(size=3)
    centre = v + np.cross(w, c)
    speeds = np.concatenate([v, w])
    assert 0.5 * speeds @ M @ speeds == pytest.approx(0.5 * m * centre @ centre + 0.5 * w @ J @ w, rel=1e-13)
    assert pytest.approx(M.T) == M


def test_wrong_input_is_refused():
    database, _ = make()
    with pytest.raises(InputError, match="mass"):
        linear_hulls(database, np.eye(5), np.diag(STIFFNESS))
    with pytest.raises(InputError, match="positive"):
        linear_hulls(database, -np.diag(MASS), np.diag(STIFFNESS))
    with pytest.raises(InputError, match="constraint_jacobian"):
        linear_hulls(database, np.diag(MASS), np.diag(STIFFNESS), constraint_jacobian=np.ones((2, 6)))
    hulls = linear_hulls(database, np.diag(MASS), np.diag(STIFFNESS))
    with pytest.raises(InputError, match=r"0\.2 to 3 rad/s"):
        motion_operators(hulls, headings=[0.0], omega=[5.0])


def test_natural_periods_where_water_between_hulls_resonates():
    """Heave with an added mass that falls below minus the mass: roots of c = w^2 (m + A(w)), counted where it falls.

    The added mass between the frequencies is the cubic spline through them, as everywhere. The root at which
    w^2 (m + A) falls has negative energy and is no mode.
    """
    from scipy.interpolate import CubicSpline
    from scipy.optimize import brentq

    database, _ = make()
    A = database.added_mass.copy()
    A[:, 2, 2] -= 2.5 * MASS[2] * np.exp(-(((W - 1.8) / 0.12) ** 2))
    A[:, 0, 2] = A[:, 2, 0] = 1e-3 * MASS[2]
    database = replace(database, added_mass=A)
    hulls = linear_hulls(database, np.diag(MASS), np.diag(STIFFNESS))
    resonant = resonant_frequencies(hulls)
    assert len(resonant) > 0
    assert np.all(np.abs(resonant - 1.8) < 0.15)
    assert len(resonant_frequencies(linear_hulls(make()[0], np.diag(MASS), np.diag(STIFFNESS)))) == 0
    added = CubicSpline(W, A[:, 2, 2])

    def left(w):
        return STIFFNESS[2] - w * w * (MASS[2] + added(w))

    grid = np.linspace(0.2, 3.0, 20001)
    value = left(grid)
    falls = np.flatnonzero((value[:-1] > 0.0) & (value[1:] <= 0.0))
    expected = sorted((2.0 * math.pi / brentq(left, grid[i], grid[i + 1]) for i in falls), reverse=True)
    assert len(expected) == 2
    modes = natural_modes(hulls)
    found = [mode.period for mode in modes if mode.coordinate == 2]
    assert found == pytest.approx(expected, rel=1e-4)
    # the others are single oscillators: 2 pi sqrt(1.5 m / c)
    for j in (0, 1, 3, 4, 5):
        (own,) = [mode.period for mode in modes if mode.coordinate == j]
        assert own == pytest.approx(2.0 * math.pi * math.sqrt(1.5 * MASS[j] / STIFFNESS[j]), rel=1e-4)


def test_modes_by_crossings_are_those_that_are_followed():
    """Both ways find the same where mass and added mass are positive."""
    from heavylift.solver.water.hulls import frequency_domain as f

    database, _ = make(slope=0.4)
    hulls = linear_hulls(database, np.diag(MASS), np.diag(STIFFNESS))
    followed = sorted(2.0 * math.pi / mode.period for mode in natural_modes(hulls))
    scale, free = f._free_coordinates(hulls)
    crossed = sorted(
        w for w, _ in f._crossed_modes(hulls, f._reduced(hulls.stiffness, scale, free), scale, free)
    )
    assert crossed == pytest.approx(followed, rel=1e-9)
