"""Settings of a run: its integration, and its outputs."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Interval, Kind, above, declared, described, integers, one_of, up_to
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
_RATE = Declared(
    Kind.FREQUENCY,
    "Hz",
    up_to(1e7),
    "Rate of the uniform output grid; left out: as the mesh orders and the highest mode excited by the "
    "meshes need",
    20000.0,
)
_FORCES = Declared(
    Kind.SWITCH,
    "",
    None,
    "Store the force of every bearing, and its moment if the bearing has tilt stiffness",
    True,
)
_DISPLACEMENTS = Declared(Kind.SWITCH, "", None, "Store displacement and velocity of every freedom", False)
_ACCELERATIONS = Declared(
    Kind.SWITCH,
    "",
    None,
    "Store the acceleration of the shaft at every bearing, and of every freedom if displacements are",
    False,
)
_ELASTIC = Declared(
    Kind.SWITCH,
    "",
    None,
    "Store the elastic part of every mesh force, what its table gives at the position and deflection of each "
    "sample: without damping and not filtered, so that impulses at the handover of teeth stay",
    False,
)
_RECEIPT = Declared(
    Kind.CHOICE,
    "",
    one_of(("full", "minimal")),
    "full: measure the errors of time steps and tables in windows of the run (3 to 40 % more time); minimal: "
    "state the tolerance only",
    "full",
)
_ORDERS = Declared(
    Kind.COUNT,
    "",
    integers(1, 1000),
    "Multiples of the mesh frequency that the output contains at the highest speed of the run",
    10,
)
_BAND = Declared(
    Kind.FREQUENCY,
    "Hz",
    Interval(ge=1e3, le=1e6),
    "Highest frequency that the output is made for where its rate is left out: the audio band; orders above "
    "it are those of the linear response",
    20000.0,
)
_FILTER = Declared(
    Kind.SWITCH,
    "",
    None,
    "Filter the output against aliasing from above half the rate; false: unfiltered samples",
    True,
)


@described
@dataclass(frozen=True)
class Integration:
    """Method and tolerances of the time integration.

    Error control takes no step below `smallest_step`, s. A run of more than `step_limit` steps ends as
    `RunStatus.STEP_LIMIT`. With `estimate_error` it runs again at a tenth of the tolerance (half of a
    `fixed_step`) and states the error from the difference of the transmission errors, as it does unasked
    where flanks part or damping is light.
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
        declared_fields(self)
        if self.largest_step <= self.smallest_step:
            bound = above(self.smallest_step, name="smallest_step")
            raise InputError("largest_step", self.largest_step, bound)
        integer("step_limit", self.step_limit, 1, 2**62)


@described
@dataclass(frozen=True)
class Outputs:
    """The outputs that a run stores.

    With `energy_audit` the run integrates the powers and balances them at the end, which takes up to a sixth
    more time, more with tables over misalignment and center distance.
    """

    sample_rate: float | None = declared(None, _RATE)
    bearing_forces: bool = declared(True, _FORCES)
    displacements: bool = declared(False, _DISPLACEMENTS)
    energy_audit: bool = True
    accelerations: bool = declared(False, _ACCELERATIONS)
    elastic_forces: bool = declared(False, _ELASTIC)
    receipt: str = declared("full", _RECEIPT)
    mesh_orders: int = declared(10, _ORDERS)
    band: float = declared(20000.0, _BAND)
    anti_alias: bool = declared(True, _FILTER)

    def __post_init__(self) -> None:
        declared_fields(self)
