"""Laws that the figures of an STE database obey."""

import math
from dataclasses import asdict, replace

import numpy as np
import pytest

from fe_contact.geometry import Gear, GearPair
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.fields import DIMENSIONS
from service.drawing.figure import Panel, Surface, number
from service.tables.aligned import shown_loads, ste_shown
from service.tables.database_surface import database_surface
from service.tables.load_sharing import load_sharing, pair_shares
from service.tables.mesh_stiffness import mesh_stiffness, secant_stiffness
from service.tables.pair import iso_mesh_stiffness
from service.tables.ripple_over_torque import ripple_over_torque
from service.tables.static_part import static_results
from service.tables.ste_curves import ste_curves


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
    content = ste_curves(database).content
    assert not isinstance(content, Surface)
    return content


def test_the_ripple_and_the_whole_are_drawn_in_micrometers_for_the_loads_asked_for(
    database: SteDatabase,
) -> None:
    """What is drawn above is what is drawn below less its mean."""
    ripple, whole = panels_of(database)
    assert [line.name.split(":")[0] for line in ripple.lines] == ["10 N m", "100 N m", "400 N m"]
    stored = database.static_transmission_error[0, 2, 0, 0]
    assert whole.lines[1].y[0] == pytest.approx(1e6 * stored)
    for load, above, below in zip(shown_loads(database), ripple.lines, whole.lines, strict=True):
        mean = 1e6 * database.mean(force=float(database.force[load])).value
        np.testing.assert_allclose(below.y - above.y, mean, rtol=1e-9)
        assert above.name == below.name == f"{above.name.split(':')[0]}: mean {number(mean)} µm"
    assert whole.y.limits is not None
    assert whole.y.limits[0] == 0.0


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
    position, followed = pair_shares(database, 2)
    total = np.sum(list(followed.values()), axis=0)
    assert position[-1] == 2.0
    np.testing.assert_allclose(total, 1.0, atol=1e-12)


def test_each_pair_passes_as_the_one_before_did_a_pitch_earlier(database: SteDatabase) -> None:
    position, followed = pair_shares(database, 2)
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
    _, values = secant_stiffness(database)
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


def test_the_surface_stands_over_position_and_force(database: SteDatabase) -> None:
    surface = database_surface(database).content
    assert isinstance(surface, Surface)
    assert surface.z.shape == (len(surface.y), len(surface.x))
    assert (surface.y[0], surface.y[-1]) == (database.force[0], database.force[-1])
    assert np.all(np.diff(surface.z, axis=0) > 0)


def test_failed_points_are_gaps_and_the_rest_is_drawn(damaged: SteDatabase) -> None:
    position, values = ste_shown(damaged)
    assert math.isnan(values[5, 2])
    assert np.count_nonzero(np.isnan(values)) == 2
    assert len(position) == 129
    for figure in (ste_curves, load_sharing, mesh_stiffness, database_surface):
        assert figure(damaged).alternative


def test_a_request_made_from_python_has_the_same_iso_line(database: SteDatabase) -> None:
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    request = {"pair": asdict(GearPair(gear, gear, 80e-3)), "normal_force": [2660.0]}
    from_python = replace(database, metadata=Metadata(case=request))
    assert iso_mesh_stiffness(from_python) == pytest.approx(iso_mesh_stiffness(database))


def test_a_single_load_names_its_mean_and_makes_no_surface(database: SteDatabase) -> None:
    cut = {
        name: np.take(getattr(database, name), [2], axis=axes.index("force"))
        for name, axes in {"force": ("force",), **DIMENSIONS}.items()
        if "force" in axes
    }
    single = replace(database, **cut)
    (ripple,) = panels_of(single)
    mean = 1e6 * database.mean(force=float(database.force[2])).value
    assert ripple.title == f"100 N m, less its mean of {number(mean)} µm"
    over_load = [f.key for section in static_results(single) for f in section.figures]
    assert "database" not in over_load
    assert "database" in [f.key for section in static_results(database) for f in section.figures]


def test_ripple_over_torque_is_that_of_the_curves(database: SteDatabase) -> None:
    ripple, harmonics = ripple_over_torque(database).content  # type: ignore[misc]
    (line,) = ripple.lines
    for k, load in enumerate(shown_loads(database)):
        curve = database.curve(force=float(database.force[load]))
        assert line.y[k] == pytest.approx(1e6 * curve.peak_to_peak.value)
        assert line.band[k] == pytest.approx(1e6 * curve.peak_to_peak.error)
        for drawn in harmonics.lines:
            one = curve.harmonics[int(drawn.name) - 1]
            if one.error >= one.value:
                assert math.isnan(drawn.y[k])
            else:
                assert drawn.y[k] == pytest.approx(20.0 * math.log10(1e6 * one.value))
    assert [note.text for note in harmonics.notes] == [drawn.name for drawn in harmonics.lines]
    assert "ripple" in [f.key for s in static_results(database) for f in s.figures]
