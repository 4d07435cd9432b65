"""``loa frontier``."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from fe_contact.analysis.frontier import Frontier
from service.cli.output import check_writable, console, print_json, progress_bar, table
from service.convert.frontier import frontier_of
from service.problems import BadInput
from service.report.frontier import frontier_figure, frontier_page, frontier_table
from service.report.image import png
from service.report.write import write_whole
from service.schemas import Case, read_model


def run_frontier(file: Path, output: Path | None, rungs: str | None, *, as_json: bool) -> None:
    """Climb the ladder, write, print."""
    case = read_model(Case, file)
    targets = [] if output is None else _targets(output)
    names = None if rungs is None else [name.strip() for name in rungs.split(",")]
    with progress_bar() as report:
        found = frontier_of(case, names, report)
    for target in targets:
        target.parent.mkdir(exist_ok=True)
        _WRITERS[target.suffix](found, target)
    if as_json:
        print_json({"written": [str(target) for target in targets], **found.to_json()})
    else:
        _show(found, targets)


def _targets(output: Path) -> list[Path]:
    """Files to write: one by its ending, or all kinds in a folder, which is made if missing.

    Raises
    ------
    BadInput
        Neither, or not writable.
    """
    endings = ", ".join(_WRITERS)
    if output.suffix and not output.is_dir():
        if output.suffix not in _WRITERS:
            raise BadInput.of("output", str(output), f"a folder, or a file ending in one of {endings}")
        check_writable(output)
        return [output]
    if output.is_file():
        raise BadInput.of("output", str(output), f"a folder, or a file ending in one of {endings}")
    check_writable(output / "x" if output.is_dir() else output)
    return [output / f"frontier{ending}" for ending in _WRITERS]


def _picture(found: Frontier, target: Path) -> None:
    """PNG."""
    target.write_bytes(png(frontier_figure(found)))


def _page(found: Frontier, target: Path) -> None:
    """Write the report page."""
    write_whole(frontier_page(found, "What accuracy costs in time"), target)


def _json(found: Frontier, target: Path) -> None:
    """JSON."""
    target.write_text(f"{json.dumps(found.to_json(), allow_nan=False, indent=1)}\n", encoding="utf-8")


_WRITERS: dict[str, Callable[[Frontier, Path], None]] = {".png": _picture, ".html": _page, ".json": _json}


def _show(found: Frontier, targets: list[Path]) -> None:
    """Print the table for people."""
    out = console()
    rows = frontier_table(found)
    out.print(table(rows.head, rows.rows, rows.caption))
    for name, reason in found.left_out.items():
        out.print(f"not run: {name}: {reason}", highlight=False)
    for target in targets:
        out.print(f"written to {target}", highlight=False)
