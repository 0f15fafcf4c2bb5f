"""All builders, in the order in which they write: what those of one table write, those of the next may hang on."""

from typing import Any

from heavylift.pipeline.equipment.equalizers import Equalizer
from heavylift.pipeline.equipment.falls import Falls
from heavylift.pipeline.equipment.floating_cranes import FloatingCrane
from heavylift.pipeline.equipment.gantry_cranes import GantryCrane
from heavylift.pipeline.equipment.link_beams import LinkBeam
from heavylift.pipeline.equipment.parts import EQUIPMENT
from heavylift.pipeline.equipment.spreaders import Spreader

__all__ = ["BUILDERS", "EQUIPMENT"]

BUILDERS: dict[str, Any] = {
    "gantry_cranes": GantryCrane,
    "floating_cranes": FloatingCrane,
    "falls": Falls,
    "equalizers": Equalizer,
    "spreaders": Spreader,
    "link_beams": LinkBeam,
}
"""By the list of a case file in which their tables stand."""
