"""Databases with the faults that panel codes have: what is repaired and told with its size, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import (
    HydrodynamicDatabase,
    check_database,
    length_scales,
    mass_scales,
)
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf, write_netcdf
from heavylift.preprocess.hydrodynamics.repairs import Repair, passive_damping, refuse_between, repaired
from heavylift.preprocess.hydrodynamics.wamit_files import read_wamit

CASES = Path(__file__).parents[2] / "cases"


@pytest.fixture(scope="module")
def barges() -> HydrodynamicDatabase:
    """Two barges side by side, of 12 coordinates, sound."""
    return read_netcdf(CASES / "two_barges" / "two_barges.nc")


def scaled_by(database: HydrodynamicDatabase, share: float, i: int, j: int, key: str) -> float:
    """An entry that is a share of the largest one of a matrix over all frequencies."""
    scales = length_scales(database)
    largest = np.abs(getattr(database, key) * np.outer(scales, scales)).max()
    return float(share * largest / (scales[i] * scales[j]))


def test_a_sound_database_is_left_as_it_is(barges: HydrodynamicDatabase) -> None:
    same = repaired(barges)
    assert same.repairs == ()
    for key in ("added_mass", "excitation", "added_mass_infinite"):
        np.testing.assert_array_equal(getattr(same, key), getattr(barges, key))


def test_unsymmetric_matrices_are_told_and_symmetrised(barges: HydrodynamicDatabase) -> None:
    added = barges.added_mass.copy()
    w = 7
    added[w, 0, 4] += scaled_by(barges, 0.08, 0, 4, "added_mass")
    bad = replace(barges, added_mass=added)
    made = repaired(bad)
    (sentence,) = made.repairs
    assert sentence.startswith("added mass of aft surge-aft pitch unsymmetric by ")
    size = float(sentence.split("unsymmetric by ")[1].split("%")[0])
    assert size == pytest.approx(8.0, abs=1.0)  # and what the panels had before
    assert f"at {barges.omega[w]:.4g} rad/s: symmetrised" in sentence
    np.testing.assert_array_equal(made.added_mass, 0.5 * (added + np.swapaxes(added, 1, 2)))
    with pytest.raises(InputError, match=r"a symmetric matrix within 5%.*'symmetrise = true'"):
        repaired(bad, Repair(symmetrise=False))
    with pytest.raises(InputError, match=r"within 6%.*'leave_out = \[.*'tolerance = 0.08"):
        repaired(bad, Repair(tolerance=0.06))
    left_out = repaired(bad, Repair(tolerance=0.06, leave_out=(float(barges.omega[w]),)))
    np.testing.assert_array_equal(left_out.omega, np.delete(barges.omega, w))


def test_negative_damping_becomes_zero_and_nothing_else_changes(barges: HydrodynamicDatabase) -> None:
    damping = barges.damping.copy()
    damping[-1, 2, 2] = -scaled_by(barges, 0.05, 2, 2, "damping")
    bad = replace(barges, damping=damping)
    made = repaired(bad)
    (sentence,) = made.repairs
    scales = length_scales(barges)
    values = np.linalg.eigvalsh(0.5 * (damping + np.swapaxes(damping, 1, 2)) * np.outer(scales, scales))
    share = values.min() / values.max()
    assert -0.05 < share < -0.03
    assert (
        f"negative damping of aft heave, {share:.1%} of the largest at {barges.omega[-1]:.4g} rad/s"
        in sentence
    )
    assert not made.damping[-1, 2].any()
    others = np.delete(np.arange(12), 2)
    block = np.ix_(others, others)
    symmetric = 0.5 * (barges.damping[-1] + barges.damping[-1].T)
    np.testing.assert_allclose(
        (made.damping[-1] * np.outer(scales, scales))[block],
        (symmetric * np.outer(scales, scales))[block],
        atol=1e-3 * values.max(),
    )
    assert np.linalg.eigvalsh(made.damping[-1] * np.outer(scales, scales)).min() > -1e-9 * values.max()
    check_database(made)
    # at the end of the frequencies a range is proposed that takes the fault away
    with pytest.raises(InputError, match=f"{share:.1%} of the largest") as caught:
        repaired(bad, Repair(tolerance=0.03))
    assert f"{barges.omega[-2]:.4g}]'" in str(caught.value)
    assert (
        repaired(bad, Repair(frequency_range=(0.0, float(barges.omega[-2])))).repairs[0].startswith("1 of ")
    )


def test_the_nearest_passive_damping_keeps_that_of_each_coordinate() -> None:
    rng = np.random.default_rng(4)
    spread = rng.normal(size=(6, 5, 5))
    good = spread @ np.swapaxes(spread, 1, 2)
    at, _ = passive_damping(good)
    assert len(at) == 0
    bad = good.copy()
    bad[2, 0, 1] = bad[2, 1, 0] = 1.5 * np.sqrt(bad[2, 0, 0] * bad[2, 1, 1])  # no coupling can be as large
    bad[4, 3, 3] *= -1.0
    at, made = passive_damping(bad)
    np.testing.assert_array_equal(at, [2, 4])
    assert np.linalg.eigvalsh(made).min() > -1e-12 * good.max()
    np.testing.assert_allclose(np.diag(made[0]), np.diag(good[2]), rtol=1e-12)
    size = np.sqrt(np.diag(good[2]))
    distance, other = (np.linalg.norm((X - bad[2]) / np.outer(size, size)) for X in (made[0], good[2]))
    assert distance < other  # a passive one that is known is farther
    assert not made[1, 3].any()
    np.testing.assert_allclose(np.diag(made[1])[:3], np.diag(good[4])[:3], rtol=1e-12)
    # of two coordinates the nearest is known: full correlation
    pair = np.array([[[4.0, 5.0], [5.0, 1.0]]])
    np.testing.assert_allclose(passive_damping(pair)[1], [[[4.0, 2.0], [2.0, 1.0]]], rtol=1e-6)


def test_the_limit_of_the_added_mass_is_found_if_it_is_missing(barges: HydrodynamicDatabase) -> None:
    bad = replace(barges, added_mass_infinite=np.full((12, 12), np.nan))
    made = repaired(bad)
    (sentence,) = made.repairs
    assert "found from the damping by Ogilvie's relation" in sentence
    # the panels of the shipped one have it to 5 %
    scale = np.sqrt(mass_scales(barges))
    error = np.abs(made.added_mass_infinite - barges.added_mass_infinite) / np.outer(scale, scale)
    assert error.max() < 0.05
    with pytest.raises(InputError, match=r"three|3 frequencies or more"):
        repaired(_at(bad, slice(0, 2)))


def test_a_limit_that_is_off_is_replaced_if_that_is_tolerated(barges: HydrodynamicDatabase) -> None:
    infinite = barges.added_mass_infinite.copy()
    infinite[2, 2] *= 0.6
    bad = replace(barges, added_mass_infinite=infinite)
    assert repaired(bad).repairs == ()  # the time domain refuses it, and says what to set
    made = repaired(bad, Repair(tolerance=0.4))
    assert "of infinite frequency of aft heave-aft heave off by" in made.repairs[0]
    assert made.added_mass_infinite[2, 2] == pytest.approx(barges.added_mass_infinite[2, 2], rel=0.1)


def test_frequencies_that_failed_are_left_out(barges: HydrodynamicDatabase) -> None:
    added, force = barges.added_mass.copy(), barges.excitation.copy()
    added[0, 3, 3] = np.nan
    force[5, 1, 2] = np.nan
    made = repaired(replace(barges, added_mass=added, excitation=force))
    assert "no finite numbers at 2 of" in made.repairs[0]
    assert "added mass of aft roll-aft roll at" in made.repairs[0]
    np.testing.assert_array_equal(made.omega, np.delete(barges.omega, [0, 5]))
    added[2:] = np.nan
    with pytest.raises(InputError, match=r"1 of .* frequencies are left with finite numbers"):
        repaired(replace(barges, added_mass=added))


def _at(database: HydrodynamicDatabase, part: slice) -> HydrodynamicDatabase:
    keys = ("omega", "added_mass", "damping", "excitation")
    return replace(database, **{key: getattr(database, key)[part] for key in keys})


def test_what_was_asked_for_is_left_out_and_must_be_there(barges: HydrodynamicDatabase) -> None:
    low, high = float(barges.omega[2]), float(barges.omega[-4])
    made = repaired(barges, Repair(frequency_range=(low, high), leave_out=(1.0,)))
    assert made.omega[[0, -1]].tolist() == [low, high]
    assert np.abs(made.omega - 1.0).min() > 0.0
    assert "frequencies left out as asked" in made.repairs[0]
    with pytest.raises(InputError, match="leave_out: 99 rad/s"):
        repaired(barges, Repair(leave_out=(99.0,)))
    with pytest.raises(InputError, match="frequency_range: 0 of"):
        repaired(barges, Repair(frequency_range=(50.0, 60.0)))


def test_a_coupling_that_damping_does_not_allow_is_told(barges: HydrodynamicDatabase) -> None:
    damping = barges.damping.copy()
    roll = np.sqrt(damping[:, 3, 3].max() * damping[:, 9, 9].max())
    w = int(np.argmax(damping[:, 3, 3]))
    damping[w, 3, 9] = damping[w, 9, 3] = 1.4 * roll
    made = repaired(replace(barges, damping=damping))
    assert "damping of aft roll-fore roll beyond what that of the two coordinates allows" in " ".join(
        made.repairs
    )
    np.testing.assert_allclose(
        np.diagonal(made.damping, axis1=1, axis2=2), np.diagonal(barges.damping, axis1=1, axis2=2), rtol=1e-9
    )


# ---- files ----


def box(omega: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Non-dimensional A and B / omega of six coordinates with K(t) = exp(-t) (1 - t): no damping at zero frequency.

    int_0^inf K exp(-i w t) dt = i w / (1 + i w)^2: B = 2 w^2 / (1 + w^2)^2, A = A_inf + (1 - w^2) / (1 + w^2)^2.
    """
    mass = 4.0 * np.eye(6) + ((1.0 - omega**2) / (1.0 + omega**2) ** 2)[:, None, None] * np.eye(6)
    return mass, (2.0 * omega / (1.0 + omega**2) ** 2)[:, None, None] * np.eye(6)


def write_box(base: Path, omega: np.ndarray, *, special: tuple[str, ...] = (), noise: float = 0.0) -> None:
    """A ``.1`` file of the box, 1000 kg/m^3, ULEN 1 m, frequencies in the order given."""
    rng = np.random.default_rng(1)
    rows = [f" {word} {i + 1} {i + 1} 4.0" for word in special for i in range(6)]
    A, B = box(omega)
    A = A + noise * rng.normal(size=A.shape)
    B = B + noise * rng.normal(size=B.shape) / omega[:, None, None]
    for k, w in enumerate(omega):
        rows += [
            f" {2.0 * np.pi / w:.9E} {i + 1} {j + 1} {A[k, i, j]:.9E} {B[k, i, j]:.9E}"
            for i in range(6)
            for j in range(6)
        ]
    base.with_suffix(".1").write_text("\n".join(rows) + "\n")


OMEGA = np.linspace(0.05, 10.0, 200)


@pytest.mark.parametrize("special", [(), ("-1.0",), ("0.0",), ("-1.0", "0.0")])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_radiation_alone_in_any_order(tmp_path: Path, special: tuple[str, ...], noise: float) -> None:
    order = np.random.default_rng(2).permutation(len(OMEGA))
    write_box(tmp_path / "box", OMEGA[order], special=special, noise=noise)
    database = read_wamit(tmp_path / "box", density=1000.0, gravity=9.81, depth=np.inf)
    assert not database.has_excitation
    assert "no exciting forces: for motions in still water" in database.repairs
    np.testing.assert_allclose(database.omega, OMEGA, rtol=1e-8)
    found = [sentence for sentence in database.repairs if "Ogilvie" in sentence]
    assert len(found) == (0 if "0.0" in special else 1)
    np.testing.assert_allclose(np.diag(database.added_mass_infinite), 4000.0, rtol=5e-3 if noise else 1e-3)


def test_capytaine_over_periods(tmp_path: Path, barges: HydrodynamicDatabase) -> None:
    """Asked for periods, it has them on the axis, and frequencies as a variable over it."""
    path = tmp_path / "periods.nc"
    write_netcdf(path, barges)
    with h5py.File(path, "r+") as file:
        file["period"] = 2.0 * np.pi / file["omega"][()]
        file["period"].make_scale("period")
        for name in ("added_mass", "radiation_damping", "excitation_force"):
            place = [scales[0].name for scales in file[name].dims].index("/omega")
            file[name].dims[place].detach_scale(file["omega"])
            file[name].dims[place].attach_scale(file["period"])
        del file["omega"]
        file["omega"] = 2.0 * np.pi / file["period"][()]
        file["omega"].dims[0].attach_scale(file["period"])
    database = read_netcdf(path)
    np.testing.assert_allclose(database.omega, barges.omega, rtol=1e-12)
    np.testing.assert_array_equal(database.excitation, barges.excitation)


@pytest.mark.parametrize("missing", ["diffraction", "all"])
def test_capytaine_without_diffraction(tmp_path: Path, barges: HydrodynamicDatabase, missing: str) -> None:
    path = tmp_path / "radiation.nc"
    write_netcdf(path, barges)
    with h5py.File(path, "r+") as file:
        if missing == "diffraction":
            force = file["excitation_force"]
            part = file.create_dataset("Froude_Krylov_force", data=force[()])
            for place, axis in enumerate(("complex", "omega", "wave_direction", "influenced_dof")):
                part.dims[place].attach_scale(file[axis])
        del file["excitation_force"]
        del file["added_mass_infinite"]
    database = read_netcdf(path)
    assert (database.has_excitation, database.body_count) == (False, 2)
    np.testing.assert_array_equal(database.added_mass, barges.added_mass)
    words = " ".join(database.repairs)
    assert "no exciting forces" in words
    assert "Ogilvie" in words
    assert ("Froude-Krylov force or diffraction alone" in words) == (missing == "diffraction")
    # it is stored and read again with all that was told
    write_netcdf(tmp_path / "again.nc", database)
    again = read_netcdf(tmp_path / "again.nc")
    assert again.repairs == database.repairs
    np.testing.assert_array_equal(again.added_mass_infinite, database.added_mass_infinite)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("leave_out", (np.nan,)),
        ("leave_out", (1.0, -1.0)),
        ("leave_out", (np.inf,)),
        ("tolerance", np.nan),
        ("tolerance", -0.1),
        ("tolerance", 1.0),
        ("frequency_range", (np.nan, 1.0)),
        ("frequency_range", (1.0, np.nan)),
        ("frequency_range", (2.0, 1.0)),
        ("frequency_range", (-1.0, 1.0)),
    ],
)
def test_repairs_that_are_none(key, value):
    """What is not a number compares with nothing: every frequency would be kept, every deviation tolerated."""
    with pytest.raises(InputError, match=f"Repair: {key}: "):
        Repair(**{key: value})


@pytest.mark.parametrize(("wanted", "at"), [(1.0, 1.0), (1.004, 1.0), (0.6996, 0.7)])
def test_a_frequency_is_meant_by_a_number_near_to_it(wanted: float, at: float) -> None:
    refuse_between(wanted, np.arange(0.5, 1.55, 0.1))
    assert abs(wanted - at) < 0.01


@pytest.mark.parametrize("wanted", [1.04, 1.05, 0.95, 0.45, 1.6])
def test_a_frequency_between_others_does_not_take_its_neighbours_along(wanted: float) -> None:
    """Steps of 0.1 rad/s: 1.04 is none of them, and 1.0 is good."""
    with pytest.raises(InputError, match=r"leave_out: .* is none of the frequencies; .*the nearest are"):
        refuse_between(wanted, np.arange(0.5, 1.55, 0.1))
