"""Plates under loads so large that they stretch: shells solved by Newton's method with their own stiffness."""

from __future__ import annotations

import numpy as np
import pytest
from shell_scenes import add_both, find, pack, put, shell, stiffness, taken

from heavylift.solver.bodies.ancf.shell_packing import element_data, load_shape, start_coordinates
from heavylift.solver.scene.mesh_shapes import rectangle
from heavylift.solver.scene.meshes import ShellSection

# Square plate L = 10 m, h = 0.1 m, E = 1 GPa, q = 981 N/m2: centre deflection in mm, n x n bicubic Hermite elements,
# strain of Green-Lagrange and bending, edges that cannot move; computed by separate code with 7 x 7 points.
DEFLECTIONS = {
    ("hinged", 0.0, 4): 136.6722,
    ("hinged", 0.3, 4): 125.4112,
    ("clamped", 0.0, 4): 99.7843,
    ("clamped", 0.3, 4): 92.0416,
    ("clamped", 0.3, 6): 92.4789,
}


@pytest.mark.slow
@pytest.mark.parametrize(("support", "nu", "n"), list(DEFLECTIONS))
def test_plates_stretch_as_they_bend(support: str, nu: float, n: int) -> None:
    mesh = rectangle(10.0, 10.0, n, n)
    body = shell(mesh, ShellSection(0.1, 1000.0, 1e9, nu))
    kind, q = pack([body]), start_coordinates(body)
    count = q.size
    bending, load = np.zeros((count, count)), np.zeros(q.shape)
    for e, (data, own) in enumerate(zip(element_data(body), mesh.elements, strict=True)):
        places = (12 * own[:, np.newaxis] + np.arange(12)).ravel()
        bending[np.ix_(places, places)] += np.kron(data[256:512].reshape(16, 16), np.eye(3))
        load[own, :, 2] -= 981.0 * load_shape(body, e).reshape(4, 4)
    fixed = np.zeros(q.shape, dtype=bool)
    for edge, along in (("x_min", 2), ("x_max", 2), ("y_min", 1), ("y_max", 1)):
        fixed[np.ix_(mesh.edges[edge], [0, along])] = True
        if support == "clamped":
            fixed[mesh.edges[edge], :, 2] = True
    free = ~fixed.ravel()
    q[n // 2 * (n + 1) + n // 2, 0, 2] = -0.05  # off the flat shape, which has no stiffness of tension yet
    for _ in range(60):
        put(kind.trial_position, q)
        find(kind, 0, kind.trial_position, kind.stage_strain)
        kind.external_force[:] = kind.blocks[:] = 0.0
        add_both(kind, 0, kind.trial_position, kind.stage_strain, kind.external_force, 1.0, 1.0, 1.0)
        rest = (load - taken(kind.external_force)).ravel() - bending @ q.ravel()
        K = stiffness(kind) + bending
        step = np.zeros(count)
        step[free] = np.linalg.solve(K[np.ix_(free, free)], rest[free])
        step *= min(1.0, 0.05 / np.abs(step).max())  # no farther than half the thickness
        q += step.reshape(q.shape)
        if np.abs(step).max() < 1e-12:
            break
    else:
        pytest.fail("Newton's method did not end")
    centre = np.flatnonzero(np.all(np.abs(mesh.nodes[:, :2] - 5.0) < 1e-9, axis=1))[0]
    assert -1e3 * q[centre, 0, 2] == pytest.approx(DEFLECTIONS[support, nu, n], rel=3e-6)
