"""Refusal of pairs that cannot run, by the standard term for what is wrong."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, NoReturn

import numpy as np

from bounds import (
    LIMIT_SLACK,
    FieldName,
    Quantity,
    SiNote,
    Text,
    Words,
    above,
    at_least,
    at_most,
    below,
    exactly,
)
from fe_contact.errors import InfeasibleGeometry, declared_fields, finite
from fe_contact.flank.involute import involute_function
from fe_contact.flank.modification import UNMODIFIED
from fe_contact.geometry.backlash import (
    base_radius_sum,
    shift_sum,
    tight_center_distance,
    tight_shift_sum,
)
from fe_contact.geometry.printed_data import backlash_rounding
from fe_contact.types import BoolArray, FloatArray

if TYPE_CHECKING:
    from fe_contact.geometry.parallel_axes import ParallelAxes
    from fe_contact.geometry.toothing import Toothing

# Interference of a tip edge with the mating fillet, off the line of action.


_SAMPLES = 513


def _fillet_penetration(pair: ParallelAxes, tip: Toothing, flank: Toothing) -> float:
    """Depth in m (arc) to which the edge of `tip` cuts the fillet of `flank`, both external; 0 if clear.

    The gears turn in conjugate motion. The edge is followed on both sides of the line of centers, from where
    it crosses the line of action; its path in the mate's frame is compared with the fillet at equal radius.
    """
    opening = math.atan2(tip.tip_roll_length, tip.base_radius)
    widest = abs(pair.working_pressure_angle - opening)
    polar = np.linspace(-widest, widest, _SAMPLES)  # of the edge, from the line of centers
    x = pair.center_distance - tip.tip_radius * np.cos(polar)
    y = -tip.tip_radius * np.sin(polar)
    roll_length = tip.tip_roll_length - tip.base_radius * (polar + opening - pair.working_pressure_angle)
    turned = (pair.common_tangent - roll_length) / flank.base_radius
    edge = pair.working_pressure_angle - turned + flank.base_thickness_half_angle - np.arctan2(y, x)
    radius = np.hypot(x, y)
    tool_angle = np.linspace(0.5 * math.pi, flank.form_point.tool_angle, _SAMPLES)
    fillet_radius = flank.trochoid.radius(tool_angle)
    fillet = np.interp(radius, fillet_radius, flank.trochoid.polar_angle(tool_angle))
    below_form = radius < flank.form_radius
    return float(np.max(radius * (fillet - edge), initial=0.0, where=below_form))


# Interference of a tip edge with the mating tooth of an internal pair, off the line of action.


_EDGE_SAMPLES = 1025


class _EdgePath(NamedTuple):
    """A tip edge in the mating gear.

    Its distance (n,) from the mate's center in m, and the arc (n,) in m by which it is inside the mate's
    tooth; negative outside.
    """

    radius: FloatArray
    depth: FloatArray


def _tip_interference(pair: ParallelAxes) -> float:
    """Depth in m to which a tip edge cuts the mating involute on its way in or out; 0 if the tips pass."""
    return max(_deepest(path, mate, on_fillet=False) for path, mate in _paths(pair))


def _trochoidal_interference(pair: ParallelAxes) -> float:
    """Depth in m to which a tip edge cuts the mating fillet; 0 if clear."""
    return max(_deepest(path, mate, on_fillet=True) for path, mate in _paths(pair))


def _pinion_edge_path(pair: ParallelAxes) -> _EdgePath:
    """Path of the pinion's tip edge in the ring's tooth space, from where it enters to where it leaves."""
    pinion, ring = pair.pinion, pair.wheel
    polar = _lens(pair.center_distance, pinion.tip_radius, ring.tip_radius)
    x, y = pinion.tip_radius * np.sin(polar), pair.center_distance + pinion.tip_radius * np.cos(polar)
    radius = np.hypot(x, y)
    turn = polar + _tip_involute(pinion) - involute_function(pair.working_pressure_angle)
    facing = _pitch_point_angle(pair) + turn / pair.speed_ratio - _flank_angle(ring, radius)
    return _EdgePath(radius, radius * (np.arctan2(x, y) - facing))


def _ring_edge_path(pair: ParallelAxes) -> _EdgePath:
    """Path of the ring's tip edge in the pinion's tooth space, from where it enters to where it leaves."""
    pinion, ring, working = pair.pinion, pair.wheel, involute_function(pair.working_pressure_angle)
    polar = _lens(-pair.center_distance, ring.tip_radius, pinion.tip_radius)
    x, y = ring.tip_radius * np.sin(polar), ring.tip_radius * np.cos(polar) - pair.center_distance
    radius = np.hypot(x, y)
    turn = (polar + _tip_involute(ring) - working) * pair.speed_ratio
    facing = turn + working - pinion.base_thickness_half_angle + _flank_angle(pinion, radius)
    return _EdgePath(radius, radius * (facing - np.arctan2(x, y)))


def _flank_angle(gear: Toothing, radius: FloatArray) -> FloatArray:
    """Angle in rad from the tooth's center line to its right flank at `radius`, on involute and fillet."""
    pressure = np.arccos(np.minimum(1.0, gear.base_radius / radius))
    involute = gear.base_thickness_half_angle - gear.sign * (np.tan(pressure) - pressure)
    tool_angle = np.linspace(gear.form_point.tool_angle, 0.5 * math.pi, _EDGE_SAMPLES)
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
    return np.linspace(-widest, widest, _EDGE_SAMPLES)


def _tip_involute(gear: Toothing) -> float:
    return involute_function(math.acos(min(1.0, gear.base_radius / gear.tip_radius)))


def _pitch_point_angle(pair: ParallelAxes) -> float:
    """Angle of the ring tooth's center line when its flank is at the pitch point, rad."""
    return pair.wheel.base_thickness_half_angle + involute_function(pair.working_pressure_angle)


def _paths(pair: ParallelAxes) -> tuple[tuple[_EdgePath, Toothing], ...]:
    return (_pinion_edge_path(pair), pair.wheel), (_ring_edge_path(pair), pair.pinion)


def _deepest(path: _EdgePath, mate: Toothing, on_fillet: bool) -> float:
    """Largest depth on the mate's fillet or on its involute, at least 0."""
    where = _on_fillet(mate, path.radius) == on_fillet
    return float(np.max(path.depth, initial=0.0, where=where))


_FILLET_SLACK = 1e-6  # of the normal module: the resolution of the sampled tip path
_HALVINGS = 40  # of the range in which the largest clear tip radius is searched
_OPPOSITE_HANDS = "External gears mesh with equal module and pressure angle and opposite helix angle."
_SAME_HAND = "A ring gear and its pinion mesh with equal module, pressure angle and helix angle."
_SHORTER = "Raise the ring's tip diameter, or lower the pinion's"


def refuse_strangers(pinion: Toothing, wheel: Toothing) -> None:
    """Refuse gears that differ in module, pressure or helix angle, and a ring gear that is too small."""
    compared = (
        ("normal module", "normal_module", wheel.normal_module, pinion.normal_module),
        (
            "pressure angle",
            "normal_pressure_angle",
            wheel.normal_pressure_angle,
            pinion.normal_pressure_angle,
        ),
        ("helix angle", "helix_angle", wheel.helix_angle, -wheel.sign * pinion.helix_angle),
    )
    for name, field, value, expected in compared:
        if not math.isclose(value, expected, rel_tol=1e-9, abs_tol=1e-12):
            advice = _OPPOSITE_HANDS if wheel.sign > 0 else _SAME_HAND
            bound = exactly(expected, ", to fit the pinion")
            raise InfeasibleGeometry(name, f"wheel.{field}", value, bound, advice)
    if wheel.sign < 0:
        _refuse_tooth_numbers(pinion, wheel)


def refuse_infeasible_pair(pair: ParallelAxes) -> None:
    """Raise `InfeasibleGeometry` if two gears cannot run at their center distance."""
    declared_fields(pair)
    _refuse_face_overlap(pair)
    for refuse in _INTERNAL_CHECKS if pair.internal else _EXTERNAL_CHECKS:
        refuse(pair)


def _refuse_face_overlap(pair: ParallelAxes) -> None:
    """Refuse gears that pass beside each other."""
    finite("axial_offset", pair.axial_offset, SiNote("In m: 5 mm is 0.005."))
    low, high = pair.common_face
    if high <= low:
        limit = 0.5 * (pair.pinion.face_width + pair.wheel.face_width)
        bound = below(limit, "m", note=" in size")
        raise InfeasibleGeometry("face overlap", "axial_offset", pair.axial_offset, bound)


def _refuse_jamming(pair: ParallelAxes) -> None:
    """Refuse teeth that jam by more than rounding of printed data makes."""
    pinion, wheel = pair.pinion, pair.wheel
    touching = pair.center_distance <= abs(base_radius_sum(pinion, wheel))
    if not touching and pair.transverse_base_backlash >= 0.0:
        return
    tight = tight_center_distance(pinion, wheel)
    bound = (at_most if pair.internal else at_least)(tight, "m", note=", where the teeth jam")
    distance = Quantity(tight, "m", side="high" if pair.internal else "low")
    advice = Text.of("Without backlash: ", FieldName("center_distance"), " = ", distance)
    if not touching:
        largest = Quantity(tight_shift_sum(pinion, wheel, pair.working_pressure_angle), side="high")
        instead = Text.of(largest, " instead of ", Quantity(shift_sum(pinion, wheel)))
        advice = Text.of(advice, ", or x_1 + x_2 = ", instead, ". ", _beyond_rounding(pair))
    advice = Text.of(advice, ".")
    raise InfeasibleGeometry("profile shift sum", "center_distance", pair.center_distance, bound, advice)


def _beyond_rounding(pair: ParallelAxes) -> Text:
    """Say how large a jam is beside what rounding of printed data makes."""
    jam, rounding = (
        -pair.transverse_base_backlash,
        backlash_rounding(pair.pinion, pair.wheel, pair.center_distance),
    )
    most = Text.of("rounding of the printed values makes ", Quantity(rounding, "m", digits=2), " at most")
    return Text.of("Jam ", Quantity(jam, "m", digits=3), "; ", most)


def _refuse_contact_ratio(pair: ParallelAxes) -> None:
    if pair.total_contact_ratio < 1.0:
        value = pair.total_contact_ratio
        if pair.overlap_ratio == 0.0:
            value = pair.transverse_contact_ratio
        bound = f"smaller: the contact ratio is {value:.6g}, below 1"
        advice = "Lower the center distance, or raise the tip diameters or the number of teeth."
        raise InfeasibleGeometry("contact ratio", "center_distance", pair.center_distance, bound, advice)


def _refuse_short_flanks(pair: ParallelAxes) -> None:
    """Refuse tip edges that end the usable flanks before the next tooth pair is in contact."""
    value = pair.active_contact_ratio + pair.overlap_ratio
    if value >= 1.0:
        return
    gears = {"pinion": pair.pinion, "wheel": pair.wheel}
    name = max(gears, key=lambda each: abs(gears[each].tip_roll_length - gears[each].tip_form_roll_length))
    shape = gears[name].modification
    field = "tip_rounding" if shape.tip_rounding else "tip_chamfer"
    bound = f"smaller: between the tip form circles the contact ratio is {value:.6g}, below 1"
    raise InfeasibleGeometry("contact ratio", f"{name}.modification.{field}", getattr(shape, field), bound)


def _refuse_tip_clearance(pair: ParallelAxes) -> None:
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        largest = pair.center_distance - mate.root_radius
        if gear.tip_radius >= largest:
            bound = below(2.0 * largest, "m", note=", where the tip reaches the mating root circle")
            advice = "Lower the tip diameter or the addendum, or raise the mate's dedendum."
            raise InfeasibleGeometry(
                "tip clearance", f"{name}.tip_diameter", 2.0 * gear.tip_radius, bound, advice
            )


def _refuse_interference(pair: ParallelAxes) -> None:
    """Refuse a tip that meets the mating flank below its form point, where it is no involute."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        lowest = pair.common_tangent - gear.tip_roll_length  # on the mate
        if lowest < mate.form_roll_length * (1.0 - LIMIT_SLACK):
            reason = "where the tip meets the mating form circle"
            advice = "Lower the tip diameter or the addendum, or raise the mate's profile shift or dedendum."
            _refuse_long_tip(pair, name, gear, reason, advice)


def _refuse_fillet_interference(pair: ParallelAxes) -> None:
    """Refuse a tip that cuts the mating fillet on its way through the tooth space."""
    gears = (("pinion", pair.pinion, pair.wheel), ("wheel", pair.wheel, pair.pinion))
    for name, gear, mate in gears:
        depth = _fillet_penetration(pair, gear, mate)
        if depth > _FILLET_SLACK * gear.normal_module:
            cut = Quantity(depth, "m", digits=3)
            reason = Text.of("the tip cuts the mating fillet by ", cut, " off the line of action")
            advice = "Lower the tip diameter or the addendum, or the mate's root radius."
            _refuse_long_tip(pair, name, gear, reason, advice)


def _refuse_long_tip(pair: ParallelAxes, name: str, gear: Toothing, reason: Words, advice: str) -> NoReturn:
    """Refuse a tip diameter, and say which one is clear of the mating flank and fillet."""
    mate = pair.wheel if gear is pair.pinion else pair.pinion
    largest = _largest_clear_tip(pair, gear, mate)
    bound = (
        Text.of("smaller: ", reason) if largest is None else at_most(largest, "m", note=Text.of(", ", reason))
    )
    raise InfeasibleGeometry("interference", f"{name}.tip_diameter", 2.0 * gear.tip_radius, bound, advice)


def _largest_clear_tip(pair: ParallelAxes, gear: Toothing, mate: Toothing) -> float | None:
    """Return the largest tip diameter in m that interferes nowhere, None if even the form diameter does."""
    reach = max(pair.common_tangent - mate.form_roll_length, 0.0)
    low, high = gear.form_radius, min(gear.tip_radius, math.hypot(gear.base_radius, reach))

    def cuts(radius: float) -> bool:
        tip_diameter = 2.0 * radius
        shorter = replace(gear, tip_diameter=tip_diameter, modification=UNMODIFIED)
        return _fillet_penetration(pair, shorter, mate) > _FILLET_SLACK * gear.normal_module

    low += 1e-6 * gear.normal_module
    if high <= low or cuts(low):
        return None
    if not cuts(high):
        return 2.0 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if cuts(middle) else (middle, high)
    return 2.0 * low


# A pinion in a ring gear.


def _refuse_tooth_numbers(pinion: Toothing, ring: Toothing) -> None:
    if ring.teeth <= pinion.teeth:
        bound = above(pinion.teeth, name="the pinion's")
        advice = "With standard teeth of 20 deg about ten more are needed for the tips to pass each other."
        raise InfeasibleGeometry("tooth number difference", "wheel.teeth", ring.teeth, bound, advice)


def _refuse_short_distance(pair: ParallelAxes) -> None:
    shortest = abs(base_radius_sum(pair.pinion, pair.wheel))
    if pair.center_distance <= shortest:
        bound = above(shortest, "m", note=", the difference of the base radii")
        tight = Quantity(tight_center_distance(pair.pinion, pair.wheel), "m", side="high")
        advice = Text.of("Without backlash it is ", tight, ".")
        raise InfeasibleGeometry("center distance", "center_distance", pair.center_distance, bound, advice)


def _refuse_internal_contact_ratio(pair: ParallelAxes) -> None:
    if pair.total_contact_ratio < 1.0:
        bound = f"larger: the contact ratio is {pair.total_contact_ratio:.6g}, below 1"
        advice = "Raise the center distance or the pinion's tip diameter, or lower the ring's tip diameter."
        raise InfeasibleGeometry("contact ratio", "center_distance", pair.center_distance, bound, advice)


def _refuse_internal_tip_clearance(pair: ParallelAxes) -> None:
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


def _refuse_internal_interference(pair: ParallelAxes) -> None:
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
    depth = _tip_interference(pair)
    if depth > _FILLET_SLACK * pair.pinion.normal_module:
        overlap = Quantity(depth, "m", digits=3)
        bound = Text.of("larger: the tips overlap by ", overlap, " in passing")
        difference = pair.wheel.teeth - pair.pinion.teeth
        advice = f"{_SHORTER}, or raise the difference of the tooth numbers, {difference}."
        value = 2.0 * pair.wheel.tip_radius
        raise InfeasibleGeometry("tip interference", "wheel.tip_diameter", value, bound, advice)


def _refuse_trochoidal_interference(pair: ParallelAxes) -> None:
    depth = _trochoidal_interference(pair)
    if depth > _FILLET_SLACK * pair.pinion.normal_module:
        cut = Quantity(depth, "m", digits=3)
        bound = Text.of("larger: a tip cuts the mating fillet by ", cut, " off the line of action")
        advice = f"{_SHORTER}, or lower the mate's root radius or raise its dedendum."
        value = 2.0 * pair.wheel.tip_radius
        raise InfeasibleGeometry("trochoidal interference", "wheel.tip_diameter", value, bound, advice)


def refuse_trimming_interference(clearance: float) -> None:
    """Refuse radial assembly past tips that stand in the way (`clearance` in m below 0)."""
    if clearance < 0.0:
        overlap = Quantity(-clearance, "m", digits=3)
        bound = Text.of("false: the tips are in the way by ", overlap, " on the pinion's base circle")
        advice = f"Mount the pinion along the axis. {_SHORTER}, or raise the difference of the tooth numbers."
        raise InfeasibleGeometry("trimming interference", "radial_assembly", True, bound, advice)


_EXTERNAL_CHECKS = (
    _refuse_jamming,
    _refuse_contact_ratio,
    _refuse_short_flanks,
    _refuse_tip_clearance,
    _refuse_interference,
    _refuse_fillet_interference,
)
_INTERNAL_CHECKS = (
    _refuse_short_distance,
    _refuse_jamming,
    _refuse_internal_tip_clearance,
    _refuse_internal_contact_ratio,
    _refuse_short_flanks,
    _refuse_internal_interference,
    _refuse_tip_interference,
    _refuse_trochoidal_interference,
)
