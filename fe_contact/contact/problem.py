"""The contact problem of all positions as plain arrays, independent of how they were obtained."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from fe_contact.contact.patch import Patches
from fe_contact.contact.strip import Gap
from fe_contact.contact.touch import Touch
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class Candidates:
    """Places where teeth can touch: P positions, n candidates each (a pair in 2-D, a slice of a pair in 3-D).

    A candidate that does not exist at a position has an infinite gap; its other entries are then harmless
    numbers.

    Attributes
    ----------
    position : ndarray, shape (P,)
        Base pitches, by the driving gear's angle.
    pair : ndarray of int, shape (n,)
        Pair index; +1 is ahead. Candidates of one pair stand together.
    face_position : ndarray, shape (n,)
        Distance of the slice's middle from the pinion's mid-face, m.
    touch : Touch
        Touching points of the rigid flanks, arrays (P, n).
    patch_1, patch_2 : Patches
        Load patches on the driving and the driven gear, arrays (P, n).
    slice_width : float
        Along the face, m.
    base_helix_angle : float
        beta_b of gear 1 in rad, > 0 right hand.
    corner_1, corner_2 : float
        What the tip corner of either gear yields over a half plane; see `fe_contact.hertz.wedge_softness`.
    """

    position: FloatArray
    pair: IntArray
    face_position: FloatArray
    touch: Touch
    patch_1: Patches
    patch_2: Patches
    slice_width: float
    base_helix_angle: float = 0.0
    corner_1: float = 1.0
    corner_2: float = 1.0

    @property
    def gap(self) -> FloatArray:
        """Rigid gap (P, n) on the line of action in m, as deflection of the driven gear that closes it."""
        return self.touch.gap

    @property
    def width(self) -> float:
        """Width of a slice along the contact line, m."""
        return self.slice_width / math.cos(self.base_helix_angle)

    @property
    def radius(self) -> FloatArray:
        """Relative radius of curvature (P, n) in the normal section, m."""
        return self.touch.radius / math.cos(self.base_helix_angle)

    @property
    def gap_about(self) -> Gap:
        """Gap about the touching points in the normal section, arrays (P, n) and (P, n, B)."""
        normal = math.cos(self.base_helix_angle)
        touch = self.touch
        return Gap(
            touch.slope * normal,
            touch.curvature * normal,
            touch.low,
            touch.high,
            touch.place,
            touch.jump * normal,
            touch.bend * normal,
        )

    @property
    def motion_arm(self) -> FloatArray:
        """Normal approach per unit deflection of the driven gear (P, n)."""
        return self.touch.lever_2 * math.cos(self.base_helix_angle)

    @property
    def torque_share(self) -> FloatArray:
        """Share of T_1/(r_b1 cos beta_b) per unit normal force (P, n)."""
        return self.touch.lever_1

    def rows(self, keep: IntArray) -> Candidates:
        """Return the candidates of some positions."""
        return replace(
            self,
            position=self.position[keep],
            touch=self.touch.rows(keep),
            patch_1=self.patch_1.rows(keep),
            patch_2=self.patch_2.rows(keep),
        )

    def touching(self, touch: Touch) -> Candidates:
        """Return the same candidates with other touching points."""
        return replace(self, touch=touch)


@dataclass(frozen=True)
class ContactProblem:
    """Candidates with the finite-element compliance between them.

    The candidates may repeat the positions of the compliance in further base pitches: it does not know one
    tooth from the next.

    Attributes
    ----------
    candidates : Candidates
    compliance : ndarray, shape (Q, n, n)
        Of position p at row p modulo Q, P a multiple of Q.
        Normal approach of candidate i per unit normal force at j, both gears, m/N.
    modulus : float
        Contact modulus E*, Pa.
    half_plane_1, half_plane_2 : float
        2 (1 - nu^2)/(pi E) of the gears, 1/Pa.
    """

    candidates: Candidates
    compliance: FloatArray
    modulus: float
    half_plane_1: float
    half_plane_2: float

    @property
    def half_planes(self) -> tuple[FloatArray, FloatArray]:
        """`half_plane_1` and `half_plane_2` at each candidate (P, n), 1/Pa: more at the own tip edge."""
        c = self.candidates
        return (
            self.half_plane_1 * (1.0 + (c.corner_1 - 1.0) * c.patch_1.at_edge),
            self.half_plane_2 * (1.0 + (c.corner_2 - 1.0) * c.patch_2.at_edge),
        )

    def rows(self, keep: IntArray) -> ContactProblem:
        """Return the problem of some positions, one row of compliance each."""
        return replace(self, candidates=self.candidates.rows(keep), compliance=self.compliance[keep])

    def touching(self, candidates: Candidates) -> ContactProblem:
        """Return the same compliance with candidates of other gaps."""
        return replace(self, candidates=candidates)
