"""What tables, flank results and root stress took for granted is checked: set right, refused or reported."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from analysis_requests import point_request, table_request
from spur_gears import GEAR, PAIR

from fe_contact import FlankModification, GearPair, Shaft, analyze
from fe_contact.analysis.flanks.flank_results import flank_results
from fe_contact.analysis.flanks.root_stress import root_stress
from fe_contact.analysis.pairs.tip_edges import OUTSIDE, handovers
from fe_contact.analysis.request import neglected_effects
from fe_contact.analysis.request.request_check import check_request
from fe_contact.errors import SolveError
from fe_contact.options import Run, TableAxes
from fe_contact.ste import SteDatabase
from fe_contact.types import Json

pytestmark = pytest.mark.usefixtures("coarse_sectors")


# tips relieved by more than twice the even deflection, but not by that of a misaligned face
RELIEVED = replace(GEAR, modification=FlankModification(tip_relief=12e-6, tip_relief_length=0.3e-3))
CLEAR = GearPair(RELIEVED, RELIEVED)
SKEWED = {"normal_forces": [1500.0], "misalignments": [150e-6], "level": "draft", "positions": 16}
# its bound, 20 nm of peak-to-peak, is a third of what the tolerance allows
TINY = {"torques": [100.0], "misalignments": [0.02e-6], "positions": 16, "tolerance": 0.02}


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def table(pair: GearPair, cache: Path, **asked: object) -> SteDatabase:
    return analyze(pair, cache=cache, **asked)


def assumption(found: SteDatabase, effect: str) -> Json:
    (entry,) = [one for one in found.metadata.receipt["assumptions"] if one["effect"] == effect]
    return dict(entry)


def same(one: SteDatabase, other: SteDatabase) -> None:
    """Bit by bit the same numbers."""
    for name in (
        "static_transmission_error",
        "tangent_compliance",
        "load_share",
        "support_transmission_error",
    ):
        if hasattr(one, name):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_an_automatic_effect_that_is_needed_is_switched_on_and_the_table_repeated(cache):
    assert not check_request(CLEAR, *table_request(**SKEWED)).model.corner_contact
    repeated, explicit = (
        table(CLEAR, cache, **SKEWED, effects=effects) for effects in ({}, {"corner_contact": "on"})
    )
    same(repeated, explicit)
    (again,) = repeated.metadata.receipt["repeated"]
    assert set(again["turned_on"]) == {"corner_contact"}
    assert again["cpu_seconds"] > 0.0
    entry = next(one for one in repeated.metadata.effect_ledger if one["name"] == "corner_contact")
    assert entry["on"]
    assert entry["choice"] == "auto"
    assert entry["decision"].startswith("on after a run without it")
    assert explicit.metadata.receipt["repeated"] == []


def test_the_caller_may_have_it_fail_or_only_reported(cache):
    with pytest.raises(SolveError, match="tip edges stay clear"):
        table(CLEAR, cache, **SKEWED, on_violation="fail")
    reported = table(CLEAR, cache, **SKEWED, on_violation="report")
    assert assumption(reported, "corner_contact")["holds"] is False
    same(reported, table(CLEAR, cache, **SKEWED, effects={"corner_contact": "off"}))


@pytest.mark.law
def test_what_was_switched_off_by_name_stays_off(cache):
    asked = {"torques": [100.0], "level": "draft", "positions": 64}
    without, whole = (table(PAIR, cache, **asked, effects=e) for e in ({"corner_contact": "off"}, {}))
    assert without.metadata.receipt["repeated"] == []
    found = assumption(without, "corner_contact")
    assert found["holds"] is False
    # a contact left out carries at most until the deflection has fallen to its gap
    change = np.max(without.static_transmission_error - whole.static_transmission_error)
    assert 0.0 < change < found["change"] * without.peak_to_peak(torque=100.0).value


def test_edges_that_stay_clear_pass(cache):
    relieved = replace(GEAR, modification=FlankModification(tip_relief=40e-6, tip_relief_length=0.5e-3))
    asked = {"torques": [20.0], "level": "draft", "positions": 32}
    found = table(GearPair(relieved, relieved), cache, **asked)
    assert assumption(found, "corner_contact")["holds"] is True
    assert assumption(found, "corner_contact")["change"] == 0.0
    # Shafts give way by more than the relief; tip edges move with them.
    shaft = Shaft(length=0.2, diameter=0.03, position=0.1)
    asked = SKEWED | {"misalignments": [0.0], "effects": {"corner_contact": "off"}}
    found = table(GearPair(RELIEVED, RELIEVED, shafts=(shaft, shaft)), cache, **asked)
    assert found.static_transmission_error.min() > 24e-6
    assert assumption(found, "corner_contact")["holds"] is True


def test_an_effect_below_the_tolerance_is_neglected_and_its_model_with_it(cache):
    neglected, aligned = (table(PAIR, cache, **(TINY | more)) for more in ({}, {"misalignments": [0.0]}))
    same(neglected, aligned)
    assert neglected.metadata.receipt["plan"]["model"] == aligned.metadata.receipt["plan"]["model"]
    entry = next(one for one in neglected.metadata.effect_ledger if one["name"] == "misalignment")
    assert not entry["on"]
    assert entry["called_for"]
    assert entry["decision"].startswith("neglected: ")
    assert 0.0 < abs(entry["influence"]["relative_mean"]) < 0.1 * 0.02
    assert assumption(neglected, "misalignment")["holds"] is True


@pytest.mark.parametrize(
    "more",
    [
        {"tolerance": None, "level": "draft"},
        {"effects": {"misalignment": "on"}},
        {"misalignments": [20e-6]},
        {"misalignments": [0.1e-6]},  # its estimate is a thousandth of the tolerance, its bound is not
        {"misalignments": [3e-6], "tolerance": 2e-3},
    ],
)
def test_it_is_kept_without_a_tolerance_by_name_or_where_it_matters(more):
    checked = check_request(PAIR, *table_request(**TINY | more))
    assert checked.decision["misalignment"] == "on"
    assert checked.model.across_face


@pytest.mark.law
def test_an_effect_neglected_in_error_is_set_right(cache, monkeypatch):
    asked = TINY | {"misalignments": [10e-6]}
    right = table(PAIR, cache, **asked)
    monkeypatch.setattr(neglected_effects, "SHARE", 1e3)
    monkeypatch.setattr(neglected_effects, "LARGEST_PART", 1e3)
    only = dict.fromkeys(("corner_contact", "tooth_coupling", "finite_width"), "on")
    del only["finite_width"]
    wrong = table(PAIR, cache, **asked, effects=only)
    (again,) = wrong.metadata.receipt["repeated"]
    assert set(again["turned_on"]) == {"misalignment"}
    same(wrong, right)


def test_teeth_that_jam_are_noticed(cache):
    # backlash of 60 um: room for a misalignment of 40 um, not for one of 80 um
    thinner = replace(GEAR, thickness_allowance=32e-6)
    pair = GearPair(thinner, thinner)
    asked = {"torques": [20.0], "level": "draft", "positions": 16}
    free, jammed = (
        table(pair, cache, **asked, misalignments=[skew]).metadata.receipt["assumptions"]
        for skew in (40e-6, 80e-6)
    )
    coast = [next(one for one in found if one["assumption"].startswith("coast")) for found in (free, jammed)]
    assert [one["holds"] for one in coast] == [True, False]
    assert "jam" in coast[1]["reason"]


SKEWED_POINT = {"normal_force": 1500.0, "misalignment": 150e-6, "level": "draft"}
AT = [0.1, *handovers(CLEAR)]


def edges(receipt: Json) -> Json:
    (entry,) = [one for one in receipt["assumptions"] if one["effect"] == "corner_contact"]
    return dict(entry)


def test_flank_results_are_repeated_refused_or_reported(cache):
    how: dict[str, Any] = {"run": Run(cache=cache), "at": AT}
    repeated = flank_results(CLEAR, *point_request(**SKEWED_POINT), **how)
    explicit = flank_results(CLEAR, *point_request(effects={"corner_contact": "on"}, **SKEWED_POINT), **how)
    for name in ("pressure", "line_load", "position"):
        np.testing.assert_array_equal(getattr(repeated, name), getattr(explicit, name))
    receipt = repeated.metadata.receipt
    (again,) = receipt["repeated"]
    assert set(again["turned_on"]) == {"corner_contact"}
    entry = next(one for one in repeated.metadata.effect_ledger if one["name"] == "corner_contact")
    assert entry["on"] and entry["decision"].startswith("on after a run without it")
    assert explicit.metadata.receipt["repeated"] == []
    reported = flank_results(CLEAR, *point_request(on_violation="report", **SKEWED_POINT), **how)
    assert edges(reported.metadata.receipt)["holds"] is False
    assert reported.pressure.max() != repeated.pressure.max()
    with pytest.raises(SolveError, match="tip edges stay clear"):
        flank_results(CLEAR, *point_request(on_violation="fail", **SKEWED_POINT), **how)


def test_root_stress_is_repeated_too(cache):
    how: dict[str, Any] = {"run": Run(cache=cache), "at": AT}
    repeated = root_stress(CLEAR, *point_request(**SKEWED_POINT), **how)
    explicit = root_stress(CLEAR, *point_request(effects={"corner_contact": "on"}, **SKEWED_POINT), **how)
    np.testing.assert_array_equal(repeated.wheel.stress, explicit.wheel.stress)
    (again,) = repeated.receipt["repeated"]
    assert set(again["turned_on"]) == {"corner_contact"}
    off = root_stress(CLEAR, *point_request(effects={"corner_contact": "off"}, **SKEWED_POINT), **how)
    assert edges(off.receipt)["holds"] is False
    assert off.receipt["repeated"] == []
    peaks = [found.wheel.peak("tension").stress.value for found in (off, repeated)]
    assert peaks[0] != peaks[1]
    with pytest.raises(SolveError, match="tip edges stay clear"):
        root_stress(CLEAR, *point_request(on_violation="fail", **SKEWED_POINT), **how)


def test_positions_that_pass_a_handover_by_miss_no_edge(cache):
    """Sixteen positions and five hundred assess the edges alike: the gap is least where pairs change."""
    pair = GearPair(GEAR, GEAR)
    asked = {"torques": [100.0], "level": "draft", "effects": {"corner_contact": "off"}, "cache": cache}
    bends = []
    for positions in (8, 13, 256):
        found = analyze(pair, positions=positions, **asked)
        curve = found.static_transmission_error[:, 0, 0, 0]
        bends.append(edges(found.metadata.receipt)["change"] * np.ptp(curve))
    assert bends[0] == pytest.approx(bends[2], rel=0.02)
    assert bends[1] == pytest.approx(bends[2], rel=0.02)


def test_handovers_are_just_outside_the_path_of_contact():
    pair = check_request(GearPair(GEAR, GEAR), TableAxes(torques=[1.0])).request.pair
    path = pair.path_of_contact
    rolls = [path.pitch_point + (x + j) * path.base_pitch for x in handovers(pair) for j in (-2, -1, 0, 1)]
    assert min(abs(path.start - roll - OUTSIDE * path.base_pitch) for roll in rolls) < 1e-12
    assert min(abs(roll - path.end - OUTSIDE * path.base_pitch) for roll in rolls) < 1e-12
