"""``loa hardcases``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import typer

from lineofaction.cli.output import check_writable, console, print_json, print_written, table
from lineofaction.gearbox.problems import EXIT_FAILED, BadInput
from lineofaction.gearbox.progress_bars import progress_bar
from lineofaction.hardcases import HARD_SCENES, HardScene, Outcome, run_scenes
from lineofaction.hardcases.page import hardcases_page
from lineofaction.report.document import write_page


def run_hardcases(only: Sequence[str], output: Path | None, *, as_json: bool) -> None:
    """Run the scenes, write the page, print."""
    scenes = _chosen_scenes(only)
    if output is not None:
        check_writable(output)
    outcomes: list[Outcome] = []
    with progress_bar() as report:
        for outcome in run_scenes(scenes):
            outcomes.append(outcome)
            report("hard scenes", len(outcomes) / len(scenes))
    if output is not None:
        write_page(hardcases_page(outcomes), output)
    if as_json:
        print_json({"scenes": [outcome.to_json() for outcome in outcomes]})
    else:
        _show(outcomes, output)
    if not all(outcome.passed for outcome in outcomes):
        raise typer.Exit(EXIT_FAILED)


def _chosen_scenes(only: Sequence[str]) -> list[HardScene]:
    """Return the scenes of these names or families, in their own order; all if none are named.

    Raises `BadInput`: no such scene.
    """
    names = [part.strip() for name in only for part in name.split(",") if part.strip()]
    known = {scene.name for scene in HARD_SCENES} | {scene.family for scene in HARD_SCENES}
    for name in names:
        if name not in known:
            raise BadInput.of("only", name, f"a scene or a family: {', '.join(sorted(known))}")
    return [scene for scene in HARD_SCENES if not names or {scene.name, scene.family} & set(names)]


def _show(outcomes: Sequence[Outcome], output: Path | None) -> None:
    out, rows = console(), []
    for outcome in outcomes:
        bounded = [figure for figure in outcome.figures if figure.use is not None]
        closest = str(max(bounded, key=lambda figure: figure.use or 0.0)) if bounded else ""
        cells = (outcome.scene.family, outcome.scene.name, "passed" if outcome.passed else "FAILED")
        rows.append((*cells, f"{outcome.seconds:.2f}", f"{outcome.cpu_seconds:.2f}", closest))
    text_columns = ("family", "scene", "figure closest to its bound")
    out.print(
        table((*text_columns[:2], "", "time, s", "CPU, s", text_columns[2]), rows, text_columns=text_columns)
    )
    for outcome in outcomes:
        if not outcome.passed:
            out.print(f"{outcome.scene.name}: {outcome.failure}")
    passed = sum(outcome.passed for outcome in outcomes)
    seconds = sum(outcome.seconds for outcome in outcomes)
    busy = sum(outcome.cpu_seconds for outcome in outcomes)
    out.print(f"{passed} of {len(outcomes)} scenes passed in {seconds:.1f} s ({busy:.1f} s of CPU time)")
    print_written([] if output is None else [output])
