"""Section forces and stresses of shells against closed forms of constant strain and curvature."""

from __future__ import annotations

import numpy as np
import pytest
from recorded_parts import place_parts
from shell_scenes import distorted_element, pack, put, recorded, rotation, shell

from heavylift.pipeline.drawn.skins import MeshSkin
from heavylift.solver.bodies.ancf.shell_packing import start_coordinates
from heavylift.solver.bodies.ancf.stress import largest_shell_stress
from heavylift.solver.scene.mesh_shapes import rectangle
from heavylift.solver.scene.meshes import ShellBody, ShellSection


def record(body: ShellBody, coordinates: np.ndarray) -> dict[str, np.ndarray]:
    kind = pack([body])
    put(kind.position, coordinates)
    places = place_parts(kind, body, 3)
    row = np.full(max(place.stop for place in places.values()) + 1, np.nan)
    recorded(kind, 0, row)
    assert np.isnan(row[[0, 1, 2, -1]]).all()
    assert np.isfinite(row[3:-1]).all()
    return {name: row[place].reshape(-1, 3) for name, place in places.items()}


@pytest.mark.slow
def test_section_forces_of_constant_strain_and_curvature() -> None:
    body = shell(rectangle(1.3, 0.8, 1, 1), ShellSection(0.02, 1.0, 1e9, 0.3))
    q = start_coordinates(body)
    x, y = body.nodes[:, 0], body.nodes[:, 1]
    x, y = x - 0.65, y - 0.4  # flat at the centre
    exx, eyy, exy, kxx, kyy, kxy = 1e-3, -4e-4, 6e-4, 2e-2, 1e-2, -3e-2
    stretch = np.array([[1 + exx, exy, 0], [exy, 1 + eyy, 0], [0, 0, 1]])
    q = q @ stretch
    q[:, 0, 2] += 0.5 * kxx * x**2 + 0.5 * kyy * y**2 + kxy * x * y
    q[:, 1, 2] += kxx * x + kxy * y
    q[:, 2, 2] += kyy * y + kxy * x
    q[:, 3, 2] += kxy
    q = q @ rotation().T
    got = record(body, q)
    C, D, t = 1e9 * 0.02 / 0.91, 1e9 * 0.02**3 / 12.0 / 0.91, 0.02
    E = 0.5 * (stretch @ stretch - np.eye(3))
    N = C * np.array([E[0, 0] + 0.3 * E[1, 1], E[1, 1] + 0.3 * E[0, 0], 0.7 * E[0, 1]])
    M = D * np.array([kxx + 0.3 * kyy, kyy + 0.3 * kxx, 0.7 * kxy])
    np.testing.assert_allclose(got["membrane_force"][0], N, rtol=1e-9)
    np.testing.assert_allclose(got["bending_moment"][0], M, rtol=1e-9)
    # the slope of w strains the surface away from the centre by grad w grad w^T / 2: the largest is at a corner
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(-0.65, 0.65, 7), np.linspace(-0.4, 0.4, 7)))
    H = np.array([[kxx, kxy], [kxy, kyy]])
    slope = np.stack([x, y], axis=1) @ H
    strain = E[:2, :2] + 0.5 * slope[:, :, np.newaxis] * slope[:, np.newaxis, :]
    rows = np.zeros((len(x), 2, 3))
    rows[:, :, :2], rows[:, :, 2] = stretch[:2, :2], slope
    normals = np.cross(rows[:, 0], rows[:, 1])
    level = (normals / np.linalg.norm(normals, axis=1, keepdims=True))[:, 2]
    mises = []
    for z in (0.01, 0.0, -0.01):
        e = strain - z * level[:, np.newaxis, np.newaxis] * H
        s = C / t * (0.7 * e + 0.3 * np.trace(e, axis1=1, axis2=2)[:, np.newaxis, np.newaxis] * np.eye(2))
        square = s[:, 0, 0] ** 2 - s[:, 0, 0] * s[:, 1, 1] + s[:, 1, 1] ** 2 + 3 * s[:, 0, 1] ** 2
        mises.append(np.sqrt(square.max()))
    np.testing.assert_allclose(got["von_mises"][0], mises, rtol=1e-9)


@pytest.mark.parametrize(
    "body", [shell(rectangle(1.3, 0.8, 2, 1)), distorted_element()], ids=["rectangles", "distorted"]
)
def test_recorded_stress_is_the_largest_that_a_picture_shows(body: ShellBody) -> None:
    """At any deformation, to rounding; the stresses of pictures are computed without the compiled elements."""
    coordinates = start_coordinates(body)
    coordinates = coordinates + 1e-3 * np.random.default_rng(3).normal(size=coordinates.shape)
    got = record(body, coordinates)["von_mises"]
    for column, side in enumerate(("top", "middle", "bottom")):
        np.testing.assert_allclose(got[:, column], largest_shell_stress(body, coordinates, side), rtol=1e-9)
    shown = MeshSkin(body).skin(coordinates)
    assert shown.largest == pytest.approx(got.max(), rel=1e-9)
    assert shown.values.max() <= shown.largest


def test_clamped_strip_has_the_stress_of_its_clamp_not_of_the_middle_of_its_element() -> None:
    """Force P at the end of a strip without lateral contraction: 6 P L / (b t^2) at the clamp, 7/8 of it in the middle
    of the first of four elements."""
    E, t, L, b, P = 2.1e11, 0.01, 2.0, 0.5, 1e-3
    body = shell(rectangle(L, b, 4, 1), ShellSection(t, 7850.0, E, 0.0))
    stiffness = E * b * t**3 / 12.0
    q, x = start_coordinates(body), body.nodes[:, 0]
    q[:, 0, 2] = P / stiffness * (L * x**2 / 2.0 - x**3 / 6.0)
    q[:, 1, 2] = P / stiffness * (L * x - x**2 / 2.0)
    got = record(body, q)
    clamp = 6.0 * P * L / (b * t**2)
    assert got["von_mises"].max() == pytest.approx(clamp, rel=1e-6)
    assert 6.0 / t**2 * got["bending_moment"][0, 0] == pytest.approx(7.0 / 8.0 * clamp, rel=1e-6)


def test_a_diverged_shell_has_no_stress() -> None:
    body = shell(rectangle(1.3, 0.8, 1, 1))
    coordinates = start_coordinates(body)
    coordinates[2] = np.nan
    kind = pack([body])
    put(kind.position, coordinates)
    places = place_parts(kind, body, 0)
    row = np.zeros(max(place.stop for place in places.values()))
    recorded(kind, 0, row)
    assert np.isnan(row[places["von_mises"]]).all()


def test_a_positive_moment_presses_the_top() -> None:
    # bent towards +z, the top (z > 0) is shortened; a stretch that balances it leaves the bottom with twice the stress
    body = shell(rectangle(1.0, 1.0, 1, 1), ShellSection(0.2, 1.0, 1e9, 0.0))
    q, x, k = (
        start_coordinates(body),
        np.array([-0.5, 0.5])[np.round(start_coordinates(body)[:, 0, 0]).astype(int)],
        1e-3,
    )
    q[..., 0] *= 1.0 + 1e-4
    q[:, 0, 2], q[:, 1, 2] = 0.5 * k * x**2, k * x
    got = record(body, q)
    assert got["bending_moment"][0, 0] > 0.0
    top, middle, bottom = got["von_mises"][0]
    assert top < 1e-2 * middle
    assert bottom == pytest.approx(2.0 * middle, rel=1e-2)


@pytest.mark.parametrize(
    "body", [shell(rectangle(1.3, 0.8, 1, 1)), distorted_element()], ids=["rectangle", "distorted"]
)
def test_axes_of_section_forces_follow_the_reference_not_the_mesh(body: ShellBody) -> None:
    # a homogeneous strain has the same principal forces and equivalent stress on any element
    stretch = np.diag([1.001, 0.9995, 1.0])
    start = start_coordinates(body)
    frame = np.linalg.svd(start[:, 0] - start[:, 0].mean(axis=0))[2]  # plane axes as rows
    got = record(body, start @ frame.T @ stretch @ frame)
    N = got["membrane_force"][0]
    exx, eyy = 0.5 * (1.001**2 - 1.0), 0.5 * (0.9995**2 - 1.0)
    C = 2.1e11 * 0.01 / 0.91
    principal = sorted([C * (exx + 0.3 * eyy), C * (eyy + 0.3 * exx)])
    np.testing.assert_allclose(np.linalg.eigvalsh([[N[0], N[2]], [N[2], N[1]]]), principal, rtol=1e-9)
    assert np.abs(got["bending_moment"]).max() < 1e-9 * C
