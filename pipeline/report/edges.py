"""Section of a report on what joints along edges carry: of all nodes of an edge the largest, and the whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.case.channel_kinds import lies_along_edge
from heavylift.pipeline.report.document import Section, Table, short_table
from heavylift.pipeline.results.words import number_words, numbers_words

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.histories import Results

__all__ = ["edge_sections"]


def edge_sections(case: Case, results: Results | None) -> list[Section]:
    """Reactions along the edges of a case, one row a joint; nothing without such joints or records."""
    joints = [joint for joint in case.joints if lies_along_edge(joint.type)]
    if results is None or not len(results.time) or not joints:
        return []
    rows = []
    for joint in joints:
        forces = _histories(results, joint.name, "reaction_force")
        moments = _histories(results, joint.name, "reaction_moment")
        if not len(forces):
            continue
        total = forces.sum(axis=0)
        record = int(np.argmax(np.linalg.norm(total, axis=1)))
        rows.append(
            (
                joint.name,
                str(len(forces)),
                _largest(results, forces, "N"),
                _largest(results, moments, "N m"),
                numbers_words(total[record].tolist(), "N") + _when(results, record),
            )
        )
    if not rows:
        return []
    columns = (
        "joint",
        "nodes",
        "largest force at a node",
        "largest moment at a node",
        "largest force of all nodes",
    )
    table: Table = short_table(columns, rows)
    return [Section("Reactions along edges", (table,))]


def _histories(results: Results, joint: str, kind: str) -> NDArray[np.float64]:
    """Reactions of all nodes, shape (nodes, records, 3)."""
    found: list[NDArray[np.float64]] = []
    while f"{joint}.{len(found)}.{kind}" in results:
        found.append(results[f"{joint}.{len(found)}.{kind}"].reshape(len(results.time), 3))
    return np.array(found).reshape(len(found), len(results.time), 3)


def _largest(results: Results, histories: NDArray[np.float64], unit: str) -> str:
    """Largest length of a vector, with its node and time."""
    sizes = np.linalg.norm(histories, axis=2)
    node, record = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
    return f"{number_words(float(sizes[node, record]), unit)} (node {node}){_when(results, int(record))}"


def _when(results: Results, record: int) -> str:
    """Time of a record, if there are several."""
    return f", {number_words(float(results.time[record]), 's')}" if len(results.time) > 1 else ""
