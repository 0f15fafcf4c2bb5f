"""Panels of plates: found between stiffeners and plates, and buckling where theory says."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.modal.plate_panels import panel_use, plate_panels
from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.sections import profile
from heavylift.preprocess.structures.structure import Beams, Shells, Structure

STEEL = Material(2.1e11, 0.3, 7850.0)
T = 0.012


def grid(nx, ny, lx, ly):
    s, t = np.meshgrid(np.linspace(0.0, lx, nx + 1), np.linspace(0.0, ly, ny + 1), indexing="ij")
    index = np.arange(s.size).reshape(s.shape)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return np.column_stack([s.ravel(), t.ravel(), np.zeros(s.size)]), quads.reshape(-1, 4)


def deck(angle=0.0, *, mixed=False):
    """2.4 m x 1.6 m with a stiffener along y = 0.6 m and a web below x = 1.6 m, turned in its plane and about x."""
    nodes, quads = grid(12, 8, 2.4, 1.6)
    line = np.flatnonzero(np.isclose(nodes[:, 1], 0.6))
    edge = np.flatnonzero(np.isclose(nodes[:, 0], 1.6))
    below = nodes[edge] - [0.0, 0.0, 0.2]
    web = np.column_stack([edge[:-1], edge[1:], len(nodes) + np.arange(1, 9), len(nodes) + np.arange(8)])
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    shells = [Shells("deck", quads, STEEL, T), Shells("web", web, STEEL, 0.01)]
    if mixed:  # some quadrilaterals in halves
        halves = np.concatenate([quads[::5][:, [0, 1, 2]], quads[::5][:, [0, 2, 3]]])
        shells[0] = Shells("deck", np.delete(quads, np.s_[::5], axis=0), STEEL, T)
        shells.append(Shells("deck", halves, STEEL, T))
    structure = Structure(
        np.concatenate([nodes, below]) @ turn.T,
        shells=tuple(shells),
        beams=(
            Beams(
                "bar", np.column_stack([line[:-1], line[1:]]), STEEL,
                profile("flat", height=0.1, thickness=0.01).section, turn @ np.array([0.0, 0.0, 1.0]),
            ),
        ),
    )  # fmt: skip
    return assemble_structure(structure), turn


@pytest.mark.parametrize(("angle", "mixed"), [(0.0, False), (0.4, False), (0.4, True)])
def test_stiffeners_and_plates_divide_panels(angle, mixed):
    model, turn = deck(angle, mixed=mixed)
    panels = plate_panels(model)
    found = sorted(
        (name, round(float(a), 9), round(float(b), 9))
        for name, a, b in zip(panels.group, panels.length, panels.width, strict=True)
    )
    assert found == [
        ("deck", 0.8, 0.6), ("deck", 1.0, 0.8), ("deck", 1.6, 0.6), ("deck", 1.6, 1.0), ("web", 1.6, 0.2)
    ]  # fmt: skip
    assert panels.others == 0
    first = int(np.flatnonzero((np.round(panels.length, 9) == 1.6) & (np.round(panels.width, 9) == 0.6))[0])
    np.testing.assert_allclose(panels.centre[first], turn @ [0.8, 0.3, 0.0], atol=1e-12)
    assert plate_panels(model, ["web"]).group == ("web",)


def strained(model, turn, strain, slope=0.0):
    """Displacements of a strain in the plane: xx, yy, xy, and xx growing along y."""
    x, y, _ = (model.nodes @ turn).T
    u = np.column_stack(
        [strain[0] * x + strain[2] * y + slope * x * y, strain[1] * y - 0.5 * slope * x**2, np.zeros(len(x))]
    )
    return np.concatenate([(u @ turn.T).ravel(), np.zeros(3 * len(model.rotating))])


@pytest.mark.parametrize(("angle", "mixed"), [(0.0, False), (0.4, True)])
def test_panels_buckle_at_the_stresses_of_theory(angle, mixed):
    model, turn = deck(angle, mixed=mixed)
    panels = plate_panels(model, ["deck"])
    reference = np.pi**2 * 2.1e11 / (12.0 * 0.91) * (T / panels.width) ** 2
    slender = panels.width / panels.length
    E, G = 2.1e11, 2.1e11 / 2.6
    long_x = ~np.isclose(panels.length, 1.0)  # the one of 1 m x 0.8 m is pressed across

    def use(displacements, strength=None):
        return panel_use(panels, (panels.operator @ displacements).reshape(1, -1, 5), strength)[0]

    # stress along x alone: e_y = -nu e_x
    sigma = 50e6
    found = use(strained(model, turn, (-sigma / E, 0.3 * sigma / E, 0.0)))
    k = np.where(long_x, 4.0, (1.0 + slender**2) ** 2)
    np.testing.assert_allclose(found, sigma / (k * reference), rtol=1e-6)
    # tension does nothing
    assert np.abs(use(strained(model, turn, (sigma / E, -0.3 * sigma / E, 0.0)))).max() < 1e-9
    # shear
    found = use(strained(model, turn, (0.0, 0.0, sigma / G)))
    np.testing.assert_allclose(found, (sigma / ((5.34 + 4.0 * slender**2) * reference)) ** 2, rtol=1e-6)
    # beyond half of the yield strength it counts
    strength = np.full(len(reference), 100e6)
    elastic = k * reference
    critical = np.where(elastic > 50e6, 100e6 * (1.0 - 100e6 / (4.0 * elastic)), elastic)
    found = use(strained(model, turn, (-sigma / E, 0.3 * sigma / E, 0.0)), strength)
    np.testing.assert_allclose(found, sigma / critical, rtol=1e-6)


def test_bending_in_the_plane_has_the_factors_of_its_gradient():
    model, turn = deck()
    panels = plate_panels(model, ["deck"])
    long_x = np.flatnonzero(np.isclose(panels.length, 1.6) & np.isclose(panels.width, 0.6))[0]
    reference = float(np.pi**2 * 2.1e11 / (12.0 * 0.91) * (T / 0.6) ** 2)
    stresses = np.zeros((3, len(panels.group), 5))
    # edges with 1 and 0, 1 and -1, 3 and 1 times 10 MPa of compression
    stresses[:, long_x, 0] = -1e7 * np.array([0.5, 0.0, 2.0])
    stresses[:, long_x, 1] = 1e7 * np.array([0.5, 1.0, -1.0])
    used = panel_use(panels, stresses)[:, long_x]
    k = np.array([8.4 / 1.1, 7.63 + 6.26 + 10.0, 8.4 / (1.0 / 3.0 + 1.1)])
    np.testing.assert_allclose(used, 1e7 * np.array([1.0, 1.0, 3.0]) / (k * reference), rtol=1e-12)
    # a stress that grows over the width is found as such, elements being constant across
    grown = (panels.operator @ strained(model, turn, (0.0, 0.0, 0.0), slope=1e-3)).reshape(-1, 5)
    D = 2.1e11 / 0.91
    assert grown[long_x, 0] == pytest.approx(D * 1e-3 * 0.3, rel=0.02)
    assert grown[long_x, 1] == pytest.approx(D * 1e-3 * 0.3, rel=0.15)
