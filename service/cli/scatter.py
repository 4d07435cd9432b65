"""``loa scatter``: tolerance Monte Carlo of a case."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from fe_contact.microgeometry import ToleranceStudy
from service.cli.assessed_case import assessed_case
from service.cli.output import check_writable, console, print_json, progress_bar, table
from service.cli.warned import messages, warnings_so_far
from service.convert.scatter import Sampling, scatter_json, scatter_of_case
from service.convert.stamp import stamp
from service.convert.task_workers import ExecutorChoice, open_executor
from service.directories import cache_home
from service.problems import BadInput
from service.report.image import png
from service.report.scatter import influence_table, quantile_table, scatter_figure, scatter_page
from service.report.write import write_whole


@dataclass(frozen=True)
class Wanted:
    """What is sampled, and by whom."""

    sampling: Sampling
    executor: ExecutorChoice


def run_scatter(case: Path, output: Path | None, wanted: Wanted, *, as_json: bool) -> None:
    """Sample, write, print."""
    given = assessed_case(case)
    if output is not None:
        if output.suffix not in _WRITERS:
            endings = ", ".join(_WRITERS)
            raise BadInput.of("output", str(output), f"a file ending in one of {endings}")
        check_writable(output)
    with open_executor(wanted.executor) as workers, progress_bar() as report:
        found = scatter_of_case(given, wanted.sampling, cache_home() / "compliance", report, workers)
    if output is not None:
        _WRITERS[output.suffix](found, output)
        stamp(output, warnings_so_far())
    if as_json:
        print_json({"written": None if output is None else str(output), **scatter_json(found)})
    else:
        _show(found, output)


def _json(found: ToleranceStudy, target: Path) -> None:
    """JSON, every sample included."""
    target.write_text(f"{json.dumps(scatter_json(found), allow_nan=False, indent=1)}\n", encoding="utf-8")


_WRITERS: dict[str, Callable[[ToleranceStudy, Path], object]] = {
    ".png": lambda found, target: target.write_bytes(png(scatter_figure(found))),
    ".html": lambda found, target: write_whole(scatter_page(found), target, warnings=messages()),
    ".json": _json,
}


def _show(found: ToleranceStudy, output: Path | None) -> None:
    """Print the tables for people."""
    out = console()
    for rows in (quantile_table(found), influence_table(found)):
        out.print(table(rows.head, rows.rows, rows.caption))
    if output is not None:
        out.print(f"written to {output}", highlight=False)
