"""Pairs of gears on parallel axes: external, and a pinion in a ring gear."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bounds import LIMIT_SLACK, Quantity, Text, above, at_least, at_most, below
from fe_contact.errors import InfeasibleGeometry, declared_fields
from fe_contact.flank.involute import involute_function
from fe_contact.geometry.backlash import base_radius_sum, reference_center_distance, tight_center_distance
from fe_contact.geometry.gear import Gear
from fe_contact.geometry.pair_feasibility import (
    FILLET_SLACK,
    refuse_face_overlap,
    refuse_infeasible_pair,
    refuse_jamming,
    refuse_short_flanks,
    refuse_strangers,
)
from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.geometry.ring_gear import RingGear, radial_clearance
from fe_contact.types import BoolArray, FloatArray

if TYPE_CHECKING:
    from fe_contact.geometry.parallel_axes import ParallelAxes
    from fe_contact.geometry.toothing import Toothing


@dataclass(frozen=True)
class GearPair(ParallelAxes):
    """Gear 1 (`pinion`) drives gear 2 (`wheel`).

    Both gears are external; `InternalGearPair` has a ring gear. `ParallelAxes` lists the properties of a
    pair. Both have equal normal module and pressure angle, and opposite helix angles.

    Raises
    ------
    InputError
        A center distance that is no positive number.
    InfeasibleGeometry
        No such pair: "normal module", "pressure angle", "helix angle", "profile shift sum", "contact ratio",
        "interference", "tip clearance".
    """

    wheel: Gear

    def __post_init__(self) -> None:
        refuse_strangers(self.pinion, self.wheel)
        if self.center_distance is None:
            object.__setattr__(self, "center_distance", reference_center_distance(self.pinion, self.wheel))
        refuse_infeasible_pair(self)

    def swapped(self) -> GearPair:
        """Return the same pair with the wheel driving: the same flanks loaded, the gears turning back."""
        return replace(
            self,
            pinion=_turning_back(self.wheel),
            wheel=_turning_back(self.pinion),
            axial_offset=-self.axial_offset,
            shafts=self.shafts[::-1],
        )


def _turning_back(gear: Gear) -> Gear:
    """Return the gear with its teeth in the order in which they mesh the other way round."""
    if gear.pitch_deviation.neutral:
        return gear
    return replace(gear, pitch_deviation=gear.pitch_deviation.reversed)


# A pinion inside a ring gear, on parallel axes (ISO 21771-1).

# Refusal of internal pairs that cannot run or be put together, by the standard term for what is wrong.


# Interference of a tip edge with the mating tooth of an internal pair, off the line of action.


_SAMPLES = 1025


class EdgePath(NamedTuple):
    """A tip edge in the mating gear.

    Attributes
    ----------
    radius : (n,) array
        Distance from the mate's center, m.
    depth : (n,) array
        Arc in m by which the edge is inside the mate's tooth; negative outside.
    """

    radius: FloatArray
    depth: FloatArray


def tip_interference(pair: ParallelAxes) -> float:
    """Depth in m to which a tip edge cuts the mating involute on its way in or out; 0 if the tips pass."""
    return max(_deepest(path, mate, on_fillet=False) for path, mate in _paths(pair))


def trochoidal_interference(pair: ParallelAxes) -> float:
    """Depth in m to which a tip edge cuts the mating fillet; 0 if clear."""
    return max(_deepest(path, mate, on_fillet=True) for path, mate in _paths(pair))


def pinion_edge_path(pair: ParallelAxes) -> EdgePath:
    """Path of the pinion's tip edge in the ring's tooth space, from where it enters to where it leaves."""
    pinion, ring = pair.pinion, pair.wheel
    polar = _lens(pair.center_distance, pinion.tip_radius, ring.tip_radius)
    x, y = pinion.tip_radius * np.sin(polar), pair.center_distance + pinion.tip_radius * np.cos(polar)
    radius = np.hypot(x, y)
    turn = polar + _tip_involute(pinion) - involute_function(pair.working_pressure_angle)
    facing = _pitch_point_angle(pair) + turn / pair.speed_ratio - flank_angle(ring, radius)
    return EdgePath(radius, radius * (np.arctan2(x, y) - facing))


def ring_edge_path(pair: ParallelAxes) -> EdgePath:
    """Path of the ring's tip edge in the pinion's tooth space, from where it enters to where it leaves."""
    pinion, ring, working = pair.pinion, pair.wheel, involute_function(pair.working_pressure_angle)
    polar = _lens(-pair.center_distance, ring.tip_radius, pinion.tip_radius)
    x, y = ring.tip_radius * np.sin(polar), ring.tip_radius * np.cos(polar) - pair.center_distance
    radius = np.hypot(x, y)
    turn = (polar + _tip_involute(ring) - working) * pair.speed_ratio
    facing = turn + working - pinion.base_thickness_half_angle + flank_angle(pinion, radius)
    return EdgePath(radius, radius * (facing - np.arctan2(x, y)))


def flank_angle(gear: Toothing, radius: FloatArray) -> FloatArray:
    """Angle in rad from the tooth's center line to its right flank at `radius`, on involute and fillet."""
    pressure = np.arccos(np.minimum(1.0, gear.base_radius / radius))
    involute = gear.base_thickness_half_angle - gear.sign * (np.tan(pressure) - pressure)
    tool_angle = np.linspace(gear.form_point.tool_angle, 0.5 * math.pi, _SAMPLES)
    height = -gear.sign * gear.trochoid.radius(tool_angle)
    fillet = np.interp(-gear.sign * radius, height, gear.trochoid.polar_angle(tool_angle))
    return np.where(_on_fillet(gear, radius), fillet, involute)


def _on_fillet(gear: Toothing, radius: FloatArray) -> BoolArray:
    """Whether a radius lies below the form circle (beyond it in a ring)."""
    return np.asarray(gear.sign * (radius - gear.form_radius) < 0.0)


def _lens(offset: float, tip_radius: float, mating_tip_radius: float) -> FloatArray:
    """Angles of a tip edge about its gear, at height `offset`, while it is inside the other tip circle."""
    cosine = (mating_tip_radius**2 - tip_radius**2 - offset**2) / (2.0 * offset * tip_radius)
    widest = math.acos(max(-1.0, min(1.0, cosine)))
    return np.linspace(-widest, widest, _SAMPLES)


def _tip_involute(gear: Toothing) -> float:
    return involute_function(math.acos(min(1.0, gear.base_radius / gear.tip_radius)))


def _pitch_point_angle(pair: ParallelAxes) -> float:
    """Angle of the ring tooth's center line when its flank is at the pitch point, rad."""
    return pair.wheel.base_thickness_half_angle + involute_function(pair.working_pressure_angle)


def _paths(pair: ParallelAxes) -> tuple[tuple[EdgePath, Toothing], ...]:
    return (pinion_edge_path(pair), pair.wheel), (ring_edge_path(pair), pair.pinion)


def _deepest(path: EdgePath, mate: Toothing, on_fillet: bool) -> float:
    """Largest depth on the mate's fillet or on its involute, at least 0."""
    where = _on_fillet(mate, path.radius) == on_fillet
    return float(np.max(path.depth, initial=0.0, where=where))


_SHORTER = "Raise the ring's tip diameter, or lower the pinion's"


def _refuse_tooth_numbers(pinion: Toothing, ring: Toothing) -> None:
    """Refuse a pinion that is no smaller than the ring."""
    if ring.teeth <= pinion.teeth:
        bound = above(pinion.teeth, name="the pinion's")
        advice = "With standard teeth of 20 deg about ten more are needed for the tips to pass each other."
        raise InfeasibleGeometry("tooth number difference", "wheel.teeth", ring.teeth, bound, advice)


def refuse_infeasible_internal_pair(pair: ParallelAxes) -> None:
    """Raise `InfeasibleGeometry` if the two gears cannot run at their center distance."""
    declared_fields(pair)
    refuse_face_overlap(pair)
    _refuse_short_distance(pair)
    refuse_jamming(pair)
    _refuse_tip_clearance(pair)
    _refuse_contact_ratio(pair)
    refuse_short_flanks(pair)
    _refuse_interference(pair)
    _refuse_tip_interference(pair)
    _refuse_trochoidal_interference(pair)


def _refuse_short_distance(pair: ParallelAxes) -> None:
    """Refuse base circles without a common tangent."""
    shortest = abs(base_radius_sum(pair.pinion, pair.wheel))
    if pair.center_distance <= shortest:
        bound = above(shortest, "m", note=", the difference of the base radii")
        tight = Quantity(tight_center_distance(pair.pinion, pair.wheel), "m", side="high")
        advice = Text.of("Without backlash it is ", tight, ".")
        raise InfeasibleGeometry("center distance", "center_distance", pair.center_distance, bound, advice)


def _refuse_contact_ratio(pair: ParallelAxes) -> None:
    """Refuse a pair that loses contact between one tooth pair and the next."""
    if pair.total_contact_ratio < 1.0:
        bound = f"larger: the contact ratio is {pair.total_contact_ratio:.6g}, below 1"
        advice = "Raise the center distance or the pinion's tip diameter, or lower the ring's tip diameter."
        raise InfeasibleGeometry("contact ratio", "center_distance", pair.center_distance, bound, advice)


def _refuse_tip_clearance(pair: ParallelAxes) -> None:
    """Refuse a tip circle that reaches the mating root circle."""
    at_pinion_tip, at_ring_tip = pair.tip_clearances
    if at_pinion_tip <= 0.0:
        largest = 2.0 * (pair.pinion.tip_radius + at_pinion_tip)
        bound = below(largest, "m", note=", where the tip reaches the ring's root circle")
        advice = "Lower the pinion's tip diameter, or raise the ring's dedendum."
        value = 2.0 * pair.pinion.tip_radius
        raise InfeasibleGeometry("tip clearance", "pinion.tip_diameter", value, bound, advice)
    if at_ring_tip <= 0.0:
        smallest = 2.0 * (pair.wheel.tip_radius - at_ring_tip)
        bound = above(smallest, "m", note=", where the tip reaches the pinion's root circle")
        advice = "Raise the ring's tip diameter, or the pinion's dedendum."
        value = 2.0 * pair.wheel.tip_radius
        raise InfeasibleGeometry("tip clearance", "wheel.tip_diameter", value, bound, advice)


def _refuse_interference(pair: ParallelAxes) -> None:
    """Refuse a tip that meets the mating flank on the line of action where it is no involute."""
    pinion, ring, path = pair.pinion, pair.wheel, pair.path_of_contact
    if path.start < pinion.form_roll_length * (1.0 - LIMIT_SLACK):
        smallest = 2.0 * math.hypot(ring.base_radius, pair.common_tangent + pinion.form_roll_length)
        bound = at_least(smallest, "m", note=", where the tip meets the pinion's form circle")
        advice = "Raise the ring's tip diameter, or the pinion's profile shift or number of teeth."
        value = 2.0 * ring.tip_radius
        raise InfeasibleGeometry("interference", "wheel.tip_diameter", value, bound, advice)
    if pair.common_tangent + path.end > ring.form_roll_length * (1.0 + LIMIT_SLACK):
        reach = ring.form_roll_length - pair.common_tangent
        largest = 2.0 * math.hypot(pinion.base_radius, max(reach, 0.0))
        bound = at_most(largest, "m", note=", where the tip meets the ring's form circle")
        advice = "Lower the pinion's tip diameter, or raise the ring's dedendum or lower its root radius."
        value = 2.0 * pinion.tip_radius
        raise InfeasibleGeometry("interference", "pinion.tip_diameter", value, bound, advice)


def _refuse_tip_interference(pair: ParallelAxes) -> None:
    """Refuse tips that hit each other as they enter or leave."""
    depth = tip_interference(pair)
    if depth > FILLET_SLACK * pair.pinion.normal_module:
        overlap = Quantity(depth, "m", digits=3)
        bound = Text.of("larger: the tips overlap by ", overlap, " in passing")
        difference = pair.wheel.teeth - pair.pinion.teeth
        advice = f"{_SHORTER}, or raise the difference of the tooth numbers, {difference}."
        value = 2.0 * pair.wheel.tip_radius
        raise InfeasibleGeometry("tip interference", "wheel.tip_diameter", value, bound, advice)


def _refuse_trochoidal_interference(pair: ParallelAxes) -> None:
    """Refuse a tip that cuts the mating fillet."""
    depth = trochoidal_interference(pair)
    if depth > FILLET_SLACK * pair.pinion.normal_module:
        cut = Quantity(depth, "m", digits=3)
        bound = Text.of("larger: a tip cuts the mating fillet by ", cut, " off the line of action")
        advice = f"{_SHORTER}, or lower the mate's root radius or raise its dedendum."
        value = 2.0 * pair.wheel.tip_radius
        raise InfeasibleGeometry("trochoidal interference", "wheel.tip_diameter", value, bound, advice)


def _refuse_trimming_interference(clearance: float) -> None:
    """Refuse radial assembly past tips that stand in the way (`clearance` in m below 0)."""
    if clearance < 0.0:
        overlap = Quantity(-clearance, "m", digits=3)
        bound = Text.of("false: the tips are in the way by ", overlap, " on the pinion's base circle")
        advice = f"Mount the pinion along the axis. {_SHORTER}, or raise the difference of the tooth numbers."
        raise InfeasibleGeometry("trimming interference", "radial_assembly", True, bound, advice)


@dataclass(frozen=True)
class InternalGearPair(ParallelAxes):
    """The external gear (`pinion`, gear 1) drives the ring gear (`wheel`, gear 2); see `ParallelAxes`.

    When the ring drives, the same contacts follow in the opposite order: deflections and forces at a position
    are the same, and the position falls with time. Both have equal normal module, pressure angle and helix
    angle, so the hand is the same. The center distance is positive (the standard's -a); backlash falls as it
    grows. With `radial_assembly` the pinion is mounted radially, which "trimming interference" may prevent;
    otherwise it is mounted along the axis.

    Raises
    ------
    InputError
        A center distance that is no positive number.
    InfeasibleGeometry
        No such pair: "normal module", "pressure angle", "helix angle", "tooth number difference", "face
        overlap", "center distance", "profile shift sum", "contact ratio", "tip clearance", "interference",
        "tip interference", "trochoidal interference", "trimming interference".
    """

    wheel: RingGear
    radial_assembly: bool = False

    def __post_init__(self) -> None:
        refuse_strangers(self.pinion, self.wheel)
        _refuse_tooth_numbers(self.pinion, self.wheel)
        if self.center_distance is None:
            object.__setattr__(self, "center_distance", reference_center_distance(self.pinion, self.wheel))
        refuse_infeasible_internal_pair(self)
        if self.radial_assembly:
            _refuse_trimming_interference(self.radial_assembly_clearance)

    @property
    def tooth_number_difference(self) -> int:
        """Teeth of the ring less teeth of the pinion."""
        return self.wheel.teeth - self.pinion.teeth

    @property
    def radial_assembly_clearance(self) -> float:
        """Play in m on the pinion's base circle when it is put in radially, in the middle of its backlash.

        Negative: it must be put in along the axis. Infinite if the tips do not hold it.
        """
        gears = (self.pinion, self.wheel)
        first, second = (math.acos(min(1.0, gear.base_radius / gear.tip_radius)) for gear in gears)
        turn = radial_clearance(1.0 / self.speed_ratio, (first, second), self.working_pressure_angle)
        return self.pinion.base_radius * turn + 0.5 * self.transverse_base_backlash
