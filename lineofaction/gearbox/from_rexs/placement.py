"""Where components stand: points and axes u, v, w, composed over the components they refer to."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.problems import BadInput

PARALLEL = 1e-6
"""Sine of the angle up to which two directions are the same."""
_MOST_REFERENCES = 100
_REFERENCE = "reference_component_for_position"


@dataclass(frozen=True)
class Placement:
    """A place in the model's own frame.

    Attributes
    ----------
    origin : (3,) array
        m.
    axes : (3, 3) array
        Unit vectors u, v, w by rows, a right-handed system.
    """

    origin: FloatArray
    axes: FloatArray

    @property
    def u(self) -> FloatArray:
        """Direction of the axis of rotation."""
        return np.asarray(self.axes[0])

    def along(self, point: FloatArray) -> float:
        """Return u of a point, m."""
        return float(self.u @ (point - self.origin))

    def within(self, outer: Placement) -> Placement:
        """Return the place of what is stated in the frame of `outer`."""
        return Placement(outer.origin + self.origin @ outer.axes, self.axes @ outer.axes)


FIXED = Placement(np.zeros(3), np.eye(3))


def placement(unit: GearUnit, part: Part) -> Placement | None:
    """Return where a component stands, None where the file does not say.

    Raises
    ------
    BadInput
        A vector has not three numbers, an axis has no direction, or places refer to each other in a ring.
    """
    return _stated(unit, part, ())


def frame_of(unit: GearUnit, part: Part, inner: tuple[int, ...] = ()) -> Placement:
    """Return where a component stands: as the file says, else by what carries it.

    On a shaft it stands at its u coordinate, along the shaft's axes; without one it has the origin of the
    component that its place refers to.

    Parameters
    ----------
    unit : GearUnit
    part : Part
    inner : tuple of int
        The components whose places refer to this one, the innermost first.

    Raises
    ------
    BadInput
        As of `placement`.
    """
    if part.id in inner or len(inner) > _MOST_REFERENCES:
        bound = "a component that is not placed by this one itself"
        raise BadInput.of(f"{part.place}, {_REFERENCE}", inner[-1], bound, "Refer to the gear unit.")
    stated, shaft = _stated(unit, part, inner), unit.owner(part, "shaft")
    if stated is not None:
        return stated
    if shaft is None or shaft.id == part.id:
        return _in_reference(unit, part, np.zeros(3), inner)
    base = frame_of(unit, shaft, (*inner, part.id))
    along = part.number("u_coordinate_on_shaft", "place along the shaft") or 0.0
    return Placement(base.origin + along * base.u, base.axes)


def u_on_shaft(unit: GearUnit, part: Part) -> float | None:
    """Return u of a component on its shaft, m: by the places of both, else by its coordinate.

    One writer gives the begin of a gear as its coordinate: its place, that of its middle, counts.
    """
    shaft, place = unit.owner(part, "shaft"), placement(unit, part)
    base = None if shaft is None else placement(unit, shaft)
    stated = part.number("u_coordinate_on_shaft", "place along the shaft")
    return stated if place is None or base is None else base.along(place.origin)


def _stated(unit: GearUnit, part: Part, inner: tuple[int, ...]) -> Placement | None:
    """Return a place as stated, None for none."""
    origin = _vector(part, "support_vector", "place")
    return None if origin is None else _in_reference(unit, part, origin, inner)


def _in_reference(unit: GearUnit, part: Part, origin: FloatArray, inner: tuple[int, ...]) -> Placement:
    u = _unit(part, "u_axis_vector", np.array([1.0, 0.0, 0.0]))
    w = _across(part, u)
    own, outer = Placement(origin, np.array([u, np.cross(w, u), w])), _reference(unit, part)
    return own if outer is None else own.within(frame_of(unit, outer, (*inner, part.id)))


def _reference(unit: GearUnit, part: Part) -> Part | None:
    """Return the component that a place refers to, None for one that is placed by itself: the root."""
    attribute = part.attribute(_REFERENCE)
    if attribute is None or attribute.kind != "reference_component" or not isinstance(attribute.value, int):
        return None
    part.say(_REFERENCE, "taken", f"its place refers to component {attribute.value}")
    return None if attribute.value == part.id else unit.part(attribute.value)


def _across(part: Part, u: FloatArray) -> FloatArray:
    """Return w, across u: the part of the stated axis that is; any if none is stated."""
    axis = _unit(part, "w_axis_vector", np.eye(3)[2 if abs(u[2]) < 0.9 else 1])
    across = axis - (axis @ u) * u
    length = float(np.linalg.norm(across))
    if length < PARALLEL:
        raise BadInput.of(f"{part.place}, w_axis_vector", list(map(float, axis)), "not along u_axis_vector")
    return np.asarray(across / length)


def _unit(part: Part, item: str, usual: FloatArray) -> FloatArray:
    """Return a stated direction of length 1."""
    vector = _vector(part, item, "axis")
    if vector is None:
        attribute = part.attribute(item)
        if attribute is None or attribute.value is None:
            part.say(item, "defaulted", f"{usual.tolist()}")
        return usual
    length = math.hypot(*vector)
    if length == 0.0:
        raise BadInput.of(f"{part.place}, {item}", vector.tolist(), "a vector that has a direction")
    return np.asarray(vector / length)


def _vector(part: Part, item: str, words: str) -> FloatArray | None:
    """Return three finite numbers, None where the file gives none."""
    numbers = part.vector(item, words)
    if numbers is None:
        return None
    if len(numbers) != 3 or not np.all(np.isfinite(numbers)):
        raise BadInput.of(f"{part.place}, {item}", list(numbers), "three finite numbers")
    return np.array(numbers, dtype=float)
