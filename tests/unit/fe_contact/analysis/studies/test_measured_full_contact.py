"""Full contact beside the accuracy study: errors where it was run, honest times, reasons."""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Sequence

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.studies import measured_full_contact as measuring
from fe_contact.analysis.studies.frontier import THIN_SLICES, frontier
from fe_contact.analysis.studies.measured_full_contact import (
    _over_face,
    full_contact_refusal,
    measure_full_contact,
)
from fe_contact.errors import InputError, SolveError
from fe_contact.full_contact import FullContactPoint, FullContactTable
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.types import Status
from lineofaction.gearbox.studies.frontier.run import RUN

GEAR = Gear(teeth=20, normal_module=2e-3, face_width=8e-3, bore_diameter=20e-3)
PAIR = GearPair(GEAR, GEAR, center_distance=40e-3)
FORCES = [200.0, 500.0]
SOFTER, FAILED = 1.02, 3


@pytest.fixture(scope="module")
def checked() -> Checked:
    return check_request(PAIR, TableAxes(normal_forces=FORCES), AnalysisOptions(positions=32))


@pytest.fixture(scope="module")
def table(checked: Checked) -> SteDatabase:
    """Of thin slices, which take no mesh."""
    return THIN_SLICES.run(checked)


def fake(table: SteDatabase, monkeypatch: pytest.MonkeyPatch, failed: Sequence[int]) -> list[list[float]]:
    """One per cent softer at the least load, two at the others; some positions fail. Returns the torques."""
    asked: list[list[float]] = []

    def point(place: int, position: float, torque: float, load: int) -> FullContactPoint:
        if place in failed:
            return FullContactPoint.failed(Status.ITERATION_LIMIT, "cut back too often", 9, torque)
        factor = SOFTER if load else 0.5 * (1.0 + SOFTER)
        lag = factor * float(table.curve(torque=torque, at=[position]).ste[0])
        return FullContactPoint(
            position, lag, Status.CONVERGED, "", 9, 1e-9, 1.0, torque, error_estimate=1e-3 * lag
        )

    def solved(_pair, torques, positions, **_):  # type: ignore[no-untyped-def]
        asked.append(list(torques))
        points = tuple(
            tuple(point(i, x, torque, load) for load, torque in enumerate(torques))
            for i, x in enumerate(positions)
        )
        count = len(positions)
        return FullContactTable(
            np.array(positions), np.array(torques), points, np.full(count, 30_000), np.full(count, 5.0)
        )

    monkeypatch.setattr(measuring, "solve_full_contact", solved)
    return asked


def test_errors_are_those_of_the_positions_that_were_solved_at_the_worst_load(
    checked: Checked, table: SteDatabase, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = fake(table, monkeypatch, [FAILED])
    found = measure_full_contact(checked, 5, lambda *_: None).compared(table, table)
    assert asked == [pytest.approx(PAIR.torque(FORCES))]  # all loads at once
    assert [row[0].status.usable for row in found.tables[0].points] == [True, True, True, False, True]
    assert found.mean_error == pytest.approx(SOFTER - 1.0, rel=1e-9)
    assert found.peak_to_peak_error == pytest.approx(SOFTER - 1.0, rel=1e-9)
    assert found.plane_strain_mean == pytest.approx(1.0 - 1.0 / SOFTER, rel=1e-9)
    assert found.own_error == pytest.approx(1e-3)
    facts = found.to_json(64)
    assert (facts["positions_run"], facts["positions_solved"]) == (5, 4)
    assert facts["points"][2 * FAILED] == {
        "status": "iteration_limit", "iterations": 9, "reason": "cut back too often",
        "torque_n_m": pytest.approx(float(PAIR.torque(FORCES[0]))),
    }  # fmt: skip


def test_a_table_costs_its_solves_at_the_mean_of_those_that_were_run(
    checked: Checked, table: SteDatabase, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake(table, monkeypatch, [])
    found = measure_full_contact(checked, 4, lambda *_: None)
    assert found.seconds(768) == pytest.approx(768 * 5.0 / len(FORCES))
    assert found.to_json(768)["cpu_seconds_measured"] == pytest.approx(20.0)


def test_one_position_has_no_peak_to_peak(
    checked: Checked, table: SteDatabase, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake(table, monkeypatch, [])
    found = measure_full_contact(checked, 1, lambda *_: None).compared(table, None)
    assert found.mean_error > 0.0
    assert np.isnan([found.peak_to_peak_error, found.plane_strain_mean]).all()
    assert "peak_to_peak_error" not in found.to_json(64)


def test_what_it_cannot_hold_is_said() -> None:
    assert full_contact_refusal(check_request(PAIR, TableAxes(normal_forces=[9.0]))) is None
    wider = dataclasses.replace(GEAR, face_width=9e-3)
    beside = check_request(
        GearPair(GEAR, wider, 40e-3), TableAxes(normal_forces=[9.0], misalignments=[0.0, 1e-5])
    )
    assert "unlike or offset faces" in str(full_contact_refusal(beside))
    apart = check_request(PAIR, TableAxes(normal_forces=[9.0], center_distance_changes=[0.0, 1e-5]))
    assert "center distance" in str(full_contact_refusal(apart))
    helical = [dataclasses.replace(GEAR, helix_angle=angle) for angle in (0.2, -0.2)]
    tilted = GearPair(*helical, center_distance=2.0 * helical[0].reference_radius)
    assert "helical" in str(full_contact_refusal(check_request(tilted, TableAxes(normal_forces=[9.0]))))


def test_what_needs_the_face_is_solved_over_it(table: SteDatabase, monkeypatch: pytest.MonkeyPatch) -> None:
    """A model in three dimensions, misalignment, or a flank that varies across the face; else the plane."""
    crowned = dataclasses.replace(GEAR, modification=FlankModification(helix_crowning=5e-6))
    aligned = {"normal_forces": FORCES, "positions": 32}
    needing = [
        check_request(PAIR, *table_request(model="3d", **aligned)),
        check_request(PAIR, *table_request(misalignments=[0.0, 1e-5], **aligned)),
        check_request(dataclasses.replace(PAIR, wheel=crowned), *table_request(**aligned)),
    ]
    assert not _over_face(check_request(PAIR, *table_request(**aligned)))
    for checked in needing:
        assert _over_face(checked)
        assert full_contact_refusal(checked) is None
    asked = fake_over_face(table, monkeypatch)
    found = measure_full_contact(needing[1], 2, lambda *_: None)
    assert asked == [(0.0, 1e-5)]
    assert found.solved_in == "three dimensions"
    assert len(found.points) == 2 * 2 * len(FORCES)
    facts = found.to_json(64)
    assert facts["misalignments_m"] == [0.0, 1e-5]
    assert facts["positions_solved"] == 2
    assert facts["cpu_seconds_predicted"] > 100.0


def fake_over_face(table: SteDatabase, monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, ...]]:
    """Stand in for the solver by that of the plane; returns the misalignments requested."""
    fake(table, monkeypatch, [])
    asked: list[tuple[float, ...]] = []

    def solved(pair, torques, positions, misalignments, **_):  # type: ignore[no-untyped-def]
        asked.append(misalignments)
        return (measuring.solve_full_contact(pair, torques, positions),) * len(misalignments)

    monkeypatch.setattr(measuring, "solve_full_contact_over_face", solved)
    return asked


def test_an_accuracy_study_goes_on_without_it(table: SteDatabase, monkeypatch: pytest.MonkeyPatch) -> None:
    fidelities = ["iso6336", "thin_slices"]
    asked = {"normal_forces": FORCES, "positions": 32}
    fake(table, monkeypatch, [])
    beside = frontier(PAIR, *table_request(**asked), fidelities=fidelities, full_contact=2)
    assert RUN.figures(beside)["full_contact"]["mean_error"] == pytest.approx(SOFTER - 1.0, rel=1e-3)
    fake(table, monkeypatch, [0])
    failed = frontier(PAIR, *table_request(**asked), fidelities=fidelities, full_contact=1)
    assert failed.full_contact is None
    assert failed.left_out == {"full_contact": "cut back too often"}
    assert [result.name for result in failed.results] == fidelities
    for wrong in (0, 65, True):
        with pytest.raises(InputError, match="full_contact"):
            frontier(PAIR, *table_request(**asked), fidelities=fidelities, full_contact=wrong)
    module = importlib.import_module("fe_contact.analysis.studies.frontier")
    monkeypatch.setattr(module, "full_contact_refusal", lambda _: "helical")
    assert frontier(PAIR, *table_request(**asked), fidelities=fidelities, full_contact=1).left_out == {
        "full_contact": "helical"
    }


def test_no_solution_at_all_is_an_error_with_its_reason(
    checked: Checked, table: SteDatabase, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake(table, monkeypatch, [0, 1])
    with pytest.raises(SolveError, match="cut back too often"):
        measure_full_contact(checked, 2, lambda *_: None)


def test_the_peer_runs_beside_the_accuracy_study() -> None:
    """The thing itself: our plane strain is within half a per cent of it."""
    found = frontier(
        PAIR,
        TableAxes(torques=[2.0, 20.0]),
        AnalysisOptions(positions=32),
        fidelities=["plane_strain", "corrected_draft"],
        full_contact=2,
    )
    measured = found.full_contact
    assert measured is not None
    assert len(measured.solved) == 4
    assert measured.plane_strain_mean < 5e-3
    assert measured.own_error < 5e-3
