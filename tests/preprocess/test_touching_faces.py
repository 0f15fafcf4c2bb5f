"""Area on which parts of a surface touch: boxes side by side, apart, turned; against areas by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.preprocess.surfaces.touching_faces import touching_area
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface


def boxes(size, other, shift, turn=None):
    one, two = box_surface(size), box_surface(other)
    points = np.vstack([one.points, two.points + np.asarray(shift)])
    points = points if turn is None else points @ turn.as_matrix().T + [3.0, -7.0, 11.0]
    return TriangleSurface(points, np.vstack([one.triangles, two.triangles + len(one.points)]))


@pytest.mark.parametrize("turn", [None, Rotation.from_rotvec([0.3, -0.7, 1.1])])
@pytest.mark.parametrize(
    ("other", "shift", "area"),
    [
        ((30.0, 16.0, 8.0), (30.0, 0.0, 0.0), 128.0),  # two halves of a box
        ((30.0, 16.0, 8.0), (30.0, 3.0, -1.5), 13.0 * 6.5),  # shifted along the face
        ((4.0, 5.0, 2.0), (1.0, 2.0, 5.0), 20.0),  # a house on deck
        ((30.0, 16.0, 8.0), (30.5, 0.0, 0.0), 0.0),  # apart
        ((30.0, 16.0, 8.0), (30.0, 16.0, 0.0), 0.0),  # an edge
    ],
)
def test_boxes_that_touch(other, shift, area, turn):
    found = touching_area(boxes((30.0, 16.0, 8.0), other, shift, turn))
    assert found == pytest.approx(area, rel=1e-9, abs=1e-9)
