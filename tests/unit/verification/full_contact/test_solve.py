"""Full contact of gears by condensation: laws that every solution keeps, and refusals."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from spur_gears import GEAR, PAIR

from fe_contact import FlankModification, Gear, GearBlank, GearPair, InternalGearPair, Material, RingGear
from fe_contact.errors import InputError, MeshError
from verification.full_contact import FullContactTable, Resolution, refusal, solve_full_contact
from verification.full_contact.condensation import placed_mesh
from verification.full_contact.condensation import solve as solved_position

WHEEL = Gear(teeth=31, normal_module=4e-3, face_width=25e-3, bore_diameter=60e-3)
WIDE_RING = RingGear(70, 4e-3, 25e-3, rim_diameter=328e-3, addendum_coefficient=0.85)
TORQUES = (10.0, 100.0, 400.0)
COARSE = Resolution(4.0)


@cache
def table(*positions: float) -> FullContactTable:
    return solve_full_contact(PAIR, TORQUES, positions, COARSE)


@pytest.mark.parametrize("position", [0.05, 0.2, 0.5])
def test_equilibrium_energy_and_complementarity_hold_to_rounding(position):
    for point in table(position).points[0]:
        assert point.status.usable, point.reason
        assert point.residual < 1e-10  # bore moment and torque, u f and p C p, pressures, gaps
        assert sum(point.load_share.values()) == pytest.approx(1.0, abs=1e-12)
        assert point.iterations > 0


def test_it_stiffens_under_load_and_torques_differ_off_the_line_of_action():
    ste = table(0.5).transmission_error[0]
    assert np.all(np.diff(ste) > 0.0)
    assert np.all(np.diff(ste / np.array(TORQUES)) < 0.0)
    on_line, at_corner = table(0.5).points[0][1], table(0.2).points[0][2]
    assert on_line.torque_ratio == pytest.approx(1.0, abs=2e-4)
    assert at_corner.torque_ratio < 0.995
    assert at_corner.load_share[-1] > 0.05


@pytest.mark.law
def test_a_pair_of_twins_mirrors():
    """Driven backwards by the other gear: the same contact, named by the angle of what then drives."""
    position, torque = 0.34, 1
    ste = float(table(position).transmission_error[0, torque])
    mirrored = -position + ste / PAIR.base_pitch
    other = solve_full_contact(PAIR, [TORQUES[torque]], [mirrored], COARSE)
    assert float(other.transmission_error[0, 0]) == pytest.approx(ste, rel=5e-4)
    first, second = table(position).points[0][torque].load_share, other.points[0][0].load_share
    assert first[0] == pytest.approx(second[0], abs=1e-3)


def test_positions_repeat_and_a_coarser_mesh_states_the_error():
    near, far = table(0.25), solve_full_contact(PAIR, TORQUES, [3.25], COARSE)  # one fraction to the last bit
    np.testing.assert_allclose(far.transmission_error, near.transmission_error, rtol=1e-9)
    assert far.points[0][0].position == 3.25
    found = solve_full_contact(PAIR, [100.0], [0.5], estimate_error=True)
    error = float(found.error_estimate[0, 0] / found.transmission_error[0, 0])
    assert 0.0 < error < 2e-3
    assert np.isnan(table(0.5).error_estimate).all()
    assert "error_estimate_m" in found.points[0][0].to_json()


def test_elasticity_scales():
    """Lengths, face and torque scaled: STE over length depends on torque / (E b r^2) alone."""
    gear = Gear(20, 2e-3, 40e-3, 20e-3, material=Material(70e9, 0.3))
    pair = GearPair(gear, gear, center_distance=40e-3)
    torques = [torque * 0.25 * 1.6 * 70e9 / GEAR.material.youngs_modulus for torque in TORQUES]
    scaled = solve_full_contact(pair, torques, [0.5], COARSE).transmission_error
    np.testing.assert_allclose(2.0 * scaled, table(0.5).transmission_error, rtol=1e-4)


def test_relief_parts_the_flanks_by_what_is_removed():
    """Both flanks relieved evenly along the whole profile: the gear lags by that much more."""
    removed = 12e-6
    crowned = replace(GEAR, modification=FlankModification(profile_crowning=removed))
    pitch_point = solve_full_contact(GearPair(crowned, GEAR, 80e-3), [100.0], [0.5], COARSE)
    rolls = PAIR.roll_lengths(0.5, np.array([-1, 0]))[0]
    gaps = crowned.modification.material_removed(crowned, rolls, 0.0)
    more = float(pitch_point.transmission_error[0, 0] - table(0.5).transmission_error[0, 1])
    assert min(gaps) < more < max(gaps) + 1e-6
    assert max(gaps) > 1e-6


@pytest.mark.law
@pytest.mark.parametrize(
    "pair", [GearPair(GEAR, WHEEL, 102e-3), InternalGearPair(GEAR, WIDE_RING)], ids=["external", "internal"]
)
def test_the_raised_ring_stands_for_the_teeth_that_are_left_out(pair, monkeypatch):
    solved = []
    for teeth in (placed_mesh.FEW_TEETH, pair.wheel.teeth):
        monkeypatch.setattr(placed_mesh, "FEW_TEETH", teeth)
        solved.append(solve_full_contact(pair, [100.0], [0.05, 0.4], Resolution(2.0)).transmission_error)
    np.testing.assert_allclose(solved[0], solved[1], rtol=3e-4)


@pytest.mark.law
def test_a_high_contact_ratio_shares_among_more_pairs():
    tall = Gear(
        teeth=60, normal_module=2e-3, face_width=20e-3, bore_diameter=40e-3,
        addendum_coefficient=1.4, dedendum_coefficient=1.65, root_radius_coefficient=0.2,
    )  # fmt: skip
    pair = GearPair(tall, tall, center_distance=120e-3)
    assert pair.transverse_contact_ratio > 2.0
    (point,) = solve_full_contact(pair, [200.0], [0.0], COARSE).points[0]
    assert point.status.usable, point.reason
    assert sum(share > 0.2 for share in point.load_share.values()) == 3
    assert point.load_share[1] == pytest.approx(point.load_share[-1], abs=2e-3)


def test_the_same_gears_inside_a_ring_deflect_less():
    pinion = Gear(24, 2e-3, 20e-3, bore_diameter=24e-3)
    ring = RingGear(72, 2e-3, 20e-3, rim_diameter=164e-3, addendum_coefficient=0.85)
    (point,) = solve_full_contact(InternalGearPair(pinion, ring), [50.0], [-0.2], COARSE).points[0]
    assert point.status.usable, point.reason
    assert point.residual < 1e-10
    assert point.torque_ratio == pytest.approx(3.0, rel=1e-3)
    assert point.transmission_error > 0.0


@pytest.mark.law
def test_unlike_materials_share_the_deflection():
    soft = replace(WHEEL, material=Material(9e9, 0.35))
    found = solve_full_contact(GearPair(GEAR, soft, 102e-3), [40.0], [0.4], COARSE)
    stiff = solve_full_contact(GearPair(GEAR, WHEEL, 102e-3), [40.0], [0.4], COARSE)
    assert not found.failed
    assert found.transmission_error[0, 0] > 8.0 * stiff.transmission_error[0, 0]


def test_what_it_cannot_hold_is_refused_by_reason():
    assert refusal(PAIR) is None
    helical = [replace(GEAR, helix_angle=angle) for angle in (0.2, -0.2)]
    assert "helical" in str(refusal(GearPair(*helical, center_distance=helical[0].reference_radius * 2.0)))
    web = replace(GEAR, blank=GearBlank(rim_thickness=8e-3, web_thickness=6e-3))
    assert "rim" in str(refusal(replace(PAIR, pinion=web)))
    rounded = replace(GEAR, modification=FlankModification(tip_rounding=0.1e-3))
    assert "tips" in str(refusal(replace(PAIR, wheel=rounded)))
    with pytest.raises(InputError, match="across the face"):
        crowned = replace(GEAR, modification=FlankModification(helix_crowning=5e-6))
        solve_full_contact(replace(PAIR, wheel=crowned), [1.0], [0.0])
    with pytest.raises(InputError, match="torques = 0"):
        solve_full_contact(PAIR, [100.0, 0.0], [0.0])
    with pytest.raises(InputError, match="positions = nan"):
        solve_full_contact(PAIR, [100.0], [float("nan")])
    with pytest.raises(InputError, match="torques = 'none'"):
        solve_full_contact(PAIR, [], [0.0])


def test_a_position_without_a_mesh_says_why(monkeypatch):
    def fail(*_):
        raise MeshError("gmsh: no")

    monkeypatch.setattr(solved_position, "placed_bodies", fail)
    found = solve_full_contact(PAIR, [100.0], [0.0])
    assert [point.reason for point in found.failed] == ["gmsh: no"]
    assert np.isnan(found.transmission_error).all()
    assert found.unknowns.tolist() == [0]
