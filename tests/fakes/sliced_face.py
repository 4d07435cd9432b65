"""An STE database in closed form over misalignment and center distance: independent slices of a face.

The slice at t = z/b, -1/2..1/2, is pressed in by d - m t and carries k(x, a) (d - m t)^1.1 per unit of t, if
that is above zero: the load's centroid, and the potential of force and moment, are known.
"""

import math
from dataclasses import replace

import numpy as np

from fe_contact.ste import Metadata, PairGeometry, SteDatabase

BASE_RADIUS = 0.04 * math.cos(math.radians(20.0))
FACE_WIDTH = 0.025
EXPONENT = 1.1
REACH = 10e-6  # m, deflection under REFERENCE_FORCE
REFERENCE_FORCE = 2660.0
ADDENDUM = 0.78  # tip contact ratios of both gears: contact from -0.78 to 0.78 pitches
NODE, WEIGHT = np.polynomial.legendre.leggauss(24)


def stiffness(position, change):
    """Force per unit of t at the deflection REACH, N; a smooth mesh cycle, softer as the shafts part."""
    wave = 1.0 + 0.2 * np.cos(2 * np.pi * position) + 0.05 * np.sin(4 * np.pi * position)
    return REFERENCE_FORCE * wave * (1.0 - 300.0 * change)


def sliced(deflection, misalignment, position, change):
    """Force (N) and centroid over the face width, for arrays that broadcast."""
    deflection, misalignment, position, change = np.broadcast_arrays(
        deflection, misalignment, position, change
    )
    ends = deflection / np.where(misalignment == 0.0, 1e-30, misalignment)  # where the flanks part
    low = np.where(misalignment < 0.0, np.clip(ends, -0.5, 0.5), -0.5)
    high = np.where(misalignment > 0.0, np.clip(ends, -0.5, 0.5), 0.5)
    t = 0.5 * (low + high)[..., None] + 0.5 * (high - low)[..., None] * NODE
    load = (np.maximum(deflection[..., None] - misalignment[..., None] * t, 0.0) / REACH) ** EXPONENT
    load = 0.5 * (high - low)[..., None] * load * WEIGHT
    force = load.sum(axis=-1)
    centroid = (load * t).sum(axis=-1) / np.where(force > 0.0, force, 1.0)
    return stiffness(position, change) * force, centroid


def deflection_under(force, misalignment, position, change):
    """Deflection in m that carries `force` (N): bisection on a monotone function."""
    low = -0.5 * np.abs(misalignment)
    high = low + 20.0 * REACH + np.abs(misalignment)
    for _ in range(50):
        middle = 0.5 * (low + high)
        less = sliced(middle, misalignment, position, change)[0] < force
        low, high = np.where(less, middle, low), np.where(less, high, middle)
    return 0.5 * (low + high)


def sliced_database(
    misalignments=(-20e-6, -10e-6, 0.0, 10e-6, 20e-6),
    distances=(0.0,),
    positions=16,
    forces=(300.0, 1000.0, 2660.0, 6000.0),
) -> SteDatabase:
    """The 20/20 pair of 4 mm module, 25 mm wide, as independent slices."""
    position, force = np.arange(positions) / positions, np.array(forces)
    x, f, m, a = np.meshgrid(position, force, misalignments, distances, indexing="ij")
    ste = deflection_under(f, m, x, a)
    step = 1e-3 * f
    tangent = (deflection_under(f + step, m, x, a) - deflection_under(f - step, m, x, a)) / (2.0 * step)
    grid = ste.shape
    return SteDatabase(
        position=position,
        force=force,
        torque=force * BASE_RADIUS,
        misalignment=np.array(misalignments),
        center_distance_change=np.array(distances),
        pair=np.array([0]),
        static_transmission_error=ste,
        tangent_compliance=tangent,
        no_load_transmission_error=-0.5 * np.abs(m[:, 0]),
        load_share=np.ones((*grid, 1)),
        face_centroid=FACE_WIDTH * sliced(ste, m, x, a)[1],
        max_pressure=np.full(grid, 5e8),
        pairs_in_contact=np.ones(grid),
        status=np.zeros(grid),
        error_estimate=np.zeros(grid),
        residuals=np.zeros((*grid, 4)),
        geometry=PairGeometry(
            teeth=(20, 20),
            base_radius=(BASE_RADIUS, BASE_RADIUS),
            base_pitch=2.0 * math.pi * BASE_RADIUS / 20,
            base_helix_angle=0.0,
            center_distance=0.08,
            working_pressure_angle=math.radians(20.0),
            face_width=FACE_WIDTH,
            helix_hand=0,
        ),
        metadata=Metadata(),
    )


def rigid_share_database(positions=400):
    """Equal shares of the pairs between the ends of the path of contact; a stiffness of its own."""
    database = sliced_database((0.0,), (0.0,), positions=positions)
    pair = np.array([-1, 0, 1])
    y = database.position[:, None] + pair
    touching = (np.abs(y) <= ADDENDUM).astype(float)
    share = touching / touching.sum(axis=1, keepdims=True)
    grid = database.static_transmission_error.shape
    return replace(database, pair=pair, load_share=np.broadcast_to(share[:, None, None, None], (*grid, 3)))
