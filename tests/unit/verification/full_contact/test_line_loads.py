"""Line loads of full contact: forces on hats become loads whose integral is the force."""

import numpy as np
import pytest

from verification.full_contact.line_load import LineLoad, line_loads


def test_a_linear_load_comes_back_from_the_forces_on_its_hats():
    stations = np.array([-4.0, -3.9, -3.0, 0.0, 4.0])
    width = 0.5 * (np.append(np.diff(stations), 0.0) + np.insert(np.diff(stations), 0, 0.0))
    forces = (7.0 - stations) * width
    across = np.array([0.25, 0.75])  # hats side by side share the force of a station
    face, force = np.tile(stations, 2), np.outer(across, forces).ravel()
    ahead = np.repeat([-1, 0], face.size)
    first, second = line_loads(ahead, np.tile(face, 2), np.concatenate([force, 2.0 * force]))
    assert (first.ahead, second.ahead) == (-1, 0)
    assert first.load == pytest.approx(7.0 - stations, rel=1e-12)
    assert second.load == pytest.approx(2.0 * first.load, rel=1e-12)


@pytest.mark.parametrize("length", [0.1, 1.0, 5.0])
def test_the_largest_mean_of_a_tent_is_about_its_top(length):
    tent = LineLoad(0, np.array([-3.0, 1.0, 5.0]), np.array([0.0, 8.0, 0.0]))
    assert tent.largest_mean(length) == pytest.approx(8.0 - 0.5 * length, rel=1e-4)
