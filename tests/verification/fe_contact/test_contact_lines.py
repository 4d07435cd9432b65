"""Contact lines: what slices and points keep exactly, and how fast the ripple of helical pairs converges."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair, Run
from fe_contact.analysis.pairs.operating_points import OperatingPoint, operating_points
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.tables import condensed_bodies
from fe_contact.contact import ContactModel, PatchRule, Slices, contact_candidates, solve_contact
from model_studies.stage_clock import StageClock

LOAD = np.array([2500.0])
POSITIONS = 16
SOURCE = "the same bodies in more slices"
HELIX = math.radians(22.0)


def pair(helix: float, **shape: float) -> GearPair:
    gears = [
        Gear(teeth, 1.8e-3, 30e-3, 20e-3, helix_angle=hand * helix, modification=FlankModification(**shape))
        for teeth, hand in ((33, 1), (33, -1))
    ]
    return GearPair(*gears)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 15])
def test_a_curve_through_the_means_of_slices_keeps_parabolas_and_forces_their_moments(count):
    slices = Slices.of_pair(pair(HELIX), count, 6)
    (curves, heights), z = slices.curves, slices.point_center
    blend = curves @ heights
    assert (np.count_nonzero(curves, axis=1) <= 3).all()
    for degree in range(min(count, 3)):
        power = degree + 1
        low, high = slices.center - 0.5 * slices.width, slices.center + 0.5 * slices.width
        means = (high**power - low**power) / (power * slices.width)
        assert blend @ means == pytest.approx(z**degree, rel=1e-10, abs=1e-12 * slices.center[-1] ** degree)
    force = np.random.default_rng(1).uniform(size=z.size)
    assert (force @ blend).sum() == pytest.approx(force.sum(), rel=1e-12)
    if count > 1:
        assert (force @ blend) @ slices.center == pytest.approx(force @ z, rel=1e-10)


def contact_of(
    shape: dict[str, float], corner: bool, cache: Path, helix: float = HELIX, level: str = "draft"
) -> OperatingPoint:
    """Bodies that all shapes share."""
    checked = check_request(
        pair(helix, **shape),
        *table_request(
            normal_forces=LOAD.tolist(), level=level, effects={"corner_contact": "on" if corner else "off"}
        ),
    )
    bodies = condensed_bodies(checked, decide(checked).plan, StageClock(), Run(cache=cache))
    return operating_points(checked.request.scene, checked.request.choices, bodies).places[0]


def deflection(place: OperatingPoint, slices: int) -> np.ndarray:
    """STE in nm."""
    contact = place.contact.in_slices(slices)
    solution = contact.solve(place.model, np.arange(POSITIONS) / POSITIONS, LOAD)[1]
    assert solution.converged
    return np.asarray(1e9 * solution.deflection[:, 0])


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("bodies")


def test_the_reference_length_parts_and_does_not_decide(cache):
    """A pair that presses on one slice moves the same, whatever part of its load's near field is local."""
    place = contact_of({}, True, cache, 0.0)
    problem = place.contact.problem(place.model, np.arange(8) / 8)
    slices = problem.candidates.slices
    shorter = replace(problem.candidates, slices=replace(slices, law_length=0.6 * slices.law_length))
    found, other = (solve_contact(each, LOAD) for each in (problem, problem.touching(shorter)))
    assert slices.pair.size == problem.candidates.pair.size
    assert other.deflection == pytest.approx(found.deflection, rel=1e-11)


@pytest.mark.law
@pytest.mark.parametrize(
    ("corner", "shape"),
    [
        pytest.param(False, {"helix_crowning": 5e-6}, marks=pytest.mark.nightly),
        (True, {"helix_crowning": 4e-6, "profile_crowning": 5e-6}),
    ],
)
def test_ripple_converges_with_the_square_of_the_slices(corner, shape, cache, record_figure):
    """0.17 and 0.35 um of it; slices that are in or out by their middle leave 50 nm in twelve.

    On bodies with a layer for every slice: those of a draft carry no 18.
    """
    place = contact_of(shape, corner, cache, level="standard")
    exact, found, rough = (deflection(place, slices) for slices in (18, 12, 6))
    errors = [np.abs(each - each.mean() - exact + exact.mean()).max() for each in (found, rough)]
    name = f"{'with' if corner else 'without'} corner contact, {' and '.join(shape)}"
    record_figure(f"ripple in 12 slices off that in 18, {name}", errors[0], "within 15", "nm", SOURCE)
    assert errors[0] < 15.0
    assert errors[0] < 0.35 * errors[1]


@pytest.mark.parametrize("slices", [1, 2, 5])
@pytest.mark.parametrize("helix", [HELIX, 0.6])
def test_all_contact_lines_are_found(slices, helix):
    """Without corner contact they are as long, in the mean of a pitch, as epsilon_alpha of the whole face."""
    gears, count = pair(helix), 400
    position = (np.arange(count) + 0.5) / count
    lines = contact_candidates(
        gears, ContactModel(), position, PatchRule(0.3e-3, 0.02e-3), Slices.of_pair(gears, slices, 6)
    )
    length = np.where(np.isfinite(lines.gap), lines.width, 0.0).sum(axis=1).mean()
    expected = gears.transverse_contact_ratio * gears.face_width / math.cos(gears.base_helix_angle)
    assert length == pytest.approx(expected, rel=1e-4)
