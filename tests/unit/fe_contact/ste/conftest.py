"""Physically shaped databases without any contact analysis.

A scalar gear pair: each tooth pair carries k(u) (d - e(u))^1.1 at phase u = position + j, with k a parabola
and e the gap (corner contact beyond the path of contact, linear tip relief before its ends), and the loads
add up. The deflection at a given load follows by bisection, the tangent in closed form.
"""

from dataclasses import replace

import numpy as np
import pytest

from fe_contact.ste import Metadata, PairGeometry, SteDatabase
from fe_contact.ste.fields import DIMENSIONS

EXPONENT = 1.1
CONTACT_RATIO = 1.5568
FACTS = PairGeometry((20, 20), (37.588e-3, 37.588e-3), 11.809e-3, 0.0, 80e-3, np.radians(20.0), 25e-3, 0)
HELICAL = PairGeometry(
    (39, 40), (60.3e-3, 61.9e-3), 9.0e-3, np.radians(24.0), 134.5e-3, np.radians(22.0), 25e-3, 1
)


def pair_laws(position, pair, relief, misalignment, center_distance_change):
    """Stiffness N/m^1.1 and gap m of every pair, on the grid (P, M, D, N)."""
    phase = position[:, None, None, None] + pair
    stiffness = 3.4e8 * np.maximum(1.0 - 0.35 * (phase / 0.78) ** 2, 0.5) / 1e-6 ** (EXPONENT - 1.0)
    reach = np.abs(phase) - CONTACT_RATIO / 2 * (1.0 - 100.0 * center_distance_change[:, None])
    gap = 2.8e-3 * np.maximum(reach, 0.0) ** 2 + relief * np.clip(reach / 0.25 + 1.0, 0.0, None)
    gap = gap + 0.2 * np.abs(misalignment)[:, None, None]
    softer = 1.0 / (1.0 + np.abs(misalignment) / 40e-6)
    return stiffness * softer[:, None, None], gap


def solve(stiffness, gap, force):
    """Deflection (P, F, M, D) at which the pairs carry `force`, by bisection to rounding."""
    low = np.repeat(gap.min(axis=-1)[:, None], len(force), axis=1)
    high = low + 1e-2
    target = force[:, None, None]
    for _ in range(100):
        middle = 0.5 * (low + high)
        pressed = np.maximum(middle[..., None] - gap[:, None], 0.0)
        enough = (stiffness[:, None] * pressed**EXPONENT).sum(axis=-1) >= target
        low, high = np.where(enough, low, middle), np.where(enough, middle, high)
    return 0.5 * (low + high)


def synthetic(
    *,
    position=None,
    force=(266.0, 1330.0, 2660.0, 5320.0, 10640.0),
    relief=0.0,
    misalignment=(0.0,),
    center_distance_change=(0.0,),
    pair=(-2, -1, 0, 1),
    geometry=FACTS,
    error=1e-9,
    **changes,
) -> SteDatabase:
    """Build a database; `changes` replace whole arrays."""
    position = np.arange(64) / 64 if position is None else np.asarray(position, dtype=float)
    force, pair = np.asarray(force, dtype=float), np.asarray(pair)
    across, spread = np.asarray(misalignment, dtype=float), np.asarray(center_distance_change, dtype=float)
    stiffness, gap = pair_laws(position, pair, relief, across, spread)
    ste = solve(stiffness, gap, force)
    pressed = np.maximum(ste[..., None] - gap[:, None], 0.0)
    carried = stiffness[:, None] * pressed**EXPONENT
    tangent = (EXPONENT * carried / np.where(pressed > 0.0, pressed, 1.0)).sum(axis=-1)
    arrays = {
        "position": position,
        "force": force,
        "torque": force * geometry.base_radius[0] * np.cos(geometry.base_helix_angle),
        "misalignment": across,
        "center_distance_change": spread,
        "pair": pair,
        "static_transmission_error": ste,
        "tangent_compliance": 1.0 / tangent,
        "no_load_transmission_error": gap.min(axis=-1),
        "load_share": carried / carried.sum(axis=-1, keepdims=True),
        "face_centroid": np.zeros_like(ste),
        "max_pressure": 1e7 * np.sqrt(carried.max(axis=-1)),
        "pairs_in_contact": (carried > 0.0).sum(axis=-1),
        "status": np.zeros(ste.shape, dtype=int),
        "error_estimate": np.full(ste.shape, error),
        "residuals": np.full((*ste.shape, 4), 1e-12),
        "geometry": geometry,
        "metadata": Metadata(
            case={"pair": {"normal_module_mm": 4.0}, "load": {"torque_n_m": [10, 50.5]}},
            effect_ledger=[{"effect": "corner_contact", "on": True, "because": "sharp tips at 100 N m"}],
            receipt={"seconds": {"fe": 1.25}},
            content_hash="0" * 64,
            software_versions={"numpy": np.__version__},
        ),
    }
    return SteDatabase(**(arrays | changes))


def written_out(database: SteDatabase, period: int, **changes) -> SteDatabase:
    """Return the same table over `period` equal base pitches; `changes` replace whole arrays."""
    arrays = {
        name: np.concatenate([getattr(database, name)] * period)
        for name, dimensions in DIMENSIONS.items()
        if dimensions[0] == "position" and name != "position"
    }
    position = np.concatenate([database.position + pitch for pitch in range(period)])
    return replace(database, **(arrays | {"position": position, "period": period} | changes))


@pytest.fixture(scope="session")
def make():
    return synthetic


@pytest.fixture(scope="session")
def repeat():
    return written_out


@pytest.fixture(scope="session")
def spur():
    return synthetic()


@pytest.fixture(scope="session")
def helical():
    return synthetic(geometry=HELICAL, relief=5e-6)


@pytest.fixture(scope="session")
def four_axes():
    return synthetic(
        position=np.arange(24) / 24 + 0.01,
        misalignment=(-30e-6, 0.0, 20e-6, 60e-6),
        center_distance_change=(-2e-4, 0.0, 1.5e-4),
        relief=4e-6,
    )


@pytest.fixture(scope="session")
def helical_facts():
    return HELICAL
