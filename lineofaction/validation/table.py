"""The outcomes of validation cases as a part of a page."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence

from bounds import engineering, error_digits
from lineofaction.validation.comparison import Comparison
from lineofaction.validation.run import Outcome

LINE = 120
MOST_ROWS = 12
"""Most rows of a case that are all written; of a longer case only the rows that `shown` returns are."""


def with_error(value: float, error: float) -> str:
    """Write a value with its error, both to its second digit; without an error six digits."""
    return error_digits.with_error(value, error) if error else f"{value:.6g}"


def difference(row: Comparison) -> str:
    """Write how far ours is from theirs, in per cent of theirs."""
    return f"{engineering(100.0 * row.difference, 2, '+')} %"


def headline(outcome: Outcome) -> str:
    """Return how many rows agree as text, or why there are none."""
    if outcome.reason:
        return outcome.reason
    agreeing = sum(row.agrees for row in outcome.comparisons)
    return f"{agreeing} of {len(outcome.comparisons)} agree"


def shown(rows: Sequence[Comparison]) -> Sequence[Comparison]:
    """Return all rows of a short case; of a long one those that differ, or else the one that nearly does."""
    if len(rows) <= MOST_ROWS:
        return rows
    differing = [row for row in rows if not row.agrees]
    return differing or [max(rows, key=lambda row: abs(row.ours - row.theirs) / (row.their_error or 1.0))]


def markdown(outcomes: Iterable[Outcome]) -> str:
    """Write each case with its source, what was assumed, and its rows."""
    return "\n".join(part for outcome in outcomes for part in _case(outcome))


def _case(outcome: Outcome) -> Iterable[str]:
    case = outcome.case
    kind = "measured" if case.measured else "computed or published"
    head = f"{case.source} ({kind}; {case.licence}). Ours: `{case.function or 'loa ' + case.verb}`."
    yield f"### {case.title}\n"
    yield _filled(" ".join((head, *case.assumed)))
    yield f"\n**{headline(outcome)}.**\n"
    if outcome.comparisons:
        yield "| quantity | theirs | ours | difference | |\n|---|---:|---:|---:|---|"
        yield "".join(f"{_cells(row)}\n" for row in shown(outcome.comparisons))
        causes = dict.fromkeys(row.why for row in outcome.comparisons if row.why and not row.agrees)
        yield from (f"{_filled(f'Why: {cause}')}\n" for cause in causes)


def _cells(row: Comparison) -> str:
    unit = f", {row.unit}" if row.unit else ""
    numbers = with_error(row.theirs, row.their_error), with_error(row.ours, row.our_error)
    return f"| {row.quantity}{unit} | {' | '.join(numbers)} | {difference(row)} | {row.verdict} |"


def _filled(text: str) -> str:
    return textwrap.fill(text, LINE, break_long_words=False, break_on_hyphens=False)
