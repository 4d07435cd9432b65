"""Levels of sound: their sums and weights, of orders and pressures, and their bands."""

import re
from pathlib import Path

import numpy as np
import pytest
from hulls import box
from wav_files import read_wav

from dynamics.acoustics import (
    Air,
    ElementalRadiators,
    LevelBand,
    OrderPower,
    Range,
    Recording,
    a_weighting,
    band_cases,
    errors_db,
    free_field_pressure,
    level_bands,
    modal_resistance,
    order_power,
    sound_power,
    sound_power_level,
    sound_pressure_level,
)
from dynamics.errors import InputError

# Levels: the table of IEC 61672-1, sums, the level of one watt.


TABLE = {10: -70.4, 31.5: -39.4, 63: -26.2, 125: -16.1, 250: -8.6, 500: -3.2, 1000: 0.0, 2000: 1.2}
TABLE |= {4000: 1.0, 8000: -1.1, 16000: -6.6, 20000: -9.3}


@pytest.mark.parametrize("nominal", TABLE)
def test_a_weighting_is_that_of_the_standard(nominal):
    """Its table is of the exact frequencies of base ten."""
    exact = 10.0 ** (round(10.0 * np.log10(nominal)) / 10.0)
    assert a_weighting(exact) == pytest.approx(TABLE[nominal], abs=0.051)


def test_one_picowatt_is_zero_decibels_and_one_watt_120():
    np.testing.assert_allclose(sound_power_level([1e-12, 1.0]), [0.0, 120.0], atol=1e-9)
    assert np.isfinite(sound_power_level(0.0))
    with pytest.raises(InputError, match="power"):
        sound_power_level([1.0, -1.0])


def test_one_watt_is_109_decibels_of_pressure_at_a_meter():
    """10 lg(1/(4 pi)) = -10.99 dB and 10 lg(rho c / 400) = 0.14 dB."""
    pressure = free_field_pressure(1.0, 1.0, 413.0)
    assert 20.0 * np.log10(pressure / 20e-6) == pytest.approx(120.0 - 10.992 + 0.139, abs=2e-3)
    assert free_field_pressure(1.0, 2.0, 413.0) == pytest.approx(0.5 * pressure)


# Bands of a level: monotone in the ranges, and coverage of random cases.


def resonance(values) -> float:
    """Level of an oscillator driven at 1.02 of its nominal frequency."""
    ratio = 1.02 / values["frequency"]
    return -10.0 * np.log10((1.0 - ratio**2) ** 2 + (2.0 * values["damping"] * ratio) ** 2)


def level_band(level, ranges) -> LevelBand:
    levels = np.array([[level(values)] for values in band_cases(ranges)])
    return level_bands(ranges, levels)[0]


DAMPING, ORDER_FREQUENCY = Range(0.005, 0.01, 0.02), Range(0.97, 1.0, 1.0)


def test_damping_at_resonance_moves_the_level_by_its_ratio():
    at = {"damping": DAMPING, "frequency": Range(1.02, 1.02, 1.02)}
    band = level_band(resonance, at)
    assert band.nominal == pytest.approx(-20.0 * np.log10(0.02))
    near, low, high, beyond = (
        20.0 * np.log10(DAMPING.at(q) / DAMPING.nominal) for q in (0.02, 0.08, 0.92, 0.98)
    )
    assert near < band.nominal - band.high < low
    assert high < band.nominal - band.low < beyond


def test_a_wider_range_never_narrows_the_band():
    low, high = np.inf, -np.inf
    for width in (0.0, 0.2, 0.5, 1.0):
        span = Range(0.01 - 0.005 * width, 0.01, 0.01 + 0.01 * width)
        band = level_band(resonance, {"damping": span, "frequency": Range(1.0, 1.0, 1.0)})
        assert band.low <= low
        assert band.high >= high
        low, high = band.low, band.high
    wider = band.with_error("boundary elements", 1.0, 2.0)
    assert wider.low < band.low < band.nominal == wider.nominal < band.high < wider.high


RANGES = {
    name: Range(-size, 0.0, size) for name, size in zip("abcde", (1.0, 2.0, 3.0, 2.0, 1.5), strict=True)
}
LAWS = {
    "sum": lambda values: sum(values.values()),
    "product": lambda values: values["a"] * values["b"] + 0.1 * values["c"],
    "extreme": lambda values: 2.0 * values["e"] - (values["c"] - 0.5) ** 2,
}


@pytest.mark.parametrize("level", LAWS.values(), ids=LAWS)
def test_a_band_of_several_guesses_holds_nine_of_ten_cases_and_no_more(level):
    band = level_band(level, RANGES)
    rng = np.random.default_rng(10)
    cases = level({name: rng.uniform(span.low, span.high, 20_000) for name, span in RANGES.items()})
    outside = [np.mean(cases < band.low), np.mean(cases > band.high)]
    np.testing.assert_allclose(outside, 0.05, atol=0.03)  # of 64 cases


def test_the_nominal_level_lies_inside_where_hardly_a_case_is_as_loud():
    band = level_band(lambda values: -abs(values["c"]), RANGES)
    assert band.high == band.nominal == 0.0
    assert band.low == pytest.approx(-0.95 * RANGES["c"].high, rel=0.05)


def test_contributions_add_up_in_squares_to_the_band():
    """A guess that changes nothing contributes nothing; what acts jointly has its own part."""
    band = level_band(LAWS["product"], RANGES)
    assert band.above["a"] == band.below["b"] == band.above["d"] == 0.0
    assert band.below["jointly"] > 1.0
    whole = level_band(LAWS["sum"], RANGES)
    assert whole.above["jointly"] == 0.0
    assert whole.above["c"] == pytest.approx(3.0 * whole.above["a"])


def test_equal_ranges_give_equal_bits():
    first, second = (level_band(LAWS["product"], RANGES) for _ in range(2))
    assert first == second


def test_a_range_without_its_nominal_value_is_refused():
    with pytest.raises(InputError, match="nominal"):
        Range(0.1, 0.05, 0.2)
    with pytest.raises(InputError, match="model"):
        level_band(resonance, {"damping": DAMPING, "frequency": ORDER_FREQUENCY}).with_error(
            "model", -1.0, 0.0
        )


# Sound power of orders over a run: sums, weighting, third octaves, quadratic forms of modes.


SPEED = np.linspace(200.0, 500.0, 30)
FREQUENCY = np.array([1.0, 2.0, 3.0])[:, None] * SPEED
POWER = np.random.default_rng(5).uniform(1e-9, 1e-6, FREQUENCY.shape)


def test_levels_are_those_of_the_powers():
    orders = OrderPower(FREQUENCY, POWER)
    np.testing.assert_allclose(orders.level, 10.0 * np.log10(POWER / 1e-12))
    np.testing.assert_allclose(orders.weighted_level - orders.level, a_weighting(FREQUENCY), atol=1e-9)
    np.testing.assert_allclose(orders.total_level, 10.0 * np.log10(POWER.sum(axis=0) / 1e-12))
    assert np.all(orders.total_weighted_level >= orders.weighted_level.max(axis=0))


def test_third_octaves_hold_every_order_once():
    center, power = OrderPower(FREQUENCY, POWER).third_octaves()
    np.testing.assert_allclose(power.sum(axis=0), POWER.sum(axis=0), rtol=1e-12)
    assert list(center) == [200.0, 250.0, 315.0, 400.0, 500.0, 630.0, 800.0, 1000.0, 1250.0, 1600.0]
    tone, alone = OrderPower(np.array([[890.0, 892.0]]), np.array([[1.0, 1.0]])).third_octaves()
    np.testing.assert_array_equal(alone, [[1.0, 0.0], [0.0, 1.0]])  # 891.25 Hz parts 800 and 1000
    assert list(tone) == [800.0, 1000.0]


def test_modes_of_a_run_up_radiate_as_their_sum():
    hull, model, air = box((0.3, 0.2, 0.2), (5, 4, 4)), ElementalRadiators(), Air()
    shapes = np.stack([np.ones(len(hull.areas)), hull.centers[:, 0], hull.normals[:, 1]], axis=1)
    made = modal_resistance(model, hull, np.array([200.0, 400.0, 600.0]), shapes, air)
    velocity = np.random.default_rng(6).normal(size=(2, 3, 3)) * (1.0 + 0.5j)
    frequency = np.array([[200.0, 400.0, 600.0], [400.0, 400.0, 600.0]])
    whole = order_power(made, frequency, velocity)
    alone = sound_power(model, hull, 400.0, shapes @ velocity[1, 0], air)
    assert whole.power[1, 0] == pytest.approx(alone, rel=1e-9)
    np.testing.assert_allclose(
        order_power(made, frequency, 3.0 * velocity).power, 9.0 * whole.power, rtol=1e-9
    )


def test_what_is_no_power_over_frequency_is_refused():
    with pytest.raises(InputError, match="power"):
        OrderPower(FREQUENCY, POWER[:-1])
    with pytest.raises(InputError, match="above 0 Hz"):
        OrderPower(0.0 * FREQUENCY, POWER)
    with pytest.raises(InputError, match="at least 0 W"):
        OrderPower(FREQUENCY, -POWER)


# Level of a recorded sound pressure: calibrator, sums, A-weighting of tones, what is no pressure.


RATE = 48_000
TIME = np.arange(RATE) / RATE


def tone(frequency: float, level: float) -> np.ndarray:
    return np.asarray(np.sqrt(2.0) * 20e-6 * 10.0 ** (level / 20.0) * np.sin(2.0 * np.pi * frequency * TIME))


def level(samples: np.ndarray, *, weighted: bool = False) -> float:
    return sound_pressure_level(Recording(samples, RATE, "sound pressure", "Pa"), weighted=weighted)


def test_a_calibrator_of_1_pa_has_94_db_weighted_or_not():
    samples = np.sqrt(2.0) * np.sin(2.0 * np.pi * 1000.0 * TIME)
    assert level(samples) == pytest.approx(93.98, abs=0.005)
    assert level(samples, weighted=True) == pytest.approx(93.98, abs=0.005)


@pytest.mark.parametrize("frequency", [50.0, 100.0, 4000.0])
def test_a_tone_is_weighted_by_its_frequency(frequency):
    expected = 80.0 + float(a_weighting(frequency))
    assert level(tone(frequency, 80.0), weighted=True) == pytest.approx(expected, abs=1e-6)


def test_two_equal_tones_have_3_db_more():
    assert level(tone(300.0, 60.0) + tone(700.0, 60.0)) == pytest.approx(
        60.0 + 10.0 * np.log10(2.0), abs=1e-6
    )


@pytest.mark.parametrize("samples", [999, 1000])
def test_it_is_that_of_the_mean_square(samples):
    noise = np.random.default_rng(1).normal(size=samples)
    assert level(noise) == pytest.approx(10.0 * np.log10(np.mean(noise**2) / 4e-10), abs=1e-9)


def test_silence_has_a_level_and_a_force_has_none():
    assert level(np.zeros(100)) == -200.0
    with pytest.raises(InputError, match="that of a sound pressure"):
        sound_pressure_level(Recording(TIME, RATE, "bearing force", "N"))


# The page on sound power: its example runs, its closed forms are those of the library.


PAGE = Path(__file__).parents[4] / "docs" / "theory" / "sound-power.md"


def test_the_examples_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for script in re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL):
        exec(compile(script, str(PAGE), "exec"), names)
    assert 0.0 < names["radiation"].metadata.interpolation_error < 0.3
    assert "[" in capsys.readouterr().out
    assert read_wav("run-up.wav").peak == pytest.approx(names["heard"].peak)


def test_the_errors_it_states_are_those_of_the_library():
    text = " ".join(PAGE.read_text("utf-8").split())
    erp = "equivalent_radiated_power"
    assert f"At ka = 1.83 equivalent radiated power is {errors_db(1.83)[erp][0]:.1f} dB too loud" in text
    assert (
        f"at ka = 0.5 {errors_db(0.5)[erp][0]:.0f} dB for n = 0 and {errors_db(0.5)[erp][1]:.0f} dB" in text
    )
    assert f"{-errors_db(0.01)['monopoles'][1]:.1f} dB low for n = 1" in text
