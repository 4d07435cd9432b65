"""Pitch deviations in the terms of ISO 1328-1."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fe_contact.errors import InputError
from fe_contact.geometry import Gear, GearPair, PitchDeviation, RingGear

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
# a chart of five teeth: F_pi 0, 3, 1, -4, -2 um
CHART = PitchDeviation((0.0, 3e-6, 1e-6, -4e-6, -2e-6))


def test_single_and_cumulative_deviations_of_a_chart():
    assert CHART.individual == pytest.approx([2e-6, 3e-6, -2e-6, -5e-6, 2e-6], abs=1e-18)
    assert CHART.single == pytest.approx(5e-6, abs=1e-18)
    assert CHART.total == pytest.approx(7e-6, abs=1e-18)


def test_single_deviations_close_the_circle_and_cumulate_to_the_index_deviations():
    values = np.random.default_rng(3).normal(0.0, 5e-6, 37)
    deviation = PitchDeviation(tuple(values))
    assert deviation.individual.sum() == pytest.approx(0.0, abs=1e-19)
    assert values[0] + np.cumsum(deviation.individual[1:]) == pytest.approx(values[1:], abs=1e-19)


@pytest.mark.parametrize(
    ("values", "period"),
    [((), 1), ((5e-6,) * 12, 1), ((1e-6, 2e-6) * 6, 2), ((1e-6, 2e-6, 3e-6, 2e-6) * 3, 4), (range(12), 12)],
)
def test_the_period_is_the_shortest_run_that_repeats(values, period):
    assert PitchDeviation(tuple(1e-6 * value for value in values)).period == period


def test_turning_back_twice_changes_nothing_and_keeps_the_first_tooth():
    assert CHART.reversed.cumulative == (0.0, -2e-6, -4e-6, 1e-6, 3e-6)
    assert CHART.reversed.reversed == CHART
    assert PitchDeviation().reversed == PitchDeviation()


def test_along_the_line_of_action_an_arc_is_shorter_by_the_transverse_pressure_angle():
    """The tooth turns by F_pi / r; the line of action sees r_b of it."""
    helical = replace(GEAR, helix_angle=0.4, pitch_deviation=PitchDeviation((1e-6,) * 20))
    turned = 1e-6 / helical.reference_radius
    found = helical.pitch_deviation.on_line_of_action(helical.transverse_pressure_angle)
    assert found == pytest.approx([turned * helical.base_radius] * 20, rel=1e-12, abs=0.0)
    assert helical.base_radius / helical.reference_radius < math.cos(math.radians(20.0))


def test_a_gear_with_deviations_keeps_its_macro_geometry():
    """So the finite-element model of the perfect gear serves it."""
    erring = replace(GEAR, pitch_deviation=PitchDeviation((0.0,) * 19 + (9e-6,)))
    assert erring.macro_geometry() == GEAR.macro_geometry()


def test_the_swapped_pair_has_the_same_teeth_in_the_other_order():
    erring = replace(GEAR, pitch_deviation=PitchDeviation(tuple(1e-6 * k for k in range(20))))
    pair = GearPair(erring, GEAR, 80e-3)
    assert pair.swapped().wheel.pitch_deviation == erring.pitch_deviation.reversed
    assert pair.swapped().swapped() == pair


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ((0.0, float("nan")), "pitch_deviation[1]"),
        ((0.0, 5.0), "pitch_deviation[1]"),
        (("5",), "pitch_deviation[0]"),
    ],
)
def test_values_that_are_no_deviations_are_refused(values, field):
    with pytest.raises(InputError) as refusal:
        PitchDeviation(values)
    assert refusal.value.field == field


@pytest.mark.parametrize("count", [1, 19, 21])
def test_the_list_has_one_value_per_tooth(count):
    with pytest.raises(InputError, match="a list of 20") as refusal:
        replace(GEAR, pitch_deviation=PitchDeviation((1e-6,) * count))
    assert refusal.value.field == "pitch_deviation"


def test_ring_gears_have_them_too():
    ring = RingGear(teeth=60, normal_module=4e-3, face_width=25e-3, rim_diameter=300e-3, cutter_teeth=25)
    erring = replace(ring, pitch_deviation=PitchDeviation((1e-6,) * 60))
    found = erring.pitch_deviation.on_line_of_action(erring.transverse_pressure_angle)
    assert found == pytest.approx([1e-6 * math.cos(math.radians(20.0))] * 60, rel=1e-12, abs=0.0)
