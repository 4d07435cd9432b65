"""A small STE database in closed form: a pair of constant stiffness per contact, two pairs sharing."""

import math

import numpy as np

from fe_contact.ste import Metadata, PairGeometry, SteDatabase

STIFFNESS = 4e8  # N/m at x = 0.5; falls to 3e8 at x = 0
BASE_RADIUS = 0.04 * math.cos(math.radians(20.0))


def small_table() -> SteDatabase:
    """Return the table of STE = F / k(x), k(x) = 3.5e8 - 0.5e8 cos(2 pi x) N/m, spur 20/20, module 4 mm."""
    position = np.arange(8) / 8.0
    torque = np.array([10.0, 50.0, 100.0, 200.0])
    force = torque / BASE_RADIUS
    stiffness = 3.5e8 - 0.5e8 * np.cos(2.0 * np.pi * position)
    grid = (position.size, force.size, 1, 1)
    ste = (force[None, :] / stiffness[:, None]).reshape(grid)
    share = np.zeros((*grid, 2))
    share[..., 0] = (1.0 - position)[:, None, None, None]
    share[..., 1] = position[:, None, None, None]
    return SteDatabase(
        position=position,
        force=force,
        torque=torque,
        misalignment=np.zeros(1),
        center_distance_change=np.zeros(1),
        pair=np.array([0, 1]),
        static_transmission_error=ste,
        tangent_compliance=np.broadcast_to((1.0 / stiffness)[:, None, None, None], grid),
        no_load_transmission_error=np.zeros((position.size, 1, 1)),
        load_share=share,
        face_centroid=np.zeros(grid),
        max_pressure=np.full(grid, 5e8),
        pairs_in_contact=np.full(grid, 2),
        status=np.zeros(grid),
        error_estimate=1e-3 * ste,
        residuals=np.zeros((*grid, 4)),
        geometry=PairGeometry(
            teeth=(20, 20),
            base_radius=(BASE_RADIUS, BASE_RADIUS),
            base_pitch=2.0 * math.pi * BASE_RADIUS / 20,
            base_helix_angle=0.0,
            center_distance=0.08,
            working_pressure_angle=math.radians(20.0),
            face_width=0.025,
            helix_hand=0,
        ),
        metadata=Metadata(case={"name": "closed form"}, content_hash="0" * 64),
    )
