"""What the kernels of rods find in `constants`: strains that are sums of products of nodal vectors.

With the eight vectors v of an element, ``r_1 r'_1 d_1 e_1 r_2 r'_2 d_2 e_2``, each of its strains is::

    s = sum_t (U_t v).(W_t v) - s_0

with one or two terms t. Strains are quadratic in the coordinates and know nothing of rotations.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, record_at
from heavylift.solver.bodies.ancf.frame_data import BENDING

__all__ = [
    "AXIAL_STRAINS",
    "BENDING_STRAINS",
    "ROD_FRAME",
    "ROD_LENGTH",
    "ROD_STRAINS",
    "STRAINS",
    "STRAIN_LENGTH",
    "TERMS",
    "TWIST",
    "VECTORS",
    "RodData",
    "RodStrain",
    "rod_data",
    "rod_strain",
    "strain_at",
]

VECTORS = 8
"""Of an element."""
TERMS = 2

AXIAL_STRAINS, BENDING_STRAINS, SECTION_STRAINS = 5, 6, 10
"""At Gauss points; curvatures along both directors at three; stretch and shear of the sections at both nodes."""
TWIST = AXIAL_STRAINS + BENDING_STRAINS
"""Number of the strain of torsion."""
ROD_STRAINS = TWIST + 1 + SECTION_STRAINS


class RodStrain(Record):
    """A strain of an element.

    Attributes
    ----------
    stiffness
        Of the energy ``1/2 stiffness s^2``.
    rest
        ``s_0``.
    height
        Length by which it is compared with a strain.
    left, right
        ``U`` and ``W``; the terms that it has not are zero.
    products
        ``U_ta W_tb + W_ta U_tb`` summed over the terms, the matrix of its geometric stiffness.
    """

    stiffness: float
    rest: float
    height: float
    left: Annotated[NDArray[np.float64], (TERMS, VECTORS)]
    right: Annotated[NDArray[np.float64], (TERMS, VECTORS)]
    products: Annotated[NDArray[np.float64], (VECTORS, VECTORS)]


class RodData(Record):
    """Matrices that all elements begin with; strains follow, then the data of a frame, for results.

    Attributes
    ----------
    mass, bending
        Scalar matrices of the eight nodal vectors; there is no constant bending matrix.
    torque
        Moment about the axis of a unit strain of torsion.
    """

    mass: Annotated[NDArray[np.float64], (VECTORS, VECTORS)]
    bending: Annotated[NDArray[np.float64], (VECTORS, VECTORS)]
    torque: float


WORD = 8
STRAIN_LENGTH = RodStrain.layout.itemsize // WORD
STRAINS = RodData.layout.itemsize // WORD
"""Place of the strains in the data of an element."""
ROD_FRAME = STRAINS + ROD_STRAINS * STRAIN_LENGTH
"""Place of the data of a frame."""
ROD_LENGTH = ROD_FRAME + BENDING

rod_data, strain_at = record_at(RodData), record_at(RodStrain)


@kernel(inline=True, internal=True)
def rod_strain(constants: NDArray[np.float64], data: int, number: int) -> RodStrain:
    """A strain of the element whose data begin at a place."""
    return strain_at(constants, data + STRAINS + number * STRAIN_LENGTH)
