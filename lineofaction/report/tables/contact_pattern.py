"""Contact pattern: the pressure that passes over the unrolled flanks of both gears in a mesh cycle."""

from __future__ import annotations

from typing import Literal

import numpy as np

from fe_contact.analysis import LoadDistribution, pressure_map
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    HeatMap,
    Line,
    Panel,
    Reference,
    Table,
    number,
)
from lineofaction.report.tables.unrolled import face_axis

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
        table=_table(flanks, maps),
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
        face_axis(flanks),
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


def _table(flanks: LoadDistribution, maps: list[_Map]) -> Table:
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
