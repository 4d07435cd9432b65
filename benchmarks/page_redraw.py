"""Sliders of the page: from the input event to the drawn plot in Chromium, and the service in between."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median

from playwright.sync_api import Page, sync_playwright

from benchmarks.figures import Figure

CASES = {
    "palermo_spur_20_20": "live flanks, spur 20/20 in the plane",
    "helical_automotive": "live flanks, helical 39/40 in 31 slices",
}
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run")
_MOVES = 30
_TARGET_MS = 200.0
_PATIENCE_MS = 1_200_000


def figures() -> list[Figure]:
    """Return medians over the moves of a slider, for a pair in the plane and one in three dimensions."""
    browser = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
    with _service() as address, sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=browser, args=list(FLAGS))
        found = [figure for name in CASES for figure in _measured(chromium.new_page(), address, name)]
        chromium.close()
    return found


@contextmanager
def _service() -> Iterator[str]:
    """Serve an empty directory on a free port."""
    with tempfile.TemporaryDirectory() as folder:
        command = [
            sys.executable,
            "-m",
            "lineofaction.cli",
            "serve",
            "--port",
            "0",
            "--data-directory",
            folder,
        ]
        log = (Path(folder) / "service.log").open("wb")
        with log, subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True) as service:
            assert service.stdout is not None
            yield service.stdout.readline().split()[-1]
            service.terminate()


def _measured(page: Page, address: str, name: str) -> list[Figure]:
    """Analyze an example, then move its slider of tip relief step by step."""
    page.set_default_timeout(_PATIENCE_MS)
    page.goto(address)
    page.wait_for_selector("html[data-ready=yes]")
    page.select_option("#example", name)
    page.wait_for_selector("#plan dl")
    page.click("#analyze")
    page.wait_for_selector("#live-figures[data-answers]")
    slider = page.locator("#live-pinion-tip_relief_um")
    slider.focus()
    moves = []
    for _ in range(_MOVES):
        count = page.get_attribute("#live-figures", "data-previews")
        slider.press("ArrowRight")
        page.wait_for_selector(f"#live-figures:not([data-previews='{count}'])")
        moves.append([float(page.get_attribute("#live-figures", f"data-{x}") or 0.0) for x in _NOTED])
    answered, drawn, cpu = (median(column) for column in zip(*moves, strict=True))
    page.close()
    return [
        Figure(CASES[name], "round trip of a question, median", answered, "ms", _TARGET_MS),
        Figure(CASES[name], "from the slider to the drawn plots, median", drawn, "ms"),
        Figure(CASES[name], "of that work of the live worker", 1e3 * cpu, "ms CPU"),
    ]


_NOTED = ("answered", "milliseconds", "cpu")
