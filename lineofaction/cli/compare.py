"""``loa compare``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from lineofaction.cli.output import check_writable, console, print_json
from lineofaction.report.comparison.compare import compare
from lineofaction.report.document.write import write_whole
from lineofaction.report.runs.run_view import RunView


def run_compare(
    files: Sequence[Path], output: Path, view: RunView, torque: float | None, *, as_json: bool
) -> None:
    """Write the page; print what differs and what is not shown to."""
    check_writable(output)
    page = compare(files, view, torque)
    write_whole(page, output)
    if as_json:
        found = {line.name: {"difference": line.value, "finding": line.remark} for line in page.headlines}
        print_json({"file": str(output), "differences": found})
        return
    for line in page.headlines:
        console().print(f"{line.name}: {line.value}: {line.remark}", highlight=False)
    console().print(f"written to {output}", highlight=False)
