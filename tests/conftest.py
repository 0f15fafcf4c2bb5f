"""Data that tests share."""

from __future__ import annotations

import gc
import os
from pathlib import Path

import numba
import numpy as np
import pytest
import scipy.linalg  # noqa: F401
from threadpoolctl import threadpool_limits


def pytest_configure() -> None:
    """One thread of BLAS: processes of tests share the cores, and threads that wait for each other take most of them.

    SciPy has a BLAS of its own. A reference that solves systems of 200 unknowns took 540 s in place of 9 s on two
    busy cores.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # of what tests start
    threadpool_limits(limits=1, user_api="blas")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Before the whole suite: compile on all cores what its processes would compile one after another."""
    config = session.config
    whole = config.args == config.getini("testpaths") and not config.option.collectonly
    if whole and not hasattr(config, "workerinput") and not numba.config.DISABLE_JIT:
        from heavylift.pipeline.commands.compile_kinds import compile_kinds
        from heavylift.pipeline.log import Log

        compile_kinds((), Log())


def pytest_collection_finish(session: pytest.Session) -> None:
    """Modules and what is compiled of them stay: cycles are sought among what tests make, and not at each turn."""
    gc.freeze()
    gc.set_threshold(100_000, 10, 10)


def _data_beside(folder: str, variable: str) -> Path:
    """Public data of others, read where they lie; skips where they are missing."""
    default = Path(__file__).resolve().parents[2] / "shared" / "data" / folder
    path = Path(os.environ.get(variable, default))
    if not path.is_dir():
        pytest.skip(f"no data at {path}; set {variable}")
    return path


@pytest.fixture(scope="session")
def mbsim_data() -> Path:
    """Folder with the public FE data of MBSim (`complex_beam`, `sliding_beam`); skips where it is missing."""
    return _data_beside("mbsim", "HEAVYLIFT_MBSIM_DATA")


@pytest.fixture(scope="session")
def hydro_data() -> Path:
    """Folder with public output of WAMIT (`ellipsoid`, `oswec`) and of Capytaine; skips where it is missing."""
    return _data_beside("hydro", "HEAVYLIFT_HYDRO_DATA")


@pytest.fixture(scope="session")
def with_middle_nodes():
    """Function that makes 20-node bricks of 8-node ones, with straight edges."""
    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.finite_elements.reference_elements import HEX_EDGES

    def elevated(mesh):
        edges = np.sort(mesh.elements[:, HEX_EDGES], axis=2).reshape(-1, 2)
        pairs, number = np.unique(edges, axis=0, return_inverse=True)
        nodes = np.vstack([mesh.nodes, mesh.nodes[pairs].mean(axis=1)])
        cells = np.hstack([mesh.elements, mesh.node_count + number.reshape(-1, 12)])
        return Mesh(nodes, cells, "hex20").check()

    return elevated


@pytest.fixture
def numbers_of_no_hull(monkeypatch):
    """Let databases have any numbers: those that are made to tell the entries of a format apart are of no hull."""
    from heavylift.preprocess.hydrodynamics import repairs

    monkeypatch.setattr(repairs, "check_plausibility", lambda _database: None)
