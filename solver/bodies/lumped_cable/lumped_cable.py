"""A cable of lumped masses: what is given of one, and what it answers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import field
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, Positive, Quantity, Shape
from heavylift.solver.scene.bodies import BODIES, Free, Started
from heavylift.solver.scene.descriptions import XYZ
from heavylift.solver.scene.drawn import Element, NodalShape
from heavylift.solver.scene.outputs import Components, Outputs, Part, Parts, channel, outputs

__all__ = ["LumpedCable", "LumpedCableOutputs", "LumpedCableParts"]


@outputs
class LumpedCableParts(Parts):
    """Of the nodes and segments of a cable."""

    position: Part = channel("length", "position of every node in the world", None)
    velocity: Part = channel("velocity", "velocity of every node in world axes", None)
    segment_tension: Part = channel("force", "tension of every segment", None)


@outputs
class LumpedCableOutputs(Outputs):
    """Of a cable as a whole."""

    start_position: Components = channel("length", "position of its first node in the world", XYZ)
    end_position: Components = channel("length", "position of its last node in the world", XYZ)
    stretched_length: float = channel("length", "sum of the lengths of its segments")
    largest_tension: float = channel("force", "largest tension of a segment")


def _no_points() -> NDArray[np.float64]:
    return np.zeros((0, 3))


@BODIES.describe("lumped_cable")
@dataclass(frozen=True, eq=False, kw_only=True)
class LumpedCable(Started):
    """A cable or chain as masses on a line, with springs between them that pull alone, or push too."""

    KIND_MODULE: ClassVar[str] = "heavylift.solver.bodies.lumped_cable.packing"
    NOUN: ClassVar[str] = "cable of lumped masses"
    ITERATES: ClassVar[bool] = True
    HAS_AXES: ClassVar[bool] = False
    CHANNELS: ClassVar = (*LumpedCableParts.CHANNELS, *LumpedCableOutputs.CHANNELS)

    name: str
    points: Annotated[NDArray[np.float64], Quantity("length"), Shape((None, 3))] = field(
        default_factory=_no_points
    )
    """Corners of the line along which it lies at the start, in the frame of the body [m]."""
    segments: int
    """Number of springs, all of one length: there is one node more."""
    mass: Annotated[float, Positive("mass")]
    """Of all of it; each segment gives half of its own to each of its nodes."""
    axial_stiffness: Annotated[float, Positive("force")]
    """Force at a strain of 1, EA."""
    length: Annotated[float | None, Positive("length"), Absent()] = None
    """Unstretched, of all of it; that of the line if absent."""
    damping_time: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Damping force of a segment over its stiffness times its rate of elongation, while it carries."""
    carries: Literal["tension", "both"] = "tension"
    """``tension``: segments go slack; ``both``: they carry compression as well, as a bar."""

    @staticmethod
    def check(spec: Any) -> None:
        """There is a line, and a spring along it."""
        if spec.segments < 1:
            raise InputError(f"{spec.segments}", key="segments", expected="a whole number, 1 or more")
        corners = np.array(spec.points, dtype=np.float64).reshape(-1, 3)
        steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        if len(corners) < 2 or not np.all(steps > 0.0):
            raise InputError(
                f"{corners.tolist()}",
                key="points",
                expected="two corners of a line or more, each apart from the one before",
            )

    @property
    def motion(self) -> Free:
        """Always free: joints hold it."""
        return Free()

    @property
    def nodes(self) -> NDArray[np.float64]:
        """Nodes at equal distances along the line [m], in the frame of the body, shape (segments + 1, 3)."""
        corners = np.asarray(self.points, dtype=np.float64)
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
        places = np.linspace(0.0, along[-1], self.segments + 1)
        return np.column_stack([np.interp(places, along, corners[:, k]) for k in range(3)])

    @property
    def rest_length(self) -> float:
        """Of a segment [m]."""
        if self.length is not None:
            return self.length / self.segments
        corners = np.asarray(self.points, dtype=np.float64)
        return float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum()) / self.segments

    @property
    def node_masses(self) -> NDArray[np.float64]:
        """[kg], shape (segments + 1,)."""
        masses = np.full(self.segments + 1, self.mass / self.segments)
        masses[[0, -1]] *= 0.5
        return masses

    def velocity_count(self, points: int) -> int:  # noqa: ARG002  rows see all of them
        """Three a node."""
        return 3 * (self.segments + 1)

    def inverse_scales(self) -> tuple[float, float]:
        """Of the line as it is given."""
        nodes, masses = self.nodes, self.node_masses
        arms = nodes - masses @ nodes / self.mass
        return 1.0 / self.mass, 1.0 / float(masses @ (arms * arms).sum(axis=1))

    @property
    def components(self) -> dict[str, tuple[str, ...]]:
        """By node and axis, and by segment."""
        of_nodes = tuple(f"{node}.{axis}" for node in range(self.segments + 1) for axis in "xyz")
        of_segments = tuple(str(segment) for segment in range(self.segments))
        return {"position": of_nodes, "velocity": of_nodes, "segment_tension": of_segments}

    def drawn(self) -> Iterable[Element]:
        """A line through its nodes, coloured by its tension."""
        from heavylift.numerics.rotation import rotation_matrix

        yield NodalShape(
            name=self.name,
            role="rope",
            points=self.position + self.nodes @ rotation_matrix(self.orientation).T,
            positions=f"{self.name}.position",
            tension=f"{self.name}.segment_tension",
        )

    def refusal(self, integrator: str, *, jointed: bool) -> str:  # noqa: ARG002
        """Only the default integrator iterates a step."""
        return "" if integrator == "dele2" else f"the step of the cable {self.name!r} is iterated"
