"""The positions of a table: one set for all its alignments and base pitches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.pairs.solved_operating_points import deflected_operating_points
from fe_contact.analysis.tables.position_nodes import (
    PositionNodes,
    adaptive_nodes,
    unmeasured_nodes,
)
from fe_contact.contact import ContactModel
from fe_contact.planning import MOST_ROWS, Plan
from fe_contact.planning.contact_cost import expected_tries
from fe_contact.types import FloatArray, IntArray
from model_studies.progress import Report, unreported


def table_nodes(points: OperatingPoints, plan: Plan, report: Report = unreported) -> PositionNodes:
    """Place the positions: the number requested, or where the assessed curves bend.

    What is missed between fixed ones is not measured here (`position_errors`). `report` is called with the
    fraction of the positions that a search usually tries.
    """
    if plan.positions is not None:
        return unmeasured_nodes(plan.positions, len(points.assessed) * plan.load.size)
    windows = assessed_windows(points.places[0].model, plan.nodes.assessed_pitches)
    tried, expected = 0, expected_tries(plan)

    def solve(position: FloatArray) -> FloatArray:
        """STE (W, P, windows x places x L) in m."""
        nonlocal tried
        curves = [_curves(points, plan.load, position, window) for window in windows]
        tried += position.size
        report(min(tried / expected, 1.0))
        return np.concatenate(curves, axis=2)

    rows = points.period * len(points.places)
    most = max(min(plan.nodes.most, MOST_ROWS // rows), plan.nodes.start)
    return adaptive_nodes(replace(plan.nodes, most=most), solve)


def assessed_windows(model: ContactModel, most: int) -> tuple[IntArray, ...]:
    """Return base pitches to assess, each with its neighbors.

    Where all teeth are alike, the one pitch there is: ``([0],)``. Else ``[m - 1, m, m + 1]`` of pitches m, at
    most `most`, evenly taken from all in the order of how much the gaps of their three pairs differ, both
    ends among them: these differences move and steepen the handovers.
    """
    if model.period == 1:
        return (np.zeros(1, dtype=np.int64),)
    meeting = np.arange(model.period)[:, None] + np.arange(-1, 2)
    spread = np.ptp(sum(term(meeting) for term in model.tooth_gaps), axis=1)
    order = np.argsort(spread, kind="stable")
    chosen = np.unique(np.linspace(0, order.size - 1, min(most, order.size)).astype(int))
    return tuple(order[k] + np.arange(-1, 2) for k in chosen)


def _curves(points: OperatingPoints, load: FloatArray, position: FloatArray, pitches: IntArray) -> FloatArray:
    """STE (T, P, places x L) in m of the assessed operating points in the given pitches."""
    curves = deflected_operating_points(
        points.assessed, [position] * len(points.assessed), load, pitches, points.workers
    )
    shape = (pitches.size, position.size, -1)
    return np.concatenate([curve.reshape(shape) for curve in curves], axis=2)
