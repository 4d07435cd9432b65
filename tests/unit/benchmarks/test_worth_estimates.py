"""The study of worth estimates counts what it says it counts."""

from __future__ import annotations

import pytest

from benchmarks.worth_cases import worth_cases
from benchmarks.worth_estimates import JudgedWorth, within_factor
from fe_contact.analysis import check_request
from fe_contact.effects import EFFECTS


@pytest.mark.parametrize(
    ("estimated", "measured", "right"),
    [(0.1, 0.19, True), (0.1, 0.21, False), (0.1, -0.1, False), (0.004, -0.009, True), (0.004, 0.011, False)],
)
def test_a_factor_of_two_is_asked_of_what_can_be_seen(estimated: float, measured: float, right: bool) -> None:
    assert within_factor(estimated, measured) is right
    assert JudgedWorth("", "", 1.0, (estimated, 0.0), (measured, 0.0)).right == (right, True)


def test_every_effect_has_something_to_do_twice() -> None:
    times = dict.fromkeys((effect.name for effect in EFFECTS), 0)
    for case in worth_cases():
        options = {name: value for name, value in case.options.items() if name != "positions"}
        for entry in check_request(case.pair, normal_forces=case.forces, **options).ledger:
            times[entry.name] += entry.on
    assert min(times.values()) >= 1
    assert sum(times.values()) >= 24
