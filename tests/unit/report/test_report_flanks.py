"""What the report shows of the flanks: pressure, contact lines, load over the face."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.contour import ContourSet

from fe_contact.analysis.flanks.load_distribution import FlankErrors
from fe_contact.analysis.flanks.pressure_map import pressure_map
from lineofaction.gearbox.convert.operating_point import typed
from lineofaction.report.document import write_report
from lineofaction.report.drawing.figure import Panel, Strokes, number
from lineofaction.report.drawing.image import panel_sheet, png
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.flank.flank import (
    PAGE,
    _isolines,
    _text,
    contact_lines,
    contact_pattern_figure,
    line_load_figure,
    load_centroid_figure,
)


def panels(figure: object) -> tuple[Panel, ...]:
    return figure.content


def test_the_pattern_passes_through_the_pressures_that_were_computed(flanks):
    """At the roll length of every contact, and between its neighbors elsewhere; nothing in the last slice."""
    for roll, panel in zip(
        (flanks.roll_length_1, flanks.roll_length_2), panels(contact_pattern_figure(flanks)), strict=True
    ):
        shade = panel.shade
        for k in range(flanks.face_position.size):
            here = flanks.on_path[:, :, k]
            for at, pressure in zip(
                1e3 * roll[:, :, k][here], 1e-6 * flanks.pressure[:, :, k][here], strict=True
            ):
                assert np.interp(at, shade.y, shade.z[:, k]) == pytest.approx(pressure, rel=1e-9)
        assert np.all(shade.z[:, -1] == 0.0)
        assert shade.largest == pytest.approx(1e-6 * flanks.pressure.max())
        assert 0.0 < shade.isolines[0] < shade.isolines[-1] < shade.largest
        assert panel.y.limits[0] < shade.y[0] < shade.y[-1] < panel.y.limits[1]


def test_an_image_has_the_lines_of_equal_pressure_at_their_values(flanks):
    content = panels(contact_pattern_figure(flanks))
    drawn = [part for ax in panel_sheet(content).axes for part in ax.collections]
    for panel, lines in zip(content, [d for d in drawn if isinstance(d, ContourSet)], strict=True):
        assert list(lines.levels) == pytest.approx(panel.shade.isolines)
        values = {text.get_text() for text in lines.labelTexts}
        assert values and values <= {f"{value:g}" for value in panel.shade.isolines}


def test_a_pressure_that_falls_along_the_path_is_interpolated_without_steps(flanks):
    """A plane over roll length comes back as it is, at ends of the path within a step of the positions."""
    lowest = flanks.roll_length_1[flanks.on_path].min()
    falling = np.where(flanks.on_path, 1e9 - 1e10 * (flanks.roll_length_1 - lowest), 0.0)
    tilted = replace(flanks, pressure=falling, force=falling)
    rows, pressure = pressure_map(tilted, tilted.roll_length_1)
    step = flanks.scene.geometry.base_pitch / flanks.position.size
    inside = (rows > rows[0] + step) & (rows < rows[-1] - step)
    assert np.count_nonzero(inside) > 50
    plane = (1e9 - 1e10 * (rows - lowest))[inside, None]
    assert np.abs(pressure[inside] - plane).max() < 1e-3 * 1e9


def test_a_tip_edge_that_passes_lightly_takes_nothing_from_the_pattern(flanks):
    """It scrapes over a place before the flanks roll there; the larger pressure of both counts."""
    roll, on_path, pressure = (np.array(x) for x in (flanks.roll_length_1, flanks.on_path, flanks.pressure))
    force = np.array(flanks.force)
    first = np.argwhere(~on_path[:, :, 0])[0]
    at = (first[0], first[1], 0)
    roll[at], force[at], pressure[at] = np.median(roll[flanks.on_path]), 1.0, 1e6
    light = replace(flanks, roll_length_1=roll, force=force, pressure=pressure)
    before, after = (pressure_map(one, one.roll_length_1)[1] for one in (flanks, light))
    np.testing.assert_allclose(after, before, rtol=1e-9)


@pytest.mark.parametrize("largest", [0.3, 1.0, 999.0, 1001.0, 1597.0, 6000.0])
def test_isolines_are_few_and_round(largest):
    levels = _isolines(largest)
    assert 1 <= len(levels) <= 6
    assert levels[-1] < largest
    assert f"{levels[0]:.0e}"[0] in "125"
    assert np.diff([0.0, *levels]) == pytest.approx(levels[0])


def test_the_marks_of_the_pattern_are_diameters_of_that_gear(flanks):
    pinion, wheel = panels(contact_pattern_figure(flanks))
    labels = [[mark.label for mark in panel.references] for panel in (pinion, wheel)]
    a = flanks.scene.geometry.center_distance
    pitch = [2e3 * a * z / 45 for z in (19, 26)]
    for row, diameter in zip(labels, pitch, strict=True):
        assert row[1] == f"pitch point, d {diameter:.4g} mm"
    assert labels[0][2].startswith("tip, d 66.66")  # 19 teeth of module 3/cos 20 deg, and two modules


def test_strokes_carry_the_force_and_run_as_the_helix_does(flanks):
    """Line load times length over all strokes of the lower panel is the force of that position."""
    upper, lower = panels(contact_lines(flanks))
    assert isinstance(upper.shade, Strokes) and isinstance(lower.shade, Strokes)
    slope = np.diff(upper.shade.y, axis=1) / np.diff(upper.shade.x, axis=1)
    assert slope == pytest.approx(-math.tan(flanks.base_helix_angle), rel=1e-9)
    length = np.diff(upper.shade.x, axis=1)[:, 0] / math.cos(flanks.base_helix_angle)
    chosen = flanks.force[::2]
    assert float(upper.shade.value @ length) == pytest.approx(chosen.sum(), rel=1e-12)
    assert len(upper.shade.value) == np.count_nonzero(flanks.on_path[::2])
    assert np.count_nonzero(upper.shade.value == 0.0) > 0
    low, high = flanks.scene.path_of_contact[0], flanks.scene.path_of_contact[-1]
    middles = upper.shade.y.mean(axis=1)
    assert middles.min() >= 1e3 * low - 1e-9 and middles.max() <= 1e3 * high + 1e-9


def test_the_load_over_the_face_and_its_factor(flanks):
    load, gap = panels(line_load_figure(flanks))
    mean = load.lines[-1]
    assert mean.name == "mean over the positions"
    assert mean.y == pytest.approx(1e-3 * flanks.face_load.mean(axis=0))
    assert len(load.lines) == 5
    assert all(np.nanmin(line.y) == 0.0 for line in gap.lines)
    centroid, factor = panels(load_centroid_figure(flanks))
    assert centroid.lines[0].x[-1] == 1.0
    assert centroid.lines[0].y[:-1] == pytest.approx(1e3 * flanks.load_centroid)
    assert factor.references[0].value == pytest.approx(flanks.mean_face_load_factor)


@pytest.mark.parametrize("seed", range(6))
def test_findings_are_true_of_random_loads(flanks, seed):
    """Every number of every sentence, by the field that it is from."""
    rng = np.random.default_rng(seed)
    force = flanks.on_path * rng.uniform(0.0, 500.0, flanks.force.shape)
    loaded = replace(flanks, force=force, pressure=4e7 * np.sqrt(force))
    at = np.unravel_index(int(loaded.pressure.argmax()), force.shape)
    where = 1e3 * loaded.roll_length_1[at], 1e3 * loaded.face_position[at[2]]
    mean = 1e-3 * loaded.face_load.mean(axis=0)
    centroid = 1e3 * loaded.load_centroid
    carrying = np.count_nonzero(force[at[0]].sum(axis=-1))
    known = {
        contact_pattern_figure: [1e-6 * loaded.pressure[at], *where],
        contact_lines: [1e-3 * loaded.line_load.max(), loaded.position[at[0]], carrying],
        line_load_figure: [mean.min(), mean.max(), loaded.mean_face_load_factor],
        load_centroid_figure: [centroid.min(), centroid.max(), loaded.mean_face_load_factor],
    }
    for draw, numbers in known.items():
        said = [float(text) for text in re.findall(r"-?\d+\.?\d*", draw(loaded).alternative)]
        assert said == pytest.approx(numbers, rel=6e-3), draw.__name__


def test_one_slice_has_a_curve_and_nothing_over_the_face(one_slice):
    section = PAGE.page(one_slice).sections[0]
    (figure,) = section.figures
    for panel in panels(figure):
        assert panel.shade is None
        assert np.nanmax(panel.lines[0].y) == pytest.approx(1e-6 * one_slice.pressure.max())
    assert "plane" in section.text
    names = [headline.name for headline in PAGE.page(one_slice).headlines]
    at = f"at {typed(one_slice.scene.torque)} N m"
    assert names == [f"largest flank pressure {at}", f"largest line load {at}"]


@pytest.fixture
def one_slice(flanks):
    middle = {
        name: getattr(flanks, name)[:, :, 2:3]
        for name in ("roll_length_1", "roll_length_2", "on_path", "force", "lever", "pressure", "gap")
    }
    return replace(flanks, face_position=np.zeros(1), **middle)


def test_every_figure_is_drawn_both_ways(flanks):
    section = PAGE.page(flanks).sections[0]
    assert [f.key for f in section.figures] == [
        "contact_pattern",
        "contact_lines",
        "line_load",
        "load_centroid",
    ]
    for figure in section.figures:
        assert png(figure).startswith(b"\x89PNG")
        assert plotly_figure(figure)["data"]


def test_load_and_alignment_are_said(flanks):
    torque = flanks.scene.torque
    assert (
        PAGE.figure(flanks).title == f"Contact pattern, 19/26, {torque:.2f} N m (1000 N), misalignment 30 µm"
    )
    headlines = PAGE.page(flanks).headlines
    values = 1e-6 * flanks.pressure.max(), 1e-3 * flanks.line_load.max(), flanks.mean_face_load_factor
    for headline, value, unit in zip(headlines, values, (" MPa", " N/mm", ""), strict=True):
        stated = re.match(r"± ([\d.]+)", headline.remark)
        shown = headline.value.removesuffix(unit)
        assert float(shown) == pytest.approx(value, rel=1e-3)
        if stated:
            assert len(shown.partition(".")[2]) == len(stated[1].partition(".")[2]), "as the error leaves"


def test_every_headline_has_its_error_or_says_why_there_is_none(flanks):
    bare = PAGE.page(flanks).headlines
    assert all(h.remark.startswith("error not estimated: one solution tells no error") for h in bare)
    errors = FlankErrors(0.05, 0.02, 0.03, 0.01, 0.04, "none is missing")
    stated = PAGE.page(replace(flanks, errors=errors)).headlines
    load, pressure = 1e-3 * flanks.line_load.max(), 1e-6 * flanks.pressure.max()
    bands = [float(re.match(r"± ([\d.]+)", h.remark)[1]) for h in stated]
    expected = [0.01 * pressure, 0.05 * load, 0.02 * flanks.mean_face_load_factor]
    assert bands == pytest.approx(expected, rel=0.05)
    lines = list(_text(replace(flanks, errors=errors)))
    assert sum("±" in line for line in lines) == 1
    part = f"peak over {number(1e3 * flanks.slice_width, 2)} mm of the face"
    assert sum(part in line for line in lines) == 1 and sum(part in h.remark for h in stated) == 2


def test_the_line_load_at_edges_is_the_mean_over_a_slice_with_its_error(flanks):
    p, j, k = np.unravel_index(flanks.line_load.argmax(), flanks.line_load.shape)
    at_edge = np.zeros(flanks.force.shape, dtype=bool)
    at_edge[p, j, k] = True
    count = min(6, flanks.face_position.size)
    errors = FlankErrors(edge_line_load=0.03)
    edged = replace(flanks, at_edge=at_edge, errors=errors)
    first = range(max(k - count + 1, 0), min(k, flanks.face_position.size - count) + 1)
    windows = [flanks.line_load[p, j, i : i + count].mean() for i in first]
    assert edged.edge_line_load.value == pytest.approx(max(windows), rel=1e-12)
    assert edged.edge_line_load.error == pytest.approx(0.03 * max(windows), rel=1e-12)
    load = PAGE.page(edged).headlines[1].remark
    assert re.search(r"; [\d.]+ N/mm at the edges, ± [\d.]+ N/mm, mean over [\d.]+ mm", load)
    bare = PAGE.page(replace(edged, errors=FlankErrors())).headlines[1].remark
    assert "at the edges, error not estimated" in bare
    assert "at the edges" not in PAGE.page(flanks).headlines[1].remark


def test_a_pressure_at_a_kink_says_over_which_length_it_is_averaged(flanks):
    kinked = replace(flanks, errors=FlankErrors(kink_length=0.21e-3))
    assert "4/pi times the mean over 0.21 mm of profile" in PAGE.page(kinked).headlines[0].remark
    assert "kink" not in PAGE.page(flanks).headlines[0].remark


def test_another_pair_than_the_databases_is_said_loudly(flanks, database, tmp_path):
    assert len(PAGE.with_database(flanks, database).alarms) == 1
    own = replace(flanks, scene=replace(flanks.scene, geometry=database.geometry))
    assert PAGE.with_database(own, database).alarms == PAGE.page(flanks).alarms == ()
    flanks.to_netcdf(tmp_path / "flanks.nc")
    database.to_netcdf(tmp_path / "ste.nc")
    both = [tmp_path / "ste.nc", tmp_path / "flanks.nc"]
    html = write_report(both, tmp_path / "report.html")[0].read_text(encoding="utf-8")
    assert "are of different gear pairs" in html
    assert '<figure id="contact_pattern">' in html
    alone = write_report(both[1], tmp_path / "alone.html")[0].read_text(encoding="utf-8")
    assert "Gear pair 19/26" in alone
