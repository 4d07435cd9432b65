"""Page on a change of flanks: levels before and after over the same pairs, and the decision."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.studies.change.result import HIGH, LOW, FlankChange
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Reference, Table
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation

GETS_LOUDER = "gets louder"
BAND = f"{100 * (HIGH - LOW):.0f} %"
LOWER, MEDIAN, UPPER = range(3)  # indices of quantiles
TOTAL = 0  # index of all orders together among the lines of a level


def _loads(result: FlankChange) -> tuple[str, ...]:
    """Return names of the load cases: their torques, with a number if a torque repeats."""
    torques = [f"{torque:.4g} N m" for torque in result.torque]
    return tuple(name if torques.count(name) == 1 else f"{name} ({k + 1})" for k, name in enumerate(torques))


def _change_figure(result: FlankChange) -> Figure:
    median = result.change_quantiles[MEDIAN, :, TOTAL]
    worst = int(np.argmax(median))
    quantity = f"{result.quantity.replace('_', ' ')}, {result.over_speeds.replace('_', ' ')} over the speeds"
    return Figure(
        key="change",
        title="Levels of the pairs before and after",
        caption=f"{len(result.deviation)} pairs, deviating alike before (dashed) and after. All orders of "
        f"{result.mesh} together: {quantity}.",
        alternative=f"The median change is {median[worst]:+.1f} dB at {_loads(result)[worst]}.",
        content=_distributions(result),
    )


def _distributions(result: FlankChange) -> tuple[Panel, Panel]:
    """Draw the distributions of the levels before and after, and of their change, by load."""
    levels, changes = [], []
    for k, load in enumerate(_loads(result)):
        color = palette.ordered(k, result.torque.size)
        levels.append(_distribution(f"{load}, before", result.before.pairs[:, k, TOTAL], color, dashed=True))
        levels.append(_distribution(load, result.after.pairs[:, k, TOTAL], color))
        changes.append(_distribution(load, result.change[:, k, TOTAL], color))
    limit = () if result.requirement is None else (Reference("requirement", result.requirement),)
    zero = (Reference("as before", 0.0),)
    share = Axis("share of all pairs")
    return (
        Panel(Axis(result.unit), share, tuple(levels), limit, title="Level"),
        Panel(Axis("change, dB"), share, tuple(changes), zero, title="Change"),
    )


def _distribution(name: str, level: FloatArray, color: str, *, dashed: bool = False) -> Line:
    part = np.arange(1, level.size + 1) / level.size
    return Line(name, np.sort(level), part, color, "dash" if dashed else "solid")


def _levels_table(result: FlankChange) -> Table:
    head = ("load", "order", *(f"{name}, dB" for name in ("before", "after", "change")), "louder")
    caption = f"As designed, and in brackets where {BAND} of the pairs lie; {result.unit}"
    return Table(caption, head, tuple(_rows(result)))


def _rows(result: FlankChange) -> Iterator[tuple[str, ...]]:
    before, after = result.before.quantiles(), result.after.quantiles()
    for k, load in enumerate(_loads(result)):
        for line, name in enumerate(result.lines):
            at = k, line
            yield (
                load,
                name,
                _banded(result.before.nominal[at], before[:, *at]),
                _banded(result.after.nominal[at], after[:, *at]),
                _banded(result.nominal_change[at], result.change_quantiles[:, *at], "+"),
                f"{100.0 * result.louder_share[at]:.0f} %",
            )


def _banded(nominal: float, band: FloatArray, sign: str = "") -> str:
    return f"{nominal:{sign}.1f} ({band[LOWER]:{sign}.1f} to {band[UPPER]:{sign}.1f})"


def _influence_table(result: FlankChange) -> Table:
    of_change, of_level = result.influence
    order = np.argsort(-np.abs(of_level).max(axis=1), kind="stable")
    head = ("deviation", *(f"{what}, {load}" for load in _loads(result) for what in ("after", "change")))
    rows = []
    for i in order.tolist():
        values = np.stack([of_level[i], of_change[i]], axis=1).ravel()
        rows.append((boundary_name(result.names[i]), *(f"{value:+.2f}" for value in values)))
    caption = "Which deviation decides: rank correlation of it, or of its size, with the level and its change"
    return Table(caption, head, tuple(rows))


def _loudest(result: FlankChange) -> str:
    return next(result.louder(), "no order as designed")


def _text(result: FlankChange) -> Iterator[Table | str]:
    yield result.verdict()
    yield f"{GETS_LOUDER}: {_loudest(result)}"
    yield from filter(None, (result.required(),))
    yield from result.partings()
    yield _levels_table(result)
    yield _influence_table(result)


def _page(result: FlankChange) -> Page:
    verdict = Headline("verdict", result.verdict(), result.required())
    heads = (verdict, Headline(GETS_LOUDER, _loudest(result)))
    tables = (_levels_table(result), _influence_table(result))
    section = Section("What it brings", "", (_change_figure(result),), tables)
    lead = f"Flanks of {result.mesh} over {len(result.deviation)} pairs within their tolerances"
    return Page("Change of flanks", lead, heads, (section,), tuple(result.partings()))


PAGE = Presentation(_change_figure, _page, _text)
