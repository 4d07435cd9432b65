"""A pair as a drawing: transverse section of the mesh, and what is removed from the flanks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bounds import Direction
from fe_contact.geometry import ParallelAxes, Toothing
from lineofaction.gearbox.convert.outline import pair_outline
from lineofaction.gearbox.units import DEGREE, MM, UM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Dash,
    Figure,
    FloatArray,
    Line,
    Note,
    Panel,
    Reference,
    number,
)

Json = dict[str, Any]

_POINTS = 201
_AXES = (Direction.PROFILE, Direction.FACE)
_SIDES = {"pinion": palette.BLUE, "wheel": palette.VERMILLION}
_HEIGHT = 3.4
"""Modules drawn above and below the pitch point."""
_WIDTH = 3.4
"""Width of the drawing over its height, nearly that of a panel."""


def pair_drawing(pair: ParallelAxes) -> Figure:
    """Return the section of the mesh; where flanks are modified, also their profiles and leads."""
    gears = {"pinion": pair.pinion, "wheel": pair.wheel}
    profiles = [
        _profile(name, pair) for name, gear in gears.items() if gear.modification.varies_along_profile
    ]
    leads = {name: gear for name, gear in gears.items() if gear.modification.varies_along_face}
    panels = (_section(pair), *profiles, *([_lead(leads)] if leads else ()))
    return Figure(
        key="pair_drawing",
        title="The pair in mesh" if len(panels) == 1 else "The pair in mesh and its flank modifications",
        caption=_caption(pair, modified=len(panels) > 1),
        alternative=" ".join(_finding(name, gear) for name, gear in gears.items()),
        content=panels,
    )


def _section(pair: ParallelAxes) -> Panel:
    """Draw both gears about the pitch point, the path of contact and the pitch circles."""
    outline = pair_outline(pair)
    lines = [_gear_line(name, outline[name]) for name in _SIDES]
    for name, radius in zip(_SIDES, pair.operating_pitch_radii, strict=True):
        center = outline[name]["centre_mm"]
        angle = np.linspace(0.0, 2.0 * math.pi, 721)
        x, y = center[0] + radius / MM * np.cos(angle), center[1] + radius / MM * np.sin(angle)
        lines.append(Line("working pitch circles", x, y, palette.MUTED, "dash", 1.0))
    points = outline["path_of_contact"]["points_mm"]
    path = np.array(sorted(points.values()))
    lines.append(Line("path of contact", path[:, 0], path[:, 1], palette.GREEN, width=2.4, markers=True))
    notes = tuple(Note(x, y, name, -(name == "D"), left=name in "AB") for name, (x, y) in points.items())
    pitch_point = pair.operating_pitch_radii[0] / MM
    half = _HEIGHT * pair.pinion.normal_module / MM
    x = Axis("mm", limits=(-_WIDTH * half, _WIDTH * half))
    y = Axis("mm", limits=(pitch_point - half, pitch_point + half))
    return Panel(x, y, tuple(lines), title="Transverse section", notes=notes, equal=True)


def _gear_line(name: str, gear: Json) -> Line:
    """Draw the outline of a whole gear."""
    tooth = np.array(gear["tooth_mm"])
    pitch = -2.0 * math.pi / gear["teeth"]  # teeth follow each other from left to right
    angles = math.radians(gear["angle_deg"]) + pitch * np.arange(gear["teeth"])
    x = np.cos(angles)[:, None] * tooth[:, 0] - np.sin(angles)[:, None] * tooth[:, 1]
    y = np.sin(angles)[:, None] * tooth[:, 0] + np.cos(angles)[:, None] * tooth[:, 1]
    closed = [np.append(part.ravel(), part.ravel()[0]) for part in (x, y)]
    center = gear["centre_mm"]
    return Line(name, closed[0] + center[0], closed[1] + center[1], _SIDES[name], width=1.4)


def _profile(name: str, pair: ParallelAxes) -> Panel:
    """Draw the K-chart of a gear: what is removed over its roll angle; at three places of a twisted flank."""
    gear: Toothing = getattr(pair, name)
    roll, half = _usable(gear), 0.5 * gear.face_width
    faces: tuple[tuple[str, float, Dash], ...] = (
        ("mid-face", 0.0, "solid"),
        ("datum face", -half, "dash"),
        ("non-datum face", half, "dot"),
    )
    twisted = any(part.varies and part.along not in _AXES for part in gear.modification.parts)
    angle = roll / gear.base_radius / DEGREE
    lines = tuple(
        Line(f"{name}, {place}" if twisted else name, angle, _removed(gear, roll, face), _SIDES[name], dash)
        for place, face, dash in faces[: 3 if twisted else 1]
    )
    pitch_point = pair.path_of_contact.pitch_point
    at_pitch = pitch_point if name == "pinion" else float(pair.mating_roll_length(pitch_point))
    mark = Reference("C", at_pitch / gear.base_radius / DEGREE)
    title = f"Profile of the {name}, root to the {'left' if gear.sign > 0 else 'right'}"
    return Panel(Axis("roll angle, deg"), Axis("removed, µm"), lines, (mark,), title=title)


def _usable(gear: Toothing) -> FloatArray:
    """Roll lengths in m over the usable flank."""
    ends = sorted((gear.form_roll_length, gear.tip_form_roll_length))
    return np.linspace(ends[0], ends[1], _POINTS)


def _lead(gears: dict[str, Toothing]) -> Panel:
    """Draw what is removed along the face at the middle of the usable flanks."""
    lines = []
    for name, gear in gears.items():
        face = np.linspace(-0.5, 0.5, _POINTS) * gear.face_width
        removed = _removed(gear, np.full(_POINTS, _usable(gear).mean()), face)
        lines.append(Line(name, face / MM, removed, _SIDES[name]))
    x = Axis("face position, mm (0 = mid-face; left: datum face)")
    return Panel(x, Axis("removed, µm"), tuple(lines), title="Lead at the middle of the profile")


def _removed(gear: Toothing, roll: FloatArray, face: FloatArray | float) -> FloatArray:
    return gear.modification.material_removed(gear, roll, face) / UM


def _caption(pair: ParallelAxes, *, modified: bool) -> str:
    """Say what the panels show of this pair."""
    section = (
        f"Section at the pinion's mid-face; the pinion drives clockwise. The wheel's center is "
        f"{'below' if pair.internal else 'above'}. A to E: the path of contact of the usable flanks."
    )
    return f"{section} Material removed along the line of action; 0 is the involute." if modified else section


def _finding(name: str, gear: Toothing) -> str:
    """Say the largest modification of a gear."""
    if gear.modification.neutral:
        return f"The {name} is not modified."
    roll, face = np.meshgrid(_usable(gear), np.linspace(-0.5, 0.5, _POINTS) * gear.face_width)
    return f"At most {number(float(_removed(gear, roll, face).max()), 3)} µm are removed from the {name}."
