"""A table of ten alignments by one process and by two, and the prediction of a scaling model for more."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.figures import Figure
from fe_contact import FlankModification, Gear, GearPair, analyze
from model_studies.workers import ByExecutor, InProcess, Workers
from model_studies.workers.run_cost import RunCost

SUBJECT = "a helical table of 10 alignments, gears in the cache"
TARGET = 0.6
"""Wall time of two processes over that of one."""
TURNS = 3
CLUSTERS = (8, 64, 512)
_TORQUES = np.array([800.0, 3000.0, 5500.0])
_MISALIGNMENTS = np.linspace(-45e-6, 45e-6, 10)


@dataclass(frozen=True)
class Recording:
    """Workers, and the CPU seconds of every task of theirs, run by run."""

    workers: Workers
    runs: list[list[float]] = field(default_factory=list)

    @property
    def cost(self) -> RunCost:
        """Cost of the workers."""
        return self.workers.cost

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        """Start the tasks of the workers, and yield their results."""
        seconds: list[float] = []
        self.runs.append(seconds)
        return self._recorded(self.workers.run(function, shared, items), seconds)

    def _recorded(self, results: Iterator[Any], seconds: list[float]) -> Iterator[Any]:
        """Yield results, and note what each cost."""
        while True:
            before = self.cost.cpu_seconds
            try:
                result = next(results)
            except StopIteration:
                return
            seconds.append(self.cost.cpu_seconds - before)
            yield result


@dataclass(frozen=True)
class Share:
    """Shares of the cost of one table by process."""

    wall: float
    caller: float
    """`wall`, `caller`: Wall seconds, and CPU seconds of the caller."""
    runs: list[list[float]]
    """CPU seconds of the tasks."""

    @property
    def tasks(self) -> float:
        """CPU seconds of all tasks."""
        return sum(map(sum, self.runs))

    def predicted(self, workers: int) -> float:
        """Wall seconds with a number of workers: the caller, and run by run the worker that ends last."""
        return self.caller + sum(_longest(run, workers) for run in self.runs)


def figures() -> list[Figure]:
    """Return walls by turns, CPU seconds, and the prediction of the model."""
    with tempfile.TemporaryDirectory() as folder:
        cache = Path(folder)
        _table(cache, InProcess())
        with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as executor:
            pool = ByExecutor(executor)
            _table(cache, pool)
            turns = [(_table(cache, InProcess()), _table(cache, pool)) for _ in range(TURNS)]
    alone = median(one.wall for one, _ in turns)
    ratio = median(two.wall / one.wall for one, two in turns)
    shared = turns[-1][1]
    spent = median((two.caller + two.tasks) / one.caller for one, two in turns)
    return [
        Figure(SUBJECT, "one process", alone, "s"),
        Figure(SUBJECT, "two processes, part of that", ratio, "-", TARGET),
        Figure(SUBJECT, "the model's part for two", shared.predicted(2) / alone, "-"),
        Figure(SUBJECT, "CPU time of two processes over that of one", spent, "-"),
        Figure(SUBJECT, "CPU time that stays with the caller", shared.caller, "CPU s"),
        Figure(SUBJECT, "CPU time of the tasks", shared.tasks, "CPU s"),
        Figure(SUBJECT, "tasks", float(sum(map(len, shared.runs))), "-"),
        Figure(SUBJECT, "longest task", max(map(max, shared.runs)), "CPU s"),
        *(
            Figure(SUBJECT, f"the model's part for {n} workers", shared.predicted(n) / alone, "-")
            for n in CLUSTERS
        ),
    ]


def _table(cache: Path, workers: Workers) -> Share:
    """Compute the table, and return its cost."""
    recording = workers if isinstance(workers, InProcess) else Recording(workers)
    began, cpu = time.perf_counter(), time.process_time()
    analyze(_pair(), torques=_TORQUES, misalignments=_MISALIGNMENTS, cache=cache, workers=recording)
    runs = recording.runs if isinstance(recording, Recording) else []
    return Share(time.perf_counter() - began, time.process_time() - cpu, runs)


def _longest(tasks: Sequence[float], workers: int) -> float:
    """Seconds until tasks are done that are taken in their order by whoever is free."""
    busy = np.zeros(workers)
    for seconds in tasks:
        busy[np.argmin(busy)] += seconds
    return float(busy.max())


def _pair() -> GearPair:
    """Return a relieved high-speed stage."""
    helix = math.radians(14.0)
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=3e-3)
    driving = _gear(97, helix, 120e-3, relief)
    driven = _gear(23, -helix, 50e-3, FlankModification())
    return GearPair(driving, driven, 0.5 * 120 * 4e-3 / math.cos(helix))


def _gear(teeth: int, helix: float, bore: float, modification: FlankModification) -> Gear:
    """Return one gear."""
    return Gear(
        teeth=teeth,
        normal_module=4e-3,
        face_width=70e-3,
        bore_diameter=bore,
        helix_angle=helix,
        modification=modification,
    )
