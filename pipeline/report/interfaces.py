"""Interfaces of a flexible body in the report: where they are, and how much of their compliance the modes have."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.report.document import Table

if TYPE_CHECKING:
    from heavylift.modal.reduced import ReducedBody

__all__ = ["interface_table"]


def interface_table(reduced: ReducedBody) -> Table:
    """A row an interface."""
    rows = []
    for name, one in reduced.interfaces.items():
        captured = f"{round(100.0 * one.captured, 3):.4g}" if np.isfinite(one.captured) else ""
        place = np.where(
            np.abs(one.point) > 1e-12 * reduced.size, one.point, 0.0
        )  # without what rounding leaves
        rows.append((name, *(f"{x:.6g}" for x in place), str(len(one.nodes)), captured))
    titles = ("interface", "x [m]", "y [m]", "z [m]", "nodes", "static compliance captured, at least [%]")
    return Table(titles, tuple(rows), frozenset({1, 2, 3, 4, 5}))
