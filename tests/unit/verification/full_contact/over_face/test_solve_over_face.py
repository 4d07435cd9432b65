"""Full contact of gears over the face: laws that every solution keeps, and refusals."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from spur_gears import GEAR, PAIR

from fe_contact import FlankModification, Gear, GearPair, InternalGearPair, RingGear
from fe_contact.errors import InputError
from verification.full_contact import (
    FullContactTable,
    Resolution,
    refusal_helical,
    refusal_over_face,
    solve_full_contact,
    solve_full_contact_over_face,
)
from verification.full_contact.condensation.contact_model import softness
from verification.full_contact.over_face.layers import graded_layers
from verification.full_contact.over_face.solve import _WholeFace

SLOPE, TORQUE, POSITION = 20e-6, 150.0, 0.1
CROWNED = FlankModification(helix_crowning=6e-6, helix_slope=SLOPE)
COARSE = Resolution(1.5, 1.0, 1)
RING = RingGear(72, 4e-3, 25e-3, rim_diameter=328e-3, addendum_coefficient=0.85)
INSIDE = InternalGearPair(Gear(24, 4e-3, 25e-3, bore_diameter=48e-3), RING)


def over_face(pair: GearPair, *misalignments: float) -> tuple[FullContactTable, ...]:
    return solve_full_contact_over_face(pair, [20.0, TORQUE], [POSITION], misalignments, COARSE)


@cache
def plain() -> tuple[FullContactTable, ...]:
    return over_face(PAIR, 0.0, SLOPE, -SLOPE)


@cache
def sloped() -> tuple[FullContactTable, ...]:
    return over_face(replace(PAIR, pinion=replace(GEAR, modification=CROWNED)), 0.0, -SLOPE, -2.0 * SLOPE)


@pytest.mark.law
def test_equilibrium_and_complementarity_hold_to_rounding():
    for table in (*plain(), *sloped()):
        for point in table.points[0]:
            assert point.status.usable, point.reason
            assert point.residual < 1e-10  # bore moments and torque, pressures, gaps
            assert sum(point.load_share.values()) == pytest.approx(1.0, abs=1e-12)
            assert point.torque_ratio == pytest.approx(1.0, abs=3e-4)


def test_opposite_misalignments_mirror():
    """Flanks that are alike at both ends cannot tell them; with a slope the mirrored one is as far away."""
    aligned, one, other = (table.transmission_error[0] for table in plain())
    np.testing.assert_allclose(one, other, rtol=1e-9)
    assert not np.allclose(one, aligned, rtol=1e-2)
    first, straight, last = (table.transmission_error[0] for table in sloped())
    np.testing.assert_allclose(first, last, rtol=0.0, atol=5e-9)
    assert np.all(straight > first)


def test_line_loads_carry_the_torque_and_mirror():
    aligned, one, other = (table.points[0][1] for table in plain())
    for point in (aligned, one, other):
        forces = [np.trapezoid(own.load, own.face_position) for own in point.line_loads]
        assert sum(forces) == pytest.approx(PAIR.normal_force(TORQUE), rel=2e-3)  # arms of bent flanks
    for own, mirrored in zip(one.line_loads, other.line_loads, strict=True):
        np.testing.assert_allclose(own.load, mirrored.load[::-1], rtol=1e-6, atol=1e-6 * own.load.max())
    assert one.line_loads[0].load[0] > 1.1 * one.line_loads[0].load[-1]


@pytest.mark.law
def test_a_slope_is_a_misalignment():
    """Removed from a flank or turned away: the same gap but for where on the flank it is."""
    steep = replace(PAIR, wheel=replace(GEAR, modification=FlankModification(helix_slope=SLOPE)))
    found = over_face(steep, 0.0)[0].transmission_error
    np.testing.assert_allclose(found, plain()[1].transmission_error, rtol=0.0, atol=2e-9)


@pytest.mark.law
def test_a_misalignment_in_a_ring_gear_undoes_the_slope_of_either_gear():
    """Both remove towards positive face positions, and the misalignment closes the gap there."""
    sloped = FlankModification(helix_slope=SLOPE)
    plain = over_face(INSIDE, 0.0)[0]
    for side in ("pinion", "wheel"):
        gear = replace(getattr(INSIDE, side), modification=sloped)
        open_there, undone = over_face(replace(INSIDE, **{side: gear}), 0.0, -SLOPE)
        np.testing.assert_allclose(undone.transmission_error, plain.transmission_error, rtol=0.0, atol=5e-9)
        assert np.all(open_there.transmission_error < undone.transmission_error - 50e-9)
    for point in plain.points[0]:
        assert point.status.usable, point.reason
        assert point.residual < 1e-10
        assert point.torque_ratio == pytest.approx(3.0, rel=2e-3)


def test_it_is_a_little_softer_than_plane_strain():
    flat = solve_full_contact(PAIR, [20.0, TORQUE], [POSITION], COARSE).transmission_error
    ratio = plain()[0].transmission_error / flat
    assert np.all(ratio > 1.02)
    assert np.all(ratio < 1.04)


def test_layers_are_finest_at_the_face_and_springs_size_the_mesh():
    layers = graded_layers(25e-3, 5)
    thickness = np.diff(layers.planes)
    assert thickness.sum() == pytest.approx(12.5e-3)
    assert np.all(np.diff(thickness) < 0.0)
    mass, mixed, steep = layers.integrals()
    ones = (np.arange(11) <= 5).astype(float)
    assert ones @ mass @ ones == pytest.approx(12.5e-3)
    np.testing.assert_allclose(ones @ mixed, 0.0, atol=1e-12)
    np.testing.assert_allclose(steep @ ones, 0.0, atol=1e-9)
    # Of a gap that opens by the mean deflection to either side: 1.5 times the mean; of twice as much: 2.
    mean = 1e5
    deflection = mean * softness(PAIR)
    for opened, factor in ((1.0, 1.5), (2.0, 2.0), (8.0, 4.0)):
        model = _WholeFace((opened * deflection,), COARSE.outermost)
        assert model.largest_line_load(PAIR, mean * 25e-3) == pytest.approx(factor * mean, rel=0.01)
        assert model.closer(PAIR) == pytest.approx(0.5 * opened * deflection)


def test_what_it_cannot_hold_is_refused_by_reason():
    assert refusal_over_face(PAIR) is None
    assert refusal_over_face(replace(PAIR, wheel=replace(GEAR, modification=CROWNED))) is None
    helical = [replace(GEAR, helix_angle=angle) for angle in (0.2, -0.2)]
    tilted = GearPair(*helical, center_distance=helical[0].reference_radius * 2.0)
    assert "helical" in str(refusal_over_face(tilted))
    assert "faces" in str(refusal_over_face(replace(PAIR, wheel=replace(GEAR, face_width=20e-3))))
    assert refusal_over_face(INSIDE) is None
    assert "ring gear" in str(refusal_helical(INSIDE))
    for pair, misalignments, torque, match in (
        (tilted, [0.0], 1.0, "helical"),
        (PAIR, [], 1.0, "misalignments"),
        (PAIR, [float("nan")], 1.0, "misalignments"),
        (PAIR, [0.0], -1.0, "torques"),
    ):
        with pytest.raises(InputError, match=match):
            solve_full_contact_over_face(pair, [torque], [0.0], misalignments)
