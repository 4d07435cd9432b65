"""Presentation of a study's result: its figure, its page, its text.

The presentation of a study is `PAGE` of the module that has the name of the study, in a folder of the report.
*Marks* show the sound of a complaint in plots.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.effects import run_lines
from lineofaction.gearbox.convert.operating_point import OPERATING_POINT
from lineofaction.gearbox.convert.scene_effects import assumed_lines, beyond_lines, scene_table
from lineofaction.gearbox.loading import LOADING, load
from lineofaction.gearbox.studies.bodies import UNIT
from lineofaction.gearbox.studies.figures import metadata_of
from lineofaction.gearbox.study import Study
from lineofaction.gearbox.units import boundary_ledger
from lineofaction.report.drawing.figure import Figure, Table
from lineofaction.report.drawing.marks import marked, marked_page, marks_of
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.tables import cost_tables, ledger_section

_SUBJECTS = [entry.name for entry in iter_modules([str(Path(__file__).parent)]) if entry.ispkg]
"""Folders of the report, in which the modules of studies are."""


def scene_point_of(result: Any) -> str:
    """Return the operating point of the result of a scene in words; empty: its file knows none."""
    return str(metadata_of(result).get(OPERATING_POINT, ""))


@dataclass(frozen=True)
class Presentation:
    """Functions from a result to its outputs for people."""

    figure: Callable[[Any], Figure]
    """Plot of ``-o FILE.png``."""
    page: Callable[[Any], Page]
    """Report."""
    text: Callable[[Any], Iterable[Table | str]]
    """Tables and lines of the terminal."""
    series: Callable[[Any], Table] | None = None
    """Numbers of the plot, which are written as CSV; None: no CSV."""
    with_database: Callable[[Any, SteDatabase], Page] | None = None
    """Report of a result together with its STE database; None: the report is `page`."""
    point: Callable[[Any], str] = scene_point_of
    """Operating point in words, which stands at the head; empty: the tables name theirs."""


def presentation_of(study: Study) -> Presentation:
    """Return the presentation of a study; its file, in the folder of its subject, is loaded on demand."""
    files = (f"{__package__}.{subject}.{study.package}" for subject in _SUBJECTS)
    with LOADING:
        presentation: Presentation = load(f"{next(filter(find_spec, files))}:PAGE")
    return _of_its_unit(presentation)


def _of_its_unit(presentation: Presentation) -> Presentation:
    """Return a presentation whose page begins with the picture of the result's gear unit.

    If the result has a complaint, its sound is marked in all plots.
    """

    def figure(result: Any) -> Figure:
        marks, plain = marks_of(result), presentation.figure(result)
        return plain if marks is None else marked(plain, marks)

    def page(result: Any) -> Page:
        from lineofaction.report.unit_picture import with_picture  # noqa: PLC0415 (start-up time: it draws)

        marks, plain = marks_of(result), presentation.page(result)
        plain = at_point(plain, presentation.point(result))
        complete = plain if marks is None else marked_page(plain, marks)
        return with_picture(complete, metadata_of(result).get(UNIT))

    return replace(presentation, figure=figure, page=page)


def at_point(page: Page, point: str) -> Page:
    """Return a page whose lead begins with the operating point."""
    named = f"{point[:1].upper()}{point[1:]}." if point else ""
    lead = page.lead and f"{page.lead[0].upper()}{page.lead[1:]}"
    return replace(page, lead=" ".join(filter(None, (named, lead)))) if named else page


def dynamics_presentation(
    title: str,
    figures: Callable[[Any], tuple[Figure, ...]],
    headlines: Callable[[Any], tuple[Headline, ...]],
    text: Callable[[Any], Iterable[Table | str]],
) -> Presentation:
    """Return the presentation of a study of a scene, whose metadata name neglected effects."""

    def complete_text(result: Any) -> Iterator[Table | str]:
        yield from text(result)
        yield from model_text(result.metadata)

    return Presentation(
        lambda result: figures(result)[0],
        lambda result: dynamics_page(title, figures(result), headlines(result), result.metadata),
        complete_text,
    )


def model_text(metadata: Mapping[str, Any]) -> Iterator[Table | str]:
    """Yield the cost of the housings of a scene, and the neglected effects; empty: none."""
    yield from cost_tables(metadata)
    if metadata["effect_ledger"] is None:
        return
    yield from effect_text(boundary_ledger(metadata["effect_ledger"]))
    yield from run_lines(metadata)


def effect_text(ledger: Mapping[str, Any]) -> Iterator[Table | str]:
    """Yield the decisions on the effects of a scene as a table, and a line on negligible effects."""
    columns, rows, trifles = scene_table(ledger)
    if rows:
        yield Table("Effects: change without each", tuple(columns), tuple(map(tuple, rows)))
    if trifles:
        yield trifles
    yield from beyond_lines(ledger)
    yield from assumed_lines(ledger)


def dynamics_page(
    title: str, figures: tuple[Figure, ...], headlines: tuple[Headline, ...], metadata: Mapping[str, Any]
) -> Page:
    """Return the page of a study of a scene: figures, effects, cost of its housings, failed assumptions.

    `metadata` has `effect_ledger`, which is None for a study without a dynamic model.
    """
    sections = [Section(title, figures=figures)]
    if metadata["effect_ledger"] is None:
        return Page("Dynamics of geared shafts", "", headlines, tuple(sections), ())
    sections.append(ledger_section(boundary_ledger(metadata["effect_ledger"])))
    if tables := cost_tables(metadata):
        sections.append(Section("Cost", tables=tables, part=Part.RECEIPT))
    return Page("Dynamics of geared shafts", "", headlines, tuple(sections), tuple(run_lines(metadata)))
