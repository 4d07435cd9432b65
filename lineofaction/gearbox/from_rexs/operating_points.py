"""The operating points of a REXS file: speeds and torques from outside, with their shares of the time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from lineofaction.gearbox.from_rexs.gear_unit import GearUnit, Part

_SPEED, _TORQUE, _POWER = "rotational_speed", "torque_around_u_axis", "power"

_SHARES = ("operating_time_fraction", "load_duration_fraction")
"""Attributes of the share of time: the name of REXS, and the name that one writer uses."""

FORCES: Mapping[str, str] = {
    "force_u_direction": "force along u of the shaft, N",
    "force_v_direction": "force along v of the shaft, N",
    "force_w_direction": "force along w of the shaft, N",
    "torque_around_u_axis": "",
    "torque_around_v_axis": "moment about v of the shaft, N m",
    "torque_around_w_axis": "moment about w of the shaft, N m",
}
"""Attributes of the force and moment of an external load, with their meaning for the account.

The torque about u has the empty meaning: it is read on its own (`torques`), and its entry here stays 0.
"""

LARGEST = 1e9
"""Largest force or moment that a scene takes, N or N m."""


@dataclass(frozen=True)
class OperatingPoint:
    """Speeds, torques, powers and forces that a load case states."""

    name: str
    number: int
    """Number of the operating point in the spectrum, counted from 1."""
    share: float
    """Share of the time, 0 to 1."""
    speeds: Mapping[int, float]
    """Speeds about u, rad/s, by shaft."""
    torques: Mapping[int, float | None]
    """Torques about u from outside, N m, by external load; None: the torque follows from the others."""
    powers: Mapping[int, float]
    """Powers into the unit, W, by external load whose torque is not stated."""
    forces: Mapping[int, tuple[float, ...]]
    """Force along and moment about u, v, w of its shaft, N and N m, by external load that states any; the
    moment about u is 0.
    """

    @staticmethod
    def all_of(unit: GearUnit) -> tuple[OperatingPoint, ...]:
        """Return the load cases of the first spectrum, or the components' own values as one case."""
        unit_parts = unit.of_type("shaft", "external_load", "gear_unit")
        cases = unit.load_cases()
        for number, spectrum in enumerate(unit.model.spectra[1:], 2):
            for case in spectrum.cases:
                for part in case.components:
                    unit.account.say(part, "", "refused", f"load spectrum {number}; the first is taken")
        if not cases:
            return (_point(unit_parts, (), "nominal", 1, 1.0),)
        shares = [_share(case) for case in cases]
        total = sum(share for share in shares if share is not None)
        if total > 0.0 and None not in shares:
            parts = [(share or 0.0) / total for share in shares]
        else:
            parts = [1.0 / len(cases)] * len(cases)
            for root in unit.of_type("gear_unit"):
                root.say(_SHARES[0], "defaulted", "equal shares: not every load case states one")
        rows = enumerate(zip(cases, parts, strict=True), 1)
        return tuple(_point(unit_parts, case, f"load case {n}", n, share) for n, (case, share) in rows)


def _share(case: tuple[Part, ...]) -> float | None:
    """Return the share of the time that a case states, 0 to 1."""
    for part in case:
        if part.type != "gear_unit":
            continue
        for item in _SHARES:
            share = part.number(item, "share of the time, %")
            if share is not None:
                return max(0.0, share)
    return None


def _point(
    unit_parts: tuple[Part, ...], case: tuple[Part, ...], name: str, number: int, share: float
) -> OperatingPoint:
    """Return an operating point; values of a load case replace values of the component itself."""
    parts = [*unit_parts, *case]  # later entries of a part's id replace earlier ones
    loads = [part for part in parts if part.type == "external_load"]
    speeds = {
        part.id: speed
        for part in parts
        if part.type == "shaft" and (speed := part.number(_SPEED, "speed about u, 1/min")) is not None
    }
    torques: dict[int, float | None] = {}
    powers: dict[int, float] = {}
    forces: dict[int, tuple[float, ...]] = {}
    for part in loads:
        _enter_torque(part, torques, powers)
        _enter_forces(part, forces)
    return OperatingPoint(name, number, share, speeds, torques, powers, forces)


def _enter_forces(part: Part, forces: dict[int, tuple[float, ...]]) -> None:
    """Enter the force and moment that a load states, each component in place of one entered before."""
    wrench = list(forces.get(part.id, (0.0,) * len(FORCES)))
    has_value = False
    for index, (item, meaning) in enumerate(FORCES.items()):
        value = part.number(item, meaning) if meaning else None
        if value is None:
            continue
        if not abs(value) <= LARGEST:
            raise part.refusal(item, value, f"from {-LARGEST:g} to {LARGEST:g} N or N m")
        if value == 0.0 == wrench[index]:  # a zero that replaces nothing
            part.say(item, "ignored", "0")
        wrench[index], has_value = value, True
    if has_value:
        forces[part.id] = tuple(wrench)


def _enter_torque(part: Part, torques: dict[int, float | None], powers: dict[int, float]) -> None:
    """Enter the torque of a load in N m, or its power in W.

    A load that transmits torque but states neither has the torque None, which follows from the other loads.
    """
    torque = part.number(_TORQUE, "torque about u from outside, N m")
    power = part.number(_POWER, "power into the unit, kW")
    if torque is not None:
        torques[part.id] = torque
        powers.pop(part.id, None)
    elif power is not None:
        torques[part.id] = None
        powers[part.id] = power
    elif part.id not in torques:
        transmits = part.value("transmits_torque")
        if transmits is not None:
            part.say("transmits_torque", "taken", "whether the load passes torque on")
        if transmits is True:
            torques[part.id] = None
