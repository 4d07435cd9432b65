"""Laws of the estimated errors of mean, peak-to-peak and harmonics."""

import dataclasses
import math

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair, RunOut, Wave, analyze
from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.estimates.curve_errors import HARMONIC_SHARE
from fe_contact.analysis.pairs import pair_contact
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.options import LEVELS, Run
from fe_contact.planning.discretization import SLICE_ORDER, face_discretization
from fe_contact.ste.curve_errors import OF_LOAD_ARM, SOURCES, all_sources
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, OFF_MESH, quantity_changes
from fe_contact.ste.fields import DIMENSIONS

FORCE = 3000.0


def spur(**modification: float) -> GearPair:
    pinion = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    changed = dataclasses.replace(pinion, modification=FlankModification(**modification))
    return GearPair(changed, pinion, 80e-3)


def helical() -> GearPair:
    pinion = Gear(18, 3e-3, 15e-3, 25e-3, helix_angle=math.radians(20.0))
    wheel = dataclasses.replace(pinion, helix_angle=-pinion.helix_angle)
    return GearPair(pinion, wheel, 18 * 3e-3 / math.cos(pinion.helix_angle))


def figures(table, **place):
    curve = table.curve(force=FORCE, **place)
    return curve.mean, curve.peak_to_peak, curve.harmonics[0]


@pytest.mark.law
@pytest.mark.parametrize(
    ("pair", "how"),
    [
        (spur(), {"positions": 32}),
        (spur(profile_slope=5e-6), {"positions": 64}),
        (spur(profile_crowning=8e-6), {"model": "plane_strain", "positions": 64}),
    ],
)
def test_the_estimate_covers_the_true_error(pair, how):
    """Against a mesh more than three times as fine, positions where the curve bends, and the finite width.

    Errors of a plane are those of its model; its correction covers the finite width (decision 13).
    """
    rough = analyze(pair, normal_forces=[FORCE], level="draft", **how)
    model = how.get("model", "auto")
    truth = analyze(pair, normal_forces=[FORCE], level="fine", model=model)
    for found, exact in zip(figures(rough), figures(truth), strict=True):
        true = abs(found.value - exact.value)
        assert true <= found.error < max(0.05 * found.value, 2.0 * true)
    corrected = rough.curve(force=FORCE).over_face
    assert (corrected is None) == (model == "auto")
    if corrected is not None:
        wide = figures(analyze(pair, normal_forces=[FORCE], level="fine"))
        for found, exact in zip((corrected.mean, corrected.peak_to_peak), wide, strict=False):
            true = abs(found.value - exact.value)
            assert true <= found.error < max(0.05 * found.value, 2.0 * true)


def test_where_flanks_can_touch_is_found_once_under_patches_of_one_width(monkeypatch):
    """Fine bodies under the patches of the coarse ones, and the coarse bodies, have the same candidates."""
    searches: list[tuple[bytes, object]] = []
    found = pair_contact.contact_candidates

    def counted(pair, model, position, rule, slices):
        searches.append((position.tobytes(), rule))
        return found(pair, model, position, rule, slices)

    monkeypatch.setattr(pair_contact, "contact_candidates", counted)
    table = analyze(spur(), normal_forces=[FORCE], level="draft", model="plane_strain", positions=64)
    assert len({rule for _, rule in searches}) == 2
    assert len(searches) == len(set(searches))
    assert np.isfinite(table.curve_error[SOURCES.index("discretisation")]).all()


@pytest.mark.law
def test_slices_of_a_helical_pair_are_a_source_of_ripple():
    """The estimate must see what slices do to the ripple, also where the mesh is exact: a little."""
    table = analyze(helical(), normal_forces=[FORCE], level="draft", positions=32)
    slices = table.curve_error[SOURCES.index("slices"), :, 0, 0, 0]
    ripple = float(table.peak_to_peak(force=FORCE))
    assert 1e-4 * ripple < slices[1] < 0.02 * ripple
    assert slices[0] < 0.01 * float(table.mean(force=FORCE))
    made = face_discretization(helical(), "draft")
    assert made.coarse_slices == made.slices // 2
    assert made.remaining_slices == pytest.approx(
        1.0 / ((made.slices / made.coarse_slices) ** SLICE_ORDER - 1.0)
    )


@pytest.mark.law
def test_what_few_slices_change_is_carried_on_along_the_curve():
    """The table with the error that is left taken off: of its peak-to-peak, and half that of the error.

    An overlap of one: half the slices ripple more than the table, by far more than they leave in it.
    """
    quiet = GearPair(
        *(dataclasses.replace(gear, face_width=27.55e-3) for gear in (helical().pinion, helical().wheel)),
        helical().center_distance,
    )
    checked = check_request(quiet, *table_request(normal_forces=[FORCE], level="draft", positions=32))
    decision = decide(checked)
    made = decision.plan.discretization
    table, few = (
        compute_database(checked, {}, Run(), decision.in_slices(count))
        for count in (made.slices, made.coarse_slices)
    )
    own, sliced = (one.static_transmission_error[:, 0, 0, 0] for one in (table, few))
    left = made.remaining_slices * (own - sliced)
    expected = max(abs(np.ptp(own + left) - np.ptp(own)), 0.5 * np.ptp(left))
    stated = table.curve_error[SOURCES.index("slices"), :, 0, 0, 0]
    assert stated[1] == pytest.approx(expected, rel=1e-9)
    assert expected < 0.9 * made.remaining_slices * abs(np.ptp(own) - np.ptp(sliced))
    assert stated[0] == pytest.approx(abs(left.mean()), rel=1e-3)


@pytest.mark.law
def test_load_arms_of_two_tables_differ_by_no_more_than_both_state():
    """Mean, peak-to-peak and five harmonics, of other meshes, slices and positions."""
    how = {"model": "3d", "normal_forces": [FORCE]}
    fine = analyze(helical(), level="standard", positions=128, **how)
    for positions in (16, 64):
        rough = analyze(helical(), level="draft", positions=positions, **how)
        arms = rough.load_arm[:, :, 0, 0], fine.load_arm[:, :, 0, 0]
        some = [*range(OFF_MESH), *range(FIRST_HARMONIC, FIRST_HARMONIC + 5)]
        apart = quantity_changes(rough.position, *arms, 1, fine.position)[some]
        stated = sum(all_sources(each.load_arm_error[..., 0, 0])[some] for each in (rough, fine))
        assert np.all(apart <= stated)
        assert np.median(stated / apart) < 20.0


@pytest.mark.law
def test_a_mean_arm_errs_although_its_change_crosses_zero():
    """Of meshes that move the arm about its mean, the mean errs by half of how far they move it."""
    table = analyze(helical(), level="draft", model="3d", normal_forces=[FORCE], positions=32)
    mean, ripple = table.load_arm_error[OF_LOAD_ARM.index("discretisation"), :2, 0, 0, 0]
    assert mean > 0.1 * ripple


@pytest.mark.law
def test_a_load_that_does_not_travel_has_no_error():
    table = analyze(spur(), normal_forces=[FORCE], level="draft", model="plane_strain", positions=16)
    assert table.load_arm_error.shape == (3, 23, 1, 1, 1)
    assert not table.load_arm_error.any() and not table.load_arm.any()


@pytest.mark.law
def test_orders_of_a_shaft_are_as_sure_as_what_pitches_differ_by():
    """Meshes err alike at every pitch, in mesh orders; of run-out they miss a part of what load adds."""
    turned = {"run_out": RunOut(eccentricity=3e-6, wobble=0.0), "waves": (Wave(7, 2e-7, 0.3),)}
    plain = spur()
    pair = dataclasses.replace(plain, pinion=dataclasses.replace(plain.pinion, **turned))
    how = {"normal_forces": [FORCE], "model": "plane_strain", "positions": 32}
    rough, fine = (analyze(pair, level=level, **how) for level in ("draft", "standard"))
    seen, sure = (table.curve(force=FORCE).spectrum for table in (rough, fine))
    beside = np.abs(seen.order - np.rint(seen.order)) > 1e-9
    apart = np.abs(seen.amplitude - sure.amplitude)
    assert np.all(apart[beside] <= seen.error[beside])
    assert seen.amplitude[[0, 6]] == pytest.approx([3e-6, 2e-7], rel=0.05)
    assert seen.error[0] < 1e-3 * seen.amplitude[0]
    assert seen.error[0] < 0.2 * seen.error[19]
    by_mesh = rough.curve_error[SOURCES.index("discretisation"), :, 0, 0, 0]
    assert by_mesh[OFF_MESH] < 0.1 * by_mesh[FIRST_HARMONIC]


def test_no_harmonic_of_a_helical_pair_errs_by_less_than_its_share():
    table = analyze(helical(), normal_forces=[FORCE], level="draft", positions=32)
    for name in ("slices", "discretisation"):
        errors = table.curve_error[SOURCES.index(name), :, 0, 0, 0]
        harmonics = errors[FIRST_HARMONIC:]
        share = HARMONIC_SHARE * errors[1] / np.sqrt(np.arange(1, harmonics.size + 1))
        assert np.all(harmonics >= share * (1.0 - 1e-12))
        assert np.any(harmonics > 1.01 * share)


def test_what_a_coarse_mesh_leaves_follows_the_layers_it_has():
    """Second order; layers come in whole groups, so that a coarse mesh may have more than two thirds."""
    for width in (5.0, 9.0, 12.0, 15.0, 18.0, 22.0):
        for level in LEVELS:
            gear = dataclasses.replace(helical().pinion, face_width=width * 3e-3)
            mate = dataclasses.replace(gear, helix_angle=-gear.helix_angle)
            made = face_discretization(GearPair(gear, mate, helical().center_distance), level)
            ratio = made.recipes[0].layers / made.coarse_recipes[0].layers
            assert 4.0 / 3.0 <= ratio <= 1.6
            assert made.remaining == pytest.approx(1.0 / (min(ratio, 1.5) ** 2 - 1.0))
            for recipe in (*made.recipes, *made.coarse_recipes):
                assert recipe.layers // recipe.layer_group >= 6  # below a helical tooth


def test_sources_make_up_the_error_which_falls_with_the_level():
    errors = [
        [found.error for found in figures(analyze(spur(), normal_forces=[FORCE], level=level))]
        for level in ("draft", "standard", "fine")
    ]
    assert np.all(np.diff(errors, axis=0) < 0.0)
    plane = analyze(spur(), normal_forces=[FORCE], level="draft")
    for name in ("slices", "force", "misalignment", "center_distance_change"):
        assert not plane.curve_error[SOURCES.index(name)].any()
    assert plane.curve_error[SOURCES.index("discretisation")].any()
    table = analyze(spur(), normal_forces=[1500.0, FORCE], level="draft")
    by_source = table.metadata.receipt["curve_error"]
    assert set(by_source) == set(SOURCES)
    assert not table.metadata.receipt["not_estimated"]
    stated = math.hypot(*(source["peak_to_peak_m"][1] for source in by_source.values()))
    assert stated == pytest.approx(table.peak_to_peak(force=FORCE).error, rel=1e-12)
    between = table.peak_to_peak(force=0.5 * (1500.0 + FORCE)).error
    assert between > 0.5 * math.hypot(*(source["peak_to_peak_m"][0] for source in by_source.values()))


@pytest.mark.parametrize("positions", [None, 32])
def test_a_minimal_receipt_changes_no_result_and_says_what_is_unknown(positions):
    how = {"normal_forces": [1500.0, FORCE], "level": "draft", "positions": positions}
    full, minimal = analyze(spur(), **how), analyze(spur(), receipt="minimal", **how)
    for name in DIMENSIONS:
        if name != "error_estimate":
            assert np.array_equal(getattr(full, name), getattr(minimal, name)), name
    receipt = minimal.metadata.receipt
    assert receipt["not_estimated"] == list(SOURCES)
    assert not receipt["curve_error"]
    assert "error estimate" not in receipt["stages"]
    assert np.isnan(minimal.error_estimate).all()
    assert all(math.isnan(found.error) for found in figures(minimal))
