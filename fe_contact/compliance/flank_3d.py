"""Compliance of the flanks of one gear over its face width."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from fe_contact.compliance.flank import ComplianceChecks
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class FlankCompliance3D:
    """Flank displacement per flank force of one gear with all teeth real, bore held.

    Flank freedoms are displacements and forces along the flank's normal at the nodes of eight-node
    quadrilaterals in (s, z): node (2 l + i, 2 e + j), i and j from 0 to 2, belongs to layer l and profile
    element e; there is none at the center i = j = 1. Teeth are numbered counter-clockwise seen from +z.

    Attributes
    ----------
    s : (k,) array
        Flank coordinate of the profile nodes from root to tip, m; nodes 2e, 2e+1, 2e+2 are one element, the
        middle one at the exact middle.
    z : (L + 1,) array
        Ends of the layers, m, increasing along the gear's axis; z = 0 is mid-face of this gear. Planes of
        nodes are the ends and middles of layers.
    index : (2 L + 1, k) int array
        Flank freedom at plane and profile node; -1 at the centers.
    blocks : (reach + 1, nf, nf) array
        Displacement of the flank of tooth m (row) per force on the flank of tooth 0 (column), both along the
        normal with the same sign, m/N; tooth 0 by tooth -m is the transpose. ``blocks[0]`` is symmetric.
    s_form, s_tip : float
        Flank coordinate of form point and tip edge, m; ``s[-1] == s_tip``.
    contact_modulus : float
        E / (1 - nu^2), Pa.
    base_helix_angle : float
        rad; > 0 is right hand: the same s is further counter-clockwise at larger z.
    teeth : int
        Number of teeth of the gear.
    checks : ComplianceChecks
        Laws kept.
    unknowns : int
        Free freedoms of the mesh of the whole gear.
    seconds : dict
        CPU seconds by stage, children included.
    solver : str
        How the equations were solved.
    key_rows : (2 s + 1, r, nf) array
        Of a keyed bore, by tooth from -s to s around tooth 0; else empty.
    key_core : (r, r) array
        ``block(t, o)`` is that of `blocks` plus ``key_rows[t].T @ key_core @ key_rows[o]``, m/N.
    from_cache : bool
        Whether it was read from disk; `seconds` are then those of the computation.
    """

    s: FloatArray
    z: FloatArray
    index: IntArray
    blocks: FloatArray
    s_form: float
    s_tip: float
    contact_modulus: float
    base_helix_angle: float
    teeth: int
    checks: ComplianceChecks
    unknowns: int
    seconds: dict[str, float]
    solver: str
    from_cache: bool = False
    key_rows: FloatArray = field(default_factory=lambda: np.zeros((0, 0, 0)))
    key_core: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))

    @property
    def reach(self) -> int:
        """Largest distance in teeth that `blocks` holds."""
        return len(self.blocks) - 1

    def block(self, tooth: int, other: int) -> FloatArray:
        """Return the (nf, nf) compliance of flank `tooth` under forces on flank `other`, both tooth numbers.

        Raises
        ------
        KeyError
            The teeth are further apart than `reach`, or beside a key further than s from tooth 0.
        """
        if len(self.key_rows) == 0:
            return self._apart(tooth, other)
        span = len(self.key_rows) // 2
        if max(abs(tooth), abs(other)) > span:
            raise KeyError((tooth, other))
        first, second = (self.key_rows[j + span] for j in (tooth, other))
        return np.asarray(self._apart(tooth, other) + first.T @ self.key_core @ second)

    def _apart(self, tooth: int, other: int) -> FloatArray:
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
