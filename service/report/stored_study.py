"""Studies that are kept as JSON: which one a file holds, and its page."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fe_contact.analysis import Frontier
from service.problems import BadInput
from service.report.ablation_page import ablation_page
from service.report.frontier import frontier_page
from service.report.optimisation import optimisation_page
from service.report.page import Page
from service.report.run_frontier import run_frontier_page
from service.report.scatter import scatter_page
from service.report.stored_ablation import stored_ablation
from service.report.stored_ladder import Json, stored_ladder
from service.report.stored_optimisation import stored_optimisation
from service.report.stored_scatter import stored_scatter

LADDER_TITLE = "What accuracy costs in time"


def _ladder(content: Json) -> Page:
    """Return the page of an accuracy ladder."""
    found = stored_ladder(content)
    if isinstance(found, Frontier):
        return frontier_page(found, LADDER_TITLE)
    return run_frontier_page(found, LADDER_TITLE)


PAGES: dict[str, Callable[[Json], Page]] = {
    "ablation": lambda content: ablation_page(stored_ablation(content)),
    "frontier": _ladder,
    "optimisation": lambda content: optimisation_page(stored_optimisation(content)),
    "scatter": lambda content: scatter_page(stored_scatter(content)),
}
"""By the kind of the result."""
_FIELDS = {
    "ablation": {"of", "nominal", "effects"},
    "frontier": {"rungs", "knee", "chosen"},
    "optimisation": {"start", "optimum", "variables"},
    "scatter": {"samples", "quantiles", "influence"},
}
"""What only that kind has."""


def stored_study(file: Path) -> tuple[str, Page]:
    """Return which study a JSON file holds, one of `PAGES`, and its page.

    Raises
    ------
    BadInput
        It holds none, or a damaged one.
    """
    bound = f"a study in JSON ({', '.join(PAGES)})"
    try:
        content: Any = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput.of("file", str(file), bound, f"It cannot be read ({error}).") from None
    named = content.keys() if isinstance(content, dict) else ()
    kinds = [kind for kind, fields in _FIELDS.items() if fields <= set(named)]
    if not kinds:
        raise BadInput.of("file", str(file), bound, "It is JSON of another kind.")
    try:
        return kinds[0], PAGES[kinds[0]](content)
    except (KeyError, TypeError, ValueError) as error:
        advice = f"Something is missing or not as written ({type(error).__name__}: {error})."
        raise BadInput.of("file", str(file), f"an undamaged {kinds[0]}", advice) from None
