"""All builders, in the order in which they write: what those of one table write, those of the next may hang on."""

from heavylift.pipeline.equipment.equalizers import Equalizer
from heavylift.pipeline.equipment.parts import EQUIPMENT

__all__ = ["BUILDERS", "EQUIPMENT"]

BUILDERS = {described.WORD: described for described in (Equalizer,)}  # type: ignore[attr-defined]
"""By the list of a case file in which their tables stand."""
