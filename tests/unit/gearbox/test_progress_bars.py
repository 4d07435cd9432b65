"""Progress in notebooks and scripts: a bar where somebody sees it, else nothing."""

import io
import sys
from types import ModuleType, SimpleNamespace

import pytest

from lineofaction.gearbox.progress_bars import progress_display
from model_studies.progress import silent

Shown = list[tuple[str, str]]


class Terminal(io.StringIO):
    """A terminal's standard error."""

    def isatty(self) -> bool:
        return True


@pytest.fixture
def cell(monkeypatch):
    """Run in a notebook; what its cell shows, first and later."""
    shown: Shown = []
    handle = SimpleNamespace(update=lambda text: shown.append(("later", text)))
    ipython, display = ModuleType("IPython"), ModuleType("IPython.display")
    ipython.get_ipython = lambda: SimpleNamespace(kernel=object())
    display.HTML = str

    def show(text, *, display_id):
        assert display_id
        shown.append(("first", text))
        return handle

    display.display = show
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    yield shown


@pytest.fixture
def clock(monkeypatch):
    now = SimpleNamespace(s=100.0)
    monkeypatch.setattr("time.monotonic", lambda: now.s)
    return now


def test_a_notebook_shows_a_bar_of_work_that_takes_longer_than_a_moment(cell, clock):
    with progress_display(None) as report:
        report("contact", 0.1)
        assert cell == []
        clock.s += 2.1
        report("contact <b>", 0.4)
        clock.s += 0.1
        report("contact <b>", 0.41)  # too soon
        clock.s += 0.3
        report("contact <b>", 0.5)
        report("contact <b>", 1.0)
    assert [when for when, _ in cell] == ["first", "later", "later"]
    assert "contact &lt;b&gt; <progress" in cell[0][1] and " 40 % " in cell[0][1]
    assert "100 %" in cell[-1][1]


def test_a_notebook_shows_it_at_once_if_told_and_never_if_not(cell, clock):
    with progress_display(False) as report:
        clock.s += 60.0
        report("contact", 0.5)
    assert cell == []
    with progress_display(True) as report:
        report("contact", 0.5)
    assert len(cell) == 1


def test_a_script_shows_bars_on_a_terminal_if_told(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    with progress_display(None) as report:
        assert report is silent
    with progress_display(True) as report:
        report("contact", 1.0)
    assert "contact" in terminal.getvalue() and "100 %" in terminal.getvalue()
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress_display(True) as report:
        assert report is silent


def test_a_function_of_the_caller_is_called(cell):
    seen: list[tuple[str, float]] = []
    with progress_display(lambda *step: seen.append(step)) as report:
        report("contact", 0.5)
    assert seen == [("contact", 0.5)] and cell == []
