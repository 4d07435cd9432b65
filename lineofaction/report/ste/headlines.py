"""The main results of an STE database, in the lines above all others."""

from __future__ import annotations

import math

import numpy as np

from bounds.error_digits import error_text, to_error
from fe_contact.ste import Curve, SteDatabase
from fe_contact.types import Estimate
from lineofaction.gearbox.units import UM
from lineofaction.report.drawing.figure import number
from lineofaction.report.drawing.page import Headline
from lineofaction.report.ste.curves import aligned_index, headline_load, load_curve, load_labels
from lineofaction.report.ste.teeth import UNBOUNDED, tooth_headlines


def static_headlines(database: SteDatabase, force: float | None = None) -> tuple[Headline, ...]:
    """Return mean and peak-to-peak STE and the largest pressure at the stored load nearest to `force`, N."""
    load = headline_load(database, force)
    cycle = (slice(None), load, *aligned_index(database))  # all positions of the aligned pair at this load
    pressure = float(np.nanmax(database.max_pressure[cycle]))
    edge = float(np.nanmax(database.edge_pressure[cycle])) if database.edge_pressure.size else 0.0
    remark = f"{UNBOUNDED}{edge_text(edge)}"
    curve, label = load_curve(database, load), load_labels(database)[load]
    mean, ripple = curve.mean, curve.peak_to_peak
    mean_bias, ripple_bias = _over_face(curve)
    return (
        Headline(f"mean STE at {label}", f"{_to_error(mean)} µm", f"{_band(mean)}{mean_bias}"),
        Headline(f"peak-to-peak STE at {label}", f"{_to_error(ripple)} µm", f"{_band(ripple)}{ripple_bias}"),
        Headline(f"largest pressure at {label}", f"{number(1e-6 * pressure, 4)} MPa", remark),
        *tooth_headlines(database, load),
    )


def _over_face(curve: Curve) -> tuple[str, str]:
    """Return remarks on mean and peak-to-peak of gears of finite width, beside those of a plane model.

    They are empty where the table itself has the finite width.
    """
    if curve.over_face is None:
        return "", ""
    figures = curve.over_face.mean, curve.over_face.peak_to_peak
    mean, ripple = (f"; gears of this width {_to_error(figure)} µm {_band(figure)}" for figure in figures)
    return mean, ripple


def edge_text(pressure: float) -> str:
    """Return text on the pressure (Pa) of contacts at an edge, separate from the flank's; empty for 0."""
    if pressure <= 0.0:
        return ""
    return f"; {number(1e-6 * pressure, 3)} MPa at the edges, indicative: the true one is singular"


def _band(estimate: Estimate) -> str:
    if math.isnan(estimate.error):
        return "not estimated"
    return f"± {error_text(estimate.value / UM, estimate.error / UM)} µm"


def _to_error(estimate: Estimate) -> str:
    return to_error(estimate.value / UM, estimate.error / UM)
