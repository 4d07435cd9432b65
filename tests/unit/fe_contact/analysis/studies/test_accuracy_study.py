"""The accuracy study: closed forms, two solvers, and errors that fall."""

import dataclasses
import math
from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair, InternalGearPair, RingGear
from fe_contact.analysis.pairs.slice_springs import SpringContact, slice_stiffness
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.studies.closed_form_fidelity import ISO6336, THIN_SLICES
from fe_contact.analysis.studies.frontier import (
    FIDELITIES,
    Frontier,
    chosen_fidelity,
    frontier,
    predicted_frontier,
)
from fe_contact.contact import solve_contact
from fe_contact.contact.problem import ContactProblem
from fe_contact.errors import InputError
from fe_contact.geometry.iso6336_stiffness import iso6336_stiffness
from fe_contact.options import TableAxes
from fe_contact.planning.plan import make_plan


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


def test_a_prediction_has_the_fidelities_of_finite_elements(spur):
    checked = Frontier.request(pair_of(width=4e-3), *table_request(normal_forces=[500.0], positions=32))
    told = predicted_frontier(checked, SPUR, None)
    assert [*told] == [result.name for result in spur.results if result.stages.get("compliance")]
    assert min(told.values()) > 0.0
    helical = Frontier.request(pair_of(0.3), *table_request(normal_forces=[500.0], positions=32))
    assert [*predicted_frontier(helical, SPUR, None)] == ["3d_draft", "3d_standard"]


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
