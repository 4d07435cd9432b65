"""Plots by one call: figures of the report on axes, on axes of the caller, by plotly."""

import sys
from typing import Any, get_args, get_origin

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Sheet
from matplotlib.transforms import Bbox
from repository import EXAMPLES

import lineofaction as loa
from bounds.plottable import Plottable
from lineofaction.gearbox.registry import STUDIES
from lineofaction.report.drawing.image import draw_figure
from lineofaction.report.plots import figures_of


@pytest.fixture(autouse=True)
def without_a_screen():
    with plt.rc_context():
        plt.switch_backend("Agg")
        yield
        plt.close("all")


def _kinds(result: Any) -> tuple[Any, ...]:
    return get_args(result) or (result,)


@pytest.mark.parametrize("study", STUDIES.values(), ids=STUDIES)
def test_every_result_of_a_study_has_plots(study):
    for kind in _kinds(study.run.file.result):
        assert issubclass(get_origin(kind) or kind, Plottable), kind


@pytest.mark.law
def test_numbers_above_the_bars_of_half_a_page_meet_no_bar_and_no_number(database):
    (figure,) = (each for each in figures_of(database) if each.key == "deflection_budget")
    sheet = Sheet(layout="constrained")
    (axes,) = draw_figure(sheet, figure, half=True)
    FigureCanvasAgg(sheet).draw()
    numbers = [text.get_window_extent() for text in axes.texts]
    (drawn,) = figure.content[0].bars
    corners = [
        [(x - 0.5 * drawn.width, 0.0), (x + 0.5 * drawn.width, top)]
        for x, top in zip(drawn.x, drawn.top, strict=True)
    ]
    bars = [Bbox(axes.transData.transform(pair)) for pair in corners]
    assert len(numbers) == len(bars) > 2
    assert all(axes.get_window_extent().y1 > number.y1 for number in numbers)
    for k, number in enumerate(numbers):
        assert not any(number.overlaps(bar) for j, bar in enumerate(bars) if j != k)
        assert not any(number.overlaps(other) for j, other in enumerate(numbers) if j != k)


def test_the_first_plot_of_a_table_is_its_curve(database):
    ripple, harris = database.plot()
    assert ripple.get_ylabel() == "STE less its mean, µm"
    drawn = max(np.ptp(np.asarray(line.get_ydata())) for line in ripple.get_lines())
    ste = 1e6 * database.static_transmission_error[:, :, 0, 0]
    assert drawn == pytest.approx(np.ptp(ste, axis=0).max(), rel=0.01)
    assert harris.get_title(loc="left") == "Harris map"


def test_a_figure_is_found_by_words_of_its_name(database, run):
    assert database.plot("harmonics")[0].get_ylabel().startswith("amplitude")
    assert database.plot("load sharing")[0].get_ylabel().startswith("normal force on a pair")
    assert run.plot()[-1].get_ylabel() == "transmission error, µm"
    with pytest.raises(loa.BadInput, match="view = 'no such': must be words of one of ste, "):
        database.plot("no such")


def test_panels_are_found_by_words_of_their_titles():
    """A K-chart is the profile of a gear, neither the section of the pair nor the lead."""
    database = loa.read(EXAMPLES / "gallery" / "results" / "helical.nc", kind=loa.SteDatabase)
    whole = database.plot("pair in mesh")
    titles = [ax.get_title(loc="left") for ax in whole]
    charts = [ax.get_title(loc="left") for ax in database.plot("K-chart")]
    assert charts == [title for title in titles if title.startswith("Profile of the ")] != []
    assert len(charts) < len(titles)
    assert set(database.to_dataframe("K-chart")["x_axis"]) <= {
        f"roll angle of the {gear}, °" for gear in ("pinion", "wheel")
    }


def test_panels_are_drawn_on_the_axes_of_the_caller(database):
    _, axes = plt.subplots(2, 1)
    assert list(database.plot(axes=axes)) == list(axes)
    assert all(ax.get_lines() for ax in axes)
    with pytest.raises(loa.BadInput, match="axes = 1: must be exactly 2"):
        database.plot(axes=axes[0])


def test_an_interactive_plot_has_the_curves_of_the_figure(database):
    drawn = database.plot(interactive=True)
    assert {"x", "y"} <= set(drawn.data[0].to_plotly_json())
    assert len(drawn.data) >= len(database.plot()[0].get_lines())


def test_a_result_of_a_study_draws_the_figure_of_its_verb():
    result = loa.modes(EXAMPLES / "jeffcott_scene.toml")
    assert result.plot()[0].figure.get_suptitle() == loa.plot(result)[0].figure.get_suptitle() != ""


def test_a_library_alone_says_what_draws(database, monkeypatch):
    monkeypatch.delitem(sys.modules, "lineofaction")
    with pytest.raises(ImportError, match="import lineofaction"):
        database.plot()


def test_the_numbers_of_a_plot_are_a_table(database):
    frame = database.to_dataframe()
    curve = database.curve(torque=100.0)
    drawn = frame[(frame["curve"] == "100 N m") & (frame["y_axis"] == "STE less its mean, µm")]
    assert np.ptp(drawn["y"]) == pytest.approx(1e6 * curve.peak_to_peak.value, rel=0.01)
    assert drawn["error"].max() >= 0.0 and (frame["error"].dropna() > 0.0).all()
    expected = 1e6 * (curve.ste - curve.ste.mean())
    middle = drawn[(drawn["x"] >= 0.0) & (drawn["x"] < 1.0)]
    np.testing.assert_allclose(
        np.interp(curve.position, middle["x"], middle["y"], period=1.0), expected, atol=0.05
    )


def test_the_numbers_of_a_map_have_its_coordinates(database):
    names = [figure.key for figure in figures_of(database) if figure.content and figure.content[0].shade]
    frame = database.to_dataframe(names[0])
    shade = next(f for f in figures_of(database) if f.key == names[0]).content[0].shade
    cells = frame.dropna(subset=["value"]).pivot(index="y", columns="x", values="value")
    np.testing.assert_array_equal(cells.to_numpy(), shade.z[:, np.isfinite(shade.z).any(axis=0)])
    with pytest.raises(loa.BadInput, match="view = 'no such'"):
        loa.dataframe(database, "no such")
