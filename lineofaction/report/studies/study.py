"""A study of scenes: maps and curves over the grid, distributions, what matters, worst and failed runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bounds import engineering
from dynamics.study import Study
from lineofaction.gearbox.studies.study.figures import in_boundary_units
from lineofaction.report.drawing.figure import Figure, Table, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation
from lineofaction.report.studies.study_plots import (
    distribution_figure,
    grid_figures,
    label,
    short,
    tornado_figure,
    varied,
)

SHOWN = 12
"""Lines of the tables of worst and failed runs."""


def study_figures(study: Study) -> tuple[Figure, ...]:
    """Draw maps or curves over the grid, the distribution and the tornado."""
    if not study.usable:
        return (distribution_figure(study),)
    figures = (*grid_figures(study), distribution_figure(study), tornado_figure(study))
    return tuple(figure for figure in figures if figure.content)


def summary_table(study: Study) -> Table:
    """Return least, mean and largest value of each response, with the mean of the stated errors."""
    rows = []
    for k in range(len(study.response)):
        one = in_boundary_units(study, k)[1]
        values = study.figure[:, k][np.isfinite(study.figure[:, k])] / one
        errors = study.error[:, k][np.isfinite(study.error[:, k])] / one
        texts = [
            number(float(take(values)), 4) if values.size else "none" for take in (np.min, np.mean, np.max)
        ]
        rows.append(
            (label(study, k), *texts, number(float(errors.mean()), 2) if errors.size else "not stated")
        )
    head = ("response", "least", "mean", "largest", "stated error, mean")
    return Table("Responses of all runs", head, tuple(rows))


def extreme_table(study: Study) -> Table:
    """Return the points of the largest first response."""
    first = study.figure[:, 0]
    usable = np.flatnonzero(np.isfinite(first))
    points = usable[np.argsort(-first[usable], kind="stable")][:SHOWN]
    head = (
        "point",
        *(short(study, k) for k in varied(study)),
        *(label(study, k) for k in range(len(study.response))),
        "kept in full",
    )
    rows = tuple(
        (
            str(point),
            *(f"{study.value[point, k]:.6g}" for k in varied(study)),
            *(
                number(float(study.figure[point, k]) / in_boundary_units(study, k)[1], 4)
                for k in range(len(study.response))
            ),
            "yes" if point in study.worst else "",
        )
        for point in points
    )
    return Table(f"Worst cases: runs of the largest {study.response[0]}", head, rows)


def failed_table(study: Study) -> Table:
    """Return the runs without figures, and why."""
    failed = [k for k, reason in enumerate(study.reason) if reason]
    rows = tuple(
        (str(k), *(f"{study.value[k, f]:.6g}" for f in varied(study)), study.reason[k])
        for k in failed[:SHOWN]
    )
    caption = f"Runs without figures: {len(failed)} of {len(study.reason)}"
    return Table(caption, ("point", *(short(study, f) for f in varied(study)), "reason"), rows)


def page(study: Study) -> Page:
    """Return the page of a study."""
    failed = len(study.reason) - study.usable
    heads = (
        Headline(
            "runs", str(len(study.reason)), f"{failed} without figures" if failed else "all with figures"
        ),
        Headline("largest", _largest(study), study.response[0]),
        Headline("cost of a run", f"{1e3 * float(study.seconds[:, 0].mean()):.0f} ms", "CPU time, mean"),
    )
    tables = (extreme_table(study), *((failed_table(study),) if failed else ()))
    sections = (
        Section("Responses", "", tuple(replace(f, table=None) for f in study_figures(study))),
        Section("Figures", "", (), (summary_table(study), *tables)),
    )
    return Page("Many scenes", _lead(study), heads, sections)


def _lead(study: Study) -> str:
    """Say what was run, and what each run neglects."""
    without = ", ".join(study.facts["neglected"])
    each = f" {study.samples} samples of each combination." if study.samples > 1 else ""
    over = ", ".join(study.factor[k] for k in varied(study))
    return f"{len(study.reason)} runs over {over}.{each} Neglected in the runs: {without}."


def _largest(study: Study) -> str:
    """Write the largest value of the first response."""
    unit, one = in_boundary_units(study, 0)
    first = study.figure[:, 0][np.isfinite(study.figure[:, 0])] / one
    return f"{number(float(first.max()), 4)} {unit}".strip() if first.size else "none"


def _text(study: Study) -> Iterator[Table | str]:
    """Responses, worst and failed runs, cost."""
    yield summary_table(study)
    yield extreme_table(study)
    if study.usable < len(study.reason):
        yield failed_table(study)
    yield f"neglected in the runs: {', '.join(study.facts['neglected'])}"
    yield f"cost {engineering(1e3 * float(study.seconds[:, 0].mean()), 3)} ms CPU a run"


PAGE = Presentation(lambda study: study_figures(study)[0], page, _text)
