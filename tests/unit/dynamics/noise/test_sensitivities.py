"""Sensitivities of levels: exact for parabolas, closed form of a resonance that only the housing damps."""

from __future__ import annotations

import math

import numpy as np
import pytest
from varied_housing import undamped_elsewhere

from dynamics.errors import InputError
from dynamics.noise import GUESSES, DesignFigure, forced_power
from dynamics.noise.sensitivities import Sensitivity, ranked
from dynamics.noise.sound_band import largest_level

FIGURE = DesignFigure("tip relief", "um", 12.0, 2.0)


def test_slope_and_curvature_of_a_parabola_are_exact():
    row = Sensitivity.of(FIGURE, lambda x: 70.0 - 0.8 * (x - 12.0) + 0.05 * (x - 12.0) ** 2)
    assert row.slope == pytest.approx(-0.8)
    assert row.curvature == pytest.approx(0.1)
    assert row.for_one_db_less == pytest.approx(1.25)
    assert row.linear_range == pytest.approx(4.0)
    bend = 0.05 * row.linear_range**2
    assert bend == pytest.approx(0.25 * abs(row.slope) * row.linear_range)
    assert row.linear
    assert not Sensitivity.of(FIGURE, lambda x: -0.1 * (x - 12.0) + 0.05 * (x - 12.0) ** 2).linear


def test_what_changes_nothing_costs_without_end():
    row = Sensitivity.of(FIGURE, lambda _: 70.0)
    assert (row.slope, row.for_one_db_less, row.linear_range) == (0.0, math.inf, math.inf)
    louder = Sensitivity.of(FIGURE, lambda x: 3.0 * x)
    assert ranked([row, louder]) == (louder, row)
    assert louder.for_one_db_less == pytest.approx(-1.0 / 3.0)


def test_a_step_of_nothing_is_refused():
    with pytest.raises(InputError, match="step"):
        DesignFigure("tip relief", "um", 12.0, 0.0)


def test_damping_of_a_resonance_costs_a_decibel_for_an_eighth():
    """-20 lg(ratio): 8.69 dB per unit of the factor at 1."""
    model, coarse = undamped_elsewhere(), np.linspace(60.0, 140.0, 400)
    near = coarse[int(np.argmax(forced_power(model, coarse, 1)[1].power[0]))]
    fine = np.linspace(0.995 * near, 1.005 * near, 60)

    def level(factor: float) -> float:
        varied = GUESSES["housing_damping"].varied(model, factor)
        return largest_level(fine, forced_power(varied, fine, 1)[1])

    row = Sensitivity.of(DesignFigure("housing_damping", "", 1.0, 0.02), level)
    assert row.slope == pytest.approx(-20.0 / math.log(10.0), rel=0.01)
