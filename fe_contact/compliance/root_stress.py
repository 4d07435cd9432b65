"""Stress in the tooth roots of one gear per force on its flanks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fe_contact.errors import SolveError
from fe_contact.geometry.flank_profile import FlankProfile
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
    """How many teeth the stressed tooth is ahead of the loaded one, counter-clockwise; consecutive, symmetric
    about 0. Shape (d,).
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
    """Laws kept."""
    unknowns: int
    """Free freedoms of the mesh of the whole gear."""
    seconds: dict[str, float]
    """CPU seconds by stage, children included."""
    solver: str
    """How the equations were solved."""
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


# The surface of the tooth root in a mesh, from the middle of the tooth space to the form point.


SAMPLES = 4001  # of the exact profile that nodes are sought on


@dataclass(frozen=True)
class RootSurface:
    """Both root fillets of one tooth, each with its half of the root land."""

    nodes: IntArray
    """Nodes of the transverse section from the middle of the tooth space up to the form point: corner,
    mid-side, corner ... First the side of the loaded (right) flank, then the other. Shape (2, 2e + 1).
    """
    s: FloatArray
    """Flank coordinate of both, m, increasing. Shape (2e + 1,)."""


def root_coordinate(profile: FlankProfile, points: FloatArray) -> FloatArray:
    """Return the flank coordinates (n,) in m of points (n, 2) on the root of the right flank.

    The nearest sample of the exact profile, then along its tangent: good to the square of the sample's
    distance over the radius of curvature.
    """
    samples = np.linspace(profile.s_space, profile.s_form, SAMPLES)
    curve = profile.flank(samples)
    nearest = np.argmin(np.linalg.norm(points[:, None] - curve, axis=2), axis=1)
    normal = profile.normal(samples[nearest])
    tangent = profile.gear.sign * np.stack([-normal[:, 1], normal[:, 0]], axis=1)  # towards the tip
    along = np.sum((points - curve[nearest]) * tangent, axis=1)
    return np.asarray(samples[nearest] + along)


STATIONS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
"""Stations of an edge at which its strain is evaluated, in its coordinate from -1 to 1."""
COMPONENTS = 3
"""Along the profile, across it, and the shear between them."""


def between_nodes(values: FloatArray) -> FloatArray:
    """Return values (..., 2e + 1) at the nodes of quadratic edges at their stations, (..., 2e)."""
    low, middle, high = values[..., :-2:2], values[..., 1::2], values[..., 2::2]
    x = STATIONS[:, None]
    at_stations = 0.5 * x * (x - 1.0) * low[..., None, :] + (1.0 - x * x) * middle[..., None, :]
    at_stations = at_stations + 0.5 * x * (x + 1.0) * high[..., None, :]
    return np.asarray(np.swapaxes(at_stations, -1, -2).reshape(*values.shape[:-1], -1))
