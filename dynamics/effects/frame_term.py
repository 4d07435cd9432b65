"""A force that a rotor feels because it, or the frame it is described in, rotates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.forces.rotating_frame import RotatingFrameLaws
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

Factors = tuple[float, float, float, float, float]


@dataclass(frozen=True)
class FrameTerm:
    """A term of a rotating-frame element.

    Attributes
    ----------
    rows : (2, N) array
        Its coordinates across the axis, m, in all rotors' freedoms.
    factors : tuple of five floats
        Those of `RotatingFrameLaws`.
    load : (float, float)
        Its load, kg m.
    """

    rows: FloatArray
    factors: Factors = (0.0, 0.0, 0.0, 0.0, 0.0)
    load: tuple[float, float] = (0.0, 0.0)

    def plus(self, other: FrameTerm) -> FrameTerm:
        """Return the sum of two terms whose rows move alike."""
        a, b, c, d, e = (x + y for x, y in zip(self.factors, other.factors, strict=True))
        load = (self.load[0] + other.load[0], self.load[1] + other.load[1])
        return replace(self, factors=(a, b, c, d, e), load=load)


def frame_laws(terms: Sequence[FrameTerm], lever: float, spinning: Sequence[bool]) -> RotatingFrameLaws:
    """Lay out the laws of `terms`; `spinning` says whose shaft adds its own rotation to the spin."""
    return RotatingFrameLaws(
        np.array([term.factors for term in terms], dtype=float).reshape(-1, 5),
        np.array([term.load for term in terms], dtype=float).reshape(-1, 2),
        np.full(len(terms), lever),
        np.array(spinning, dtype=np.bool_),
    )


def frame_lever(scene: Scene) -> float:
    """Return the radius that makes lengths of tilts, m."""
    return max((gear.base_radius for gear in scene.gears), default=1.0)
