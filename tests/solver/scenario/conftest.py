"""Puts the scenes of ropes, and those of bodies with modes, on the path."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path += [
    str(Path(__file__).resolve().parents[1] / "force_elements"),
    str(Path(__file__).resolve().parents[1]),
]
