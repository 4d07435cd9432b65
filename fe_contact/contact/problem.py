"""The contact problem of all positions as plain arrays, independent of how they were obtained."""

from __future__ import annotations

from dataclasses import dataclass

from fe_contact.contact.patch import Patches
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
        Pair index; +1 is ahead.
    patch_1, patch_2 : Patches
        Load patches on the driving and the driven gear, arrays (P, n).
    gap : ndarray, shape (P, n)
        Rigid gap on the line of action in m, as deflection of the driven gear that closes it.
    lever_1, lever_2 : ndarray, shape (P, n)
        Lever arm of the contact normal about either gear over its base radius; 1 on the line of action.
    radius : ndarray, shape (P, n)
        Relative radius of curvature, m.
    edge_slope : ndarray, shape (P, n)
        Angle between the flanks at the tip edge in rad (see `fe_contact.hertz.edge_contact`); NaN = no edge
        law.
    width : ndarray, shape (n,)
        Width of the slice along the contact line, m.
    base_helix_cosine : float
        cos(beta_b).
    """

    position: FloatArray
    pair: IntArray
    patch_1: Patches
    patch_2: Patches
    gap: FloatArray
    lever_1: FloatArray
    lever_2: FloatArray
    radius: FloatArray
    edge_slope: FloatArray
    width: FloatArray
    base_helix_cosine: float = 1.0

    @property
    def motion_arm(self) -> FloatArray:
        """Normal approach per unit deflection of the driven gear (P, n)."""
        return self.lever_2 * self.base_helix_cosine

    @property
    def torque_share(self) -> FloatArray:
        """Share of T_1/(r_b1 cos beta_b) per unit normal force (P, n)."""
        return self.lever_1


@dataclass(frozen=True)
class ContactProblem:
    """Candidates with the finite-element compliance between them.

    Attributes
    ----------
    candidates : Candidates
    compliance : ndarray, shape (P, n, n)
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
