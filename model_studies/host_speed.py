"""Speed of this host relative to the one that set the constants of cost models; measured once and cached.

A short factorisation of a sparse matrix stands for all work but dense algebra, which has a measurement of its
own (`fe_contact.compliance.cost_3d.dense_rate`).
"""

from __future__ import annotations

import json
import math
import os
import platform
import tempfile
import time
from functools import lru_cache
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

VERSION = 1  # raise it with every change of the benchmark or its reference
FILE = "host-speed.json"
REFERENCE_SECONDS = 0.0065
"""Of the benchmark on the host where the constants of the cost model were measured."""
_SIDE, _REPEATS = 60, 5
_SLOWEST = 1000.0


def host_slowness(cache: Path | None) -> float:
    """Return the time that this host takes beside the reference, 1 = alike, 2 = twice as long.

    Parameters
    ----------
    cache : Path, optional
        Directory in which the measurement is kept; a missing, damaged or foreign file is made anew. None:
        measured once per process.
    """
    if cache is None:
        return measured_slowness()
    kept = _read(cache / FILE)
    if kept is not None:
        return kept
    slowness = measured_slowness()
    _write(cache / FILE, slowness)
    return slowness


@lru_cache(maxsize=1)
def measured_slowness() -> float:
    """Run the benchmark; the quickest of several runs counts."""
    laplacian = sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(_SIDE, _SIDE))
    matrix = sparse.csc_array(sparse.kronsum(laplacian, laplacian))
    load = np.ones(_SIDE**2)
    times = []
    for _ in range(_REPEATS):
        start = time.process_time()
        splu(matrix).solve(load)
        times.append(time.process_time() - start)
    return min(max(min(times) / REFERENCE_SECONDS, 1.0 / _SLOWEST), _SLOWEST)


def _identity() -> dict[str, object]:
    """Return what a measurement is valid for."""
    return {
        "version": VERSION,
        "host": platform.node(),
        "machine": platform.machine(),
        "cores": os.cpu_count(),
        "numpy": np.__version__,
    }


def _read(file: Path) -> float | None:
    """Return the kept measurement of this host, None if there is none that can be trusted."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        slowness = float(content["slowness"])
        trusted = content["identity"] == _identity() and math.isfinite(slowness)
        return slowness if trusted and 1.0 / _SLOWEST <= slowness <= _SLOWEST else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _write(file: Path, slowness: float) -> None:
    """Keep a measurement; a directory that cannot be written is left as it is."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, draft = tempfile.mkstemp(dir=file.parent, suffix=".partial")
    except OSError:
        return
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            json.dump({"identity": _identity(), "slowness": slowness}, stream)
        Path(draft).replace(file)
    except OSError:
        Path(draft).unlink(missing_ok=True)
