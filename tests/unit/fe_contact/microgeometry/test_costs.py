"""The cost of a study is that of all who worked on it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from analysis_requests import design_request

from fe_contact import GearPair
from fe_contact.microgeometry.optimize import optimize
from fe_contact.microgeometry.search import NelderMead, Search
from fe_contact.microgeometry.tolerance_study import Sampling, Tolerances, scatter
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.options import AnalysisOptions, Run
from fe_contact.workers import RunCost
from fe_contact.workers.executor import _Done

DRAFT: dict[str, Any] = {"level": "draft", "model": "plane_strain"}
DEAR = 1000.0


@dataclass(frozen=True)
class DearWorkers:
    """Others, who take 1000 CPU s for every task."""

    cost: RunCost = field(default_factory=RunCost)

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for item in items:
            yield self.cost.add(_Done(function(shared, item), DEAR, 0))


def test_searches_by_workers_are_in_the_cost_of_an_optimization(
    long_reliefs: GearPair, compliances: Path
) -> None:
    relief = DesignVariable("pinion.tip_relief", 0.0, 60e-6)
    search = Search(NelderMead(), evaluations=4, positions=16, exploration=8, starts=2)
    workers = DearWorkers()
    request = design_request(long_reliefs, [100.0], (relief,), search=search, map_torques=[100.0], **DRAFT)
    result = optimize(request, Run(workers, compliances))
    assert workers.cost.tasks == 2
    assert 2.0 * DEAR < result.cost["cpu_seconds"] < 3.0 * DEAR
    assert result.cost["stages"]["search"]["cpu_seconds"] > 2.0 * DEAR


def test_samples_by_workers_are_in_the_cost_of_a_tolerance_study(pair: GearPair, compliances: Path) -> None:
    workers, slope = DearWorkers(), Tolerances(0.0, {"pinion.profile_slope": 10e-6})
    sampling = Sampling(samples=20, seed=3, positions=16)
    result = scatter(pair, [100.0], slope, sampling, AnalysisOptions(**DRAFT), Run(workers, compliances))
    assert result.cost["cpu_seconds"] > workers.cost.cpu_seconds >= DEAR
