"""Contours that are kept have the bits of those that are made, and what fails is told each time."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.splines import kept
from heavylift.contours.splines.kept import kept_check, kept_contour
from heavylift.contours.splines.neutral import NeutralContour, neutral_curve, neutral_surface
from heavylift.numerics.derived import keeping
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.derived_files import DerivedFiles
from heavylift.pipeline.results.storage import OutputFolder


def same(one: NeutralContour, other: NeutralContour) -> bool:
    arrays = [
        [*(space.knots for space in contour.spaces), contour.control, contour.modal, contour.weights]
        for contour in (one, other)
    ]
    shapes = [[(s.degree, s.count, s.closed) for s in contour.spaces] for contour in (one, other)]
    return shapes[0] == shapes[1] and all(a.tobytes() == b.tobytes() for a, b in zip(*arrays, strict=True))


def test_curves_and_surfaces_with_modes(tmp_path, monkeypatch):
    rng = np.random.default_rng(2)
    turn = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    ring = np.stack([np.cos(turn), np.sin(turn), 0.1 * turn * (turn - 6.0)], axis=1)
    sheet = np.stack([*np.meshgrid(np.arange(6.0), np.arange(5.0), indexing="ij"), np.zeros((6, 5))], axis=2)
    modes = rng.normal(size=(3, 6, 5, 3))
    curve = neutral_curve(ring, degree=3, closed=True, parametrisation="chord", source="ring")
    surface = neutral_surface(
        sheet,
        degrees=(3, 4),
        closed=(False, False),
        parametrisation="chord",
        mode_shapes=modes,
        source="sheet",
    )
    made: list[int] = []
    through = kept._through_points

    def counted(*given):
        made.append(1)
        return through(*given)

    for key in ("__module__", "__name__", "__qualname__"):
        setattr(counted, key, getattr(through, key))
    monkeypatch.setattr(kept, "_through_points", counted)
    folder = OutputFolder(tmp_path)
    for run in range(2):
        with keeping(DerivedFiles(folder)):
            of_ring = kept_contour(
                ring, degrees=(3,), closed=(True,), parametrisation="chord", mode_shapes=None, source="ring"
            )
            of_sheet = kept_contour(
                sheet,
                degrees=(3, 4),
                closed=(False, False),
                parametrisation="chord",
                mode_shapes=modes,
                source="sheet",
            )
            assert same(of_ring, curve)
            assert same(of_sheet, surface)
            below = sheet.reshape(-1, 3) - [0.0, 0.0, 1.0]
            kept_check(of_sheet, flip=False, nodes=below, source="sheet")
            with pytest.raises(InputError, match="its normal points into the body"):
                kept_check(of_sheet, flip=True, nodes=below, source="sheet")
        assert len(made) == 2, run
