"""The kind of floating-frame bodies: a moving reference frame plus modal coordinates.

"Deformable bodies with complex geometries ... sliding contacts" (2014), chapter 2, with unit
quaternions and body-axis angular velocity in place of Cardan angles, so that neither the
singularity of eq. 2.31 nor the incomplete quadratic terms of eq. 2.79 arise.

All matrices of the deformed body come from a few shape integrals (`ShapeIntegrals`). With
``q`` the modal coordinates, the quadratic ones enter through products of six symmetric and
three antisymmetric matrices with q and its rate::

    H_11 = S_11 ... H_12 = S_12 + S_21 ...    A_1 = S_23 - S_32, A_2 = S_31 - S_13, A_3 = S_12 - S_21

which are evaluated once a step, stacked as one matrix, and carried with the state.

Small things that all of the kind share: where the data of one body lie (views, no copies), and the step ratio.
"""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1, Floats2
from heavylift.numerics.jit import kernel, view
from heavylift.numerics.records import Records, Vector, Vector6
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.frames.base import Frame, FrameBodies, FrameIndex
from heavylift.solver.drive import FREE
from heavylift.solver.interface import Workspace
from heavylift.solver.scene.bodies import ModalOutputs

__all__ = [
    "FlexibleIndex",
    "FloatingFrame",
    "FloatingFrameBodies",
    "lag_scale",
    "product_columns",
    "shape_of",
]


class FlexibleIndex(FrameIndex):
    """Where a flexible body is among the others.

    Attributes
    ----------
    mode_count, first_mode
        Modes, and place of the first of them among those of all bodies.
    shape_start
        Place of its shape in the constants.
    stiffening
        Place of its geometric stiffening in the constants, -1 of a body without.
    load_count, first_load, load_start
        Loads at places that stiffen it, the first of them among those of all bodies, and place in the constants of what
        finds them in generalised forces.
    parts
        Of its modes in a record.
    """

    mode_count: int
    first_mode: int
    shape_start: int
    stiffening: int
    load_count: int
    first_load: int
    load_start: int
    parts: ModalOutputs


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
    slender, axis, axial_momentum
        Whether the smallest moment of inertia about the centre of mass is well below the others; the axis of it, body
        axes; momentum about that axis through the centre of mass, at the start of the step and then at its end.
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
    stiffening_rate
        Of a body that stiffens: no less than the largest change of its modal stiffness in this step [1/s2].
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
    slender: bool
    axis: Vector
    axial_momentum: float
    first_moment: Vector
    inertia: Vector6
    right_hand_side: Vector6
    start_velocity: Vector6
    stage_velocity: Vector6
    mid_pose: Annotated[NDArray[np.float64], (7,)]
    end_rotation: Annotated[NDArray[np.float64], (9,)]
    at_end: bool
    stiffening_rate: float
    factor: Annotated[NDArray[np.float64], (36,)]
    negative_factor: Annotated[NDArray[np.float64], (36,)]


class FloatingFrameBodies(FrameBodies):
    """All bodies of a scene with modes: their frames are free, driven or fixed.

    Attributes
    ----------
    constants
        Packed inertia shapes (bodies of one reduced model share one), drives, and marker data: of a
        point its body-frame position [m] and mode shapes, 3 + 3 nf, component by component; of a
        direction the body-frame vector, and if modes turn it the rotations of its place, 3 + 3 nf.
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
    shortened
        Of bodies that stiffen: ``E q`` at the position of the inertia.
    unforced
        Velocities of a stage without joints and contacts, of bodies that forces at places stiffen.
    row_loads
        Forces and moments at places [N, N m], axes of the frames: means of those of joints in the last two steps, and
        those of the last one.
    moves
        Whether the frame of any is free or driven.
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        *FrameBodies.kernel_modules,
        "heavylift.solver.bodies.floating_frame.step",
        "heavylift.solver.bodies.floating_frame.contours",
        "heavylift.solver.bodies.floating_frame.joints",
        "heavylift.solver.bodies.floating_frame.record",
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
        "row_loads",
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
    shortened: Floats1
    unforced: Floats1
    row_loads: Floats2
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

    def poses(self) -> tuple[NDArray[np.float64], ...]:
        """Frames, and modal coordinates."""
        return (*super().poses(), np.array(self.modal_position))

    def put_increment(
        self,
        start: tuple[NDArray[np.float64], ...],
        end: tuple[NDArray[np.float64], ...],
        increment: NDArray[np.float64],
    ) -> None:
        """Frames, and modes."""
        super().put_increment(start, end, increment)
        increment[self._modal_dofs()] = end[2] - start[2]

    def put_velocity(self, velocity: NDArray[np.float64]) -> None:
        """Of free frames, and of all modes."""
        super().put_velocity(velocity)
        self.modal_velocity[:] = velocity[self._modal_dofs()]
        self.modal_acceleration[:] = 0.0
        self.frame["lag"] = 0.0
        self.frame["at_end"] = False

    def _soften(self, load: NDArray[np.float64], gravity: NDArray[np.float64]) -> None:
        """Add what loads at places do to the stiffness: those that are there, and the joints of `take_reactions`.

        The weight that is among the loads is none of them.
        """
        for number, row in enumerate(self.table):
            if row.load_count:
                n, m = row.mode_count, row.load_count
                own = slice(row.dof + 6, row.dof + 6 + n)
                at = row.stiffening + 7 * n * n
                G = self.constants[at : at + m * n * n].reshape(m, n, n)
                acting = load.copy()
                acting[row.dof : row.dof + 3] -= self.frame[number].mass * gravity
                of_joints = self.row_loads[0, row.first_load : row.first_load + m]
                factors = of_joints + self._loads_of(number, acting)
                q = self.modal_position[row.first_mode : row.first_mode + n]
                load[own] -= np.tensordot(factors, G, axes=1) @ q

    def _loads_of(self, number: int, force: NDArray[np.float64]) -> NDArray[np.float64]:
        """Loads at the places of a body in generalised forces, shape (m,)."""
        row = self.table[number]
        width, m = 6 + row.mode_count, row.load_count
        acting = force[row.dof : row.dof + width].copy()
        acting[:3] = rotation_matrix(self.frame[number].orientation).T @ acting[:3]
        found: NDArray[np.float64] = (
            self.constants[row.load_start : row.load_start + m * width].reshape(m, width) @ acting
        )
        return found

    def take_reactions(self, pull: NDArray[np.float64]) -> float:
        """Let forces of joints at rest, on all velocities, stiffen; how far that changes what they did, relative."""
        change = largest = 0.0
        for number, row in enumerate(self.table):
            if row.load_count:
                held = slice(row.first_load, row.first_load + row.load_count)
                now = self._loads_of(number, pull)
                change = max(change, float(np.abs(now - self.row_loads[0, held]).max()))
                largest = max(largest, float(np.abs(now).max()))
                self.row_loads[:, held] = now
        return change / largest if largest > 0.0 else 0.0

    def collect_load(self, work: Workspace, load: NDArray[np.float64]) -> None:
        """The weight of the deformed bodies, ``-k q``, and what the weight does to the stiffness."""
        super().collect_load(work, load)
        own = self._modal_dofs()
        self._soften(load, work.sums.gravity)
        load[own] -= self.stiffness * self.modal_position
        for row, frame in zip(self.table, self.frame, strict=True):
            modes = slice(row.first_mode, row.first_mode + row.mode_count)
            inside = rotation_matrix(frame.orientation).T @ work.sums.gravity
            S = self.translation[:, modes]
            first_moment = frame.undeformed_first_moment + S @ self.modal_position[modes]
            load[row.dof + 3 : row.dof + 6] += np.cross(first_moment, inside)
            load[own[modes]] += inside @ S
            if (
                row.stiffening >= 0 and row.motion != FREE
            ):  # of what is free, weight and support are in balance
                n = row.mode_count
                start = row.stiffening + 4 * n * n
                G = self.constants[start : start + 3 * n * n].reshape(3, n, n)
                load[own[modes]] += np.tensordot(inside, G, axes=1) @ self.modal_position[modes]


# ---- where the data of one body lie, and the step ratio ----


@kernel(inline=True, internal=True)
def lag_scale(step: float, work: Workspace) -> float:
    """Square of this step relative to the last one, which the lag of a frame goes with; 1 in the first step."""
    last = work.control.last_step
    return (step / last) ** 2 if last > 0.0 else 1.0


@view
def shape_of(kind: FloatingFrameBodies, body: int) -> NDArray[np.float64]:
    """Packed shape of a body, without the stacked matrices, shape (12 n,)."""
    n = kind.table[body].mode_count
    start = kind.table[body].shape_start + 8 * n * n
    return kind.constants[start : start + 12 * n]


@view
def product_columns(kind: FloatingFrameBodies, body: int) -> NDArray[np.float64]:
    """Stacked product matrices of a body, column after column, shape (n 8 n,)."""
    n = kind.table[body].mode_count
    start = kind.table[body].shape_start
    return kind.constants[start : start + 8 * n * n]
