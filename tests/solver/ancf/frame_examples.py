"""Frames to try the elements on: straight, pre-stressed, curved in a plane and in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from frame_oracle import OracleElement, Section

from heavylift.solver.scene.meshes import FrameBody, FrameSection

SECTION = FrameSection(density=7800.0, youngs_modulus=2e5, area=0.01, second_moment=3e-4, outer_fibre=0.05)
EA, EI, MASS = 2e3, 60.0, 78.0


def line(lengths: list[float], direction: list[float] = [1.0, 0.0, 0.0], **other: object) -> FrameBody:  # noqa: B006
    """Elements of given lengths along a line."""
    axis = np.asarray(direction) / np.linalg.norm(direction)
    places = np.concatenate(([0.0], np.cumsum(lengths)))
    return through(places[:, None] * axis, np.tile(axis, (len(places), 1)), **other)


def arc(angle: float, radius: float, count: int, rise: float = 0.0, **other: object) -> FrameBody:
    """A circle or helix, by its nodes and tangents."""
    a = np.linspace(0.0, angle, count + 1)
    nodes = np.column_stack((radius * np.sin(a), radius * (1.0 - np.cos(a)), rise * a))
    tangents = np.column_stack((radius * np.cos(a), radius * np.sin(a), np.full(count + 1, rise)))
    return through(nodes, tangents / np.hypot(radius, rise), model="exact", **other)


def through(nodes: np.ndarray, tangents: np.ndarray, **other: object) -> FrameBody:
    """Elements between nodes that follow each other."""
    ends = np.arange(len(nodes) - 1)
    return FrameBody(
        name="frame",
        nodes=nodes,
        tangents=tangents,
        elements=np.column_stack((ends, ends + 1)),
        sections=(SECTION,),
        **other,  # type: ignore[arg-type]
    )


@dataclass
class Example:
    body: FrameBody
    curved: bool

    def oracle(self) -> list[OracleElement]:
        """The elements, written again."""
        body = self.body
        vectors = np.stack((body.nodes, body.tangents), axis=1)
        strains = body.axial_strains if len(body.axial_strains) else np.zeros(len(body.elements))
        return [
            OracleElement(
                vectors[nodes].reshape(4, 3),
                Section(EA, EI, MASS),
                body.model == "exact",
                self.curved,
                strain,
            )
            for nodes, strain in zip(body.elements, strains, strict=True)
        ]


EXAMPLES = {
    "green-lagrange": Example(line([0.7, 1.2], [2.0, 1.0, -0.5]), curved=False),
    "pre-stressed": Example(line([0.7, 1.2], axial_strains=np.array([0.01, -0.02])), curved=False),
    "exact": Example(line([0.7, 1.2], [0.3, 1.0, -0.5], model="exact"), curved=False),
    "exact pre-stressed": Example(
        line([0.7, 1.2], model="exact", axial_strains=np.array([0.01, -0.02])), curved=False
    ),
    "arc": Example(arc(1.4, 1.3, 2), curved=True),
    "helix": Example(arc(1.4, 1.3, 2, rise=0.6, axial_strains=np.array([0.01, -0.02])), curved=True),
}
