"""Databases from BEMIO files, written here from known numbers."""

from __future__ import annotations

import h5py
import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.bemio_files import read_bemio

DENSITY, GRAVITY = 1000.0, 9.81
OMEGA, DEGREES = np.array([0.2, 0.9, 1.6, 2.2]), np.array([0.0, 60.0, 180.0])
CENTRES = np.array([[0.0, 0.0, -0.7], [30.0, 0.0, -2.0]])


pytestmark = pytest.mark.usefixtures("numbers_of_no_hull")


@pytest.fixture(scope="module")
def truth():
    rng = np.random.default_rng(5)
    scale = np.tile([4e5, 4e5, 9e5, 5e6, 5e6, 1e6], 2)
    size = np.sqrt(np.outer(scale, scale))
    spread = rng.normal(size=(5, 12, 12))
    positive = np.eye(12) + np.einsum("wij,wkj->wik", spread, spread) / 24.0
    mass, infinite = positive[:4] * size, positive[4] * size
    heading = np.deg2rad(DEGREES)
    force = 1e5 * (rng.normal(size=(4, 3, 12)) + 1j * rng.normal(size=(4, 3, 12)))
    force[0, :, 0::6] = -1e4j * np.cos(heading)[:, None]
    force[0, :, 1::6] = -1e4j * np.sin(heading)[:, None]
    along = np.cos(heading)[:, None] * CENTRES[:, 0]
    force *= np.exp(1j * np.repeat((OMEGA**2 / GRAVITY)[:, None, None] * along[None], 6, axis=2))
    return {
        "mass": mass,
        "infinite": infinite,
        "damping": 0.1 * mass * OMEGA[:, None, None],
        "force": force,
        "drift": rng.normal(size=(4, 3, 12)) * 1e3,
        "stiffness": rng.normal(size=(2, 6, 6)) * 1e6,
    }


def write(path, truth, *, scaled=False, depth="infinite", backwards=False, drift=False):
    """Columns of MATLAB become rows: (6, 6N, nw) and (6, nh, nw)."""
    order = np.arange(4)[::-1] if backwards else np.arange(4)
    rho, weight = (1.0, 1.0) if scaled else (DENSITY, DENSITY * GRAVITY)
    with h5py.File(path, "w") as file:
        sea = file.create_group("simulation_parameters")
        sea["scaled"] = np.array([[float(scaled)]])
        sea["rho"], sea["g"] = np.array([[DENSITY]]), np.array([[GRAVITY]])
        sea["w"], sea["T"] = OMEGA[order][:, None], 2.0 * np.pi / OMEGA[order][:, None]
        sea["wave_dir"] = DEGREES[:, None]
        sea["water_depth"] = np.bytes_(depth.encode()) if isinstance(depth, str) else np.array([[depth]])
        for b in range(2):
            rows = slice(6 * b, 6 * b + 6)
            group = file.create_group(f"body{b + 1}")
            damping = truth["damping"] if scaled else truth["damping"] / (DENSITY * OMEGA[:, None, None])
            group["hydro_coeffs/added_mass/all"] = np.transpose(
                truth["mass"][order][:, rows] / rho, (1, 2, 0)
            )
            group["hydro_coeffs/added_mass/inf_freq"] = truth["infinite"][rows] / rho
            group["hydro_coeffs/radiation_damping/all"] = np.transpose(damping[order][:, rows], (1, 2, 0))
            force = np.transpose(truth["force"][order][:, :, rows].conj() / weight, (2, 1, 0))
            group["hydro_coeffs/excitation/re"], group["hydro_coeffs/excitation/im"] = force.real, force.imag
            group["hydro_coeffs/linear_restoring_stiffness"] = truth["stiffness"][b] / weight
            if drift:
                values = np.transpose(truth["drift"][order][:, :, rows] / weight, (2, 1, 0))
                group["hydro_coeffs/mean_drift/pressure_integration/val"] = values
                group["hydro_coeffs/mean_drift/momentum_conservation/val"] = 0.0 * values
            group["properties/name"] = np.bytes_(["float", "spar"][b].encode())
            group["properties/cg"] = CENTRES[b][:, None]
            group["properties/cb"] = CENTRES[b][:, None] - [[0.0], [0.0], [0.5]]
            group["properties/disp_vol"] = np.array([[700.0 + b]])


@pytest.mark.parametrize("scaled", [False, True])
@pytest.mark.parametrize("backwards", [False, True])
def test_numbers_in_si_units_and_our_time_convention(tmp_path, truth, scaled, backwards):
    path = tmp_path / "rm3.h5"
    write(path, truth, scaled=scaled, backwards=backwards)
    database = read_bemio(path)
    np.testing.assert_array_equal(database.omega, OMEGA)
    np.testing.assert_allclose(database.headings, np.deg2rad(DEGREES))
    np.testing.assert_allclose(database.added_mass, truth["mass"], rtol=1e-12)
    np.testing.assert_allclose(database.damping, truth["damping"], rtol=1e-12)
    np.testing.assert_allclose(database.added_mass_infinite, truth["infinite"], rtol=1e-12)
    np.testing.assert_allclose(database.excitation, truth["force"], rtol=1e-12)
    np.testing.assert_allclose(database.hydrostatic_stiffness, truth["stiffness"], rtol=1e-12)
    np.testing.assert_array_equal(database.reference_points, CENTRES)
    np.testing.assert_allclose(database.centres_of_buoyancy, CENTRES - [0.0, 0.0, 0.5])
    np.testing.assert_array_equal(database.volumes, [700.0, 701.0])
    assert database.bodies == ("float", "spar")
    assert database.depth == np.inf


def test_mean_drift_where_it_is_given(tmp_path, truth):
    path = tmp_path / "rm3.h5"
    write(path, truth)
    assert read_bemio(path).drift is None
    write(path, truth, drift=True, backwards=True)
    np.testing.assert_allclose(read_bemio(path).drift, truth["drift"], rtol=1e-12)


def test_radiation_alone_serves_still_water(tmp_path, truth):
    path = tmp_path / "rm3.h5"
    write(path, truth)
    with h5py.File(path, "r+") as file:
        for b in (1, 2):
            del file[f"body{b}/hydro_coeffs/excitation"]
    database = read_bemio(path)
    assert not database.has_excitation
    assert database.repairs == ("no exciting forces: for motions in still water",)
    np.testing.assert_allclose(database.added_mass, truth["mass"], rtol=1e-12)
    with h5py.File(path, "r+") as file:
        for b in (1, 2):
            del file[f"body{b}/hydro_coeffs/added_mass/inf_freq"]
    with pytest.raises(InputError, match="no added mass of infinite frequency"):  # numbers without a kernel
        read_bemio(path)


def test_other_reference_points_leave_the_restoring_out(tmp_path, truth):
    path = tmp_path / "rm3.h5"
    write(path, truth)
    points = CENTRES + np.array([0.0, 0.0, 1.0])
    database = read_bemio(path, reference_points=points)
    np.testing.assert_array_equal(database.reference_points, points)
    assert database.hydrostatic_stiffness is None


def test_depth_is_a_number_or_a_word(tmp_path, truth):
    path = tmp_path / "rm3.h5"
    write(path, truth, depth=90.0)
    assert read_bemio(path).depth == 90.0
    write(path, truth, depth="shallow")
    with pytest.raises(InputError, match="metres or 'infinite'"):
        read_bemio(path)


def remove(name):
    def change(file):
        del file[name]

    return change


def alone(file):
    """Coefficients of one body without the other."""
    del file["body1/hydro_coeffs/added_mass/all"]
    file["body1/hydro_coeffs/added_mass/all"] = np.ones((6, 6, 4))


def conjugated(file):
    for b in (1, 2):
        file[f"body{b}/hydro_coeffs/excitation/im"][...] *= -1.0


def in_tonnes(file):
    file["simulation_parameters/rho"][...] = 1.0


BAD = {
    "missing": (remove("body2/hydro_coeffs/excitation/im"), "there is no 'body2/hydro_coeffs/excitation/im'"),
    "sea": (remove("simulation_parameters/g"), "there is no 'simulation_parameters/g'"),
    "alone": (alone, r"shape \(6, 6, 4\).*all bodies in one computation"),
    "conjugated": (conjugated, "time convention"),
    "tonnes": (in_tonnes, "density"),
    "bodies": (lambda f: (f.__delitem__("body1"), f.__delitem__("body2")), "no group 'body1'"),
}


@pytest.mark.parametrize("kind", BAD)
def test_files_that_cannot_be_used(tmp_path, truth, kind):
    change, message = BAD[kind]
    path = tmp_path / "rm3.h5"
    write(path, truth)
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(InputError, match=message) as caught:
        read_bemio(path)
    assert "rm3.h5" in str(caught.value)


def test_no_file(tmp_path):
    with pytest.raises(InputError, match="no such HDF5 file"):
        read_bemio(tmp_path / "none.h5")
    (tmp_path / "text.h5").write_text("body1")
    with pytest.raises(InputError, match="no such HDF5 file"):
        read_bemio(tmp_path / "text.h5")
