"""Figures over misalignment, center distance and the face: what they draw, and when."""

from dataclasses import replace

import numpy as np
import pytest

from fe_contact.ste import SteDatabase
from lineofaction.report.ste.over_torque import deviation_curves, face_load, has_deviations, has_face_load
from lineofaction.report.ste.page import static_results

SKEW = np.array([-20e-6, 0.0, 40e-6])
CHANGE = np.array([0.0, 0.1e-3])
RIPPLE = np.array([[1.5, 1.2], [1.0, 0.8], [3.0, 2.4]])
"""Factor of the whole curve, and so of its peak-to-peak, at each misalignment and center distance."""


@pytest.fixture
def deviating(database: SteDatabase) -> SteDatabase:
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


def test_peak_to_peak_over_either_deviation_alone(deviating: SteDatabase) -> None:
    figure = deviation_curves(deviating)
    over_skew, over_change = figure.content  # type: ignore[misc]
    assert [line.name for line in over_skew.lines] == ["10 N m", "100 N m", "400 N m"]
    assert over_skew.lines[0].x == pytest.approx([-20.0, 0.0, 40.0])
    assert over_change.lines[0].x == pytest.approx([0.0, 0.1])
    for k, line in enumerate(over_skew.lines, start=1):
        nominal = 1e6 * np.ptp(deviating.static_transmission_error[:, k, 1, 0])
        assert line.y == pytest.approx(nominal * RIPPLE[:, 0], rel=1e-3)
        assert over_change.lines[k - 1].y == pytest.approx(nominal * RIPPLE[1], rel=1e-3)


def test_an_axis_of_one_value_has_no_panel(deviating: SteDatabase) -> None:
    names = ("static_transmission_error", "tangent_compliance", "load_share", "pairs_in_contact", "status",
             "residuals", "error_estimate", "face_centroid", "max_pressure")  # fmt: skip
    cut = {name: getattr(deviating, name)[:, :, :1] for name in names}
    narrow = replace(
        deviating,
        misalignment=SKEW[1:2],
        no_load_transmission_error=np.zeros((64, 1, 2)),
        **cut,
    )
    (panel,) = deviation_curves(narrow).content  # type: ignore[misc]
    assert panel.x.label == "change of the center distance, mm"


def test_the_table_names_every_deviation_with_its_unit(deviating: SteDatabase) -> None:
    table = deviation_curves(deviating).table
    assert table is not None
    assert [row[0] for row in table.rows] == [
        "misalignment -20.0 µm", "misalignment 0 µm", "misalignment 40.0 µm",
        "change of the center distance 0 mm", "change of the center distance 0.100 mm",
    ]  # fmt: skip
    assert table.head == ("deviation", "10 N m", "100 N m", "400 N m")


def test_centroid_and_pressure_at_every_misalignment(deviating: SteDatabase) -> None:
    figure = face_load(deviating)
    centroid, pressure = figure.content  # type: ignore[misc]
    assert [line.name for line in centroid.lines] == [
        "misalignment -20.0 µm", "misalignment 0 µm", "misalignment 40.0 µm",
    ]  # fmt: skip
    assert centroid.lines[2].y[0] == pytest.approx(-4.0)
    assert centroid.lines[2].y[64] == centroid.lines[2].y[0] == centroid.lines[2].y[128]
    assert pressure.lines[0].y == pytest.approx(900.0)
    assert "from -4.00 to 2.98 mm" in figure.alternative
    assert "1100 MPa" in figure.alternative


def test_they_are_on_the_page_only_where_there_is_something_to_show(
    database: SteDatabase, deviating: SteDatabase
) -> None:
    def keys(table: SteDatabase) -> set[str]:
        return {figure.key for section in static_results(table) for figure in section.figures}

    assert not has_deviations(database) and not has_face_load(database)
    assert has_deviations(deviating) and has_face_load(deviating)
    assert keys(deviating) - keys(database) == {"deviations", "face_load"}


def test_failed_points_leave_gaps_and_no_error(deviating: SteDatabase) -> None:
    ste, status = deviating.static_transmission_error.copy(), np.array(deviating.status)
    centroid = np.array(deviating.face_centroid)
    ste[5, 2, 0, 0], centroid[5, 2, 0, 0], status[5, 2, 0, 0] = np.nan, np.nan, 1
    failed = replace(deviating, static_transmission_error=ste, status=status, face_centroid=centroid)
    assert has_face_load(failed)
    panel, _ = face_load(failed).content  # type: ignore[misc]
    assert np.isnan(panel.lines[0].y[5])
    first, _ = deviation_curves(failed).content  # type: ignore[misc]
    assert np.all(np.isfinite(first.lines[0].y))
