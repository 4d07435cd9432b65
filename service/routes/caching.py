"""Cache control of an answer that was given for a key (RFC 9111)."""

from __future__ import annotations

from starlette.datastructures import MutableHeaders
from starlette.types import Message, Send

NO_STORE = "no-store"
_REVALIDATED = "private, no-cache"


def for_one_caller(send: Send) -> Send:
    """Return `send` for answers that hang on a key: no shared cache keeps them, and no other asks in vain.

    The caller's own cache may keep them and asks before each use, so that a key that is taken back opens
    nothing. RFC 9111, sections 3.5, 5.2.2.4 and 5.2.2.7.
    """

    async def confidential(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(raw=message.setdefault("headers", []))
            if NO_STORE not in headers.get("cache-control", ""):
                headers["cache-control"] = _REVALIDATED
            headers.add_vary_header("Authorization")
        await send(message)

    return confidential
