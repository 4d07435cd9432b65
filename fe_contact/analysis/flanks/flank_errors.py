"""Errors of the largest line loads, K_Hbeta and the largest pressure, by rougher discretizations.

The error of the model itself was measured against full contact that resolves the free ends
(benchmarks/full_contact_line_load.py).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from fe_contact.analysis.flanks.load_distribution import FlankErrors, LoadDistribution, load_distribution
from fe_contact.analysis.flanks.rougher_solutions import halves, rougher_solutions
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.contact import ContactProblem
from fe_contact.errors import MeshError, SolveError
from fe_contact.types import FloatArray

FIGURES = ("line_load", "face_load_factor", "largest_face_load_factor", "pressure", "edge_line_load")
"""Fields of `FlankErrors`."""
REMAINING = np.array([1.5, 1.5, 1.5, 1.0, 1.5])
"""Error of each figure over its change by rougher positions, slices, patches and meshes.

Searches of flanks use the same factors (benchmarks/limit_coverage.py)."""
FREE_ENDS = {
    "line_load": 0.015,
    "face_load_factor": 0.015,
    "largest_face_load_factor": 0.015,
    "pressure": 0.015,
    "edge_line_load": 0.03,
}
"""Relative errors of the model over the face. On three spur and three helical pairs at 14 alignments the line
load clear of edges is off by -2.1 to +1.5 %, where the references themselves are uncertain by 1.4 %; the
pressure is off by -0.8 to +1.8 %, the load at an edge over a slice by -1.9 to +0.2 %."""
IN_THE_PLANE = {"line_load": 2e-3, "pressure": 5e-3, "edge_line_load": 5e-3}
"""Relative errors of a plane model, which has no ends of the face. On plain, relieved and crowned flanks the
largest pressure is within 0.5 % of full contact, the load at a tip edge within 0.2 %.
"""


def with_errors(
    flanks: LoadDistribution, point: SolvedOperatingPoint, cache: Path | None
) -> LoadDistribution:
    """Return flank results with the errors of their figures.

    Parameters
    ----------
    flanks : LoadDistribution
        Flank results of the solved operating point.
    cache : Path, optional
        Directory of flank compliances: the coarse meshes are taken from it, or computed.
    """
    try:
        changes = list(_changes(flanks, point, cache))
    except (MeshError, SolveError) as error:
        return replace(flanks, errors=FlankErrors(reason=f"the coarse mesh has no solution: {error}"))
    left = REMAINING * np.linalg.norm(changes, axis=0)
    model, reason = _model(flanks)
    errors = {
        name: model[name] + part
        for name, part in zip(FIGURES, left.tolist(), strict=True)
        if name in model and np.isfinite(part)
    }
    kink = _kink_length(flanks, point.problem)
    return replace(flanks, errors=FlankErrors(**errors, reason=reason, kink_length=kink))


def _kink_length(flanks: LoadDistribution, problem: ContactProblem) -> float:
    """Return the strip of the largest pressure in m if a relief begins in it with a kink, else 0."""
    position, pair, stretch = np.unravel_index(flanks.clear_pressure.argmax(), flanks.force.shape)
    pressure = float(flanks.pressure[position, pair, stretch])
    contact = position, pair * flanks.face_position.size + stretch
    line_load = float(flanks.force[position, pair, stretch] / problem.candidates.width[contact])
    half = 2.0 * line_load / (math.pi * pressure)  # half width of Hertz's strip
    about = problem.candidates.gap_at(contact)
    kinked = bool(np.any((about.jump > 0.0) & (np.abs(about.offset) < half)))
    return 2.0 * half if kinked else 0.0


def _model(flanks: LoadDistribution) -> tuple[dict[str, float], str]:
    """Return the relative errors of the figures by the model, and why other figures have no error."""
    if flanks.face_position.size == 1:
        return IN_THE_PLANE, "a plane model assumes an even load"
    if flanks.base_helix_angle and np.any(flanks.at_edge):
        model = {name: part for name, part in FREE_ENDS.items() if name != "largest_face_load_factor"}
        return model, "the load peaks where a contact line ends at a tip edge, over less than a slice"
    return FREE_ENDS, "no contact is clear of an edge"


def _changes(
    flanks: LoadDistribution, point: SolvedOperatingPoint, cache: Path | None
) -> Iterator[FloatArray]:
    """Yield the relative changes of the figures by rougher discretizations."""
    for half in halves(flanks.position):
        yield _change(flanks, flanks.at(half))
    for solutions in rougher_solutions(point, cache):
        yield _change(*(load_distribution(s.pair, s.problem, s.solution) for s in solutions))


def _change(finer: LoadDistribution, rougher: LoadDistribution) -> FloatArray:
    """Return the relative changes of the figures; infinite for a figure that is 0, without such contacts."""
    values = _figures(finer)
    ratio = np.divide(_figures(rougher), values, out=np.full(values.size, np.inf), where=values > 0.0)
    return np.asarray(ratio - 1.0)


def _figures(flanks: LoadDistribution) -> FloatArray:
    """Return the values of `FIGURES`, in SI units."""
    estimates = (
        flanks.largest_line_load,
        flanks.cycle_face_load_factor,
        flanks.largest_face_load_factor,
        flanks.largest_pressure,
        flanks.edge_line_load,
    )
    return np.array([estimate.value for estimate in estimates])
