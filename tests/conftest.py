"""Data that tests share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def mbsim_data() -> Path:
    """Folder with the public FE data of MBSim (`complex_beam`, `sliding_beam`); skips where it is missing."""
    default = Path(__file__).resolve().parents[2] / "shared" / "data" / "mbsim"
    folder = Path(os.environ.get("HEAVYLIFT_MBSIM_DATA", default))
    if not folder.is_dir():
        pytest.skip(f"no MBSim data at {folder}; set HEAVYLIFT_MBSIM_DATA")
    return folder
