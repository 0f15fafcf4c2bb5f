"""What force elements need when a scene is packed: markers, rows, record columns, and where their kinds go.

A module that packs a kind has a function ``pack(things, context)``. It makes the kind of all things of the scene that
name this module, and says where it goes: `PackingContext.add_rows` if it has rows, `PackingContext.add_forces` if its
forces act on markers, both if it does both. Whether springs or ropes are rows or forces is for it to say, by
`PackingContext.integrator`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.system import ElementBlock
from heavylift.solver.interface import FORCES
from heavylift.solver.joints.packing import start_frames
from heavylift.solver.markers import MarkerBook
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.force_elements.watched import WatchedRopes
    from heavylift.solver.rows.structure import Attachment
    from heavylift.solver.scene.outputs import Columns
    from heavylift.solver.scene.scene import AnyBody, Scene

__all__ = ["PackingContext"]


@dataclass
class PackingContext:
    """What packers of force elements are given, and what they leave.

    Attributes
    ----------
    scene, integrator
        What is packed, and the name of the integrator that it is packed for.
    book
        Receives the markers.
    attachment, scales
        Where the rows on a body go; its inverse mass [1/kg] and smallest inverse inertia [1/(kg m2)], 0 if its motion
        is prescribed. Of the name of a body; the ground has no scales.
    watched
        Ropes whose pulls something watches.
    first_block
        Number of blocks of rows that joints take.
    columns
        Where the outputs of each thing are in a record, by its `id`.
    row_kinds, force_kinds, blocks, notes
        What has been left so far.
    """

    scene: Scene
    integrator: str
    book: MarkerBook
    attachment: Callable[[str], Attachment]
    scales: Callable[[str], tuple[float, float]]
    watched: WatchedRopes
    first_block: int
    columns: dict[int, Columns] = field(default_factory=dict)
    row_kinds: list[Any] = field(default_factory=list)
    force_kinds: list[Any] = field(default_factory=list)
    blocks: list[ElementBlock] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Bodies and joints are asked for by name."""
        self._bodies = {body.name: body for body in self.scene.bodies}
        self._joints = {joint.name: joint for joint in self.scene.joints}

    def point(self, body: str, point: NDArray[np.float64], level: int = FORCES) -> int:
        """Number of a new marker at a material point [m], in the frame of a body or in the world."""
        return self.book.point(body, point, level)

    def direction(
        self, body: str, direction: NDArray[np.float64], level: int = FORCES, *, at: NDArray[np.float64]
    ) -> int:
        """Number of a new marker of a unit direction at a material point [m], in the same frame."""
        return self.book.direction(body, direction, level, at=at)

    def column(self, thing: Any) -> Columns:
        """Where the outputs of a thing are in a record."""
        return self.columns[id(thing)]

    def body(self, name: str) -> AnyBody:
        """Body of the scene."""
        return self._bodies[name]

    def joint(self, name: str) -> Joint:
        """Joint of the scene."""
        return self._joints[name]

    def start_frames(self, joint: Joint) -> tuple[JointFrame, JointFrame]:
        """Points [m] and axes of both sides of a joint, in the world at the start; see `as_joint` for others."""
        return start_frames(joint, self.scene.bodies)

    @property
    def next_block(self) -> int:
        """Number that the next block of rows gets."""
        return self.first_block + sum(block.block_count for block in self.blocks)

    def block(
        self,
        name: str,
        bodies: Sequence[str],
        *,
        rows: int = 1,
        turns: bool = False,
        fitted: bool = True,
        compliance: float = 1.0,
        relaxation: float = 0.0,
    ) -> int:
        """Number of a new block of rows.

        Parameters
        ----------
        name
            Of the thing that it belongs to, for messages.
        bodies
            Whose velocities the rows see: side k of the block is that of the body k. The ground may be among them.
        rows
            How many.
        turns
            Whether they are angles, not lengths.
        fitted
            Whether the kind fits the rows to a law by iteration (`relinearise`).
        compliance, relaxation
            Of a linear spring with a damper: the inverse of its stiffness [m/N, rad/(N m)], damping over stiffness [s].
        """
        sides = tuple(self.attachment(body) for body in bodies)
        scale = sum(self.scales(body)[1 if turns else 0] for body in bodies if body != GROUND)
        return self.add_blocks(ElementBlock(name, sides, scale, compliance, relaxation, rows, fitted=fitted))

    def add_blocks(self, *blocks: ElementBlock) -> int:
        """Number of the first of some blocks of rows, which follow those that are there.

        Raises
        ------
        InputError
            If they are fitted to a law, and the integrator fits none.
        """
        if self.integrator != "dele2" and any(block.fitted for block in blocks):
            raise InputError(
                f"{self.integrator!r} with rows that are fitted to a law by iteration",
                source=blocks[0].name,
                key="integrator",
                expected="'dele2' for such a scene",
            )
        number = self.next_block
        self.blocks += blocks
        return number

    def add_rows(self, *kinds: Any) -> None:
        """Take kinds that write rows, or otherwise take part in a step as joints do."""
        self.row_kinds += kinds

    def add_forces(self, *kinds: Any) -> None:
        """Take kinds whose forces act on markers, or that only watch."""
        self.force_kinds += kinds

    def note(self, sentence: str) -> None:
        """Something that the user should know of the scene."""
        self.notes.append(sentence)

    @property
    def block_names(self) -> tuple[str, ...]:
        """Whom each block belongs to."""
        return tuple(block.name for block in self.blocks for _ in range(block.block_count))
