"""Event streams as they are sent: how many are open, and how many events went out."""

from __future__ import annotations

from collections.abc import Callable

from starlette.types import Message

from service.routes.metrics import Metrics

_EVENT_STREAM = b"text/event-stream"


class StreamFigures:
    """Watches the answer to one request; anything but an event stream leaves no trace.

    Parameters
    ----------
    metrics : Metrics
    route : callable
        Returns the template of the request's path, once it was matched.

    Attributes
    ----------
    route : str
        Of the stream; empty while the answer is none.
    """

    def __init__(self, metrics: Metrics, route: Callable[[], str]) -> None:
        self._metrics, self._template = metrics, route
        self.route = ""

    def see(self, message: Message) -> None:
        """Look at a piece of the answer; the pieces of a stream are whole events or comments."""
        if message["type"] == "http.response.start":
            if dict(message.get("headers", ())).get(b"content-type", b"").startswith(_EVENT_STREAM):
                self.route = self._template()
                self._metrics.streams(self.route, 1)
        elif self.route:
            blocks = message.get("body", b"").split(b"\n\n")
            events = sum(bool(block) and not block.startswith(b":") for block in blocks)
            self._metrics.sent(self.route, events)

    def end(self) -> None:
        """Note that nothing more is sent."""
        if self.route:
            self._metrics.streams(self.route, -1)
