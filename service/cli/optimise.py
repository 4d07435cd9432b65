"""``loa optimise``."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from fe_contact.microgeometry import Optimization
from service.cli.assessed_case import assessed_case
from service.cli.interrupt import until_interrupted
from service.cli.output import console, output_files, print_json, progress_bar, table
from service.cli.warned import messages, warnings_so_far
from service.convert.optimisation import boundary_values, optimisation_json, optimisation_of
from service.convert.stamp import stamp
from service.convert.task_workers import ExecutorChoice, open_executor
from service.directories import cache_home
from service.report.image import png
from service.report.optimisation import (
    harris_figure,
    optimisation_page,
    optimum_table,
    ripple_table,
)
from service.report.write import write_whole
from service.schemas import read_model
from service.schemas.optimisation import OptimisationInput


def run_optimise(
    case: Path, study: Path, output: Path | None, executor: ExecutorChoice, *, as_json: bool
) -> None:
    """Optimise, write, print."""
    given, wanted = assessed_case(case), read_model(OptimisationInput, study)
    targets = [] if output is None else output_files(output, "optimum", tuple(_WRITERS))
    with open_executor(executor) as workers, progress_bar() as report, until_interrupted() as cancel:
        home = cache_home()
        kept = home / "compliance", report, workers, cancel, home / "searches"
        found = optimisation_of(given, wanted, *kept)
        interrupted = cancel()
    for target in targets:
        target.parent.mkdir(exist_ok=True)
        _WRITERS[target.suffix](found, target)
        stamp(target, warnings_so_far())
    if as_json:
        print_json({"written": [str(target) for target in targets], **optimisation_json(found)})
    else:
        _show(found, targets)
    if interrupted:
        raise KeyboardInterrupt("interrupted. The design above is the best of those searched so far.")


def _picture(found: Optimization, target: Path) -> None:
    """PNG."""
    target.write_bytes(png(harris_figure(found)))


def _page(found: Optimization, target: Path) -> None:
    """Write the report page."""
    write_whole(optimisation_page(found), target, warnings=messages())


def _json(found: Optimization, target: Path) -> None:
    """JSON."""
    text = json.dumps(optimisation_json(found), allow_nan=False, indent=1)
    target.write_text(f"{text}\n", encoding="utf-8")


def _values(found: Optimization, target: Path) -> None:
    """TOML of the best design: lines for the tables of both gears in the case file."""
    lines = [f"# {found.reason}"]
    for gear, fields in boundary_values(found.optimum.values).items():
        lines += ["", f"[pair.{gear}]", *(f"{name} = {value:.6g}" for name, value in fields.items())]
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


_WRITERS: dict[str, Callable[[Optimization, Path], None]] = {
    ".png": _picture,
    ".html": _page,
    ".json": _json,
    ".toml": _values,
}


def _show(found: Optimization, targets: list[Path]) -> None:
    """Print the tables for people."""
    out = console()
    for rows in (optimum_table(found), ripple_table(found)):
        out.print(table(rows.head, rows.rows, rows.caption))
    for line in found.not_tried:
        out.print(f"not tried: {line}", highlight=False)
    search = f"{found.evaluations} designs in {found.cost['stages']['search']['cpu_seconds']:.3g} CPU s"
    out.print(f"{found.outcome.replace('_', ' ')}: {found.reason}; {search}", highlight=False)
    for target in targets:
        out.print(f"written to {target}", highlight=False)
