"""What every kind offers to the step: the generic functions, their arguments and the shared workspace.

Coordinates of a body are its velocities ``U``: of a rigid frame the world velocity of the frame
origin and the body-axis angular velocity, then the flexible coordinates. A *marker* is a vector
attached to a body, a material point or a direction; forces act on markers and never see what
kind of body is behind them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.kinds import generic

__all__ = [
    "ANGULAR_MOMENTUM",
    "DISSIPATED",
    "DRIVE_WORK",
    "ELASTIC",
    "ENERGY_NAMES",
    "EXTERNAL_WORK",
    "FIELD",
    "KINETIC",
    "LINEAR_MOMENTUM",
    "POINT",
    "POINT_FORCE",
    "POINT_VELOCITY",
    "POTENTIAL",
    "STATUS_BODY",
    "STATUS_OUTCOME",
    "SUM_COUNT",
    "Workspace",
    "add_forces",
    "add_totals",
    "advance",
    "check",
    "correct",
    "factor",
    "fill_markers",
    "finish",
    "predict",
    "record",
    "start",
    "thesis_advance",
    "thesis_velocity",
]

STATUS_OUTCOME, STATUS_BODY = 0, 1
"""Places of `Workspace.status`: an `Outcome`, and the number of the body it concerns."""

POINT, POINT_VELOCITY, POINT_FORCE = 0, 3, 6
"""Columns of `Workspace.markers`."""

FIELD = 0
"""Place of the acceleration of gravity in `Workspace.sums`."""

KINETIC, ELASTIC, POTENTIAL, EXTERNAL_WORK, DRIVE_WORK, DISSIPATED = range(3, 9)
"""Places of the energies in `Workspace.sums`."""

LINEAR_MOMENTUM, ANGULAR_MOMENTUM, SUM_COUNT = 9, 12, 15
"""Places of the momenta in `Workspace.sums`, and its length."""

ENERGY_NAMES = ("kinetic", "elastic", "potential", "external_work", "drive_work", "dissipated")


class Workspace(NamedTuple):
    """Arrays shared by all kinds during a step, made once a scene.

    Attributes
    ----------
    velocity
        Generalised velocities of the stage, of all bodies [m/s, rad/s, modal], shape (dof_count,).
    markers
        Marker vectors in world axes (positions [m] or unit directions), their rates at the predicted
        midpoint velocity, and the forces on them [N]; shape (marker_count, 9).
    jacobian
        Derivatives of the vectors by the velocities of their own body, shape (marker_count, 3, widest
        window).
    sums
        Acceleration of gravity [m/s2], energies [J], linear momentum [kg m/s] and angular momentum
        about the world origin [kg m2/s], shape (15,).
    status
        Outcome of the step and the body that caused it, shape (2,).
    """

    velocity: NDArray[np.float64]
    markers: NDArray[np.float64]
    jacobian: NDArray[np.float64]
    sums: NDArray[np.float64]
    status: NDArray[np.int64]


@generic
def start(kinds: Any, time: float) -> None:
    """Bodies: complete the start state: driven frames, products, momenta."""


@generic
def predict(kinds: Any, time: float, step: float) -> None:
    """Bodies: midpoint configuration and predicted midpoint velocity from the carried state."""


@generic
def fill_markers(kinds: Any, at_midpoint: bool, work: Workspace) -> None:
    """Bodies: vectors, rates and Jacobian windows of their markers, at the midpoint or at the carried state."""


@generic
def add_forces(kinds: Any, time: float, work: Workspace) -> None:
    """Forces: add marker forces and gravity at a time [s] to the workspace."""


@generic
def factor(kinds: Any, step: float, work: Workspace) -> None:
    """Bodies: gather forces, factor the own step matrix, write the velocity of the stage."""


@generic
def correct(kinds: Any, step: float, work: Workspace) -> None:
    """Bodies with quadratic velocity forces: re-evaluate these at the velocity found, solve with the same factor."""


@generic
def check(kinds: Any, step: float, work: Workspace) -> None:
    """Bodies: refuse a velocity that is not finite or turns too far in a step, before any state is changed."""


@generic
def advance(kinds: Any, time: float, step: float, work: Workspace) -> None:
    """Bodies: configuration and momenta to the end of the step, work of the forces."""


@generic
def finish(kinds: Any, step: float, work: Workspace) -> None:
    """Bodies: end velocities and accelerations from the momenta."""


@generic
def thesis_velocity(kinds: Any, time: float, step: float, work: Workspace) -> None:
    """Bodies: end velocity of the first-order scheme from forces at the start of the step."""


@generic
def thesis_advance(kinds: Any, time: float, step: float, work: Workspace) -> None:
    """Bodies: configuration by the end velocity."""


@generic
def record(kinds: Any, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Bodies: write the carried state, reactions and sensors into their columns of a record."""


@generic
def add_totals(kinds: Any, work: Workspace) -> None:
    """Bodies: add energies, works and momenta of the carried state to the totals."""
