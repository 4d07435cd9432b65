"""Orders of a recording: amplitudes of known tones, nothing folded onto them, noise found and removed."""

import numpy as np
import pytest

from dynamics.errors import InputError
from dynamics.orders import PositionedSignal, Waterfall, order_power, recorded_waterfall, shared_frequencies

RATE = 8192.0
TIME = np.arange(int(8.0 * RATE)) / RATE
FREQUENCY = 20.0 + 20.0 * TIME  # 20 to 180 Hz
POSITION = 20.0 * TIME + 10.0 * TIME**2
AMPLITUDES = {1: 1.0, 2: 0.01, 3: 0.3, 5: 0.1, 8: 0.03}
OVERLAP = 0.75
SPAN = (30.0, 170.0)


def signal(*further: np.ndarray) -> PositionedSignal:
    orders = sum(size * np.cos(2 * np.pi * k * POSITION + k) for k, size in AMPLITUDES.items())
    return PositionedSignal(TIME, POSITION, np.asarray(sum(further, orders)), "m/s²")


def test_orders_of_a_run_up_keep_their_amplitude():
    blocks = recorded_waterfall(signal(), 16, 8, overlap=OVERLAP)
    for order, size in AMPLITUDES.items():
        np.testing.assert_allclose(blocks.cut(order), size, rtol=2e-3, atol=2e-4)
    np.testing.assert_allclose(blocks.cut(4), 0.0, atol=2e-4)
    np.testing.assert_allclose(blocks.mesh_frequency, np.interp(blocks.time, TIME, FREQUENCY), rtol=2e-3)


def test_a_tone_far_above_the_orders_does_not_fold_onto_them():
    """Where the mesh is slow the tone is at order 160: of 64 samples a pitch it would fold onto the first.

    What is left is the error of the interpolation, 0.4 % of a tone at 2.56 samples a period.
    """
    tone = 3.0 * np.cos(2 * np.pi * 3200.0 * TIME)
    loud, quiet = (recorded_waterfall(one, 16, 8, overlap=OVERLAP) for one in (signal(tone), signal()))
    assert np.abs(loud.amplitude[:, 1:] - quiet.amplitude[:, 1:]).max() < 0.004 * 3.0


def test_noise_is_removed_from_the_power_of_an_order_within_its_error():
    """Over 24 draws the mean is right, and two standard deviations hold 9 draws in 10."""
    whole, inside = [], 0
    for seed in range(24):
        noise = 0.5 * np.random.default_rng(seed).standard_normal(TIME.size)
        blocks = recorded_waterfall(signal(noise), 16, 8, overlap=OVERLAP)
        power = order_power(blocks, 8, SPAN, OVERLAP)
        whole.append(power.power)
        inside += abs(power.power - 0.5 * AMPLITUDES[8] ** 2) <= 2.0 * power.deviation
    deviation = float(np.std(whole)) / np.sqrt(len(whole))
    assert abs(np.mean(whole) - 0.5 * AMPLITUDES[8] ** 2) < 3.0 * deviation + 1e-3 * np.mean(whole)
    assert inside >= 21
    assert power.noise > 0.05 * power.power  # it would be seen if it stayed


def test_an_order_that_is_not_there_is_not_seen():
    noise = 0.1 * np.random.default_rng(3).standard_normal(TIME.size)
    blocks = recorded_waterfall(signal(noise), 16, 8, overlap=OVERLAP)
    seen = {k: order_power(blocks, k, SPAN, OVERLAP).is_seen for k in (1, 3, 4, 5, 7)}
    assert seen == {1: True, 3: True, 4: False, 5: True, 7: False}


def test_a_power_that_follows_the_speed_is_averaged_over_it_whatever_the_blocks():
    """The mean of (1 + f / 100)^2 / 2 over the span, from blocks that start elsewhere and lie elsewhere."""
    size = 1.0 + FREQUENCY / 100.0
    tone = np.asarray(size * np.cos(2 * np.pi * POSITION))
    low, high = 1.0 + np.array(SPAN) / 100.0
    mean = 0.5 * (high**3 - low**3) / 3.0 / (high - low)
    for first, pitches in ((0, 16), (700, 16), (0, 23)):
        part = PositionedSignal(TIME[first:], POSITION[first:], tone[first:], "N")
        blocks = recorded_waterfall(part, pitches, 8, overlap=OVERLAP)
        power = order_power(blocks, 1, SPAN, OVERLAP)
        assert power.power == pytest.approx(mean, rel=2e-3)
        assert abs(power.power - mean) < 2.0 * power.deviation + 1e-3 * mean


def test_two_signals_share_the_speeds_that_both_pass():
    def blocks(low, high):
        frequency = np.linspace(high, low, 9)
        zeros = np.zeros((9, 3))
        return Waterfall(np.arange(3.0), np.arange(9.0), frequency, zeros, zeros[:, 0], "N", 1.5)

    assert shared_frequencies(blocks(10.0, 100.0), blocks(30.0, 200.0)) == (30.0, 100.0)
    assert shared_frequencies(blocks(10.0, 20.0), blocks(30.0, 200.0)) is None
    assert shared_frequencies(blocks(50.0, 50.0), blocks(50.4, 50.4)) == (50.0, 50.4)


def test_what_cannot_be_analyzed_is_refused():
    with pytest.raises(InputError, match="highest"):
        recorded_waterfall(signal(), 16, 20)
    with pytest.raises(InputError, match="base pitches"):
        recorded_waterfall(signal(), 4000, 8)
    with pytest.raises(InputError, match="rising"):
        PositionedSignal(TIME, -POSITION, POSITION, "m/s²")
