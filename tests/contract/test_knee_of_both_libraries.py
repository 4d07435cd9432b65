"""The knee of error against time is the same in both libraries, which do not know each other."""

from __future__ import annotations

import numpy as np

from dynamics.accuracy.knee import knee_of
from fe_contact.analysis.pareto import knee_of as knee_of_tables


def test_both_find_the_same_knee():
    rng = np.random.default_rng(5)
    found = set()
    for _ in range(200):
        points = {str(k): (float(t), float(e)) for k, (t, e) in enumerate(10.0 ** rng.normal(size=(6, 2)))}
        assert knee_of(points) == knee_of_tables(points)
        found.add(knee_of(points))
    assert len(found) > 4
