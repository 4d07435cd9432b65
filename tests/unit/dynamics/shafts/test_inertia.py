"""Inertia of cylinders against the closed forms, by subtraction and by slicing."""

from __future__ import annotations

import math

import pytest

from dynamics.errors import InputError
from dynamics.shafts import Inertia, hollow_cylinder


def test_a_solid_steel_cylinder():
    part = hollow_cylinder(0.1, 0.2, density=7850.0)
    mass = 7850.0 * math.pi * 0.05**2 * 0.2
    assert part.mass == pytest.approx(mass)
    assert part.polar == pytest.approx(0.5 * mass * 0.05**2)
    assert part.transverse == pytest.approx(mass * (0.05**2 / 4 + 0.2**2 / 12))


def test_a_bore_takes_away_its_own_cylinder():
    hollow, solid, core = (hollow_cylinder(*a) for a in ((0.1, 0.03, 0.04), (0.1, 0.03), (0.04, 0.03)))
    for name in ("mass", "polar", "transverse"):
        assert getattr(hollow, name) == pytest.approx(getattr(solid, name) - getattr(core, name))


@pytest.mark.parametrize(
    "sizes", [(0.0, 0.1, 0.0), (0.1, -0.1, 0.0), (0.1, 0.1, 0.1), (0.1, 0.1, -0.01), (math.nan, 0.1, 0.0)]
)
def test_impossible_sizes_are_refused(sizes):
    with pytest.raises(InputError):
        hollow_cylinder(*sizes)


def test_negative_inertia_is_refused():
    with pytest.raises(InputError, match=r"^polar"):
        Inertia(1.0, -1e-9, 0.0)
