"""Rolling bearings of a REXS model by their internal geometry, or by their line in a catalog."""

from __future__ import annotations

import math

from dynamics.bearing_rows import BallBearing, RollerBearing
from dynamics.errors import InputError
from service.from_rexs.gear_unit import GearUnit
from service.from_rexs.part import Part

Row = BallBearing | RollerBearing

_RATING = "radial_static_load_rating"
_CLEARANCE = "operating_radial_bearing_clearance"


def catalog_bearing(unit: GearUnit, part: Part) -> tuple[Row, float] | None:
    """Return a deep groove ball bearing of a catalog line and its static load rating, N.

    None for other types, and where bore, outside diameter or rating are missing or fit no bearing.
    """
    del unit
    names = ("inner_diameter", "outer_diameter", _RATING)
    words = ("bore, mm", "outside diameter, mm", "static load rating, kN")
    bore, outside, rating = (part.number(name, word) for name, word in zip(names, words, strict=True))
    attribute = part.attribute("bearing_type")
    if attribute is None or attribute.value != "radial_grooved_ball_bearing":
        return None
    if bore is None or outside is None or rating is None:
        return None
    from dynamics.rolling_bearings import from_catalog  # noqa: PLC0415 (start-up time)

    try:
        bearing = from_catalog(bore, outside, rating, _clearance(part))
    except InputError as error:
        part.say(_RATING, "refused", f"no deep groove ball bearing has this line: {error}")
        return None
    part.say("bearing_type", "taken", f"{bearing.count} balls of {bearing.diameter * 1e3:.3g} mm, estimated")
    return bearing, rating


def detailed_bearing(unit: GearUnit, part: Part) -> tuple[Row, float] | None:
    """Return a bearing of one row by its geometry, and its static load rating, N; None if some is missing."""
    rows = unit.children(part, "rolling_bearing_row")
    rating = part.number(_RATING, "static load rating, kN")
    if len(rows) != 1 or rating is None:
        reason = f"{len(rows)} rows; one is computed" if len(rows) != 1 else "no static load rating"
        part.say("", "taken", f"stiffness not from its geometry: {reason}")
        return None
    elements = unit.children(rows[0], "rolling_element")
    count = rows[0].attribute("number_of_rolling_elements")
    pitch = rows[0].number("reference_diameter_rolling_bearing", "pitch diameter, mm")
    diameter = (
        elements[0].number("diameter_of_rolling_element", "diameter of the element, mm") if elements else None
    )
    if count is None or not isinstance(count.value, int) or pitch is None or diameter is None:
        return None
    rows[0].say("number_of_rolling_elements", "taken", "number of elements")
    try:
        return _row(part, rows[0], elements[0], count.value, (diameter, pitch)), rating
    except InputError as error:
        part.say("", "refused", f"no such bearing: {error}")
        return None


def _row(part: Part, row: Part, element: Part, count: int, sizes: tuple[float, float]) -> Row:
    """Return a row of balls or rollers; grooves that are not stated are those of ISO/TS 16281."""
    diameter, pitch = sizes
    angle = row.number("pressure_angle", "contact angle, deg") or 0.0
    clearance = _clearance(part)
    length = row.number("significant_contact_length_inner_ring", "effective length of the roller, mm")
    length = length or element.number("length_of_rolling_element", "length of the roller, mm")
    kind = part.attribute("bearing_type")
    if kind is not None and "roller" in str(kind.value):
        return RollerBearing(
            count, diameter, length or diameter, pitch, contact_angle=angle, clearance=clearance
        )
    grooves = [
        row.number(f"raceway_radius_of_{ring}_ring", "radius of the groove, mm")
        for ring in ("inner", "outer")
    ]
    inner, outer = (None if radius is None else radius / diameter for radius in grooves)
    return BallBearing(
        count, diameter, pitch, inner or 0.52, outer or 0.53, contact_angle=angle, clearance=clearance
    )


def _clearance(part: Part) -> float:
    """Return the radial clearance in operation, m; 0 where the file gives none or a preload."""
    value = part.number(_CLEARANCE, "radial clearance in operation, um")
    if value is None:
        part.say(_CLEARANCE, "defaulted", "0 um: the file gives none")
        return 0.0
    if value < 0.0 or not math.isfinite(value):
        part.say(_CLEARANCE, "refused", f"{value * 1e6:g} um is a preload, which the bearing's row has not")
        return 0.0
    return value
