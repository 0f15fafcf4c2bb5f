"""The kind of floating-frame bodies: a moving reference frame plus modal coordinates.

"Deformable bodies with complex geometries ... sliding contacts" (2014), chapter 2, with unit
quaternions and body-axis angular velocity in place of Cardan angles, so that neither the
singularity of eq. 2.31 nor the incomplete quadratic terms of eq. 2.79 arise.

All matrices of the deformed body come from a few shape integrals (`ShapeIntegrals`). With
``q`` the modal coordinates, the quadratic ones enter through products of six symmetric and
three antisymmetric matrices with q and its rate::

    H_11 = S_11 ... H_12 = S_12 + S_21 ...    A_1 = S_23 - S_32, A_2 = S_31 - S_13, A_3 = S_12 - S_21

which are evaluated once a step, stacked as one matrix, and carried with the state.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.modal.invariants import ShapeIntegrals
from heavylift.modal.reduced import ReducedBody
from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.outcome import InputError
from heavylift.numerics.small import aligned
from heavylift.solver.drive import DRIVEN, FIXED, FREE, pack_drive
from heavylift.solver.markers import BodyMarkers, pack_markers
from heavylift.solver.scene_bodies import Driven, Fixed, FlexibleBody, Free

__all__ = ["FixedFrameBodies", "FlexibleBodies", "FloatingFrameBodies", "pack_floating_frames", "pack_shape"]

# columns of `table`; starts are places in `constants`
MODES, MODAL, DOF, SHAPE, MOTION, DRIVE, COLUMN, NUMBER = range(8)

# columns of `frame`: the carried state of the reference frame ...
POSITION = 0  # frame origin, world [m]
ORIENTATION = 3  # unit quaternion
VELOCITY = 7  # world [m/s]
SPIN = 10  # body axes [rad/s]
ACCELERATION = 13  # difference quotient of the last step, world [m/s2]
SPIN_RATE = 16  # likewise, body axes [rad/s2]
MOMENTUM = 19  # world [kg m/s]
ANGULAR_MOMENTUM = 22  # about the frame origin, world axes [kg m2/s]
WORK = 25  # of external forces, of the drive, and dissipated [J]
# ... and the scratch of a step
MID_POSITION = 28
MID_VELOCITY = 31  # predicted, body axes
MID_SPIN = 34
TRANSPORTED = 37  # angular momentum about the midpoint origin, world axes
FORCE = 40  # resultant of the marker forces, world axes
MOMENT = 43  # of the marker forces about the origin of the stage, body axes
FIRST_MOMENT = 46  # S_t = I1 + S q
INERTIA = 49  # I_tt: 11 22 33 12 13 23
FRAME_RHS = 55  # right-hand side of the six frame rows, body axes
START_VELOCITY = 61  # v, w at the start of the step
MID_POSE = 67  # position and quaternion of a driven frame
PRESCRIBED = 74  # velocity, spin, acceleration, spin rate of a driven frame
DRIVEN_VELOCITY = 86  # mean of both ends of the step
MID_ROTATION = 92  # rotation matrix of the stage, row by row
END_ROTATION = 101  # and of the end of the step
FACTOR = 110  # Cholesky factor of the frame block, 6 x 6, row by row
LAG = 146  # carried: how far the midpoint velocity lies from the mean of both ends of a step
FOUND = 152  # velocity of the stage: world, and spin in body axes, of driven frames in world axes
JOINT_FORCE = 158  # of the joints on a held frame at the carried state, as FORCE and MOMENT
REACH = 164  # largest distance of a node from the frame origin
AT_END = 165  # 1 once inertia and velocities belong to the end of the step, 0 before
NEGATIVE = 166  # the Cholesky factor, its numbers off the diagonal with the other sign
FRAME_WIDTH = 208  # whole cache lines

# rows of `modal`: coordinates, rates, difference quotient of the rates; constants; scratch
Q, RATE, RATE2, STIFFNESS, DAMPING, MID_Q, MID_RATE, INVERSE, ROW, LOAD, QUADRATIC, S1, TF1 = (*range(12), 14)
SCALED = (
    TF1 + 3
)  # the couplings S and I_tf have three rows each; [S; I_tf] times the inverse modal diagonal, six
JOINT_LOAD = SCALED + 6  # of the joints on a held body at the carried state
MODAL_ROWS = JOINT_LOAD + 1

# rows of `products`: [A_1; A_2; A_3; H_11 H_22 H_12 H_13 H_23] times a vector
AT_Q, AT_RATE, AT_RATE2, AT_MIDPOINT, AT_VELOCITY = range(5)  # the last: at the midpoint velocity

# a packed shape: the stacked matrices (n x 8 n), then
SHAPE_MASS = 0
SHAPE_FIRST_MOMENT = 1
SHAPE_INERTIA = 4  # I_11 I_22 I_33 I_12 I_13 I_23
SHAPE_HEAD = 10  # then S (3 n), Ibar antisymmetric (3 n), Ibar symmetric (6 n)


SMALLEST_FRAME_SHARE = 0.1
"""Of the inertia of a free body that its modes must not carry with them."""


class FloatingFrameBodies(Arrays):
    """All floating-frame bodies of a scene; columns and rows are named at the top of this file.

    Attributes
    ----------
    table
        Mode count, first modal coordinate, first velocity, start of the shape, motion, start of the
        drive, first record column, number in the scene; shape (nb, 8).
    constants
        Packed inertia shapes (bodies of one reduced model share one), drives, and marker data: of a
        point its body-frame position [m] and mode shapes, 3 + 3 nf, component by component; of a
        direction the body-frame vector.
    frame
        State of the frames and scratch of the step, shape (nb, 208).
    modal
        State of the modes, modal stiffness [1/s2] and damping [1/s], and scratch; shape (24, modes of
        all bodies).
    products
        Stacked matrix products, shape (5, 8 x modes of all bodies).
    markers
        Points and directions that forces act on: number in the workspace, row of the body, start of the
        data, 1 for a direction, what it serves; shape (m, 5).
    sensors
        Points that are recorded: first record column, then the same; shape (m, 5).
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.bodies.floating_frame_advance",
        "heavylift.solver.bodies.floating_frame_configuration",
        "heavylift.solver.bodies.floating_frame_contours",
        "heavylift.solver.bodies.floating_frame_joints",
        "heavylift.solver.bodies.floating_frame_record",
        "heavylift.solver.bodies.floating_frame_step",
        "heavylift.solver.bodies.floating_frame_thesis",
    )

    table: Ints2
    constants: Floats1
    frame: Floats2
    modal: Floats2
    products: Floats2
    markers: Ints2
    sensors: Ints2


class FixedFrameBodies(Arrays):
    """All flexible bodies with fixed frames; the fields are those of `FloatingFrameBodies`."""

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.bodies.fixed_frame",
        "heavylift.solver.bodies.fixed_frame_joints",
        "heavylift.solver.bodies.floating_frame_configuration",
        "heavylift.solver.bodies.floating_frame_contours",
    )

    table: Ints2
    constants: Floats1
    frame: Floats2
    modal: Floats2
    products: Floats2
    markers: Ints2
    sensors: Ints2


FlexibleBodies = FloatingFrameBodies | FixedFrameBodies
"""Kinds that share this layout, and with it the functions for markers and shapes."""


def pack_shape(integrals: ShapeIntegrals) -> NDArray[np.float64]:
    """Flatten shape integrals into the block the kernels read.

    Notes
    -----
    The stacked matrices are stored by columns, ``T[j, r]`` being the factor of ``q_j`` in product r:
    a sum of long scaled rows runs at vector speed for any number of modes. (Reading only one half of
    each matrix was slower: arithmetic limits here, not memory.)
    """
    S = integrals.mode_mode
    Ibar = integrals.position_mode
    I = integrals.inertia_kl
    head = np.array([integrals.mass, *integrals.first_moment, *np.diag(I), I[0, 1], I[0, 2], I[1, 2]])
    antisymmetric = ((1, 2), (2, 0), (0, 1))
    symmetric = ((0, 1), (0, 2), (1, 2))
    stacked = [S[k, l] - S[l, k] for k, l in antisymmetric]
    stacked += [S[k, k] for k in range(2)] + [S[k, l] + S[l, k] for k, l in symmetric]
    Ibar_rows = [Ibar[k, l] - Ibar[l, k] for k, l in antisymmetric]
    Ibar_rows += [Ibar[k, k] for k in range(3)] + [Ibar[k, l] + Ibar[l, k] for k, l in symmetric]
    block = np.concatenate(
        [
            np.ascontiguousarray(np.concatenate(stacked).T).ravel(),
            head,
            integrals.modal_translation.ravel(),
            np.concatenate(Ibar_rows),
        ]
    )
    return np.concatenate([block, np.zeros(-len(block) % 8)])  # the next block begins at a cache line too


def pack_floating_frames(
    bodies: Sequence[FlexibleBody],
    first_number: int,
    first_dof: int,
    first_column: int,
    markers: Sequence[BodyMarkers],
    sensors: Sequence[BodyMarkers],
) -> FloatingFrameBodies:
    """Make the kind from what the user said; start velocities of driven frames are set by the integrator.

    Parameters
    ----------
    bodies
        In the order of their rows.
    first_number, first_dof, first_column
        Number of the first body in the scene, place of its velocities and of its first record column.
    markers, sensors
        Points and directions of each body with their numbers; same order as `bodies`.

    Raises
    ------
    InputError
        If the modes of a free body move it almost rigidly.
    """
    counts = [body.reduced.mode_count for body in bodies]
    modal_starts = np.concatenate([[0], np.cumsum(counts)])
    total = int(modal_starts[-1])
    index = np.zeros((len(bodies), 8), dtype=np.int64)
    frame = np.zeros((len(bodies), FRAME_WIDTH))
    modal = np.zeros((MODAL_ROWS, total))
    constants: list[NDArray[np.float64]] = []  # shapes first: their blocks keep the alignment
    shape_starts: dict[int, int] = {}
    for body in bodies:
        if id(body.reduced) not in shape_starts:
            shape_starts[id(body.reduced)] = sum(map(len, constants))
            constants.append(pack_shape(body.reduced.integrals))
    dof, column = first_dof, first_column
    for row, body in enumerate(bodies):
        reduced = body.reduced
        if isinstance(body.motion, Free) and not reduced.mean_axis:
            _check_free_modes(body.name, reduced.integrals)
        modes = slice(modal_starts[row], modal_starts[row + 1])
        motion = {Free: FREE, Fixed: FIXED, Driven: DRIVEN}[type(body.motion)]
        index[row] = (
            counts[row],
            modal_starts[row],
            dof,
            shape_starts[id(reduced)],
            motion,
            sum(map(len, constants)),
            column,
            first_number + row,
        )
        if isinstance(body.motion, Driven):
            constants.append(pack_drive(body.motion, body.position, body.orientation))
        frame[row, POSITION : POSITION + 3] = body.position
        frame[row, ORIENTATION : ORIENTATION + 4] = body.orientation / np.linalg.norm(body.orientation)
        frame[row, REACH] = np.linalg.norm(reduced.nodes, axis=1).max(initial=0.0)
        if isinstance(body.motion, Free):
            frame[row, VELOCITY : VELOCITY + 3] = body.velocity
            frame[row, SPIN : SPIN + 3] = body.angular_velocity
        if body.modal_position.size:
            modal[Q, modes] = body.modal_position
        if body.modal_velocity.size:
            modal[RATE, modes] = body.modal_velocity
        modal[STIFFNESS, modes] = reduced.eigenvalues
        modal[S1:TF1, modes] = reduced.integrals.modal_translation
        if body.damping_ratio.size:
            modal[DAMPING, modes] = 2.0 * body.damping_ratio * np.sqrt(np.maximum(reduced.eigenvalues, 0.0))
        dof += 6 + counts[row]
        column += 13 + 2 * counts[row] + (0 if isinstance(body.motion, Free) else 6)
    shapes_of = [_marker_shapes(body.reduced) for body in bodies]
    marker_index = pack_markers(markers, shapes_of, constants)
    sensor_index = pack_markers(sensors, shapes_of, constants)
    flat = aligned(sum(map(len, constants)))
    flat[:] = np.concatenate(constants)
    return FloatingFrameBodies(
        table=index,
        constants=flat,
        frame=frame,
        modal=modal,
        products=aligned((5, 8 * total)),
        markers=marker_index,
        sensors=sensor_index,
    )


def _check_free_modes(name: str, integrals: ShapeIntegrals) -> None:
    """Refuse modes that leave a free frame next to no inertia of its own.

    Notes
    -----
    With ``C = [S; I_tf]`` the share is the smallest eigenvalue of ``M_rr - C C^T`` relative to ``M_rr``,
    which depends neither on units nor on the place of the frame: 1 for mean-axis modes. Tumbling bodies
    of point masses stayed in balance above 0.2 and blew up below 0.05, at every step tried.
    """
    Ibar, I = integrals.position_mode, integrals.inertia_kl
    C = np.vstack(
        [
            integrals.modal_translation,
            Ibar[1, 2] - Ibar[2, 1],
            Ibar[2, 0] - Ibar[0, 2],
            Ibar[0, 1] - Ibar[1, 0],
        ]
    )
    M = np.zeros((6, 6))
    M[:3, :3] = integrals.mass * np.eye(3)
    M[3:, 3:] = np.trace(I) * np.eye(3) - I
    s1, s2, s3 = integrals.first_moment
    M[3:, :3] = [[0.0, -s3, s2], [s3, 0.0, -s1], [-s2, s1, 0.0]]
    M[:3, 3:] = M[3:, :3].T
    shared = np.linalg.solve(np.linalg.cholesky(M), C)
    share = 1.0 - float(np.linalg.norm(shared, 2)) ** 2 if C.size else 1.0
    if share < SMALLEST_FRAME_SHARE:
        raise InputError(
            f"its modes move it almost rigidly: {share:.2g} of its inertia is left to the free frame",
            source=name,
            key="reduced",
            expected=f"{SMALLEST_FRAME_SHARE} or more: reduce it with mean-axis modes, or hold its frame",
        )


def _marker_shapes(reduced: ReducedBody) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Return a function from a body-frame point to (undeformed position, 3 nf mode shape entries)."""

    def shapes(point: NDArray[np.float64]) -> NDArray[np.float64]:
        node = reduced.nearest_node(point)
        return np.concatenate([reduced.nodes[node], reduced.mode_shapes[:, node, :].T.ravel()])

    return shapes
