"""Verbs on accuracy and robustness that are not studies of the registry: plans, hard scenes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lineofaction.cli.guard import computing, guarded
from lineofaction.cli.verbs.options import AsJson
from lineofaction.cli.verbs.overrides import CaseFile, overridable

verbs = typer.Typer()


@verbs.command(epilog="Example: loa plan examples/palermo_spur_20_20.toml --time-budget-s 5")
@computing
@overridable("case")
def plan(
    case: CaseFile,
    time_budget_s: Annotated[
        float | None,
        typer.Option(help="Budget in CPU seconds to compare the plan with, besides the case's tolerance."),
    ] = None,
    json: AsJson = False,
) -> None:
    """Predict time by stage, memory and error of a case, with its effects; computes no contact."""
    from lineofaction.cli.plan import run_plan  # noqa: PLC0415 (start-up time)

    run_plan(case, time_budget_s, as_json=json)


@verbs.command(epilog="Example: loa hardcases --only table -o hardcases.html")
@guarded
def hardcases(
    only: Annotated[
        list[str] | None, typer.Option("--only", help="Names or families of scenes, separated by commas.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Report page to write (HTML).")
    ] = None,
    json: AsJson = False,
) -> None:
    """Run the hard scenes: cases known to break solvers, each checked against laws of physics."""
    from lineofaction.cli.hardcases import run_hardcases  # noqa: PLC0415 (start-up time)

    run_hardcases(only or [], output, as_json=json)
