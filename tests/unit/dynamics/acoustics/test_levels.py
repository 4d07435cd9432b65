"""Levels: the table of IEC 61672-1, sums, the level of one watt."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.acoustics import a_weighting, free_field_pressure, sound_power_level
from dynamics.errors import InputError

TABLE = {10: -70.4, 31.5: -39.4, 63: -26.2, 125: -16.1, 250: -8.6, 500: -3.2, 1000: 0.0, 2000: 1.2}
TABLE |= {4000: 1.0, 8000: -1.1, 16000: -6.6, 20000: -9.3}


@pytest.mark.parametrize("nominal", TABLE)
def test_a_weighting_is_that_of_the_standard(nominal: float) -> None:
    """Its table is of the exact frequencies of base ten."""
    exact = 10.0 ** (round(10.0 * np.log10(nominal)) / 10.0)
    assert a_weighting(exact) == pytest.approx(TABLE[nominal], abs=0.051)


def test_one_picowatt_is_zero_decibels_and_one_watt_120() -> None:
    np.testing.assert_allclose(sound_power_level([1e-12, 1.0]), [0.0, 120.0], atol=1e-9)
    assert np.isfinite(sound_power_level(0.0))
    with pytest.raises(InputError, match="power"):
        sound_power_level([1.0, -1.0])


def test_one_watt_is_109_decibels_of_pressure_at_a_meter() -> None:
    """10 lg(1/(4 pi)) = -10.99 dB and 10 lg(rho c / 400) = 0.14 dB."""
    pressure = free_field_pressure(1.0, 1.0, 413.0)
    assert 20.0 * np.log10(pressure / 20e-6) == pytest.approx(120.0 - 10.992 + 0.139, abs=2e-3)
    assert free_field_pressure(1.0, 2.0, 413.0) == pytest.approx(0.5 * pressure)
