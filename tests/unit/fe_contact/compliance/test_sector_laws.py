"""A sector that is cut out of a gear, its cut planes and bore fixed, in the plane."""

from dataclasses import replace

import numpy as np
import pytest
from compliance_gears import coarse_plane

from fe_contact import AnalysisOptions, Gear, GearBlank, GearPair, TableAxes, analyze
from fe_contact.compliance import PlaneHypothesis, flank_compliance, flank_compliance_3d
from fe_contact.compliance.deformed_section import deformed_sections
from fe_contact.compliance.ring_checks import uniform_pressure
from fe_contact.errors import InfeasibleGeometry, InputError

WHOLE = Gear(teeth=21, normal_module=4e-3, face_width=24e-3, bore_diameter=50e-3)


def mean_motion(gear: Gear) -> float:
    """Return the mean displacement of the flank of tooth 0 under an even unit load on it, 1/Pa."""
    made = flank_compliance(gear, coarse_plane(gear), PlaneHypothesis.PLANE_STRAIN, teeth=3)
    forces = uniform_pressure(made.s, made.s_form, 1.0).forces
    return float(forces @ made.block(0, 0) @ forces / forces.sum() ** 2)


@pytest.mark.law
def test_a_wider_sector_is_softer_and_the_whole_gear_is_its_limit():
    motions = [mean_motion(replace(WHOLE, sector_teeth=teeth)) for teeth in (5, 7, 11, 19)]
    whole = mean_motion(WHOLE)
    assert all(first < second for first, second in zip(motions, [*motions[1:], whole], strict=True))
    assert motions[0] < 0.995 * whole
    assert motions[-1] == pytest.approx(whole, rel=1e-4)


@pytest.mark.law
def test_cut_planes_and_bore_do_not_move():
    gear = replace(WHOLE, sector_teeth=7)
    recipe = coarse_plane(gear)
    count = len(flank_compliance(gear, recipe, teeth=3).s)
    (field,) = deformed_sections(gear, recipe, PlaneHypothesis.PLANE_STRAIN, [{0: np.ones(count)}])
    x, y, _ = field.points.T
    motion = np.linalg.norm(field.displacement, axis=1)
    cut = np.abs(np.abs(np.arctan2(x, y)) - 7.0 * np.pi / 21.0) < 1e-9
    bore = np.abs(np.hypot(x, y) - 25e-3) < 1e-9
    assert cut.sum() > 10
    assert (motion[cut | bore] == 0.0).all()
    assert (motion[~(cut | bore)] > 0.0).all()
    assert field.residual < 1e-9


@pytest.mark.filterwarnings("ignore::bounds.PlausibilityWarning")
def test_a_pair_with_a_sector_deflects_less_and_is_another_result():
    def mean(gear):
        pair = GearPair(WHOLE, gear)
        options = AnalysisOptions(level="draft", model="plane_strain", positions=8, receipt="minimal")
        return float(analyze(pair, TableAxes(torques=[100.0]), options).static_transmission_error.mean())

    assert 0.9 * mean(WHOLE) < mean(replace(WHOLE, sector_teeth=7)) < 0.999 * mean(WHOLE)
    assert replace(WHOLE, sector_teeth=7).macro_geometry() != WHOLE.macro_geometry()


@pytest.mark.parametrize("teeth", [6, 21, 23])
def test_a_sector_is_centered_on_a_tooth_and_smaller_than_the_gear(teeth):
    with pytest.raises(InfeasibleGeometry, match="sector_teeth"):
        replace(WHOLE, sector_teeth=teeth)


def test_a_sector_has_neither_web_nor_third_dimension():
    with pytest.raises(InfeasibleGeometry, match="sector_teeth"):
        replace(WHOLE, sector_teeth=7, blank=GearBlank(rim_thickness=6e-3, web_thickness=8e-3))
    sector = replace(WHOLE, sector_teeth=7)
    with pytest.raises(InputError, match="sector_teeth"):
        flank_compliance_3d(sector)
    with pytest.raises(InputError, match=r"wheel\.sector_teeth"):
        analyze(GearPair(WHOLE, sector), TableAxes(torques=[100.0]), AnalysisOptions(model="3d"))


def test_a_sector_too_narrow_for_the_contact_is_refused_by_its_field():
    with pytest.raises(InputError, match="sector_teeth = 5: must be 7 or more"):
        flank_compliance(replace(WHOLE, sector_teeth=5), teeth=5)
