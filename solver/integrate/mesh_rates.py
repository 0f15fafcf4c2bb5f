"""How fast a frame or a shell vibrates at most, from lengths and material alone: before anything is packed.

The highest frequency of a mesh is below that of its stiffest element with free ends (B. M. Irons and G. Treharne, "A
bound theorem in eigenvalues and its practical applications", 1971). Of a cubic element of length l with wave speed c
it is ``c k1/l`` in stretching and ``sqrt(E I / (rho A)) k2/l^2`` in bending; of a rectangle of two such directions
squares of the first and values of the second add up.
"""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np

from heavylift.solver.scene.meshes import FrameBody, MeshBody, ShellBody

__all__ = ["highest_rate"]


@functools.cache
def _element_numbers() -> tuple[float, float]:
    """``k1`` and ``k2``: highest frequencies of a cubic of unit length and mass, in stretching and in bending."""
    x, weights = np.polynomial.legendre.leggauss(4)
    x, weights = 0.5 * (x + 1.0), 0.5 * weights
    shape = np.array([1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2])
    slope = np.array([6 * x**2 - 6 * x, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x])
    bend = np.array([12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2])
    mass, stretching, bending = ((values * weights) @ values.T for values in (shape, slope, bend))
    found = (np.linalg.eigvals(np.linalg.solve(mass, matrix)).real.max() for matrix in (stretching, bending))
    first, second = (math.sqrt(value) for value in found)
    return first, second


def highest_rate(body: MeshBody) -> float:
    """Bound of the highest rate [1/s]: circular frequency, or rate of what damping takes away fastest.

    Parameters
    ----------
    body
        Frame or shell, as it is placed and not stressed.
    """
    frequency = 0.0
    of_element: Any = body.element_sections if isinstance(body, FrameBody | ShellBody) else ()
    k1, k2 = _element_numbers()
    if isinstance(body, FrameBody):
        chords = body.nodes[body.elements[:, 1]] - body.nodes[body.elements[:, 0]]
        lengths = np.linalg.norm(chords, axis=1)
        for number, length in enumerate(lengths):
            section = body.sections[of_element[number] if len(of_element) else 0]
            modulus = section.youngs_modulus / section.density
            stretching = math.sqrt(modulus) * k1 / length
            bending = math.sqrt(modulus * section.second_moment / section.area) * k2 / length**2
            frequency = max(frequency, stretching, bending)
    elif isinstance(body, ShellBody):
        for number, (a, b) in enumerate(np.asarray(body.lengths, dtype=np.float64)):
            plate = body.sections[of_element[number] if len(of_element) else 0]
            modulus = plate.youngs_modulus / (plate.density * (1.0 - plate.poissons_ratio**2))
            stretching = math.sqrt(modulus) * k1 * math.hypot(1.0 / a, 1.0 / b)
            bending = math.sqrt(modulus / 12.0) * plate.thickness * k2 * (1.0 / a**2 + 1.0 / b**2)
            frequency = max(frequency, stretching, bending)
    return max(frequency, body.viscous_damping + body.stiffness_damping * frequency**2)
