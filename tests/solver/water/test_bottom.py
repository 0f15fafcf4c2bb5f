"""Catenaries over inclined bottoms and between two hanging ends.

Against chains of springs of least energy, quadrature of the cable equations, closed forms and MoorPy.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.sparse import coo_matrix, identity
from scipy.sparse.linalg import splu

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, filled_rows, records
from heavylift.solver.scene.moorings import LineSection
from heavylift.solver.water.lines.bottom import BottomState, solve_lines_over_bottom
from heavylift.solver.water.lines.catenary import (
    FAILED,
    RESTING,
    SLACK,
    SUSPENDED,
    LineData,
    LineEnds,
    SectionData,
)
from heavylift.solver.water.lines.catenary_line import (
    Catenary,
    length_for_tension,
    profile_over_bottom,
    solve_catenary,
)

CHAIN = LineSection(300.0, 900.0, 4e8)
SOFT = (LineSection(120.0, 900.0, 2e6), LineSection(110.0, 400.0, 1e6), LineSection(70.0, 900.0, 2e6))


def rise(degrees: float) -> float:
    return math.tan(math.radians(degrees))


# MoorPy 1.3.0, catenary(x, z, L, EA, w, CB, alpha, Tol=1e-10) of this chain: span, height, slope [deg], clearance
# (None: on the bottom); H, V at the upper end, H, V of the lower end on the line, length on the bottom.
MOORPY = [
    (250.0, 80.0, -5.0, None, 44425.410801739, 121319.766846626, 56996.975666112, -4986.589226048, 160.88168148416),
    (220.0, 20.0, 0.0, 60.0, 25452.705650940, 94058.674865502, 25452.705650940, -75258.004599791, 111.87035614968),
]  # fmt: skip


@pytest.mark.parametrize("row", MOORPY)
def test_numbers_of_moorpy(row: tuple[Any, ...]) -> None:
    x, z, degrees, clearance, *expected = row
    line = solve_catenary((CHAIN,), x, z, slope=rise(degrees), clearance=clearance)
    found = [line.horizontal, line.vertical, line.anchor_horizontal, line.anchor_vertical, line.on_seabed]
    assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.filterwarnings("ignore")  # those of MoorPy, where it does not converge
def test_agrees_with_moorpy() -> None:
    """Uniform lines with the anchor on a slope, without friction and under tension all along; level U shapes.

    Not where MoorPy lets a line pass through the slope, or its iteration for a U shape ends elsewhere than at the span.
    """
    catenary = pytest.importorskip("moorpy.Catenary").catenary
    rng = np.random.default_rng(3)
    compared = tried = 0
    for _ in range(200):
        x, high, degrees = rng.uniform(50, 800), rng.uniform(20, 200), rng.uniform(-20, 20)
        clearance = None if rng.random() < 0.5 else rng.uniform(10, 150)
        if clearance is not None:
            degrees = 0.0
        z = high + x * rise(degrees) - (clearance or 0.0)
        chord, most = math.hypot(x, z), x / math.cos(math.radians(degrees)) + high + (clearance or 0.0)
        if clearance is not None and z < 0.0:
            continue
        length = chord + rng.uniform(0.02, 0.7) * (most - chord)
        section = LineSection(length, 10 ** rng.uniform(2, 3.5), 10 ** rng.uniform(7.5, 9))
        line = solve_catenary((section,), x, z, slope=rise(degrees), clearance=clearance)
        if line.branch != RESTING or line.anchor_horizontal < 100.0:
            continue
        ax, az, bx, bz, info = catenary(
            x, z, length, section.axial_stiffness, section.weight,
            CB=0.0 if clearance is None else -clearance, alpha=degrees, Tol=1e-9,
        )  # fmt: skip
        tried += 1
        if clearance is None and az < ax * (rise(degrees) - 1e-6):
            continue
        if clearance is not None:
            H, w, EA = -bx, section.weight, section.axial_stiffness
            reached = info["LBot"] * (1.0 + H / EA)
            reached += H / w * sum(math.asinh(abs(v) / H) for v in (az, bz)) + H * (abs(az) + abs(bz)) / (
                w * EA
            )
            if not abs(reached - x) < 1e-6 * length:
                continue
        scale = line.tension
        found = [line.horizontal, line.vertical, line.anchor_horizontal, line.anchor_vertical]
        assert np.abs(np.array(found) - [-bx, -bz, ax, az]).max() < 1e-6 * scale
        assert line.on_seabed == pytest.approx(info["LBot"], abs=1e-6 * length)
        compared += 1
    assert compared > max(60, 0.8 * tried)


class SpringChain:
    """Masses between springs that only pull, above a stiff plane, where their energy is least."""

    def __init__(
        self,
        sections: tuple[LineSection, ...],
        clumps: tuple[float, ...],
        slope: float,
        clearance: float,
        pieces: int,
    ) -> None:
        total = sum(section.length for section in sections)
        counts = [max(round(pieces * section.length / total), 1) for section in sections]
        self.rest = np.concatenate([np.full(n, s.length / n) for n, s in zip(counts, sections, strict=True)])
        self.stiffness = (
            np.concatenate([np.full(n, s.axial_stiffness) for n, s in zip(counts, sections, strict=True)])
            / self.rest
        )
        weights = (
            np.concatenate([np.full(n, s.weight) for n, s in zip(counts, sections, strict=True)]) * self.rest
        )
        self.weight = np.zeros(len(weights) + 1)
        self.weight[1:] += weights / 2
        self.weight[:-1] += weights / 2
        for joint, clump in zip(np.cumsum(counts)[:-1], clumps, strict=False):
            self.weight[joint] += clump
        self.normal = np.array([-slope, 1.0]) / math.hypot(1.0, slope)
        self.offset = clearance * self.normal[1]
        self.hard = 1e5 * weights.max()

    def energy(self, r: NDArray[np.float64]) -> float:
        stretch = np.maximum(np.linalg.norm(np.diff(r, axis=0), axis=1) - self.rest, 0.0)
        deep = np.minimum(r @ self.normal + self.offset, 0.0)
        return float(
            0.5 * self.stiffness @ stretch**2
            + self.weight @ r[:, 1]
            + 0.5 * self.hard * deep[1:-1] @ deep[1:-1]
        )

    def derivatives(self, r: NDArray[np.float64]) -> tuple[NDArray[np.float64], Any]:
        n = len(r)
        d = np.diff(r, axis=0)
        length = np.linalg.norm(d, axis=1)
        e = d / length[:, None]
        pull = (self.stiffness * np.maximum(length - self.rest, 0.0))[:, None] * e
        force = np.zeros_like(r)
        force[:-1] -= pull
        force[1:] += pull
        force[:, 1] += self.weight
        deep = np.minimum(r @ self.normal + self.offset, 0.0)
        deep[[0, -1]] = 0.0
        force += self.hard * deep[:, None] * self.normal
        along = e[:, :, None] * e[:, None, :]
        tight = (length > self.rest)[:, None, None]
        K = np.where(tight, np.eye(2) - (self.rest / length)[:, None, None] * (np.eye(2) - along), 0.0)
        K *= self.stiffness[:, None, None]
        at = np.arange(n - 1)
        blocks = [(at, at, K), (at + 1, at + 1, K), (at, at + 1, -K), (at + 1, at, -K)]
        touch = np.flatnonzero(deep < 0.0)
        blocks.append(
            (touch, touch, np.tile(self.hard * np.outer(self.normal, self.normal), (len(touch), 1, 1)))
        )
        rows = [(2 * i[:, None, None] + np.arange(2)[:, None] + 0 * k).ravel() for i, _, k in blocks]
        columns = [(2 * j[:, None, None] + np.arange(2) + 0 * k).ravel() for _, j, k in blocks]
        values = np.concatenate([k.ravel() for *_, k in blocks])
        H = coo_matrix(
            (values, (np.concatenate(rows).astype(int), np.concatenate(columns).astype(int))), (2 * n, 2 * n)
        )
        return force, H.tocsc()

    def settle(self, start: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces that the ends exert on the chain, lower and upper [N], shape (2, 2); from a shape with its ends [m].

        The energy is convex: wherever it begins, there is one minimum.
        """
        r = start.copy()
        damping, value = 1e-2 * self.stiffness.max(), self.energy(r)
        inner = slice(2, 2 * len(r) - 2)
        for _ in range(8000):
            force, H = self.derivatives(r)
            if np.abs(force[1:-1]).max() < 1e-9 * np.abs(force).max():
                return force[[0, -1]]
            H = H[inner, inner] + damping * identity(2 * len(r) - 4, format="csc")
            trial = r.copy()
            trial[1:-1] -= splu(H).solve(force[1:-1].ravel()).reshape(-1, 2)
            lower = self.energy(trial)
            if lower <= value + 1e-13 * abs(value):
                r, value, damping = trial, lower, damping / 4
            else:
                damping = 4 * damping + 1e-12
        raise AssertionError("the chain does not come to rest")


@pytest.mark.parametrize(
    ("x", "z", "degrees", "clearance", "clumps"),
    [
        (265.0, 60.0, 0.0, None, ()),
        (260.0, 110.0, 12.0, None, ()),  # the anchor downhill
        (260.0, 40.0, -12.0, None, ()),  # and uphill
        (230.0, 90.0, 15.0, None, (2e4, 0.0)),  # a clump on the slope
        (230.0, 30.0, 0.0, 60.0, ()),
        (225.0, 10.0, 8.0, 60.0, ()),
        (225.0, -20.0, -8.0, 70.0, (0.0, 1e4)),
        (230.0, 0.0, 0.0, 45.0, (3e4, 0.0)),  # a clump that the lower end lifts in part
        (285.0, 30.0, 10.0, 60.0, ()),  # clear of the bottom
        (215.0, 120.0, 20.0, None, ()),  # slides past its anchor
    ],
)
@pytest.mark.slow
def test_a_chain_of_springs(
    x: float, z: float, degrees: float, clearance: float | None, clumps: tuple[float, ...]
) -> None:
    slope = rise(degrees)
    line = solve_catenary(SOFT, x, z, slope=slope, clearance=clearance, clumps=clumps)
    chain = SpringChain(SOFT, clumps, slope, clearance or 0.0, 1000)
    profile = profile_over_bottom(SOFT, x, z, slope=slope, clearance=clearance, clumps=clumps)
    s = np.concatenate([[0.0], np.cumsum(chain.rest)])
    start = np.column_stack([np.interp(s, profile.s, profile.x), np.interp(s, profile.s, profile.z)])
    start[:, 0] -= 1.0 * np.sin(2 * np.pi * s / s[-1])
    start[:, 1] += 3.0 * np.sin(np.pi * s / s[-1])
    lower, upper = chain.settle(start)
    scale = line.tension
    assert upper == pytest.approx([line.horizontal, line.vertical], abs=3e-4 * scale)
    if clearance is not None:
        assert lower == pytest.approx([-line.anchor_horizontal, -line.anchor_vertical], abs=3e-4 * scale)


def shoot(
    section: LineSection, line: Catenary, slope: float, friction: float, lifted: float | None
) -> tuple[float, float]:
    """Span and height by quadrature of the cable equations down from the upper end, under tension all along."""
    angle = math.atan(slope)
    w, EA, H = section.weight, section.axial_stiffness, line.horizontal
    hung = (line.vertical - slope * H) / w

    def hang(H: float, v: float, length: float) -> tuple[float, float]:
        stretched = lambda s: 1.0 / math.hypot(H, v - w * s) + 1.0 / EA  # noqa: E731
        return (
            quad(lambda s: H * stretched(s), 0.0, length, epsabs=0, epsrel=1e-12)[0],
            quad(lambda s: (v - w * s) * stretched(s), 0.0, length, epsabs=1e-10, epsrel=1e-12)[0],
        )

    x, z = hang(H, line.vertical, hung)
    lying = line.on_seabed
    t = H / math.cos(angle)
    fall = w * (math.sin(angle) + friction * math.cos(angle))
    way = lying + (t * lying - 0.5 * fall * lying**2) / EA
    x, z = x + way * math.cos(angle), z + way * math.sin(angle)
    t -= fall * lying
    assert t > 0.0
    if lifted is None:
        assert line.anchor_horizontal == pytest.approx(t * math.cos(angle), rel=1e-10)
        return x, z
    low = hang(t * math.cos(angle), t * math.sin(angle), section.length - hung - lying)
    assert line.anchor_horizontal == pytest.approx(t * math.cos(angle), rel=1e-10)
    assert line.anchor_vertical == pytest.approx(
        t * math.sin(angle) - w * (section.length - hung - lying), rel=1e-10
    )
    assert slope * low[0] - low[1] == pytest.approx(lifted, abs=1e-8)
    return x + low[0], z + low[1]


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(
    ("x", "z", "degrees", "clearance"),
    [
        (280.0, 90.0, 7.0, None),
        (260.0, 40.0, -12.0, None),
        (235.0, 40.0, 0.0, 50.0),
        (245.0, 60.0, 7.0, 50.0),
        (240.0, 0.0, -6.0, 60.0),
    ],
)
def test_weight_and_friction_along_the_bottom(
    x: float, z: float, degrees: float, clearance: float | None, friction: float
) -> None:
    line = solve_catenary((CHAIN,), x, z, slope=rise(degrees), clearance=clearance, friction=friction)
    assert line.branch == RESTING
    assert line.on_seabed > 10.0
    assert shoot(CHAIN, line, rise(degrees), friction, clearance) == pytest.approx((x, z), abs=1e-8)
    if degrees == 0.0:  # the lying part takes up the difference of the horizontal tensions
        taken = line.horizontal - line.anchor_horizontal
        assert taken == pytest.approx(friction * 900.0 * line.on_seabed, rel=1e-9)


def test_a_u_shape_in_closed_form() -> None:
    """Inextensible over a level bottom: V^2 = (H + w h)^2 - H^2 at both ends, and the span follows from H."""
    w, L, a, b = 700.0, 260.0, 40.0, 65.0

    def lift(h: float, H: float) -> float:
        return math.sqrt(h * h + 2.0 * h * H / w)

    def span(H: float) -> float:
        tails = [lift(h, H) for h in (a, b)]
        return L - sum(tails) + sum(H / w * math.asinh(w * s / H) for s in tails)

    H = 3e4
    line = solve_catenary((LineSection(L, w, math.inf),), span(H), b - a, clearance=a)
    assert line.horizontal == pytest.approx(H, rel=1e-9)
    assert line.anchor_horizontal == pytest.approx(H, rel=1e-9)
    assert (line.vertical, -line.anchor_vertical) == pytest.approx((w * lift(b, H), w * lift(a, H)), rel=1e-9)
    assert line.on_seabed == pytest.approx(L - lift(a, H) - lift(b, H), rel=1e-9)


def test_a_line_on_a_steep_slope_lies_down_by_itself() -> None:
    """All but 30 m of height lies: t at the touch-down is what its weight and what hangs ask for.

    The anchor uphill carries ``t + w sin(b) l``, inextensible: a catenary that leaves the slope at its tangent.
    """
    w, degrees = 500.0, -25.0
    m, b = rise(degrees), math.radians(degrees)
    H = 4e4

    # from the touch-down at slope m up to 20 m over the bottom
    def over(u: float) -> float:  # V / H at the end
        return H / w * (math.sqrt(1 + u * u) - math.sqrt(1 + m * m) - m * (math.asinh(u) - math.asinh(m)))

    u = brentq(lambda u: over(u) - 20.0, m, 10.0, xtol=1e-14)
    hung, lying = H / w * (u - m), 150.0
    x = lying * math.cos(b) + H / w * (math.asinh(u) - math.asinh(m))
    z = lying * math.sin(b) + H / w * (math.sqrt(1 + u * u) - math.sqrt(1 + m * m))
    line = solve_catenary((LineSection(hung + lying, w, math.inf),), x, z, slope=m)
    assert (line.horizontal, line.vertical) == pytest.approx((H, u * H), rel=1e-9)
    assert line.anchor_tension == pytest.approx(H / math.cos(b) - w * math.sin(b) * lying, rel=1e-9)
    assert line.on_seabed == pytest.approx(lying, rel=1e-9)


@pytest.mark.parametrize("clumps", [(), (1e4, 5e3)])
@pytest.mark.parametrize(
    ("x", "z", "degrees", "clearance"),
    [
        (220.0, 30.0, 0.0, 60.0),
        (230.0, 10.0, 8.0, 60.0),
        (240.0, -30.0, -8.0, 80.0),
        (150.0, 0.0, 10.0, 60.0),
    ],
)
def test_ends_may_be_exchanged(
    x: float, z: float, degrees: float, clearance: float, clumps: tuple[float, ...]
) -> None:
    m = rise(degrees)
    there = solve_catenary(SOFT, x, z, slope=m, clearance=clearance, clumps=clumps)
    back = solve_catenary(SOFT[::-1], x, -z, slope=-m, clearance=clearance + z - m * x, clumps=clumps[::-1])
    assert there.branch == RESTING
    assert (back.horizontal, back.vertical) == pytest.approx(
        (there.anchor_horizontal, -there.anchor_vertical), rel=1e-9
    )
    assert (back.anchor_horizontal, back.anchor_vertical) == pytest.approx(
        (there.horizontal, -there.vertical), rel=1e-9
    )
    assert back.on_seabed == pytest.approx(there.on_seabed, rel=1e-9)


@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize(("x", "z"), [(180.0, 60.0), (250.0, 60.0), (280.0, 95.0), (300.0, 60.0)])
def test_limits_are_those_of_a_level_bottom(x: float, z: float, friction: float) -> None:
    """A slope that goes to zero, and an end that comes down to the bottom."""
    clumps = (1e4, 0.0)
    flat = solve_catenary(SOFT, x, z, friction=friction, clumps=clumps)
    slight = solve_catenary(SOFT, x, z, friction=friction, clumps=clumps, slope=1e-10)
    low = solve_catenary(SOFT, x, z, friction=friction, clumps=clumps, clearance=1e-7)
    level = solve_catenary(SOFT, x, z, friction=friction, clumps=clumps, slope=0.0)
    assert (level.horizontal, level.vertical, level.energy) == (flat.horizontal, flat.vertical, flat.energy)
    for near, rel in ((slight, 1e-6), (low, 1e-3)):
        assert (near.horizontal, near.vertical) == pytest.approx(
            (flat.horizontal, flat.vertical), rel=rel, abs=rel * flat.tension
        )
        assert near.energy == pytest.approx(flat.energy, rel=rel)
        assert near.on_seabed == pytest.approx(flat.on_seabed, rel=rel, abs=rel * 300.0)


def test_slack_lines() -> None:
    """Where friction holds what lies both ends hang straight down; where it does not, the rest slides downhill."""
    w = 500.0
    line = solve_catenary((LineSection(300.0, w, math.inf),), 50.0, 30.0, clearance=60.0)
    assert line.branch == SLACK
    assert (line.horizontal, line.anchor_horizontal) == (0.0, 0.0)
    assert (line.vertical, -line.anchor_vertical) == pytest.approx((90.0 * w, 60.0 * w), rel=1e-12)
    assert line.on_seabed == pytest.approx(150.0, rel=1e-12)
    m = rise(10.0)
    held = solve_catenary(
        (LineSection(300.0, w, math.inf),), 50.0, 30.0, slope=m, clearance=60.0, friction=0.5
    )
    assert held.branch == SLACK
    assert held.vertical == pytest.approx((90.0 - 50.0 * m) * w, rel=1e-12)
    loose = solve_catenary((LineSection(300.0, w, math.inf),), 50.0, 30.0, slope=m, clearance=60.0)
    assert loose.branch == RESTING
    assert loose.horizontal > 0.0 > loose.anchor_horizontal  # a loop below the foot of the lower end
    # what pulls at both ends of what lies is its weight along the slope
    t = (loose.horizontal - loose.anchor_horizontal) / math.cos(math.radians(10.0))
    assert t == pytest.approx(w * math.sin(math.radians(10.0)) * loose.on_seabed, rel=1e-9)


CASES = [
    (220.0, 90.0, 10.0, None), (255.0, 60.0, -10.0, None), (180.0, 60.0, 12.0, None),
    (220.0, 30.0, 0.0, 60.0), (230.0, 10.0, 8.0, 60.0), (240.0, -30.0, -8.0, 80.0), (280.0, 20.0, 5.0, 50.0),
    (150.0, 0.0, 10.0, 60.0),
]  # fmt: skip


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(("x", "z", "degrees", "clearance"), CASES)
def test_stiffness_is_the_derivative_of_the_force(
    x: float, z: float, degrees: float, clearance: float | None, friction: float
) -> None:
    more: dict[str, Any] = {
        "slope": rise(degrees),
        "clearance": clearance,
        "friction": friction,
        "clumps": (5e3, 8e3),
    }

    def force(x: float, z: float) -> NDArray[np.float64]:
        line = solve_catenary(SOFT, x, z, **more)
        return np.array([line.horizontal, line.vertical])

    K = solve_catenary(SOFT, x, z, **more).stiffness
    h, place = 1e-4, np.array([x, z])
    columns = []
    for d in h * np.eye(2):
        near = force(*(place + d)) - force(*(place - d))
        far = force(*(place + 2 * d)) - force(*(place - 2 * d))
        columns.append((8 * near - far) / (12 * h))
    assert np.abs(K - np.column_stack(columns)).max() < 1e-6 * np.abs(K).max()
    if friction == 0.0:
        assert K[0, 1] == pytest.approx(K[1, 0], rel=1e-9)
        assert np.linalg.eigvalsh(K)[0] > 0.0


@pytest.mark.parametrize(("x", "z", "degrees", "clearance"), CASES)
def test_energy_is_the_potential_of_the_force(
    x: float, z: float, degrees: float, clearance: float | None
) -> None:
    more: dict[str, Any] = {"slope": rise(degrees), "clearance": clearance, "clumps": (5e3, 8e3)}

    def energy(x: float, z: float) -> float:
        return solve_catenary(SOFT, x, z, **more).energy

    line = solve_catenary(SOFT, x, z, **more)
    h = 1e-3
    gradient = (
        (energy(x + h, z) - energy(x - h, z)) / (2 * h),
        (energy(x, z + h) - energy(x, z - h)) / (2 * h),
    )
    assert gradient == pytest.approx((line.horizontal, line.vertical), rel=1e-6, abs=1e-6 * line.tension)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(
    ("x", "z", "degrees", "clearance"), [*CASES, (50.0, 30.0, 0.0, 60.0), (60.0, 50.0, 5.0, None)]
)
def test_profile_and_energy_are_those_of_the_line(
    x: float, z: float, degrees: float, clearance: float | None, friction: float
) -> None:
    """It ends where the line does, nowhere below the bottom, and its parts carry the energy."""
    m = rise(degrees)
    more: dict[str, Any] = {"slope": m, "clearance": clearance, "friction": friction, "clumps": (5e3, 8e3)}
    line = solve_catenary(SOFT, x, z, **more)
    profile = profile_over_bottom(SOFT, x, z, points=2001, **more)
    assert (profile.x[0], profile.z[0]) == pytest.approx((0.0, 0.0), abs=1e-7)
    assert (profile.x[-1], profile.z[-1]) == pytest.approx((x, z), abs=1e-12)
    assert profile.tension[[0, -1]] == pytest.approx(
        [line.anchor_tension, line.tension], abs=1e-6 * line.tension
    )
    assert (profile.z - m * profile.x + (clearance or 0.0)).min() > -1e-7
    ds, mid = np.diff(profile.s), lambda a: (a[1:] + a[:-1]) / 2
    w = np.repeat([section.weight for section in SOFT], 2000)
    EA = np.repeat([section.axial_stiffness for section in SOFT], 2000)
    energy = np.sum(w * mid(profile.z) * ds) + np.sum(mid(profile.tension**2) / (2 * EA) * ds)
    energy += 5e3 * profile.z[2000] + 8e3 * profile.z[4000]
    assert line.energy == pytest.approx(energy, rel=1e-5, abs=1e-6 * line.tension * 300.0)


def random_lines(
    count: int, sections: int, hang: bool, friction: float
) -> tuple[Records[SectionData], Records[LineData], NDArray[np.float64]]:
    """Taut, nearly taut, ordinary and slack lines over slopes up to 40 degrees: sections, lines, places."""
    rng = np.random.default_rng(12)
    x, m = 10 ** rng.uniform(0, 3.3, count), np.tan(np.radians(rng.uniform(-40, 40, count)))
    low, high = rng.uniform(0.5, 300, count) * hang, rng.uniform(0.5, 500, count)
    z = high + m * x - low
    chord, most = np.hypot(x, z), x * np.hypot(1.0, m) + low + high
    length = np.choose(
        rng.integers(0, 4, count),
        [
            chord * (1 - 10 ** rng.uniform(-6, -1.2, count)),
            chord * (1 + 10 ** rng.uniform(-6, -1, count)),
            chord + (most - chord) * rng.random(count),
            most * rng.uniform(1, 2, count),
        ],
    )
    rows = np.zeros((count, sections, 4))
    rows[:, :, 0] = length[:, None] * rng.dirichlet(np.ones(sections), count)
    rows[:, :, 1] = (10 ** rng.uniform(1, 4, count))[:, None] * rng.uniform(0.3, 1.7, (count, sections))
    rows[:, :, 2] = 10 ** -rng.uniform(6, 10, count)[:, None]
    lines = records(LineData, count)
    lines["first"], lines["count"], lines["tail"] = np.arange(count) * sections, sections, 0
    lines["length"], lines["friction"] = length, friction
    lines["weight"] = (rows[:, :, 0] * rows[:, :, 1]).sum(1)
    lines["stretch"] = (rows[:, :, 0] * rows[:, :, 2]).sum(1)
    lengths, weights, flexibility, clump = rows.reshape(-1, 4).T
    return (
        filled_rows(SectionData, length=lengths, weight=weights, flexibility=flexibility, clump=clump),
        lines,
        np.column_stack([x, z, m, low if hang else -np.ones(count)]),
    )


@pytest.mark.parametrize("hang", [False, True])
@pytest.mark.parametrize(("sections", "friction"), [(1, 0.0), (1, 0.4), (3, 0.0), (3, 0.4)])
def test_random_lines(sections: int, friction: float, hang: bool) -> None:
    """Three thousand lines: none fails, the nodes close, and warm starts find the same."""
    rows, lines, places = random_lines(3000, sections, hang, friction)

    def solve(places: NDArray[np.float64], state: Records[BottomState]) -> Records[BottomState]:
        solve_lines_over_bottom(rows, lines, places, state, records(LineEnds, 3000), np.empty((0, 3)))
        return state

    state = solve(places, records(BottomState, 3000))
    assert set(np.unique(state["branch"])) == {SUSPENDED, RESTING} | ({SLACK} if friction else set())
    nodes = np.empty((sections + 1, 3))
    for i in range(0, 3000, 7):
        own = records(LineData, [lines[i]])
        own["first"] = 0
        some = records(SectionData, rows[i * sections : (i + 1) * sections])
        solve_lines_over_bottom(
            some, own, places[i : i + 1], records(BottomState, 1), records(LineEnds, 1), nodes
        )
        assert np.abs(nodes[-1, :2]).max() < 1e-9 * lines[i].length
    moved = places.copy()
    moved[:, :2] *= 1 + 1e-2 * np.random.default_rng(1).standard_normal((3000, 2))
    cold, warm = solve(moved, records(BottomState, 3000)), solve(moved, state.copy())
    assert not np.any(warm["branch"] == FAILED)
    scale = np.hypot(cold["horizontal"], cold["vertical"])
    scale = np.maximum(scale, np.hypot(cold["lower_horizontal"], cold["lower_vertical"]))
    for name in ("horizontal", "vertical", "lower_horizontal", "lower_vertical"):
        assert np.abs((warm[name] - cold[name]) / scale).max() < 1e-9


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(
    ("x", "z", "degrees", "clearance"),
    [(400.0, 90.0, 5.0, None), (400.0, 20.0, -5.0, None), (300.0, 10.0, 0.0, 50.0), (300.0, 10.0, 3.0, 50.0)],
)
def test_length_for_a_tension(
    x: float, z: float, degrees: float, clearance: float | None, friction: float
) -> None:
    more: dict[str, Any] = {"slope": rise(degrees), "clearance": clearance, "friction": friction}
    length = length_for_tension(150e3, 700.0, 3e8, x, z, **more)
    line = solve_catenary((LineSection(length, 700.0, 3e8),), x, z, **more)
    assert line.tension == pytest.approx(150e3, rel=1e-9)
    assert line.on_seabed > 10.0
    with pytest.raises(InputError, match="less than the line has at any length"):
        length_for_tension(20e3, 700.0, 3e8, x, z, **more)


def test_a_hanging_end_of_a_line_with_a_buoy_is_refused() -> None:
    with pytest.raises(InputError, match="a buoy of 5000 N") as caught:
        solve_catenary(SOFT, 220.0, 30.0, clearance=60.0, clumps=(0.0, -5e3))
    assert caught.value.key == "clumps.1"
    floating = (LineSection(100.0, -5.0, 1e6), *SOFT)
    with pytest.raises(InputError, match="weight is -5") as caught:
        solve_catenary(floating, 220.0, 30.0, clearance=60.0)
    assert caught.value.key == "sections.0.weight"
