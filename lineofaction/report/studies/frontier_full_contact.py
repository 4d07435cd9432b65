"""Full finite-element contact beside the accuracy study: what it is known to cost, and took on the case."""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.studies.frontier import Frontier
from fe_contact.analysis.studies.measured_full_contact import ORIGIN, PLANE, PROGRAM, MeasuredFullContact
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import number
from lineofaction.report.studies.frontier_peer import Peer

LIVE = "full contact, run on this case"


def peers(study: Frontier) -> list[Peer]:
    """Return the known cost of as many positions x loads, and the point of the case itself."""
    known, measured = _known_cost(study), study.full_contact
    return known if measured is None else [*known, _of_case(measured, study.solves)]


def _known_cost(study: Frontier) -> list[Peer]:
    """Return what is known of this very pair, if anything is."""
    levels = study.known_full_contact
    if not levels:
        return []
    titles = tuple(f"full contact, {level.unknowns // 1000} k unknowns" for level in levels)
    time = np.array([level.seconds(study.solves) for level in levels])
    errors = {"mean_error": np.array([level.relative_error for level in levels])}
    return [Peer("full contact, 2-D", titles, time, errors, "known cost", palette.VERMILLION, 1.8)]


def _of_case(measured: MeasuredFullContact, solves: int) -> Peer:
    title = f"full contact of this case, {measured.unknowns // 1000} k unknowns"
    mark = f"{len(measured.solved)} of {len(measured.points)} positions x loads solved"
    names = ("mean_error", "peak_to_peak_error")
    errors = {name: np.array([getattr(measured, name)]) for name in names}
    time = np.array([measured.seconds(solves)])
    return Peer(LIVE, (title,), time, errors, mark, palette.PURPLE, 0.0, "full contact")


def _own(measured: MeasuredFullContact) -> str:
    """Say what error the peer states of itself."""
    if not np.isfinite(measured.own_error):
        return ""
    return f" Its own meshes differ by at most {number(100.0 * measured.own_error, 2)} %."


def _left_out(measured: MeasuredFullContact) -> str:
    return ", and hold what plane strain leaves out" if measured.solved_in == PLANE else ""


def caption(study: Frontier) -> str:
    """Say where the points come from, and what was measured of them."""
    times = f"Peer: {ORIGIN}; times for the same {study.solves} positions x loads."
    known = f"{times} " if study.known_full_contact else ""
    measured = study.full_contact
    if measured is None:
        return known.strip()
    own = measured.plane_strain_mean
    beside = (
        f" Our plane strain differs from it by {number(100.0 * own, 2)} % of the mean."
        if np.isfinite(own)
        else ""
    )
    return (
        f"{known}On this case {PROGRAM} solved {measured.positions} positions under all loads in "
        f"{measured.solved_in} ({measured.unknowns // 1000} k unknowns, {number(measured.cpu_seconds, 3)} "
        f"CPU s): its errors are those at these positions, the worst of all loads{_left_out(measured)}; its "
        f"time is extrapolated, the mean of a position and load times {study.solves}."
        f"{_own(measured)}{beside}"
    )
