"""The compliance of flanks, plane and over the face, and the laws that it keeps."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Protocol, TypeVar

import numpy as np

from fe_contact.compliance.rounding import LARGEST_ROUNDING
from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray

THREADS = 4.0
"""Allowed rounding of the energy over its bound: sums of hundreds of thousands of terms round by their order,
which threads and processors choose.
"""


@dataclass(frozen=True)
class ComplianceChecks:
    """Breaches of the laws of a finite-element compliance. All are relative except the last."""

    residual: float
    """Norm of f - K u over that of f, on every free freedom of the uncondensed mesh, under uniform pressure
    on tooth 0.
    """
    reciprocity: float
    """Largest |S - S'| over the largest |S|, before S is made exactly symmetric."""
    bore_moment: float
    """Moment of the reactions on the bore against base radius times flank force."""
    energy: float
    """Largest difference among u' K u, f' u and q' S q."""
    least_eigenvalue: float
    """Least eigenvalue of S, 1/Pa; above 0."""
    residual_rounding: float
    energy_rounding: float
    """`residual_rounding`, `energy_rounding`: Bounds of the rounding errors in `residual` and `energy`
    (`fe_contact.compliance.flank`).
    """

    @property
    def limits(self) -> dict[str, float]:
        """Largest value of each law; residual and energy may be what rounding can make of them, no more.

        Measured on one thread they are below 0.15 of that in the plane, from solid gears to discs of a
        hundredth of a module, and up to 0.6 over the face, where 300 000 freedoms are summed. The order of
        the sums is that of the threads of the linear algebra: on two threads it was 1.2, hence `THREADS`.
        """
        return {
            "residual": self.residual_rounding,
            "reciprocity": 1e-10,
            "bore_moment": 1e-6,
            "energy": THREADS * self.energy_rounding,
        }


@dataclass(frozen=True)
class FlankCompliance:
    """Flank displacement per flank force of one gear, bore clamped."""

    s: FloatArray
    """Flank coordinate of the nodes, m, the same for all teeth; quadratic elements with nodes 2e, 2e+1, 2e+2,
    the middle one at the exact middle, so that s is linear within an element. Shape (k,).
    """
    teeth: IntArray
    """Consecutive tooth numbers, centered on 0; tooth j is turned by j pitches counter-clockwise from tooth
    0. Shape (t,).
    """
    matrix: FloatArray
    """Inward displacement along the flank normal at node a per inward consistent nodal force along the flank
    normal at node b and per unit face width, m / (N/m). Row n k + a is node a of tooth ``teeth[n]``.
    Symmetric positive definite. Shape (t k, t k).
    """
    along: FloatArray
    """Displacement along the flank towards its tip at node a per such force at node b of the same flank.
    Shape (k, k).
    """
    s_form: float
    s_tip: float
    """`s_form`, `s_tip`: Flank coordinate of form point and tip edge, m; ``s[-1] == s_tip``."""
    contact_modulus: float
    """E / (1 - nu^2) in plane strain, E in plane stress, Pa: the modulus of the half plane."""
    checks: ComplianceChecks
    """Laws kept."""
    unknowns: int
    condensed_unknowns: int
    """`unknowns`, `condensed_unknowns`: Free freedoms of the mesh, and of the system left after condensing
    its tooth sectors.
    """
    seconds: dict[str, float]
    """CPU seconds by stage, children included."""
    solver: str
    """Name of the sparse solver."""
    from_cache: bool = False
    """Whether it was read from disk; `seconds` are then those of the computation."""

    def block(self, tooth: int, other: int) -> FloatArray:
        """Return the (k, k) compliance of flank `tooth` under forces on flank `other`, both tooth numbers."""
        k, first = len(self.s), int(self.teeth[0])
        rows, columns = (tooth - first) * k, (other - first) * k
        if not (tooth in self.teeth and other in self.teeth):
            raise KeyError((tooth, other))
        return self.matrix[rows : rows + k, columns : columns + k]


class _HasChecks(Protocol):
    """Any compliance, of the transverse section or over the face."""

    @property
    def checks(self) -> ComplianceChecks:
        """Laws kept."""


Checked = TypeVar("Checked", bound=_HasChecks)


def refuse_broken_laws(compliance: Checked) -> Checked:
    """Return a compliance whose checks keep their limits.

    Raises `SolveError` naming the check, its value and the limit; ``partial`` is the compliance.
    """
    checks = compliance.checks
    if not checks.energy_rounding <= LARGEST_ROUNDING:
        text = (
            f"flank compliance: rounding may change it by {checks.energy_rounding:.3g}, which exceeds "
            f"{LARGEST_ROUNDING:g}: the body moves far more than it is strained, as a thin plate does. "
            "Widen the face or the bore, or thicken the web."
        )
        raise SolveError(text, compliance)
    for name, limit in checks.limits.items():
        value = getattr(checks, name)
        if not value <= limit:
            raise SolveError(f"flank compliance: {name} {value:.3g} exceeds {limit:.3g}", compliance)
    if not checks.least_eigenvalue > 0.0:
        text = f"flank compliance: least eigenvalue {checks.least_eigenvalue:.3g} is not positive"
        raise SolveError(text, compliance)
    return compliance


@dataclass(frozen=True)
class FlankCompliance3D:
    """Flank displacement per flank force of one gear with all teeth real, bore held.

    Flank freedoms are displacements and forces along the flank's normal at the nodes of eight-node
    quadrilaterals in (s, z): node (2 l + i, 2 e + j), i and j from 0 to 2, belongs to layer l and profile
    element e; there is none at the center i = j = 1. Teeth are numbered counter-clockwise seen from +z.
    """

    s: FloatArray
    """Flank coordinate of the profile nodes from root to tip, m; nodes 2e, 2e+1, 2e+2 are one element, the
    middle one at the exact middle. Shape (k,).
    """
    z: FloatArray
    """Ends of the layers, m, increasing along the gear's axis; z = 0 is mid-face of this gear. Planes of
    nodes are the ends and middles of layers. Shape (L + 1,).
    """
    index: IntArray
    """Flank freedom at plane and profile node; -1 at the centers. Shape (2 L + 1, k)."""
    blocks: FloatArray
    """Displacement of the flank of tooth m (row) per force on the flank of tooth 0 (column), both along the
    normal with the same sign, m/N; tooth 0 by tooth -m is the transpose. ``blocks[0]`` is symmetric. Shape
    (reach + 1, nf, nf).
    """
    s_form: float
    s_tip: float
    """`s_form`, `s_tip`: Flank coordinate of form point and tip edge, m; ``s[-1] == s_tip``."""
    contact_modulus: float
    """E / (1 - nu^2), Pa."""
    base_helix_angle: float
    """Base helix angle, rad; > 0 is right hand: the same s is further counter-clockwise at larger z."""
    teeth: int
    """Number of teeth of the gear."""
    checks: ComplianceChecks
    """Breaches of the laws of the compliance."""
    unknowns: int
    """Free freedoms of the mesh of the whole gear."""
    seconds: dict[str, float]
    """CPU seconds by stage, children included."""
    solver: str
    """Method and software that solved the equations."""
    from_cache: bool = False
    """Whether it was read from disk; `seconds` are then those of the computation."""
    key_rows: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    """Rows of the update by a keyed bore, by tooth from -s to s around tooth 0; else empty. Shape (2 s + 1,
    r, nf).
    """
    key_core: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    """Core of the update by a keyed bore, m/N. ``block(t, o)`` is the block of `blocks` plus ``key_rows[t].T
    @ key_core @ key_rows[o]``. Shape (r, r).
    """

    @property
    def reach(self) -> int:
        """Largest distance in teeth that `blocks` holds."""
        return len(self.blocks) - 1

    def block(self, tooth: int, other: int) -> FloatArray:
        """Return the (nf, nf) compliance of flank `tooth` under forces on flank `other`, both tooth numbers.

        Raises `KeyError`: the teeth are further apart than `reach`, or beside a key further than s from tooth
        0.
        """
        if len(self.key_rows) == 0:
            return self._by_distance(tooth, other)
        span = len(self.key_rows) // 2
        if max(abs(tooth), abs(other)) > span:
            raise KeyError((tooth, other))
        first, second = (self.key_rows[j + span] for j in (tooth, other))
        return np.asarray(self._by_distance(tooth, other) + first.T @ self.key_core @ second)

    def _by_distance(self, tooth: int, other: int) -> FloatArray:
        """Return the part of `block` that depends on the distance of the teeth alone."""
        ahead = (tooth - other) % self.teeth
        behind = self.teeth - ahead
        if ahead <= self.reach:
            return np.asarray(self.blocks[ahead])
        if behind <= self.reach:
            return np.asarray(self.blocks[behind].T)
        raise KeyError((tooth, other))

    def mirrored(self) -> FlankCompliance3D:
        """Return the compliance of the gear of opposite hand: the mirror image in the plane of mid-face.

        It has the same transverse section at mid-face, so the right flank stays the right flank.
        """
        planes = self.index[::-1]
        order = planes[planes >= 0]
        blocks = np.ascontiguousarray(self.blocks[:, order[:, None], order])
        rows = self.key_rows[:, :, order] if len(self.key_rows) else self.key_rows
        return replace(
            self, key_rows=rows, z=0.0 - self.z[::-1], blocks=blocks, base_helix_angle=-self.base_helix_angle
        )
