"""Events of a job as they come (server-sent events, HTML Living Standard, clause 9.2)."""

from __future__ import annotations

import json
from typing import Any

EVENT_STREAM = "text/event-stream"


class EventReader:
    """The documents of a stream of events, which comes in pieces of any size."""

    def __init__(self) -> None:
        self._rest, self._data = b"", list[bytes]()

    def documents(self, piece: bytes) -> list[dict[str, Any]]:
        """Return the documents that a further piece completes, without comments and names of events."""
        *lines, self._rest = (self._rest + piece).split(b"\n")
        complete = []
        for line in (line.rstrip(b"\r") for line in lines):
            if line.startswith(b"data:"):
                self._data.append(line[5:].removeprefix(b" "))
            elif not line and self._data:
                complete.append(json.loads(b"\n".join(self._data)))
                self._data.clear()
        return complete
