"""Solver of contacts: enumeration of all states, closed forms, least squares, and thousands of random problems."""

from __future__ import annotations

import itertools

import contact_problems as problems
import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.optimize import brentq, nnls

from heavylift.solver.contact.laws.normal_force import mean_normal_force
from heavylift.solver.contact.layout import (
    BILATERAL,
    COMPLIANT,
    CURVE,
    HERTZ,
    INACTIVE,
    NORMAL_GIVEN,
)
from heavylift.solver.contact.solve.newton import FAILED, NonsmoothNewton, solve_contacts


def points(rng, count, mu, size=None, softness=1e-3):
    """Contacts between the origin and points with a dense inverse mass."""
    size = size or 3 * count
    root = rng.normal(size=(size, size))
    B = root @ root.T + 0.1 * np.eye(size)
    contacts = [[(3 * c, np.eye(3))] for c in range(count)]
    return problems.build(contacts, rng.normal(size=size), B, mu, softness)


def candidates_of_one(problem):
    """All solutions of one contact: open, stick, and every slip whose direction is opposed by friction."""
    w0, A = problem.N @ problem.y0, problem.W + np.diag(problem.parameters[0].softness)
    mu = problem.parameters[0].friction
    if w0[0] >= 0.0:
        yield np.zeros(3)
    p = np.linalg.solve(A, -w0)
    if p[0] >= 0.0 and np.hypot(p[1], p[2]) <= mu * p[0]:
        yield p

    def impulse(angle):
        along = np.array([1.0, mu * np.cos(angle), mu * np.sin(angle)])
        return -w0[0] / (A[0] @ along) * along

    def turn(angle):  # rate across the direction of friction
        g = w0 + A @ impulse(angle)
        return -np.sin(angle) * g[1] + np.cos(angle) * g[2]

    grid = np.linspace(0.0, 2.0 * np.pi, 2001)
    values = [turn(a) for a in grid]
    for a, b, u, v in zip(grid[:-1], grid[1:], values[:-1], values[1:], strict=True):
        if u * v <= 0.0:
            angle = brentq(turn, a, b, xtol=1e-14)
            p = impulse(angle)
            g = w0 + A @ p
            if p[0] > 0.0 and abs(turn(angle)) < 1e-6 and g[1] * np.cos(angle) + g[2] * np.sin(angle) <= 0.0:
                yield p


@pytest.mark.slow
@pytest.mark.parametrize("form", ["solve", "solve_rows"])
def test_one_contact_against_enumeration(form):
    states = set()
    for seed in range(120):
        rng = np.random.default_rng(seed)
        problem = points(rng, 1, rng.uniform(0.1, 1.0))
        status, _, _, p, _ = getattr(problem, form)()
        assert status >= 0
        P = p[0]
        found = list(candidates_of_one(problem))
        assert min(np.abs(P - q).max() for q in found) < 1e-9 * max(1.0, np.abs(P).max())
        states.add(
            "open"
            if P[0] == 0.0
            else "slip"
            if np.hypot(*P[1:]) > 0.999999 * problem.parameters[0].friction * P[0]
            else "stick"
        )
    assert states == {"open", "stick", "slip"}


def test_two_contacts_in_a_plane_against_enumeration():
    for seed in range(150):
        rng = np.random.default_rng(seed)
        problem = points(rng, 2, 0.4)
        problem.y0[[2, 5]] = 0.0  # nothing out of the plane
        for i in (2, 5):
            problem.B[i, :] = problem.B[:, i] = 0.0
            problem.B[i, i] = 1.0
        _, _, _, p, _ = problem.solve()
        mu, w0 = 0.4, problem.N @ problem.y0
        A = problem.W + np.diag(problem.parameters["softness"].ravel())
        found = []
        for states in itertools.product(("open", "stick", -1.0, 1.0), repeat=2):
            system, right = np.eye(6), np.zeros(6)
            for c, state in enumerate(states):
                n, t = 3 * c, 3 * c + 1
                if state == "open":
                    continue
                system[n], right[n] = A[n], -w0[n]
                if state == "stick":
                    system[t], right[t] = A[t], -w0[t]
                else:
                    system[t, n] = -state * mu
            q = np.linalg.solve(system, right)
            g = w0 + A @ q
            for c, state in enumerate(states):
                n, t = 3 * c, 3 * c + 1
                good = g[n] >= 0.0 if state == "open" else q[n] >= 0.0
                if state == "stick":
                    good = good and abs(q[t]) <= mu * q[n]
                elif state != "open":
                    good = good and state * g[t] <= 0.0
                if not good:
                    break
            else:
                found.append(q)
        assert found
        assert min(np.abs(p.ravel() - q).max() for q in found) < 1e-9


def test_redundant_contacts_without_friction_are_a_least_squares_problem():
    for seed in range(20):
        rng = np.random.default_rng(seed)
        problem = problems.stack(5, rng, 0.1, mu=0.0)
        softness = 1e-5 * problem.W.diagonal()[0]
        problem.parameters["softness"][:, 0] = softness
        N, L = problem.N[0::3], np.linalg.cholesky(problem.B)
        A = np.vstack([L.T @ N.T, np.sqrt(softness) * np.eye(problem.count)])
        expected, _ = nnls(A, np.concatenate([-np.linalg.solve(L, problem.y0), np.zeros(problem.count)]))
        status, _, _, p, _ = problem.solve()
        assert status >= 0
        np.testing.assert_allclose(p[:, 0], expected, rtol=1e-8, atol=1e-8 * expected.max())
        assert np.all(p[:, 1:] == 0.0)


@pytest.mark.parametrize("form", ["solve", "solve_rows"])
def test_resting_box_carries_no_noise(form):
    rng = np.random.default_rng(3)
    for _ in range(10):
        frame = problems.frame_about(rng.normal(size=3))
        contacts = [
            [(0, problems.rows_at(frame, frame.T @ [-0.3, x, y]))] for x in (-1.0, 1.0) for y in (-0.5, 0.5)
        ]
        y0 = np.concatenate([-0.0981 * frame[0], np.zeros(3)])
        problem = problems.build(contacts, y0, np.diag([1e-3] * 3 + [4e-3] * 3), 0.5)
        _, _, residual, p, w = getattr(problem, form)()
        weight = 98.1 / (1.0 + 0.25e-7 * problem.W.diagonal()[0] * 1000.0)  # shared by softness
        np.testing.assert_allclose(p[:, 0].sum(), weight, rtol=1e-13)
        np.testing.assert_allclose(p[:, 0], 0.25 * weight, rtol=1e-10 if form == "solve" else 1e-8)
        assert residual < 1e-14
        assert np.abs(w).max() < 1e-7


@pytest.mark.parametrize("mu", [0.1, 0.5, 0.9])
def test_box_on_an_incline_at_the_threshold(mu):
    h, g, mass = 0.01, 9.81, 1000.0
    B = problems.inverse_masses(np.array([mass]), np.array([1.0, 0.5, 0.05]))
    for part in (-1e-6, 1e-6):
        slope = np.arctan(mu * (1.0 + part))
        contacts = [
            [(0, problems.rows_at(problems.UP, np.array([x, y, -0.05])))]
            for x in (-1.0, 1.0)
            for y in (-0.5, 0.5)
        ]
        y0 = np.array([h * g * np.sin(slope), 0.0, -h * g * np.cos(slope), 0.0, 0.0, 0.0])
        problem = problems.build(contacts, y0, B, mu, 1e-11)
        _, _, _, p, _ = problem.solve()
        speed = (y0 + B @ problem.N.T @ p.ravel())[0]
        # a softness relative to W moves the box by a part like it of h g: 1e-11 is 1e-5 of what is measured here
        slides = h * g * (np.sin(slope) - mu * np.cos(slope))
        if part > 0.0:
            assert speed == pytest.approx(slides, rel=1e-4)
            assert np.hypot(p[:, 1].sum(), p[:, 2].sum()) == pytest.approx(mu * p[:, 0].sum(), rel=1e-12)
        else:
            assert abs(speed) < 1e-11 * h * g
            assert np.hypot(p[:, 1].sum(), p[:, 2].sum()) == pytest.approx(mass * y0[0], rel=1e-7)


def test_rod_that_strikes_with_friction():
    # T. R. Kane and D. A. Levinson, Dynamics: Theory and Applications (1985): stick or slip at one end of a rod
    mass, half = 2.0, 0.6
    states = set()
    for angle, spin, speed in itertools.product((0.3, 0.8, 1.2), (-2.0, 0.0, 3.0), (-4.0, 0.5, 6.0)):
        arm = -half * np.array([np.cos(angle), 0.0, np.sin(angle)])
        inertia = mass * half**2 / 3.0
        B = np.diag([1.0 / mass] * 3 + [1.0 / inertia] * 3)
        y0 = np.array([speed, 0.0, -3.0, 0.0, spin, 0.0])
        problem = problems.build([[(0, problems.rows_at(problems.UP, arm))]], y0, B, 0.4, 1e-12)
        _, _, _, p, w = problem.solve()
        # in the plane of the rod, by hand
        x, z = arm[0], arm[2]
        W = np.array(
            [
                [1.0 / mass + x * x / inertia, -x * z / inertia],
                [-x * z / inertia, 1.0 / mass + z * z / inertia],
            ]
        )
        rate = np.array([-3.0 - spin * x, speed + spin * z])
        if rate[0] >= 0.0:
            expected = np.zeros(2)
        else:
            expected = -np.linalg.solve(W, rate)
            if expected[0] < 0.0 or abs(expected[1]) > 0.4 * expected[0]:
                for sign in (-1.0, 1.0):
                    normal = -rate[0] / (W[0, 0] + sign * 0.4 * W[0, 1])
                    trial = np.array([normal, sign * 0.4 * normal])
                    if normal >= 0.0 and sign * (rate + W @ trial)[1] <= 0.0:
                        expected = trial
        tangent = problems.UP[1:] @ [1.0, 0.0, 0.0] @ p[0, 1:]
        np.testing.assert_allclose([p[0, 0], tangent], expected, rtol=1e-9, atol=1e-10)
        assert w[0, 0] > -1e-10
        states.add("open" if p[0, 0] == 0.0 else "slip" if abs(tangent) > 0.39999999 * p[0, 0] else "stick")
    assert states >= {"stick", "slip"}


def checked(problem, form="solve", start=None):
    """Solve and check the laws, the cones and the dissipation of friction; returns the status and iterations."""
    status, iterations, residual, p, w = getattr(problem, form)(start)
    assert status != FAILED
    assert residual <= 1e-10
    mu, P = problem.parameters["friction"], p + problem.parameters["offset"]
    assert P[:, 0].min() >= -1e-12 * np.abs(P).max()
    assert np.all(np.hypot(P[:, 1], P[:, 2]) <= mu * P[:, 0] * (1.0 + 1e-9) + 1e-15 * np.abs(P).max())
    rounding = np.abs(p * problem.W.diagonal().reshape(-1, 3)).max() / max(
        np.abs(w).max(), np.abs(problem.N @ problem.y0).max()
    )
    assert problems.violation(problem, p, w) < 1e-9 + 1e-14 * rounding
    return status, iterations, p, w


@pytest.mark.parametrize("family", ["resting", "wedged", "chain", "stack"])
def test_random_problems(family):
    make = {
        "resting": problems.resting,
        "wedged": problems.wedged,
        "chain": lambda rng: problems.chain(5, rng, 10.0 ** rng.uniform(-3.0, 0.0)),
        "stack": lambda rng: problems.stack(5, rng, 10.0 ** rng.uniform(-3.0, 0.0)),
    }[family]
    mixed = 0
    for seed in range(150):
        problem = make(np.random.default_rng([7, seed]))
        _, _, p, w = checked(problem)
        slips = (p[:, 0] > 0.0) & (
            np.hypot(p[:, 1], p[:, 2]) > problem.parameters["friction"] * p[:, 0] * (1 - 1e-9)
        )
        mixed += bool(np.any(slips) and np.any(~slips & (p[:, 0] > 0.0)))
        work = np.sum(p[:, 1:] * w[:, 1:], axis=1)
        assert work.max() <= 1e-13 * np.abs(p).max() * np.abs(problem.N @ problem.y0).max()
    assert mixed > 10


@pytest.mark.slow
@pytest.mark.parametrize("family", ["resting", "wedged"])
def test_ten_thousand_random_problems(family):
    for seed in range(10_000):
        checked(getattr(problems, family)(np.random.default_rng([11, seed])))


def test_both_forms_agree_and_repeat():
    for seed in range(20):
        problem = problems.resting(np.random.default_rng([5, seed]), 6)
        problem.parameters["softness"] *= 1e4  # one solution
        problem.parameters["friction"] = 0.2
        first, second, third = problem.solve(), problem.solve_rows(), problem.solve()
        assert np.array_equal(first[3], third[3])
        np.testing.assert_allclose(first[3], second[3], rtol=1e-7, atol=1e-8 * np.abs(first[3]).max())


def test_warm_start_of_a_stack():
    problem = problems.stack(10, np.random.default_rng(1), 0.03)
    _, cold, p, _ = checked(problem)
    problem.y0 *= 1.0 + 1e-6
    _, warm, _, _ = checked(problem, start=p)
    assert warm <= min(10, cold // 2)
    checked(problem, start=np.full_like(p, np.nan))


def test_many_contacts_on_two_bodies():
    problem = problems.tank_in_hull(np.random.default_rng(1))
    status, iterations, p, _ = checked(problem)
    assert status == 0
    assert iterations <= 15
    assert np.count_nonzero(p[:, 0]) > 100


@pytest.mark.parametrize("noise", [0.0, 1e-10, 1e-8])
def test_a_wall_bears_more_often_than_needed(noise):
    """332 contacts, rank 288 of 996, with targets that no rigid motion fits: each course carries what is above it."""
    courses, width = 8, 6
    problem = problems.wall(courses, width, np.random.default_rng(1), noise)
    assert problem.count == 332
    status, iterations, residual, p, w = problem.solve()
    assert status != FAILED
    assert iterations < 300
    assert residual <= max(1e-10, 10.0 * noise)  # over 1 m/s
    np.testing.assert_allclose(w, problem.parameters["target"], atol=max(1e-9, 10.0 * noise))
    assert np.all(np.hypot(p[:, 1], p[:, 2]) <= 0.5 * p[:, 0] * (1.0 + 1e-9))
    weight = width * 100.0 * 9.81 * 0.5e-3
    lowest = problem.ends[:, 3] == 0  # on the ground
    assert p[lowest, 0].sum() == pytest.approx(courses * weight, rel=1e-6 + 100.0 * noise)


@pytest.mark.parametrize(("step", "error"), [(1e-3, 2e-3), (1e-4, 2e-3), (1e-5, 2e-3), (1e-6, 2e-2)])
def test_a_wall_bears_its_load_whatever_the_step(step, error):
    """Gaps differ by some 1 % of g h^2, as much in steps of any length; without friction a quadratic programme."""
    courses, width = 8, 6
    rng = np.random.default_rng(1)
    problem = problems.wall(courses, width, rng, 0.01 * 9.81 * step, mu=0.0, step=step)
    status, iterations, _, p, _ = problem.solve()
    assert status != FAILED
    assert iterations < (300 if step > 1e-6 else 2000)
    softness, target = problem.parameters["softness"][:, 0], problem.parameters["target"][:, 0]
    L = np.linalg.cholesky(problem.B)
    A = np.vstack([L.T @ problem.N[0::3].T, np.diag(np.sqrt(softness))])
    b = np.concatenate([-np.linalg.solve(L, problem.y0), target / np.sqrt(softness)])
    expected, _ = nnls(A, b, maxiter=20_000)
    lowest = problem.ends[:, 3] == 0
    weight = courses * width * 100.0 * 9.81 * 0.5 * step
    assert p[lowest, 0].sum() == pytest.approx(expected[lowest].sum(), abs=error * weight)


@pytest.mark.slow
def test_a_wall_that_fits_no_motion_is_given_up_soon():
    """480 velocities, targets 1e5 times what a solution allows: impulses push and stay in their cones all the same."""
    problem = problems.wall(10, 8, np.random.default_rng(1), 1e-5)
    status, iterations, residual, p, _ = problem.solve()
    assert status == FAILED
    assert 1e-7 < residual < 1e-3
    assert iterations < 2000  # systems and sweeps: a second, where 4 s went by
    assert p[:, 0].min() >= 0.0
    assert np.all(np.hypot(p[:, 1], p[:, 2]) <= 0.5 * p[:, 0] * (1.0 + 1e-9))


def test_what_is_given_up_has_the_residual_that_is_told():
    """The best impulses of all attempts push and stay in their cones; what they violate is measured independently."""
    problem = problems.wall(8, 6, np.random.default_rng(1), 1e-5)
    status, iterations, residual, p, w = problem.solve()
    assert status == FAILED
    assert iterations < 4000  # systems and sweeps, a few tenths of a second
    largest = max(
        np.abs(problem.N @ problem.y0).max(), np.abs(w - (problem.N @ problem.y0).reshape(-1, 3)).max()
    )
    violated = problems.violation(problem, p, w) * largest / max(largest, problem.least_rate)
    assert violated == pytest.approx(
        residual, rel=0.5
    )  # which adds what a contact violates along three directions
    assert residual < 1e-3
    assert p[:, 0].min() >= 0.0
    assert np.all(np.hypot(p[:, 1], p[:, 2]) <= 0.5 * p[:, 0] * (1.0 + 1e-9))


@pytest.mark.parametrize("fixed", [False, True])
def test_of_the_inverse_mass_only_its_blocks_are_read(fixed):
    """Free bodies feel no others: the same impulses with nothing outside their blocks; one without motion has zeros."""
    problem = problems.stack(6, np.random.default_rng(2), 0.05)
    if fixed:
        problem.B[:6, :6] = 0.0
        problem.y0[:6] = 0.0
    _, _, _, expected, _ = problem.solve()
    packed = problem.packed()
    first = 6 * (np.arange(len(problem.y0)) // 6)
    B = np.where(first[:, None] == first, packed.B, np.nan)
    told = packed._replace(B=B, head=first, past=first + 6)
    solve_contacts((NonsmoothNewton(),), told)
    np.testing.assert_allclose(
        told.p.reshape(-1, 3), expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max()
    )


def test_what_does_not_act_on_each_other_is_solved_apart():
    """Two stacks in one problem have the impulses of each of them alone; one that is found soon iterates no more."""
    apart = [
        problems.stack(4, np.random.default_rng(5), 0.3),
        problems.stack(1, np.random.default_rng(6), 0.0),
    ]
    first, second = apart
    shift = np.array([len(first.y0), 0, len(first.y0), 0]) * (second.ends[:, [1, 1, 3, 3]] > 0)
    both = problems.ContactProblem(
        np.concatenate([one.kinds for one in apart]).view(type(first.kinds)),
        np.concatenate([one.parameters for one in apart]).view(type(first.parameters)),
        np.vstack([first.ends, second.ends + shift]),
        np.vstack([one.blocks for one in apart]),
        np.concatenate([one.y0 for one in apart]),
        block_diag(*(one.B for one in apart)),
        block_diag(*(one.N for one in apart)),
    )
    packed = both.packed()
    solve_contacts((NonsmoothNewton(),), packed)
    alone = [one.solve() for one in apart]
    expected = np.vstack([one[3] for one in alone])
    np.testing.assert_allclose(packed.p.reshape(-1, 3), expected, atol=1e-8 * np.abs(expected).max())
    iterations = [one[1] for one in alone]
    assert 0 < iterations[1] < iterations[0]
    assert packed.solution.effort < iterations[0] * both.count


def test_rates_of_rounding_ask_for_no_impulses_of_a_size():
    """Three contacts too many under rates of 1e-14 m/s, as at the end of a step at rest: found at once."""
    for seed in range(100):
        rng = np.random.default_rng([13, seed])
        problem = problems.wall(1, 1, rng, 0.0)
        problem.y0[:] = 0.0
        problem.parameters["target"][:] = 1e-14 * rng.normal(size=(4, 3))
        status, iterations, _, p, _ = problem.solve()
        assert status == 0
        assert iterations <= 6
        assert np.abs(p * problem.W.diagonal().reshape(-1, 3)).max() < 1e-4


def test_offsets_are_impulses_given_before():
    for seed in range(30):  # w + S p - b as a function of P = p + o stays the same
        rng = np.random.default_rng([9, seed])
        problem = problems.resting(rng, 5)
        problem.parameters["softness"] *= 1e4
        _, _, _, plain, _ = problem.solve()
        offset = rng.uniform(0.0, 1.0, (5, 3)) * np.abs(plain).max()
        problem.parameters["offset"] = offset
        problem.parameters["target"] -= problem.parameters["softness"] * offset
        problem.y0 = problem.y0 + problem.B @ problem.N.T @ offset.ravel()
        _, _, _, rest, _ = problem.solve()
        np.testing.assert_allclose(rest + offset, plain, rtol=1e-6, atol=1e-6 * np.abs(plain).max())


def test_bilateral_contact_with_friction():
    B = np.diag([1.0, 1.0, 1.0]) / 2.0
    for pull in (-3.0, 3.0):  # holds both ways
        problem = problems.build([[(0, np.eye(3))]], np.array([pull, 4.0, 3.0]), B, 0.3, 1e-9)
        problem.kinds[0].kind = BILATERAL
        for form in ("solve", "solve_rows"):
            _, _, _, p, w = getattr(problem, form)()
            assert p[0, 0] == pytest.approx(-2.0 * pull, rel=1e-8)
            np.testing.assert_allclose(p[0, 1:], -0.3 * 6.0 * np.array([0.8, 0.6]), rtol=1e-8)
            assert abs(w[0, 0]) < 1e-8


def test_bead_on_a_curve():
    B = np.eye(3) / 2.0
    for along, expected in ((4.0, -0.3 * 10.0), (1.0, -2.0)):  # slips, sticks
        problem = problems.build([[(0, np.eye(3))]], np.array([-3.0, 4.0, along]), B, 0.3, 1e-9)
        problem.kinds[0].kind = CURVE
        for form in ("solve", "solve_rows"):
            status, _, _, p, w = getattr(problem, form)()
            assert status == 0
            np.testing.assert_allclose(p[0], [6.0, -8.0, expected], rtol=1e-8)
            assert np.abs(w[0, :2]).max() < 1e-8


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_compliant_contact_is_the_mean_force(mu):
    h, k, mass = 1e-3, 3e6, 2.0
    for d0, speed in ((1e-3, 1.0), (-2e-4, 1.0), (1e-3, -3.0), (-1e-3, 0.1)):
        problem = problems.build([[(0, np.eye(3))]], np.array([-speed, 0.5, 0.0]), np.eye(3) / mass, mu, 1e-9)
        problem.kinds[0] = COMPLIANT, HERTZ
        told = problem.parameters[0]
        told.stiffness, told.exponent, told.depth, told.step = k, 1.5, d0, h
        _, _, _, p, w = problem.solve()
        force = mean_normal_force(HERTZ, k, 1.5, 0.0, d0, d0 - h * w[0, 0], h)[1]
        assert p[0, 0] == pytest.approx(0.5 * h * force, rel=1e-12, abs=1e-15)
        assert w[0, 0] == pytest.approx(-speed + p[0, 0] / mass, rel=1e-12)
        assert p[0, 1] == pytest.approx(-min(mu * p[0, 0], 0.5 * mass), rel=1e-7, abs=1e-15)


def test_given_normal_impulse_and_inactive_contacts():
    problem = problems.build(
        [[(0, np.eye(3))], [(3, np.eye(3))]], np.array([-1.0, 4.0, 3.0] * 2), np.eye(6), 0.5, 1e-9
    )
    problem.kinds["kind"] = NORMAL_GIVEN, INACTIVE
    problem.parameters["offset"][:, 0] = 2.0
    for form in ("solve", "solve_rows"):
        _, _, _, p, w = getattr(problem, form)(np.ones((2, 3)))
        np.testing.assert_allclose(p[0], [0.0, -0.8, -0.6], rtol=1e-9, atol=1e-15)
        assert np.all(p[1] == 0.0)
        np.testing.assert_allclose(w[1], [-1.0, 4.0, 3.0])


def test_lost_bodies_fail_at_once():
    problem = problems.stack(2, np.random.default_rng(1), 0.1)
    problem.y0[3] = np.nan
    for form in ("solve", "solve_rows"):
        status, iterations, _, _, _ = getattr(problem, form)()
        assert status == FAILED
        assert iterations == 0
