"""A page as PDF: printed by the Chromium of this machine, without network."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from lineofaction.gearbox.problems import BadInput

_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome", "msedge")
_LIMIT_S = 120.0  # longest time that a browser may take
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
    ``CHROMIUM`` names one), it fails, or it takes over two minutes.
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
        try:
            call = [path, *_FLAGS, *sandbox, *arguments]
            subprocess.run(call, check=True, capture_output=True, timeout=_LIMIT_S)
            return printed.read_bytes()
        except (OSError, subprocess.SubprocessError) as error:
            bound = f"a page that {Path(path).name} prints: {type(error).__name__}"
            raise BadInput.of("output", str(named), bound, "Write an .html page and print that.") from None
