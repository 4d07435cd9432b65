"""Rolling bearings of a REXS model by their internal geometry, or by their line in a catalog."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dynamics.bearings import BallBearing, CatalogLine, RollerBearing
from dynamics.bearings.row import CLEARANCE
from dynamics.errors import InputError
from lineofaction.gearbox.from_rexs.bounded_number import bounded_number
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.rexs.vocabulary import words

# The clearance of a rolling bearing: in operation, as mounted, or before mounting.


_STAGES = (
    ("operating_", "in operation"),
    ("mounted_", "as mounted, without temperatures"),
    ("", "before mounting, without fits and temperatures"),
)
_OPERATING = "operating_radial_bearing_clearance"


def radial_clearance(part: Part) -> float:
    """Return the play across the axis between both extremes, m; negative: preload.

    That in operation counts first, then that as mounted, then that before mounting, stated or the mean of
    its limits; 0 where the file gives none.
    """
    for stage, meaning in _STAGES:
        value = _stated(part, f"{stage}radial_bearing_clearance", meaning)
        if value is not None:
            return value
    limits = [_stated(part, f"{end}_radial_bearing_clearance", "limit") for end in ("minimum", "maximum")]
    if limits[0] is not None and limits[1] is not None:
        mean = 0.5 * (limits[0] + limits[1])
        part.say(_OPERATING, "derived", f"{1e6 * mean:g} um: mean of the limits before mounting")
        return mean
    part.say(_OPERATING, "defaulted", "0 um: the file gives none")
    return 0.0


def axial_clearance(part: Part, contact_angle: float) -> float:
    """Return the way along the axis to contact of a row with a contact angle, m; negative: preload.

    At each stage, as of `radial_clearance`, a stated axial clearance counts first, then half of the radial
    one times the cotangent of the contact angle. A preload distance is taken off, unless a preload force
    follows.
    """
    way = _way_to_contact(part, contact_angle)
    distance = _stated(part, "preload_distance", "approach of the rings beyond contact, um")
    if distance and not part.number("preload_force", "preload force, N"):
        return way - distance
    if distance:
        part.say("preload_distance", "ignored", "the preload force counts")
    return way


def _way_to_contact(part: Part, contact_angle: float) -> float:
    """Return the way along the axis to contact as stated, m; 0 where the file gives none."""
    for stage, meaning in _STAGES:
        along = _stated(part, f"{stage}axial_bearing_clearance", meaning)
        if along is not None:
            return along
        across = _stated(part, f"{stage}radial_bearing_clearance", meaning)
        if across is not None:
            way = 0.5 * across / math.tan(contact_angle)
            item = f"{stage}axial_bearing_clearance"
            part.say(item, "derived", f"{1e6 * way:.3g} um: half of the radial clearance over tan(alpha)")
            return way
    part.say("operating_axial_bearing_clearance", "defaulted", "0 um: the file gives none")
    return 0.0


def _stated(part: Part, item: str, words: str) -> float | None:
    """Return a stated clearance, m; None where there is none or none that a bearing can have."""
    return bounded_number(part, item, f"clearance {words}", CLEARANCE)


Row = BallBearing | RollerBearing

DEEP_GROOVE = "radial_grooved_ball_bearing"
BALLS = (DEEP_GROOVE, "angular_contact_ball_bearing")
ROLLERS = ("radial_roller_bearing", "radial_needle_roller_bearing", "radial_tapered_roller_bearing")
GROOVES = {"inner": 0.52, "outer": 0.53}
_RATING = "radial_static_load_rating"


@dataclass(frozen=True)
class BearingGeometry:
    """A bearing of one row whose geometry is known.

    Attributes
    ----------
    row : BallBearing or RollerBearing
        Its contact angle is not negative: which direction it holds is not in it.
    rating : float
        Static load rating C_0, N.
    line : CatalogLine or None
        The line in a catalog that the row is estimated from.
    """

    row: Row
    rating: float
    line: CatalogLine | None = None


def bearing_geometry(unit: GearUnit, part: Part) -> BearingGeometry | str:
    """Return the geometry of a bearing, or the reason why it is not known."""
    if part.type == "rolling_bearing_with_catalog_geometry":
        return _catalog_bearing(part)
    if part.type == "rolling_bearing_with_detailed_geometry":
        return _detailed_bearing(unit, part)
    return f"a {part.type} has no geometry"


def bearing_type(part: Part) -> str:
    """Return the type of a rolling bearing; the account refuses one that REXS does not have."""
    kind = part.text("bearing_type", "type of the bearing") or ""
    if kind and kind not in words("bearing_types"):
        part.say("bearing_type", "refused", f"{kind} is no type of REXS: the bearing has no geometry")
    return kind


def _catalog_bearing(part: Part) -> BearingGeometry | str:
    """Return a deep groove ball bearing by its line in a catalog."""
    names = ("inner_diameter", "outer_diameter", _RATING)
    words = ("bore, mm", "outside diameter, mm", "static load rating, kN")
    bore, outside, rating = (part.number(name, word) for name, word in zip(names, words, strict=True))
    kind = bearing_type(part)
    if kind != DEEP_GROOVE:
        return f"no geometry follows from the catalog line of a {kind or 'bearing without bearing_type'}"
    if bore is None or outside is None or rating is None:
        return "bore, outside diameter or static load rating are missing"
    from dynamics.bearings.catalog import BAND, from_catalog  # noqa: PLC0415 (start-up time)

    try:
        line = CatalogLine(bore, outside, rating, radial_clearance(part))
        row = from_catalog(line.bore, line.outside_diameter, line.static_rating, line.clearance)
    except InputError as error:
        part.say(_RATING, "refused", f"no deep groove ball bearing has this line: {error}")
        return "no deep groove ball bearing has its catalog line"
    estimate = f"{row.count} balls of {row.diameter * 1e3:.3g} mm, estimated"
    part.say(
        "bearing_type", "derived", f"{estimate}; displacements within {100.0 * BAND['displacement']:g} %"
    )
    return BearingGeometry(row, rating, line)


def _detailed_bearing(unit: GearUnit, part: Part) -> BearingGeometry | str:
    kind, rows = bearing_type(part), unit.children(part, "rolling_bearing_row")
    rating = part.number(_RATING, "static load rating, kN")
    if kind not in (*BALLS, *ROLLERS):
        return f"{kind or 'a bearing without bearing_type'} is not computed"
    if len(rows) != 1 or rating is None:
        return f"{len(rows)} rows; one is computed" if len(rows) != 1 else "no static load rating"
    elements = unit.children(rows[0], "rolling_element")
    count = rows[0].attribute("number_of_rolling_elements")
    pitch = rows[0].number("reference_diameter_rolling_bearing", "pitch diameter, mm")
    diameter = (
        elements[0].number("diameter_of_rolling_element", "diameter of the element, mm") if elements else None
    )
    if count is None or not isinstance(count.value, int) or pitch is None or diameter is None:
        return "number or diameter of the elements, or their pitch diameter, are missing"
    rows[0].say("number_of_rolling_elements", "taken", "number of elements")
    try:
        return BearingGeometry(_row(part, rows[0], elements[0], count.value, (diameter, pitch)), rating)
    except InputError as error:
        part.say("bearing_type", "refused", f"no such bearing: {error}")
        return "its geometry is that of no bearing"


def _row(part: Part, row: Part, element: Part, count: int, sizes: tuple[float, float]) -> Row:
    """Return a row of balls or rollers."""
    diameter, pitch = sizes
    angle = abs(row.number("pressure_angle", "contact angle, deg") or 0.0)
    clearance = axial_clearance(part, angle) if angle else radial_clearance(part)
    if bearing_type(part) in ROLLERS:
        length = row.number("significant_contact_length_inner_ring", "effective length of the roller, mm")
        length = length or element.number("length_of_rolling_element", "length of the roller, mm")
        if length is None:
            element.say("length_of_rolling_element", "defaulted", "its diameter: the file gives none")
        return RollerBearing(
            count, diameter, length or diameter, pitch, contact_angle=angle, clearance=clearance
        )
    inner, outer = (_groove(row, ring, diameter, usual) for ring, usual in GROOVES.items())
    return BallBearing(count, diameter, pitch, inner, outer, contact_angle=angle, clearance=clearance)


def _groove(row: Part, ring: str, diameter: float, usual: float) -> float:
    """Return the radius of a groove over the ball diameter."""
    item = f"raceway_radius_of_{ring}_ring"
    radius = row.number(item, "radius of the groove, mm")
    if radius:
        return radius / diameter
    row.say(item, "defaulted", f"{usual:g} of the ball diameter (ISO/TS 16281)")
    return usual
