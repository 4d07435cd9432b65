"""Misalignment: axes tilted against each other in the plane of action, a table axis."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import Break, ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.flank.extent import Extent
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import relative_radius
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class MisalignmentGap:
    """Gap of axes tilted about the pitch point in the middle of the common face.

    Along a line parallel to the axes it grows by `growth` (m) over the common face width, and with the helix
    along the line of action: `ParallelAxes.tilt_arm`.
    """

    growth: float
    along_profile: ClassVar[bool] = False
    only_removes: ClassVar[bool] = False
    grids: ClassVar[tuple[None, None]] = (None, None)

    def breaks(self, pair: ParallelAxes, face: FloatArray) -> tuple[Break, ...]:
        """Return none: along the profile, across the plane of action, the gap is constant."""
        return ()

    def __call__(
        self, pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Return the gap in m, negative on the side that comes closer."""
        arm = pair.tilt_arm(roll_1, face) - pair.common_face_center
        return np.asarray(self.growth * arm / pair.face_width)

    def extent(self, pair: ParallelAxes) -> Extent:
        """Return the largest gap to either side; with the helix it grows along the line of action.

        Beyond the ends of the path of contact the gap of a tip edge grows as x^2/(2 R'), that of misalignment
        by at most slope x: so it exceeds the edge's by at most slope^2 R'/2. Twice that is allowed, as the
        gap of the edge grows a little more slowly.
        """
        slope = abs(self.growth * math.tan(pair.base_helix_angle)) / pair.face_width
        reach = self.reach(pair) + slope**2 * max(_edge_radii(pair))
        return Extent(-reach, reach, slope)

    def reach(self, pair: ParallelAxes) -> float:
        """Largest gap in size on the path of contact, m."""
        path = pair.path_of_contact
        ends = pair.common_face_center + 0.5 * pair.face_width * np.array([[-1.0], [1.0]])
        rolls = np.array([path.start, path.end])
        return float(np.abs(self(pair, rolls, rolls, ends)).max())


def _edge_radii(pair: ParallelAxes) -> tuple[float, float]:
    """Return R' of the gaps of both tip edges over the overshoot x along the line of action, m.

    The edge stands off by the arc l x/r_b of its flank, on flanks of the relative radius R.
    """
    path = pair.path_of_contact
    ends = (path.end, pair.pinion), (path.start, pair.wheel)
    radii = []
    for roll_1, gear in ends:
        roll_2 = float(pair.mating_roll_length(roll_1))
        radius = abs(float(relative_radius(roll_1, pair.wheel.sign * roll_2)))
        radii.append(radius * (gear.base_radius / (roll_1 if gear is pair.pinion else roll_2)) ** 2)
    return radii[0], radii[1]


@dataclass(frozen=True)
class Misalignment(Effect):
    """Contributes the gap of the scene's single misalignment value; the table runs over its axis."""

    name: ClassVar[str] = "misalignment"
    brings: ClassVar[str] = "misalignment"
    needs: ClassVar[tuple[str, ...]] = ("face position",)
    adds: ClassVar[tuple[str, ...]] = ("gap", "table axis")
    cost: ClassVar[str] = "one more contact sweep per value; no finite-element work"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#misalignment",)
    valid_for: ClassVar[str] = "every pair in three dimensions"

    def called_for(self, scene: ContactScene) -> Verdict:
        """Call for the effect where any value of the misalignment axis is not zero."""
        largest = float(np.abs(scene.misalignment).max())
        if largest == 0.0:
            return Verdict(False, "the gears are aligned", neutral=True)
        return Verdict(True, f"misalignment up to {1e6 * largest:.4g} µm over the face")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the gap of the scene's one value."""
        growth = float(scene.misalignment[0])
        if growth == 0.0:
            return model
        return replace(model, gaps=(*model.gaps, MisalignmentGap(growth)))

    def across_face(self, scene: ContactScene) -> str | None:
        """Return misalignment as a reason for a model over the face; None where the axes are parallel."""
        return "misalignment" if np.any(scene.misalignment != 0.0) else None

    def extent(self, scene: ContactScene) -> Extent:
        """Return the extent of the largest misalignment."""
        return MisalignmentGap(scene.largest_misalignment).extent(scene.pair)

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene with aligned gears."""
        return replace(scene, misalignment=np.zeros_like(scene.misalignment))
