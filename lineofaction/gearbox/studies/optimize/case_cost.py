"""Predicted cost of a search for flanks of a case, by what its designs and their analyses solve.

A search assesses designs at its few positions and the loads that count, at every node of the scatter. Its
best design and the start are analyzed at the end: a table over all loads, and figures at the positions of the
table with their errors.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fe_contact.analysis.run_plan import PredictedDesigns, predicted_designs, table_seconds
from fe_contact.microgeometry.objective import Limits
from fe_contact.microgeometry.optimization import OptimizationRequest
from fe_contact.microgeometry.search import usual_designs
from lineofaction.gearbox.studies.cost import StudyCost, Work

FIGURES = 3.25
"""Cost of the figures of an analysis with their errors over that of the figures alone: each half of the
positions is solved, and one of them in fewer slices, in wider patches and on the coarse meshes.
"""
REFINED = 40.0
"""Assessments of a design by the search from one that exceeds the limits between the positions: 15 to 23
steps of about two each.
"""


def search_cost(request: OptimizationRequest, cache: Path | None) -> StudyCost:
    """Return the cost of the gears, the designs of a usual search, and both analyses at the end.

    Raises `InputError`: the request cannot be planned.
    """
    predicted = predicted_designs(request.checked, cache)
    work, positions = predicted.work, request.search.positions
    design = _design_seconds(request, predicted, positions)
    parts = [
        Work("gears", predicted.bodies, stage="compliance"),
        Work("compliance", work.of(positions, 0), stage="search"),  # all designs share it
        Work("designs", design, usual_designs(request.search), "search"),
    ]
    limited = request.limits != Limits()  # between the positions of the search a design may exceed them
    if limited:
        more = _design_seconds(request, predicted, positions + predicted.positions)
        parts.append(Work("designs within limits", more, REFINED, "confirmation"))
    tables = [
        table_seconds(request.checked, pair, request.checked.request.alignments, cache)
        for pair in (request.pair, request.checked.request.pair)  # of the start, and with all variables
    ]
    figures = _figures_seconds(request, predicted)
    parts += [
        Work("coarse gears", predicted.coarse_bodies, stage="confirmation"),
        Work("analyses", tables[0] + figures, 1, "confirmation"),
        Work("analyses", tables[1] + figures, 2 if limited else 1, "confirmation"),
        Work("steps from the optimum", design, 2 * len(request.variables), "confirmation"),
    ]
    return StudyCost(tuple(parts), predicted.bytes)


def _design_seconds(request: OptimizationRequest, predicted: PredictedDesigns, positions: int) -> float:
    """Return the CPU seconds of a design at positions whose compliance is assembled, at all nodes."""
    nodes, loads = request.scatter.nodes().weight.size, np.size(request.torques)
    return float(nodes * predicted.work.of_flanks(positions, loads))


def _figures_seconds(request: OptimizationRequest, predicted: PredictedDesigns) -> float:
    """Return the CPU seconds of the figures of an analysis, and of a design at finer nodes of the scatter."""
    nodes, work, positions = request.scatter.nodes(), predicted.work, predicted.positions
    flanks = work.of_flanks(positions, request.checked.request.load.size)
    figures = FIGURES * (work.of(positions, 0) + nodes.weight.size * flanks)
    compared = 0 if nodes.finer is None else nodes.weight.size + nodes.finer.weight.size
    design = work.of_flanks(request.search.positions, np.size(request.torques))
    return figures + compared * design
