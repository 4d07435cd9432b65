"""Laws that the figures of a run obey."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from geared_scenes import gear_pair_scene

from dynamics import Outputs, simulate
from dynamics.types import RunStatus
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.drawing.placing import envelope
from lineofaction.report.run.page import (
    _accuracy,
    dynamic_alarms,
    dynamic_headlines,
    dynamic_making,
    dynamic_results,
)
from lineofaction.report.run.signals import (
    amplitude_spectrum,
    dynamic_error,
    order_amplitudes,
    signal_over_time,
    signal_spectrum,
    spectrum_window,
)
from lineofaction.report.run.view import RunView, Travel, selected_signal, travel, window_speeds


def test_position_is_unwrapped_and_speed_is_the_driver_s(run):
    series = travel(run)
    assert np.all(np.diff(series.position) >= 0)
    np.testing.assert_allclose(series.position % 1.0, run.position[0], atol=1e-9)
    assert series.speed_rpm[-1] == pytest.approx(900.0)
    assert series.position[-1] == pytest.approx(20 * 900 / 60 * 2.0 / 2, rel=1e-3)


def test_a_run_backwards_travels_as_far(run):
    backwards = replace(run, position=(-run.position) % 1.0, speed=-run.speed)
    np.testing.assert_allclose(travel(backwards).position, travel(run).position, atol=1e-9)


def test_dynamic_and_static_error_are_drawn_at_three_speeds(run):
    panels = dynamic_error(run).content
    assert [panel.title.split(" rpm")[0] for panel in panels] == ["90.0", "400", "800"]
    for panel in panels:
        dynamic, static = panel.lines
        assert (dynamic.name, static.name) == ("dynamic", "static")
        assert np.ptp(static.x) == pytest.approx(3.0, abs=0.2)
        assert static.y.max() == pytest.approx(7.0, abs=0.01)


def test_the_bearing_that_varies_most_is_shown(run):
    signal = selected_signal(run, RunView())
    assert (signal.name, signal.unit) == ("force on bearing right", "N rms")
    whole, detail = signal_over_time(run, signal).content
    assert [line.name for line in whole.lines] == ["y"]
    assert whole.lines[0].y.min() < -1020
    assert detail.x.limits[0] > whole.x.limits[0]


def test_over_a_few_pitches_the_ripple_is_drawn_about_its_mean(run):
    shifted = replace(run, bearing_force=run.bearing_force + 1e5)
    signal = selected_signal(shifted, RunView())
    _, detail = signal_over_time(shifted, signal).content
    assert detail.y.label.endswith("less its mean, N")
    (ripple,) = (line.y for line in detail.lines if line.name == "y")  # alone has any
    assert ripple.min() < 0.0 < ripple.max()
    assert all(np.abs(line.y).max() < 1e4 for line in detail.lines)


def test_the_view_names_bearing_quantity_and_scale(run):
    other = selected_signal(run, RunView(bearing="left", scale="peak"))
    assert (other.part, other.unit) == ("left", "N peak")
    error = selected_signal(run, RunView(quantity="transmission_error"))
    (drawn,) = error.components(run).values()
    np.testing.assert_array_equal(drawn, 1e6 * run.dynamic_transmission_error[0])
    peak, effective = (selected_signal(run, RunView(scale=scale)) for scale in ("peak", "rms"))
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
def test_a_view_that_the_run_cannot_serve_is_refused(run, view, field):
    bare = replace(run, bearing_acceleration=np.empty((0, 3, run.time.size)))
    with pytest.raises(BadInput, match=field):
        selected_signal(bare, view)


def test_a_sine_shows_its_amplitude(run):
    phase = 2 * np.pi * 100 * run.time
    force = np.zeros_like(run.bearing_force)
    force[1, 0] = 5.0 + 3.0 * np.cos(phase)
    force[1, 1] = 4.0 * np.sin(phase)
    sine = replace(run, bearing_force=force)
    window = slice(0, int(run.sample_rate))  # 1 s
    for scale, factor in (("peak", 1.0), ("rms", np.sqrt(0.5))):
        signal = selected_signal(sine, RunView(scale=scale))
        frequency, amplitude = amplitude_spectrum(sine, signal, window)
        assert frequency[np.argmax(amplitude)] == 100.0
        assert amplitude.max() == pytest.approx(5.0 * factor, rel=1e-9)
        assert amplitude[frequency > 110].max() < 1e-9


def test_mesh_orders_are_found_where_they_are(run):
    window = spectrum_window(run.time)
    mesh = run.mesh_frequency[0, window]
    frequency, amplitude = amplitude_spectrum(run, selected_signal(run, RunView()), window)
    (first, weak), (second, strong), *others = order_amplitudes(frequency, amplitude, mesh)
    assert mesh.min() - 10 <= first <= mesh.max() + 10
    assert second == pytest.approx(2 * first, abs=10)
    assert strong > weak > 20 * max(amplitude for _, amplitude in others)


def test_orders_are_marked_at_multiples_of_the_mesh_frequency(run):
    (panel,) = signal_spectrum(run, selected_signal(run, RunView())).content
    marks = [reference.value for reference in panel.references]
    np.testing.assert_allclose(marks, np.arange(1, 7) * marks[0])  # what the rate holds
    assert marks[0] == pytest.approx(20 * 900 * 0.925 / 60, rel=1e-3)
    assert panel.y.scale == "log"


def test_a_run_without_bearing_forces_shows_its_mesh_force(run):
    bare = replace(run, bearing=(), bearing_force=np.empty((0, 3, run.time.size)))
    titles = [section.title for section in dynamic_results(bare, RunView())]
    assert titles == ["Dynamic transmission error", "Mesh force of mesh", "Levels and orders", "Mesh forces"]
    titles[1] = "Force on bearing right"
    assert [section.title for section in dynamic_results(run, RunView())] == titles


def test_the_audit_and_the_step_error_are_told(run):
    tables = {t.caption: t for s in dynamic_making(run) for t in (*s.tables, *s.folded)}
    accuracy = dict(tables["Accuracy of the run"].rows)
    assert accuracy["step error, nm rms (step control)"] == "1.00"
    assert ("residual", "0") in tables["Energy audit, J"].rows
    (row,) = tables["Effects"].rows
    assert row == ("lateral", "input", "yes", "1 µm along the line of action at rest", "r")
    assert dynamic_headlines(run)[0].remark == "nominal 2660 N"


def test_a_run_that_ended_early_says_so(run):
    assert dynamic_alarms(run) == ()
    (alarm,) = dynamic_alarms(replace(run, status=RunStatus.STEP_FLOOR))
    assert "ended early at 2 s: step floor" in alarm


def test_the_envelope_keeps_every_peak():
    rng = np.random.default_rng(7)
    time = np.linspace(0.0, 5.0, 100_001)
    values = rng.normal(size=time.size)
    values[[333, 77_777]] = [9.0, -9.0]
    thin_time, thin = envelope(time, values, 500)
    assert len(thin) <= 1002
    assert np.all(np.diff(thin_time) > 0)
    assert (thin.max(), thin.min()) == (9.0, -9.0)
    stretches = np.linspace(0, time.size, 501).astype(int)
    for first, last in pairwise(stretches):
        inside = (thin_time >= time[first]) & (thin_time <= time[last - 1])
        assert thin[inside].max() == values[first:last].max()


def test_a_short_series_stays_whole():
    time = np.arange(10.0)
    np.testing.assert_array_equal(envelope(time, time**2)[1], time**2)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("target", [100.0, 400.0, 900.0])
def test_a_window_holds_whole_pitches_around_the_speed(target, sign):
    time = np.linspace(0.0, 5.0, 100_001)
    speed = sign * 191.0 * time
    position = sign * 20 * 191.0 / 60 * time**2 / 2
    chosen = Travel(speed, position).window(target)
    traveled = np.abs(position[chosen])
    assert np.ptp(traveled) == pytest.approx(3.0, abs=0.02)
    assert traveled[0] % 1.0 == pytest.approx(0.0, abs=0.02)
    assert np.abs(speed[chosen]).min() <= target <= np.abs(speed[chosen]).max()


def test_a_window_at_the_end_of_the_run_stays_inside():
    time = np.linspace(0.0, 1.0, 1001)
    chosen = Travel(np.ones_like(time), 10 * time).window(5.0)
    assert chosen.stop <= time.size
    assert np.ptp(10 * time[chosen]) >= 2.9


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_run_at_one_speed_is_shown_at_that_speed_at_its_end(sign):
    time = np.linspace(0.0, 1.0, 1001)
    speed = sign * (3000.0 + np.cos(400.0 * time))
    (shown,) = window_speeds(speed)
    assert shown == pytest.approx(3000.0, abs=1.0)
    chosen = Travel(speed, sign * 50.0 * time).window(shown)
    assert 50.0 * time[chosen][0] == pytest.approx(47.0) and chosen.stop == time.size


def test_speeds_that_a_run_does_not_pass_are_not_shown():
    assert window_speeds(np.array([500.0, 1000.0])) == (900.0,)
    assert window_speeds(np.array([350.0, 1000.0])) == (400.0, 900.0)
    assert window_speeds(np.array([940.0, 820.0])) == (820.0,)  # 846 is rounded to 800


def test_speeds_are_round():
    assert window_speeds(np.array([0.0, 955.0])) == (100.0, 400.0, 900.0)
    assert window_speeds(np.array([-167.0, 0.0])) == (20.0, 70.0, 150.0)


def test_every_source_has_its_row_and_unknown_ones_have_none():
    scene = gear_pair_scene(duration=0.2, effects={"lateral": "off"})
    full = dict(_accuracy(simulate(scene)).rows)
    lean = dict(_accuracy(simulate(replace(scene, outputs=Outputs(receipt="minimal")))).rows)
    for start in ("step error", "table error", "neglected effects"):
        assert sum(title.startswith(start) for title in full) >= 1
    for start in ("table error", "neglected effects"):
        assert not any(title.startswith(start) for title in lean)
    assert [value for title, value in lean.items() if title.startswith("step error")] == ["1.00"]
