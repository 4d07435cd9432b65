"""Shaft deflection: the beam against textbooks, the term against vector algebra, when it is called for."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fe_contact.contact import ContactModel, ContactProblem, PatchRule, Slices, contact_candidates
from fe_contact.contact import with_compliances as with_added
from fe_contact.contact.flank_slope import rolls_at
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.effects.shaft_compliance import SeatCompliance, ShaftCompliance
from fe_contact.effects.shaft_deflection import ShaftDeflection
from fe_contact.geometry import Gear, GearPair, InternalGearPair, ParallelAxes, RingGear, Shaft

SHAFT = Shaft(length=0.2, diameter=0.04, position=0.06, bearing_stiffness=4e8)
E, NU = SHAFT.material.youngs_modulus, SHAFT.material.poissons_ratio


def seat(**changes: Any) -> SeatCompliance:
    return SeatCompliance.of_shaft(replace(SHAFT, **changes))


def figures(found: SeatCompliance) -> tuple[float, float, float]:
    return found.translation, found.coupling, found.tilt


def bending_stiffness(diameter: float) -> float:
    return E * math.pi * diameter**4 / 64.0


def test_a_slender_shaft_is_the_textbooks_beam_and_shear_adds_what_timoshenko_says():
    length, a = 3.0, 1.2
    b = length - a
    found = seat(length=length, diameter=5e-3, position=a, bearing_stiffness=None)
    three = 3.0 * bending_stiffness(5e-3) * length
    closed = (a**2 * b**2 / three, a * b * (b - a) / three, (a**3 + b**3) / (three * length))
    assert figures(found) == pytest.approx(closed, rel=1e-5, abs=0.0)
    # Against the beam of Bernoulli: a b/(k G A l) of translation, 1/(k G A l) of tilt, no coupling.
    found = seat(bearing_stiffness=None)
    a, b, length = 0.06, 0.14, 0.2
    three = 3.0 * bending_stiffness(0.04) * length
    area = 6.0 * (1.0 + NU) / (7.0 + 6.0 * NU) * E / (2.0 * (1.0 + NU)) * math.pi * 0.02**2
    assert found.translation - a**2 * b**2 / three == pytest.approx(
        a * b / (area * length), rel=1e-9, abs=0.0
    )
    assert found.coupling == pytest.approx(a * b * (b - a) / three, rel=1e-12, abs=0.0)
    tilt = found.tilt - (a**3 + b**3) / (three * length)
    assert tilt == pytest.approx(1.0 / (area * length), rel=1e-9, abs=0.0)


@pytest.mark.parametrize("side", [+1, -1])
def test_a_gear_beside_the_bearings_is_the_textbooks_overhang(side):
    length, c = 3.0, 0.8
    position = length + c if side > 0 else -c
    found = seat(length=length, diameter=5e-3, position=position, bearing_stiffness=None)
    stiffness = bending_stiffness(5e-3)
    closed = (
        c**2 * (length + c) / (3.0 * stiffness),
        side * c * (2.0 * length + 3.0 * c) / (6.0 * stiffness),
        (length + 3.0 * c) / (3.0 * stiffness),
    )
    assert figures(found) == pytest.approx(closed, rel=1e-4, abs=0.0)


@pytest.mark.parametrize("position", [-0.05, 0.0, 0.06, 0.1, 0.23])
def test_bearings_move_the_shaft_as_a_rigid_body(position):
    """Two springs k at 0 and l: translation ((l - a)^2 + a^2)/(k l^2), tilt 2/(k l^2)."""
    length, k = 0.2, 4e8
    soft, hard = seat(position=position), seat(position=position, bearing_stiffness=None)
    added = np.subtract(figures(soft), figures(hard))
    closed = ((length - position) ** 2 + position**2, 2.0 * position - length, 2.0)
    assert added == pytest.approx(np.array(closed) / (k * length**2), rel=1e-9, abs=1e-22)


def make_pair(helix: float = 0.0, offset: float = 0.0, **fields: Any) -> GearPair:
    pinion = Gear(20, 4e-3, 24e-3, 40e-3, helix_angle=helix)
    return GearPair(pinion, replace(pinion, teeth=31, helix_angle=-helix), axial_offset=offset, **fields)


def internal_pair(helix: float, offset: float) -> InternalGearPair:
    pinion = Gear(20, 4e-3, 24e-3, 40e-3, helix_angle=helix, profile_shift_coefficient=0.3)
    ring = RingGear(80, 4e-3, 24e-3, 0.42, helix_angle=helix, addendum_coefficient=0.8)
    return InternalGearPair(pinion, ring, axial_offset=offset)


def places(pair: ParallelAxes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Roll lengths (P, n) and face positions (n,) of the middles of slices."""
    slices = Slices.of_pair(pair, 5)
    found = contact_candidates(pair, ContactModel(), np.arange(3) / 3, PatchRule(3e-4, 2e-4), slices).slices
    return *rolls_at(pair, found.touch.s_1, found.touch.s_2), found.face_position


def skewed(vector: np.ndarray) -> np.ndarray:
    """Matrix of the cross product."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def moved_by_wrenches(pair, seats, roll_1, roll_2, face) -> np.ndarray:
    """C_ij = w_i' S w_j with the six-by-six compliance of each seat and w = (force, moment) in space."""
    beta = pair.base_helix_angle
    t, n, z = np.eye(3)
    force = math.cos(beta) * t + math.sin(beta) * z
    total = np.zeros((face.size, face.size))
    beside = face - pair.axial_offset
    origins = (
        [pair.pinion.base_radius * n + roll * t + y * z for roll, y in zip(roll_1, face, strict=True)],
        [
            -pair.wheel.sign * (pair.wheel.base_radius * n + roll * t) + y * z
            for roll, y in zip(roll_2, beside, strict=True)
        ],
    )
    for found, arms in zip(seats, origins, strict=True):
        space = np.zeros((6, 6))
        space[0, 0] = space[1, 1] = found.translation
        space[3, 3] = space[4, 4] = found.tilt
        # a turn about n slopes the axis in t; one about t slopes it against n
        space[0, 4] = space[4, 0] = found.coupling
        space[1, 3] = space[3, 1] = -found.coupling
        wrenches = np.array([np.concatenate([force, skewed(arm) @ force]) for arm in arms])
        total += wrenches @ space @ wrenches.T
    return total


@pytest.mark.parametrize("helix", [0.0, 0.35, -0.35])
@pytest.mark.parametrize("make", [make_pair, internal_pair])
def test_the_term_is_the_work_of_wrenches_on_the_seats(make, helix):
    """A ring's axis lies on the pinion's side of the line of action, its foot behind the pinion's."""
    pair = make(helix, offset=3e-3)
    seats = seat(), seat(length=0.15, position=0.1, diameter=0.05)
    roll_1, roll_2, face = places(pair)
    found = ShaftCompliance(*seats)(pair, roll_1, roll_2, face)
    for p in range(3):
        expected = moved_by_wrenches(pair, seats, roll_1[p], roll_2[p], face)
        assert found[p] == pytest.approx(expected, rel=1e-10, abs=0.0)


@pytest.mark.parametrize("helix", [0.0, 0.35])
def test_the_term_is_symmetric_and_never_gives_work_away(helix):
    pair = make_pair(helix)
    found = ShaftCompliance(seat(), seat(position=0.15))(pair, *places(pair))
    assert np.array_equal(found, found.transpose(0, 2, 1))
    values = np.linalg.eigvalsh(found)
    assert values.min() > -1e-13 * values.max()
    # translation and tilt of either gear in the plane of action, and a constant
    assert np.linalg.matrix_rank(found[0], tol=1e-10 * values.max()) <= 4


def test_opposite_hand_or_side_is_the_mirror_image():
    right, left = make_pair(0.35), make_pair(-0.35)
    roll_1, roll_2, face = places(right)
    first = ShaftCompliance(seat(), seat(position=0.15))(right, roll_1, roll_2, face)
    second = ShaftCompliance(seat(position=0.14), seat(position=0.05))(left, roll_1, roll_2, -face)
    assert second == pytest.approx(first, rel=1e-12, abs=0.0)
    first, second = seat(position=0.05), seat(position=0.15)
    assert second.translation == pytest.approx(first.translation, rel=1e-12, abs=0.0)
    assert second.coupling == pytest.approx(-first.coupling, rel=1e-12, abs=0.0)
    assert second.tilt == pytest.approx(first.tilt, rel=1e-12, abs=0.0)
    pair = make_pair(shafts=(SHAFT, None))
    assert pair.swapped().shafts == (None, SHAFT)


def problem_of(pair: GearPair) -> ContactProblem:
    slices = Slices.of_pair(pair, 5)
    candidates = contact_candidates(pair, ContactModel(), np.arange(3) / 3, PatchRule(3e-4, 2e-4), slices)
    springs = 1e-9 * np.eye(candidates.slices.pair.size) + np.zeros((3, 1, 1))
    return ContactProblem(candidates, springs, 1e11, 1e-11, 1e-11)


def scene(*shafts: Shaft | None) -> ContactScene:
    return ContactScene(make_pair(shafts=shafts), np.array([100.0]), EFFECTS)


def test_without_shafts_the_problem_is_untouched_and_with_ever_stiffer_ones_nothing_is_added():
    bare = scene(None, None)
    model = ShaftDeflection().contribute(bare, ContactModel())
    assert model == ContactModel()
    problem = problem_of(bare.pair)
    assert with_added(bare.pair, problem, model) is problem
    added = []
    for diameter in (0.1, 1.0, 10.0):
        stiff = scene(replace(SHAFT, diameter=diameter, bearing_stiffness=None), None)
        model = ShaftDeflection().contribute(stiff, ContactModel())
        assert len(model.compliances) == 1
        added.append(np.abs(with_added(stiff.pair, problem, model).compliance - problem.compliance).max())
    assert added[1] < 1e-2 * added[0]  # shear falls with the square of the diameter, bending faster
    assert added[2] < 1.01e-2 * added[1] < 1e-4 * problem.compliance.max()


def test_the_term_is_added_between_all_slices_once():
    case = scene(SHAFT, replace(SHAFT, position=0.1))
    problem = problem_of(case.pair)
    model = ShaftDeflection().contribute(case, ContactModel())
    added = with_added(case.pair, problem, model).compliance - problem.compliance
    assert added == pytest.approx(model.compliances[0](case.pair, *places(case.pair)), rel=1e-6, abs=0.0)
    assert np.all(added > 0.0)


def test_a_shaft_calls_for_its_deflection_and_for_three_dimensions():
    assert not ShaftDeflection().called_for(scene(None, None)).on
    assert "wheel" in ShaftDeflection().called_for(scene(None, SHAFT)).reason
    verdict = ShaftDeflection().called_for(scene(SHAFT, None))
    force = 100.0 / scene(SHAFT, None).pair.pinion.base_radius
    skew = 1e6 * force * seat().coupling * 24e-3
    assert verdict.reason == f"pinion on a flexible shaft: {skew:.3g} µm of misalignment at the largest load"
    model, ledger = compose(scene(SHAFT, None), {})
    assert model.across_face
    assert len(model.compliances) == 1
    assert compose(scene(SHAFT, None), {"shaft_deflection": "off"})[0].compliances == ()
    assert (
        compose(replace(scene(SHAFT, SHAFT), registry=EFFECTS[::-1]), {})[0]
        == compose(scene(SHAFT, SHAFT), {})[0]
    )
    assert {entry.name for entry in ledger if entry.on} >= {"shaft_deflection", "face_load_distribution"}
