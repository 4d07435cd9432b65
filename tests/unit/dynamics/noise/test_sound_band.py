"""Bands of sound power: zero without ranges, monotone in them, closed form of damping, blind coverage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from varied_housing import (
    FINE,
    MESH,
    blind_levels,
    covered,
    meshed,
    sound_model,
    undamped_elsewhere,
)

from dynamics.acoustics import Range
from dynamics.errors import InputError
from dynamics.housings import reduced_housing
from dynamics.noise import GUESSES, forced_power, sound_band
from dynamics.noise.sound_band import USUAL_RANGES, missed_between

SPEED = np.geomspace(60.0, 300.0, 24)
MESH_ERROR = Range(0.945, 1.0, 1.0)
"""Of the meshed housing, by its frequencies on a mesh 1.5 times as coarse: 8 % higher."""
NONE = {name: Range(1.0, 1.0, 1.0) for name in GUESSES}


@pytest.fixture(scope="module")
def model():
    return sound_model(reduced_housing(meshed()))


def bands_of(band):
    return (band.largest_total, *band.largest, *band.there, *band.total)


def test_without_ranges_only_modes_and_speeds_are_uncertain(model):
    band = sound_band(model, SPEED, 4, NONE)
    assert set(band.largest_total.above) == {*GUESSES, "jointly", "mode_number", "speed_steps"}
    for each in bands_of(band):
        assert all(each.below[name] == each.above[name] == 0.0 for name in (*GUESSES, "jointly"))
        assert each.below["mode_number"] == each.above["mode_number"]
    assert max(each.below["mode_number"] for each in band.largest) > 0.01


@pytest.mark.law
def test_a_wider_range_never_narrows_the_band(model):
    before = [(np.inf, -np.inf)] * 100
    for width in (0.0, 0.3, 1.0):
        usual = USUAL_RANGES["housing_damping"]
        span = Range(1.0 + width * (usual.low - 1.0), 1.0, 1.0 + width * (usual.high - 1.0))
        band = sound_band(model, SPEED, 3, NONE | {"housing_damping": span}, steps=3)
        now = [(each.low, each.high) for each in (band.largest_total, *band.largest)]
        for (low, high), (former_low, former_high) in zip(now, before, strict=False):
            assert low <= former_low
            assert high >= former_high
        before = now
    assert before[0][1] - before[0][0] > 3.0


def test_a_resonance_that_only_the_housing_damps_falls_by_the_ratio():
    """The level at a resonance falls by 20 lg of the ratio, with the whole scene about the housing."""
    model = undamped_elsewhere()
    coarse = np.linspace(60.0, 140.0, 400)
    order, power = forced_power(model, coarse, 1)
    near = coarse[int(np.argmax(power.power[0]))]
    fine = np.linspace(0.99 * near, 1.01 * near, 400)
    ranges = {"housing_damping": Range(0.5, 1.0, 2.0)}
    band = sound_band(model, fine, 1, ranges, steps=2).largest[0]
    assert order.tolist() == [1.0]
    assert band.above["housing_damping"] == pytest.approx(20.0 * np.log10(2.0), abs=0.1)
    assert band.below["housing_damping"] == pytest.approx(20.0 * np.log10(2.0), abs=0.1)


@pytest.mark.law
@pytest.mark.parametrize(
    ("speeds", "mounts", "cases"), [(24, 1, 20), pytest.param(135, 20, 200, marks=pytest.mark.nightly)]
)
def test_the_band_holds_nine_of_ten_blind_variations(speeds, mounts, cases):
    """A finer mesh, more modes, other mounts, dampings and bearings: none of them made the band."""
    model = sound_model(reduced_housing(meshed(MESH)))
    speed = np.geomspace(60.0, 300.0, speeds)
    band = sound_band(model, speed, 4, USUAL_RANGES | {"housing_frequency": MESH_ERROR})
    shares = covered(band, blind_levels(band, speed, FINE, mounts, cases))
    assert shares.largest_total >= 0.9
    assert np.all(shares.largest >= 0.9)
    assert np.all(shares.there >= 0.9)
    assert np.mean(shares.total) >= 0.9


def test_a_peak_between_speeds_is_seen_by_its_flanks():
    speed = np.linspace(0.9, 1.1, 41)
    for center, damping in ((1.002, 0.004), (0.9975, 0.01), (1.0, 0.003)):
        power = 1.0 / ((speed - center) ** 2 + damping**2)
        missed = 10.0 * np.log10(damping**-2 / power.max())
        assert missed_between(speed, power) == pytest.approx(missed, abs=1e-6)
    assert missed_between(speed, speed) == 0.0
    assert missed_between(speed[:1], speed[:1]) == 0.0


def test_an_alternative_counts_by_its_difference(model):
    louder = replace(model.resistance["case"], matrix=2.0 * model.resistance["case"].matrix)
    other = replace(model, resistance={"case": louder})
    band = sound_band(model, SPEED[:6], 2, NONE, joint=0, alternatives={"radiation_model": other})
    for each in bands_of(band):
        assert each.above["radiation_model"] == pytest.approx(10.0 * np.log10(2.0))
        assert each.below["radiation_model"] == each.above["radiation_model"]


def test_no_other_parameter_is_varied(model):
    with pytest.raises(InputError, match="ranges"):
        sound_band(model, SPEED, 2, {"color": Range(1.0, 1.0, 1.0)})
    held = replace(model.housings["case"], mount_stiffness=None, mount_damping=None)
    fixed = replace(model, housings={"case": held})
    band = sound_band(fixed, SPEED[:3], 2, {"mount_stiffness": Range(0.5, 1.0, 2.0)})
    assert "mount_stiffness" not in band.largest_total.above
