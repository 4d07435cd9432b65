"""What the report makes of a table over several base pitches."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.answers import curve_json, metadata_json
from lineofaction.report.ste.curves import pitches_shown, position_axis, shown_rows, ste_curves, ste_shown
from lineofaction.report.ste.over_torque import face_load
from lineofaction.report.ste.page import static_results
from lineofaction.report.ste.stiffness import _pair_shares, load_sharing

Tables = Callable[..., SteDatabase]


def test_a_period_is_shown_whole_once(with_pitch_errors: Tables) -> None:
    table = with_pitch_errors()
    position, values = ste_shown(table)
    assert (position[0], position[-1]) == (0.0, 3.0)
    assert np.all(np.diff(position) > 0.0)
    assert values[-1] == pytest.approx(values[0])
    assert position_axis(table).limits == (0, 3)
    at = np.searchsorted(position, table.position)
    assert values[at] == pytest.approx(table.static_transmission_error[:, :, 0, 0], rel=1e-9)
    assert "3 base pitches" in ste_curves(table).title
    assert "after 3 base pitches" in ste_curves(table).caption


def test_of_a_long_period_the_first_pitches_are_shown_and_go_on(with_pitch_errors: Tables) -> None:
    table = with_pitch_errors(50)
    position, values = ste_shown(table)
    assert (pitches_shown(table), position[-1]) == (40, 40.0)
    assert values[-1] == pytest.approx(table.static_transmission_error[40 * 64, :, 0, 0])
    rows = shown_rows(table)[1]
    assert (rows[-1], rows.size) == (40 * 64, 40 * 64 + 1)


@pytest.mark.parametrize("period", [1, 3, 50])
def test_every_pair_is_followed_and_the_shares_sum_to_one(
    with_pitch_errors: Tables, database: SteDatabase, period: int
) -> None:
    table = database if period == 1 else with_pitch_errors(period)
    position, followed = _pair_shares(table, 2)
    assert np.sum(list(followed.values()), axis=0) == pytest.approx(np.ones(position.size))
    assert len(followed) == pitches_shown(table) + 1
    for share in followed.values():  # one stretch of mesh each
        assert np.count_nonzero(np.diff((share > 0.0).astype(int)) == 1) <= 1


def test_the_static_part_is_made_without_the_secant_stiffness(
    with_pitch_errors: Tables, database: SteDatabase
) -> None:
    table = with_pitch_errors()
    keys = [figure.key for section in static_results(table) for figure in section.figures]
    assert "mesh_stiffness" not in keys
    assert {"ste", "load_sharing", "ste_spectrum"} <= set(keys)
    assert "mesh_stiffness" in [f.key for section in static_results(database) for f in section.figures]
    assert len(load_sharing(table).content) == 3  # type: ignore[arg-type]
    panel = face_load(table).content[0]  # type: ignore[index]
    assert panel.lines[0].x[-1] == 3.0


def test_answers_hold_the_period_and_its_orders(with_pitch_errors: Tables, database: SteDatabase) -> None:
    answer = curve_json(with_pitch_errors(), torque_n_m=100.0)
    assert answer["period"] == 3
    assert answer["order"][:3] == pytest.approx([1 / 3, 2 / 3, 1.0])
    assert answer["amplitude_um"][0] > 1.0
    assert answer["amplitude_um"][2] == pytest.approx(answer["harmonics_um"][0])
    plain = curve_json(database, torque_n_m=100.0)
    assert plain["period"] == 1
    assert "order" not in plain
    assert metadata_json(with_pitch_errors())["period"] == 3
