"""A table that breaks a law of mechanics is no result: planted breaks fail it, tables as solved do not."""

import copy
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from analysis_requests import table_request
from spur_gears import GEAR, PAIR, gear

from bounds import PlausibilityWarning
from fe_contact import FlankGrid, FlankModification, GearPair, Material, ToothFlank, analyze
from fe_contact.analysis.checks.neighbors import approach_steps
from fe_contact.analysis.checks.table_laws import TOUCH, check_laws, require_laws
from fe_contact.analysis.database import compute_database
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.tables import SolvedTable, solve_table
from fe_contact.contact import solve_contact
from fe_contact.errors import SolveError
from fe_contact.geometry import PitchDeviation
from fe_contact.options import Run
from model_studies.stage_clock import StageClock

pytestmark = pytest.mark.usefixtures("coarse_sectors")

RELIEVED = replace(GEAR, modification=FlankModification(tip_relief=8e-6, tip_relief_length=1e-3))
THREE_LOADS = {"torques": [10.0, 100.0, 400.0], "level": "draft", "positions": 256}
SPOT = 56
"""A position at which two pairs carry, edges apart."""
SKEWED = {"torques": [50.0, 200.0], "misalignments": [0.0, 20e-6], "level": "draft", "positions": 16}
UNEVEN = replace(GEAR, pitch_deviation=PitchDeviation(5e-6 * np.sin(np.arange(20.0))))


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("compliance")


def solved(pair: GearPair, cache: Path, **asked: Any) -> SolvedTable:
    run = Run(cache=cache)
    return solve_table(check_request(pair, *table_request(**asked)), StageClock(run.workers.cost), run)


@pytest.fixture(scope="module")
def relieved(cache):
    return solved(GearPair(RELIEVED, GEAR), cache, **THREE_LOADS)


def assert_lawful(made: SolvedTable) -> None:
    support = [each.solution for each in made.support]
    require_laws(check_laws(made.table, made.places.places, made.solved, support), made.table)


@dataclass(frozen=True)
class Break:
    """A fault planted in arrays of a table or of its contact: the law it breaks, what it does."""

    law: str
    plant: Callable[[dict[str, np.ndarray], np.ndarray], None]


def _into(
    name: str, change: Callable[[np.ndarray], Any]
) -> Callable[[dict[str, np.ndarray], np.ndarray], None]:
    """Return a fault at one position and the middle load of an array of the table."""

    def plant(arrays, _force):
        place = arrays[name][SPOT] if name == "no_load_transmission_error" else arrays[name][SPOT, 1]
        place[...] = change(place)

    return plant


def _exchanged(arrays: dict[str, np.ndarray], _force: np.ndarray) -> None:
    ste = arrays["static_transmission_error"]
    ste[SPOT, [0, 1]] = ste[SPOT, [1, 0]]


def _same_at_two_loads(arrays: dict[str, np.ndarray], _force: np.ndarray) -> None:
    ste = arrays["static_transmission_error"]
    ste[SPOT, 1] = ste[SPOT, 0]


def _pulling(_arrays: dict[str, np.ndarray], force: np.ndarray) -> None:
    force[SPOT, 1] = force[SPOT, 1].sum() * np.array([1.1, -0.1, *np.zeros(force.shape[2] - 2)])


def _unbalanced(_arrays: dict[str, np.ndarray], force: np.ndarray) -> None:
    force[SPOT, 1] *= 1.0 + 1e-6


def _pulling_share(arrays: dict[str, np.ndarray], _force: np.ndarray) -> None:
    share = arrays["load_share"][SPOT, 1, 0, 0]
    share += 0.1 * (np.arange(share.size) == share.argmax()) - 0.1 * (np.arange(share.size) == share.argmin())


def _low_pressure(arrays: dict[str, np.ndarray], _force: np.ndarray) -> None:
    for name in ("max_pressure", "edge_pressure"):
        arrays[name][SPOT, 1] *= 0.3


def _spike(arrays: dict[str, np.ndarray], _force: np.ndarray) -> None:
    """All loads and the curve without load together, by less than the relief could."""
    arrays["static_transmission_error"][SPOT] += 3e-6
    arrays["support_transmission_error"][SPOT] += 3e-6
    arrays["no_load_transmission_error"][SPOT] += 3e-6


BREAKS = {
    "the curve without load falls below the flanks": Break(
        "lifting of rigid gears", _into("no_load_transmission_error", lambda x: x - 0.1e-6)
    ),
    "the curve without load rises above the relief": Break(
        "lifting of rigid gears", _into("no_load_transmission_error", lambda x: x + 20e-6)
    ),
    "a deflection of more than one pair": Break(
        "lifting under load", _into("static_transmission_error", lambda x: 3.0 * x + 16e-6)
    ),
    "a deflection below the flanks": Break(
        "lifting under load", _into("static_transmission_error", lambda x: -x)
    ),
    "no number": Break("lifting under load", _into("static_transmission_error", lambda x: np.nan * x)),
    "less under more load": Break("rise with load", _exchanged),
    "one deflection under two loads": Break("rise with load", _same_at_two_loads),
    "a mesh that softens with load": Break(
        "stiffening with load", _into("static_transmission_error", lambda x: 1.3 * x)
    ),
    "a tangent of another curve": Break(
        "stiffening with load", _into("tangent_compliance", lambda x: 0.5 * x)
    ),
    "a contact that pulls": Break("contacts push", _pulling),
    "forces beyond the torque": Break("balance of moments", _unbalanced),
    "an equilibrium that is not": Break("balance of moments", _into("residuals", lambda x: x + 1e-6)),
    "shares of less than the load": Break("shares of the load", _into("load_share", lambda x: 0.99 * x)),
    "a negative share": Break("contacts push", _pulling_share),
    "a centroid beside the face": Break("load within the face", _into("face_centroid", lambda x: x + 13e-3)),
    "pressure that does not carry": Break("pressure carries the load", _low_pressure),
    "a spike in one position": Break("continuity over positions", _spike),
}


def planted(made: SolvedTable, fault: Break) -> SolvedTable:
    table = copy.copy(made.table)
    arrays = {name: getattr(table, name).copy() for name in table.stored}
    (problem, solution), *others = made.solved
    force = solution.force.copy()
    fault.plant(arrays, force)
    for name, values in arrays.items():
        object.__setattr__(table, name, values)
    return replace(made, table=table, solved=[(problem, replace(solution, force=force)), *others])


@pytest.mark.parametrize("fault", BREAKS.values(), ids=BREAKS)
def test_a_planted_break_fails_by_law_place_and_numbers(relieved, fault):
    broken = planted(relieved, fault)
    with pytest.raises(SolveError, match=f"{fault.law}: .* is .* at position .*, bound ") as refused:
        assert_lawful(broken)
    assert refused.value.partial is broken.table


def test_every_law_has_a_planted_break(relieved):
    laws = {law.law for law in check_laws(relieved.table, relieved.places.places, relieved.solved)}
    assert laws - {"continuity without load"} == {fault.law for fault in BREAKS.values()}


@pytest.mark.parametrize(
    ("pair", "asked"),
    [
        (PAIR, THREE_LOADS),
        (PAIR, THREE_LOADS | {"torques": [1e-3, 0.1, 4000.0]}),
        (GearPair(GEAR, RELIEVED), THREE_LOADS | {"center_distance_changes": [0.0, 0.1e-3]}),
        (GearPair(UNEVEN, GEAR), THREE_LOADS),
        (PAIR, SKEWED),
        (GearPair(gear(helix_angle=0.3), gear(31, helix_angle=-0.3)), SKEWED),
    ],
    ids=["plain", "light and heavy", "relieved", "uneven pitches", "misaligned", "helical"],
)
def test_tables_as_solved_obey_all_laws(pair, asked, cache):
    assert_lawful(solved(pair, cache, **asked))


def test_a_run_whose_table_breaks_a_law_fails_with_it(relieved, cache, monkeypatch):
    broken = planted(relieved, BREAKS["a deflection below the flanks"])
    monkeypatch.setattr(compute_database, "solve_table", lambda *_, **__: broken)
    for tolerance in (None, 0.02):
        asked = (
            THREE_LOADS if tolerance is None else {"torques": THREE_LOADS["torques"], "tolerance": tolerance}
        )
        with pytest.raises(SolveError, match="breaks a law of mechanics") as refused:
            analyze(GearPair(RELIEVED, GEAR), cache=cache, **asked)
        assert refused.value.partial is broken.table


def test_the_receipt_says_how_near_each_law_is_to_its_bound(cache):
    laws = analyze(PAIR, cache=cache, **THREE_LOADS).metadata.receipt["laws"]
    assert len(laws) >= 10
    assert all(0.0 <= law["ratio"] <= 1.0 for law in laws)
    ratio = {law["law"]: law["ratio"] for law in laws}
    # one pair carries all: bound and deflection differ by the strip alone, which is a few per cent of it
    assert 0.9 < ratio["lifting under load"] < 1.0
    assert ratio["rise with load"] > 0.9


EDGE_BREAK = ((5.0, 21.5, 22.3, 22.6, 22.85), (0.0, -4.0, -5.5, -5.0, 13.8))
"""Roll lengths in mm and what is removed in um: the end of a measured trace at its tip."""


def test_a_trace_on_one_tooth_never_lifts_by_more_than_it_is_high(cache):
    roll, removed = (np.array(values) for values in EDGE_BREAK)
    grid = FlankGrid(tuple(1e-3 * roll), (-12e-3, 12e-3), tuple((1e-6 * x, 1e-6 * x) for x in removed))
    asked: Any = {"torques": [200.0], "level": "draft"}
    rough = GearPair(GEAR, replace(GEAR, tooth_flanks=(ToothFlank(tooth=3, flank_grid=grid),)))
    table = analyze(rough, cache=cache, **asked)
    plain = analyze(PAIR, cache=cache, **asked).static_transmission_error
    assert np.ptp(table.static_transmission_error) < np.ptp(removed) * 1e-6 + plain.max()


def test_a_jump_to_the_next_crest_is_no_more_than_its_curvature_makes_it(cache):
    """The strip of a crest is narrower: two cylinders approach by p/(pi E*) ln of the ratio of curvatures."""
    small = gear(51, normal_module=1e-3, face_width=15e-3, bore_diameter=20e-3)
    ends = small.form_roll_length, small.tip_roll_length
    removed = np.zeros(24)
    removed[-6:] = 1e-6 * np.array([-1.0, -3.0, -5.4, -2.0, 5.0, 13.8])
    grid = FlankGrid(tuple(np.linspace(*ends, 24)), (-7.5e-3, 7.5e-3), tuple((x, x) for x in removed))
    pair = GearPair(replace(small, tooth_flanks=(ToothFlank(tooth=2, flank_grid=grid),)), small)
    run = solved(pair, cache, torques=[10.0], level="draft")
    assert_lawful(run)
    problem, solution = run.solved[0]
    steps = approach_steps(run.places.places[0].contact.pair, problem, len(run.table.position), solution.load)
    curve = run.table.static_transmission_error[:, 0, 0, 0]
    assert np.abs(np.diff(curve)).max() > 20e-9  # there is a jump, at nodes 0.1 mm apart
    assert 20e-9 < steps.max() < 0.3e-6


def test_a_contact_at_the_edge_of_flanks_that_open_never_softens(cache):
    """Hollow flanks touch at the edge of the mate where plain flanks touch inside."""
    hollow = tuple(ToothFlank(tooth=t, profile_form=-3e-6 * (t % 5)) for t in range(2, 21))
    pair = GearPair(replace(GEAR, tooth_flanks=hollow), GEAR)
    made = solved(pair, cache, torques=[100.0], level="draft", positions=256)
    point, position = made.places.places[0], made.solved[0][0].candidates.position
    problem = point.contact.problem(point.model, position, np.repeat(np.arange(20), position.size))
    touch, load = problem.candidates.touch, np.geomspace(0.01, 1.0, 8)
    solution = solve_contact(problem, load)
    alone = (solution.force > 0.0).sum(axis=(1, 2)) == load.size
    opening = (touch.slope != 0.0) & (touch.lever_1 == 1.0) & (touch.lever_2 == 1.0)
    at_edge = ((solution.force[:, -1] > 0.0) & opening).any(axis=1)
    tangent = solution.tangent[alone & at_edge]
    assert len(tangent) > 0
    assert np.all(np.diff(tangent, axis=1) < 1e-9 * tangent[:, 1:])


def test_a_patch_leaves_its_edge_without_a_step_of_the_curve(cache):
    """A soft wheel is tilted so much that a step of the tilt by 2 % was one of the curve by 0.06 um."""
    steel = gear(51, normal_module=1e-3, face_width=15e-3, bore_diameter=33e-3, tip_diameter=52.894e-3)
    plastic = Material(youngs_modulus=2.282e9, poissons_ratio=0.3)
    soft = gear(
        52,
        normal_module=1e-3,
        face_width=15e-3,
        bore_diameter=33e-3,
        tip_diameter=53.788e-3,
        profile_shift_coefficient=0.011,
        material=plastic,
    )
    pair = GearPair(replace(steel, profile_shift_coefficient=-0.2033), soft, 52e-3)
    asked: Any = {"torques": [15.7], "level": "standard", "model": "plane_strain"}
    with pytest.warns(PlausibilityWarning):
        analyze(pair, cache=cache, **asked)  # raises where a law is broken


def test_a_light_load_forgives_the_accuracy_of_the_gaps_and_no_more(cache):
    """Under some newtons an error of the gaps of 1 nm is a per cent of the deflection."""
    made = solved(GearPair(RELIEVED, GEAR), cache, torques=[0.1], level="draft", positions=16)

    def lifted(height):
        rigid = made.table.no_load_transmission_error + height
        return replace(made, table=replace(made.table, no_load_transmission_error=rigid))

    assert_lawful(lifted(0.5 * TOUCH))
    with pytest.raises(SolveError, match="rise with load"):
        assert_lawful(lifted(5.0 * TOUCH))
