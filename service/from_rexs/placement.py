"""Where components stand: points and axes u, v, w, composed over the components they refer to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds.types import FloatArray
from service.from_rexs.gear_unit import GearUnit
from service.from_rexs.part import Part
from service.problems import BadInput

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

    def within(self, outer: Placement) -> Placement:
        """Return the place of what is stated in the frame of `outer`."""
        return Placement(outer.origin + self.origin @ outer.axes, self.axes @ outer.axes)


FIXED = Placement(np.zeros(3), np.eye(3))


def placement(unit: GearUnit, part: Part, inner: tuple[int, ...] = ()) -> Placement | None:
    """Return where a component stands, None where the file does not say.

    Parameters
    ----------
    unit : GearUnit
    part : Part
    inner : tuple of int
        The components whose places refer to this one, the innermost first.

    Raises
    ------
    BadInput
        A vector has not three numbers, an axis has no direction, or places refer to each other in a ring.
    """
    if part.id in inner or len(inner) > _MOST_REFERENCES:
        bound = "a component that is not placed by this one itself"
        raise BadInput.of(f"{part.place}, {_REFERENCE}", inner[-1], bound, "Refer to the gear unit.")
    own = _own(part)
    outer = None if own is None else _reference(unit, part)
    if own is None or outer is None:
        return own
    return own.within(placement(unit, outer, (*inner, part.id)) or FIXED)


def _reference(unit: GearUnit, part: Part) -> Part | None:
    """Return the component that a place refers to, None for one that is placed by itself: the root."""
    attribute = part.attribute(_REFERENCE)
    if attribute is None or attribute.kind != "reference_component" or not isinstance(attribute.value, int):
        return None
    part.say(_REFERENCE, "taken", f"its place refers to component {attribute.value}")
    return None if attribute.value == part.id else unit.part(attribute.value)


def _own(part: Part) -> Placement | None:
    """Return the place as stated, in the frame of its reference."""
    origin = _vector(part, "support_vector", "place")
    if origin is None:
        return None
    u = _unit(part, "u_axis_vector", np.array([1.0, 0.0, 0.0]))
    w = _across(part, u)
    return Placement(origin, np.array([u, np.cross(w, u), w]))


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
        part.say(item, "defaulted", f"{usual.tolist()}")
        return usual
    length = float(np.linalg.norm(vector))
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
