"""Where the components of a gear unit stand: axes and origins in the frame of the unit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.from_rexs.gear_unit import GearUnit
from service.from_rexs.part import Part
from service.problems import BadInput

Vector = NDArray[np.float64]
_MOST_FRAMES = 32


@dataclass(frozen=True)
class Frame:
    """A local frame in that of the gear unit.

    Attributes
    ----------
    origin : array (3,)
        m.
    axes : array (3, 3)
        Unit vectors u, v, w as columns; right-handed.
    """

    origin: Vector
    axes: Vector

    @property
    def u(self) -> Vector:
        """Direction of the axis of rotation."""
        return self.axes[:, 0]


_UNIT = Frame(np.zeros(3), np.eye(3))


def frame_of(unit: GearUnit, part: Part) -> Frame:
    """Return the frame of a component: its support vector and axes, in those of its reference component.

    A component on a shaft that gives no support vector stands at its u coordinate on the shaft. Without axes
    it is parallel to its reference component.

    Raises
    ------
    BadInput
        Axes of no length or along each other, or frames that refer to each other in a circle.
    """
    return _frame(unit, part, 0)


def _frame(unit: GearUnit, part: Part, depth: int) -> Frame:
    """Return the frame of a component that others refer to."""
    if depth > _MOST_FRAMES:
        field = f"{part.place}, reference_component_for_position"
        raise BadInput.of(field, part.id, f"at most {_MOST_FRAMES} frames away from the gear unit's")
    origin = part.vector("support_vector", "place in the frame of its reference component")
    shaft = unit.owner(part, "shaft")
    if origin is None and shaft is not None and shaft.id != part.id:
        return _on_shaft(_frame(unit, shaft, depth + 1), part)
    return _within(_reference_frame(unit, part, depth), part, origin or (0.0, 0.0, 0.0))


def _on_shaft(shaft: Frame, part: Part) -> Frame:
    """Return the frame of a component at its coordinate on a shaft."""
    along = part.number("u_coordinate_on_shaft", "place along the shaft") or 0.0
    return Frame(shaft.origin + along * shaft.u, shaft.axes)


def _reference_frame(unit: GearUnit, part: Part, depth: int) -> Frame:
    """Return the frame that a component's place is given in; the unit's if it names none, or itself."""
    attribute = part.attribute("reference_component_for_position")
    number = None if attribute is None else attribute.value
    if isinstance(number, bool) or not isinstance(number, int | float) or number == part.id:
        return _UNIT
    if unit.model.component(int(number)) is None:
        field = f"{part.place}, reference_component_for_position"
        raise BadInput.of(field, number, "the id of a component")
    part.say("reference_component_for_position", "taken", "frame of its place")
    return _frame(unit, unit.part(int(number)), depth + 1)


def _within(outer: Frame, part: Part, origin: tuple[float, ...]) -> Frame:
    """Return the frame at an origin in an outer one; without axes it is parallel to it."""
    u = part.vector("u_axis_vector", "direction of its axis") or (1.0, 0.0, 0.0)
    w = part.vector("w_axis_vector", "direction across its axis") or (0.0, 0.0, 1.0)
    return Frame(outer.origin + outer.axes @ _vector(part, origin), outer.axes @ _axes(part, u, w))


def _axes(part: Part, u: tuple[float, ...], w: tuple[float, ...]) -> Vector:
    """Return orthonormal axes: u as it is, w made square to it."""
    first, last = _vector(part, u), _vector(part, w)
    length = math.hypot(*first)
    if length > 0.0:
        first = first / length
        last = last - (last @ first) * first
    height = math.hypot(*last)
    if length == 0.0 or height <= 1e-6 * length:
        field = f"{part.place}, u_axis_vector"
        raise BadInput.of(field, [*u, *w], "a direction square to w_axis_vector")
    last = last / height
    return np.column_stack([first, np.cross(last, first), last])


def _vector(part: Part, values: tuple[float, ...]) -> Vector:
    """Return three numbers as a vector."""
    if len(values) != 3:
        raise BadInput.of(f"{part.place}, vector", list(values), "three numbers")
    return np.array(values)
