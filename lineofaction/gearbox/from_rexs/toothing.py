"""Macro geometry of a gear as its file gives it, in SI (ISO 21771-1)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from lineofaction.gearbox.from_rexs.flank_sides import LoadedFlank
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.problems import BadInput


@dataclass(frozen=True)
class ToothingData:
    """Numbers of a gear's toothing; lengths in m, angles in rad, all numbers but angles and shift positive.

    Attributes
    ----------
    sign : int
        1 of an external gear, -1 of a ring gear.
    helix_angle : float
        > 0: right hand.
    profile_shift_coefficient : float or None
        None where the file gives none.
    """

    part: Part
    sign: int
    teeth: int
    normal_module: float
    pressure_angle: float
    helix_angle: float
    face_width: float
    profile_shift_coefficient: float | None

    @cached_property
    def reference_diameter(self) -> float:
        """Reference diameter d = z m_n / cos(beta), m."""
        return self.teeth * self.normal_module / math.cos(self.helix_angle)

    @cached_property
    def transverse_pressure_angle(self) -> float:
        """alpha_t, rad."""
        return math.atan(math.tan(self.pressure_angle) / math.cos(self.helix_angle))


def toothing_of(gear: Part, loaded: LoadedFlank) -> ToothingData:
    """Return the numbers of a gear.

    Raises
    ------
    BadInput
        A number that every gear has is missing or impossible, named by component and attribute.
    """
    teeth = required(gear, "number_of_teeth", "teeth")
    ring = gear.type == "ring_gear"
    if teeth != round(teeth) or teeth == 0.0 or (teeth < 0.0 and not ring):
        bound = f"a whole number {'other than' if ring else 'above'} 0"
        advice = "" if teeth > 0.0 else "A ring gear is a component of the type ring_gear."
        raise BadInput.of(f"{gear.place}, number_of_teeth", teeth, bound, advice)
    return ToothingData(
        part=gear,
        sign=-1 if ring else 1,
        teeth=abs(round(teeth)),
        normal_module=positive(gear, "normal_module", "normal_module_mm"),
        pressure_angle=_pressure_angle(gear, loaded),
        helix_angle=_helix_angle(gear),
        face_width=positive(gear, "face_width", "face_width_mm"),
        profile_shift_coefficient=_shift(loaded),
    )


def required(part: Part, item: str, words: str) -> float:
    """Return a number that a component must have.

    Raises
    ------
    BadInput
        It is missing.
    """
    value = part.number(item, words)
    if value is None:
        raise BadInput.of(f"{part.place}, {item}", None, "given", f"{part.name} needs it.")
    return value


def positive(part: Part, item: str, words: str) -> float:
    """Return a number above zero that a component must have.

    Raises
    ------
    BadInput
        It is missing, zero or negative.
    """
    value = required(part, item, words)
    if not value > 0.0:
        raise BadInput.of(f"{part.place}, {item}", value, "above 0")
    return value


def _pressure_angle(gear: Part, loaded: LoadedFlank) -> float:
    """Return the normal pressure angle of the loaded flank, else of the other, else of the gear."""
    for part in (*loaded.flanks, gear):
        value = part.number("normal_pressure_angle", "normal_pressure_angle_deg")
        if value is not None:
            _say_difference(loaded, "normal_pressure_angle", value)
            return value
    gear.say("normal_pressure_angle", "defaulted", "20 deg (ISO 53)")
    return math.radians(20.0)


def _helix_angle(gear: Part) -> float:
    """Return the helix angle, > 0 for a right hand; a spur gear may leave it out."""
    value = gear.number("helix_angle_reference_diameter", "helix_angle_deg; > 0 is right hand")
    if value is None:
        gear.say("helix_angle_reference_diameter", "defaulted", "0: a spur gear")
        return 0.0
    if not abs(value) < math.radians(80.0):
        field = f"{gear.place}, helix_angle_reference_diameter"
        raise BadInput.of(field, math.degrees(value), "-80 to 80 deg")
    return value + 0.0  # -0.0 becomes 0.0


def _shift(loaded: LoadedFlank) -> float | None:
    """Return the profile shift coefficient of the loaded flank, else of the other."""
    for flank in loaded.flanks:
        value = flank.number("addendum_modification_coefficient", "profile_shift_coefficient")
        if value is not None:
            _say_difference(loaded, "addendum_modification_coefficient", value)
            return value
    return None


def _say_difference(loaded: LoadedFlank, item: str, value: float) -> None:
    """State that a value of the unloaded flank is left aside where it differs."""
    other = loaded.other
    own = None if other is None else other.number(item, "as of the loaded flank")
    if other is not None and own is not None and own != value:
        other.say(item, "ignored", f"the case has the loaded {loaded.side} flank's")
