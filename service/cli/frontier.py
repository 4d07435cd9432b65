"""``loa frontier``: of a case or of a scene."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from service.cli.output import Report, console, output_files, print_json, progress_bar, table
from service.cli.warned import messages, warnings_so_far
from service.convert.stamp import stamp
from service.problems import BadInput
from service.report.figure import Figure, Table
from service.report.image import png
from service.report.page import Page
from service.report.write import write_whole
from service.schemas import read_table

_TITLE = "What accuracy costs in time"


@dataclass(frozen=True)
class _Climbed:
    """A ladder as it is written and printed."""

    facts: dict[str, Any]
    left_out: dict[str, str]
    table: Table
    figure: Figure
    page: Page


def run_frontier(
    file: Path, output: Path | None, rungs: str | None, full_contact: int | None, *, as_json: bool
) -> None:
    """Climb the ladder, write, print."""
    content = read_table(file)
    targets = [] if output is None else output_files(output, "frontier", tuple(_WRITERS))
    names = None if rungs is None else _named(rungs, of_scene="shafts" in content)
    with progress_bar() as report:
        if "shafts" in content:
            found = _of_scene(file, names, full_contact, report)
        else:
            found = _of_case(file, names, full_contact, report)
    for target in targets:
        target.parent.mkdir(exist_ok=True)
        _WRITERS[target.suffix](found, target)
        stamp(target, warnings_so_far())
    if as_json:
        print_json({"written": [str(target) for target in targets], **found.facts})
    else:
        _show(found, targets)


def _named(rungs: str, *, of_scene: bool) -> list[str]:
    """Split the names of rungs; raises `BadInput`."""
    from service.convert.rungs import rungs_asked  # noqa: PLC0415 (start-up time)

    return rungs_asked([name.strip() for name in rungs.split(",")], of_scene=of_scene)


def _of_case(file: Path, names: list[str] | None, full_contact: int | None, report: Report) -> _Climbed:
    """Climb the ladder of transmission errors."""
    from service.cli.assessed_case import assessed_case  # noqa: PLC0415 (start-up time)
    from service.convert.frontier import frontier_of  # noqa: PLC0415
    from service.report.frontier import frontier_figure, frontier_page, frontier_table  # noqa: PLC0415

    found = frontier_of(assessed_case(file), names, report, full_contact=full_contact)
    page = frontier_page(found, _TITLE)
    return _Climbed(found.to_json(), found.left_out, frontier_table(found), frontier_figure(found), page)


def _of_scene(file: Path, names: list[str] | None, full_contact: int | None, report: Report) -> _Climbed:
    """Climb the ladder of dynamics."""
    if full_contact is not None:
        raise BadInput.of("--full-contact", full_contact, "left out for a scene", "Give it with a case.")
    from service.cli.scene_tables import scene_with_tables  # noqa: PLC0415 (start-up time)
    from service.client.portable import scene_of  # noqa: PLC0415
    from service.convert.run_frontier import run_frontier_of  # noqa: PLC0415
    from service.report.run_frontier import (  # noqa: PLC0415
        run_frontier_figure,
        run_frontier_page,
        run_frontier_table,
    )

    scene = scene_with_tables(*scene_of(file), None, report)
    found = run_frontier_of(scene, names, report)
    figure, page = run_frontier_figure(found), run_frontier_page(found, _TITLE)
    return _Climbed(found.to_json(), found.left_out, run_frontier_table(found), figure, page)


def _picture(found: _Climbed, target: Path) -> None:
    """PNG."""
    target.write_bytes(png(found.figure))


def _page(found: _Climbed, target: Path) -> None:
    """Write the report page."""
    write_whole(found.page, target, warnings=messages())


def _json(found: _Climbed, target: Path) -> None:
    """JSON."""
    target.write_text(f"{json.dumps(found.facts, allow_nan=False, indent=1)}\n", encoding="utf-8")


_WRITERS: dict[str, Callable[[_Climbed, Path], None]] = {".png": _picture, ".html": _page, ".json": _json}


def _show(found: _Climbed, targets: list[Path]) -> None:
    """Print the table for people."""
    out = console()
    out.print(table(found.table.head, found.table.rows, found.table.caption))
    for name, reason in found.left_out.items():
        out.print(f"not run: {name}: {reason}", highlight=False)
    for target in targets:
        out.print(f"written to {target}", highlight=False)
