"""Macro geometry of a gear as its file gives it, in SI (ISO 21771-1)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.from_rexs.loaded_flank import LoadedFlank

SHIFT = "addendum_modification_coefficient"


@dataclass(frozen=True)
class ToothingData:
    """Numbers of a gear's toothing; lengths in m, angles in rad, all but angles and shift positive."""

    loaded: LoadedFlank
    sign: int
    """1 of an external gear, -1 of a ring gear."""
    teeth: int
    normal_module: float
    pressure_angle: float
    helix_angle: float
    """> 0: right hand."""
    face_width: float
    profile_shift_coefficient: float | None
    """Profile shift coefficient; None: the file states none."""

    @classmethod
    def of(cls, flank: LoadedFlank) -> ToothingData:
        """Return the numbers of a gear."""
        gear = flank.gear
        teeth = gear.required("number_of_teeth", "teeth")
        ring = gear.type == "ring_gear"
        if teeth != round(teeth) or teeth == 0.0 or (teeth < 0.0 and not ring):
            bound = f"a whole number {'other than' if ring else 'above'} 0"
            remedy = "" if teeth > 0.0 else "A ring gear is a component of the type ring_gear."
            raise gear.refusal("number_of_teeth", teeth, bound, remedy)
        return cls(
            loaded=flank,
            sign=-1 if ring else 1,
            teeth=abs(round(teeth)),
            normal_module=gear.positive("normal_module", "normal_module_mm"),
            pressure_angle=_pressure_angle(flank),
            helix_angle=_helix_angle(gear),
            face_width=gear.positive("face_width", "face_width_mm"),
            profile_shift_coefficient=_of_flanks(flank, SHIFT, "profile_shift_coefficient"),
        )

    @property
    def part(self) -> Part:
        """The gear."""
        return self.loaded.gear

    @cached_property
    def reference_diameter(self) -> float:
        """Reference diameter d = z m_n / cos(beta), m."""
        return self.teeth * self.normal_module / math.cos(self.helix_angle)

    @cached_property
    def transverse_pressure_angle(self) -> float:
        """alpha_t, rad."""
        return math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))


def _pressure_angle(flank: LoadedFlank) -> float:
    """Return the normal pressure angle of the loaded flank, else of the other, else of the gear."""
    item, field = "normal_pressure_angle", "normal_pressure_angle_deg"
    value = _of_flanks(flank, item, field)
    if value is None:
        value = flank.gear.number(item, field)
        if value is not None:
            _say_difference(flank, item, value)
    if value is None:
        flank.gear.say(item, "defaulted", "20 deg (ISO 53)")
        return math.radians(20.0)
    return value


def _of_flanks(loaded: LoadedFlank, item: str, field: str) -> float | None:
    """Return a number of the loaded flank, else of the other."""
    value = next((value for flank in loaded.flanks if (value := flank.number(item, field)) is not None), None)
    if value is not None:
        _say_difference(loaded, item, value)
    return value


def _helix_angle(gear: Part) -> float:
    item = "helix_angle_reference_diameter"
    value = gear.number(item, "helix_angle_deg; > 0 is right hand", 0.0, "0: a spur gear")
    if not abs(value) < math.radians(80.0):
        raise gear.refusal(item, math.degrees(value), "-80 to 80 deg")
    return value + 0.0  # -0.0 becomes 0.0


def _say_difference(flank: LoadedFlank, item: str, value: float) -> None:
    """State that a value of the unloaded flank is left aside where it differs."""
    other = flank.other
    value_of_other = None if other is None else other.number(item, "as of the loaded flank")
    if other is not None and value_of_other is not None and value_of_other != value:
        other.say(item, "ignored", f"the case has the loaded {flank.side} flank's")
