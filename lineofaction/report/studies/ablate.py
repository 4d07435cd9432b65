"""An ablation: the largest change, the plot, every effect, and what was not toggled."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from dynamics.ablation import Ablation as SceneAblation
from fe_contact.analysis.studies.ablation import Ablation
from lineofaction.report.drawing.figure import Figure, Table
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation
from lineofaction.report.studies import ablate_of_case as of_case
from lineofaction.report.studies import ablate_of_scene as of_scene
from lineofaction.report.studies.ablate_look import Look


def ablation_figure(ablation: Ablation | SceneAblation) -> Figure:
    """Draw what every effect changes."""
    look = _look(ablation)
    changes = [
        f"{entry.name} {look.words(ablation, entry)} of peak to peak" for entry in look.ordered(ablation)
    ]
    return Figure(
        key="ablation",
        title=look.title,
        caption=look.caption(ablation),
        alternative="; ".join(changes),
        content=look.panels(ablation),
        table=look.table(ablation),
    )


def ablation_table(ablation: Ablation | SceneAblation) -> Table:
    """Return the changes by every effect, the largest of peak-to-peak first."""
    return _look(ablation).table(ablation)


def ablation_page(ablation: Ablation | SceneAblation) -> Page:
    """Return the page of an ablation."""
    look, heads = _look(ablation), []
    if ablation.effects:
        entry = look.ordered(ablation)[0]
        name, change = entry.name.replace("_", " "), look.words(ablation, entry)
        heads.append(Headline(f"without {name}", change, "of peak to peak, the largest influence"))
    left = Table("Effects that were not toggled", ("effect", "because"), tuple(ablation.left_out.items()))
    tables = (look.table(ablation), *([left] if ablation.left_out else []))
    figures = (replace(ablation_figure(ablation), table=None),) if ablation.effects else ()
    lead = f"{len(ablation.effects)} effects of the {look.what}, each toggled by itself"
    return Page("Influence of every effect", lead, tuple(heads), (Section("Effects", "", figures, tables),))


def _look(ablation: Ablation | SceneAblation) -> Look:
    return of_case.LOOK if isinstance(ablation, Ablation) else of_scene.LOOK


def _text(ablation: Ablation | SceneAblation) -> Iterator[Table | str]:
    """Every effect, and what was not toggled."""
    yield ablation_table(ablation)
    for name, reason in ablation.left_out.items():
        yield f"not toggled: {name}: {reason}"


PAGE = Presentation(ablation_figure, ablation_page, _text)
