"""Runs of pairs, measured once: each is a JSON line, so that a study that was stopped can go on."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.assessed import HARMONICS, STATED
from benchmarks.finest_solution import FINER, finest
from benchmarks.pair_cases import PairCase
from fe_contact import SteDatabase, analyze
from fe_contact.analysis.studies.frontier import warm_up
from fe_contact.ste.curve_errors import AT_NODES, all_sources
from fe_contact.ste.metadata import content_hash
from fe_contact.types import FloatArray, Json

FILE = Path(__file__).parents[1] / "out" / "bench" / "runs.jsonl"
VERSION = 4
"""Raise it whenever the solver gives other numbers."""


@dataclass(frozen=True)
class StoredRun:
    """One table of a pair."""

    value: FloatArray
    """Values of mean, peak-to-peak and three harmonics, m. Shape (5, loads)."""
    sources: FloatArray
    """Stated errors of these values by source, in the order of `AT_NODES`, m. Shape (6, 5, loads)."""
    receipt: Json
    """Parts of the table's receipt: cost, prediction, plan, tolerance, passes."""

    @property
    def seconds(self) -> float:
        """CPU seconds of all passes with an empty cache."""
        return float(self.receipt["cpu_seconds"])

    def stated(self, *without: str) -> FloatArray:
        """Return the stated errors (5, loads) in m, some sources left out."""
        return together(self.sources, *without)


def together(sources: FloatArray, *without: str) -> FloatArray:
    """Return the errors (5, loads) of sources (6, 5, loads), some of them left out."""
    kept = [source not in without for source in AT_NODES]
    return all_sources(sources[kept])


def table_run(case: PairCase, **accuracy: Any) -> StoredRun:
    """Return the table of a case as a caller's `analyze` gives it, with nothing in the cache."""
    found = _stored(case, repr(sorted(accuracy.items())), lambda folder: _run(case, folder, accuracy))
    return StoredRun(np.array(found["value"]), np.array(found["sources"]), found["receipt"])


def finest_run(case: PairCase) -> FloatArray:
    """Return the quantities (5, loads) of the finest solution of a case, m."""
    found = _stored(case, f"finest, {FINER:g}", lambda folder: {"value": finest(case, folder).tolist()})
    return np.array(found["value"])


def _run(case: PairCase, folder: Path, accuracy: Json) -> Json:
    """Run a case."""
    warm_up(across_face=True)
    table = analyze(case.pair, normal_forces=case.forces, cache=folder, **accuracy, **case.options)
    receipt = table.metadata.receipt
    excerpt = {
        name: receipt[name]
        for name in ("cpu_seconds", "prediction", "passes", "tolerance")
        if name in receipt
    }
    return {
        "value": quantities(table).tolist(),
        "sources": errors_by_source(table).tolist(),
        "receipt": excerpt,
    }


def errors_by_source(table: SteDatabase) -> FloatArray:
    """Return the stated errors (6, 5, loads) in m at the loads of a table, in the order of `AT_NODES`."""
    return np.asarray(table.curve_error[: len(AT_NODES), :, :, 0, 0][:, list(STATED)])


def quantities(table: SteDatabase) -> FloatArray:
    """Return mean, peak-to-peak and harmonics (5, loads) at the loads of a table, m."""
    skew = float(table.misalignment[0])
    curves = [table.curve(force=float(force), misalignment=skew) for force in table.force]
    rows = [[one.mean, one.peak_to_peak, *one.harmonics[:HARMONICS]] for one in curves]
    return np.array([[quantity.value for quantity in row] for row in rows]).T


def _stored(case: PairCase, run: str, measure: Callable[[Path], Json]) -> Json:
    """Read a run, or make and store it."""
    request = {"pair": asdict(case.pair), "forces": case.forces, "options": dict(case.options), "run": run}
    key = content_hash(request, str(VERSION), 0)[:24]
    lines = FILE.read_text(encoding="utf-8").splitlines() if FILE.exists() else []
    for line in map(json.loads, lines):
        if line["key"] == key:
            return dict(line["found"])
    sys.stderr.write(f"  {case.name}: {run}\n")
    with tempfile.TemporaryDirectory() as folder:
        found = measure(Path(folder))
    FILE.parent.mkdir(parents=True, exist_ok=True)
    with FILE.open("a", encoding="utf-8") as file:
        file.write(json.dumps({"key": key, "case": case.name, "run": run, "found": found}) + "\n")
    return found
