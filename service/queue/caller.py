"""The caller who submits, and the limit of jobs at a time."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Caller:
    """The caller who submits.

    Attributes
    ----------
    name : str
        Of the access key; empty without one.
    unfinished_jobs : int or None
        Jobs that may wait or run at the same time; None: no limit but the queue's.
    highest_priority : int or None
        Of its jobs; None: any.
    max_cost_s : float or None
        CPU seconds that each of its jobs may take; None: no limit.
    """

    name: str = ""
    unfinished_jobs: int | None = None
    highest_priority: int | None = None
    max_cost_s: float | None = None


ANYBODY = Caller()
