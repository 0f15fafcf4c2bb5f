"""``heavylift ballast``: fillings by least pumping, bounds, drafts, stability, the girder in still water."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.commands.ballast import ballast_command
from heavylift.pipeline.log import Log
from heavylift.preprocess.hydrodynamics.hull_surface import check_hull
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.water.hulls.ballast_plan import Weight, girder, least_change
from heavylift.solver.water.hulls.hydrostatics import Pose

G, RHO, LENGTH, BREADTH, DRAFT = 9.81, 1025.0, 97.5, 36.0, 4.5
LOAD = 1891.6e3
PLACES = (-39.0, -19.5, 0.0, 19.5, 39.0)

CASE = """
title = "plan"
[gravity]
acceleration = [0, 0, -9.81]
[sea]
density = 1025
[bodies.barge]
type = "rigid"
mass = "9298.275 t"
inertia = [1.5e9, 5.5e9, 5.5e9]
frame = { motion = "free" }
[[surfaces]]
name = "plating"
body = "barge"
shape = { type = "box", size = [97.5, 36, 6] }
at = [0, 0, -1.5]
[hulls.barge]
surface = "plating"
"""


def tank(
    name: str, x: float, mass: float = 1e6, height: float = 5.4, y: float = 0.0, breadth: float = 20.0
) -> str:
    return (
        f'[[tanks]]\nname = "{name}"\nhull = "barge"\nfloor = [{x}, {y}, -4]\n'
        f"size = [19.5, {breadth}, {height}]\nmass = {mass}\n"
    )


def plan(folder: Path, text: str) -> dict:
    (folder / "case.toml").write_text(CASE + text, encoding="utf-8")
    return ballast_command(folder, out=folder / "out", log=Log(quiet=True))[0]


FIVE = "".join(tank(f"tank_{i + 1}", x) for i, x in enumerate(PLACES))
STAGES = f"""
[ballast]
hull = "barge"
draft = 4.5
stages = [
    {{ name = "midships", loads = [{{ mass = {LOAD}, point = [0, 0, 11.5], length = 25.2 }}], time = 0 }},
    {{ name = "end", loads = [{{ mass = {LOAD}, point = [36.15, 0, 11.5], length = 25.2 }}], time = 3600 }},
    {{ name = "ashore", time = 7200 }},
]
"""


class TestPlan:
    def test_least_norm_girder_and_stability(self, tmp_path: Path) -> None:
        """+-701.35, +-350.67 t: the least of all that take a moment; 167.7 MN m sagging, 112.1 hogging."""
        pumps = '[[pumps]]\nname = "p"\nsource = "sea"\ntarget = "tank_1"\nrate = "500 t/h"\n'
        found = plan(tmp_path, FIVE + pumps + STAGES)
        midships, end, ashore = found["stages"]
        x = np.array(PLACES)
        A = np.array([np.ones(5), x])
        expected = np.linalg.pinv(A) @ np.array([0.0, -LOAD * 36.15])
        np.testing.assert_allclose(np.abs(expected[[0, 1]]) * 1e-3, [701.35, 350.67], atol=5e-3)
        changes = np.array(list(end["changes"].values()))
        np.testing.assert_allclose(changes, expected, rtol=1e-9, atol=1e-9 * LOAD)
        np.testing.assert_allclose(list(midships["changes"].values()), 0.0, atol=1e-9 * LOAD)
        assert sum(ashore["tanks"].values()) == pytest.approx(5e6 + LOAD, rel=1e-12)
        assert end["rates"]["tank_1"] == pytest.approx(expected[0] / 3600.0, rel=1e-9)
        assert end["short"] == {"tank_1": pytest.approx(500e3 / 3600.0)}
        assert midships["sagging"]["value"] == pytest.approx(LOAD * G * (LENGTH - 25.2) / 8.0, rel=1e-9)
        assert midships["sagging"]["value"] == pytest.approx(167.7e6, rel=1e-3)
        assert end["hogging"]["value"] == pytest.approx(-112.1e6, rel=1e-3)
        for stage in found["stages"]:
            assert stage["draft_aft"] == pytest.approx(DRAFT, abs=1e-9)
            assert stage["draft_forward"] == pytest.approx(DRAFT, abs=1e-9)
            assert np.abs(stage["closure"]).max() < 1e-6
        free = 5 * RHO * 19.5 * 20.0**3 / 12.0
        depth = (1e6 + expected) / (RHO * 19.5 * 20.0)
        weights = [9298.275e3, LOAD, *(1e6 + expected)]
        heights = [DRAFT, DRAFT + 11.5, *(0.5 + 0.5 * depth)]
        KG = float(np.dot(weights, heights)) / sum(weights)
        GM = 0.5 * DRAFT + BREADTH**2 / (12.0 * DRAFT) - KG - free / sum(weights)
        assert end["GM_T"] == pytest.approx(GM, rel=1e-9)
        with (tmp_path / "out" / "ballast" / "barge_ballast.csv").open() as file:
            rows = list(csv.DictReader(file))
        assert float(rows[1]["tank_1_kg"]) == end["tanks"]["tank_1"]
        assert (tmp_path / "out" / "ballast" / "barge_ballast.png").stat().st_size > 10_000
        assert (
            json.loads((tmp_path / "out" / "ballast" / "barge_ballast.json").read_text())["hull"] == "barge"
        )

    def test_table_of_the_lightship(self, tmp_path: Path) -> None:
        """Even weight in pieces is a trapezoid without slope."""
        table = "\nlightship = { stations = [-48.75, -10, 20, 48.75], weights = [3, 3, 3, 3] }"
        one = plan(tmp_path, FIVE + STAGES)["stages"]
        two = plan(tmp_path, FIVE + STAGES.replace("draft = 4.5", "draft = 4.5" + table))["stages"]
        for a, b in zip(one, two, strict=True):
            for key in ("sagging", "hogging", "shear"):
                assert a[key]["value"] == pytest.approx(b[key]["value"], rel=1e-9, abs=1.0)

    def test_tanks_that_run_full_leave_the_rest_to_others(self, tmp_path: Path) -> None:
        """Against SciPy's general solver with bounds."""
        from scipy.optimize import minimize

        small = "".join(tank(f"tank_{i + 1}", x, height=3.6 if i == 0 else 5.4) for i, x in enumerate(PLACES))
        end = plan(tmp_path, small + STAGES)["stages"][1]
        full = RHO * 19.5 * 20.0 * 3.6
        high = np.array([full, *[RHO * 19.5 * 20.0 * 5.4] * 4])
        rows = np.array([np.ones(5), PLACES])
        best = minimize(
            lambda d: float(d @ d), np.zeros(5), jac=lambda d: 2.0 * d, method="SLSQP",
            constraints={"type": "eq", "fun": lambda d: rows @ d - [0.0, -LOAD * 36.15 * 1e-6], "jac": lambda _: rows},
            bounds=[(-1.0, h * 1e-6 - 1.0) for h in high], options={"ftol": 1e-14, "maxiter": 500},
        )  # fmt: skip
        assert end["tanks"]["tank_1"] == pytest.approx(full, rel=1e-12)
        np.testing.assert_allclose(list(end["changes"].values()), best.x * 1e6, atol=100.0)

    def test_heel_of_a_load_off_the_middle_and_no_draft(self, tmp_path: Path) -> None:
        """Wing tanks: water moves across, none comes; the hull floats as deep as before."""
        wings = "".join(
            tank(f"{side}_{i}", x, y=y, breadth=9.0)
            for side, y in (("p", 8.0), ("s", -8.0))
            for i, x in enumerate((-30.0, 30.0))
        )
        text = """
        [ballast]
        hull = "barge"
        stages = [{ name = "a", loads = [{ mass = 2e5, point = [10, 4, 10] }], heel = 0.01, trim = 0.005 }]
        """
        stage = plan(tmp_path, wings + text)["stages"][0]
        assert stage["list"] == pytest.approx(0.01, abs=1e-9)
        assert stage["trim"] == pytest.approx(0.005, abs=1e-9)
        assert np.abs(stage["closure"]).max() < 1e-4

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            (("mass = 1891600.0", "mass = 9e6"), "no filling of tank_1"),
            (("[36.15, 0, 11.5]", "[36.15, 2, 11.5]"), "stage 'end': no filling of tank_1"),
            (('hull = "barge"\ndraft', 'hull = "bargee"\ndraft'), "bargee"),
            (('"end"', '"midships"'), "two stages 'midships'"),
            (("time = 3600", "time = 7200"), "increasing times"),
            (("draft = 4.5", 'draft = 4.5\ntanks = ["tank_9"]'), "tank_9"),
            (
                ("draft = 4.5", "draft = 4.5\nlightship = { stations = [-48, 48], weights = [2, 1] }"),
                "its centre is at x",
            ),
        ],
    )
    def test_refused(self, tmp_path: Path, change: tuple[str, str], words: str) -> None:
        text = FIVE + STAGES
        assert change[0] in text
        with pytest.raises(InputError, match=words):
            plan(tmp_path, text.replace(*change))


@pytest.mark.slow
def test_nearest_within_bounds_agrees_with_projection_by_dykstra() -> None:
    """Random equations and boxes against alternating projections."""
    random = np.random.default_rng(3)
    for _ in range(20):
        n, k = 8, 2
        A, high = random.normal(size=(k, n)), random.uniform(0.5, 2.0, n)
        inside = random.uniform(0.0, 1.0, n) * high
        before = random.uniform(-1.0, 3.0, n)
        b = A @ inside
        found = least_change(A, b, before, high)
        assert found is not None
        x, p, q = before.copy(), np.zeros(n), np.zeros(n)
        inverse = np.linalg.inv(A @ A.T)
        for _ in range(20000):
            y = x + p - A.T @ (inverse @ (A @ (x + p) - b))
            p = x + p - y
            x = np.clip(y + q, 0.0, high)
            q = y + q - x
        np.testing.assert_allclose(found, x, atol=1e-6)
    assert least_change(np.ones((1, 3)), np.array([10.0]), np.zeros(3), np.ones(3)) is None


class TestGirder:
    def test_sections_of_an_octahedron(self) -> None:
        """Half under water: sections (R - |x|)^2, and R^4 rho g / 12 of hogging under an even weight."""
        R = 5.0
        points = R * np.vstack([np.eye(3), -np.eye(3)])
        faces = [[i, j, k] for i in (0, 3) for j in (1, 4) for k in (2, 5)]
        triangles = [f if np.linalg.det(points[f]) > 0.0 else f[::-1] for f in faces]
        hull = check_hull(TriangleSurface(points, np.array(triangles), name="octahedron"))
        mass = RHO * 2.0 * R**3 / 3.0
        beam = girder(hull, Pose(0.0, 0.0, 0.0), [Weight(mass, -R, R)], RHO, G)
        assert beam.bending.min() == pytest.approx(-RHO * G * R**4 / 12.0, rel=1e-9)
        assert np.abs(beam.closure).max() < 1e-9

    def test_trimmed_box_closes(self) -> None:
        """Weight over the centre of buoyancy of a trimmed box, at another height: nothing is left at the end."""
        box = check_hull(box_surface((LENGTH, BREADTH, 10.0)))
        from heavylift.solver.water.hulls.hydrostatics import equilibrium

        mass, centre = RHO * LENGTH * BREADTH * 5.0, (0.5, 0.0, 1.0)
        position = equilibrium(box, mass, centre, density=RHO, gravity=G)
        assert abs(position.pose.trim) > 1e-3
        slope = 12.0 * 0.5 / LENGTH
        weights = [Weight(mass, -LENGTH / 2, LENGTH / 2, 1.0, slope)]
        beam = girder(box, position.pose, weights, RHO, G)
        assert np.abs(beam.closure).max() < 1e-6

    def test_point_loads_jump(self) -> None:
        """A mass in the middle of a box: W L / 8 without length."""
        box = check_hull(box_surface((LENGTH, BREADTH, 10.0)))
        mass = RHO * LENGTH * BREADTH * 5.0
        beam = girder(box, Pose(0.0, 0.0, 0.0), [Weight(mass, 0.0, 0.0)], RHO, G)
        assert beam.bending.max() == pytest.approx(mass * G * LENGTH / 8.0, rel=1e-9)
        assert beam.shear.max() == pytest.approx(mass * G / 2.0, rel=1e-9)
        assert beam.shear.min() == pytest.approx(-mass * G / 2.0, rel=1e-9)
