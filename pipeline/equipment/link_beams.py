"""Link beams: bridges between two decks that wheels drive over, hinged on one, lying loose on the other.

A link of the length L is a rigid plate with a hinge across its one end. With the corners of its other end it lies on
the deck of the other side, where it slides with friction and may lift off: a line bearing, each end of it with a
spring and a damper. So several links beside each other, and the roll of both sides against each other, find their loads
by the stiffness of the bearings, and no row is redundant. A load f at the distance x from the hinge gives it
``f (1 - x/L)``: what crosses a link leaves its deck little by little.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyPoint, NameOf, Positive, Quantity
from heavylift.pipeline.equipment.parts import EQUIPMENT, Equipment, heading, listed

if TYPE_CHECKING:
    from heavylift.pipeline.equipment.parts import Made, Places

__all__ = ["LinkBeam"]

STEEPEST = math.radians(30.0)
"""Of a link at the start."""


@EQUIPMENT.describe("link_beams")
@dataclass(frozen=True, eq=False, kw_only=True)
class LinkBeam(Equipment):
    """A bridge for wheels, with a hinge on one deck and loose on another one."""

    ORDER: ClassVar = 6

    name: str
    hinged_on: Annotated[str, NameOf("body")]
    """Body that its hinge is on."""
    hinge: Annotated[NDArray[np.float64], BodyPoint()]
    """Middle of its hinge, level with the deck, in the coordinates of the geometry of that body [m]."""
    rests_on: Annotated[str, NameOf("side")]
    """Body that its other end lies on, or ``"ground"``."""
    edge: Annotated[NDArray[np.float64], BodyPoint(of="rests_on")]
    """Where the deck of that begins, before the middle of the link, in the coordinates of its geometry [m]; of the
    ground in the world. The deck is level there."""
    along: Annotated[tuple[float, float, float], Quantity("number")] = (1.0, 0.0, 0.0)
    """Horizontal direction from the hinge to the other end at the start, in the world; any length."""
    length: Annotated[float, Positive("length")]
    """From the hinge to the end [m]."""
    breadth: Annotated[float, Positive("length")]
    """Over which wheels can drive [m]; its bearings are at both corners of the end."""
    lip: Annotated[float, Positive("length")] = 0.02
    """Height of its upper side over the deck that it lies on, at its end [m]; more than the deflection of the
    bearings, or wheels are on that deck first."""
    depth: Annotated[float, Positive("length")] = 0.5
    """Of the plate, for its inertia [m]."""
    mass: Annotated[float, Positive("mass")]
    """[kg], spread evenly."""
    friction: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 0.2
    """Coefficient between its end and the deck."""
    stiffness: Annotated[float, Positive("stiffness")] = 1e8
    """Of each of the two bearings [N/m]."""
    damping: Annotated[float | None, Quantity("damping", minimum=0.0, closed=True)] = None
    """Of each of them [N s/m]; half of what is critical for the link alone if absent."""

    @staticmethod
    def check(spec: Any) -> None:
        """It points somewhere."""
        if not any(spec.along):
            raise InputError("a direction of length zero", key="along", expected="a horizontal direction")
        heading(spec.along, "along")

    @staticmethod
    def build(spec: Any, places: Places, made: Made) -> None:
        """Write the plate, its hinge, the bearings and the deck that wheels see."""
        name, L, b = spec.name, spec.length, spec.breadth
        along, _ = heading(spec.along, "along")
        hinge = places.world(spec.hinged_on, spec.hinge)
        edge = places.world(spec.rests_on, spec.edge)
        gap, rise = float((edge - hinge) @ along), float(edge[2] + spec.lip - hinge[2])
        if not abs(rise) <= math.sin(STEEPEST) * L:
            raise InputError(
                f"its end is to lie {rise:.6g} m over its hinge, it is {L:.6g} m long",
                key="edge",
                expected=f"a rise of at most {math.degrees(STEEPEST):.0f} deg",
            )
        reach = math.sqrt(L * L - rise * rise)
        if not 0.0 < gap < reach:
            raise InputError(
                f"a link beam of {L:.6g} m, which reaches {reach:.6g} m, over a gap of {gap:.6g} m"
                if gap > 0.0
                else f"the edge is {-gap:.6g} m behind the hinge",
                key="length" if gap > 0.0 else "along",
                expected=f"a link beam longer than {math.hypot(gap, rise):.6g} m"
                if gap > 0.0
                else "the direction from the hinge to the edge",
            )
        x = (reach * along + [0.0, 0.0, rise]) / L
        y = np.array([-along[1], along[0], 0.0])
        axis, angle = _turn(np.column_stack([x, y, np.cross(x, y)]))
        m = spec.mass
        inertia = [m * v / 12.0 for v in (b * b + spec.depth**2, L * L + spec.depth**2, L * L + b * b)]
        initial: dict[str, Any] = {"position": listed(hinge)}
        if angle:
            initial["orientation"] = {"axis": axis, "angle": angle}
        plate = {
            "type": "rigid",
            "mass": m,
            "inertia": inertia,
            "centre_of_mass": [0.5 * L, 0.0, 0.0],
            "frame": {"motion": "free"},
            "initial": initial,
        }
        made.body(f"{name}_plate", plate, key="mass")
        joint = {"name": f"{name}_hinge", "type": "hinge", "between": [spec.hinged_on, f"{name}_plate"]}
        made.add("joints", joint | {"at": listed(hinge), "axis": listed(y)}, "hinge")
        deck = {"name": f"{name}_deck", "body": f"{name}_plate", "sides": [-0.5 * b, 0.5 * b]}
        made.add("decks", deck | {"stations": [0.0, L], "heights": [0.0, 0.0]}, "breadth")
        origin, *ends = (places.local(spec.rests_on, edge + v) for v in (np.zeros(3), along, [0.0, 0.0, 1.0]))
        onto, up = (end - origin for end in ends)
        c = math.sqrt(spec.stiffness * m / 6.0) if spec.damping is None else spec.damping
        bearing = {
            "name": f"{name}_end",
            "type": "line_bearing",
            "between": [spec.rests_on, f"{name}_plate"],
            "points": [listed(spec.edge), [L, 0.0, -spec.lip]],
            "inward": listed(onto),
            "normal": listed(up),
            "length": b,
            "stiffness": spec.stiffness,
            "damping": c,
            "friction": spec.friction,
        }
        made.add("forces", bearing, "stiffness")


def _turn(R: NDArray[np.float64]) -> tuple[list[float], float]:
    """Axis and angle [rad] of a rotation."""
    w = 0.5 * math.sqrt(max(0.0, 1.0 + float(np.trace(R))))
    if w < 1e-6:  # half a turn
        twice = R + np.eye(3)
        axis = twice[:, int(np.argmax(np.diag(twice)))]
        return listed(axis / np.linalg.norm(axis)), math.pi
    axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / (4.0 * w)
    size = float(np.linalg.norm(axis))
    return (listed(axis / size), 2.0 * math.atan2(size, w)) if size > 1e-12 else ([0.0, 0.0, 1.0], 0.0)
