"""An elastic ring against plane finite elements with all teeth, by gmsh and scikit-fem alone."""

import math

import numpy as np
import pytest
from toothed_ring import ToothedRing

from dynamics.elastic_ring.ring_compliance import HeldRing, Port
from dynamics.elastic_ring.ring_modes import ring_modes
from dynamics.elastic_ring.ring_support import RingSupport
from fe_contact.geometry import RingGear
from lineofaction.gearbox.studies.elastic_ring.run import MODE_ERROR, MODEL_ERROR, rim_of

PRESSURE_ANGLE = math.radians(20.0)
pytestmark = pytest.mark.nightly


def gear_of(rim: float) -> RingGear:
    """Return a ring gear of 60 teeth with a rim of so many modules below its teeth."""
    root = 62.5e-3
    return RingGear(60, 2e-3, ToothedRing.width, 2.0 * (root + rim * 2e-3), addendum_coefficient=0.85)


def elements_of(gear: RingGear) -> ToothedRing:
    return ToothedRing(gear.root_radius, 0.5 * gear.rim_diameter, gear.teeth, gear.normal_module)


@pytest.mark.parametrize("rim", [3.0, 6.0, 12.0])
@pytest.mark.parametrize(("lugs", "half_lug"), [(6, 1.0), (8, 2.0)])
def test_what_a_ring_adds_to_a_table_is_within_its_error(rim, lugs, half_lug):
    gear, stiffness = gear_of(rim), 3e8
    angle, radius, added = elements_of(gear).added(
        np.arange(12) * 5, lugs, stiffness, PRESSURE_ANGLE, math.radians(half_lug)
    )
    held = HeldRing(rim_of(gear), RingSupport(lugs, 0.0, stiffness, stiffness))
    mesh = Port(angle, radius, math.sin(PRESSURE_ANGLE), math.cos(PRESSURE_ANGLE))
    ring = held.added_compliance(mesh)
    assert np.diag(ring) == pytest.approx(np.diag(added), rel=MODEL_ERROR)
    assert np.abs(ring - added).max() < MODEL_ERROR * np.diag(added).max()


@pytest.mark.parametrize("rim", [3.0, 6.0, 12.0])
def test_free_modes_are_within_their_error(rim):
    gear = gear_of(rim)
    modes = ring_modes(rim_of(gear), RingSupport(), 11).frequency[3:]
    assert modes == pytest.approx(elements_of(gear).free_modes()[:8], rel=MODE_ERROR)
