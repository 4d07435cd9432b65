"""A tolerance is a part of the quantity and, below its floor, absolute; one object says so to all."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from fe_contact import AllowedError, FlankModification, Gear, GearPair, analyze
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.tables import _adaptive_nodes
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.planning.plan import FLOOR_SHARE, NodeRule

NM = 1e-9
VALUES = np.array([0.0, 30.0, -1999.0, 2001.0, 5000.0]) * NM


def quiet_pair() -> GearPair:
    """A crowned pair whose ripple is 1 % of its mean at the rated load."""
    lead = FlankModification(helix_crowning=4e-6)
    gear = Gear(20, 2e-3, 20e-3, 20e-3, helix_angle=0.45, modification=lead)
    mate = dataclasses.replace(gear, helix_angle=-0.45, modification=FlankModification())
    return GearPair(gear, mate, 40e-3 / np.cos(0.45))


def test_the_larger_of_the_part_and_the_floor_is_allowed():
    assert AllowedError().of(VALUES) / NM == pytest.approx([20.0, 20.0, 20.0, 20.01, 50.0])
    assert AllowedError(0.1, 50 * NM).of(VALUES) / NM == pytest.approx([50.0, 50.0, 199.9, 200.1, 500.0])
    assert AllowedError(0.01, 0.0).of(VALUES) / NM == pytest.approx([0.0, 0.3, 19.99, 20.01, 50.0])


def test_what_is_allowed_is_a_part_of_the_scale():
    for allowed in (AllowedError(), AllowedError(0.2, 3e-7), AllowedError(0.01, 0.0)):
        assert allowed.of(VALUES) == pytest.approx(allowed.relative * allowed.scale(VALUES), rel=1e-15)


def test_a_number_is_the_relative_part():
    def allowed(tolerance):
        return check_request(
            quiet_pair(), TableAxes(torques=[20.0]), AnalysisOptions(tolerance=AllowedError.given(tolerance))
        ).request.options.allowed

    assert allowed(0.02) == AllowedError(0.02, 20 * NM)
    assert allowed(AllowedError(0.02, 0.0)) == AllowedError(0.02, 0.0)
    assert allowed(None) == AllowedError(0.01, 0.0)  # a level promises no floor


def test_a_floor_makes_a_quiet_pair_cheaper_and_more_so_the_higher_it_is():
    """The choice of mesh and slices weighs errors by it; a loud table does not see it."""
    pair = quiet_pair()

    def effort(floor, torque):
        asked = check_request(
            pair, TableAxes(torques=[torque]), AnalysisOptions(tolerance=AllowedError(0.005, floor))
        )
        return decide(asked).mesh.option.effort

    quiet = [effort(floor * NM, 20.0) for floor in (0.0, 20.0, 200.0)]
    assert quiet[0] > quiet[1] >= quiet[2]
    assert effort(0.0, 20.0) == effort(1e-4 * NM, 20.0)


def test_positions_are_placed_by_the_floor():
    """Small kinked curves need as many positions as large ones, and none below the floor."""

    def kinked(height):
        return lambda x: (height * np.abs((x[:, None] + 0.3) % 1.0 - 0.5))[None]

    rule = NodeRule(32, 0.002, 768, least_ripple=1e-6)
    large, small = (_adaptive_nodes(rule, kinked(height)).position.size for height in (1e-4, 1e-8))
    assert _adaptive_nodes(NodeRule(32, 0.002, 768), kinked(1e-8)).position.size == large
    assert large > small == 32


def test_positions_know_the_floor_of_the_tolerance():
    asked = check_request(
        quiet_pair(), TableAxes(torques=[20.0]), AnalysisOptions(tolerance=AllowedError(0.01, 30 * NM))
    )
    assert decide(asked).plan.nodes.least_ripple == pytest.approx(FLOOR_SHARE * 3e-6)
    assert (
        decide(
            check_request(quiet_pair(), TableAxes(torques=[20.0]), AnalysisOptions(level="draft"))
        ).plan.nodes.least_ripple
        == 0.0
    )


def test_the_receipt_holds_the_measured_errors_against_it(tmp_path):
    """Met is what every stated error keeps, and not what was expected of the mesh."""
    spur = GearPair(*[Gear(20, 2e-3, 12e-3, 20e-3)] * 2, 40e-3)
    asked = {"torques": [5.0, 50.0], "model": "plane_strain", "positions": 16, "cache": tmp_path}

    def kept(allowed, **more):
        table = analyze(spur, tolerance=allowed, **asked, **more)
        receipt = table.metadata.receipt
        assert receipt["choice"]["met"] == receipt["tolerance"]["met"]
        return table, receipt["tolerance"]

    table, loose = kept(AllowedError(0.5, 0.0))
    used = [
        estimate.error / abs(estimate.value)
        for torque in asked["torques"]
        for estimate in (table.mean(torque=torque), table.peak_to_peak(torque=torque))
    ]
    assert loose["used"] == pytest.approx(max(used) / 0.5, rel=1e-3)
    assert (loose["relative"], loose["floor_m"], loose["met"]) == (0.5, 0.0, True)
    tight = AllowedError(1e-4, 0.0)
    assert kept(tight)[1]["met"] is False
    assert kept(AllowedError(1e-4, 1e-6))[1]["met"] is True
    assert kept(tight, receipt="minimal")[1] == {"relative": 1e-4, "floor_m": 0.0, "used": None, "met": None}
    level = analyze(spur, level="draft", **asked).metadata.receipt
    assert "tolerance" not in level
