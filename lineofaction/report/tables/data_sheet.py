"""The data sheet of a pair (ISO 21771-1): both gears, their mesh, the points of the path of contact."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fe_contact.geometry import ParallelAxes, Toothing, sliding_factor, specific_sliding
from lineofaction.gearbox.units import DEGREE, MM, UM
from lineofaction.report.drawing.figure import Table
from lineofaction.report.drawing.page import Section
from lineofaction.report.tables.pair_drawing import pair_drawing
from lineofaction.report.tables.pair_remarks import pair_remarks

Json = dict[str, Any]

_UNITS: Mapping[str, float] = {"": 1.0, "mm": MM, "um": UM, "deg": DEGREE}
_DECIMALS = {"": 4, "mm": 4, "um": 1, "deg": 4}


@dataclass(frozen=True)
class Entry:
    """A line of the sheet.

    Attributes
    ----------
    words, symbol : str
        As in ISO 21771-1.
    unit : str
        Of the boundary.
    of : callable
        Its values in SI: of pinion and wheel, or of the pair.
    """

    words: str
    symbol: str
    unit: str
    of: Callable[[ParallelAxes], Sequence[float]]

    @property
    def name(self) -> str:
        """Its name in JSON, with the unit."""
        words = self.words.replace(" ", "_").replace("-", "_")
        return f"{words}_{self.unit}" if self.unit else words

    def values(self, pair: ParallelAxes) -> list[float]:
        """Return the values in the unit of the boundary."""
        return [float(value) / _UNITS[self.unit] + 0.0 for value in self.of(pair)]

    def row(self, pair: ParallelAxes) -> tuple[str, ...]:
        """Return the line as words."""
        return (self.words, self.symbol, *(_text(value, self.unit) for value in self.values(pair)), self.unit)


def _both(of: Callable[[Toothing], float]) -> Callable[[ParallelAxes], Sequence[float]]:
    return lambda pair: (of(pair.pinion), of(pair.wheel))


def _pair(of: Callable[[ParallelAxes], float]) -> Callable[[ParallelAxes], Sequence[float]]:
    return lambda pair: (of(pair),)


def _start_rolls(pair: ParallelAxes) -> tuple[float, float]:
    """Roll lengths in m of both gears where their active flanks begin at the root."""
    path = pair.active_path
    return path.start, float(pair.mating_roll_length(path.end))


def _start_diameters(pair: ParallelAxes) -> list[float]:
    """Diameters in m at which the active flanks begin."""
    gears = (pair.pinion, pair.wheel)
    rolls = zip(gears, _start_rolls(pair), strict=True)
    return [2.0 * math.hypot(gear.base_radius, roll) for gear, roll in rolls]


GEARS = (
    Entry("number of teeth", "z", "", _both(lambda gear: gear.teeth)),
    Entry("profile shift coefficient", "x", "", _both(lambda gear: gear.profile_shift_coefficient)),
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


@dataclass(frozen=True)
class PathPoint:
    """A point of the path of contact: diameters in m, roll angles in rad, sliding without a unit."""

    name: str
    diameter: tuple[float, float]
    roll_angle: tuple[float, float]
    sliding_factor: float
    specific_sliding: tuple[float, float]


def _path_points(pair: ParallelAxes) -> list[PathPoint]:
    """Return A to E of the usable flanks."""
    radii = pair.pinion.base_radius, pair.wheel.base_radius
    points = []
    for name, roll in zip("ABCDE", pair.active_path.points, strict=True):
        rolls = roll, float(pair.mating_roll_length(roll))
        first, second = specific_sliding(pair, roll)
        points.append(
            PathPoint(
                name,
                (2.0 * math.hypot(radii[0], rolls[0]), 2.0 * math.hypot(radii[1], rolls[1])),
                (rolls[0] / radii[0], rolls[1] / radii[1]),
                float(sliding_factor(pair, roll)),
                (float(first), float(second)),
            )
        )
    return points


def data_sheet(pair: ParallelAxes) -> tuple[Table, Table, Table]:
    """Return the sheet as tables: gears, mesh, points of the path of contact."""
    gears = tuple(entry.row(pair) for entry in GEARS)
    mesh = tuple(entry.row(pair) for entry in MESH)
    return (
        Table("Gears", ("quantity", "symbol", "pinion", "wheel", "unit"), gears),
        Table("Mesh", ("quantity", "symbol", "value", "unit"), mesh),
        Table("Path of contact", _POINT_HEAD, tuple(_point_row(point) for point in _path_points(pair))),
    )


_POINT_HEAD = (
    "point",
    "d_y1 mm",
    "d_y2 mm",
    "roll angle 1 deg",
    "roll angle 2 deg",
    "sliding factor K_g",
    "specific sliding 1",
    "specific sliding 2",
)


def _point_row(point: PathPoint) -> tuple[str, ...]:
    lengths = [diameter / MM for diameter in point.diameter]
    angles = [angle / DEGREE for angle in point.roll_angle]
    sliding = (point.sliding_factor, *point.specific_sliding)
    numbers = [_text(length, "mm") for length in lengths] + [_text(angle, "deg") for angle in angles]
    return (point.name, *numbers, *(_ratio(value) for value in sliding))


def data_sheet_section(pair: ParallelAxes) -> Section:
    """Return the sheet as a section: what speaks against it, the drawing, then the tables."""
    remarks = " ".join(f"Warning: {remark['message']}" for remark in pair_remarks(pair))
    text = remarks or "No warnings: undercut, backlash, tip clearance, tip thickness, contact ratio."
    return Section("Data sheet", text, figures=(pair_drawing(pair),), tables=data_sheet(pair))


def data_sheet_json(pair: ParallelAxes) -> Json:
    """Return the sheet as plain JSON: by gear, of the mesh, and by point of the path of contact."""
    gears = {entry.name: entry.values(pair) for entry in GEARS}
    sides = {
        side: {name: both[index] for name, both in gears.items()}
        for index, side in enumerate(("pinion", "wheel"))
    }
    points = {
        point.name: {
            "diameter_mm": [diameter / MM for diameter in point.diameter],
            "roll_angle_deg": [angle / DEGREE for angle in point.roll_angle],
            "sliding_factor": point.sliding_factor,
            "specific_sliding": list(point.specific_sliding),
        }
        for point in _path_points(pair)
    }
    return sides | {"mesh": {entry.name: entry.values(pair)[0] for entry in MESH}, "path_of_contact": points}


def _text(value: float, unit: str) -> str:
    """Write a value with the decimals of its unit; numbers of teeth are whole."""
    return f"{value:.0f}" if not unit and value.is_integer() else f"{value:.{_DECIMALS[unit]}f}"


def _ratio(value: float) -> str:
    """Write a ratio of speeds; what is zero but for rounding is zero."""
    return f"{round(value, 3) + 0.0:.3f}"
