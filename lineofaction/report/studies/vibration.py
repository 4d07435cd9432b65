"""A housing's vibration as people see it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from lineofaction.gearbox.convert.run_effects import model_lines
from lineofaction.gearbox.studies.vibration.run import MM_PER_S, HousingVibrationResult
from lineofaction.report.drawing.figure import Figure, Table, number
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.housing_cost_table import cost_tables
from lineofaction.report.presentation import Presentation, dynamics_page
from lineofaction.report.studies.bearing_force_words import force_words
from lineofaction.report.studies.vibration_plots import (
    contribution_figure,
    shape_figure,
    transfer_figure,
    velocity_figure,
)
from lineofaction.report.studies.vibration_tables import contribution_table, largest_table, series, where


def figure(result: HousingVibrationResult) -> Figure:
    """Draw the mode or the deflection; without a surface the velocities."""
    return shape_figure(result) or velocity_figure(result)


def page(result: HousingVibrationResult) -> Page:
    """Return the report."""
    shape = shape_figure(result)
    figures = (velocity_figure(result), contribution_figure(result), transfer_figure(result))
    drawn = figures if shape is None else (figures[0], shape, *figures[1:])
    whole = dynamics_page("Vibration of the housing", drawn, headlines(result), result.analysis.facts)
    rests = Table("Forces that move the housing", ("what", "how"), force_words(result.analysis.facts))
    accuracy = Section("Accuracy of the velocities", tables=(rests,), part=Part.ACCURACY)
    return replace(whole, sections=(*whole.sections, accuracy))


def headlines(result: HousingVibrationResult) -> tuple[Headline, ...]:
    """Return the velocity at the order and speed shown, and what makes most of it."""
    found = result.analysis
    vibration, at = found.vibration, (found.at_speed, found.at_order)
    surface = found.deflection is not None
    if vibration.point:
        rms = vibration.rms[(slice(None), *at)]
        fastest = int(np.argmax(rms))
        first = Headline(f"velocity of {vibration.point[fastest]}", _speed(float(rms[fastest])), where(found))
    else:
        rms_of_hull = float(vibration.mean_square_velocity[at]) ** 0.5
        first = Headline("velocity of the outer hull", _speed(rms_of_hull))
    most = []
    for what, shares in (("bearing", found.bearings), ("mode", found.modes)):
        part = shares.surface if surface else shares.point[0]
        p = int(np.argmax(part))
        hertz = f"{number(float(shares.frequency[p]), 4)} Hz, " if np.isfinite(shares.frequency[p]) else ""
        share = f"{hertz}{number(100.0 * float(part[p]), 3)} % of the mean square"
        most.append(Headline(f"{what} that contributes most", shares.name[p], share))
    return (first, *most)


def _speed(rms: float) -> str:
    """Write a velocity."""
    return f"{number(rms / MM_PER_S, 3)} mm/s rms"


def _text(result: HousingVibrationResult) -> Iterator[Table | str]:
    """Yield the largest velocities, the contributions, what holds no more, and the cost."""
    found, vibration = result.analysis, result.analysis.vibration
    yield largest_table(result)
    yield contribution_table(result)
    beyond = vibration.order[~np.all(vibration.valid, axis=0)]
    if beyond.size:
        orders = ", ".join(f"{order:.4g}" for order in beyond)
        limit = number(vibration.highest_valid_frequency, 4)
        yield f"orders {orders} go beyond {limit} Hz, 0.7 of the highest mode kept: keep more modes"
    yield from (f"{what}: {words}" for what, words in force_words(found.facts))
    yield from cost_tables(found.facts)
    yield from model_lines(found.facts)


PAGE = Presentation(figure, page, _text, series=series)
