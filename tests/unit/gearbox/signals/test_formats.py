"""Recordings of other programs come back as they were written, with their units."""

import numpy as np
import pytest
from recordings import FULL_SCALE, WRITERS, pyuff

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.signals.recording import read_recording

TIME = np.arange(4096) / 8192.0
ACCELERATION = 30.0 * np.sin(2 * np.pi * 300.0 * TIME) + 4.0
RPM = 900.0 + 200.0 * TIME
ROUNDING = {
    "uff": 1e-9,
    "wav": 2.0 * FULL_SCALE / (1 << 24),
    "mat": 0.0,
    "h5": 1e-13,
    "mf4": 0.0,
    "csv": 1e-13,
}


@pytest.mark.parametrize("form", WRITERS)
def test_a_channel_comes_back_in_si_units(form, tmp_path):
    file = WRITERS[form](tmp_path / f"a.{form}", TIME, ACCELERATION, RPM)
    recording = read_recording(file, "measured")
    by_hand = {"wav": ("channel 1", "m/s²")}.get(form, ("", ""))
    channel = recording.channel("measured", by_hand[0], ("acceleration",))
    time, values = channel.measured("measured", "acceleration", by_hand[1])
    values = values * (FULL_SCALE if form == "wav" else 1.0)
    np.testing.assert_allclose(values, ACCELERATION, atol=ROUNDING.get(form, 0.0) + 1e-12)
    np.testing.assert_allclose(time - time[0], TIME, rtol=4e-6)  # a universal file has six digits of the step
    assert channel.direction == ("y" if form == "uff" else "")
    if form != "wav":
        speed = recording.channel("tacho", "", ("speed",))
        np.testing.assert_allclose(speed.measured("tacho", "speed")[1][0], 900.0 * np.pi / 30.0, rtol=1e-9)


@pytest.mark.parametrize("form", ["mat", "h5", "mf4", "csv"])
def test_only_named_channels_are_read(form, tmp_path):
    file = WRITERS[form](tmp_path / f"a.{form}", TIME, ACCELERATION, RPM)
    names = [channel.name for channel in read_recording(file, "measured").channels]
    assert len(names) == 2
    assert [one.name for one in read_recording(file, "measured", names[1:]).channels] == names[1:]


def test_a_unit_that_is_not_stated_is_not_guessed(tmp_path):
    file = WRITERS["wav"](tmp_path / "a.wav", TIME, ACCELERATION, RPM)
    channel = read_recording(file, "measured").channel("measured", "channel 1")
    with pytest.raises(BadInput, match=r"unit of measured channel 1.*State the unit of acceleration: m/s²"):
        channel.measured("measured", "acceleration")
    with pytest.raises(BadInput, match="a unit of acceleration"):
        channel.measured("measured", "acceleration", "rpm")


def test_one_of_several_channels_is_not_guessed(tmp_path):
    file = WRITERS["csv"](tmp_path / "a.csv", TIME, ACCELERATION, RPM)
    recording = read_recording(file, "measured")
    with pytest.raises(BadInput, match=r"0 could be it.*acceleration_m_per_s2, speed_rpm"):
        recording.channel("measured", "", ("force",))
    with pytest.raises(BadInput, match="one channel of that name"):
        recording.channel("measured", "acceleration")


def test_a_label_that_contradicts_the_units_of_the_file_is_refused(tmp_path):
    file = WRITERS["uff"](tmp_path / "a.uff", TIME, ACCELERATION, RPM)
    for length, fits in ((1.0, True), (1e3, False)):
        units = {"units_code": 9, "units_description": "own", "temp_mode": 1, "length": length}
        rest = {"force": 1.0, "temp": 1.0, "temp_offset": 0.0}
        head = tmp_path / f"units_{fits}.uff"
        pyuff.UFF(str(head)).write_sets([pyuff.prepare_164(**units, **rest)], mode="overwrite")
        head.write_bytes(head.read_bytes() + file.read_bytes())
        if fits:
            assert len(read_recording(head, "measured").channels) == 2
        else:
            with pytest.raises(BadInput, match="a function with one unit; its label says m/s"):
                read_recording(head, "measured")
