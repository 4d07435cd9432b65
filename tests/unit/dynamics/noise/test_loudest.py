"""The loudest points, models side by side, several housings, the cache of resistances."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from hulls import sphere
from sounding_housings import rigid_housing
from sounding_scene import SPEEDS, housing, oscillating, radiation, response, sound

from dynamics.acoustics import Air, ElementalRadiators, EquivalentRadiatedPower
from dynamics.errors import InputError
from dynamics.noise import RadiatedSound, kept_radiation, loudest, models_at, radiated_sound

AIR = Air()


def test_the_first_point_is_the_loudest_order_and_speed() -> None:
    points, level = loudest(sound()), sound().orders.weighted_level
    assert points[0].weighted_level == pytest.approx(level.max())
    assert [point.weighted_level for point in points] == sorted(
        (point.weighted_level for point in points), reverse=True
    )
    for point in points:
        s, h = point.speed_index, point.order_index
        assert point.weighted_level == pytest.approx(level[h, s])
        assert (point.speed, point.frequency) == (SPEEDS[s], sound().frequency[s, h])
        assert point.mode_share == pytest.approx(sound().mode_share[:, s, h].max() / sound().power[s, h])
        assert sound().natural_frequency[point.mode - 1] == point.natural_frequency
        assert point.bearing == sound().bearing[int(sound().bearing_share[:, s, h].argmax())]


def test_silence_has_no_loudest_point() -> None:
    quiet = replace(response(), bearing_force=0.0 * response().bearing_force)
    assert loudest(radiated_sound(quiet, housing(), None, radiation())) == ()


@pytest.mark.law
def test_a_mode_in_resonance_carries_the_sound() -> None:
    body, driven, _, _ = oscillating(5.0, 5.0 * (2.0 * np.pi * 300.0) ** 2)
    plane = kept_radiation(body, EquivalentRadiatedPower(), driven.frequency)
    (point, *_) = loudest(radiated_sound(driven, body, None, plane))
    assert point.frequency == 300.0 and point.natural_frequency == pytest.approx(300.0)
    assert (point.bearing, point.mode_share) == ("seat", pytest.approx(1.0))


def test_models_at_a_point_are_those_of_the_map() -> None:
    at = loudest(sound(), 1)[0]
    where = at.speed_index, at.order_index
    ladder = models_at(response(), housing(), None, where, (EquivalentRadiatedPower(), ElementalRadiators()))
    assert ladder.results["monopoles"].level == pytest.approx(at.level, abs=0.5)


def test_two_housings_alike_are_3_db_louder_than_one() -> None:
    both = RadiatedSound.of_all([sound(), sound()])
    np.testing.assert_allclose(both.power, 2.0 * sound().power, rtol=1e-12)
    np.testing.assert_allclose(both.efficiency, sound().efficiency, rtol=1e-12)
    np.testing.assert_allclose(both.bearing_share.sum(axis=0), both.power, rtol=1e-9)
    assert loudest(both, 1)[0].mode == loudest(sound(), 1)[0].mode
    with pytest.raises(InputError, match="frequency"):
        RadiatedSound.of_all([sound(), replace(sound(), frequency=2.0 * sound().frequency)])
    with pytest.raises(InputError, match="sounds"):
        RadiatedSound.of_all([])


def test_the_second_time_comes_from_the_cache_to_the_last_bit(tmp_path, monkeypatch) -> None:
    module = import_module("dynamics.noise.housing_radiation")
    monkeypatch.setattr(module, "LEAST_COST", 0.0)
    body = rigid_housing(1.0, 1e6, 0.02, sphere(6, 0.1))
    first = kept_radiation(body, ElementalRadiators(), [200.0, 400.0], cache=tmp_path)
    monkeypatch.setattr(module, "housing_radiation", None)
    again = kept_radiation(body, ElementalRadiators(), [200.0, 400.0], cache=tmp_path)
    np.testing.assert_array_equal(again.matrix, first.matrix)
    assert (again.area, again.impedance, again.facts) == (first.area, first.impedance, first.facts)
    others = (
        (replace(body, mass=2.0 * body.mass), ElementalRadiators(), [200.0, 400.0], AIR),
        (body, EquivalentRadiatedPower(), [200.0, 400.0], AIR),
        (body, ElementalRadiators(), [200.0, 401.0], AIR),
        (body, ElementalRadiators(), [200.0, 400.0], Air(density=1.0)),
    )
    for other in others:
        with pytest.raises(TypeError):  # computed anew
            kept_radiation(*other, cache=tmp_path)
