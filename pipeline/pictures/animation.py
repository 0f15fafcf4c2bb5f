"""Moving pictures: frames with one palette as GIF, or MP4 where an encoder is installed."""

from __future__ import annotations

import io
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from heavylift.pipeline.results.storage import replacing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from numpy.typing import NDArray
    from PIL.Image import Image

__all__ = ["ENCODER", "choose_format", "evenly", "shown_seconds", "write_animation"]

ENCODER = "imageio_ffmpeg"
"""Package that brings an encoder for MP4."""
_SAMPLES = 6  # frames that the palette is made from
_WHITE = 244  # of 255: brighter colours become white
_FASTEST = 50.0  # frames a second that viewers of GIF show
_SHORTEST, _LONGEST = 4.0, 15.0


def choose_format(wanted: Literal["auto", "gif", "mp4"]) -> Literal["gif", "mp4"]:
    """MP4 if it can be written here, unless GIF is wanted."""
    return "mp4" if wanted != "gif" and find_spec(ENCODER) is not None else "gif"


def evenly(times: NDArray[np.float64], most: int) -> list[int]:
    """Records whose times are spread evenly, first and last among them, at most `most`."""
    wanted = np.linspace(times[0], times[-1], min(most, len(times)))
    nearest = np.searchsorted(0.5 * (times[1:] + times[:-1]), wanted)
    return [int(record) for record in np.unique(nearest)]


def shown_seconds(times: NDArray[np.float64], wanted: float | None) -> float:
    """How long a run is shown [s]: as long as it takes, but neither a flash nor a feature film."""
    return wanted if wanted is not None else float(np.clip(times[-1] - times[0], _SHORTEST, _LONGEST))


def write_animation(
    path: Path,
    frames: Iterable[bytes],
    *,
    count: int,
    seconds: float,
    progress: Callable[[float, str], None] = lambda _done, _note: None,
) -> None:
    """Write an animation, in the format that the suffix of its file says.

    Parameters
    ----------
    path
        Ends in ``.gif`` or ``.mp4``; replaced in one step.
    frames
        PNG files of one size.
    count
        Number of frames, for the rate and the progress.
    seconds
        How long they are shown together [s]; GIF shows 50 frames a second at most.
    progress
        Told how many frames are done.
    """
    pictures = []
    for number, png in enumerate(frames, start=1):
        pictures.append(png)  # kept as PNG: all of them at full size would fill the memory
        progress(number, f"frame {number} of {count}")
    rate = count / seconds
    with replacing(path) as temporary:
        if path.suffix == ".mp4":
            _write_mp4(temporary, pictures, rate)
        else:
            _write_gif(temporary, pictures, min(rate, _FASTEST))


def _opened(png: bytes) -> Image:
    from PIL import Image

    with Image.open(io.BytesIO(png)) as picture:
        return picture.convert("RGB")


def _write_gif(path: Path, pictures: list[bytes], rate: float) -> None:
    """All frames with one palette: colours keep their meaning, and what stands still costs nothing."""
    from PIL import Image

    chosen = np.unique(np.linspace(0, len(pictures) - 1, _SAMPLES).round().astype(int))
    samples = [_opened(pictures[index]) for index in chosen]
    width, height = samples[0].size
    sheet = Image.new("RGB", (width, height * len(samples)), "white")
    for row, sample in enumerate(samples):
        sheet.paste(sample, (0, row * height))
    found = sheet.quantize(256, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).getpalette()
    colours = np.array(found).reshape(-1, 3)
    # what is nearly white stands beside white in the coarse search for the nearest colour, and would take its place
    colours[(colours.min(axis=1) >= _WHITE) | (colours.sum(axis=1) == colours.sum(axis=1).max())] = 255
    palette = Image.new("P", (1, 1))
    palette.putpalette(colours.ravel().tolist())
    flat = [_opened(png).quantize(palette=palette, dither=Image.Dither.NONE) for png in pictures]
    # times in hundredths of a second: rounded so that they add up
    ends = np.round(100.0 * np.arange(1, len(flat) + 1) / rate)
    durations = [10 * int(step) for step in np.diff(ends, prepend=0.0)]
    flat[0].save(
        path, format="GIF", save_all=True, append_images=flat[1:], duration=durations, loop=0, optimize=False
    )


def _write_mp4(path: Path, pictures: list[bytes], rate: float) -> None:
    """H.264 with even numbers of pixels, which all players show."""
    from importlib import import_module

    encoder: Any = import_module(ENCODER)

    width, height = (size - size % 2 for size in _opened(pictures[0]).size)
    video = path.with_suffix(".mp4")  # by which the encoder knows the container
    try:
        writer = encoder.write_frames(
            str(video), (width, height), fps=rate, codec="libx264", quality=8, macro_block_size=2
        )
        writer.send(None)
        for png in pictures:
            writer.send(np.ascontiguousarray(np.asarray(_opened(png))[:height, :width]))
        writer.close()
        video.replace(path)
    finally:
        video.unlink(missing_ok=True)
