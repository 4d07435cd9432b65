"""The study of influence estimates counts what it says it counts."""

import pytest
from analysis_requests import table_request

from benchmarks.assessed_influence import within_factor
from benchmarks.influence_cases import influence_cases
from benchmarks.influence_estimates import STUDY, LoadedInfluence, markdown
from fe_contact.analysis.request.request_check import check_request
from fe_contact.effects import EFFECTS


@pytest.mark.parametrize(
    ("estimated", "measured", "right"),
    [(0.1, 0.19, True), (0.1, 0.21, False), (0.1, -0.1, False), (0.004, -0.009, True), (0.004, 0.011, False)],
)
def test_a_factor_of_two_is_asked_of_what_can_be_seen(estimated, measured, right):
    assert within_factor(estimated, measured) is right
    assert LoadedInfluence("", "", (estimated, 0.0), (measured, 0.0)).right == (right, True)


def test_every_effect_has_something_to_do_twice():
    times = dict.fromkeys((effect.name for effect in EFFECTS), 0)
    for case in influence_cases():
        options = {name: value for name, value in case.options.items() if name != "positions"}
        for entry in check_request(case.pair, *table_request(normal_forces=case.forces, **options)).ledger:
            times[entry.name] += entry.on
    assert min(times.values()) >= 1
    assert sum(times.values()) >= 24


def test_counts_and_tables_are_those_of_the_ablations():
    right = LoadedInfluence("one", "misalignment", (0.1, 0.2), (0.11, 0.19))
    wrong = LoadedInfluence("two", "misalignment", (0.1, 0.2), (0.11, -0.19))
    off = LoadedInfluence("two", "corner_contact", (0.001, 0.0), (0.002, 0.03), (0.05,))
    rows = {figure.what: figure for figure in STUDY.counts([right, right, wrong, off])}
    assert rows["mean or peak-to-peak beyond a factor 2"].value == pytest.approx(50.0)
    assert rows["mean: beyond a factor 2, of the 3 changes above 1 %"].value == 0.0
    left = [
        rows[f"largest change by what auto neglects at {text}"]
        for text in ("1 % (0 ablations)", "5 % (1 ablations)")
    ]
    assert [figure.value for figure in left] == pytest.approx([0.0, 3.0])
    assert all(figure.met for figure in left)
    text = markdown([right, wrong, off])
    assert "| two | misalignment | +10 / +11 | **+20 / -19** |" in text
    assert "| misalignment | 2 | 100 % | 0.91 | 50 % |" in text
