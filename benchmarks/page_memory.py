"""Memory of the page over minutes in which its picture rolls and a slider moves without rest."""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.bare_browser import BareBrowser, bare_browser
from benchmarks.figures import Figure
from benchmarks.page_motion import FLAGS, MOVE, PAIR, SIZE
from benchmarks.service_process import running
from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.subjects import case_of

_WARM_MIN, _WATCHED_MIN, _EVERY_S = 3.0, 10.0, 15.0
"""Left out until its code is compiled, watched after; seconds between two samples."""
SHOWN = """() => new Promise((done) => {
  const seen = () => (document.querySelector("#live-figures[data-answers]") ? done() : setTimeout(seen, 200));
  seen();
})"""


def figures() -> list[Figure]:
    """Return what the heap of scripts and all processes of the browser grow by, and the moves meanwhile."""
    path = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome") or ""
    with (
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder,
        running(Path(folder)) as (address, _, _),
        bare_browser(path, FLAGS, Path(folder) / "profile") as browser,
    ):
        with LineOfActionClient(address, cache_dir=Path(folder) / "cache") as client:
            key = client.obtain("analyze", {"case": case_of(PAIR).model_dump(mode="json")}).key
        browser.open(f"{address}/#database={key}", SIZE)
        browser.evaluate(SHOWN)
        return list(_of_moves(browser))


def _of_moves(browser: BareBrowser) -> list[Figure]:
    steps = 0

    def step() -> None:
        nonlocal steps
        browser.evaluate(MOVE)
        steps += 1

    watched(browser, step, _WARM_MIN)
    steps = 0
    time_min, heap, processes = np.array(watched(browser, step, _WATCHED_MIN)).T
    what = f"{_WATCHED_MIN:g} minutes of rolling and sliding"
    found = [Figure(what, "moves of the slider", float(steps), "-")]
    for name, size in (("heap of scripts", heap), ("all processes of the browser", processes)):
        slope, error = slope_of(time_min, size)
        found.append(Figure(what, f"{name}, growth", slope, "MB/min"))
        found.append(Figure(what, f"{name}, standard error of the growth", error, "MB/min"))
    return found


def watched(
    browser: BareBrowser, step: Callable[[], None], minutes: float
) -> list[tuple[float, float, float]]:
    """Return samples (minutes, heap, all processes in MB) while `step` is done again and again."""
    begin, samples = time.perf_counter(), []
    while (passed := (time.perf_counter() - begin) / 60.0) < minutes:
        samples.append((passed, *browser.memory_mb()))
        end = time.perf_counter() + _EVERY_S
        while time.perf_counter() < end:
            step()
    return samples


def slope_of(time_min: Any, size: Any) -> tuple[float, float]:
    """Return the slope of a straight line through the samples, and its standard error."""
    (slope, start), rest = np.polyfit(time_min, size, 1), time_min - np.mean(time_min)
    left = size - slope * time_min - start
    return float(slope), float(np.sqrt(np.sum(left**2) / (len(size) - 2) / np.sum(rest**2)))
