"""Between its nodes a table is within its stated error of what is solved there, and of a tolerance it met."""

import numpy as np
import pytest

from benchmarks.nodes_between import between_nodes, covered, drawn_tables, within

DAY = (0, 3)
"""A spur pair and an internal one in the plane, with loads up to five times apart."""


@pytest.mark.law
def test_drawn_tables_cover_what_is_solved_between_their_loads(tmp_path):
    drawn = list(drawn_tables(count=DAY[-1] + 1))
    check_coverage([drawn[k] for k in DAY], tmp_path, minimum=0.9)  # of ten points nine


@pytest.mark.nightly
def test_thirty_drawn_tables_cover_what_is_solved_between_their_nodes(tmp_path):
    check_coverage(list(drawn_tables()), tmp_path)


def check_coverage(drawn, cache, minimum=0.95):
    found = [between_nodes(*table, cache) for table in drawn]
    ripple, mean = (np.concatenate([getattr(one, name) for one in found]) for name in ("ripple", "mean"))
    assert covered(ripple) >= minimum
    assert covered(mean) >= 0.95
    assert np.mean([one.outside for one in found]) <= 0.05
    assert within(np.concatenate([one.ripple for one in found if one.met])) == 1.0
