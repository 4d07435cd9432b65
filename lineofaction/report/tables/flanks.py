"""Flank results: contact lines, contact pattern, loads over the face."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from fe_contact.analysis.flanks.load_distribution import LoadDistribution, pressure_map
from fe_contact.types import IntArray
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
from lineofaction.report.tables.ste import POSITION_LABEL


def _face_axis(flanks: LoadDistribution) -> Axis:
    """Return the axis across the face."""
    low, high = (1e3 * end for end in flanks.scene.common_face)
    return Axis("face position, mm (0 = mid-face of the pinion; right: +z end)", limits=(low, high))


# Contact lines of all pairs in the plane of action, with the line load they carry.


LINES_SHOWN = 8  # positions


def contact_lines(flanks: LoadDistribution) -> Figure:
    """Draw contact lines at positions spread over the cycle, and those of the largest pressure alone."""
    worst = int(flanks.pressure.max(axis=(1, 2)).argmax())
    step = max(flanks.position.size // LINES_SHOWN, 1)
    chosen = np.arange(0, flanks.position.size, step)
    load = _strokes(flanks, chosen, 1e-3 * flanks.line_load, "line load, N/mm")
    pressure = _strokes(flanks, np.array([worst]), 1e-6 * flanks.pressure, "Hertz pressure, MPa")
    at = f"{flanks.position[worst]:.3g}"
    x, y = _axes(flanks)
    return Figure(
        key="contact_lines",
        title="Contact lines in the plane of action",
        caption="Where the tooth pairs touch: face across, path of contact upwards from the pinion's root "
        "(A) to its tip (E). Color and thickness: line load; thin gray: flanks that could touch "
        "but carry no load. "
        f"{_strip(flanks)}",
        alternative=f"At most {number(float(1e-3 * flanks.line_load.max()), 4)} N/mm; at position {at}, the "
        f"one of the largest pressure, {_carrying(flanks, worst)} tooth pairs carry load.",
        content=(
            Panel(x, y, (), _marks(flanks), f"line load at {chosen.size} positions of the cycle", load),
            Panel(x, y, (), _marks(flanks), f"pressure at position {at}, where it is largest", pressure),
        ),
        table=_table(flanks, chosen),
    )


def _axes(flanks: LoadDistribution) -> tuple[Axis, Axis]:
    """Face and path of contact, mm."""
    start, *_, end = (1e3 * point for point in flanks.scene.path_of_contact)
    room = 0.06 * (end - start)
    return (
        _face_axis(flanks),
        Axis("roll length of the pinion, mm", limits=(start - room, end + 1.5 * room)),
    )


def _marks(flanks: LoadDistribution) -> tuple[Reference, ...]:
    """Mark A, C, E, and B and D where one pair alone can carry."""
    points = dict(zip("ABCDE", flanks.scene.path_of_contact, strict=True))
    single = points["A"] < points["B"] < points["D"] < points["E"]
    names = "ABCDE" if single else "ACE"
    return tuple(
        Reference(name, 1e3 * points[name], "horizontal", 0.99 if name in "ACE" else 0.95) for name in names
    )


def _strokes(flanks: LoadDistribution, chosen: IntArray, values: FloatArray, label: str) -> Strokes:
    """One stroke per slice that can touch, as long as the slice is wide and as oblique as the helix."""
    present = (flanks.on_path | (flanks.force > 0.0))[chosen]
    roll, face = 1e3 * flanks.roll_length_1[chosen], 1e3 * flanks.face_position
    rise = -0.5e3 * flanks.slice_width * math.tan(flanks.base_helix_angle) * flanks.on_path[chosen]
    half = 0.5e3 * flanks.slice_width
    x = np.stack(np.broadcast_arrays(face - half, face + half), axis=-1)
    ends = np.stack([roll - rise, roll + rise], axis=-1)[present]
    across = np.broadcast_to(x, (*present.shape, 2))[present]
    return Strokes(across, ends, values[chosen][present], label, float(values.max()))


def _strip(flanks: LoadDistribution) -> str:
    return f"One stroke is {number(1e3 * flanks.slice_width, 2)} mm of the face, its color the mean there."


def _carrying(flanks: LoadDistribution, position: int) -> int:
    return int(np.count_nonzero(flanks.force[position].sum(axis=-1)))


def _table(flanks: LoadDistribution, chosen: IntArray) -> Table:
    """Pairs in contact, line load and pressure at the positions shown."""
    rows = tuple(
        (
            f"{flanks.position[k]:.4g}",
            str(_carrying(flanks, int(k))),
            number(1e-3 * float(flanks.line_load[k].max())),
            number(float(flanks.line_load_factor[k]), 3),
            number(1e-6 * float(flanks.pressure[k].max())),
        )
        for k in chosen
    )
    head = (
        "position, base pitches",
        "pairs that carry",
        "largest line load, N/mm",
        "over its mean",
        "largest pressure, MPa",
    )
    return Table("Contact lines by position", head, rows)


# Contact pattern: the pressure that passes over the unrolled flanks of both gears in a mesh cycle.


Gear = Literal["pinion", "wheel"]
GEARS: tuple[Gear, ...] = ("pinion", "wheel")
PRESSURE = "Hertz pressure, MPa"
_MOST_ISOLINES = 6
_HIGHEST_ISOLINE = 0.92  # of the largest; a curve about a ridge narrower than the positions breaks up
_Map = tuple[FloatArray, FloatArray]
"""Roll lengths (R,) in mm and pressures (R, K) in MPa."""


def contact_pattern_figure(flanks: LoadDistribution) -> Figure:
    """Draw one panel per gear: colors over face and roll length, or a curve where there is one slice."""
    drawn = _shaded if flanks.face_position.size > 1 else _curve
    maps = [_map(flanks, roll) for roll in (flanks.roll_length_1, flanks.roll_length_2)]
    return Figure(
        key="contact_pattern",
        title="Contact pattern",
        caption="The Hertz pressure that passes over each point of the unrolled flanks, interpolated between "
        f"{flanks.position.size} positions{_stretches(flanks)}. At a tip edge the true pressure is "
        "singular, and this a measure only. Roll length: distance to the base circle along the "
        "involute's normal. Seen from the +z end, the driving gear turns clockwise.",
        alternative=_words(flanks),
        content=tuple(drawn(flanks, gear, one) for gear, one in zip(GEARS, maps, strict=True)),
        table=_pattern_table(flanks, maps),
    )


def _map(flanks: LoadDistribution, roll: FloatArray) -> _Map:
    """Return the pressure over one flank in mm and MPa."""
    rows, pressure = pressure_map(flanks, roll)
    return 1e3 * rows, 1e-6 * pressure


def _stretches(flanks: LoadDistribution) -> str:
    """Say between how many stretches of the face it is interpolated."""
    count = flanks.face_position.size
    return f" and {count} stretches of the face; blank: nothing touches" if count > 1 else ""


def _roll_marks(
    flanks: LoadDistribution, gear: Gear, direction: Literal["horizontal", "vertical"]
) -> tuple[Reference, ...]:
    """Mark start of active profile, pitch point and tip with their diameters."""
    scene, index = flanks.scene, GEARS.index(gear)
    marks = {
        "start of active profile": scene.start_of_active_profile[index],
        "pitch point": scene.pitch_point[index],
        "tip": scene.tip[index],
    }
    base = scene.facts.base_radius[index]
    return tuple(
        Reference(f"{name}, d {2e3 * np.hypot(base, roll):.4g} mm", 1e3 * roll, direction, 0.99)
        for name, roll in marks.items()
    )


def _shaded(flanks: LoadDistribution, gear: Gear, one: _Map) -> Panel:
    roll, pressure = one
    largest = 1e-6 * float(flanks.pressure.max())
    face = 1e3 * flanks.face_position
    return Panel(
        _face_axis(flanks),
        Axis("roll length, mm", limits=_extent(flanks, gear, roll)),
        references=_roll_marks(flanks, gear, "horizontal"),
        title=_title(flanks, gear),
        shade=HeatMap(face, roll, pressure, PRESSURE, largest, isolines=isolines(largest)),
    )


def isolines(largest: float) -> tuple[float, ...]:
    """Return round values clearly below the largest, at most six."""
    step = 10.0 ** np.floor(np.log10(largest)) if largest > 0.0 else 1.0
    wide = next(w for w in (0.2, 0.5, 1.0, 2.0, 5.0) if largest / (w * step) <= _MOST_ISOLINES + 1)
    count = int(_HIGHEST_ISOLINE * largest / (wide * step))
    return tuple(float(wide * step * k) for k in range(1, count + 1))


def _title(flanks: LoadDistribution, gear: Gear) -> str:
    """Name a flank and where its tip is."""
    if gear == "pinion":
        return "pinion (drives): root below, tip above"
    ring = flanks.scene.facts.internal
    return "ring gear: tip below, root above" if ring else "wheel: root below, tip above"


def _curve(flanks: LoadDistribution, gear: Gear, one: _Map) -> Panel:
    """Draw the pressure along the profile: in the plane it is the same over the face."""
    roll, pressure = one
    line = Line("pressure", roll, pressure[:, 0], palette.BLUE)
    title = _title(flanks, gear).replace("below", "left").replace("above", "right")
    return Panel(
        Axis("roll length, mm", limits=_extent(flanks, gear, roll)),
        Axis(PRESSURE, limits=(0.0, 1.15e-6 * float(flanks.pressure.max()))),
        (line,),
        _roll_marks(flanks, gear, "vertical"),
        title,
    )


def _extent(flanks: LoadDistribution, gear: Gear, roll: FloatArray) -> tuple[float, float]:
    """Return the range in mm from what is touched, or the start of the active profile, to the tip."""
    scene, index = flanks.scene, GEARS.index(gear)
    marks = [
        1e3 * scene.start_of_active_profile[index],
        1e3 * scene.tip[index],
        float(roll[0]),
        float(roll[-1]),
    ]
    low, high = min(marks), max(marks)  # the tip of a ring is the lower one
    room = 0.06 * (high - low)
    return low - room, high + room * (1.5 if flanks.face_position.size > 1 else 3.0)


def _words(flanks: LoadDistribution) -> str:
    """Say where the pressure is largest, edges aside."""
    at = np.unravel_index(int(flanks.clear_pressure.argmax()), flanks.pressure.shape)
    roll, face = (1e3 * float(v) for v in (flanks.roll_length_1[at], flanks.face_position[at[2]]))
    largest = number(1e-6 * float(flanks.pressure[at]), 4)
    where = f"at roll length {number(roll, 3)} mm of the pinion"
    if flanks.face_position.size == 1:
        return f"The largest pressure is {largest} MPa, {where}."
    return f"The largest pressure is {largest} MPa, {where}, {number(face, 3)} mm from its mid-face."


def _pattern_table(flanks: LoadDistribution, maps: list[_Map]) -> Table:
    """Largest pressure of each stretch of the face, or of each part of the pinion's profile."""
    if flanks.face_position.size > 1:
        largest = 1e-6 * flanks.pressure.max(axis=(0, 1))
        rows = zip(1e3 * flanks.face_position, largest, strict=True)
        head = ("face position, mm", "pressure, MPa")
        return Table("Largest pressure over the face", head, tuple(tuple(map(number, row)) for row in rows))
    roll, pressure = maps[0]
    rows = zip(roll, pressure[:, 0], strict=True)
    head = ("roll length of the pinion, mm", "pressure, MPa")
    return Table("Pressure along the profile", head, tuple(tuple(map(number, row)) for row in rows))


# Distribution of the load along the face: load and gap over it, centroid and K_Hbeta over position.


CURVES_SHOWN = 4  # positions

_VISIBLE_GAP = 0.01
"""um; a plot of less shows nothing."""
_ROUNDING = 1e-9
"""Part of the face width; a centroid nearer to mid-face is the rounding of a symmetric load."""


def line_load_figure(flanks: LoadDistribution) -> Figure:
    """Draw the load of all pairs per unit of face width, and the gap that the most loaded pair leaves."""
    chosen = np.unique(np.linspace(0, flanks.position.size, CURVES_SHOWN, endpoint=False).astype(int))
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
        alternative=f"Averaged over the positions the face carries {number(float(mean.min()), 4)} to "
        f"{number(float(mean.max()), 4)} N/mm: K_Hbeta {number(factor, 3)}.",
        content=(
            Panel(face, Axis("load per face width, N/mm"), (*loads, cycle)),
            *gaps,
        ),
        table=_face_table(flanks, mean),
    )


def _gap_panel(
    flanks: LoadDistribution, face: Axis, chosen: dict[str, int], colors: list[str]
) -> tuple[Panel, ...]:
    """Draw the gap left on the pair that carries most; nothing where its flanks touch all along the face."""
    gaps = {name: _gap(flanks, int(k)) for name, k in chosen.items()}
    if not any(np.nanmax(gap, initial=0.0) > _VISIBLE_GAP for gap in gaps.values()):
        return ()
    x = 1e3 * flanks.face_position
    lines = tuple(
        Line(name, x, gap, color, label=name) for (name, gap), color in zip(gaps.items(), colors, strict=True)
    )
    return (Panel(face, Axis("gap, µm"), lines),)


def _line_load_caption(flanks: LoadDistribution, *, with_gap: bool) -> str:
    """Say what the panels of the load over the face show of this pair."""
    caption = "Force of all pairs per unit of face width."
    if with_gap:
        caption = (
            f"Above: {caption[0].lower()}{caption[1:]} Below: remaining gap between the loaded flanks of the "
            "pair with the largest load; 0 in contact."
        )
    else:
        caption += " The flanks of the pair with the largest load touch wherever they can: no gap."
    if flanks.base_helix_angle == 0.0:
        return caption
    return f"{caption} A single position is uneven: the number of pairs that touch changes along the face."


def load_centroid_figure(flanks: LoadDistribution) -> Figure:
    """Draw where along the face the load acts, and how unevenly it lies, over position."""
    factor = flanks.mean_face_load_factor
    rounding = _ROUNDING * float(np.ptp(flanks.face_position))
    centroid = 1e3 * np.where(np.abs(flanks.load_centroid) > rounding, flanks.load_centroid, 0.0)
    return Figure(
        key="load_centroid",
        title="Load centroid and face load factor",
        caption="Above: distance of the load's centroid from the pinion's mid-face. Below: largest over mean "
        "load per unit of face width at each position; the line is that of the load averaged over all of "
        "them, K_Hbeta of ISO 6336-1 for this alignment and without manufacturing errors.",
        alternative=f"The centroid lies {number(float(centroid.min()), 3)} to "
        f"{number(float(centroid.max()), 3)} mm from mid-face; K_Hbeta is {number(factor, 3)}.",
        content=(
            _over_position(
                flanks, Axis("load centroid, mm"), centroid, Reference("mid-face", 0.0, "horizontal")
            ),
            _over_position(
                flanks,
                Axis("largest over mean load"),
                flanks.face_load_factor,
                Reference(f"K_Hbeta {number(factor, 3)}", factor, "horizontal"),
            ),
        ),
    )


def _over_position(flanks: LoadDistribution, y: Axis, values: FloatArray, mark: Reference) -> Panel:
    """Draw a curve over one cycle, closed where the positions make one."""
    step = np.diff(flanks.position)
    whole = step.size > 0 and np.allclose(step, 1.0 / flanks.position.size)
    position = np.append(flanks.position, 1.0 + flanks.position[0]) if whole else flanks.position
    line = Line("", position, np.append(values, values[0]) if whole else values, palette.BLUE)
    x = Axis(POSITION_LABEL, limits=(float(position[0]), float(position[-1]))) if step.size else None
    return Panel(x or Axis(POSITION_LABEL), y, (line,), (mark,))


def _gap(flanks: LoadDistribution, position: int) -> FloatArray:
    """Gap in um of the pair that carries most; NaN where the flanks cannot meet."""
    pair = int(flanks.force[position].sum(axis=-1).argmax())
    gap = 1e6 * flanks.gap[position, pair]
    return np.where(np.isfinite(gap) & flanks.on_path[position, pair], gap, np.nan)


def _face_table(flanks: LoadDistribution, mean: FloatArray) -> Table:
    """Tabulate the averaged load and the largest line load over the face."""
    largest = 1e-3 * flanks.line_load.max(axis=(0, 1))
    rows = tuple(
        (number(1e3 * float(x), 4), number(float(m)), number(float(v)))
        for x, m, v in zip(flanks.face_position, mean, largest, strict=True)
    )
    head = ("face position, mm", "mean load per face width, N/mm", "largest line load, N/mm")
    return Table("Load over the face", head, rows)
