"""Rating life under load cases: that of the bearing alone, linear damage, the cube of a ball's load."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, with_gear

from dynamics.bearings import BallBearing, Bushing, RollerBearing, RollingBearing
from dynamics.bearings.loaded_bearing import LoadedBearing
from dynamics.bearings.rating_life import rating_life
from dynamics.deflection import LoadCase, deflect, life_duration
from dynamics.deflection.bearing_loads import bearing_life

CAPACITY = 23400.0
BALL = BallBearing(8, 0.0115, 0.0435, clearance=5e-6)
ROLLERS = RollerBearing(
    count=14, diameter=0.009, length=0.0136, pitch_diameter=0.0535, contact_angle=0.3, profile="straight"
)
LOOSE = replace(ROLLERS, count=16, contact_angle=0.0, clearance=30e-6)
PLACES = 64  # around the circle, at which elements are taken on average
ROW = RollingBearing("left", "input", BALL, 0.0, dynamic_capacity=CAPACITY)


def on_rows(capacity=CAPACITY, row=BALL, preload=50.0):
    """A 20/20 pair whose gears sit between two rows on each shaft, which springs hold along its axis."""
    rows = tuple(
        RollingBearing(f"{shaft}.{end}", shaft, row, z, sign * preload, dynamic_capacity=capacity)
        for shaft in ("input", "output")
        for end, z, sign in (("left", 0.05, 1.0), ("right", 0.15, -1.0))
    )
    along = tuple(Bushing(f"{shaft}.along", shaft, 0.1, 0.0, 1e8) for shaft in ("input", "output"))
    scene = gear_pair_scene(spring_table(4e8))
    scene = with_gear(with_gear(scene, 0, position=0.1), 1, position=0.1)
    return replace(scene, bushings=along, rolling_bearings=rows)


def rows_of(case):
    return [load for load in case.bearings if not load.name.endswith("along")]


@pytest.mark.parametrize(("row", "preload"), [(BALL, 50.0), (LOOSE, 0.0)], ids=["preload", "clearance"])
def test_a_load_case_alone_has_the_life_of_the_bearing_under_its_load(row, preload):
    (case,) = deflect(on_rows(row=row, preload=preload), positions=3).cases
    loaded = LoadedBearing(row, copies=PLACES // row.count)
    assert case.status == "converged" and len(rows_of(case)) == 4
    for load in rows_of(case):
        d = loaded.displacement(load.force)
        expected = rating_life(row, loaded.evaluate(d).load, CAPACITY).revolutions
        assert np.hypot(*load.force[:2]) > 100.0
        assert load.rating_life == pytest.approx(expected, rel=1e-5)


def test_the_preload_of_a_row_counts():
    alone = replace(ROW, row=replace(BALL, clearance=0.0), axial_preload=500.0)
    loaded = LoadedBearing(alone.row, copies=8)
    at = loaded.evaluate(loaded.displacement((0.0, 0.0, 500.0, 0.0, 0.0)))
    expected = rating_life(alone.row, at.load, CAPACITY).revolutions
    assert bearing_life(alone, np.zeros(5)) == pytest.approx(expected, rel=1e-9)
    assert bearing_life(replace(alone, axial_preload=0.0), np.zeros(5)) == math.inf


@pytest.mark.parametrize(
    ("row", "exponent"),
    [(BALL, 3.0), (ROLLERS, 10.0 / 3.0)],
    ids=["balls", "rollers"],
)
def test_the_life_falls_with_the_power_of_the_element_load(row, exponent):
    # under thrust every element carries F / (Z sin a); of balls a grows with the load
    loaded, lives, elements = LoadedBearing(row, copies=8), [], []
    for thrust in (500.0, 1000.0):
        d = loaded.displacement((0.0, 0.0, thrust, 0.0, 0.0))
        lives.append(bearing_life(replace(ROW, row=row), d))
        elements.append(float(loaded.evaluate(d).load[0].sum()))
    assert lives[0] / lives[1] == pytest.approx((elements[1] / elements[0]) ** exponent, rel=1e-9)
    angle = [math.asin(thrust / (row.count * q)) for thrust, q in zip((500.0, 1000.0), elements, strict=True)]
    closed = (2.0 * math.sin(angle[0]) / math.sin(angle[1])) ** exponent
    assert lives[0] / lives[1] == pytest.approx(closed, rel=1e-9)
    assert 0.5 * 2.0**exponent < lives[0] / lives[1] <= 2.0**exponent * (1.0 + 1e-9)


def test_two_halves_of_a_case_are_the_case():
    whole = life_duration([3e8], [100.0], [1.0])
    assert whole == pytest.approx(2.0 * math.pi * 3e8 / 100.0)
    assert life_duration([3e8, 3e8], [100.0, 100.0], [0.5, 0.5]) == pytest.approx(whole)
    assert life_duration([3e8, 3e8], [100.0, 100.0], [7.0, 7.0]) == pytest.approx(whole)


def test_damage_adds_by_share_and_speed():
    lives, speed, share = (1e8, 4e9), (300.0, 100.0), (0.2, 0.8)
    damage = sum(q * n / (2.0 * math.pi * life) for life, n, q in zip(lives, speed, share, strict=True))
    assert life_duration(lives, speed, share) == pytest.approx(1.0 / damage)
    assert life_duration((1e8, math.inf), speed, share) == pytest.approx(
        life_duration((1e8,), (300.0,), (1.0,)) / 0.2
    )
    assert life_duration((math.inf,), (300.0,), (1.0,)) == math.inf
    assert life_duration((1e8,), (0.0,), (1.0,)) == math.inf


def test_without_a_capacity_no_life_is_known():
    cases = (LoadCase("light", factor=0.5), LoadCase("heavy"))
    found = deflect(on_rows(capacity=None), cases, 3)
    assert all(math.isnan(load.rating_life) for case in found.cases for load in rows_of(case))
    light, heavy = (rows_of(case)[0].rating_life for case in deflect(on_rows(), cases, 3).cases)
    assert 6.0 < light / heavy <= 9.0  # 8 but for the clearance
