"""What might break the sea: long steps, huge waves, capsizing, hulls under and over water, slack lines, many turns."""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize
from scipy.spatial import ConvexHull, HalfspaceIntersection

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.rotation import quaternion_from_rotation_vector, rotation_matrix
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
from heavylift.preprocess.hydrodynamics.retardation import infinite_added_mass
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.force_elements.wire_rope import SpringRope
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.connections import GROUND, RopePoint
from heavylift.solver.scene.contacts import RigidLaw
from heavylift.solver.scene.moorings import LineSection
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Radiation, Sea, Water
from heavylift.solver.scene.wind_loads import CurrentField, DragElement, WindField
from heavylift.solver.simulation import Simulation
from heavylift.solver.water.lines.fenders import Fender
from heavylift.solver.water.lines.mooring_lines import MooringLine
from heavylift.solver.water.waves.wave_trains import regular_wave

sys.path.append(str(Path(__file__).resolve().parents[1] / "solver"))
sys.path.append(str(Path(__file__).resolve().parents[1] / "solver" / "contact"))
from hull_shapes import box_grid
from mesh_contact_scenes import Run

if TYPE_CHECKING:
    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]

G, DENSITY = 9.81, 1025.0
WATER = Water(density=DENSITY, gravity=G)
WEIGHT = (Gravity(np.array([0.0, 0.0, -G])),)
L, B, D, T = 20.0, 10.0, 5.0, 2.5
BOX = box_surface((L, B, D))
CASES = Path(__file__).resolve().parents[2] / "cases"
# of the barge whose database comes with its case
BARGE = (97.5, 36.0, 6.0)
DRAFT = 4.5


def box(
    name: str = "box",
    *,
    mass: float = DENSITY * L * B * T,
    rise: float = 0.0,
    height: float = 0.0,
    **more: Any,
) -> RigidBody:
    """Body of the 20 x 10 x 5 m box, origin in its middle; floats with half its depth.

    Parameters
    ----------
    rise, height
        Of the centre of mass over the middle, and of the middle over its place at rest [m].
    """
    inertia = mass / 12.0 * np.diag([B**2 + D**2, L**2 + D**2, L**2 + B**2])
    place = more.pop("position", np.array([0.0, 0.0, height]))
    return RigidBody(name, mass, inertia, centre_of_mass=np.array([0.0, 0.0, rise]), position=place, **more)


def turned(x: float, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    return quaternion_from_rotation_vector(np.array([x, y, z]))


def damped(mass: float = DENSITY * L * B * T) -> np.ndarray:
    """A fifth of the critical damping of heave, roll and pitch, roughly."""
    rate = 0.4 * np.sqrt(G / T)
    return np.diag([1.0, 1.0, 1.0, B**2 / 6.0, L**2 / 6.0, L**2 / 6.0]) * mass * rate


def simulate(scene: Scene, step: float, duration: float, **options: Any) -> Run:
    """Run to the end, or to where it stops by itself; only finite numbers are recorded."""
    every = options.pop("record_every", max(1, round(0.1 / step)))
    simulation = Simulation(scene, step, record_every=every, **options)
    first = simulation.record()
    times, records = simulation.advance(round(duration / step))
    found = Run(np.append(0.0, times), np.vstack([first, records]), simulation)
    assert np.isfinite(found.records).all()
    return found


def completed(found: Run) -> Run:
    assert found.simulation.outcome == Outcome.COMPLETED, found.simulation.message
    return found


def floating(*bodies: RigidBody, **sea: Any) -> Scene:
    """Boxes that float in still water, far from each other as far as water knows."""
    damping = sea.pop("damping", np.zeros((6, 6)))
    surface = sea.pop("surface", BOX)
    hulls = tuple(Hull(body=body.name, restoring=surface, damping=damping) for body in bodies)
    return Scene(bodies=bodies, forces=WEIGHT, sea=Sea(water=WATER, hulls=hulls, **sea))


def roll(found: Run, name: str = "box") -> np.ndarray:
    """Angle between the z axis of a body and the vertical [rad]."""
    R = np.array([rotation_matrix(q) for q in found[f"{name}.orientation"]])
    return np.arccos(np.clip(R[:, 2, 2], -1.0, 1.0))


# ---- hulls without waves


def test_a_hull_with_negative_metacentric_height_takes_its_angle_of_loll() -> None:
    """Wall-sided: GM + BM tan^2 / 2 = 0; the deck edge is dry at this angle. Both sides, from a small push."""
    BM = B**2 / (12.0 * T)
    GM = -0.2
    rise = BM + 0.5 * T - GM - D / 2.0  # KG over the middle: KB + BM - GM
    angle = np.arctan(np.sqrt(-2.0 * GM / BM))
    for side in (1.0, -1.0):
        body = box(rise=rise, orientation=turned(side * 0.01))
        found = completed(simulate(floating(body, damping=damped()), 0.05, 300.0))
        R = rotation_matrix(found["box.orientation"][-1])
        assert np.arctan2(R[2, 1], R[2, 2]) == pytest.approx(side * angle, abs=1e-4)
        assert np.abs(found["box.velocity"][-1]).max() < 1e-6


@pytest.mark.parametrize("step", [0.02, 0.1, 0.5])
def test_a_hull_capsizes_and_energy_never_grows(step: float) -> None:
    """Centre of mass 6 m over the middle: it turns over, and rests with its weight below."""
    body = box(rise=6.0, orientation=turned(0.02, 0.003, 0.1))
    found = completed(simulate(floating(body, damping=damped()), step, 200.0))
    energy = found["energy.kinetic"] + found["energy.potential"]
    released = energy[0] - energy[-1]
    assert np.diff(energy).max() < 0.01 * released * step
    assert roll(found)[-1] > 0.99 * np.pi
    assert found["box.displaced_volume"][-1] == pytest.approx(L * B * T, rel=1e-6)


def test_undamped_capsizing_keeps_its_energy() -> None:
    body = box(rise=4.0, orientation=turned(0.05, 0.02, 0.0))
    ways = [completed(simulate(floating(body), step, 60.0)) for step in (0.04, 0.02, 0.01)]
    turned_over = roll(ways[-1]).max()
    assert turned_over > 0.5 * np.pi
    swing = np.ptp(ways[-1]["energy.kinetic"])
    drifts = [found.drift / swing for found in ways]
    assert drifts[0] < 0.02
    assert drifts[2] < 0.3 * drifts[0]


def test_a_submerged_body_sinks_and_another_rises_with_its_acceleration() -> None:
    """Weight less buoyancy over mass, exactly, until the light one reaches the surface."""
    heavy, light = 1.5 * DENSITY * L * B * D, 0.8 * DENSITY * L * B * D
    bodies = (
        box("heavy", mass=heavy, position=np.array([0.0, 0.0, -10.0])),
        box("light", mass=light, position=np.array([50.0, 0.0, -60.0])),
    )
    found = completed(simulate(floating(*bodies), 0.05, 5.0))
    for name, mass, depth in (("heavy", heavy, -10.0), ("light", light, -60.0)):
        a = G * (DENSITY * L * B * D / mass - 1.0)
        z = depth + 0.5 * a * found.times**2
        assert z.max() < -D / 2.0
        np.testing.assert_allclose(found[f"{name}.position"][:, 2], z, rtol=0.0, atol=1e-9)


def test_a_box_falls_splashes_dives_and_comes_out_again() -> None:
    """From 1 m it dives wholly, by energy 6 m deep; undamped it rises to where it came from, again and again."""
    start = T + 1.0  # bottom 1 m over the water; 0 is the place at rest
    assert pytest.approx(6.0 * (D - T)) == T * 1.0 + 0.5 * D**2
    body = box(height=start)
    found = completed(simulate(floating(body), 0.005, 30.0, record_every=4))
    z = found["box.position"][:, 2]
    flight = found.times < np.sqrt(2.0 * 1.0 / G)
    np.testing.assert_allclose(z[flight], start - 0.5 * G * found.times[flight] ** 2, rtol=0.0, atol=1e-9)
    assert z.min() == pytest.approx(0.5 * D - 6.0, abs=2e-3)
    later = found.times > 10.0
    assert z[later].max() == pytest.approx(start, abs=2e-3)
    assert z[later].min() == pytest.approx(0.5 * D - 6.0, abs=2e-3)
    assert found["box.displaced_volume"].max() == pytest.approx(L * B * D, rel=1e-12)
    assert found["box.displaced_volume"].min() == 0.0


@pytest.mark.parametrize("step", [0.01, 0.1, 0.2, 0.5])
def test_heave_and_roll_stay_bounded_at_long_steps(step: float) -> None:
    """2 pi sqrt(T / g) = 3.2 s are 6 steps of 0.5 s: an inaccurate period, not a growing motion, over 1000 s."""
    body = box(height=0.3, orientation=turned(0.05, 0.01, 0.3))
    found = completed(simulate(floating(body), step, 1000.0))
    late = found.times > 900.0
    assert np.abs(found["box.position"][late, 2]).max() < 0.4
    assert roll(found)[late].max() < 0.09
    assert np.ptp(found["energy.balance"]) < 0.25 * found["energy.kinetic"].max()


def wet_volume(position: np.ndarray, R: np.ndarray, size: tuple[float, float, float]) -> float:
    """Of a box below z = 0, by half spaces [m3]."""
    planes = [
        [*(s * R[:, k]), -s * R[:, k] @ position - 0.5 * size[k]] for k in range(3) for s in (1.0, -1.0)
    ]
    planes.append([0.0, 0.0, 1.0, 0.0])
    corners = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T * size @ R.T + position
    low = corners[corners[:, 2].argmin()]
    inside = low + 0.02 * (position - low)
    if low[2] >= 0.0:
        return 0.0
    if corners[:, 2].max() <= 0.0:
        return float(np.prod(size))
    return float(ConvexHull(HalfspaceIntersection(np.array(planes), inside).intersections).volume)


def test_a_hull_of_12000_triangles_in_random_poses() -> None:
    """Volume against half spaces; then all of them tumble for 20 s, and energy is kept."""
    points, triangles = box_grid((70, 35, 17), (L, B, D))
    assert len(triangles) > 12_000
    surface = replace(BOX, points=points, triangles=triangles)
    random = np.random.default_rng(5)
    bodies = [
        box(
            f"b{i}",
            position=np.array([40.0 * i, 0.0, random.uniform(-6.0, 6.0)]),
            orientation=turned(*random.normal(scale=2.0, size=3)),
            velocity=random.normal(scale=1.0, size=3),
            angular_velocity=random.normal(scale=0.3, size=3),
        )
        for i in range(12)
    ]
    found = completed(simulate(floating(*bodies, surface=surface), 0.01, 20.0, record_every=10))
    for body in bodies:
        for at in (0, -1):
            R = rotation_matrix(found[f"{body.name}.orientation"][at])
            volume = wet_volume(found[f"{body.name}.position"][at], R, (L, B, D))
            assert found[f"{body.name}.displaced_volume"][at] == pytest.approx(volume, rel=1e-9, abs=1e-6)
    assert found.drift < 2e-3 * found["energy.kinetic"].max()


# ---- waves and added mass


@cache
def database() -> HydrodynamicDatabase:
    return read_netcdf(CASES / "transport_barge" / "barge.nc")


def barge(**more: Any) -> RigidBody:
    """The barge, origin in the water plane."""
    length, breadth, _ = BARGE
    mass = more.pop("mass", database().density * length * breadth * DRAFT)
    inertia = mass * np.diag([(0.35 * breadth) ** 2, (0.25 * length) ** 2, (0.25 * length) ** 2])
    return RigidBody("barge", mass, inertia, centre_of_mass=np.array([0.0, 0.0, 1.5]), **more)


def barge_hull(**more: Any) -> Hull:
    surface = box_surface(BARGE)
    surface = replace(surface, points=surface.points + np.array([0.0, 0.0, BARGE[2] / 2.0 - DRAFT]))
    return Hull(body="barge", **{"restoring": surface, **more})


def in_waves(body: RigidBody, hull: Hull, height: float, period: float, heading: float, **more: Any) -> Scene:
    water = Water(density=database().density, gravity=database().gravity)
    waves = regular_wave(height, period, heading, gravity=water.gravity)
    radiation = Radiation(bodies=("barge",), database=more.pop("database", database()))
    sea = Sea(water=water, hulls=(hull,), radiation=(radiation,), waves=waves, **{"ramp": 20.0, **more})
    return Scene(bodies=(body,), forces=(Gravity(np.array([0.0, 0.0, -water.gravity])),), sea=sea)


def linear_hull(**more: Any) -> Hull:
    """The barge with a float plane in place of its surface."""
    length, breadth, _ = BARGE
    area = length * breadth
    restoring = LinearRestoring(
        volume=area * DRAFT,
        centre_of_buoyancy=np.array([0.0, 0.0, -0.5 * DRAFT]),
        reference=np.zeros(3),
        area=area,
        second_moments=(area * length**2 / 12.0, area * breadth**2 / 12.0, 0.0),
    )
    return Hull(body="barge", restoring=restoring, **more)


@pytest.mark.parametrize("step", [0.05, 0.5])
@pytest.mark.parametrize("heading", [0.0, 90.0])
@pytest.mark.parametrize(("height", "period"), [(14.0, 8.0), (30.0, 13.0)])
def test_waves_near_breaking_do_not_blow_up(
    height: float, period: float, heading: float, step: float
) -> None:
    """H / lambda of 0.11: the motion is bounded, or stops where the whole deck goes under or the bottom comes out."""
    found = simulate(in_waves(barge(), barge_hull(), height, period, np.deg2rad(heading)), step, 300.0)
    if found.simulation.outcome is not Outcome.COMPLETED:
        assert found.simulation.outcome is Outcome.OUTSIDE_DATABASE
        assert "'barge'" in found.simulation.message
    assert np.abs(found["barge.position"][:, 2]).max() < height


@pytest.mark.parametrize("step", [0.05, 0.5])
@pytest.mark.parametrize(("height", "period"), [(14.0, 8.0), (30.0, 13.0)])
def test_waves_near_breaking_move_a_linear_hull_by_as_much_more(
    height: float, period: float, step: float
) -> None:
    """Linear theory knows no height: heave in head waves is that of waves of a millimetre, times the height."""
    heights = []
    for one in (1e-3, height):
        scene = in_waves(barge(), linear_hull(), one, period, 0.0)
        found = completed(simulate(scene, step, 300.0))
        heights.append(found["barge.position"][:, 2] / one)
    scale = np.abs(heights[0]).max()
    # pitch is no small angle any more, and the barge drifts: terms of second order
    assert np.abs(heights[1] - heights[0]).max() < 0.25 * scale
    assert scale < 1.5


def test_a_barge_that_goes_under_stops_with_the_reason() -> None:
    """Beam waves of 30 m: its database says nothing of a hull without a water plane."""
    found = simulate(in_waves(barge(), barge_hull(), 30.0, 13.0, 0.5 * np.pi), 0.05, 300.0)
    assert found.simulation.outcome is Outcome.OUTSIDE_DATABASE
    assert found.times[-1] < 300.0


@pytest.mark.parametrize("heading", [0.0, 90.0])
def test_a_step_of_half_a_second_keeps_the_motion(heading: float) -> None:
    """Small waves of 9 s: 18 steps a period; heave within 6 % of that with steps of 25 ms."""
    scene = in_waves(barge(), barge_hull(), 0.2, 9.0, np.deg2rad(heading))
    amplitudes = []
    for step in (0.025, 0.25, 0.5):
        found = completed(simulate(scene, step, 400.0, record_every=round(0.5 / step)))
        late = found.times > 300.0
        amplitudes.append(np.std(found["barge.position"][late, 2]))
    assert amplitudes[1] == pytest.approx(amplitudes[0], rel=0.02)
    assert amplitudes[2] == pytest.approx(amplitudes[0], rel=0.06)


@pytest.mark.parametrize("share", [1.0, 0.2, 0.02])
@pytest.mark.parametrize("step", [0.05, 0.5])
def test_a_body_lighter_than_the_water_it_carries_along(share: float, step: float) -> None:
    """Deep under water at rest: the first acceleration is (buoyancy - weight) / (m + A33), however small m is."""
    length, breadth, depth = BARGE
    data = database()
    displaced = data.density * length * breadth * depth
    mass = share * 0.5 * displaced
    body = barge(mass=mass, position=np.array([0.0, 0.0, -300.0]))
    whole = LinearRestoring(
        volume=length * breadth * depth,
        centre_of_buoyancy=np.zeros(3),
        reference=np.zeros(3),
        area=0.0,
        second_moments=(0.0, 0.0, 0.0),
    )
    # a single wave of no height: the memory acts, no wave does
    scene = in_waves(body, Hull(body="barge", restoring=whole), 1e-9, 9.0, 0.0)
    found = completed(simulate(scene, step, 4.0, record_every=1))
    A33 = infinite_added_mass(data.omega, data.added_mass, data.damping)[0][2, 2]
    assert 0.9 * mass < A33  # infinite-frequency added mass of heave
    a = data.gravity * (displaced - mass) / (mass + A33)
    z = found["barge.position"][:, 2] + 300.0
    early = (found.times > 0.0) & (found.times <= max(0.1, step))
    # memory takes from it with the time: B is not zero at once, K(0) t / (m + A) of it
    np.testing.assert_allclose(z[early], 0.5 * a * found.times[early] ** 2, rtol=0.35 if step > 0.1 else 0.06)
    assert np.all(np.diff(z) > 0.0)


def test_the_waves_a_hull_sees_turn_with_it_by_two_turns() -> None:
    """Spun at a constant rate, so heavy that nothing turns it (it falls): forces from the database by hand."""
    data, rate, cut, period = database(), 0.02, 0.05, 9.0
    body = barge(mass=1e18, angular_velocity=np.array([0.0, 0.0, rate]))
    body = replace(body, centre_of_mass=np.zeros(3), inertia=np.eye(3) * 1e22)
    hull = barge_hull(restoring=None, low_pass=cut)
    scene = in_waves(body, hull, 2.0, period, 0.4, ramp=0.0)
    found = completed(simulate(scene, 0.1, 4.0 * np.pi / rate + 120.0, record_every=10))
    omega = 2.0 * np.pi / period
    at_omega = CubicSpline(data.omega, data.excitation_at_reference_points())(omega)
    mirror = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    turn = np.concatenate([data.headings, 2.0 * np.pi - data.headings[-2::-1]])
    table = np.concatenate([at_omega, (at_omega * mirror)[-2::-1]])
    table[-1] = table[0]
    by_heading = CubicSpline(turn, table, bc_type="periodic")
    t = found.times
    late = t > 200.0  # the filter follows at a distance of 2 rate / cut-off
    heading = rate * t - 2.0 * rate / cut
    assert heading[-1] > 4.0 * np.pi
    force = (by_heading(np.mod(0.4 - heading, 2.0 * np.pi)) * np.exp(-1j * omega * t)[:, None]).real
    got = np.hstack([found["barge.wave_force"], found["barge.wave_moment"]])
    scale = np.abs(force).max(axis=0)
    assert (np.abs(got - force)[late] / scale).max() < 5e-3
    spun = rotation_matrix(found["barge.orientation"][-1])
    assert np.arctan2(spun[1, 0], spun[0, 0]) == pytest.approx(np.angle(np.exp(1j * rate * t[-1])), abs=1e-6)


# ---- lines, wind, current, fenders


def line(length: float, **more: Any) -> MooringLine:
    """Wire from a bollard 60 m ahead of the middle of the box to its bow, in air."""
    return MooringLine(
        **{
            "name": "wire",
            "body_a": GROUND,
            "point_a": np.array([60.0, 0.0, 1.0]),
            "body_b": "box",
            "point_b": np.array([10.0, 0.0, 1.0]),
            "sections": (LineSection(length, 8.0, 2e7),),
            **more,
        }
    )


WIND = WindField(speed=20.0, profile="uniform", direction=np.pi)
CURRENT = CurrentField(speed=1.0, direction=0.0)


def moored(
    body: RigidBody, length: float, *, air: float = 0.0, water: float = 0.0, fender: bool = True, **more: Any
) -> Scene:
    """The box with a wire ahead and two fenders astern, in wind from ahead and current from astern."""
    face = -L / 2.0 if fender else -1e3
    loads = (
        DragElement(name="windage", body="box", point=np.array([0.0, 0.0, 1.0]), area=air, coefficient=1.2),
        DragElement(
            name="drag",
            body="box",
            point=np.array([0.0, 0.0, -1.0]),
            area=water,
            coefficient=1.0,
            fluid="current",
        ),
    )
    stops = tuple(
        Fender(
            name=name,
            body_a=GROUND,
            point_a=np.array([face, y, 0.0]),
            body_b="box",
            point_b=np.array([-L / 2.0, y, 0.0]),
            direction=np.array([1.0, 0.0, 0.0]),
            stiffness=1e6,
            damping=1e5,
        )
        for name, y in (("port", 4.0), ("starboard", -4.0))
    )
    return floating(
        body, lines=(line(length, **more),), fenders=stops, loads=loads, fields=(WIND, CURRENT),
        damping=damped() * 0.05,
    )  # fmt: skip


def test_wind_presses_a_hull_on_its_fenders_with_its_own_force() -> None:
    """At rest: rho C A V^2 / 2 on the two fenders, less what the slack wire pulls by its weight."""
    area = 200.0
    wanted = 0.5 * WIND.density * 1.2 * area * WIND.speed**2
    found = completed(simulate(moored(box(), 90.0, air=area), 0.05, 400.0))
    assert found["windage.force"][-1, 0] == pytest.approx(-wanted, rel=1e-6)
    pull = found["wire.horizontal_tension"][-1]
    assert 0.0 < pull < 0.01 * wanted
    for name in ("port", "starboard"):
        assert found[f"{name}.force"][-1] == pytest.approx(0.5 * (wanted - pull), rel=1e-5)
        assert found[f"{name}.compression"][-1] == pytest.approx(found[f"{name}.force"][-1] / 1e6, rel=1e-5)
    assert np.abs(found["box.velocity"][-1]).max() < 1e-5


def test_current_carries_a_hull_away_with_its_own_speed() -> None:
    """Drag over damping: rho C A (U - v)^2 / 2 = d v, far from the fender, on a wire that is slack."""
    area = 400.0
    resistance = 0.05 * damped()[0, 0]
    scene = moored(box(), 400.0, water=area, fender=False)
    found = completed(simulate(scene, 0.1, 60.0))
    v = brentq(lambda u: 0.5 * DENSITY * area * (1.0 - u) ** 2 - resistance * u, 0.0, 1.0)
    pull = found["wire.horizontal_tension"]
    assert pull.max() < 0.05 * resistance * v
    assert found["box.velocity"][-1, 0] == pytest.approx(v, rel=0.03)


@pytest.mark.parametrize("step", [0.005, 0.02, 0.1, 0.5])
def test_a_line_snaps_taut_and_goes_slack_again(step: float) -> None:
    """The box drifts away with 0.5 m/s: its kinetic energy goes into the wire and comes back. Peak v sqrt(m EA / L)."""
    body = box(velocity=np.array([-0.5, 0.0, 0.0]))
    length = 52.0
    scene = moored(body, length, fender=False)
    hulls = tuple(replace(hull, damping=np.zeros((6, 6))) for hull in scene.sea.hulls)
    scene = replace(scene, sea=replace(scene.sea, hulls=hulls))
    found = completed(simulate(scene, step, 60.0, record_every=1))
    peak = 0.5 * np.sqrt(body.mass * 2e7 / length)
    tension = found["wire.tension"]
    assert tension.max() < 1.1 * peak
    assert tension.min() < 0.02 * peak
    kinetic = found["energy.kinetic"]
    if step <= 0.1:
        assert tension.max() == pytest.approx(peak, rel=0.03)  # 2 % of the energy lifts the wire
        assert found["box.velocity"][-1, 0] == pytest.approx(0.5, abs=0.02)  # thrown back as fast as it came
        assert kinetic.max() < 1.1 * kinetic[0]  # the wire falls as the bollard comes near
    else:  # half a period of mass and wire is 7 steps: what the kink of slack to taut adds stays bounded
        assert kinetic.max() < 2.0 * kinetic[0]


def test_a_line_that_is_torn_stops_the_run_and_is_named() -> None:
    """At 5 m/s the strain goes beyond its limit: the run stops before that, and says which line it was."""
    body = box(velocity=np.array([-5.0, 0.0, 0.0]))
    found = simulate(moored(body, 50.5, fender=False, strain_limit=0.02), 0.02, 30.0)
    assert found.simulation.outcome == Outcome.LINE_OVERSTRETCHED
    assert "wire" in found.simulation.message
    assert found.times[-1] < 2.0


def test_a_line_shorter_than_its_span_is_refused() -> None:
    with pytest.raises(InputError, match="wire") as caught:
        Simulation(moored(box(), 40.0), 0.05)
    assert "40" in caught.value.problem


# ---- cargo


def test_a_block_on_deck_presses_with_its_weight_and_sinks_the_hull() -> None:
    """Set down from 0.1 m on the middle of the deck: weight in the contact, sinkage m / (rho A) of the hull."""
    hull, load = box(rise=-1.5), 60.0e3
    cube = box_surface(2.0)
    block = RigidBody(
        "block", load, load * 4.0 / 6.0 * np.eye(3), position=np.array([0.0, 0.0, D / 2.0 + 1.0 + 0.1])
    )
    scene = floating(hull, damping=2.0 * damped())
    scene = replace(
        scene,
        bodies=(hull, block),
        surfaces=(
            CollisionSurface(name="deck", body="box", surface=BOX),
            CollisionSurface(name="skin", body="block", surface=cube),
        ),
        collisions=(
            Collision(name="cargo", surfaces=("deck", "skin"), law=RigidLaw(), friction=0.5, clearance=True),
        ),
    )
    found = completed(simulate(scene, 0.01, 60.0, record_every=20))
    assert found["cargo.normal_force"][-1] == pytest.approx(load * G, rel=1e-6)
    sinkage = load / (DENSITY * L * B)
    assert found["box.position"][-1, 2] == pytest.approx(-sinkage, rel=1e-5)
    gap = found["block.position"][-1, 2] - found["box.position"][-1, 2]
    assert gap == pytest.approx(D / 2.0 + 1.0, abs=1e-5)
    assert found["box.displaced_volume"][-1] == pytest.approx((hull.mass + load) / DENSITY, rel=1e-6)


def test_a_load_on_a_rope_swings_with_a_rolling_hull() -> None:
    """Roll of the hull, its sway, and the pendulum: frequencies of the linear system of three coordinates."""
    load, rope, jib, below = 50.0e3, 6.0, 9.0, -0.5
    hull = box(rise=below)
    tip = np.array([0.0, 0.0, jib])
    stiffness = 5e8
    stretch = load * G / stiffness
    trim = load / (DENSITY * L * B)
    reach = rope + stretch
    hang = np.array([0.3, jib - trim - np.sqrt(reach**2 - 0.3**2)])  # swung out by 0.3 m to start
    radius = 0.1
    ball = RigidBody("load", load, load * radius * np.eye(3), position=np.array([0.0, hang[0], hang[1]]))
    hull = replace(hull, position=np.array([0.0, 0.0, -trim]))
    scene = floating(hull)
    hoist = SpringRope(
        name="hoist", path=(RopePoint("box", tip), RopePoint("load", np.zeros(3))), length=rope,
        stiffness=stiffness,
    )  # fmt: skip
    scene = replace(scene, bodies=(hull, ball), ropes=(hoist,))
    found = completed(simulate(scene, 0.02, 400.0, record_every=5))
    # q = sway of the middle, roll, y of the load; rope of constant length and tension
    m, I = hull.mass, hull.inertia[0, 0]
    draft = T + trim
    M = np.zeros((3, 3))
    M[0, 0] = m
    M[0, 1] = M[1, 0] = -m * below
    M[1, 1] = I + m * below**2
    M[2, 2] = load
    volume = L * B * draft
    buoyancy = -D / 2.0 + draft / 2.0  # of its centre over the middle
    K = np.zeros((3, 3))
    K[1, 1] = DENSITY * G * (L * B**3 / 12.0 + volume * buoyancy) - m * G * below - load * G * jib
    # the rope: m g / l times half the square of the offset of its ends; the tip is at y - jib roll
    offset = np.array([1.0, -jib, -1.0])
    K += load * G / reach * np.outer(offset, offset)
    values = np.linalg.eigvals(np.linalg.solve(M, K)).real
    slow, fast = np.sqrt(np.sort(values)[1:])
    y = found["load.position"][:, 1] - found["box.position"][:, 1]
    t = found.times

    def misfit(pair: tuple[float, float]) -> float:
        columns = [np.ones_like(t)] + [f(w * t) for w in pair for f in (np.cos, np.sin)]
        matrix = np.column_stack(columns)
        return float(np.linalg.norm(y - matrix @ np.linalg.lstsq(matrix, y, rcond=None)[0]))

    best = minimize(misfit, (slow, fast), method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-9})
    np.testing.assert_allclose(best.x, (slow, fast), rtol=2e-3)
    assert best.fun < 0.05 * np.linalg.norm(y - y.mean())
    assert np.abs(found["hoist.tension"] / (load * G) - 1.0).max() < 0.05
