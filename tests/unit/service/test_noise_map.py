"""The map of sound power: power is kept, and it ends where its colors do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from sounding_scene import sound

from dynamics.noise import RadiatedSound
from lineofaction.report.drawing.figure import HeatMap
from lineofaction.report.housing.noise import DEPTH, _cells, row_axis


def quiet_above() -> RadiatedSound:
    power = np.array(sound().power)
    power[-1] *= 1e-12
    return replace(sound(), power=power, facts=sound().facts | {"leading_shaft": "input"})


def shade() -> HeatMap:
    sound = quiet_above()
    _, along = row_axis(sound.speed, sound.facts)
    return _cells(sound.orders, along)


def test_it_holds_the_power_of_every_speed() -> None:
    drawn = np.nansum(10.0 ** (shade().z / 10.0), axis=0) * 1e-12
    total = quiet_above().orders.weighted_power.sum(axis=0)
    left_out = total.max() * 10.0 ** (-DEPTH / 10.0) * quiet_above().order.size
    np.testing.assert_allclose(drawn, total, atol=left_out)


def test_it_ends_with_what_is_shown() -> None:
    map_, frequency = shade(), quiet_above().orders.frequency
    assert np.any(np.isfinite(map_.z[-1])) and len(map_.y) == len(map_.z)
    assert map_.y[-1] < 0.5 * (frequency[-2:].max(axis=1).sum())
