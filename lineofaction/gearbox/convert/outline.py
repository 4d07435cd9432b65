"""The two gears in mesh as a drawing: transverse outlines in mm, turned so that their flanks touch."""

from __future__ import annotations

import math

import numpy as np

from bounds.types import Json
from fe_contact.analysis.flanks.deformed_pair import mesh_angles
from fe_contact.geometry import ParallelAxes, Toothing, tooth_profile
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.live import _FLANK_POINTS, _ROOT_POINTS, _TIP_POINTS
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.units import DEGREE, MM


def outline_json(case: Case) -> Json:
    """Return the drawing of the pair of a case, see `pair_outline`, with its main figures.

    Raises `BadInput`: no such pair exists.
    """
    pair = gear_pair(case)
    with boundary_errors():
        return pair_outline(pair) | {"figures": _figures(pair)}


def pair_outline(pair: ParallelAxes) -> Json:
    """Return the outline of the pair at position 0; x to the right, y upwards, seen from +z; mm.

    Each gear has one tooth with half a space on either side, in its tooth frame (center at the origin, tooth
    on +y), the number of its teeth and the angle by which the whole is turned counter-clockwise. A ring
    gear's tooth is seen from the other side, so that it stands as in the mesh.
    """
    angles = mesh_angles(pair, 0.0)
    sign = pair.wheel.sign
    gears = {"pinion": _gear(pair.pinion), "wheel": _gear(pair.wheel)}
    centers = ((0.0, 0.0), (0.0, sign * pair.center_distance))
    # sense in which the gear turns as the position grows: 1 is counter-clockwise
    turns = (-1.0, -1.0 if pair.internal else 1.0)
    middles = (0.0, pair.axial_offset)
    # the transverse sections are turned along z: the pinion's by `twist` in deg/mm, and the wheel's by as
    # much as it rolls with the pinion's
    rises = (1.0, -sign * pair.pinion.teeth / pair.wheel.teeth)
    twist = math.tan(pair.base_helix_angle) / pair.pinion.base_radius * MM / DEGREE
    for gear, angle, center, turn in zip(gears.values(), angles, centers, turns, strict=True):
        gear |= {"angle_deg": angle / DEGREE, "centre_mm": [value / MM for value in center], "turn": turn}
    for gear, body, middle, rise in zip(
        gears.values(), (pair.pinion, pair.wheel), middles, rises, strict=True
    ):
        half = 0.5 * body.face_width
        gear |= {"face_mm": [(middle - half) / MM, (middle + half) / MM], "twist_deg_per_mm": rise * twist}
    return gears | {"internal": pair.internal, "path_of_contact": _path(pair)}


def _gear(gear: Toothing) -> Json:
    profile = tooth_profile(gear)
    root = np.linspace(profile.s_space, profile.s_form, _ROOT_POINTS, endpoint=False)
    flank = np.linspace(profile.s_form, profile.s_tip, _FLANK_POINTS)
    right = profile.flank(np.concatenate((root, flank)))
    tip = profile.tip_land(np.linspace(0.0, 1.0, _TIP_POINTS)[1:-1])  # its ends are the flanks' last points
    tooth = np.concatenate((right, tip, right[::-1] * (-1.0, 1.0)))
    circles = {"tip": gear.tip_radius, "root": gear.root_radius, "base": gear.base_radius}
    circles |= {"reference": gear.reference_radius, "held": gear.seat_radius, "form": gear.form_radius}
    return {
        "teeth": gear.teeth,
        # from left to right, seen from the mesh's side
        "tooth_mm": _points(tooth[::-1] if gear.sign > 0 else tooth * (-1.0, 1.0)),
        "radius_mm": {name: round(radius / MM, 9) for name, radius in circles.items()},
    }


def _path(pair: ParallelAxes) -> Json:
    """Return the line of action and A to E of the usable flanks on it, in the frame of the drawing."""
    alpha = pair.working_pressure_angle
    along = np.array([math.cos(alpha), math.sin(alpha)])
    foot = pair.pinion.base_radius * np.array([-math.sin(alpha), math.cos(alpha)])
    points = {
        name: _points((foot + roll * along)[None, :])[0]
        for name, roll in zip("ABCDE", pair.active_path.points, strict=True)
    }
    return {"points_mm": points, "base_pitch_mm": pair.base_pitch / MM}


def _figures(pair: ParallelAxes) -> Json:
    return {
        "speed_ratio": pair.speed_ratio,
        "working_pressure_angle_deg": pair.working_pressure_angle / DEGREE,
        "transverse_contact_ratio": pair.active_contact_ratio,
        "overlap_ratio": pair.overlap_ratio,
        "total_contact_ratio": pair.active_contact_ratio + pair.overlap_ratio,
        "base_pitch_mm": pair.base_pitch / MM,
        "common_face_width_mm": pair.face_width / MM,
        "circumferential_backlash_um": 1e6 * pair.circumferential_backlash,
    }


def _points(points: FloatArray) -> list[list[float]]:
    # four digits of a millimeter: 0.1 um, far below the width of a drawn line
    return [[round(float(x) / MM, 4), round(float(y) / MM, 4)] for x, y in points]
