"""Full contact of one position by CalculiX, on a coarse mesh: equilibrium, and our own plane strain."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fe_contact import FlankModification, Gear, GearPair, analyze
from fe_contact.full_contact import FullContactMesh, find_calculix, solve_position
from fe_contact.mesh import MeshRecipe, mesh_gear

CALCULIX = find_calculix()
TORQUE = 400.0
GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
CROWNED = replace(GEAR, modification=FlankModification(profile_crowning=20e-6))

pytestmark = pytest.mark.skipif(CALCULIX is None, reason="CalculiX (ccx) is not installed")


@pytest.fixture(scope="module")
def coarse() -> FullContactMesh:
    """Three real teeth and an element to a Hertz half-width: 20 thousand unknowns, some CPU seconds."""
    recipe = replace(MeshRecipe.standard(GEAR), flank_size=0.2e-3, tip_size=0.1e-3, growth=0.5, real_teeth=3)
    mesh = mesh_gear(GEAR, recipe)
    return FullContactMesh((mesh, mesh), reach=1)


@pytest.mark.parametrize("gear", [GEAR, CROWNED])
def test_equilibrium_and_our_own_plane_strain(coarse: FullContactMesh, gear: Gear) -> None:
    assert CALCULIX is not None
    pair = GearPair(gear, gear, center_distance=80e-3)
    point = solve_position(CALCULIX, pair, coarse, float(pair.normal_force(TORQUE)), 0.0, 120.0)
    assert point.status.usable, point.reason
    assert abs(point.residual) < 1e-6  # moment of the contact forces is the torque that was asked for
    assert point.torque_ratio == pytest.approx(1.0, abs=1e-3)  # on the line of action, equal base radii
    assert point.position * pair.base_pitch == pytest.approx(point.transmission_error, rel=1e-9, abs=0.0)
    table = analyze(pair, torques=[TORQUE], model="plane_strain", level="draft", positions=16)
    own = float(table.curve(torque=TORQUE, at=[point.position]).ste[0])
    assert point.transmission_error == pytest.approx(own, rel=0.01, abs=0.0)


def test_a_position_past_its_limit_is_said(coarse: FullContactMesh) -> None:
    pair = GearPair(GEAR, GEAR, center_distance=80e-3)
    assert CALCULIX is not None
    point = solve_position(CALCULIX, pair, coarse, float(pair.normal_force(TORQUE)), 0.0, 1.0)
    assert not point.status.usable
    assert "within 1 CPU s" in point.reason
    assert set(point.to_json()) == {"status", "iterations", "reason"}
