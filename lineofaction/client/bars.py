"""Progress bars of jobs, in a terminal or a notebook."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from lineofaction.client.libraries import libraries
from lineofaction.client.status import JobState, Watch

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress, TaskID

_MOST_ENDED = 3
"""Bars of ended jobs that stay: those of a map would fill the screen."""
_COLORS = {"failed": "red", "dismissed": "yellow"}


@contextmanager
def progress_bars(console: Console | None = None) -> Iterator[Watch]:
    """Yield a watch that draws a bar for each job: ``LineOfActionClient(progress=watch)``.

    A bar says which job of all it is, its stage, per cent, time taken and time left. Of ended jobs the last
    ones are shown.

    Parameters
    ----------
    console : rich.console.Console, optional
        Where to draw; default: the terminal or the notebook.

    Raises
    ------
    ModuleNotFoundError
        rich is not installed: it is optional for a client alone.
    """
    with libraries("Progress bars need rich: pip install 'lineofaction-client[bars]'"):
        from rich.progress import (  # noqa: PLC0415 (optional)
            BarColumn,
            Progress,
            TextColumn,
            TimeElapsedColumn,
        )

    percent, left = TextColumn("{task.percentage:>3.0f} %"), TextColumn("{task.fields[left]}")
    columns = (TextColumn("{task.description}"), BarColumn(), percent, TimeElapsedColumn(), left)
    with Progress(*columns, console=console) as bars:
        yield _Bars(bars).see


class _Bars:
    """The bars of jobs, by identifier; each says process, title and stage."""

    def __init__(self, bars: Progress) -> None:
        self._bars = bars
        self._tasks: dict[str, TaskID] = {}
        self._ended: deque[str] = deque()
        self._count = 0

    def see(self, state: JobState) -> None:
        """Draw the state of a job."""
        from rich.markup import escape  # noqa: PLC0415 (optional)

        if state.id not in self._tasks:
            self._count += 1
            self._tasks[state.id] = self._bars.add_task("", total=100, left="")
        task = self._tasks[state.id]
        number = f"{task + 1}. " if self._count > 1 else ""
        color = _COLORS.get(state.status, "none")
        name = escape(f"{state.process} {state.title}".rstrip())
        words = f"[{color}]{number}{name}: {escape(state.words)}[/]"
        self._bars.update(task, completed=state.progress, description=words, left=state.time_left)
        if state.ended and state.id not in self._ended:
            self._end(state.id)

    def _end(self, job: str) -> None:
        """Stop the clock of a job; take away the bar that ended first, if there are too many."""
        self._bars.stop_task(self._tasks[job])
        self._ended.append(job)
        if len(self._ended) > _MOST_ENDED:
            self._bars.update(self._tasks[self._ended.popleft()], visible=False)
