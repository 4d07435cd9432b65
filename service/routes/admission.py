"""Admission: how many requests of one caller and in all are answered at once, how many bodies awaited."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from starlette.types import Message, Receive, Scope

from service.access.capacity import Capacity, Usage
from service.access.quotas import Quota


class Admission:
    """The requests of all callers of one server process.

    A request has a place among the bodies until its body has arrived, then one among the answered requests.
    So a caller that sends bodies slowly takes places from bodies alone, and no more than its share. `share`
    is the number of answered requests, and of bodies, that one caller may have by default.
    """

    def __init__(self, capacity: Capacity) -> None:
        self.share = capacity.share
        self._answered = Usage("requests under way", capacity.requests)
        self._awaited = Usage("bodies under way", capacity.requests)

    def quota(self, name: str, maximum: int) -> Quota:
        """Return the caller's quota of requests answered at the same time, with its remainder."""
        return Quota("concurrent", maximum, maximum - self._answered.number(name), unit="concurrent-requests")

    @contextmanager
    def admitted(self, scope: Scope, receive: Receive, name: str, maximum: int | None) -> Iterator[Receive]:
        """Hold a place among bodies until there is no more of it to come, then one among requests.

        Raises `TooManyHeld`, `TooManyRequests`: the caller has as many as it may, or all together have;
        nothing was read then.

        Parameters
        ----------
        scope, receive : Scope, Receive
            Scope and channel of the request.
        name : str
            Name of the caller.
        maximum : int or None
            Most requests, and most bodies, of this caller; None: no limit but that of all callers.

        Yields
        ------
        Receive
            Channel from which the request must be read.
        """
        self._answered.refuse_beyond(name, maximum)
        headers = dict(scope["headers"])  # whether a body follows the head: RFC 9112, section 6.3
        follows = b"transfer-encoding" in headers or headers.get(b"content-length", b"0") != b"0"
        with ExitStack() as stack:
            if not follows:
                stack.enter_context(self._answered.one(name))
                yield receive
                return
            self._awaited.refuse_beyond(name, maximum)
            stack.enter_context(self._awaited.one(name))
            is_complete = False

            async def received() -> Message:
                nonlocal is_complete
                message = await receive()
                if not is_complete and not message.get("more_body", False):
                    is_complete = True
                    stack.close()  # gives back the place of the body
                    stack.enter_context(self._answered.one(name))
                return message

            yield received
