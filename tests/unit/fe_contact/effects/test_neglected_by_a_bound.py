"""An effect is left out by a bound: by the pair's moduli and bodies, and by the largest gap anywhere."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from analysis_requests import table_request
from spur_gears import GEAR, PAIR, gear

from fe_contact import FlankGrid, FlankModification, GearPair, ToothFlank, analyze
from fe_contact.analysis.request.request_check import check_request
from fe_contact.effects.influence.estimate import estimate_influence, largest_part
from fe_contact.geometry import PitchDeviation, RunOut, Wave
from fe_contact.material import Material

pytestmark = pytest.mark.usefixtures("coarse_sectors")

POM = Material(2.8e9, 0.35)
RELIEF = FlankModification(tip_relief=12e-6, tip_relief_length=0.5e-3)
SOFT = GearPair(replace(GEAR, modification=RELIEF, material=POM), replace(GEAR, modification=RELIEF))
TOLERANCE = {"torques": [20.0, 200.0], "tolerance": 0.02}


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def reason(pair: GearPair, **asked: Any) -> str:
    checked = check_request(pair, *table_request(**asked))
    return next(entry.verdict.reason for entry in checked.ledger if entry.name == "corner_contact")


def test_plastic_on_steel_is_planned_as_its_run_shows_it(cache):
    asked: dict[str, Any] = {"torques": [20.0], "level": "draft", "positions": 32}
    steel = GearPair(SOFT.wheel, SOFT.wheel)
    assert not check_request(steel, *table_request(**asked)).model.corner_contact
    assert check_request(SOFT, *table_request(**asked)).model.corner_contact
    table = analyze(SOFT, cache=cache, **asked)
    assert table.metadata.receipt["repeated"] == []
    # the run without tip edges finds the same
    without = analyze(SOFT, cache=cache, effects={"corner_contact": "off"}, **asked)
    (edges,) = (
        entry for entry in without.metadata.receipt["assumptions"] if entry["effect"] == "corner_contact"
    )
    assert edges["holds"] is False
    assert analyze(steel, cache=cache, **asked).metadata.receipt["repeated"] == []


def test_the_deflection_that_closes_a_gap_is_inverse_to_the_moduli():
    def deflection(modulus):
        gears = replace(gear(), material=Material(modulus, 0.3))
        words = reason(GearPair(gears, gears), torques=[100.0])
        return float(words.removeprefix("deflections up to ").partition(" ")[0])

    assert deflection(20.6e9) == pytest.approx(10.0 * deflection(206e9), rel=0.05)


TRACES = [(0.0, 0.0, -5.4, 0.0, 13.8), (0.0, 0.0, 0.0, 0.0, 13.8)]
"""Removed in um at the last nodes of a measured trace: at the tip, and 0.15, 0.45, 1.2 mm before it."""


@pytest.mark.parametrize("removed", TRACES)
@pytest.mark.parametrize("tooth", [3, 40])
def test_the_end_of_a_measured_trace_is_not_dropped(removed, tooth):
    """Samples of 32 of 67 base pitches, 64 positions in each, passed it by."""
    wheel = gear(67)
    roll = np.array([5e-3, *(wheel.tip_roll_length - np.array([1.2e-3, 0.45e-3, 0.15e-3, 0.0]))])
    grid = FlankGrid(tuple(roll), (-0.01, 0.01), tuple((1e-6 * x, 1e-6 * x) for x in removed))
    rough = GearPair(GEAR, replace(wheel, tooth_flanks=(ToothFlank(tooth, flank_grid=grid),)))
    for tolerance in (0.3, 0.02):
        asked = TOLERANCE | {"tolerance": tolerance, "pitches": 67}
        assert check_request(rough, *table_request(**asked)).decision["tooth_deviations"] == "on"


def drawn(seed: int) -> GearPair:
    """A pair with small gaps of all kinds, some of which a tolerance does not need."""
    random = np.random.default_rng(seed)
    size = 10.0 ** random.uniform(-9.5, -6.0, 5)
    pinion = replace(
        GEAR,
        modification=FlankModification(profile_crowning=size[0], tip_relief=size[1], tip_relief_length=1e-3),
        pitch_deviation=PitchDeviation(size[2] * random.uniform(-1.0, 1.0, 20)),
    )
    wheel = replace(GEAR, run_out=RunOut(eccentricity=size[3]), waves=(Wave(37, size[4]),))
    return GearPair(pinion, wheel)


@pytest.mark.law
@pytest.mark.drawn
@pytest.mark.parametrize("seed", range(6))
def test_what_is_neglected_changes_less_than_its_bound_and_the_tolerance(seed):
    tilt = 10.0 ** np.random.default_rng([seed, 1]).uniform(-8.0, -6.5)
    asked = TOLERANCE | {"torques": [150.0], "pitches": 20, "misalignments": [tilt]}
    checked = check_request(drawn(seed), *table_request(**asked))
    allowed, request = checked.request.options.allowed, checked.request
    bounds = []
    for name in request.neglected:
        scene, decision = checked.assessing(name)
        influence = estimate_influence(scene, decision, name)
        extent = scene.effect(name).extent(scene)
        assert np.all(np.abs(influence.mean) <= extent.reach + 1e-12)
        assert np.all(np.abs(influence.peak_to_peak) <= extent.span + 1e-12)
        bounds.append(largest_part(extent, influence.full.mean, influence.full.peak_to_peak, allowed))
    assert sum(bounds) <= 0.501 * allowed.relative


def test_drawn_pairs_have_neglected_effects_and_others():
    """The law above is not empty."""
    asked = TOLERANCE | {"torques": [150.0], "pitches": 20}
    counts = [len(check_request(drawn(seed), *table_request(**asked)).request.neglected) for seed in range(6)]
    assert max(counts) >= 1
    assert min(counts) < 4


def test_a_table_without_what_is_neglected_is_within_the_tolerance(cache):
    """Solved by finite elements: switched on, what was neglected changes less than the tolerance."""
    asked: dict[str, Any] = {"torques": [150.0], "positions": 64, "pitches": 20, "tolerance": 0.02}
    pair = next(
        p for p in map(drawn, range(6)) if check_request(p, *table_request(**asked)).request.neglected
    )
    names = check_request(pair, *table_request(**asked)).request.neglected
    without = analyze(pair, cache=cache, **asked)
    whole = analyze(pair, cache=cache, **asked, effects=dict.fromkeys(names, "on"))
    for figure in ("mean", "peak_to_peak"):
        less, more = (getattr(table, figure)(torque=150.0).value for table in (without, whole))
        assert abs(less - more) <= max(0.02 * more, 20e-9)


def test_the_pair_itself_is_as_ever():
    assert check_request(PAIR, *table_request(torques=[100.0])).model.corner_contact
