"""Curves from a compliance in memory are those of a whole analysis, for any flanks, load and alignment."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fe_contact import Gear, GearPair, analyze
from fe_contact.analysis.flanks.flank_results import flank_results
from fe_contact.analysis.flanks.load_distribution import load_distribution
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.errors import InputError
from fe_contact.geometry import FlankModification, PitchDeviation
from fe_contact.options import AnalysisOptions, OperatingPoint, Run
from fe_contact.ste import SteDatabase

pytestmark = pytest.mark.usefixtures("coarse_sectors")

GEAR = Gear(teeth=20, normal_module=1e-3, face_width=4e-3, bore_diameter=10e-3)
PAIR = GearPair(GEAR, GEAR, center_distance=20e-3)
RELIEF = FlankModification(tip_relief=3e-6, tip_relief_length=0.4e-3)
TORQUES = np.array([0.5, 1.0])


def with_flank(pair: GearPair, modification: FlankModification) -> GearPair:
    return replace(pair, pinion=replace(pair.pinion, modification=modification))


def table_of(pair: GearPair, cache: Path, model: str = "plane_strain", **wish: object) -> SteDatabase:
    return analyze(
        pair,
        torques=TORQUES,
        level="draft",
        model=model,
        positions=64 if model == "3d" else 192,
        receipt="minimal",
        cache=cache,
        effects={"corner_contact": "on"},
        **wish,
    )


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def condensed(pair: GearPair, cache: Path, model: str = "plane_strain") -> CondensedPair:
    """Analyze, then fetch what that left in the cache."""
    found = condensed_pair(pair, table_of(pair, cache, model), {}, cache)
    assert found is not None
    return found


def test_a_relieved_flank_has_the_curve_of_its_own_analysis(cache):
    relieved = with_flank(PAIR, RELIEF)
    quick = condensed(PAIR, cache).table(relieved, TORQUES)
    whole = table_of(relieved, cache)
    assert np.array_equal(quick.static_transmission_error, whole.static_transmission_error)
    assert np.array_equal(quick.load_share, whole.load_share)
    plain = table_of(PAIR, cache)
    assert abs(quick.peak_to_peak(torque=1.0).value / plain.peak_to_peak(torque=1.0).value - 1.0) > 0.02


def test_crowning_and_misalignment_have_the_curve_of_their_own_analysis(cache):
    crowned = with_flank(PAIR, FlankModification(helix_crowning=2e-6))
    quick = condensed(PAIR, cache, "3d").table(crowned, TORQUES, misalignment=5e-6)
    whole = table_of(crowned, cache, "3d", misalignments=[5e-6])
    assert np.array_equal(quick.static_transmission_error, whole.static_transmission_error)
    assert np.array_equal(quick.face_centroid, whole.face_centroid)


@pytest.mark.law
def test_crowned_and_misaligned_flanks_carry_what_they_carry_in_results_of_their_own(cache):
    crowned = with_flank(PAIR, FlankModification(helix_crowning=2e-6))
    table, solved = condensed(PAIR, cache, "3d").solve_table(crowned, TORQUES, misalignment=5e-6)
    quick = load_distribution(solved.pair, solved.problem, solved.solution, 1)
    options = AnalysisOptions(level="draft", model="3d", effects={"corner_contact": "on"})
    point = OperatingPoint(torque=1.0, misalignment=5e-6)
    whole = flank_results(crowned, point, options, Run(cache=cache), at=quick.position)
    for field in ("force", "pressure", "roll_length_1"):
        values, other = getattr(quick, field), getattr(whole, field)
        np.testing.assert_allclose(values, other, rtol=0.0, atol=1e-12 * other.max())
    assert np.array_equal(quick.deflection, table.static_transmission_error[:, 1, 0, 0])
    assert quick.mean_face_load_factor == pytest.approx(whole.mean_face_load_factor, rel=1e-12, abs=0.0)
    assert quick.mean_face_load_factor > 1.5


@pytest.mark.parametrize("model", ["plane_strain", "3d"])
def test_a_preview_is_every_other_position_of_the_table_without_errors(cache, model):
    pair, relieved = condensed(PAIR, cache, model), with_flank(PAIR, RELIEF)
    quick, _ = pair.solve_table(relieved, TORQUES, preview=True)
    whole = pair.table(relieved, TORQUES)
    assert np.array_equal(quick.position, whole.position[::2])
    for name in ("static_transmission_error", "load_share", "max_pressure"):
        assert np.array_equal(getattr(quick, name), getattr(whole, name)[::2])
    assert np.isnan(quick.curve_error).all() and np.isfinite(whole.curve_error[0]).all()
    assert "discretisation" in quick.metadata.receipt["not_estimated"]


@pytest.mark.parametrize("model", ["plane_strain", "3d"])
def test_a_preview_is_found_from_the_one_before_but_does_not_depend_on_it(cache, model):
    pair, relieved = condensed(PAIR, cache, model), with_flank(PAIR, RELIEF)
    pair._latest.preview = None
    _, alone = pair.solve_table(relieved, TORQUES, preview=True)
    pair.solve_table(PAIR, 0.9 * np.array(TORQUES), preview=True)
    _, after = pair.solve_table(relieved, TORQUES, preview=True)
    np.testing.assert_allclose(after.solution.deflection, alone.solution.deflection, rtol=1e-10)
    largest = alone.solution.force.max()
    np.testing.assert_allclose(after.solution.force, alone.solution.force, rtol=0.0, atol=1e-8 * largest)


def test_a_preview_after_one_of_almost_the_same_flanks_takes_fewer_iterations(cache):
    pair, relieved = condensed(PAIR, cache, "3d"), with_flank(PAIR, RELIEF)
    pair._latest.preview = None
    _, alone = pair.solve_table(relieved, TORQUES, preview=True)
    near = with_flank(PAIR, replace(RELIEF, tip_relief=1.05 * RELIEF.tip_relief))
    pair.solve_table(near, TORQUES, preview=True)
    _, after = pair.solve_table(relieved, TORQUES, preview=True)
    assert after.solution.iterations.mean() < 0.8 * alone.solution.iterations.mean()


def test_another_center_distance_has_the_curve_of_its_own_analysis(cache):
    pair = condensed(PAIR, cache)
    for change in (1e-5, 3e-5, 2e-5):
        quick = pair.table(with_flank(PAIR, RELIEF), TORQUES, center_distance_change=change)
    assert list(pair._by_distance) == [3e-5, 2e-5]  # those requested last
    whole = table_of(with_flank(PAIR, RELIEF), cache, center_distance_changes=[2e-5])
    assert np.array_equal(quick.center_distance_change, whole.center_distance_change)
    assert np.array_equal(quick.static_transmission_error, whole.static_transmission_error)
    nominal = pair.table(with_flank(PAIR, RELIEF), TORQUES)
    assert np.abs(nominal.static_transmission_error / quick.static_transmission_error - 1.0).max() > 1e-3


def test_a_center_distance_at_which_more_teeth_touch_is_refused(cache, monkeypatch):
    pair = condensed(PAIR, cache)
    module = sys.modules[CondensedPair.__module__]  # its name in the package is the function's
    monkeypatch.setattr(module, "condensed_teeth", lambda _: 7)
    with pytest.raises(InputError, match=r"center_distance_changes\[0\].*at most \d teeth .* 7 can"):
        pair.table(PAIR, TORQUES, center_distance_change=1e-5)
    assert not pair._by_distance


def test_what_bodies_or_plane_cannot_hold_is_refused(cache):
    pair = condensed(PAIR, cache)
    with pytest.raises(InputError, match=r"pinion\.modification"):
        pair.table(with_flank(PAIR, FlankModification(helix_crowning=2e-6)), TORQUES)
    with pytest.raises(InputError, match="misalignments"):
        pair.table(PAIR, TORQUES, misalignment=5e-6)
    with pytest.raises(InputError, match="gears and the center distance"):
        pair.table(replace(PAIR, center_distance=20.01e-3), TORQUES)
    with pytest.raises(InputError, match="at most 2: 2 times"):
        pair.table(PAIR, np.array([2.001]))
    assert pair.table(PAIR, np.array([2.0])).n_failed == 0


def test_pitch_deviations_stay_with_the_gear(cache):
    deviation = PitchDeviation(tuple(2e-6 * np.cos(2.0 * np.pi * np.arange(20) / 20)))
    uneven = replace(PAIR, pinion=replace(GEAR, pitch_deviation=deviation))
    quick = condensed(uneven, cache).table(with_flank(uneven, RELIEF), TORQUES)
    assert quick.period == 20
    whole = table_of(with_flank(uneven, RELIEF), cache)
    assert quick.position.size == whole.position.size == 20 * 192
    assert np.array_equal(quick.static_transmission_error, whole.static_transmission_error)


def test_without_the_compliance_there_is_no_condensed_pair(cache, tmp_path):
    assert condensed_pair(PAIR, table_of(PAIR, cache), {}, tmp_path) is None
