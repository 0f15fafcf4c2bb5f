"""Databases whose numbers contradict each other: what each relation sees and what not, and that sound ones pass."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase, at_frequencies
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
from heavylift.preprocess.hydrodynamics.plausibility import (
    check_plausibility,
    group_velocity,
    haskind_damping,
    outlying_frequencies,
)
from heavylift.preprocess.hydrodynamics.repairs import Repair, repaired

CASES = Path(__file__).parents[2] / "cases"
HEAVE, PITCH = 2, 4


@pytest.fixture(scope="module")
def barge() -> HydrodynamicDatabase:
    """A barge, 19 headings of half a circle, 60 frequencies from very long waves on."""
    return read_netcdf(CASES / "transport_barge" / "barge.nc")


def few_headings(database: HydrodynamicDatabase, *at: int) -> HydrodynamicDatabase:
    """The same with some of its headings, which say nothing of the others."""
    kept = list(at)
    return replace(
        database, headings=database.headings[kept], excitation=database.excitation[:, kept], symmetric=False
    )


def scaled(values, factor, *place):
    made = values.copy()
    made[place] = made[place] * factor
    return made


def negated_heave(database):
    added = database.added_mass.copy()
    added[:, HEAVE, HEAVE] *= -1.0
    return replace(database, added_mass=added)


def exchanged_forces(database):
    turned = database.excitation.copy()
    turned[:, :, [HEAVE, PITCH]] = turned[:, :, [PITCH, HEAVE]]
    return replace(database, excitation=turned)


def exchanged_coordinates(database):
    """Rows and columns of heave and pitch, which leaves the matrices symmetric."""
    order = np.arange(6 * database.body_count)
    order[[HEAVE, PITCH]] = PITCH, HEAVE
    square = np.ix_(order, order)
    return replace(
        database,
        added_mass=np.array([one[square] for one in database.added_mass]),
        damping=np.array([one[square] for one in database.damping]),
        added_mass_infinite=database.added_mass_infinite[square],
    )


WRONG = {
    "added mass of heave negated": (negated_heave, "added_mass: of heave it is negative at"),
    "one frequency of added mass times 3": (
        lambda d: replace(d, added_mass=scaled(d.added_mass, 3.0, 20)),
        r"added_mass: at .* rad/s all of it is 3 times",
    ),
    "one frequency of damping times 3": (
        lambda d: replace(d, damping=scaled(d.damping, 3.0, 30)),
        r"damping: at .* rad/s all of it is 3(\.\d)? times",
    ),
    "one frequency of damping a third": (
        lambda d: replace(d, damping=scaled(d.damping, 1.0 / 3.0, 30)),
        r"damping: at .* rad/s all of it is 0\.3\d* times",
    ),
    "one frequency of excitation times 3": (
        lambda d: replace(d, excitation=scaled(d.excitation, 3.0, 12)),
        r"excitation: at .* rad/s all of it is 3(\.\d)? times",
    ),
    "excitation times 5": (
        lambda d: replace(d, excitation=5.0 * d.excitation),
        r"excitation: of \w+: the waves .* take 2\d times the damping",
    ),
    "excitation of half the amplitude": (
        lambda d: replace(d, excitation=0.5 * d.excitation),
        r"excitation: of \w+: the waves .* take 0\.2\d* times the damping",
    ),
    "excitation turned by 1 rad": (
        lambda d: replace(d, excitation=np.exp(1j) * d.excitation),
        r"excitation: in the longest wave, .* off the phase",
    ),
    "excitation turned back by 1 rad": (
        lambda d: replace(d, excitation=np.exp(-1j) * d.excitation),
        r"excitation: in the longest wave, .* off the phase",
    ),
    "forces of heave and pitch exchanged": (exchanged_forces, "the waves that it would radiate"),
    "matrices of heave and pitch exchanged": (
        exchanged_coordinates,
        "the waves that it would radiate|symmetric|displaced mass",
    ),
}


@pytest.mark.parametrize("how", WRONG)
def test_what_contradicts_itself_is_refused(barge, how):
    change, words = WRONG[how]
    with pytest.raises(InputError, match=words) as caught:
        repaired(change(barge))
    assert caught.value.source == barge.source
    assert caught.value.key in {"added_mass", "added_mass_infinite", "damping", "excitation", "symmetric"}
    assert caught.value.expected


@pytest.mark.parametrize(
    "how", ["excitation times 5", "excitation turned by 1 rad", "forces of heave and pitch exchanged"]
)
@pytest.mark.parametrize("headings", [(0,), (18,), (0, 9), (4,)])
def test_few_headings_tell_in_long_waves(barge, how, headings):
    few = few_headings(barge, *headings)
    repaired(few)
    with pytest.raises(InputError):
        repaired(WRONG[how][0](few))


def test_the_frequency_that_is_named_is_that_to_leave_out(barge):
    wrong = replace(barge, damping=scaled(barge.damping, 3.0, 30))
    left_out = repaired(wrong, Repair(leave_out=(float(barge.omega[30]),)))
    assert len(left_out.omega) == len(barge.omega) - 1


@pytest.mark.parametrize("case", ["transport_barge/barge", "spring_barge/barge", "two_barges/two_barges"])
def test_sound_databases_pass(case):
    check_plausibility(read_netcdf(CASES / f"{case}.nc"))


@pytest.mark.parametrize("case", ["transport_barge/barge", "two_barges/two_barges"])
@pytest.mark.parametrize("spacing", [2, 3, 9])
def test_sound_databases_with_fewer_headings_pass(case, spacing):
    """Every 20, 30 and 90 degrees: short waves have forces between two headings."""
    whole = read_netcdf(CASES / f"{case}.nc")
    few = replace(few_headings(whole, *range(0, 19, spacing)), symmetric=True)
    check_plausibility(few)
    with pytest.raises(InputError, match="Haskind"):
        check_plausibility(replace(few, excitation=3.0 * few.excitation))


@pytest.mark.parametrize("case", ["transport_barge/barge", "spring_barge/barge"])
@pytest.mark.parametrize("kept", [slice(0, 6), slice(6, 18), slice(-15, None), slice(-8, None)])
def test_a_part_of_the_frequencies_passes(case, kept):
    whole = read_netcdf(CASES / f"{case}.nc")
    check_plausibility(at_frequencies(whole, np.arange(len(whole.omega))[kept]))


@pytest.mark.parametrize("count", [8, 12, 36])
def test_headings_tell_only_of_waves_that_they_resolve(barge, count):
    """Heave of a slender hull, F sin(q) / q with q = k L / 2 cos(heading), integrated over thousands of headings."""
    omega = np.linspace(0.2, 2.5, 60)
    k, headings = omega**2 / 9.81, 2.0 * np.pi * np.arange(count) / count

    def force(headings):
        return np.sinc(k[:, None] * 100.0 / (2.0 * np.pi) * np.cos(headings))

    excitation = np.zeros((60, count, 6), dtype=complex)
    excitation[:, :, HEAVE] = force(headings)
    inertia = np.array([1.0, 1.0, 1.0, 0.0, 0.5, 0.5]) * 1e7 * 100.0 ** np.array([0, 0, 0, 2, 2, 2])
    slender = replace(
        barge,
        omega=omega,
        headings=headings,
        excitation=excitation,
        added_mass=np.repeat(np.diag(inertia)[None], 60, axis=0),
        added_mass_infinite=np.diag(inertia) / 4.0,
        damping=np.zeros((60, 6, 6)),
        depth=np.inf,
        gravity=9.81,
        symmetric=False,
        drift=None,
    )
    found = haskind_damping(slender)[:, HEAVE]
    every = (force(2.0 * np.pi * np.arange(5000) / 5000) ** 2).mean(axis=1) * 2.0 * np.pi
    expected = k / (8.0 * np.pi * slender.density * 9.81 * group_velocity(slender)) * every
    told = np.isfinite(found)
    assert told.sum() > 5
    np.testing.assert_allclose(found[told], expected[told], rtol=0.15)


def test_little_heave_in_long_waves_is_no_fault(barge):
    """Columns on pontoons: what the water's acceleration takes of its weight is said by the mass of hull and water."""
    plane = barge.omega[0] ** 2 * (barge.added_mass[0, HEAVE, HEAVE] + barge.density * barge.volumes[0])
    stiffness = barge.hydrostatic_stiffness.copy()
    stiffness[0, HEAVE, HEAVE] = 1.2 * plane
    excitation = barge.excitation.copy()
    excitation[:, :, HEAVE] *= 0.2 * plane / np.abs(excitation[0, 0, HEAVE])
    damping = barge.damping.copy()
    damping[:, HEAVE, HEAVE] *= (0.2 * plane / np.abs(barge.excitation[0, 0, HEAVE])) ** 2
    check_plausibility(
        replace(barge, excitation=excitation, hydrostatic_stiffness=stiffness, damping=damping)
    )


def test_what_no_relation_sees(barge):
    """The first frequencies, and one coordinate alone: said in the module."""
    repaired(replace(barge, added_mass=scaled(barge.added_mass, 2.0, 0)))
    alone = barge.damping.copy()
    alone[30, 5, 5] *= 1.5
    repaired(replace(barge, damping=alone))


def test_haskind_gives_the_damping_of_a_heaving_body_of_revolution():
    """B33 = omega^3 |X3|^2 / (2 rho g^3) in deep water: Faltinsen, equation 3.36, by any set of headings."""
    omega, force = np.linspace(0.4, 1.2, 5), 3e6
    for headings in (np.zeros(1), np.array([0.3, 2.0]), np.linspace(0.0, 1.75 * np.pi, 8)):
        excitation = np.zeros((5, len(headings), 6), dtype=complex)
        excitation[:, :, HEAVE] = force
        database = HydrodynamicDatabase(
            bodies=("sphere",),
            omega=omega,
            headings=headings,
            added_mass=np.repeat(np.diag([1e5, 1e5, 1e5, 1e5, 1e5, 1e5])[None], 5, axis=0),
            damping=np.zeros((5, 6, 6)),
            added_mass_infinite=np.eye(6),
            excitation=excitation,
            reference_points=np.zeros((1, 3)),
            density=1025.0,
            gravity=9.81,
            depth=np.inf,
            source="made for tests",
        )
        expected = omega**3 * force**2 / (2.0 * 1025.0 * 9.81**3)
        np.testing.assert_allclose(haskind_damping(database)[:, HEAVE], expected, rtol=1e-12)


def test_group_velocities_of_deep_and_shallow_water(barge):
    deep = group_velocity(replace(barge, depth=np.inf))
    np.testing.assert_allclose(deep, barge.gravity / (2.0 * barge.omega), rtol=1e-12)
    shallow = group_velocity(replace(barge, depth=0.01))
    np.testing.assert_allclose(shallow[:10], np.sqrt(barge.gravity * 0.01), rtol=1e-2)
    # d omega / d k by differences, of water of any depth
    for depth in (5.0, 30.0):
        at = replace(barge, depth=depth)
        step = 1e-6
        k = (
            replace(at, omega=at.omega * (1 + step)).wave_numbers()
            - replace(at, omega=at.omega * (1 - step)).wave_numbers()
        )
        np.testing.assert_allclose(group_velocity(at), 2.0 * step * at.omega / k, rtol=1e-6)


def test_a_resonance_is_no_outlier():
    """One coordinate of three grows at one frequency, as water between hulls does; a common factor is one."""
    omega = np.linspace(0.2, 2.0, 19)
    values = np.stack([omega * np.exp(-omega), omega**2 * np.exp(-omega), 1.0 / (1.0 + omega)], axis=1)
    assert outlying_frequencies(omega, values, values.max(axis=0)) == []
    resonant = values.copy()
    resonant[9, 1] *= 6.0
    assert outlying_frequencies(omega, resonant, resonant.max(axis=0)) == []
    ((at, factor),) = outlying_frequencies(omega, scaled(values, 3.0, 9), values.max(axis=0))
    assert at == 9
    assert factor == pytest.approx(3.0, rel=0.05)
