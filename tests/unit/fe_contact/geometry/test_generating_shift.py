"""Addendum modification for generating x_E: where the cutter stands that removes a thickness allowance."""

import json
import math
import random
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from compliance_gears import coarse_plane
from spur_gears import make_gear, make_ring

from fe_contact.compliance import PlaneHypothesis
from fe_contact.compliance.flank_compliance_2d import compliance_key
from fe_contact.errors import InputError
from fe_contact.geometry import GearPair, tooth_profile
from fe_contact.geometry.toothing import Toothing
from fe_contact.types import FloatArray

KINDS = {"gear": make_gear, "ring gear": make_ring}
kinds = pytest.mark.parametrize("kind", KINDS)
both_cases = pytest.mark.parametrize("thinning", ["generating", "flank"])


def drawn(kind: str, seed: int, **changes: Any) -> Toothing:
    draw = random.Random(seed)
    fields: dict[str, Any] = {
        "teeth": draw.randint(60, 120),
        "profile_shift_coefficient": draw.uniform(-0.2, 0.3),
        "helix_angle": draw.choice([0.0, draw.uniform(0.05, 0.5)]),
        "normal_pressure_angle": math.radians(draw.uniform(18.0, 24.0)),
        "thickness_allowance": draw.uniform(1e-5, 2e-4),
    }
    if kind == "ring gear":
        fields |= {"addendum_coefficient": 0.8, "rim_diameter": 0.8}
    return KINDS[kind](**(fields | changes))


def outline(gear: Toothing) -> FloatArray:
    """Return points (n, 2) of the right flank, from the space's center to the tip, m."""
    profile = tooth_profile(gear)
    return profile.flank(np.linspace(profile.s_space, profile.s_tip, 201))


@kinds
@both_cases
@pytest.mark.parametrize("seed", range(4))
def test_thickness_at_the_reference_circle_is_the_nominal_less_the_allowance(kind, thinning, seed):
    """s_n = m_n (pi / 2 + 2 x tan alpha_n) - A, whatever removes A; read off the outline."""
    gear = drawn(kind, seed, tooth_thinning=thinning)
    x, y = tooth_profile(gear).involute(np.array([gear.roll_length(gear.reference_radius)]))[0]
    normal = 2.0 * gear.reference_radius * math.atan2(x, y) * math.cos(gear.helix_angle)
    shift = 2.0 * gear.profile_shift_coefficient * math.tan(gear.normal_pressure_angle)
    nominal = gear.normal_module * (0.5 * math.pi + shift)
    assert nominal - normal == pytest.approx(gear.thickness_allowance, rel=1e-8)


@kinds
@pytest.mark.parametrize("seed", range(4))
def test_a_gear_is_the_one_of_its_generating_shift_with_its_tip_circle(kind, seed):
    """The cutter does not know the nominal shift: outline, shape and compliance are one."""
    gear = drawn(kind, seed)
    infeed = 0.5 * gear.thickness_allowance / math.tan(gear.normal_pressure_angle)
    shift = gear.profile_shift_coefficient - infeed / gear.normal_module
    assert gear.generating_shift_coefficient == pytest.approx(shift, rel=1e-13)
    nominal = replace(
        gear,
        profile_shift_coefficient=gear.generating_shift_coefficient,
        thickness_allowance=0.0,
        tip_diameter=2.0 * gear.tip_radius,
    )
    assert np.array_equal(outline(gear), outline(nominal))
    assert gear.form_radius == nominal.form_radius
    assert json.dumps(gear.macro_geometry()) == json.dumps(nominal.macro_geometry())


@kinds
@pytest.mark.parametrize("seed", range(4))
def test_the_root_moves_by_the_infeed_and_the_tip_stays(kind, seed):
    gear = drawn(kind, seed)
    ground, plain = replace(gear, tooth_thinning="flank"), replace(gear, thickness_allowance=0.0)
    infeed = 0.5 * gear.thickness_allowance / math.tan(gear.normal_pressure_angle)
    assert gear.sign * (plain.root_radius - gear.root_radius) == pytest.approx(infeed, rel=1e-8)
    assert gear.sign * (plain.form_radius - gear.form_radius) > 0.0
    assert ground.root_radius == plain.root_radius
    assert gear.tip_radius == ground.tip_radius == plain.tip_radius
    assert gear.tip_tooth_thickness == pytest.approx(ground.tip_tooth_thickness, rel=1e-12)
    assert gear.base_tooth_thickness == pytest.approx(ground.base_tooth_thickness, rel=1e-12)


@kinds
@pytest.mark.parametrize("seed", range(4))
def test_without_an_allowance_nothing_tells_the_two_cases_apart(kind, seed):
    gear = drawn(kind, seed, thickness_allowance=0.0)
    ground = replace(gear, tooth_thinning="flank")
    assert np.array_equal(outline(gear), outline(ground))
    assert gear.macro_geometry() == ground.macro_geometry()
    assert gear.macro_geometry()["profile_shift_coefficient"] == gear.profile_shift_coefficient


def test_two_shapes_have_two_compliances_and_one_shape_has_one():
    def key(gear):
        return compliance_key(gear, coarse_plane(gear), PlaneHypothesis.PLANE_STRAIN, 5)

    gear = make_gear(thickness_allowance=1e-4)
    assert key(gear) != key(replace(gear, tooth_thinning="flank"))
    assert key(gear) != key(replace(gear, thickness_allowance=0.0))


@both_cases
def test_backlash_is_the_allowances_whatever_removes_them(thinning):
    pinion = make_gear(23, thickness_allowance=6e-5, tooth_thinning=thinning)
    wheel = make_gear(47, thickness_allowance=4e-5)
    pair = GearPair(pinion, wheel)
    assert pair.circumferential_backlash == pytest.approx(1e-4, rel=1e-9)
    infeed = 0.0 if thinning == "flank" else 3e-5 / math.tan(math.radians(20.0))
    clearance = 0.25 * 4e-3 + infeed  # of the wheel's tip from the pinion's root
    assert pair.tip_clearances[1] == pytest.approx(clearance, rel=1e-9)


def test_an_allowance_deepens_undercut():
    """The onset of undercut is that of x_E: 14 teeth of a sharp rack of full depth at x = 0.1812."""
    sharp = {"root_radius_coefficient": 0.0, "dedendum_coefficient": 1.0, "teeth": 14}
    onset = 1.0 - 7.0 * math.sin(math.radians(20.0)) ** 2
    beyond = {**sharp, "profile_shift_coefficient": onset + 1e-3, "thickness_allowance": 4e-5}
    assert make_gear(**beyond).form_point.undercut
    assert not make_gear(**beyond, tooth_thinning="flank").form_point.undercut


@kinds
def test_another_way_of_thinning_is_refused(kind):
    with pytest.raises(InputError, match=r"tooth_thinning.*hobbing.*generating"):
        KINDS[kind](tooth_thinning="hobbing")
