"""Numbers of a page: arrays in one block of bytes, referred to by a header in JSON, and both in one HTML file."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import zlib
from dataclasses import field
from functools import cache
from importlib import resources
from importlib.metadata import PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Block",
    "LibraryMissingError",
    "content_policy",
    "finite",
    "header_text",
    "live_content",
    "page_parts",
]

_LEVELS = 65535  # of a quantised number
_ALIGNED = 4  # bytes at which arrays begin


class LibraryMissingError(RuntimeError):
    """The package that ships the script library of the page is not installed."""


@dataclass
class Block:
    """Arrays one behind the other.

    Attributes
    ----------
    parts
        Their bytes.
    size
        Of all of them [bytes].
    """

    parts: list[bytes] = field(default_factory=list)
    size: int = 0

    def add(self, values: ArrayLike, kind: str = "f4") -> dict[str, Any]:
        """Reference to an array stored as ``f4``, ``f8``, ``i4``, ``u1``, ``i2``; what ``f4`` does not hold is NaN."""
        array = np.asarray(values)
        if kind == "f4":
            with np.errstate(over="ignore", invalid="ignore"):
                array = array.astype("<f4")
            array = np.where(np.isfinite(array), array, np.float32(np.nan))
        content = np.ascontiguousarray(array, dtype=f"<{kind}").tobytes()
        entry = {"o": self.size, "n": int(array.size), "t": kind, "s": list(array.shape)}
        content += bytes(-len(content) % _ALIGNED)
        self.parts.append(content)
        self.size += len(content)
        return entry

    def quantised(self, values: NDArray[np.float64]) -> dict[str, Any]:
        """Reference to numbers of which each component, the last axis, is one of 65,536 levels of its range.

        What is not finite counts as the middle of the range.
        """
        width = values.shape[-1]
        flat = np.asarray(values, dtype=np.float64).reshape(-1, width)
        good = np.isfinite(flat)
        low = np.where(good, flat, np.inf).min(axis=0, initial=np.inf)
        high = np.where(good, flat, -np.inf).max(axis=0, initial=-np.inf)
        none = low > high
        low, high = np.where(none, 0.0, low), np.where(none, 0.0, high)
        step = np.maximum((high - low) / _LEVELS, 1e-30)
        levels = np.round((np.where(good, flat, 0.5 * (low + high)) - low) / step) - 32768.0
        entry = self.add(np.clip(levels, -32768, 32767).reshape(values.shape), "i2")
        return {**entry, "low": [float(v) for v in low + 32768.0 * step], "step": [float(v) for v in step]}

    def packed(self, level: int = 6) -> bytes:
        """All bytes, compressed."""
        return zlib.compress(b"".join(self.parts), level)


def finite(value: Any) -> Any:
    """A document without numbers that JSON does not know: they become null."""
    if isinstance(value, dict):
        return {key: finite(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(entry) for entry in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and value - value != 0.0:
        return None
    return value


def header_text(header: dict[str, Any]) -> str:
    """The header as JSON in which HTML finds neither the end of a script nor a comment."""
    text = json.dumps(finite(header), ensure_ascii=False, separators=(",", ":"))
    for letter in "<>&\u2028\u2029":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return text


def live_content(header: dict[str, Any], block: Block) -> bytes:
    """Length of the header, header and block, as a page asks for them again while a run goes on."""
    text = header_text(header).encode()
    return len(text).to_bytes(4, "little") + text + block.packed(1)


def page_parts(header: dict[str, Any], block: Block) -> tuple[str, str]:
    """Style, and HTML of the interactive part with scripts, library and data in it.

    Raises
    ------
    LibraryMissingError
        If k3d is not installed.
    """
    own = resources.files("heavylift.pipeline.page")
    parts = {
        "HEADER": header_text(header),
        "BLOCK": base64.b64encode(block.packed()).decode("ascii"),
        "LIBRARY": _library(),
        "LICENCE": _licence(),
        "SCRIPT": (own / "viewer.js").read_text(encoding="utf-8"),
    }
    page = (own / "viewer.html").read_text(encoding="utf-8")
    body = re.sub(r"\[([A-Z]+)\]", lambda place: parts[place[1]], page)  # once: names may look like places
    return (own / "viewer.css").read_text(encoding="utf-8"), body


@cache
def content_policy() -> str:
    """What a browser may do for a page that a server delivers: the one script of ours, and nothing from elsewhere.

    The library is a text that our script runs; it draws with textures that stand in it, and asks us for fonts.
    """
    own = resources.files("heavylift.pipeline.page")
    page = (own / "viewer.html").read_text(encoding="utf-8")
    scripts = [text for text in re.findall(r"<script>(.*?)</script>", page, re.DOTALL) if "[SCRIPT]" in text]
    ours = scripts[0].replace("[SCRIPT]", (own / "viewer.js").read_text(encoding="utf-8"))
    digest = base64.b64encode(hashlib.sha256(ours.encode()).digest()).decode("ascii")
    return "; ".join(
        (
            "default-src 'none'",
            f"script-src 'sha256-{digest}' 'unsafe-eval'",
            "style-src 'unsafe-inline'",
            "img-src data: blob:",
            "font-src 'self' data:",
            "worker-src blob:",
            "connect-src 'self'",
            "base-uri 'none'",
            "form-action 'none'",
            "frame-ancestors 'none'",
        )
    )


def _folder() -> Path:
    """Folder of the files of k3d, which is never imported: it would bring all of Jupyter."""
    found = find_spec("k3d")
    if found is None or not found.origin:
        raise LibraryMissingError("k3d is not installed; `pip install k3d` brings the library that draws it")
    return Path(found.origin).parent / "static"


@cache
def _library() -> str:
    """The script library, compressed, in base64."""
    file = _folder() / "standalone.js"
    try:
        return base64.b64encode(zlib.compress(file.read_bytes(), 9)).decode("ascii")
    except OSError as error:
        raise LibraryMissingError(f"{file} of the package k3d cannot be read: {error.strerror}") from None


def _licence() -> str:
    """One line on whose the library is."""
    try:
        version = distribution("k3d").version
    except PackageNotFoundError:
        version = ""
    return f"k3d {version} (MIT licence, k3d-jupyter.org) with three.js (MIT licence, threejs.org)".replace(
        "  ", " "
    )
