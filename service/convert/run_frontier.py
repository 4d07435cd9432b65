"""The ladder of dynamics at the boundary: from a scene to its frontier."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dynamics.accuracy import Frontier, frontier
from dynamics.errors import InputError, SolveError
from dynamics.scene import Scene
from service.convert.errors import translated
from service.problems import JobFailed


def run_frontier_of(
    scene: Scene, rungs: Sequence[str] | None, progress: Callable[[str, float], None] | None = None
) -> Frontier:
    """Run the ladder on a scene.

    Raises
    ------
    BadInput
        No such rung, or the run is too short.
    JobFailed
        Fewer than two rungs came to their end.
    """
    try:
        return frontier(scene, fidelities=rungs, progress=progress)
    except InputError as error:
        raise translated(error) or error from None
    except SolveError as error:
        raise JobFailed(str(error)) from None
