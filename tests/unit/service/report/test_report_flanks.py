"""What the report shows of the flanks: pressure, contact lines, load over the face."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fe_contact.analysis import LoadDistribution, contact_pattern
from fe_contact.ste import SteDatabase
from service.drawing.figure import HeatMap, Panel, Strokes
from service.drawing.image import png
from service.drawing.interactive import plotly_figure
from service.report import write_report
from service.studies.flank.page import operating_point, page
from service.tables.contact_lines import contact_lines
from service.tables.contact_pattern import contact_pattern_figure
from service.tables.face_distribution import line_load_figure, load_centroid_figure


def panels(figure: object) -> tuple[Panel, ...]:
    content = figure.content  # type: ignore[attr-defined]
    assert isinstance(content, tuple)
    return content


def test_the_pattern_is_the_librarys_in_mpa_and_blank_where_nothing_touches(flanks: LoadDistribution) -> None:
    figure = contact_pattern_figure(flanks)
    for gear, panel in zip(("pinion", "wheel"), panels(figure), strict=True):
        shade, pattern = panel.shade, contact_pattern(flanks, gear)  # type: ignore[arg-type]
        assert isinstance(shade, HeatMap)
        touched = pattern.pressure > 0.0
        assert np.array_equal(np.isfinite(shade.z), touched)
        assert not touched.all()
        assert shade.z[touched] == pytest.approx(1e-6 * pattern.pressure[touched])
        assert shade.largest == pytest.approx(1e-6 * flanks.pressure.max())
        assert panel.y.limits is not None
        assert (
            panel.y.limits[0]
            < 1e3 * pattern.roll_length[0]
            < 1e3 * pattern.roll_length[-1]
            < panel.y.limits[1]
        )


def test_the_marks_of_the_pattern_are_diameters_of_that_gear(flanks: LoadDistribution) -> None:
    pinion, wheel = panels(contact_pattern_figure(flanks))
    labels = [[mark.label for mark in panel.references] for panel in (pinion, wheel)]
    a = flanks.scene.facts.center_distance
    pitch = [2e3 * a * z / 45 for z in (19, 26)]
    for row, diameter in zip(labels, pitch, strict=True):
        assert row[1] == f"pitch point, d {diameter:.4g} mm"
    assert labels[0][2].startswith("tip, d 66.66")  # 19 teeth of module 3/cos 20 deg, and two modules


def test_strokes_carry_the_force_and_run_as_the_helix_does(flanks: LoadDistribution) -> None:
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


def test_the_load_over_the_face_and_its_factor(flanks: LoadDistribution) -> None:
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


def test_one_slice_has_a_curve_and_nothing_over_the_face(one_slice: LoadDistribution) -> None:
    section = page(one_slice).sections[0]
    (figure,) = section.figures
    for panel in panels(figure):
        assert panel.shade is None
        assert np.nanmax(panel.lines[0].y) == pytest.approx(1e-6 * one_slice.pressure.max())
    assert "plane" in section.text
    assert [headline.name for headline in page(one_slice).headlines] == ["largest flank pressure"]


@pytest.fixture
def one_slice(flanks: LoadDistribution) -> LoadDistribution:
    middle = {
        name: getattr(flanks, name)[:, :, 2:3]
        for name in ("roll_length_1", "roll_length_2", "on_path", "force", "lever", "pressure", "gap")
    }
    return replace(flanks, face_position=np.zeros(1), **middle)


def test_every_figure_is_drawn_both_ways(flanks: LoadDistribution) -> None:
    section = page(flanks).sections[0]
    assert [f.key for f in section.figures] == [
        "contact_pattern",
        "contact_lines",
        "line_load",
        "load_centroid",
    ]
    for figure in section.figures:
        assert png(figure).startswith(b"\x89PNG")
        assert plotly_figure(figure)["data"]


def test_load_and_alignment_are_said(flanks: LoadDistribution) -> None:
    torque = flanks.scene.torque
    assert operating_point(flanks) == f"{torque:.2f} N m, misalignment 30.0 µm"
    assert [h.value for h in page(flanks).headlines] == [
        f"{1e-6 * flanks.pressure.max():.1f} MPa",
        f"{flanks.mean_face_load_factor:.2f}",
    ]


def test_another_pair_than_the_databases_is_said_loudly(
    flanks: LoadDistribution, database: SteDatabase, tmp_path: Path
) -> None:
    assert len(page(flanks, database).alarms) == 1
    own = replace(flanks, scene=replace(flanks.scene, facts=database.facts))
    assert page(own, database).alarms == page(flanks).alarms == ()
    flanks.to_netcdf(tmp_path / "flanks.nc")
    database.to_netcdf(tmp_path / "ste.nc")
    both = [tmp_path / "ste.nc", tmp_path / "flanks.nc"]
    html = write_report(both, tmp_path / "report.html")[0].read_text(encoding="utf-8")
    assert "are of different gear pairs" in html
    assert '<figure id="contact_pattern">' in html
    alone = write_report(both[1], tmp_path / "alone.html")[0].read_text(encoding="utf-8")
    assert "Gear pair 19/26" in alone
