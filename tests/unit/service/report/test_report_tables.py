"""Tables say what the metadata says, in full digits."""

from dataclasses import replace

import numpy as np
import pytest

from fe_contact.ste import SteDatabase
from lineofaction.gearbox.units import boundary_ledger
from lineofaction.report.drawing.page import _is_number
from lineofaction.report.drawing.tables import facts, side_by_side
from lineofaction.report.ste.page import (
    case_tables,
    contact_effects,
    static_alarms,
    static_headlines,
    static_making,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1330.0, "1330"),
        (7850.0, "7850"),
        (0.349066, "0.349066"),
        (2.1e11, "2.1e+11"),
        ([10.0, 0.5], "10, 0.5"),
    ],
)
def test_no_digit_is_lost(value: object, text: str) -> None:
    assert facts("Case", {"load": value}).rows == (("load", text),)


def test_both_gears_stand_beside_each_other() -> None:
    table = side_by_side("Gears", {"pinion": {"teeth": 20}, "wheel": {"teeth": 40, "rim_mm": 5.0}})
    assert table.head == ("quantity", "pinion", "wheel")
    assert table.rows == (("teeth", "20", "40"), ("rim, mm", "", "5"))


def test_the_case_is_told_in_full(database: SteDatabase) -> None:
    gears, rest = case_tables(database.metadata.case)
    assert ("teeth", "20", "20") in gears.rows
    assert ("center distance, mm", "80") in rest.rows
    assert ("load · torque, N m", "10, 100, 400") in rest.rows


def test_the_ledger_says_what_is_simulated_and_why(database: SteDatabase) -> None:
    section = contact_effects(boundary_ledger(database.metadata.effect_ledger))
    (table,), (trifles, decisions) = section.tables, section.folded
    assert section.text.endswith("estimated change without each, at 400 N m, misalignment 0 um.")
    assert table.head == ("effect", "in", "simulated", "without it", "because")
    assert decisions.head == ("effect", "cost", "decision", "price of the choice", "checked")
    words = "mean +0.2 um (+2 %), peak-to-peak -0.05 um (-5 %)"
    assert table.rows == (("corner_contact", "contact", "yes", words, "tips touch"),)
    assert [row[0] for row in decisions.rows] == ["corner_contact", "misalignment"]
    assert trifles.caption == "1 effect below 0.1 %"
    assert [row[0] for row in trifles.rows] == ["misalignment"]


def test_a_ledger_without_estimates_says_so() -> None:
    section = contact_effects([{"name": "misalignment", "on": False, "reason": "aligned"}])
    assert section.text == ""
    assert section.tables[0].rows == (("misalignment", "contact", "no", "not estimated", "aligned"),)


def test_an_edge_is_named_apart_from_the_largest_pressure(database: SteDatabase) -> None:
    edges = np.zeros(database.max_pressure.shape)
    assert "edge" not in static_headlines(replace(database, edge_pressure=edges))[2].remark
    edges[3] = 1.072e9
    pressed = static_headlines(replace(database, edge_pressure=edges))[2]
    assert pressed.value == static_headlines(database)[2].value == "700.0 MPa"
    assert pressed.remark.endswith("up to 1072 MPa at edges, indicative")


def test_headlines_are_those_of_the_load_asked_for(database: SteDatabase) -> None:
    names = [headline.name for headline in static_headlines(database, force=10_000.0)]
    assert names == ["mean STE at 400 N m", "peak-to-peak STE at 400 N m", "largest pressure at 400 N m"]
    mean = static_headlines(database)[0]
    assert (mean.name, mean.value, mean.remark) == ("mean STE at 100 N m", "5.978 µm", "± 0.012 µm")


def test_failed_points_are_said_loudly(database: SteDatabase, damaged: SteDatabase) -> None:
    assert static_alarms(database) == ()
    (alarm,) = static_alarms(damaged)
    assert "1 of 256 points FAILED" in alarm


def test_the_receipt_is_in_the_page(database: SteDatabase) -> None:
    tables = [t for section in static_making(database) for t in (*section.tables, *section.folded)]
    stages = next(t for t in tables if t.caption == "Time by stage")
    assert stages.rows == (("mesh", "1.00", "1.10"),)
    made = next(t for t in tables if t.caption == "Made with")
    assert ("numpy", "2.0") in made.rows


@pytest.mark.parametrize("text", ["12", "-0.5", "1.0e-12", "6.2 ± 0.1", "10 N m", ""])
def test_numbers_are_known(text: str) -> None:
    assert _is_number(text)


@pytest.mark.parametrize("text", ["none", "832, 0 failed", "10, 20", "corner_contact", "2 % of the mean"])
def test_words_are_no_numbers(text: str) -> None:
    assert not _is_number(text)
