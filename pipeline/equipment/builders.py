"""All builders, in the order in which they write: every module of this package may describe some."""

from typing import Any

from heavylift.pipeline import equipment
from heavylift.pipeline.equipment.parts import EQUIPMENT
from heavylift.solver.scene.descriptions import import_all

__all__ = ["BUILDERS", "EQUIPMENT"]


def _find() -> dict[str, Any]:
    """Builders by their words."""
    import_all(equipment)
    return {word: EQUIPMENT.get(word) for word in EQUIPMENT.words}


BUILDERS = _find()
"""By the list of a case file in which their tables stand."""
