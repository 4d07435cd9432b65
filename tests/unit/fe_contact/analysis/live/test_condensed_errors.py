"""A table of a condensed pair says how wrong it is: as an analysis would, and within what is true."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, SteDatabase, analyze
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.ste.curve_errors import AT_NODES, SOURCES
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, MEAN, PEAK_TO_PEAK
from fe_contact.types import FloatArray

pytestmark = pytest.mark.usefixtures("coarse_sectors")

GEAR = Gear(teeth=20, normal_module=1e-3, face_width=4e-3, bore_diameter=10e-3)
PAIR = GearPair(GEAR, GEAR, center_distance=20e-3)
TORQUES = np.array([0.5, 1.0])
SHORT = FlankModification(tip_relief=3e-6, tip_relief_length=0.3e-3)
LONG = FlankModification(tip_relief=8e-6, tip_relief_length=0.6e-3)
ROUND = FlankModification(profile_crowning=3e-6)
FLANKS = {"plain": FlankModification(), "short": SHORT, "long": LONG, "round": ROUND}
CORNERS = {"corner_contact": "on"}


def with_flank(modification: FlankModification) -> GearPair:
    return replace(PAIR, pinion=replace(GEAR, modification=modification))


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


@pytest.fixture(scope="module")
def pair(cache):
    """Return the corrected plane, analyzed with a full receipt."""
    return condensed(analyze(PAIR, torques=TORQUES, level="draft", positions=64, cache=cache), cache)


def condensed(table: SteDatabase, cache: Path) -> CondensedPair:
    found = condensed_pair(PAIR, table, {}, cache)
    assert found is not None
    return found


def figures(table: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """Return mean, peak-to-peak and first three harmonics by load, and their errors, (2, 5) in m."""
    curves = [table.curve(force=float(force)) for force in table.force]
    shown = [[one.mean, one.peak_to_peak, *one.harmonics[:3]] for one in curves]
    return (
        np.array([[each.value for each in row] for row in shown]),
        np.array([[each.error for each in row] for row in shown]),
    )


@pytest.mark.parametrize("model", ["auto", "3d"])
def test_errors_of_the_discretization_are_those_of_an_analysis_of_its_own(cache, model):
    count = 64 if model == "3d" else 192
    wish = {"torques": TORQUES, "level": "draft", "model": model, "cache": cache, "effects": CORNERS}
    bodies = condensed(analyze(PAIR, positions=16, **wish), cache)
    quick, whole = (
        bodies.table(with_flank(SHORT), TORQUES),
        analyze(with_flank(SHORT), positions=count, **wish),
    )
    for name in ("discretisation", "slices", "finite_width", "contact_solver"):
        source = AT_NODES.index(name)
        # solved from other forces, STE differs by its rounding, and so do the least of its differences
        rounding = 1e-15 * float(whole.static_transmission_error.max())
        assert quick.curve_error[source] == pytest.approx(whole.curve_error[source], rel=1e-9, abs=rounding)
    acting = {"discretisation", "slices" if model == "3d" else "finite_width"}
    assert {name for name in AT_NODES if quick.curve_error[AT_NODES.index(name)].max() > 1e-12} >= acting


def test_wide_load_patches_count_where_they_show(pair):
    """Patches are wider on the coarse meshes: at the knee of a relief that changes the curve."""
    coarse, own = pair.contacts.coarse, pair.contact.plan.patch
    assert coarse is not None and coarse.plan.patch.half_width > 1.5 * own.half_width
    alike = replace(coarse, plan=replace(coarse.plan, patch=own), _problems={})
    flat = pair.contact.in_plane_strain
    blind = replace(pair, contacts=replace(pair.contacts, coarse=alike, patched=flat))
    source = AT_NODES.index("discretisation")
    with_it, without = (each.table(with_flank(LONG), TORQUES).curve_error[source] for each in (pair, blind))
    some = [MEAN, PEAK_TO_PEAK, FIRST_HARMONIC]
    assert np.max(with_it[some] / without[some]) > 1.5


@pytest.mark.law
def test_stated_errors_hold_against_finer_meshes_and_more_positions(cache, pair):
    held, over = [], []
    for flank in FLANKS.values():
        value, stated = figures(pair.table(with_flank(flank), TORQUES))
        finest = analyze(
            with_flank(flank),
            torques=TORQUES,
            level="fine",
            positions=512,
            receipt="minimal",
            cache=cache,
            effects=CORNERS,
        )
        ratio = stated / np.maximum(np.abs(value - figures(finest)[0]), 1e-5 * np.abs(value))
        held.append(ratio >= 1.0)
        over.append(ratio)
    assert np.mean(held) >= 0.9
    assert np.median(over) < 10.0


def test_without_coarse_meshes_errors_are_those_usual_of_the_level(tmp_path, pair):
    table = analyze(PAIR, torques=TORQUES, level="draft", positions=64, receipt="minimal", cache=tmp_path)
    alone = condensed(table, tmp_path)
    assert alone.contacts.coarse is None
    usual, measured = (each.table(with_flank(SHORT), TORQUES) for each in (alone, pair))
    assert np.array_equal(usual.static_transmission_error, measured.static_transmission_error)
    said = [each.metadata.receipt["discretisation_error"] for each in (usual, measured)]
    assert said == ["expected", "measured"]
    ratio = (figures(usual)[1] / figures(measured)[1])[:, :3]
    assert np.all((ratio > 1.0) & (ratio < 6.0))


def test_a_pair_so_misaligned_that_it_leads_is_wrong_by_more_than_nothing(tmp_path):
    asked = {"level": "draft", "model": "3d", "positions": 8, "receipt": "minimal"}
    alone = condensed(analyze(PAIR, torques=TORQUES, cache=tmp_path, **asked), tmp_path)
    misaligned = alone.table(PAIR, TORQUES, 50e-6)
    assert np.all(misaligned.static_transmission_error.mean(axis=0) < 0.0)
    assert np.all(figures(misaligned)[1] > 0.0)


def test_plane_strain_that_stands_in_for_a_finite_width_is_corrected(cache):
    """A tolerance may leave the finite width out; live answers then lack it too, and say how much that is."""
    wide = replace(PAIR, pinion=replace(GEAR, face_width=60e-3), wheel=replace(GEAR, face_width=60e-3))
    table = analyze(wide, torques=15.0 * TORQUES, tolerance=0.05, positions=16, cache=cache)
    found = condensed_pair(wide, table, {}, cache)
    assert found is not None and list(found.neglected) == ["finite_width"]
    quick = found.table(wide, 15.0 * TORQUES)
    source = AT_NODES.index("finite_width")
    mean = figures(quick)[0][:, 0]
    known = (1.0 + finite_width_excess(wide)[0]) * mean
    figures_over_face = [quick.curve(force=float(force)).over_face for force in quick.force]
    assert [one.mean.value for one in figures_over_face] == pytest.approx(known, rel=0.01, abs=0.0)
    assert not quick.curve_error[source].any()
    unchecked = [one for one in quick.metadata.receipt["assumptions"] if one["holds"] is None]
    assert "finite_width" in {one["effect"] for one in unchecked}


def test_an_error_is_told_at_the_loads_and_not_between_them(pair):
    table = pair.table(PAIR, TORQUES)
    assert table.metadata.receipt["not_estimated"] == []
    assert np.isfinite(table.curve_error[: len(AT_NODES)]).all() and np.isfinite(table.error_estimate).all()
    assert np.isfinite(table.peak_to_peak(torque=0.5).error)
    assert np.isnan(table.peak_to_peak(torque=0.7).error)
    assert list(table.metadata.receipt["curve_error"]) == list(SOURCES[: len(AT_NODES)])


def test_nothing_is_assembled_for_a_second_question(pair):
    pair.table(PAIR, TORQUES)
    kept = [dict(each._problems) for each in _contacts(pair)]
    pair.table(with_flank(LONG), np.array([0.7]))
    assert [each._problems for each in _contacts(pair)] == kept
    assert [len(each) for each in kept] == [1, 1, 1]


def _contacts(pair: CondensedPair) -> list[PairContact]:
    """Return the contacts of the corrected plane on all its discretizations."""
    every = pair.contacts
    return [each for each in (every.fine, every.plane, every.coarse) if each is not None]
