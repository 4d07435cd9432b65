"""The page in motion: frames in software rendering, a slider to its picture, memory over minutes of both."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from playwright.sync_api import Browser, CDPSession, Page, sync_playwright

from benchmarks.figures import Figure
from benchmarks.service_process import running
from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.subjects import case_of

_EXAMPLES = Path(__file__).parents[1] / "examples"
_PAIR, _UNIT = _EXAMPLES / "helical_ev_23_67.toml", _EXAMPLES / "two_stage" / "two_stage.rexs"
FLAGS = (
    *("--headless", "--no-sandbox", "--disable-background-networking", "--no-first-run"),
    *("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
)
_SIZE = {"width": 1440, "height": 900}
_TARGET_MS = 60.0
_SETTLED_S, _WATCHED_S, _MOVES = 10.0, 30.0, 30
_MINUTES, _FIRST_MINUTES, _EVERY_S = 10.0, 1.0, 15.0
"""Of memory: watched, left out at the beginning; seconds between two samples."""
_PATIENCE_MS = 1_200_000
CANVAS = "canvas.view"

_MOVE = """async () => {
  const slider = document.getElementById("live-pinion-tip_relief_um");
  const [canvas, figures] = [document.querySelector("canvas.view"), document.getElementById("live-figures")];
  const at = Number(slider.value), [low, high] = [Number(slider.min), Number(slider.max)];
  if (at >= high - 1e-9) slider.dataset.way = "down";
  if (at <= low + 1e-9) slider.dataset.way = "up";
  const changed = (node, name) => new Promise((done) => {
    const watch = new MutationObserver(() => { watch.disconnect(); done(); });
    watch.observe(node, { attributes: true, attributeFilter: [name] });
  });
  const [pressed, answered] = [changed(canvas, "data-pressed"), changed(figures, "data-previews")];
  const begin = performance.now();
  if (slider.dataset.way === "down") slider.stepDown(); else slider.stepUp();
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  await pressed;
  await changed(canvas, "data-frames");
  const passed = performance.now() - begin;
  await answered;
  return [passed, 1000 * Number(figures.dataset.cpu)];
}"""
"""A step of the slider; ms until the frame with its pressure is drawn, and of CPU time of the answer."""


def figures() -> list[Figure]:
    """Return frame times of a pair and a unit, the wait for a slider's picture, and growths of memory."""
    path = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
    with (
        tempfile.TemporaryDirectory() as folder,
        sync_playwright() as playwright,
        running(Path(folder)) as (address, _, _),
    ):
        with LineOfActionClient(address, cache_dir=Path(folder) / "cache") as client:
            key = client.obtain("analyze", {"case": case_of(_PAIR).model_dump(mode="json")}).key
        browser = playwright.chromium.launch(executable_path=path, args=list(FLAGS))
        page = _opened(browser, f"{address}/#database={key}")
        found = [*_of_pair(browser, page)]
        page.locator("#import-file").set_input_files(_UNIT)
        page.get_by_text("click a mesh").wait_for()
        found.append(_frames(page, "two-stage unit"))
        browser.close()
    return found


def _opened(browser: Browser, address: str) -> Page:
    page = browser.new_page(viewport=_SIZE)  # type: ignore[arg-type]
    page.set_default_timeout(_PATIENCE_MS)
    page.goto(address)
    page.wait_for_selector("#live-figures[data-answers]", state="attached")
    page.wait_for_selector(f"{CANVAS}[data-pressed]:not([data-pressed='0'])")
    return page


def _of_pair(browser: Browser, page: Page) -> Iterator[Figure]:
    yield _frames(page, "helical pair 23/67")
    rolling = Memory(browser, page).growth(lambda: page.wait_for_timeout(1000.0))
    _roll(page, now=False)
    moves = [_moved(page) for _ in range(_MOVES)]
    picture, cpu = (median(column) for column in zip(*moves, strict=True))
    yield Figure("slider", "from its event to the frame with the pressure, median", picture, "ms")
    yield Figure("slider", "of that CPU time of the live worker, median", cpu, "ms CPU")
    sliding = Memory(browser, page).growth(lambda: page.evaluate(_MOVE))
    for what, growth in (("rolling", rolling), ("sliding", sliding)):
        for name, (slope, error) in growth.items():
            minutes = f"{_MINUTES:g} minutes of {what}"
            yield Figure(minutes, f"{name}, growth", slope, "MB/min")
            yield Figure(minutes, f"{name}, standard error of the growth", error, "MB/min")


def _moved(page: Page) -> list[float]:
    """Move the slider once, and let the whole answer come."""
    count = page.get_attribute("#live-figures", "data-answers")
    measured: list[float] = page.evaluate(_MOVE)
    page.wait_for_selector(f"#live-figures:not([data-answers='{count}'])", state="attached")
    return measured


def _count(page: Page) -> int:
    return int(page.get_attribute(CANVAS, "data-frames") or 0)


def _roll(page: Page, *, now: bool) -> None:
    """Start or stop the picture."""
    before = _count(page)
    page.wait_for_timeout(1000.0)
    if (_count(page) - before > 2) != now:
        page.locator(CANVAS).press(" ")


def _frames(page: Page, subject: str) -> Figure:
    """Let it roll until its resolution has settled, then count frames."""
    _roll(page, now=True)
    page.wait_for_timeout(1e3 * _SETTLED_S)
    begin, count = time.perf_counter(), _count(page)
    page.wait_for_timeout(1e3 * _WATCHED_S)
    took = 1e3 * (time.perf_counter() - begin) / max(_count(page) - count, 1)
    return Figure(subject, "a frame while it rolls, 1440 x 900, software rendering", took, "ms", _TARGET_MS)


class Memory:
    """Memory of a page: its heap after a collection, and that of all processes of the browser."""

    def __init__(self, browser: Browser, page: Page) -> None:
        self._whole: CDPSession = browser.new_browser_cdp_session()
        self._own: CDPSession = page.context.new_cdp_session(page)
        self._own.send("Performance.enable")

    def growth(self, step: Callable[[], Any]) -> dict[str, tuple[float, float]]:
        """Return slope and its standard error in MB/min by what grows, doing `step` again and again."""
        begin, samples = time.perf_counter(), []
        while (minutes := (time.perf_counter() - begin) / 60.0) < _MINUTES:
            if minutes >= _FIRST_MINUTES:
                samples.append((minutes, *self._sample()))
            end = time.perf_counter() + _EVERY_S
            while time.perf_counter() < end:
                step()
        time_min, heap, processes = np.array(samples).T
        names = "heap of scripts", "all processes of the browser"
        return {name: slope_of(time_min, size) for name, size in zip(names, (heap, processes), strict=True)}

    def _sample(self) -> tuple[float, float]:
        self._own.send("HeapProfiler.collectGarbage")
        metrics = self._own.send("Performance.getMetrics")["metrics"]
        heap = next(entry["value"] for entry in metrics if entry["name"] == "JSHeapUsedSize")
        pids = [entry["id"] for entry in self._whole.send("SystemInfo.getProcessInfo")["processInfo"]]
        return heap / 1e6, sum(map(_proportional_mb, pids))


def _proportional_mb(pid: int) -> float:
    """Return the proportional share of memory of a process, MB; 0 if it ended."""
    try:
        text = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii")
    except OSError:
        return 0.0
    found = re.search(r"^Pss:\s+(\d+)", text, re.MULTILINE)
    return 0.0 if found is None else int(found.group(1)) / 1024.0


def slope_of(time_min: Any, size: Any) -> tuple[float, float]:
    """Return the slope of a straight line through the samples, and its standard error."""
    (slope, start), rest = np.polyfit(time_min, size, 1), time_min - np.mean(time_min)
    left = size - slope * time_min - start
    return float(slope), float(np.sqrt(np.sum(left**2) / (len(size) - 2) / np.sum(rest**2)))
