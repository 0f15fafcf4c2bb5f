"""Which bodies of a case joints hold together with a hull."""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.solver.scene.connectivity import connected_bodies, shared_bodies

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case

__all__ = ["connected_to_hull", "shared_with_hulls"]


def connected_to_hull(case: Case, name: str) -> tuple[frozenset[str], frozenset[str]]:
    """Those of `connected_bodies` of a hull of a case, which other hulls do not belong to."""
    return connected_bodies(name, _free(case), [joint.between for joint in case.joints], case.hulls)


def shared_with_hulls(case: Case, name: str) -> dict[str, tuple[str, ...]]:
    """Those of `shared_bodies` of a hull of a case."""
    return shared_bodies(name, _free(case), [joint.between for joint in case.joints], case.hulls)


def _free(case: Case) -> set[str]:
    return {body for body, section in case.bodies.items() if section.is_free}
