"""One thread for dense linear algebra: the blocks of a sparse factor are too small for more.

With two threads a modal analysis took three times the CPU time on a busy machine, most of it spent
waiting, and its last bits depended on the number of cores.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

__all__ = ["one_blas_thread"]

P = ParamSpec("P")
R = TypeVar("R")


def one_blas_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Let every BLAS library use one thread while a function runs; restored afterwards."""

    @functools.wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        import scipy.linalg  # noqa: F401  loads its BLAS, so that the limit applies to it as well
        from threadpoolctl import threadpool_limits

        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited
