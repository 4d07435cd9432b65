"""Placement of components: points and axes u, v, w, composed over the components they refer to."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import Part

PARALLEL = 1e-6
"""Sine of the angle up to which two directions are the same."""
_MAX_REFERENCES = 100
_REFERENCE = "reference_component_for_position"


@dataclass(frozen=True)
class Placement:
    """A point with axes u, v, w in the frame of the model."""

    origin: FloatArray
    """Origin in the frame of the model, m. Shape (3,)."""
    axes: FloatArray
    """Unit vectors u, v, w by rows, a right-handed system. Shape (3, 3)."""

    @property
    def u(self) -> FloatArray:
        """Direction of the axis of rotation."""
        return np.asarray(self.axes[0])

    def along(self, point: FloatArray) -> float:
        """Return u of a point, m."""
        return float(self.u @ (point - self.origin))

    def within(self, outer: Placement) -> Placement:
        """Return the placement in the model of a placement in the frame of `outer`."""
        return Placement(outer.origin + self.origin @ outer.axes, self.axes @ outer.axes)

    @staticmethod
    def of(part: Part, inner: tuple[int, ...] = ()) -> Placement | None:
        """Return the placement of a component, None: the file states none; `inner` as of `frame_of`."""
        origin = _vector(part, "support_vector", "place")
        return None if origin is None else _in_reference(part, origin, inner)


FIXED = Placement(np.zeros(3), np.eye(3))


def frame_of(part: Part, inner: tuple[int, ...] = ()) -> Placement:
    """Return the placement of a component by the file, else by the component that carries it.

    On a shaft it stands at its u coordinate, along the shaft's axes; without one it has the origin of the
    component that its place refers to.
    `inner` are the components whose places refer to this one, the innermost first. Raises `BadInput` as
    `Placement.of`.
    """
    if part.id in inner or len(inner) > _MAX_REFERENCES:
        bound = "a component that is not placed by this one itself"
        raise part.refusal(_REFERENCE, inner[-1], bound, "Refer to the gear unit.")
    frame, shaft = Placement.of(part, inner), part.shaft
    if frame is not None:
        return frame
    if shaft is None or shaft.id == part.id:
        return _in_reference(part, np.zeros(3), inner)
    base = frame_of(shaft, (*inner, part.id))
    along = part.number("u_coordinate_on_shaft", "place along the shaft") or 0.0
    return Placement(base.origin + along * base.u, base.axes)


def u_on_shaft(part: Part) -> float | None:
    """Return u of a component on its shaft, m: by the places of both, else by its coordinate.

    One writer gives the begin of a gear as its coordinate: its place, that of its middle, counts.
    """
    shaft, placement = part.shaft, Placement.of(part)
    base = None if shaft is None else Placement.of(shaft)
    coordinate = part.number("u_coordinate_on_shaft", "place along the shaft")
    return coordinate if placement is None or base is None else base.along(placement.origin)


def _in_reference(part: Part, origin: FloatArray, inner: tuple[int, ...]) -> Placement:
    u = _unit(part, "u_axis_vector", np.array([1.0, 0.0, 0.0]))
    axis = _unit(part, "w_axis_vector", np.eye(3)[2 if abs(u[2]) < 0.9 else 1])
    across = axis - (axis @ u) * u
    length = float(np.linalg.norm(across))
    if length < PARALLEL:
        raise part.refusal("w_axis_vector", list(map(float, axis)), "not along u_axis_vector")
    w = np.asarray(across / length)
    frame, outer = Placement(origin, np.array([u, np.cross(w, u), w])), _reference(part)
    return frame if outer is None else frame.within(frame_of(outer, (*inner, part.id)))


def _reference(part: Part) -> Part | None:
    """Return the component that a place refers to, None for one that is placed by itself: the root."""
    attribute = part.attribute(_REFERENCE)
    if attribute is None or attribute.kind != "reference_component" or not isinstance(attribute.value, int):
        return None
    part.say(_REFERENCE, "taken", f"its place refers to component {attribute.value}")
    return None if attribute.value == part.id else part.unit.part(attribute.value)


def _unit(part: Part, item: str, usual: FloatArray) -> FloatArray:
    vector = _vector(part, item, "axis")
    if vector is None:
        if part.value(item) is None:
            part.say(item, "defaulted", f"{usual.tolist()}")
        return usual
    length = math.hypot(*vector)
    if length == 0.0:
        raise part.refusal(item, vector.tolist(), "a vector that has a direction")
    return np.asarray(vector / length)


def _vector(part: Part, item: str, meaning: str) -> FloatArray | None:
    numbers = part.vector(item, meaning)
    if numbers is None:
        return None
    if len(numbers) != 3 or not np.all(np.isfinite(numbers)):
        raise part.refusal(item, list(numbers), "three finite numbers")
    return np.array(numbers, dtype=float)
