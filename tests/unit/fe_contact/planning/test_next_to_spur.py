"""A helix of next to no overlap has the errors and the meshes of a spur pair."""

import math
from pathlib import Path

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, SteDatabase, analyze
from fe_contact.ste.curve_errors import AT_NODES

# both pairs have the sectors of one level, whichever it is
pytestmark = pytest.mark.usefixtures("coarse_sectors")
HELIX_DEG = 0.02
RELIEVED = FlankModification(tip_relief=8e-6, tip_relief_length=0.8e-3)


def pair_of(helix_deg: float, modification: FlankModification) -> GearPair:
    helix = math.radians(helix_deg)
    gears = [
        Gear(z, 2e-3, 10e-3, 1e-3 * z, helix_angle=hand * helix, modification=modification)
        for z, hand in ((19, 1), (26, -1))
    ]
    return GearPair(*gears, 45e-3 / math.cos(helix))


def table(helix_deg: float, modification: FlankModification, cache: Path) -> SteDatabase:
    how = {"level": "draft", "model": "3d", "positions": 32, "cache": cache}
    return analyze(pair_of(helix_deg, modification), torques=[20.0, 60.0], **how)


@pytest.mark.law
@pytest.mark.filterwarnings("ignore:implausible")
@pytest.mark.parametrize("modification", [FlankModification(), RELIEVED], ids=["plain", "relieved"])
def test_stated_errors_differ_by_a_tenth_at_most(modification, tmp_path):
    spur, helical = (table(helix, modification, tmp_path) for helix in (0.0, HELIX_DEG))
    for load in range(spur.force.size):
        for name in ("mean", "peak_to_peak"):
            one, other = (getattr(made, name)(force=made.force[load]) for made in (spur, helical))
            assert 1.0 / 1.1 < other.error / one.error < 1.1, name
            assert other.value == pytest.approx(one.value, rel=2e-3)
    band = helical.error_estimate.mean(axis=0) / spur.error_estimate.mean(axis=0)
    assert np.all((band > 1.0 / 1.1) & (band < 1.1))
    for source in AT_NODES:
        row = AT_NODES.index(source)
        one, other = (made.curve_error[row, :2].max() for made in (spur, helical))
        whole = spur.curve_error[: len(AT_NODES), :2].max()
        assert abs(other - one) < 0.1 * whole, source
