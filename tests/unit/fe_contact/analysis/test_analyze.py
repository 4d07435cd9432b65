"""The main flow: laws of its results, support loads, condition numbers, and other bodies."""

import dataclasses

import numpy as np
import pytest
from analysis_requests import table_request
from spur_gears import PAIR

from fe_contact import FlankModification, Gear, GearPair, SteDatabase, analyze
from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact.condition_number import condition_numbers
from fe_contact.errors import DatabaseError
from fe_contact.planning.plan import make_plan
from fe_contact.ste import Validity


def gear(teeth: int = 20, **changes: object) -> Gear:
    values = {"normal_module": 4e-3, "face_width": 25e-3, "bore_diameter": 40e-3} | changes
    return Gear(teeth=teeth, **values)


@pytest.fixture(scope="module")
def pair():
    return GearPair(gear(), gear(), 80e-3)


def draft(pair, **options):
    options = {"torques": [20.0, 100.0], "level": "draft", "positions": 32} | options
    return analyze(pair, **options)


def test_a_symmetric_pair_has_a_symmetric_curve(pair):
    """Mirror rule: at position x by the driver and at -x + STE/p_b by it the exchanged gears meet alike."""
    table = draft(pair, positions=None)
    x = np.linspace(0.25, 0.45, 7)  # double contact: the shift by STE/p_b moves nothing visible
    ste = table.ste(x, pair.normal_force(100.0))
    mirrored = table.ste(-x, pair.normal_force(100.0))
    assert mirrored == pytest.approx(ste, rel=2e-4)


def test_relief_lifts_the_no_load_curve_by_its_own_gap():
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=1.2e-3)
    relieved = gear(modification=relief)
    table = draft(GearPair(relieved, relieved, 80e-3))
    single = np.abs((table.position + 0.5) % 1.0 - 0.5) < 0.1
    assert np.all(table.no_load_transmission_error[single] == 0.0)
    assert table.static_transmission_error.min() > 0.0
    assert np.all(np.diff(table.static_transmission_error, axis=1) > 0.0)


def test_effects_off_are_what_leaving_them_out_changes(pair):
    """Study figures of the 20/20 pair at 100 N m: mean -5.7 %, peak-to-peak +20 %."""
    full = draft(pair, level="standard", positions=None).curve(torque=100.0)
    without = draft(pair, level="standard", positions=None, effects={"tooth_coupling": "off"}).curve(
        torque=100.0
    )
    assert without.mean.value / full.mean.value - 1.0 == pytest.approx(-0.057, abs=0.005)
    assert without.peak_to_peak.value / full.peak_to_peak.value - 1.0 == pytest.approx(0.20, abs=0.02)
    # A study of the 20/20 pair at 100 N m found +2.2 % of the mean with plain Hertz contact at the tip
    # edges, which itself read 1.2 to 1.6 % of STE too stiff there: +1.7 % is left of it.
    off = draft(pair, level="standard", positions=None, effects={"corner_contact": "off"}).curve(torque=100.0)
    assert off.mean.value / full.mean.value - 1.0 == pytest.approx(0.017, abs=0.003)


@pytest.mark.law
def test_the_error_estimate_covers_the_true_error(pair):
    """Against a mesh twice as fine; the draft's estimate must hold and not be idle."""
    rough = draft(pair, positions=None)
    fine = draft(pair, positions=None, level="fine")
    truth = fine.ste(rough.position[:, None], rough.force[None, :])[..., None, None]
    error = np.abs(rough.static_transmission_error - truth)
    estimate = rough.error_estimate
    assert np.mean(error <= estimate) > 0.95
    assert np.median(estimate / truth) < 0.01


def test_progress_reaches_the_end_of_every_stage(pair):
    seen: dict[str, float] = {}
    draft(pair, progress=lambda stage, fraction: seen.update({stage: fraction}))
    assert seen == {"compliance": 1.0, "contact": 1.0, "error estimate": 1.0}


@pytest.fixture(scope="module")
def plain_pair():
    return PAIR


@pytest.fixture(scope="module")
def table(plain_pair):
    return analyze(plain_pair, torques=[100.0], level="draft", positions=32)


def test_the_force_axis_is_what_was_asked_and_valid_to_the_highest_support_load(table, tmp_path):
    assert table.torque == pytest.approx([100.0])
    assert table.support_force[0] < 2e-3 * table.force[0]
    assert table.support_force[-1] == pytest.approx(2.0 * table.force[0])
    at = np.array([0.4])
    inside = table.force_at(at, table.ste(at, 1.9 * table.force[0]))
    above = table.force_at(at, table.ste(at, 2.1 * table.force[0]))
    assert inside.validity[0] == Validity.INSIDE
    assert above.validity[0] == Validity.ABOVE_TABLE
    table.to_netcdf(tmp_path / "table.nc")
    assert SteDatabase.from_netcdf(tmp_path / "table.nc").identical(table)
    with pytest.raises(DatabaseError, match="support_force"):
        dataclasses.replace(
            table,
            support_force=table.force,
            support_transmission_error=table.static_transmission_error,
            support_tangent_compliance=table.tangent_compliance,
            support_pairs_in_contact=table.pairs_in_contact,
        )


def test_loads_below_and_above_the_only_asked_one_are_true(table, plain_pair):
    """A solve at 30 and 150 N m is met by the table of 100 N m alone, outside the moving handover."""
    solved = analyze(plain_pair, torques=[30.0, 150.0], level="draft", positions=32)
    steady = (np.abs(table.position - 0.5) < 0.2) | (np.abs((table.position + 0.5) % 1.0 - 0.5) < 0.12)
    for k, force in enumerate(solved.force):
        expected = solved.static_transmission_error[steady, k, 0, 0]
        assert table.ste(table.position[steady], force) == pytest.approx(expected, rel=2e-3)


def test_condition_numbers_leave_out_what_is_no_candidate_or_not_definite():
    rng = np.random.default_rng(5)
    basis = rng.normal(size=(3, 5, 5))
    real = 1e-9 * (basis @ basis.transpose(0, 2, 1) + 0.1 * np.eye(5))
    wider = np.zeros((3, 7, 7))
    wider[:, 1:6, 1:6] = real
    assert condition_numbers(wider) == pytest.approx(np.linalg.cond(real), rel=1e-9)
    wider[1], wider[1, :5, :5] = 0.0, real[1]
    wider[2], wider[2, 1:5, 1:5] = 0.0, real[2, 1:, 1:]
    expected = [*np.linalg.cond(real[:2]), np.linalg.cond(real[2, 1:, 1:])]
    assert condition_numbers(wider) == pytest.approx(expected, rel=1e-9)
    assert condition_numbers(np.array([np.diag([1.0, -1.0]), np.diag([1.0, 4.0])])).tolist() == [np.inf, 4.0]


MISALIGNMENTS, CHANGES = (-2e-5, 0.0, 2e-5), (0.0, 1e-4)


@pytest.fixture(scope="module")
def laid_out():
    """Operating points over a draft, those laid out afresh over a standard mesh, and the pair on it."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    axes = {"misalignments": MISALIGNMENTS, "center_distance_changes": CHANGES}
    checked = check_request(GearPair(gear, gear, 80e-3), *table_request(torques=[100.0], **axes))
    request = checked.request
    plans = [
        make_plan(request.pair, request.load, request.options, checked.model, level)
        for level in ("draft", "standard")
    ]
    draft, standard = (PairContact(request.pair, plan) for plan in plans)
    first, second = (operating_points(request.scene, request.choices, each) for each in (draft, standard))
    return first, second, standard


def test_other_bodies_are_laid_out_as_afresh(laid_out):
    first, afresh, bodies = laid_out
    found = first.on_bodies(bodies)
    assert found.shape == afresh.shape == (3, 2)
    assert found.nominal is bodies
    for place, other in zip(found.places, afresh.places, strict=True):
        assert place.model == other.model
        assert place.contact.pair == other.contact.pair
        assert place.contact.plan is bodies.plan
    first, _, bodies = laid_out
    found = first.on_bodies(bodies)
    contacts = np.array([id(place.contact) for place in found.places]).reshape(found.shape)
    assert np.all(contacts == contacts[0])
    assert contacts[0, 0] != contacts[0, 1]
    assert all(place.contact._problems is not bodies._problems for place in found.places)
