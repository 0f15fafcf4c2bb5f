"""Fixed steps of any size: what comes of them is right, or told."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parent))


@pytest.mark.slow
def test_steps_of_any_size_are_right_or_told():
    """A hundred and fifty scenes of nine kinds; the whole is `python tests/faults/soak.py steps`."""
    from soak_steps import KINDS, run

    counts = run(150, 11)
    assert counts["failures"] == 0
    assert sum(counts[word] for word in ("right", "right, warned", "wrong, warned", "stopped")) == 150
    for kind in KINDS:  # each can be right without a word
        assert counts.get(f"{kind.__name__}: right", 0) > 0 or kind.__name__ in {"swing", "links"}
