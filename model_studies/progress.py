"""Progress of a computation, reported to a caller or to nobody.

A pass is one computation of a table with all its stages; under a tolerance, passes follow until it is met.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from bounds import engineering

Progress = Callable[[str, float], None]
"""Callback for progress, called as progress(stage, fraction); behind a semicolon the stage may say more, see
`stage_name`.
"""

Report = Callable[[float], None]
"""Callback for the fraction done of one piece of work, from 0 to 1."""

ANNOUNCED = 3.0
"""CPU seconds from which on a cost is reported before the work begins."""
_PASS_SHARE = 0.8
"""Share of the remaining fraction that a pass counts if another one may follow. It is large because most
passes are the last.
"""


def stage_name(reported: str) -> str:
    """Return the name of a stage without the remark behind a semicolon."""
    return reported.partition(";")[0]


def announce(progress: Progress, stage: str, seconds: float, subject: str = "") -> None:
    """Report the predicted cost of a stage before it begins, behind its name, if it is more than a moment.

    `progress`: called as progress("pairs; 200 before and after: about 25 CPU s", 0.0).
    """
    if seconds > ANNOUNCED:
        of = f"{subject}: " if subject else ""
        progress(f"{stage}; {of}about {engineering(seconds, 2)} CPU s", 0.0)


def silent(_stage: str, _fraction: float) -> None:
    """Report no progress."""


def unreported(_fraction: float) -> None:
    """Report no fraction."""


def by_cost(report: Report, costs: Mapping[str, float]) -> Progress:
    """Return the progress of parts done one after the other that reports the fraction of all of them.

    Parameters
    ----------
    report : callable
        Called with the fraction of the sum of `costs`.
    costs : mapping
        Predicted cost of each part, in the order in which they are done, >= 0; in any unit. What is none of
        them is not reported.
    """
    total = sum(costs.values())

    def progress(part: str, fraction: float) -> None:
        names = list(costs)
        if part in costs and total > 0.0:
            done = sum(costs[name] for name in names[: names.index(part)])
            report(min((done + fraction * costs[part]) / total, 1.0))

    return progress


class TableFraction:
    """The fraction done of a table, by the predicted cost of its stages; it never falls.

    A new pass counts the whole remaining fraction, or `_PASS_SHARE` of it if another pass may follow.
    `refines`: another pass may follow, as under a tolerance.
    """

    def __init__(self, *, refines: bool = False) -> None:
        self._share = _PASS_SHARE if refines else 1.0
        self._done = 0.0
        self._progress: Progress = silent

    def plan(self, stages: Mapping[str, float]) -> None:
        """Begin a pass with the predicted cost of its stages."""
        begun, share = self._done, self._share * (1.0 - self._done)
        self._progress = by_cost(lambda fraction: self._reach(begun + share * fraction), stages)

    def at(self, stage: str, fraction: float) -> float:
        """Return the completed fraction of the table at a fraction of a stage."""
        self._progress(stage, fraction)
        return self._done

    def _reach(self, fraction: float) -> None:
        self._done = max(self._done, fraction)
