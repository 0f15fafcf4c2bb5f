"""Matplotlib figures as PNG, without the global state of pyplot."""

from __future__ import annotations

import io
from typing import Any

__all__ = ["few_colours", "figure_png"]


def figure_png(figure: Any) -> bytes:
    """Content of a PNG file at the resolution of the figure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    buffer = io.BytesIO()
    FigureCanvasAgg(figure).print_png(buffer)
    return buffer.getvalue()


def few_colours(png: bytes) -> bytes:
    """The picture with a palette of 256 colours: a quarter of the size for plots and for sheets of thumbnails."""
    from PIL import Image

    buffer = io.BytesIO()
    with Image.open(io.BytesIO(png)) as image:
        flat = image.convert("RGB").quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    flat.save(buffer, format="png")
    return buffer.getvalue()
