"""The stiffness of a bearing: as stated, from its geometry, or a default with its reason."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from dynamics.bearings import RollerBearing
from dynamics.errors import DynamicsError
from lineofaction.gearbox.from_rexs.bearings import BearingGeometry, Row
from lineofaction.gearbox.from_rexs.gear_unit import Part

RIGID_FROM = 1e13
"""Stiffness in N/m from which a bearing counts as rigid. No bearing is as stiff: files write 1e20 or 1e23 for
a bearing that does not yield."""

RIGID_TILT_FROM = 1e9
"""Tilting stiffness in N m/rad from which a bearing counts as rigid: files write 1e12."""

RIGID, RIGID_TILT = 1e10, 1e7
"""Stiffness and tilting stiffness of a rigid seat, N/m and N m/rad: ten times the stiffest rolling bearings
of gear units."""

USUAL = {"ball": 2e8, "roller": 1e9}
"""Radial stiffness of bearings of about 50 mm bore, N/m, by kind of rolling element. A bearing whose kind has
no value counts as a ball bearing."""

AXIAL_SHARE = 0.5
"""Axial over radial stiffness where the file has neither a value nor the geometry."""

RADIAL_LOAD, AXIAL_LOAD = 0.1, 0.025
"""Radial load and least axial load at which a bearing's tangent is taken, over its static load rating."""

INDUCED = 1.25
"""Axial over radial load, times cot(alpha), at which half of the rolling elements of a row carry. The row of
contact angle alpha itself induces this thrust: F_r / (2 Y), Y = 0.4 cot(alpha) (ISO 281)."""

_TILTS = (3, 4)
"""Indices of the tilts in a displacement x, y, z, tilts."""

COPIES = 8
"""Number of positions of a rolling element, spread over one pitch, over which the stiffness is averaged."""

_FIXED = ("both_directions", "positive", "negative")

_MOTIONS = ("d_u", "d_v", "d_w", "rot_v", "rot_w")

_ROWS = ("f_u", "f_v", "f_w", "m_v", "m_w")


@dataclass(frozen=True)
class BearingStiffness:
    """Stiffness of a bearing along and across its axis."""

    radial: float
    axial: float
    """`radial`, `axial`: Radial and axial stiffness, N/m."""
    tilt: float
    """Tilting stiffness, N m/rad."""
    matrix: FloatArray | None = None
    """Stiffness matrix in u, v, w, rotation about v, about w; N, m, rad. It replaces the other fields. Shape
    (5, 5)."""

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
        return cls(radial, axial, _resolved_stiffness(part, "bending_stiffness", tilt) or 0.0)


def _radial(part: Part, tangent: FloatArray | None) -> float:
    item = "radial_stiffness"
    if part.value("radial_force_absorption") is False:
        part.say("radial_force_absorption", "taken", "no radial stiffness")
        return 0.0
    derived = None if tangent is None else 0.5 * (tangent[0, 0] + tangent[1, 1])
    value = _resolved_stiffness(part, item, derived)
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
    value = _resolved_stiffness(part, item, None if tangent is None else tangent[2, 2])
    if absorption in _FIXED[1:]:
        part.say("axial_force_absorption", "derived", f"{absorption} alone; the linear spring acts both ways")
    if value or absorption not in _FIXED:
        return value or 0.0
    part.say(item, "defaulted", f"{AXIAL_SHARE:g} of the radial stiffness: a fixed bearing without a value")
    return AXIAL_SHARE * radial


def finite_stiffness(part: Part, item: str) -> float | None:
    """Return the stated stiffness of a bearing, None where the file has none or one that means rigid."""
    value = part.number(item, "stiffness of the bearing")
    rigid_from = RIGID_TILT_FROM if item == "bending_stiffness" else RIGID_FROM
    return value if value is not None and 0.0 < value < rigid_from else None


def _resolved_stiffness(part: Part, item: str, derived: float | None) -> float | None:
    """Return a stiffness: a finite stated one, else the derived one, else a rigid one, else None."""
    value = finite_stiffness(part, item)
    if value is not None:
        return value
    rigid, unit = (RIGID_TILT, "N m/rad") if item == "bending_stiffness" else (RIGID, "N/m")
    stated = part.number(item, "stiffness of the bearing")
    if derived is not None:
        text = f"{derived:.3g} {unit}, tangent of the bearing's geometry at {RADIAL_LOAD:g} C0 radially"
        part.say(item, "derived", text + ("" if stated is None else f" instead of the stated {stated:.3g}"))
        return max(0.0, float(derived))
    if stated is not None and stated > 0.0:
        part.say(item, "derived", f"{stated:.3g} {unit} means rigid: {rigid:g} here")
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
        return np.asarray(bearing.evaluate(bearing.displacement(load, fixed=_TILTS)).tangent)
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
    minimum = INDUCED * RADIAL_LOAD * math.tan(abs(contact_angle))
    return math.copysign(max(AXIAL_LOAD, minimum), contact_angle)


def operating_point(part: Part) -> FloatArray | None:
    """Return the stated matrix (5, 5), None where the file has none or one that holds nothing."""
    names = [[f"operating_point_stiffness_{row}_{motion}" for motion in _MOTIONS] for row in _ROWS]
    meaning = "stiffness at the operating point"
    matrix = np.array([[part.number(name, meaning, 0.0) for name in row] for row in names])
    if not np.any(matrix):
        return None
    matrix = 0.5 * (matrix + matrix.T)
    minimum, largest = map(float, np.linalg.eigvalsh(matrix)[[0, -1]])
    if largest <= 0.0 or minimum < -1e-6 * largest or np.max(np.abs(matrix)) >= RIGID_FROM:
        for name in itertools.chain.from_iterable(names):
            if part.attribute(name) is not None:
                part.say(
                    name, "refused", "no stiffness matrix: it is not positive semidefinite, or not finite"
                )
        return None
    return np.asarray(matrix)
