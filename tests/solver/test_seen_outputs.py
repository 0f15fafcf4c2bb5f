"""Extremes of all that a measure sees: channels follow from one class, and records have its fields."""

from __future__ import annotations

import numpy as np

from heavylift.solver.recording import width_of
from heavylift.solver.sensors.relative_motions import MotionOutputs, MotionSeen, motion_outputs
from heavylift.solver.sensors.seen import extremes_of


def test_extremes_have_the_channels_of_what_is_seen_in_its_order() -> None:
    seen = [channel.name for channel in MotionSeen.CHANNELS]
    names = [channel.name for channel in MotionOutputs.CHANNELS]
    assert names == seen + [f"{name}_max" for name in seen] + [f"{name}_min" for name in seen]
    for one, high in zip(MotionSeen.CHANNELS, MotionOutputs.CHANNELS[len(seen) :], strict=False):
        assert (one.quantity, one.unit, one.components) == (high.quantity, high.unit, high.components)
        assert high.sentence.startswith(f"largest value of `{one.name}` since the last record")


def test_their_record_has_the_same_fields() -> None:
    width = width_of(MotionSeen)
    assert width == sum(len(channel.columns()) for channel in MotionSeen.CHANNELS)
    assert len(extremes_of(MotionSeen, 3)) == 3 * width
    row = np.zeros(2 + 3 * width)
    out = motion_outputs(row, 2)
    out.seen.radius, out.largest.radius, out.smallest.position[1] = 1.0, 2.0, 3.0
    assert row[1 + width] == 1.0
    assert row[1 + 2 * width] == 2.0
    assert row[2 + 2 * width + 1] == 3.0
