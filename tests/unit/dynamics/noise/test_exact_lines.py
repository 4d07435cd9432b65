"""Boundary elements at the loudest lines: they hold there alone, narrow the band, keep to their budget."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from sounding_scene import AIR, housing, oscillating, radiation, response

from dynamics.acoustics import ElementalRadiators, LevelBand, OrderPower, sphere_efficiency
from dynamics.acoustics.boundary_elements import EDGES
from dynamics.noise import (
    EstimatedRadiation,
    HousingRadiation,
    SoundBand,
    corrected_radiation,
    estimated_radiation,
    exact_lines,
    housing_radiation,
    panel_sound,
    radiated_sound,
    with_exact_lines,
)
from dynamics.noise.coarse_hull import Coarseness
from dynamics.noise.exact_lines import BLEND, EXACT, FLAT
from dynamics.noise.housing_radiation import BAND

HERTZ = 700.0


@pytest.fixture(scope="module")
def estimate():
    return estimated_radiation(housing(), radiation(), AIR)


def line(estimate: EstimatedRadiation, hertz: float, louder: float) -> HousingRadiation:
    """A line with the resistance of the estimate times a factor."""
    matrix = louder * at(estimate, hertz)
    return replace(radiation(), frequency=np.array([hertz]), matrix=matrix[None])


def at(made: HousingRadiation, hertz: float) -> np.ndarray:
    return np.sum(
        [
            share * made.matrix[np.flatnonzero(made.frequency == knot)[0]]
            for knot, share in made.weights(hertz)
        ],
        axis=0,
    )


def test_a_line_holds_for_every_motion_near_it_and_nowhere_else(estimate):
    made = with_exact_lines(estimate, [line(estimate, HERTZ, 3.0)])
    for hertz in (HERTZ / FLAT, HERTZ, HERTZ * FLAT):
        expected = 3.0 * at(estimate, HERTZ) * (hertz / HERTZ) ** 2
        np.testing.assert_allclose(at(made, hertz), expected, rtol=1e-12)
        assert made.error_band(hertz, np.ones(3)) == pytest.approx((-EXACT, EXACT))
    for hertz in (HERTZ / BLEND, HERTZ * BLEND, 0.5 * HERTZ, 1.9 * HERTZ):
        np.testing.assert_allclose(at(made, hertz), at(estimate, hertz), rtol=1e-9)


@pytest.mark.parametrize("ratio", [1.04, 1.08, 1.3])
def test_two_lines_leave_the_resistance_positive_and_each_other_alone(estimate, ratio):
    lines = [line(estimate, HERTZ * ratio, 0.5), line(estimate, HERTZ, 3.0)]
    made = with_exact_lines(estimate, lines)
    assert np.all(np.diff(made.frequency) > 0.0)
    eigenvalues = np.linalg.eigvalsh(made.matrix)
    assert np.all(eigenvalues >= -1e-12 * eigenvalues.max(axis=1, keepdims=True))
    for each in lines:
        np.testing.assert_allclose(at(made, float(each.frequency[0])), each.matrix[0], rtol=1e-12)


def test_panels_add_up_to_the_power_of_a_line(estimate):
    point = (2, 1)
    made = with_exact_lines(estimate, [line(estimate, float(response().frequency[point]), 3.0)])
    sound, before = (radiated_sound(response(), housing(), None, each) for each in (made, estimate))
    assert sound.power[point] == pytest.approx(3.0 * before.power[point], rel=1e-9)
    panels = panel_sound(response(), housing(), None, made, point, ElementalRadiators(), AIR)
    assert panels.power.sum() == pytest.approx(sound.power[point], rel=1e-9)


def test_panels_between_the_line_and_the_octave_below_are_those_of_the_finer_octave(monkeypatch):
    """The line takes the knot between two octaves out; panels of the lower one do not resolve it."""
    known, model = radiation().metadata.resolved_frequency, ElementalRadiators()
    point = (0, 0)
    hertz = float(response().frequency[point])
    between, high = 1.012 * hertz, 1.8 * hertz
    assert high < known
    octaves = housing_radiation(housing(), model, [between**2 / high * BAND, high / BAND], AIR)
    assert np.any(np.abs(octaves.frequency / between - 1.0) < 1e-9)
    beside = estimated_radiation(housing(), octaves, AIR)
    made = with_exact_lines(beside, [line(beside, 1.05 * hertz, 3.0)])
    (below, _), (above, _) = made.weights(hertz)
    assert below < between < above
    chosen: list[float] = []
    used: list[float] = []
    panels_module = sys.modules["dynamics.noise.panel_sound"]

    def noted(call, at, heard):
        def called(*arguments):
            heard.append(arguments[at])
            return call(*arguments)

        return called

    monkeypatch.setattr(EstimatedRadiation, "hull_at", noted(EstimatedRadiation.hull_at, 2, chosen))
    monkeypatch.setattr(panels_module, "panel_power", noted(panels_module.panel_power, 2, used))
    assert panel_sound(response(), housing(), None, made, point, model, AIR).power.sum() > 0.0
    assert max(used) == above <= chosen[-1], "of the panels that were chosen last"


@pytest.mark.law
def test_a_sphere_that_oscillates_has_the_power_of_theory_at_its_line(monkeypatch):
    """Within 0.3 dB by 400 panels, at ka of 0.27 to 1.5, where monopoles are 3.5 dB off."""
    pytest.importorskip("ngsolve", reason="boundary elements need the extra boundary-elements")
    monkeypatch.setattr(exact_lines, "COARSE", Coarseness(EDGES, 200))
    body, driven, plane, ka = oscillating(4.0, 1e7)
    monopoles = housing_radiation(body, ElementalRadiators(), driven.frequency, AIR)
    made = corrected_radiation(driven, body, None, estimated_radiation(body, monopoles, AIR))
    sound = radiated_sound(driven, body, None, made.radiation)
    points = [tuple(np.argwhere(driven.frequency == each.frequency)[0]) for each in made.lines]
    assert made.lines and not made.omitted
    for each, point in zip(made.lines, points, strict=True):
        exact = plane[point] * sphere_efficiency(1, float(ka[point]))
        assert 10.0 * np.log10(sound.power[point] / exact) == pytest.approx(0.0, abs=0.3)
        assert each.level == pytest.approx(10.0 * np.log10(sound.power[point] / 1e-12), abs=1e-6)
        low, high = made.radiation.error_band(each.frequency, sound.mode_alone[(slice(None), *point)])
        assert (low, high) == pytest.approx((-EXACT, EXACT))


def test_lines_beyond_the_budget_and_without_the_library_are_named(estimate, monkeypatch):
    made = corrected_radiation(response(), housing(), None, estimate, budget=1.0)
    assert not made.lines and "of 1 CPU s" in made.omitted[0]
    monkeypatch.setitem(sys.modules, "ngsolve", None)
    made = corrected_radiation(response(), housing(), None, estimate)
    assert made.radiation is estimate and "lineofaction[boundary-elements]" in made.omitted[0]


def test_a_quieter_line_that_may_be_louder_widens_the_band_of_the_largest():
    """Orders of 80 and 77 dB: the first is exact, the second off by 6 dB: 83 dB at most, 80 dB at least."""
    hertz, speed = np.array([[1000.0, 500.0], [2000.0, 1000.0]]), np.array([1.0, 2.0])
    power = 1e-12 * 10.0 ** (np.array([[80.0, 20.0], [20.0, 77.0]]) / 10.0)
    nothing = LevelBand(80.0, {}, {})
    band = SoundBand(
        speed, np.array([1.0, 2.0]), nothing, nothing, (nothing,) * 2, speed, (nothing,) * 2, (nothing,) * 2
    )
    off = np.array([[0.0, 0.0], [0.0, 6.0]])
    made = band.with_power_error("radiation_model", OrderPower(hertz, power), off, off)
    assert made.largest_total.high == pytest.approx(83.0, abs=1e-4)
    assert made.largest_total.low == pytest.approx(80.0, abs=1e-4)
    assert [each.width for each in made.largest] == pytest.approx([0.0, 12.0], abs=1e-4)
    even = band.with_power_error(
        "radiation_model", OrderPower(hertz, power), 0.0 * off + 2.0, 0.0 * off + 1.0
    )
    for each in (even.largest_total, even.mean_total, *even.largest, *even.there, *even.total):
        assert (each.below["radiation_model"], each.above["radiation_model"]) == pytest.approx((2.0, 1.0))


def test_contributions_to_a_band_add_up_by_squares():
    band = LevelBand(80.0, {"damping": 3.0, "model": 4.0}, {"damping": 4.0, "model": 0.0})
    assert band.width == pytest.approx(9.0)
