"""Does a looser tolerance cost less, and is the cost predicted? Drawn pairs at 1 and 0.3 %, by turns.

All runs are of one process that has compiled its loops, with nothing condensed in the cache; the log of runs
fills as a user's does. Of each pair one tolerance comes first, of the next the other.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from statistics import median
from typing import Any, NamedTuple

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

SEED, PAIRS = 83, 10
LOOSE, TIGHT = 0.01, 0.003
_CODE = """
import tempfile
from pathlib import Path
from benchmarks.drawn_pairs import drawn_pairs
from fe_contact import analyze
from fe_contact.analysis.studies.frontier import warm_up

def run(case, tolerance, folder):
    table = analyze(case.pair, normal_forces=case.forces, tolerance=tolerance, cache=folder, **case.options)
    receipt = table.metadata.receipt
    for file in folder.glob("compliance-*"):
        file.unlink()
    stages = {name: each["cpu_seconds"] for name, each in receipt["stages"].items()}
    return {
        "name": case.name, "tolerance": tolerance, "seconds": receipt["cpu_seconds"], "stages": stages,
        "predicted": receipt["prediction"]["stages"], "positions": int(table.position.size),
        "expected_positions": receipt["prediction"]["positions"], "passes": receipt.get("passes", []),
    }

warm_up(across_face=True)
found = []
with tempfile.TemporaryDirectory() as name:
    # the first pair compiles what the warm-up does not, and is no part of the figures
    for i, case in enumerate([*drawn_pairs(SEED + 1, 2), *drawn_pairs(SEED, PAIRS)]):
        for tolerance in TOLERANCES[:: 1 if i % 2 else -1]:
            result = run(case, tolerance, Path(name))
            if i >= 2:
                found.append(result)
measured = {"found": found}
"""


class ToleratedRun(NamedTuple):
    """Cost of one run in CPU seconds, and what was predicted of its stages."""

    name: str
    tolerance: float
    seconds: float
    predicted: float
    measured: float

    @property
    def off(self) -> float:
        """Predicted over measured time of the predicted stages, less one."""
        return self.predicted / self.measured - 1.0


def figures() -> list[Figure]:
    """Return how often a looser tolerance is dearer, and how far predictions are off."""
    return counts(runs())


def counts(found: Sequence[ToleratedRun]) -> list[Figure]:
    """Return the figures of runs, both of each pair side by side."""
    by_pair: dict[str, dict[float, float]] = {}
    for run in found:
        by_pair.setdefault(run.name, {})[run.tolerance] = run.seconds
    dearer = [pair[LOOSE] / pair[TIGHT] for pair in by_pair.values()]
    above = sum(each > 1.0 for each in dearer)
    beyond = [abs(run.off) > 0.3 for run in found]
    subject = f"{100 * LOOSE:g} % against {100 * TIGHT:g} %, {len(by_pair)} drawn pairs"
    return [
        Figure(subject, "pairs for which the looser costs more", above, "-", 0.0),
        Figure(subject, "cost of the looser over the other, median", median(dearer), "-"),
        Figure(subject, "the same, at most", max(dearer), "-", 1.05),
        Figure(subject, "predictions off by more than 30 %", 100.0 * sum(beyond) / len(beyond), "%", 10.0),
    ]


def runs(seed: int = SEED, pairs: int = PAIRS) -> list[ToleratedRun]:
    """Run every pair at both tolerances."""
    head = f"SEED, PAIRS, TOLERANCES = {seed}, {pairs}, ({TIGHT}, {LOOSE})\n"
    found: list[dict[str, Any]] = measure(head + _CODE)["found"]
    for run in found:
        sys.stderr.write(f"{run}\n")
    return [
        ToleratedRun(
            run["name"],
            run["tolerance"],
            run["seconds"],
            sum(run["predicted"].values()),
            sum(run["stages"].get(stage, 0.0) for stage in run["predicted"]),
        )
        for run in found
    ]
