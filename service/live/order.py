"""Questions to a process that answers while somebody waits, as they travel to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

from host.children.frames import Frame

Json = dict[str, Any]
LiveWork = Callable[..., Json]


@dataclass(frozen=True)
class LiveOrder:
    """A question to a live worker."""

    entry: str
    """``"module:function"``, called as ``function(inputs)``; it returns plain JSON."""
    inputs: Json
    """Argument of the function, plain JSON."""

    def frame(self) -> Frame:
        """Return the message that carries it."""
        return Frame.of_json("order", vars(self))

    @classmethod
    def from_frame(cls, frame: Frame) -> Self:
        """Read the message."""
        return cls(**frame.as_json())
