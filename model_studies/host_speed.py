"""Speeds of this host for predictions of cost, measured once and stored, so that predictions agree.

The benchmark is a short factorization of a sparse matrix. It represents all work except dense algebra, which
has a benchmark of its own (`condensation_cost` of fe_contact). On shared processors, a repeated measurement
of either differs by tens of per cent.
"""

from __future__ import annotations

import json
import os
import platform
import time
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import numpy as np

from host.directories import atomic_file
from host.optional_modules import sparse, sparse_linalg

VERSION = 2  # raise it with every change of the benchmark or its reference
FILE = "host-speed.json"
REFERENCE_SECONDS = 0.00255
"""CPU seconds of the benchmark on the host where the constants of the cost model were measured."""
_SIDE, _REPEATS = 40, 12
_ALIKE, _AGREEMENT = 3, 1.02
"""Number of the quickest runs of a benchmark, and the ratio of the slowest to the quickest of them, at which
a further run would tell nothing new. The first runs get fresh memory, and others of the host's processors
come and go: two runs agree by chance, at up to twice the time.
"""
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables that state the number of threads, the first that is set first."""
_SLOWEST = 1000.0
"""Largest slowness that counts as a measurement, and the inverse of the smallest."""


def host_slowness(cache: Path | None) -> float:
    """Return the time of this host over that of the reference: 1 = equal, 2 = twice as long.

    `cache`: as of `cached_speed`.
    """
    return cached_speed(cache, "slowness", measured_slowness, (1.0 / _SLOWEST, _SLOWEST))


def algebra_threads() -> int:
    """Return the number of threads that dense linear algebra of this process starts.

    Threads that wait for each other take CPU time: a speed that is measured in one number of threads is not
    that of another.
    """
    for variable in _THREADS:
        number = os.environ.get(variable, "")
        if number.isdigit() and int(number) > 0:
            return int(number)
    return os.cpu_count() or 1


def cached_speed(
    cache: Path | None, name: str, measure: Callable[[], float], bounds: tuple[float, float]
) -> float:
    """Return a speed of this host, measured once.

    Parameters
    ----------
    cache : Path, optional
        Directory of the file that stores the speed. A file that is missing, damaged or of another host is
        written anew. None: no file; `measure` may store its value for this process.
    bounds : (float, float)
        Range of plausible values; a stored value outside of it is measured anew.
    """
    if cache is None:
        return measure()
    file = cache / FILE
    known = _read(file)
    stored = known.get(name)
    if isinstance(stored, float) and bounds[0] <= stored <= bounds[1]:
        return stored
    value = measure()
    _write(file, {**known, "identity": _identity(), name: value})
    return value


@lru_cache(maxsize=1)
def measured_slowness() -> float:
    """Return the slowness by the quickest of several runs of the benchmark."""
    laplacian = sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(_SIDE, _SIDE))
    matrix = sparse.csc_array(sparse.kronsum(laplacian, laplacian))
    load = np.ones(_SIDE**2)
    seconds = quickest(lambda: sparse_linalg.splu(matrix).solve(load))
    return min(max(seconds / REFERENCE_SECONDS, 1.0 / _SLOWEST), _SLOWEST)


def quickest(run: Callable[[], object]) -> float:
    """Return the CPU seconds of the quickest of several runs of a benchmark of some milliseconds."""
    times: list[float] = []
    while len(times) < _ALIKE or (len(times) < _REPEATS and times[_ALIKE - 1] > _AGREEMENT * times[0]):
        start = time.process_time()
        run()
        times = sorted([*times, time.process_time() - start])
    return times[0]


def _identity() -> dict[str, object]:
    return {
        "version": VERSION,
        "host": platform.node(),
        "machine": platform.machine(),
        "cores": os.cpu_count(),
        "numpy": np.__version__,
    }


def _read(file: Path) -> dict[str, object]:
    """Return the stored speed of this host; nothing where it cannot be trusted."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        return dict(content) if content["identity"] == _identity() else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _write(file: Path, content: dict[str, object]) -> None:
    """Keep measurements; a directory that cannot be written is left as it is."""
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        with atomic_file(file) as draft:
            draft.write_text(json.dumps(content), encoding="utf-8")
