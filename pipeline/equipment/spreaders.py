"""Spreader beams: two slings from a hook to the ends of a beam, and lines from the beam down to lugs.

Slings at the angle th from the horizontal carry ``F = W/(2 sin th)`` each and press the beam together with F cos th,
which the load without a spreader would have to bear. Eyes of slings lie on the top of the beam, those of lines below
it, so that it hangs upright.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, BodyPoint, Least, NameOf, Positive, Quantity, Square
from heavylift.pipeline.equipment.equalizers import EqualizerHook, EqualizerRope
from heavylift.pipeline.equipment.parts import DOWN, EQUIPMENT, Equipment, heading

if TYPE_CHECKING:
    from heavylift.pipeline.equipment.parts import Made, Places

__all__ = ["Spreader"]

FLATTEST = math.radians(30.0)
"""Angle of slings from the horizontal below which they are refused: they carry as much as the load, and more."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class SpreaderBeam:
    """The beam."""

    mass: Annotated[float, Positive("mass")]
    """Mass [kg]."""
    length: Annotated[float, Positive("length")]
    """Between the eyes of both slings [m]."""
    depth: Annotated[float, Positive("length")] = 1.0
    """From the eyes of slings down to those of lines [m]."""
    inertia: Annotated[NDArray[np.float64] | None, Quantity("moment of inertia"), Square(3), Absent()] = None
    """About its centre, x along the beam and z up [kg m^2]; that of a square bar if absent."""


@EQUIPMENT.part
@dataclass(frozen=True, eq=False, kw_only=True)
class SpreaderLine:
    """A line from the beam to the load."""

    at: Annotated[float, Quantity("length")]
    """Its place along the beam, from the middle [m]."""
    body: Annotated[str, NameOf("body")]
    """The load."""
    point: Annotated[NDArray[np.float64], BodyPoint()]
    """Its lug [m], in the coordinates of the geometry of the load."""
    length: Annotated[float | None, Positive("length")] = None
    """Unstretched [m]; the initial geometric length if absent."""


@EQUIPMENT.describe("spreaders")
@dataclass(frozen=True, eq=False, kw_only=True)
class Spreader(Equipment):
    """A beam on two slings, with lines to a load."""

    ORDER: ClassVar = 5

    name: str
    hook: EqualizerHook
    """What both slings hang on."""
    along: Annotated[tuple[float, float, float], Quantity("number")] = (1.0, 0.0, 0.0)
    """Horizontal direction of the beam at the start, in the world; any length."""
    beam: SpreaderBeam
    """The beam."""
    sling_length: Annotated[float, Positive("length")]
    """Unstretched length of each sling [m]."""
    sling: EqualizerRope
    """What slings are made of."""
    line: EqualizerRope
    """What lines are made of."""
    lines: Annotated[tuple[SpreaderLine, ...], Least(2)]
    """Lines from the beam to the load."""

    @staticmethod
    def check(spec: Any) -> None:
        """Slings are long enough, and lines on the beam."""
        if not any(spec.along):
            raise InputError("a direction of length zero", key="along", expected="a horizontal direction")
        heading(spec.along, "along")
        least = 0.5 * spec.beam.length / math.cos(FLATTEST)
        if spec.sling_length < least:
            half = 0.5 * spec.beam.length / spec.sling_length
            angle = (
                f"{math.degrees(math.acos(half)):.4g} deg to the horizontal" if half < 1.0 else "too short"
            )
            raise InputError(
                f"slings of {spec.sling_length:.6g} m to a beam of {spec.beam.length:.6g} m: {angle}",
                key="sling_length",
                expected=f"at least {least:.6g} m, 30 deg",
            )
        for i, line in enumerate(spec.lines):
            if abs(line.at) > 0.5 * spec.beam.length:
                raise InputError(
                    f"{line.at:.6g} m from the middle of a beam of {spec.beam.length:.6g} m",
                    key=f"lines.{i}.at",
                    expected=f"at most {0.5 * spec.beam.length:.6g} m",
                )

    @staticmethod
    def build(spec: Any, places: Places, made: Made) -> None:
        """Write beam, slings and lines."""
        name, beam = spec.name, spec.beam
        along, angle = heading(spec.along, "along")
        half, depth = 0.5 * beam.length, beam.depth
        top = places.world(spec.hook.body, spec.hook.point) + math.sqrt(spec.sling_length**2 - half**2) * DOWN
        middle = top + 0.5 * depth * DOWN
        bar = [beam.mass * v / 12.0 for v in (2.0 * depth**2, *[beam.length**2 + depth**2] * 2)]
        made.rigid(f"{name}_beam", beam.mass, beam.inertia or bar, middle, angle, key="beam")
        hook = {"body": spec.hook.body, "point": list(spec.hook.point)}
        of_sling = {"axial_stiffness": spec.sling.axial_stiffness, "damping": spec.sling.damping}
        of_line = {"axial_stiffness": spec.line.axial_stiffness, "damping": spec.line.damping}
        for i, x in enumerate((-half, half)):
            eye = {"body": f"{name}_beam", "point": [x, 0.0, 0.5 * depth]}
            entry = {"name": f"{name}_sling_{i + 1}", **of_sling, "length": spec.sling_length}
            made.add("ropes", entry | {"path": [hook, eye]}, "sling")
        for i, line in enumerate(spec.lines):
            start = middle + line.at * along + 0.5 * depth * DOWN
            lug = places.world(line.body, line.point)
            if (lug - start) @ DOWN <= 0.0:
                raise InputError(
                    f"the lug is {-float((lug - start) @ DOWN):.6g} m above the beam",
                    key=f"lines.{i}.point",
                    expected="a lug below the beam",
                )
            eye = {"body": f"{name}_beam", "point": [line.at, 0.0, -0.5 * depth]}
            path = [eye, {"body": line.body, "point": list(line.point)}]
            entry = {"name": f"{name}_line_{i + 1}", **of_line, "path": path}
            made.add("ropes", entry | ({} if line.length is None else {"length": line.length}), f"lines.{i}")
