"""What pictures of frames and shells are made of: skins as one, exaggerations, scales of stress."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.pipeline.drawn.skins import Skin
from heavylift.pipeline.pictures.drawings import (
    BANDED,
    DIVERGING,
    colours,
    stress_bands,
    stress_limit,
    stress_unit,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.pictures.camera import Camera

__all__ = [
    "Exaggeration",
    "Scale",
    "Shot",
    "join",
    "stress_scale",
]


def join(skins: list[Skin]) -> Skin:
    """Several skins as one; the element is that of the skin with the largest stress."""
    starts = np.cumsum([0, *(len(skin.points) for skin in skins)])

    def indices(key: str) -> NDArray[np.int64]:
        return np.concatenate(
            [getattr(skin, key) + start for skin, start in zip(skins, starts, strict=False)]
        )

    first = max(skins, key=lambda skin: abs(skin.largest))
    return Skin(
        points=np.concatenate([skin.points for skin in skins]),
        normals=np.concatenate([skin.normals for skin in skins]),
        triangles=indices("triangles"),
        values=np.concatenate([skin.values for skin in skins]),
        largest=first.largest,
        where=first.where,
        outline=indices("outline"),
        edges=indices("edges"),
    )


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
