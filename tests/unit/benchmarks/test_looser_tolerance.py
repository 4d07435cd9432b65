"""The study of two tolerances counts pairs for which the looser is dearer, and predictions that are off."""

from benchmarks.looser_tolerance import LOOSE, TIGHT, ToleratedRun, counts

CHEAPER = [ToleratedRun("spur", LOOSE, 2.0, 1.5, 1.9), ToleratedRun("spur", TIGHT, 4.0, 2.6, 3.9)]
DEARER = [ToleratedRun("helical", TIGHT, 9.0, 9.5, 8.8), ToleratedRun("helical", LOOSE, 12.6, 11.0, 12.0)]


def test_dearer_pairs_and_predictions_that_are_off_are_counted():
    rows = {figure.what: figure.value for figure in counts([*CHEAPER, *DEARER])}
    assert rows["pairs for which the looser costs more"] == 1
    assert rows["the same, at most"] == 1.4
    assert rows["predictions off by more than 30 %"] == 25.0
