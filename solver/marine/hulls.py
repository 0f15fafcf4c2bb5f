"""The kind of hulls: rigid bodies that float, with the mass of the water that they carry along.

Bodies are kept as in `heavylift.solver.bodies.rigid`: centre of mass and principal axes. Added mass, memory and
waves belong to hydrodynamic coordinates, surge to yaw at a reference point in axes that follow the heading. With
their velocities ``u = T(q) U`` the step of "Integrated simulation ... (2018)", eq. 49, in the middle of the step is::

    ( M + T^T (A_inf + h/2 (B + D)) T + h^2/4 K ) Ub = M U + T^T A_inf u + h/2 ( Q + h/2 K U + T^T (F_w - F_m) )

with the memory force ``F_m + B u`` of Cummins' equation and the stiffness K of buoyancy and lines: added mass larger
than the mass, and steps that are long for the hydrostatics, do no harm. Hulls that interact share one matrix, and
joints see them as one body with 6 N velocities.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.records import Records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.rigid import RigidFrame, RigidIndex
from heavylift.solver.kinds import Table
from heavylift.solver.marine.clipping import CLIP_WIDTH

__all__ = ["Hulls", "start_filters"]

# columns of `hulls`
GROUP, OFFSET, RESTORING, FIRST_POINT, LAST_POINT, FIRST_TRIANGLE, LAST_TRIANGLE, FIRST_TANK, LAST_TANK = (
    range(9)
)
HULL_COLUMNS = 9
UNDER_WATER, CLIPPED, LINEAR = range(3)
"""Values of `RESTORING`."""

# columns of `groups`: first hull, number of hulls, first velocity, first number of its matrices
FIRST, COUNT, GROUP_DOF, MATRIX = range(4)

# columns of `hull`: reference point, x and y axes of the body, in principal axes; linear restoring; damping;
# cut-off of the filter; volume below which a database does not hold
REFERENCE, AXIS_X, AXIS_Y, BUOYANCY, FLOAT_PLANE, WATERPLANE, DISPLACED = 0, 3, 6, 9, 12, 15, 21
QUADRATIC, CUT_OFF, LEAST_VOLUME = 22, 28, 29
HULL_WIDTH = 32

# columns of `stage`, scratch of a step: T of the middle and of the end, heading and place that the waves see, clip,
# displacement to the pose of the stage in coordinates of the body, buoyancy in them, its stiffness (z, x, y), rotation
# at the start or end, predicted displacement, at which lines were evaluated; place and heading of the middle; energy of
# the water by the turn of its axes before the step
TRANSFORM, END_TRANSFORM, HEADING, PLACE, CLIP, PREDICTED, LIFT, STIFFNESS, ROTATION, FORESEEN, TARGET, TURNED = (
    0, 36, 72, 73, 75, 75 + CLIP_WIDTH, 81 + CLIP_WIDTH, 87 + CLIP_WIDTH, 93 + CLIP_WIDTH, 102 + CLIP_WIDTH,
    108 + CLIP_WIDTH,
    111 + CLIP_WIDTH,
)  # fmt: skip
STAGE_WIDTH = 128

# rows of `vectors`: velocities in hydrodynamic coordinates at start, middle and end of the step; memory force without
# the part of the middle velocity; force of the waves; of memory and damping; right-hand side of the step, its change,
# scratch; velocities at the start as the mass of the water needs them; what is known of those of the middle
START, MIDDLE, FINISH, KNOWN, WAVE, RADIATED, LOAD, CHANGE, SCRATCH, LEAD, SPEED = range(11)
VECTORS = 11

# columns of `state` for each hull: low-passed x, y, heading and rates; energy dissipated; work of waves and ballast;
# by how much twice the velocities of the middle exceed the sum of those of both ends, over the square of the step;
# heading with all its turns
LOW_PASS, LOST, SUPPLIED, LAG, YAW = 0, 6, 7, 8, 14
STATE_WIDTH = 15

# columns of `tanks`: point in principal axes, mass, velocity, free surfaces, velocity at the start that its mass needs
TANK_POINT, TANK_MASS, TANK_VELOCITY, TANK_SURFACE, TANK_START = 0, 3, 4, 7, 9
TANK_WIDTH = 12


class Parts(Table):
    """What a database brings: memories, or excitations, of hulls."""


class Hulls(Arrays):
    """All hulls of a scene; columns are named at the top of this file.

    Attributes
    ----------
    table, constants, frame, markers, sensors
        As in the kind of rigid bodies.
    hulls, groups
        Where the data of each hull and of each group of interacting hulls are; shapes (nb, 9), (ng, 4).
    water
        Density times gravity [N/m3], gravity [m/s2], level [m]; shape (3,).
    hull, stage
        Constants and scratch of each hull, shapes (nb, 32), (nb, 128).
    points, triangles, placed
        Surfaces in principal axes through the centres of mass, and their vertices in world directions.
    added_mass, damping, implicit
        At infinite frequency; constant; of the memory at the velocity of the middle: shapes (6 nb, 6 nb).
    vectors
        Forces and velocities in hydrodynamic coordinates, shape (11, 6 nb).
    matrices
        Of each group: factor of the step, factor of its end or matrix of the corrected middle, matrix of the step;
        flat.
    tank_table, tank_times, tanks
        Hull, first row and rows of the schedule; schedule: time [s], mass [kg]; what the step needs of each.
    tangents, rate_tangents, line_ends
        Stiffness and damping matrices of lines and fenders, shared with them, shapes (n, 9); hull, marker, line
        and other end, or -1, of each end.
    state
        Carried, flat: `STATE_WIDTH` numbers a hull, the lag of the velocity of each tank (3), the states of the parts.
    radiation, excitation
        Parts that a database brings; empty without one.
    gauge
        Undisturbed waves, for records: omega, kx, ky, phase, amplitude; shape (5, m).
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.marine.hull_contours",
        "heavylift.solver.marine.hull_joints",
        "heavylift.solver.marine.hull_record",
        "heavylift.solver.marine.hull_stage",
        "heavylift.solver.marine.hulls_configuration",
        "heavylift.solver.marine.hull_step",
    )

    table: Records[RigidIndex]
    constants: Floats1
    frame: Records[RigidFrame]
    markers: Ints2
    sensors: Ints2
    hulls: Ints2
    groups: Ints2
    water: Floats1
    hull: Floats2
    stage: Floats2
    points: Floats2
    triangles: Ints2
    placed: Floats2
    added_mass: Floats2
    damping: Floats2
    implicit: Floats2
    vectors: Floats2
    matrices: Floats1
    tank_table: Ints2
    tank_times: Floats2
    tanks: Floats2
    tangents: Floats2
    rate_tangents: Floats2
    line_ends: Ints2
    state: Floats1
    radiation: Parts
    excitation: Parts
    gauge: Floats2

    def sharing_state(self) -> Hulls:
        """The same with the states of its parts as views of its own, which has been replaced."""
        at = STATE_WIDTH * len(self.table) + 3 * len(self.tank_table)
        parts = []
        for part in self.radiation:
            old = part.memory.state
            view = self.state[at : at + old.size].reshape(old.shape)
            parts.append(part._replace(memory=part.memory._replace(state=view)))
            at += old.size
        return self._replace(radiation=Parts(parts))


def start_filters(kind: Hulls) -> None:
    """Position and heading that the waves see start at those of the hulls."""
    for row in range(len(kind.table)):
        R = rotation_matrix(kind.frame[row].orientation)
        place = kind.frame[row].position + R @ kind.hull[row, REFERENCE : REFERENCE + 3]
        forward = R @ kind.hull[row, AXIS_X : AXIS_X + 3]
        at = STATE_WIDTH * row + LOW_PASS
        heading = np.arctan2(forward[1], forward[0])
        kind.state[at : at + 6] = place[0], 0.0, place[1], 0.0, heading, 0.0
        kind.state[STATE_WIDTH * row + YAW] = heading
