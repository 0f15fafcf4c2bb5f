"""Floating positions and righting arms against closed forms of the box, and an independent clip of its section."""

import math

import numpy as np
import pytest
from hull_shapes import outward_hull
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.spatial import ConvexHull

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.hull_surface import check_hull
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.water.hulls.hydrostatics import (
    FloatingHull,
    Pose,
    Tank,
    equilibrium,
    righting_arm_curve,
    settle,
)

L, B, D, T = 97.5, 36.0, 6.0, 4.5
RHO, G = 1025.0, 9.81
MASS = RHO * L * B * T
BM, BM_L = B * B / (12.0 * T), L * L / (12.0 * T)
LEVER = 0.5 * D - 0.5 * T  # centre of gravity of the origin above the centre of buoyancy


@pytest.fixture(scope="module")
def barge():
    return check_hull(box_surface((L, B, D), name="barge"))


@pytest.fixture(scope="module")
def open_barge():
    box = box_surface((L, B, D), name="barge")
    top = (box.points[box.triangles][:, :, 2] > 0.0).all(axis=1)
    return check_hull(TriangleSurface(box.points, box.triangles[~top], name="barge"), open_deck=0.5 * D)


def wedge():
    """Hull without symmetry fore and aft: a box whose bow is narrower and cut off below."""
    box = box_surface((60.0, 14.0, 8.0), name="wedge")
    points = box.points.copy()
    bow = points[:, 0] > 0.0
    points[bow, 1] *= 0.3
    points[bow & (points[:, 2] < 0.0), 0] -= 12.0
    return check_hull(TriangleSurface(points, box.triangles, name="wedge"))


def test_upright_box(barge):
    position = equilibrium(barge, MASS, (0.0, 0.0, 0.0), density=RHO, gravity=G, level=2.0)
    assert position.pose == pytest.approx(Pose(0.5 * D - T, 0.0, 0.0), abs=1e-12)
    assert position.level + position.pose.height == pytest.approx(0.5, abs=1e-12)
    assert position.mass == pytest.approx(MASS)
    assert position.volume == pytest.approx(L * B * T, rel=1e-13)
    assert [position.draft, position.draft_aft, position.draft_forward] == pytest.approx([T, T, T])
    heights = [position.KB, position.KG, position.BM_T, position.BM_L, position.GM_T, position.GM_L]
    assert heights == pytest.approx([0.5 * T, 0.5 * D, BM, BM_L, BM - LEVER, BM_L - LEVER])
    assert position.GM_T_upright == pytest.approx(BM - LEVER)
    assert [position.LCB, position.LCF, position.trim_by_bow] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert position.waterplane_area == pytest.approx(L * B)
    assert position.mass_per_immersion == pytest.approx(RHO * L * B)
    assert position.moment_to_trim == pytest.approx(MASS * (BM_L - LEVER) / L)
    assert position.wetted_area == pytest.approx(L * B + 2.0 * (L + B) * T)
    assert position.freeboard == math.inf


@pytest.mark.parametrize(("offset", "rise"), [(0.4, 0.0), (-0.7, 2.0), (1.2, -1.0)])
def test_list_of_a_wall_sided_box(barge, offset, rise):
    """A mass off the centre plane by y: ``tan(phi) (GM + BM/2 tan(phi)^2) = y``, to the side of the mass."""
    position = equilibrium(barge, MASS, (0.0, offset, rise), density=RHO, gravity=G)
    t = math.tan(-position.pose.list)
    assert t * (BM - LEVER - rise + 0.5 * BM * t * t) == pytest.approx(offset, rel=1e-10)
    assert position.pose.trim == pytest.approx(0.0, abs=1e-12)
    # the height of the water on the centre line does not change, and is measured along z of the body
    assert position.draft == pytest.approx(T, rel=1e-12)


def test_trim_of_a_wall_sided_box(barge):
    position = equilibrium(barge, MASS, (1.5, 0.0, 0.0), density=RHO, gravity=G, marks=(-40.0, 40.0))
    t = math.tan(position.pose.trim)
    assert t * (BM_L - LEVER + 0.5 * BM_L * t * t) == pytest.approx(1.5, rel=1e-10)
    assert position.pose.list == pytest.approx(0.0, abs=1e-12)
    assert position.trim_by_bow == pytest.approx(80.0 * t)
    assert position.draft_aft == pytest.approx(T - 40.0 * t)


def test_list_with_trim(barge):
    """A position of the table of box hydrostatics, the centre of gravity above that of buoyancy."""
    roll, pitch = math.radians(10.0), math.radians(2.0)
    pose = Pose(-2.5, roll, pitch)
    volume, buoyancy = 17133.951863, np.array([3.265298, -2.229829, -3.384331 + 2.5])
    centre = pose.rotation.T @ (buoyancy + np.array([0.0, 0.0, 1.0]))
    position = equilibrium(barge, RHO * volume, centre, density=RHO, gravity=G)
    assert position.pose == pytest.approx(pose, abs=1e-6)


@pytest.mark.parametrize("GM", [-0.05, -0.2])
def test_angle_of_loll(GM):
    """``tan(phi) = sqrt(-2 GM / BM)``; there ``GM_T = -2 GM / cos(phi)`` by the slope of the righting arm."""
    length, breadth, depth, draft = 40.0, 10.0, 10.0, 5.0
    hull = check_hull(box_surface((length, breadth, depth)))
    radius = breadth**2 / (12.0 * draft)
    rise = radius - 0.5 * draft - GM  # above the middle of the box: KB = 2.5 m, KG = 5 m + rise
    position = equilibrium(hull, RHO * length * breadth * draft, (0.0, 0.0, rise), density=RHO, gravity=G)
    assert position.GM_T_upright == pytest.approx(GM)
    assert position.pose.list == pytest.approx(math.atan(math.sqrt(-2.0 * GM / radius)), abs=1e-9)
    assert math.isclose(position.GM_T, -2.0 * GM / math.cos(position.pose.list), rel_tol=1e-9)


def test_tanks_are_masses_with_a_free_surface(barge):
    tank = Tank(2e5, (10.0, 3.0, -1.0), (RHO * 20.0 * 8.0**3 / 12.0, RHO * 8.0 * 20.0**3 / 12.0))
    still = Tank(2e5, (10.0, 3.0, -1.0))
    mass = MASS - 2e5
    with_surface = equilibrium(barge, mass, (0.0, 0.0, 1.0), density=RHO, gravity=G, tanks=[tank])
    solid = equilibrium(barge, mass, (0.0, 0.0, 1.0), density=RHO, gravity=G, tanks=[still])
    assert with_surface.mass == pytest.approx(MASS)
    assert with_surface.centre_of_gravity == pytest.approx(
        (mass * np.array([0.0, 0.0, 1.0]) + 2e5 * np.array([10.0, 3.0, -1.0])) / MASS
    )
    loss = np.array(tank.free_surface) / MASS
    assert [with_surface.GM_T_loss, with_surface.GM_L_loss] == pytest.approx(
        list(loss), rel=1e-5
    )  # cosines of list and trim
    # symmetric free surface: as if the centre of gravity were higher
    same = Tank(0.0, (0.0, 0.0, 0.0), (MASS * 0.5, MASS * 0.5))
    raised = equilibrium(barge, MASS, (0.0, 0.6, 1.5), density=RHO, gravity=G)
    free = equilibrium(barge, MASS, (0.0, 0.6, 1.0), density=RHO, gravity=G, tanks=[same])
    assert free.pose == pytest.approx(raised.pose, abs=1e-10)
    assert math.isclose(free.GM_T, raised.GM_T, rel_tol=1e-9)
    assert abs(with_surface.pose.list) > abs(solid.pose.list)


def section_arm(angle, rise):
    """GZ [m] of the box at a heel, by clipping its section alone."""
    half = np.array([[-0.5 * B, -0.5 * D], [0.5 * B, -0.5 * D], [0.5 * B, 0.5 * D], [-0.5 * B, 0.5 * D]])
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    corners = half @ turn.T

    def wet(height):
        polygon = []
        for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            a, b = p[1] + height, q[1] + height
            if a < 0.0:
                polygon.append(p)
            if (a < 0.0) != (b < 0.0):
                polygon.append(p + a / (a - b) * (q - p))
        if len(polygon) < 3:
            return 0.0, 0.0
        p = np.array(polygon)
        q = np.roll(p, -1, axis=0)
        cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
        return 0.5 * cross.sum(), float(cross @ (p[:, 0] + q[:, 0])) / 6.0

    height = brentq(lambda h: wet(h)[0] - B * T, -B, B, xtol=1e-14)
    area, moment = wet(height)
    return -(moment / area - rise * turn[0, 1])


def test_righting_arm_of_the_wall_sided_box(barge):
    """``GZ = sin(phi) (GM + BM/2 tan(phi)^2)`` until the deck is in the water, at ``tan(phi) = 2 (D - T) / B``."""
    angles = np.linspace(0.0, math.atan(2.0 * (D - T) / B), 9)
    curve = righting_arm_curve(barge, MASS, (0.0, 0.0, 1.0), angles, density=RHO, gravity=G)
    GM = BM - LEVER - 1.0

    def arm(phi):
        return np.sin(phi) * (GM + 0.5 * BM * np.tan(phi) ** 2)

    assert curve.arms == pytest.approx(arm(angles), abs=1e-10)
    areas = [quad(arm, 0.0, angle, epsabs=1e-14)[0] for angle in angles]
    assert curve.work == pytest.approx(areas, abs=1e-12)
    assert curve.trims == pytest.approx(np.zeros(9), abs=1e-12)
    assert curve.equilibrium == 0.0


@pytest.mark.slow
def test_righting_arm_beyond_the_deck_edge(barge):
    angles = np.radians(np.arange(-80.0, 81.0, 4.0))
    rise = 2.0
    curve = righting_arm_curve(barge, MASS, (0.0, 0.0, rise), angles, density=RHO, gravity=G)
    assert curve.arms == pytest.approx([section_arm(angle, rise) for angle in angles], abs=1e-9)
    vanishing = brentq(lambda angle: section_arm(angle, rise), 0.5, 1.4, xtol=1e-13)
    assert curve.equilibrium == pytest.approx(0.0, abs=1e-9)
    assert curve.vanishing == pytest.approx(vanishing, abs=1e-9)
    assert curve.range == pytest.approx(vanishing, abs=1e-9)
    tops = np.linspace(0.2, 0.5, 3001)
    arms = [section_arm(angle, rise) for angle in tops]
    assert curve.largest_arm == pytest.approx(max(arms), abs=1e-6)
    assert curve.largest_angle == pytest.approx(tops[int(np.argmax(arms))], abs=1e-3)
    area = quad(lambda angle: section_arm(angle, rise), 0.0, vanishing, points=[0.083], epsabs=1e-5)[0]
    assert curve.work.max() == pytest.approx(area, rel=2e-3)  # 4 degrees apart, the last below the top
    assert np.interp(-1.0, angles, curve.work) == pytest.approx(np.interp(1.0, angles, curve.work), rel=1e-9)


def test_righting_arm_with_free_surface(barge):
    angles = np.radians(np.arange(0.0, 60.0, 5.0))
    tank = Tank(0.0, (0.0, 0.0, 0.0), (0.8 * MASS, 3.0 * MASS))
    plain = righting_arm_curve(barge, MASS, (0.0, 0.0, 1.0), angles, density=RHO, gravity=G)
    free = righting_arm_curve(barge, MASS, (0.0, 0.0, 1.0), angles, density=RHO, gravity=G, tanks=[tank])
    assert free.arms == pytest.approx(plain.arms - 0.8 * np.sin(angles), abs=1e-9)


def test_work_is_the_area_with_free_trim():
    """A hull without symmetry: derivative of the potential against the moment, and no trimming moment left."""
    hull = wedge()
    mass, centre = 0.5 * RHO * hull.volume, (-6.0, 0.3, -1.0)
    angles = np.linspace(-0.6, 1.0, 161)
    curve = righting_arm_curve(hull, mass, centre, angles, density=RHO, gravity=G)
    assert np.ptp(curve.trims) > 0.01
    slope = (curve.work[2:] - curve.work[:-2]) / (angles[2:] - angles[:-2])
    expected = curve.arms * np.cos(curve.trims)
    assert np.abs(slope - expected[1:-1]).max() < 3e-4 * np.abs(expected).max()  # 0.01 rad, GZ has kinks
    floating = FloatingHull(hull, mass, centre, RHO, G)
    for n in (0, 80, 160):
        _, force = floating.evaluate(Pose(curve.heights[n], angles[n], curve.trims[n]))
        assert force[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-8 * mass * G)
    position = equilibrium(hull, mass, centre, density=RHO, gravity=G)
    assert curve.equilibrium == pytest.approx(position.pose.list, abs=1e-8)


def test_heel_to_the_other_side(barge):
    angles = np.radians(np.arange(0.0, 50.0, 5.0))
    centre = (0.0, 0.5, 1.0)
    other = righting_arm_curve(barge, MASS, centre, angles, density=RHO, gravity=G, side=-1)
    mirrored = righting_arm_curve(barge, MASS, (0.0, -0.5, 1.0), angles, density=RHO, gravity=G)
    assert other.arms == pytest.approx(mirrored.arms, abs=1e-10)
    position = equilibrium(barge, MASS, centre, density=RHO, gravity=G)
    assert other.equilibrium == pytest.approx(-position.pose.list, abs=1e-9)


def test_open_deck(barge, open_barge):
    """An opening changes nothing while it is dry; the deck edge comes to the water at ``tan(phi) = 2 (D - T) / B``."""
    angles = np.radians([0.0, 2.0, 4.0, 6.0, 8.0])
    whole = righting_arm_curve(barge, MASS, (0.0, 0.0, 1.0), angles, density=RHO, gravity=G)
    curve = righting_arm_curve(open_barge, MASS, (0.0, 0.0, 1.0), angles, density=RHO, gravity=G)
    edge = math.atan(2.0 * (D - T) / B)
    assert curve.flooding == pytest.approx(edge, abs=1e-9)
    assert curve.range == pytest.approx(edge, abs=1e-9)
    assert curve.largest_angle == pytest.approx(edge, abs=1e-4)
    assert curve.arms[:3] == pytest.approx(whole.arms[:3], abs=1e-12)
    assert np.isnan(curve.arms[3:]).all()
    position = equilibrium(open_barge, MASS, (0.0, 0.0, 1.0), density=RHO, gravity=G)
    assert position.freeboard == pytest.approx(D - T)


def test_positions_that_do_not_exist(barge, open_barge):
    def message(hull, mass, centre, **options):
        with pytest.raises(InputError) as caught:
            equilibrium(hull, mass, centre, density=RHO, gravity=G, **options)
        return str(caught.value)

    assert "barge: mass: sinks" in message(barge, 1.01 * RHO * L * B * D, (0.0, 0.0, 0.0))
    assert "submerged to its open deck at z = 3 m" in message(
        open_barge, 1.01 * RHO * L * B * D, (0.0, 0.0, 0.0)
    )
    assert "barge: centre_of_gravity: capsizes" in message(barge, MASS, (0.0, 0.0, 60.0))
    assert "capsizes" in message(barge, MASS, (0.0, 17.0, 3.0))
    assert "floods" in message(open_barge, MASS, (0.0, 2.5, 0.0))
    assert "expected a positive number in kg" in message(barge, -1.0, (0.0, 0.0, 0.0))
    assert "three coordinates" in message(barge, MASS, (0.0, math.nan, 0.0))
    assert "level" in message(barge, MASS, (0.0, 0.0, 0.0), level=math.inf)
    assert "marks" in message(barge, MASS, (0.0, 0.0, 0.0), marks=(1.0, -1.0))
    with pytest.raises(InputError, match="free_surface"):
        Tank(1.0, (0.0, 0.0, 0.0), (-1.0, 0.0))
    with pytest.raises(InputError, match="angles"):
        righting_arm_curve(barge, MASS, (0.0, 0.0, 0.0), [0.2, 0.1])


def test_settles_from_far_away(barge):
    """From large list and trim, and from above the water, to the one position of a stable box."""
    floating = FloatingHull(barge, MASS, (0.8, 0.5, 0.0), RHO, G)
    near = equilibrium(barge, MASS, (0.8, 0.5, 0.0), density=RHO, gravity=G).pose
    for start in (Pose(-1.5, 0.6, 0.0), Pose(-8.0, -0.4, 0.3), Pose(3.5, 0.1, -0.2), Pose(-1.5, 1.2, 0.5)):
        assert settle(floating, start) == pytest.approx(near, abs=1e-9)


def test_random_hulls_float_or_capsize():
    """Without symmetry: forces in balance and a positive stiffness, or a stop with the reason."""
    rng = np.random.default_rng(3)
    afloat = capsized = 0
    for _ in range(60):
        points = rng.normal(size=(int(rng.integers(5, 25)), 3)) * [30.0, 8.0, 4.0]
        points = points[np.unique(ConvexHull(points).simplices)]
        hull = check_hull(TriangleSurface(points, outward_hull(points), name="cloud"))
        centre = points.mean(axis=0) + rng.uniform(-0.2, 0.2, 3) * np.ptp(points, axis=0)
        mass = RHO * hull.volume * rng.uniform(0.1, 0.95)
        floating = FloatingHull(hull, mass, centre, RHO, G)
        try:
            position = equilibrium(hull, mass, centre, density=RHO, gravity=G)
        except InputError as error:
            if "capsizes" not in str(error):
                raise
            capsized += 1
            continue
        afloat += 1
        _, force = floating.evaluate(position.pose)
        assert np.abs(force / [1.0, floating.size, floating.size]).max() < 1e-9 * mass * G
        stiffness = floating.stiffness(position.pose)
        assert np.linalg.eigvalsh(0.5 * (stiffness + stiffness.T))[0] > 0.0
        apart = position.pose.rotation @ (position.centre_of_buoyancy - position.centre_of_gravity)
        assert apart[:2] == pytest.approx([0.0, 0.0], abs=1e-8 * floating.size)
    assert afloat > 20
    assert capsized > 5
