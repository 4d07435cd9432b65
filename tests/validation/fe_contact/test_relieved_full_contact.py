"""A spur pair with a long linear relief against full finite-element contact, where the relief begins.

The strip lies over the beginning of the relief of one pair and carries half the load: the local law is far
from its parabola there.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, SteDatabase, analyze

SOURCE = "CalculiX 2.20, 1.5 elements per Hertz half-width, plane strain, uncertainty 0.2 %"
# position by the driving gear, base pitches: STE, um, at 50, 100, 400 N m
AT_THE_KNEE = {50.0: (0.4921863, 3.77395), 100.0: (0.4921858, 6.30914), 400.0: (0.4921793, 20.91680)}
BESIDE_IT = {50.0: (0.25, 4.11104), 100.0: (0.25, 8.01536), 400.0: (0.25, 30.42931)}


@pytest.fixture(scope="module")
def database() -> SteDatabase:
    """30 um over the last 3.5 mm of roll, on both gears of the 20/20 pair."""
    plain = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    begins = math.hypot(plain.base_radius, plain.tip_roll_length - 3.5e-3)
    relief = FlankModification(tip_relief=30e-6, tip_relief_length=plain.tip_radius - begins)
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3, modification=relief)
    pair = GearPair(gear, gear, 80e-3)
    return analyze(pair, torques=list(AT_THE_KNEE), model="plane_strain", positions=128, receipt="minimal")


@pytest.mark.parametrize("torque", AT_THE_KNEE)
@pytest.mark.parametrize(
    ("name", "points", "target"), [("knee", AT_THE_KNEE, 0.7), ("beside", BESIDE_IT, 0.3)]
)
def test_the_strip_over_the_beginning_of_a_relief(database, torque, name, points, target, record_figure):
    position, ste = points[torque]
    found = float(database.curve(torque=torque, at=np.array([position])).ste[0])
    error = 100.0 * (found / (1e-6 * ste) - 1.0)
    record_figure(f"STE with a long relief, {name}, {torque:g} N m", error, f"within {target} %", "%", SOURCE)
    assert abs(error) < target
