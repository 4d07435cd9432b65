"""Base pitches by which effects are estimated where teeth differ: few, with both gears at all angles."""

import math

import numpy as np
import pytest

from fe_contact.effects.influence.estimated_curve import MAX_PITCHES, spread_pitches

PAIRS = [(23, 67), (20, 64), (32, 96), (34, 55), (17, 23), (53, 102), (61, 125), (199, 500)]
"""Teeth: hunting, with common factors, of Fibonacci, many."""


@pytest.mark.law
@pytest.mark.parametrize("teeth", PAIRS, ids=lambda pair: "/".join(map(str, pair)))
def test_run_outs_and_their_beat_are_seen_whole_and_have_no_mean(teeth):
    pitch = spread_pitches(teeth)
    assert len(set(pitch)) == len(pitch) == MAX_PITCHES
    assert np.all((pitch >= 0) & (pitch < math.lcm(*teeth)))
    rates = [1.0 / number for number in teeth] + [2.0 / number for number in teeth]
    one, other = rates[:2]
    for rate in (*rates, one + other, one - other):
        wave = np.exp(2j * np.pi * pitch * rate)
        assert abs(wave.mean()) < 0.12, rate  # of as many drawn at random 0.18
        assert np.ptp(wave.real) > 1.9 and np.ptp(wave.imag) > 1.9, rate


@pytest.mark.parametrize(("teeth", "number"), [((1, 1), 1), ((25, 1), 25), ((21, 21), 21), ((4, 6), 12)])
def test_short_periods_are_taken_whole(teeth, number):
    assert spread_pitches(teeth).tolist() == list(range(number))
