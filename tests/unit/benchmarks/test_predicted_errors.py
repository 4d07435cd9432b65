"""The study of predictions compares what it says it compares."""

import numpy as np
import pytest

from benchmarks.drawn_pairs import drawn_pairs
from benchmarks.predicted_errors import compare, markdown, within
from benchmarks.stored_runs import StoredRun

HELICAL = drawn_pairs(3, 2)[1]


def run_with(total: float, mean: float | None) -> StoredRun:
    """Return a run that states 0.1 um of 10 um and 0.2 um of 1 um."""
    sources = np.zeros((6, 5, 1))
    sources[0, 0], sources[0, 1] = 0.1e-6, 0.2e-6
    error = {"total": total, "mean_m": mean, "peak_to_peak_m": mean}
    value = np.array([[10e-6], [1e-6], [0.0], [0.0], [0.0]])
    return StoredRun(value, sources, {"prediction": {"error": error}})


def test_predictions_are_held_against_the_largest_stated_error():
    found = compare(HELICAL, "draft", run_with(0.1, 0.4e-6)).ratios
    assert found == pytest.approx({"relative": 0.5, "mean": 4.0, "peak-to-peak": 2.0})
    # of the size by which the tolerance counts: 2 um
    assert compare(HELICAL, "tolerance", run_with(0.1, 0.4e-6)).ratios["relative"] == pytest.approx(1.0)


def test_what_is_not_predicted_is_not_counted():
    found = [compare(HELICAL, "draft", run_with(0.1, mean)) for mean in (None, 0.4e-6)]
    assert set(found[0].ratios) == {"relative"}
    assert "| all | 2 | 2 of 2, 0.5 to 0.5 | 0 of 1, 4 to 4 | 1 of 1, 2 to 2 |" in markdown(found)
    assert within(3.0) and within(1.0 / 3.0) and not within(3.1) and not within(0.3)
