"""Catenaries against published numbers, quadrature of the cable equations, closed forms and MoorPy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, filled_rows, records
from heavylift.solver.scene.moorings import LineSection
from heavylift.solver.water.lines.catenary import (
    FAILED,
    RESTING,
    SLACK,
    SUSPENDED,
    LineData,
    LineEnds,
    LineState,
    SectionData,
    solve_lines,
)
from heavylift.solver.water.lines.catenary_line import (
    Catenary,
    length_for_tension,
    line_profile,
    solve_catenary,
)

# Table 3-21 of "Integrated simulation ... ships and offshore structures" (2018) read as 5 tonf, kgf/m and kN (EA) with
# g = 9.81: weight [kgf/m], EA [kN], depth, span [m]; exact elastic length in all and on the seabed [m] without
# friction, found with MoorPy 1.3.0; OrcaFlex has 401.09, 301.53, 351.08 m.
TABLE_3_21 = [
    (19.1, 215_893.0, 12.0, 400.0, 401.144, 322.802),
    (18.0, 213_622.0, 15.0, 300.0, 301.609, 211.573),
    (22.8, 270_375.0, 11.0, 350.0, 351.121, 282.545),
]
# The same lines with friction, cross-checked with MoorPy 1.3.0: weight [N/m], EA [N], depth, span [m], friction;
# length, length on the seabed [m], H, V, tension at the anchor [N].
FAIRLEAD_TENSION = 49_050.0
TARGETS = [
    (187.371, 215_893e3, 12.0, 400.0, 0.0, 401.1437, 322.80219, 46_802.05, 14_678.93, 46_802.05),
    (187.371, 215_893e3, 12.0, 400.0, 0.5, 401.16631, 322.8248, 46_802.05, 14_678.93, 16_558.04),
    (187.371, 215_893e3, 12.0, 400.0, 1.0, 401.18661, 322.8451, 46_802.05, 14_678.93, 0.0),
    (176.58, 213_622e3, 15.0, 300.0, 0.0, 301.60908, 211.57258, 46_401.89, 15_898.65, 46_401.89),
    (176.58, 213_622e3, 15.0, 300.0, 0.5, 301.61833, 211.58183, 46_401.89, 15_898.65, 27_721.33),
    (176.58, 213_622e3, 15.0, 300.0, 1.0, 301.62758, 211.59108, 46_401.89, 15_898.65, 9_039.14),
    (223.668, 270_375e3, 11.0, 350.0, 0.0, 351.1215, 282.54489, 46_590.09, 15_338.39, 46_590.09),
    (223.668, 270_375e3, 11.0, 350.0, 0.5, 351.13801, 282.5614, 46_590.09, 15_338.39, 14_990.12),
    (223.668, 270_375e3, 11.0, 350.0, 1.0, 351.15224, 282.57563, 46_590.09, 15_338.39, 0.0),
]
# Eq. 229 of the same work: span, height, length [m], weight [kN/m]; H and V of the inextensible line [kN]; H and V with
# EA = 2e5 kN.
HANGING = [
    (100.0, 60.0, 118.0, 2.0, 322.80969, 317.84214, 300.24564, 304.72452),
    (100.0, 80.0, 129.0, 2.0, 373.68439, 435.04982, 327.95008, 399.38994),
]
CHAIN_WIRE_CHAIN = (
    LineSection(80.0, 900.0, 4e8),
    LineSection(150.0, 250.0, 3e8),
    LineSection(40.0, 900.0, 4e8),
)


@pytest.mark.parametrize(("weight", "stiffness", "depth", "span", "total", "lying"), TABLE_3_21)
def test_lengths_of_table_3_21(
    weight: float, stiffness: float, depth: float, span: float, total: float, lying: float
) -> None:
    w, EA = weight * 9.81, stiffness * 1e3
    length = length_for_tension(5.0e3 * 9.81, w, EA, span, depth)
    line = solve_catenary((LineSection(length, w, EA),), span, depth)
    assert length == pytest.approx(total, abs=0.01)
    assert line.on_seabed == pytest.approx(lying, abs=0.01)


@pytest.mark.parametrize("row", TARGETS)
def test_lengths_and_forces_with_friction(row: tuple[float, ...]) -> None:
    w, EA, depth, span, friction, total, lying, H, V, anchor = row
    length = length_for_tension(FAIRLEAD_TENSION, w, EA, span, depth, friction=friction)
    assert length == pytest.approx(total, abs=1e-5)
    line = solve_catenary((LineSection(length, w, EA),), span, depth, friction=friction)
    assert line.tension == pytest.approx(FAIRLEAD_TENSION, rel=1e-12)
    assert line.on_seabed == pytest.approx(lying, abs=1e-5)
    assert (line.horizontal, line.vertical) == pytest.approx((H, V), rel=1e-6)
    assert line.anchor_tension == pytest.approx(anchor, rel=1e-6, abs=1e-9)


def inextensible_tension(span: float, height: float, length: float, weight: float) -> float:
    """Horizontal tension [N] of a hanging line: ``sinh(u)/u = sqrt(length^2 - height^2)/span``, eq. 229 (2018)."""
    r = math.sqrt(length**2 - height**2) / span
    u = math.sqrt(6.0 * (r - 1.0)) if r < 3.0 else math.log(2.0 * r) + math.log(math.log(2.0 * r))
    for _ in range(50):
        step = (math.sinh(u) - r * u) / (math.cosh(u) - r)
        u -= step
        if abs(step) <= 1e-15 * u:
            break
    return weight * span / (2.0 * u)


@pytest.mark.parametrize("row", HANGING)
def test_hanging_lines(row: tuple[float, ...]) -> None:
    """Eq. 229, and the elastic kernel with and without stretch."""
    span, height, length, q, H, V, H_elastic, V_elastic = row
    assert inextensible_tension(span, height, length, q) == pytest.approx(H, rel=1e-7)
    stiff = solve_catenary((LineSection(length, q, math.inf),), span, height, seabed=False)
    assert (stiff.horizontal, stiff.vertical) == pytest.approx((H, V), rel=1e-7)
    soft = solve_catenary((LineSection(length, q, 2e5),), span, height, seabed=False)
    assert (soft.horizontal, soft.vertical) == pytest.approx((H_elastic, V_elastic), rel=1e-7)


def test_length_of_an_inextensible_line() -> None:
    """The hanging lines the other way round: from their tension to their length."""
    for span, height, length, q, H, V, _, _ in HANGING:
        found = length_for_tension(math.hypot(H, V), q, math.inf, span, height, seabed=False)
        assert found == pytest.approx(length, rel=1e-7)


def walk(
    sections: tuple[LineSection, ...], clumps: tuple[float, ...], line: Catenary, resting: bool
) -> tuple[float, float]:
    """Span and height by quadrature of dx/ds = H/T (1 + T/EA), dz/ds = V/T (1 + T/EA) down from the upper end."""
    H, v = line.horizontal, line.vertical
    x = z = 0.0
    for section, clump in zip(sections[::-1], [*clumps[::-1], 0.0], strict=True):
        w, EA = section.weight, section.axial_stiffness
        hung = min(section.length, v / w) if resting else section.length

        def stretched(s: float, v: float = v, w: float = w, EA: float = EA) -> float:
            return 1.0 / math.hypot(H, v - w * s) + 1.0 / EA

        x += quad(lambda s: H * stretched(s), 0.0, hung, epsabs=0, epsrel=1e-12)[0]
        z += quad(lambda s, v=v, w=w: (v - w * s) * stretched(s), 0.0, hung, epsabs=1e-10, epsrel=1e-12)[0]
        x += (section.length - hung) * (1.0 + H / EA)
        v -= w * hung + clump
        v = max(v, 0.0) if resting else v
    return x, z


@pytest.mark.parametrize(
    ("span", "height", "clumps", "seabed"),
    [
        (220.0, 90.0, (), True),  # lower chain partly on the ground
        (255.0, 60.0, (5e3, 0.0), True),  # the clump lies on the ground
        (235.0, 90.0, (20e3, -10e3), True),  # a buoy holds the wire up
        (248.0, 60.0, (30e3, 0.0), True),  # the clump hangs by its line partly
        (250.0, 100.0, (20e3, 10e3), False),
        (150.0, -40.0, (0.0, -30e3), False),  # sags below both ends
        (269.9, 0.0, (), False),
    ],
)
def test_sections_and_clumps(span: float, height: float, clumps: tuple[float, ...], seabed: bool) -> None:
    line = solve_catenary(CHAIN_WIRE_CHAIN, span, height, seabed=seabed, clumps=clumps)
    assert walk(CHAIN_WIRE_CHAIN, clumps or (0.0, 0.0), line, seabed) == pytest.approx(
        (span, height), abs=1e-8
    )
    weight = sum(s.length * s.weight for s in CHAIN_WIRE_CHAIN) + sum(clumps)
    if not seabed:
        assert line.vertical - line.anchor_vertical == pytest.approx(weight, rel=1e-12)
        assert line.horizontal == line.anchor_horizontal


def test_a_clump_on_a_nearly_weightless_line_makes_a_triangle() -> None:
    half, span, clump = 50.0, 60.0, 4e4
    line = solve_catenary((LineSection(half, 1e-6, math.inf),) * 2, span, 0.0, seabed=False, clumps=(clump,))
    depth = math.sqrt(half**2 - (span / 2) ** 2)
    assert line.vertical == pytest.approx(clump / 2, rel=1e-8)
    assert line.horizontal == pytest.approx(clump * span / (4 * depth), rel=1e-8)


def test_a_taut_light_line_is_a_rubber_band() -> None:
    """EA (chord/L - 1) along the chord; weight gives each end half of it."""
    L, EA, x, z = 100.0, 1e7, 92.0, 47.0
    chord = math.hypot(x, z)
    line = solve_catenary((LineSection(L, 1e-3, EA),), x, z, seabed=False)
    pull = EA * (chord / L - 1.0)
    assert line.horizontal == pytest.approx(pull * x / chord, rel=1e-9)
    assert line.vertical == pytest.approx(pull * z / chord + 0.05, rel=1e-9)


def test_a_slack_line_hangs_straight_down() -> None:
    """L > x + z: H = 0, and V carries what the height needs: z = V/w + V^2/(2 EA w)."""
    w, EA, x, z = 500.0, 1e7, 30.0, 80.0
    V = EA * (math.sqrt(1.0 + 2.0 * w * z / EA) - 1.0)
    line = solve_catenary((LineSection(150.0, w, EA),), x, z)
    assert line.branch == SLACK
    assert line.horizontal == 0.0
    assert line.vertical == pytest.approx(V, rel=1e-12)
    assert line.on_seabed == pytest.approx(150.0 - V / w, rel=1e-12)
    assert line.stiffness == pytest.approx(np.array([[0.0, 0.0], [0.0, w / (1.0 + V / EA)]]), rel=1e-10)
    lying = 150.0 - V / w
    near = solve_catenary((LineSection(150.0, w, EA),), lying + 1e-3, z)
    assert near.branch == RESTING
    assert 0.0 < near.horizontal < 1.0  # comes in smoothly
    # of sections: the wire hangs, 20 m of the chain below it too
    chain = (LineSection(100.0, 900.0, math.inf), LineSection(30.0, 100.0, math.inf))
    line = solve_catenary(chain, 10.0, 50.0, clumps=(1e3,))
    assert line.vertical == pytest.approx(30.0 * 100.0 + 1e3 + 20.0 * 900.0, rel=1e-12)
    assert line.on_seabed == pytest.approx(80.0, rel=1e-12)


def test_ends_of_a_line_in_air_may_be_exchanged() -> None:
    section = (LineSection(80.0, 60.0, 5e6),)
    for x, z in ((70.0, 12.0), (20.0, -30.0), (0.5, 5.0), (79.0, 10.0)):
        there = solve_catenary(section, x, z, seabed=False)
        back = solve_catenary(section, x, -z, seabed=False)
        assert back.horizontal == pytest.approx(there.horizontal, rel=1e-10)
        assert back.vertical == pytest.approx(-there.anchor_vertical, rel=1e-10, abs=1e-8)
        sag = line_profile(section, there.horizontal, there.vertical, seabed=False)
        if there.vertical > 0.0 > there.anchor_vertical:
            assert sag.z.min() < min(0.0, z)


def random_lines(
    count: int, seabed: bool, sections: int = 1
) -> tuple[Records[SectionData], Records[LineData], np.ndarray]:
    """Taut, nearly taut, ordinary and slack lines: sections, lines, places."""
    rng = np.random.default_rng(20)
    x, z = 10 ** rng.uniform(0, 3.3, count), rng.uniform(2, 500, count)
    if not seabed:
        z *= rng.choice([-1, 1], count)
    chord, most = np.hypot(x, z), x + np.abs(z)
    length = np.choose(
        rng.integers(0, 4, count),
        [
            chord * (1 - 10 ** rng.uniform(-6, -1.2, count)),
            chord * (1 + 10 ** rng.uniform(-6, -1, count)),
            chord + (most - chord) * rng.random(count),
            most * rng.uniform(1, 2, count),
        ],
    )
    share = rng.dirichlet(np.ones(sections), count)
    rows = np.zeros((count, sections, 4))
    rows[:, :, 0] = length[:, None] * share
    rows[:, :, 1] = (10 ** rng.uniform(1, 4, count))[:, None] * rng.uniform(0.3, 1.7, (count, sections))
    rows[:, :, 2] = 10 ** -rng.uniform(6, 10, count)[:, None]
    lines = records(LineData, count)
    lines["first"] = np.arange(count) * sections
    lines["count"] = sections
    lines["tail"] = 0 if seabed else sections
    lines["length"] = length
    lines["weight"] = (rows[:, :, 0] * rows[:, :, 1]).sum(1)
    lines["stretch"] = (rows[:, :, 0] * rows[:, :, 2]).sum(1)
    length, weight, flexibility, clump = rows.reshape(-1, 4).T
    sections_of = filled_rows(SectionData, length=length, weight=weight, flexibility=flexibility, clump=clump)
    return sections_of, lines, np.column_stack([x, z])


def solve(
    problem: tuple[Records[SectionData], Records[LineData], np.ndarray],
    places: np.ndarray | None = None,
    state: Records[LineState] | None = None,
) -> tuple[Records[LineState], Records[LineEnds]]:
    sections, lines, start = problem
    state = records(LineState, len(lines)) if state is None else state.copy()
    ends = records(LineEnds, len(lines))
    solve_lines(sections, lines, start if places is None else places, state, ends)
    return state, ends


def textbook(rows: np.ndarray, H: float, V: float, seabed: bool) -> tuple[float, float]:
    """Span and height with areas of the hyperbolic sine, as they stand in books, in extended precision."""
    H, V = np.longdouble(H), np.longdouble(V)
    x = z = np.longdouble(0)
    for L, w, c, _ in rows.astype(np.longdouble):
        hung = min(L, V / w) if seabed else L
        low = V - w * hung
        x += H / w * (np.arcsinh(V / H) - np.arcsinh(low / H)) + c * H * L + (L - hung)
        z += (np.hypot(H, V) - np.hypot(H, low)) / w + c * (V + low) * hung / 2
        V = low
    return float(x), float(z)


@pytest.mark.parametrize("seabed", [True, False])
@pytest.mark.parametrize("sections", [1, 3])
def test_random_lines(seabed: bool, sections: int) -> None:
    """Three thousand lines: none fails, all satisfy the textbook formulas, warm starts find the same."""
    problem = random_lines(3000, seabed, sections)
    state, _ = solve(problem)
    branches = set(np.unique(state["branch"]))
    assert branches == ({SUSPENDED, RESTING, SLACK} if seabed else {SUSPENDED})
    rows = problem[0].view(np.float64).reshape(3000, sections, 4)
    for i in np.flatnonzero(state["branch"] != SLACK):
        found = textbook(rows[i], state[i].horizontal, state[i].vertical, seabed)
        assert found == pytest.approx(tuple(problem[2][i]), abs=2e-11 * problem[1][i].length)
    moved = problem[2] * (1 + 1e-2 * np.random.default_rng(1).standard_normal((3000, 2)))
    cold, warm = solve(problem, moved)[0], solve(problem, moved, state)[0]
    scale = np.hypot(cold["horizontal"], cold["vertical"])
    for name in ("horizontal", "vertical"):
        assert np.abs((warm[name] - cold[name]) / scale).max() < 1e-10
    assert not np.any(warm["branch"] == FAILED)


@pytest.mark.parametrize("seabed", [True, False])
def test_stiffness_is_the_derivative_of_the_force(seabed: bool) -> None:
    for clumps in ((), (15e3, 5e3)):
        for friction in (0.0, 0.4) if seabed else (0.0,):
            for x, z in ((200.0, 90.0), (236.0, 90.0), (250.0, 95.0), (262.0, 80.0)):

                def force(x: float, z: float, clumps=clumps, friction=friction) -> np.ndarray:  # type: ignore[no-untyped-def]
                    line = solve_catenary(
                        CHAIN_WIRE_CHAIN, x, z, seabed=seabed, friction=friction, clumps=clumps
                    )
                    return np.array([line.horizontal, line.vertical])

                K = solve_catenary(
                    CHAIN_WIRE_CHAIN, x, z, seabed=seabed, friction=friction, clumps=clumps
                ).stiffness
                columns = []
                for step in (np.array([1e-4, 0.0]), np.array([0.0, 1e-4])):
                    near = force(x + step[0], z + step[1]) - force(x - step[0], z - step[1])
                    far = force(x + 2 * step[0], z + 2 * step[1]) - force(x - 2 * step[0], z - 2 * step[1])
                    columns.append((8 * near - far) / (12 * step.sum()))
                differences = np.column_stack(columns)
                assert np.abs(K - differences).max() < 1e-6 * np.abs(K).max()
                if friction == 0.0:
                    assert K[0, 1] == pytest.approx(K[1, 0], rel=1e-12)
                    assert np.linalg.eigvalsh(K)[0] > 0.0


@pytest.mark.parametrize("seabed", [True, False])
def test_energy_is_the_potential_of_the_force(seabed: bool) -> None:
    """Its gradient by the place of the upper end, and its value for a line that hangs straight down."""
    for x, z in ((180.0, 90.0), (230.0, 90.0), (245.0, 110.0), (252.0, 100.0)):

        def energy(x: float, z: float) -> float:
            return solve_catenary(CHAIN_WIRE_CHAIN, x, z, seabed=seabed, clumps=(5e3, -2e3)).energy

        line = solve_catenary(CHAIN_WIRE_CHAIN, x, z, seabed=seabed, clumps=(5e3, -2e3))
        h = 1e-3
        gradient = (
            (energy(x + h, z) - energy(x - h, z)) / (2 * h),
            (energy(x, z + h) - energy(x, z - h)) / (2 * h),
        )
        assert gradient == pytest.approx((line.horizontal, line.vertical), rel=1e-6, abs=1e-2)
    w, z = 500.0, 80.0
    slack = solve_catenary((LineSection(150.0, w, math.inf),), 30.0, z)
    assert slack.energy == pytest.approx(w * z * z / 2, rel=1e-12)


def test_profile_has_the_ends_and_the_tensions_of_the_line() -> None:
    for span, height, seabed, friction in (
        (225.0, 90.0, True, 0.5),
        (245.0, 100.0, True, 0.0),
        (150.0, -40.0, False, 0.0),
        (100.0, 90.0, True, 0.5),
    ):
        line = solve_catenary(
            CHAIN_WIRE_CHAIN, span, height, seabed=seabed, friction=friction, clumps=(0.0, 4e3)
        )
        profile = line_profile(
            CHAIN_WIRE_CHAIN,
            line.horizontal,
            line.vertical,
            seabed=seabed,
            friction=friction,
            clumps=(0.0, 4e3),
            points=60,
        )
        slack = line.branch == SLACK
        assert profile.s[-1] == pytest.approx(270.0, rel=1e-12)
        assert profile.z[-1] == pytest.approx(height, abs=1e-7)
        if not slack:  # a slack line lies about as it likes
            assert profile.x[-1] == pytest.approx(span, abs=1e-7)
        assert profile.tension[-1] == pytest.approx(line.tension, rel=1e-12)
        assert profile.tension[0] == pytest.approx(line.anchor_tension, rel=1e-9, abs=1e-6)
        if seabed:
            lying = profile.s[profile.z < 1e-9]
            assert lying[-1] == pytest.approx(line.on_seabed, abs=1e-6)
        ds = np.hypot(np.diff(profile.x), np.diff(profile.z))
        assert ds.sum() == pytest.approx(270.0, rel=1e-3)


def test_agrees_with_moorpy() -> None:
    """MoorPy 1.3.0 solves the same equations (its tolerance: 1e-6 of the tension)."""
    moorpy = pytest.importorskip("moorpy.Catenary")
    rng = np.random.default_rng(5)
    for _ in range(60):
        x, z = rng.uniform(50.0, 800.0), rng.uniform(20.0, 300.0)
        chord = math.hypot(x, z)
        length = chord + (x + z - chord) * rng.uniform(0.03, 0.97)
        w, EA, friction = (
            10 ** rng.uniform(2, 3.5),
            10 ** rng.uniform(8, 9.5),
            float(rng.choice([0.0, 0.5, 1.0])),
        )
        h_a, v_a, h_b, v_b, info = moorpy.catenary(x, z, length, EA, w, CB=friction, Tol=1e-9)
        line = solve_catenary((LineSection(length, w, EA),), x, z, friction=friction)
        assert (line.horizontal, line.vertical) == pytest.approx((-h_b, -v_b), rel=1e-5)
        assert line.anchor_horizontal == pytest.approx(h_a, rel=1e-4, abs=1e-4 * line.tension)
        assert line.on_seabed == pytest.approx(info["LBot"], abs=1e-4 * length)
        assert line.anchor_vertical == pytest.approx(v_a, abs=1e-5 * line.tension)


def test_impossible_lines_are_refused() -> None:
    with pytest.raises(InputError, match=r"inextensible line of 100 m is shorter than its span of 111"):
        solve_catenary((LineSection(100.0, 500.0, math.inf),), 100.0, 50.0)
    with pytest.raises(
        InputError, match=r"a tension of 1000 N is less than the line has at any length.*expected more"
    ):
        length_for_tension(1000.0, 500.0, 1e9, 100.0, 50.0)
    for section, key in (
        (LineSection(0.0, 1.0, 1.0), "sections.0.length"),
        (LineSection(1.0, math.nan, 1.0), "sections.0.weight"),
        (LineSection(1.0, 1.0, -2.0), "sections.0.axial_stiffness"),
    ):
        with pytest.raises(InputError) as error:
            solve_catenary((section,), 1.0, 1.0)
        assert error.value.key == key
    with pytest.raises(InputError, match="1 clumps at 2 joints"):
        solve_catenary(CHAIN_WIRE_CHAIN, 200.0, 90.0, clumps=(1.0,))
    with pytest.raises(InputError, match="has no weight"):
        solve_catenary((LineSection(100.0, 0.0, 1e6),), 50.0, 0.0, seabed=False)
