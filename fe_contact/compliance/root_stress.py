"""Stress in the tooth roots of one gear per force on its flanks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray

RESIDUAL_LIMIT = 1e-8
RECOVERY_LIMIT = 1e-5
"""The far field of a load is known to 1e-6 of it (see `fe_contact.compliance.cyclic_ring`)."""


@dataclass(frozen=True)
class RootStressChecks:
    """Laws that a root stress must keep, relative."""

    residual: float
    """Norm of f - K u over that of f on the uncondensed mesh, under uniform pressure on tooth 0."""
    recovery: float
    """Stress of that field, from the displacement of all nodes, against unit-load stress times load."""


@dataclass(frozen=True)
class UnitRootStress:
    """Unit-load stress on the surface of the tooth roots of one gear, in the plane or over the face."""

    distance: IntArray
    """Number of teeth by which the stressed tooth is ahead of the loaded one, counter-clockwise; consecutive,
    symmetric about 0. Shape (d,).
    """
    stress: FloatArray
    """Stress per force at each flank freedom. Second axis: the root beside the loaded (right) flank, which
    the load pulls, and the root on the other side. Third: normal stress along the profile, normal stress
    across it in the surface, shear between the two. Pa/N over the face, Pa/(N/m) in the plane. Forces are
    along the *inward* normal of the flank. Shape (d, 2, 3, p, q, n).
    """
    station_s: FloatArray
    """Flank coordinate of the stations, m, from the middle of the tooth space to the form point. Shape (p,).
    """
    station_z: FloatArray
    """Distance of the stations from mid-face of this gear, m; a single 0 in the plane. Shape (q,)."""
    tangent_angle: FloatArray
    """Angle between the surface there and the tooth's center line, rad; pi/2 at the root circle. Shape (p,).
    """
    s: FloatArray
    """Flank coordinate of the profile nodes that carry forces, m. Shape (k,)."""
    z: FloatArray
    """Ends of the layers, m; empty in the plane. Shape (L + 1,)."""
    index: IntArray
    """Flank freedom at plane and profile node; (1, k) in the plane. Shape (2 L + 1, k)."""
    checks: RootStressChecks
    """Breaches of the laws of root stress."""
    unknowns: int
    """Free freedoms of the mesh of the whole gear."""
    seconds: dict[str, float]
    """CPU seconds by stage, children included."""
    solver: str
    """Method and software that solved the equations."""
    from_cache: bool = False
    """Whether it was read from disk; `seconds` are then those of the computation."""

    @property
    def across_face(self) -> bool:
        """Whether the stress is known over the face, not in the plane alone."""
        return self.z.size > 0

    def mirrored(self) -> UnitRootStress:
        """Return the root stress of the gear of opposite hand: the mirror image in the plane of mid-face."""
        planes = self.index[::-1]
        order = planes[planes >= 0]
        stress = self.stress[..., ::-1, :][..., order]
        stress[:, :, 2] *= -1.0
        z, stations = 0.0 - self.z[::-1], 0.0 - self.station_z[::-1]
        return replace(self, stress=stress, z=z, station_z=stations)


def refuse_broken_stress(stress: UnitRootStress) -> UnitRootStress:
    """Return a root stress whose checks keep their limits.

    Raises `SolveError` naming the check, its value and the limit; ``partial`` is the root stress.
    """
    limits = {"residual": RESIDUAL_LIMIT, "recovery": RECOVERY_LIMIT}
    for name, limit in limits.items():
        value = getattr(stress.checks, name)
        if not value <= limit:
            raise SolveError(f"root stress: {name} {value:.3g} exceeds {limit:.3g}", stress)
    return stress


def relative_difference(values: FloatArray, expected: FloatArray) -> float:
    """Return the largest difference over the largest value."""
    return float(np.abs(values - expected).max() / np.abs(expected).max())
