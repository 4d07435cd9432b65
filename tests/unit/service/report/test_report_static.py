"""Laws that the figures of an STE database obey."""

import math
from dataclasses import asdict, replace

import numpy as np
import pytest

from fe_contact.geometry import Gear, GearPair
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.fields import DIMENSIONS
from lineofaction.report.drawing.figure import Panel, number
from lineofaction.report.pair import iso_mesh_stiffness
from lineofaction.report.ste.curves import shown_loads, ste_curves, ste_shown
from lineofaction.report.ste.over_torque import ripple_over_torque
from lineofaction.report.ste.page import static_results
from lineofaction.report.ste.stiffness import _pair_shares, _secant_stiffness, load_sharing, mesh_stiffness


def test_two_pitches_repeat_the_period(database: SteDatabase) -> None:
    position, values = ste_shown(database)
    first = position < 1.0
    second = (position >= 1.0) & (position < 2.0)
    assert position[0] == 0.0
    assert position[-1] == 2.0
    np.testing.assert_array_equal(position[first] + 1.0, position[second])
    np.testing.assert_array_equal(values[first], values[second])
    np.testing.assert_array_equal(values[0], values[-1])


def test_stored_points_are_on_the_curve(database: SteDatabase) -> None:
    position, values = ste_shown(database)
    at = np.searchsorted(position, database.position)
    stored = database.static_transmission_error[:, :, 0, 0]
    np.testing.assert_allclose(values[at], stored, rtol=1e-9)


def panels_of(database: SteDatabase) -> tuple[Panel, ...]:
    return ste_curves(database).content


def test_the_ripple_is_drawn_in_micrometers_with_its_mean_in_the_label(database: SteDatabase) -> None:
    """And in the Harris map every load is higher than the last by the same step."""
    ripple, harris = panels_of(database)
    assert [line.name for line in ripple.lines] == ["10 N m", "100 N m", "400 N m"]
    position, ste = ste_shown(database)
    offsets = []
    for load, line, mapped in zip(shown_loads(database), ripple.lines, harris.lines, strict=True):
        curve = database.curve(force=float(database.force[load]))
        np.testing.assert_array_equal(line.x, position)
        np.testing.assert_allclose(line.y, 1e6 * (ste[:, load] - curve.mean.value), rtol=1e-9)
        offsets.append(mapped.y - line.y)
        numbers = (number(1e6 * e.value, 3) for e in (curve.mean, curve.peak_to_peak))
        assert line.label == "{}: mean {} µm,\n{} µm peak to peak".format(line.name, *numbers)
        assert mapped.label == line.name
    steps = np.diff(offsets, axis=0)
    assert steps.min() > 0.0
    np.testing.assert_allclose(steps, steps[0, 0], rtol=1e-9)


def test_the_band_is_half_the_error_of_peak_to_peak(database: SteDatabase) -> None:
    lines = panels_of(database)[0].lines
    for load, line in zip(shown_loads(database), lines, strict=True):
        error = database.peak_to_peak(force=float(database.force[load])).error
        assert 2.0 * line.band == pytest.approx(1e6 * error)


def test_the_table_has_every_load_with_its_error(database: SteDatabase) -> None:
    table = ste_curves(database).table
    assert table is not None
    assert [row[0] for row in table.rows] == ["0.4 N m", "10 N m", "100 N m", "400 N m"]
    assert table.rows[2][2] == "5.978 ± 0.012"


def test_the_load_that_serves_lift_off_is_not_drawn(database: SteDatabase) -> None:
    assert shown_loads(database) == (1, 2, 3)


def test_shares_sum_to_one_wherever_a_pair_is(database: SteDatabase) -> None:
    position, followed = _pair_shares(database, 2)
    total = np.sum(list(followed.values()), axis=0)
    assert position[-1] == 2.0
    np.testing.assert_allclose(total, 1.0, atol=1e-12)


def test_each_pair_passes_as_the_one_before_did_a_pitch_earlier(database: SteDatabase) -> None:
    position, followed = _pair_shares(database, 2)
    pitch = len(database.position)
    np.testing.assert_array_equal(followed[-1][pitch:], followed[0][: pitch + 1])
    carried = position[followed[-1] > 0]
    assert 0.28 < carried[0] < 0.31  # enters
    assert 1.69 < carried[-1] < 1.72  # leaves
    assert np.all(np.diff(carried) < 0.02)  # without a gap


def test_load_sharing_shows_three_loads(database: SteDatabase) -> None:
    titles = [panel.title for panel in load_sharing(database).content]  # type: ignore[union-attr]
    assert titles == ["10 N m", "100 N m", "400 N m"]


def test_secant_stiffness_is_force_over_ste_and_width(database: SteDatabase) -> None:
    _, values = _secant_stiffness(database)
    ste = database.static_transmission_error[0, 2, 0, 0]
    assert values[0, 2] == pytest.approx(100.0 / 0.0375877 / ste / 0.025)


def test_the_iso_line_has_the_standard_s_value(database: SteDatabase) -> None:
    (panel,) = mesh_stiffness(database).content  # type: ignore[misc]
    (reference,) = panel.references
    assert reference.value == pytest.approx(16.28 * 210.0 / 206.0, abs=0.006)  # method B, in steel of 210 GPa
    assert reference.direction == "horizontal"


def test_a_database_without_a_case_has_no_iso_line(database: SteDatabase) -> None:
    bare = replace(database, metadata=Metadata())
    assert iso_mesh_stiffness(bare) is None
    assert mesh_stiffness(bare).content[0].references == ()  # type: ignore[index]


def test_failed_points_are_gaps_and_the_rest_is_drawn(damaged: SteDatabase) -> None:
    position, values = ste_shown(damaged)
    assert math.isnan(values[5, 2])
    assert np.count_nonzero(np.isnan(values)) == 2
    assert len(position) == 129
    for figure in (ste_curves, load_sharing, mesh_stiffness):
        assert figure(damaged).alternative


def test_a_request_made_from_python_has_the_same_iso_line(database: SteDatabase) -> None:
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    request = {"pair": asdict(GearPair(gear, gear, 80e-3)), "normal_force": [2660.0]}
    from_python = replace(database, metadata=Metadata(case=request))
    assert iso_mesh_stiffness(from_python) == pytest.approx(iso_mesh_stiffness(database))


def test_a_single_load_is_drawn_without_a_map(database: SteDatabase) -> None:
    cut = {
        name: np.take(getattr(database, name), [2], axis=axes.index("force"))
        for name, axes in {"force": ("force",), **DIMENSIONS}.items()
        if "force" in axes
    }
    (ripple,) = panels_of(replace(database, **cut))
    mean = 1e6 * database.mean(force=float(database.force[2])).value
    assert ripple.lines[0].label.startswith(f"100 N m: mean {number(mean, 3)} µm")


def test_ripple_over_torque_is_that_of_the_curves(database: SteDatabase) -> None:
    ripple, linear, level = ripple_over_torque(database).content
    (line,) = ripple.lines
    solid = [{drawn.name: drawn for drawn in panel.lines if not drawn.label} for panel in (linear, level)]
    dotted = [[drawn for drawn in panel.lines if drawn.label] for panel in (linear, level)]
    assert [[drawn.label for drawn in lines] for lines in dotted] == [list("12345678")] * 2
    for k, load in enumerate(shown_loads(database)):
        curve = database.curve(force=float(database.force[load]))
        assert line.y[k] == pytest.approx(1e6 * curve.peak_to_peak.value)
        assert line.band[k] == pytest.approx(1e6 * curve.peak_to_peak.error)
        for one, *lines in zip(curve.harmonics, *dotted, strict=False):
            values = 1e6 * one.value, 20.0 * math.log10(1e6 * one.value)
            for value, drawn, sure in zip(values, lines, solid, strict=True):
                assert drawn.y[k] == pytest.approx(value)
                if drawn.name in sure:
                    assert math.isnan(sure[drawn.name].y[k]) == (one.error >= one.value)
                else:
                    assert one.error >= one.value
    assert "ripple" in [f.key for s in static_results(database) for f in s.figures]
