"""Sound pressure beside sound power: by the same transfer functions, at the place of the complaint."""

from typing import Any

import numpy as np
import pytest
from pytest import approx
from small_inputs import small_inputs

import lineofaction as loa
from dynamics.noise import QuantityLevel, SoundModel, SoundPressure
from lineofaction.gearbox.studies.noise.run import RUN
from lineofaction.gearbox.workbench import tabled
from lineofaction.report.housing.noise import PAGE

PLACE = [10.0, 10.0, 400.0]
QUICK: dict[str, Any] = {"speed_rpm": [300.0, 600.0], "orders": 2, "boundary_elements": False}


@pytest.fixture(scope="module")
def scene():
    return dict(small_inputs("noise")["scene"])


@pytest.fixture(scope="module")
def sound(scene):
    """That of a complaint at order 1, heard at its microphone."""
    return loa.noise(scene | {"complaint": {"order": 20.0, "microphone_mm": PLACE}}, QUICK)


@pytest.mark.law
def test_panels_as_monopoles_are_heard_as_the_quantity_of_that_name(scene):
    sound = loa.noise(scene, QUICK | {"band": False, "radiation": "monopoles"}, microphone_mm=PLACE)
    subject = tabled(scene)
    (name,) = subject.housings
    place = (0.01, 0.01, 0.4)
    level = QuantityLevel(
        SoundPressure(name, place), SoundModel(subject.scene, subject.housings, {}), "pressure"
    )
    square = level.squares(loa.response(scene, speed_rpm=[300.0, 600.0], orders=2))
    pressure = RUN.figures(sound)["pressure"]
    assert pressure["level_db_a"] == approx(10.0 * np.log10(square.T / 4e-10), abs=1e-6)
    assert pressure["total_level_db_a"] == approx(10.0 * np.log10(square.sum(axis=1) / 4e-10), abs=1e-6)
    assert [(row["low_db_a"], row["high_db_a"]) for row in pressure["orders"]] == [(None, None)] * 2


def test_an_order_has_the_band_of_its_sound_power(sound):
    figures = RUN.figures(sound)
    assert figures["pressure"]["microphone_mm"] == approx(PLACE)
    for own, power in zip(figures["pressure"]["orders"], figures["band"]["orders"], strict=True):
        band = power["largest"]
        assert own["level_db_a"] - own["low_db_a"] == approx(band["level_db_a"] - band["low_db_a"])
        assert own["high_db_a"] - own["level_db_a"] == approx(band["high_db_a"] - band["level_db_a"])
        assert own["speed_rpm"] == approx(600.0)


def test_the_order_of_the_complaint_is_said_where_it_is_heard(sound):
    """Order 2 is 24 dB louder."""
    (said,) = [line for line in PAGE.page(sound).headlines if line.name.startswith("sound pressure")]
    assert said.name == "sound pressure level at (10, 10, 400) mm"
    assert ", harmonic 1 of " in said.remark and ", at 600.0 rpm; " in said.remark
