"""The page in motion: frames in software rendering, a slider to its picture."""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median

from playwright.sync_api import Browser, Page, sync_playwright

from benchmarks.figures import Figure
from benchmarks.service_process import running
from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.subjects import case_of

_EXAMPLES = Path(__file__).parents[1] / "examples"
PAIR, _UNIT = _EXAMPLES / "helical_ev_23_67.toml", _EXAMPLES / "two_stage" / "two_stage.rexs"
FLAGS = (
    *("--headless", "--no-sandbox", "--disable-background-networking", "--no-first-run"),
    *("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
)
SIZE = {"width": 1440, "height": 900}
_TARGET_MS = 60.0
_SETTLED_S, _WATCHED_S, _MOVES = 10.0, 30.0, 30
_PATIENCE_MS = 1_200_000
CANVAS = "canvas.view"

MOVE = """async () => {
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
    """Return frame times of a pair and a unit, and the wait for a slider's picture."""
    path = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
    with (
        tempfile.TemporaryDirectory() as folder,
        sync_playwright() as playwright,
        running(Path(folder)) as (address, _, _),
    ):
        with LineOfActionClient(address, cache_dir=Path(folder) / "cache") as client:
            key = client.obtain("analyze", {"case": case_of(PAIR).model_dump(mode="json")}).key
        browser = playwright.chromium.launch(executable_path=path, args=list(FLAGS))
        page = _opened(browser, f"{address}/#database={key}")
        found = [*_of_pair(page)]
        page.locator("#import-file").set_input_files(_UNIT)
        page.get_by_text("click a mesh").wait_for()
        found.append(_frames(page, "two-stage unit"))
        browser.close()
    return found


def _opened(browser: Browser, address: str) -> Page:
    page = browser.new_page(viewport=SIZE)  # type: ignore[arg-type]
    page.set_default_timeout(_PATIENCE_MS)
    page.goto(address)
    page.wait_for_selector("#live-figures[data-answers]", state="attached")
    page.wait_for_selector(f"{CANVAS}[data-pressed]:not([data-pressed='0'])")
    return page


def _of_pair(page: Page) -> Iterator[Figure]:
    yield _frames(page, "helical pair 23/67")
    _roll(page, now=False)
    moves = [_moved(page) for _ in range(_MOVES)]
    picture, cpu = (median(column) for column in zip(*moves, strict=True))
    yield Figure("slider", "from its event to the frame with the pressure, median", picture, "ms")
    yield Figure("slider", "of that CPU time of the live worker, median", cpu, "ms CPU")


def _moved(page: Page) -> list[float]:
    """Move the slider once, and let the whole answer come."""
    count = page.get_attribute("#live-figures", "data-answers")
    measured: list[float] = page.evaluate(MOVE)
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
