"""The scenes of a study, made from values of its factors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Protocol

from dynamics.scene import Scene


class Scenes(Protocol):
    """Makes scenes of one structure; can be pickled, and is frozen data that has a content hash."""

    def scene(self, values: Mapping[str, float]) -> Scene:
        """Return the scene at values of the factors, by name.

        Raises
        ------
        LeftOut, DynamicsError
            There is no such scene, and why.
        """
        ...

    def expensive(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Return those of the values that decide what takes longer to make than a run, such as a table."""
        ...


class Workers(Protocol):
    """Runs independent tasks, yields their results in order; see `fe_contact.workers`, which conform."""

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        """Yield ``function(shared, item)`` of every item."""
        ...


class OneByOne:
    """One task after the other, here."""

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        """Yield results as they are computed."""
        return (function(shared, item) for item in items)
