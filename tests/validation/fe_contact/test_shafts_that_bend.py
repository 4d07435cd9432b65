"""Shafts that bend, through the whole analysis: what they shift and tilt, and in proportion to what."""

import dataclasses

import numpy as np
import pytest
from spur_gears import GEAR

from fe_contact import GearPair, Shaft, SteDatabase, analyze
from fe_contact.effects.shaft_compliance import SeatCompliance

pytestmark = pytest.mark.usefixtures("coarse_sectors")

SHAFT = Shaft(length=0.2, diameter=0.04, position=0.1, bearing_stiffness=4e8)
FORCES = np.array([500.0, 4000.0])


def table(*shafts: Shaft | None, **options: object) -> SteDatabase:
    asked = {
        "normal_forces": FORCES,
        "level": "draft",
        "positions": 12,
        "model": "3d",
    }
    return analyze(GearPair(GEAR, GEAR, 80e-3, shafts=shafts), **asked | options)


def test_a_shaft_under_the_middle_shifts_the_whole_curve_by_its_deflection():
    """No tilt: each curve moves by the beam's deflection under its load, and the ripple stays."""
    choice = {"effects": {"corner_contact": "off"}}
    rigid = table(None, None, **choice).static_transmission_error
    bent = table(SHAFT, None, **choice).static_transmission_error
    shift = SeatCompliance.of_shaft(SHAFT).translation * FORCES
    assert (bent - rigid)[:, :, 0, 0] == pytest.approx(np.tile(shift, (12, 1)), rel=1e-6, abs=0.0)


def test_tilt_stays_in_proportion_to_the_load_where_misalignment_fades():
    """Hertz apart, the load of a shaft that tilts keeps its place; misalignment is pressed out by load."""
    off_center = dataclasses.replace(SHAFT, position=0.05)
    tilting = table(off_center, None).face_centroid[:, :, 0, 0].mean(axis=0)
    skewed = table(None, None, misalignments=[8e-6]).face_centroid[:, :, 0, 0].mean(axis=0)
    assert np.all(tilting < -0.3e-3), "the end nearer to the bearing carries more"
    assert tilting[1] / tilting[0] == pytest.approx(1.0, abs=0.15)
    assert skewed[1] / skewed[0] < 0.4


def test_the_same_shafts_on_both_sides_of_the_pair_mirror_the_load():
    near, far = (dataclasses.replace(SHAFT, position=place) for place in (0.06, 0.14))
    first, second = (table(shaft, shaft) for shaft in (near, far))
    assert second.static_transmission_error == pytest.approx(
        first.static_transmission_error, rel=1e-9, abs=0.0
    )
    assert second.face_centroid == pytest.approx(-first.face_centroid, rel=1e-6, abs=1e-12)
    assert np.abs(first.face_centroid).max() > 1e-4
