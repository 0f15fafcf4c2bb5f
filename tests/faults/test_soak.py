"""The program of faults by the hundred finds its parts, and each says what it does."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

PROGRAM = Path(__file__).with_name("soak.py")


def test_every_part_can_be_asked_for():
    names = [path.stem.removeprefix("soak_") for path in PROGRAM.parent.glob("soak_*.py")]
    done = subprocess.run(
        [sys.executable, str(PROGRAM), "--help"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for name in names:
        assert f"\n    {name} " in done.stdout
