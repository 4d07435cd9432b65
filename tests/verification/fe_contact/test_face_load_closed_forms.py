"""Contact over the face against closed forms: uncoupled slices, tilting shafts, lengths of contact lines."""

import dataclasses
import math

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, LoadDistribution, Material, Shaft
from fe_contact.analysis.flanks.load_distribution import load_distribution
from fe_contact.contact import (
    ContactModel,
    ContactProblem,
    ContactSolution,
    PatchRule,
    Slices,
    contact_candidates,
    solve_contact,
    with_compliances,
    with_gaps,
)
from fe_contact.effects.flank_modification import ModificationGap
from fe_contact.effects.misalignment import MisalignmentGap
from fe_contact.effects.shaft_compliance import SeatCompliance, ShaftCompliance

SOURCE = "thin slices, closed form"
WIDTH = 20e-3
STIFFNESS, FORCE = 15e9, 3000.0  # N/m per m of face, N


def slice_pair(**modification: float) -> GearPair:
    gear = Gear(20, 4e-3, WIDTH, 40e-3, modification=FlankModification(**modification))
    return GearPair(gear, dataclasses.replace(gear, modification=FlankModification()), 80e-3)


COUNT = 200


def uncoupled(pair: GearPair, *gaps: object) -> tuple[float, np.ndarray]:
    """Deflection and line load of one pair at the pitch point whose slices are springs of their own."""
    found = springs(pair, *gaps)
    return float(found.deflection[0]), found.line_load[0, np.flatnonzero(found.pair == 0)[0]]


def springs(pair: GearPair, *gaps: object) -> LoadDistribution:
    """Load distribution of that pair."""
    problem, solution, _ = solved_slices(pair, ContactModel(gaps=gaps), np.array([FORCE]))
    return load_distribution(pair, problem, solution)


def solved_slices(
    pair: GearPair, model: ContactModel, force: np.ndarray, modulus: float = 1e20, soft: float = 1e-20
) -> tuple[ContactProblem, ContactSolution, np.ndarray]:
    """One pair at the pitch point, bodies a billion times stiffer than steel: no local approach."""
    slices = Slices.of_pair(pair, COUNT, 1)
    plain = contact_candidates(pair, model, np.zeros(1), PatchRule(1e-3, 1e-4), slices)
    # one point a slice that moves with its own slice alone: no curve through the means of its neighbors
    alone = dataclasses.replace(plain, curves=np.eye(COUNT), heights=np.eye(COUNT))
    candidates = with_gaps(pair, alone, model)
    only = candidates.pair == 0
    gap = np.where(only, candidates.gap, np.inf)
    candidates = candidates.touching(dataclasses.replace(candidates.touch, gap=gap))
    spring = np.eye(only.size)[None] / (STIFFNESS * WIDTH / COUNT)
    problem = with_compliances(pair, ContactProblem(candidates, spring, modulus, soft, soft), model)
    solution = solve_contact(problem, force)
    assert solution.converged
    return problem, solution, only


@pytest.mark.parametrize(
    ("misalignment", "k_h_beta", "side", "fraction"),
    [
        (5e-6, 1.25, 12.5e-6, 1.0),
        (10e-6, 1.5, 15e-6, 1.0),
        (20e-6, 2.0, 20e-6, 1.0),
        (40e-6, 2.828427, 28.284271e-6, 0.707107),
        (80e-6, 4.0, 40e-6, 0.5),
    ],
)
def test_misalignment_of_uncoupled_slices(misalignment, k_h_beta, side, fraction, record_figure):
    """Largest over mean line load, deflection of the loaded side, part of the face in contact."""
    deflection, load = uncoupled(slice_pair(), MisalignmentGap(misalignment))
    # the gap is zero at mid-face; the loaded side is half the misalignment closer
    at_end = deflection + misalignment / 2
    largest = at_end * STIFFNESS / (FORCE / WIDTH)
    record_figure(f"K_Hbeta of thin slices, {1e6 * misalignment:g} um", largest, k_h_beta, "-", SOURCE)
    assert largest == pytest.approx(k_h_beta, rel=1e-3)
    assert at_end == pytest.approx(side, rel=1e-3)
    assert np.mean(load > 0.0) == pytest.approx(fraction, abs=2.5e-3)


@pytest.mark.parametrize(
    ("misalignment", "k_h_beta", "fraction"),
    [(0.0, 1.0, 1.0), (5e-6, 1.25, 1.0), (20e-6, 2.0, 1.0), (40e-6, 2.828427, 0.707107), (80e-6, 4.0, 0.5)],
)
def test_face_load_factor_and_centroid_of_uncoupled_slices(misalignment, k_h_beta, fraction):
    """The load falls linearly from the closed side over the part of the face in contact.

    Trapezoid (all in contact): centroid at (K - 1) b/6 from the middle; triangle: a third of its base from
    the closed side. The outermost slice is half a slice away from the end of the face.
    """
    found = springs(slice_pair(), MisalignmentGap(misalignment))
    slope = misalignment * STIFFNESS * WIDTH / FORCE
    assert found.face_load_factor[0] == pytest.approx(k_h_beta - 0.5 * slope / COUNT, rel=1e-5)
    assert found.mean_face_load_factor == pytest.approx(found.face_load_factor[0], rel=1e-12)
    pair_factor = found.pair_line_load_factor[0, np.flatnonzero(found.pair == 0)[0]]
    assert pair_factor == pytest.approx(found.face_load_factor[0], rel=1e-9)
    away = (k_h_beta - 1.0) / 6.0 if fraction == 1.0 else 0.5 - fraction / 3.0
    assert found.load_centroid[0] == pytest.approx(-away * WIDTH, rel=1e-3, abs=1e-9)


@pytest.mark.parametrize(
    ("crown", "expected"),
    [(5e-6, 11.66667e-6), (10e-6, 13.33333e-6), (15e-6, 15e-6), (20e-6, 16.50964e-6), (40e-6, 20.80084e-6)],
)
def test_crowning_of_uncoupled_slices(crown, expected, record_figure):
    pair = slice_pair(helix_crowning=crown)
    lead = ModificationGap(pair.pinion.modification, pair.wheel.modification)
    deflection, _ = uncoupled(pair, lead)
    name = f"deflection of crowned thin slices, {1e6 * crown:g} um"
    record_figure(name, 1e6 * deflection, 1e6 * expected, "um", SOURCE)
    assert deflection == pytest.approx(expected, rel=1e-3)


def helical_pair(overlap: float) -> GearPair:
    """Return the pair of ISO/TR 6336-30 example 1 with the face width that gives an overlap ratio."""
    angle = math.radians(15.8)
    width = overlap * math.pi * 8e-3 / math.sin(angle)
    pinion = Gear(
        17, 8e-3, width, 60e-3, helix_angle=angle, profile_shift_coefficient=0.145, dedendum_coefficient=1.4
    )
    wheel = dataclasses.replace(pinion, teeth=103, helix_angle=-angle, profile_shift_coefficient=0.0)
    return GearPair(pinion, wheel, 0.5)


@pytest.mark.parametrize("overlap", [0.4, 0.5, 1.0, 1.0834])
def test_length_of_contact_lines(overlap, record_figure):
    """Overlap of two trapezoids of the phase: mean eps_alpha eps_beta; ends from the fractional parts.

    In units of axial pitch over cos(beta_b), the length at phase x is the measure of phases in [x, x +
    eps_beta] that fall into [0, eps_alpha] modulo one pitch.
    """
    pair = helical_pair(overlap)
    position = np.linspace(0.0, 1.0, 101)
    slices = Slices.of_pair(pair, 20)
    candidates = contact_candidates(pair, ContactModel(), position, PatchRule(2e-3, 1e-4), slices)
    axial_pitch = math.pi * pair.pinion.normal_module / math.sin(pair.pinion.helix_angle)
    # points at the ends of a line stand for the part that is on it
    length = np.where(np.isfinite(candidates.gap), candidates.width, 0.0).sum(axis=1)
    lines = length * math.cos(pair.base_helix_angle) / axial_pitch
    alpha, beta = pair.transverse_contact_ratio, pair.overlap_ratio
    mean, low, high = alpha * beta, *closed_form_extremes(alpha, beta)
    name = f"mean contact length, eps_beta {overlap:g}"
    record_figure(name, float(lines[:-1].mean()), mean, "p_x/cos(beta_b)", "closed form")
    # the mean of a hundred places misses the corners of the trapezoids
    assert lines[:-1].mean() == pytest.approx(mean, rel=1e-5)
    assert lines.min() == pytest.approx(low, abs=1e-10)
    assert lines.max() == pytest.approx(high, abs=1e-10)


def closed_form_extremes(alpha: float, beta: float) -> tuple[float, float]:
    """Least and largest length from the whole and fractional parts of the two ratios."""
    whole_a, whole_b = math.floor(alpha), math.floor(beta)
    part_a, part_b = alpha - whole_a, beta - whole_b
    base = whole_a * whole_b + whole_a * part_b + whole_b * part_a
    return base + max(part_a + part_b - 1.0, 0.0), base + min(part_a, part_b)


@pytest.mark.parametrize(
    ("alpha", "beta", "mean", "low", "high"),
    [
        (1.6586, 1.3327, 2.21042, 1.9913, 2.3240),
        (1.5, 0.5, 0.75, 0.5, 1.0),
        (1.7, 0.4, 0.68, 0.5, 0.8),
        (1.549, 1.083, 1.67757, 1.632, 1.715),
        (1.62, 1.0, 1.62, 1.62, 1.62),
    ],
)
def test_the_closed_form_is_the_published_table(alpha, beta, mean, low, high):
    found = closed_form_extremes(alpha, beta)
    assert alpha * beta == pytest.approx(mean, abs=1e-4)
    assert found == pytest.approx((low, high), abs=1e-3)


ON_A_BEAM = "thin slices on a beam, closed form"
RIGID = 2e-17
"""2 (1 - nu^2)/(pi E) in 1/Pa of bodies a hundred thousand times stiffer than steel: next to no approach.

Forces follow from the local approach, a difference of motions: the stiffer the bodies, the more rounding.
"""

NARROW = Material(210e9, 0.0)  # without lateral contraction: its free ends are as stiff as the middle
GEAR = Gear(teeth=20, normal_module=4e-3, face_width=WIDTH, bore_diameter=40e-3, material=NARROW)
PAIR = GearPair(GEAR, GEAR, 80e-3)


def loaded(
    seats: tuple[SeatCompliance | None, SeatCompliance | None], force: np.ndarray, rigid: float = RIGID
):
    """Deflection and line load of one pair at the pitch point, at each normal force."""
    model = ContactModel(compliances=(ShaftCompliance(*seats),))
    _, solution, only = solved_slices(PAIR, model, force, 1.0 / (math.pi * rigid), rigid)
    return solution.deflection[0], solution.force[0][:, only] / (WIDTH / COUNT)


def closed_form(seats: tuple[SeatCompliance, ...]) -> tuple[float, float]:
    """Deflection per force and K_Hbeta where the whole face carries.

    With the line load q = c (d - u - v z), force c b (d - u), moment -c v b^3/12, and u, v from the seats.
    """
    translation, coupling, tilt = (
        sum(getattr(seat, name) for seat in seats) for name in ("translation", "coupling", "tilt")
    )
    inertia = STIFFNESS * WIDTH**3 / 12.0
    slope = coupling / (1.0 + tilt * inertia)  # v per force
    deflection = translation - coupling * slope * inertia + 1.0 / (STIFFNESS * WIDTH)
    return deflection, 1.0 + STIFFNESS * abs(slope) * 0.5 * WIDTH**2


@pytest.mark.parametrize("position", [0.03, 0.06, 0.1, 0.13, 0.22])
def test_tilting_shafts_load_one_end_in_proportion_to_the_load(position, record_figure):
    """K_Hbeta above 1, the same at every load: misalignment grows with it."""
    shaft = Shaft(length=0.2, diameter=0.045, position=position, bearing_stiffness=5e8)
    seats = (
        SeatCompliance.of_shaft(shaft),
        SeatCompliance.of_shaft(dataclasses.replace(shaft, diameter=0.06)),
    )
    force = np.array([300.0, 3000.0, 30000.0])
    deflection, load = loaded(seats, force)
    per_force, k_h_beta = closed_form(seats)
    found = load.max(axis=1) / load.mean(axis=1)
    record_figure(f"K_Hbeta, gear at {1e3 * position:g} of 200 mm", float(found[1]), k_h_beta, "-", ON_A_BEAM)
    assert load.min() > 0.0
    assert deflection == pytest.approx(per_force * force, rel=1e-5, abs=0.0)
    # the middle of the last slice stands half of its own width from its end
    assert found - 1.0 == pytest.approx(
        np.full(3, (k_h_beta - 1.0) * (1.0 - 1.0 / COUNT)), rel=1e-4, abs=1e-9
    )
    # the end nearer to a bearing gives way less; a gear beside them loads its inner end
    assert (np.argmax(load[1]) > COUNT / 2) == (0.1 < position < 0.2) or position == 0.1


def test_load_grows_uneven_the_further_the_gear_stands_from_the_middle():
    uneven = []
    for position in (0.1, 0.08, 0.06, 0.05):
        seat = SeatCompliance.of_shaft(Shaft(length=0.2, diameter=0.04, position=position))
        _, load = loaded((seat, None), np.array([3000.0]))
        uneven.append(load.max() / load.mean())
    assert uneven[0] == pytest.approx(1.0, abs=1e-9)
    assert np.all(np.diff(uneven) > 0.01)


def test_partial_contact_satisfies_its_own_tilt():
    """Where the tilt lifts part of the face off, the load that is left bends the shaft to that tilt."""
    seat = SeatCompliance(translation=1e-8, coupling=1e-6, tilt=1e-5)
    deflection, load = loaded((seat, None), np.array([2000.0]), rigid=0.05 * RIGID)
    z = Slices.of_pair(PAIR, COUNT).center
    slice_force = load[0] * WIDTH / COUNT
    force, moment = slice_force.sum(), slice_force @ z
    u, v = seat.translation * force + seat.coupling * moment, seat.coupling * force + seat.tilt * moment
    expected = np.maximum(STIFFNESS * (deflection[0] - u - v * z), 0.0)
    assert 0.1 < np.mean(load[0] > 0.0) < 0.9
    assert force == pytest.approx(2000.0, rel=1e-9)
    assert load[0] == pytest.approx(expected, rel=1e-6, abs=1e-6 * load.max())
