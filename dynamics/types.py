"""Types that every room shares: arrays and the outcomes of the two solvers."""

from __future__ import annotations

from enum import IntEnum

from bounds.types import BoolArray, ComplexArray, FloatArray, IntArray, Json

__all__ = ["BoolArray", "ComplexArray", "FloatArray", "IntArray", "Json", "RunStatus", "StaticStatus"]


class RunStatus(IntEnum):
    """The end of a time integration, stored with its result."""

    COMPLETED = 0
    STEP_FLOOR = 1  # the step control needs less than the smallest step allowed
    STEP_LIMIT = 2  # the number of steps allowed was used up
    NOT_FINITE = 3  # the motion diverged: NaN, or a step error of a meter
    NO_EQUILIBRIUM = 4  # the run could not start: no static equilibrium under the load at t = 0
    CANCELLED = 5  # on request; the result holds what was computed, and a streamed run can be resumed

    @property
    def usable(self) -> bool:
        """Whether the whole requested duration was computed."""
        return self is RunStatus.COMPLETED


class StaticStatus(IntEnum):
    """The end of the search for the static equilibrium."""

    CONVERGED = 0
    ITERATION_LIMIT = 1  # Newton ran out of iterations
    UNBALANCED = 2  # no position of the bodies carries the load, e.g. a torque that nothing resists

    @property
    def usable(self) -> bool:
        """Whether the position found is an equilibrium."""
        return self is StaticStatus.CONVERGED
