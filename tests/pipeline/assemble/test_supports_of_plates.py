"""Supports and loads of plates and beams: symmetry holds rotations, pressure acts along normals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.modes import _nodal_forces, held_directions
from heavylift.pipeline.case.statics import BodySupportSection, StaticLoadSection
from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.structure import Shells, Solids, Structure

STEEL = Material(2.1e11, 0.3, 7850.0)


def plate(low, count, *, cut=False):
    """Square from (low, low) to (1, 1) of quadrilaterals, one row of them cut into triangles if asked."""
    line = np.linspace(low, 1.0, count + 1)
    x, y = (a.ravel() for a in np.meshgrid(line, line, indexing="ij"))
    i = np.arange(x.size).reshape(count + 1, count + 1)
    quads = np.stack([i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]], -1)
    parts = [Shells("q", quads[: count - cut].reshape(-1, 4), STEEL, 0.02)]
    if cut:
        row = quads[-1]
        parts.append(Shells("t", np.concatenate([row[:, [0, 1, 2]], row[:, [0, 2, 3]]]), STEEL, 0.02))
    groups = {"edge": np.flatnonzero((np.abs(x) == 1.0) | (np.abs(y) == 1.0)), "all": np.arange(x.size)}
    structure = Structure(np.column_stack([x, y, 0 * x]), shells=tuple(parts), node_groups=groups)
    return assemble_structure(structure)


def solid():
    brick = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
    )
    return assemble_structure(
        Structure(
            brick, solids=(Solids("s", np.arange(8)[None], "hex8", STEEL),), node_groups={"all": np.arange(8)}
        )
    )


def solved(model, held, forces):
    free = np.setdiff1d(np.arange(model.dof_count), held)
    u = np.zeros(model.dof_count)
    u[free] = spsolve(model.stiffness[free][:, free].tocsc(), forces[free])
    return u


def test_a_quarter_with_planes_of_symmetry_moves_as_the_whole():
    clamp = BodySupportSection(on="edge", fixed="xyz", rotations="xyz")
    load = StaticLoadSection(on="all", pressure=1000.0)
    whole, quarter = plate(-1.0, 8), plate(0.0, 4)
    planes = [BodySupportSection(symmetry="x"), BodySupportSection(symmetry="y")]
    found = []
    for model, supports in ((whole, [clamp]), (quarter, [clamp, *planes])):
        forces = _nodal_forces(model, load, "load")
        u = solved(model, held_directions(model, supports), forces)
        middle = int(np.flatnonzero(np.abs(model.nodes).max(axis=1) < 1e-9)[0])
        found.append(u[3 * middle + 2])
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    # 0.00126 p a^4 / D with a of 2 m, thin
    assert found[1] == pytest.approx(-0.00126 * 1000.0 * 16.0 * 12.0 * 0.91 / (2.1e11 * 0.02**3), rel=0.02)


def test_pressure_acts_against_the_normals_of_plates():
    """The resultant of quadrilaterals and triangles, and its centre."""
    model = plate(0.0, 3, cut=True)
    forces = _nodal_forces(model, StaticLoadSection(on="all", pressure=1000.0), "load")
    assert not forces[3 * model.node_count :].any()
    at_nodes = forces[: 3 * model.node_count].reshape(-1, 3)
    np.testing.assert_allclose(at_nodes.sum(axis=0), [0, 0, -1000.0], atol=1e-9)
    np.testing.assert_allclose(model.nodes.T @ at_nodes[:, 2], [-500.0, -500.0, 0.0], atol=1e-9)


def test_rotations_are_held_where_there_are_some_only():
    model = plate(0.0, 2)
    n = model.node_count
    held = held_directions(model, [BodySupportSection(on="edge", rotations="z")])
    assert (held >= 3 * n).all()
    assert set((held - 3 * n) % 3) == {2}
    with pytest.raises(InputError, match=r"rotations of 8 node.s. that have none"):
        held_directions(solid(), [BodySupportSection(on="all", rotations="x")])
    for wrong in ({"symmetry": "x", "rotations": "y"}, {"rotations": "y"}, {"on": "all"}):
        with pytest.raises(ValueError, match=r"'rotations'|neither"):
            BodySupportSection(**wrong)


def test_forces_and_moments_on_an_edge_are_shared_by_its_length():
    """Trapezoids along an edge of unequal elements; a moment acts on rotations, and on solids it is refused."""
    line = np.array([0.0, 0.5, 0.6, 1.0])
    x, y = (a.ravel() for a in np.meshgrid([0.0, 1.0], line, indexing="ij"))
    quads = np.array([[k, k + 4, k + 5, k + 1] for k in range(3)])
    model = assemble_structure(
        Structure(
            np.column_stack([x, y, 0 * x]),
            shells=(Shells("q", quads, STEEL, 0.02),),
            node_groups={"SET1 7": np.arange(4, 8)},
        )
    )
    shares = np.array([0.25, 0.3, 0.25, 0.2])
    force = _nodal_forces(model, StaticLoadSection(on="SET1 7", force=(0, 0, 10.0)), "load")
    np.testing.assert_allclose(force[12:24].reshape(-1, 3)[:, 2], 10.0 * shares)
    moment = _nodal_forces(model, StaticLoadSection(on="SET1 7", moment=(0, 5.0, 0)), "load")
    np.testing.assert_allclose(moment[36:48].reshape(-1, 3)[:, 1], 5.0 * shares)
    assert np.count_nonzero(moment) == np.count_nonzero(force) == 4
    with pytest.raises(InputError, match=r"a moment on 8 node.s. without rotations"):
        _nodal_forces(solid(), StaticLoadSection(on="all", moment=(1.0, 0, 0)), "load")
