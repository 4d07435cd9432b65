"""``loa validate``."""

from __future__ import annotations

import contextlib
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import typer

from lineofaction.cli.output import check_writable, console, print_json, print_written, table
from lineofaction.gearbox.problems import EXIT_FAILED, BadInput
from lineofaction.gearbox.progress_bars import progress_bar
from lineofaction.validation import CASES, Outcome, ValidationCase, markdown, read_case, run_case
from lineofaction.validation.table import difference, headline, shown, with_error


def run_validate(names: Sequence[str], output: Path | None, *, as_json: bool) -> None:
    """Run the cases, write the page, print."""
    cases = [read_case(_file(name)) for name in names or CASES]
    if output is not None:
        check_writable(output)
    outcomes: list[Outcome] = []
    with progress_bar() as report:
        for case in cases:
            outcomes.append(run_case(case, _verb_json))
            report("validation", len(outcomes) / len(cases))
    if output is not None:
        output.write_text(markdown(outcomes), encoding="utf-8")
    if as_json:
        print_json({"cases": [outcome.to_json() for outcome in outcomes]})
    else:
        _show(outcomes, output)
    if any(outcome.failed for outcome in outcomes):
        raise typer.Exit(EXIT_FAILED)


def _file(name: str) -> Path:
    """Return the file of a case that comes with the program, or at a path."""
    if name in CASES:
        return CASES[name]
    if Path(name).is_file():
        return Path(name)
    raise BadInput.of("name", name, f"a file of a case, or one of {', '.join(CASES)}")


def _verb_json(words: Sequence[str]) -> Mapping[str, Any]:
    """Run a verb in this process and return what it prints as JSON."""
    from lineofaction.cli.commands import app  # noqa: PLC0415 (it imports this module)

    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        app([*words, "--json"], standalone_mode=False)
    answer: Mapping[str, Any] = json.loads(printed.getvalue())
    return answer


def _show(outcomes: Sequence[Outcome], output: Path | None) -> None:
    out = console()
    for outcome in outcomes:
        case: ValidationCase = outcome.case
        out.print(f"{case.name}: {headline(outcome)} ({outcome.cpu_seconds:.1f} CPU s). {case.source}")
        rows = [
            (row.quantity, row.unit, with_error(row.theirs, row.their_error),
             with_error(row.ours, row.our_error), difference(row), row.verdict)
            for row in shown(outcome.comparisons)
        ]  # fmt: skip
        if rows:
            heads = ("quantity", "unit", "theirs", "ours", "difference", "")
            out.print(table(heads, rows, text_columns=("quantity", "unit", "")))
        for cause in dict.fromkeys(row.why for row in outcome.comparisons if not row.agrees):
            out.print(f"  why: {cause or 'no cause is stated'}", soft_wrap=True)
    comparisons = [row for outcome in outcomes for row in outcome.comparisons]
    agreeing = sum(row.agrees for row in comparisons)
    missing = sum(bool(outcome.reason) for outcome in outcomes)
    seconds = sum(outcome.cpu_seconds for outcome in outcomes)
    out.print(
        f"{agreeing} of {len(comparisons)} numbers of {len(outcomes) - missing} cases agree; "
        f"{missing} cases not run ({seconds:.0f} s of CPU time)"
    )
    print_written([] if output is None else [output])
