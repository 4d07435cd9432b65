"""The interface of a study's module `page`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from fe_contact.ste import SteDatabase
from service.drawing.figure import Figure, Table
from service.drawing.page import Headline, Page, Section


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


def dynamics_page(title: str, figures: tuple[Figure, ...], headlines: tuple[Headline, ...]) -> Page:
    """Return the page of a study of a scene that is its figures."""
    return Page("Dynamics of geared shafts", "", headlines, (Section(title, figures=figures),))
