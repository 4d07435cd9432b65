"""Results of a bearing: forces on both sides, and how they move, each and against each other."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from bounds.types import FloatArray
from dynamics.deflection import BearingLoad
from lineofaction.gearbox.from_rexs.scene_parts import BearingPart
from lineofaction.gearbox.rexs import Attribute
from lineofaction.gearbox.to_rexs.calculated import calculated
from lineofaction.gearbox.units import UM

AXES = "uvw"
DEFLECTIONS = ("axial_deflection", "radial_deflection_in_v", "radial_deflection_in_w")


def bearing_results(part: BearingPart, load: BearingLoad) -> tuple[Attribute, ...]:
    """Return the attributes of a bearing under a load case, along its own u, v, w, mean over the mesh cycle.

    The force on a side is what the bearing exerts on the component of that side: what it carries acts on the
    housing, its reaction on the shaft. The deflection is the displacement of the inner less that of the
    outer side, clearance included.

    Parameters
    ----------
    part : BearingPart
    load : BearingLoad
        In x, y, z of the scene.
    """
    on_housing, moment = _turned(part, load.force)
    across, tilt = _turned(part, load.elastic + load.clearance)
    seat, seat_tilt = _turned(part, load.seat)
    shaft, shaft_tilt = across + seat, tilt + seat_tilt
    shaft_side, housing_side = ("inner", "outer") if part.shaft_inside else ("outer", "inner")
    inward = 1.0 if part.shaft_inside else -1.0
    return (
        *_loads(shaft_side, -on_housing, -moment),
        *_loads(housing_side, on_housing, moment),
        *(
            calculated(name, inward * value / UM, "mum")
            for name, value in zip(DEFLECTIONS, across, strict=True)
        ),
        *(
            calculated(f"angular_deflection_in_{axis}", inward * tilt[AXES.index(axis)], "rad")
            for axis in "vw"
        ),
        *_displacements(shaft_side, shaft, shaft_tilt),
        *_displacements(housing_side, seat, seat_tilt),
    )


def _turned(part: BearingPart, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the vectors along u, v, w of x, y, z and of tilt_x, tilt_y."""
    return part.turn.T @ values[:3], part.turn.T @ np.array([*values[3:5], 0.0])


def _loads(side: str, force: FloatArray, moment: FloatArray) -> Iterator[Attribute]:
    """Yield force and moment on the component of a side; none about u, about which the bearing turns."""
    for axis, value in zip(AXES, force, strict=True):
        yield calculated(f"force_acting_on_{side}_component_{axis}", value, "N")
    for axis, value in zip("vw", moment[1:], strict=True):
        yield calculated(f"torque_acting_on_{side}_component_{axis}", value, "N m")


def _displacements(side: str, displacement: FloatArray, tilt: FloatArray) -> Iterator[Attribute]:
    """Yield the displacements of a side from where it stands without load."""
    for axis, value in zip(AXES, displacement, strict=True):
        yield calculated(f"displacement_{side}_side_{axis}", value / UM, "mum")
    for axis, value in zip("vw", tilt[1:], strict=True):
        yield calculated(f"tilting_{side}_side_{axis}", math.degrees(value), "deg")
