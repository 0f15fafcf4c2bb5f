"""Points that criteria look at, and whether a run records where they are."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from collections.abc import Sequence
from typing import Any

from heavylift.pipeline.case.fields import GROUND, BodyPlace, Section, SideName, reject
from heavylift.pipeline.case.rope_parts import has_lines

__all__ = ["PlaceSection", "check_axes", "check_path", "check_place", "sensor_at"]

_SAME = 1e-9
"""Distance of points that are one, relative to their size."""


class PlaceSection(Section):
    """A point of a body, or of the ground."""

    body: SideName
    """A body, or ``"ground"``. Flexible bodies, frames and shells need a sensor at the point."""
    point: BodyPlace
    """[m] in the coordinates of the geometry of the body; of the ground in the world."""


def sensor_at(case: Any, body: str, point: Sequence[float]) -> str | None:
    """Name of the sensor at a point of a body; None if there is none."""
    return next(
        (
            sensor.name
            for sensor in case.sensors
            if sensor.body == body and math.dist(sensor.point, point) <= _SAME * (1.0 + math.hypot(*point))
        ),
        None,
    )


def check_place(case: Any, body: str, point: Sequence[float], key: str) -> None:
    """A place moves with a rigid body, or a sensor records where it is."""
    if body == GROUND or not case.bodies[body].BODY.DEFORMS or sensor_at(case, body, point):
        return
    at = ", ".join(f"{x:g}" for x in point)
    reject(f"where the point ({at}) of {body!r} is, is not recorded", "a sensor at this point", key=key)


def check_axes(case: Any, body: str, key: str) -> None:
    """A body with a frame has axes, one of nodes has none."""
    if body != GROUND and not case.bodies[body].has_frame:
        noun = case.bodies[body].BODY.NOUN
        reject(f"{body!r} is a {noun}, which has no axes", "a body with a frame", key=key)


def check_path(case: Any, name: str, key: str) -> None:
    """What is a rope with a path, whose places and pulleys can be found at all times."""
    rope = next((one for one in case.ropes if one.name == name), None)
    if rope is None:
        reject(f"{name!r} has no path", "a rope of [[ropes]]", key=key)
    for number, stop in enumerate(rope.path):
        check_place(case, stop.body, stop.point, key)
        if stop.radius > 0.0 or (has_lines(rope) and number == 0):
            check_axes(case, stop.body, key)
