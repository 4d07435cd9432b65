"""``loa ablate``."""

from __future__ import annotations

import json
from pathlib import Path

from dynamics.ablation import Ablation as SceneAblation
from fe_contact.analysis.ablation import Ablation
from service.cli.assessed_case import assessed_case
from service.cli.output import Report, check_writable, console, print_json, progress_bar, table
from service.cli.scene_tables import scene_with_tables
from service.cli.warned import messages, warnings_so_far
from service.client.portable import scene_of
from service.convert.ablation import ablation_json, ablation_of_case, ablation_of_scene
from service.convert.stamp import stamp
from service.directories import cache_home
from service.problems import BadInput
from service.report.ablation import (
    case_ablation_figure,
    case_ablation_table,
    scene_ablation_figure,
    scene_ablation_table,
)
from service.report.ablation_page import ablation_page
from service.report.image import png
from service.report.write import write_whole
from service.schemas import read_table


def run_ablate(file: Path, output: Path | None, only: str | None, *, as_json: bool) -> None:
    """Toggle the effects of a case or a scene, write, print."""
    if output is not None:
        if output.suffix not in (".png", ".json", ".html"):
            raise BadInput.of("output", str(output), "a file ending in .png, .json or .html")
        check_writable(output)
    names = None if only is None else [name.strip() for name in only.split(",")]
    with progress_bar() as report:
        found = _found(file, names, report)
    if output is not None:
        _write(found, output)
    if as_json:
        print_json({"written": None if output is None else str(output), **ablation_json(found)})
    else:
        _show(found, output)


def _found(file: Path, only: list[str] | None, report: Report) -> Ablation | SceneAblation:
    """Tell a scene from a case by its meshes."""
    if "meshes" in read_table(file):
        scene, folder = scene_of(file)
        return ablation_of_scene(scene_with_tables(scene, folder, None, report), only, report)
    return ablation_of_case(assessed_case(file), only, cache_home() / "compliance", report)


def _write(found: Ablation | SceneAblation, output: Path) -> None:
    """PNG, JSON or the report page."""
    if output.suffix == ".json":
        text = json.dumps(ablation_json(found), allow_nan=False, indent=1)
        output.write_text(f"{text}\n", encoding="utf-8")
        stamp(output, warnings_so_far())
        return
    if output.suffix == ".html":
        write_whole(ablation_page(found), output, warnings=messages())
        return
    figure = case_ablation_figure(found) if isinstance(found, Ablation) else scene_ablation_figure(found)
    output.write_bytes(png(figure))


def _show(found: Ablation | SceneAblation, output: Path | None) -> None:
    """Print the table for people."""
    out = console()
    rows = case_ablation_table(found) if isinstance(found, Ablation) else scene_ablation_table(found)
    out.print(table(rows.head, rows.rows, rows.caption))
    for name, reason in found.left_out.items():
        out.print(f"not switched: {name}: {reason}", highlight=False)
    if output is not None:
        out.print(f"written to {output}", highlight=False)
