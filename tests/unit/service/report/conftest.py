"""A small STE database in closed form: one or two equal pairs in contact, stiffening slightly with load."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fe_contact.ste import Metadata, PairFacts, SteDatabase

R_B, PITCH, WIDTH = 0.0375877, 0.0118085, 0.025
CASE = {
    "pair": {
        "normal_module_mm": 4.0,
        "center_distance_mm": 80.0,
        "pinion": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
        "wheel": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
    },
    "load": {"torque_n_m": [10.0, 100.0, 400.0]},
}


def closed_form(**changes: Any) -> SteDatabase:
    """Two pairs carry between positions 0.28 and 0.72, one elsewhere."""
    position = np.arange(64) / 64
    torque = np.array([0.4, 10.0, 100.0, 400.0])
    force = torque / R_B
    double = (position > 0.28) & (position < 0.72)
    compliance = np.where(double, 1.7e-9, 2.7e-9)  # m/N
    ste = compliance[:, None] * force * (force / 2660.0) ** -0.05
    grid = (64, 4, 1, 1)
    share = np.zeros((64, 3))
    share[:, 1] = np.where(double, 0.5, position <= 0.28)
    share[:, 0] = np.where(double, 0.5, position >= 0.72)
    arrays: dict[str, Any] = {
        "position": position,
        "force": force,
        "torque": torque,
        "misalignment": np.zeros(1),
        "center_distance_change": np.zeros(1),
        "pair": np.array([-1, 0, 1]),
        "static_transmission_error": ste.reshape(grid),
        "tangent_compliance": (0.95 * ste / force).reshape(grid),
        "no_load_transmission_error": np.zeros((64, 1, 1)),
        "load_share": np.broadcast_to(share[:, None, None, None, :], (*grid, 3)),
        "face_centroid": np.zeros(grid),
        "max_pressure": np.full(grid, 7e8),
        "pairs_in_contact": np.broadcast_to(np.where(double, 2, 1)[:, None, None, None], grid),
        "status": np.zeros(grid, dtype=np.int8),
        "error_estimate": 0.002 * ste.reshape(grid),
        "residuals": np.full((*grid, 4), 1e-12),
        "facts": PairFacts((20, 20), (R_B, R_B), PITCH, 0.0, 0.08, math.radians(20), WIDTH, 0),
        "metadata": Metadata(
            case=CASE,
            effect_ledger=[{"name": "corner_contact", "on": True, "reason": "tips touch", "worth": "2 %"}],
            receipt={"stages": {"mesh": {"cpu_seconds": 1.0, "wall_seconds": 1.1}}, "cpu_seconds": 1.0},
            content_hash="0" * 64,
            software_versions={"numpy": "2.0"},
        ),
    }
    return SteDatabase(**(arrays | changes))


def with_failures() -> SteDatabase:
    """The same table with one failed point."""
    whole = closed_form()
    ste, status = whole.static_transmission_error.copy(), whole.status.copy()
    ste[5, 2], status[5, 2] = np.nan, 1
    return replace(whole, static_transmission_error=ste, status=status)


@pytest.fixture
def database() -> SteDatabase:
    return closed_form()


@pytest.fixture
def damaged() -> SteDatabase:
    return with_failures()
