"""Flank results and root stress check what they took for granted; tip edges are assessed at handovers too."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from analysis_requests import point_request

from fe_contact import FlankModification, Gear, GearPair, analyze
from fe_contact.analysis.checks.assumptions import OUTSIDE, _handovers
from fe_contact.analysis.flanks.flank_file import flank_results
from fe_contact.analysis.flanks.root_stress import root_stress
from fe_contact.analysis.request.request_check import check_request
from fe_contact.errors import SolveError
from fe_contact.options import Run, TableAxes
from fe_contact.types import Json

pytestmark = pytest.mark.usefixtures("coarse_sectors")

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
# tips relieved by more than twice the even deflection, but not by that of a misaligned face
RELIEVED = replace(GEAR, modification=FlankModification(tip_relief=12e-6, tip_relief_length=0.3e-3))
CLEAR = GearPair(RELIEVED, RELIEVED)
SKEWED = {"normal_force": 1500.0, "misalignment": 150e-6, "level": "draft"}
AT = [0.1, *_handovers(CLEAR)]


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("compliance")


def edges(receipt: Json) -> Json:
    """The entry of the tip edges."""
    (entry,) = [one for one in receipt["assumptions"] if one["effect"] == "corner_contact"]
    return dict(entry)


def test_flank_results_are_repeated_refused_or_reported(cache: Path) -> None:
    how: dict[str, Any] = {"run": Run(cache=cache), "at": AT}
    repeated = flank_results(CLEAR, *point_request(**SKEWED), **how)
    explicit = flank_results(CLEAR, *point_request(effects={"corner_contact": "on"}, **SKEWED), **how)
    for name in ("pressure", "line_load", "position"):
        np.testing.assert_array_equal(getattr(repeated, name), getattr(explicit, name))
    receipt = repeated.metadata.receipt
    (again,) = receipt["repeated"]
    assert set(again["turned_on"]) == {"corner_contact"}
    entry = next(one for one in repeated.metadata.effect_ledger if one["name"] == "corner_contact")
    assert entry["on"] and entry["decision"].startswith("on after a run without it")
    assert explicit.metadata.receipt["repeated"] == []
    reported = flank_results(CLEAR, *point_request(on_violation="report", **SKEWED), **how)
    assert edges(reported.metadata.receipt)["holds"] is False
    assert reported.pressure.max() != repeated.pressure.max()
    with pytest.raises(SolveError, match="tip edges stay clear"):
        flank_results(CLEAR, *point_request(on_violation="fail", **SKEWED), **how)


def test_root_stress_is_repeated_too(cache: Path) -> None:
    how: dict[str, Any] = {"run": Run(cache=cache), "at": AT}
    repeated = root_stress(CLEAR, *point_request(**SKEWED), **how)
    explicit = root_stress(CLEAR, *point_request(effects={"corner_contact": "on"}, **SKEWED), **how)
    np.testing.assert_array_equal(repeated.wheel.stress, explicit.wheel.stress)
    (again,) = repeated.receipt["repeated"]
    assert set(again["turned_on"]) == {"corner_contact"}
    off = root_stress(CLEAR, *point_request(effects={"corner_contact": "off"}, **SKEWED), **how)
    assert edges(off.receipt)["holds"] is False
    assert off.receipt["repeated"] == []
    peaks = [found.wheel.peak("tension").stress.value for found in (off, repeated)]
    assert peaks[0] != peaks[1]
    with pytest.raises(SolveError, match="tip edges stay clear"):
        root_stress(CLEAR, *point_request(on_violation="fail", **SKEWED), **how)


def test_positions_that_pass_a_handover_by_miss_no_edge(cache: Path) -> None:
    """Sixteen positions and five hundred assess the edges alike: the gap is least where pairs change."""
    pair = GearPair(GEAR, GEAR)
    asked = {"torques": [100.0], "level": "draft", "effects": {"corner_contact": "off"}, "cache": cache}
    bends = []
    for positions in (8, 13, 256):
        found = analyze(pair, positions=positions, **asked)  # type: ignore[arg-type]
        curve = found.static_transmission_error[:, 0, 0, 0]
        bends.append(edges(found.metadata.receipt)["change"] * np.ptp(curve))
    assert bends[0] == pytest.approx(bends[2], rel=0.02)
    assert bends[1] == pytest.approx(bends[2], rel=0.02)


def test_handovers_are_just_outside_the_path_of_contact() -> None:
    pair = check_request(GearPair(GEAR, GEAR), TableAxes(torques=[1.0])).request.pair
    path = pair.path_of_contact
    rolls = [path.pitch_point + (x + j) * path.base_pitch for x in _handovers(pair) for j in (-2, -1, 0, 1)]
    assert min(abs(path.start - roll - OUTSIDE * path.base_pitch) for roll in rolls) < 1e-12
    assert min(abs(roll - path.end - OUTSIDE * path.base_pitch) for roll in rolls) < 1e-12
