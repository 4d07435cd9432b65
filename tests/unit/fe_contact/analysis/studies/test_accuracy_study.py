"""The accuracy study: closed forms, two solvers, errors that fall, and full contact beside it."""

from __future__ import annotations

import dataclasses
import importlib
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair, InternalGearPair, RingGear
from fe_contact.analysis.pairs.slice_springs import SpringContact, slice_stiffness
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.studies import measured_full_contact as measuring
from fe_contact.analysis.studies.closed_form_fidelity import ISO6336, THIN_SLICES
from fe_contact.analysis.studies.frontier import (
    FIDELITIES,
    Frontier,
    chosen_fidelity,
    frontier,
    predicted_frontier,
)
from fe_contact.analysis.studies.measured_full_contact import (
    NAME,
    full_contact_refusal,
    measure_full_contact,
    needs_the_face,
)
from fe_contact.contact import solve_contact
from fe_contact.contact.problem import ContactProblem
from fe_contact.errors import InputError, SolveError
from fe_contact.full_contact import FullContactPoint, FullContactTable
from fe_contact.geometry.iso6336_stiffness import iso6336_stiffness
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.planning.plan import make_plan
from fe_contact.ste import SteDatabase
from fe_contact.types import Status
from lineofaction.gearbox.studies.frontier.run import RUN


def pair_of(helix: float = 0.0, width: float = 8e-3, **modification: float) -> GearPair:
    gear = Gear(20, 2e-3, width, 20e-3, helix_angle=helix, modification=FlankModification(**modification))
    mate = dataclasses.replace(gear, helix_angle=-helix, modification=FlankModification())
    return GearPair(gear, mate, 40e-3 / math.cos(helix))


def run(fidelity, pair, **asked):
    checked = check_request(pair, *table_request(normal_forces=[500.0], positions=64, **asked))
    return fidelity.run(checked)


def test_iso_stiffness_of_a_spur_pair_is_the_closed_form():
    """One pair carries c_gamma_alpha b/eps_alpha, two pairs twice as much; the load is shared evenly."""
    pair = pair_of()
    table = run(ISO6336, pair)
    single = iso6336_stiffness(pair).mesh_stiffness * pair.face_width / pair.transverse_contact_ratio
    ste, pairs = table.static_transmission_error[:, 0, 0, 0], table.pairs_in_contact[:, 0, 0, 0]
    assert set(pairs) == {1, 2}
    np.testing.assert_allclose(ste, 500.0 / (single * pairs), rtol=1e-12, atol=0.0)
    shares = table.load_share[pairs == 2, 0, 0, 0]
    np.testing.assert_allclose(shares[shares > 0.0], 0.5, rtol=1e-12)


@pytest.mark.parametrize("helix", [math.radians(15.0), -math.radians(28.0)])
def test_iso_stiffness_of_a_helical_pair_follows_the_length_of_its_contact_lines(helix):
    """The lengths are measured by sampling the field of action, which knows no slices."""
    pair = pair_of(helix, width=16e-3)
    table = run(ISO6336, pair)
    path, across = pair.path_of_contact, 8e-3 * (2.0 * (np.arange(4000) + 0.5) / 4000 - 1.0)
    index = np.arange(-6, 7)
    roll = path.pitch_point + (table.position[:, None, None] + index[:, None]) * pair.base_pitch
    roll = roll + across * math.tan(pair.base_helix_angle)
    in_pairs = ((roll >= path.start) & (roll <= path.end)).mean(axis=2).sum(axis=1)
    stiffness = iso6336_stiffness(pair).mesh_stiffness * 16e-3 * in_pairs / pair.transverse_contact_ratio
    expected = 500.0 * math.cos(pair.base_helix_angle) / stiffness
    np.testing.assert_allclose(table.static_transmission_error[:, 0, 0, 0], expected, rtol=1e-3)


def test_iso_stiffness_is_even_where_the_overlap_is_a_whole_pitch():
    """With eps_beta = 1 the contact lines keep their length."""
    helix = math.radians(20.0)
    pair = pair_of(helix, width=math.pi * 2e-3 / math.sin(helix))
    ste = run(ISO6336, pair).static_transmission_error[:, 0, 0, 0]
    assert np.ptp(ste) < 1e-9 * ste.mean()
    force = 500.0 * math.cos(pair.base_helix_angle) / pair.face_width
    assert ste.mean() == pytest.approx(force / iso6336_stiffness(pair).mesh_stiffness, rel=1e-9, abs=0.0)


@pytest.mark.parametrize(
    ("helix", "misalignment", "crown"),
    [(0.0, 0.0, 0.0), (0.0, 3e-5, 0.0), (0.0, 0.0, 1e-5), (0.3, 2e-5, 5e-6)],
)
def test_thin_slices_are_the_contact_solver_with_uncoupled_slices(helix, misalignment, crown):
    """One solves in closed form what the other iterates, whose slices are held against published figures."""
    pair = pair_of(helix, helix_crowning=crown)
    checked = check_request(pair, TableAxes(normal_forces=[50.0, 500.0], misalignments=[misalignment]))
    plan = make_plan(pair, checked.request.load, checked.request.options, checked.model)
    springs = SpringContact(pair, plan, law=THIN_SLICES.law)
    problem, found = springs.solve(checked.model, np.linspace(0.0, 0.9, 7), plan.load)
    stiffness = slice_stiffness(pair, problem.candidates, THIN_SLICES.law)
    diagonal = np.eye(stiffness.shape[1]) / stiffness[:, None, :]
    # bodies a million times stiffer than steel: no local approach; each slice has its own point
    own = np.eye(len(problem.candidates.curves))
    candidates = replace(problem.candidates, curves=own, heights=own)
    rigid = solve_contact(ContactProblem(candidates, diagonal, 1e19, 3e-20, 3e-20), plan.load)
    assert rigid.converged
    np.testing.assert_allclose(found.deflection, rigid.deflection, rtol=1e-7)
    np.testing.assert_allclose(found.tangent, rigid.tangent, rtol=1e-6)
    np.testing.assert_allclose(found.force, rigid.force, rtol=1e-5, atol=1e-5 * plan.load[-1])


def test_thin_slices_have_the_mean_stiffness_of_the_standard_without_its_correction():
    """Without corner contact the parabola's mean over the cycle is c_gamma_alpha/C_M."""
    pair = pair_of()
    table = run(THIN_SLICES, pair, effects={"corner_contact": "off"})
    # the stiffness is averaged, not the compliance
    stiffness = (1.0 / table.tangent_compliance[:, 0, 0, 0]).mean() / pair.face_width
    assert stiffness == pytest.approx(iso6336_stiffness(pair).mesh_stiffness / 0.8, rel=0.02)


SPUR = ["iso6336", "thin_slices", "plane_strain", "corrected_draft", "3d_draft", "3d_standard"]


@pytest.fixture(scope="module")
def spur():
    return frontier(pair_of(width=4e-3), *table_request(normal_forces=[500.0], positions=32), fidelities=SPUR)


def test_a_prediction_has_the_fidelities_of_finite_elements_and_full_contact_by_position(spur):
    checked = Frontier.request(pair_of(width=4e-3), *table_request(normal_forces=[500.0], positions=32))
    told = predicted_frontier(checked, SPUR, 8, None)
    assert [*told] == [*(result.name for result in spur.results if result.stages.get("compliance")), NAME]
    assert min(told.values()) > 0.0
    assert told[NAME] == pytest.approx(8.0 * predicted_frontier(checked, SPUR, 1, None)[NAME])
    helical = Frontier.request(pair_of(0.3), *table_request(normal_forces=[500.0], positions=32))
    assert [*predicted_frontier(helical, SPUR, 8, None)] == ["3d_draft", "3d_standard"]


def test_errors_of_a_spur_pair_fall_from_fidelity_to_fidelity(spur):
    errors = {result.name: result.mean_error for result in spur.results}
    falling = [errors[name] for name in ("iso6336", "plane_strain", "3d_draft")]
    assert falling == sorted(falling, reverse=True)
    assert errors["thin_slices"] > errors["plane_strain"] > errors["corrected_draft"]
    assert errors["iso6336"] > 0.05
    assert max(errors["corrected_draft"], errors["3d_draft"]) < 0.01


@pytest.mark.nightly
def test_errors_of_a_helical_pair_fall_from_fidelity_to_fidelity():
    found = frontier(
        pair_of(math.radians(15.0)),
        *table_request(normal_forces=[500.0], positions=16),
        fidelities=["iso6336", "3d_draft", "3d_standard"],
    )
    iso, draft, _ = found.results
    assert iso.mean_error > draft.mean_error > 0.0
    assert iso.peak_to_peak_error > draft.peak_to_peak_error > 0.0


def test_the_reference_states_what_its_mesh_leaves(spur):
    """Elements of 0.15 for 0.2 modules, second order: (0.2/0.15)^2 - 1 of the difference is left."""
    draft, standard = spur.results[-2:]
    assert standard.mean_error == pytest.approx(draft.mean_error / ((0.2 / 0.15) ** 2 - 1.0), rel=1e-12)


def test_a_fidelity_that_is_not_valid_says_why():
    ring = RingGear(96, 2e-3, 8e-3, 212e-3, addendum_coefficient=0.9)
    gear = Gear(teeth=36, normal_module=2e-3, face_width=8e-3, bore_diameter=30e-3)
    internal = check_request(InternalGearPair(gear, ring, 60e-3), TableAxes(normal_forces=[500.0]))
    helical = check_request(pair_of(0.3), TableAxes(normal_forces=[500.0]))
    refused = {
        fidelity.name: (fidelity.refusal(internal), fidelity.refusal(helical)) for fidelity in FIDELITIES
    }
    assert all("external" in refused[name][0] for name in ("iso6336", "thin_slices"))
    plane = [name for name in refused if name.startswith(("plane", "corrected"))]
    assert all("helix" in refused[name][1] for name in plane)
    assert all(refused[name] == (None, None) for name in refused if name.startswith("3d"))


@pytest.mark.parametrize("level", ["draft", "standard", "fine"])
@pytest.mark.parametrize("model", ["auto", "plane_strain", "3d"])
def test_the_chosen_fidelity_is_the_model_and_the_mesh_asked_for(model, level):
    checked = check_request(pair_of(), *table_request(normal_forces=[500.0], model=model, level=level))
    fidelity = next(fidelity for fidelity in FIDELITIES if fidelity.name == chosen_fidelity(checked))
    made = fidelity.as_computed(checked)
    assert made.model == checked.model
    assert made.request.options.level == (level if model != "plane_strain" else "standard")


def test_an_unknown_fidelity_is_refused_by_name():
    with pytest.raises(InputError, match="fidelities"):
        frontier(pair_of(), TableAxes(normal_forces=[500.0]), fidelities=["4d"])


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


def test_a_table_costs_its_solves_and_one_position_has_no_peak_to_peak(
    checked: Checked, table: SteDatabase, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake(table, monkeypatch, [])
    found = measure_full_contact(checked, 4, lambda *_: None)
    assert found.seconds(768) == pytest.approx(768 * 5.0 / len(FORCES))
    assert found.to_json(768)["cpu_seconds_measured"] == pytest.approx(20.0)
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
    assert not needs_the_face(check_request(PAIR, *table_request(**aligned)))
    for checked in needing:
        assert needs_the_face(checked)
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
        *table_request(torques=[2.0, 20.0], positions=32),
        fidelities=["plane_strain", "corrected_draft"],
        full_contact=2,
    )
    measured = found.full_contact
    assert measured is not None
    assert len(measured.solved) == 4
    assert measured.plane_strain_mean < 5e-3
    assert measured.own_error < 5e-3
