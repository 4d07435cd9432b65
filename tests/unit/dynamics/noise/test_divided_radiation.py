"""The radiation of a housing by workers: the frequencies are tasks, the resistance is the same."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from hulls import box
from reduced_housings import bare_housing
from sounding_housings import smooth_motion, with_surface

from dynamics.acoustics import ElementalRadiators
from dynamics.noise import housing_radiation
from model_studies.host_speed import host_slowness
from model_studies.workers import InProcess, RunCost, dispatch, local_processes


@dataclass(frozen=True)
class Noting:
    """Workers that note how many tasks they get at a time."""

    sent: list[int] = field(default_factory=list)
    cost: RunCost = field(default_factory=RunCost)

    def run(self, function: Any, shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        self.sent.append(len(items))
        return (function(shared, item) for item in items)


def test_the_first_frequencies_are_sent_for_the_whole_and_later_ones_by_what_they_take(monkeypatch):
    bare, hull = bare_housing(modal=8), box((0.3, 0.2, 0.15), (6, 4, 3))
    body, costs, workers = with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness))), [], Noting()
    request = body, ElementalRadiators(), [100.0, 900.0]
    housing_radiation(*request, expected=costs.append)
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.6 * costs[0].seconds / host_slowness(None))
    computed = housing_radiation(*request, workers=workers)
    assert len(workers.sent) == 1 and 1 < workers.sent[0] < computed.frequency.size


@pytest.mark.law
def test_workers_compute_the_same_resistance_and_their_time_counts(monkeypatch):
    monkeypatch.setattr(dispatch, "START_SECONDS", 0.0)
    bare, hull = bare_housing(modal=8), box((0.3, 0.2, 0.15), (6, 4, 3))
    body, seen = with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness))), []
    with local_processes(2) as pool:
        here, there = (
            housing_radiation(body, ElementalRadiators(), [100.0, 900.0], None, seen.append, workers=workers)
            for workers in (InProcess(), pool)
        )
        assert pool.cost.tasks == here.frequency.size > 10
        assert there.metadata.cost.seconds > pool.cost.cpu_seconds > 0.0
    np.testing.assert_array_equal(there.frequency, here.frequency)
    np.testing.assert_array_equal(there.matrix, here.matrix)
    assert there.metadata.interpolation_error == here.metadata.interpolation_error
    half = len(seen) // 2
    assert seen[:half] == seen[half:] == sorted(seen[:half]) and 0.5 < seen[half - 1] <= 1.0
