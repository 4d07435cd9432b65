"""Events of a job as they come (server-sent events, HTML Living Standard, clause 9.2)."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Any

import httpx2

from lineofaction.client.answers import stranger
from lineofaction.client.status import JobState
from lineofaction.client.steps import Item, Items, Pause, Piece, Stream
from lineofaction.client.waiting import AWAY, AWAY_PAUSE_S, STOPS, note_continuing

if TYPE_CHECKING:
    from lineofaction.client.exchange import Exchange

EVENT_STREAM = "text/event-stream"


class EventReader:
    """The documents of a stream of events, which comes in pieces of any size."""

    def __init__(self) -> None:
        self._rest, self._data = b"", list[bytes]()

    def documents(self, piece: bytes) -> list[dict[str, Any]]:
        """Return what a further piece completes; comments and names of events are passed over."""
        *lines, self._rest = (self._rest + piece).split(b"\n")
        complete = []
        for line in (line.rstrip(b"\r") for line in lines):
            if line.startswith(b"data:"):
                self._data.append(line[5:].removeprefix(b" "))
            elif not line and self._data:
                complete.append(json.loads(b"\n".join(self._data)))
                self._data.clear()
        return complete


def job_events(exchange: Exchange, job: str, patience: float) -> Items[JobState]:
    """Hand out the state of a job now and whenever it changes, until it has ended.

    A stream that breaks is opened again; a state that did not change meanwhile is not handed out twice.

    Raises
    ------
    Unreachable
        The service was away for longer than `patience` seconds.
    """
    last: JobState | None = None
    answered = time.monotonic()
    while True:
        try:
            stream: Stream = yield from exchange.opened(f"/v1/jobs/{job}/events", EVENT_STREAM)
            reader = EventReader()
            while (piece := (yield Piece(stream))) is not None:
                answered = time.monotonic()
                for state in map(JobState.from_json, reader.documents(piece)):
                    if state != last:
                        last = state
                        yield Item(state)
        except (httpx2.TransportError, *AWAY) as error:
            if last is None or time.monotonic() - answered > patience:
                raise exchange.away(error) if isinstance(error, httpx2.TransportError) else error from None
        except STOPS as stop:
            note_continuing(stop, job)
            raise
        else:
            if last is None:
                raise stranger(stream.response)
        if last.ended:
            return
        yield Pause(AWAY_PAUSE_S)
