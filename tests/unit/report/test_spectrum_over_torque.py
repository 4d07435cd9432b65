"""Laws of the spectrum over torque: its rows hold the energy of the curves, and nothing below its error."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fe_contact.ste import SteDatabase
from fe_contact.ste.spectrum import even_positions
from lineofaction.report.drawing.figure import FloatArray, HeatMap
from lineofaction.report.ste.curves import drawn_loads, load_curve, load_labels
from lineofaction.report.ste.page import static_results
from lineofaction.report.ste.spectrum import ste_waterfall

Tables = Callable[..., SteDatabase]


def shade_of(database: SteDatabase) -> HeatMap:
    (panel,) = ste_waterfall(database).content
    return panel.shade


def with_orders(database: SteDatabase, amplitudes: dict[float, float], relative_error: float) -> SteDatabase:
    """The table with a mean of 20 µm at 400 N m and orders of these amplitudes in m, by the load."""
    x = database.position[:, None]
    wave = sum(a * np.cos(2.0 * np.pi * order * x + order) for order, a in amplitudes.items())
    ste = (20e-6 + wave) * (database.force / database.force[-1])
    return replace(
        database,
        static_transmission_error=ste[..., None, None],
        no_load_transmission_error=np.full_like(database.no_load_transmission_error, -1e-6),
        error_estimate=relative_error * ste[..., None, None],
    )


@pytest.mark.parametrize(
    ("period", "amplitudes"),
    [(1, {1.0: 2e-6, 2.0: 5e-7, 5.0: 2e-7}), (3, {1.0 / 3.0: 1e-6, 1.0: 2e-6, 4.0 / 3.0: 3e-7, 2.0: 5e-7})],
)
def test_the_orders_of_a_row_hold_the_mean_square_of_the_curve(
    database, with_pitch_errors, period, amplitudes
):
    """Parseval: half the sum of the squared amplitudes."""
    table = with_orders(database if period == 1 else with_pitch_errors(period), amplitudes, 0.0)
    shade = shade_of(table)
    assert shade.z.shape == (len(drawn_loads(table)), shade.x.size)
    for load, level in zip(drawn_loads(table), shade.z, strict=True):
        ste = 1e6 * table.curve(force=float(table.force[load]), at=even_positions(period)).ste
        drawn = 0.5 * np.sum(np.where(level > shade.minimum, 10.0 ** (level / 10.0), 0.0))
        assert drawn == pytest.approx(float(np.var(ste)), rel=1e-4)
        for order, size in amplitudes.items():
            column = int(np.argmin(np.abs(shade.x - order)))
            known = 1e6 * size * float(table.force[load] / table.force[-1])
            assert level[column] == pytest.approx(20.0 * np.log10(known), abs=0.1)


def test_what_is_below_its_error_is_blank_and_all_else_is_drawn(database):
    table = with_orders(database, {1.0: 2e-6, 3.0: 1e-7}, 0.01)
    shade = shade_of(table)
    for load, level in zip(drawn_loads(table), shade.z, strict=True):
        tones = load_curve(table, load).harmonics
        assert 0.0 < tones[2].value < tones[2].error
        assert list(np.isnan(level)) == [not tone.value > tone.error for tone in tones]
    assert "blank: below the stated error" in ste_waterfall(table).caption
    nothing = ste_waterfall(with_orders(database, {1.0: 1e-8}, 0.01))
    assert nothing.alternative == "No order exceeds its error at any load."


def test_errors_that_were_not_estimated_are_said_and_hide_nothing(database):
    table = with_orders(database, {1.0: 2e-6}, 0.01)
    unknown = replace(table, error_estimate=np.full_like(table.error_estimate, np.nan))
    assert "errors were not estimated" in ste_waterfall(unknown).caption
    assert np.isfinite(shade_of(unknown).z[:, 0]).all()


def test_a_long_period_has_few_cells_of_which_each_shows_its_largest_order(with_pitch_errors):
    table = with_pitch_errors(150)
    figure, shade = ste_waterfall(table), shade_of(table)
    assert shade.x.size == 300
    assert "A cell is as wide as 2 orders" in figure.caption
    levels = [_level(load_curve(table, load).spectrum.amplitude[:600]) for load in drawn_loads(table)]
    largest = np.max(np.reshape(levels, (-1, 300, 2)), axis=2)
    drawn = np.isfinite(shade.z) & (shade.z > shade.minimum)
    assert drawn.any()
    np.testing.assert_allclose(shade.z[drawn], largest[drawn], rtol=1e-12)


def _level(amplitude: FloatArray) -> FloatArray:
    return np.asarray(20.0 * np.log10(1e6 * amplitude))


def test_the_finding_names_order_load_and_level(database):
    table = with_orders(database, {1.0: 2e-6, 2.0: 3e-6}, 1e-4)
    figure = ste_waterfall(table)
    assert figure.alternative == "Order 2 at 400 N m is the largest: 9.5 dB re 1 µm."
    assert [row[0] for row in figure.table.rows] == [load_labels(table)[k] for k in drawn_loads(table)]
    assert figure.table.head == ("torque", "order 1", "order 2")


def test_one_load_has_no_spectrum_over_torque(database):
    def keys(table):
        return {figure.key for section in static_results(table) for figure in section.figures}

    along = {name: axes.index("force") for name, axes in database.stored.items() if "force" in axes}
    single = {name: np.take(getattr(database, name), [2], axis=axis) for name, axis in along.items()}
    assert "ste_waterfall" in keys(database)
    assert "ste_waterfall" not in keys(replace(database, **single))
