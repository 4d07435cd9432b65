"""Laws of loaded contact over random feasible pairs, from candidates to forces.

Bodies are springs in closed form, so that an example takes milliseconds. What finite elements add obeys the
same laws in tests/stability.
"""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from sprung_flanks import on_springs

from fe_contact import AnalysisOptions, FlankModification, Gear, GearPair, Material, PitchDeviation, TableAxes
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact import ContactModel, ContactSolution
from fe_contact.errors import InputError
from fe_contact.planning.plan import make_plan

LAWS = settings(suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow])
POSITIONS = np.arange(24) / 24
LINE_LOAD = 10e6  # Pa of face width times module


@dataclass(frozen=True)
class Loaded:
    """A pair with its loads."""

    contact: PairContact
    model: ContactModel
    load: np.ndarray

    @property
    def pair(self) -> GearPair:
        return self.contact.pair

    def solve(self, position=POSITIONS, load=None, **model: object) -> ContactSolution:
        chosen = replace(self.model, **model)
        return self.contact.solve(chosen, position, self.load if load is None else load)[1]


def loaded(pair: GearPair, load: np.ndarray) -> Loaded:
    asked = check_request(
        pair,
        TableAxes(normal_forces=load, pitches=pitches_of(pair)),
        AnalysisOptions(model="plane_strain", level="draft"),
    )
    plan = make_plan(pair, asked.request.load, asked.request.options, asked.model)
    return Loaded(on_springs(pair, plan), asked.model, load)


def pitches_of(pair: GearPair) -> int | None:
    gears = (pair.pinion, pair.wheel)
    return None if all(gear.period == 1 for gear in gears) else 1


materials = st.builds(Material, st.floats(2e9, 300e9), st.floats(0.0, 0.49))


@st.composite
def gears(draw: st.DrawFn, module: float) -> Gear:
    size = module * 10.0 ** draw(st.floats(-4.0, -2.3))
    relief = draw(st.sampled_from([0.0, size]))
    modification = FlankModification(
        tip_relief=relief,
        tip_relief_length=0.5 * module if relief else 0.0,
        profile_crowning=draw(st.sampled_from([0.0, size])),
    )
    return Gear(
        teeth=draw(st.integers(12, 120)),
        normal_module=module,
        face_width=draw(st.floats(1.0, 20.0)) * module,
        bore_diameter=3.0 * module,
        profile_shift_coefficient=draw(st.floats(-0.2, 0.6)),
        addendum_coefficient=draw(st.floats(0.85, 1.1)),
        root_radius_coefficient=0.2,
        material=draw(materials),
        modification=modification,
    )


@st.composite
def pairs(draw: st.DrawFn, alike: bool = False) -> Loaded:
    module = 10.0 ** draw(st.floats(-3.7, -1.4))
    try:
        pinion = draw(gears(module))
        pair = GearPair(pinion, pinion if alike else draw(gears(module)))
        apart = draw(st.floats(0.0, 0.1)) * module
        pair = replace(pair, center_distance=pair.center_distance + apart)
    except InputError:
        assume(False)
        raise
    softest = min(gear.material.youngs_modulus for gear in (pair.pinion, pair.wheel))
    nominal = LINE_LOAD * pair.face_width * module * softest / 210e9
    return loaded(pair, nominal * np.geomspace(1e-3, 10.0, 5))


def elastic(solution: ContactSolution) -> np.ndarray:
    return solution.deflection - solution.no_load[:, None]


@LAWS
@given(pairs())
def test_contact_holds_and_shares_are_positive_and_sum_to_one(case):
    problem, solution = case.contact.solve(case.model, POSITIONS, case.load)
    assert solution.converged
    assert solution.residuals.max() < 1e-9
    assert solution.iterations.max() <= 40
    shares = solution.force * problem.candidates.torque_share[:, None, :] / case.load[:, None]
    assert shares.min() >= 0.0
    assert shares.sum(axis=2) == pytest.approx(np.ones(solution.status.shape), abs=1e-12)


@LAWS
@given(pairs())
def test_deflection_grows_with_load_and_stiffness_does_not_fall(case):
    solution = case.solve()
    assert np.all(np.diff(solution.deflection, axis=1) > 0.0)
    assert np.all(solution.tangent > 0.0)
    # off the line of action the arms differ by a per cent, which lets the tangent rise by a trace
    assert np.all(np.diff(solution.tangent, axis=1) <= 2e-3 * solution.tangent[:, :-1])


@LAWS
@given(pairs(), st.floats(0.02, 50.0))
def test_lengths_scale_and_forces_scale_with_their_square(case, scale):
    def scaled(gear):
        lengths = ("normal_module", "face_width", "bore_diameter")
        names = ("tip_relief", "tip_relief_length", "profile_crowning")
        modification = replace(gear.modification, **{n: scale * getattr(gear.modification, n) for n in names})
        return replace(gear, modification=modification, **{n: scale * getattr(gear, n) for n in lengths})

    try:
        large = GearPair(scaled(case.pair.pinion), scaled(case.pair.wheel), scale * case.pair.center_distance)
    except InputError:  # a modification above the largest that is believed
        assume(False)
        raise
    found = loaded(large, scale**2 * case.load).solve(corner_contact=case.model.corner_contact)
    plain = case.solve()
    assert elastic(found) == pytest.approx(scale * elastic(plain), rel=1e-6, abs=0.0)


@LAWS
@given(pairs())
def test_either_gear_may_drive(case):
    """Position x by the one gear is -x by the other, where contact is on the line of action.

    But for lever arms on sloped flanks: the torque is that of gear 1, the lag that of gear 2.
    """
    swapped = loaded(case.pair.swapped(), case.load)
    there = case.solve(corner_contact=False).deflection
    back = swapped.solve((1.0 - POSITIONS) % 1.0, corner_contact=False).deflection
    steepest = steepest_slope(case, POSITIONS)
    assert back == pytest.approx(there, rel=1e-7 + 2.0 * steepest, abs=1e-9 * there.max())


@LAWS
@given(pairs(alike=True))
def test_a_pair_of_equal_gears_is_its_own_mirror_image(case):
    """But for lever arms on sloped flanks: the torque is that of gear 1, the lag that of gear 2."""
    position = (POSITIONS + 1e-3) % 1.0
    solution = case.solve(position, corner_contact=False).deflection
    mirrored = case.solve((1.0 - POSITIONS - 1e-3) % 1.0, corner_contact=False).deflection
    steepest = steepest_slope(case, position)
    assert mirrored == pytest.approx(solution, rel=1e-7 + 2.0 * steepest, abs=1e-9 * solution.max())


def steepest_slope(case: Loaded, position: np.ndarray) -> float:
    """Return the largest slope of flanks where they touch."""
    problem, _ = case.contact.solve(replace(case.model, corner_contact=False), position, case.load)
    touch = problem.candidates.touch
    there = np.isfinite(touch.gap)
    return float(np.abs([touch.slope_1[there], touch.slope_2[there]]).max())


@LAWS
@given(pairs(), st.floats(-1.0, 1.0))
def test_a_rigid_offset_is_added(case, part):
    """All teeth of one gear out of their places by the same: STE shifts by that along the line of action."""
    pinion = case.pair.pinion
    deviation = part * 5e-4 * pinion.normal_module
    moved = replace(pinion, pitch_deviation=PitchDeviation((deviation,) * pinion.teeth))
    shifted = loaded(replace(case.pair, pinion=moved), case.load).solve()
    plain = case.solve()
    offset = -deviation * np.cos(pinion.transverse_pressure_angle)
    error = np.abs(shifted.deflection - plain.deflection - offset)
    assert error.max() <= 1e-9 * (np.abs(plain.deflection).max() + abs(offset))


@LAWS
@given(pairs(), st.floats(0.0, 1.0))
def test_all_repeats_after_one_base_pitch(case, position):
    here, there = (case.solve(np.array([x])) for x in (position, position + 1.0))
    assert there.deflection == pytest.approx(here.deflection, rel=1e-9, abs=0.0)
    # from the end of one pitch to the start of the next other pairs have other indices: a dropped one shows
    before, after = (case.solve(np.array([x])) for x in (1.0 - 1e-9, 1.0))
    assert elastic(after) == pytest.approx(elastic(before), rel=1e-4, abs=0.0)


@LAWS
@given(pairs(), st.floats(0.0, 1.0))
def test_taking_material_off_never_lowers_the_deflection(case, part):
    wheel = case.pair.wheel
    more = wheel.modification.profile_crowning + part * 1e-3 * wheel.normal_module
    worn = replace(wheel, modification=replace(wheel.modification, profile_crowning=more))
    other = loaded(replace(case.pair, wheel=worn), case.load)
    there, here = (each.solve(corner_contact=True).deflection for each in (other, case))
    # the touching point of a modified flank is found to parts of a nanometer
    assert np.all(there - here >= -1e-6 * np.abs(here).max())
