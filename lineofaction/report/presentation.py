"""How a study shows its result: the interface of the modules in `lineofaction.report.studies`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.effects import run_lines
from lineofaction.gearbox.loading import LOADING
from lineofaction.gearbox.registry import Study
from lineofaction.report.drawing.figure import Figure, Table
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.tables import cost_tables
from lineofaction.report.runs.dynamic_part import ledger_section


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


def presentation_of(study: Study) -> Presentation:
    """Return how a study shows its result; the module of its name is loaded on demand."""
    with LOADING:
        shown: Presentation = import_module(f"lineofaction.report.studies.{study.package}").PAGE
    return shown


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
