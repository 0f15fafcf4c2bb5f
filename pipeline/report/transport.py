"""Section of a report on transporters: when they tip over, and plans of their paths."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.pictures.path_plan import Stand, path_plan
from heavylift.pipeline.report.document import Figure, Section, Table
from heavylift.pipeline.results.model_io import read_header

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["transport_section"]

_STANDS = 12
"""Times at which a vehicle is drawn on its path."""


def transport_section(
    case: Case, stages: OutputFolder, results: Results | None, album: Album
) -> list[Section]:
    """Tipping angles of all transporters, and a plan of each path."""
    if results is None or not case.transporters or not len(results.time):
        return []
    items: list[Any] = []
    tipping = results.metadata.get("tipping", {})
    if tipping:
        rows = [
            (name, *(f"{math.degrees(angles[key]):.2f}" for key in ("static", "compliant")))
            for name, angles in tipping.items()
        ]
        header = ("tips over at [degrees]", "on rigid groups", "on compliant groups")
        items.append(Table(header, tuple(rows), frozenset({1, 2})))
    for transporter in case.transporters:
        if not transporter.legs:
            continue
        content = path_plan(*_stands(case, stages, transporter, results), title=f"path of {transporter.name}")
        caption = (
            f"Plan of {transporter.name}: way of the middle of its bogies, and its wheels as they are steered at times "
            "evenly apart."
        )
        items.append(Figure(album.add(f"path_{transporter.name}", content), caption))
    return [Section("Transporters", tuple(items))] if items else []


def _stands(
    case: Case, stages: OutputFolder, transporter: Any, results: Results
) -> tuple[NDArray[np.float64], list[Stand]]:
    """Way of the middle of the bogies in the plan [m], and the vehicle at some times."""
    from scipy.spatial.transform import Rotation

    body: Any = case.bodies[transporter.body]
    points = np.vstack([np.asarray(group.bogies, dtype=np.float64) for group in transporter.groups])
    if body.BODY.MODAL:
        points = points - np.array(json.loads(read_header(stages.reduced(transporter.body))["frame_origin"]))
    else:
        points = points - np.array(body.drawn_origin)
    position = results[f"{transporter.body}.position"]
    turn = Rotation.from_quat(results[f"{transporter.body}.orientation"][:, [1, 2, 3, 0]])
    way = (position + turn.apply(points.mean(axis=0)))[:, :2]
    steering = results[f"{transporter.name}.steering"].reshape(len(results.time), -1)
    stands = []
    for i in np.unique(np.linspace(0, len(results.time) - 1, _STANDS).round().astype(int)):
        wheels = (position[i] + turn[i].apply(points))[:, :2]
        ahead = turn[i].apply(np.asarray(transporter.direction, dtype=np.float64))
        stands.append(Stand(float(results.time[i]), wheels, math.atan2(ahead[1], ahead[0]) + steering[i]))
    return way, stands
