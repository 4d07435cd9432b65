"""The transverse section of a pair as it is drawn: every tooth in it has its form."""

import math

import numpy as np
import pytest
from matplotlib.axes import Axes

from bounds.types import FloatArray, Json
from fe_contact import Gear, GearPair, InternalGearPair, RingGear
from fe_contact.geometry import ParallelAxes, Toothing, tooth_profile
from lineofaction.gearbox.convert.outline import pair_outline
from lineofaction.gearbox.units import MM
from lineofaction.report.drawing.image import panel_sheet
from lineofaction.report.pair import pair_drawing

POINTS = 400
"""Of a flank and its root."""


def gear(teeth: int, module: float, bore: float, helix: float = 0.0) -> Gear:
    return Gear(teeth, normal_module=module, face_width=25e-3, bore_diameter=bore, helix_angle=helix)


def helical() -> ParallelAxes:
    helix = math.radians(24.0)
    return GearPair(
        gear(29, 1.75e-3, 24e-3, helix), gear(62, 1.75e-3, 50e-3, -helix), center_distance=87.5e-3
    )


def internal() -> ParallelAxes:
    ring = RingGear(78, normal_module=2e-3, face_width=25e-3, rim_diameter=0.18, tip_diameter=152.8e-3)
    return InternalGearPair(gear(21, 2e-3, 16e-3), ring, center_distance=57e-3)


def teeth_in_view(ax: Axes, gear: Toothing, drawn: Json) -> list[FloatArray]:
    """Return points (n, 2) of each tooth of a gear that are in the picture, in pixels."""
    profile = tooth_profile(gear)
    right = profile.flank(np.linspace(profile.s_space, profile.s_tip, POINTS)) / MM
    tooth = np.concatenate([right, right * (-1.0, 1.0)])
    low, high = ax.viewLim.get_points()
    teeth = []
    for angle in math.radians(drawn["angle_deg"]) + 2.0 * math.pi / gear.teeth * np.arange(gear.teeth):
        turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        points = tooth @ turn + drawn["centre_mm"]
        seen = points[np.all((points > low) & (points < high), axis=1)]
        teeth += [ax.transData.transform(seen)] if seen.size else []
    return teeth


def off_the_line(points: FloatArray, line: FloatArray) -> float:
    """Return how far the farthest of points (n, 2) is from a line through others (m, 2)."""
    low, high = points.min(axis=0) - 50.0, points.max(axis=0) + 50.0
    near = np.all((line[:-1] > low) & (line[:-1] < high), axis=1)
    start, along = line[:-1][near], np.diff(line, axis=0)[near]
    way = points[:, None] - start
    part = np.sum(way * along, axis=2) / np.maximum(np.sum(along**2, axis=1), 1e-12)
    off = way - np.clip(part, 0.0, 1.0)[..., None] * along
    return float(np.linalg.norm(off, axis=2).min(axis=1).max())


@pytest.mark.law
@pytest.mark.parametrize("pair", [helical(), internal()], ids=["helical", "internal"])
def test_every_tooth_in_the_picture_has_its_form_within_half_a_line(pair):
    sheet, outline = panel_sheet(pair_drawing(pair).content[:1]), pair_outline(pair)
    sheet.draw_without_rendering()
    ax = sheet.axes[0]
    for name, line in zip(("pinion", "wheel"), ax.lines, strict=False):
        drawn = np.array(line.get_path().cleaned(line.get_transform(), simplify=True).vertices)[:-1]
        teeth = teeth_in_view(ax, getattr(pair, name), outline[name])
        assert len(teeth) >= 5
        half_a_line = 0.5 * line.get_linewidth() * sheet.dpi / 72.0
        assert max(off_the_line(tooth, drawn) for tooth in teeth) < half_a_line


def test_gears_are_tinted_within_their_outline_and_a_ring_gear_is_not():
    filled = [
        [line.filled for line in pair_drawing(pair).content[0].lines] for pair in (helical(), internal())
    ]
    assert filled == [[True, True, False, False, False], [True, False, False, False, False]]
