"""The work of the integrator."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from dynamics.types import Json


@dataclass(frozen=True)
class StepStatistics:
    """Counts and sizes of the steps of a run.

    Attributes
    ----------
    accepted, rejected : int
        Steps.
    newton_failures : int
        Rejected steps in which Newton's method failed.
    newton_mean : float
        Newton iterations per implicit stage; 0 for an explicit method.
    newton_most : int
        In one stage.
    smallest_step, largest_step : float
        Accepted, s.
    """

    accepted: int
    rejected: int
    newton_failures: int
    newton_mean: float
    newton_most: int
    smallest_step: float
    largest_step: float

    def to_json(self) -> Json:
        """Return plain numbers."""
        return asdict(self)
