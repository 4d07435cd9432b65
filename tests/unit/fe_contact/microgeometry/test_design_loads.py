"""Loads with a misalignment each: what is refused, and which further torques and table they lead to."""

from __future__ import annotations

import numpy as np

from fe_contact.microgeometry.confirmation import DesignLoads, _misalignment_axis, _on_axis

TORQUES = [100.0, 200.0, 200.0, 400.0]
SKEWS = [4e-6, 8e-6, -2e-6, 20e-6]


def test_one_misalignment_is_that_of_every_load() -> None:
    for one in (8e-6, [8e-6], np.array(8e-6)):
        assert DesignLoads.of([100.0, 300.0], one).misalignment.tolist() == [8e-6, 8e-6]


def test_further_torques_have_misalignments_between_those_of_their_neighbors() -> None:
    loads, own = DesignLoads.of(TORQUES, SKEWS).with_torques([50.0, 150.0, 200.0, 300.0, 500.0])
    assert loads.torque.tolist() == [50.0, 100.0, 150.0, 200.0, 200.0, 300.0, 400.0, 500.0]
    expected = [4e-6, 4e-6, 6e-6, 8e-6, -2e-6, 9e-6, 20e-6, 20e-6]
    np.testing.assert_allclose(loads.misalignment, expected, rtol=1e-12)
    assert own.tolist() == [1, 3, 4, 6]
    again, _ = DesignLoads.of(TORQUES, SKEWS).with_torques(loads.torque)
    np.testing.assert_array_equal(again.misalignment, loads.misalignment)


def test_a_table_has_every_misalignment_once() -> None:
    """A sum and the number it should be differ in the last bit: an axis through both would have no slope."""
    skews, away = np.array([4.1e-6, 12.3e-6]), np.array([8.2e-6, -8.2e-6])
    assert skews[0] + away[0] != skews[1]
    axis = _misalignment_axis(skews, away)
    np.testing.assert_allclose(axis, [-4.1e-6, 4.1e-6, 12.3e-6, 20.5e-6], rtol=1e-12)
    assert set(_on_axis(axis, skews + away[:, None]).ravel()) <= set(axis)
    assert _on_axis(axis, np.array([[5e-6]])) == 5e-6  # between two of them
