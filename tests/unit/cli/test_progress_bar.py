"""Progress of the verbs on a terminal: what a stage says of itself, on the stage's own bar."""

from __future__ import annotations

import io
import sys

import pytest

from lineofaction.cli.output import progress_bar


class Terminal(io.StringIO):
    """A terminal's standard error."""

    def isatty(self) -> bool:
        return True


def test_a_stage_says_what_it_will_take_on_its_own_bar(monkeypatch: pytest.MonkeyPatch) -> None:
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
