"""A search that makes another load worse says so: torques where the ripple rises beyond both errors."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fe_contact.microgeometry.confirmation import HarrisMap, rising
from fe_contact.microgeometry.design_problem import Assessed
from fe_contact.microgeometry.optimization import Outcome
from fe_contact.microgeometry.optimize import _conclusion
from fe_contact.microgeometry.search import Ended, Search, SearchRun
from fe_contact.types import Estimate

UM = 1e-6


def harris(*ripples: float) -> HarrisMap:
    """Return the map of ripples in um at 20, 50 and 80 N m, each known to 0.01 um."""
    ripple, error = np.array(ripples) * UM, np.full(3, 0.01 * UM)
    torque, position = np.array([20.0, 50.0, 80.0]), np.arange(2.0)
    ste = np.zeros((2, 3))
    return HarrisMap(torque, position, ste, ripple, error, ripple[None], error[None], np.ones(1))


def concluded(after: HarrisMap, objective: float = 0.2, violation: float = 0.0) -> tuple[Outcome, str]:
    """Return the conclusion of a search from 0.042, 0.2 and 0.3 um."""

    def design(table: HarrisMap, value: float, over: float = 0.0) -> Any:
        return SimpleNamespace(
            harris_map=table, objective=Estimate(value * UM, 0.01 * UM, "m"), violation=over
        )

    run = SearchRun(np.array([0.5]), Assessed(0.2 * UM, 0.0, 1.0), 10, Ended.CONVERGED, 0.0)
    designs = {"start": design(BEFORE, 0.3), "optimum": design(after, objective, violation)}
    choice = SimpleNamespace(runs=(run,), run=run, **designs)
    request = SimpleNamespace(search=Search(), outside=())
    return _conclusion(cast(Any, choice), cast(Any, request))


BEFORE = harris(0.042, 0.2, 0.3)


@pytest.mark.parametrize(
    ("after", "worse"),
    [((0.042, 0.1, 0.2), []), ((0.0619, 0.1, 0.2), []), ((0.0621, 0.1, 0.2), [0]), ((0.1, 0.3, 0.2), [0, 1])],
)
def test_a_ripple_rises_if_it_does_by_more_than_both_errors(
    after: tuple[float, ...], worse: list[int]
) -> None:
    assert rising(BEFORE, harris(*after)).tolist() == worse


def test_the_reason_names_the_torques_that_get_worse() -> None:
    outcome, reason = concluded(harris(0.123, 0.25, 0.2))
    assert outcome is Outcome.IMPROVED
    assert "falls by 0.1 um" in reason
    assert "it rises at 20, 50 N m, most at 20 N m from 0.042 to 0.123 um" in reason


@pytest.mark.parametrize(("objective", "violation"), [(0.3, 0.0), (0.2, 0.5)])
def test_it_does_so_whatever_the_outcome(objective: float, violation: float) -> None:
    _, reason = concluded(harris(0.123, 0.1, 0.2), objective, violation)
    assert "it rises at 20 N m" in reason


def test_nothing_is_said_where_nothing_rises() -> None:
    assert "rises" not in concluded(harris(0.042, 0.1, 0.2))[1]
