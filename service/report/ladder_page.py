"""The page of a ladder: what was chosen, the knee, the plot, every rung, and what was not run."""

from __future__ import annotations

from dataclasses import replace

from dynamics.accuracy import Frontier as SceneFrontier
from fe_contact.analysis import Frontier as CaseFrontier
from service.report.figure import Figure, Table, number
from service.report.page import Headline, Page, Section


def ladder_page(
    found: CaseFrontier | SceneFrontier, title: str, lead: str, chosen: str, figure: Figure, rungs: Table
) -> Page:
    """Return the page; `chosen` says by what the chosen rung was chosen, `rungs` lists all."""
    by_name = {result.name: result for result in found.results}
    heads = [
        Headline(text, by_name[name].title, f"{number(by_name[name].cpu_seconds, 2)} CPU s")
        for text, name in ((chosen, found.chosen), ("knee", found.knee))
        if name in by_name and name is not None
    ]
    left = Table("Rungs that were not run", ("rung", "because"), tuple(found.left_out.items()))
    tables = (rungs, *([left] if found.left_out else []))
    return Page(
        title, lead, tuple(heads), (Section(rungs.caption, "", (replace(figure, table=None),), tables),)
    )
