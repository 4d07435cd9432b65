"""Laws of tables over random traces on one tooth and on all but one, beside the true gaps of the flanks.

True touching points break no law; those that end where the flanks are not are detected. Bodies are springs in
closed form.
"""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from sprung_flanks import on_springs
from spur_gears import gear

from fe_contact import AnalysisOptions, FlankGrid, Gear, GearPair, TableAxes, ToothFlank
from fe_contact.analysis.checks.law import LawCheck
from fe_contact.analysis.checks.table_laws import check_laws
from fe_contact.analysis.pairs.operating_points import OperatingPoint
from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.table_fields import table_of_solution
from fe_contact.contact import ContactModel
from fe_contact.contact.flank_slope import rolls_at
from fe_contact.contact.model import MeetingTeeth
from fe_contact.contact.plain_touch import conjugate_touch
from fe_contact.errors import InputError
from fe_contact.planning.plan import make_plan

POSITIONS = np.arange(32) / 32
FORCES = [300.0, 3000.0]
NEAR = 0.02e-6
"""m: how well a touching point that breaks no law is searched for."""


def _white(random: np.random.Generator, at: np.ndarray) -> np.ndarray:
    return random.uniform(-1.0, 1.0, at.size)


def _filtered(random: np.random.Generator, at: np.ndarray) -> np.ndarray:
    return np.cos(np.pi * random.integers(1, 4) * at + random.uniform(0.0, 3.0))


def _edge_break(random: np.random.Generator, at: np.ndarray) -> np.ndarray:
    return np.where(at > random.uniform(0.9, 0.98), 1.0, 0.0)


def _step(random: np.random.Generator, at: np.ndarray) -> np.ndarray:
    return np.where(at > random.uniform(0.3, 0.7), 0.5, -0.5)


KINDS = {"white": _white, "filtered": _filtered, "edge break": _edge_break, "step": _step}


def traced(gear_: Gear, random: np.random.Generator, kind: str, teeth: int) -> Gear:
    """Return a gear with a trace of some micrometers on its first teeth, others as designed."""
    roll = np.linspace(gear_.form_roll_length, gear_.tip_roll_length, int(random.integers(8, 40)))
    at = np.linspace(0.0, 1.0, roll.size)
    removed = 10.0 ** random.uniform(-6.5, -4.8) * KINDS[kind](random, at)
    grid = FlankGrid(tuple(roll), (-0.01, 0.01), tuple((x, x) for x in removed.tolist()))
    return replace(gear_, tooth_flanks=tuple(ToothFlank(k + 1, flank_grid=grid) for k in range(teeth)))


@dataclass(frozen=True)
class Solved:
    contact: PairContact
    model: ContactModel
    pitches: np.ndarray
    no_load: np.ndarray
    laws: tuple[LawCheck, ...]


def solved(pair: GearPair) -> Solved:
    axes = TableAxes(normal_forces=FORCES, pitches=4)
    checked = check_request(pair, axes, AnalysisOptions(model="plane_strain", level="draft"))
    plan = make_plan(pair, checked.request.load, checked.request.options, checked.model)
    contact, model, pitches = on_springs(pair, plan), checked.model, np.arange(4)
    rows = np.repeat(pitches, POSITIONS.size)
    problem, solution = contact.solve(model, POSITIONS, checked.request.load, rows)
    table = table_of_solution(pair, problem, solution, POSITIONS, 0.0)
    first = replace(solution, force=solution.force[: POSITIONS.size])
    laws = check_laws(table, [OperatingPoint(contact, model)], [(problem, first)])
    return Solved(contact, model, pitches, solution.no_load, laws)


def true_no_load(case: Solved) -> np.ndarray:
    """The least gap of all pairs, by a thousand places along each flank."""
    pair = case.contact.pair
    plain = case.contact.candidates(case.model, POSITIONS)
    touch = conjugate_touch(pair, *pair.roll_lengths(POSITIONS[:, None], plain.pair), True)
    part = np.linspace(0.0, 1.0, 1001)[:, None, None]
    reach = 0.3e-3
    x = np.maximum(touch.low, -reach) * (1.0 - part) + np.minimum(touch.high, reach) * part
    rolls = rolls_at(pair, touch.s_1 + x, touch.s_2 - x)
    parted = touch.gap + x * (touch.slope + 0.5 * touch.curvature * x)
    minimum = [
        parted + case.model.gap_of_teeth(MeetingTeeth(pair, pitch - plain.pair, *rolls, np.zeros(())))
        for pitch in case.pitches
    ]
    return np.concatenate([gap.min(axis=(0, 2)) for gap in minimum])


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("teeth", [1, 23])
@pytest.mark.parametrize("side", ["pinion", "wheel"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.drawn
def test_laws_pass_true_touching_points_and_find_out_others(kind, side, teeth, seed):
    random = np.random.default_rng([seed, teeth, len(kind), len(side)])
    gears = {"pinion": gear(24), "wheel": gear(24)}
    try:
        gears[side] = traced(gears[side], random, kind, teeth)
    except InputError:
        pytest.skip("nodes that are no surface")
    case = solved(GearPair(**gears))
    error = case.no_load - true_no_load(case)
    (rigid,) = (law for law in case.laws if law.law == "lifting of rigid gears")
    broken = [law.text for law in case.laws if law.broken]
    if np.abs(error).max() < NEAR:
        assert broken == []
    span = case.model.extent(case.contact.pair, np.arange(24)).span
    if np.abs(error).max() > span + NEAR:
        assert rigid.broken
