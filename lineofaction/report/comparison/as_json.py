"""The comparison of two stored results as plain JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lineofaction.report.comparison.compare import compare_results
from lineofaction.report.document.as_json import of_the_store, page_json
from lineofaction.report.runs.run_view import RunView

Json = dict[str, Any]
NAMES = ("first", "second")


def stored_comparison(inputs: Json) -> Json:
    """Compare ``{"files": [...]}``, two tables or two runs; work of the live worker."""
    named = dict(zip(NAMES, map(Path, inputs["files"]), strict=True))
    with of_the_store():
        return page_json(compare_results(named, RunView()))
