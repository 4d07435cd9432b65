"""Types that every room shares: arrays, point status, and a value with its error."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from bounds.types import BoolArray, ComplexArray, FloatArray, IntArray, Json

__all__ = ["BoolArray", "ComplexArray", "Estimate", "FloatArray", "IntArray", "Json", "Status"]


class Status(IntEnum):
    """Outcome of one contact solve, stored with every point of a database."""

    CONVERGED = 0
    ITERATION_LIMIT = 1  # Newton and its fallback both ran out of iterations
    SINGULAR = 2  # the contact matrix lost positive definiteness
    OUT_OF_MODEL = 3  # converged, but the load needs contact that the model does not hold
    NOT_COMPUTED = 4  # the sweep ended before this point

    @property
    def usable(self) -> bool:
        """Whether the value stored with this status is a solution."""
        return self is Status.CONVERGED


@dataclass(frozen=True)
class Estimate:
    """A number with the estimate of its own error."""

    value: float
    error: float
    """`value`, `error`: The number and the half-width of its error band, both in `unit`; error >= 0."""
    unit: str
    """SI unit, e.g. "m"."""

    def __float__(self) -> float:
        return self.value
