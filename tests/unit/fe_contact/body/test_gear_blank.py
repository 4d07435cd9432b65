"""Rim, web and hub of a gear: what fits, what is the same gear, and closed forms of a web."""

import math
from dataclasses import replace

import pytest

from fe_contact.geometry import Gear, GearBlank, GearPair, blank_factor, iso6336_stiffness, web_compliance
from fe_contact.geometry.web_compliance import shift_compliance, torsion_compliance
from fe_contact.material import STEEL

GEAR = Gear(teeth=40, normal_module=4e-3, face_width=40e-3, bore_diameter=40e-3)
BLANK = GearBlank(rim_thickness=12e-3, web_thickness=10e-3, hub_diameter=60e-3, web_offset=3e-3)


def test_the_web_lies_where_the_drawing_says():
    web = replace(GEAR, blank=BLANK).web
    assert web.outer_radius == pytest.approx(GEAR.root_radius - 12e-3, rel=1e-15)
    assert (web.inner_radius, web.low, web.high) == pytest.approx((30e-3, -2e-3, 8e-3), rel=1e-12)
    assert replace(GEAR, blank=replace(BLANK, hub_diameter=None)).web.inner_radius == 20e-3
    assert replace(GEAR, blank=BLANK).rim_thickness == pytest.approx(12e-3, rel=1e-12)
    assert GEAR.rim_thickness == GEAR.root_radius - 20e-3


def test_a_web_as_thick_as_the_face_is_a_solid_gear():
    full = replace(GEAR, blank=GearBlank(rim_thickness=12e-3, web_thickness=40e-3, hub_diameter=60e-3))
    assert full.web is None
    assert full.macro_geometry() == GEAR.macro_geometry()
    assert full.with_parts(("seat",)) == GEAR
    assert replace(GEAR, blank=BLANK).macro_geometry() != GEAR.macro_geometry()


def test_the_mirror_image_has_its_web_on_the_other_side():
    left = replace(GEAR, helix_angle=-0.3, blank=BLANK)
    right = left.right_handed()
    assert right.helix_angle == 0.3
    assert (right.web.low, right.web.high) == (-left.web.high, -left.web.low)
    assert right.right_handed() is right


def test_blank_factor_of_the_standard():
    """C_R = 1 + ln(b_s/b) / (5 exp(s_R / (5 m_n))) inside 0.2 <= b_s/b <= 1, s_R/m_n >= 1."""
    assert blank_factor(GEAR) == 1.0
    assert blank_factor(replace(GEAR, blank=BLANK)) == pytest.approx(
        1.0 + math.log(0.25) / (5.0 * math.exp(0.6))
    )
    thin, thinner = (replace(GEAR, blank=replace(BLANK, web_thickness=b)) for b in (8e-3, 4e-3))
    assert blank_factor(thin) == pytest.approx(blank_factor(thinner), rel=1e-12)
    slim, slimmer = (replace(GEAR, blank=replace(BLANK, rim_thickness=s)) for s in (4e-3, 2.5e-3))
    assert blank_factor(slim) == blank_factor(slimmer) < blank_factor(replace(GEAR, blank=BLANK))
    solid, webbed = (GearPair(GEAR, replace(GEAR, blank=b)) for b in (None, BLANK))
    ratio = iso6336_stiffness(webbed).mesh_stiffness / iso6336_stiffness(solid).mesh_stiffness
    assert ratio == pytest.approx(0.5 + 0.5 * blank_factor(webbed.wheel), rel=1e-12)


def test_discs_in_series_add_up_in_torsion_and_a_thin_one_shifts_by_shear_and_stretch():
    parts = torsion_compliance(20e-3, 30e-3, STEEL) + torsion_compliance(30e-3, 50e-3, STEEL)
    assert parts == pytest.approx(torsion_compliance(20e-3, 50e-3, STEEL), rel=1e-14)
    # A narrow annulus: shear G and, held along the edges, stretch E / (1 - nu^2), each over half of it.
    gap, radius, nu = 1e-6, 50e-3, STEEL.poissons_ratio
    G = 0.5 * STEEL.youngs_modulus / (1.0 + nu)
    M = STEEL.youngs_modulus / (1.0 - nu**2)
    thin = gap / (math.pi * radius * (G + M))
    assert shift_compliance(radius, radius + gap, STEEL) == pytest.approx(thin, rel=1e-4)


def test_a_solid_body_has_no_web_to_give_way():
    assert web_compliance(GEAR) == 0.0
    thin, thick = (
        web_compliance(replace(GEAR, blank=replace(BLANK, web_thickness=b))) for b in (5e-3, 10e-3)
    )
    assert thin / thick == pytest.approx((1 / 5 - 1 / 40) / (1 / 10 - 1 / 40), rel=1e-12)
