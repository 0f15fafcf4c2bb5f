"""What every builder has: how it is described, where bodies are, and the tables that it writes.

A builder is the description of one table of a case file (`heavylift.solver.scene.descriptions`), a dataclass that
derives from `Equipment`, with a function ``build(spec, places, made)``. `spec` is its table with numbers in SI; what
`build` adds to `made` are entries of other tables of the case file as a user would write them, in SI. They are checked,
assembled and recorded as any other; errors in one are reported at the key of the builder from which it follows.
"""

from __future__ import annotations

import math
from dataclasses import field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.descriptions import Family

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "DOWN",
    "EQUIPMENT",
    "Equipment",
    "Made",
    "Part",
    "Places",
    "given",
    "heading",
    "listed",
    "upright",
]

EQUIPMENT: Family[Any] = Family("table", "heavylift.pipeline.equipment", typed=False)
"""Builders, by the list of a case file in which their tables stand."""

DOWN = np.array([0.0, 0.0, -1.0])
"""Where loads hang."""

LEVEL = 1e-9
"""Slope of a direction that counts as horizontal."""


class Equipment:
    """Base of all builders."""

    CHANNELS: ClassVar = ()
    """None of its own: what it writes has channels."""
    ORDER: ClassVar[float] = math.inf
    """Place among the tables of a case file and in which they are written; those without one follow by the alphabet."""
    OWN_NAME: ClassVar[bool] = True
    """Whether no other thing of a case has its name; if not, that is the name of something that it writes."""

    def __init_subclass__(cls) -> None:
        """Refuse a builder that builds nothing.

        Raises
        ------
        TypeError
            If it has no function ``build``.
        """
        if not hasattr(cls, "build"):
            raise TypeError(
                f"{cls.__module__}.{cls.__qualname__}: a piece of equipment has a function 'build'"
            )


class Places(Protocol):
    """Where the bodies of a case are at the start."""

    def world(self, body: str, point: ArrayLike) -> NDArray[np.float64]:
        """Place in the world [m] of a point of a body in the coordinates of its geometry; of the ground the point."""

    def local(self, body: str, point: ArrayLike) -> NDArray[np.float64]:
        """Point of a body in the coordinates of its geometry [m] at a place in the world."""

    def centre_of_mass(self, body: str) -> NDArray[np.float64] | None:
        """Centre of mass of a rigid body in the world [m]; None of what is computed later."""

    def has_steps(self) -> bool:
        """Whether the case is simulated with the integrator of which measures follow the steps."""

    def hangs_alone(self, body: str) -> bool:
        """Whether nothing is on a body beside what builders make."""


class Part(NamedTuple):
    """An entry that a builder wrote: table, name, content, and the key of the builder from which it follows."""

    table: str
    name: str
    entry: dict[str, Any]
    key: str


@dataclass
class Made:
    """What one builder wrote."""

    parts: list[Part] = field(default_factory=list)

    def rigid(
        self,
        name: str,
        mass: float,
        inertia: Any,
        position: NDArray[np.float64],
        angle: float = 0.0,
        *,
        key: str,
        **more: Any,
    ) -> None:
        """A free rigid body at a place [m], turned about the vertical [rad]."""
        entry = {
            "type": "rigid",
            "mass": mass,
            "inertia": [list(row) if isinstance(row, tuple) else row for row in inertia],
            "frame": {"motion": "free"},
            "initial": upright(position, angle),
            **more,
        }
        self.body(name, entry, key=key)

    def body(self, name: str, entry: dict[str, Any], key: str) -> None:
        """A body."""
        self.parts.append(Part("bodies", name, entry, key))

    def add(self, table: str, entry: dict[str, Any], key: str) -> None:
        """An entry of a list of tables."""
        self.parts.append(Part(table, entry["name"], entry, key))


def given(part: Any) -> dict[str, Any]:
    """A table of a builder as it is given on."""
    return {name: getattr(part, name) for name in type(part).model_fields if name in part.model_fields_set}


def listed(point: ArrayLike) -> list[float]:
    """A vector as a case file has it."""
    return [float(value) for value in np.asarray(point, dtype=np.float64)]


def upright(position: ArrayLike, angle: float) -> dict[str, Any]:
    """Start of a body at a place [m], turned about the vertical [rad]."""
    initial: dict[str, Any] = {"position": listed(position)}
    if angle:
        initial["orientation"] = {"axis": [0.0, 0.0, 1.0], "angle": angle}
    return initial


def heading(direction: ArrayLike, key: str) -> tuple[NDArray[np.float64], float]:
    """Unit vector and angle about the vertical [rad] of a horizontal direction.

    Raises
    ------
    InputError
        If it is not horizontal.
    """
    along: NDArray[np.float64] = np.asarray(direction, dtype=np.float64)
    along = along / np.abs(along).max()  # whose square may be no number
    along = along / np.linalg.norm(along)
    if abs(along[2]) > LEVEL:
        raise InputError(
            f"{listed(direction)} is not horizontal", key=key, expected="a direction without z component"
        )
    return along, float(np.arctan2(along[1], along[0]))
