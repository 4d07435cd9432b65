"""The hard scenes on a page: the law of each, the margin to its bounds, and the time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from lineofaction.hardcases import Outcome
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Reference, Table, number
from lineofaction.report.drawing.page import Headline, Page, Section

_SMALLEST_USE = 1e-9


def hardcases_page(outcomes: Sequence[Outcome]) -> Page:
    """Return the page of all outcomes."""
    passed = sum(outcome.passed for outcome in outcomes)
    slowest = max(outcomes, key=lambda outcome: outcome.seconds)
    heads = (
        Headline("passed", f"{passed} of {len(outcomes)}"),
        Headline("time in all", f"{sum(o.seconds for o in outcomes):.1f} s"),
        Headline("CPU time in all", f"{sum(o.cpu_seconds for o in outcomes):.1f} s"),
        Headline("slowest", slowest.scene.name, f"{slowest.seconds:.1f} s"),
    )
    families = dict.fromkeys(outcome.scene.family for outcome in outcomes)
    sections = [Section("Margins", "", (_margins(outcomes),))]
    for family in families:
        of_family = [outcome for outcome in outcomes if outcome.scene.family == family]
        sections.append(_section(family, of_family))
    alarms = tuple(f"{o.scene.name} failed: {o.failure}" for o in outcomes if not o.passed)
    lead = "Scenes that are known to break solvers, each assessed by laws that hold whatever the numbers are."
    return Page("Hard scenes", lead, heads, tuple(sections), alarms)


def _section(family: str, outcomes: Sequence[Outcome]) -> Section:
    head = ("scene", "result", "time, s", "CPU, s", "hard because", "criterion")
    rows = tuple(
        (
            o.scene.name,
            "passed" if o.passed else f"FAILED: {o.failure}",
            number(o.seconds, 3),
            number(o.cpu_seconds, 3),
            o.scene.hard_because,
            o.scene.criterion,
        )
        for o in outcomes
    )
    figures = tuple(_figures(outcome) for outcome in outcomes)
    return Section(
        f"{family.capitalize()} scenes", "", (), (Table(f"Scenes: {family}", head, rows),), figures
    )


def _figures(outcome: Outcome) -> Table:
    rows = tuple(
        (figure.name, number(figure.value, 3), figure.bound, "" if figure.passed else "out of bounds")
        for figure in outcome.figures
    )
    return Table(f"Figures of {outcome.scene.name}", ("figure", "value", "bound", "remark"), rows)


def _margins(outcomes: Sequence[Outcome]) -> Figure:
    """Draw how much of its bound every figure uses."""
    points = [
        (index, max(figure.use, _SMALLEST_USE))
        for index, outcome in enumerate(outcomes, start=1)
        for figure in outcome.figures
        if figure.use is not None and np.isfinite(figure.use)
    ]
    scenes, use = np.array(points, dtype=float).reshape(-1, 2).T
    worst = max(use.tolist(), default=0.0)
    names = tuple(
        (str(index), o.scene.name, "passed" if o.passed else "FAILED", number(o.seconds, 3))
        for index, o in enumerate(outcomes, start=1)
    )
    panel = Panel(
        Axis("scene", limits=(0.0, len(outcomes) + 1.0)),
        Axis("part of the bound that is used", "log"),
        (Line("figures", scenes, use, palette.BLUE, width=0, markers=True),),
        (Reference("bound", 1.0, "horizontal"),),
    )
    return Figure(
        key="hardcases",
        title="How close the figures come to their bounds",
        caption="Every figure with a bound that is neither zero nor met exactly, over that bound (or the "
        f"bound over it, where it must be larger); below {_SMALLEST_USE:g} drawn there. Near one stands "
        "physics, far below rounding.",
        alternative=f"The largest is {number(worst, 3)}.",
        content=(panel,),
        table=Table("Scenes by number", ("number", "scene", "result", "time, s"), names),
    )
