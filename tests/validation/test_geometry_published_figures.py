"""Geometry and forces of published gear pairs, to the digits given there."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from spur_gears import PAIR

from fe_contact.geometry import Gear, GearPair, iso6336_stiffness
from fe_contact.material import Material

ISMA = "Palermo et al., ISMA 2010, Table 1"
TR_30 = "ISO/TR 6336-30, example 1"
RIKOR = "RIKOR test 001"


def spur_20_20() -> GearPair:
    return PAIR


def helical_17_103() -> GearPair:
    beta = math.radians(15.8)
    fields: dict[str, Any] = {
        "normal_module": 8e-3,
        "face_width": 0.1,
        "bore_diameter": 0.05,
        "dedendum_coefficient": 1.4,
        "root_radius_coefficient": 0.39,
    }
    pinion = Gear(teeth=17, helix_angle=beta, profile_shift_coefficient=0.145, **fields)
    return GearPair(pinion, Gear(teeth=103, helix_angle=-beta, **fields), 0.5)


def helical_14_59() -> GearPair:
    beta = math.radians(11.0)
    fields = {"normal_module": 8e-3, "face_width": 0.1, "bore_diameter": 0.03}
    pinion = Gear(teeth=14, helix_angle=beta, profile_shift_coefficient=0.4713, **fields)
    return GearPair(pinion, Gear(teeth=59, helix_angle=-beta, **fields))


def of_standard_steel(pair: GearPair) -> GearPair:
    """The pair in the steel of the standard's series and its examples, 206 GPa."""
    steel = Material(206e9)
    return replace(
        pair, pinion=replace(pair.pinion, material=steel), wheel=replace(pair.wheel, material=steel)
    )


def test_spur_pair_of_the_paper(record_figure: Any) -> None:
    pair = spur_20_20()
    figures = (
        ("contact ratio 20/20", pair.transverse_contact_ratio, 1.5568, "1", 5e-5),
        ("base radius 20/20", pair.pinion.base_radius * 1e3, 37.588, "mm", 5e-4),
        ("base pitch 20/20", pair.base_pitch * 1e3, 11.809, "mm", 5e-4),
        ("normal force 20/20 at 100 N m", float(pair.normal_force(100.0)), 2660.0, "N", 0.5),
    )
    for name, value, target, unit, half_digit in figures:
        record_figure(name, value, target, unit, ISMA)
        assert value == pytest.approx(target, abs=half_digit), name
    assert pair.normal_backlash == pytest.approx(0.0, abs=1e-15)


def test_iso_tr_6336_30_example_1(record_figure: Any) -> None:
    stiffness = iso6336_stiffness(of_standard_steel(helical_17_103()))
    figures = (
        ("c'th 17/103", stiffness.theoretical_single_stiffness, 17.85584, 5e-6),
        ("c' 17/103", stiffness.single_stiffness, 12.37047, 5e-6),
        # the example rounds its contact ratio: its own figure is good to 6e-4
        ("c gamma alpha 17/103", stiffness.mesh_stiffness, 17.465, 6e-4 * 17.465),
    )
    for name, value, target, tolerance in figures:
        record_figure(name, value * 1e-9, target, "N/(mm um)", TR_30)
        assert value * 1e-9 == pytest.approx(target, abs=tolerance), name
    pair = helical_17_103()
    record_figure("transverse contact ratio 17/103", pair.transverse_contact_ratio, 1.549, "1", TR_30)
    record_figure("overlap ratio 17/103", pair.overlap_ratio, 1.083, "1", TR_30)
    assert pair.transverse_contact_ratio == pytest.approx(1.549, abs=5e-4)
    assert pair.overlap_ratio == pytest.approx(1.083, abs=5e-4)
    # the center distance is the one without backlash, rounded to 10 um
    assert 0.0 <= pair.normal_backlash < 1e-5


def test_iso_6336_stiffness_of_the_spur_pair(record_figure: Any) -> None:
    stiffness = iso6336_stiffness(of_standard_steel(spur_20_20()))
    record_figure("c' 20/20", stiffness.single_stiffness * 1e-9, 11.487, "N/(mm um)", "ISO 6336-1 method B")
    name = "c gamma alpha 20/20"
    record_figure(name, stiffness.mesh_stiffness * 1e-9, 16.28, "N/(mm um)", "ISO 6336-1 method B")
    assert stiffness.single_stiffness == pytest.approx(11.487e9, abs=5e5)
    assert stiffness.mesh_stiffness == pytest.approx(16.28e9, abs=5e6)


def test_rikor_test_001_forces(record_figure: Any) -> None:
    pair = helical_14_59()
    normal = pair.normal_force(8962.5)
    figures = (
        ("F_bt 14/59", float(pair.transverse_force(normal)), 167555.8, 0.05),
        ("F_bn 14/59", float(normal), 170316.0, 0.5),
        ("F_bx 14/59", float(pair.axial_force(normal)), 30538.0, 0.5),
    )
    for name, value, target, half_digit in figures:
        record_figure(name, value, target, "N", RIKOR)
        assert value == pytest.approx(target, abs=half_digit), name
