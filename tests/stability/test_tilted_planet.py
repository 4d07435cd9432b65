"""A planet that tilts in its ring presses on one end of the face, far from where a guess puts the load."""

import numpy as np
import pytest

from fe_contact import Gear, InternalGearPair, RingGear, analyze

SHAPE = {"normal_module": 2e-3, "face_width": 20e-3}
PLANET_IN_RING = InternalGearPair(
    Gear(teeth=36, bore_diameter=30e-3, **SHAPE),
    RingGear(teeth=96, rim_diameter=212e-3, addendum_coefficient=0.9, **SHAPE),
    center_distance=60e-3,
)
TILTED = {"level": "draft", "positions": 64, "misalignments": [80e-6], "receipt": "minimal"}


@pytest.mark.law
def test_one_load_alone_is_solved_as_at_the_end_of_many():
    alone = analyze(PLANET_IN_RING, torques=[200.0], **TILTED)
    rising = analyze(PLANET_IN_RING, torques=[25.0, 50.0, 100.0, 150.0, 200.0], **TILTED)
    assert alone.n_failed == rising.n_failed == 0
    np.testing.assert_allclose(
        alone.static_transmission_error[:, 0], rising.static_transmission_error[:, -1], rtol=1e-8
    )
