"""A pair in a report: its name, its warnings, its drawing and its data sheet.

A gear as made has tooth flanks that deviate from the design; a lead is the trace of a flank along the face.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from pydantic import ValidationError

from bounds import Direction
from bounds.error_digits import MAX_DIGITS
from fe_contact.geometry import (
    BoreSeat,
    FlankGrid,
    FlankModification,
    Gear,
    GearBlank,
    GearPair,
    InternalGearPair,
    ParallelAxes,
    PitchDeviation,
    RingGear,
    RunOut,
    ToothFlank,
    Toothing,
    Wave,
    sliding_factor,
    specific_sliding,
)
from fe_contact.geometry.flank_tolerances import helix_tolerance, profile_tolerance
from fe_contact.geometry.iso6336_stiffness import iso6336_stiffness
from fe_contact.material import Material
from fe_contact.plausibility import mesh_findings
from fe_contact.ste import PairGeometry, SteDatabase
from fe_contact.types import IntArray, Json
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.outline import pair_outline
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.units import DEGREE, MM, UM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    Line,
    Note,
    Panel,
    Reference,
    Table,
    number,
)
from lineofaction.report.drawing.page import Section
from lineofaction.report.teeth_as_made import teeth_as_made

_PARTS: dict[str, Callable[..., object]] = {  # fields of a gear in a request that are objects
    "modification": FlankModification,
    "material": Material,
    "pitch_deviation": PitchDeviation,
    "blank": GearBlank,
    "seat": BoreSeat,
    "run_out": RunOut,
    "waves": Wave,
    "tooth_flanks": ToothFlank,
    "flank_grid": FlankGrid,
}
_POINTS = 201  # along a drawn profile or lead
_AXES = (Direction.PROFILE, Direction.FACE)
_SIDES = dict(zip(("pinion", "wheel"), palette.GEARS, strict=True))
_HEIGHT = 3.4
"""Modules drawn above and below the pitch point."""
_WIDTH = 3.4
"""Width of the drawing over its height, nearly the ratio of a panel."""
_UNITS: Mapping[str, float] = {"": 1.0, "mm": MM, "um": UM, "deg": DEGREE}
_DECIMALS = {"": 4, "mm": 4, "um": 1, "deg": 4}
_SYMBOLS = {"um": "µm", "deg": "°"}
_POINT_HEAD = (
    "point", "d_y1 mm", "d_y2 mm", "roll angle 1 °", "roll angle 2 °", "sliding factor K_g",
    "specific sliding 1", "specific sliding 2",
)  # fmt: skip


def pair_of(database: SteDatabase) -> ParallelAxes | None:
    """Return the pair of the case that the database echoes: a case file, or a request in SI; else None."""
    case = database.metadata.case
    try:
        # strict models take JSON's lists for tuples only from text
        return gear_pair(Case.model_validate_json(json.dumps(case)))
    except ValidationError:
        return _from_si(case)


def tolerance_class_of(database: SteDatabase) -> int | None:
    """Return the class of gears and axes that the case of a database states."""
    errors = database.metadata.case.get("errors") or {}
    tolerance_class: int | None = errors.get("misalignment_class")
    return tolerance_class


def iso_mesh_stiffness(database: SteDatabase) -> float | None:
    """Return the mean mesh stiffness of ISO 6336-1, N/m per m of face width; None without a pair.

    It holds above 100 N/mm of load. None for a ring gear too: its approximation by a rack leaves out the rim.
    """
    pair = pair_of(database)
    return iso6336_stiffness(pair).mesh_stiffness if isinstance(pair, GearPair) else None


def _from_si(case: Json) -> ParallelAxes | None:
    """Rebuild the pair of a request that was made from Python."""
    try:
        pair = case["pair"]
        pinion, wheel, distance = pair["pinion"], pair["wheel"], pair["center_distance"]
        if "rim_diameter" in wheel:
            return InternalGearPair(Gear(**_fields(pinion)), RingGear(**_fields(wheel)), distance)
        return GearPair(Gear(**_fields(pinion)), Gear(**_fields(wheel)), distance)
    except (KeyError, TypeError):
        return None


def _fields(content: Json) -> Json:
    """Return the fields of a gear in a request with its objects."""
    parts = {}
    for name, kind in _PARTS.items():
        if content.get(name) is not None:
            parts[name] = _parts(kind, content[name])
    return content | parts


def _parts(kind: Callable[..., object], content: Json | list[Json]) -> object:
    if isinstance(content, list):
        return tuple(_parts(kind, entry) for entry in content)
    return kind(**_fields(content))


def pair_title(geometry: PairGeometry) -> str:
    """Name a pair by its teeth."""
    pinion, wheel = geometry.teeth
    return f"Gear pair {pinion}/{wheel}, internal" if geometry.internal else f"Gear pair {pinion}/{wheel}"


def pair_lead(geometry: PairGeometry) -> str:
    """Return the main dimensions of a pair as text."""
    return (
        f"center distance {1e3 * geometry.center_distance:.6g} mm, "
        f"face width {1e3 * geometry.face_width:.6g} mm, base pitch {1e3 * geometry.base_pitch:.5g} mm"
    )


def pair_remarks(pair: ParallelAxes) -> list[Json]:
    """Return the remarks as warnings: `check`, `message`."""
    remarks = []
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        if isinstance(gear, Gear) and gear.form_point.undercut:
            remedy = "the tool cuts into the involute near the root. Raise its profile shift."
            remarks.append({"check": "undercut", "message": f"pair.{name}: {remedy}"})
    if pair.normal_backlash <= 0.0:
        remedy = "no backlash. Give thickness_allowance_um, or a larger center distance."
        remarks.append({"check": "backlash", "message": f"pair: {remedy}"})
    remarks += [{"check": finding.check, "message": finding.message()} for finding in mesh_findings(pair)]
    return remarks


def pair_drawing(pair: ParallelAxes, tolerance_class: int | None = None) -> Figure:
    """Draw the transverse section; where flanks are modified or as made, also profiles and leads.

    With a tolerance class, its F_alpha and F_beta of ISO 1328-1 are shaded about profiles and leads.
    """
    gears = {"pinion": pair.pinion, "wheel": pair.wheel}
    panels = [_section(pair)]
    leads = {}
    for name, gear in gears.items():
        made = _made_flanks(gear)
        if gear.modification.varies_along_profile or made:
            panels.append(_profile(name, pair, tolerance_class))
        if gear.modification.varies_along_face or any(flank.varies_along_face for flank in made):
            leads[name] = gear
    if leads:
        panels.append(_lead(leads, tolerance_class))
    caption = (
        f"Section at the pinion's mid-face; the pinion drives clockwise. The wheel's center is "
        f"{'below' if pair.internal else 'above'}. A to E: the path of contact of the usable flanks."
    )
    if len(panels) > 1:
        caption += " Material removed along the line of action; 0 is the involute."
    if len(panels) > 1 and tolerance_class is not None:
        tolerances = f"F_alpha and F_beta of class {tolerance_class} of ISO 1328-1:2013"
        caption += f" Shaded: {tolerances}, half to each side."
    if any(map(_made_flanks, gears.values())):
        caption += " Thin: the teeth as made, without their pitch deviations."
    return Figure(
        key="pair_drawing",
        title="The pair in mesh" if len(panels) == 1 else "The pair in mesh and its flank modifications",
        caption=caption,
        alternative=" ".join(_finding(name, gear) for name, gear in gears.items()),
        content=tuple(panels),
    )


def _made_flanks(gear: Toothing) -> list[ToothFlank]:
    """Return the flanks of the teeth that deviate from the design."""
    return [flank for flank in gear.tooth_flanks if not flank.neutral]


def _section(pair: ParallelAxes) -> Panel:
    outline = pair_outline(pair)
    half = _HEIGHT * pair.pinion.normal_module / MM
    lines = [_gear_line(name, outline[name], _WIDTH * half) for name in _SIDES]
    for name, radius in zip(_SIDES, pair.operating_pitch_radii, strict=True):
        center = outline[name]["centre_mm"]
        angle = np.linspace(0.0, 2.0 * math.pi, 721)
        x, y = center[0] + radius / MM * np.cos(angle), center[1] + radius / MM * np.sin(angle)
        lines.append(Line("working pitch circles", x, y, palette.MUTED, "dash", 1.0))
    points = outline["path_of_contact"]["points_mm"]
    path = np.array(sorted(points.values()))
    lines.append(Line("path of contact", path[:, 0], path[:, 1], palette.GREEN, width=2.4, markers=True))
    notes = []
    for name, (x, y) in points.items():
        row = -1 if name == "D" else 0  # lower than the others, clear of its neighbors
        notes.append(Note(x, y, name, row, left=name in "AB"))
    pitch_point = pair.operating_pitch_radii[0] / MM
    axes = (
        Axis("mm", limits=(-_WIDTH * half, _WIDTH * half)),
        Axis("mm", limits=(pitch_point - half, pitch_point + half)),
    )
    return Panel(*axes, tuple(lines), title="Transverse section", notes=tuple(notes), equal=True)


def _gear_line(name: str, gear: Json, across: float) -> Line:
    """Draw the teeth of a gear near the mesh; the drawing reaches `across`, mm, to either side."""
    tooth = np.array(gear["tooth_mm"])
    pitch = -2.0 * math.pi / gear["teeth"]  # teeth follow each other from left to right
    angles = math.radians(gear["angle_deg"]) + pitch * _near_teeth(gear, across)
    x = np.cos(angles)[:, None] * tooth[:, 0] - np.sin(angles)[:, None] * tooth[:, 1]
    y = np.sin(angles)[:, None] * tooth[:, 0] + np.cos(angles)[:, None] * tooth[:, 1]
    is_complete = len(angles) == gear["teeth"]
    # a complete outline closes at its first point; a part of the teeth closes over the gear's center
    closed = [np.append(part.ravel(), part.ravel()[0] if is_complete else 0.0) for part in (x, y)]
    center = gear["centre_mm"]
    outline = Line(name, closed[0] + center[0], closed[1] + center[1], _SIDES[name], width=1.4)
    return replace(outline, filled=gear["radius_mm"]["tip"] > gear["radius_mm"]["root"])  # not a ring gear


def _near_teeth(gear: Json, across: float) -> IntArray:
    """Return the numbers of the teeth within twice the drawn distance of the mesh, or of all teeth."""
    count = gear["teeth"]
    reach = 2.0 * across / gear["radius_mm"]["root"]  # rad, about
    if reach >= 1.0:
        return np.arange(count)
    reach_teeth = math.ceil(reach * count / (2.0 * math.pi)) + 1
    return np.arange(-reach_teeth, reach_teeth + 1)


def _half(tolerance: Callable[[Toothing, int], float], gear: Toothing, tolerance_class: int | None) -> float:
    """Return half a tolerance in um, 0 without a class."""
    return 0.0 if tolerance_class is None else 0.5 * tolerance(gear, tolerance_class) / UM


def _profile(name: str, pair: ParallelAxes, tolerance_class: int | None) -> Panel:
    """Draw the K-chart of a gear: removed material over roll angle; of a twisted flank at three places."""
    gear: Toothing = getattr(pair, name)
    roll, half = _usable(gear), 0.5 * gear.face_width
    angle = roll / gear.base_radius / DEGREE
    twisted = any(part.varies and part.along not in _AXES for part in gear.modification.parts)
    band = _half(profile_tolerance, gear, tolerance_class)
    label = f"{name}, mid-face" if twisted else name
    lines = [Line(label, angle, _removed(gear, roll, 0.0), _SIDES[name], band=band)]
    if twisted:
        datum, other = _removed(gear, roll, -half), _removed(gear, roll, half)
        lines.append(Line(f"{name}, datum face", angle, datum, _SIDES[name], "dash"))
        lines.append(Line(f"{name}, non-datum face", angle, other, _SIDES[name], "dot"))
    lines += _teeth_as_made(name, gear, angle, roll, np.zeros(_POINTS))
    pitch_point = pair.path_of_contact.pitch_point
    at_pitch = pitch_point if name == "pinion" else float(pair.mating_roll_length(pitch_point))
    mark = Reference("C", at_pitch / gear.base_radius / DEGREE)
    title = f"Profile of the {name}, root to the {'left' if gear.sign > 0 else 'right'}"
    axes = Axis(f"roll angle of the {name}, °"), Axis("removed, µm")
    return Panel(*axes, tuple(lines), (mark,), title=title)


def _usable(gear: Toothing) -> FloatArray:
    """Return roll lengths over the usable flank, m."""
    ends = sorted((gear.form_roll_length, gear.tip_form_roll_length))
    return np.linspace(ends[0], ends[1], _POINTS)


def _lead(gears: dict[str, Toothing], tolerance_class: int | None) -> Panel:
    lines = []
    for name, gear in gears.items():
        face = np.linspace(-0.5, 0.5, _POINTS) * gear.face_width
        roll = np.full(_POINTS, _usable(gear).mean())
        band = _half(helix_tolerance, gear, tolerance_class)
        lines.append(Line(name, face / MM, _removed(gear, roll, face), _SIDES[name], band=band))
        lines += _teeth_as_made(name, gear, face / MM, roll, face)
    x = Axis("face position, mm (0 = mid-face; left: datum face)")
    return Panel(x, Axis("removed, µm"), tuple(lines), title="Lead at the middle of the profile")


def _teeth_as_made(
    name: str, gear: Toothing, x: FloatArray, roll: FloatArray, face: FloatArray
) -> tuple[Line, ...]:
    """Return the traces of all teeth that deviate over `x` as one line with gaps; no line without any."""
    traces = [
        _removed(gear, roll, face) - flank.excess(gear, roll, face) / UM for flank in _made_flanks(gear)
    ]
    if not traces:
        return ()
    y = np.concatenate([np.append(trace, np.nan) for trace in traces])
    return (Line(f"{name}, as made", np.tile(np.append(x, np.nan), len(traces)), y, _SIDES[name], width=0.6),)


def _removed(gear: Toothing, roll: FloatArray, face: FloatArray | float) -> FloatArray:
    """Return the material that the design removes along the line of action, um."""
    return gear.modification.material_removed(gear, roll, face) / UM


def _finding(name: str, gear: Toothing) -> str:
    remark = f" {len(_made_flanks(gear))} of its teeth are drawn as made." if _made_flanks(gear) else ""
    if gear.modification.neutral:
        return f"The {name} is not modified.{remark}"
    roll, face = np.meshgrid(_usable(gear), np.linspace(-0.5, 0.5, _POINTS) * gear.face_width)
    return f"At most {number(_removed(gear, roll, face).max(), 3)} µm are removed from the {name}.{remark}"


@dataclass(frozen=True)
class Entry:
    """A line of the data sheet: term and symbol of ISO 21771-1, unit, and function of the values.

    `of` returns the values of pinion and wheel, or the one of the pair, in SI.
    """

    term: str
    symbol: str
    unit: str
    of: Callable[[ParallelAxes], Sequence[float]]

    @property
    def name(self) -> str:
        """The name of the quantity in JSON, with the unit."""
        label = self.term.replace(" ", "_").replace("-", "_")
        return f"{label}_{self.unit}" if self.unit else label

    def values(self, pair: ParallelAxes) -> list[float]:
        """Return the values in the unit of the boundary."""
        return [float(value) / _UNITS[self.unit] + 0.0 for value in self.of(pair)]  # + 0.0: no -0.0

    def row(self, pair: ParallelAxes) -> tuple[str, ...]:
        """Return the line as words."""
        values = (_text(value, self.unit) for value in self.values(pair))
        return (self.term, self.symbol, *values, _SYMBOLS.get(self.unit, self.unit))


def _both(of: Callable[[Toothing], float]) -> Callable[[ParallelAxes], Sequence[float]]:
    return lambda pair: (of(pair.pinion), of(pair.wheel))


def _pair(of: Callable[[ParallelAxes], float]) -> Callable[[ParallelAxes], Sequence[float]]:
    return lambda pair: (of(pair),)


def _start_diameters(pair: ParallelAxes) -> list[float]:
    """Return the diameters at which the active flanks begin, m."""
    path = pair.active_path
    wheel_roll = float(pair.mating_roll_length(path.end))
    return [
        2.0 * math.hypot(pair.pinion.base_radius, path.start),
        2.0 * math.hypot(pair.wheel.base_radius, wheel_roll),
    ]


GEARS = (
    Entry("number of teeth", "z", "", _both(lambda gear: gear.teeth)),
    Entry("profile shift coefficient", "x", "", _both(lambda gear: gear.profile_shift_coefficient)),
    Entry("generating profile shift", "x_E", "", _both(lambda gear: gear.generating_shift_coefficient)),
    Entry("face width", "b", "mm", _both(lambda gear: gear.face_width)),
    Entry("reference diameter", "d", "mm", _both(lambda gear: 2.0 * gear.reference_radius)),
    Entry("base diameter", "d_b", "mm", _both(lambda gear: 2.0 * gear.base_radius)),
    Entry("working pitch diameter", "d_w", "mm", lambda pair: [2.0 * r for r in pair.operating_pitch_radii]),
    Entry("tip diameter", "d_a", "mm", _both(lambda gear: 2.0 * gear.tip_radius)),
    Entry("tip form diameter", "d_Fa", "mm", _both(lambda gear: 2.0 * gear.tip_form_radius)),
    Entry("active root diameter", "d_Nf", "mm", _start_diameters),
    Entry("root form diameter", "d_Ff", "mm", _both(lambda gear: 2.0 * gear.form_radius)),
    Entry("root diameter", "d_f", "mm", _both(lambda gear: 2.0 * gear.root_radius)),
    Entry("transverse tooth thickness", "s_t", "mm", _both(lambda gear: gear.tooth_thickness)),
    Entry("tooth thickness at the tip", "s_at", "mm", _both(lambda gear: gear.tip_tooth_thickness)),
    Entry("tip clearance", "c", "mm", lambda pair: pair.tip_clearances),
)
"""Lines with a value for either gear."""

MESH = (
    Entry("center distance", "a", "mm", _pair(lambda pair: pair.center_distance)),
    Entry("transmission ratio", "i", "", _pair(lambda pair: pair.speed_ratio)),
    Entry("normal module", "m_n", "mm", _pair(lambda pair: pair.pinion.normal_module)),
    Entry("transverse module", "m_t", "mm", _pair(lambda pair: pair.pinion.transverse_module)),
    Entry("normal pressure angle", "alpha_n", "deg", _pair(lambda pair: pair.pinion.normal_pressure_angle)),
    Entry(
        "transverse pressure angle",
        "alpha_t",
        "deg",
        _pair(lambda pair: pair.pinion.transverse_pressure_angle),
    ),
    Entry("working pressure angle", "alpha_wt", "deg", _pair(lambda pair: pair.working_pressure_angle)),
    Entry("helix angle of the pinion", "beta", "deg", _pair(lambda pair: pair.pinion.helix_angle)),
    Entry("base helix angle of the pinion", "beta_b", "deg", _pair(lambda pair: pair.base_helix_angle)),
    Entry("transverse base pitch", "p_bt", "mm", _pair(lambda pair: pair.base_pitch)),
    Entry("common face width", "b_w", "mm", _pair(lambda pair: pair.face_width)),
    Entry("length of path of contact", "g_alpha", "mm", _pair(lambda pair: pair.active_path.length)),
    Entry("transverse contact ratio", "eps_alpha", "", _pair(lambda pair: pair.active_contact_ratio)),
    Entry("overlap ratio", "eps_beta", "", _pair(lambda pair: pair.overlap_ratio)),
    Entry(
        "total contact ratio",
        "eps_gamma",
        "",
        _pair(lambda pair: pair.active_contact_ratio + pair.overlap_ratio),
    ),
    Entry("normal backlash", "j_bn", "um", _pair(lambda pair: pair.normal_backlash)),
    Entry("circumferential backlash", "j_wt", "um", _pair(lambda pair: pair.circumferential_backlash)),
)
"""Lines with one value."""


def _path_points(pair: ParallelAxes) -> dict[str, Json]:
    """Return the points A to E of the path of contact; lists of two values are of pinion and wheel."""
    radii = pair.pinion.base_radius, pair.wheel.base_radius
    points = {}
    for name, pinion_roll in zip("ABCDE", pair.active_path.points, strict=True):
        rolls = pinion_roll, float(pair.mating_roll_length(pinion_roll))
        gears = list(zip(radii, rolls, strict=True))
        points[name] = {
            "diameter_mm": [2.0 * math.hypot(radius, roll) / MM for radius, roll in gears],
            "roll_angle_deg": [roll / radius / DEGREE for radius, roll in gears],
            "sliding_factor": float(sliding_factor(pair, pinion_roll)),
            "specific_sliding": [float(value) for value in specific_sliding(pair, pinion_roll)],
        }
    return points


def data_sheet(pair: ParallelAxes) -> tuple[Table, Table, Table]:
    """Return the sheet as tables: gears, mesh, points of the path of contact."""
    gears = tuple(entry.row(pair) for entry in GEARS)
    mesh = tuple(entry.row(pair) for entry in MESH)
    points = tuple(_point_row(*point) for point in _path_points(pair).items())
    return (
        Table("Gears", ("quantity", "symbol", "pinion", "wheel", "unit"), gears),
        Table("Mesh", ("quantity", "symbol", "value", "unit"), mesh),
        Table("Path of contact", _POINT_HEAD, points),
    )


def _point_row(name: str, point: Json) -> tuple[str, ...]:
    numbers = [_text(length, "mm") for length in point["diameter_mm"]]
    numbers += [_text(angle, "deg") for angle in point["roll_angle_deg"]]
    ratios = (point["sliding_factor"], *point["specific_sliding"])
    return (name, *numbers, *(f"{round(ratio, 3) + 0.0:.3f}" for ratio in ratios))  # + 0.0: no -0.0


def data_sheet_section(pair: ParallelAxes, tolerance_class: int | None = None) -> Section:
    """Return the sheet as a section: the warnings, the drawing, then the tables."""
    remarks = " ".join(f"Warning: {remark['message']}" for remark in pair_remarks(pair))
    text = remarks or "No warnings: undercut, backlash, tip clearance, tip thickness, contact ratio."
    figures = (pair_drawing(pair, tolerance_class), *teeth_as_made(pair))
    return Section("Data sheet", text, figures=figures, tables=data_sheet(pair))


def data_sheet_json(pair: ParallelAxes) -> Json:
    """Return the sheet as plain JSON: by gear, of the mesh, and by point of the path of contact."""
    gears = {entry.name: entry.values(pair) for entry in GEARS}
    return {
        "pinion": {name: both[0] for name, both in gears.items()},
        "wheel": {name: both[1] for name, both in gears.items()},
        "mesh": {entry.name: entry.values(pair)[0] for entry in MESH},
        "path_of_contact": _path_points(pair),
    }


def _text(value: float, unit: str) -> str:
    """Write a value with the decimals of its unit; numbers of teeth are whole."""
    if not unit and value.is_integer():
        return f"{value:.0f}"
    digits_before = len(f"{abs(value):.0f}")
    decimals = min(_DECIMALS[unit], max(MAX_DIGITS - digits_before, 0))
    return f"{value:.{decimals}f}"
