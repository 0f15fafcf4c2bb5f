"""Matrices of CalculiX and Abaqus: written here from scikit-fem's own assembly, in the words of these programs."""

from __future__ import annotations

import numpy as np
import pytest
import skfem
from skfem.models.elasticity import lame_parameters, linear_elasticity

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.geometry import read_deck
from heavylift.preprocess.finite_elements.matrix_files import read_matrices

YOUNG, POISSON, DENSITY = 210000.0, 0.3, 7.85e-9  # N, mm, t
UNITS = {"length_unit": 1e-3, "mass_factor": 1e3, "stiffness_factor": 1e3}
SIZE = (40.0, 5.0, 4.0)


@pytest.fixture(scope="module")
def bar():
    """Matrices of a bar of 4 x 1 x 1 bricks by scikit-fem, degrees of freedom node by node; nodes and cells."""
    mesh = skfem.MeshHex.init_tensor(
        *(np.linspace(0.0, length, n + 1) for length, n in zip(SIZE, (4, 1, 1), strict=True))
    )
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex1()), intorder=3)

    @skfem.BilinearForm
    def inertia(u, v, w):
        return DENSITY * skfem.helpers.dot(u, v)

    K = linear_elasticity(*lame_parameters(YOUNG, POISSON)).assemble(basis)
    order = basis.nodal_dofs.T.ravel()
    # corners of scikit-fem's brick by their places, in the order of C3D8
    corners = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    )
    places = skfem.ElementHex1().doflocs
    cells = mesh.t[[int(np.abs(places - corner).sum(axis=1).argmin()) for corner in corners]].T
    return (
        K.toarray()[np.ix_(order, order)],
        inertia.assemble(basis).toarray()[np.ix_(order, order)],
        mesh.p.T,
        cells,
    )


def written(folder, bar, held=(), name="C3D8", extra=""):
    """Files of CalculiX; node k has the number 100 - 3 k, rows are in an order of their own."""
    K, M, nodes, cells = bar
    label = [100 - 3 * k for k in range(len(nodes))]
    text = "*NODE\n" + "".join(f"{label[k]}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(nodes))
    text += f"*ELEMENT, TYPE={name}\n"
    text += "".join(
        f"{e + 1}, " + ", ".join(str(label[k]) for k in cell) + "\n" for e, cell in enumerate(cells)
    )
    text += (
        "*NSET, NSET=Root\n" + "".join(f"{label[k]},\n" for k, x in enumerate(nodes) if x[0] == 0.0) + extra
    )
    (folder / "job.inp").write_text(text)
    rows = [dof for dof in np.random.default_rng(3).permutation(len(K)) if dof not in held]
    (folder / "job.dof").write_text("".join(f"{label[dof // 3]}.{dof % 3 + 1}\n" for dof in rows))
    for suffix, matrix in ((".sti", K), (".mas", M)):
        lines = [
            f"{i + 1} {j + 1} {matrix[rows[i], rows[j]]:20.13e}\n"
            for j in range(len(rows))
            for i in range(j + 1)
        ]
        (folder / f"job{suffix}").write_text("".join(lines))
    return folder


def read(folder, **units):
    job = folder / "job"
    return read_matrices(
        read_deck(job.with_suffix(".inp")),
        job.with_suffix(".sti"),
        job.with_suffix(".mas"),
        job.with_suffix(".dof"),
        **{**UNITS, **units},
    )


def test_matrices_of_a_free_bar_come_back(tmp_path, bar):
    K, M, nodes, _ = bar
    model = read(written(tmp_path, bar))
    np.testing.assert_allclose(model.nodes, 1e-3 * nodes, rtol=1e-12)
    np.testing.assert_allclose(model.stiffness.toarray(), 1e3 * K, atol=1e-9 * np.abs(K).max() * 1e3)
    np.testing.assert_allclose(model.full_mass().toarray(), 1e3 * M, atol=1e-12 * np.abs(M).max() * 1e3)
    assert model.total_mass == pytest.approx(40e-3 * 5e-3 * 4e-3 * 7850.0, rel=1e-10)
    assert model.mesh.element_type == "hex8"
    assert len(model.node_groups["Root"]) == 4
    assert any(
        "longitudinal waves 6" in note for note in model.notes
    )  # sqrt((lambda + 2 mu) / rho) = 6002 m/s


def test_clamped_nodes_have_no_row(tmp_path, bar):
    K, M, nodes, _ = bar
    root = np.flatnonzero(nodes[:, 0] == 0.0)
    held = (3 * root[:, None] + np.arange(3)).ravel()
    model = read(
        written(tmp_path, bar, held, extra="*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n*BOUNDARY\nRoot, 1, 3\n")
    )
    np.testing.assert_array_equal(model.fixed_nodes, root)
    free = np.setdiff1d(np.arange(len(K)), held)
    np.testing.assert_allclose(
        model.stiffness.toarray()[np.ix_(free, free)], 1e3 * K[np.ix_(free, free)], atol=1e-3
    )
    assert not model.stiffness.toarray()[held].any()
    assert "4 nodes have no row: clamped in the file, and their mass is not in it" in model.notes
    # first frequency of the clamped bar: stiff by the mesh, of the right size (Euler and Bernoulli: 2061 Hz)
    K_free, M_free = (m.toarray()[np.ix_(free, free)] for m in (model.stiffness, model.full_mass()))
    from scipy.linalg import eigh

    first = np.sqrt(eigh(K_free, M_free, eigvals_only=True)[0]) / (2 * np.pi)
    expected = np.sqrt(eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)[0]) / (2 * np.pi)
    assert first == pytest.approx(expected, rel=1e-9)


def test_matrices_of_bricks_of_other_kinds_need_no_elements_of_ours(tmp_path, bar):
    model = read(written(tmp_path, bar, name="C3D8").resolve())
    text = (tmp_path / "job.inp").read_text()
    # as if the same nodes were of wedges: a kind that is not assembled here
    head, _, tail = text.partition("*ELEMENT")
    cells = "*ELEMENT, TYPE=C3D6\n" + "".join(
        line.rsplit(",", 2)[0] + "\n" for line in tail.partition("*NSET")[0].splitlines()[1:]
    )
    (tmp_path / "job.inp").write_text(head + cells + "*NSET" + tail.partition("*NSET")[2])
    other = read(tmp_path)
    assert other.mesh is None
    np.testing.assert_allclose(other.stiffness.toarray(), model.stiffness.toarray())


def test_matrices_of_abaqus_name_nodes_and_directions(tmp_path, bar):
    K, M, _, _ = bar
    written(tmp_path, bar)
    for suffix, matrix in (("STIF", K), ("MASS", M)):
        lines = [
            f"{100 - 3 * (i // 3)},{i % 3 + 1}, {100 - 3 * (j // 3)},{j % 3 + 1}, {matrix[i, j]:.15e}\n"
            for i in range(len(K))
            for j in range(i + 1)
            if matrix[i, j] or i == j
        ]
        (tmp_path / f"job_{suffix}1.mtx").write_text("".join(lines))
    deck = read_deck(tmp_path / "job.inp")
    model = read_matrices(deck, tmp_path / "job_STIF1.mtx", tmp_path / "job_MASS1.mtx", **UNITS)
    np.testing.assert_allclose(model.stiffness.toarray(), 1e3 * K, atol=1e-9 * np.abs(K).max() * 1e3)
    with pytest.raises(InputError, match=r"job.sti: 3 numbers a line; expected .* with a file of degrees"):
        read_matrices(deck, tmp_path / "job.sti", tmp_path / "job.mas", **UNITS)


@pytest.mark.parametrize(
    ("file", "change", "words"),
    [
        ("job.dof", lambda text: "7.1\n" + text, r"job.dof: line 1: node 7 is not in the deck"),
        (
            "job.dof",
            lambda text: "100.4\n" + text,
            r"job.dof: line 1: '100.4'; expected a node and a direction",
        ),
        (
            "job.sti",
            lambda text: text + "61 1 0.\n",
            r"job.sti: line 1831: '61 1'; expected whole numbers from 1 to 60",
        ),
        ("job.sti", lambda text: text + "1 2\n", r"job.sti: line 1831: 2 numbers"),
        (
            "job.mas",
            lambda text: "1 1 1.\n" + text.split("\n", 1)[1],
            "not the same in all directions",
        ),
    ],
)
def test_faults_are_named(tmp_path, bar, file, change, words):
    written(tmp_path, bar)
    path = tmp_path / file
    path.write_text(change(path.read_text()))
    with pytest.raises(InputError, match=words):
        read(tmp_path)


def test_rows_that_are_missing_without_a_support_are_refused(tmp_path, bar):
    written(tmp_path, bar, held=(0, 1, 2), extra="*EQUATION\n2\n100,1,1.,97,1,-1.\n")
    with pytest.raises(
        InputError, match=r"node 100 has no row, and no \*BOUNDARY holds it; expected .* without equations"
    ):
        read(tmp_path)
    written(tmp_path, bar, held=(0,), extra="*BOUNDARY\n100, 1\n")
    with pytest.raises(InputError, match=r"node 100 has rows in 2 directions \(1 such nodes\)"):
        read(tmp_path)


def test_units_that_do_not_fit_are_refused(tmp_path, bar):
    written(tmp_path, bar)
    with pytest.raises(InputError, match="no material is like that"):
        read(tmp_path, stiffness_factor=1.0, mass_factor=1e9)


def of_instances(folder, bar, count=1, reference_point=False):
    """Deck of parts and instances, and files of Abaqus, whose lines know numbers alone."""
    K, M, nodes, cells = bar
    text = "*Part, name=P\n*Node\n" + "".join(
        f"{k + 1}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(nodes)
    )
    text += "*Element, type=C3D8\n"
    text += "".join(f"{e + 1}, " + ", ".join(str(k + 1) for k in cell) + "\n" for e, cell in enumerate(cells))
    text += "*End Part\n*Assembly, name=A\n"
    text += "".join(
        f"*Instance, name=P-{k + 1}, part=P\n{100.0 * k}, 0., 0.\n*End Instance\n" for k in range(count)
    )
    text += "*Node\n1, 7., 7., 7.\n" if reference_point else ""
    (folder / "m.inp").write_text(text + "*End Assembly\n")
    for name, matrix in (("K.mtx", K), ("M.mtx", M)):
        lines = [
            f"{i // 3 + 1},{i % 3 + 1}, {j // 3 + 1},{j % 3 + 1}, {matrix[i, j]:.16e}\n"
            for i in range(len(K))
            for j in range(i + 1)
        ]
        (folder / name).write_text("".join(lines))
    return read_matrices(read_deck(folder / "m.inp"), folder / "K.mtx", folder / "M.mtx", **UNITS)


def test_matrices_of_an_instance_find_its_nodes(tmp_path, bar):
    """Also beside a reference point of the assembly with the same number, which no element has."""
    K, _, nodes, _ = bar
    for reference_point in (False, True):
        model = of_instances(tmp_path, bar, reference_point=reference_point)
        np.testing.assert_allclose(model.nodes, 1e-3 * nodes, rtol=1e-12)
        np.testing.assert_allclose(model.stiffness.toarray(), 1e3 * K, atol=1e-9 * np.abs(K).max() * 1e3)
        assert model.total_mass == pytest.approx(40e-3 * 5e-3 * 4e-3 * 7850.0, rel=1e-10)


def test_numbers_that_several_instances_have_are_refused(tmp_path, bar):
    with pytest.raises(
        InputError, match=r"K\.mtx: line 1: node 1 is one of several: P-1\.1, P-2\.1; expected"
    ):
        of_instances(tmp_path, bar, count=2)


def of_coordinates(folder, bar, order=None):
    """Files of Abaqus in its coordinate format: rows of the nodes in the order of their numbers, here 100 - 3 k."""
    K, M, *_ = bar
    nodes = np.arange(len(K) // 3)[::-1] if order is None else order
    rows = (3 * nodes[:, None] + np.arange(3)).ravel()
    for name, matrix in (("K.mtx", K), ("M.mtx", M)):
        lines = [
            f"{i + 1:10d} {j + 1:10d} {matrix[rows[i], rows[j]]:25.16e}\n"
            for i in range(len(rows))
            for j in range(i + 1)
        ]
        (folder / name).write_text("".join(lines))
    return read_matrices(read_deck(folder / "job.inp"), folder / "K.mtx", folder / "M.mtx", **UNITS)


def test_coordinate_format_of_abaqus(tmp_path, bar):
    model = of_coordinates(written(tmp_path, bar), bar)
    expected = read(tmp_path, **UNITS)
    assert abs(model.stiffness - expected.stiffness).max() < 1e-9 * abs(expected.stiffness).max()
    assert abs(model.mass - expected.mass).max() < 1e-12 * abs(expected.mass).max()
    assert any("in the order of their numbers" in note for note in model.notes)


def test_rows_in_another_order_resist_rigid_motions(tmp_path, bar):
    shuffled = np.random.default_rng(1).permutation(len(bar[0]) // 3)
    with pytest.raises(InputError, match=r"K\.mtx: resists rigid motions if its rows are directions"):
        of_coordinates(written(tmp_path, bar), bar, shuffled)
