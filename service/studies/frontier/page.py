"""An accuracy study: what was chosen, the knee, the plot, every fidelity, and what was not run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from dynamics.accuracy import Frontier as SceneFrontier
from fe_contact.analysis import Frontier
from service.report.figure import Figure, Table, number
from service.report.page import Headline, Page, Section
from service.studies.frontier.of_case import frontier_figure, frontier_table
from service.studies.frontier.of_scene import run_frontier_figure, run_frontier_table
from service.studies.presentation import Presentation


def frontier_page(found: Frontier | SceneFrontier) -> Page:
    """Return the page of an accuracy study."""
    if isinstance(found, Frontier):
        lead = f"{len(found.results)} ways to the same table of {found.solves} positions x loads"
        chosen = "chosen for the asked accuracy"
    else:
        lead = (
            f"{len(found.results)} ways to the same vibration: {found.blocks} blocks, {found.orders} orders"
        )
        chosen = "the scene's own setting"
    by_name = {result.name: result for result in found.results}
    heads = [
        Headline(text, by_name[name].title, f"{number(by_name[name].cpu_seconds, 2)} CPU s")
        for text, name in ((chosen, found.chosen), ("knee", found.knee))
        if name in by_name and name is not None
    ]
    left = Table("Rungs that were not run", ("rung", "because"), tuple(found.left_out.items()))
    rungs = _table(found)
    tables = (rungs, *([left] if found.left_out else []))
    section = Section(rungs.caption, "", (replace(_figure(found), table=None),), tables)
    return Page("What accuracy costs in time", lead, tuple(heads), (section,))


def _figure(found: Frontier | SceneFrontier) -> Figure:
    """Draw that of a case or of a scene."""
    return frontier_figure(found) if isinstance(found, Frontier) else run_frontier_figure(found)


def _table(found: Frontier | SceneFrontier) -> Table:
    """List that of a case or of a scene."""
    return frontier_table(found) if isinstance(found, Frontier) else run_frontier_table(found)


def _text(found: Frontier | SceneFrontier) -> Iterator[Table | str]:
    """Every rung, and what was not run."""
    yield _table(found)
    for name, reason in found.left_out.items():
        yield f"not run: {name}: {reason}"


PAGE = Presentation(_figure, frontier_page, _text)
