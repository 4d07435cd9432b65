"""The study of quiet helical pairs assesses in um what has no per cent."""

from dataclasses import replace

import pytest

from benchmarks.quiet_helical import AssessedInfluence, groups, markdown, share_right
from benchmarks.quiet_helical_cases import quiet_pairs
from fe_contact.effects.influence.influence import Influence

RIPPLE = Influence(50.0, 0.0, -1e-6, 0.1e-6, 10e-6, 0.2e-6)


@pytest.mark.parametrize(
    ("estimated", "computed", "right"),
    [
        (0.1, 0.19, True),
        (0.1, 0.21, False),
        (0.01, -0.01, True),
        (0.005, 0.021, False),
        (-0.03, 0.03, False),
    ],
)
def test_below_twenty_nm_a_change_of_the_ripple_is_nothing(estimated, computed, right):
    one, other = (replace(RIPPLE, peak_to_peak=1e-6 * value) for value in (estimated, computed))
    assert AssessedInfluence(quiet_pairs()[0], "", one, other).right == (True, right)


def test_pairs_that_assess_are_told_apart():
    wrong = replace(RIPPLE, mean=1e-6)
    found = [
        AssessedInfluence(pair, "tooth_coupling", RIPPLE, wrong if pair.unseen else RIPPLE)
        for pair in quiet_pairs()
    ]
    sizes = {title: (len(group), share_right(group)) for title, group in groups(found).items()}
    assert sizes == {"unseen": (5, 0.0), "seen": (12, 100.0)}
    assert "*19/42, 16 deg* | 0.20 | tooth_coupling | **-1 / +1** | +0.1 / +0.1 |" in markdown(found)
