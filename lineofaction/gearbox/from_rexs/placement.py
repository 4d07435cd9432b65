"""Placement of components: points and axes u, v, w in the frame of the model.

A file places a component in the frame of another one, its reference component, up to the component that is
placed in the frame of the model: the root, often the gear unit. u is the axis of rotation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from lineofaction.gearbox.from_rexs.gear_unit import Part

PARALLEL = 1e-6
"""Sine of the angle up to which two directions are the same."""
_MAX_REFERENCES = 100
"""Longest chain of reference components."""
_NEARLY_ALONG_Z = 0.9
"""z of the unit vector u from which on the default of w is y, as u is too close to z."""
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
        """Return the coordinate of a point along u, m."""
        return float(self.u @ (point - self.origin))

    def within(self, outer: Placement) -> Placement:
        """Return the placement in the model of a placement in the frame of `outer`."""
        return Placement(outer.origin + self.origin @ outer.axes, self.axes @ outer.axes)

    @staticmethod
    def of(part: Part, inner: tuple[int, ...] = ()) -> Placement | None:
        """Return the placement of a component, None: the file states none; `inner` is that of `frame_of`."""
        origin = _vector(part, "support_vector", "place")
        return None if origin is None else _in_reference(part, origin, inner)


FIXED = Placement(np.zeros(3), np.eye(3))
"""Frame of the model."""


def frame_of(part: Part, inner: tuple[int, ...] = ()) -> Placement:
    """Return the placement of a component by the file, else by the component that carries it.

    A component on a shaft has the axes of the shaft, at its u coordinate. A component without shaft has the
    origin of its reference component.

    `inner` are the ids of the components whose placement needs this one, the innermost first: a component
    among them refers to itself. Raises `BadInput`: it does, or an axis or a vector is not valid.
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
    """Return the coordinate of a component along its shaft, m.

    It follows from the placements of both, else from the stated coordinate. Placements come first because one
    program writes the coordinate of the end of a gear, but the placement of its middle.
    """
    shaft, placement = part.shaft, Placement.of(part)
    base = None if shaft is None else Placement.of(shaft)
    coordinate = part.number("u_coordinate_on_shaft", "place along the shaft")
    return coordinate if placement is None or base is None else base.along(placement.origin)


def _in_reference(part: Part, origin: FloatArray, inner: tuple[int, ...]) -> Placement:
    """Return the placement of a component by an origin, m, and its axes in the frame of its reference."""
    u = _unit(part, "u_axis_vector", np.array([1.0, 0.0, 0.0]))
    axis = _unit(part, "w_axis_vector", np.eye(3)[2 if abs(u[2]) < _NEARLY_ALONG_Z else 1])
    across = axis - (axis @ u) * u
    length = float(np.linalg.norm(across))
    if length < PARALLEL:
        raise part.refusal("w_axis_vector", list(map(float, axis)), "not along u_axis_vector")
    w = np.asarray(across / length)
    frame, outer = Placement(origin, np.array([u, np.cross(w, u), w])), _reference(part)
    return frame if outer is None else frame.within(frame_of(outer, (*inner, part.id)))


def _reference(part: Part) -> Part | None:
    """Return the reference component; None for the root, which has none or refers to itself."""
    attribute = part.attribute(_REFERENCE)
    if attribute is None or attribute.kind != "reference_component" or not isinstance(attribute.value, int):
        return None
    part.say(_REFERENCE, "taken", f"its place refers to component {attribute.value}")
    return None if attribute.value == part.id else part.unit.part(attribute.value)


def _unit(part: Part, item: str, usual: FloatArray) -> FloatArray:
    """Return the unit vector of an attribute, by default `usual`."""
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
