"""Databases from files of WAMIT: written here from known numbers by the formulas of its manual, chapters 3 and 5."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.wamit_files import read_wamit, read_wamit_out
from heavylift.preprocess.hydrodynamics.words import FirstColumn

DENSITY, GRAVITY, LENGTH, DEPTH = 1025.0, 9.80665, 2.5, 60.0
OMEGA = np.array([0.15, 0.6, 1.4])
DEGREES = np.array([0.0, 30.0, 180.0])
ORIGINS = np.array([[-20.0, 0.0, 0.0], [25.0, 0.0, -1.5]])
VOLUMES = np.array([500.0, 620.0])
ROTATION = np.array([0, 0, 0, 1, 1, 1] * 2)


class Truth:
    """Numbers of two hulls in SI units; forces for exp(-i omega t)."""

    def __init__(self):
        rng = np.random.default_rng(11)
        scale = np.tile([3e5, 3e5, 5e5, 4e6, 6e6, 7e6], 2)
        size = np.sqrt(np.outer(scale, scale))
        spread = rng.normal(size=(5, 12, 12))
        self.zero, self.infinite, *self.mass = (np.eye(12) + s @ s.T / 24.0 for s in spread)
        self.zero, self.infinite = self.zero * size, self.infinite * size
        self.mass = np.array(self.mass) * size
        self.damping = 0.2 * self.mass * OMEGA[:, None, None]
        k = np.array([_wave_number(w) for w in OMEGA])
        heading = np.deg2rad(DEGREES)
        shape = (len(OMEGA), len(DEGREES), 12)
        force = 1e5 * (rng.normal(size=shape) + 1j * rng.normal(size=shape))
        force[0, :, 0::6] = -2e4j * np.cos(heading)[:, None]
        force[0, :, 1::6] = -2e4j * np.sin(heading)[:, None]
        along = np.cos(heading)[:, None] * ORIGINS[:, 0]
        self.force = force * np.exp(1j * np.repeat(k[:, None, None] * along[None], 6, axis=2))
        self.stiffness = np.zeros((2, 6, 6))
        for b in range(2):
            self.stiffness[b, 2, 2] = 1e6 * (b + 1)
            self.stiffness[b, 3, 3], self.stiffness[b, 4, 4] = 2e7, 9e7
            self.stiffness[b, 2, 4] = self.stiffness[b, 4, 2] = 3e5
            self.stiffness[b, 3, 4] = self.stiffness[b, 4, 3] = -4e4
            self.stiffness[b, 2, 3] = self.stiffness[b, 3, 2] = 1e4
            self.stiffness[b, 3, 5], self.stiffness[b, 4, 5] = 2e4, -3e4


pytestmark = pytest.mark.usefixtures("numbers_of_no_hull")


def _wave_number(omega):
    k = omega**2 / GRAVITY
    for _ in range(200):
        k = 0.5 * (k + omega**2 / (GRAVITY * np.tanh(k * DEPTH)))
    return k


@pytest.fixture(scope="module")
def truth():
    return Truth()


def mass_unit(i, j):
    return DENSITY * LENGTH ** (3 + ROTATION[i] + ROTATION[j])


def force_unit(i):
    return DENSITY * GRAVITY * LENGTH ** (2 + ROTATION[i])


def restoring_unit(i, j):
    return DENSITY * GRAVITY * LENGTH ** (2 + ROTATION[i] + ROTATION[j])


def weights(stiffness, arms):
    """What the weight of the displaced water adds: C44, C55 - m g z_G, C46 + m g x_G, C56 + m g y_G."""
    whole = stiffness.copy()
    for b, (x, y, z) in enumerate(arms):
        weight = DENSITY * GRAVITY * VOLUMES[b]
        whole[b, 3, 3] -= weight * z
        whole[b, 4, 4] -= weight * z
        whole[b, 3, 5] += weight * x
        whole[b, 4, 5] += weight * y
    return whole


def write_numeric(base, truth, *, column="period", skip=(), arms=None, header=False):
    """.1, .3 and .hst."""
    special = {"period": ("-1.0", "0.0"), "frequency": ("0.0", "-1.0")}[column]
    first = 2.0 * np.pi / OMEGA if column == "period" else OMEGA
    rows = [" PER I J A B"] if header else []
    for word, matrix in zip(special, (truth.zero, truth.infinite), strict=True):
        if word in skip:
            continue
        rows += [
            f" {word} {i + 1} {j + 1} {matrix[i, j] / mass_unit(i, j):.9E}"
            for i in range(12)
            for j in range(12)
        ]
    for w in reversed(range(3)):  # short periods first
        for i in range(12):
            for j in range(12):
                if (i, j) in skip:
                    continue
                a = truth.mass[w, i, j] / mass_unit(i, j)
                b = truth.damping[w, i, j] / (mass_unit(i, j) * OMEGA[w])
                rows.append(f" {first[w]:.9E} {i + 1} {j + 1} {a:.9E} {b:.9E}")
    base.with_suffix(".1").write_text("\n".join(rows) + "\n")
    rows = []
    for w in reversed(range(3)):
        for h, degrees in enumerate(DEGREES):
            if ("heading", h, w) in skip:
                continue
            for i in range(12):
                x = truth.force[w, h, i].conjugate() / force_unit(i)
                phase = np.rad2deg(np.angle(x))
                rows.append(
                    f" {first[w]:.9E} {degrees:.4f} {i + 1} {abs(x):.9E} {phase:.3f} {x.real:.9E} {x.imag:.9E}"
                )
    base.with_suffix(".3").write_text("\n".join(rows) + "\n")
    whole = weights(truth.stiffness, np.zeros((2, 3)) if arms is None else arms)
    rows = [
        f" {6 * b + i + 1} {6 * b + j + 1} {whole[b, i, j] / restoring_unit(i, j):.9E}"
        for b in range(2)
        for i in range(6)
        for j in range(6)
    ]
    base.with_suffix(".hst").write_text("\n".join(rows) + "\n")


def read(base, **changes):
    given = {
        "length": LENGTH,
        "density": DENSITY,
        "gravity": GRAVITY,
        "depth": DEPTH,
        "reference_points": ORIGINS,
        "bodies": ("crane", "ship"),
        "volumes": VOLUMES,
        "centres_of_buoyancy": [[0.0, 0.0, -1.0], [0.0, 0.0, -2.0]],
    }
    return read_wamit(base, **{**given, **changes})


def same(database, truth, *, force=1e-8):
    np.testing.assert_allclose(database.omega, OMEGA, rtol=1e-6)
    np.testing.assert_allclose(database.headings, np.deg2rad(DEGREES), atol=1e-12)
    np.testing.assert_allclose(database.added_mass, truth.mass, rtol=1e-6)
    np.testing.assert_allclose(database.damping, truth.damping, rtol=1e-6)
    np.testing.assert_allclose(database.added_mass_infinite, truth.infinite, rtol=1e-6)
    np.testing.assert_allclose(database.excitation, truth.force, atol=force * np.abs(truth.force).max())
    np.testing.assert_array_equal(database.reference_points, ORIGINS)


@pytest.mark.parametrize("column", get_args(FirstColumn))
@pytest.mark.parametrize("header", [False, True])
def test_numeric_files(tmp_path, truth, column, header):
    base = tmp_path / "two"
    write_numeric(base, truth, column=column, header=header)
    database = read(base, first_column=column)
    same(database, truth)
    np.testing.assert_allclose(database.hydrostatic_stiffness, truth.stiffness, rtol=1e-7)
    assert database.bodies == ("crane", "ship")
    assert (database.density, database.gravity, database.depth) == (DENSITY, GRAVITY, DEPTH)
    same(read(base.with_suffix(".3"), first_column=column), truth)  # any of the three names will do


def test_weight_is_taken_out_of_the_restoring(tmp_path, truth):
    arms = np.array([[0.5, 0.0, 3.0], [-1.0, 0.2, 4.0]])
    write_numeric(tmp_path / "two", truth, arms=arms)
    database = read(tmp_path / "two", centres_of_gravity=arms)
    np.testing.assert_allclose(database.hydrostatic_stiffness, truth.stiffness, rtol=1e-6)
    with pytest.raises(InputError, match="contain the weight"):
        read(tmp_path / "two", centres_of_gravity=arms, volumes=None)


def test_entries_left_out_are_zero_and_restoring_may_be_missing(tmp_path, truth):
    write_numeric(tmp_path / "two", truth, skip={(0, 1), (1, 0)})
    (tmp_path / "two.hst").unlink()
    database = read(tmp_path / "two")
    assert np.all(database.added_mass[:, 0, 1] == 0.0)
    assert np.all(database.damping[:, 1, 0] == 0.0)
    assert database.hydrostatic_stiffness is None


def write_drift(path, drift, *, skip=()):
    """Rows of two headings; those of two that differ are not mean drift of one wave."""
    rows = []
    for w in range(3):
        for h, degrees in enumerate(DEGREES):
            if (w, h) in skip:
                continue
            for i in range(12):
                value = drift[w, h, i] / (DENSITY * GRAVITY * LENGTH ** (1 + ROTATION[i]))
                row = f"{i + 1} {abs(value):.9E} 0.0 {value:.9E} 0.0"
                rows += [
                    f"{2 * np.pi / OMEGA[w]:.7E} {degrees} {degrees} {row}",
                    f"{2 * np.pi / OMEGA[w]:.7E} 0 30 {row}",
                ]
    path.write_text("\n".join(rows) + "\n")


def test_mean_drift_where_it_is_given(tmp_path, truth):
    base = tmp_path / "two"
    drift = np.random.default_rng(2).normal(size=(3, 3, 12)) * 1e4
    write_numeric(base, truth)
    assert read(base).drift is None
    write_drift(tmp_path / "two.8", drift)  # of all bodies together: no use for two
    assert read(base).drift is None
    write_drift(tmp_path / "two.9", drift)
    np.testing.assert_allclose(read(base).drift, drift, rtol=1e-6)
    write_drift(tmp_path / "two.9", drift, skip={(1, 2)})
    with pytest.raises(InputError, match=r"no mean drift at 0\.6 rad/s, 180 deg"):
        read(base)
    (tmp_path / "two.9").write_text("7.0 0.0 0.0 1 1.0 0.0 1.0 0.0\n")
    with pytest.raises(InputError, match="frequencies, headings and modes of the exciting forces"):
        read(base)


def test_numeric_files_that_cannot_be_used(tmp_path, truth):
    base = tmp_path / "two"
    with pytest.raises(InputError, match="no such file"):
        read(base)
    write_numeric(base, truth, skip={("heading", 1, 2)})  # two frequencies are no database
    with pytest.raises(InputError, match=r"there is no excitation of crane surge at .* rad/s, 30 deg"):
        read(base)
    write_numeric(base, truth, skip={("heading", h, 2) for h in range(3)})
    with pytest.raises(InputError, match="2 of 3 frequencies are left with finite numbers"):
        read(base)
    write_numeric(base, truth)
    with pytest.raises(InputError, match=r"coefficient \(1, 7\)"):
        read(base, reference_points=ORIGINS[:1], bodies=("crane",), volumes=None, centres_of_buoyancy=None)
    with pytest.raises(InputError, match="first_column"):
        read(base, first_column="omega")
    with pytest.raises(InputError, match="3 names"):
        read(base, bodies=("a", "b", "c"))
    with pytest.raises(InputError, match="tonnes for kilograms"):  # ULEN forgotten
        read(base, length=250.0)
    path = base.with_suffix(".3")
    path.write_text(path.read_text().replace(" 30.0000 ", " thirty ", 1))
    with pytest.raises(InputError, match=r"line \d+.*numbers"):
        read(base)
    path.write_text("1.0 0.0 1 2.0\n")
    with pytest.raises(InputError, match=r"line 1: 4 columns; expected 7"):
        read(base)


def test_phase_of_the_other_convention_is_noticed(tmp_path, truth):
    base = tmp_path / "two"
    write_numeric(base, truth)
    rows = [line.split() for line in base.with_suffix(".3").read_text().splitlines()]
    base.with_suffix(".3").write_text("\n".join(" ".join([*r[:6], str(-float(r[6]))]) for r in rows) + "\n")
    with pytest.raises(InputError, match="time convention"):
        read(base)


def listing(truth, *, depth="60.0000", extra="", turn=0.0, zero_period=True):
    """The parts of a listing that carry numbers, among others that do not."""
    lines = [
        " " + "-" * 71,
        "                        WAMIT  Version 7.2(x64)        ",
        " Input from Geometric Data Files:                                       ",
        "                               N=  1     crane.gdf                      ",
        "   Period       Time           RAD      DIFF  (max iterations)          ",
        "   -1.0000    09:05:20          -1                                      ",
        "    0.0000    09:05:21          -1                                      ",
        *(f"{2 * np.pi / w:10.4f}    09:06:0{i}          -1      -1" for i, w in enumerate(OMEGA)),
        f" Gravity:     {GRAVITY:.5f}                Length scale:        {LENGTH:.5f}",
        f" Water depth:        {depth}{extra}",
        " BODY PARAMETERS:",
    ]
    arms = np.array([[0.0, 0.0, 2.0], [0.3, 0.0, -1.0]])
    whole = weights(truth.stiffness, arms)
    for b, (x, y, z) in enumerate(ORIGINS):
        c = np.array([[whole[b, i, j] / restoring_unit(i, j) for j in range(6)] for i in range(6)])
        lines += [
            f" Body number: N= {b + 1}       Total panels:  1728    Waterline panels:  144",
            f" XBODY = {x:9.4f} YBODY = {y:9.4f} ZBODY = {z:9.4f} PHIBODY = {turn:5.1f}",
            " Volumes (VOLX,VOLY,VOLZ):  " + " ".join(f"{VOLUMES[b] + d:.6f}" for d in (-0.1, 0.0, 0.2)),
            " Center of Buoyancy (Xb,Yb,Zb):     0.500000     0.000000    -1.250000",
            " Hydrostatic and gravitational restoring coefficients: ",
            f" C(3,3),C(3,4),C(3,5):   {c[2, 2]:.8E}  {c[2, 3]:.8E} {c[2, 4]:.8E}",
            f" C(4,4),C(4,5),C(4,6):      {c[3, 3]:.8E} {c[3, 4]:.8E} {c[3, 5]:.8E}",
            f"        C(5,5),C(5,6):             {c[4, 4]:.8E} {c[4, 5]:.8E}",
            " Center of Gravity  (Xg,Yg,Zg):  " + " ".join(f"{v:.6f}" for v in arms[b]),
            " Radii of gyration:     0.000000     0.000000     0.000000",
        ]
    specials = [("infinite", "zero ", truth.zero)] + (
        [("zero", "infinite ", truth.infinite)] if zero_period else []
    )
    for word, other, matrix in specials:
        lines += [
            " " + "*" * 72,
            f" Wave period = {word}                                 Wavenumber = {other}",
            "    ADDED-MASS COEFFICIENTS",
            "     I     J         A(I,J)",
            "",
        ]
        lines += [
            f"    {i + 1:2d}    {j + 1:2d}   {matrix[i, j] / mass_unit(i, j):.8E}"
            for i in range(12)
            for j in range(12)
        ]
    for w in reversed(range(3)):
        lines += [
            " " + "*" * 72,
            f" Wave period (sec) =  {2 * np.pi / OMEGA[w]:.8E}        Wavenumber (kL) =  4.077472E-05",
            "    ADDED-MASS AND DAMPING COEFFICIENTS",
            "     I     J         A(I,J)         B(I,J)",
            "",
        ]
        for i in range(12):
            for j in range(12):
                unit = mass_unit(i, j)
                a, b = truth.mass[w, i, j] / unit, truth.damping[w, i, j] / (unit * OMEGA[w])
                lines.append(f"    {i + 1:2d}    {j + 1:2d}   {a:.8E}   {b:.8E}")
        for name, factor in (("HASKIND", 1.01), ("DIFFRACTION", 1.0)):
            lines += ["", f"    {name} EXCITING FORCES AND MOMENTS", ""]
            for h, degrees in enumerate(DEGREES):
                lines += [
                    f"  Wave Heading (deg) :    {degrees:5.1f}",
                    "",
                    "     I     Mod[Xh(I)]     Pha[Xh(I)]",
                    "",
                ]
                for i in range(12):
                    x = factor * truth.force[w, h, i].conjugate() / force_unit(i)
                    lines.append(
                        f"    {i + 1:2d}   {abs(x):.8E}           {round(np.rad2deg(np.angle(x))):4d}"
                    )
        lines += ["", "    RESPONSE AMPLITUDE OPERATORS", "", "  Wave Heading (deg) :      0", ""]
        lines += [f"    {i + 1:2d}    9.40403E-01            -90" for i in range(12)]
    return "\n".join(lines) + "\n"


def test_listing(tmp_path, truth):
    path = tmp_path / "two.out"
    path.write_text(listing(truth))
    database = read_wamit_out(path, density=DENSITY, bodies=("crane", "ship"))
    same(database, truth, force=np.deg2rad(0.51))  # phases are whole degrees
    np.testing.assert_allclose(np.abs(database.excitation), np.abs(truth.force), rtol=1e-6)
    np.testing.assert_allclose(database.hydrostatic_stiffness, truth.stiffness, rtol=1e-6)
    np.testing.assert_allclose(database.volumes, VOLUMES)
    np.testing.assert_allclose(database.centres_of_buoyancy, ORIGINS + np.array([0.5, 0.0, -1.25]))
    assert database.depth == DEPTH
    haskind = read_wamit_out(path, density=DENSITY, forces="haskind")
    np.testing.assert_allclose(haskind.excitation, 1.01 * database.excitation, rtol=1e-6)
    assert haskind.bodies == ("body1", "body2")


def test_listings_that_cannot_be_used(tmp_path, truth):
    path = tmp_path / "two.out"
    with pytest.raises(InputError, match="no such file"):
        read_wamit_out(path, density=DENSITY)
    path.write_text("nothing\n")
    with pytest.raises(InputError, match="a listing of WAMIT"):
        read_wamit_out(path, density=DENSITY)
    path.write_text(listing(truth, extra="        Water density:    1000.00000"))
    with pytest.raises(InputError, match="expected what the listing states, 1000"):
        read_wamit_out(path, density=DENSITY)
    path.write_text(listing(truth, turn=30.0))
    with pytest.raises(InputError, match="PHIBODY = 30 deg"):
        read_wamit_out(path, density=DENSITY)
    path.write_text(listing(truth, zero_period=False))
    with pytest.raises(InputError, match="no added mass of infinite frequency"):
        read_wamit_out(path, density=DENSITY)
    with pytest.raises(InputError, match="diffraction or haskind"):
        read_wamit_out(path, density=DENSITY, forces="rao")
    path.write_text(listing(truth, depth="infinite"))
    assert read_wamit_out(path, density=DENSITY).depth == np.inf


def test_what_capytaine_exports_for_wamit(tmp_path):
    """An independent writer: the same numbers by way of netCDF and by way of .1 and .3."""
    capytaine = pytest.importorskip("capytaine")
    xarray = pytest.importorskip("xarray")
    from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

    capytaine.set_logging("ERROR")
    mesh = capytaine.mesh_parallelepiped(size=(20.0, 8.0, 6.0), resolution=(5, 2, 2)).immersed_part()
    body = capytaine.FloatingBody(
        mesh=mesh,
        dofs=capytaine.rigid_body_dofs(rotation_center=(0, 0, 0)),
        center_of_mass=(0.0, 0.0, 1.0),
        name="box",
    )
    wanted = xarray.Dataset(
        coords={
            "omega": [0.3, 0.8, np.inf],
            "wave_direction": [0.0, 1.0, np.pi],
            "radiating_dof": list(body.dofs),
            "rho": [DENSITY],
            "g": [GRAVITY],
        }
    )
    data = capytaine.BEMSolver().fill_dataset(wanted, [body], progress_bar=False, _check_wavelength=False)
    capytaine.export_dataset(tmp_path / "box.nc", data)
    from capytaine.io.wamit import export_to_wamit

    export_to_wamit(data, str(tmp_path / "box"), exports=("1", "3"))
    expected = read_netcdf(tmp_path / "box.nc")
    found = read_wamit(tmp_path / "box", density=DENSITY, gravity=GRAVITY, depth=np.inf)
    for name in ("omega", "headings", "excitation"):
        values = getattr(expected, name)
        np.testing.assert_allclose(getattr(found, name), values, atol=2e-6 * np.abs(values).max())
    for name in ("added_mass", "damping", "added_mass_infinite"):
        # it numbers (motion, force) where WAMIT has (force, motion): the same but for the error of the panels
        values = np.swapaxes(getattr(expected, name), -1, -2)
        np.testing.assert_allclose(getattr(found, name), values, atol=2e-6 * np.abs(values).max())


# ---- files that were cut, joined, or are of other bodies ----


@pytest.fixture
def whole(tmp_path, truth):
    """All numeric files and a listing, with the database that each gives."""
    write_numeric(tmp_path / "two", truth)
    write_drift(tmp_path / "two.9", np.random.default_rng(2).normal(size=(3, 3, 12)) * 1e4)
    (tmp_path / "two.out").write_text(listing(truth))
    return tmp_path


def read_either(folder, ending):
    if ending == ".out":
        return read_wamit_out(folder / "two.out", density=DENSITY)
    return read(folder / "two")


def equal(one, other):
    for name in ("omega", "headings", "added_mass", "damping", "added_mass_infinite", "excitation", "drift", "volumes",
                 "hydrostatic_stiffness"):  # fmt: skip
        a, b = getattr(one, name), getattr(other, name)
        if (a is None) != (b is None) or (a is not None and not np.array_equal(a, b)):
            return False
    return True


@pytest.mark.parametrize("ending", [".1", ".3", ".hst", ".9", ".out"])
def test_a_file_that_is_cut_anywhere_is_refused_or_told_or_the_same(whole, ending):
    """No cut, within a row or after one, gives other numbers without a word."""
    file = whole / f"two{ending}"
    text, before = file.read_text(), read_either(whole, ending)
    rng = np.random.default_rng(5)
    ends = np.flatnonzero(np.array(list(text)) == "\n")
    cuts = {
        *rng.integers(1, len(text), 25).tolist(),
        *rng.choice(ends, 15).tolist(),
        *(rng.choice(ends, 15) + 1).tolist(),
    }
    cuts |= set(range(len(text) - 14, len(text) - 1, 3))
    refused = 0
    for cut in sorted(int(one) for one in cuts):
        for tail in ("", "\n"):
            file.write_text(text[:cut] + tail)
            try:
                after = read_either(whole, ending)
            except InputError:
                refused += 1
                continue
            assert equal(after, before) or set(after.repairs) - set(before.repairs), (
                cut,
                text[cut - 40 : cut],
            )
    assert refused > len(cuts)


@pytest.mark.parametrize("ending", [".1", ".3", ".hst", ".9", ".out"])
def test_two_runs_in_a_file(whole, truth, ending):
    """The same twice is the same; another run behind it is refused, also with periods that are rounded otherwise."""
    file = whole / f"two{ending}"
    text, before = file.read_text(), read_either(whole, ending)
    file.write_text(text + text)
    if ending == ".out":
        with pytest.raises(InputError, match="two listings in one file"):
            read_either(whole, ending)
        return
    assert equal(read_either(whole, ending), before)
    rows = [line.split() for line in text.splitlines()]
    place = {".1": 3, ".3": 5, ".hst": 2, ".9": 6}[ending]
    size = {".3": 3, ".9": 4}.get(ending, place)
    for row in rows:
        for k in {place, size}:
            row[k] = f"{1.2 * float(row[k]):.9E}"
        if ending == ".3":
            row[6] = f"{1.2 * float(row[6]):.9E}"
    file.write_text(text + "\n".join(" ".join(row) for row in rows) + "\n")
    with pytest.raises(
        InputError, match=r"line \d+: .* where the same coefficient was .* two runs in one file"
    ):
        read_either(whole, ending)
    if ending == ".1":
        for row in rows:
            row[0] = f"{float(row[0]) * (1.0 + 2e-6):.9E}"
        finite = [" ".join(row) for row in rows if float(row[0]) > 0.0]
        file.write_text(text + "\n".join(finite) + "\n")
        with pytest.raises(InputError, match="as good as the same"):
            read_either(whole, ending)


def test_rows_that_cannot_be(whole):
    base = whole / "two"
    texts = {ending: (whole / f"two{ending}").read_text() for ending in (".1", ".3", ".hst")}

    def changed(ending, line, column, value):
        rows = [one.split() for one in texts[ending].splitlines()]
        rows[line][column : column + 1] = [value] if value else []
        (whole / f"two{ending}").write_text("\n".join(" ".join(row) for row in rows) + "\n")
        with pytest.raises(InputError) as caught:
            read(base)
        (whole / f"two{ending}").write_text(texts[ending])
        return str(caught.value)

    last = texts[".1"].count("\n") - 1
    assert "no damping at a finite period" in changed(".1", last, 4, "")
    assert "mode 1.5" in changed(".1", last, 1, "1.5")
    assert "mode 0" in changed(".3", 5, 2, "0")
    assert "modulus" in changed(".3", 5, 6, "1.0E-09")
    assert "a symmetric table" in changed(".hst", 6 * 2 + 4, 2, "9.9E+09")  # C(3,5)


def test_a_body_without_numbers_is_refused(tmp_path, truth):
    """Of two bodies the file has the second alone."""
    write_numeric(tmp_path / "two", truth, skip={"-1.0", "0.0"})
    for ending in (".1", ".3"):
        file = tmp_path / f"two{ending}"
        column = {".1": (1, 2), ".3": (2, 2)}[ending]
        rows = [line.split() for line in file.read_text().splitlines()]
        file.write_text("\n".join(" ".join(r) for r in rows if min(int(r[c]) for c in column) > 6) + "\n")
    with pytest.raises(InputError, match=r"no added mass of 'crane', coordinates 1 to 6"):
        read(tmp_path / "two")


def test_exciting_forces_without_radiation_are_told(tmp_path, truth, monkeypatch):
    """The radiation lacks a period that the forces have, as if it were cut between two of them."""
    from heavylift.preprocess.hydrodynamics import repairs

    monkeypatch.setattr(repairs, "FEWEST", 1)
    write_numeric(tmp_path / "two", truth)
    file = tmp_path / "two.1"
    longest = f"{2.0 * np.pi / OMEGA[0]:.9E}"
    file.write_text("\n".join(line for line in file.read_text().splitlines() if longest not in line) + "\n")
    told = read(tmp_path / "two").repairs
    assert any(
        "exciting forces at 1 frequencies without radiation (0.15 to 0.15 rad/s)" in one for one in told
    )


@pytest.mark.parametrize("stated", ["1.00000", "1.02500"])
def test_a_listing_in_other_units_of_density_has_the_density_of_the_sea(tmp_path, truth, stated):
    """Its numbers have no dimension; WAMIT writes 1 where nobody gave it a density, and tonnes are tonnes."""
    path = tmp_path / "two.out"
    path.write_text(listing(truth))
    before = read_wamit_out(path, density=DENSITY)
    path.write_text(listing(truth, extra=f"        Water density:    {stated}"))
    assert equal(read_wamit_out(path, density=DENSITY), before)
