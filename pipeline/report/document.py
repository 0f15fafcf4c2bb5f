"""A report as a tree of sections, tables and figures, the album of its pictures, and its forms: Markdown and HTML."""

from __future__ import annotations

import base64
import re
from dataclasses import field, replace
from html import escape
from typing import TYPE_CHECKING

from heavylift.numerics.classes import dataclass
from heavylift.pipeline.results.storage import replacing

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

__all__ = [
    "Album",
    "Document",
    "Facts",
    "Figure",
    "Section",
    "Table",
    "Text",
    "Verdict",
    "short_table",
    "to_html",
    "to_markdown",
]

_ROWS = 60  # rows of a short table at most


@dataclass(frozen=True)
class Text:
    """A paragraph; `warning` sets it off."""

    text: str
    warning: bool = False


@dataclass(frozen=True)
class Verdict:
    """The answer in one line. `passed` is None when there is none."""

    text: str
    passed: bool | None


@dataclass(frozen=True)
class Facts:
    """Names and values, one a line."""

    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Table:
    """Cells as text; columns whose indices are in `numbers` are aligned right.

    `passed` has a value for each row: True and False mark it, None leaves it plain. Long tables of narrow
    columns may be set in several columns side by side in HTML.
    """

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: frozenset[int] = frozenset()
    passed: tuple[bool | None, ...] = ()
    columns: int = 1


@dataclass(frozen=True)
class Figure:
    """A picture or animation beside the report; `wide` gives it the whole width in HTML."""

    file: str
    caption: str
    wide: bool = True


@dataclass(frozen=True)
class Section:
    """A heading and what stands below it."""

    title: str
    items: tuple[Text | Verdict | Facts | Table | Figure, ...]


@dataclass(frozen=True)
class Document:
    """The whole report."""

    title: str
    subtitle: str
    sections: tuple[Section, ...] = field(default=())


@dataclass
class Album:
    """Pictures and animations of one report: written to its folder as they come, kept for the HTML file.

    Attributes
    ----------
    folder
        Folder of the report.
    pictures
        File name to content.
    """

    folder: Path
    pictures: dict[str, bytes] = field(default_factory=dict)

    def add(self, name: str, content: bytes) -> str:
        """Write a PNG; returns its file name, `name` with unusual characters replaced and made unique."""
        path = self.path(name, ".png")
        with replacing(path) as temporary:
            temporary.write_bytes(content)
        return self.take(path)

    def path(self, name: str, suffix: str) -> Path:
        """Path of a file that is yet to be written, with a name as `add` makes it."""
        stem = re.sub(r"[^A-Za-z0-9_-]+", "_", name) or "picture"
        file, number = f"{stem}{suffix}", 2
        while file in self.pictures:
            file, number = f"{stem}_{number}{suffix}", number + 1
        return self.folder / file

    def take(self, path: Path) -> str:
        """Take up a file that has been written at a path from `path`; returns its name."""
        self.pictures[path.name] = path.read_bytes()
        return path.name


def to_markdown(document: Document) -> str:
    """Markdown text; pictures are linked by file name."""
    blocks = [f"# {_md(document.title)}", _md(document.subtitle)]
    for section in document.sections:
        if section.title:
            blocks.append(f"## {_md(section.title)}")
        blocks += [_markdown_item(item) for item in section.items]
    return "\n\n".join(block for block in blocks if block) + "\n"


def _markdown_item(item: Text | Verdict | Facts | Table | Figure) -> str:
    match item:
        case Text():
            return f"> {_md(item.text)}" if item.warning else _md(item.text)
        case Verdict():
            return f"**{_md(item.text)}**"
        case Facts():
            return "\n".join(["| | |", "|---|---|"] + [f"| {_md(k)} | {_md(v)} |" for k, v in item.rows])
        case Figure() if item.file.endswith(".mp4"):
            return f"[{_md(item.caption)}]({item.file})"
        case Figure():
            return f"![{_md(item.caption)}]({item.file})\n\n*{_md(item.caption)}*"
        case Table():
            rule = ["---:" if n in item.numbers else "---" for n in range(len(item.header))]
            rows = [item.header, *item.rows]
            lines = ["| " + " | ".join(_md(cell) for cell in row) + " |" for row in rows]
            return "\n".join([lines[0], "|" + "|".join(rule) + "|", *lines[1:]])


def _md(text: str) -> str:
    """Text in which Markdown finds neither markup nor HTML, on one line."""
    line = " ".join(text.split())
    line = line.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return re.sub(r"([\\`*_\[\]|])", r"\\\1", line)


def to_html(
    document: Document, pictures: Mapping[str, bytes], interactive: tuple[str, str] = ("", "")
) -> str:
    """One HTML file that needs nothing else.

    Parameters
    ----------
    document
        The report.
    pictures
        Content of the files (PNG, GIF, MP4) that its figures name; they are embedded.
    interactive
        Style and HTML of a part that stands above all of it.
    """
    body = [
        "<header>",
        f"<h1>{escape(document.title)}</h1>",
        f'<p class="subtitle">{escape(document.subtitle)}</p>',
        "</header>",
    ]
    for section in document.sections:
        body.append("<section>")
        if section.title:
            body.append(f"<h2>{escape(section.title)}</h2>")
        narrow: list[str] = []
        for item in section.items:
            if isinstance(item, Figure) and not item.wide:
                narrow.append(_html_figure(item, pictures))
                continue
            if narrow:
                body.append(_pair(narrow))
                narrow = []
            body.append(_html_item(item, pictures))
        if narrow:
            body.append(_pair(narrow))
        body.append("</section>")
    style, above = interactive
    return _PAGE.format(
        title=escape(document.title), style=f"{_STYLE}\n{style}", above=above, body="\n".join(body)
    )


def _pair(parts: list[str]) -> str:
    """Side by side, two in a row."""
    return '<div class="figures">\n' + "\n".join(parts) + "\n</div>"


def _html_item(item: Text | Verdict | Facts | Table | Figure, pictures: Mapping[str, bytes]) -> str:
    match item:
        case Text():
            kind = ' class="warning"' if item.warning else ""
            return f"<p{kind}>{escape(item.text)}</p>"
        case Verdict():
            state = {True: "passed", False: "failed", None: "open"}[item.passed]
            return f'<p class="verdict {state}">{escape(item.text)}</p>'
        case Facts():
            rows = "\n".join(f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in item.rows)
            return f'<table class="facts">\n{rows}\n</table>'
        case Figure():
            return _html_figure(item, pictures)
        case Table():
            return _html_table(item)


def _html_figure(figure: Figure, pictures: Mapping[str, bytes]) -> str:
    content = pictures.get(figure.file)
    if content is None:
        source = escape(figure.file, quote=True)
    else:
        kind = _MEDIA[figure.file.rpartition(".")[2]]
        source = f"data:{kind};base64," + base64.b64encode(content).decode("ascii")
    caption = escape(figure.caption)
    if figure.file.endswith(".mp4"):
        picture = f'<video src="{source}" controls loop muted playsinline aria-label="{caption}"></video>'
    else:
        picture = f'<img src="{source}" alt="{caption}">'
    return f"<figure>\n{picture}\n<figcaption>{caption}</figcaption>\n</figure>"


def _html_table(table: Table) -> str:
    def cells(row: tuple[str, ...], tag: str) -> str:
        return "".join(
            f'<{tag} class="number">{escape(cell)}</{tag}>'
            if n in table.numbers
            else f"<{tag}>{escape(cell)}</{tag}>"
            for n, cell in enumerate(row)
        )

    marks = table.passed or (None,) * len(table.rows)
    if table.columns > 1 and len(table.rows) > 12:
        height = -(-len(table.rows) // table.columns)
        starts = range(0, len(table.rows), height)
        parts = [
            replace(table, rows=table.rows[k : k + height], passed=marks[k : k + height], columns=1)
            for k in starts
        ]
        return _pair([_html_table(part) for part in parts])
    kinds = {True: ' class="passed"', False: ' class="failed"', None: ""}
    rows = "\n".join(
        f"<tr{kinds[mark]}>{cells(row, 'td')}</tr>" for row, mark in zip(table.rows, marks, strict=True)
    )
    head = cells(table.header, "th")
    return f'<div class="scroll"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table></div>'


_MEDIA = {"png": "image/png", "gif": "image/gif", "mp4": "video/mp4"}
_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{style}
</style>
</head>
<body>
{above}
<main id="report">
{body}
</main>
</body>
</html>
"""

_STYLE = """:root { --ink: #1d2733; --grey: #5d6873; --line: #dde2e7; --blue: #1f5fa8; }
* { box-sizing: border-box; }
body { margin: 0; background: #f3f5f7; color: var(--ink);
       font: 16px/1.5 "Helvetica Neue", Helvetica, Arial, "DejaVu Sans", sans-serif; }
main { max-width: 1060px; margin: 0 auto; padding: 32px 40px 48px; background: #fff; }
header { border-bottom: 3px solid var(--blue); margin-bottom: 20px; }
h1 { font-size: 28px; line-height: 1.25; margin: 0 0 4px; }
h2 { font-size: 20px; margin: 36px 0 12px; padding-bottom: 4px; border-bottom: 1px solid var(--line); }
.subtitle { color: var(--grey); margin: 0 0 12px; overflow-wrap: anywhere; }
.verdict { padding: 12px 16px; border-left: 6px solid; border-radius: 3px; font-size: 18px; font-weight: 600; }
.verdict.passed { background: #e9f5ec; border-color: #2e7d32; }
.verdict.failed { background: #fdecea; border-color: #c62828; }
.verdict.open { background: #eef1f4; border-color: #8a949f; }
.warning { padding: 10px 14px; background: #fff6e0; border-left: 4px solid #d99a00; overflow-wrap: anywhere; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 14px; margin: 8px 0 16px; }
th, td { padding: 5px 10px; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
thead th { color: var(--grey); font-weight: 600; border-bottom: 2px solid #b8c0c8; white-space: nowrap; }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
table.facts { width: auto; }
table.facts th { font-weight: 400; color: var(--grey); padding-left: 0; padding-right: 24px; white-space: nowrap; }
table.facts td { overflow-wrap: anywhere; }
tr.passed td:last-child { color: #2e7d32; font-weight: 600; }
tr.failed td { background: #fdecea; }
tr.failed td:last-child { color: #c62828; font-weight: 600; }
figure { margin: 16px 0 24px; break-inside: avoid; }
figure img, figure video {
  display: block; width: 100%; height: auto; border: 1px solid var(--line); border-radius: 3px; }
figcaption { color: var(--grey); font-size: 14px; margin-top: 6px; }
.figures { display: grid; grid-template-columns: repeat(2, 1fr); gap: 0 20px; }
@media (max-width: 720px) { main { padding: 20px; } .figures { grid-template-columns: 1fr; } }
@media print { body { background: #fff; font-size: 11pt; } main { max-width: none; padding: 0; }
  h2 { break-after: avoid; } tr { break-inside: avoid; } .scroll { overflow: visible; } }"""


def short_table(
    header: Sequence[str], rows: Sequence[tuple[str, ...]], numbers: frozenset[int] = frozenset()
) -> Table:
    """A table that says how many rows it leaves out; `numbers` are columns set to the right."""
    shown = list(rows[:_ROWS])
    if len(rows) > _ROWS:
        shown.append(("…", f"{len(rows) - _ROWS} more", *([""] * (len(header) - 2))))
    return Table(tuple(header), tuple(shown), numbers)
