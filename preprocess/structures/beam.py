"""The straight Timoshenko beam of two nodes, with offsets, a shear centre and released ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.material import Material
    from heavylift.preprocess.structures.sections import BeamSection
    from heavylift.preprocess.structures.structure import Beams

__all__ = ["ALONG", "BeamOperators", "beam_operators", "beam_shapes", "principal_angle", "skew"]

ALONG = 1e-3
"""Sine of the angle between a beam and its orientation below which its planes are not known."""


class BeamOperators(NamedTuple):
    """Axes of many beams of one section and their stiffness.

    Attributes
    ----------
    axes
        Rows are the axis of the beam, the one in plane 1, and the third, shape (ne, 3, 3).
    length
        Between the centroids at the ends [m], shape (ne,).
    ends
        Centroids at the ends [m], shape (ne, 2, 3), in the axes of the structure.
    ends_from_nodes
        Displacements and rotations of the sections at both ends along the axes of the beam, from those of the nodes
        along the axes of the structure, shape (ne, 12, 12); with released freedoms they are those that follow.
    local
        Stiffness along the axes of the beam before anything is released, shape (ne, 12, 12).
    stiffness
        Of the nodes, shape (ne, 12, 12) [N/m, N, N m].
    """

    axes: NDArray[np.float64]
    length: NDArray[np.float64]
    ends: NDArray[np.float64]
    ends_from_nodes: NDArray[np.float64]
    local: NDArray[np.float64]
    stiffness: NDArray[np.float64]


def skew(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrices S with ``S b = a x b`` of vectors a (..., 3), shape (..., 3, 3)."""
    S = np.zeros((*vectors.shape, 3))
    S[..., 0, 1], S[..., 0, 2], S[..., 1, 2] = -vectors[..., 2], vectors[..., 1], -vectors[..., 0]
    return S - np.swapaxes(S, -1, -2)


def principal_angle(section: BeamSection) -> float:
    """From axis 2 of a section to the principal axis next to it, towards axis 3 [rad]."""
    if section.product == 0.0:
        return 0.0
    difference = section.second_moment_1 - section.second_moment_2
    if difference == 0.0:
        return float(np.copysign(0.25 * np.pi, section.product))
    return 0.5 * float(np.arctan(2.0 * section.product / difference))


def beam_operators(
    nodes: NDArray[np.float64], beams: Beams, *, source: object = "structure"
) -> BeamOperators:
    """Axes and stiffness of beams.

    Parameters
    ----------
    nodes
        Positions [m], shape (n, 3).
    beams
        Of one section.
    source
        Named in messages.

    Raises
    ------
    InputError
        A beam without length, an orientation along it, releases that leave a mechanism.

    Notes
    -----
    Axis 1 runs from centroid to centroid after offsets, axis 3 is square to it and to the orientation, axis 2 completes
    them: plane 1 of axes 1 and 2 contains the orientation. The stiffness follows from the exact static shape functions
    (J. S. Przemieniecki, *Theory of Matrix Structural Analysis*, 1968, section 5.6) with
    ``phi = 12 E I / (G A_s L^2)``, in the principal axes of the section. Bending and normal force act at the
    centroid, shear and torsion at the shear centre: displacements there are ``v - z_s theta_x``, ``w + y_s theta_x``.
    """
    ne = len(beams.elements)
    ends = nodes[beams.elements].copy()
    offsets = np.stack(
        [np.broadcast_to(beams.offset_a, (ne, 3)), np.broadcast_to(beams.offset_b, (ne, 3))], axis=1
    )
    ends += offsets
    e1 = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(e1, axis=1)
    _refuse(beams, length <= 0.0, "has no length", "two ends at different places", ends, source)
    e1 /= length[:, None]
    v = np.broadcast_to(beams.orientation, (ne, 3))
    e3 = np.cross(e1, v)
    sine = np.linalg.norm(e3, axis=1)
    along = ~(sine > ALONG * np.linalg.norm(v, axis=1))
    _refuse(
        beams,
        along,
        "has an orientation along its axis",
        "a vector in its plane 1, which its web or first second moment lies in, at an angle to the beam",
        ends,
        source,
    )
    e3 /= sine[:, None]
    axes = np.stack([e1, np.cross(e3, e1), e3], axis=1)

    local = _local_stiffness(beams.material, beams.section, length)
    # displacements of the sections along the axes of the structure: u + theta x o
    to_ends = np.zeros((ne, 12, 12))
    for end in range(2):
        first = 6 * end
        to_ends[:, first : first + 3, first : first + 3] = axes
        to_ends[:, first + 3 : first + 6, first + 3 : first + 6] = axes
        to_ends[:, first : first + 3, first + 3 : first + 6] = -np.matmul(axes, skew(offsets[:, end]))
    released = np.broadcast_to(beams.released, (ne, 12))
    if released.any():
        to_ends = np.matmul(_released(beams, local, released, ends, source), to_ends)
    stiffness = np.matmul(to_ends.transpose(0, 2, 1), np.matmul(local, to_ends))
    return BeamOperators(axes, length, ends, to_ends, local, 0.5 * (stiffness + stiffness.transpose(0, 2, 1)))


def beam_shapes(
    material: Material, section: BeamSection, length: NDArray[np.float64], at: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Displacements and rotations of the section along a beam from those of its ends.

    Parameters
    ----------
    material, section
        Of the beams.
    length
        [m], shape (ne,).
    at
        Places along the beam, 0 to 1, shape (m,).

    Returns
    -------
    NDArray
        Shape (ne, m, 6, 12): displacement of the centroid, rotations; along the axes of the beam. Exact for loads at
        the ends alone.
    """
    ne, m = len(length), len(at)
    turn = _principal_turn(section)
    shapes = np.zeros((ne, m, 6, 12))
    shapes[:, :, 0, 0] = shapes[:, :, 3, 3] = 1.0 - at
    shapes[:, :, 0, 6] = shapes[:, :, 3, 9] = at
    I1, I2, A1, A2 = _principal_constants(section)
    for I, A, deflection, rotation, sign in ((I1, A1, 1, 5, 1.0), (I2, A2, 2, 4, -1.0)):
        phi = _shear_ratio(material, I, A, length)[:, None]
        L, s = length[:, None], at[None]
        scale = 1.0 / (1.0 + phi)
        columns = (deflection, rotation, deflection + 6, rotation + 6)
        w = (
            scale * (1.0 - 3.0 * s**2 + 2.0 * s**3 + phi * (1.0 - s)),
            scale * L * (s - 2.0 * s**2 + s**3 + 0.5 * phi * (s - s**2)),
            scale * (3.0 * s**2 - 2.0 * s**3 + phi * s),
            scale * L * (-(s**2) + s**3 - 0.5 * phi * (s - s**2)),
        )
        theta = (
            scale * 6.0 / L * (s**2 - s),
            scale * (1.0 - 4.0 * s + 3.0 * s**2 + phi * (1.0 - s)),
            scale * 6.0 / L * (s - s**2),
            scale * (3.0 * s**2 - 2.0 * s + phi * s),
        )
        for column, value, slope, odd in zip(columns, w, theta, (False, True, False, True), strict=True):
            shapes[:, :, deflection, column] = sign * value if odd else value
            shapes[:, :, rotation, column] = slope if odd else sign * slope
    # the deflections above are those of the shear centre
    to_shear_centre, back = _shear_centre(section), _shear_centre(section, back=True)
    shapes = np.matmul(np.matmul(back[:6, :6], shapes), to_shear_centre)
    return np.matmul(np.matmul(turn[:6, :6].T, shapes), turn)


def _local_stiffness(
    material: Material, section: BeamSection, length: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Stiffness of the sections at the ends along axes 1, 2, 3, shape (ne, 12, 12)."""
    E, G, L = material.young_modulus, material.shear_modulus, length
    K = np.zeros((len(length), 12, 12))
    for stiffness, at in ((E * section.area / L, 0), (G * section.torsion / L, 3)):
        K[:, at, at] = K[:, at + 6, at + 6] = stiffness
        K[:, at, at + 6] = K[:, at + 6, at] = -stiffness
    I1, I2, A1, A2 = _principal_constants(section)
    for I, A, deflection, rotation, sign in ((I1, A1, 1, 5, 1.0), (I2, A2, 2, 4, -1.0)):
        phi = _shear_ratio(material, I, A, L)
        index = np.array([deflection, rotation, deflection + 6, rotation + 6])
        one = np.ones_like(L)
        block = np.array(
            [
                [12.0 * one, sign * 6.0 * L, -12.0 * one, sign * 6.0 * L],
                [sign * 6.0 * L, (4.0 + phi) * L**2, -sign * 6.0 * L, (2.0 - phi) * L**2],
                [-12.0 * one, -sign * 6.0 * L, 12.0 * one, -sign * 6.0 * L],
                [sign * 6.0 * L, (2.0 - phi) * L**2, -sign * 6.0 * L, (4.0 + phi) * L**2],
            ]
        )
        K[:, index[:, None], index] = (E * I / (L**3 * (1.0 + phi)) * block).transpose(2, 0, 1)
    turned = np.matmul(_shear_centre(section), _principal_turn(section))
    return np.matmul(turned.T, np.matmul(K, turned))


def _principal_constants(section: BeamSection) -> tuple[float, float, float, float]:
    """Second moments and shear areas in the principal planes: I_1, I_2, A_1, A_2."""
    angle = principal_angle(section)
    c, s = float(np.cos(angle)), float(np.sin(angle))
    I1, I2, I12 = section.second_moment_1, section.second_moment_2, section.product
    flexible = 1.0 / section.shear_area_1, 1.0 / section.shear_area_2
    F1 = c * c * flexible[0] + s * s * flexible[1]
    F2 = s * s * flexible[0] + c * c * flexible[1]
    return (
        c * c * I1 + s * s * I2 + 2.0 * c * s * I12,
        s * s * I1 + c * c * I2 - 2.0 * c * s * I12,
        1.0 / F1 if F1 else np.inf,
        1.0 / F2 if F2 else np.inf,
    )


def _shear_ratio(
    material: Material, I: float, shear_area: float, length: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Phi = 12 E I / (G A_s L^2), shape (ne,)."""
    stiff = material.shear_modulus * shear_area * length**2
    return np.asarray(12.0 * material.young_modulus * I / stiff, dtype=np.float64)


def _principal_turn(section: BeamSection) -> NDArray[np.float64]:
    """Displacements and rotations at both ends along the principal axes from those along axes 2 and 3, (12, 12)."""
    angle = principal_angle(section)
    turn = np.eye(3)
    turn[1:, 1:] = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    return np.asarray(np.kron(np.eye(4), turn), dtype=np.float64)


def _shear_centre(section: BeamSection, *, back: bool = False) -> NDArray[np.float64]:
    """Deflections of the shear centre from those of the centroid, principal axes, or the other way, (12, 12)."""
    angle = principal_angle(section)
    c, s = np.cos(angle), np.sin(angle)
    y, z = section.shear_centre
    sign = -1.0 if back else 1.0
    shift = np.eye(12)
    for first in (0, 6):
        shift[first + 1, first + 3] = -sign * (-s * y + c * z)
        shift[first + 2, first + 3] = sign * (c * y + s * z)
    return shift


def _released(
    beams: Beams,
    local: NDArray[np.float64],
    released: NDArray[np.bool_],
    ends: NDArray[np.float64],
    source: object,
) -> NDArray[np.float64]:
    """Freedoms of the end sections from those that the nodes hold, shape (ne, 12, 12)."""
    follow = np.zeros_like(local)
    patterns, which = np.unique(released, axis=0, return_inverse=True)
    for pattern, free in enumerate(patterns):
        rows = np.flatnonzero(which.ravel() == pattern)
        held = ~free
        follow[np.ix_(rows, np.flatnonzero(held), np.flatnonzero(held))] = np.eye(int(held.sum()))
        if not free.any():
            continue
        K = local[np.ix_(rows, np.flatnonzero(free), np.flatnonzero(free))]
        size = np.sqrt(np.einsum("eii->ei", local[rows])[:, free])
        scaled = K / (size[:, :, None] * size[:, None, :])
        loose = np.zeros(len(released), dtype=bool)
        loose[rows] = np.linalg.eigvalsh(scaled)[:, 0] < 1e-9
        _refuse(
            beams,
            loose,
            "moves freely with what it releases at its ends",
            "releases that leave no mechanism (an axis that is released at one end only)",
            ends,
            source,
        )
        across = local[np.ix_(rows, np.flatnonzero(free), np.flatnonzero(held))]
        follow[np.ix_(rows, np.flatnonzero(free), np.flatnonzero(held))] = -np.linalg.solve(K, across)
    return follow


def _refuse(
    beams: Beams,
    wrong: NDArray[np.bool_],
    problem: str,
    expected: str,
    ends: NDArray[np.float64],
    source: object,
) -> None:
    """Refuse the first of some beams, with its place."""
    found = np.flatnonzero(wrong)
    if found.size:
        i = int(found[0])
        number = int(beams.numbers[i]) if beams.numbers.size else i + 1
        x, y, z = ends[i].mean(axis=0)
        raise InputError(
            problem + (f" ({found.size} such beams)" if found.size > 1 else ""),
            source=source,
            key=f"beam {number} of {beams.name} at ({x:.6g}, {y:.6g}, {z:.6g}) m",
            expected=expected,
        )
