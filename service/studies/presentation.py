"""The interface of a study's module `page`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from fe_contact.ste import SteDatabase
from service.convert.effect_lines import run_lines
from service.drawing.figure import Figure, Table
from service.drawing.page import Headline, Page, Part, Section
from service.runs.dynamic_part import ledger_section
from service.studies.housing_costs import cost_tables


@dataclass(frozen=True)
class Presentation:
    """A result as people see it.

    Attributes
    ----------
    figure : callable
        The one plot of ``-o FILE.png``.
    page : callable
        The report.
    text : callable
        Tables and lines of the terminal.
    series : callable, optional
        The numbers of the plot, which are written as CSV.
    beside : callable, optional
        The report beside that of an STE database, called with both; default: the same.
    """

    figure: Callable[[Any], Figure]
    page: Callable[[Any], Page]
    text: Callable[[Any], Iterable[Table | str]]
    series: Callable[[Any], Table] | None = None
    beside: Callable[[Any, SteDatabase], Page] | None = None


def dynamics_page(
    title: str, figures: tuple[Figure, ...], headlines: tuple[Headline, ...], facts: Mapping[str, Any]
) -> Page:
    """Return the page of a study of a scene: its figures, effects, cost of its housings, what does not hold.

    `facts` hold `effect_ledger`.
    """
    sections = [Section(title, figures=figures), ledger_section(facts["effect_ledger"])]
    if tables := cost_tables(facts):
        sections.append(Section("Cost", tables=tables, part=Part.RECEIPT))
    return Page("Dynamics of geared shafts", "", headlines, tuple(sections), tuple(run_lines(facts)))
