"""A design that keeps the limits where the search looked, and not where its full analysis does."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fe_contact.microgeometry import optimize as choice
from fe_contact.microgeometry.design_problem import Assessed, DesignProblem
from fe_contact.microgeometry.objective import Limits, WeightedMean
from fe_contact.microgeometry.search import Ended, Search, SearchRun
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class Places:
    """An evaluator that is nothing but its positions."""

    position: FloatArray

    def at(self, position: FloatArray) -> Places:
        return Places(position)


RUN = SearchRun(np.array([0.5]), Assessed(1e-6, 0.0, 1.0), 10, Ended.CONVERGED, 0.0)
VARIABLE = DesignVariable("pinion.profile_slope", -1e-6, 1e-6)


@pytest.mark.parametrize(
    ("exceeded", "rounds"), [([0.0], 0), ([0.02, 0.0], 1), ([0.02, 0.01, 0.001], 2), ([0.02] * 9, 3)]
)
def test_positions_of_every_analysis_join_until_the_limits_are_kept(
    exceeded: list[float], rounds: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    searched: list[list[float]] = []
    confirmed = iter([(0.0, 0.9), *((violation, 0.1 * k) for k, violation in enumerate(exceeded, 1))])

    def confirm(*_: Any) -> Any:
        violation, place = next(confirmed)
        return SimpleNamespace(violation=violation, harris_map=SimpleNamespace(position=np.array([place])))

    def search_from(problem: DesignProblem, *_: Any, **__: Any) -> SearchRun:
        searched.append(problem.evaluator.position.tolist())
        return RUN

    monkeypatch.setattr(choice, "confirm", confirm)
    monkeypatch.setattr(choice, "search_from", search_from)
    problem = DesignProblem(
        cast(Any, Places(np.array([0.0, 0.5]))), (VARIABLE,), WeightedMean(), Limits(), 1.0
    )
    asked: Any = SimpleNamespace(own=(0.0,), search=Search())
    found = choice._choose(problem, (RUN,), asked, cast(Any, None), StageClock(), None, lambda: False)
    places = [0.1 * k for k in range(1, rounds + 1)]
    assert searched == [sorted([0.0, 0.5, *places[: k + 1]]) for k in range(rounds)]
    assert len(found.runs) == rounds + 1 and found.best == rounds
    assert found.optimum.violation == exceeded[rounds]
