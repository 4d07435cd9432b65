"""Laws that the figures of a run obey."""

from dataclasses import replace

import numpy as np
import pytest

from dynamics.results import RunResult
from dynamics.types import RunStatus
from service.runs.bearing_force import bearing_force
from service.runs.bearing_spectrum import (
    amplitude_spectrum,
    bearing_spectrum,
    order_amplitudes,
    spectrum_window,
)
from service.runs.dynamic_error import dynamic_error
from service.runs.dynamic_part import dynamic_alarms, dynamic_headlines, dynamic_making, dynamic_results
from service.runs.run_series import run_series


def test_position_is_unwrapped_and_speed_is_the_driver_s(run: RunResult) -> None:
    series = run_series(run)
    assert np.all(np.diff(series.position) >= 0)
    np.testing.assert_allclose(series.position % 1.0, run.position[0], atol=1e-9)
    assert series.speed_rpm[-1] == pytest.approx(900.0)
    assert series.position[-1] == pytest.approx(20 * 900 / 60 * 2.0 / 2, rel=1e-3)


def test_a_run_backwards_travels_as_far(run: RunResult) -> None:
    backwards = replace(run, position=(-run.position) % 1.0, speed=-run.speed)
    np.testing.assert_allclose(run_series(backwards).position, run_series(run).position, atol=1e-9)


def test_dynamic_and_static_error_are_drawn_at_three_speeds(run: RunResult) -> None:
    panels = dynamic_error(run_series(run)).content
    assert isinstance(panels, tuple)
    assert [panel.title.split(" rpm")[0] for panel in panels] == ["90.0", "400", "800"]
    for panel in panels:
        dynamic, static = panel.lines
        assert (dynamic.name, static.name) == ("dynamic", "static")
        assert np.ptp(static.x) == pytest.approx(3.0, abs=0.2)
        assert static.y.max() == pytest.approx(7.0, abs=0.01)


def test_the_bearing_that_varies_most_is_shown(run: RunResult) -> None:
    assert run_series(run).loudest_bearing == "right"
    figure = bearing_force(run_series(run))
    whole, detail = figure.content  # type: ignore[misc]
    assert [line.name for line in whole.lines] == ["y"]
    assert whole.lines[0].y.min() < -1020
    assert detail.x.limits[0] > whole.x.limits[0]


def test_a_sine_shows_its_amplitude() -> None:
    time = np.arange(4000) / 4000.0
    force = np.zeros((4000, 3))
    force[:, 0] = 5.0 + 3.0 * np.cos(2 * np.pi * 100 * time)
    force[:, 1] = 4.0 * np.sin(2 * np.pi * 100 * time)
    frequency, amplitude = amplitude_spectrum(time, force)
    assert frequency[np.argmax(amplitude)] == 100.0
    assert amplitude.max() == pytest.approx(5.0, rel=1e-9)
    assert amplitude[frequency > 110].max() < 1e-9


def test_mesh_orders_are_found_where_they_are(run: RunResult) -> None:
    series = run_series(run)
    window = spectrum_window(series)
    mesh = series.mesh_frequency[window]
    frequency, amplitude = amplitude_spectrum(series.time[window], series.bearings["right"][window])
    (first, weak), (second, strong), *others = order_amplitudes(frequency, amplitude, mesh)
    assert mesh.min() - 10 <= first <= mesh.max() + 10
    assert second == pytest.approx(2 * first, abs=10)
    assert strong > weak > 20 * max(amplitude for _, amplitude in others)


def test_orders_are_marked_at_multiples_of_the_mesh_frequency(run: RunResult) -> None:
    (panel,) = bearing_spectrum(run_series(run)).content  # type: ignore[misc]
    marks = [reference.value for reference in panel.references]
    np.testing.assert_allclose(marks, np.arange(1, 7) * marks[0])  # what the rate holds
    assert marks[0] == pytest.approx(20 * 900 * 0.925 / 60, rel=1e-3)
    assert panel.y.scale == "log"


def test_a_run_without_bearing_forces_has_no_such_section(run: RunResult) -> None:
    bare = replace(run, bearing=(), bearing_force=np.empty((0, 3, run.time.size)))
    titles = [section.title for section in dynamic_results(bare)]
    assert titles == ["Dynamic transmission error", "Orders", "Mesh forces"]
    assert [section.title for section in dynamic_results(run)] == [titles[0], "Bearing forces", *titles[1:]]


def test_the_audit_and_the_step_error_are_told(run: RunResult) -> None:
    tables = {t.caption: t for s in dynamic_making(run) for t in (*s.tables, *s.folded)}
    accuracy = dict(tables["Accuracy of the run"].rows)  # type: ignore[arg-type]
    assert accuracy["step error, nm rms (step control)"] == "1.00"
    assert ("residual", "0") in tables["Energy audit, J"].rows
    assert tables["Effect ledger of the run"].rows[0][:3] == ("lateral", "input", "yes")
    assert dynamic_headlines(run)[0].remark == "nominal 2660 N"


def test_a_run_that_ended_early_says_so(run: RunResult) -> None:
    assert dynamic_alarms(run) == ()
    (alarm,) = dynamic_alarms(replace(run, status=RunStatus.STEP_FLOOR))
    assert "ended early at 2 s: step floor" in alarm
