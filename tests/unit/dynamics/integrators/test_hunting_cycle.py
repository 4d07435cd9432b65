"""Runs on tables of several base pitches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from geared_scenes import gear_pair_scene, repeated, square_wave_table, with_mesh

from dynamics.simulation import simulate

TABLE = square_wave_table()
SCENE = gear_pair_scene(TABLE, duration=0.03)


def one_tooth_behind(period, error):
    """The table of one pitch written out, one of them `error` m further from contact."""
    table = repeated(TABLE, period)
    third = np.floor(table.position) == 2
    bump = np.where(third, np.sin(np.pi * (table.position - 2.0)) ** 2, 0.0)
    slope = np.where(third, np.pi * np.sin(2 * np.pi * (table.position - 2.0)), 0.0)
    return replace(
        table,
        deflection=table.deflection + error * bump[:, None],
        deflection_slope=table.deflection_slope + error * slope[:, None],
    )


def test_equal_pitches_written_out_run_as_one():
    one, many = simulate(SCENE), simulate(with_mesh(SCENE, table=repeated(TABLE, 20)))
    assert many.position.max() > 8.9
    np.testing.assert_allclose(many.position % 1.0, one.position, atol=1e-12)
    for name in ("mesh_force", "dynamic_transmission_error", "static_transmission_error"):
        mine, theirs = getattr(many, name), getattr(one, name)
        np.testing.assert_allclose(mine, theirs, rtol=1e-7, atol=1e-9 * np.abs(theirs).max())


def test_an_error_of_one_tooth_returns_with_its_period():
    result = simulate(with_mesh(SCENE, table=one_tooth_behind(5, 3e-6)))
    smooth = simulate(SCENE)
    plain = np.interp(result.time, smooth.time, smooth.static_transmission_error[0])
    pitch = np.floor(result.position[0]) % 5
    raised = np.abs(result.static_transmission_error[0] - plain)
    assert raised[pitch == 2].max() > 2.5e-6
    assert raised[pitch != 2].max() < 0.1e-6
    assert result.case["meshes"][0]["table"]["period"] == 5
