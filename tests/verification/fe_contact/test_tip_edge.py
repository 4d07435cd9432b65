"""Rounded and chamfered tips against sharp ones, against tips that are cut off, and against Hertz."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair
from fe_contact.contact.contact_pressure import contact_pressure
from fe_contact.geometry import InternalGearPair, ParallelAxes, RingGear
from lineofaction.hardcases.contact.contact_case import (
    ContactCase,
    contact_case,
    even_positions,
    nominal_pair,
)

TORQUES = [20.0, 100.0, 400.0]
POSITIONS = even_positions(200)


def in_ring(shape: FlankModification) -> InternalGearPair:
    pinion = Gear(20, 4e-3, 25e-3, bore_diameter=40e-3, modification=shape)
    ring = RingGear(60, 4e-3, 25e-3, rim_diameter=290e-3, addendum_coefficient=0.8, modification=shape)
    return InternalGearPair(pinion, ring, 80e-3)


def helical(shape: FlankModification) -> GearPair:
    gear = Gear(20, 4e-3, 25e-3, bore_diameter=40e-3, helix_angle=0.25, modification=shape)
    return GearPair(gear, replace(gear, helix_angle=-0.25), 2.0 * gear.reference_radius)


def spur(shape: FlankModification) -> GearPair:
    return nominal_pair(modification=shape)


PAIRS = {"spur": (spur, "plane_strain"), "ring": (in_ring, "plane_strain"), "helical": (helical, "3d")}


def cut_off(pair: ParallelAxes, height: float) -> ParallelAxes:
    """Return the pair with lower tips on both gears."""
    gears = {name: getattr(pair, name) for name in ("pinion", "wheel")}
    diameters = {name: 2.0 * (gear.tip_radius - gear.sign * height) for name, gear in gears.items()}
    return replace(pair, **{name: replace(gears[name], tip_diameter=diameters[name]) for name in gears})


def curves(case: ContactCase) -> np.ndarray:
    """STE, of a helical pair at every fifth position: its contact lines hand over at all of them."""
    load = np.asarray(case.pair.normal_force(np.array(TORQUES)))
    position = POSITIONS[::5] if case.pair.base_helix_angle else POSITIONS
    solution = case.solve(position, load)[1]
    assert np.all(solution.status == 0)
    return np.asarray(solution.deflection)


@pytest.fixture(scope="module", params=list(PAIRS))
def sharp(request):
    make, model = PAIRS[request.param]
    return request.param, contact_case(make(FlankModification()), TORQUES, model=model)


def with_edge(sharp: tuple[str, ContactCase], **edge: float) -> ContactCase:
    name, bodies = sharp
    make, model = PAIRS[name]
    case = contact_case(make(FlankModification(**edge)), TORQUES, model=model, bodies=bodies.contact)
    return case.with_model(corner_contact=True)


def test_no_edge_given_is_the_sharp_tip_to_the_last_bit(sharp):
    none = with_edge(sharp, tip_rounding=0.0, tip_chamfer=0.0, tip_chamfer_angle=1.0)
    assert curves(none).tobytes() == curves(sharp[1]).tobytes()


@pytest.mark.law
def test_a_rounding_tends_to_the_sharp_edge_in_proportion_to_its_radius(sharp):
    """Somewhere in the handover the change is what an edge loses: a few tenths of the radius at most."""
    plain = curves(sharp[1])
    changes = []
    for radius in (1e-4, 1e-5, 1e-6, 1e-8):
        change = np.abs(curves(with_edge(sharp, tip_rounding=radius)) - plain).max()
        assert change < 0.05 * radius
        changes.append(change)
    assert np.all(np.diff(changes) < 0.0)
    assert changes[-1] < 1e-6 * plain.max() + 2e-10


@pytest.mark.law
def test_chamfered_teeth_are_teeth_cut_off_at_the_tip_form_circle(sharp):
    """Pairs hand over where theirs do; what is left is the body of the tip, and load patches."""
    height = 0.3e-3
    name, bodies = sharp
    make, model = PAIRS[name]
    cut = contact_case(cut_off(make(FlankModification()), height), TORQUES, model=model)
    wanted, found, plain = curves(cut), curves(with_edge(sharp, tip_chamfer=height)), curves(bodies)
    mean_limit, largest, ripple = {
        "spur": (1e-3, 0.011, 5e-3),
        "ring": (4e-3, 0.03, 5e-3),
        "helical": (2.1e-3, 0.01, 2e-2),
    }[name]
    scale = wanted.mean(axis=0)
    assert np.abs(found.mean(axis=0) / scale - 1.0).max() < mean_limit
    assert (np.abs(found - wanted).max(axis=0) / scale).max() < largest
    assert np.abs(np.ptp(found, axis=0) / np.ptp(wanted, axis=0) - 1.0).max() < ripple
    assert (np.abs(plain - wanted).max(axis=0) / scale).min() > 5.0 * largest


@pytest.mark.law
def test_an_edge_never_stiffens_the_mesh(sharp):
    plain = curves(sharp[1])
    before = plain
    for radius in (1e-5, 1e-4, 3e-4):
        after = curves(with_edge(sharp, tip_rounding=radius))
        assert (after - before).min() > -2e-4 * plain.max()
        assert after.mean() > before.mean()
        before = after


def test_pressure_on_a_rounding_is_that_of_hertz_on_its_radius():
    """Far beyond the tip form point light contacts lie on the arc alone."""
    radius = 0.4e-3
    case = contact_case(nominal_pair(modification=FlankModification(tip_rounding=radius)), TORQUES)
    problem, solution = case.solve(POSITIONS, np.asarray(case.pair.normal_force(np.array([400.0]))))
    candidates = problem.candidates
    form = case.pair.pinion.tip_form_roll_length**2 / (2.0 * case.pair.pinion.base_radius)
    load = solution.force[:, 0] / candidates.width
    pressure = contact_pressure(problem, solution.force)[0][:, 0]
    curvature = 1.0 / radius + 1.0 / np.sqrt(2.0 * case.pair.wheel.base_radius * candidates.touch.s_2)
    half = np.sqrt(4.0 * load / (math.pi * problem.modulus * curvature))
    on_arc = (candidates.touch.s_1 - form > half) & (load > 0.0)
    assert on_arc.sum() >= 3
    wanted = np.sqrt(load * problem.modulus * curvature / math.pi)
    assert pressure[on_arc] == pytest.approx(wanted[on_arc], rel=0.03)
    assert np.all(np.isfinite(pressure))


@pytest.mark.parametrize("angle", [10.0, 45.0])
def test_the_angle_of_a_steep_chamfer_hardly_matters(angle):
    """Beyond its edge contact is open whatever the angle; the edge itself is an edge."""
    height = 0.3e-3
    edge = {"tip_chamfer": height, "tip_chamfer_angle": math.radians(angle)}
    case = contact_case(nominal_pair(modification=FlankModification(**edge)), TORQUES)
    steep = {"tip_chamfer": height, "tip_chamfer_angle": math.radians(30.0)}
    other = contact_case(nominal_pair(modification=FlankModification(**steep)), TORQUES, bodies=case.contact)
    found, wanted = curves(case), curves(other)
    assert (np.abs(found - wanted).max(axis=0) / wanted.mean(axis=0)).max() < 0.02
    load = np.asarray(case.pair.normal_force(np.array(TORQUES)))
    problem, solution = case.solve(POSITIONS, load)
    sharp = contact_case(cut_off(nominal_pair(), height), TORQUES)
    at_cut = contact_pressure(*_with_force(sharp, load))[0].max()
    assert contact_pressure(problem, solution.force)[0].max() == pytest.approx(at_cut, rel=0.05)


def _with_force(case: ContactCase, load: np.ndarray) -> tuple[object, np.ndarray]:
    problem, solution = case.solve(POSITIONS, load)
    return problem, solution.force
