"""Laws of the division of curves."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.mesh.outline import divide, middles, spread


@pytest.mark.parametrize(("start", "end"), [(0.0, 1.0), (2.0, -1.0)])
def test_ends_are_exact_and_parts_follow_the_size(start: float, end: float) -> None:
    ends = divide(start, end, lambda t: 0.01 + 0.1 * np.abs(t - end))
    assert (ends[0], ends[-1]) == (start, end)
    lengths = np.abs(np.diff(ends))
    assert np.all(np.diff(ends) * (end - start) > 0.0)
    wanted = 0.01 + 0.1 * np.abs(middles(ends) - end)
    assert lengths == pytest.approx(wanted, rel=0.05)
    assert np.all(lengths <= 1.001 * wanted)


def test_a_size_larger_than_the_interval_gives_one_part() -> None:
    assert divide(0.0, 1.0, lambda t: np.full_like(t, 5.0)).tolist() == [0.0, 1.0]


def test_a_whole_number_of_parts_stays_whole() -> None:
    assert len(divide(0.0, 1.0, lambda t: np.full_like(t, 0.1))) == 11


def test_spread_grows_from_the_nearest_source_up_to_the_largest() -> None:
    size = spread(np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([0.1, 1.0]), growth=0.2, largest=1.5)
    found = size(np.array([[0.0, 0.0], [0.0, 3.0], [10.0, 0.0], [50.0, 0.0]]))
    assert found == pytest.approx([0.1, 0.7, 1.0, 1.5])
