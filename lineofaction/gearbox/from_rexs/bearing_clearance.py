"""The clearance of a rolling bearing: in operation, as mounted, or before mounting."""

from __future__ import annotations

import math

from dynamics.bearings.rolling_bearing import CLEARANCE
from lineofaction.gearbox.from_rexs.gear_unit import Part

_STAGES = (
    ("operating_", "in operation"),
    ("mounted_", "as mounted, without temperatures"),
    ("", "before mounting, without fits and temperatures"),
)

_OPERATING = "operating_radial_bearing_clearance"


def radial_clearance(part: Part) -> float:
    """Return the play across the axis between both extremes, m; negative: preload.

    The file may state it in operation, as mounted or before mounting: the first of these counts. Else it is
    the mean of the limits before mounting; 0 where the file gives none.
    """
    for stage, meaning in _STAGES:
        value = _clearance(part, f"{stage}radial_bearing_clearance", meaning)
        if value is not None:
            return value
    limits = [_clearance(part, f"{end}_radial_bearing_clearance", "limit") for end in ("minimum", "maximum")]
    if limits[0] is not None and limits[1] is not None:
        mean = 0.5 * (limits[0] + limits[1])
        part.say(_OPERATING, "derived", f"{1e6 * mean:g} µm: mean of the limits before mounting")
        return mean
    part.say(_OPERATING, "defaulted", "0 µm: the file gives none")
    return 0.0


def axial_clearance(part: Part, contact_angle: float) -> float:
    """Return the distance along the axis to contact of a row with a contact angle, m; negative: preload.

    At each stage, as of `radial_clearance`, a stated axial clearance counts first, then half of the radial
    one times the cotangent of the contact angle. A preload distance is subtracted, unless the file also has a
    preload force.
    """
    way = _way_to_contact(part, contact_angle)
    distance = _clearance(part, "preload_distance", "approach of the rings beyond contact, µm")
    if distance and not part.number("preload_force", "preload force, N"):
        return way - distance
    if distance:
        part.say("preload_distance", "ignored", "the preload force counts")
    return way


def _way_to_contact(part: Part, contact_angle: float) -> float:
    for stage, meaning in _STAGES:
        item = f"{stage}axial_bearing_clearance"
        along = _clearance(part, item, meaning)
        if along is not None:
            return along
        across = _clearance(part, f"{stage}radial_bearing_clearance", meaning)
        if across is not None:
            way = 0.5 * across / math.tan(contact_angle)
            part.say(item, "derived", f"{1e6 * way:.3g} µm: half of the radial clearance over tan(alpha)")
            return way
    part.say("operating_axial_bearing_clearance", "defaulted", "0 µm: the file gives none")
    return 0.0


def _clearance(part: Part, item: str, meaning: str) -> float | None:
    return part.bounded(item, f"clearance {meaning}", CLEARANCE)
