"""How a search ends, what it keeps, and how it shares its designs between exploring and settling."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import pytest

from fe_contact.microgeometry.design_problem import Assessed, DesignProblem
from fe_contact.microgeometry.optimize import _search_all, _search_one
from fe_contact.microgeometry.search import (
    EXPLORED,
    DifferentialEvolution,
    Ended,
    NelderMead,
    Search,
    SequentialLinearProgramming,
    search_from,
)
from fe_contact.options import Run
from fe_contact.types import FloatArray
from fe_contact.workers import InProcess

START = np.array([0.9, 0.1, 0.5])
BOTTOM = np.array([0.3, 0.6, 0.2])
EVOLUTION = DifferentialEvolution()


@dataclass
class Tangent:
    """A bowl to first order."""

    away: FloatArray

    def least(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, float]:
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

    def linearize(self, place: FloatArray) -> tuple[Assessed, Tangent]:
        return self.assess(place), Tangent(place - self.bottom)

    def rough(self, positions: int) -> Bowl:
        self.roughened = Bowl(self.bottom + 0.02)
        return self.roughened

    def place(self, own: Any) -> FloatArray:
        return np.asarray(own)


def searched(bowl: Bowl, search: Search, cancel: Callable[[], bool] | None = None) -> Any:
    return search_from(cast(DesignProblem, bowl), search, START, 0, cancel=cancel)


def test_evolution_explores_roughly_and_a_simplex_settles_it() -> None:
    bowl = Bowl()
    run = searched(bowl, Search(EVOLUTION, seed=1, evaluations=3000))
    assert run.ended is Ended.CONVERGED and run.converged
    np.testing.assert_allclose(run.place, BOTTOM, atol=2e-3)  # not the bottom of the rough one
    assert bowl.roughened is not None
    assert run.explored == len(bowl.roughened.seen) > 0.5 * run.evaluations
    assert run.evaluations == len(bowl.seen) + len(bowl.roughened.seen)


def test_the_simplex_keeps_its_part_of_the_designs() -> None:
    run = searched(Bowl(), Search(EVOLUTION, seed=1, evaluations=200))
    assert run.explored + 1 == int(EXPLORED * 200)  # the start is assessed in full
    assert run.evaluations == 200 and run.ended is Ended.SPENT
    longer = searched(Bowl(), Search(EVOLUTION, seed=1, evaluations=400))
    assert longer.assessed.objective <= run.assessed.objective


def test_programmes_follow_the_best_of_a_sample() -> None:
    bowl = Bowl()
    run = searched(bowl, Search(SequentialLinearProgramming(sample=32, trials=2), seed=1))
    assert run.ended is Ended.CONVERGED and run.explored == 32
    np.testing.assert_allclose(run.place, BOTTOM, atol=0.02)  # a bowl is flat to first order at its bottom
    assert run.assessed.objective < 1.0 + 1e-3
    ranked = bowl.roughened
    assert ranked is not None
    best = min(tuple(ranked.seen), key=lambda place: ranked.assess(place).objective)
    assert any(np.array_equal(best, place) for place in bowl.seen)
    alone = searched(Bowl(), Search(SequentialLinearProgramming(sample=0), seed=1))
    assert alone.explored == 0 and alone.assessed.objective < 1.0 + 1e-3


@pytest.mark.parametrize("method", [DifferentialEvolution(), NelderMead(), SequentialLinearProgramming()])
@pytest.mark.parametrize("evaluations", [1, 2, 3])
def test_a_search_of_hardly_any_design_keeps_the_best(method: Any, evaluations: int) -> None:
    bowl = Bowl()
    run = searched(bowl, Search(method, evaluations=evaluations))
    assert run.ended is Ended.SPENT and run.evaluations == evaluations
    assert run.assessed.objective == min(bowl.assess(place).objective for place in bowl.seen[:])


@pytest.mark.parametrize("after", [1, 20, 150])
def test_a_cancelled_search_keeps_the_best_so_far(after: int) -> None:
    bowl, asked = Bowl(), [0]

    def cancel() -> bool:
        asked[0] += 1
        return asked[0] > after

    run = searched(bowl, Search(EVOLUTION, seed=2, evaluations=2000), cancel)
    assert run.ended is Ended.CANCELLED and run.evaluations == after
    told = Bowl().assess(run.place)  # in full, whatever it was ranked by
    assert run.assessed == told
    if after > 1:
        assert told.objective < Bowl().assess(START).objective


def test_interrupted_in_a_worker_it_gives_what_it_has() -> None:
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


def test_starts_that_have_ended_survive_an_interruption() -> None:
    search = Search(NelderMead(), starts=4, evaluations=60)
    every = _search_all(
        cast(DesignProblem, Bowl()), search, tuple(START), Run(workers=InProcess()), lambda: False
    )
    assert len(every) == 4
    asked = [0]

    def once_one_ended() -> bool:
        asked[0] += 1
        return asked[0] > 1

    for workers in (Failing(9), Failing(2)):  # cancelled between two, and by a dead worker
        asked[0] = 0
        kept = _search_all(
            cast(DesignProblem, Bowl()), search, tuple(START), Run(workers=workers), once_one_ended
        )
        assert len(kept) == 2
        for one, whole in zip(kept, every, strict=False):
            assert one.assessed == whole.assessed
    with pytest.raises(RuntimeError):
        _search_all(cast(DesignProblem, Bowl()), search, tuple(START), Run(workers=Failing(2)), lambda: False)


@pytest.mark.parametrize("workers", [InProcess(), Failing(0)])
def test_cancelled_before_the_first_design_the_start_is_left(workers: Any) -> None:
    (run,) = _search_all(
        cast(DesignProblem, Bowl()), Search(), tuple(START), Run(workers=workers), lambda: True
    )
    np.testing.assert_array_equal(run.place, START)
    assert run.ended is Ended.CANCELLED and run.evaluations == 1
