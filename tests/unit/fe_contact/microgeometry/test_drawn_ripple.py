"""Pairs within a class on bodies in memory: no tolerance, no band; the band of a tolerance Monte Carlo."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fe_contact import Gear, GearPair, analyze
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.errors import InputError
from fe_contact.geometry import FlankModification, PitchDeviation
from fe_contact.microgeometry.drawn_ripple import SOLVED, DrawnRipple, RippleBand
from fe_contact.microgeometry.tolerance_study import Sampling, scatter
from fe_contact.microgeometry.tolerances import Tolerances, iso1328_tolerances
from fe_contact.options import AnalysisOptions, Run

pytestmark = pytest.mark.usefixtures("coarse_sectors")

FLANK = FlankModification(tip_relief=3e-6, tip_relief_length=0.4e-3)
GEAR = Gear(teeth=20, normal_module=1e-3, face_width=4e-3, bore_diameter=10e-3, modification=FLANK)
PAIR = GearPair(GEAR, GEAR, center_distance=20e-3)
TORQUE = 1.0
CORNERS = {"corner_contact": "on"}


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def bodies_of(pair: GearPair, cache: Path) -> CondensedPair:
    choice = {"level": "draft", "model": "plane_strain", "receipt": "minimal", "positions": 64}
    table = analyze(pair, torques=[TORQUE], cache=cache, effects=CORNERS, **choice)
    found = condensed_pair(pair, table, CORNERS, cache)
    assert found is not None
    return found


def band_of(bodies: CondensedPair, tolerances: Tolerances) -> RippleBand:
    drawn = DrawnRipple.of(bodies, PAIR, TORQUE, tolerances)
    while drawn.solved < SOLVED:
        drawn = drawn.further()
    return drawn.band()


@pytest.mark.law
def test_without_a_tolerance_the_band_has_no_width_and_is_the_curve(cache):
    bodies = bodies_of(PAIR, cache)
    band = band_of(
        bodies, Tolerances(modification={"pinion.profile_slope": 1e-15, "wheel.tip_relief": 1e-15})
    )
    _, solved = bodies.solve_table(PAIR, np.array([TORQUE]), preview=True)
    curve = solved.solution.deflection[:, 0]
    assert band.low == pytest.approx(band.high, abs=1e-13)
    assert band.low == pytest.approx(curve - curve.mean(), abs=1e-11)
    for spread in (band.peak_to_peak, band.first_harmonic):
        assert spread.low == pytest.approx(spread.high, abs=1e-13)
        assert spread.error < 1e-13
    assert band.peak_to_peak.low == pytest.approx(np.ptp(curve), abs=1e-11)


@pytest.mark.law
@pytest.mark.parametrize("tolerance_class", [5, 7])
def test_the_band_is_that_of_a_tolerance_study_within_its_error(cache, tolerance_class):
    tolerances = iso1328_tolerances(PAIR, tolerance_class, across_face=False)
    spread = band_of(bodies_of(PAIR, cache), tolerances).peak_to_peak
    options = AnalysisOptions(level="draft", model="plane_strain", effects=CORNERS)
    sampling = Sampling(samples=300, exact=300, positions=96, seed=1)
    study = scatter(PAIR, [TORQUE], tolerances, sampling, options, Run(cache=cache))
    low, _, high = (float(quantile.value[0]) for quantile in study.quantiles)
    assert spread.error < 0.2 * (spread.high - spread.low)
    bounds = max(float(0.5 * (each.high - each.low)[0]) for each in study.quantiles)
    for end, whole in ((spread.low, low), (spread.high, high)):
        assert abs(end - whole) < np.hypot(spread.error, bounds)


def test_teeth_that_differ_and_effects_that_are_off_are_refused(cache):
    tolerances = iso1328_tolerances(PAIR, 6, across_face=True)
    with pytest.raises(InputError, match="effects of the flanks are off"):
        DrawnRipple.of(bodies_of(PAIR, cache), PAIR, TORQUE, tolerances)
    early = replace(GEAR, pitch_deviation=PitchDeviation(cumulative=(*[0.0] * 19, 3e-6)))
    other = replace(PAIR, pinion=early)
    with pytest.raises(InputError, match="teeth differ"):
        DrawnRipple.of(bodies_of(other, cache), other, TORQUE, tolerances)
