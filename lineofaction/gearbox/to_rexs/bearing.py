"""Results of a bearing: forces on both sides, displacement of each, and deflection between them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from bounds.types import FloatArray
from dynamics.deflection import BearingLoad
from lineofaction.gearbox.from_rexs.scene_parts import BearingPart
from lineofaction.gearbox.rexs.model import Attribute
from lineofaction.gearbox.to_rexs.attributes import calculated
from lineofaction.gearbox.units import UM

_AXES = "uvw"

_DEFLECTIONS = ("axial_deflection", "radial_deflection_in_v", "radial_deflection_in_w")


def _along(name: str, vector: Iterable[float], unit: str, axes: str = _AXES) -> Iterator[Attribute]:
    """Yield the components of a vector along some axes, each by a name that ends in the axis."""
    for axis, value in zip(_AXES, vector, strict=True):
        if axis in axes:
            yield calculated(f"{name}_{axis}", value, unit)


def bearing_results(part: BearingPart, load: BearingLoad) -> tuple[Attribute, ...]:
    """Return the attributes of a bearing under a load case, along its own u, v, w, mean over the mesh cycle.

    The force on a side is what the bearing exerts on the component of that side: what it carries acts on the
    housing, its reaction on the shaft. The deflection is the displacement of the inner less that of the
    outer side, clearance included. The load is in x, y, z of the scene.
    """
    on_housing, moment = _turned(part, load.force)
    deflection, tilt = _turned(part, load.elastic + load.clearance)
    seat, seat_tilt = _turned(part, load.seat)
    shaft, shaft_tilt = deflection + seat, tilt + seat_tilt
    shaft_side, housing_side = ("inner", "outer") if part.shaft_inside else ("outer", "inner")
    inward = 1.0 if part.shaft_inside else -1.0
    deflections = zip(_DEFLECTIONS, deflection, strict=True)
    return (
        *_loads(shaft_side, -on_housing, -moment),
        *_loads(housing_side, on_housing, moment),
        *(calculated(name, inward * value / UM, "mum") for name, value in deflections),
        *_along("angular_deflection_in", inward * tilt, "rad", "vw"),
        *_displacements(shaft_side, shaft, shaft_tilt),
        *_displacements(housing_side, seat, seat_tilt),
    )


def _turned(part: BearingPart, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    return part.rotation.T @ values[:3], part.rotation.T @ np.array([*values[3:5], 0.0])


def _loads(side: str, force: FloatArray, moment: FloatArray) -> Iterator[Attribute]:
    """Yield force and moment on the component of a side; none about u, about which the bearing turns."""
    yield from _along(f"force_acting_on_{side}_component", force, "N")
    yield from _along(f"torque_acting_on_{side}_component", moment, "N m", "vw")


def _displacements(side: str, displacement: FloatArray, tilt: FloatArray) -> Iterator[Attribute]:
    """Yield the displacements of a side from where it stands without load."""
    yield from _along(f"displacement_{side}_side", displacement / UM, "mum")
    yield from _along(f"tilting_{side}_side", map(math.degrees, tilt), "deg", "vw")
