"""No module needs itself: imports within functions, and those for the type checker alone, count as all others."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path
from textwrap import dedent

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("numerics", "preprocess", "modal", "contours", "solver", "pipeline")

IMPORT = re.compile(
    r"^[ \t]*(?:from heavylift[\w.]* import (?:\([^)]*\)|[^\n]*)|import heavylift[^\n]*)", re.MULTILINE
)
"""An import wherever it stands; to parse all files whole would take a second and a half."""


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(("heavylift", *parts)).removesuffix(".__init__")


def imported(source: str, known: Mapping[str, str]) -> set[str]:
    """Modules that a source names in its imports."""
    found: set[str] = set()
    for statement in IMPORT.findall(source):
        (node,) = ast.parse(dedent(statement)).body
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            whole = [f"{node.module}.{alias.name}" for alias in node.names]
            found |= {name if name in known else str(node.module) for name in whole}
    return found & known.keys()


def circle(sources: Mapping[str, str]) -> list[str]:
    """Modules of a circle, each imported by the one before it; empty if there is none."""
    graph = {name: imported(source, sources) - {name} for name, source in sources.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(reversed(error.args[1]))
    return []


def test_no_modules_import_each_other_in_a_circle():
    files = [path for room in ROOMS for path in (ROOT / room).rglob("*.py")]
    sources = {module_name(path): path.read_text(encoding="utf-8") for path in files}
    assert len(sources) == len(files) > 0
    found = circle(sources)
    assert not found, "imports in a circle: " + " -> ".join(found)


def test_a_circle_is_found_through_functions_and_types():
    sources = {
        "heavylift.a": "from heavylift import b\n",
        "heavylift.b": "def late():\n    from heavylift.c import (\n        one,\n        two,\n    )\n",
        "heavylift.c": "if TYPE_CHECKING:\n    import heavylift.a\n",
        "heavylift.d": "import heavylift.a\n",
    }
    found = circle(sources)
    assert set(found) == {"heavylift.a", "heavylift.b", "heavylift.c"}
    for importer, name in pairwise(found):
        assert name in imported(sources[importer], sources)
    sources["heavylift.c"] = "import os\n"
    assert circle(sources) == []
