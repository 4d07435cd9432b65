"""The result of a study in a few lines, as a Python prompt shows it: the main figures of its report."""

from __future__ import annotations

from typing import Any

from bounds.brief import Row
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.document import study_of
from lineofaction.report.presentation import presentation_of


def summary(result: Any) -> tuple[str, list[Row]] | None:
    """Return the title and the rows of a result of a study; None: its report has no main figures."""
    try:
        study = study_of(result)
    except BadInput:  # a table or a run, which have lines of their own, or a part of a result
        return None
    page = presentation_of(study).page(result)
    if not page.headlines:
        return None
    rows = [("subject", page.lead)] if page.lead else []
    for headline in page.headlines:
        separator = " " if headline.remark.startswith("±") else ", "
        rows.append((headline.name, separator.join(filter(None, (headline.value, headline.remark)))))
    rows += [("warning", alarm) for alarm in page.alarms]
    return f"{type(result).__name__}: {study.title.lower()}", rows
