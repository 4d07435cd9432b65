"""Geometry of pairs with thickness allowances compared with a listing printed by STplus (DIN 3960).

STplus generates with the upper allowance, x_E = x + A_sne / (2 m_n tan alpha_n); so do the gears here. A_sne
is the upper and A_sni the lower allowance of the tooth thickness.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from fe_contact.geometry import Gear, GearPair, sliding_factor, specific_sliding
from fe_contact.geometry.backlash import tight_shift_sum
from lineofaction.validation.comparison import Comparison, last_digit

MM = 1e-3
DEGREE = math.radians(1.0)
CENTER_DISTANCE_TOLERANCE = 17.5e-6
"""Tolerance JS 7 of center distances from 80 to 120 mm (ISO 286), m; the listing prints it rounded."""

Row = dict[str, str]
Values = Callable[["Listing"], Sequence[float]]
"""Function that returns the numbers of both gears or of the pair, in mm, degrees or 1."""


def listed_quantities(data: Path, pair: str, iterated_mm: dict[str, float]) -> Iterator[Comparison]:
    """Compare every printed quantity of a pair; `iterated_mm`: errors of quantities that STplus iterates."""
    with data.open(encoding="utf-8", newline="") as lines:
        rows = [row for row in csv.DictReader(lines) if row["pair"] == pair]
    listing = Listing(listed_pair(rows, "A_sne"), listed_pair(rows, "A_sni"))
    for row in rows:
        if row["kind"] != "printed" or row["symbol_listing"] not in QUANTITIES:
            continue
        symbol = row["symbol_listing"]
        printed = [(column, row[column]) for column in ("pinion", "wheel", "pair_value") if row[column]]
        for (column, text), value in zip(printed, QUANTITIES[symbol](listing), strict=True):
            error = max(last_digit(text), iterated_mm.get(symbol, 0.0))
            name = symbol if column == "pair_value" else f"{symbol} of the {column}"
            yield Comparison(name, "", float(text), error, value)


def _number(rows: Sequence[Row], symbol: str, column: str) -> float:
    """Return a number of a gear or of the pair; NaN where the listing has none."""
    values = [row[column] or row["pair_value"] for row in rows if row["symbol_listing"] == symbol]
    return float(values[0]) if values and values[0] else math.nan


def _of_kind(rows: Sequence[Row], kind: str) -> list[Row]:
    return [row for row in rows if row["kind"] == kind]


def _gear(rows: Sequence[Row], column: str, hand: float, allowance: str) -> Gear:
    inputs = _of_kind(rows, "input")
    tip = _number(inputs, "KOPFKREISDM", column)
    shift = _number(inputs, "PROFILVERSCHIEBUNG_N", column)
    return Gear(
        round(_number(inputs, "ZAEHNEZAHL", column)),
        _number(inputs, "NORMALMODUL", column) * MM,
        _number(inputs, "ZAHNBREITE", column) * MM,
        bore_diameter=20.0 * MM,
        normal_pressure_angle=math.radians(_number(inputs, "EINGRIFFSWINKEL", column)),
        helix_angle=hand * math.radians(_number(inputs, "SCHRAEGUNGSWINKEL", column)),
        profile_shift_coefficient=0.0 if math.isnan(shift) else shift,
        dedendum_coefficient=_number(inputs, "KOPFHOEHENFAKTOR", column),
        root_radius_coefficient=_number(inputs, "KOPFABRUNDUNGSFAKTOR", column),
        tip_diameter=None if math.isnan(tip) else tip * MM,
        thickness_allowance=-_number(_of_kind(rows, "printed"), allowance, column) * MM,
    )


def listed_pair(rows: Sequence[Row], allowance: str) -> GearPair:
    """Return the pair with the upper or lower allowance; a listed center distance sets the wheel's shift."""
    pinion, wheel = _gear(rows, "pinion", 1.0, allowance), _gear(rows, "wheel", -1.0, allowance)
    distance = _number(_of_kind(rows, "input"), "ACHSABSTAND", "pair_value") * MM
    if math.isnan(distance):
        return GearPair(pinion, wheel)
    angle = math.acos((pinion.base_radius + wheel.base_radius) / distance)
    total = tight_shift_sum(_nominal(pinion), _nominal(wheel), angle)
    shifted = replace(wheel, profile_shift_coefficient=total - pinion.profile_shift_coefficient)
    return GearPair(pinion, shifted, distance)


def _nominal(gear: Gear) -> Gear:
    return replace(gear, thickness_allowance=0.0)


@dataclass(frozen=True)
class Listing:
    """A pair with its upper allowances, and with its lower ones."""

    upper: GearPair
    lower: GearPair

    @property
    def gears(self) -> tuple[Gear, Gear]:
        """Pinion and wheel with their upper allowances."""
        return self.upper.pinion, self.upper.wheel

    @cached_property
    def wider(self) -> GearPair:
        """The pair at the upper end of the tolerance of the center distance."""
        return self.upper.at_center_distance(self.upper.center_distance + CENTER_DISTANCE_TOLERANCE)

    @cached_property
    def rolls(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Roll lengths of pinion and wheel at either end of the path of contact, m."""
        path = self.upper.path_of_contact
        ends = path.start, path.end
        first, second = ((roll, float(self.upper.mating_roll_length(roll))) for roll in ends)
        return first, second

    def sliding(self, gear: int, *, at_tip: bool) -> float:
        """Return the specific sliding of a gear at its tip or at its root."""
        end = 1 if (gear == 0) == at_tip else 0  # the path ends at the pinion's tip, the wheel's root
        return float(specific_sliding(self.upper, self.rolls[end][0])[gear])


def _of_gears(value: Callable[[Gear], float], unit: float = 1.0) -> Values:
    return lambda listing: [value(gear) / unit for gear in listing.gears]


def _of_pair(value: Callable[[GearPair], float], unit: float = 1.0) -> Values:
    return lambda listing: [value(listing.upper) / unit]


def _normal_tip_thickness(gear: Gear) -> float:
    helix = math.atan(math.tan(gear.helix_angle) * gear.tip_radius / gear.reference_radius)
    return gear.tip_tooth_thickness * math.cos(helix)


def _common_depth(pair: GearPair) -> float:
    return pair.pinion.tip_radius + pair.wheel.tip_radius - pair.center_distance


def _active_root_diameters(listing: Listing) -> list[float]:
    # the pinion is active down to the start of the path, gear 0 at end 0, the wheel to its end
    return [
        2.0 * math.hypot(gear.base_radius, listing.rolls[index][index]) / MM
        for index, gear in enumerate(listing.gears)
    ]


def _form_allowances(listing: Listing) -> list[float]:
    roots = _active_root_diameters(listing)
    return [0.5 * root - gear.form_radius / MM for root, gear in zip(roots, listing.gears, strict=True)]


def _addendum_paths(listing: Listing) -> list[float]:
    path = listing.upper.path_of_contact
    return [(path.end - path.pitch_point) / MM, (path.pitch_point - path.start) / MM]


def _tip_sliding_factors(listing: Listing) -> list[float]:
    tips = (1, 0)  # the path of contact ends at the pinion's tip and starts at the wheel's
    return [abs(float(sliding_factor(listing.upper, listing.rolls[end][0]))) for end in tips]


def _rack_addendum(gear: Gear) -> float:
    return (gear.tip_radius - gear.reference_radius) / gear.normal_module - gear.profile_shift_coefficient


def _nominal_thickness(gear: Gear) -> float:
    return _nominal(gear).tooth_thickness


def _normal_thickness(gear: Gear) -> float:
    return _nominal_thickness(gear) * math.cos(gear.helix_angle)


QUANTITIES: dict[str, Values] = {
    "alfa_t": _of_pair(lambda pair: pair.pinion.transverse_pressure_angle, DEGREE),
    "alfa_wt": _of_pair(lambda pair: pair.working_pressure_angle, DEGREE),
    "beta_b": _of_pair(lambda pair: abs(pair.base_helix_angle), DEGREE),
    "z2/z1": _of_pair(lambda pair: pair.speed_ratio),
    "a": _of_pair(lambda pair: pair.center_distance, MM),
    "m_t": _of_pair(lambda pair: pair.pinion.transverse_module, MM),
    "x_1+x_2": lambda listing: [sum(gear.profile_shift_coefficient for gear in listing.gears)],
    "x": _of_gears(lambda gear: gear.profile_shift_coefficient),
    "x*m_n": _of_gears(lambda gear: gear.profile_shift_coefficient * gear.normal_module, MM),
    "p_t": _of_pair(lambda pair: math.pi * pair.pinion.transverse_module, MM),
    "p_n": _of_pair(lambda pair: math.pi * pair.pinion.normal_module, MM),
    "p_x": _of_pair(lambda pair: math.pi * pair.pinion.normal_module / math.sin(pair.pinion.helix_angle), MM),
    "p_et": _of_pair(lambda pair: pair.base_pitch, MM),
    "p_en": _of_pair(lambda pair: pair.base_pitch * math.cos(pair.base_helix_angle), MM),
    "g": _of_pair(lambda pair: pair.active_path.length, MM),
    "h_*": _of_pair(lambda pair: _common_depth(pair) / pair.pinion.normal_module),
    "eps_alfa": _of_pair(lambda pair: pair.transverse_contact_ratio),
    "eps_beta": _of_pair(lambda pair: pair.overlap_ratio),
    "eps_gamma": _of_pair(lambda pair: pair.total_contact_ratio),
    "b_gem": _of_pair(lambda pair: pair.face_width, MM),
    "d_w": lambda listing: [2.0 * radius / MM for radius in listing.upper.operating_pitch_radii],
    "d": _of_gears(lambda gear: 2.0 * gear.reference_radius, MM),
    "d_b": _of_gears(lambda gear: 2.0 * gear.base_radius, MM),
    "d_a": _of_gears(lambda gear: 2.0 * gear.tip_radius, MM),
    "d_Fa": _of_gears(lambda gear: 2.0 * gear.tip_form_radius, MM),
    "d_Nf": _active_root_diameters,
    "d_Ff": _of_gears(lambda gear: 2.0 * gear.form_radius, MM),
    "c_n": _form_allowances,
    "d_f": _of_gears(lambda gear: 2.0 * gear.root_radius, MM),
    "h_aP*": _of_gears(_rack_addendum),
    "h": _of_gears(lambda gear: gear.tip_radius - gear.root_radius, MM),
    "h_gem": _of_pair(_common_depth, MM),
    "h_a": _of_gears(lambda gear: gear.tip_radius - gear.reference_radius, MM),
    "c": lambda listing: [clearance / MM for clearance in listing.upper.tip_clearances],
    "c_*": lambda listing: [c / listing.upper.pinion.normal_module for c in listing.upper.tip_clearances],
    "g_alfa-a": _addendum_paths,
    "K_ga": _tip_sliding_factors,
    "zeta_a": lambda listing: [listing.sliding(gear, at_tip=True) for gear in (0, 1)],
    "zeta_f": lambda listing: [listing.sliding(gear, at_tip=False) for gear in (0, 1)],
    "s_t": _of_gears(_nominal_thickness, MM),
    "A_ste": _of_gears(lambda gear: gear.tooth_thickness - _nominal_thickness(gear), MM),
    "s_n": _of_gears(_normal_thickness, MM),
    "e_n": _of_gears(lambda gear: math.pi * gear.normal_module - _normal_thickness(gear), MM),
    "s_an": _of_gears(_normal_tip_thickness, MM),
    "j_t upper": _of_pair(lambda pair: pair.circumferential_backlash, MM),
    "j_n upper": _of_pair(lambda pair: pair.normal_backlash, MM),
    "j_t lower": lambda listing: [listing.lower.circumferential_backlash / MM],
    "j_n lower": lambda listing: [listing.lower.normal_backlash / MM],
    "j_t change A_Ae": lambda listing: [
        (listing.wider.circumferential_backlash - listing.upper.circumferential_backlash) / MM
    ],
    "j_n change A_Ae": lambda listing: [(listing.wider.normal_backlash - listing.upper.normal_backlash) / MM],
    "x_E": _of_gears(lambda gear: gear.generating_shift_coefficient),
}
"""Quantities by the symbol of the listing, in mm, degrees or 1."""
