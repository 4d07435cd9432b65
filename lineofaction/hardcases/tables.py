"""Tables of contact in closed form, for hard scenes of extraction and noise.

Axes: P positions, F forces, M misalignments, D changes of center distance.
"""

from __future__ import annotations

import math

import numpy as np

from fe_contact.ste import Metadata, PairGeometry, SteDatabase
from fe_contact.types import FloatArray

BASE_RADIUS = 0.04 * math.cos(math.radians(20.0))
COMPLIANCE = 2.5e-9
"""Compliance of a pair of teeth, m/N."""
_GEOMETRY = PairGeometry(
    teeth=(20, 20),
    base_radius=(BASE_RADIUS, BASE_RADIUS),
    base_pitch=2.0 * math.pi * BASE_RADIUS / 20,
    base_helix_angle=0.0,
    center_distance=0.08,
    working_pressure_angle=math.radians(20.0),
    face_width=0.025,
    helix_hand=0,
)

PLAIN_TABLE = (
    "load_share",
    "face_centroid",
    "max_pressure",
    "pairs_in_contact",
    "status",
    "error_estimate",
    "residuals",
)
"""Fields that `table_of` fills with constants."""


def table_of(position: FloatArray, force: FloatArray, ste: FloatArray, lift_off: FloatArray) -> SteDatabase:
    """Return the database of STE (P, F) in m over lift-off (P,), tangents by differences."""
    levels = np.concatenate([lift_off[:, None], ste], axis=1)
    secant = np.abs(np.diff(levels, axis=1)) / np.diff(force, prepend=0.0)
    grid = (*ste.shape, 1, 1)
    share = np.zeros((*grid, 2))
    share[..., 0] = 1.0
    return SteDatabase(
        position=position,
        force=force,
        torque=force * BASE_RADIUS,
        misalignment=np.zeros(1),
        center_distance_change=np.zeros(1),
        pair=np.array([0, 1]),
        static_transmission_error=ste.reshape(grid),
        # positive also where curves nearly touch
        tangent_compliance=np.maximum(secant, 1e-3 * COMPLIANCE).reshape(grid),
        no_load_transmission_error=lift_off.reshape(-1, 1, 1),
        load_share=share,
        face_centroid=np.zeros(grid),
        max_pressure=np.full(grid, 5e8),
        pairs_in_contact=np.ones(grid),
        status=np.zeros(grid),
        error_estimate=np.full(grid, 1e-9),
        residuals=np.zeros((*grid, 4)),
        geometry=_GEOMETRY,
        metadata=Metadata(),
    )


def along(values: FloatArray, factor: FloatArray) -> FloatArray:
    """Repeat values (P, 1, D) or (P, F, 1, D, ...) along the axis of misalignment, times a factor (M,)."""
    axis = 1 if values.ndim == 3 else 2
    shape = [1] * values.ndim
    shape[axis] = factor.size
    return np.asarray(values * factor.reshape(shape))


def square_wave(position: FloatArray) -> FloatArray:
    """Return the compliance in m/N of one pair, and of two on the first half of the pitch."""
    return np.where(position < 0.5, 0.5 * COMPLIANCE, COMPLIANCE)
