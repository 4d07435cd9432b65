"""The record of full contact of a case, as the accuracy study compares its fidelities with it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bounds import written
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.studies.full_contact_record import PLANE, FullContactRecord, solved_in
from fe_contact.errors import SolveError
from fe_contact.solver_version import software_versions
from model_studies.progress import Report
from verification.full_contact import (
    FullContactTable,
    refusal,
    refusal_over_face,
    solve_full_contact,
    solve_full_contact_over_face,
)


def full_contact_refusal(checked: Checked) -> str | None:
    """Say why full contact cannot be run on a request; None if it can."""
    request = checked.request
    if (reason := (refusal if _in_plane(checked) else refusal_over_face)(request.pair)) is not None:
        return reason
    if request.center_distance_change.size > 1 or request.center_distance_change[0] != 0.0:
        return "changes of the center distance: it runs at the nominal one"
    return None


def record_full_contact(checked: Checked, positions: int, report: Report) -> FullContactRecord:
    """Solve full contact of a case under all its loads; points that fail have no number.

    Raises `SolveError`: no point has a solution.

    Parameters
    ----------
    checked : Checked
        Without `full_contact_refusal`.
    positions : int
        Equally spaced over one base pitch, the first at the pitch point.
    report : callable
        Called with the fraction that is done.
    """
    request, fractions = checked.request, [count / positions for count in range(positions)]
    torques = [float(torque) for torque in request.torque]
    tables: Sequence[FullContactTable]
    if _in_plane(checked):
        tables = [solve_full_contact(request.pair, torques, fractions, estimate_error=True, report=report)]
    else:
        tables = solve_full_contact_over_face(
            request.pair,
            torques,
            fractions,
            [float(misalignment) for misalignment in request.misalignment],
            estimate_error=True,
            report=report,
        )
    points = [point for table in tables for row in table.points for point in row]
    if not any(point.status.usable for point in points):
        raise SolveError("; ".join(dict.fromkeys(point.reason for point in points)))
    return FullContactRecord(
        pair=written(request.pair),
        version=software_versions()["lineofaction"],
        solved_in=solved_in(checked),
        misalignment=np.array(request.misalignment, dtype=float),
        position=np.array(fractions),
        torque=np.array(torques),
        transmission_error=np.stack([table.transmission_error for table in tables]),
        error_estimate=np.stack([table.error_estimate for table in tables]),
        unknowns=int(max(table.unknowns.max(initial=0) for table in tables)),
        seconds_per_solve=float(sum(table.cpu_seconds.sum() for table in tables)) / len(points),
    )


def _in_plane(checked: Checked) -> bool:
    return solved_in(checked) == PLANE
