"""Flank results: contact pattern, contact lines, load over the face."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

import numpy as np

from bounds import engineering
from bounds.error_digits import error_text, to_error
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.analysis.flanks.pressure_map import pressure_map
from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate, IntArray
from lineofaction.gearbox.convert.effects import assumption_lines
from lineofaction.gearbox.convert.operating_point import pair_point, typed
from lineofaction.gearbox.units import MPA, boundary_ledger
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    HeatMap,
    Line,
    Panel,
    Reference,
    Strokes,
    Table,
    number,
)
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.tables import settings_table
from lineofaction.report.pair import pair_lead, pair_title
from lineofaction.report.presentation import Presentation
from lineofaction.report.ste.curves import POSITION_LABEL
from lineofaction.report.ste.headlines import edge_text
from lineofaction.report.ste.page import case_tables, contact_effects

N_PER_MM = 1e3
"""One N/mm in N/m."""

MAX_LINES = 8  # most positions with a contact line in a plot
Gear = Literal["pinion", "wheel"]
GEARS: tuple[Gear, ...] = ("pinion", "wheel")
PRESSURE = "Hertz pressure, MPa"
_MAX_ISOLINES = 6
_HIGHEST_ISOLINE = 0.92  # share of the largest: curves about a ridge narrower than the positions break up
_Map = tuple[FloatArray, FloatArray]
"""Roll lengths (R,) in mm and pressures (R, K) in MPa of a contact pattern."""
MAX_CURVES = 4  # most positions with a curve in a plot
_VISIBLE_GAP = 0.01
"""Least gap that is drawn, um; a plot of a smaller gap shows nothing."""
_ROUNDING = 1e-9
"""Share of the face width within which a load centroid counts as mid-face, the rounding of a symmetric load.
"""


def _face_axis(flanks: LoadDistribution) -> Axis:
    low, high = (1e3 * end for end in flanks.scene.common_face)
    return Axis("face position, mm (0 = mid-face of the pinion; right: +z end)", limits=(low, high))


def contact_lines(flanks: LoadDistribution) -> Figure:
    """Draw contact lines at positions spread over the cycle, and separately at the largest pressure."""
    worst = int(flanks.pressure.max(axis=(1, 2)).argmax())
    step = max(flanks.position.size // MAX_LINES, 1)
    chosen = np.arange(0, flanks.position.size, step)
    load = _strokes(flanks, chosen, 1e-3 * flanks.line_load, "line load, N/mm")
    pressure = _strokes(flanks, np.array([worst]), 1e-6 * flanks.pressure, "Hertz pressure, MPa")
    at = f"{flanks.position[worst]:.3g}"
    x = _face_axis(flanks)
    start, *_, end = (1e3 * point for point in flanks.scene.path_of_contact)
    room = 0.06 * (end - start)
    y = Axis("roll length of the pinion, mm", limits=(start - room, end + 1.5 * room))
    return Figure(
        key="contact_lines",
        title="Contact lines in the plane of action",
        caption="Where the tooth pairs touch: face across, path of contact upwards from the pinion's root "
        "(A) to its tip (E). Color and thickness: line load; thin gray: flanks that could touch "
        "but carry no load. "
        f"One stroke is {number(1e3 * flanks.slice_width, 2)} mm of the face, its color the mean there.",
        alternative=f"At most {_to_error(flanks.largest_line_load, N_PER_MM)} N/mm; at position {at}, the "
        f"one of the largest pressure, tooth pairs that carry load: {_carrying(flanks, worst)}.",
        content=(
            Panel(x, y, (), _marks(flanks), f"line load at {chosen.size} positions of the cycle", load),
            Panel(x, y, (), _marks(flanks), f"pressure at position {at}, where it is largest", pressure),
        ),
        table=_table(flanks, chosen),
    )


def _marks(flanks: LoadDistribution) -> tuple[Reference, ...]:
    """Mark A, C, E, and B and D where one pair alone can carry."""
    points = dict(zip("ABCDE", flanks.scene.path_of_contact, strict=True))
    single = points["A"] < points["B"] < points["D"] < points["E"]
    marks = []
    for name in "ABCDE" if single else "ACE":
        label_end = 0.99 if name in "ACE" else 0.95
        marks.append(Reference(name, 1e3 * points[name], "horizontal", label_end))
    return tuple(marks)


def _strokes(flanks: LoadDistribution, chosen: IntArray, values: FloatArray, label: str) -> Strokes:
    """Draw one stroke per slice that can touch, as long as the slice is wide and as oblique as the helix.

    Axes of the arrays: position, tooth pair, slice.
    """
    present = (flanks.on_path | (flanks.force > 0.0))[chosen]
    roll, face = 1e3 * flanks.roll_length_1[chosen], 1e3 * flanks.face_position
    # the contact line's rise over half a slice, mm; zero at tip edges, which are no part of the line
    rise = -0.5e3 * flanks.slice_width * math.tan(flanks.base_helix_angle) * flanks.on_path[chosen]
    half = 0.5e3 * flanks.slice_width
    x = np.stack(np.broadcast_arrays(face - half, face + half), axis=-1)
    ends = np.stack([roll - rise, roll + rise], axis=-1)[present]
    across = np.broadcast_to(x, (*present.shape, 2))[present]
    return Strokes(across, ends, values[chosen][present], label, float(values.max()))


def _carrying(flanks: LoadDistribution, position: int) -> int:
    return int(np.count_nonzero(flanks.force[position].sum(axis=-1)))


def _table(flanks: LoadDistribution, chosen: IntArray) -> Table:
    load, pressure = flanks.largest_line_load, flanks.largest_pressure
    columns = {
        "position, base pitches": lambda k: f"{flanks.position[k]:.4g}",
        "pairs that carry": lambda k: str(_carrying(flanks, int(k))),
        "largest line load, N/mm": lambda k: _as_exact_as(load, float(flanks.line_load[k].max()), N_PER_MM),
        "over its mean": lambda k: number(float(flanks.line_load_factor[k]), 3),
        "largest pressure, MPa": lambda k: _as_exact_as(pressure, float(flanks.pressure[k].max()), MPA),
    }
    return Table.of("Contact lines by position", chosen, columns)


def contact_pattern_figure(flanks: LoadDistribution) -> Figure:
    """Draw one panel per gear: colors over face and roll length, or a curve where there is one slice."""
    pressures = (pressure_map(flanks, roll) for roll in (flanks.roll_length_1, flanks.roll_length_2))
    maps = [(1e3 * rows, 1e-6 * pressure) for rows, pressure in pressures]
    count = flanks.face_position.size
    drawn = _shaded_panel if count > 1 else _curve
    teeth = "/".join(map(str, flanks.scene.geometry.teeth))
    stretches = f" and {count} stretches of the face; blank: nothing touches" if count > 1 else ""
    return Figure(
        key="contact_pattern",
        title=f"Contact pattern, {teeth}, {_point(flanks).removeprefix('at ')}",
        caption="The Hertz pressure that passes over each point of the unrolled flanks, interpolated between "
        f"{flanks.position.size} positions{stretches}. At a tip edge the true pressure is "
        "singular, and this a measure only. Roll length: distance to the base circle along the "
        "involute's normal. Seen from the +z end, the driving gear turns clockwise.",
        alternative=_alternative(flanks),
        content=tuple(drawn(flanks, gear, pattern) for gear, pattern in zip(GEARS, maps, strict=True)),
        table=_pattern_table(flanks, maps),
    )


def _roll_marks(
    flanks: LoadDistribution, gear: Gear, direction: Literal["horizontal", "vertical"]
) -> tuple[Reference, ...]:
    scene, index = flanks.scene, GEARS.index(gear)
    marks = {
        "start of active profile": scene.start_of_active_profile[index],
        "pitch point": scene.pitch_point[index],
        "tip": scene.tip[index],
    }
    base = scene.geometry.base_radius[index]
    return tuple(
        Reference(f"{name}, d {2e3 * np.hypot(base, roll):.4g} mm", 1e3 * roll, direction, 0.99)
        for name, roll in marks.items()
    )


def _shaded_panel(flanks: LoadDistribution, gear: Gear, pattern: _Map) -> Panel:
    roll, pressure = pattern
    largest = 1e-6 * float(flanks.pressure.max())
    face = 1e3 * flanks.face_position
    return Panel(
        _face_axis(flanks),
        Axis("roll length, mm", limits=_extent(flanks, gear, roll)),
        references=_roll_marks(flanks, gear, "horizontal"),
        title=_title(flanks, gear),
        shade=HeatMap(face, roll, pressure, PRESSURE, largest, isolines=_isolines(largest)),
    )


def _isolines(largest: float) -> tuple[float, ...]:
    """Return round levels below the largest pressure: multiples of 0.2, 0.5, 1, 2 or 5 powers of ten."""
    power = 10.0 ** np.floor(np.log10(largest)) if largest > 0.0 else 1.0
    steps = [factor * power for factor in (0.2, 0.5, 1.0, 2.0, 5.0)]
    step = next(step for step in steps if largest / step <= _MAX_ISOLINES + 1)
    count = int(_HIGHEST_ISOLINE * largest / step)
    return tuple(float(step * k) for k in range(1, count + 1))


def _title(flanks: LoadDistribution, gear: Gear) -> str:
    if gear == "pinion":
        return "pinion (drives): root below, tip above"
    ring = flanks.scene.geometry.internal
    return "ring gear: tip below, root above" if ring else "wheel: root below, tip above"


def _curve(flanks: LoadDistribution, gear: Gear, pattern: _Map) -> Panel:
    """Draw the pressure along the profile: in the plane it is the same over the face."""
    roll, pressure = pattern
    line = Line("pressure", roll, pressure[:, 0], palette.BLUE)
    title = _title(flanks, gear).replace("below", "left").replace("above", "right")
    return Panel(
        Axis("roll length, mm", limits=_extent(flanks, gear, roll)),
        Axis(PRESSURE, limits=(0.0, 1.15e-6 * float(flanks.pressure.max()))),  # MPa, with 15 % of room
        (line,),
        _roll_marks(flanks, gear, "vertical"),
        title,
    )


def _extent(flanks: LoadDistribution, gear: Gear, roll: FloatArray) -> tuple[float, float]:
    """Return the range in mm from the touched flank, or the start of the active profile, to the tip."""
    scene, index = flanks.scene, GEARS.index(gear)
    ends = scene.start_of_active_profile[index], scene.tip[index]
    marks = [*(1e3 * end for end in ends), float(roll[0]), float(roll[-1])]
    low, high = min(marks), max(marks)  # the tip of a ring is the lower one
    room = 0.06 * (high - low)
    return low - room, high + room * (1.5 if flanks.face_position.size > 1 else 3.0)  # room for marks' texts


def _alternative(flanks: LoadDistribution) -> str:
    worst = np.unravel_index(int(flanks.clear_pressure.argmax()), flanks.pressure.shape)
    roll = 1e3 * float(flanks.roll_length_1[worst])
    face = 1e3 * float(flanks.face_position[worst[-1]])  # axes: position, tooth pair, slice
    largest = _as_exact_as(flanks.largest_pressure, float(flanks.pressure[worst]), MPA)
    where = f"at roll length {number(roll, 3)} mm of the pinion"
    if flanks.face_position.size == 1:
        return f"The largest pressure is {largest} MPa, {where}."
    return f"The largest pressure is {largest} MPa, {where}, {number(face, 3)} mm from its mid-face."


def _pattern_table(flanks: LoadDistribution, maps: list[_Map]) -> Table:
    """List the largest pressure of each stretch of the face, or of each part of the pinion's profile."""
    if flanks.face_position.size > 1:
        caption, over = "Largest pressure over the face", "face position, mm"
        at, largest = 1e3 * flanks.face_position, 1e-6 * flanks.pressure.max(axis=(0, 1))
    else:
        caption, over = "Pressure along the profile", "roll length of the pinion, mm"
        at, largest = maps[0][0], maps[0][1][:, 0]
    rows = tuple(tuple(map(number, row)) for row in zip(at, largest, strict=True))
    return Table(caption, (over, "pressure, MPa"), rows)


def line_load_figure(flanks: LoadDistribution) -> Figure:
    """Draw the load of all pairs per unit of face width, and the gap that the most loaded pair leaves."""
    chosen = np.unique(np.linspace(0, flanks.position.size, MAX_CURVES, endpoint=False).astype(int))
    face = _face_axis(flanks)
    mean = 1e-3 * flanks.face_load.mean(axis=0)
    names = [f"position {flanks.position[k]:.3g}" for k in chosen]
    x = 1e3 * flanks.face_position
    colors = [palette.BLUE, palette.SKY, palette.GREEN, palette.PURPLE][: len(chosen)]
    loads = [
        Line(name, x, 1e-3 * flanks.face_load[k], color, label=name)
        for name, k, color in zip(names, chosen, colors, strict=True)
    ]
    cycle = Line("mean over the positions", x, mean, palette.VERMILLION, width=3.0, label="mean")
    factor = flanks.mean_face_load_factor
    gaps = _gap_panel(flanks, face, dict(zip(names, chosen, strict=True)), colors)
    return Figure(
        key="line_load",
        title="Load and gap over the face" if gaps else "Load over the face",
        caption=_line_load_caption(flanks, with_gap=bool(gaps)),
        alternative=f"Averaged over the positions the face carries {number(mean.min(), 4)} to "
        f"{number(mean.max(), 4)} N/mm: K_Hbeta {number(factor, 3)}.",
        content=(Panel(face, Axis("load per face width, N/mm"), (*loads, cycle)), *gaps),
        table=_face_table(flanks, mean),
    )


def _gap_panel(
    flanks: LoadDistribution, face: Axis, chosen: dict[str, int], colors: list[str]
) -> tuple[Panel, ...]:
    """Draw the gap left on the pair that carries most; nothing where its flanks touch all along the face."""
    x = 1e3 * flanks.face_position
    lines = []
    for (name, position), color in zip(chosen.items(), colors, strict=True):
        pair = int(flanks.force[position].sum(axis=-1).argmax())
        gap = 1e6 * flanks.gap[position, pair]
        can_meet = np.isfinite(gap) & flanks.on_path[position, pair]
        lines.append(Line(name, x, np.where(can_meet, gap, np.nan), color, label=name))
    if not any(np.nanmax(line.y, initial=0.0) > _VISIBLE_GAP for line in lines):
        return ()
    return (Panel(face, Axis("gap, µm"), tuple(lines)),)


def _line_load_caption(flanks: LoadDistribution, *, with_gap: bool) -> str:
    caption = "Force of all pairs per unit of face width."
    if with_gap:
        caption = (
            f"First: {caption[0].lower()}{caption[1:]} Second: remaining gap between the loaded flanks of "
            "the pair with the largest load; 0 in contact."
        )
    else:
        caption += " The flanks of the pair with the largest load touch wherever they can: no gap."
    if flanks.base_helix_angle == 0.0:
        return caption
    return f"{caption} A single position is uneven: the number of pairs that touch changes along the face."


def load_centroid_figure(flanks: LoadDistribution) -> Figure:
    """Draw where along the face the load acts, and how unevenly it lies, over position."""
    factor = flanks.mean_face_load_factor
    k = number(factor, 3)
    rounding = _ROUNDING * float(np.ptp(flanks.face_position))
    centroid = 1e3 * np.where(np.abs(flanks.load_centroid) > rounding, flanks.load_centroid, 0.0)
    return Figure(
        key="load_centroid",
        title="Load centroid and face load factor",
        caption="First: distance of the load's centroid from the pinion's mid-face. Second: largest over "
        "mean load per unit of face width at each position; the line is that of the load averaged over all "
        "of them, K_Hbeta of ISO 6336-1 for this alignment and without manufacturing errors.",
        alternative=f"The centroid lies {number(centroid.min(), 3)} to "
        f"{number(centroid.max(), 3)} mm from mid-face; K_Hbeta is {k}.",
        content=(
            _over_position(flanks, "load centroid, mm", centroid, "mid-face", 0.0),
            _over_position(flanks, "largest over mean load", flanks.face_load_factor, f"K_Hbeta {k}", factor),
        ),
    )


def _over_position(flanks: LoadDistribution, y: str, values: FloatArray, mark: str, at: float) -> Panel:
    """Draw a curve over position and a marked value; a curve over a full cycle is closed."""
    step = np.diff(flanks.position)
    is_full_cycle = step.size > 0 and np.allclose(step, 1.0 / flanks.position.size)
    position = flanks.position
    if is_full_cycle:
        position = np.append(position, 1.0 + position[0])
        values = np.append(values, values[0])
    line = Line("", position, values, palette.BLUE)
    marks = (Reference(mark, at, "horizontal"),)
    return Panel(Axis.over(POSITION_LABEL, position), Axis(y), (line,), marks)


def _face_table(flanks: LoadDistribution, mean: FloatArray) -> Table:
    largest = 1e-3 * flanks.line_load.max(axis=(0, 1))
    load = flanks.largest_line_load
    columns = {
        "face position, mm": lambda k: number(1e3 * float(flanks.face_position[k]), 4),
        "mean load per face width, N/mm": lambda k: _as_exact_as(load, float(mean[k]) * N_PER_MM, N_PER_MM),
        "largest line load, N/mm": lambda k: _as_exact_as(load, float(largest[k]) * N_PER_MM, N_PER_MM),
    }
    return Table.of("Load over the face", range(mean.size), columns)


def error_or_reason(estimate: Estimate, unit: str, scale: float, reason: str) -> str:
    """Return the error of a figure in a unit of `scale` SI units, or that it has none, and why."""
    if math.isnan(estimate.error):
        return f"error not estimated: {reason}"
    return f"± {error_text(estimate.value / scale, estimate.error / scale)} {unit}".rstrip()


def _as_exact_as(largest: Estimate, value: float, scale: float) -> str:
    """Write a value, in SI, to the digits that the error of the largest of its kind leaves."""
    return to_error(value / scale, largest.error / scale)


def _to_error(estimate: Estimate, scale: float = 1.0) -> str:
    return to_error(estimate.value / scale, estimate.error / scale)


def _page(flanks: LoadDistribution, database: SteDatabase | None = None) -> Page:
    """Return the page of flank results; effects and case are left out where their database shows them."""
    pair = flanks.scene.geometry
    sections = (_results(flanks), *_making(flanks, alone=database is None))
    heads = tuple(_headlines(flanks))
    return Page(pair_title(pair), pair_lead(pair), heads, sections, _alarms(flanks, database))


def _headlines(flanks: LoadDistribution) -> Iterator[Headline]:
    """Yield the largest pressure, the largest line load and K_Hbeta, with errors or why there are none."""
    reason, at = flanks.errors.reason, f"at {typed(flanks.scene.torque)} N m"
    pressure, load = flanks.largest_pressure, flanks.largest_line_load
    band = error_or_reason(pressure, "MPa", MPA, reason)
    remark = f"{band}{_kink_text(flanks)}{edge_text(flanks.edge_pressure)}"
    yield Headline(f"largest flank pressure {at}", f"{_to_error(pressure, MPA)} MPa", remark)
    band = error_or_reason(load, "N/mm", N_PER_MM, reason)
    remark = f"{band}{_length_text(flanks)}{_edge_load(flanks)}"
    yield Headline(f"largest line load {at}", f"{_to_error(load, N_PER_MM)} N/mm", remark)
    if flanks.face_position.size > 1:
        factor = flanks.cycle_face_load_factor
        remark = f"{error_or_reason(factor, '', 1.0, reason)}{_length_text(flanks)}"
        yield Headline(f"K_Hbeta over the cycle {at}", _to_error(factor), remark)


def _kink_text(flanks: LoadDistribution) -> str:
    """Return text on the length over which the pressure at a kink is a mean; empty without a kink."""
    length = flanks.errors.kink_length
    if length <= 0.0:
        return ""
    over = number(1e3 * length, 2)
    return f", infinite at the kink of a relief: 4/pi times the mean over {over} mm of profile"


def _edge_load(flanks: LoadDistribution) -> str:
    """Return text on the line load at edges, a mean over a slice; empty: no edge is reached."""
    load = flanks.edge_line_load
    if load.value <= 0.0:
        return ""
    band = error_or_reason(load, "N/mm", N_PER_MM, flanks.errors.reason)
    over = f", mean over {number(1e3 * flanks.edge_length, 2)} mm" if flanks.face_position.size > 1 else ""
    return f"; {_to_error(load, N_PER_MM)} N/mm at the edges, {band}{over}"


def _length_text(flanks: LoadDistribution) -> str:
    """Return text on the length over which a load is the mean; empty in the plane."""
    if flanks.face_position.size == 1:
        return ""
    return f", peak over {number(1e3 * flanks.slice_width, 2)} mm of the face"


def _results(flanks: LoadDistribution) -> Section:
    """Return the section of the flanks; a plane model, of one slice, has no plots over the face."""
    figures: tuple[Figure, ...] = (contact_pattern_figure(flanks),)
    text = f"{flanks.position.size} positions of the mesh cycle."
    if flanks.face_position.size > 1:
        figures += (contact_lines(flanks), line_load_figure(flanks), load_centroid_figure(flanks))
    else:
        text += " The model is plane: what is shown is the same over the whole face."
    return Section("Flanks", text, figures=figures)


def _making(flanks: LoadDistribution, *, alone: bool) -> tuple[Section, ...]:
    """Return the sections on how the results were made; `alone`: without a database, add effects and case."""
    metadata = flanks.metadata
    if not metadata.receipt:
        return ()
    cost = {name: value for name, value in metadata.receipt.items() if name not in ("plan", "laws")}
    versions = {**metadata.software_versions, "content_hash": metadata.content_hash}
    section = Section(
        "Receipt of the flank results",
        tables=(settings_table("Cost", cost),),
        folded=(settings_table("Made with", versions),),
        part=Part.RECEIPT,
    )
    if not alone:
        return (section,)
    case = Section("Case", folded=case_tables(metadata.case), part=Part.INPUT)
    return contact_effects(boundary_ledger(metadata.effect_ledger)), case, section


def _alarms(flanks: LoadDistribution, database: SteDatabase | None) -> tuple[str, ...]:
    """Return an alarm if database and flank results are of different pairs."""
    if database is None:
        return ()
    computed, stored = flanks.scene.geometry, database.geometry
    same_pair = computed.teeth == stored.teeth
    for name in ("base_pitch", "face_width"):
        size = getattr(stored, name)
        same_pair &= abs(getattr(computed, name) - size) <= 1e-9 * size
    return () if same_pair else ("The flank results and the STE database are of different gear pairs.",)


def _point(flanks: LoadDistribution) -> str:
    scene = flanks.scene
    return pair_point(scene.torque, scene.normal_force, scene.misalignment, scene.center_distance_change)


def _text(flanks: LoadDistribution) -> Iterator[str]:
    receipt, reason = flanks.metadata.receipt, flanks.errors.reason
    if flanks.face_position.size > 1:
        ends = (engineering(1e3 * end, 3) for end in (flanks.load_centroid.min(), flanks.load_centroid.max()))
        largest = flanks.largest_face_load_factor
        yield (
            f"K_Hbeta at most {_to_error(largest)} at one position, "
            f"{error_or_reason(largest, '', 1.0, reason)}{_length_text(flanks)}; "
            f"load centroid {' to '.join(dict.fromkeys(ends))} mm from mid-face"
        )
    yield from assumption_lines(receipt)


PAGE = Presentation(contact_pattern_figure, _page, _text, with_database=_page, point=_point)
