"""Databases in netCDF files: our own, and Capytaine's."""

from __future__ import annotations

from dataclasses import replace

import h5py
import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.hydrodynamics.netcdf_files import read_digest, read_netcdf, write_netcdf

pytestmark = pytest.mark.usefixtures("numbers_of_no_hull")

ARRAYS = (
    "omega", "headings", "added_mass", "damping", "added_mass_infinite", "excitation", "reference_points",
    "drift", "volumes", "centres_of_buoyancy", "hydrostatic_stiffness",
)  # fmt: skip
DOFS = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")


@pytest.fixture
def database():
    """Two hulls, numbers without meaning but within what is physical."""
    rng = np.random.default_rng(7)
    n, nw, nh = 12, 3, 4
    scale = np.tile([1e5, 1e5, 1e5, 1e6, 1e6, 1e6], 2)
    spread = rng.normal(size=(nw, n, n))
    positive = np.einsum("wij,wkj->wik", spread, spread) / n + np.eye(n)
    matrices = positive * np.sqrt(np.outer(scale, scale))
    omega, headings = np.array([0.1, 0.7, 1.9]), np.array([0.0, 0.5, 1.5, 3.0])
    excitation = rng.normal(size=(nw, nh, n)) + 1j * rng.normal(size=(nw, nh, n))
    excitation[0, :, 0::6] = -1e3j * np.cos(headings)[:, None]
    excitation[0, :, 1::6] = -1e3j * np.sin(headings)[:, None]
    points = np.array([[-10.0, 0.0, 0.5], [12.0, 0.0, -0.5]])
    along = (
        (omega[:, None] ** 2 / 9.81)[..., None] * np.cos(headings)[None, :, None] * points[None, None, :, 0]
    )
    return HydrodynamicDatabase(
        bodies=("crane barge", "dock"),
        omega=omega,
        headings=headings,
        added_mass=matrices,
        damping=0.3 * matrices,
        added_mass_infinite=matrices[1],
        excitation=1e5 * excitation * np.exp(1j * np.repeat(along, 6, axis=2)),
        reference_points=points,
        density=1025.0,
        gravity=9.81,
        depth=np.inf,
        source="numbers",
        drift=rng.normal(size=(nw, nh, n)),
        volumes=np.array([500.0, 600.0]),
        centres_of_buoyancy=rng.normal(size=(2, 3)),
        hydrostatic_stiffness=rng.normal(size=(2, 6, 6)),
    )


@pytest.mark.parametrize("depth", [np.inf, 15.0])
def test_what_is_written_is_read_to_the_last_bit(tmp_path, database, depth):
    path = tmp_path / "sea.nc"
    # the phases are those of deep water: 15 m is as good as deep for the check of the longest wave only if it is met
    database = replace(database, depth=depth, symmetric=False)
    write_netcdf(path, database, digest="key of the inputs")
    back = read_netcdf(path)
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(back, name), getattr(database, name))
    assert back.bodies == database.bodies
    assert (back.density, back.gravity, back.depth) == (1025.0, 9.81, depth)
    assert back.symmetric is False
    assert read_digest(path) == "key of the inputs"


def test_optional_parts_may_be_missing_and_symmetry_is_kept(tmp_path, database):
    path = tmp_path / "sea.nc"
    even = np.tile([1, 0, 1, 0, 1, 0], 2)
    kept = even[:, None] == even[None, :]  # what hulls symmetric about y = 0 may have
    bare = replace(
        database,
        added_mass=database.added_mass * kept,
        added_mass_infinite=database.added_mass_infinite * kept,
        drift=None,
        volumes=None,
        centres_of_buoyancy=None,
        hydrostatic_stiffness=None,
        symmetric=True,
    )
    write_netcdf(path, bare)
    back = read_netcdf(path)
    assert back.symmetric
    assert back.drift is None
    assert back.volumes is None
    assert back.hydrostatic_stiffness is None
    assert read_digest(path) == ""
    assert read_digest(tmp_path / "none.nc") == ""


def test_our_files_open_with_xarray(tmp_path, database):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("netCDF4")
    path = tmp_path / "sea.nc"
    write_netcdf(path, database)
    with xarray.open_dataset(path, engine="netcdf4") as data:
        heave = data.added_mass.sel(
            omega=0.7, influenced_dof="dock__Heave", radiating_dof="crane barge__Surge", method=None
        )
        assert float(heave) == database.added_mass[1, 8, 0]
        force = data.excitation_force.sel(complex="im", influenced_dof="dock__Yaw").isel(
            omega=2, wave_direction=3
        )
        assert float(force) == database.excitation[2, 3, 11].imag
        assert data.omega.attrs["units"] == "rad/s"


def capytaine_arrays(database, order):
    """Variables as Capytaine has them, coordinates in another order, infinite frequency among the others."""
    mass = np.concatenate([database.added_mass, database.added_mass_infinite[None]])
    damping = np.concatenate([database.damping, np.zeros((1, 12, 12))])
    waves = np.concatenate([database.excitation, np.full((1, 4, 12), np.nan)])
    names = [f"{body}__{dof}" for body in database.bodies for dof in DOFS]
    return {
        "names": [names[i] for i in order],
        "omega": np.append(database.omega, np.inf),
        "mass": mass[:, order][:, :, order],
        "damping": damping[:, order][:, :, order],
        "part": 0.25 * waves[:, :, order],
        "rest": 0.75 * waves[:, :, order],
    }


def write_hdf5(path, database, order, **changes):
    """The layout of Capytaine in HDF5; matrices with the radiating coordinate first."""
    have = capytaine_arrays(database, order)
    with h5py.File(path, "w") as file:
        for name, values in (
            ("omega", have["omega"]),
            ("wave_direction", database.headings),
            ("radiating_dof", have["names"]),
            ("influenced_dof", have["names"]),
            ("complex", ["re", "im"]),
        ):
            scale = file.create_dataset(name, data=values)
            scale.make_scale(name)
        file["omega"].attrs["units"] = np.bytes_(b"rad/s")
        file["wave_direction"].attrs["units"] = np.bytes_(changes.get("heading_unit", b"rad"))
        square = ("radiating_dof", "omega", "influenced_dof")
        for name, axes, values in (
            ("added_mass", square, np.transpose(have["mass"], (2, 0, 1))),
            ("radiation_damping", square, np.transpose(have["damping"], (2, 0, 1))),
            ("Froude_Krylov_force", ("complex", "omega", "wave_direction", "influenced_dof"), have["part"]),
            ("diffraction_force", ("complex", "omega", "wave_direction", "influenced_dof"), have["rest"]),
        ):
            numbers = np.stack([values.real, values.imag]) if np.iscomplexobj(values) else values
            data = file.create_dataset(name, data=numbers)
            for place, axis in enumerate(axes):
                data.dims[place].attach_scale(file[axis])
        for name, value in (("rho", 1025.0), ("g", 9.81), ("water_depth", np.inf), ("forward_speed", 0.0)):
            file[name] = changes.get(name, value)
        file["rotation_center"] = database.reference_points
        file.attrs["capytaine_version"] = "3.0.0"


@pytest.fixture
def order():
    return np.random.default_rng(3).permutation(12)


def same_coefficients(back, database):
    for name in ("omega", "headings", "added_mass", "damping", "added_mass_infinite", "reference_points"):
        np.testing.assert_array_equal(getattr(back, name), getattr(database, name))
    np.testing.assert_allclose(back.excitation, database.excitation, rtol=1e-14)


def test_coordinates_in_any_order(tmp_path, database, order):
    path = tmp_path / "capytaine.nc"
    # hulls keep the order in which they are first named
    order = np.concatenate([order[order < 6], order[order >= 6]])
    write_hdf5(path, database, order)
    same_coefficients(read_netcdf(path), database)


def test_classic_files_of_version_3(tmp_path, database):
    from scipy.io import netcdf_file

    path = tmp_path / "classic.nc"
    have = capytaine_arrays(database, np.arange(12))
    with netcdf_file(path, "w") as file:
        for name, size in (
            ("omega", 4), ("wave_direction", 4), ("influenced_dof", 12), ("radiating_dof", 12), ("complex", 2),
            ("letters", 24), ("body", 2), ("space_coordinate", 3),
        ):  # fmt: skip
            file.createDimension(name, size)

        def put(name, axes, values):
            variable = file.createVariable(name, "d", axes)
            variable[...] = values

        for name in ("influenced_dof", "radiating_dof"):
            variable = file.createVariable(name, "c", (name, "letters"))
            variable[:] = np.array([list(text.ljust(24, "\0")) for text in have["names"]], dtype="S1")
        put("omega", ("omega",), have["omega"])
        put("wave_direction", ("wave_direction",), database.headings)
        put("added_mass", ("omega", "influenced_dof", "radiating_dof"), have["mass"])
        put("radiation_damping", ("omega", "influenced_dof", "radiating_dof"), have["damping"])
        whole = have["part"] + have["rest"]
        waves = ("omega", "wave_direction", "influenced_dof", "complex")
        put("excitation_force", waves, np.stack([whole.real, whole.imag], axis=-1))
        put("rotation_center", ("body", "space_coordinate"), database.reference_points)
        for name, value in (("rho", 1025.0), ("g", 9.81), ("water_depth", np.inf)):
            put(name, (), value)
        file.capytaine_version = "2.2"
    same_coefficients(read_netcdf(path), database)


def drop(name):
    def change(file):
        del file[name]

    return change


def set_attribute(name, value):
    def change(file):
        file.attrs[name] = value

    return change


def finite_only(file):
    file["omega"][3] = 5.0
    file["Froude_Krylov_force"][:, 3] = 0.0
    file["diffraction_force"][:, 3] = 0.0


def without_version(file):
    del file.attrs["capytaine_version"]


def moving(file):
    file["forward_speed"][()] = 2.0


def elastic(file):
    file["influenced_dof"][3] = file["radiating_dof"][3] = "dock__Bending"


def two_depths(file):
    del file["water_depth"]
    file["water_depth"] = [10.0, 20.0]


BAD = {
    "unit": (
        lambda f: f["wave_direction"].attrs.__setitem__("units", np.bytes_(b"deg")),
        "unit is 'deg'.*'rad'",
    ),
    "time convention": (without_version, "time convention is not stated"),
    "other convention": (set_attribute("time_convention", "cos"), "time convention is 'cos'"),
    "conjugated": (set_attribute("time_convention", "exp(+i omega t)"), r"exp\(-i omega t\)"),
    "infinite": (finite_only, "no added mass of infinite frequency.*scatters"),
    "reference": (drop("rotation_center"), "reference point of moments is not stated"),
    "missing": (drop("radiation_damping"), "there is no 'radiation_damping'"),
    "speed": (moving, "a forward speed"),
    "elastic": (elastic, "Surge, Sway, Heave, Roll, Pitch, Yaw of each hull"),
    "two depths": (two_depths, "2 values.*one"),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", BAD)
def test_files_that_cannot_be_used(tmp_path, database, kind):
    change, message = BAD[kind]
    path = tmp_path / "capytaine.nc"
    write_hdf5(path, database, np.arange(12))
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(InputError, match=message) as caught:
        read_netcdf(path)
    assert "capytaine.nc" in str(caught.value)


def test_what_a_file_does_not_state_can_be_given(tmp_path, database):
    path = tmp_path / "other.nc"
    write_hdf5(path, replace(database, excitation=database.excitation.conj()), np.arange(12))
    with h5py.File(path, "r+") as file:
        del file.attrs["capytaine_version"]
        del file["rotation_center"]
    back = read_netcdf(path, time_convention="exp(+i omega t)", reference_points=database.reference_points)
    same_coefficients(back, database)


def test_reference_points_that_disagree_are_refused(tmp_path, database):
    path = tmp_path / "sea.nc"
    write_netcdf(path, database)
    with pytest.raises(InputError, match="expected the reference points"):
        read_netcdf(path, reference_points=np.zeros((2, 3)))


def test_no_file_and_no_netcdf(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_netcdf(tmp_path / "none.nc")
    (tmp_path / "text.nc").write_text("omega\n")
    with pytest.raises(InputError, match="a netCDF file"):
        read_netcdf(tmp_path / "text.nc")


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2])
def test_files_that_capytaine_writes(tmp_path, count):
    capytaine = pytest.importorskip("capytaine")
    xarray = pytest.importorskip("xarray")
    capytaine.set_logging("ERROR")
    bodies = []
    for b in range(count):
        mesh = capytaine.mesh_parallelepiped(
            size=(20.0, 8.0, 6.0), resolution=(5, 2, 2), center=(30.0 * b, 0.0, 0.0)
        ).immersed_part()
        bodies.append(
            capytaine.FloatingBody(
                mesh=mesh,
                dofs=capytaine.rigid_body_dofs(rotation_center=(30.0 * b, 0.0, -0.5)),
                center_of_mass=(30.0 * b, 0.0, 1.5),
                name=f"hull{b}",
            )
        )
    body = bodies[0] if count == 1 else capytaine.Multibody(bodies)
    wanted = xarray.Dataset(
        coords={
            "omega": [0.2, 0.6, np.inf],
            "wave_direction": [0.0, 0.5, np.pi],
            "radiating_dof": list(body.dofs),
            "rho": [1025.0],
        }
    )
    data = capytaine.BEMSolver().fill_dataset(wanted, [body], progress_bar=False, _check_wavelength=False)
    path = tmp_path / "capytaine.nc"
    capytaine.export_dataset(path, data)
    back = read_netcdf(path)
    assert back.body_count == count
    names = [f"hull{b}__{dof}" if count > 1 else dof for b in range(count) for dof in DOFS]
    for i, influenced in enumerate(names):
        for j, radiating in enumerate(names):
            entry = data.sel(influenced_dof=influenced, radiating_dof=radiating)
            np.testing.assert_array_equal(back.added_mass[:, i, j], entry.added_mass.values[:2])
            np.testing.assert_array_equal(back.damping[:, i, j], entry.radiation_damping.values[:2])
            assert back.added_mass_infinite[i, j] == entry.added_mass.values[2]
        force = data.sel(influenced_dof=influenced).excitation_force.values[:2]
        np.testing.assert_array_equal(back.excitation[:, :, i], force)
    np.testing.assert_allclose(back.volumes, 480.0, rtol=1e-12)
    np.testing.assert_array_equal(back.reference_points[:, 0], 30.0 * np.arange(count))
    # without weight, about 0.5 m below the water: rho g (int y^2 dA + V (z_B - z_ref)); Capytaine takes the integral
    # from the middles of panels, here two rows at 2 m
    roll = 1025.0 * 9.81 * (160.0 * 2.0**2 + 480.0 * (-1.5 + 0.5))
    np.testing.assert_allclose(back.hydrostatic_stiffness[:, 2, 2], 1025.0 * 9.81 * 160.0, rtol=1e-9)
    np.testing.assert_allclose(back.hydrostatic_stiffness[:, 3, 3], roll, rtol=1e-9)
