"""Transmission error of flanks as rough as the contact is wide, against full contact of the same flanks."""

from dataclasses import replace

import numpy as np
import pytest

from fe_contact import (
    AnalysisOptions,
    FlankGrid,
    FlankModification,
    Gear,
    GearPair,
    OperatingPoint,
    analyze,
    flank_results,
)

MODULE, FACE = 3e-3, 18e-3
POSITION = [0.7883, 0.795, 0.8017, 0.8083, 0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]
FULL_CONTACT = {
    50.0: [5475.2, 5750.4, 6145.0, 6483.8, 7619.4, 7653.8, 5311.8, 5285.6, 5125.5, 5148.1, 5122.1, 5312.0,
           6042.1, 7630.0],
    200.0: [19601.7, 19843.3, 20143.7, 20544.7, 27346.5, 27479.5, 19086.4, 18777.9, 18548.2, 18518.9, 18662.3,
            18832.4, 20060.8, 27394.6],
}  # fmt: skip
"""nm, good to 9 nm, `verification.full_contact` on its standard mesh."""


def rough_pair() -> GearPair:
    """Return 20/27, on the wheel waves of 0.1 to 0.3 mm, 1.5 um in all: strips are 0.1 to 0.4 mm wide."""
    pinion, wheel = (Gear(teeth, MODULE, FACE, 0.5 * teeth * MODULE) for teeth in (20, 27))
    draw = np.random.default_rng(2)
    roll = np.linspace(wheel.form_roll_length * 1.02, wheel.tip_roll_length, 161)
    at = roll**2 / (2 * wheel.base_radius)
    sizes, phases, lengths = draw.normal(size=12), draw.uniform(0, 2 * np.pi, 12), np.linspace(0.7, 2.0, 12)
    waves = np.cos(2 * np.pi * at / (0.15e-3 * lengths[:, None]) + phases[:, None])
    removed = sizes @ waves
    removed *= 1.5e-6 / np.ptp(removed)
    rows = tuple((x, x) for x in (removed - removed.min()).tolist())
    grid = FlankGrid(tuple(roll.tolist()), (-0.02, 0.02), rows)
    wheel = replace(wheel, modification=FlankModification(flank_grid=grid))
    return GearPair(pinion, wheel, 0.5 * 47 * MODULE)


@pytest.mark.law
def test_rough_flanks_give_way_as_full_contact_does(tmp_path):
    """One parabola for each crest was 5 % off under 200 N m, and its jumps broke the law of neighbors."""
    table = analyze(
        rough_pair(), torques=list(FULL_CONTACT), model="plane_strain", level="draft", cache=tmp_path
    )
    for torque, exact in FULL_CONTACT.items():
        curve = table.curve(torque=torque, at=POSITION)
        error = np.abs(curve.ste - 1e-9 * np.array(exact))
        assert error.max() < 0.03 * np.mean(curve.ste)
        assert error.mean() < 0.008 * np.mean(curve.ste)
        assert np.mean(error <= curve.error) >= 0.9


def test_flank_results_of_crests_far_apart_break_no_law():
    """Two crests share a light load: their strip is wider than that of the flattest plain flanks."""
    options, position = AnalysisOptions(model="plane_strain", level="draft"), np.arange(128) / 1024
    flanks = flank_results(rough_pair(), OperatingPoint(torque=5.0), options, at=position.tolist())
    assert {law["law"] for law in flanks.metadata.receipt["laws"]} >= {"pressure carries the line load"}
