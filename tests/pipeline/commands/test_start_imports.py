"""What commands import: a start waits for each library."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

CASES = Path(__file__).parents[3] / "cases"

HINGE = """
[bodies.arm]
type = "rigid"
mass = "10 t"
inertia = ["1e4 kg m^2", "1e4 kg m^2", "1e4 kg m^2"]
frame = { motion = "free" }
initial = { position = ["20 m", 0, 0] }

[[joints]]
name = "pin"
type = "hinge"
between = ["ground", "arm"]
at = ["18 m", 0, 0]
axis = [0, 1, 0]
"""

HEAVY = ("gmsh", "k3d", "matplotlib", "meshio", "pint", "pyvista", "skfem", "trimesh", "vtkmodules")
OTHERS = tuple(
    f"heavylift.pipeline.case.{table}"
    for table in ("ballast", "contours", "flexible_bodies", "hulls", "meshes", "scenario", "sea", "surfaces")
)
"""Sections of tables that the case does not have."""
SCIPY = ("scipy.linalg", "scipy.optimize", "scipy.sparse", "scipy.spatial")


def imported(*arguments: str, watched: tuple[str, ...]) -> list[str]:
    """Those of some modules that a command has imported when it ends."""
    code = (
        "import atexit, sys\n"
        f"atexit.register(lambda: print('IMPORTED', *sorted({set(watched)!r} & set(sys.modules)), file=sys.stderr))\n"
        "from heavylift.pipeline.commands.start import main\n"
        "main()\n"
    )
    command = [sys.executable, "-P", "-c", code, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return next(line.split()[1:] for line in done.stderr.splitlines() if line.startswith("IMPORTED"))


def test_a_run_of_a_rope_and_a_hinge_needs_no_compiler_and_no_scipy(tmp_path: Path) -> None:
    case = tmp_path / "hoist"
    shutil.copytree(CASES / "hoist", case, ignore=shutil.ignore_patterns("out"))
    with (case / "case.toml").open("a", encoding="utf-8") as file:
        file.write(HINGE)
    first = imported("simulate", str(case), watched=HEAVY)  # what compiles kernels may import SciPy
    assert first == []
    assert imported("simulate", str(case), "--force", watched=(*HEAVY, *SCIPY, *OTHERS, "numba")) == []


def test_help_and_keys_need_no_kernels() -> None:
    assert imported("--help", watched=("numpy", "pydantic", *HEAVY)) == []
    assert imported("schema", "joints", watched=(*SCIPY, *HEAVY)) == []
