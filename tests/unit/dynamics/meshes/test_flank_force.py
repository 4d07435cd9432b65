"""Damping acts in contact only, in full under load, and never pulls."""

from __future__ import annotations

import numpy as np
import pytest
from geared_scenes import square_wave_table

from dynamics.meshes.flank_force import FlankLaws, flank_force
from dynamics.meshes.packed_tables import pack_tables

LAW = FlankLaws(pack_tables([square_wave_table()]), np.array([2000.0]), np.array([133.0]))


def test_in_full_contact_it_is_viscous():
    elastic = flank_force(LAW, 0, 0.1, 6e-6, 0.0, 0)[0]
    assert elastic > 133.0
    for rate in (-0.01, 0.02):
        assert flank_force(LAW, 0, 0.1, 6e-6, rate, 0)[0] == pytest.approx(elastic + 2000.0 * rate)


def test_out_of_contact_there_is_none():
    assert flank_force(LAW, 0, 0.1, -1e-9, 10.0, 0)[0] == 0.0


def test_it_never_pulls():
    rates = np.linspace(-50.0, 50.0, 101)
    for d in np.linspace(-1e-6, 8e-6, 50):
        forces = np.array([flank_force(LAW, 0, 0.3, d, rate, 0)[0] for rate in rates])
        assert np.all(forces >= 0.0)
        assert np.all(np.diff(forces) >= 0.0)  # damping takes energy at every rate


def test_derivatives_are_those_of_the_force():
    h = 1e-12
    for d, rate in ((0.2e-6, 0.01), (0.1e-6, -0.002), (6e-6, 0.05)):
        _, _, tangent, viscous, _ = flank_force(LAW, 0, 0.4, d, rate, 0)
        up, down = (flank_force(LAW, 0, 0.4, d + s, rate, 0)[0] for s in (h, -h))
        assert tangent == pytest.approx((up - down) / (2 * h), rel=1e-3)
        up, down = (flank_force(LAW, 0, 0.4, d, rate + s, 0)[0] for s in (1e-6, -1e-6))
        assert viscous == pytest.approx((up - down) / 2e-6, rel=1e-6)
