"""The kind of rigid bodies: centre of mass and principal axes inside, the user's frame outside.

In principal axes through the centre of mass the mass matrix is diagonal and constant. The step
carries the spatial angular momentum ``L = R I w``, so no gyroscopic torque is ever evaluated::

    xb, Rb  from half a step along an arc
    vb = v + h/2 F/m,           wb = I^-1 ( Rb^T L + h/2 t )
    x += h vb,  R := R exp(h wb),  v := 2 vb - v,  L := 2 Rb I wb - L,  w = I^-1 R^T L

Rb is predicted. Where it is off by an angle d, the momentum across the axis of a rod has the part d I2 w2 along it, and
the spin about the axis is wrong by d w2 I2/I1: a rod with I1 far below I2 would spin up by itself, and no step is small
enough. So a slender body carries the momentum about its first axis in its own axes, with the gyroscopic torque at the
predicted spin, which is small, for |I2 - I3| <= I1::

    I1 w1b = I1 w1 + h/2 ( (I2 - I3) w2* w3* + t1 ),      w1 := 2 w1b - w1

The spatial angular momentum then is kept to second order, not to rounding; the energy is ten to a hundred times better.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.records import Quaternion, Records, Vector, records
from heavylift.solver.bodies.frames.base import Frame, FrameBodies, FrameIndex, FrameMotion
from heavylift.solver.interface import Coordinates

__all__ = ["RigidBodies", "RigidFrame", "RigidFrames", "RigidIndex"]


class RigidIndex(FrameIndex):
    """Where a rigid body is among the others.

    Attributes
    ----------
    state_place
        Of position and quaternion in a state vector of the accurate integrator.
    """

    state_place: int


class RigidFrame(Frame, whole_lines=True):
    """What is known of a rigid body. Its frame has the centre of mass as origin, and principal axes.

    Attributes
    ----------
    principal_inertia, inverse_mass, inverse_inertia
        Constants, and reciprocals of them and of the mass [kg, kg m2].
    centre, axes
        Centre of mass [m] and principal axes (quaternion) in the frame of the user.
    arc
        Share of ``h^2 a`` in the midpoint: 1/8 along an arc, 0 along a straight line.
    slender
        Whether the first moment of inertia is so much less than the others that the momentum about that axis is carried
        by itself.
    end
        Motion of a driven body at the end of the step; in records that of the frame of the user.
    """

    principal_inertia: Vector
    inverse_mass: float
    inverse_inertia: Vector
    centre: Vector
    axes: Quaternion
    arc: float
    slender: int
    end: FrameMotion


class RigidFrames(FrameBodies):
    """Base of the kinds of rigid bodies: marker data are points from the centre of mass and directions, principal axes.

    The reach of a body is the distance of what is attached from the centre of mass, at least the radius of gyration.
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        *FrameBodies.kernel_modules,
        "heavylift.solver.bodies.rigid.step",
        "heavylift.solver.bodies.rigid.record",
    )

    largest_turn: ClassVar[float] = 1.0

    table: Records[RigidIndex]
    frame: Records[RigidFrame]

    def _inertia(self) -> NDArray[np.float64]:
        """Masses and principal inertias."""
        return np.hstack([np.repeat(self.frame["mass"][:, None], 3, axis=1), self.frame["principal_inertia"]])


class RigidBodies(RigidFrames):
    """All rigid bodies of a scene but those that float."""

    kernel_modules: ClassVar[tuple[str, ...]] = (
        *RigidFrames.kernel_modules,
        "heavylift.solver.bodies.rigid.accurate",
    )

    carried_fields: ClassVar[tuple[str, ...]] = ("frame",)

    def straighten(self) -> None:
        """Of all bodies."""
        self.frame["arc"] = 0.0

    def place_coordinates(self, place: int) -> tuple[Records[Coordinates], int]:
        """Coordinates in a state vector of the accurate integrator, from a place on, and the place behind them."""
        table, found = self.table, records(Coordinates, len(self.table))
        table["state_place"] = place + 7 * np.arange(len(table))
        found["number"], found["motion"] = table["number"], table["motion"]
        found["place"], found["velocity"] = table["state_place"], table["dof"]
        found["reach"] = self.frame["reach"]
        return found, place + 7 * len(table)

    def write_state(self, values: Floats1) -> None:
        """Carried state into a state vector."""
        for one, frame in zip(self.table, self.frame, strict=True):
            values[one.dof : one.dof + 6] = frame.twist
            values[one.state_place : one.state_place + 7] = frame.pose
