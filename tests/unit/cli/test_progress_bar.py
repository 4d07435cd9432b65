"""Progress of the verbs on a terminal: what a stage says of itself, on the stage's own bar."""

import io
import sys

import pytest

from lineofaction.gearbox.progress_bars import progress_bar
from lineofaction.gearbox.stages import TimeLeft


class Terminal(io.StringIO):
    """A terminal's standard error."""

    def isatty(self) -> bool:
        return True


def test_a_stage_says_what_it_will_take_on_its_own_bar(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("COLUMNS", "160")
    monkeypatch.setenv("TERM", "xterm")
    with progress_bar() as report:
        report("housing; case: about 25 CPU s, 1.2 GB", 0.0)
        assert "housing; case: about 25 CPU s, 1.2 GB" in terminal.getvalue()
        report("housing", 1.0)
    last = terminal.getvalue().rpartition("\r")[2]
    assert "housing" in last and "100 %" in last
    assert terminal.getvalue().count("\n") == 1  # one bar is one line


@pytest.mark.law
def test_what_is_left_is_that_of_all_stages_by_the_times_of_those_done():
    """A stage that ends leaves the others, each as much slower than its share as those before."""
    left = TimeLeft((("gears", 0.2), ("search", 0.6), ("confirmation", 0.2)), 0.0)
    assert left.text("gears", 0.0, 0.0) == ""
    assert left.text("gears", 1.0, 10.0) == "0:00:40 left"
    assert left.text("search", 0.5, 25.0) == "0:00:25 left"
    assert left.text("confirmation", 1.0, 50.0) == ""
    slow = TimeLeft((("gears", 0.5), ("search", 0.5)), 0.0)
    slow.text("gears", 0.0, 0.0)
    assert slow.text("gears", 1.0, 60.0) == "0:01:00 left"


def test_work_without_known_stages_has_the_pace_of_each_bar():
    left = TimeLeft((), 0.0)
    assert left.text("pages", 0.0, 5.0) == "" and left.text("pages", 0.25, 15.0) == "0:00:30 left"
    assert left.text("pages", 1.0, 45.0) == ""
