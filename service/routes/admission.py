"""Admission: how many requests of one caller and in all are answered at once, how many bodies awaited."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from starlette.types import Message, Receive, Scope

from service.access.capacity import Capacity, Usage
from service.access.quotas import Quota


class Admission:
    """The requests of all callers of one server process.

    A body that is under way holds none of the places of requests that are answered: whoever sends bodies
    slowly takes room from slow bodies alone, and from those of others no more than a share. `share`: requests
    of one caller, and bodies, where nothing else is said.
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
            Requests of this caller, and bodies; None: as many as of all.

        Yields
        ------
        Receive
            What the request is to be read with.
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
                    stack.close()
                    stack.enter_context(self._answered.one(name))
                return message

            yield received
