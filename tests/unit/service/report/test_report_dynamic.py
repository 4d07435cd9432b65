"""Laws that the figures of a run obey."""

from dataclasses import replace

import numpy as np
import pytest

from dynamics.results import RunResult
from dynamics.types import RunStatus
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.run.page import (
    dynamic_alarms,
    dynamic_headlines,
    dynamic_making,
    dynamic_results,
)
from lineofaction.report.run.signals import (
    _order_amplitudes,
    amplitude_spectrum,
    dynamic_error,
    signal_over_time,
    signal_spectrum,
    spectrum_window,
)
from lineofaction.report.run.view import RunView, shown_signal, travel


def test_position_is_unwrapped_and_speed_is_the_driver_s(run: RunResult) -> None:
    series = travel(run)
    assert np.all(np.diff(series.position) >= 0)
    np.testing.assert_allclose(series.position % 1.0, run.position[0], atol=1e-9)
    assert series.speed_rpm[-1] == pytest.approx(900.0)
    assert series.position[-1] == pytest.approx(20 * 900 / 60 * 2.0 / 2, rel=1e-3)


def test_a_run_backwards_travels_as_far(run: RunResult) -> None:
    backwards = replace(run, position=(-run.position) % 1.0, speed=-run.speed)
    np.testing.assert_allclose(travel(backwards).position, travel(run).position, atol=1e-9)


def test_dynamic_and_static_error_are_drawn_at_three_speeds(run: RunResult) -> None:
    panels = dynamic_error(run).content
    assert isinstance(panels, tuple)
    assert [panel.title.split(" rpm")[0] for panel in panels] == ["90.0", "400", "800"]
    for panel in panels:
        dynamic, static = panel.lines
        assert (dynamic.name, static.name) == ("dynamic", "static")
        assert np.ptp(static.x) == pytest.approx(3.0, abs=0.2)
        assert static.y.max() == pytest.approx(7.0, abs=0.01)


def test_the_bearing_that_varies_most_is_shown(run: RunResult) -> None:
    signal = shown_signal(run, RunView())
    assert (signal.name, signal.unit) == ("force on bearing right", "N rms")
    whole, detail = signal_over_time(run, signal).content  # type: ignore[misc]
    assert [line.name for line in whole.lines] == ["y"]
    assert whole.lines[0].y.min() < -1020
    assert detail.x.limits[0] > whole.x.limits[0]


def test_over_a_few_pitches_the_ripple_is_drawn_about_its_mean(run: RunResult) -> None:
    shifted = replace(run, bearing_force=run.bearing_force + 1e5)
    signal = shown_signal(shifted, RunView())
    _, detail = signal_over_time(shifted, signal).content  # type: ignore[misc]
    assert detail.y.label.endswith("less its mean, N")
    (ripple,) = (line.y for line in detail.lines if line.name == "y")  # alone has any
    assert ripple.min() < 0.0 < ripple.max()
    assert all(np.abs(line.y).max() < 1e4 for line in detail.lines)


def test_the_view_names_bearing_quantity_and_scale(run: RunResult) -> None:
    other = shown_signal(run, RunView(bearing="left", scale="peak"))
    assert (other.part, other.unit) == ("left", "N peak")
    error = shown_signal(run, RunView(quantity="transmission_error"))
    (drawn,) = error.components(run).values()
    np.testing.assert_array_equal(drawn, 1e6 * run.dynamic_transmission_error[0])
    peak, effective = (shown_signal(run, RunView(scale=scale)) for scale in ("peak", "rms"))
    amplitude = np.ones((2, 3, 5))
    np.testing.assert_allclose(peak.amplitude(amplitude), np.sqrt(3.0))
    np.testing.assert_allclose(effective.amplitude(amplitude), np.sqrt(1.5))


@pytest.mark.parametrize(
    ("view", "field"),
    [
        (RunView(quantity="noise"), "quantity"),
        (RunView(quantity="acceleration"), "accelerations = true"),
        (RunView(bearing="middle"), "bearing"),
        (RunView(mesh="second"), "mesh"),
        (RunView(orders=(1.5,)), "orders"),
        (RunView(orders=(99.0,)), "orders"),
        (RunView(window="boxcar"), "window"),
        (RunView(scale="sone"), "scale"),
    ],
)
def test_a_view_that_the_run_cannot_serve_is_refused(run: RunResult, view: RunView, field: str) -> None:
    bare = replace(run, bearing_acceleration=np.empty((0, 3, run.time.size)))
    with pytest.raises(BadInput, match=field):
        shown_signal(bare, view)


def test_a_sine_shows_its_amplitude(run: RunResult) -> None:
    phase = 2 * np.pi * 100 * run.time
    force = np.zeros_like(run.bearing_force)
    force[1, 0] = 5.0 + 3.0 * np.cos(phase)
    force[1, 1] = 4.0 * np.sin(phase)
    sine = replace(run, bearing_force=force)
    window = slice(0, int(run.sample_rate))  # 1 s
    for scale, factor in (("peak", 1.0), ("rms", np.sqrt(0.5))):
        signal = shown_signal(sine, RunView(scale=scale))
        frequency, amplitude = amplitude_spectrum(sine, signal, window)
        assert frequency[np.argmax(amplitude)] == 100.0
        assert amplitude.max() == pytest.approx(5.0 * factor, rel=1e-9)
        assert amplitude[frequency > 110].max() < 1e-9


def test_mesh_orders_are_found_where_they_are(run: RunResult) -> None:
    window = spectrum_window(run.time)
    mesh = run.mesh_frequency[0, window]
    frequency, amplitude = amplitude_spectrum(run, shown_signal(run, RunView()), window)
    (first, weak), (second, strong), *others = _order_amplitudes(frequency, amplitude, mesh)
    assert mesh.min() - 10 <= first <= mesh.max() + 10
    assert second == pytest.approx(2 * first, abs=10)
    assert strong > weak > 20 * max(amplitude for _, amplitude in others)


def test_orders_are_marked_at_multiples_of_the_mesh_frequency(run: RunResult) -> None:
    (panel,) = signal_spectrum(run, shown_signal(run, RunView())).content  # type: ignore[misc]
    marks = [reference.value for reference in panel.references]
    np.testing.assert_allclose(marks, np.arange(1, 7) * marks[0])  # what the rate holds
    assert marks[0] == pytest.approx(20 * 900 * 0.925 / 60, rel=1e-3)
    assert panel.y.scale == "log"


def test_a_run_without_bearing_forces_shows_its_mesh_force(run: RunResult) -> None:
    bare = replace(run, bearing=(), bearing_force=np.empty((0, 3, run.time.size)))
    titles = [section.title for section in dynamic_results(bare, RunView())]
    assert titles == ["Dynamic transmission error", "Mesh force of mesh", "Levels and orders", "Mesh forces"]
    titles[1] = "Force on bearing right"
    assert [section.title for section in dynamic_results(run, RunView())] == titles


def test_the_audit_and_the_step_error_are_told(run: RunResult) -> None:
    tables = {t.caption: t for s in dynamic_making(run) for t in (*s.tables, *s.folded)}
    accuracy = dict(tables["Accuracy of the run"].rows)  # type: ignore[arg-type]
    assert accuracy["step error, nm rms (step control)"] == "1.00"
    assert ("residual", "0") in tables["Energy audit, J"].rows
    (row,) = tables["Effects"].rows
    assert row == ("lateral", "input", "yes", "1.00 µm at the line of action", "r")
    assert dynamic_headlines(run)[0].remark == "nominal 2660 N"


def test_a_run_that_ended_early_says_so(run: RunResult) -> None:
    assert dynamic_alarms(run) == ()
    (alarm,) = dynamic_alarms(replace(run, status=RunStatus.STEP_FLOOR))
    assert "ended early at 2 s: step floor" in alarm
