"""``loa report``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from service.cli.output import check_writable, console, print_json
from service.problems import BadInput
from service.report import write_report


def run_report(files: Sequence[Path], output: Path, images: Path | None, *, as_json: bool) -> None:
    """Write the page, and the pictures if asked."""
    for file in files:
        if not file.is_file():
            raise BadInput.of("file", str(file), "an STE database or a run", "Check the path.")
    check_writable(output)
    written = write_report(list(files), output, images)
    if as_json:
        print_json({"file": str(output), "written": [str(path) for path in written]})
        return
    for path in written:
        console().print(f"written to {path}", highlight=False)
