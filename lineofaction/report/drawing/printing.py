"""A page as PDF: printed by the Chromium of this machine, without network."""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from host import family_cpu_seconds
from lineofaction.gearbox.problems import BadInput

_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
_CPU_LIMIT_S = 120.0  # most CPU time that a browser may take, its processes included
_STANDSTILL_S, _PROGRESS_S = 60.0, 0.2
"""Time in which a browser must use some CPU time, and how much. While it does it is printing, however slowly
on a loaded machine."""
_WAIT_S = 600.0  # longest time of a browser on a system that does not tell the CPU time of its processes
_LOOK_S = 0.05  # time between two looks at the browser
_FLAGS = (
    "--headless", "--disable-gpu", "--no-pdf-header-footer", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--no-first-run", "--disable-extensions",
)  # fmt: skip


def browser() -> str | None:
    """Return the path of a browser that prints; None: there is none, nor does ``CHROMIUM`` name one."""
    paths = (shutil.which(name) for name in (os.environ.get("CHROMIUM", ""), *_BROWSERS))
    return next((path for path in paths if path), None)


def pdf(page: str, named: Path) -> bytes:
    """Return a page of HTML as PDF, A4 with page numbers.

    `named` is the requested file, which a refusal names. Raises `BadInput`: there is no browser (the variable
    ``CHROMIUM`` names one), it fails, it takes over two minutes of CPU time, or it stands still.
    """
    path = browser()
    if path is None:
        remedy = "Install Chromium or Chrome, name one in CHROMIUM, or write an .html page and print that."
        raise BadInput.of("output", str(named), "a page where no browser is installed", remedy)
    # a browser of the superuser has no sandbox; what it opens here is our own page
    sandbox = ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    with TemporaryDirectory() as folder:
        source, printed = Path(folder) / "page.html", Path(folder) / "page.pdf"
        source.write_text(page, encoding="utf-8")
        arguments = [f"--user-data-dir={folder}/profile", f"--print-to-pdf={printed}", source.as_uri()]
        call = [path, *_FLAGS, *sandbox, *arguments]
        try:
            reason = _run(call)
            if not reason:
                return printed.read_bytes()
        except OSError as error:
            reason = f": {type(error).__name__}"
        bound = f"a page that {Path(path).name} prints{reason}"
        raise BadInput.of("output", str(named), bound, "Write an .html page and print that.")


def _run(call: Sequence[str]) -> str:
    """Run a browser to its end; return why a page is none that it prints, "" if it has printed."""
    with subprocess.Popen(call, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            reason = _awaited(process)
        finally:
            process.kill()
    return reason


def _awaited(process: subprocess.Popen[bytes]) -> str:
    """Wait for the end of a browser, or for its limits; return the reason as `_run`."""
    began = moved = time.monotonic()
    noted = 0.0  # CPU time at `moved`
    while True:
        try:
            code = process.wait(_LOOK_S)
            return f": it ended with exit code {code}" if code else ""
        except subprocess.TimeoutExpired:
            instant, spent = time.monotonic(), family_cpu_seconds(process.pid)
        if spent is None:
            if instant > began + _WAIT_S:
                return f" within {_WAIT_S:g} s"
        elif spent > _CPU_LIMIT_S:
            return f" within {_CPU_LIMIT_S:g} s of CPU time"
        elif abs(spent - noted) >= _PROGRESS_S:  # less: one of its processes has ended unseen
            noted, moved = spent, instant
        elif instant > moved + _STANDSTILL_S:
            return f": it stood still for {_STANDSTILL_S:g} s"
