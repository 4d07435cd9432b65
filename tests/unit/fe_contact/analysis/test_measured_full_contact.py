"""Full contact beside the ladder: errors where it was run, honest times, reasons. Needs no CalculiX."""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Iterator

import numpy as np
import pytest

from fe_contact import Gear, GearPair
from fe_contact.analysis import measured_full_contact as measuring
from fe_contact.analysis.frontier import frontier
from fe_contact.analysis.ladder import THIN_SLICES
from fe_contact.analysis.measured_full_contact import full_contact_refusal, measure_full_contact
from fe_contact.analysis.request import Checked
from fe_contact.analysis.request_check import check_request
from fe_contact.errors import InputError
from fe_contact.full_contact import FullContactPoint
from fe_contact.ste import SteDatabase
from fe_contact.types import Status

GEAR = Gear(teeth=20, normal_module=2e-3, face_width=8e-3, bore_diameter=20e-3)
PAIR = GearPair(GEAR, GEAR, center_distance=40e-3)
SOFTER, FAILED = 1.02, 3
NAN = float("nan")


@pytest.fixture(scope="module")
def checked() -> Checked:
    return check_request(PAIR, normal_forces=[200.0, 500.0], positions=32)


@pytest.fixture(scope="module")
def table(checked: Checked) -> SteDatabase:
    """Of thin slices, which take no mesh."""
    return THIN_SLICES.run(checked, lambda *_: None, None)


@pytest.fixture
def stand_in(table: SteDatabase, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[float]]:
    """Two per cent softer than the table; the fourth position fails. Yields the forces it was asked."""
    asked: list[float] = []

    def solved(_program, _pair, _mesh, force, position, _limit):  # type: ignore[no-untyped-def]
        asked.append(force)
        if len(asked) == FAILED + 1:
            return FullContactPoint(NAN, NAN, Status.ITERATION_LIMIT, "cut back too often", 9, NAN, NAN)
        lag = SOFTER * float(table.curve(force=force, at=[position]).ste[0])
        return FullContactPoint(position, lag, Status.CONVERGED, "", 9, 1e-9, 1.0)

    monkeypatch.setattr(measuring, "solve_position", solved)
    monkeypatch.setattr(measuring, "find_calculix", lambda: "nowhere/ccx")
    monkeypatch.setattr(measuring, "version_of", lambda _: "CalculiX")
    yield asked


def test_errors_are_those_of_the_positions_that_were_solved(
    checked: Checked, table: SteDatabase, stand_in: list[float]
) -> None:
    found = measure_full_contact(checked, 5, lambda *_: None).compared(table, table)
    assert stand_in == [500.0] * 5  # the largest load
    assert [point.status.usable for point in found.points] == [True, True, True, False, True]
    assert found.mean_error == pytest.approx(SOFTER - 1.0, rel=1e-9)
    assert found.peak_to_peak_error == pytest.approx(SOFTER - 1.0, rel=1e-9)
    assert found.plane_strain_mean == pytest.approx(1.0 - 1.0 / SOFTER, rel=1e-9)
    facts = found.to_json(64)
    assert (facts["positions_run"], facts["positions_solved"]) == (5, 4)
    assert facts["points"][FAILED] == {
        "status": "iteration_limit", "iterations": 9, "reason": "cut back too often",
    }  # fmt: skip


def test_a_table_costs_its_solves_at_the_mean_of_those_that_were_run(
    checked: Checked, stand_in: list[float]
) -> None:
    found = dataclasses.replace(
        measure_full_contact(checked, 4, lambda *_: None), cpu_seconds=100.0, mesh_cpu_seconds=2.0
    )
    assert found.seconds(768) == pytest.approx(2.0 + 768 * 25.0)
    assert found.to_json(768)["cpu_seconds_measured"] == pytest.approx(102.0)


def test_one_position_has_no_peak_to_peak(
    checked: Checked, table: SteDatabase, stand_in: list[float]
) -> None:
    found = measure_full_contact(checked, 1, lambda *_: None).compared(table, None)
    assert found.mean_error > 0.0
    assert np.isnan([found.peak_to_peak_error, found.plane_strain_mean]).all()
    assert "peak_to_peak_error" not in found.to_json(64)


def test_what_it_cannot_hold_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measuring, "find_calculix", lambda: None)
    assert "not installed" in str(full_contact_refusal(check_request(PAIR, normal_forces=[9.0])))
    skewed = check_request(PAIR, normal_forces=[9.0], misalignments=[0.0, 1e-5])
    assert "misalignment" in str(full_contact_refusal(skewed))
    apart = check_request(PAIR, normal_forces=[9.0], center_distance_changes=[0.0, 1e-5])
    assert "centre distance" in str(full_contact_refusal(apart))


def test_a_ladder_goes_on_without_it(monkeypatch: pytest.MonkeyPatch, stand_in: list[float]) -> None:
    rungs = ["iso6336", "thin_slices"]
    asked = {"normal_forces": [500.0], "positions": 32, "rungs": rungs}
    beside = frontier(PAIR, **asked, full_contact=2).to_json()
    assert beside["full_contact"]["mean_error"] == pytest.approx(SOFTER - 1.0, rel=1e-3)
    stand_in.extend([0.0] * (FAILED - len(stand_in)))
    failed = frontier(PAIR, **asked, full_contact=1)
    assert failed.full_contact is None
    assert failed.left_out == {"full_contact": "cut back too often"}
    assert [result.name for result in failed.results] == rungs
    for wrong in (0, 65, True):
        with pytest.raises(InputError, match="full_contact"):
            frontier(PAIR, **asked, full_contact=wrong)
    climbing = importlib.import_module("fe_contact.analysis.frontier")
    monkeypatch.setattr(climbing, "full_contact_refusal", lambda _: "helical")
    assert frontier(PAIR, **asked, full_contact=1).left_out == {"full_contact": "helical"}
