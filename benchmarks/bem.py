"""Time of computing the database of the transport barge, and what a reader of it costs.

    python benchmarks/bem.py

648 panels and a lid, 60 frequencies and infinity, 19 headings; wall time, and CPU time of this process and of those it
started. Needs `heavylift[hydro]`. Aim: 60 s on two cores.
"""

from __future__ import annotations

import importlib.util
import os
import statistics
import tempfile
import time
from pathlib import Path

from heavylift.preprocess.hydrodynamics.bem import capytaine_version, compute_database
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf, write_netcdf

CASE = Path(__file__).resolve().parents[1] / "cases" / "transport_barge"
REPEATS = 21


def cpu_seconds() -> float:
    """CPU time of this process and of all processes that it started and that have ended."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def main() -> None:
    spec = importlib.util.spec_from_file_location("make_database", CASE / "make_database.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    inputs = module.database_inputs()
    wall, cpu = time.perf_counter(), cpu_seconds()
    database = compute_database(inputs)
    wall = time.perf_counter() - wall
    try:
        from joblib.externals.loky import get_reusable_executor

        get_reusable_executor().shutdown(wait=True)  # the time of a child counts when it has ended
    except ImportError:
        pass
    cpu = cpu_seconds() - cpu
    print(f"Capytaine {capytaine_version()}, {os.cpu_count()} cores: {wall:.1f} s wall, {cpu:.1f} s CPU")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "barge.nc"
        for name, action in (
            ("write", lambda: write_netcdf(path, database)),
            ("read", lambda: read_netcdf(path)),
        ):
            times = []
            for _ in range(REPEATS):
                start = time.perf_counter()
                action()
                times.append(time.perf_counter() - start)
            print(f"{name} {path.stat().st_size / 1024:.0f} KiB: {1e3 * statistics.median(times):.1f} ms")


if __name__ == "__main__":
    main()
