"""Contact pattern: the largest pressure of the mesh cycle over the unrolled flanks of both gears."""

from __future__ import annotations

from typing import Literal

import numpy as np

from fe_contact.analysis import ContactPattern, LoadDistribution, contact_pattern
from service.drawing import palette
from service.drawing.figure import Axis, Figure, HeatMap, Line, Panel, Reference, Table, number

Gear = Literal["pinion", "wheel"]
GEARS: tuple[Gear, ...] = ("pinion", "wheel")
NAMES = {"pinion": "pinion (drives)", "wheel": "wheel"}
PRESSURE = "Hertz pressure, MPa"


def contact_pattern_figure(flanks: LoadDistribution) -> Figure:
    """Draw one panel per gear: cells over face and roll length, or a curve where there is one slice."""
    patterns = {gear: contact_pattern(flanks, gear) for gear in GEARS}
    largest = 1e-6 * max(float(pattern.pressure.max()) for pattern in patterns.values())
    drawn = _map if flanks.face_position.size > 1 else _curve
    return Figure(
        key="contact_pattern",
        title="Contact pattern",
        caption="The largest Hertz pressure that each place of the unrolled flank meets over the positions "
        "computed, root below and tip above (a ring gear's the other way). White: nothing touches. At a tip "
        "edge the true pressure is singular, and this a measure only. Roll length: distance to the base "
        "circle along the involute's normal.",
        alternative=_words(flanks, patterns["pinion"]),
        content=tuple(drawn(flanks, gear, patterns[gear], largest) for gear in GEARS),
        table=_table(flanks, patterns),
    )


def roll_marks(
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


def _map(flanks: LoadDistribution, gear: Gear, pattern: ContactPattern, largest: float) -> Panel:
    """One unrolled flank."""
    pressure = np.where(pattern.pressure > 0.0, 1e-6 * pattern.pressure, np.nan)
    low, high = (1e3 * end for end in flanks.scene.common_face)
    return Panel(
        Axis("face position, mm (0 = mid-face of the pinion)", limits=(low, high)),
        Axis("roll length, mm", limits=_extent(flanks, gear, pattern)),
        references=roll_marks(flanks, gear, "horizontal"),
        title=NAMES[gear],
        shade=HeatMap(1e3 * pattern.face_position, 1e3 * pattern.roll_length, pressure, PRESSURE, largest),
    )


def _curve(flanks: LoadDistribution, gear: Gear, pattern: ContactPattern, largest: float) -> Panel:
    """Draw the pressure along the profile: in the plane it is the same over the face."""
    line = Line("largest pressure", 1e3 * pattern.roll_length, 1e-6 * pattern.pressure[:, 0], palette.BLUE)
    return Panel(
        Axis("roll length, mm", limits=_extent(flanks, gear, pattern)),
        Axis(PRESSURE, limits=(0.0, 1.15 * largest)),
        (line,),
        roll_marks(flanks, gear, "vertical"),
        NAMES[gear],
    )


def _extent(flanks: LoadDistribution, gear: Gear, pattern: ContactPattern) -> tuple[float, float]:
    """Return the range in mm from what is touched, or the start of the active profile, to the tip."""
    scene, index = flanks.scene, GEARS.index(gear)
    marks = (scene.start_of_active_profile[index], scene.tip[index])  # the tip of a ring is the lower one
    low = min(*marks, float(pattern.roll_length[0]))
    high = max(*marks, float(pattern.roll_length[-1]))
    room = 1e3 * 0.06 * (high - low)
    return 1e3 * low - room, 1e3 * high + room * (1.5 if flanks.face_position.size > 1 else 3.0)


def _words(flanks: LoadDistribution, pattern: ContactPattern) -> str:
    """Say where the pressure is largest."""
    row, column = np.unravel_index(int(pattern.pressure.argmax()), pattern.pressure.shape)
    where = f"at roll length {number(1e3 * float(pattern.roll_length[row]), 3)} mm of the pinion"
    if flanks.face_position.size > 1:
        where += f", {number(1e3 * float(pattern.face_position[column]), 3)} mm from its mid-face"
    return f"The largest pressure, {number(1e-6 * float(pattern.pressure.max()), 4)} MPa, is {where}."


def _table(flanks: LoadDistribution, patterns: dict[Gear, ContactPattern]) -> Table:
    """Largest pressure of each slice, or of each part of the profile, of both gears."""
    if flanks.face_position.size > 1:
        columns = [1e-6 * patterns[gear].pressure.max(axis=0) for gear in GEARS]
        rows = zip(1e3 * flanks.face_position, *columns, strict=True)
        head = ("face position, mm", *(f"{gear}, MPa" for gear in GEARS))
        return Table("Largest pressure over the face", head, tuple(tuple(map(number, row)) for row in rows))
    pattern = patterns["pinion"]
    rows = zip(1e3 * pattern.roll_length, 1e-6 * pattern.pressure[:, 0], strict=True)
    head = ("roll length of the pinion, mm", "pressure, MPa")
    return Table("Largest pressure along the profile", head, tuple(tuple(map(number, row)) for row in rows))
