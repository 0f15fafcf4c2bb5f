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
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.modal.invariants import ShapeIntegrals
from heavylift.modal.reduced import ReducedBody
from heavylift.numerics.arrays import Floats1, Floats2
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, Vector, Vector6, records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.numerics.small import aligned
from heavylift.solver.bodies.frames.base import Frame, FrameBodies, FrameIndex
from heavylift.solver.drive import DRIVEN, FIXED, FREE, pack_drive
from heavylift.solver.interface import Workspace
from heavylift.solver.markers import BodyMarkers, PackedMarker, pack_markers
from heavylift.solver.scene.bodies import Driven, Fixed, FlexibleBody, Free

__all__ = [
    "FlexibleIndex",
    "FloatingFrame",
    "FloatingFrameBodies",
    "pack_floating_frames",
    "pack_shape",
]

SMALLEST_FRAME_SHARE = 0.1
"""Of the inertia of a free body that its modes must not carry with them."""


class FlexibleIndex(FrameIndex):
    """Where a flexible body is among the others.

    Attributes
    ----------
    mode_count, first_mode
        Modes, and place of the first of them among those of all bodies.
    shape_start
        Place of its shape in the constants.
    """

    mode_count: int
    first_mode: int
    shape_start: int


class FloatingFrame(Frame, whole_lines=True):
    """Frame of a flexible body: its carried state, constants of the body, scratch of a step.

    Accelerations are difference quotients of the last step. The reach is that of the farthest node.

    Attributes
    ----------
    dissipated_work
        [J].
    linear_momentum
        World axes [kg m/s].
    lag
        How far the midpoint velocity lies from the mean of both ends of a step: velocity, spin.
    undeformed_first_moment, undeformed_second_moments
        Integrals of ``x`` [kg m], and of ``x x^T``: 11 22 33 12 13 23 [kg m2], body axes.
    transported_momentum
        Angular momentum about the midpoint origin, world axes.
    first_moment, inertia
        ``S_t = I1 + S q`` and ``I_tt``: 11 22 33 12 13 23.
    right_hand_side
        Of the six frame rows, body axes.
    start_velocity
        Velocity and spin at the start of the step.
    stage_velocity
        Velocity found for the stage: world, and spin in body axes, of driven frames in world axes.
    mid_pose
        Position and quaternion of a driven frame at the midpoint.
    end_rotation
        Rotation matrix at the end of the step, row by row.
    at_end
        Whether inertia and velocities belong to the end of the step.
    factor, negative_factor
        Cholesky factor of the frame block, 6 x 6, row by row; the same, its numbers off the diagonal with the other
        sign.
    """

    dissipated_work: float
    linear_momentum: Vector
    lag: Vector6
    undeformed_first_moment: Vector
    undeformed_second_moments: Vector6
    transported_momentum: Vector
    first_moment: Vector
    inertia: Vector6
    right_hand_side: Vector6
    start_velocity: Vector6
    stage_velocity: Vector6
    mid_pose: Annotated[NDArray[np.float64], (7,)]
    end_rotation: Annotated[NDArray[np.float64], (9,)]
    at_end: bool
    factor: Annotated[NDArray[np.float64], (36,)]
    negative_factor: Annotated[NDArray[np.float64], (36,)]


class FloatingFrameBodies(FrameBodies):
    """All bodies of a scene with modes: their frames are free, driven or fixed.

    Attributes
    ----------
    constants
        Packed inertia shapes (bodies of one reduced model share one), drives, and marker data: of a
        point its body-frame position [m] and mode shapes, 3 + 3 nf, component by component; of a
        direction the body-frame vector.
    modal_position, modal_velocity, modal_acceleration
        State of the modes of all bodies: coordinates, rates, difference quotients of the rates; shape (modes,), as
        all of the following have for their last dimension.
    stiffness, damping
        Modal constants [1/s2, 1/s].
    translation
        Coupling S of the modes with the velocity of the frame, body axes, constant; shape (3, modes).
    mid_modal_position, mid_modal_velocity
        Of the stage.
    modal_load, quadratic_force
        Modal forces of the markers; centrifugal and Coriolis forces.
    modal_right_hand_side, inverse_diagonal
        Of the modal rows of the step matrix: right-hand side, and reciprocal of the diagonal.
    coupling
        Coupling I_tf of the modes with the spin of the frame, body axes; shape (3, modes).
    scaled_coupling
        ``[S; I_tf]`` times the inverse modal diagonal; shape (6, modes).
    position_products, velocity_products, acceleration_products
        Products ``[A_1; A_2; A_3; H_11 H_22 H_12 H_13 H_23]`` with the state of the modes, 8 n numbers a body; of the
        difference quotients only the first 3 n.
    midpoint_products, mid_velocity_products
        The same at the midpoint, and with the rates there.
    moves
        Whether the frame of any is free or driven.
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        *FrameBodies.kernel_modules,
        "heavylift.solver.bodies.floating_frame.advance",
        "heavylift.solver.bodies.floating_frame.contours",
        "heavylift.solver.bodies.floating_frame.joints",
        "heavylift.solver.bodies.floating_frame.record",
        "heavylift.solver.bodies.floating_frame.step",
        "heavylift.solver.bodies.floating_frame.thesis",
    )

    carried_fields: ClassVar[tuple[str, ...]] = (
        "frame",
        "modal_position",
        "modal_velocity",
        "modal_acceleration",
        "position_products",
        "velocity_products",
        "acceleration_products",
    )

    # thin bodies first: above it errors are of order one
    largest_turn: ClassVar[float] = 0.25

    table: Records[FlexibleIndex]
    frame: Records[FloatingFrame]
    modal_position: Floats1
    modal_velocity: Floats1
    modal_acceleration: Floats1
    stiffness: Floats1
    damping: Floats1
    translation: Floats2
    mid_modal_position: Floats1
    mid_modal_velocity: Floats1
    modal_load: Floats1
    quadratic_force: Floats1
    modal_right_hand_side: Floats1
    inverse_diagonal: Floats1
    coupling: Floats2
    scaled_coupling: Floats2
    position_products: Floats1
    velocity_products: Floats1
    acceleration_products: Floats1
    midpoint_products: Floats1
    mid_velocity_products: Floats1
    moves: bool

    def _inertia(self) -> NDArray[np.float64]:
        """Masses, and undeformed inertias about the centres of mass."""
        frame, mass = self.frame, self.frame["mass"][:, None]
        centre = frame["undeformed_first_moment"] / mass
        second = frame["undeformed_second_moments"][:, :3] - mass * centre**2
        return np.hstack([np.repeat(mass, 3, axis=1), second.sum(axis=1, keepdims=True) - second])

    def _modal_dofs(self) -> NDArray[np.int64]:
        """Places of the velocities of all modes, shape (modes,)."""
        first = self.table["dof"] + 6 - self.table["first_mode"]
        return np.repeat(first, self.table["mode_count"]) + np.arange(len(self.modal_position))

    def survey(
        self, places: NDArray[np.float64], inertia: NDArray[np.float64], velocity: NDArray[np.float64]
    ) -> None:
        """Frames, held ones too, and modes of unit mass."""
        super().survey(places, inertia, velocity)
        inertia[self._modal_dofs()] = 1.0
        velocity[self._modal_dofs()] = self.modal_velocity

    def move(self, increment: NDArray[np.float64]) -> None:
        """Frames, and ``q += e``."""
        super().move(increment)
        self.modal_position[:] += increment[self._modal_dofs()]
        self.frame["at_end"] = False

    def put_velocity(self, velocity: NDArray[np.float64]) -> None:
        """Of free frames, and of all modes."""
        super().put_velocity(velocity)
        self.modal_velocity[:] = velocity[self._modal_dofs()]
        self.modal_acceleration[:] = 0.0
        self.frame["lag"] = 0.0
        self.frame["at_end"] = False

    def collect_load(self, work: Workspace, load: NDArray[np.float64]) -> None:
        """The weight of the deformed bodies, and ``-k q``."""
        super().collect_load(work, load)
        own = self._modal_dofs()
        load[own] -= self.stiffness * self.modal_position
        for row, frame in zip(self.table, self.frame, strict=True):
            modes = slice(row.first_mode, row.first_mode + row.mode_count)
            inside = rotation_matrix(frame.orientation).T @ work.sums.gravity
            S = self.translation[:, modes]
            first_moment = frame.undeformed_first_moment + S @ self.modal_position[modes]
            load[row.dof + 3 : row.dof + 6] += np.cross(first_moment, inside)
            load[own[modes]] += inside @ S


def pack_shape(integrals: ShapeIntegrals) -> NDArray[np.float64]:
    """Flatten shape integrals into the block the kernels read.

    The stacked matrices (8 n n), then S (3 n), Ibar antisymmetric (3 n), Ibar symmetric (6 n).

    Notes
    -----
    The stacked matrices are stored by columns, ``T[j, r]`` being the factor of ``q_j`` in product r:
    a sum of long scaled rows runs at vector speed for any number of modes. (Reading only one half of
    each matrix was slower: arithmetic limits here, not memory.)
    """
    S = integrals.mode_mode
    Ibar = integrals.position_mode
    antisymmetric = ((1, 2), (2, 0), (0, 1))
    symmetric = ((0, 1), (0, 2), (1, 2))
    stacked = [S[k, l] - S[l, k] for k, l in antisymmetric]
    stacked += [S[k, k] for k in range(2)] + [S[k, l] + S[l, k] for k, l in symmetric]
    Ibar_rows = [Ibar[k, l] - Ibar[l, k] for k, l in antisymmetric]
    Ibar_rows += [Ibar[k, k] for k in range(3)] + [Ibar[k, l] + Ibar[l, k] for k, l in symmetric]
    block = np.concatenate(
        [
            np.ascontiguousarray(np.concatenate(stacked).T).ravel(),
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
    kind = _empty(len(bodies), total)
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
        kind.table[row] = (
            dof,
            motion,
            sum(map(len, constants)),
            column,
            first_number + row,
            counts[row],
            modal_starts[row],
            shape_starts[id(reduced)],
        )
        if isinstance(body.motion, Driven):
            constants.append(pack_drive(body.motion, body.position, body.orientation))
        frame, integrals = kind.frame[row], reduced.integrals
        frame.position[:] = body.position
        frame.orientation[:] = body.orientation / np.linalg.norm(body.orientation)
        if isinstance(body.motion, Free):
            frame.velocity[:] = body.velocity
            frame.spin[:] = body.angular_velocity
        frame.mass = integrals.mass
        frame.reach = np.linalg.norm(reduced.nodes, axis=1).max(initial=0.0)
        frame.undeformed_first_moment[:] = integrals.first_moment
        I = integrals.inertia_kl
        frame.undeformed_second_moments[:] = [*np.diag(I), I[0, 1], I[0, 2], I[1, 2]]
        if body.modal_position.size:
            kind.modal_position[modes] = body.modal_position
        if body.modal_velocity.size:
            kind.modal_velocity[modes] = body.modal_velocity
        kind.stiffness[modes] = reduced.eigenvalues
        kind.translation[:, modes] = integrals.modal_translation
        if body.damping_ratio.size:
            critical = np.sqrt(np.maximum(reduced.eigenvalues, 0.0))
            kind.damping[modes] = 2.0 * body.damping_ratio * critical
        dof += 6 + counts[row]
        column += 13 + 2 * counts[row] + (0 if isinstance(body.motion, Free) else 6)
    shapes_of = [_marker_shapes(body.reduced) for body in bodies]
    marker_index = pack_markers(markers, shapes_of, constants)
    sensor_index = pack_markers(sensors, shapes_of, constants)
    flat = aligned(sum(map(len, constants)))
    flat[:] = np.concatenate(constants)
    return kind._replace(
        constants=flat,
        markers=marker_index,
        sensors=sensor_index,
        driven=any(isinstance(body.motion, Driven) for body in bodies),
        moves=any(not isinstance(body.motion, Fixed) for body in bodies),
    )


def _empty(bodies: int, modes: int) -> FloatingFrameBodies:
    """All zeros, for some bodies that have some modes together; no constants and markers."""
    return FloatingFrameBodies(
        table=records(FlexibleIndex, bodies),
        constants=np.zeros(0),
        frame=records(FloatingFrame, bodies),
        modal_position=aligned(modes),
        modal_velocity=aligned(modes),
        modal_acceleration=aligned(modes),
        stiffness=aligned(modes),
        damping=aligned(modes),
        translation=aligned((3, modes)),
        mid_modal_position=aligned(modes),
        mid_modal_velocity=aligned(modes),
        modal_load=aligned(modes),
        quadratic_force=aligned(modes),
        modal_right_hand_side=aligned(modes),
        inverse_diagonal=aligned(modes),
        coupling=aligned((3, modes)),
        scaled_coupling=aligned((6, modes)),
        position_products=aligned(8 * modes),
        velocity_products=aligned(8 * modes),
        acceleration_products=aligned(8 * modes),
        midpoint_products=aligned(8 * modes),
        mid_velocity_products=aligned(8 * modes),
        markers=records(PackedMarker, 0),
        sensors=records(PackedMarker, 0),
        driven=False,
        moves=False,
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
