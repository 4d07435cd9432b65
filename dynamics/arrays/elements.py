"""Force elements as a scene's assembly gathers them, and their arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.forces.elements import ElementLaws, Elements, prepare_laws
from dynamics.kernels.by_address import by_address
from dynamics.kernels.law import Law
from dynamics.types import FloatArray


@dataclass(frozen=True)
class Element:
    """One element with p local coordinates y = gradient q + offset, in meters.

    Attributes
    ----------
    law : Law
    entry : int
        Its index in the arrays of its law.
    mesh : int
        The mesh whose position it reads; -1: none.
    gradient : (p, N) array
        In the six freedoms of all r rotors.
    offset : (p,) array
        m.
    drift : (p, k) array or None
        Rate of the coordinates per unit speed of each law of the kinematic motion, m/rad; None: 0.
    speed : (2, k) array or None
        Spin and speed of the frame per unit speed of each law, for rotating-frame terms; None: 0.
    stiffness : (p,) array or None
        Typical stiffness of a bearing, N/m; None: 0.
    """

    law: Law
    entry: int
    mesh: int
    gradient: FloatArray
    offset: FloatArray
    drift: FloatArray | None = None
    stiffness: FloatArray | None = None
    speed: FloatArray | None = None


def pack_elements(elements: Sequence[Element], laws: ElementLaws, motions: int) -> Elements:
    """Lay out `elements`, their rows one after the other, in a kinematic motion of that many laws."""
    drift = [
        np.zeros((element.offset.size, motions)) if element.drift is None else element.drift
        for element in elements
    ]
    stiffness = [
        np.zeros(element.offset.size) if element.stiffness is None else element.stiffness
        for element in elements
    ]
    speed = [np.zeros((2, motions)) if element.speed is None else element.speed for element in elements]
    sizes = [element.offset.size for element in elements]
    packed = by_address(
        Elements(
            np.array([int(element.law) for element in elements], dtype=np.int64),
            np.array([element.entry for element in elements], dtype=np.int64),
            np.cumsum([0, *sizes], dtype=np.int64),
            np.array([element.mesh for element in elements], dtype=np.int64),
            np.concatenate([np.empty(0), *(element.offset for element in elements)]),
            np.ascontiguousarray(np.concatenate([np.empty((0, motions)), *drift]).T),
            np.concatenate([np.empty(0), *stiffness]),
            np.ascontiguousarray(np.moveaxis(np.array(speed).reshape(len(elements), 2, motions), 2, 0)),
            laws,
        )
    )
    prepare_laws(packed)
    return packed


def gradients(elements: Sequence[Element], columns: int) -> FloatArray:
    """Return the rows of all elements, (R, columns)."""
    return np.concatenate([np.empty((0, columns)), *(element.gradient for element in elements)])
