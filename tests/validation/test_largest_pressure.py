"""Largest pressure of plane flank results against full contact that resolves the strip."""

from dataclasses import replace

import pytest

from fe_contact import AnalysisOptions, FlankModification, Gear, GearPair, OperatingPoint, flank_results
from verification.full_contact import Resolution, solve_full_contact

MESH = Resolution(6.0)
ELEMENT_MEAN = 0.0017
"""Part by which the mean over the element at its top is below the peak of an ellipse, six a side."""


def pair(**modification: float) -> GearPair:
    gear = Gear(20, 3e-3, 12e-3, 30e-3, modification=FlankModification(**modification))
    return GearPair(gear, replace(gear), 60e-3)


PAIRS = {
    "plain": pair(),
    "relieved": pair(tip_relief=15e-6, tip_relief_length=1.5e-3),
    "crowned": pair(profile_crowning=6e-6),
}


@pytest.mark.law
@pytest.mark.parametrize("name", PAIRS)
def test_the_stated_error_covers_full_contact(name):
    """Where one pair of teeth carries clear of the edges."""
    meshing, position = PAIRS[name], 0.05
    torque = 150e3 * meshing.face_width * meshing.pinion.base_radius
    (points,) = solve_full_contact(meshing, [torque], [position], MESH).points
    options = AnalysisOptions(model="plane_strain", level="standard")
    found = flank_results(meshing, OperatingPoint(torque=torque), options, at=[position])
    pressure, truth = found.largest_pressure, points[0].max_pressure / (1.0 - ELEMENT_MEAN)
    assert abs(pressure.value - truth) <= pressure.error
    assert 0.0 < pressure.error < 0.015 * pressure.value
