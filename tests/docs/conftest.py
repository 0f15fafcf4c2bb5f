"""Puts the reference models of this folder on the path; tests of other folders do the same."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent))
