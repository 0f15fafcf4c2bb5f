"""Control points and shapes of flexible bodies against matrix products."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.splines.modal_sums import modal_data, modal_points, modal_shapes
from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.jit import kernel


@kernel
def run_sums(data, begin, modes, q, controls, net, w, out):
    modal_points(data, begin, modes, q, 1, controls, controls.shape[0], net, 2)
    modal_shapes(data, begin, modes, controls, controls.shape[0], w, 3, out, 4)


@pytest.mark.parametrize("modes", [0, 1, 7])
@pytest.mark.parametrize("count", [4, 15, 16])
def test_sums_are_matrix_products(modes: int, count: int) -> None:
    random = np.random.default_rng(modes)
    contour = neutral_surface(random.normal(size=(6, 5, 3)), mode_shapes=random.normal(size=(modes, 6, 5, 3)))
    data = np.concatenate([[np.nan] * 5, modal_data(contour)])
    controls = random.permutation(30)[:count]
    q, w = random.normal(size=1 + modes), random.normal(size=3 + count)
    net, out = np.full((32, 3), np.nan), np.full(4 + 3 * modes, np.nan)
    run_sums(data, 5, modes, q, controls, net, w, out)
    expected = contour.control + np.tensordot(q[1:], contour.modal, axes=1)
    assert net[2 + controls] == pytest.approx(
        expected[controls], abs=1e-12 * (1.0 + np.max(np.abs(expected)))
    )
    untouched = np.delete(np.arange(32), 2 + controls)
    assert np.all(np.isnan(net[untouched]))
    shapes = np.einsum("c,mck->km", w[3:], contour.modal[:, controls]).ravel()
    assert out[4:] == pytest.approx(shapes, abs=1e-12 * (1.0 + np.max(np.abs(shapes), initial=0.0)))
    assert np.all(np.isnan(out[:4]))
