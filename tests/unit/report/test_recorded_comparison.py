"""A recording beside the run that it was made from: levels of orders agree, whatever the format."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene
from recordings import FULL_SCALE, PULSES, WRITERS, universal

from dynamics import RunResult, TimeLaw, simulate
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.comparison.compare import compare
from lineofaction.report.comparison.recorded import Measurement
from lineofaction.report.drawing.page import Page, html
from lineofaction.report.run.view import RunView

RATE = 51_200.0  # Hz, of the recorder
WAV = Measurement(
    channel="channel 1", unit="m/s²", full_scale=FULL_SCALE, tacho="channel 2", pulses_per_turn=PULSES
)
VIEW = RunView(quantity="acceleration", bearing="input.left", direction="y", orders=tuple(range(1, 9)))


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A run at the rate of the program, and the same motion at that of a recorder with noise and a tone."""
    scene = gear_pair_scene(speed=TimeLaw.ramp(600.0 * RPM, 1500.0 * RPM, 1.5), duration=1.5)
    computed, dense = (
        simulate(replace(scene, outputs=replace(scene.outputs, accelerations=True, sample_rate=rate)))
        for rate in (None, RATE)
    )
    file = tmp_path_factory.mktemp("run") / "run.nc"
    computed.to_netcdf(file)
    return file, _recorder(dense)


def _recorder(run: RunResult) -> dict[str, Any]:
    """White noise of 1 % of the signal, and a tone of 20 % at 17 kHz, beyond all orders.

    Order 1 lies 35 dB below the loudest.
    """
    acceleration = run.bearing_acceleration[run.bearing.index("input.left"), 1]
    size = float(acceleration.std())
    noise = 0.01 * size * np.random.default_rng(11).standard_normal(acceleration.size)
    tone = 0.2 * size * np.sin(2 * np.pi * 17_000.0 * run.time)
    rpm = np.abs(run.speed[run.shaft.index("input")]) / RPM
    return {"time": run.time, "acceleration": acceleration + noise + tone, "rpm": rpm}


def _differences(page: Page) -> dict[int, tuple[float, float]]:
    """Difference and error by order, dB."""
    number = r"([+-][\d.]+) ± ([\d.]+)"
    found = {int(one.name.split()[-1]): re.search(number, one.value) for one in page.headlines}
    return {order: (float(match[1]), float(match[2])) for order, match in found.items() if match}


@pytest.mark.parametrize("form", WRITERS)
def test_levels_of_eight_orders_agree_within_a_fifth_of_a_decibel(form, recorded, tmp_path):
    """The published target: one measured waterfall, written by other programs, read back and compared."""
    run, recording = recorded
    assert np.abs(recording["acceleration"]).max() < FULL_SCALE
    file = WRITERS[form](tmp_path / f"test.{form}", **recording)
    page = compare([run, file], VIEW, None, WAV if form == "wav" else Measurement())
    differences = _differences(page)
    assert list(differences) == list(range(1, 9))
    assert {order: value for order, (value, _) in differences.items() if abs(value) > 0.2} == {}
    assert sum(abs(value) <= error + 0.005 for value, error in differences.values()) >= 7  # two deviations


def test_a_recording_of_twice_the_size_is_six_decibels_louder(recorded, tmp_path):
    run, recording = recorded
    twice = recording | {"acceleration": 2.0 * recording["acceleration"]}
    page = compare([run, universal(tmp_path / "t.uff", **twice)], VIEW)
    assert all(abs(value - 6.02) < 0.2 for value, _ in _differences(page).values())
    assert {one.remark for one in page.headlines} == {"the measured one is louder"}
    assert [figure.key for figure in page.sections[0].figures] == ["levels", "order_maps"]
    assert len(page.sections[0].figures[1].content) == 2


def test_what_the_file_does_not_say_is_asked_for(recorded, tmp_path):
    run, recording = recorded
    without = replace(VIEW, direction="")
    file = universal(tmp_path / "t.uff", **recording, direction=0)
    with pytest.raises(BadInput, match="along which the sensor measures: --direction"):
        compare([run, file], without)
    stated = universal(tmp_path / "s.uff", **recording, direction=-2)
    assert "along y" in compare([run, stated], without).lead
    wav = WRITERS["wav"](tmp_path / "t.wav", **recording)
    with pytest.raises(BadInput, match=r"the name of a channel: 2 could be it.*channel 1, channel 2"):
        compare([run, wav], VIEW)
    with pytest.raises(BadInput, match="a unit of acceleration"):
        compare([run, wav], VIEW, None, replace(WAV, unit=""))
    with pytest.raises(BadInput, match="left out beside --tacho"):
        compare([run, wav], VIEW, None, replace(WAV, rpm=900.0))
    with pytest.raises(BadInput, match="at speeds that the run passes too"):
        compare([run, file], replace(VIEW, orders=(1, 2)), None, Measurement(rpm=4000.0))
    other = run.with_name("other.nc")
    other.write_bytes(run.read_bytes())
    with pytest.raises(BadInput, match=r"files = |one run with a mesh beside a recording"):
        compare([run, other, file], VIEW)


def test_names_of_channels_and_files_are_text_on_the_page(recorded, tmp_path):
    run, recording = recorded
    file = universal(tmp_path / "<img src=x onerror=alert(1)>.uff", **recording)
    written = html(compare([run, file], VIEW), {"levels": b"", "order_maps": b""}, still=True)
    assert "<img src=x" not in written and "&lt;img src=x" in written
