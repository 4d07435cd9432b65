"""The model of the contact analysis: effects contribute to it, the candidates are built from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fe_contact.flank.extent import Extent
from fe_contact.geometry import FlankGrid, ParallelAxes
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class Break:
    """Begin of a modification of one gear along its profile, to a depth of jump d + bend d^2/2."""

    gear: int
    """0 is the pinion, 1 the wheel."""
    position: FloatArray
    """Flank coordinate on that gear, m; of no dimension, or one per touching point."""
    side: int
    """+1 where it runs towards the pinion's tip (the wheel's root), else -1."""
    jump: FloatArray | float
    bend: FloatArray | float
    """`jump`, `bend`: 1 and 1/m; arrays where `position` is one."""
    ends_flank: bool = False
    """Whether the usable flank ends there: a rounded or chamfered tip."""

    def distance(self, s_1: FloatArray, s_2: FloatArray) -> FloatArray:
        """Return how far it is from touching points at these coordinates, m towards the pinion's tip."""
        return self.position - s_1 if self.gear == 0 else s_2 - self.position

    def height(self, beyond: FloatArray) -> FloatArray:
        """Return the material removed at distances towards the pinion's tip, m; distances in m."""
        depth = np.maximum(self.side * beyond, 0.0)
        return np.asarray(depth * (self.jump + 0.5 * self.bend * depth))


class GapTerm(Protocol):
    """A rigid gap on the line of action, added to the conjugate (zero) or corner gap.

    `along_profile` says whether it varies along the flanks: only then can it move the touching point.
    """

    @property
    def along_profile(self) -> bool:
        """Whether the gap varies along the flanks, at the roll lengths where they touch."""

    @property
    def only_removes(self) -> bool:
        """Whether it is nowhere below zero."""

    @property
    def grids(self) -> tuple[FlankGrid | None, FlankGrid | None]:
        """Surfaces of pinion and wheel that are in it: they may be rough, and have no breaks."""

    def breaks(self, pair: ParallelAxes, face: FloatArray) -> tuple[Break, ...]:
        """Return where the gap's slope or curvature along the profile jumps.

        At `face`, as many distances (n,) from the pinion's mid-face in m as there are touching points.
        """

    def extent(self, pair: ParallelAxes) -> Extent:
        """Return bounds of the gap all over the usable flanks."""

    def __call__(
        self, pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Gap in m, > 0 where material is missing.

        Taken at the touching roll lengths of the two flanks, of a gap that does not vary along them at those
        on the line of action, and at `face`, the distance from the pinion's mid-face, in m; the three
        broadcast.
        """


@dataclass(frozen=True)
class MeetingTeeth:
    """Pairs of teeth where they touch; arrays that broadcast."""

    pair: ParallelAxes
    meeting: IntArray
    """Number of the pair that meets, counted from position 0. Meeting 0 is pair 0 at position 0. Meeting k
    touches at the pitch point at position k, with the k-th next teeth of both gears.
    """
    roll_1: FloatArray
    roll_2: FloatArray
    """`roll_1`, `roll_2`: Roll lengths of the two flanks, m."""
    face: FloatArray
    """Distance from the pinion's mid-face, m."""

    @classmethod
    def at_pitch_point(cls, pair: ParallelAxes, meeting: IntArray) -> MeetingTeeth:
        """Return pairs that touch at the pitch point in mid-face."""
        roll = np.array(pair.path_of_contact.pitch_point)
        return cls(pair, meeting, roll, pair.mating_roll_length(roll), np.zeros(()))


class ToothGap(Protocol):
    """A rigid gap by one gear that differs from tooth to tooth."""

    @property
    def gear(self) -> int:
        """0 of the pinion, 1 of the wheel: its teeth come again after a revolution of that gear."""

    @property
    def period(self) -> int:
        """Number of base pitches after which it repeats, also below 0."""

    @property
    def largest(self) -> float:
        """Bound of the gap in m, of whichever tooth."""

    @property
    def extents(self) -> Extent:
        """Bounds of the gap all over the usable flanks, arrays over the teeth of the gear, or numbers."""

    def tooth(self, meeting: IntArray) -> IntArray:
        """Return the numbers of the gear's teeth that meet, the first is 0."""

    def nodes(self, pair: ParallelAxes, tooth: int) -> FloatArray:
        """Return roll lengths in m, between two of which the profile of a tooth turns back once at most."""

    def __call__(self, teeth: MeetingTeeth) -> FloatArray:
        """Gap in m, > 0 where material is missing."""


class ComplianceTerm(Protocol):
    """Compliance of shafts and seats that carry the gears, added to that of teeth and bodies.

    Hashable, so that an assembled problem can be kept with the terms that are in it.
    """

    def __call__(
        self, pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Return the normal approach (P, n, n) in m of each candidate per N at each other.

        Symmetric and positive semidefinite; taken at the touching roll lengths (P, n) of the two flanks and
        at `face` (n,), the distance from the pinion's mid-face, in m.
        """


@dataclass(frozen=True)
class ContactModel:
    """The composed model; neutral as constructed."""

    couple_teeth: bool = False
    """Load on one tooth moves its neighbors."""
    corner_contact: bool = False
    """Tip edges may touch off the line of action, before A and after E."""
    across_face: bool = False
    """Load distributes over the face width: three dimensions instead of the plane."""
    finite_width: bool = False
    """Whether the plane is corrected for the finite width: the compliance is that of plane strain plus that
    of the free ends. In three dimensions the compliance has both anyway.
    """
    parts: tuple[str, ...] = ()
    """Parts of the gears' bodies that are in their compliance (`Toothing.with_parts`); without any they are
    solid, their bores fixed all over.
    """
    gaps: tuple[GapTerm, ...] = ()
    tooth_gaps: tuple[ToothGap, ...] = ()
    compliances: tuple[ComplianceTerm, ...] = ()

    @property
    def sloped(self) -> bool:
        """Whether flanks slope along their profiles, so that they press off the place of plain involutes."""
        return any(term.along_profile for term in self.gaps)

    def gap_of_teeth(self, teeth: MeetingTeeth) -> FloatArray:
        """Sum of the gaps that differ from tooth to tooth, m."""
        return np.asarray(sum((term(teeth) for term in self.tooth_gaps), np.zeros(())))

    def extent(self, pair: ParallelAxes, meeting: IntArray) -> Extent:
        """Return bounds of all gaps of the pairs of teeth that meet, arrays as `meeting`."""
        alike = sum((term.extent(pair) for term in self.gaps), Extent())
        of_teeth = sum((term.extents.at(term.tooth(meeting)) for term in self.tooth_gaps), alike)
        none = np.zeros(meeting.shape)
        return of_teeth + Extent(none, none, none)

    @property
    def period(self) -> int:
        """Whole base pitches after which the contact repeats."""
        return math.lcm(1, *(term.period for term in self.tooth_gaps))
