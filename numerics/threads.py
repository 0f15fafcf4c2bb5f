"""One thread for dense linear algebra: the blocks of a sparse factor are too small for more.

With two threads a modal analysis took three times the CPU time on a busy machine, most of it spent
waiting, and its last bits depended on the number of cores.
"""

from __future__ import annotations

import contextlib
import functools
import sys
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

__all__ = ["numpy_on_one_thread", "one_blas_thread"]

P = ParamSpec("P")
R = TypeVar("R")


def one_blas_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Let every BLAS library use one thread while a function runs; restored afterwards."""

    @functools.wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        import scipy.linalg  # noqa: F401  loads its BLAS, so that the limit applies to it as well

        with numpy_on_one_thread():
            return function(*args, **kwargs)

    return limited


def numpy_on_one_thread() -> contextlib.AbstractContextManager[Any]:
    """One thread within, of NumPy and of what else is there: importing SciPy takes longer than a small scene."""
    found: contextlib.AbstractContextManager[Any] = _libraries("scipy.linalg" in sys.modules).limit(
        limits=1, user_api="blas"
    )
    return found


@functools.cache
def _libraries(with_scipy: bool) -> Any:
    """BLAS libraries that are loaded; a search for them takes milliseconds."""
    del with_scipy  # is the key
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
