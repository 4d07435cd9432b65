"""Rolling bearings of a REXS model by their internal geometry, or by their line in a catalog."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.bearings import BallBearing, CatalogLine, RollerBearing
from dynamics.errors import InputError
from lineofaction.gearbox.from_rexs.bearing_clearance import axial_clearance, radial_clearance
from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.rexs.vocabulary import terms

Row = BallBearing | RollerBearing

DEEP_GROOVE = "radial_grooved_ball_bearing"
BALLS = (DEEP_GROOVE, "angular_contact_ball_bearing")
ROLLERS = ("radial_roller_bearing", "radial_needle_roller_bearing", "radial_tapered_roller_bearing")
GROOVES = {"inner": 0.52, "outer": 0.53}
_RATING = "radial_static_load_rating"


@dataclass(frozen=True)
class BearingGeometry:
    """A bearing of one row whose geometry is known."""

    row: Row
    """Row of rolling elements. Its contact angle is not negative: the row does not say which direction it
    supports."""
    rating: float
    """Static load rating C_0, N."""
    line: CatalogLine | None = None
    """The line in a catalog that the row is estimated from."""

    @staticmethod
    def of(part: Part) -> BearingGeometry | str:
        """Return the geometry of a bearing, or the reason why it is not known."""
        read = {
            "rolling_bearing_with_catalog_geometry": _catalog_bearing,
            "rolling_bearing_with_detailed_geometry": _detailed_bearing,
        }.get(part.type)
        return f"a {part.type} has no geometry" if read is None else read(part)


def _bearing_type(part: Part) -> str:
    """Return the type of a rolling bearing; the account refuses one that REXS does not have."""
    kind = part.text("bearing_type", "type of the bearing") or ""
    if kind and kind not in terms("bearing_types"):
        part.say("bearing_type", "refused", f"{kind} is no type of REXS: the bearing has no geometry")
    return kind


def _catalog_bearing(part: Part) -> BearingGeometry | str:
    bore = part.number("inner_diameter", "bore, mm")
    outside = part.number("outer_diameter", "outside diameter, mm")
    rating = part.number(_RATING, "static load rating, kN")
    kind = _bearing_type(part)
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
    text = f"{row.count} balls of {row.diameter * 1e3:.3g} mm, estimated; displacements within"
    part.say("bearing_type", "derived", f"{text} {100.0 * BAND['displacement']:g} %")
    return BearingGeometry(row, rating, line)


def _detailed_bearing(part: Part) -> BearingGeometry | str:
    kind, rows = _bearing_type(part), part.children("rolling_bearing_row")
    rating = part.number(_RATING, "static load rating, kN")
    if kind not in (*BALLS, *ROLLERS):
        return f"{kind or 'a bearing without bearing_type'} is not computed"
    if len(rows) != 1 or rating is None:
        return f"{len(rows)} rows; one is computed" if len(rows) != 1 else "no static load rating"
    elements = rows[0].children("rolling_element")
    count = rows[0].value("number_of_rolling_elements")
    pitch = rows[0].number("reference_diameter_rolling_bearing", "pitch diameter, mm")
    diameter = (
        elements[0].number("diameter_of_rolling_element", "diameter of the element, mm") if elements else None
    )
    if not isinstance(count, int) or pitch is None or diameter is None:
        return "number or diameter of the elements, or their pitch diameter, are missing"
    rows[0].say("number_of_rolling_elements", "taken", "number of elements")
    try:
        return BearingGeometry(_row(part, rows[0], elements[0], count, (diameter, pitch)), rating)
    except InputError as error:
        part.say("bearing_type", "refused", f"no such bearing: {error}")
        return "its geometry is that of no bearing"


def _row(part: Part, row: Part, element: Part, count: int, sizes: tuple[float, float]) -> Row:
    diameter, pitch = sizes
    angle = abs(row.number("pressure_angle", "contact angle, deg") or 0.0)
    clearance = axial_clearance(part, angle) if angle else radial_clearance(part)
    if _bearing_type(part) in ROLLERS:
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
