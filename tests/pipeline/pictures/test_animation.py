"""Animations: every frame at its time, colours that keep their meaning, formats that the machine can write."""

import io
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from heavylift.pipeline.pictures import animation
from heavylift.pipeline.pictures.animation import choose_format, evenly, shown_seconds, write_animation


def png(colour, size=(64, 48)):
    from PIL import Image

    image = Image.new("RGB", size, "white")
    image.paste(colour, (10, 10, 30, 30))
    for k in range(12):  # a soft edge, as anti-aliasing leaves it
        image.paste((244 + k, 250, 255 - k), (40 + k, 5, 41 + k, 45))
    buffer = io.BytesIO()
    image.save(buffer, format="png")
    return buffer.getvalue()


def test_records_are_even_in_time_also_if_they_are_not_recorded_evenly():
    assert evenly(np.linspace(0.0, 1.0, 101), 11) == list(range(0, 101, 10))
    times = np.concatenate([np.linspace(0.0, 0.1, 1001), np.linspace(0.2, 1.0, 9)])
    chosen = times[evenly(times, 11)]
    np.testing.assert_allclose(chosen, np.linspace(0.0, 1.0, 11), atol=1e-12)
    assert evenly(np.array([3.0]), 5) == [0]
    assert evenly(np.array([0.0, 1.0, 5.0]), 100) == [0, 1, 2]


def test_long_and_short_runs_are_shown_in_bearable_time():
    assert shown_seconds(np.array([0.0, 1e-3]), None) == 4.0
    assert shown_seconds(np.array([0.0, 7.0]), None) == 7.0
    assert shown_seconds(np.array([0.0, 1e4]), None) == 15.0
    assert shown_seconds(np.array([0.0, 1e4]), 3.0) == 3.0


def test_gif_has_all_frames_their_time_and_their_colours(tmp_path):
    from PIL import Image

    colours = [(200, 20 * k, 255 - 20 * k) for k in range(6)]
    told = []
    path = tmp_path / "run.gif"
    write_animation(
        path,
        (png(colour) for colour in colours),
        count=6,
        seconds=1.5,
        progress=lambda done, _note: told.append(done),
    )
    assert told == list(range(1, 7))
    with Image.open(path) as image:
        assert image.n_frames == 6
        total = 0
        for k, colour in enumerate(colours):
            image.seek(k)
            total += image.info["duration"]
            frame = image.convert("RGB")
            assert frame.getpixel((0, 0)) == (255, 255, 255)
            np.testing.assert_allclose(frame.getpixel((20, 20)), colour, atol=16)
    assert total == 1500
    assert list(tmp_path.iterdir()) == [path]


def test_mp4_needs_its_encoder(monkeypatch):
    monkeypatch.setattr(animation, "find_spec", lambda _name: None)
    assert choose_format("mp4") == choose_format("auto") == "gif"
    monkeypatch.setattr(animation, "find_spec", lambda _name: object())
    assert choose_format("mp4") == choose_format("auto") == "mp4"
    assert choose_format("gif") == "gif"


def test_encoder_of_mp4_is_given_even_frames_at_the_right_rate(tmp_path, monkeypatch):
    given = {}

    def write_frames(path, size, **options):
        given.update(options, size=size, frames=[])
        while True:
            try:
                frame = yield
            except GeneratorExit:
                Path(path).write_bytes(b"film")
                return
            given["frames"].append(frame.shape)

    monkeypatch.setitem(sys.modules, animation.ENCODER, types.SimpleNamespace(write_frames=write_frames))
    path = tmp_path / "run.mp4"
    write_animation(path, [png("red", (65, 47))] * 6, count=6, seconds=3.0)
    assert given["size"] == (64, 46)
    assert given["frames"] == [(46, 64, 3)] * 6
    assert given["fps"] == pytest.approx(2.0)
    assert path.read_bytes() == b"film"
    assert list(tmp_path.iterdir()) == [path]
