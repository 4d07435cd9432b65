"""``loa report``."""

from __future__ import annotations

from pathlib import Path

from service.cli.output import check_writable, console, print_json
from service.problems import BadInput
from service.report import write_report


def run_report(file: Path, output: Path, *, as_json: bool) -> None:
    """Write the page."""
    if not file.is_file():
        raise BadInput.of("file", str(file), "an STE database or a run", "Check the path.")
    check_writable(output)
    write_report(file, output)
    if as_json:
        print_json({"file": str(output)})
    else:
        console().print(f"written to {output}", highlight=False)
