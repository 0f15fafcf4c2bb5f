"""Write `docs/where.md`: which file implements which section of the two theses, and which case checks it.

    python tests/docs/where.py

Files are found by what their docstrings cite (``"... (2018)", section 2.4.3`` or ``eqs. 163-164``), cases by what their
``case.toml`` and ``README.md`` cite, and by the sorts of joints that they contain.
"""

from __future__ import annotations

import ast
import re
import tomllib
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[2]
ROOMS = ("solver", "contours", "modal", "preprocess", "numerics", "pipeline")
THESES = {
    "2018": "Integrated simulation for design verification of ships and offshore structures (2018)",
    "2014": "Deformable bodies with complex geometries, sliding contacts (2014)",
}
SECTIONS: dict[str, tuple[tuple[str, str, float], ...]] = {
    "2018": (
        ("2.1.1", "discrete Euler-Lagrange equation", 1),
        ("2.1.2", "with constraints", 13),
        ("2.1.3", "with non-conservative forces", 28),
        ("2.1.4", "regularisation", 36),
        ("2.1.5", "stabilisation", 46),
        ("2.1.6", "final form", 49),
        ("2.1.7", "meaning of its parameters", 50),
        ("2.2", "frame elements", 51),
        ("2.3", "shell elements", 103),
        ("2.4.1", "ball joint", 162),
        ("2.4.2", "universal joint", 165),
        ("2.4.3", "hinge joint", 168),
        ("2.4.4", "slider joint", 171),
        ("2.4.5", "fixed joint", 175),
        ("2.4.6", "slider-hinge joint", 178),
        ("2.4.7", "wire rope", 181),
        ("2.5.1", "joints on frame elements", 186),
        ("2.5.2", "joints on shell elements", 195),
        ("2.6.1", "collision detection", 203),
        ("2.6.2", "collision response", 203),
        ("2.6.4", "case studies of collisions", 216),
        ("2.6.5", "impulse and impulsive force", 216),
        ("2.7.2", "pulleys", 219),
        ("2.7.3", "case studies of pulleys", 221),
        ("2.9.1", "hydrodynamic force", 223),
        ("2.9.2", "buoyancy", 225),
        ("2.9.3", "wind", 225),
        ("2.9.4", "current", 228),
        ("2.9.5", "catenary mooring", 229),
        ("2.9.6", "spring rope", 230),
        ("3.1.1", "multibody benchmarks", 231),
        ("3.1.2", "against commercial software", 231),
        ("3.2.1", "frame elements", 231),
        ("3.2.2", "shell elements", 233),
        ("3.3.1", "barge in a regular wave (I)", 235),
        ("3.3.2", "barge in a regular wave (II)", 235),
        ("3.3.3", "barge on four springs", 235),
        ("3.4", "catenary mooring", 235),
        ("3.5", "module erection", 235),
        ("3.6", "living quarter erection", 235),
        ("4.1", "lifts with equalizers", 235),
        ("4.2", "LPG tank erection", 235),
        ("4.3", "thin plate blocks", 235),
    ),
    "2014": (
        ("2.2", "modal analysis", 2.01),
        ("2.3", "modal reduction", 2.15),
        ("2.4", "floating frame of reference", 2.20),
        ("3.1", "contact kinematics", 3.01),
        ("3.2.1", "NURBS", 3.09),
        ("3.2.2", "contour interpolation", 3.24),
        ("3.3", "contact search", 3.30),
        ("4.2", "preprocessor and interface", 4.01),
        ("4.4", "contours", 4.02),
        ("5.1", "complex beam", 5.01),
        ("5.2", "point mass on a beam", 5.01),
        ("5.3", "balls on beams", 5.01),
    ),
}
"""Number, title and first equation of the sections that hold formulas or examples; 2.9 of 2014 stands as 2.09."""

HEAD = """# Where the theses are

Written by `python tests/docs/where.py` from what docstrings and cases cite; do not edit. Corrections to the theses
stand in the docstrings of the files.
"""

CITED = re.compile(r"\((2018|2014)\)\W{0,3}\s*(.{0,70})|(2018|2014) thesis\W{0,2}\s*(.{0,70})")
NUMBERS = r"(?:\d+(?:\.\d+)*(?:\s?(?:,|-|to|and)\s?)?)+"
PLACE = re.compile(rf"(?:^|and |of |, )(chapter|sections?|eqs?\.|equations?) ({NUMBERS})", re.IGNORECASE)


def cited(text: str) -> set[tuple[str, str]]:
    """Theses and numbers of sections that a text cites."""
    found = set()
    for match in CITED.finditer(" ".join(text.split())):
        thesis, tail = match[1] or match[3], match[2] or match[4]
        before = " ".join(text.split())[max(0, match.start() - 24) : match.start()]
        for place in [*PLACE.finditer(tail), *re.finditer(r"([Ee]qs?\.) (\d+)(?= of the $)", before)]:
            numbers = re.findall(r"\d+(?:\.\d+)*", place[2])
            found |= {(thesis, _section(thesis, place[1].lower(), number)) for number in numbers}
    return {(thesis, section) for thesis, section in found if section}


def _section(thesis: str, what: str, number: str) -> str:
    """Section of the table that a section or equation belongs to; empty if none."""
    known = SECTIONS[thesis]
    if what.startswith("eq"):
        chapter, _, minor = number.partition(".")
        value = float(chapter) if thesis == "2018" else float(chapter) + int(minor or 0) / 100.0
        below = [section for section, _, first in known if first <= value]
        return below[-1] if below else ""
    fits = [section for section, _, _ in known if number == section or number.startswith(f"{section}.")]
    return fits[0] if fits else next((s for s, _, _ in known if s.startswith(f"{number}.")), "")


def docstrings(file: Path) -> str:
    """All docstrings of a module."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    nodes = [n for n in ast.walk(tree) if isinstance(n, (ast.Module, ast.ClassDef, ast.FunctionDef))]
    return "\n\n".join(filter(None, (ast.get_docstring(node) for node in nodes)))


def joint_words(file: Path) -> set[str]:
    """Types of joints that a module describes."""
    return set(re.findall(r'@JOINTS\.describe\("(\w+)"\)', file.read_text(encoding="utf-8")))


def table() -> str:
    """The page."""
    files, cases = defaultdict(set), defaultdict(set)
    containing = defaultdict(set)
    for folder in sorted(path.parent for path in (ROOT / "cases").glob("*/case.toml")):
        text = (folder / "case.toml").read_text(encoding="utf-8")
        for key in cited(text) | cited((folder / "README.md").read_text(encoding="utf-8")):
            cases[key].add(folder.name)
        for joint in tomllib.loads(text).get("joints", ()):
            containing[joint["type"]].add(folder.name)
    for room in ROOMS:
        for file in sorted((ROOT / room).rglob("*.py")):
            for key in cited(docstrings(file)):
                files[key].add(file.relative_to(ROOT).as_posix())
                for word in joint_words(file):
                    cases[key] |= set(sorted(containing[word])[:4])
    lines = [HEAD]
    for thesis, title in THESES.items():
        lines += [f"## {title}\n", "| section | | files | cases |", "|---|---|---|---|"]
        for section, what, _ in SECTIONS[thesis]:
            key = thesis, section
            if files[key] or cases[key]:
                where = ", ".join(f"[{name}](../{name})" for name in sorted(files[key]))
                checked = ", ".join(f"[{name}](../cases/{name})" for name in sorted(cases[key]))
                lines.append(f"| {section} | {what} | {where} | {checked} |")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    (ROOT / "docs" / "where.md").write_text(table(), encoding="utf-8")
