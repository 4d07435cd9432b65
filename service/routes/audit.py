"""The line of every access in the log: who did what to what, under which scope, and what came of it."""

from __future__ import annotations

import re
from typing import Any

import structlog
from starlette.types import Message, Scope, Send

from lineofaction.gearbox.problems import ServiceError
from service.access import Holder

_KEY = re.compile(r"loa_[A-Za-z0-9_-]+")
_LONGEST = 200

logger = structlog.get_logger(__name__)


class Visit:
    """One access to a service with keys, until it is noted.

    Attributes
    ----------
    holder : Holder or None
        Who it is, once that is known.
    """

    def __init__(self, scope: Scope, send: Send) -> None:
        self._scope, self._send = scope, send
        self.holder: Holder | None = None
        self._status = 500
        self._problem: str | None = None

    async def send(self, message: Message) -> None:
        """Pass on a piece of the answer."""
        if message["type"] == "http.response.start":
            self._status = message["status"]
        await self._send(message)

    def refused(self, error: ServiceError) -> None:
        """Note why there is no answer but a problem."""
        self._status, self._problem = error.status, error.kind

    def note(self) -> None:
        """Write the line; the key is in none of its fields, not even of who has it in the path."""
        problem = self._problem or self._scope["state"].get("problem")
        logger.info(
            "access",
            **self._who(),
            scope=getattr(self._scope.get("endpoint"), "scope", None),
            operation=getattr(self._scope.get("route"), "name", None),
            target=f"{self._scope['method']} {_KEY.sub('(key)', self._scope['path'])[:_LONGEST]}",
            outcome=problem or "granted",
            status=self._status,
        )

    def _who(self) -> dict[str, Any]:
        holder = self.holder
        return {"caller": holder and holder.name, "project": holder and holder.project}
