"""Bodies with modes of a scene become arrays: inertia shapes, markers, drives; what is refused of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.modal.invariants import ShapeIntegrals
from heavylift.modal.stiffening import PRODUCTS, Stiffening
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records
from heavylift.numerics.small import aligned
from heavylift.solver.bodies.floating_frame.kind import FlexibleIndex, FloatingFrame, FloatingFrameBodies
from heavylift.solver.bodies.floating_frame.stiffening_loads import find_loads, refuse_other_places
from heavylift.solver.bodies.frames.base import SLENDER
from heavylift.solver.body_places import BodyPlaces
from heavylift.solver.drive import DRIVEN, FIXED, FREE, pack_drive
from heavylift.solver.markers import BodyMarkers, PackedMarker, pack_markers
from heavylift.solver.recording import placed
from heavylift.solver.scene.bodies import Driven, Fixed, FlexibleBody, Free, HeldOutputs, ModalOutputs
from heavylift.solver.scene.outputs import Columns

__all__ = ["frame_inertia", "pack", "pack_floating_frames", "pack_shape"]


SMALLEST_FRAME_SHARE = 0.1
"""Of the inertia of a free body that its modes must not carry with them."""


def pack_shape(integrals: ShapeIntegrals, stiffening: Stiffening | None = None) -> NDArray[np.float64]:
    """Flatten shape integrals, corrected by the shortening of what bends, into the block the kernels read.

    The stacked matrices (8 n n), then S (3 n), Ibar antisymmetric (3 n), Ibar symmetric (6 n).

    Notes
    -----
    The stacked matrices are stored by columns, ``T[j, r]`` being the factor of ``q_j`` in product r:
    a sum of long scaled rows runs at vector speed for any number of modes. (Reading only one half of
    each matrix was slower: arithmetic limits here, not memory.)
    """
    S = integrals.mode_mode
    if stiffening is not None:
        S = S.copy()
        for (k, l), E in zip(PRODUCTS, stiffening.second_moments, strict=True):
            S[k, l] -= E
            if k != l:
                S[l, k] -= E
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


def pack(bodies: Sequence[FlexibleBody], places: BodyPlaces) -> FloatingFrameBodies:
    """Make the kind of some bodies of a scene, see `pack_floating_frames`."""
    return pack_floating_frames(
        bodies, places.number, places.dofs[0], places.columns, places.markers, places.sensors
    )


def pack_floating_frames(
    bodies: Sequence[FlexibleBody],
    first_number: int,
    first_dof: int,
    columns: Sequence[Columns],
    markers: Sequence[BodyMarkers],
    sensors: Sequence[BodyMarkers],
) -> FloatingFrameBodies:
    """Make the kind from the scene; start velocities of driven frames are set by the integrator.

    Parameters
    ----------
    bodies
        In the order of their rows.
    first_number, first_dof
        Number of the first body in the scene, and place of its velocities.
    columns
        Where each is in a record.
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
    load_counts = [0 if s is None else len(s.labels) for s in (body.reduced.stiffening for body in bodies)]
    kind = _empty(len(bodies), total, sum(load_counts))
    constants: list[NDArray[np.float64]] = []  # shapes first: their blocks keep the alignment
    shape_starts: dict[int, int] = {}
    for body in bodies:
        if id(body.reduced) not in shape_starts:
            shape_starts[id(body.reduced)] = sum(map(len, constants))
            constants.append(pack_shape(body.reduced.integrals, body.reduced.stiffening))
    stiffening_starts: dict[int, int] = {}
    for body in bodies:
        stiffening = body.reduced.stiffening
        if stiffening is not None and id(stiffening) not in stiffening_starts:
            stiffening_starts[id(stiffening)] = sum(map(len, constants))
            constants.append(_pack_stiffening(stiffening))
    dof = first_dof
    for row, (body, place) in enumerate(zip(bodies, columns, strict=True)):
        reduced = body.reduced
        if isinstance(body.motion, Free) and not reduced.mean_axis:
            _check_free_modes(body.name, reduced.integrals)
        modes = slice(modal_starts[row], modal_starts[row + 1])
        entry = kind.table[row]
        entry.dof, entry.number = dof, first_number + row
        entry.motion = {Free: FREE, Fixed: FIXED, Driven: DRIVEN}[type(body.motion)]
        entry.drive = sum(map(len, constants))
        entry.column, entry.held = place, place.at(HeldOutputs)
        entry.parts = placed(ModalOutputs, place)
        entry.mode_count, entry.first_mode = counts[row], modal_starts[row]
        entry.shape_start = shape_starts[id(reduced)]
        entry.stiffening = stiffening_starts.get(id(reduced.stiffening), -1)
        entry.load_count, entry.first_load = load_counts[row], sum(load_counts[:row])
        if load_counts[row]:
            entry.load_start = sum(map(len, constants))
            constants.append(find_loads(body).ravel())
        if reduced.stiffening is not None:
            refuse_other_places(body, markers[row])
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
        moments, axes = _central_inertia(integrals)
        frame.slender = moments[0] < SLENDER * moments[1]
        frame.axis[:] = axes[:, 0]
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
    shapes_of = [_point_shapes(body) for body in bodies]
    marker_index = pack_markers(markers, shapes_of, constants, [_direction_turns(body) for body in bodies])
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


def _empty(bodies: int, modes: int, loads: int) -> FloatingFrameBodies:
    """All zeros, for some bodies that have some modes and loads together; no constants and markers."""
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
        shortened=aligned(modes),
        unforced=aligned(6 * bodies + modes if loads else 0),
        row_loads=aligned((2, loads)),
        markers=records(PackedMarker, 0),
        sensors=records(PackedMarker, 0),
        driven=False,
        moves=False,
    )


def _pack_stiffening(stiffening: Stiffening) -> NDArray[np.float64]:
    """The trace of what second moments lose, matrices of accelerations and of loads, seven and more (n, n); norms.

    Norms are that of a unit spin about any axis, and of the matrices from the second one on.
    """
    matrices = [stiffening.trace, *stiffening.angular, *stiffening.linear, *stiffening.loads]
    norms = [stiffening.largest_of_spin, *(float(np.linalg.norm(matrix, 2)) for matrix in matrices[1:])]
    block = np.concatenate([*(matrix.ravel() for matrix in matrices), norms])
    return np.concatenate([block, np.zeros(-len(block) % 8)])


def _central_inertia(integrals: ShapeIntegrals) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Principal moments about the centre of mass, the smallest first, and their axes as columns."""
    c = integrals.first_moment / integrals.mass
    second = integrals.inertia_kl - integrals.mass * np.outer(c, c)
    moments, axes = np.linalg.eigh(np.trace(second) * np.eye(3) - second)
    return moments, axes


def frame_inertia(integrals: ShapeIntegrals) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mass matrix of the frame, (6, 6), and its coupling ``[S; I_tf]`` with the modes, (6, nf); undeformed."""
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
    return M, C


def _check_free_modes(name: str, integrals: ShapeIntegrals) -> None:
    """Refuse modes that leave a free frame next to no inertia of its own.

    Notes
    -----
    With ``C = [S; I_tf]`` the share is the smallest eigenvalue of ``M_rr - C C^T`` relative to ``M_rr``,
    which depends neither on units nor on the place of the frame: 1 for mean-axis modes. Tumbling bodies
    of point masses stayed in balance above 0.2 and blew up below 0.05, at every step tried.
    """
    M, C = frame_inertia(integrals)
    shared = np.linalg.solve(np.linalg.cholesky(M), C)
    share = 1.0 - float(np.linalg.norm(shared, 2)) ** 2 if C.size else 1.0
    if share < SMALLEST_FRAME_SHARE:
        raise InputError(
            f"its modes move it almost rigidly: {share:.2g} of its inertia is left to the free frame",
            source=name,
            key="reduced",
            expected=f"{SMALLEST_FRAME_SHARE} or more: reduce it with mean-axis modes, or hold its frame",
        )


def _point_shapes(body: FlexibleBody) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Return a function from a body-frame point to (undeformed position, 3 nf mode shape entries)."""

    def shapes(point: NDArray[np.float64]) -> NDArray[np.float64]:
        place, displacement = body.reduced.point_at(point, source=body.name)
        return np.concatenate([place, displacement.T.ravel()])

    return shapes


def _direction_turns(
    body: FlexibleBody,
) -> Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]:
    """Return a function from a direction at a body-frame point to it and 3 nf entries of the rotation of the place.

    The direction alone, if modes do not turn it there.
    """
    reduced = body.reduced
    known: dict[bytes, NDArray[np.float64] | None] = {}

    def turns(direction: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
        key = point.tobytes()
        if key not in known:
            known[key] = reduced.motion_at(point, source=body.name).rotation
        rotation = known[key]
        if rotation is None or not reduced.turns(rotation, direction):
            return np.asarray(direction, dtype=np.float64)
        return np.concatenate([direction, rotation.T.ravel()])

    return turns
