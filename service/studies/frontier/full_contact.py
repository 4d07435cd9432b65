"""Full finite-element contact beside the accuracy study: what it is known to cost, and took on the case."""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.accuracy_study.full_contact import ORIGIN
from fe_contact.analysis.frontier import Frontier
from fe_contact.analysis.measured_full_contact import PLANE, PROGRAM, MeasuredFullContact
from service.report import palette
from service.report.figure import Line, Note, number

LIVE = "full contact, run on this case"


def known_cost(found: Frontier) -> list[Line]:
    """Return the known cost of as many positions x loads, with its errors in per cent, if it is known."""
    if not found.known_full_contact:
        return []
    time = np.array([level.seconds(found.solves) for level in found.known_full_contact])
    size = 100.0 * np.array([level.relative_error for level in found.known_full_contact])
    return [Line("full contact, 2-D", time, size, palette.VERMILLION, markers=True)]


def live_point(found: Frontier, error: float) -> tuple[list[Line], list[Note]]:
    """Return the point of the case itself, with an error as a fraction, and its name; nothing without one."""
    measured = found.full_contact
    if measured is None or not error > 0.0:
        return [], []
    time = measured.seconds(found.solves)
    line = Line(LIVE, np.array([time]), np.array([100.0 * error]), palette.PURPLE, width=0, markers=True)
    return [line], [Note(time, 100.0 * error, "full contact")]


def times(found: Frontier) -> list[float]:
    """Return the CPU times of all of them, s."""
    live = [] if found.full_contact is None else [found.full_contact.seconds(found.solves)]
    return [*(level.seconds(found.solves) for level in found.known_full_contact), *live]


def rows(found: Frontier) -> list[tuple[str, ...]]:
    """Return the rows of the table, errors in per cent."""
    known: list[tuple[str, ...]] = [
        (
            f"full contact, {level.unknowns // 1000} k unknowns",
            number(level.seconds(found.solves), 3),
            number(100.0 * level.relative_error, 2),
            "",
            "",
            "known cost",
        )
        for level in found.known_full_contact
    ]
    return known if found.full_contact is None else [*known, _live_row(found, found.full_contact)]


def _live_row(found: Frontier, measured: MeasuredFullContact) -> tuple[str, ...]:
    """One row for the case itself."""
    errors = (measured.mean_error, measured.peak_to_peak_error)
    mean, swing = (number(100.0 * error, 2) if np.isfinite(error) else "" for error in errors)
    title = f"full contact of this case, {measured.unknowns // 1000} k unknowns"
    mark = f"{len(measured.solved)} of {len(measured.points)} positions x loads solved"
    return title, number(measured.seconds(found.solves), 3), mean, swing, "", mark


def _own(measured: MeasuredFullContact) -> str:
    """Say what error the peer states of itself."""
    if not np.isfinite(measured.own_error):
        return ""
    return f" Its own meshes differ by at most {number(100.0 * measured.own_error, 2)} %."


def _left_out(measured: MeasuredFullContact) -> str:
    """Say what its errors hold besides those of the solution."""
    return ", and hold what plane strain leaves out" if measured.solved_in == PLANE else ""


def caption(found: Frontier) -> str:
    """Say where the points come from, and what was measured of them."""
    times = f"Peer: {ORIGIN}; times for the same {found.solves} positions x loads."
    known = f"{times} " if found.known_full_contact else ""
    measured = found.full_contact
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
        f"time is extrapolated, the mean of a position and load times {found.solves}."
        f"{_own(measured)}{beside}"
    )
