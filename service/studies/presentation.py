"""What the module `page` of a study offers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from service.report.figure import Figure, Table
from service.report.page import Page, Section


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
    """

    figure: Callable[[Any], Figure]
    page: Callable[[Any], Page]
    text: Callable[[Any], Iterable[Table | str]]


def dynamics_page(title: str, figures: tuple[Figure, ...]) -> Page:
    """Return the page of a study of a scene that is its figures."""
    return Page("Dynamics of geared shafts", "", (), (Section(title, figures=figures),))
