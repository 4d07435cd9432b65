"""Records of full contact: what is solved for them, and what they cannot hold."""

import dataclasses

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import Gear, GearPair, Status, TableAxes
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.studies.full_contact_record import FACE, PLANE, full_contact_records
from fe_contact.errors import SolveError
from model_studies.progress import unreported
from verification import full_contact_record as recording
from verification.full_contact import FullContactPoint, FullContactTable, solve_full_contact
from verification.full_contact_record import full_contact_refusal, record_full_contact

GEAR = Gear(teeth=20, normal_module=2e-3, face_width=8e-3, bore_diameter=20e-3)
PAIR = GearPair(GEAR, GEAR, center_distance=40e-3)
FORCES = [200.0, 500.0]


def solved_table(
    torques: list[float], positions: list[float], failed: tuple[int, ...] = ()
) -> FullContactTable:
    def point(number, position, torque):
        if number in failed:
            return FullContactPoint.failed(Status.ITERATION_LIMIT, "cut back too often", 9, torque)
        lag = 1e-7 * torque
        return FullContactPoint(
            position, lag, Status.CONVERGED, "", 9, 1e-9, 1.0, torque, error_estimate=1e-3 * lag
        )

    points = tuple(tuple(point(i, x, torque) for torque in torques) for i, x in enumerate(positions))
    count = len(positions)
    return FullContactTable(
        np.array(positions), np.array(torques), points, np.full(count, 30_000), np.full(count, 5.0)
    )


def test_all_loads_are_solved_at_equally_spaced_positions(monkeypatch):
    monkeypatch.setattr(
        recording,
        "solve_full_contact",
        lambda _, torques, positions, **__: solved_table(torques, positions, (1,)),
    )
    record = record_full_contact(check_request(PAIR, TableAxes(normal_forces=FORCES)), 4, unreported)
    assert (record.solved_in, record.unknowns) == (PLANE, 30_000)
    assert record.position.tolist() == [0.0, 0.25, 0.5, 0.75]
    np.testing.assert_allclose(record.torque, PAIR.torque(FORCES))
    assert np.isnan(record.transmission_error[0, 1]).all()
    assert record.transmission_error[0, 2].tolist() == (1e-7 * record.torque).tolist()
    assert record.seconds_per_solve == pytest.approx(4 * 5.0 / 8)


def test_misaligned_gears_are_solved_over_the_face(monkeypatch):
    def solved(_pair, torques, positions, misalignments, **_):
        return (solved_table(torques, positions),) * len(misalignments)

    monkeypatch.setattr(recording, "solve_full_contact_over_face", solved)
    checked = check_request(PAIR, *table_request(misalignments=[0.0, 1e-5], normal_forces=FORCES))
    record = record_full_contact(checked, 2, unreported)
    assert record.solved_in == FACE
    assert record.misalignment.tolist() == [0.0, 1e-5]
    assert record.transmission_error.shape == (2, 2, len(FORCES))


def test_no_solution_at_all_is_an_error_with_its_reason(monkeypatch):
    monkeypatch.setattr(
        recording,
        "solve_full_contact",
        lambda _, torques, positions, **__: solved_table(torques, positions, (0, 1)),
    )
    with pytest.raises(SolveError, match="cut back too often"):
        record_full_contact(check_request(PAIR, TableAxes(normal_forces=FORCES)), 2, unreported)


def test_what_it_cannot_hold_is_said():
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


def test_the_record_of_the_accuracy_study_is_what_is_solved_today():
    """One position of the 20/20 pair of the examples, under the least and the largest load."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    record = full_contact_records()[0]
    table = solve_full_contact(GearPair(gear, gear, 80e-3), record.torque[[0, -1]].tolist(), [0.25])
    (at,) = np.flatnonzero(record.position == 0.25)
    np.testing.assert_allclose(
        table.transmission_error[0], record.transmission_error[0, at, [0, -1]], rtol=1e-6
    )
