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
    """

    rows: FloatArray
    factors: Factors

    def plus(self, other: FrameTerm) -> FrameTerm:
        """Return the sum of two terms whose rows move alike."""
        a, b, c, d, e = (x + y for x, y in zip(self.factors, other.factors, strict=True))
        return replace(self, factors=(a, b, c, d, e))


def frame_laws(terms: Sequence[FrameTerm], lever: float, spinning: Sequence[bool]) -> RotatingFrameLaws:
    """Lay out the laws of `terms`; `spinning` says whose shaft adds its own rotation to the spin."""
    return RotatingFrameLaws(
        np.array([term.factors for term in terms], dtype=float).reshape(-1, 5),
        np.full(len(terms), lever),
        np.array(spinning, dtype=np.bool_),
    )


def frame_lever(scene: Scene) -> float:
    """Return the radius that makes lengths of tilts, m."""
    return max((gear.base_radius for gear in scene.gears), default=1.0)
