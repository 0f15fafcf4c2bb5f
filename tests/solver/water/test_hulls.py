"""Hulls in scenes: order, merged masses, long steps, capsized and drowned hulls, restarts, equilibria.

Scenes of the same kinds share their compiled code: hulls alone (without or with added mass), with memory and waves,
with a joint, with lines, two with databases of their own, two with one.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hull_shapes import outward_hull
from scipy.optimize import brentq, fsolve
from scipy.spatial.transform import Rotation

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.rotation import quaternion_from_rotation_vector
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.moorings import LineSection
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Radiation, Sea, Tank, Water
from heavylift.solver.simulation import Simulation
from heavylift.solver.water.lines.mooring_lines import MooringLine
from heavylift.solver.water.waves.wave_trains import regular_wave

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]

FILE = Path(__file__).resolve().parents[3] / "cases" / "transport_barge" / "barge.nc"
LENGTH, BREADTH, HEIGHT, DRAFT = 97.5, 36.0, 6.0, 4.5
RHO, G = 1025.0, 9.80665
MASS = RHO * LENGTH * BREADTH * DRAFT
AREA = LENGTH * BREADTH
CENTRE = np.array([0.0, 0.0, 1.5])  # KG 6 m; the origin is the middle of the water plane
INERTIA = np.diag(MASS * np.array([0.35 * BREADTH, 0.25 * LENGTH, 0.25 * LENGTH]) ** 2)
DAMPING = np.diag([1e5, 1e5, 1e6, 1e8, 1e9, 1e8])
WAVES = regular_wave(2.0, 9.0, np.deg2rad(30.0), gravity=G)
WEIGHT = (Gravity(np.array([0.0, 0.0, -G])),)
WATER = Water(density=RHO, gravity=G)


@cache
def database() -> HydrodynamicDatabase:
    return replace(read_netcdf(FILE), density=RHO, gravity=G)


@cache
def surface():
    box = box_surface((LENGTH, BREADTH, HEIGHT))
    return replace(box, points=box.points + np.array([0.0, 0.0, HEIGHT / 2.0 - DRAFT]))


def linear() -> LinearRestoring:
    return LinearRestoring(
        volume=AREA * DRAFT,
        centre_of_buoyancy=np.array([0.0, 0.0, -DRAFT / 2.0]),
        reference=np.zeros(3),
        area=AREA,
        second_moments=(BREADTH * LENGTH**3 / 12.0, LENGTH * BREADTH**3 / 12.0, 0.0),
    )


def barge(name: str = "barge", place=(0.0, 0.0, 0.2), turn=(0.03, 0.01, 0.2), **values) -> RigidBody:
    given = {
        "mass": MASS,
        "inertia": INERTIA,
        "centre_of_mass": CENTRE,
        "position": np.array(place),
        "orientation": quaternion_from_rotation_vector(np.array(turn)),
    } | values
    return RigidBody(name, **given)


def hull(name: str = "barge", restoring=None, **values) -> Hull:
    return Hull(body=name, restoring=surface() if restoring is None else restoring, **values)


def scene(*bodies: RigidBody, joints=(), **sea) -> Scene:
    given = {"hulls": tuple(hull(body.name) for body in bodies)} | sea
    return Scene(bodies=bodies, forces=WEIGHT, joints=joints, sea=Sea(water=WATER, **given))


def run(made: Scene, step: float, duration: float, every: float, **options):
    """Times, histories by channel, and the simulation."""
    simulation = Simulation(made, step, record_every=round(every / step), **options)
    simulation.record()
    times, records = simulation.advance(round(duration / step))
    assert simulation.outcome is Outcome.COMPLETED, simulation.message
    channels = {channel.name: channel for channel in simulation.channels}

    def history(name: str) -> np.ndarray:
        at = channels[name]
        return records[:, at.column : at.column + len(at.components)]

    return times, history, simulation


def motion(history, name: str = "barge") -> np.ndarray:
    """Place and orientation, (nt, 7)."""
    return np.hstack([history(f"{name}.position"), history(f"{name}.orientation")])


def split(share: float, place: np.ndarray, inertia: np.ndarray) -> RigidBody:
    """The barge without a part of its mass at a place of it: with that part it is the barge again."""
    part, rest = share * MASS, (1.0 - share) * MASS
    centre = (MASS * CENTRE - part * place) / rest

    def away(r: np.ndarray) -> np.ndarray:
        return r @ r * np.eye(3) - np.outer(r, r)

    own = INERTIA - inertia - part * away(place - CENTRE) - rest * away(centre - CENTRE)
    return barge(mass=rest, inertia=own, centre_of_mass=centre)


def constant(ratios: tuple[float, ...], bodies=("barge",)) -> HydrodynamicDatabase:
    """Added mass of all frequencies alike, in units of the mass and moments of inertia of the barge; no damping."""
    n = 6 * len(bodies)
    one = np.diag(np.array(ratios) * np.array([MASS, MASS, MASS, *np.diag(INERTIA)]))
    A = np.kron(np.eye(len(bodies)), one)
    omega = np.linspace(0.1, 2.0, 20)
    headings = np.deg2rad(np.arange(0.0, 181.0, 10.0))
    return HydrodynamicDatabase(
        bodies=bodies,
        omega=omega,
        headings=headings,
        added_mass=np.tile(A, (20, 1, 1)),
        damping=np.zeros((20, n, n)),
        added_mass_infinite=A,
        excitation=np.zeros((20, 19, n), dtype=np.complex128),
        reference_points=np.array([[150.0 * i, 0.0, 0.0] for i in range(len(bodies))]),
        density=RHO,
        gravity=G,
        depth=np.inf,
        source="test",
        symmetric=True,
    )


def rocking_spar(ratio: float, share: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Spin in axes of the body, its axis and the energy balance over 100 s, at 10 steps a second.

    Parameters
    ----------
    ratio
        Moment of inertia about the axis over that across it.
    share
        Of the displaced mass that moves with it, across the axis.
    """
    radius, length, draft, sides = 2.5, 100.0, 80.0, 32
    turn = 2.0 * np.pi * np.arange(sides) / sides
    rings = [
        np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(sides, z)])
        for z in (-draft, length - draft)
    ]
    points = np.vstack(rings)
    buoy = replace(surface(), points=points, triangles=outward_hull(points))
    mass = RHO * draft * 0.5 * sides * radius**2 * np.sin(2.0 * np.pi / sides)
    across = mass * length**2 / 12.0
    spar = barge(
        "spar",
        (0.0, 0.0, 0.0),
        (0.3, 0.0, 0.0),
        mass=mass,
        inertia=np.diag([across, across, ratio * across]),
        centre_of_mass=np.array([0.0, 0.0, -50.0]),
        angular_velocity=np.array([0.0, 0.03, 0.0]),
    )
    m, z = share * mass, -0.5 * draft
    A = np.zeros((6, 6))
    A[0, 0] = A[1, 1] = m
    A[0, 4] = A[4, 0] = m * z
    A[1, 3] = A[3, 1] = -m * z
    A[3, 3] = A[4, 4] = m * (z * z + draft**2 / 12.0)
    water = replace(constant((0.0,) * 6, ("spar",)), added_mass=np.tile(A, (20, 1, 1)), added_mass_infinite=A)
    made = scene(
        spar,
        hulls=(hull("spar", restoring=buoy),),
        radiation=(Radiation(bodies=("spar",), database=water, memory="none"),) if share else (),
    )
    _, history, _ = run(made, 0.1, 100.0, 1.0)
    q = history("spar.orientation")
    axis = Rotation.from_quat(q[:, [1, 2, 3, 0]]).as_matrix()[:, :, 2]
    return (
        history("spar.angular_velocity"),
        axis,
        history("energy.balance")[:, 0] / history("energy.kinetic").max(),
    )


class TestHullsAlone:
    """Hulls without waves and memory: one kind, whatever their restoring, tanks and added mass."""

    @pytest.mark.parametrize("ratio", [0.0, 5.0])
    @pytest.mark.parametrize("step", [0.05, 0.5])
    def test_heave_is_that_of_the_midpoint_rule_to_rounding(self, step: float, ratio: float) -> None:
        """Linear restoring, with added mass larger than the mass too: tan(omega' h / 2) = omega h / 2."""
        made = scene(
            barge(turn=(0.0, 0.0, 0.4)),
            hulls=(hull(restoring=linear()),),
            radiation=(Radiation(bodies=("barge",), database=constant((ratio,) * 6), memory="none"),)
            if ratio
            else (),
        )
        times, history, _ = run(made, step, 100.0, 0.5)
        omega = np.sqrt(RHO * G * AREA / ((1.0 + ratio) * MASS))
        shifted = 2.0 / step * np.arctan(0.5 * omega * step)
        z = history("barge.position")
        np.testing.assert_allclose(z[:, 2], 0.2 * np.cos(shifted * times), atol=1e-11)
        np.testing.assert_allclose(z[:, :2], 0.0, atol=1e-9)

    @pytest.mark.parametrize("database", [True, False])
    @pytest.mark.parametrize("roll", [0.3, 0.4])
    def test_what_tilts_beyond_its_database_is_told(self, roll: float, database: bool) -> None:
        """0.4 rad are 22.9 degrees; without a database nothing is wrong with that."""
        made = scene(
            barge(turn=(roll, 0.0, 0.0)),
            hulls=(hull(),),
            radiation=(Radiation(bodies=("barge",), database=constant((1.0,) * 6), memory="none"),)
            if database
            else (),
        )
        simulation = Simulation(made, 0.05)
        simulation.advance(20)
        told = "'barge' tilts by up to 22.9 deg" in simulation.warning
        assert told == (database and roll == 0.4)

    def test_roll_with_added_mass_larger_than_the_mass(self) -> None:
        """Period of small roll: heave's and sway's added mass at the water plane has a part in it, by the matrices."""
        ratios = (5.0, 3.0, 4.0, 5.0, 2.0, 1.0)
        made = scene(
            barge(place=(0.0, 0.0, 0.0), turn=(1e-4, 0.0, 0.0)),
            hulls=(hull(restoring=linear()),),
            radiation=(Radiation(bodies=("barge",), database=constant(ratios), memory="none"),),
        )
        h = 0.02
        times, history, _ = run(made, h, 60.0, 0.2)
        z = CENTRE[2]
        M = np.array([[4.0 * MASS, -MASS * z], [-MASS * z, 6.0 * INERTIA[0, 0] + MASS * z * z]])
        C = RHO * G * (LENGTH * BREADTH**3 / 12.0 - AREA * DRAFT * DRAFT / 2.0) - MASS * G * z
        # sway has no stiffness: it follows roll by its momentum, and both move as one
        omega = np.sqrt(C / (M[1, 1] - M[0, 1] ** 2 / M[0, 0]))
        omega = 2.0 / h * np.arctan(0.5 * omega * h)
        roll = 2.0 * history("barge.orientation")[:, 1]
        np.testing.assert_allclose(roll, 1e-4 * np.cos(omega * times), atol=1e-9)
        sway = -M[0, 1] / M[0, 0] * 1e-4 * (np.cos(omega * times) - 1.0)
        np.testing.assert_allclose(history("barge.position")[:, 1], sway, atol=2e-8)

    @pytest.mark.parametrize("damped", [False, True])
    @pytest.mark.parametrize("ratio", [0.0, 2.0])
    def test_second_order_in_every_coordinate(self, ratio: float, damped: bool) -> None:
        ratios = ratio * np.array([0.1, 0.7, 1.3, 0.9, 0.6, 0.4])
        made = scene(
            barge(turn=(0.1, 0.03, 0.2)),
            hulls=(hull(damping=DAMPING * damped, quadratic_damping=damped * np.full(6, 1e5)),),
            radiation=(Radiation(bodies=("barge",), database=constant(tuple(ratios)), memory="none"),),
        )
        found = [motion(run(made, h, 40.0, 0.4)[1]) for h in (0.1, 0.05, 0.025)]
        change = [np.abs(b - a).max(axis=0) for a, b in pairwise(found)]
        np.testing.assert_allclose(np.log2(change[0] / change[1]), 2.0, atol=0.3)

    @pytest.mark.parametrize("share", [0.0, 0.9])
    def test_a_spar_that_rocks_does_not_turn_about_its_axis(self, share: float) -> None:
        """An axisymmetric buoy of 100 m that goes round in a cone: slender as real ones, with added mass across it.

        Its spin about the axis stays zero, and its path is that of a thick one with the same moments across.
        """
        ends = {ratio: rocking_spar(ratio, share) for ratio in (0.2, 3e-3)}
        for spin, _, energy in ends.values():
            assert np.abs(spin[:, 2]).max() < 2e-4 * np.abs(spin[:, :2]).max()
            assert np.abs(energy - energy[0]).max() < 1e-4
        np.testing.assert_allclose(ends[3e-3][1], ends[0.2][1], atol=1e-4)

    def test_hull_under_water_and_in_air(self) -> None:
        """A constant force: parabolas, which the step follows to rounding."""
        bodies = (barge("sunk", (0.0, 0.0, -60.0), (0.0, 0.0, 0.3)), barge("dropped", (0.0, 90.0, 60.0)))
        times, history, _ = run(scene(*bodies), 0.05, 2.0, 0.1)
        lift = G * (HEIGHT / DRAFT - 1.0)
        np.testing.assert_allclose(history("sunk.position")[:, 2], -60.0 + 0.5 * lift * times**2, atol=1e-9)
        z = history("dropped.position")[:, 2]
        np.testing.assert_allclose(z, 60.0 - 0.5 * G * times**2, atol=1e-9)
        np.testing.assert_allclose(history("sunk.displaced_volume"), LENGTH * BREADTH * HEIGHT, rtol=1e-12)
        np.testing.assert_allclose(history("dropped.displaced_volume"), 0.0, atol=1e-12)

    def test_a_hull_that_falls_into_the_water_capsizes_and_keeps_its_energy(self) -> None:
        """Deck and bottom go in and out of the water flat and tilted: stiffness jumps."""
        bodies = (
            barge("low", (0.0, 0.0, 20.0), (0.4, 0.1, 0.0)),
            barge("over", (0.0, 90.0, 0.0), (2.0, 0.0, 0.0)),
        )
        balances = []
        for h in (0.02, 0.01):
            _, history, _ = run(scene(*bodies), h, 120.0, 0.2)
            balance = history("energy.balance")[:, 0]
            balances.append(np.abs(balance - balance[0]).max() / history("energy.kinetic").max())
            assert np.abs(history("low.position")[:, 2]).max() < 65.0
        assert balances[1] < 2e-3
        assert balances[1] < 0.6 * balances[0]

    def test_yaw_of_more_than_two_turns_is_followed(self) -> None:
        """Heading that the waves see: exact answer of the filter to a ramp, and not the angle within a turn."""
        spin, cut = 0.5, 0.3
        made = scene(
            barge(place=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0), angular_velocity=np.array([0.0, 0.0, spin])),
            hulls=(hull(low_pass=cut),),
        )
        times, history, simulation = run(made, 0.05, 40.0, 0.5)
        t = times[-1]
        lag = 2.0 * spin / cut
        expected = spin * t - lag + (lag + spin * t) * np.exp(-cut * t)
        heading = simulation._layout.bodies[0].state[0].low_pass[4]
        assert heading == pytest.approx(expected, abs=1e-4)
        assert heading > 4.0 * np.pi
        w, z = history("barge.orientation")[-1, [0, 3]]
        assert np.exp(2j * np.arctan2(z, w)) == pytest.approx(np.exp(1j * spin * t), abs=1e-9)

    def test_ballast_is_a_mass_on_the_hull(self) -> None:
        """Against a hull that has it in mass, centre and moments of inertia; the difference is of second order."""
        place = np.array([20.0, 5.0, 2.0])
        tank = Tank(name="T", hull="barge", point=place, times=np.zeros(1), masses=np.array([0.2 * MASS]))
        apart = []
        for h in (0.1, 0.05):
            one = motion(run(scene(barge()), h, 60.0, 0.2)[1])
            _, history, _ = run(scene(split(0.2, place, np.zeros((3, 3))), tanks=(tank,)), h, 60.0, 0.2)
            np.testing.assert_allclose(history("barge.ballast"), 0.2 * MASS)
            apart.append(np.abs(motion(history) - one).max(axis=0) / np.ptp(one, axis=0))
        assert apart[1].max() < 5e-3
        assert apart[1].max() < 0.35 * apart[0].max()

    def test_filling_sinks_the_hull_by_the_mass_over_the_water_plane(self) -> None:
        """And the energy that the water brings is booked."""
        tank = Tank(
            name="T", hull="barge", point=np.zeros(3), times=np.array([0.0, 300.0]), masses=np.array([0.0, 0.2 * MASS])
        )  # fmt: skip
        made = scene(barge(place=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0)), tanks=(tank,))
        times, history, _ = run(made, 0.05, 500.0, 0.5)
        z = history("barge.position")[:, 2]
        assert z[-1] == pytest.approx(-0.2 * DRAFT, abs=0.01)
        assert z[times > 310.0].mean() == pytest.approx(-0.2 * DRAFT, abs=1e-3)
        balance = history("energy.balance")
        assert np.ptp(balance) < 1e-4 * 0.2 * MASS * G * DRAFT

    def test_hull_with_ballast_starts_where_it_rests(self) -> None:
        tank = Tank(
            name="T", hull="barge", point=np.array([0.0, 3.0, 0.0]), times=np.zeros(1), masses=np.array([0.05 * MASS])
        )  # fmt: skip
        _, history, _ = run(scene(barge(), tanks=(tank,)), 0.05, 5.0, 0.5, start="equilibrium")
        assert np.ptp(history("barge.position"), axis=0).max() < 1e-6
        list_ = Rotation.from_quat(history("barge.orientation")[0][[1, 2, 3, 0]]).as_matrix()[2, 1]
        T, total, arm = 1.05 * DRAFT, 1.05 * MASS, 0.05 / 1.05 * 3.0
        KG = ((DRAFT + CENTRE[2]) + 0.05 * DRAFT) / 1.05
        GM, BM = T / 2.0 + BREADTH**2 / (12.0 * T) - KG, BREADTH**2 / (12.0 * T)
        # wall-sided: GM tan + BM/2 tan^3 = arm to port
        tangent = brentq(lambda x: GM * x + 0.5 * BM * x**3 - arm, 0.0, 0.2)
        assert abs(list_) == pytest.approx(np.sin(np.arctan(tangent)), rel=1e-6)
        assert total == pytest.approx(RHO * float(history("barge.displaced_volume")[0, 0]), rel=1e-9)

    def test_two_hulls_in_one_database_without_interaction_are_two(self) -> None:
        """Added mass of twelve coordinates, block by block: to rounding."""
        bodies = (barge("a", turn=(0.03, 0.01, 0.0)), barge("b", (150.0, 0.0, 0.2), (0.02, -0.01, -0.05)))
        ratios = (0.1, 0.6, 1.2, 0.8, 0.5, 0.3)
        separate = tuple(Radiation(bodies=(n,), database=constant(ratios, (n,)), memory="none") for n in "ab")
        together = (Radiation(bodies=("a", "b"), database=constant(ratios, ("a", "b")), memory="none"),)
        one, two = (run(scene(*bodies, radiation=r), 0.05, 60.0, 0.2)[1] for r in (separate, together))
        for name in "ab":
            np.testing.assert_allclose(motion(one, name), motion(two, name), atol=1e-9)

    def test_goes_on_bit_for_bit(self) -> None:
        check_restart(scene(barge()))

    @pytest.mark.parametrize("water", [{"density": 1000.0}, {"level": 0.5}])
    def test_a_state_of_other_water_is_refused(self, water: dict[str, float]) -> None:
        state = Simulation(scene(barge()), 0.05).state()
        other = scene(barge())
        changed = replace(other, sea=replace(other.sea, water=replace(WATER, **water)))
        with pytest.raises(InputError, match="digest"):
            Simulation(changed, 0.05).restore(state)


def check_restart(made: Scene) -> None:
    """A state that is taken and given to another simulation."""
    one = Simulation(made, 0.05, record_every=2)
    one.advance(200)
    state = one.state()
    first = one.advance(200)[1]
    other = Simulation(made, 0.05, record_every=2)
    other.restore(state)
    np.testing.assert_array_equal(other.advance(200)[1], first)


def in_waves(*bodies: RigidBody, **sea) -> Scene:
    """One hull in waves that remembers its own."""
    given = {
        "hulls": (hull(damping=DAMPING),),
        "radiation": (Radiation(bodies=("barge",), database=database(), fit_error=5e-3),),
        "waves": WAVES,
        "ramp": 10.0,
    } | sea
    return scene(*(bodies or (barge(),)), **given)


class TestMemoryAndWaves:
    def test_second_order_in_every_coordinate(self) -> None:
        found = [motion(run(in_waves(), h, 40.0, 0.4)[1]) for h in (0.1, 0.05, 0.025)]
        change = [np.abs(b - a).max(axis=0) for a, b in pairwise(found)]
        np.testing.assert_allclose(np.log2(change[0] / change[1]), 2.0, atol=0.3)

    def test_energy_with_waves_and_memory(self) -> None:
        """Work of the waves less what the hull radiates; of the largest kinetic energy, and of second order.

        With a heading that stands: where it turns, the energy of water that surge and sway move differently does too.
        """
        off = []
        for h in (0.1, 0.05):
            made = in_waves(hulls=(hull(damping=DAMPING, low_pass=1e-9),))
            _, history, _ = run(made, h, 120.0, 0.2)
            off.append(np.ptp(history("energy.balance")) / history("energy.kinetic").max())
        assert off[1] < 2e-3
        assert off[1] < 0.35 * off[0]

    @pytest.mark.parametrize(("height", "kind"), [(4.0, "clipped"), (12.0, "linear")])
    def test_long_steps_are_stable(self, height: float, kind: str) -> None:
        """Half a second for twenty minutes: heave as with a fifth of the step."""
        restoring = linear() if kind == "linear" else None
        found = []
        for h in (0.5, 0.1):
            made = in_waves(
                waves=regular_wave(height, 9.0, np.deg2rad(30.0), gravity=G),
                hulls=(hull(restoring=restoring, damping=DAMPING),),
            )
            times, history, _ = run(made, h, 1200.0, 0.5)
            late = times > 1000.0
            q = history("barge.orientation")[late]
            up = 1.0 - 2.0 * (q[:, 1] ** 2 + q[:, 2] ** 2)
            found.append((np.abs(history("barge.position")[late, 2]).max(), up.mean()))
        assert found[0][0] == pytest.approx(found[1][0], rel=0.05)
        assert min(up for _, up in found) > 0.5

    def test_goes_on_bit_for_bit(self) -> None:
        check_restart(in_waves())

    def test_block_that_is_welded_on_is_mass_of_the_hull(self) -> None:
        """A joint between a hull with memory and a rigid body; with a step of half the length a quarter remains."""
        place, inertia = np.array([20.0, 5.0, 6.0]), np.diag([1e8, 1e8, 1e8])
        rest = split(0.2, place, inertia)
        turn = Rotation.from_rotvec([0.03, 0.01, 0.2]).as_matrix()
        block = RigidBody(
            "block",
            0.2 * MASS,
            inertia,
            position=np.array([0.0, 0.0, 0.2]) + turn @ place,
            orientation=rest.orientation,
        )
        weld = FixedJoint(
            name="weld", body_a="barge", body_b="block", frame_a=JointFrame(place), frame_b=JointFrame(np.zeros(3))
        )  # fmt: skip
        jointed = in_waves(rest, block, joints=(weld,))
        apart = []
        for h in (0.1, 0.05):
            one, two = motion(run(in_waves(), h, 60.0, 0.2)[1]), motion(run(jointed, h, 60.0, 0.2)[1])
            apart.append(np.abs(two - one).max(axis=0) / np.ptp(one, axis=0))
        assert apart[1].max() < 5e-3
        assert apart[1].max() < 0.35 * apart[0].max()
        check_restart(jointed)


def doubled(away: float) -> HydrodynamicDatabase:
    """Two barges on the x axis that do not feel each other."""
    one = database()

    def blocks(X: np.ndarray) -> np.ndarray:
        out = np.zeros((len(X), 12, 12))
        out[:, :6, :6] = out[:, 6:, 6:] = X
        return out

    phase = np.exp(1j * one.wave_numbers()[:, None, None] * np.cos(one.headings)[None, :, None] * away)
    return replace(
        one,
        bodies=("a", "b"),
        added_mass=blocks(one.added_mass),
        damping=blocks(one.damping),
        added_mass_infinite=blocks(one.added_mass_infinite[None])[0],
        excitation=np.concatenate([one.excitation, one.excitation * phase], axis=2),
        reference_points=np.array([[0.0, 0.0, 0.0], [away, 0.0, 0.0]]),
        drift=None,
        volumes=None,
        centres_of_buoyancy=None,
        hydrostatic_stiffness=None,
    )


def test_two_hulls_in_one_database_with_memory_and_waves() -> None:
    """As two with databases of their own: their kernels are fitted one by one there."""
    bodies = (barge("a", turn=(0.03, 0.01, 0.0)), barge("b", (150.0, 0.0, 0.2), (0.02, -0.01, 0.0)))
    hulls = tuple(hull(name, damping=DAMPING) for name in "ab")
    separate = tuple(
        Radiation(bodies=(n,), database=replace(database(), bodies=(n,)), fit_error=5e-3) for n in "ab"
    )
    together = (Radiation(bodies=("a", "b"), database=doubled(150.0), fit_error=5e-3),)
    one, two = (
        run(scene(*bodies, hulls=hulls, radiation=r, waves=WAVES, ramp=10.0), 0.05, 60.0, 0.2)[1]
        for r in (separate, together)
    )
    for name in "ab":
        np.testing.assert_allclose(one(f"{name}.wave_force"), two(f"{name}.wave_force"),
                                   atol=1e-6 * np.abs(one(f"{name}.wave_force")).max())  # fmt: skip
        x, y = motion(one, name), motion(two, name)
        assert np.abs(y - x).max(axis=0)[:3].max() < 1e-4 * np.ptp(x[:, :3])


class TestLines:
    """A barge on four lines."""

    LENGTH_OF_LINE, SUBMERGED, STIFFNESS = float(np.hypot(62.0, 42.0) * 1.002), 1000.0, 5e8

    def moored(self, **values) -> Scene:
        lines = tuple(
            MooringLine(
                name=f"line{i}",
                body_a=GROUND,
                point_a=np.array([x * 110.0, y * 60.0, 2.0]),
                body_b="barge",
                point_b=np.array([x * 48.0, y * 18.0, 1.5]),
                sections=(LineSection(self.LENGTH_OF_LINE, self.SUBMERGED, self.STIFFNESS),),
            )
            for i, (x, y) in enumerate([(1, 1), (1, -1), (-1, 1), (-1, -1)])
        )
        given = {"place": (0.2, 0.0, 0.1), "turn": (0.0, 0.0, 0.0)} | values
        return in_waves(barge(**given), lines=lines)

    def pull(self, across: float, up: float) -> tuple[float, float]:
        """Horizontal and vertical force at the upper end of an elastic catenary that hangs free [N]."""
        L, w, EA = self.LENGTH_OF_LINE, self.SUBMERGED, self.STIFFNESS

        def gap(force: np.ndarray) -> np.ndarray:
            H, V = 1e5 * force
            low = V - w * L
            return np.array(
                [
                    H / w * (np.arcsinh(V / H) - np.arcsinh(low / H)) + H * L / EA - across,
                    (np.hypot(H, V) - np.hypot(H, low)) / w + (V * L - 0.5 * w * L * L) / EA - up,
                ]
            )

        found = fsolve(gap, [3.0, 5e-6 * w * L], xtol=1e-12, full_output=True)[0]
        np.testing.assert_allclose(gap(found), 0.0, atol=1e-10)
        return float(1e5 * found[0]), float(1e5 * found[1])

    def test_equilibrium(self) -> None:
        """By symmetry in the middle, and sunk by the vertical forces of the lines over the water plane."""
        made = self.moored()
        made = replace(made, sea=replace(made.sea, ramp=1000.0))
        _, history, _ = run(made, 0.05, 0.5, 0.1, start="equilibrium")
        z = history("barge.position")[0]
        assert np.abs(z[:2]).max() < 1e-6

        def lift(height: float) -> float:
            return RHO * G * AREA * -height - 4.0 * self.pull(np.hypot(62.0, 42.0), height - 0.5)[1]

        assert z[2] == pytest.approx(brentq(lift, -0.2, 0.2), abs=1e-8)
        H, V = self.pull(np.hypot(62.0, 42.0), float(z[2]) - 0.5)
        assert history("line0.tension")[0].max() == pytest.approx(np.hypot(H, V), rel=1e-5)

    def test_long_steps_converge_and_are_stable(self) -> None:
        found = {h: run(self.moored(), h, 120.0, 0.5)[1] for h in (0.5, 0.1, 0.05, 0.025)}
        x = {h: motion(history)[:, :3] for h, history in found.items()}
        spread = np.ptp(x[0.025], axis=0)
        assert (np.abs(x[0.5] - x[0.025]).max(axis=0) < 0.5 * spread).all()
        first, second = (np.abs(x[a] - x[b]).max() for a, b in ((0.1, 0.05), (0.05, 0.025)))
        assert np.log2(first / second) == pytest.approx(2.0, abs=0.5)

    def test_goes_on_bit_for_bit(self) -> None:
        check_restart(self.moored())
