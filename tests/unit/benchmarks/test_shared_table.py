"""Laws of the model that predicts what more workers would take."""

import pytest

from benchmarks.shared_table import Share

SHARE = Share(wall=12.0, caller=2.0, runs=[[1.0, 1.0, 1.0, 2.0], [3.0, 0.5, 0.5]])


def test_one_worker_does_everything():
    assert SHARE.predicted(1) == pytest.approx(SHARE.caller + SHARE.tasks)


def test_two_workers_take_the_tasks_in_their_order():
    # first run: 1 and 1, then 1 and 2; second: 3 beside 0.5 and 0.5
    assert SHARE.predicted(2) == pytest.approx(2.0 + 3.0 + 3.0)


def test_more_workers_than_tasks_wait_for_the_longest_of_every_run():
    assert SHARE.predicted(512) == pytest.approx(2.0 + 2.0 + 3.0)
