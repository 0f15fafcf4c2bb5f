"""Hydrodynamic databases: what must be true of them, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import (
    HydrodynamicDatabase,
    check_database,
    check_phase,
    database_faults,
    length_scales,
    over_full_circle,
    wave_numbers,
)
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

CASES = Path(__file__).parents[2] / "cases"
DENSITY, GRAVITY = 1025.0, 9.81


def long_waves(*, points=((0.0, 0.0, 0.0),), symmetric=True, count=19):
    """Small boxes in long waves: force = stiffness in heave, mass times acceleration of the water in the plane."""
    omega = np.array([0.1, 0.2, 0.4, 0.8])
    headings = np.linspace(0.0, np.pi, count) if symmetric else 2.0 * np.pi * np.arange(count) / count
    points = np.asarray(points)
    n = 6 * len(points)
    single = np.array([1.0e5, 2.0e5, 6.0e5, 4.0e6, 6.0e6, 7.0e6])
    mass = np.diag(np.tile(single, len(points)))
    damping = omega[:, None, None] * 0.1 * mass
    slope = np.stack([np.cos(headings), np.sin(headings)], axis=1)
    w2 = omega[:, None] ** 2
    force = np.zeros((len(omega), count, n), dtype=complex)
    for b, point in enumerate(points):
        phase = np.exp(1j * (w2 / GRAVITY) * (slope @ point[:2]))
        force[:, :, 6 * b + 0] = -1j * w2 * 6.0e5 * slope[:, 0] * phase
        force[:, :, 6 * b + 1] = -1j * w2 * 7.0e5 * slope[:, 1] * phase
        force[:, :, 6 * b + 2] = 2.0e6 * phase
        force[:, :, 6 * b + 3] = 1j * w2 * 5.0e5 * slope[:, 1] * phase
        force[:, :, 6 * b + 4] = -1j * w2 * 9.0e5 * slope[:, 0] * phase
        force[:, :, 6 * b + 5] = w2**2 * 1.0e5 * slope[:, 0] * slope[:, 1] * phase
    return HydrodynamicDatabase(
        bodies=tuple(f"box{b}" for b in range(len(points))),
        omega=omega,
        headings=headings,
        added_mass=np.repeat(mass[None], len(omega), axis=0),
        damping=damping,
        added_mass_infinite=mass,
        excitation=force,
        reference_points=points,
        density=DENSITY,
        gravity=GRAVITY,
        depth=np.inf,
        source="long waves",
        symmetric=symmetric,
        volumes=np.full(len(points), 500.0),
    )


@pytest.mark.parametrize("depth", [2.0, 12.0, 150.0, np.inf])
def test_wave_numbers_solve_the_dispersion_relation(depth):
    omega = np.geomspace(0.02, 6.0, 40)
    deep = omega**2 / GRAVITY
    if np.isinf(depth):
        expected = deep
    else:
        expected = [
            brentq(
                lambda k, d=d: k * np.tanh(k * depth) - d, d, 10.0 * d + np.sqrt(d / depth) * 2.0, xtol=1e-16
            )
            for d in deep
        ]
    np.testing.assert_allclose(wave_numbers(omega, GRAVITY, depth), expected, rtol=1e-12)


def test_headings_beyond_half_a_turn_are_mirror_images():
    half = long_waves(points=((-20.0, 0.0, 0.0), (20.0, 0.0, 0.0)), symmetric=True, count=19)
    whole = long_waves(points=((-20.0, 0.0, 0.0), (20.0, 0.0, 0.0)), symmetric=False, count=36)
    made = over_full_circle(half)
    np.testing.assert_allclose(made.headings, whole.headings, atol=1e-12)
    np.testing.assert_allclose(made.excitation, whole.excitation, atol=1e-9 * np.abs(whole.excitation).max())
    assert not made.symmetric
    assert over_full_circle(whole) is whole


def test_phase_at_the_hull_itself_does_not_depend_on_where_it_lies():
    at_origin = long_waves()
    elsewhere = long_waves(points=((30.0, 40.0, 0.0),))
    np.testing.assert_allclose(
        elsewhere.excitation_at_reference_points(),
        at_origin.excitation,
        atol=1e-9 * np.abs(at_origin.excitation).max(),
    )
    assert np.abs(elsewhere.excitation - at_origin.excitation).max() > 1e5


def test_a_consistent_database_passes():
    database = long_waves(points=((-20.0, 0.0, 0.0), (20.0, 0.0, 0.0)))
    check_database(database)
    check_phase(database)
    assert database.body_count == 2
    assert database.body_index("box1") == 1
    with pytest.raises(InputError, match=r"no hull 'crane'.*one of box0, box1"):
        database.body_index("crane")


def with_entry(values, place, value):
    changed = values.copy()
    changed[place] = value
    return changed


BAD = {
    "nan": (
        "added_mass.*is nan.*finite",
        lambda d: {"added_mass": with_entry(d.added_mass, (1, 2, 3), np.nan)},
    ),
    "shape": ("damping.*shape.*expected", lambda d: {"damping": d.damping[:, :5]}),
    "names": ("different names", lambda _: {"bodies": ("box", "box"), "reference_points": np.zeros((2, 3))}),
    "nothing": ("at least one of each", lambda _: {"omega": np.zeros(0)}),
    "order": ("increasing order", lambda d: {"omega": d.omega[::-1]}),
    "zero": ("without 0", lambda d: {"omega": with_entry(d.omega, 0, 0.0)}),
    "heading order": ("headings are not increasing", lambda d: {"headings": with_entry(d.headings, 3, 0.0)}),
    "degrees": ("are these degrees", lambda d: {"headings": np.rad2deg(d.headings)}),
    "half": ("0 .. 180 deg", lambda d: {"headings": d.headings - 0.5}),
    "off the plane": ("off the plane", lambda _: {"reference_points": np.array([[0.0, 1.0, 0.0]])}),
    "tonnes per cubic metre": ("density.*kg/m", lambda _: {"density": 1.025}),
    "feet": ("gravity.*m/s", lambda _: {"gravity": 32.2}),
    "dry": ("depth", lambda _: {"depth": 0.0}),
    "tonnes": ("tonnes for kilograms", lambda d: {"added_mass_infinite": 1e-3 * d.added_mass_infinite}),
    "unsymmetric": (
        "symmetric matrix within 5%",
        lambda d: {"added_mass": with_entry(d.added_mass, (2, 0, 2), 0.1 * d.added_mass.max())},
    ),
    "no mirror": (
        "heave and roll are coupled|roll and heave are coupled",
        lambda d: {
            "added_mass": d.added_mass + 2e5 * (np.eye(6)[[0, 1, 3, 2, 4, 5]] - np.diag([1, 1, 0, 0, 1, 1]))
        },
    ),
    "negative added mass": (
        "positive definite",
        lambda d: {"added_mass_infinite": with_entry(d.added_mass_infinite, (2, 2), -1e5)},
    ),
    "negative damping": (
        "0.8 rad/s: negative damping drives heave",
        lambda d: {"damping": with_entry(d.damping, (3, 2, 2), -1e4)},
    ),
}


@pytest.mark.parametrize("kind", BAD)
def test_what_cannot_be_is_refused(kind):
    message, change = BAD[kind]
    database = long_waves()
    with pytest.raises(InputError, match=message) as caught:
        check_database(replace(database, **change(database)))
    assert "long waves" in str(caught.value)


@pytest.mark.parametrize("kind", ["negative damping", "not symmetric"])
@pytest.mark.parametrize(
    ("source", "proposed"),
    [
        ("Capytaine 3.0, 648 panels, lid at z = 0", False),
        ("Capytaine 3.0, 648 panels, no lid", True),
        ("barge.nc", True),
    ],
)
def test_a_lid_is_proposed_only_where_there_may_be_none(kind, source, proposed):
    changed = {
        "negative damping": lambda d: {"damping": with_entry(d.damping, (3, 2, 2), -1e4)},
        "not symmetric": lambda d: {"added_mass": with_entry(d.added_mass, (3, 0, 4), 5e6)},
    }[kind]
    database = replace(long_waves(), source=source)
    with pytest.raises(InputError) as caught:
        check_database(replace(database, **changed(database)))
    assert ("lid" in caught.value.expected) == proposed
    assert "finer panels" in caught.value.expected


def test_conjugated_excitation_and_reversed_headings_are_refused():
    database = long_waves()
    check_phase(database)
    with pytest.raises(InputError, match=r"exp\(-i omega t\)"):
        check_phase(replace(database, excitation=database.excitation.conj()))
    with pytest.raises(InputError, match="TOWARDS"):  # values of heading b stored under b + pi
        check_phase(replace(database, headings=database.headings + np.pi, symmetric=False))
    # both at once are the same physics again
    check_phase(
        replace(
            database,
            excitation=database.excitation.conj(),
            headings=database.headings + np.pi,
            symmetric=False,
        )
    )


@pytest.mark.parametrize("case", ["transport_barge/barge", "two_barges/two_barges"])
def test_shipped_databases_obey_haskind(case):
    """B_ij = k / (8 pi rho g c_g) int X_i X_j* d(beta): energy of the radiated waves (Newman 1962).

    Diffraction and radiation are computed apart, so this ties excitation (modulus, phase between hulls, mirrored
    headings) to damping. Panels are flat and of constant strength: 6 % of the largest entry, up to 1.5 rad/s.
    """
    database = read_netcdf(CASES / f"{case}.nc")
    whole = over_full_circle(database)
    assert whole.headings.size == 36
    used = whole.omega <= 1.5
    k = whole.wave_numbers()[used]
    group_speed = 0.5 * GRAVITY / whole.omega[used]
    X = whole.excitation[used]
    integral = np.einsum("whi,whj->wij", X, X.conj()) * (2.0 * np.pi / 36)
    expected = (
        k[:, None, None] / (8.0 * np.pi * whole.density * GRAVITY * group_speed[:, None, None]) * integral
    )
    largest = np.sqrt(np.abs(whole.damping[used]).max(axis=0).diagonal())
    error = np.abs(expected - whole.damping[used]) / np.outer(largest, largest)
    assert error.max() < 0.06, (error.max(), np.unravel_index(error.argmax(), error.shape))


@pytest.mark.parametrize("case", ["transport_barge/barge", "two_barges/two_barges"])
def test_shipped_databases_have_the_limits_of_long_waves(case):
    """Heave force -> rho g A, stiffness of a box in closed form, volume and centre of buoyancy."""
    length, breadth, draft = (97.5, 36.0, 4.5) if "transport" in case else (60.0, 20.0, 3.0)
    database = read_netcdf(CASES / f"{case}.nc")
    area = length * breadth
    forces = database.excitation[0, :, 2::6]
    np.testing.assert_allclose(np.abs(forces), DENSITY * GRAVITY * area, rtol=0.01)
    np.testing.assert_allclose(database.volumes, area * draft, rtol=1e-12)
    np.testing.assert_allclose(database.centres_of_buoyancy[:, 2], -0.5 * draft, rtol=1e-12)
    roll = area * breadth**2 / 12.0 - 0.5 * draft * area * draft
    pitch = area * length**2 / 12.0 - 0.5 * draft * area * draft
    for stiffness in database.hydrostatic_stiffness:
        expected = DENSITY * GRAVITY * np.diag([0.0, 0.0, area, roll, pitch, 0.0])
        np.testing.assert_allclose(stiffness, expected, atol=1e-9 * expected.max())


def test_every_bad_frequency_is_named_with_its_entries():
    database = long_waves()
    assert database_faults(database) == ()
    added, damping = database.added_mass.copy(), database.damping.copy()
    scales = length_scales(database)
    largest = np.abs(added * np.outer(scales, scales)).max()
    for w, size in ((0, 0.2), (2, 0.07), (3, 0.04)):
        added[w, 0, 4] += size * largest / (scales[0] * scales[4])
    damping[1, 2, 2] = -np.abs(damping).max()
    bad = replace(database, added_mass=added, damping=damping)
    found = database_faults(bad)
    assert [(fault.key, fault.omega) for fault in found] == [
        ("added_mass", database.omega[0]),
        ("damping", database.omega[1]),
        ("added_mass", database.omega[2]),
    ]
    assert [sorted(fault.entries) for fault in found] == [[0, 4], [2, 2], [0, 4]]
    np.testing.assert_allclose([found[0].size, found[2].size], [0.2, 0.07], rtol=0.05)
    assert found[1].size < 0.0
    assert "added_mass of surge and pitch differs by 20" in found[0].words(bad).replace(
        "pitch and surge", "surge and pitch"
    )
    assert "drives heave" in found[1].words(bad)
    with pytest.raises(InputError, match="worst of 2 frequencies"):
        check_database(replace(database, added_mass=added))
