"""What counts as a good end of a random case, and what does not."""

from __future__ import annotations

import pytest
import scenes_that_break as fake
from random_cases import kind_of_end, random_request

from fe_contact.errors import InputError
from lineofaction.hardcases import Outcome

REFUSAL = str(InputError("teeth", 3, "at least 4", "Add teeth."))


@pytest.mark.parametrize(
    ("ended_by", "end"),
    [
        (f"InputError: {REFUSAL}", "refusal"),
        ("InfeasibleGeometry: undercut: pinion.tip_diameter = 1.0: must be above 2 m", "refusal"),
        ("InputError: something is wrong", "unclear"),
        (f"InputError: {REFUSAL}\nand more", "unclear"),
        (f"InputError: {REFUSAL}{'!' * 500}", "unclear"),
        ("MeshError: poor", "mesh"),
        ("SolveError: residual", "solve"),
        ("ValueError: teeth are not all condensed", "exception"),
        ("not done after its limit of 600 s", "hang"),
        ("its process ended with code -9", "crash"),
    ],
)
def test_only_a_clear_refusal_is_as_good_as_a_table(ended_by: str, end: str) -> None:
    assert kind_of_end(Outcome(fake.GOOD, (), 1.0, ended_by)) == end


def test_a_table_must_be_sound() -> None:
    assert kind_of_end(fake.GOOD.run()) == "table"
    assert kind_of_end(fake.OUT_OF_BOUNDS.run()) == "unsound"
    assert kind_of_end(fake.NO_NUMBER.run()) == "unsound"


@pytest.mark.parametrize("kind", ["plane", "face"])
def test_a_seed_is_a_case_and_cases_are_both_feasible_and_not(kind) -> None:
    ends = []
    for seed in range(60):
        try:
            first, again = random_request(kind, seed), random_request(kind, seed)
            assert first == again
            ends.append(True)
        except InputError:
            ends.append(False)
    assert 15 <= sum(ends) <= 50
