"""Refusal of a pinion in a ring gear that cannot run, with the standard's term for the defect."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bounds import LIMIT_SLACK, Quantity, Text, above, at_least, at_most, below
from fe_contact.errors import InfeasibleGeometry
from fe_contact.geometry.backlash import base_radius_sum, tight_center_distance
from fe_contact.geometry.fillet_interference import FILLET_SLACK
from fe_contact.geometry.tip_interference import tip_interference, trochoidal_interference

if TYPE_CHECKING:
    from fe_contact.geometry.parallel_axes import ParallelAxes
    from fe_contact.geometry.toothing import Toothing


_SHORTER = "Raise the ring's tip diameter, or lower the pinion's"


def refuse_tooth_numbers(pinion: Toothing, ring: Toothing) -> None:
    """Refuse a ring gear with no more teeth than its pinion."""
    if ring.teeth <= pinion.teeth:
        bound = above(pinion.teeth, name="the pinion's")
        remedy = "With standard teeth of 20 deg about ten more are needed for the tips to pass each other."
        raise InfeasibleGeometry("tooth number difference", "wheel.teeth", ring.teeth, bound, remedy)


def refuse_short_distance(pair: ParallelAxes) -> None:
    """Refuse a center distance at which the base circles leave no common tangent."""
    shortest = abs(base_radius_sum(pair.pinion, pair.wheel))
    if pair.center_distance <= shortest:
        bound = above(shortest, "m", note=", the difference of the base radii")
        tight = Quantity(tight_center_distance(pair.pinion, pair.wheel), "m", side="high")
        remedy = Text.of("Without backlash it is ", tight, ".")
        raise InfeasibleGeometry("center distance", "center_distance", pair.center_distance, bound, remedy)


def refuse_internal_contact_ratio(pair: ParallelAxes) -> None:
    """Refuse a total contact ratio below 1."""
    if pair.total_contact_ratio < 1.0:
        bound = f"larger: the contact ratio is {pair.total_contact_ratio:.6g}, below 1"
        remedy = "Raise the center distance or the pinion's tip diameter, or lower the ring's tip diameter."
        raise InfeasibleGeometry("contact ratio", "center_distance", pair.center_distance, bound, remedy)


def refuse_internal_tip_clearance(pair: ParallelAxes) -> None:
    """Refuse a tip that reaches the mate's root circle."""
    at_pinion_tip, at_ring_tip = pair.tip_clearances
    if at_pinion_tip <= 0.0:
        largest = 2.0 * (pair.pinion.tip_radius + at_pinion_tip)
        bound = below(largest, "m", note=", where the tip reaches the ring's root circle")
        remedy = "Lower the pinion's tip diameter, or raise the ring's dedendum."
        value = 2.0 * pair.pinion.tip_radius
        raise InfeasibleGeometry("tip clearance", "pinion.tip_diameter", value, bound, remedy)
    if at_ring_tip <= 0.0:
        smallest = 2.0 * (pair.wheel.tip_radius - at_ring_tip)
        bound = above(smallest, "m", note=", where the tip reaches the pinion's root circle")
        remedy = "Raise the ring's tip diameter, or the pinion's dedendum."
        value = 2.0 * pair.wheel.tip_radius
        raise InfeasibleGeometry("tip clearance", "wheel.tip_diameter", value, bound, remedy)


def refuse_internal_interference(pair: ParallelAxes) -> None:
    """Refuse a tip that meets the mating flank on the line of action where it is no involute."""
    pinion, ring, path = pair.pinion, pair.wheel, pair.path_of_contact
    if path.start < pinion.form_roll_length * (1.0 - LIMIT_SLACK):
        smallest = 2.0 * math.hypot(ring.base_radius, pair.common_tangent + pinion.form_roll_length)
        bound = at_least(smallest, "m", note=", where the tip meets the pinion's form circle")
        remedy = "Raise the ring's tip diameter, or the pinion's profile shift or number of teeth."
        value = 2.0 * ring.tip_radius
        raise InfeasibleGeometry("interference", "wheel.tip_diameter", value, bound, remedy)
    if pair.common_tangent + path.end > ring.form_roll_length * (1.0 + LIMIT_SLACK):
        reach = ring.form_roll_length - pair.common_tangent
        largest = 2.0 * math.hypot(pinion.base_radius, max(reach, 0.0))
        bound = at_most(largest, "m", note=", where the tip meets the ring's form circle")
        remedy = "Lower the pinion's tip diameter, or raise the ring's dedendum or lower its root radius."
        value = 2.0 * pinion.tip_radius
        raise InfeasibleGeometry("interference", "pinion.tip_diameter", value, bound, remedy)


def refuse_tip_interference(pair: ParallelAxes) -> None:
    """Refuse tips that overlap as they pass each other."""
    depth = tip_interference(pair)
    if depth > FILLET_SLACK * pair.pinion.normal_module:
        overlap = Quantity(depth, "m", digits=3)
        bound = Text.of("larger: the tips overlap by ", overlap, " in passing")
        difference = pair.wheel.teeth - pair.pinion.teeth
        remedy = f"{_SHORTER}, or raise the difference of the tooth numbers, {difference}."
        value = 2.0 * pair.wheel.tip_radius
        raise InfeasibleGeometry("tip interference", "wheel.tip_diameter", value, bound, remedy)


def refuse_trochoidal_interference(pair: ParallelAxes) -> None:
    """Refuse a tip edge that cuts the mating fillet off the line of action."""
    depth = trochoidal_interference(pair)
    if depth > FILLET_SLACK * pair.pinion.normal_module:
        cut = Quantity(depth, "m", digits=3)
        bound = Text.of("larger: a tip cuts the mating fillet by ", cut, " off the line of action")
        remedy = f"{_SHORTER}, or lower the mate's root radius or raise its dedendum."
        value = 2.0 * pair.wheel.tip_radius
        raise InfeasibleGeometry("trochoidal interference", "wheel.tip_diameter", value, bound, remedy)


def refuse_trimming_interference(clearance: float) -> None:
    """Refuse radial assembly past tips that stand in the way (`clearance` in m below 0)."""
    if clearance < 0.0:
        overlap = Quantity(-clearance, "m", digits=3)
        bound = Text.of("false: the tips are in the way by ", overlap, " on the pinion's base circle")
        remedy = f"Mount the pinion along the axis. {_SHORTER}, or raise the difference of the tooth numbers."
        raise InfeasibleGeometry("trimming interference", "radial_assembly", True, bound, remedy)
