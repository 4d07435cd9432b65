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
    """Point of a profile from which on a modification removes jump d + bend d^2/2 at the distance d."""

    gear: int
    """0 is the pinion, 1 the wheel."""
    position: FloatArray
    """Flank coordinate on that gear, m; a scalar, or one per touching point."""
    side: int
    """+1 where the modification is towards the pinion's tip (the wheel's root) from here, else -1."""
    jump: FloatArray | float
    bend: FloatArray | float
    """`jump`, `bend`: Slope and curvature of the removed depth; 1 and 1/m. Arrays where `position` is one."""
    ends_flank: bool = False
    """Whether the usable flank ends there: a rounded or chamfered tip."""

    def distance(self, s_1: FloatArray, s_2: FloatArray) -> FloatArray:
        """Return its distance in m from points at flank coordinates, positive towards the pinion's tip."""
        return self.position - s_1 if self.gear == 0 else s_2 - self.position

    def height(self, distance: FloatArray) -> FloatArray:
        """Return the material removed in m at distances in m from the break, as those of `distance`."""
        beyond = np.maximum(self.side * distance, 0.0)
        return np.asarray(beyond * (self.jump + 0.5 * self.bend * beyond))


class GapTerm(Protocol):
    """A rigid gap on the line of action, added to the conjugate (zero) or corner gap.

    `along_profile` says whether it varies along the flanks: only then can it move the touching point.
    """

    @property
    def along_profile(self) -> bool:
        """Whether the gap varies along the flanks, at the roll lengths where they touch."""

    @property
    def only_removes(self) -> bool:
        """Whether the gap is nowhere below zero."""

    @property
    def grids(self) -> tuple[FlankGrid | None, FlankGrid | None]:
        """Surfaces of pinion and wheel that it contains, which may be rough; they have no breaks."""

    def breaks(self, pair: ParallelAxes, face: FloatArray) -> tuple[Break, ...]:
        """Return the breaks: where the gap's slope or curvature along the profile jumps.

        `face`: Distance of each touching point from the pinion's mid-face (n,), m.
        """

    def extent(self, pair: ParallelAxes) -> Extent:
        """Return bounds of the gap over the whole usable flanks."""

    def __call__(
        self, pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Return the gap in m, > 0 where material is removed.

        Parameters
        ----------
        roll_1, roll_2 : ndarray
            Roll lengths at which the two flanks touch, m; those on the line of action for a gap that does not
            vary along the flanks.
        face : ndarray
            Distance from the pinion's mid-face, m. The three arrays broadcast.
        """


@dataclass(frozen=True)
class MeetingTeeth:
    """Pairs of teeth and the points where they touch; arrays that broadcast."""

    pair: ParallelAxes
    meeting: IntArray
    """Number of the meeting, counted from position 0: in meeting k, the pair of teeth k after those of
    meeting 0 on both gears is in contact. It touches at the pitch point at position k.
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
        """The gear: 0 is the pinion, 1 the wheel. Its teeth meet again after a revolution of that gear."""

    @property
    def period(self) -> int:
        """Number of base pitches after which the gap repeats, forwards and backwards."""

    @property
    def largest(self) -> float:
        """Bound of the gap of all teeth, m."""

    @property
    def extents(self) -> Extent:
        """Bounds of the gap over the whole usable flanks: arrays over the teeth of the gear, or scalars."""

    def tooth(self, meeting: IntArray) -> IntArray:
        """Return the number of the gear's tooth in each meeting, from 0 on."""

    def nodes(self, pair: ParallelAxes, tooth: int) -> FloatArray:
        """Return roll lengths in m; the profile of a tooth has at most one extremum between neighbors."""

    def __call__(self, teeth: MeetingTeeth) -> FloatArray:
        """Return the gap in m, > 0 where material is removed."""


class ComplianceTerm(Protocol):
    """Compliance of shafts and seats that carry the gears, added to that of teeth and bodies.

    A term is hashable, so that assembled problems can be stored under the terms that they contain.
    """

    def __call__(
        self, pair: ParallelAxes, roll_1: FloatArray, roll_2: FloatArray, face: FloatArray
    ) -> FloatArray:
        """Return the normal approach of each candidate per force on each other (P, n, n), m/N.

        It is symmetric and positive semidefinite. `roll_1`, `roll_2`: Roll lengths (P, n) at which the two
        flanks touch, m. `face`: Distance (n,) from the pinion's mid-face, m.
        """


@dataclass(frozen=True)
class ContactModel:
    """The composed model; without arguments it has no effect at all."""

    couple_teeth: bool = False
    """Whether the load on one tooth moves its neighbors."""
    corner_contact: bool = False
    """Whether tip edges may touch off the line of action, before A and after E."""
    across_face: bool = False
    """Whether the model has the load's distribution over the face width: three dimensions instead of a plane.
    """
    finite_width: bool = False
    """Whether the plane is corrected for the finite width: the compliance is that of plane strain plus that
    of the free ends. In three dimensions the compliance has both anyway.
    """
    parts: tuple[str, ...] = ()
    """Parts of the gears' bodies that their compliance includes (`Toothing.with_parts`). Without any the
    bodies are solid, and their bores fixed all over.
    """
    gaps: tuple[GapTerm, ...] = ()
    tooth_gaps: tuple[ToothGap, ...] = ()
    compliances: tuple[ComplianceTerm, ...] = ()

    @property
    def sloped(self) -> bool:
        """Whether gaps vary along the profiles, so that flanks touch elsewhere than plain involutes."""
        return any(term.along_profile for term in self.gaps)

    def gap_of_teeth(self, teeth: MeetingTeeth) -> FloatArray:
        """Return the sum of the gaps that differ from tooth to tooth, m."""
        return np.asarray(sum((term(teeth) for term in self.tooth_gaps), np.zeros(())))

    def extent(self, pair: ParallelAxes, meeting: IntArray) -> Extent:
        """Return bounds of all gaps of the pairs of teeth that meet, arrays as `meeting`."""
        common = sum((term.extent(pair) for term in self.gaps), Extent())
        of_teeth = sum((term.extents.at(term.tooth(meeting)) for term in self.tooth_gaps), common)
        zero = np.zeros(meeting.shape)
        return of_teeth + Extent(zero, zero, zero)

    @property
    def period(self) -> int:
        """Whole base pitches after which the contact repeats."""
        return math.lcm(1, *(term.period for term in self.tooth_gaps))
