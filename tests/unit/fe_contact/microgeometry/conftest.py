"""A spur pair in the plane, whose gears are condensed once."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from fe_contact import FlankModification, Gear, GearPair


@pytest.fixture(scope="session")
def compliances(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("compliances")


@pytest.fixture(scope="session")
def pair() -> GearPair:
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    return GearPair(gear, gear, 80e-3)


@pytest.fixture(scope="session")
def long_reliefs(pair: GearPair) -> GearPair:
    """The same pair with room for tip reliefs down to where a single pair of teeth carries."""
    gear, path = pair.pinion, pair.path_of_contact
    single = math.hypot(gear.base_radius, path.start + path.base_pitch)
    length = FlankModification(tip_relief_length=gear.tip_radius - single)
    return replace(pair, pinion=replace(gear, modification=length), wheel=replace(gear, modification=length))
