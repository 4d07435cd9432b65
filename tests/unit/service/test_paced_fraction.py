"""The fraction reported of work without a predicted cost follows the time that its stages take."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np
import pytest

from lineofaction.gearbox.stages import PacedFraction

SHARES = {"analysis": 0.5, "runs": 0.3, "confirmation": 0.2}
Reported = list[tuple[str, float, float]]
"""Stage, share of the time spent, fraction reported."""


def reported(seconds: Mapping[str, float], start_s: float = 3.0, steps: int = 200) -> Reported:
    """Report stages that take so many seconds each, evenly."""
    paced, whole, past, reports = PacedFraction(SHARES.items()), sum(seconds.values()), 0.0, []
    for stage, duration in seconds.items():
        for fraction in np.linspace(0.0, 1.0, steps):
            spent = past + fraction * duration
            done = paced.at(stage, float(fraction), start_s + spent)
            assert done is not None
            reports.append((stage, spent / whole, done))
        past += duration
    return reports


TIMES = [dict(zip(SHARES, seconds, strict=True)) for seconds in itertools.product((0.5, 5.0, 20.0), repeat=3)]


@pytest.mark.parametrize("seconds", TIMES, ids=str)
def test_the_fraction_never_falls_and_ends_at_one(seconds: dict[str, float]) -> None:
    fractions = [fraction for *_, fraction in reported(seconds)]
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("seconds", TIMES, ids=str)
def test_the_last_stage_is_right_whatever_the_shares_say(seconds: dict[str, float]) -> None:
    """After a tenth of it; more that was reported before stands until it is true."""
    reports = reported(seconds)
    before = max(fraction for stage, _, fraction in reports if stage != "confirmation")
    last = [(spent, fraction) for stage, spent, fraction in reports if stage == "confirmation"]
    for spent, fraction in last[len(last) // 10 + 1 :]:
        assert fraction == pytest.approx(max(spent, before), abs=0.1)


def test_usual_times_are_reported_as_they_are() -> None:
    for _, spent, fraction in reported({"analysis": 5.0, "runs": 3.0, "confirmation": 2.0}):
        assert fraction == pytest.approx(spent, abs=0.01)


@pytest.mark.parametrize("seconds", [{"runs": 6.0, "confirmation": 4.0}, {"confirmation": 9.0}])
def test_stages_that_are_left_out_have_no_share(seconds: dict[str, float]) -> None:
    for _, spent, fraction in reported(seconds):
        assert fraction == pytest.approx(spent, abs=0.01)


def test_an_undeclared_stage_says_nothing() -> None:
    paced = PacedFraction(SHARES.items())
    assert paced.at("meanwhile", 0.5, 1.0) is None
    assert paced.at("analysis", 0.5, 1.0) == 0.25


def test_what_a_stage_says_behind_its_name_is_no_other_stage() -> None:
    plain, telling = PacedFraction(SHARES.items()), PacedFraction(SHARES.items())
    for fraction, elapsed in ((0.0, 1.0), (0.5, 3.0), (1.0, 5.0)):
        expected = plain.at("analysis", fraction, elapsed)
        assert expected is not None
        assert telling.at("analysis; case: about 25 CPU s, 1.2 GB", fraction, elapsed) == expected
