"""What a run stores."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, declared, described, integers, one_of, up_to
from dynamics.checks import declared_fields

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
_RECEIPT = Declared(
    Kind.CHOICE,
    "",
    one_of(("full", "minimal")),
    "full: measure the errors of time steps and tables in windows of the run (6 to 21 % more time); minimal: "
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
_FILTER = Declared(
    Kind.SWITCH,
    "",
    None,
    "Filter the output against aliasing from above half the rate; false: unfiltered samples",
    True,
)


@described
@dataclass(frozen=True)
class Outputs:
    """The outputs that a run stores.

    With `energy_audit` the run integrates the powers and balances them at the end, which takes a third to
    three quarters more time, more with more levels in the tables.
    """

    sample_rate: float | None = declared(None, _RATE)
    bearing_forces: bool = declared(True, _FORCES)
    displacements: bool = declared(False, _DISPLACEMENTS)
    energy_audit: bool = True
    accelerations: bool = declared(False, _ACCELERATIONS)
    receipt: str = declared("full", _RECEIPT)
    mesh_orders: int = declared(10, _ORDERS)
    anti_alias: bool = declared(True, _FILTER)

    def __post_init__(self) -> None:
        declared_fields(self)
