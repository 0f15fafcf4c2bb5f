"""Sliders whose travel is a function of time: the rows of a slider and that of its travel; 6 rows.

The sixth row is ``z_a . (p_b - p_a) - l(t) = 0``; its reaction is the force of the drive on b along z of a,
and part of the reaction force.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.solver.connections import Slider
from heavylift.solver.drive import profile_value
from heavylift.solver.interface import (
    Workspace,
    fill_bias,
    fill_rows,
    record_joints,
    set_targets,
)
from heavylift.solver.joints import slider
from heavylift.solver.joints.driving import PRESCRIBED, aim, drive_work, pack_profiles
from heavylift.solver.joints.packing import JointPlace
from heavylift.solver.joints.reactions import add_force
from heavylift.solver.joints.row_writing import residuals, targets, travel_bias, travel_row
from heavylift.solver.joints.slider import (
    BLOCK,
    COLUMN,
    POINT_A,
    POINT_B,
    Z_A,
    fill_slider_bias,
    fill_slider_rows,
    record_sliders,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows import RowArrays

__all__ = ["CHANNELS", "ROTATIONAL", "DrivenSliders", "pack"]

ROTATIONAL = (*slider.ROTATIONAL, False)
CHANNELS = slider.CHANNELS

ROW = 5
PROFILE = 12


class DrivenSliders(Arrays):
    """All driven sliders of a scene.

    Attributes
    ----------
    table
        Columns of `Sliders`, start of the profile; shape (n, 13).
    state
        Of the drives, shape (n, 3).
    profiles
        Packed, one after the other.
    """

    table: Ints2
    state: Floats2
    profiles: Floats1


def pack(joints: Sequence[Slider], places: Sequence[JointPlace], book: MarkerBook) -> DrivenSliders:
    """Make the kind."""
    made = slider.pack(joints, places, book)
    profiles, starts, state = pack_profiles([joint.drive for joint in joints])
    table = np.ascontiguousarray(np.column_stack([made.table, starts]))
    return DrivenSliders(table, state, profiles)


@implement(fill_rows, DrivenSliders)
@kernel(internal=True)
def fill_driven_slider_rows(
    kind: DrivenSliders, with_residual: bool, work: Workspace, system: RowArrays
) -> None:
    """Rows of the slider and of its travel."""
    fill_slider_rows(kind, with_residual, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block = entry[BLOCK]
        value = travel_row(system, block, ROW, work, entry[POINT_A], entry[POINT_B], entry[Z_A])
        if with_residual:
            residuals(system, block)[ROW] = value - kind.state[j, PRESCRIBED]


@implement(set_targets, DrivenSliders)
@kernel(internal=True)
def aim_driven_sliders(
    kind: DrivenSliders, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """Follow the profile."""
    for j in range(kind.table.shape[0]):
        entry, state = kind.table[j], kind.state[j]
        aim(system, entry[BLOCK], ROW, kind.profiles, entry[PROFILE], state, time, step, at_midpoint)


@implement(fill_bias, DrivenSliders)
@kernel(internal=True)
def fill_driven_slider_bias(kind: DrivenSliders, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms and the prescribed acceleration."""
    fill_slider_bias(kind, time, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        gamma = travel_bias(work, entry[POINT_A], entry[POINT_B], entry[Z_A])
        targets(system, entry[BLOCK])[ROW] = profile_value(kind.profiles, entry[PROFILE], time)[2] - gamma


@implement(record_joints, DrivenSliders)
@kernel(internal=True)
def record_driven_sliders(
    kind: DrivenSliders, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """As a slider, with the force and the work of the drive."""
    record_sliders(kind, time, work, system, row)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        add_force(system, entry[BLOCK], ROW, work, entry[Z_A], row, entry[COLUMN])
        work.sums.drive_work += drive_work(system, entry[BLOCK], ROW, kind.state[j])
