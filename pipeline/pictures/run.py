"""What pictures of frames and shells are made of: their motion, the scale of their colours, what is exaggerated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.pipeline.pictures.drawings import (
    BANDED,
    DIVERGING,
    colours,
    stress_bands,
    stress_limit,
    stress_unit,
)
from heavylift.pipeline.pictures.meshes import rest_coordinates

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from heavylift.pipeline.pictures.camera import Camera
    from heavylift.solver.scene.meshes import FrameBody, ShellBody

__all__ = ["Exaggeration", "MeshRun", "Scale", "Shot", "stress_scale"]


@dataclass(frozen=True, eq=False)
class MeshRun:
    """A frame or shell and its motion.

    Attributes
    ----------
    body
        Unloaded shape, sections, and the pose of its frame, which stands still.
    coordinates
        Vectors of the nodes in world axes at a record, shape (n, 2 or 4, 3).
    lengths
        Of the unloaded elements of a frame [m], shape (e,); found if None.
    """

    body: FrameBody | ShellBody
    coordinates: Callable[[int], NDArray[np.float64]]
    lengths: NDArray[np.float64] | None = None

    @property
    def rest(self) -> NDArray[np.float64]:
        """Vectors of the nodes of the unloaded shape in world axes, shape (n, 2 or 4, 3)."""
        from heavylift.numerics.rotation import rotation_matrix

        moved = rest_coordinates(self.body) @ rotation_matrix(self.body.orientation).T
        moved[:, 0] += self.body.position
        return moved


class Exaggeration(NamedTuple):
    """What is drawn larger than it is: displacements, and radii of tubes by the name of the frame."""

    displacement: float
    radius: dict[str, float]

    @property
    def words(self) -> str:
        """For the picture; empty if all is as it is."""
        parts = [f"displacement × {self.displacement:g}"] if self.displacement != 1.0 else []
        factors = sorted({factor for factor in self.radius.values() if factor != 1.0})
        for factor in factors:
            names = [name for name, own in self.radius.items() if own == factor]
            who = "" if len(names) == len(self.radius) else f" of {', '.join(names)}"
            parts.append(f"radius{who} × {factor:g}")
        return f"drawn with {' and '.join(parts)}" if parts else ""


class Shot(NamedTuple):
    """Camera, and the middle of what it shows, where lengths are measured [m]."""

    camera: Camera
    middle: NDArray[np.float64]


class Scale(NamedTuple):
    """Colours of stress: end of the scale, number of bands, whether it begins at minus its end; pascals in its unit."""

    limit: float
    bands: int
    signed: bool
    divisor: float
    unit: str

    @property
    def colours(self) -> tuple[str, ...]:
        """One a band."""
        return colours(DIVERGING if self.signed else BANDED, self.bands)

    @property
    def limits(self) -> tuple[float, float]:
        """Ends in the unit of the scale."""
        return (-self.limit if self.signed else 0.0), self.limit


def stress_scale(stress: NDArray[np.float64], peak: float, *, signed: bool) -> Scale:
    """Scale of round bands that suits stresses [Pa], shape (m,), and their largest amount, by which the unit is chosen.

    A few values far above the rest, as beside a point support, lie beyond its end.
    """
    amounts = np.abs(stress)
    divisor, unit = stress_unit(max(peak, float(amounts.max(initial=0.0))))
    largest = stress_limit(amounts / divisor)
    if not signed:
        return Scale(*stress_bands(largest), signed=False, divisor=divisor, unit=unit)
    limit, bands = stress_bands(largest, most=6)  # on each side of zero
    return Scale(limit, 2 * bands, signed=True, divisor=divisor, unit=unit)
