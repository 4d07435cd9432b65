"""Contact of one load and one alignment, the start of flank results and deformed gears."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from fe_contact.analysis.checks.assumptions import check_single_point
from fe_contact.analysis.checks.repetition import settled, with_effects
from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.analysis.tables import condensed_bodies
from fe_contact.errors import InputError, SolveError, finite
from fe_contact.options import Run
from fe_contact.types import FloatArray, Json, Status
from model_studies.stage_clock import StageClock

POSITIONS = 64
"""Number of positions over one mesh cycle where none is requested."""
LISTED = 5
"""Positions without a solution that a message names."""


def solved_point(
    checked: Checked, at: ArrayLike | None, clock: StageClock, run: Run
) -> tuple[SolvedOperatingPoint, Json]:
    """Solve an operating point at positions, check its assumptions, and repeat the solution if needed.

    Raises `InputError`: a value that cannot be used, by field name; `MeshError`, `SolveError` as
    `solve_operating_point`, or an assumption does not hold and `on_violation` is "fail".

    Parameters
    ----------
    checked : Checked
        Of one load and one alignment.
    at : array_like, optional
        Positions in base pitches; default: 64 over one mesh cycle.

    Returns
    -------
    SolvedOperatingPoint
        Its request is that of the last run, with the effects that the first showed to be needed.
    dict
        Receipt: times, the plan, `assumptions`, `repeated`.
    """
    position = np.arange(POSITIONS) / POSITIONS if at is None else checked_positions(at)

    def repeat(point: SolvedOperatingPoint, needed: Mapping[str, str]) -> SolvedOperatingPoint:
        return solve_operating_point(
            with_effects(point.checked, needed, check_size=False), position, clock, run
        )

    first = solve_operating_point(checked, position, clock, run)
    made, checks, repeated = settled(first, check_single_point, repeat, clock)
    plan, assumptions = made.plan.to_json(), [check.to_json() for check in checks]
    return made, clock.to_json() | {"plan": plan, "assumptions": assumptions, "repeated": repeated}


def solve_operating_point(
    checked: Checked, position: FloatArray, clock: StageClock, run: Run
) -> SolvedOperatingPoint:
    """Solve the one load and the one alignment of a request at positions (P,).

    Beyond the first base pitch pairs are counted from the one that is then at the place of pair 0. All teeth
    have their own deviations, however few `pitches` of the request a table would cover. Raises `MeshError`,
    `SolveError`: no acceptable mesh, or positions without a solution.
    """
    if checked.request.pitches is not None:
        request = replace(checked.request, pitches=None)
        checked = checked_request(request, check_size=False, neglect=False)
    request = checked.request
    plan = checked.planned(run.cache)
    nominal = condensed_bodies(checked, plan, clock, run, report=partial(run.progress, "compliance"))
    with clock.stage("contact"):
        points = operating_points(request.scene, request.choices, nominal)
        (point,) = points.places
        pitch = np.floor(position).astype(np.int64)
        problem, solution = point.solve(position - pitch, plan.load, pitch if pitch.any() else None)
    run.progress("contact", 1.0)
    if not solution.converged:
        codes = solution.status[:, 0]
        failed = np.flatnonzero(codes)
        names = [f"position {position[i]:.6g}: {Status(int(codes[i])).name}" for i in failed[:LISTED]]
        more = f"; and {failed.size - LISTED} more" if failed.size > LISTED else ""
        reason = f"{failed.size} of {position.size} positions have no solution ({'; '.join(names)}{more})"
        raise SolveError(reason, partial=solution)
    return SolvedOperatingPoint(checked, plan, points, [(problem, solution)])


def checked_positions(at: ArrayLike) -> FloatArray:
    """Return the positions requested; raises `InputError`: they are no numbers, or none."""
    position = np.atleast_1d(np.asarray(at, dtype=float))
    if position.ndim != 1 or position.size == 0:
        raise InputError("at", at, "a list of positions in base pitches")
    for i, value in enumerate(position):
        finite(f"at[{i}]", float(value), "In base pitches: 0 to 1 is one mesh cycle.")
    return position
