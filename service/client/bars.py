"""Progress bars of jobs, in a terminal or a notebook."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from service.client.status import JobState, Watch

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import TaskID


@contextmanager
def progress_bars(console: Console | None = None) -> Iterator[Watch]:
    """Yield a watch that draws a bar for each job: ``LineOfActionClient(progress=watch)``.

    Parameters
    ----------
    console : rich.console.Console, optional
        Where to draw; default: the terminal or the notebook.

    Raises
    ------
    ModuleNotFoundError
        rich is not installed: it is optional for a client alone.
    """
    from rich.progress import (  # noqa: PLC0415 (optional)
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
    )

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console) as bars:
        tasks: dict[str, TaskID] = {}

        def watch(state: JobState) -> None:
            if state.id not in tasks:
                tasks[state.id] = bars.add_task("", total=100)
            words = f"{state.process} {state.stage or state.status}"
            bars.update(tasks[state.id], completed=state.progress, description=words)

        yield watch
