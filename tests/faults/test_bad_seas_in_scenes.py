"""Mistakes in seas that are made in Python, without a case file: one error that names body, line or database."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase, check_database
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.moorings import LineSection
from heavylift.solver.scene.scene import Fixed, Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Radiation, Sea, Tank, Water
from heavylift.solver.water.lines.fenders import Fender
from heavylift.solver.water.lines.mooring_lines import MooringLine
from heavylift.solver.water.waves.wave_trains import regular_wave

if TYPE_CHECKING:
    from collections.abc import Callable

G, DENSITY = 9.81, 1025.0
BOX = box_surface((20.0, 10.0, 5.0))
BODY = RigidBody("barge", 512.5e3, np.diag([5.3e6, 1.8e7, 2.1e7]))
HULL = Hull(body="barge", restoring=BOX)
LINE = MooringLine(
    name="bow_line",
    body_a=GROUND,
    point_a=np.array([60.0, 0.0, 2.0]),
    body_b="barge",
    point_b=np.array([10.0, 0.0, 2.0]),
    sections=(LineSection(51.0, 80.0, 2e7),),
)
FENDER = Fender(
    name="quay",
    body_a=GROUND,
    point_a=np.array([0.0, 5.0, 0.0]),
    body_b="barge",
    point_b=np.array([0.0, 5.0, 0.0]),
    direction=np.array([0.0, -1.0, 0.0]),
    stiffness=1e6,
)


def database() -> HydrodynamicDatabase:
    """Damping of one mode after the other like w exp(-w), added mass that belongs to it, headings of half a turn."""
    omega = np.linspace(0.05, 8.0, 160)
    size = np.array([1e5, 1e5, 3e5, 3e6, 1e7, 2e6])
    damping = (4.0 * omega * np.exp(-2.0 * omega))[:, None, None] * np.diag(size)
    from heavylift.preprocess.hydrodynamics.retardation import infinite_added_mass

    limit = np.diag(size)
    added = np.broadcast_to(limit, damping.shape)
    shift = added - infinite_added_mass(omega, added, damping)[0]  # what Ogilvie's relation wants beside it
    return HydrodynamicDatabase(
        bodies=("barge",),
        omega=omega,
        headings=np.deg2rad(np.arange(0.0, 181.0, 10.0)),
        added_mass=added,
        damping=damping,
        added_mass_infinite=limit - shift.mean(axis=0),
        excitation=np.zeros((160, 19, 6), dtype=complex),
        reference_points=np.zeros((1, 3)),
        density=DENSITY,
        gravity=G,
        depth=np.inf,
        source="made.nc",
        symmetric=True,
    )


def error_of(bodies: tuple[RigidBody, ...] = (BODY,), step: float = 0.05, **sea: Any) -> InputError:
    """The error of a scene with the box in water and something wrong; fails if there is none."""
    water = sea.pop("water", Water(density=DENSITY, gravity=G))
    made = Sea(water=water, **{"hulls": (HULL,), **sea})
    scene = Scene(bodies=bodies, forces=(Gravity(np.array([0.0, 0.0, -G])),), sea=made)
    with pytest.raises(InputError) as caught:
        pack_scene(scene, "dele2", step)
    return caught.value


def radiation(**more: Any) -> Radiation:
    return Radiation(**{"bodies": ("barge",), "database": database(), **more})


SMALL = LinearRestoring(
    volume=-1.0,
    centre_of_buoyancy=np.zeros(3),
    reference=np.zeros(3),
    area=200.0,
    second_moments=(6667.0, 1667.0, 0.0),
)


@pytest.mark.parametrize(
    ("sea", "words"),
    [
        ({"hulls": (replace(HULL, body="bardge"),)}, "'bardge' is no rigid body"),
        ({"hulls": (HULL, HULL)}, "'barge' floats already"),
        ({"hulls": (replace(HULL, low_pass=0.0),)}, "barge: low_pass: 0.0 is too small"),
        ({"hulls": (replace(HULL, damping=-np.eye(6)),)}, "barge: damping"),
        ({"hulls": (replace(HULL, quadratic_damping=np.array([0, 0, -1.0, 0, 0, 0])),)}, "barge: quadratic"),
        ({"hulls": (replace(HULL, restoring=SMALL),)}, "barge: restoring: volume -1.0 m3"),
        ({"water": Water(density=DENSITY, gravity=1.62)}, "gravity"),
        ({"tanks": (Tank(name="T1", hull="bardge", point=np.zeros(3), times=np.zeros(1), masses=np.ones(1)),)}, "T1"),
        ({"tanks": (Tank(name="T1", hull="barge", point=np.zeros(3), times=np.zeros(2), masses=np.ones(2)),)}, "T1"),
        ({"lines": (replace(LINE, sections=(LineSection(40.0, 80.0, 2e7),)),)}, "bow_line"),
        ({"lines": (replace(LINE, sections=(LineSection(-40.0, 80.0, 2e7),)),)}, "bow_line"),
        ({"lines": (replace(LINE, body_b="bardge"),)}, "bardge"),
        ({"fenders": (replace(FENDER, stiffness=-1e6),)}, "quay"),
        ({"fenders": (replace(FENDER, direction=np.zeros(3)),)}, "quay"),
    ],
)  # fmt: skip
def test_each_mistake_names_what_it_is_of(sea: dict[str, Any], words: str) -> None:
    assert words in str(error_of(**sea))


def test_a_body_that_does_not_move_freely_cannot_float() -> None:
    assert "prescribed" in str(error_of((replace(BODY, motion=Fixed()),)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda triangles: triangles[2:], "open"),
        (lambda triangles: triangles[:, ::-1], "inside"),
    ],
    ids=["leaking", "inside out"],
)
def test_a_surface_that_is_no_hull(change: Callable[[np.ndarray], np.ndarray], words: str) -> None:
    broken = replace(BOX, triangles=np.ascontiguousarray(change(BOX.triangles)))
    error = error_of(hulls=(replace(HULL, restoring=broken),))
    assert words in f"{error.problem} {error.expected}".lower()


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"bodies": ("bardge",)}, "'bardge' is no hull"),
        ({"bodies": ("barge", "barge")}, "is no hull, or has a database already"),
        ({"memory": "direct"}, "made.nc: memory: direct convolution without a fixed step"),
    ],
)
def test_a_database_that_does_not_fit_the_scene(more: dict[str, Any], words: str) -> None:
    assert words in str(error_of(step=0.0, radiation=(radiation(**more),)))


def test_a_database_of_other_water() -> None:
    fresh = replace(database(), density=1000.0)
    assert "made.nc: density, gravity, depth" in str(error_of(radiation=(radiation(database=fresh),)))
    shallow = Water(density=DENSITY, gravity=G, depth=20.0)
    assert "depth inf m" in str(error_of(water=shallow, radiation=(radiation(),)))


@pytest.mark.slow
def test_a_wave_beyond_the_database() -> None:
    """A period of 0.6 s where the table ends at 8 rad/s, and a direction of which it has none."""
    short = regular_wave(0.01, 0.6, 0.0, gravity=G)
    assert "made.nc" in str(error_of(radiation=(radiation(),), waves=short))
    half = replace(database(), symmetric=False)
    away = regular_wave(0.5, 6.0, np.deg2rad(-120.0), gravity=G)
    assert "made.nc" in str(error_of(radiation=(radiation(database=half),), waves=away))


def test_negative_damping_in_a_database() -> None:
    damping = database().damping.copy()
    damping[10, 2, 2] *= -1.0
    with pytest.raises(InputError, match="negative damping"):
        check_database(replace(database(), damping=damping))
