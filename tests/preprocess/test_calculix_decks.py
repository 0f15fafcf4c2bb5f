"""Decks of CalculiX's own tests: read, or refused for a reason of mechanics; five against independent solutions."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import material_of
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.geometry import read_deck, scaled_mesh
from heavylift.preprocess.finite_elements.model import Material

ROOT = Path(__file__).resolve().parents[2]
UNITS = {"length_unit": 1e-3, "mass_unit": 1e3}  # mm, t, N
STATIC = {"density": 7850.0}  # for decks without one

PARTS = r"falls into 2 parts with no node in common: .*choose with 'part'"
ORTHOTROPIC = r"material 'EL' is orthotropic"

READ = {
    "beam10p": ("tet10", 31),
    "beam8f": ("hex8", 256),
    "beam8pjc": ("hex8", 256),
    "beam_sens_freq_coord2": ("hex8", 30),
    "beam_sens_stress_coord1": ("hex8", 32),
    "beam_sens_stress_coord2": ("hex8", 32),
    "beamnldyems": ("hex8", 32),
    "circ10pcent": ("tet10", 31),
    "cycliccontact": ("hex8", 624),
    "dyncube": ("hex8", 1),
    "mohr1": ("hex8", 1),
    "segmenttetsms": ("tet10", 1489),
    "sens_freq_disp_cyc_implicit": ("hex8", 624),
    "sensitivity_I": ("hex8", 2),
    "sensitivity_VII": ("hex8", 2),
    "transition": ("hex8", 32),
}
# elements of each part
IN_PARTS = {
    "changecontacttype1": (1, 1),
    "changesurfbeh": (1, 1),
    "contact1": (1, 1),
    "contact16": (1, 1),
    "contact19": (1, 1),
    "contact7": (1, 1),
    "contactdeleteelement": (5, 5),
    "equrem2": (1, 1),
    "friction1": (64, 64),
    "scheibe2n2f": (256, 256),
}
REFUSED = {
    "anipla_nl_dy_exp": ORTHOTROPIC,
    "sens_disp_orien": ORTHOTROPIC,
    "patch_c3d8i": r"element 4 \(C3D8I\) at .*distorted beyond use: .*\(1 of 7 elements\)",
    "segmentsmooth2": r"element 363 \(C3D10\) at .*distorted beyond use: .*\(2 of 1489 elements\)",
}


def folder():
    found = Path(os.environ.get("HEAVYLIFT_CALCULIX_DATA", ROOT.parent / "shared" / "data" / "calculix"))
    if not found.is_dir():
        pytest.skip(f"no decks of CalculiX at {found}; set HEAVYLIFT_CALCULIX_DATA")
    return found


def deck(name):
    return read_deck(folder() / f"{name}.inp")


def material(body):
    """In SI; of decks without density with one of steel."""
    given = {} if body.material.density else STATIC
    return material_of(body.material, given, source="body", **UNITS)


@pytest.mark.parametrize("name", READ)
def test_decks_of_one_body_are_read(name):
    body = deck(name).body()
    assert (body.mesh.element_type, body.mesh.element_count) == READ[name]
    assert 70e9 < material(body).young_modulus < 220e9


@pytest.mark.parametrize("name", IN_PARTS)
def test_of_decks_with_parts_one_is_chosen(name):
    whole = deck(name)
    with pytest.raises(InputError, match=PARTS):
        whole.body()
    parts = [whole.body(part=number) for number in (1, 2)]
    assert tuple(part.mesh.element_count for part in parts) == IN_PARTS[name]
    assert all(70e9 < material(part).young_modulus < 220e9 for part in parts)


@pytest.mark.parametrize("name", REFUSED)
def test_decks_that_are_refused(name):
    whole = deck(name)
    with pytest.raises(InputError, match=REFUSED[name]):
        material(whole.body())


# ---- against independent solutions, in the units of the decks: mm, N, t ----


def plain(path, width):
    """Nodes and elements by a reading of its own: of these decks the first block of nodes and all of the elements."""
    kind, numbers = "", {"NODE": [], "ELEMENT": []}
    for line in path.read_text().splitlines():
        if line.startswith("*"):
            kind = line[1:].split(",")[0].strip().upper() if not line.startswith("**") else kind
        elif kind in numbers:
            numbers[kind] += [float(word) for word in line.replace(",", " ").split()]
    table = np.array(numbers["NODE"]).reshape(-1, 4)
    rows = {int(label): k for k, label in enumerate(table[:, 0])}
    cells = np.array(numbers["ELEMENT"], dtype=int).reshape(-1, width + 1)[:, 1:]
    return table[:, 1:], np.array([[rows[label] for label in cell] for cell in cells])


def solved_by_scikit_fem(points, cells, young, poisson, density, clamped):
    """Stiffness and mass by scikit-fem's own mesh, element and weak form, free of the clamped nodes."""
    import meshio
    import skfem
    from skfem.io.meshio import from_meshio
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    kind, element = (
        ("hexahedron", skfem.ElementHex1()) if cells.shape[1] == 8 else ("tetra10", skfem.ElementTetP2())
    )
    used, flat = np.unique(cells, return_inverse=True)
    mesh = from_meshio(meshio.Mesh(points[used], [(kind, flat.reshape(cells.shape))]))
    # C3D8 has 2 x 2 x 2 points; on bricks that are no parallelepipeds it is part of the element
    basis = skfem.Basis(mesh, skfem.ElementVector(element), intorder=3 if cells.shape[1] == 8 else 6)
    K = linear_elasticity(*lame_parameters(young, poisson)).assemble(basis)

    @skfem.BilinearForm
    def inertia(u, v, w):
        return density * skfem.helpers.dot(u, v)

    M = inertia.assemble(basis)
    free = ~clamped(basis.doflocs)
    return K[free][:, free], M[free][:, free], basis.doflocs[:, free]


def frequencies(K, M, count=4):
    """Lowest natural frequencies [Hz]."""
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import eigsh

    values = eigsh(csc_array(K), count, csc_array(M), sigma=0.0, which="LM", return_eigenvectors=False)
    return np.sqrt(np.sort(values)) / (2 * np.pi)


def own_matrices(body, clamped, formulation=None):
    """Our matrices of a body in SI, free of the clamped nodes."""
    model = assemble(scaled_mesh(body.mesh, 1e-3), material(body), formulation=formulation)
    held = np.repeat(clamped(1e3 * model.nodes.T), 3)
    return model.stiffness[~held][:, ~held], model.full_mass()[~held][:, ~held]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "part", "clamped", "tolerance"),
    [
        ("beam8f", None, lambda x: x[2] < 1e-6, 1e-8),
        ("friction1", 1, lambda x: x[2] < 1e-6, 1e-8),
        ("sens_freq_disp_cyc_implicit", None, lambda x: x[2] < 65.0, 1e-8),
        ("circ10pcent", None, lambda x: x[2] < 1e-6, 1e-8),
        # bent edges: the integrals are rational, and quadratures differ
        ("segmenttetsms", None, lambda x: x[0] < 1e-6, 1e-6),
    ],
)
def test_frequencies_agree_with_scikit_fem(name, part, clamped, tolerance):
    body = deck(name).body(part=part)
    points, cells = plain(folder() / f"{name}.inp", body.mesh.elements.shape[1])
    if part is not None:
        cells = cells[: body.mesh.element_count]
    spec = body.material
    K, M, _ = solved_by_scikit_fem(
        points, cells, spec.young_modulus, spec.poisson_ratio, spec.density, clamped
    )
    expected = frequencies(K, M)
    np.testing.assert_allclose(frequencies(*own_matrices(body, clamped, "full")), expected, rtol=tolerance)


def test_frequencies_of_a_cantilever_agree_with_beam_theory():
    body = deck("beam8f").body()
    found = frequencies(*own_matrices(body, lambda x: x[2] < 1e-6), 5)
    young, poisson, density = 2.1e11, 0.3, 7800.0
    a, b, length = 1e-3, 1.5e-3, 8e-3
    shear = young / (2 * (1 + poisson))
    bending = [timoshenko_cantilever(young, shear, density, a * b, h**2 / 12, length) for h in (a, b)]
    # Saint-Venant's torsion of a rectangle, b / a = 1.5: J = 0.196 a^3 b (Roark)
    twist = np.sqrt(shear * 0.196 * a**3 * b / (density * a * b * (a**2 + b**2) / 12)) / (4 * length)
    # the clamped section of the solid cannot contract, and above all not warp: it is stiffer by some per cent
    np.testing.assert_allclose(found[[0, 2]], bending[0], rtol=0.025)
    np.testing.assert_allclose(found[[1, 4]], bending[1], rtol=0.025)
    assert found[3] == pytest.approx(twist, rel=0.04)


def timoshenko_cantilever(young, shear, density, area, gyration2, length):
    """First two frequencies [Hz] of a Timoshenko beam of rectangular section: zeros of the determinant."""
    GA, EI = 5.0 / 6.0 * shear * area, young * gyration2 * area

    def determinant(omega):
        # exp(k x) with slope phi = s w: GA (w'' - phi') + m w = 0 and EI phi'' + GA (w' - phi) + j phi = 0
        m, j = density * area * omega**2, density * gyration2 * area * omega**2
        k = np.roots([GA * EI, 0.0, GA * j + m * EI, 0.0, m * j - m * GA]).astype(complex)
        s = (GA * k**2 + m) / (GA * k)
        end = np.exp(k * length)
        # w, phi at the root; phi', w' - phi at the tip
        rows = np.array([np.ones(4), s, end * s * k, end * (k - s)])
        return abs(np.linalg.det(rows / np.abs(rows).max(axis=1)[:, None]))

    # steps of half a per cent of the first one, of Euler and Bernoulli about 3.5
    grid = np.sqrt(young * gyration2 / density) / length**2 * np.arange(1.0, 22.0, 0.005)
    size = np.array([determinant(omega) for omega in grid])
    lowest = 1 + np.flatnonzero((size[1:-1] < size[:-2]) & (size[1:-1] < size[2:]))
    return grid[lowest[:2]] / (2 * np.pi)


def test_deflection_of_a_cantilever_of_tetrahedra():
    body = deck("beam10p").body()
    mesh, groups = body.mesh, body.mesh.node_groups
    K = assemble(mesh, Material(210000.0, 0.3, 1.0)).stiffness.tocsc()  # in N and mm
    held = np.zeros(3 * mesh.node_count, dtype=bool)
    held[3 * groups["FIX"] + 2] = True
    labels = groups["NALL"]  # nodes of the deck in ascending order
    held[[3 * labels[0], 3 * labels[0] + 1, 3 * labels[2]]] = True
    load = np.zeros(3 * mesh.node_count)
    load[3 * groups["LOAD"] + 1] = 1.0
    from scipy.sparse.linalg import spsolve

    u = np.zeros_like(load)
    u[~held] = spsolve(K[~held][:, ~held], load[~held])
    found = u[3 * groups["LOAD"] + 1].mean()
    # bending and shear under 9 N at the end of 8 mm; free to contract at the support
    expected = 9.0 * 8.0**3 / (3 * 210000.0 / 12) + 9.0 * 8.0 / (5 / 6 * 210000.0 / 2.6)
    assert found == pytest.approx(expected, rel=0.02)


def test_force_of_a_stretched_cube():
    body = deck("mohr1").body()
    model = assemble(body.mesh, Material(210000.0, 0.0, 1.0))
    u = np.zeros((8, 3))
    u[:, 0] = 0.01 * body.mesh.nodes[:, 0]
    force = (model.stiffness @ u.ravel()).reshape(8, 3)
    # nu = 0: E A / L times 0.01 mm, along x only
    assert force[body.mesh.nodes[:, 0] > 0.5, 0].sum() == pytest.approx(2100.0, rel=1e-12)
    np.testing.assert_allclose(force[:, 1:], 0.0, atol=1e-9)
