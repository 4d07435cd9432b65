"""The accuracy study beside records of full contact: whose they are, and what they differ by."""

import dataclasses
from collections.abc import Sequence

import numpy as np
import pytest
from analysis_requests import table_request

from bounds import written
from fe_contact import AnalysisOptions, FlankModification, Gear, GearPair, SteDatabase, TableAxes, frontier
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.studies.closed_form_fidelity import THIN_SLICES
from fe_contact.analysis.studies.full_contact_record import (
    FACE,
    NO_RECORD,
    PLANE,
    FullContactRecord,
    compare_full_contact,
    full_contact_records,
    record_of,
    solved_in,
)
from fe_contact.errors import InputError
from lineofaction.gearbox.studies.frontier.run import RUN

GEAR = Gear(teeth=20, normal_module=2e-3, face_width=8e-3, bore_diameter=20e-3)
PAIR = GearPair(GEAR, GEAR, center_distance=40e-3)
FORCES = [200.0, 500.0]
SOFTER, FAILED = 1.02, 3
FIDELITIES = ["iso6336", "thin_slices"]


@pytest.fixture(scope="module")
def checked():
    return check_request(PAIR, TableAxes(normal_forces=FORCES), AnalysisOptions(positions=32))


@pytest.fixture(scope="module")
def table(checked):
    """Of thin slices, which take no mesh."""
    return THIN_SLICES.run(checked)


def record(table: SteDatabase, positions: int = 5, failed: Sequence[int] = ()) -> FullContactRecord:
    """One per cent softer at the least load, two at the others; some positions failed."""
    position, torque = np.arange(positions) / positions, PAIR.torque(FORCES)
    lag = np.array([table.curve(torque=float(load), at=position).ste for load in torque]).T
    lag = lag * [0.5 * (1.0 + SOFTER), SOFTER]
    lag[list(failed)] = np.nan
    return FullContactRecord(
        pair=written(PAIR),
        version="0.1",
        solved_in=PLANE,
        misalignment=np.zeros(1),
        position=position,
        torque=torque,
        transmission_error=lag[None],
        error_estimate=1e-3 * lag[None],
        unknowns=30_000,
        seconds_per_solve=2.5,
    )


def test_errors_are_those_of_the_positions_that_were_solved_at_the_worst_load(table):
    found = compare_full_contact(record(table, failed=[FAILED]), table, table)
    assert (found.solves, found.solved) == (10, 8)
    assert found.mean_error == pytest.approx(SOFTER - 1.0, rel=1e-9)
    assert found.peak_to_peak_error == pytest.approx(SOFTER - 1.0, rel=1e-9)
    assert found.plane_strain_mean == pytest.approx(1.0 - 1.0 / SOFTER, rel=1e-9)
    assert found.record.mesh_error == pytest.approx(1e-3)
    facts = found.to_json(64)
    assert (facts["positions_run"], facts["positions_solved"]) == (5, 4)
    assert facts["points"][2 * FAILED] == {
        "position": FAILED / 5.0,
        "torque_n_m": pytest.approx(float(PAIR.torque(FORCES[0]))),
    }


def test_a_table_costs_its_solves_and_one_position_has_no_peak_to_peak(table):
    found = compare_full_contact(record(table, 4), table, None)
    assert found.seconds(768) == pytest.approx(768 * 2.5)
    assert found.to_json(768)["cpu_seconds_measured"] == pytest.approx(20.0)
    found = compare_full_contact(record(table, 4).at_positions(1), table, None)
    assert found.mean_error > 0.0
    assert np.isnan([found.peak_to_peak_error, found.plane_strain_mean]).all()
    assert "peak_to_peak_error" not in found.to_json(64)


def test_a_record_is_thinned_to_equally_spaced_positions(table):
    whole = record(table, 16)
    assert whole.at_positions(4).position.tolist() == [0.0, 0.25, 0.5, 0.75]
    assert whole.at_positions(64).position.tolist() == whole.position.tolist()
    assert whole.at_positions(3).transmission_error.shape == (1, 3, 2)


def test_a_record_is_read_as_it_was_written(table):
    whole = record(table, failed=[FAILED])
    read = FullContactRecord.from_json(whole.to_json())
    for field in dataclasses.fields(whole):
        np.testing.assert_equal(getattr(read, field.name), getattr(whole, field.name))


def test_a_record_is_of_the_very_pair_and_model_at_loads_of_the_case(checked, table):
    records = [record(table)]
    found = record_of(checked, records)
    assert found is not None and found.torque.tolist() == records[0].torque.tolist()
    rounded = dataclasses.replace(PAIR, center_distance=40e-3 * (1.0 + 1e-15))
    assert record_of(check_request(rounded, TableAxes(normal_forces=FORCES)), records) is not None
    single = record_of(check_request(PAIR, TableAxes(normal_forces=FORCES[1:])), records)
    assert single is not None and single.transmission_error.shape == (1, 5, 1)
    relieved = FlankModification(tip_relief=10e-6, tip_relief_length=1e-3)
    others = (
        (PAIR, TableAxes(normal_forces=[9.0])),
        (PAIR, TableAxes(normal_forces=FORCES, misalignments=[0.0, 1e-5])),
        (PAIR, TableAxes(normal_forces=FORCES, center_distance_changes=[0.0, 1e-5])),
        (
            dataclasses.replace(PAIR, pinion=dataclasses.replace(GEAR, modification=relieved)),
            TableAxes(normal_forces=FORCES),
        ),
        (dataclasses.replace(PAIR, center_distance=40.1e-3), TableAxes(normal_forces=FORCES)),
    )
    assert [record_of(check_request(*other), records) for other in others] == [None] * len(others)


def test_what_needs_the_face_is_compared_over_it():
    """A model in three dimensions, misalignment, or a flank that varies across the face; else the plane."""
    crowned = dataclasses.replace(GEAR, modification=FlankModification(helix_crowning=5e-6))
    aligned = {"normal_forces": FORCES, "positions": 32}
    needing = [
        check_request(PAIR, *table_request(model="3d", **aligned)),
        check_request(PAIR, *table_request(misalignments=[0.0, 1e-5], **aligned)),
        check_request(dataclasses.replace(PAIR, wheel=crowned), *table_request(**aligned)),
    ]
    assert solved_in(check_request(PAIR, *table_request(**aligned))) == PLANE
    assert {solved_in(one) for one in needing} == {FACE}


def test_an_accuracy_study_goes_on_without_a_record_and_says_so(table):
    request = table_request(normal_forces=FORCES, positions=32)
    beside = frontier(PAIR, *request, fidelities=FIDELITIES, full_contact=2, records=[record(table, 4)])
    assert RUN.figures(beside)["full_contact"]["mean_error"] == pytest.approx(SOFTER - 1.0, rel=1e-3)
    without = frontier(PAIR, *request, fidelities=FIDELITIES, full_contact=2)
    assert without.full_contact is None
    assert without.omitted == {"full_contact": NO_RECORD}
    assert [result.name for result in without.results] == FIDELITIES
    for wrong in (0, 65, True):
        with pytest.raises(InputError, match="full_contact"):
            frontier(PAIR, *request, fidelities=FIDELITIES, full_contact=wrong)


def test_plane_strain_is_within_half_a_per_cent_of_recorded_curves():
    """The 20/20 pair of the examples: two solvers that share neither compliance nor contact."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    pair = GearPair(gear, gear, center_distance=80e-3)
    found = frontier(
        pair,
        *table_request(torques=[50.0, 100.0, 200.0], positions=32),
        fidelities=["plane_strain", "corrected_draft"],
        full_contact=4,
    ).full_contact
    assert found is not None and found.solved == found.solves > 0
    assert found.record.torque.tolist() == pytest.approx([50.0, 75.0, 100.0, 130.0, 165.0, 200.0])
    assert found.plane_strain_mean < 5e-3
    assert found.record.mesh_error < 5e-3


def test_every_record_that_comes_with_the_study_names_its_version_and_has_solutions():
    records = full_contact_records()
    assert len(records) > 2
    for one in records:
        assert one.version and one.solved_in in (PLANE, FACE)
        assert one.transmission_error.shape == (one.misalignment.size, one.position.size, one.torque.size)
        assert np.isfinite(one.transmission_error).mean() > 0.9
