"""Laws that the figures of an STE database obey, and their captions."""

import math
from collections.abc import Callable
from dataclasses import asdict, replace

import numpy as np
import pytest

from bounds.error_digits import to_error
from fe_contact.geometry import Gear, GearPair
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.fields import DIMENSIONS
from lineofaction.gearbox.convert.answers import curve_json, metadata_json
from lineofaction.report.drawing.figure import Panel
from lineofaction.report.flank.flank import line_load_figure
from lineofaction.report.pair import iso_mesh_stiffness
from lineofaction.report.ste.curves import (
    drawn_loads,
    drawn_pitches,
    drawn_rows,
    drawn_ste,
    position_axis,
    ste_curves,
)
from lineofaction.report.ste.over_torque import (
    deviation_curves,
    face_load,
    has_deviations,
    has_face_load,
    ripple_over_torque,
)
from lineofaction.report.ste.page import static_results
from lineofaction.report.ste.stiffness import (
    load_sharing,
    mesh_stiffness,
    pair_shares,
    secant_stiffness_curves,
)


def test_two_pitches_repeat_the_period(database):
    position, values = drawn_ste(database)
    first = position < 1.0
    second = (position >= 1.0) & (position < 2.0)
    assert position[0] == 0.0
    assert position[-1] == 2.0
    np.testing.assert_array_equal(position[first] + 1.0, position[second])
    np.testing.assert_array_equal(values[first], values[second])
    np.testing.assert_array_equal(values[0], values[-1])


def test_stored_points_are_on_the_curve(database):
    position, values = drawn_ste(database)
    at = np.searchsorted(position, database.position)
    stored = database.static_transmission_error[:, :, 0, 0]
    np.testing.assert_allclose(values[at], stored, rtol=1e-9)


def panels_of(database: SteDatabase) -> tuple[Panel, ...]:
    return ste_curves(database).content


def test_the_ripple_is_drawn_in_micrometers_with_its_mean_in_the_label(database):
    """And in the Harris map every load is higher than the last by the same step."""
    ripple, harris = panels_of(database)
    assert [line.name for line in ripple.lines] == ["10 N m", "100 N m", "400 N m"]
    position, ste = drawn_ste(database)
    offsets = []
    for load, line, mapped in zip(drawn_loads(database), ripple.lines, harris.lines, strict=True):
        curve = database.curve(force=float(database.force[load]))
        np.testing.assert_array_equal(line.x, position)
        np.testing.assert_allclose(line.y, 1e6 * (ste[:, load] - curve.mean.value), rtol=1e-9)
        offsets.append(mapped.y - line.y)
        numbers = (to_error(1e6 * e.value, 1e6 * e.error) for e in (curve.mean, curve.peak_to_peak))
        assert line.label == "{}: mean {} µm\n{} µm peak to peak".format(line.name, *numbers)
        assert mapped.label == line.name
    steps = np.diff(offsets, axis=0)
    assert steps.min() > 0.0
    np.testing.assert_allclose(steps, steps[0, 0], rtol=1e-9)


def test_the_band_is_half_the_error_of_peak_to_peak(database):
    lines = panels_of(database)[0].lines
    for load, line in zip(drawn_loads(database), lines, strict=True):
        error = database.peak_to_peak(force=float(database.force[load])).error
        assert 2.0 * line.band == pytest.approx(1e6 * error)


def test_the_table_has_every_load_with_its_error(database):
    table = ste_curves(database).table
    assert [row[0] for row in table.rows] == ["0.4 N m", "10 N m", "100 N m", "400 N m"]
    assert table.rows[2][2] == "5.978 ± 0.012"


def test_each_pair_passes_as_the_one_before_did_a_pitch_earlier(database):
    position, followed = pair_shares(database, 2)
    pitch = len(database.position)
    np.testing.assert_array_equal(followed[-1][pitch:], followed[0][: pitch + 1])
    carried = position[followed[-1] > 0]
    assert 0.28 < carried[0] < 0.31  # enters
    assert 1.69 < carried[-1] < 1.72  # leaves
    assert np.all(np.diff(carried) < 0.02)  # without a gap


def test_secant_stiffness_is_force_over_ste_and_width(database):
    _, values = secant_stiffness_curves(database)
    ste = database.static_transmission_error[0, 2, 0, 0]
    assert values[0, 2] == pytest.approx(100.0 / 0.0375877 / ste / 0.025)


def test_the_iso_line_has_the_standard_s_value(database):
    (panel,) = mesh_stiffness(database).content
    (reference,) = panel.references
    assert reference.value == pytest.approx(16.28 * 210.0 / 206.0, abs=0.006)  # method B, in steel of 210 GPa
    assert reference.direction == "horizontal"


def test_a_database_without_a_case_has_no_iso_line(database):
    bare = replace(database, metadata=Metadata())
    assert iso_mesh_stiffness(bare) is None
    assert mesh_stiffness(bare).content[0].references == ()


def test_failed_points_are_gaps_and_the_rest_is_drawn(damaged):
    position, values = drawn_ste(damaged)
    assert math.isnan(values[5, 2])
    assert np.count_nonzero(np.isnan(values)) == 2
    assert len(position) == 129
    for figure in (ste_curves, load_sharing, mesh_stiffness):
        assert figure(damaged).alternative


def test_a_request_made_from_python_has_the_same_iso_line(database):
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    request = {"pair": asdict(GearPair(gear, gear, 80e-3)), "normal_force": [2660.0]}
    from_python = replace(database, metadata=Metadata(case=request))
    assert iso_mesh_stiffness(from_python) == pytest.approx(iso_mesh_stiffness(database))


def test_a_single_load_is_drawn_without_a_map(database):
    cut = {
        name: np.take(getattr(database, name), [2], axis=axes.index("force"))
        for name, axes in {"force": ("force",), **DIMENSIONS}.items()
        if "force" in axes
    }
    (ripple,) = panels_of(replace(database, **cut))
    mean = database.mean(force=float(database.force[2]))
    assert ripple.lines[0].label.startswith(
        f"100 N m: mean {to_error(1e6 * mean.value, 1e6 * mean.error)} µm"
    )


def test_ripple_over_torque_is_that_of_the_curves(database):
    """Lines have loads between the requested ones, as the table interpolates; points are the requested."""
    ripple, *amplitudes = ripple_over_torque(database).content
    line, points = ripple.lines
    requested = database.torque[list(drawn_loads(database))]
    assert points.markers and np.array_equal(points.x, requested)
    assert line.x.size == 8 * (requested.size - 1) + 1 and np.array_equal(line.x[::8], requested)
    dotted = [[drawn for drawn in panel.lines if drawn.label] for panel in amplitudes]
    assert [[drawn.label for drawn in lines] for lines in dotted] == [list("12345678")] * 2
    for k, torque in enumerate(line.x):
        curve = database.curve(torque=float(torque))
        assert line.y[k] == pytest.approx(1e6 * curve.peak_to_peak.value)
        assert line.band[k] == pytest.approx(1e6 * curve.peak_to_peak.error)
        for panel, lines, decibels in zip(amplitudes, dotted, (False, True), strict=True):
            for tone, drawn in zip(curve.harmonics, lines, strict=False):
                size = 1e6 * tone.value
                assert drawn.y[k] == pytest.approx(20.0 * math.log10(size) if decibels else size)
                sure = [other for other in panel.lines if other.name == drawn.name and other is not drawn]
                known = [other.y[other.x == torque] for other in sure if torque in other.x]
                assert np.isfinite(known).any() == (tone.error < tone.value)
    assert "ripple" in [f.key for s in static_results(database) for f in s.figures]


def test_a_least_ripple_between_requested_torques_is_said(database):
    """Curves of two loads in antiphase cancel somewhere between."""
    wave = np.cos(2.0 * np.pi * database.position)[:, None, None, None]
    size, mean = np.array([[1.0, -1.0, 3.0, 4.0], [10.0, 20.0, 30.0, 40.0]])[..., None, None]
    ste = 1e-6 * (size * wave + mean)
    opposed = replace(database, static_transmission_error=ste, error_estimate=1e-3 * np.abs(ste))
    figure = ripple_over_torque(opposed)
    line, _ = figure.content[0].lines
    least = int(line.y.argmin())
    assert line.y[least] < 0.5 and least % 8
    said = f" Between them it falls to {line.y[least]:.3g} µm, at {line.x[least]:.3g} N m."
    assert figure.alternative.endswith(said)
    assert "Between them" not in ripple_over_torque(database).alternative


SKEW = np.array([-20e-6, 0.0, 40e-6])
CHANGE = np.array([0.0, 0.1e-3])
RIPPLE = np.array([[1.5, 1.2], [1.0, 0.8], [3.0, 2.4]])
"""Factor of the whole curve, and so of its peak-to-peak, at each misalignment and center distance."""


@pytest.fixture
def deviating(database):
    grid = (64, 4, 3, 2)
    arrays = {
        name: np.broadcast_to(getattr(database, name), grid + getattr(database, name).shape[4:])
        for name in ("tangent_compliance", "load_share", "pairs_in_contact", "status", "residuals")
    }
    ste = database.static_transmission_error * RIPPLE
    centroid = np.broadcast_to(-100.0 * SKEW[:, None], grid) + 1e-3 * database.position[:, None, None, None]
    return replace(
        database,
        misalignment=SKEW,
        center_distance_change=CHANGE,
        static_transmission_error=ste,
        error_estimate=0.002 * ste,
        no_load_transmission_error=np.zeros((64, 3, 2)),
        face_centroid=centroid,
        max_pressure=np.broadcast_to(7e8 + 1e13 * np.abs(SKEW[:, None]), grid),
        **arrays,
    )


def test_peak_to_peak_over_either_deviation_alone(deviating):
    figure = deviation_curves(deviating)
    over_skew, over_change = figure.content
    assert [line.name for line in over_skew.lines] == ["10 N m", "100 N m", "400 N m"]
    assert over_skew.lines[0].x == pytest.approx([-20.0, 0.0, 40.0])
    assert over_change.lines[0].x == pytest.approx([0.0, 0.1])
    for k, line in enumerate(over_skew.lines, start=1):
        nominal = 1e6 * np.ptp(deviating.static_transmission_error[:, k, 1, 0])
        assert line.y == pytest.approx(nominal * RIPPLE[:, 0], rel=1e-3)
        assert over_change.lines[k - 1].y == pytest.approx(nominal * RIPPLE[1], rel=1e-3)


def test_an_axis_of_one_value_has_no_panel(deviating):
    names = ("static_transmission_error", "tangent_compliance", "load_share", "pairs_in_contact", "status",
             "residuals", "error_estimate", "face_centroid", "max_pressure")  # fmt: skip
    cut = {name: getattr(deviating, name)[:, :, :1] for name in names}
    narrow = replace(
        deviating,
        misalignment=SKEW[1:2],
        no_load_transmission_error=np.zeros((64, 1, 2)),
        **cut,
    )
    (panel,) = deviation_curves(narrow).content
    assert panel.x.label == "change of the center distance, mm"


def test_the_table_names_every_deviation_with_its_unit(deviating):
    table = deviation_curves(deviating).table
    assert [row[0] for row in table.rows] == [
        "misalignment -20.0 µm", "misalignment 0 µm", "misalignment 40.0 µm",
        "change of the center distance 0 mm", "change of the center distance 0.100 mm",
    ]  # fmt: skip
    assert table.head == ("deviation", "10 N m", "100 N m", "400 N m")


def test_centroid_and_pressure_at_every_misalignment(deviating):
    figure = face_load(deviating)
    centroid, pressure = figure.content
    assert [line.name for line in centroid.lines] == [
        "misalignment -20.0 µm", "misalignment 0 µm", "misalignment 40.0 µm",
    ]  # fmt: skip
    assert centroid.lines[2].y[0] == pytest.approx(-4.0)
    assert centroid.lines[2].y[64] == centroid.lines[2].y[0] == centroid.lines[2].y[128]
    assert pressure.lines[0].y == pytest.approx(900.0)
    assert "from -4.00 to 2.98 mm" in figure.alternative
    assert "1100 MPa" in figure.alternative


def test_they_are_on_the_page_only_where_there_is_something_to_show(database, deviating):
    def keys(table):
        return {figure.key for section in static_results(table) for figure in section.figures}

    assert not has_deviations(database) and not has_face_load(database)
    assert has_deviations(deviating) and has_face_load(deviating)
    assert keys(deviating) - keys(database) == {"deviations", "face_load"}


def test_failed_points_leave_gaps_and_no_error(deviating):
    ste, status = deviating.static_transmission_error.copy(), np.array(deviating.status)
    centroid = np.array(deviating.face_centroid)
    ste[5, 2, 0, 0], centroid[5, 2, 0, 0], status[5, 2, 0, 0] = np.nan, np.nan, 1
    failed = replace(deviating, static_transmission_error=ste, status=status, face_centroid=centroid)
    assert has_face_load(failed)
    panel, _ = face_load(failed).content
    assert np.isnan(panel.lines[0].y[5])
    first, _ = deviation_curves(failed).content
    assert np.all(np.isfinite(first.lines[0].y))


Tables = Callable[..., SteDatabase]


def test_a_period_is_shown_whole_once(with_pitch_errors):
    table = with_pitch_errors()
    position, values = drawn_ste(table)
    assert (position[0], position[-1]) == (0.0, 3.0)
    assert np.all(np.diff(position) > 0.0)
    assert values[-1] == pytest.approx(values[0])
    assert position_axis(table).limits == (0, 3)
    at = np.searchsorted(position, table.position)
    assert values[at] == pytest.approx(table.static_transmission_error[:, :, 0, 0], rel=1e-9)
    assert "3 base pitches" in ste_curves(table).title
    assert "after 3 base pitches" in ste_curves(table).caption


def test_of_a_long_period_the_first_pitches_are_shown_and_go_on(with_pitch_errors):
    table = with_pitch_errors(50)
    position, values = drawn_ste(table)
    assert (drawn_pitches(table), position[-1]) == (40, 40.0)
    assert values[-1] == pytest.approx(table.static_transmission_error[40 * 64, :, 0, 0])
    rows = drawn_rows(table)[1]
    assert (rows[-1], rows.size) == (40 * 64, 40 * 64 + 1)


@pytest.mark.parametrize("period", [1, 3, 50])
def test_every_pair_is_followed_and_the_shares_sum_to_one(with_pitch_errors, database, period):
    table = database if period == 1 else with_pitch_errors(period)
    position, followed = pair_shares(table, 2)
    assert np.sum(list(followed.values()), axis=0) == pytest.approx(np.ones(position.size))
    assert len(followed) == drawn_pitches(table) + 1
    for share in followed.values():  # one stretch of mesh each
        assert np.count_nonzero(np.diff((share > 0.0).astype(int)) == 1) <= 1


def test_the_largest_force_on_a_pair_is_that_of_all_pitches(with_pitch_errors):
    """Also where it lies beyond those that are drawn: three pairs share in all pitches but the last."""
    table = with_pitch_errors(50)
    share = table.load_share.copy()
    share[: 49 * 64] = 1.0 / 3.0
    maximum = load_sharing(replace(table, load_share=share))
    assert "A pair carries at most 10642 N, 100 % of the load, at 400 N m." in maximum.alternative
    assert "in 1.1 % of the mesh cycle at 10 N m" in maximum.alternative  # 0.57 of one pitch in 50


def test_the_caption_says_where_a_period_is_longer_than_what_is_drawn(with_pitch_errors, database):
    assert "Shown are the first 40 of 41 base pitches." in load_sharing(with_pitch_errors(41)).caption
    for whole in (with_pitch_errors(40), with_pitch_errors(3), database):
        assert "Shown are" not in load_sharing(whole).caption


def test_the_static_part_is_made_without_the_secant_stiffness(with_pitch_errors, database):
    table = with_pitch_errors()
    keys = [figure.key for section in static_results(table) for figure in section.figures]
    assert "mesh_stiffness" not in keys
    assert {"ste", "load_sharing", "ste_spectrum"} <= set(keys)
    assert "mesh_stiffness" in [f.key for section in static_results(database) for f in section.figures]
    assert len(load_sharing(table).content) == 3
    panel = face_load(table).content[0]
    assert panel.lines[0].x[-1] == 3.0


def test_answers_hold_the_period_and_its_orders(with_pitch_errors, database):
    answer = curve_json(with_pitch_errors(), torque_n_m=100.0)
    assert answer["period"] == 3
    assert answer["order"][:3] == pytest.approx([1 / 3, 2 / 3, 1.0])
    assert answer["amplitude_um"][0] > 1.0
    assert answer["amplitude_um"][2] == pytest.approx(answer["harmonics_um"][0])
    plain = curve_json(database, torque_n_m=100.0)
    assert plain["period"] == 1
    assert "order" not in plain
    assert metadata_json(with_pitch_errors())["period"] == 3


def of_high_contact_ratio(database: SteDatabase, more: int = 1, helix: float = 0.0) -> SteDatabase:
    """Return the table with as many more pairs in contact everywhere, sharing alike."""
    counts = database.pairs_in_contact + more
    pairs = np.arange(int(counts.max()))
    share = (pairs < counts[..., None]) / counts[..., None]
    geometry = replace(database.geometry, base_helix_angle=helix)
    torque = database.torque * math.cos(helix)
    return replace(
        database, pairs_in_contact=counts, load_share=share, pair=pairs, geometry=geometry, torque=torque
    )


def words(database: SteDatabase) -> str:
    figures = [plot(database) for plot in (ste_curves, load_sharing)]
    return " ".join(f"{figure.caption} {figure.alternative}" for figure in figures)


def test_a_pair_of_contact_ratio_one_and_a_half_is_told_by_its_numbers(database):
    text = words(database)
    assert "1 or 2 tooth pairs carry the load" in text
    assert "One pair carries the whole load in" in text
    assert "low where more do, high where fewer" in text
    assert "single" not in text


def test_a_helical_pair_has_no_steps(database):
    text = words(of_high_contact_ratio(database, 2, helix=0.3))
    assert "3 or 4 tooth pairs carry the load" in text
    assert "low where" not in text


def test_a_number_of_pairs_that_never_changes_is_said_so(database):
    same = replace(database, pairs_in_contact=np.full_like(database.pairs_in_contact, 2))
    assert "2 tooth pairs carry the load at every position" in words(same)
    assert "low where" not in words(same)


def test_a_gap_plot_that_shows_nothing_is_left_out(flanks):
    figure = line_load_figure(replace(flanks, gap=np.zeros_like(flanks.gap)))
    assert [panel.y.label for panel in figure.content if isinstance(panel, Panel)] == [
        "load per face width, N/mm"
    ]
    assert figure.title == "Load over the face"
    assert "Below" not in figure.caption and "no gap" in figure.caption


@pytest.mark.parametrize(("helix", "uneven"), [(0.0, False), (0.2, True)])
def test_only_a_helical_pair_is_uneven_at_a_single_position(flanks, helix, uneven):
    figure = line_load_figure(replace(flanks, base_helix_angle=helix))
    assert ("A single position is uneven" in figure.caption) == uneven
