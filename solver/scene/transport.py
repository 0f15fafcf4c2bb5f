"""Where roads and the vehicles on them are described, and the parts that both are made of, in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, BodyPoint, Least, Positive, Quantity, Shape
from heavylift.solver.scene.descriptions import Family, check_table

__all__ = ["TRANSPORT", "BogieGroup", "Bump", "OilPump"]

TRANSPORT: Family[Any] = Family("table", "heavylift.solver.transport", typed=False)
"""Decks and transporters, by the lists of a case file in which they stand."""

CHORDS = 512
"""Of a bump."""


@TRANSPORT.part
@dataclass(frozen=True)
class Bump:
    """A bump across a deck."""

    start: Annotated[float, Quantity("length")]
    """Station at which it begins [m]."""
    length: Annotated[float, Positive("length")]
    """L, along the deck [m]."""
    height: Annotated[float, Quantity("length")]
    """h, of its middle [m]; negative of a dip."""
    shape: Literal["cosine", "smooth"] = "cosine"
    """``h sin^2(pi x / L)``, whose curvature begins at once and makes what passes ring; or ``h sin^4(pi x / L)``, whose
    curvature begins gently."""

    def profile(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Stations and heights [m], near enough that chords are off by 2e-5 of the height at most."""
        share = np.linspace(0.0, 1.0, CHORDS + 1)
        height = np.sin(np.pi * share) ** (2 if self.shape == "cosine" else 4)
        return self.start + self.length * share, self.height * height


@TRANSPORT.part
@dataclass(frozen=True, eq=False)
class OilPump:
    """Oil that is pumped into a group, as the way by which it lifts all bogies of the group."""

    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,)), Least(1)]
    """[s], increasing."""
    lifts: Annotated[NDArray[np.float64], Quantity("length"), Shape((None,))]
    """[m], linear between the times, held before the first and after the last."""

    @staticmethod
    def check(said: Any) -> None:
        """A lift a time."""
        check_table("times", said.times, "lifts", said.lifts)


@TRANSPORT.part
@dataclass(frozen=True, eq=False)
class BogieGroup:
    """Bogies whose cylinders share their oil: one pressure."""

    name: str
    bogies: Annotated[NDArray[np.float64], BodyPoint(), Shape((None, 3)), Least(1)]
    """Where the wheels of each bogie touch the road at the start, in the coordinates of the geometry of the body that
    rides on them [m]."""
    oil_stiffness: Annotated[float, Positive("stiffness"), Absent()] = 0.0
    """Of oil and hoses [N/m]: force of a bogie by its stroke if all bogies of the group move together."""
    gas_length: Annotated[float, Positive("length"), Absent()] = 0.0
    """In place of `oil_stiffness`, a gas accumulator: its gas volume at the start, over the area of a cylinder and the
    number of bogies [m]."""
    load: Annotated[float, Quantity("force", minimum=0.0, closed=True), Absent()] = np.nan
    """Force of a bogie at the start [N]; without it the groups carry the weight of the body, all bogies as evenly as
    the balance allows."""
    pump: OilPump | None = None
    """How its oil changes."""

    @staticmethod
    def check(said: Any) -> None:
        """Oil, or gas."""
        if (said.oil_stiffness is None) == (said.gas_length is None):
            problem = "neither 'oil_stiffness' nor 'gas_length'" if said.gas_length is None else "both"
            raise InputError(problem, key="oil_stiffness", expected="one of 'oil_stiffness' and 'gas_length'")
