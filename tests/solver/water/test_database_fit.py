"""Databases against the hulls and the water of a scene: closed forms of a box, right ones and wrong ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.preprocess.surfaces.triangle_surface import placed
from heavylift.solver.layout_sea import floating_hulls
from heavylift.solver.scenario.actions.tank import TankRate
from heavylift.solver.scene.scenario import Phase, Scenario
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Radiation, RestoringOfSurface, Sea, Tank, Water
from heavylift.solver.water.hulls.database_fit import check_databases, weight_words

L, B, T, RHO, G = 60.0, 20.0, 4.0, 1025.0, 9.81
AHEAD = np.array([3.0, 0.0, 0.0])  # of the middle of the hull from the origin of its frame
NUMBERS = ("volumes", "centres_of_buoyancy", "hydrostatic_stiffness")


def box_database(
    point=(0.0, 0.0, 0.0), *, length=L, breadth=B, draught=T, **changes: Any
) -> HydrodynamicDatabase:
    """Of a box whose middle is `AHEAD` of the origin, with moments about a point; no waves.

    Its added mass of heave acts under its middle: A35 = - x A33, A34 = y A33.
    """
    x, y, _ = AHEAD - np.array(point)
    z_ref = point[2]
    area, volume = length * breadth, length * breadth * draught
    arm = volume * (-0.5 * draught - z_ref)
    C = np.zeros((6, 6))
    C[2, 2] = area
    C[2, 3] = C[3, 2] = y * area
    C[2, 4] = C[4, 2] = -x * area
    C[3, 3] = length * breadth**3 / 12.0 + area * y * y + arm
    C[4, 4] = breadth * length**3 / 12.0 + area * x * x + arm
    C[3, 4] = C[4, 3] = -x * y * area
    heave = RHO * volume
    A = np.diag([0.1, 0.5, 1.0, breadth**2 / 16.0, length**2 / 16.0, length**2 / 20.0]) * heave
    A[2, 3] = A[3, 2] = y * heave
    A[2, 4] = A[4, 2] = -x * heave
    A[3, 3] += y * y * heave
    A[4, 4] += x * x * heave
    given: dict[str, Any] = {
        "bodies": ("hull",),
        "omega": np.array([0.3, 0.6, 0.9]),
        "headings": np.zeros(0),
        "added_mass": np.array([A, A, A]),
        "damping": np.zeros((3, 6, 6)),
        "added_mass_infinite": A,
        "excitation": np.zeros((3, 0, 6), dtype=np.complex128),
        "reference_points": np.array([point], dtype=float),
        "density": RHO,
        "gravity": G,
        "depth": np.inf,
        "source": "box.nc",
        "volumes": np.array([volume]),
        "centres_of_buoyancy": (AHEAD - [0.0, 0.0, 0.5 * draught])[None],
        "hydrostatic_stiffness": RHO * G * C[None],
    }
    return HydrodynamicDatabase(**{**given, **changes})


def hull_surface(length=L, breadth=B, sunk=T, middle=AHEAD):
    """A box of 8 m whose bottom is so far below the origin of its frame."""
    return placed(box_surface((length, breadth, 8.0)), position=np.add(middle, [0.0, 0.0, 4.0 - sunk]))


def scene(database, restoring=None, *, reference=(0.0, 0.0, 0.0), tanks=(), **water) -> Scene:
    body = RigidBody(
        name="hull",
        mass=RHO * L * B * T,
        inertia=np.diag([1e8, 1e9, 1e9]),
        centre_of_mass=np.array([3.0, 0.0, 1.0]),
        position=np.zeros(3),
    )
    hull = Hull(
        body="hull",
        restoring=hull_surface() if restoring is None else restoring,
        reference=np.array(reference, dtype=float),
    )
    sea = Sea(
        water=Water(**{"density": RHO, "gravity": G, **water}),
        hulls=(hull,),
        radiation=(Radiation(bodies=("hull",), database=database),),
        tanks=tuple(tanks),
    )
    return Scene((body,), (Gravity(np.array([0.0, 0.0, -sea.water.gravity])),), sea=sea)


def notes_of(made: Scene) -> list[str]:
    assert made.sea is not None
    return check_databases(floating_hulls(made), made.sea)


def error_of(made: Scene) -> str:
    with pytest.raises(InputError) as caught:
        notes_of(made)
    return str(caught.value)


without = dict.fromkeys(NUMBERS)


@pytest.mark.parametrize("point", [(0, 0, 0), (3, 0, 0), (0, 0, -2), (-7, 1, 1.5)])
@pytest.mark.parametrize("left_out", [(), NUMBERS, NUMBERS[:2], NUMBERS[1:], NUMBERS[2:]])
def test_the_right_one_is_accepted_about_any_point_and_whatever_it_states(point, left_out) -> None:
    database = box_database(point, **dict.fromkeys(left_out))
    assert notes_of(scene(database, reference=point)) == []
    linear = {
        "volume": L * B * (T - 1.0),  # about a float plane 1 m below that of the database
        "centre_of_buoyancy": np.array([3.0, 0.0, -0.5 * (T + 1.0)]),
        "reference": np.array([0.0, 0.0, -1.0]),
        "area": L * B,
        "first_moments": (3.0 * L * B, 0.0),
        "second_moments": (B * L**3 / 12.0 + 9.0 * L * B, L * B**3 / 12.0, 0.0),
    }
    for kind in (LinearRestoring, RestoringOfSurface):
        assert notes_of(scene(database, kind(**linear), reference=point)) == []


WATERS = {
    "density": {"density": 1000.0},
    "gravity": {"gravity": 9.7},
    "depth": {"depth": 30.0},
}


@pytest.mark.parametrize("key", WATERS)
def test_another_water_is_refused(key) -> None:
    assert "expected those of the sea" in error_of(scene(box_database(), **WATERS[key]))


def turned_hull():
    return hull_surface(B, L)


WRONG = {
    "turned": (box_database(), turned_hull(), (0, 0, 0), "turned by 90 degrees"),
    "turned_as_files_have_it": (
        box_database(volumes=None, centres_of_buoyancy=None),
        turned_hull(),
        (0, 0, 0),
        "that differ by",
    ),
    "turned_without_numbers": (box_database(**without), turned_hull(), (0, 0, 0), "turned by 90 degrees"),
    "reference_aside": (box_database(), None, (0, 5, 0), "its centre of buoyancy at y = -5 m"),
    "reference_aside_without_numbers": (
        box_database(**without),
        None,
        (0, 5, 0),
        "the centre of its water plane at y = -5 m",
    ),
    "reference_ahead": (box_database(), None, (8, 0, 0), "its centre of buoyancy at x = -5 m"),
    "reference_above": (box_database(), None, (0, 0, 1.5), "a displaced volume of 6600 m3"),
    "reference_above_the_hull": (box_database(**without), None, (0, 0, -4.5), "is out of the water"),
    "wider": (
        box_database(volumes=None, centres_of_buoyancy=None),
        hull_surface(L, 1.3 * B),
        (0, 0, 0),
        "1560 m2",
    ),
    "aside_of_symmetry": (
        box_database((0, 0, 0), symmetric=True, **without),
        hull_surface(middle=np.array([3.0, 2.0, 0.0])),
        (0, 0, 0),
        "the middle of its displaced volume at y = 2 m",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_another_hull_is_refused(name) -> None:
    database, surface, reference, words = WRONG[name]
    error = error_of(scene(database, surface, reference=reference))
    assert error.startswith("box.nc: reference: 'hull', upright")
    assert words in error


def test_what_is_a_little_off_is_told() -> None:
    (volume,) = notes_of(scene(box_database(draught=0.93 * T)))
    assert "a displaced volume of 4800 m3" in volume
    assert "(box.nc) 4464 m3" in volume
    told = notes_of(scene(box_database(), reference=(0, 0.6, 0)))  # 10 % of the gyradius of 5.77 m
    assert len(told) == 2
    assert all("y = -0.6 m" in one for one in told)
    assert notes_of(scene(box_database(), reference=(0, 0.2, 0))) == []


def test_a_float_plane_in_numbers_is_told_of_and_not_refused() -> None:
    linear = LinearRestoring(
        volume=1000.0,
        centre_of_buoyancy=np.array([0.0, 0.0, -1.0]),
        reference=np.zeros(3),
        area=500.0,
        second_moments=(2e4, 2e4, 0.0),
    )
    assert len(notes_of(scene(box_database(), linear))) > 3
    same = RestoringOfSurface(**vars(linear))
    assert "expected about" in error_of(scene(box_database(), same))


def words_at(volume: float, **changes: Any) -> str:
    made = scene(box_database(**changes.pop("database", {})), tanks=changes.pop("tanks", ()))
    assert made.sea is not None
    return weight_words(floating_hulls(made), made.sea, "hull", volume, **changes)


@pytest.mark.parametrize("numbers", [{}, without])
def test_displacement_at_rest(numbers) -> None:
    """Told from 5 % of what the database displaces, refused from 20 %; without numbers of what the hull has there."""
    whole = L * B * T
    assert words_at(1.04 * whole, database=numbers) == ""
    assert "10% less than the 4800 m3 of its database" in words_at(0.9 * whole, database=numbers)
    for share in (0.6, 1.25):
        with pytest.raises(InputError, match=r"box\.nc: mass: 'hull' displaces .* than the 4800 m3"):
            words_at(share * whole, database=numbers)


def test_what_ropes_carry_or_pumps_change_is_not_refused() -> None:
    whole = L * B * T
    assert words_at(0.85 * whole, unknown="ropes") == ""
    assert "not counted: ropes" in words_at(0.6 * whole, unknown="ropes")
    filled = Tank(
        name="peak", hull="hull", point=np.zeros(3), times=np.array([0.0, 1e3]), masses=np.array([0.0, 2e6])
    )
    assert "40% less" in words_at(0.6 * whole, tanks=[filled])
    still = Tank(name="wing", hull="hull", point=np.zeros(3), times=np.zeros(1), masses=np.array([1e5]))
    told = Scenario((Phase("fill", actions=(TankRate("wing", 100.0),)),))
    assert "40% less" in words_at(0.6 * whole, tanks=[still], scenario=told)
    with pytest.raises(InputError, match="40% less"):
        words_at(0.6 * whole, tanks=[still])
