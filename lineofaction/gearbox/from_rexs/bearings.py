"""Rolling bearings of a file: their inside geometry and the stiffness that the file states."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from dynamics.bearings import BallBearing, CatalogLine, RollerBearing
from dynamics.bearings.rolling_bearing import CLEARANCE
from dynamics.errors import DynamicsError, InputError
from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.rexs.vocabulary import words

# The clearance of a rolling bearing: in operation, as mounted, or before mounting.


_STAGES = (
    ("operating_", "in operation"),
    ("mounted_", "as mounted, without temperatures"),
    ("", "before mounting, without fits and temperatures"),
)
_OPERATING = "operating_radial_bearing_clearance"


def _radial_clearance(part: Part) -> float:
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
        part.say(_OPERATING, "derived", f"{1e6 * mean:g} µm: mean of the limits before mounting")
        return mean
    part.say(_OPERATING, "defaulted", "0 µm: the file gives none")
    return 0.0


def _axial_clearance(part: Part, contact_angle: float) -> float:
    """Return the way along the axis to contact of a row with a contact angle, m; negative: preload.

    At each stage, as of `_radial_clearance`, a stated axial clearance counts first, then half of the radial
    one times the cotangent of the contact angle. A preload distance is taken off, unless a preload force
    follows.
    """
    way = _way_to_contact(part, contact_angle)
    distance = _stated(part, "preload_distance", "approach of the rings beyond contact, µm")
    if distance and not part.number("preload_force", "preload force, N"):
        return way - distance
    if distance:
        part.say("preload_distance", "ignored", "the preload force counts")
    return way


def _way_to_contact(part: Part, contact_angle: float) -> float:
    for stage, meaning in _STAGES:
        item = f"{stage}axial_bearing_clearance"
        along = _stated(part, item, meaning)
        if along is not None:
            return along
        across = _stated(part, f"{stage}radial_bearing_clearance", meaning)
        if across is not None:
            way = 0.5 * across / math.tan(contact_angle)
            part.say(item, "derived", f"{1e6 * way:.3g} µm: half of the radial clearance over tan(alpha)")
            return way
    part.say("operating_axial_bearing_clearance", "defaulted", "0 µm: the file gives none")
    return 0.0


def _stated(part: Part, item: str, words: str) -> float | None:
    return part.bounded(item, f"clearance {words}", CLEARANCE)


# Rolling bearings of a REXS model by their internal geometry, or by their line in a catalog.


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
    """Its contact angle is not negative: which direction it holds is not in it."""
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
    if kind and kind not in words("bearing_types"):
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
        line = CatalogLine(bore, outside, rating, _radial_clearance(part))
        row = from_catalog(line.bore, line.outside_diameter, line.static_rating, line.clearance)
    except InputError as error:
        part.say(_RATING, "refused", f"no deep groove ball bearing has this line: {error}")
        return "no deep groove ball bearing has its catalog line"
    words = f"{row.count} balls of {row.diameter * 1e3:.3g} mm, estimated; displacements within"
    part.say("bearing_type", "derived", f"{words} {100.0 * BAND['displacement']:g} %")
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
    clearance = _axial_clearance(part, angle) if angle else _radial_clearance(part)
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


# The stiffness of a bearing: as stated, from its geometry, or a default with its reason.


RIGID_FROM = 1e13
"""N/m; no bearing is as stiff: files write 1e20 or 1e23 for one that does not yield."""
RIGID_TILT_FROM = 1e9
"""N m/rad; likewise: files write 1e12."""
RIGID, RIGID_TILT = 1e10, 1e7
"""N/m and N m/rad of a rigid seat: ten times the stiffest rolling bearings of gear units."""
USUAL = {"ball": 2e8, "roller": 1e9}
"""N/m, radial, of bearings of about 50 mm bore; of concepts without a value, as of balls."""
AXIAL_SHARE = 0.5
"""Axial over radial stiffness where the file has neither a value nor the geometry."""
RADIAL_LOAD, AXIAL_LOAD = 0.1, 0.025
"""Load at which a bearing's tangent is taken, as shares of its static load rating; axial is the least."""
INDUCED = 1.25
"""Axial over radial load, times cot(alpha): the thrust F_r / (2 Y) that a row of contact angle alpha itself
induces, Y = 0.4 cot(alpha) (ISO 281). Half of its elements carry; with much less it slips off its raceway."""
_TILTS = (3, 4)

COPIES = 8
"""Of each element: stiffness as the average over the passing of an element."""

_FIXED = ("both_directions", "positive", "negative")
_MOTIONS = ("d_u", "d_v", "d_w", "rot_v", "rot_w")
_ROWS = ("f_u", "f_v", "f_w", "m_v", "m_w")


@dataclass(frozen=True)
class BearingStiffness:
    """Stiffness of a bearing along its own axis and across."""

    radial: float
    axial: float
    """`radial`, `axial`: N/m."""
    tilt: float
    """N m/rad."""
    matrix: FloatArray | None = None
    """In u, v, w, rotation about v, about w; N, m, rad; instead of the others. Shape (5, 5)."""

    @classmethod
    def of(cls, part: Part) -> BearingStiffness:
        """Return the stiffness of a bearing; the account says where each value comes from.

        The stiffness at an operating point counts first, then finite stated values, then the tangent of the
        bearing by its geometry or its catalog line, then what the file calls rigid, then a default.
        """
        matrix = operating_point(part)
        if matrix is not None:
            return cls(0.0, 0.0, 0.0, matrix)
        tangent = _by_geometry(part)
        radial = _radial(part, tangent)
        tilt = None if tangent is None else 0.5 * (tangent[3, 3] + tangent[4, 4])
        axial = _axial(part, tangent, radial)
        return cls(radial, axial, _own_stiffness(part, "bending_stiffness", tilt) or 0.0)


def _radial(part: Part, tangent: FloatArray | None) -> float:
    item = "radial_stiffness"
    if part.value("radial_force_absorption") is False:
        part.say("radial_force_absorption", "taken", "no radial stiffness")
        return 0.0
    derived = None if tangent is None else 0.5 * (tangent[0, 0] + tangent[1, 1])
    value = _own_stiffness(part, item, derived)
    if value:
        return value
    kind = "roller" if "roller" in str(part.value("bearing_type")) else "ball"
    reason = "neither stiffness nor geometry is stated"
    part.say(item, "defaulted", f"{USUAL[kind]:g} N/m, as of {kind} bearings of about 50 mm bore: {reason}")
    return USUAL[kind]


def _axial(part: Part, tangent: FloatArray | None, radial: float) -> float:
    item = "axial_stiffness"
    absorption = part.text("axial_force_absorption", "fixed or floating bearing")
    if absorption == "no_direction":
        part.say(item, "derived", "0 N/m: a floating bearing (axial_force_absorption)")
        return 0.0
    value = _own_stiffness(part, item, None if tangent is None else tangent[2, 2])
    if absorption in _FIXED[1:]:
        part.say("axial_force_absorption", "derived", f"{absorption} alone; the linear spring acts both ways")
    if value or absorption not in _FIXED:
        return value or 0.0
    part.say(item, "defaulted", f"{AXIAL_SHARE:g} of the radial stiffness: a fixed bearing without a value")
    return AXIAL_SHARE * radial


def stated_stiffness(part: Part, item: str) -> float | None:
    """Return a stated stiffness of a bearing, None where there is none, or none that is finite."""
    value = part.number(item, "stiffness of the bearing")
    return value if value is not None and 0.0 < value < _rigid(item)[0] else None


def _rigid(item: str) -> tuple[float, float, str]:
    """Return from where on a stiffness means rigid, the stiffness of a rigid seat, and their unit."""
    tilt = item == "bending_stiffness"
    return (RIGID_TILT_FROM, RIGID_TILT, "N m/rad") if tilt else (RIGID_FROM, RIGID, "N/m")


def _own_stiffness(part: Part, item: str, derived: float | None) -> float | None:
    """Return a stiffness: a finite stated one, else the derived one, else a rigid one, else None."""
    value, (rigid_from, rigid, unit) = part.number(item, "stiffness of the bearing"), _rigid(item)
    if stated_stiffness(part, item) is not None:
        return value
    if derived is not None:
        of = f"{derived:.3g} {unit}, tangent of the bearing's geometry at {RADIAL_LOAD:g} C0 radially"
        part.say(item, "derived", of + ("" if value is None else f" instead of the stated {value:.3g}"))
        return max(0.0, float(derived))
    if value is not None and value >= rigid_from:
        part.say(item, "derived", f"{value:.3g} {unit} means rigid: {rigid:g} here")
        return rigid
    return None


def _by_geometry(part: Part) -> FloatArray | None:
    """Return the tangent (5, 5) in x, y, z, tilts of a bearing whose geometry is known, at the usual load."""
    geometry = BearingGeometry.of(part)
    if isinstance(geometry, str):
        return None
    from dynamics.bearings.loaded_bearing import LoadedBearing  # noqa: PLC0415 (start-up time)

    bearing = LoadedBearing(geometry.row, COPIES)
    load = geometry.rating * np.array([RADIAL_LOAD, 0.0, _axial_load(geometry.row), 0.0, 0.0])
    try:
        return np.asarray(bearing.evaluate(bearing.displacement(load, held=_TILTS)).tangent)
    except DynamicsError as error:
        part.say("bearing_type", "refused", f"its geometry carries no load of a tenth of its rating: {error}")
        return None


def _axial_load(row: Row) -> float:
    """Return the usual axial load over the static load rating, with the sign of the contact angle.

    Cylindrical rollers carry none: that of their ribs is not in the geometry.
    """
    contact_angle = row.contact_angle
    if isinstance(row, RollerBearing) and contact_angle == 0.0:
        return 0.0
    least = INDUCED * RADIAL_LOAD * math.tan(abs(contact_angle))
    return math.copysign(max(AXIAL_LOAD, least), contact_angle)


def operating_point(part: Part) -> FloatArray | None:
    """Return the stated matrix (5, 5), None where the file has none or one that holds nothing."""
    names = [[f"operating_point_stiffness_{row}_{motion}" for motion in _MOTIONS] for row in _ROWS]
    words = "stiffness at the operating point"
    matrix = np.array([[part.number(name, words, 0.0) for name in row] for row in names])
    if not np.any(matrix):
        return None
    matrix = 0.5 * (matrix + matrix.T)
    least, most = map(float, np.linalg.eigvalsh(matrix)[[0, -1]])
    if most <= 0.0 or least < -1e-6 * most or np.max(np.abs(matrix)) >= RIGID_FROM:
        for name in (name for row in names for name in row if part.attribute(name) is not None):
            part.say(name, "refused", "no stiffness matrix: it is not positive semidefinite, or not finite")
        return None
    return np.asarray(matrix)
