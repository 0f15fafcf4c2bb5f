"""Descriptions of collision: surfaces of triangles on bodies, and which pairs of them may touch; SI units.

A *surface* is any set of triangles, open or closed, wound either way. A *collision* lets two surfaces touch anywhere:
its contacts come and go with the motion, by the same laws as those of contours.
"""

from __future__ import annotations

import math
from dataclasses import field
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from annotated_types import Interval

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Absent, Positive, Quantity
from heavylift.solver.scene.bodies import GROUND
from heavylift.solver.scene.contacts import COLLISION_LAWS, ContactLaw, RigidLaw
from heavylift.solver.scene.descriptions import XYZ
from heavylift.solver.scene.drawn import Drawn, Element, Solid
from heavylift.solver.scene.outlines import surface_triangles
from heavylift.solver.scene.outputs import Components, Outputs, channel, largest, outputs, smallest

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy as np
    from numpy.typing import NDArray

    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = [
    "Collision",
    "CollisionOutputs",
    "CollisionPlace",
    "CollisionSurface",
    "RecordedContactOutputs",
]


@dataclass(frozen=True, eq=False, kw_only=True)
class CollisionSurface:
    """Triangles that move with a body.

    Attributes
    ----------
    name, body
        Its own name and that of its body, `GROUND` for one that stands still in the world.
    surface
        Triangles in the frame of the body, excluded ones left out; of a frame or shell None: its own surface. That of
        a shell is its middle surface, rounded by half of its (largest) thickness; that of a frame its axis, round,
        with the area of its (largest) cross-section, which rounds its ends too. Of a body with modes its undeformed
        triangles, from `heavylift.contours.triangles.body_surface.body_surface`.
    facets
        Of a frame or shell: facets along each side of an element.
    nodes
        Of a body with modes: its node at each point of the triangles, shape (n,).

    Notes
    -----
    Surfaces that deform are found by nearness: contacts begin while features are still apart, at four motions of a
    step. What moves on by more than half of its thickness from one step to the next, beyond that, can be missed.
    """

    name: str
    body: str
    surface: TriangleSurface | None
    facets: int = 2
    nodes: NDArray[np.int64] | None = None

    def drawn(self) -> Iterable[Element]:
        """Its triangles; the surface of a frame, a shell or a body with modes is drawn by that."""
        if self.surface is not None and self.nodes is None:
            points, triangles, _ = surface_triangles(self.surface)
            role: Drawn = "ground" if self.body == GROUND else "body"
            yield Solid(name=self.name, role=role, body=self.body, points=points, triangles=triangles)


@dataclass(frozen=True, eq=False, kw_only=True)
class CollisionPlace:
    """Which surfaces may touch, and by what law.

    Attributes
    ----------
    name
        Prefix of its channels.
    surfaces
        Names of both surfaces.
    law
        Force or impulse across each contact; a stiffness is that of a patch, which its contacts share.
    """

    name: str
    surfaces: tuple[str, str]
    law: ContactLaw = field(default_factory=RigidLaw)


@outputs
class CollisionOutputs(Outputs):
    """Of two surfaces that may touch."""

    gap: float = channel(
        "length",
        "smallest distance of the surfaces, negative inside; no number out of reach unless somebody asks for it",
    )
    contacts: float = channel("number", "number of contacts")
    patches: float = channel("number", "number of patches of contacts")
    force: Components = channel("force", "force on the second surface, world axes", XYZ)
    normal_force: float = channel("force", "sum of the forces of all contacts along their normals")
    largest_force: float = channel("force", "largest sum of the normal forces of a patch of contacts")
    impulse: float = channel(
        "momentum", "sum of the impulses along the normals since the start, impacts included", unit="N s"
    )
    point: Components = channel("length", "centre of the forces, in the world", XYZ)
    slip: float = channel("velocity", "largest speed at which a contact slides")
    dissipated: float = channel(
        "moment or energy",
        "energy lost to impacts, damping and friction since the start, part of energy.dissipated",
        unit="J",
    )
    impacts: float = channel("number", "number of impacts since the start")
    impact_impulse: float = channel(
        "momentum",
        "sum of the impulses of impacts along the normals since the start; what bears a weight is not in it",
        unit="N s",
    )
    normal_force_max: float = largest("force", "normal_force")
    normal_force_min: float = smallest("force", "normal_force")
    gap_min: float = smallest("length", "gap", seen="at the ends of all steps in which it was known")


@outputs
class RecordedContactOutputs(Outputs):
    """Of a contact of a collision."""

    point: Components = channel("length", "point of the contact, in the world", XYZ)
    normal: Components = channel(
        "number", "unit normal from the first surface to the second, world axes", XYZ
    )
    gap: float = channel("length", "distance of the surfaces at the contact; negative inside")
    force: float = channel("force", "force of the contact along its normal")
    friction: float = channel("force", "force of the contact across its normal, its amount")
    impulse: float = channel("momentum", "impulse of the last step along the normal", unit="N s")
    patch: float = channel("number", "number of the patch of the contact; -1 where none is recorded")


@COLLISION_LAWS.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Collision(CollisionPlace):
    """Two surfaces that may touch."""

    CHANNELS: ClassVar = CollisionOutputs.CHANNELS
    """What it records, in the order of its columns."""
    CONTACT_CHANNELS: ClassVar = RecordedContactOutputs.CHANNELS
    """What it records of each of its `recorded` contacts, behind its own channels: ``NAME.contact_1.point``, ..."""

    friction: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 0.0
    """Coulomb's coefficient; 0 without."""
    method: Literal["swept", "position-difference"] = "swept"
    """``swept``: certified tests of the paths within a step; ``position-difference``: as in "Integrated simulation of
    ships and offshore structures (2018)", section 2.6, which misses collisions; for comparison."""
    patch_angle: Annotated[float, Quantity("angle", minimum=0.0, maximum=math.pi)] = math.radians(18.0)
    """Contacts belong to one patch if their normals differ by less [rad]."""
    patch_size: Annotated[float, Positive("length"), Absent()] = 0.0
    """And lie within this distance [m]; a tenth of the smaller surface, at least 1.5 times its mean edge, if absent."""
    most_contacts: Annotated[int, Interval(ge=1, le=100_000)] = 512
    """At once, of a pair; if there are more, the simulation stops. All pairs together have as many for each surface.
    With a frame or shell 64 at most."""
    recorded: Annotated[int, Interval(ge=0, le=1000)] = 8
    """Contacts recorded one by one, those with the largest forces."""
    clearance: bool = False
    """Record the distance of the surfaces in `gap`, and its smallest value over all steps in `gap_min`, while they are
    far apart too; it costs a search for each record, and for each step in which they may have come nearer. So
    it is if a phase waits for it, or criteria, checks, references or the report name it. Otherwise both are not a
    number beyond the reach of the search, a few times the motion in a step."""
