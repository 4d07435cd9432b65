"""How a search ends, what it keeps and says, and what its linear programmes find."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from threading import Event
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fe_contact import DesignVariable, Estimate, Limits, Run, Search
from fe_contact.microgeometry import best_design as choice
from fe_contact.microgeometry.conclusion import outcome_and_reason
from fe_contact.microgeometry.confirmation import HarrisMap, rising
from fe_contact.microgeometry.counted_merit import Budget
from fe_contact.microgeometry.design_problem import Assessed, DesignProblem
from fe_contact.microgeometry.linear_program import LinearMerit
from fe_contact.microgeometry.objective import Objective, WeightedMean, Worst
from fe_contact.microgeometry.optimization import Outcome
from fe_contact.microgeometry.optimize import _search_one, search_all
from fe_contact.microgeometry.search import Ended, SearchRun, search_from
from fe_contact.microgeometry.search_methods import (
    EXPLORED,
    DifferentialEvolution,
    NelderMead,
    SequentialLinearProgramming,
    StagedLinearProgramming,
)
from fe_contact.types import FloatArray
from model_studies.stage_clock import StageClock
from model_studies.workers import ByExecutor, InProcess, RunCost, WorkersLost, dispatch

START = np.array([0.9, 0.1, 0.5])
BOTTOM = np.array([0.3, 0.6, 0.2])
EVOLUTION = DifferentialEvolution()


@dataclass
class Tangent:
    """A bowl to first order."""

    away: FloatArray

    def minimum(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, float]:
        step = np.where(self.away > 0.0, low, high)
        return step, 1.0 + float((self.away**2).sum() + 2.0 * self.away @ step)


@dataclass
class Bowl:
    """A problem with its minimum at `bottom`; the rough one has it a little beside, and counts for itself."""

    bottom: FloatArray = field(default_factory=BOTTOM.copy)
    seen: list[FloatArray] = field(default_factory=list)
    roughened: Bowl | None = None
    interrupt_at: int = 0
    memory: None = None

    def assess(self, place: FloatArray) -> Assessed:
        self.seen.append(place)
        if len(self.seen) == self.interrupt_at:
            raise KeyboardInterrupt
        value = 1.0 + float(((place - self.bottom) ** 2).sum())
        return Assessed(value, 0.0, value)

    def linearize(self, place: FloatArray, _workers: object) -> tuple[Assessed, Tangent]:
        return self.assess(place), Tangent(place - self.bottom)

    def rough(self, positions: int) -> Bowl:
        self.roughened = Bowl(self.bottom + 0.02)
        return self.roughened

    def unit_point(self, own: Any) -> FloatArray:
        return np.asarray(own)

    def keep(self, place: FloatArray, assessed: Assessed) -> None:
        """Remember nothing."""


def searched(bowl: Bowl, search: Search, cancel: Callable[[], bool] | None = None) -> Any:
    return search_from(cast(DesignProblem, bowl), search, START, 0, cancel=cancel)


def test_evolution_explores_roughly_and_a_simplex_settles_it():
    bowl = Bowl()
    run = searched(bowl, Search(EVOLUTION, seed=1, evaluations=3000))
    assert run.ended is Ended.CONVERGED and run.converged
    np.testing.assert_allclose(run.coordinates, BOTTOM, atol=2e-3)  # not the bottom of the rough one
    assert run.explored == len(bowl.roughened.seen) > 0.5 * run.evaluations
    assert run.evaluations == len(bowl.seen) + len(bowl.roughened.seen)


def test_the_simplex_keeps_its_part_of_the_designs():
    run = searched(Bowl(), Search(EVOLUTION, seed=1, evaluations=200))
    assert run.explored + 1 == int(EXPLORED * 200)  # the start is assessed in full
    assert run.evaluations == 200 and run.ended is Ended.SPENT
    longer = searched(Bowl(), Search(EVOLUTION, seed=1, evaluations=400))
    assert longer.assessed.objective <= run.assessed.objective


STAGED = StagedLinearProgramming(sample=16, trials=3)


def test_stages_follow_every_start_roughly_and_settle_the_best_in_full():
    bowl = Bowl()
    run = searched(bowl, Search(STAGED, seed=1))
    assert run.ended is Ended.CONVERGED and len(run.ends) == 1 + STAGED.trials
    np.testing.assert_allclose(run.coordinates, BOTTOM, atol=0.02)  # a bowl is flat at its bottom
    assert run.explored == len(bowl.roughened.seen) > 3 * len(bowl.seen)


@dataclass
class Valleys(Bowl):
    """Two bowls in one: the deeper one is away from the start."""

    roughened: Bowl | None = None

    def assess(self, place: FloatArray) -> Assessed:
        self.seen.append(place)
        near, far = (((place - bottom) ** 2).sum() for bottom in (START, self.bottom))
        value = 1.0 + float(min(near + 0.1, far))
        return Assessed(value, 0.0, value)

    def linearize(self, place: FloatArray, _workers: object) -> tuple[Assessed, Tangent]:
        assessed = self.assess(place)
        near, far = (((place - bottom) ** 2).sum() for bottom in (START, self.bottom))
        return assessed, Tangent(place - (START if near + 0.1 < far else self.bottom))

    def rough(self, positions: int) -> Bowl:
        return Valleys(self.bottom)


def test_stages_leave_the_valley_of_the_start_for_a_deeper_one_and_say_that_starts_differ():
    run = searched(Valleys(), Search(STAGED, seed=1))
    np.testing.assert_allclose(run.coordinates, BOTTOM, atol=0.02)
    assert max(run.ends) == pytest.approx(1.1, abs=1e-3) and min(run.ends) < 1.01


def test_stages_end_with_what_the_designs_reach():
    for evaluations in (1, 2, 5, 20, 40):
        run = searched(Bowl(), Search(STAGED, seed=1, evaluations=evaluations))
        assert run.evaluations <= evaluations and np.isfinite(run.assessed.objective)


def test_programmes_follow_the_best_of_a_sample():
    bowl = Bowl()
    run = searched(bowl, Search(SequentialLinearProgramming(sample=32, trials=2), seed=1))
    assert run.ended is Ended.CONVERGED and run.explored == 32
    np.testing.assert_allclose(run.coordinates, BOTTOM, atol=0.02)  # a bowl is flat at its bottom
    assert run.assessed.objective < 1.0 + 1e-3
    ranked = bowl.roughened
    assert ranked is not None
    best = min(tuple(ranked.seen), key=lambda place: ranked.assess(place).objective)
    assert any(np.array_equal(best, place) for place in bowl.seen)
    alone = searched(Bowl(), Search(SequentialLinearProgramming(sample=0), seed=1))
    assert alone.explored == 0 and alone.assessed.objective < 1.0 + 1e-3


@pytest.mark.parametrize("method", [DifferentialEvolution(), NelderMead(), SequentialLinearProgramming()])
@pytest.mark.parametrize("evaluations", [1, 2, 3])
def test_a_search_of_hardly_any_design_keeps_the_best(method, evaluations):
    bowl = Bowl()
    run = searched(bowl, Search(method, evaluations=evaluations))
    assert run.ended is Ended.SPENT and run.evaluations == evaluations
    assert run.assessed.objective == min(bowl.assess(place).objective for place in bowl.seen[:])


@pytest.mark.parametrize("after", [1, 20, 150])
def test_a_cancelled_search_keeps_the_best_so_far(after):
    bowl, asked = Bowl(), [0]

    def cancel():
        asked[0] += 1
        return asked[0] > after

    run = searched(bowl, Search(EVOLUTION, seed=2, evaluations=2000), cancel)
    assert run.ended is Ended.CANCELLED and run.evaluations == after
    told = Bowl().assess(run.coordinates)  # in full, whatever it was ranked by
    assert run.assessed == told
    if after > 1:
        assert told.objective < Bowl().assess(START).objective


def test_interrupted_in_a_worker_it_gives_what_it_has():
    """A Ctrl-C reaches the processes of a pool too."""
    search = Search(NelderMead(), evaluations=500)
    bowl = Bowl(interrupt_at=30)
    run = _search_one((cast(DesignProblem, bowl), search), (0, START))
    assert run.ended is Ended.CANCELLED and run.evaluations == 30
    assert run.assessed.objective == min(Bowl().assess(place).objective for place in bowl.seen[:29])
    with pytest.raises(KeyboardInterrupt):  # here it is the caller's
        searched(Bowl(interrupt_at=30), search)


@dataclass(frozen=True)
class Failing:
    """Workers that fail after some results."""

    after: int

    def run(self, function: Any, shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for count, item in enumerate(items):
            if count == self.after:
                raise RuntimeError("a worker died")
            yield function(shared, item)


def test_starts_that_have_ended_survive_an_interruption():
    search = Search(NelderMead(), starts=4, evaluations=60)
    every = search_all(
        cast(DesignProblem, Bowl()), search, tuple(START), Run(workers=InProcess()), lambda: False
    )
    assert len(every) == 4
    asked = [0]

    def once_one_ended():
        asked[0] += 1
        return asked[0] > 1

    for workers in (Failing(9), Failing(2)):  # cancelled between two, and by a dead worker
        asked[0] = 0
        kept = search_all(
            cast(DesignProblem, Bowl()), search, tuple(START), Run(workers=workers), once_one_ended
        )
        assert len(kept) == 2
        for one, whole in zip(kept, every, strict=False):
            assert one.assessed == whole.assessed
    with pytest.raises(RuntimeError):
        search_all(cast(DesignProblem, Bowl()), search, tuple(START), Run(workers=Failing(2)), lambda: False)


@pytest.mark.parametrize("workers", [InProcess(), Failing(0)])
def test_cancelled_before_the_first_design_the_start_is_left(workers):
    (run,) = search_all(
        cast(DesignProblem, Bowl()), Search(), tuple(START), Run(workers=workers), lambda: True
    )
    np.testing.assert_array_equal(run.coordinates, START)
    assert run.ended is Ended.CANCELLED and run.evaluations == 1


@pytest.mark.law
@pytest.mark.parametrize(
    "method",
    [SequentialLinearProgramming(sample=4, trials=2), StagedLinearProgramming(sample=4, trials=2)],
    ids=["each", "staged"],
)
def test_walks_by_others_end_for_the_same_reason(method, monkeypatch):
    """Whatever the number of designs: also where a walk by itself ends with the last of them."""
    monkeypatch.setattr(dispatch, "START_SECONDS", -1.0)
    with ThreadPoolExecutor(1) as one, ThreadPoolExecutor(2) as two:
        reasons = set()
        for evaluations in range(1, 150):
            search = Search(method, evaluations=evaluations)
            here, *others = (
                search_from(cast(DesignProblem, Bowl()), search, START, 0, workers=workers)
                for workers in (InProcess(), ByExecutor(one), ByExecutor(two))
            )
            reasons.add(here.ended)
            for run in others:
                np.testing.assert_array_equal(run.coordinates, here.coordinates)
                assert replace(run, coordinates=here.coordinates, cpu_seconds=here.cpu_seconds) == here
    assert reasons == {Ended.SPENT, Ended.CONVERGED}


@dataclass(frozen=True)
class Interrupted:
    """Workers that a Ctrl-C ends after some results."""

    after: int
    stop: Event = field(default_factory=Event)
    cost: RunCost = field(default_factory=lambda: RunCost(tasks=1))

    def run(self, function: Any, shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for item in items:
            if self.cost.tasks > self.after:
                self.stop.set()
                raise WorkersLost("A worker was interrupted.")
            self.cost.tasks += 1
            yield function(shared, item)


@pytest.mark.parametrize("after", [1, 3, 6])
def test_a_start_whose_workers_are_interrupted_keeps_the_best_so_far(after, monkeypatch):
    monkeypatch.setattr(dispatch, "START_SECONDS", -1.0)
    bowl, workers = cast(DesignProblem, Bowl()), Interrupted(after)
    search = Search(SequentialLinearProgramming(sample=4, trials=2))
    run = search_from(bowl, search, START, 0, cancel=workers.stop.is_set, workers=workers)
    assert run.ended is Ended.CANCELLED and run.evaluations > 0
    assert run.assessed == Bowl().assess(run.coordinates)
    with pytest.raises(WorkersLost):  # nobody requested that
        search_from(bowl, search, START, 0, cancel=lambda: False, workers=Interrupted(after))


@dataclass(frozen=True)
class Places:
    """An evaluator that is nothing but its positions."""

    position: FloatArray

    def at(self, position: FloatArray) -> Places:
        return Places(position)


CONVERGED = SearchRun(np.array([0.5]), Assessed(1e-6, 0.0, 1.0), 10, Ended.CONVERGED, 0.0)
VARIABLE = DesignVariable("pinion.profile_slope", -1e-6, 1e-6)


@pytest.mark.parametrize(
    ("exceeded", "rounds"), [([0.0], 0), ([0.02, 0.0], 1), ([0.02, 0.01, 0.001], 2), ([0.02] * 9, 3)]
)
def test_positions_of_every_analysis_join_until_the_limits_are_kept(exceeded, rounds, monkeypatch):
    searched: list[list[float]] = []
    confirmed = iter([(0.0, 0.9), *((violation, 0.1 * k) for k, violation in enumerate(exceeded, 1))])

    def confirm(*_):
        violation, place = next(confirmed)
        return SimpleNamespace(violation=violation, harris_map=SimpleNamespace(position=np.array([place])))

    def search_from(problem, *_, **__):
        searched.append(problem.evaluator.position.tolist())
        return CONVERGED

    monkeypatch.setattr(choice, "confirm", confirm)
    monkeypatch.setattr(choice, "search_from", search_from)
    problem = DesignProblem(
        cast(Any, Places(np.array([0.0, 0.5]))), (VARIABLE,), Limits(), 1.0, objective=WeightedMean()
    )
    asked: Any = SimpleNamespace(start_design=(0.0,), search=Search(), grid={}, limits=Limits())
    checked = SimpleNamespace(predicted=lambda *_: SimpleNamespace(cpu_seconds=0.0))
    study: Any = SimpleNamespace(decision=SimpleNamespace(checked=checked, plan=None))
    found = choice.choose(problem, (CONVERGED,), asked, study, StageClock(), Run(), lambda: False)
    places = [0.1 * k for k in range(1, rounds + 1)]
    assert searched == [sorted([0.0, 0.5, *places[: k + 1]]) for k in range(rounds)]
    assert len(found.runs) == rounds + 1 and found.best == rounds
    assert found.optimum.violation == exceeded[rounds]


UM = 1e-6


def harris(*ripples: float) -> HarrisMap:
    """Return the map of ripples in µm at 20, 50 and 80 N m, each known to 0.01 µm."""
    ripple, error = np.array(ripples) * UM, np.full(3, 0.01 * UM)
    torque, position = np.array([20.0, 50.0, 80.0]), np.arange(2.0)
    ste = np.zeros((2, 3))
    return HarrisMap(torque, position, ste, ripple, error, ripple[None], error[None], np.ones(1))


def concluded(after: HarrisMap, objective: float = 0.2, violation: float = 0.0) -> tuple[Outcome, str]:
    """Return the conclusion of a search from 0.042, 0.2 and 0.3 µm."""

    def design(table, value, over=0.0):
        return SimpleNamespace(
            harris_map=table, objective=Estimate(value * UM, 0.01 * UM, "m"), violation=over
        )

    run = SearchRun(np.array([0.5]), Assessed(0.2 * UM, 0.0, 1.0), 10, Ended.CONVERGED, 0.0)
    designs = {"start": design(BEFORE, 0.3), "optimum": design(after, objective, violation)}
    choice = SimpleNamespace(runs=(run,), run=run, **designs)
    request = SimpleNamespace(search=Search(), outside=(), objective=WeightedMean())
    return outcome_and_reason(cast(Any, choice), cast(Any, request))


BEFORE = harris(0.042, 0.2, 0.3)


@pytest.mark.parametrize(
    ("after", "worse"),
    [((0.042, 0.1, 0.2), []), ((0.0619, 0.1, 0.2), []), ((0.0621, 0.1, 0.2), [0]), ((0.1, 0.3, 0.2), [0, 1])],
)
def test_a_ripple_rises_if_it_does_by_more_than_both_errors(after, worse):
    assert rising(BEFORE, harris(*after)).tolist() == worse


def test_the_reason_names_the_torques_that_get_worse():
    outcome, reason = concluded(harris(0.123, 0.25, 0.2))
    assert outcome is Outcome.IMPROVED
    assert "falls by 0.1 µm" in reason
    assert "it rises at 20, 50 N m, most at 20 N m from 0.042 to 0.123 µm" in reason
    assert "rises" not in concluded(harris(0.042, 0.1, 0.2))[1]


@pytest.mark.parametrize(("objective", "violation"), [(0.3, 0.0), (0.2, 0.5)])
def test_it_does_so_whatever_the_outcome(objective, violation):
    _, reason = concluded(harris(0.123, 0.1, 0.2), objective, violation)
    assert "it rises at 20 N m" in reason


DIMENSIONS, NODES, POSITIONS, LOADS = 3, 2, 20, 2
LOW, HIGH = np.full(DIMENSIONS, -0.2), np.array([0.2, 0.1, 0.0])


def some_merit(objective: Objective, seed: int, limits: int = 1) -> LinearMerit:
    rng = np.random.default_rng(seed)
    rows = tuple((rng.normal(size=9) - 1.0, rng.normal(size=(9, DIMENSIONS))) for _ in range(limits))
    return LinearMerit(
        5.0 + rng.normal(size=(NODES, POSITIONS, LOADS)),
        rng.normal(size=(NODES, POSITIONS, LOADS, DIMENSIONS)),
        np.array([0.25, 0.75]),
        objective.rows(LOADS),
        rows,
        10.0,
    )


def merit_at(merit: LinearMerit, step: np.ndarray) -> float:
    """Merit at a step, without any program."""
    ripple = np.ptp(merit.curves + merit.by @ step, axis=1)
    found = float((merit.load_weight @ (merit.node_weight @ ripple)).max())
    for rows, by in merit.limits:
        found += merit.penalty * max(0.0, float((rows + by @ step).max()))
    return found


@pytest.mark.parametrize("objective", [WeightedMean((1.0, 3.0)), Worst()])
@pytest.mark.parametrize("seed", range(5))
def test_the_least_is_that_of_the_merit_itself(objective, seed):
    merit = some_merit(objective, seed)
    step, promised = merit.minimum(LOW, HIGH)
    assert ((step >= LOW - 1e-9) & (step <= HIGH + 1e-9)).all()
    assert promised == pytest.approx(merit_at(merit, step), rel=1e-7)
    rng = np.random.default_rng(seed)
    others = rng.uniform(LOW, HIGH, size=(2000, DIMENSIONS))
    assert min(merit_at(merit, other) for other in others) >= promised - 1e-7


def test_objectives_are_the_largest_of_their_rows():
    expected = np.array([2.0, 5.0, 1.0])
    for objective in (WeightedMean(), WeightedMean((1.0, 0.0, 2.0)), Worst()):
        assert (objective.rows(3) @ expected).max() == pytest.approx(objective.of(expected), rel=1e-12)


@pytest.mark.law
def test_the_part_done_is_that_of_a_usual_search_not_that_of_all_designs_allowed():
    told: list[float] = []
    budget = Budget(1000, lambda: False, told.append, 50.0)
    for _ in range(80):
        budget.take(1000)
        budget.tell(1.0)
    assert told[24] == 0.5
    assert np.diff(told).min() > -1e-12 and told[-1] == pytest.approx(1.0 / 1.1)  # a tail is left
    short = Budget(10, lambda: False, told.append, 50.0)
    for _ in range(10):
        short.take(10)
        short.tell(1.0)
    assert told[-1] == 1.0
