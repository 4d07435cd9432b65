"""The page of an ablation: the largest change, the plot, every effect, and what was not switched."""

from __future__ import annotations

from dataclasses import replace

from dynamics.ablation import Ablation as SceneAblation
from fe_contact.analysis.ablation import Ablation
from service.report.ablation import (
    case_ablation_figure,
    case_ablation_table,
    largest_change,
    scene_ablation_figure,
    scene_ablation_table,
)
from service.report.figure import Table
from service.report.page import Headline, Page, Section


def ablation_page(found: Ablation | SceneAblation) -> Page:
    """Return the page of an ablation."""
    if isinstance(found, Ablation):
        what, figure, rows = "case", case_ablation_figure(found), case_ablation_table(found)
    else:
        what, figure, rows = "scene", scene_ablation_figure(found), scene_ablation_table(found)
    heads = []
    if found.effects:
        name, change = largest_change(found)
        heads.append(Headline(f"without {name.replace('_', ' ')}", change, "of peak to peak, most of all"))
    left = Table("Effects that were not switched", ("effect", "because"), tuple(found.left_out.items()))
    tables = (rows, *([left] if found.left_out else []))
    section = Section("Effects", "", (replace(figure, table=None),) if found.effects else (), tables)
    lead = f"{len(found.effects)} effects of the {what}, each toggled by itself"
    return Page("What every effect changes", lead, tuple(heads), (section,))
