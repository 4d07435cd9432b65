"""Report, answers and `loa ste` name the most loaded tooth of each gear, where teeth differ."""

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from command_line import loa
from declared_figures import check_declared

from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.answers import curve_json, metadata_json, summary_json
from lineofaction.report.drawing.figure import Figure, HeatMap, number
from lineofaction.report.ste.headlines import static_headlines
from lineofaction.report.ste.page import static_results

Tables = Callable[..., SteDatabase]
WORST = 5
FORCE = 100.0 / 0.0375877


@pytest.fixture
def alike(with_pitch_errors):
    """20 pitches of 20/20 teeth, all of which carry as much."""
    return with_pitch_errors(20)


@pytest.fixture
def table(alike):
    """Three of four parts of the load on all teeth, at most, and nine of ten on one of either gear."""
    share = np.where(alike.load_share == 1.0, 0.75, np.where(alike.load_share == 0.0, 0.25, 0.5))
    share[alike.pairs_in_contact == 1, 2] = 0.0
    share[alike.pairs_in_contact == 2, :] = (0.5, 0.5, 0.0)
    worst = (alike.position >= WORST - 1) & (alike.position < WORST - 0.9)  # pair 0 near the pitch point
    share[worst] = (0.1, 0.9, 0.0)
    return replace(alike, load_share=share)


def drawn(table: SteDatabase) -> dict[str, Figure]:
    return {figure.key: figure for section in static_results(table) for figure in section.figures}


def test_the_report_names_the_worst_tooth_of_either_gear(table):
    figure = drawn(table)["tooth_loads"]
    force = number(0.9 * FORCE, 4)
    times = f"{0.9 / (0.75 * 19 + 0.9) * 20:.3f}"
    for gear, panel in zip(("pinion", "wheel"), figure.content, strict=True):
        (bars,) = panel.bars
        assert bars.top == pytest.approx(FORCE * np.where(bars.x == WORST, 0.9, 0.75), rel=1e-6)
        assert (
            f"The largest force on the {gear} is on tooth 5, {force} N, {times} times the mean tooth;"
            in figure.alternative
        )
        head = {line.name: line for line in static_headlines(table)}[
            f"most loaded tooth of the {gear} at 100 N m"
        ]
        assert (head.value, head.remark) == ("tooth 5", f"{force} N, {times} times the mean tooth")
    assert figure.table is not None and figure.table.rows[0][:3] == ("pinion", "5", force)


def test_nothing_is_shown_where_teeth_are_alike(alike, database):
    for plain in (alike, database):
        assert "tooth_loads" not in drawn(plain)
        assert not any("most loaded" in line.name for line in static_headlines(plain))
        assert "tooth_loads" not in curve_json(plain, torque_n_m=100.0)
        assert "tooth_loads" not in metadata_json(plain)


def pressed(table: SteDatabase) -> SteDatabase:
    """The table with 600 MPa wherever a pair carries, and 900 where both teeth 8 meet."""
    pressure = np.where(table.load_share > 0.0, 6e8, 0.0)
    pressure[(table.position >= 7.0) & (table.position < 7.2), ..., 1] = 9e8
    return replace(table, pair_pressure=pressure)


def test_the_report_maps_the_pressure_of_all_teeth_and_names_the_largest(table):
    for gear in ("pinion", "wheel"):
        figure = drawn(pressed(table))[f"tooth_pressures_{gear}"]
        map_of, way = figure.content
        assert isinstance(map_of.shade, HeatMap) and map_of.shade.z.shape[0] == 20
        assert np.nanmax(map_of.shade.z, axis=1) == pytest.approx(
            [900.0 if k == 7 else 600.0 for k in range(20)]
        )
        assert [line.name for line in way.lines] == ["tooth 8", "mean of all teeth"]
        assert way.lines[1].y == pytest.approx(np.nan_to_num(map_of.shade.z).mean(axis=0))
        assert f"The largest pressure on the {gear} is on tooth 8, 900.0 MPa" in figure.alternative
        (head,) = (
            h
            for h in static_headlines(pressed(table))
            if h.name == f"most pressed tooth of the {gear} at 100 N m"
        )
        assert (head.value, head.remark) == ("tooth 8", "900.0 MPa; no error is stated for it")
    assert not any(key.startswith("tooth_pressures") for key in drawn(table))  # of a table without them
    answer = curve_json(pressed(table), torque_n_m=100.0)["tooth_loads"]["wheel"]
    assert (answer["most_pressed"], answer["pressure_mpa"]) == ([8], pytest.approx(900.0))
    check_declared("database", json.loads(json.dumps(metadata_json(pressed(table)))))


def test_teeth_that_are_equally_worst_are_all_named(table):
    share = table.load_share.copy()
    share[(table.position >= 11.0) & (table.position < 11.1)] = (0.1, 0.9, 0.0)
    figure = drawn(replace(table, load_share=share))["tooth_loads"]
    assert "on the wheel is on teeth 5 and 12, " in figure.alternative
    assert [note.text for note in figure.content[0].notes] == ["5", "12"]


def test_what_derivatives_may_change_is_said(table):
    receipt = table.metadata.receipt | {"cycle": {"share_error": 0.01, "pressure_error_relative": 0.02}}
    derived = replace(pressed(table), metadata=replace(table.metadata, receipt=receipt))
    assert "within 18.00 MPa at 99 % of the drawn points" in drawn(derived)["tooth_pressures_wheel"].caption
    assert "within 27 N at 99 % of the drawn points" in drawn(derived)["tooth_loads"].caption
    assert "derivatives" not in drawn(table)["tooth_loads"].caption


def test_answers_hold_the_loads_of_all_teeth(table):
    answer = curve_json(table, torque_n_m=100.0)["tooth_loads"]
    assert list(answer) == ["pinion", "wheel"]
    assert answer["pinion"]["most_loaded"] == [WORST]
    assert answer["pinion"]["force_n"] == pytest.approx(0.9 * FORCE, rel=1e-6)
    assert len(answer["wheel"]["force_by_tooth_n"]) == 20
    by_load = metadata_json(table)["tooth_loads"]
    assert by_load[2] == answer == summary_json(table)["loads"][2]["tooth_loads"]
    check_declared("database", json.loads(json.dumps(metadata_json(table))))


def test_loa_ste_names_them(table, alike, tmp_path):
    for name, each in (("worst", table), ("alike", alike)):
        each.to_netcdf(tmp_path / f"{name}.nc")
    lines = loa("ste", tmp_path / "worst.nc", "--torque", 100).stdout.splitlines()
    for gear in ("pinion", "wheel"):
        (line,) = (line for line in lines if line.startswith(f"  {gear}: "))
        assert line.startswith(f"  {gear}: most on tooth 5, {0.9 * FORCE:.0f} N, 1.188 times the mean")
        assert len(line) <= 80
    assert "times the mean" not in loa("ste", tmp_path / "alike.nc", "--torque", 100).stdout
