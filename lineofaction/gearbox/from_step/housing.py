"""The fields of a housing of a scene from the STEP file of its solid, and its detected bores."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bounds import engineering
from dynamics.housings import FlatFace, StepSolid, usual_edge
from dynamics.solid_housing import MATERIALS
from dynamics.types import FloatArray
from lineofaction.gearbox.convert.placement import Placement
from lineofaction.gearbox.from_step.candidates import Bearings
from lineofaction.gearbox.from_step.placement import Seated, best_seating, seated
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.bearings import BushingInput, RollingBearingInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.units import MM, as_typed

DIRECTIONS = {
    f"{sign}{name}": (1.0 if sign == "+" else -1.0) * axis
    for name, axis in zip("xyz", np.eye(3), strict=True)
    for sign in "+-"
}
"""Outward normals of a foot, as they are typed."""
_REACH = 1.5
"""Largest extent of an element of a bore's wall along its axis, over the edge that the mesher keeps to."""
_FINEST = 0.5
"""Least edge of elements for the sake of a seat over the usual one: half: eight times as many."""
_FACING = 5e-3
"""Sine of the angle between normals that are the same."""
_EVEN = 1e-5
"""Distance of a bearing from the middle of its bore that is none, m."""
_LEVEL = 1e-5
"""Height within which faces are in one plane, m."""


@dataclass(frozen=True)
class Stand:
    """The faces that a housing stands on: all in the outermost plane of a direction; m, m^2."""

    point: FloatArray
    normal: FloatArray
    faces: int
    area: float


@dataclass(frozen=True)
class StepHousing:
    """A housing as a table of a scene, with the bores that its bearings sit in."""

    fields: Mapping[str, Any]
    """Fields of the table `[[housings]]` except name and file."""
    seated: Seated
    """Bores by bearing."""
    omitted: tuple[str, ...]
    replaced: tuple[str, ...]
    """`omitted`, `replaced`: Bearings in no bore; housings of the scene whose bearings are in this one,
    which it replaces.
    """
    stand: Stand
    mass: float
    wall: float
    """`mass`, `wall`: kg; mean thickness of the walls 2 V/S, m."""


def step_housing(
    scene: SceneInput, solid: StepSolid, material: str, stands_on: str, placement: Placement | None = None
) -> StepHousing:
    """Return the housing that a solid is in a scene: its bearings are in bores, it stands on outermost faces.

    Raises `BadInput`: the scene has no bearings, no placement fits, no bearing is in a bore, a bearing is so
    near to an end of its bore that no mesh resolves its seat, or no face looks where it should stand.

    Parameters
    ----------
    material : str
        One of `MATERIALS`.
    stands_on : str
        One of `DIRECTIONS`: outward normal of the foot in the scene.
    placement : Placement, optional
        Default: `best_seating` by the bores.
    """
    bearings = _bearings(scene)
    if placement is None:
        seating = best_seating(solid.bores, bearings)
    else:
        seating = seated(solid.bores, bearings, placement)
    if not seating.bores:
        remedy = "Leave --origin-mm, --x-axis and --z-axis out: the bores say where it stands."
        raise BadInput.of("--origin-mm", seating.placement.fields, "such that a bearing is in a bore", remedy)
    wall = 2.0 * solid.volume / solid.surface
    element_size = _element_size(seating, wall)
    stand = _stand(solid, seating.placement, stands_on)
    point = [as_typed(float(np.round(value, 8)) + 0.0, MM) for value in stand.point]
    fields = {
        "material": material,
        **({} if element_size is None else {"element_size_mm": as_typed(element_size, MM)}),
        **seating.placement.fields,
        "feet": [{"name": "base", "point_mm": point, "normal": (stand.normal + 0.0).tolist()}],
        "seats": [_seat(name, seating) for name in seating.bores],
    }
    omitted = tuple(name for name in bearings if name not in seating.bores)
    modeled = (part for part in scene.housings if not part.is_measured)
    replaced = tuple(part.name for part in modeled if seating.bores.keys() & {*part.bushings})
    mass = MATERIALS[material].density * solid.volume
    return StepHousing(fields, seating, omitted, replaced, stand, mass, wall)


def _bearings(scene: SceneInput) -> Bearings:
    origin = {shaft.name: np.array(shaft.origin_mm) for shaft in scene.shafts}
    parts: tuple[BushingInput | RollingBearingInput, ...] = (*scene.bushings, *scene.rolling_bearings)
    if not parts:
        bound = "given, or rolling_bearings: bores are known by the bearings in them"
        raise BadInput.of("bushings", [], bound)
    return {part.name: MM * (origin[part.shaft] + np.array([0.0, 0.0, part.position_mm])) for part in parts}


def _seat(name: str, seating: Seated) -> dict[str, Any]:
    """Return the seat of a bearing: as much of its bore as lies evenly about it."""
    return {
        "bearing": name,
        "bore_diameter_mm": as_typed(round(seating.bores[name].diameter, 9), MM),
        "bore_length_mm": as_typed(round(even_length(seating, name), 9), MM),
    }


def even_length(seating: Seated, name: str) -> float:
    """Return the length of a bore that lies evenly about its bearing, m."""
    bore = seating.bores[name]
    return float(bore.length - 2.0 * abs(bore.position[2] - seating.bearings[name][2]))


def _element_size(seating: Seated, wall: float) -> float | None:
    """Return the edge of elements that the seats need, to 10 µm; None: the usual mesh of such walls will do.

    A seat has to be as long as the elements of its bore are along the axis. Raises `BadInput` for a seat that
    needs much smaller ones.
    """
    sizes = []
    for name, bore in seating.bores.items():
        length = even_length(seating, name)
        usual = usual_edge(wall, bore.diameter)
        if length >= min(_REACH * usual, bore.length - 2.0 * _EVEN):
            continue
        if length < _FINEST * _REACH * usual:
            part, least, whole = (
                f"{engineering(value / MM, 3)} mm"
                for value in (length, _FINEST * _REACH * usual, bore.length)
            )
            bound = f"evenly in at least {least} of its bore, which is {whole} long"
            remedy = "Move it towards the middle of the bore, or write seats and element_size_mm by hand."
            raise BadInput.of(f'bearing "{name}"', part, bound, remedy)
        sizes.append(np.floor(1e5 * length / _REACH) / 1e5)
    return min(sizes, default=None)


def _stand(solid: StepSolid, placement: Placement, stands_on: str) -> Stand:
    """Return the outermost flat faces of a direction."""
    normal = DIRECTIONS[stands_on]
    facing = [face for face in solid.planes if _faces(face, placement, normal)]
    if not facing:
        sides = []
        for name, axis in DIRECTIONS.items():
            if any(_faces(face, placement, axis) for face in solid.planes):
                sides.append(name)
        bound = f"a side of the solid with a flat face: {', '.join(sides) or 'it has none'}"
        raise BadInput.of("--stands-on", stands_on, bound, "Or write its feet into the scene yourself.")
    heights = [float(placement.points(face.plane.point) @ normal) for face in facing]
    outermost = [face for face, height in zip(facing, heights, strict=True) if height > max(heights) - _LEVEL]
    point = placement.points(outermost[0].plane.point)
    return Stand(point, normal, len(outermost), sum(face.area for face in outermost))


def _faces(face: FlatFace, placement: Placement, normal: FloatArray) -> bool:
    direction = placement.axes @ np.array(face.plane.normal)
    return bool(direction @ normal > 0.0 and np.linalg.norm(np.cross(direction, normal)) < _FACING)
