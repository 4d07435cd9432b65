"""Progress of long work where a person sees it: bars of a terminal, one bar of a notebook, else nothing."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from html import escape
from typing import Any

from lineofaction.gearbox.stages import TimeLeft
from model_studies.progress import Progress, silent, stage_name

Stages = Iterable[tuple[str, float]]
"""Names of stages with their usual shares of the time, in their order; empty: unknown."""
ProgressChoice = Progress | bool | None
"""Function that is called as progress(stage, fraction); True: bars where output is shown; False: nothing;
None: the bar of a notebook, if the work takes longer than a moment.
"""
_MOMENT = 2.0
"""Seconds after which a notebook shows a bar that nobody asked for."""
_INTERVAL = 0.25
"""Least seconds between two drawings of a notebook's bar."""


@contextmanager
def progress_display(progress: ProgressChoice, stages: Stages = ()) -> Iterator[Progress]:
    """Yield the function to which work reports its progress."""
    display = None if callable(progress) or progress is False else notebook_display()
    if callable(progress):
        yield progress
    elif display is not None:
        yield NotebookBar(display, stages, 0.0 if progress else _MOMENT).report
    elif progress:
        with progress_bar(stages) as report:
            yield report
    else:
        yield silent


def notebook_display() -> Callable[..., Any] | None:
    """Return the function by which a cell of a notebook shows HTML; None: no notebook runs this."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if not hasattr(shell, "kernel"):
        return None
    from IPython.display import HTML, display  # noqa: PLC0415 (a notebook has loaded it)

    return lambda text, handle=None: (
        display(HTML(text), display_id=True) if handle is None else handle.update(HTML(text))
    )


class NotebookBar:
    """The bar of a cell: stage, fraction done, time left.

    `display` shows HTML and returns a handle; with the handle as second argument it replaces what it showed.
    """

    def __init__(self, display: Callable[..., Any], stages: Stages, moment_s: float) -> None:
        self._display, self._handle = display, None
        self._begun_s = self._drawn_s = time.monotonic()
        self._left, self._moment_s = TimeLeft(stages, self._begun_s), moment_s

    def report(self, stage: str, fraction: float) -> None:
        """Show a stage; at most four times a second, and not before the moment is over."""
        now_s, done = time.monotonic(), min(max(fraction, 0.0), 1.0)
        left = self._left.text(stage_name(stage), done, now_s)
        is_soon = self._handle is not None and now_s - self._drawn_s < _INTERVAL and done < 1.0
        if is_soon or now_s - self._begun_s < self._moment_s:
            return
        text = f'{escape(stage)} <progress value="{done:.3f}" max="1"></progress> {100.0 * done:.0f} % {left}'
        shown = self._display(text, self._handle)
        self._handle, self._drawn_s = self._handle or shown, now_s


@contextmanager
def progress_bar(stages: Stages = ()) -> Iterator[Progress]:
    """Yield ``report(stage, fraction)``; it draws on standard error if that is a terminal, else nothing.

    What is left is that of the whole work: its `stages`, by the time that those before took. Of work without
    known stages each bar has its own.
    """
    if not sys.stderr.isatty():
        yield silent
        return
    from rich.console import Console  # noqa: PLC0415 (start-up time)
    from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn  # noqa: PLC0415

    columns = (TextColumn("{task.description:<14}"), BarColumn(), TextColumn("{task.percentage:>3.0f} %"))
    clocks = (TimeElapsedColumn(), TextColumn("{task.fields[left]}"))
    left = TimeLeft(stages, time.monotonic())
    with Progress(*columns, *clocks, console=Console(stderr=True)) as bars:
        tasks: dict[str, TaskID] = {}
        announced_costs: dict[str, str] = {}  # a cost that was announced stays

        def report(stage: str, fraction: float) -> None:
            name = stage_name(stage)
            if name not in tasks:
                tasks[name] = bars.add_task(stage, total=1.0, left="")
            announced_costs[name] = stage if stage != name else announced_costs.get(name, stage)
            done = min(max(fraction, 0.0), 1.0)
            text = left.text(name, done, time.monotonic())
            bars.update(tasks[name], description=announced_costs[name], completed=done, left=text)

        yield report
