"""Tanks with geometry, pumps, controllers and tide: closed forms of a wall-sided barge, mass, energy, refusals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.scene.ballast import Controller, LevelPoint, Pump
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Sea, Tank, Tide, Water
from heavylift.solver.simulation import Simulation

LENGTH, BREADTH, DRAFT, KG = 97.5, 36.0, 4.5, 4.5
RHO, G = 1025.0, 9.81
AREA = LENGTH * BREADTH
MASS = RHO * AREA * DRAFT
PER_METRE = RHO * AREA
GM_L = LENGTH**2 / (12.0 * DRAFT) + 0.5 * DRAFT - KG
GM_T = BREADTH**2 / (12.0 * DRAFT) + 0.5 * DRAFT - KG
WATER = Water(density=RHO, gravity=G)
TON_H = 1000.0 / 3600.0
INERTIA = np.diag(MASS * np.array([0.35 * BREADTH, 0.25 * LENGTH, 0.25 * LENGTH]) ** 2)
DAMPING = np.diag([1e6, 1e6, 2e7, 2e9, 1e10, 1e9])
"""About critical in heave, roll and pitch: what is looked at is quasi-static."""


def barge(mass: float = MASS, **more: Any) -> RigidBody:
    """Origin in the middle of the water plane at the draft."""
    values = {"mass": mass, "inertia": INERTIA, "centre_of_mass": np.array([0.0, 0.0, KG - DRAFT])} | more
    return RigidBody("barge", **values)


def scene(water: Water = WATER, mass: float = MASS, **sea: Any) -> Scene:
    restoring = LinearRestoring(
        volume=AREA * DRAFT,
        centre_of_buoyancy=np.array([0.0, 0.0, -0.5 * DRAFT]),
        reference=np.zeros(3),
        area=AREA,
        second_moments=(BREADTH * LENGTH**3 / 12.0, LENGTH * BREADTH**3 / 12.0, 0.0),
    )
    hull = Hull(body="barge", restoring=restoring, damping=DAMPING)
    return Scene(
        bodies=(barge(mass),),
        forces=(Gravity(np.array([0.0, 0.0, -G])),),
        sea=Sea(water=water, hulls=(hull,), **sea),
    )


def run(
    made: Scene, step: float, duration: float, interval: float, start: Any = "check"
) -> tuple[np.ndarray, Callable[[str], np.ndarray], Simulation]:
    every = round(interval / step)
    simulation = Simulation(made, step, record_every=every, start=start)
    first = simulation.record()
    times, records = simulation.advance(round(duration / step))
    records = np.vstack([first, records])
    places = {c.name: slice(c.column, c.column + len(c.components)) for c in simulation.channels}
    return np.append(0.0, times), lambda name: records[:, places[name]], simulation


def tank(name: str = "T", x: float = 0.0, mass: float = 0.0, **more: Any) -> Tank:
    size = np.array([19.5, 30.0, 5.0])
    return Tank(name=name, hull="barge", floor=np.array([x, 0.0, -4.0]), size=size, mass=mass, **more)


def pump(name: str = "P", source: str = "sea", target: str = "T", rate: float = 1000.0, **more: Any) -> Pump:
    return Pump(name=name, source=source, target=target, rate=rate, **more)


def controller(name: str = "C", pumps: tuple[str, ...] = ("P",), **more: Any) -> Controller:
    return Controller(name=name, hull="barge", pumps=pumps, **({"gain": 0.005, "period": 1.0} | more))


def pitch(history: Callable[[str], np.ndarray]) -> np.ndarray:
    q = history("barge.orientation")
    return 2.0 * (q[:, 0] * q[:, 2] - q[:, 3] * q[:, 1])


class TestTanks:
    def test_box_has_centre_surface_and_depth_of_its_filling(self) -> None:
        one = tank(mass=1e6, permeability=0.98)
        point, surface, depth = one.contents(1e6, WATER)
        l, b, h = 19.5, 30.0, 5.0
        level = 1e6 / (RHO * 0.98 * l * b)
        assert depth == pytest.approx(level, rel=1e-14)
        np.testing.assert_allclose(point, [0.0, 0.0, -4.0 + 0.5 * level], rtol=1e-14)
        np.testing.assert_allclose(surface, [RHO * 0.98 * l * b**3 / 12, RHO * 0.98 * b * l**3 / 12])
        assert one.capacity(WATER) == pytest.approx(RHO * 0.98 * l * b * h)
        for none in (0.0, one.capacity(WATER)):
            assert one.contents(none, WATER)[1] == (0.0, 0.0)

    def test_free_surface_of_a_full_width_tank_takes_its_share_of_gm(self) -> None:
        """4.8 m of GM for a full-width tank of 19.5 m of this barge, 1.2 m with a bulkhead."""
        wide = Tank(
            name="T", hull="barge", floor=np.zeros(3), size=np.array([19.5, 36.0, 5.0]), mass=1e6
        )  # fmt: skip
        half = replace(wide, size=np.array([19.5, 18.0, 5.0]))
        assert wide.contents(1e6, WATER)[1][0] / MASS == pytest.approx(4.8, abs=0.01)
        assert 2.0 * half.contents(1e6, WATER)[1][0] / MASS == pytest.approx(1.2, abs=0.003)

    @pytest.mark.slow
    def test_centre_of_the_water_decides_where_the_hull_rests(self) -> None:
        """A table of a wedge, whose centre moves along the hull as it fills: list by mass, place and free surface."""
        V = np.linspace(0.0, 1000.0, 101)
        x = 10.0 + 20.0 * V / 1000.0
        centres = np.column_stack([x, 0.0 * x, 0.0 * x])
        one = Tank(
            name="T", hull="barge", volumes=V, centres=centres, mass=0.0,
            surfaces=np.column_stack([0.0 * x, 500.0 * V / 1000.0]),
        )  # fmt: skip
        plan = pump(rate=1000.0, times=np.array([0.0, 400.0]), rates=np.array([1000.0, 0.0]))
        _, history, simulation = run(scene(tanks=(one,), pumps=(plan,)), 0.2, 600.0, 10.0)
        m = float(history("T.mass")[-1, 0])
        assert m == pytest.approx(400e3, rel=1e-12)
        arm = 10.0 + 20.0 * m / RHO / 1000.0
        stiffness = MASS * G * GM_L - RHO * G * 500.0 * m / RHO / 1000.0
        # water at the height of the water plane: its own weight at z = 0 counts by the sinkage alone
        assert pitch(history)[-1] == pytest.approx(m * G * arm / stiffness, rel=2e-3)
        assert simulation.outcome is Outcome.COMPLETED

    @pytest.mark.slow
    @pytest.mark.parametrize("swell", [0.0, 0.3])
    def test_energy_and_mass_while_it_fills(self, swell: float) -> None:
        """From the sea and from another tank, with free surfaces, swinging: second order; mass to rounding."""
        apart = []
        for h in (0.2, 0.1):
            tanks = (tank("A", -30.0, 5e5), tank("B", 30.0, 1e5))
            pumps = (
                pump("fill", "sea", "A", 3000.0, lag=15.0, times=np.array([0.0]), rates=np.array([3000.0])),
                pump("move", "A", "B", 2500.0, lag=5.0, times=np.array([10.0]), rates=np.array([2500.0])),
            )
            made = scene(mass=MASS - 6e5, tanks=tanks, pumps=pumps)
            body = replace(
                made.bodies[0],
                velocity=np.array([0.0, 0.0, swell]),
                angular_velocity=np.array([0.0, 0.4 * swell, 0.0]),
            )
            _, history, _ = run(replace(made, bodies=(body,)), h, 200.0, 2.0)
            total = history("A.mass") + history("B.mass") - history("fill.pumped")
            assert np.ptp(total) < 1e-9 * total.max()
            t = 200.0
            moved = 2500.0 * (190.0 - 5.0 * (1.0 - np.exp(-190.0 / 5.0)))
            assert history("move.pumped")[-1, 0] == pytest.approx(moved, rel=1e-12)
            assert history("fill.pumped")[-1, 0] == pytest.approx(
                3000.0 * (t - 15.0 * (1.0 - np.exp(-t / 15.0))), rel=1e-12
            )
            balance = history("energy.balance")
            apart.append(np.ptp(balance))
        works = 6e5 * G * 1.0
        assert apart[1] < 1e-4 * works
        assert apart[1] < 0.4 * apart[0] or not swell  # 1e-10 of the works without


class TestPumps:
    @pytest.mark.slow
    def test_edge_of_a_wall_sided_barge_rises_with_the_pump(self) -> None:
        """0.278 mm for each ton: sinkage of the area, trim of the moment at the end."""
        one = tank(mass=0.0, x=20.0)
        plan = pump(rate=1000.0, times=np.array([0.0]), rates=np.array([1000.0]))
        times, history, _ = run(scene(tanks=(one,), pumps=(plan,)), 0.2, 600.0, 10.0)
        z = history("barge.position")[:, 2]
        late = times >= 300.0
        rate = np.polyfit(times[late], z[late], 1)[0]
        assert pytest.approx(0.278, abs=5e-4) == 1e6 / PER_METRE  # mm a ton
        assert rate == pytest.approx(-1000.0 / PER_METRE, rel=0.01)

    def test_plan_with_a_lag_is_exact(self) -> None:
        """Against the first-order equation integrated by SciPy."""
        from scipy.integrate import solve_ivp

        plan = {"times": np.array([0.0, 20.0, 31.0]), "rates": np.array([900.0, -400.0, 0.0])}
        one = pump(lag=12.0, reversible=True, **plan)
        rows = one.plan()

        def told(t: float) -> float:
            return 900.0 if t < 20.0 else -400.0 if t < 31.0 else 0.0

        found = solve_ivp(
            lambda t, y: [(told(t) - y[0]) / 12.0, y[0]], (0.0, 31.0), [0.0, 0.0],
            t_eval=[20.0, 31.0], max_step=0.05, rtol=1e-10, atol=1e-8,
        )  # fmt: skip
        np.testing.assert_allclose(rows[1:, 2:], found.y.T, rtol=1e-4)

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("mass", "source", "target", "word"),
        [(2.9e6, "sea", "T", "overflows"), (2e4, "T", "sea", "runs dry")],
    )
    def test_overflow_and_dry_running_are_named(
        self, mass: float, source: str, target: str, word: str
    ) -> None:
        plan = pump(source=source, target=target, times=np.array([0.0]), rates=np.array([1000.0]))
        times, _, simulation = run(
            scene(mass=MASS - mass, tanks=(tank(mass=mass),), pumps=(plan,)), 0.2, 600.0, 10.0
        )
        full = RHO * 19.5 * 30.0 * 5.0
        when = (full - mass) / 1000.0 if word == "overflows" else mass / 1000.0
        assert simulation.outcome is Outcome.LIMIT_REACHED
        assert word in simulation.message
        assert "'T'" in simulation.message
        assert simulation.time == pytest.approx(when, abs=0.5)
        assert times[-1] <= simulation.time


def ends(**more: Any) -> dict[str, Any]:
    """Tanks at both ends and amidships with pumps of the same name, half full."""
    places = {"aft": -39.0, "mid": 0.0, "fore": 39.0}
    return {
        "tanks": tuple(tank(name, x, 1.0e6) for name, x in places.items()),
        "pumps": tuple(
            pump(f"pump_{name}", "sea", name, reversible=True, **({"rate": 3000.0} | more)) for name in places
        ),
    }


PUMPS = ("pump_aft", "pump_mid", "pump_fore")
HEAVY = MASS - 3.0e6


KEEL = np.array([0.0, 0.0, -DRAFT])


class TestControllers:
    @pytest.mark.slow
    def test_error_of_a_draft_decays_with_the_gain(self) -> None:
        """``e0 exp(-K t)`` to 1 %; the split is the least of all: a third in each of three tanks."""
        K = 0.01
        one = controller(pumps=PUMPS, gain=K, draft=DRAFT + 0.05, draft_at=KEEL)
        times, history, _ = run(scene(mass=HEAVY, controllers=(one,), **ends(rate=1e5)), 0.2, 300.0, 5.0)
        error = -history("barge.position")[:, 2] - 0.05
        assert error[0] == pytest.approx(-0.05, abs=1e-12)
        assert np.abs(error + 0.05 * np.exp(-K * times)).max() < 0.01 * 0.05
        added = [np.ptp(history(f"{name}.mass")) for name in ("aft", "mid", "fore")]
        np.testing.assert_allclose(added, 0.05 * (1.0 - np.exp(-3.0)) * PER_METRE / 3.0, rtol=0.01)

    @pytest.mark.slow
    def test_heel_and_trim_of_an_uneven_load_vanish(self) -> None:
        """Four tanks at the corners: masses that balance the moments of the load, the least that do."""
        corners = {"ap": (-39, 9), "as": (-39, -9), "fp": (39, 9), "fs": (39, -9)}
        tanks = tuple(
            Tank(name=name, hull="barge", floor=np.array([x, y, -4.0]), size=np.array([19.5, 16.0, 5.0]), mass=6e5)
            for name, (x, y) in corners.items()
        )  # fmt: skip
        pumps = tuple(pump(f"p_{name}", "sea", name, 5000.0, reversible=True, lag=10.0) for name in corners)
        one = controller(pumps=tuple(p.name for p in pumps), gain=0.02, heel=0.0, trim=0.0)
        load, at = 2e5, np.array([25.0, 4.0, 0.0])
        mass = MASS - 4 * 6e5
        centre = (np.array([0.0, 0.0, KG - DRAFT]) * (mass - load) + at * load) / mass
        made = scene(mass=mass, tanks=tanks, pumps=pumps, controllers=(one,))
        made = replace(made, bodies=(barge(mass, centre_of_mass=centre),))
        _, history, _ = run(made, 0.2, 900.0, 10.0, start="equilibrium")
        assert abs(history("C.error")[0]).max() > 1e-3
        assert abs(history("C.error")[-1]).max() < 1e-6
        moved = {name: history(f"{name}.mass")[-1, 0] - 6e5 for name in corners}
        A = np.array([[x for x, _ in corners.values()], [y for _, y in corners.values()]], dtype=float)
        expected = -np.linalg.pinv(A) @ (load * at[:2])
        found = np.array(list(moved.values()))
        np.testing.assert_allclose(A @ found, -load * at[:2], rtol=1e-4)
        np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())

    @pytest.mark.slow
    @pytest.mark.parametrize("ahead", [False, True])
    def test_tide_leaves_its_rate_over_the_gain(self, ahead: bool) -> None:
        """1 m/h of tide is 3,600 t/h into the barge; the error is r/K without, none with a look ahead."""
        K, r = 0.005, 1.0 / 3600.0
        water = replace(WATER, tide=Tide(times=np.array([0.0, 36000.0]), levels=np.array([0.0, 10.0])))
        level = LevelPoint(point=np.array([48.75, 0.0, 1.5]), height=1.5)
        one = controller(pumps=PUMPS, gain=K, trim=0.0, levels=(level,), tide_ahead=ahead)
        made = scene(water, HEAVY, controllers=(one,), **ends(rate=2000.0))
        _, history, _ = run(made, 0.2, 2400.0, 20.0)
        error = history("C.error")
        assert error[-1, 1] == pytest.approx(0.0 if ahead else r / K, abs=0.01 * r / K)
        flow = sum(history(f"{name}.flow")[-1, 0] for name in PUMPS)
        assert flow == pytest.approx(PER_METRE * r, rel=0.01)
        assert flow == pytest.approx(3600.0 * TON_H, rel=0.01)
        balance = history("energy.balance")
        assert np.ptp(balance) < 1e-6 * MASS * G

    @pytest.mark.slow
    def test_filter_keeps_waves_out_of_the_valves(self) -> None:
        """Water that goes up and down by 0.25 m in 10 s, filter of 60 s: 1/(1 + (w T)^2) of what is measured."""
        t = np.arange(0.0, 400.5, 0.5)
        water = replace(WATER, tide=Tide(times=t, levels=0.25 * np.sin(2.0 * np.pi * t / 10.0)))
        one = controller(pumps=PUMPS, gain=0.0025, filter=60.0, draft=DRAFT, draft_at=KEEL)
        made = scene(water, HEAVY, controllers=(one,), **ends(rate=1000.0))
        times, history, _ = run(made, 0.1, 400.0, 0.5)
        late = times >= 300.0
        measured = history("barge.water_level")[late, 0] - history("barge.position")[late, 2]
        seen = history("C.error")[late, 0]
        seen = seen - np.polyval(np.polyfit(times[late], seen, 2), times[late])
        measured = measured - np.polyval(np.polyfit(times[late], measured, 2), times[late])
        assert np.std(seen) / np.std(measured) == pytest.approx(
            1.0 / (1.0 + (2.0 * np.pi * 6.0) ** 2), rel=0.05
        )
        moved = max(np.ptp(history(f"{name}.command")[late]) for name in PUMPS)
        assert moved < 0.01 * 1000.0

    @pytest.mark.slow
    def test_what_pumps_are_told_stays_between_looks_and_within_their_rates(self) -> None:
        one = controller(pumps=PUMPS, period=5.0, gain=0.02, draft=DRAFT + 0.5, draft_at=KEEL, trim=0.01)
        _, history, _ = run(scene(mass=HEAVY, controllers=(one,), **ends(rate=800.0)), 0.5, 100.0, 0.5)
        told = np.column_stack([history(f"{name}.command")[:, 0] for name in PUMPS])
        assert np.abs(told).max() == pytest.approx(800.0)
        assert np.abs(told).max() <= 800.0 * (1.0 + 1e-12)
        changes = np.flatnonzero(np.abs(np.diff(told, axis=0)).max(axis=1) > 0.0) + 1
        assert len(changes)
        assert (changes % 10 == 0).all()
        share = history("C.share")[:, 0]
        assert 0.0 < share[0] < 0.2

    @pytest.mark.slow
    def test_full_tank_is_left_to_the_others(self) -> None:
        """What has no room stops before it overflows, with what its lag still brings, and the others take over."""
        full = RHO * 19.5 * 30.0 * 5.0
        parts = ends(lag=20.0)
        tanks = (replace(parts["tanks"][0], mass=full - 2e4), *parts["tanks"][1:])
        one = controller(pumps=PUMPS, gain=0.01, draft=DRAFT + 0.1, draft_at=KEEL)
        mass = MASS - sum(t.mass for t in tanks)
        _, history, simulation = run(
            scene(mass=mass, tanks=tanks, pumps=parts["pumps"], controllers=(one,)),
            0.2,
            1200.0,
            10.0,
            "equilibrium",
        )
        assert simulation.outcome is Outcome.COMPLETED, simulation.message
        assert full * (1.0 - 1e-3) < history("aft.mass").max() <= full * (1.0 + 1e-9)
        assert abs(history("C.error")[-1, 0]) < 1e-4

    @pytest.mark.slow
    def test_goes_on_bit_for_bit(self) -> None:
        t = np.linspace(0.0, 200.0, 41)
        water = replace(WATER, tide=Tide(times=t, levels=0.2 * np.sin(t / 20.0)))
        one = controller(
            pumps=PUMPS, period=2.0, gain=0.005, filter=5.0, trim=0.002, draft=DRAFT + 0.1, draft_at=KEEL
        )
        made = scene(water, HEAVY, controllers=(one,), **ends(lag=10.0))
        whole = Simulation(made, 0.1, record_every=10)
        _, expected = whole.advance(1000)
        first = Simulation(made, 0.1, record_every=10)
        first.advance(330)
        again = Simulation(made, 0.1, record_every=10)
        again.restore(first.state())
        _, found = again.advance(670)
        np.testing.assert_array_equal(found, expected[-len(found) :])
        assert np.ptp(expected, axis=0).max() > 0.0


def check(made: Scene) -> None:
    Simulation(made, 0.1).warm_up()


class TestRefused:
    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ({"gain": 0.03}, ("faster than its pumps allow", "lag of 20 s", "0.0148")),
            ({"gain": 0.01, "filter": 60.0}, ("filter of 2 x 60", "at most")),
            ({"hull": "bridge"}, ("no hull with buoyancy 'bridge'",)),
            ({"pumps": ("pump_fore", "nothing")}, ("no pump 'nothing'",)),
            ({"pumps": ("pump_fore", "pump_fore")}, ("in the hands of 'C'",)),
            ({"trim": None}, ("keeps nothing",)),
        ],
    )
    def test_controllers(self, change: dict[str, Any], words: tuple[str, ...]) -> None:
        one = replace(controller(pumps=PUMPS, period=5.0, trim=0.0), **change)
        with pytest.raises(InputError) as error:
            Simulation(scene(mass=HEAVY, controllers=(one,), **ends(lag=20.0)), 0.1)
        for word in words:
            assert word in str(error.value)

    def test_period_of_half_a_step(self) -> None:
        one = controller(pumps=PUMPS, period=0.15, trim=0.0)
        with pytest.raises(InputError, match="whole steps"):
            Simulation(scene(mass=HEAVY, controllers=(one,), **ends()), 0.1)

    @pytest.mark.slow
    def test_pumps_that_cannot(self) -> None:
        """Tanks on the centreline do not heel a hull."""
        one = controller(pumps=PUMPS, heel=0.0, trim=0.0)
        with pytest.raises(InputError, match="can change 1 of them"):
            check(scene(mass=HEAVY, controllers=(one,), **ends()))

    @pytest.mark.parametrize(
        ("sea", "words"),
        [
            ({"tanks": (tank(mass=3.1e6),)}, "overflows: 3.1e"),
            ({"tanks": (Tank(name="T", hull="barge", point=np.zeros(3), size=np.ones(3), mass=1.0),)}, "'point' and"),
            ({"tanks": (Tank(name="T", hull="barge", size=np.ones(3), mass=1.0),)}, "no 'floor'"),
            ({"tanks": (Tank(name="T", hull="barge", mass=1.0),)}, "no place"),
            ({"tanks": (tank(), tank())}, "'T' is taken"),
            ({"tanks": (tank(),), "pumps": (pump(target="X"),)}, "no tank 'X'"),
            ({"tanks": (tank(),), "pumps": (pump(target="sea"),)}, "source and target"),
            ({"tanks": (tank(),), "pumps": (pump(times=np.zeros(1), rates=np.array([-1.0])),)}, "not reversible"),
            ({"tanks": (tank(),), "pumps": (pump(times=np.zeros(1), rates=np.array([2000.0])),)}, "at most its 'rate'"),
            (
                {
                    "tanks": (replace(tank(), mass=None, times=np.zeros(1), masses=np.zeros(1)),),
                    "pumps": (pump(),),
                },
                "follows a schedule",
            ),
        ],
    )  # fmt: skip
    def test_tanks_and_pumps(self, sea: dict[str, Any], words: str) -> None:
        with pytest.raises(InputError, match=words):
            Simulation(scene(**sea), 0.1)
