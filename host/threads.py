"""The threads that libraries of linear algebra start in a process."""

from __future__ import annotations

import os

ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
"""Environment of a process that computes in one thread.

Matrices of a few hundred rows gain nothing by more: threads that wait for each other keep processors busy.
"""


def keep_to_one_thread() -> None:
    """Let libraries that are not loaded yet start no threads, where the environment does not say how many."""
    if not any(name in os.environ for name in ONE_THREAD):
        os.environ.update(ONE_THREAD)
