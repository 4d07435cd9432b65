"""A browser that prints has limits of CPU time and of standing still, none of wall time."""

import stat
import sys
from pathlib import Path

import pytest

from lineofaction.gearbox.problems import BadInput
from lineofaction.report.drawing import printing
from lineofaction.report.drawing.printing import pdf

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a script is no program there")

BROWSER = """#!{python} -S
import sys, time
def work(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass
printed, = (word.partition("=")[2] for word in sys.argv if word.startswith("--print-to-pdf="))
{course}
open(printed, "wb").write(b"%PDF")
"""


@pytest.fixture
def browser(tmp_path, monkeypatch):
    """Install a browser that takes a course before it prints."""

    def installed(course: str) -> None:
        file = tmp_path / "browser"
        file.write_text(BROWSER.format(python=sys.executable, course=course))
        file.chmod(file.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("CHROMIUM", str(file))

    return installed


def refusal() -> str:
    with pytest.raises(BadInput) as refused:
        pdf("<p>page", Path("report.pdf"))
    (fault,) = refused.value.faults
    assert fault.suggestion == "Write an .html page and print that."
    return str(fault.bound)


def test_a_browser_that_goes_on_slowly_may_take_any_time(browser, monkeypatch):
    """Longer in all than any limit of time: it rests often, as one does that gets little of the machine."""
    monkeypatch.setattr(printing, "_STANDSTILL_S", 1.5)
    monkeypatch.setattr(printing, "_PROGRESS_S", 0.02)
    monkeypatch.setattr(printing, "_WAIT_S", 1.5)
    browser("for _ in range(8):\n    work(0.05)\n    time.sleep(0.25)")
    assert pdf("<p>page", Path("report.pdf")) == b"%PDF"


def test_a_browser_that_stands_still_is_ended(browser, monkeypatch):
    monkeypatch.setattr(printing, "_STANDSTILL_S", 0.3)
    browser("time.sleep(600)")
    assert refusal() == "a page that browser prints: it stood still for 0.3 s"


def test_a_browser_that_never_ends_is_ended_by_its_cpu_time(browser, monkeypatch):
    monkeypatch.setattr(printing, "_CPU_LIMIT_S", 0.3)
    browser("work(600)")
    assert refusal() == "a page that browser prints within 0.3 s of CPU time"


def test_where_no_cpu_time_is_told_there_is_a_limit_of_time(browser, monkeypatch):
    monkeypatch.setattr(printing, "family_cpu_seconds", lambda _: None)
    monkeypatch.setattr(printing, "_WAIT_S", 0.3)
    browser("time.sleep(600)")
    assert refusal() == "a page that browser prints within 0.3 s"


def test_a_browser_that_fails_says_by_what_code(browser):
    browser("sys.exit(3)")
    assert refusal() == "a page that browser prints: it ended with exit code 3"
