"""How a run integrates."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Interval, Kind, above, declared, described, one_of, up_to
from dynamics.checks import declared_fields, integer, positive
from dynamics.errors import InputError

_METHOD = Declared(
    Kind.CHOICE,
    "",
    one_of(("auto", "implicit", "explicit")),
    "implicit: singly diagonally implicit Runge-Kutta of order 4, L-stable; explicit: Dormand-Prince of "
    "order 5; auto: explicit, unless the fastest motion would shorten its steps",
    "auto",
)
_TOLERANCE = Declared(
    Kind.LENGTH,
    "m",
    up_to(1e-3),
    "Allowed step error of the displacements over the run, rms; rotations count times the base radius",
    1e-9,
    written="nm",
)
_FIXED = Declared(Kind.TIME, "s", up_to(1.0), "Step; left out: chosen by error control", 1e-5)
_LARGEST = Declared(Kind.TIME, "s", Interval(gt=1e-12, le=1.0), "Largest step of the error control", 1e-3)


@described
@dataclass(frozen=True)
class Integration:
    """Method and tolerances of the time integration.

    Error control takes no step below `smallest_step`, s. A run of more than `step_limit` steps ends as
    `RunStatus.STEP_LIMIT`. With `estimate_error` it runs again at a tenth of the tolerance and reports the
    difference of the transmission errors.
    """

    method: str = declared("auto", _METHOD)
    tolerance: float = declared(1e-9, _TOLERANCE)
    fixed_step: float | None = declared(None, _FIXED)
    smallest_step: float = 1e-12
    largest_step: float = declared(1e-3, _LARGEST)
    step_limit: int = 100_000_000
    estimate_error: bool = False

    def __post_init__(self) -> None:
        positive("smallest_step", self.smallest_step)
        if self.largest_step <= self.smallest_step:
            bound = above(self.smallest_step, name="smallest_step")
            raise InputError("largest_step", self.largest_step, bound)
        declared_fields(self)
        integer("step_limit", self.step_limit, 1, 2**62)
