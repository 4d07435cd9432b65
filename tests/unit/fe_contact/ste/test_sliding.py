"""Where the load slides: signs, lengths, and the mean over the lines of contact of helical teeth."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from sliced_face import sliced_database

from fe_contact.ste.extraction import SMOOTHING, _sliding


def test_a_single_pair_slides_by_its_distance_from_the_pitch_point():
    """It approaches before x = 0 (pair -1 just before the next whole pitch) and recedes after."""
    database = sliced_database((0.0,), (0.0,), positions=40)
    for pair, sign in ((0, 1.0), (-1, -1.0)):
        direction, arm = (a[:, 0, 0, 0] for a in _sliding(replace(database, pair=np.array([pair]))))
        y = (database.position + pair) * database.facts.base_pitch
        far = np.abs(y) > 0.1 * database.facts.base_pitch
        np.testing.assert_allclose(direction[far], sign, atol=0.5 * (SMOOTHING / 0.1) ** 2)
        np.testing.assert_allclose(arm[far], np.abs(y[far]), rtol=0.5 * (SMOOTHING / 0.1) ** 2)
        assert np.all(arm >= 0.0)
    assert _sliding(replace(database, pair=np.array([0])))[0][0, 0, 0, 0] == 0.0  # at the pitch point


@pytest.mark.parametrize("angle", [1e-4, 0.2, 0.5])
def test_helical_teeth_have_the_mean_over_their_line_of_contact(angle):
    database = sliced_database((0.0,), (0.0,), positions=8)
    facts = replace(database.facts, base_helix_angle=angle, helix_hand=1)
    torque = database.torque * math.cos(angle)
    found = _sliding(replace(database, facts=facts, torque=torque, pair=np.array([0])))
    along = np.linspace(-0.5, 0.5, 20001) * facts.face_width * math.tan(angle)
    y = database.position[:, None] * facts.base_pitch + along
    sign = y / np.sqrt(y**2 + (SMOOTHING * facts.base_pitch) ** 2)
    for values, exact in zip(found, (sign, sign * y), strict=True):
        mean = np.trapezoid(exact, dx=1.0 / (along.size - 1), axis=1)
        np.testing.assert_allclose(values[:, 0, 0, 0], mean, rtol=1e-5, atol=1e-5 * np.abs(mean).max())
