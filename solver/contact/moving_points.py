"""How many contacts there may be at once on surfaces that deform: each takes a moving point of its body."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from heavylift.solver.scene.collisions import Collision
    from heavylift.solver.scene.contacts import Contour
    from heavylift.solver.scene.scene import Scene

__all__ = ["MOST_ON_MESHES", "count_moving", "count_slots", "most_of", "moving_points"]

MOST_ON_MESHES = 64
"""Contacts at once of a collision with a frame or shell: each is a vector over all nodes in every step."""


def _mesh_sides(collision: Collision, scene: Scene) -> list[str]:
    """Frames and shells that take part."""
    meshes = {body.name for body in scene.bodies if body.SEEN_AT_POINTS}
    owners = {one.name: one.body for one in scene.surfaces}
    return [owners[name] for name in collision.surfaces if owners.get(name) in meshes]


def most_of(collision: Collision, scene: Scene) -> int:
    """Contacts of a collision at once."""
    most = collision.most_contacts
    return max(1, min(most, MOST_ON_MESHES)) if _mesh_sides(collision, scene) else most


def count_slots(scene: Scene) -> dict[str, int]:
    """Moving points for contacts between triangles, by the names of frames and shells."""
    counts: dict[str, int] = {}
    for collision in scene.collisions:
        for name in _mesh_sides(collision, scene):
            counts[name] = counts.get(name, 0) + most_of(collision, scene)
    return counts


def moving_points(contour: Contour) -> int:
    """Moving points that each contact on a contour of a frame or shell takes.

    A point beside a curve, on a band or a cylinder, moves with the tangent as well, which is the second one.
    """
    return 2 if contour.radius > 0.0 or contour.width > 0.0 else 1


def count_moving(scene: Scene) -> dict[str, int]:
    """Contacts on each frame and shell: each touches a point of its own that moves, those of contours first."""
    on = {contour.name: contour for contour in scene.contours}
    meshes = {body.name for body in scene.bodies if body.SEEN_AT_POINTS}
    counts: dict[str, int] = {}
    for contact in scene.contacts:
        contour = on.get(contact.contour)
        if contour is not None and contour.body in meshes:
            counts[contour.body] = counts.get(contour.body, 0) + moving_points(contour)
    if scene.collisions:
        for name, count in count_slots(scene).items():
            counts[name] = counts.get(name, 0) + count
    return counts
