"""What is installed on this machine, and what to do about what is not."""

from __future__ import annotations

import os
import platform
import re
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from typing import Any

from heavylift.numerics.children import NEUTRAL_FOLDER, python_command
from heavylift.pipeline.commands.requirements import remedy, requirements, troubles

__all__ = ["diagnosis", "diagnosis_lines"]

OPTIONAL_SOLVERS = {
    "pypardiso": "PARDISO (pip install pypardiso)",
    "scikit-sparse": "CHOLMOD (scikit-sparse)",
}

APT_PACKAGES = {
    "libGL.so.1": "libgl1",
    "libGLU.so.1": "libglu1-mesa",
    "libEGL.so.1": "libegl1",
    "libOSMesa.so.8": "libosmesa6",
    "libX11.so.6": "libx11-6",
    "libXrender.so.1": "libxrender1",
    "libXcursor.so.1": "libxcursor1",
    "libXft.so.2": "libxft2",
    "libXinerama.so.1": "libxinerama1",
    "libXfixes.so.3": "libxfixes3",
    "libXi.so.6": "libxi6",
    "libXext.so.6": "libxext6",
    "libgomp.so.1": "libgomp1",
    "libfontconfig.so.1": "libfontconfig1",
}
"""Debian packages of the system libraries that gmsh and VTK load."""

_RENDER = """
import pyvista, sys
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere(), color="red")
image = plotter.screenshot(return_img=True)
info = plotter.render_window.ReportCapabilities() if hasattr(plotter, "render_window") else ""
name = [line.split(":", 1)[1].strip() for line in info.splitlines() if "renderer string" in line]
print(plotter.render_window.GetClassName(), name[0] if name else "")
sys.exit(0 if image.std() > 1.0 else 3)
"""


def diagnosis() -> dict[str, Any]:
    """Findings as plain values; ``ready`` tells whether everything needed works."""
    packages = requirements()
    outside = troubles(packages)
    gmsh = _attempt("import gmsh; gmsh.initialize(); gmsh.finalize(); print(gmsh.__version__)")
    drawing = _attempt(_RENDER)
    return {
        "ready": not outside and gmsh["works"] and drawing["works"],
        "python": f"{platform.python_version()} ({sys.executable})",
        "platform": platform.platform(),
        "cpu": _cpu(),
        "cores": len(os.sched_getaffinity(0)),
        "packages": {one.name: one.version for one in packages},
        "out_of_range": {one.name: str(one) for one in outside},
        "remedy": remedy(outside) if outside else "",
        "optional_solvers": {name: _version(name) for name in OPTIONAL_SOLVERS},
        "factorisations": [] if outside else _factorisations(),
        "blas": "unknown" if outside else _blas(),
        "gmsh": gmsh,
        "drawing": drawing,
        "cache": _cache(compiler=not outside),
    }


def _cache(*, compiler: bool) -> dict[str, Any]:
    """Where compiled kernels are, and how many, if there is a compiler that is known."""
    from heavylift.numerics.sources import cache_root, distrusted

    root = cache_root()
    folder = root / "objects"
    found = {
        "folder": str(root),
        "writable": _writable(folder),
        "distrusted": distrusted(folder),
        "size": _size(root),
        "parts": 0,
        "compiled": 0,
    }
    if not compiler:
        return found
    from heavylift.solver.compiling import all_units, missing_units

    units = [unit for own in all_units().values() for unit in own]
    return found | {"parts": len(units), "compiled": len(units) - len(missing_units(units))}


def _writable(folder: Path) -> bool:
    """Whether files can be made in a folder, or it can be made."""
    while not folder.exists():
        folder = folder.parent
    return os.access(folder, os.W_OK)


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _factorisations() -> list[str]:
    from heavylift.modal.factor import available_backends

    return list(available_backends())


def _blas() -> str:
    import numpy as np

    config = np.show_config(mode="dicts")
    blas = config.get("Build Dependencies", {}).get("blas", {}) if isinstance(config, dict) else {}
    return f"{blas.get('name', 'unknown')} {blas.get('version', '')}".strip()


def _cpu() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return platform.processor() or platform.machine()
    match = re.search(r"model name\s*:\s*(.+)", text)
    return match[1].strip() if match else platform.machine()


def _attempt(code: str) -> dict[str, Any]:
    """Run code in a process of its own, because a missing driver may end the process."""
    try:
        result = subprocess.run(  # noqa: S603
            python_command("-c", code),
            cwd=NEUTRAL_FOLDER,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=120,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return {"works": False, "detail": "no answer within two minutes", "remedy": ""}
    words = (result.stdout if result.returncode == 0 else result.stderr).strip().splitlines()
    detail = words[-1] if words else f"exit code {result.returncode}"
    missing = sorted(set(re.findall(r"(lib[\w+.-]+\.so[.\d]*)", result.stderr)) & set(APT_PACKAGES))
    remedy = ""
    if result.returncode != 0:
        names = [APT_PACKAGES[name] for name in missing] or [
            "libgl1",
            "libglu1-mesa",
            "libegl1",
            "libxrender1",
        ]
        remedy = f"apt-get install {' '.join(names)}"
    return {"works": result.returncode == 0, "detail": detail, "remedy": remedy}


def _size(folder: Path) -> int:
    """Bytes of all files below a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) if folder.is_dir() else 0


def diagnosis_lines(found: dict[str, Any]) -> list[str]:
    """Findings as lines for a person."""
    lines = [
        f"Python          {found['python']}",
        f"platform        {found['platform']}",
        f"CPU             {found['cpu']}, {found['cores']} cores usable",
        f"BLAS            {found['blas']}",
    ]
    for name, version in found["packages"].items():
        told = found["out_of_range"].get(name)
        lines.append(f"{name:15} {version if told is None else f'OUT OF RANGE: {told}'}")
    if found["remedy"]:
        lines.append(f"remedy          {found['remedy']}")
    for name, version in found["optional_solvers"].items():
        lines.append(f"{name:15} {version or 'not installed (optional): ' + OPTIONAL_SOLVERS[name]}")
    lines.append(f"factorisations  {', '.join(found['factorisations'])}")
    for key, title in (("gmsh", "gmsh works"), ("drawing", "pictures")):
        item = found[key]
        state = "yes" if item["works"] else "NO"
        lines.append(
            f"{title:15} {state}: {item['detail']}" + (f"; {item['remedy']}" if item["remedy"] else "")
        )
    cache = found["cache"]
    writable = "" if cache["writable"] else ", NOT WRITABLE: set HEAVYLIFT_CACHE_DIR"
    if cache["distrusted"]:
        writable = f", NOT USED: {cache['distrusted']}"
    ready = f"{cache['compiled']} of {cache['parts']} parts compiled" if cache["parts"] else "not known"
    ahead = (
        "" if cache["compiled"] == cache["parts"] else "; `heavylift compile` compiles the rest in advance"
    )
    lines.append(f"kernels         {ready}{ahead}")
    lines.append(f"kernel cache    {cache['folder']}, {cache['size'] / 2**20:.1f} MB in all{writable}")
    lines.append("ready" if found["ready"] else "NOT ready, see above")
    return lines
