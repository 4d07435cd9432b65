"""Threads that make due calls of webhooks: signed requests to addresses of allowed origins."""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import structlog

from lineofaction.gearbox.problems import ServiceError
from service.origin import Origin
from service.webhooks.calls import Call, Calls
from service.webhooks.requests import NotCalled, send

THREADS, LOOK_S = 4, 2.0
"""Number of threads, and seconds between two looks of a thread. The threads look in turns: a due call is seen
within half a second."""
_STOPPING_S = 1.0
"""Longest wait for the threads at the end, s."""
_GONE = 410
"""Status of an address that is not to be called again (HTTP "Gone")."""
logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class Outbox:
    """Parts from which calls are made: due calls, allowed origins, key, body."""

    calls: Calls
    origins: frozenset[Origin]
    """Origins that may be called."""
    key: bytes
    """Key of the signatures."""
    compose: Callable[[str, str], Any]
    """Function from identifier of a job and event to the body, JSON."""

    def make_one(self) -> bool:
        """Make a call that is due; False: there is none."""
        call = self.calls.claim()
        if call is None:
            return False
        self._make(call)
        return True

    def _make(self, call: Call) -> None:
        fields = {"job": call.job, "call": call.event, "attempt": call.attempts}
        try:
            status = self._sent(call)
        except NotCalled as error:
            logger.warning("webhook not delivered", **fields, reason=str(error))
            self.calls.fail(call, f"{error}.")
            return
        except Exception:
            logger.exception("webhook not delivered", **fields)
            self.calls.fail(call, "an unexpected failure; the log has the details.")
            return
        if 200 <= status < 300:
            logger.info("webhook delivered", **fields, status=status)
            self.calls.deliver(call, f"answered {status}.")
        else:
            logger.warning("webhook refused", **fields, status=status)
            text = "redirects are not followed" if 300 <= status < 400 else "not taken"
            self.calls.fail(call, f"answered {status}, {text}.", final=status == _GONE)

    def _sent(self, call: Call) -> int:
        if Origin.of(call.uri) not in self.origins:
            raise NotCalled("the origin is not listed any more")
        body = json.dumps(self.compose(call.job, call.event), allow_nan=False).encode()
        headers = signed_headers(self.key, call.id, int(time.time()), body)
        return send(call.uri, body, {"Content-Type": "application/json", **headers})


def signed_headers(key: bytes, identifier: str, timestamp: int, body: bytes) -> dict[str, str]:
    """Return the headers of a call, signed as of Standard Webhooks 1.0.0; `timestamp` is in s since 1970."""
    content = b".".join((identifier.encode(), str(timestamp).encode(), body))
    digest = base64.b64encode(hmac.new(key, content, hashlib.sha256).digest()).decode()
    return {
        "webhook-id": identifier,
        "webhook-timestamp": str(timestamp),
        "webhook-signature": f"v1,{digest}",
    }


class Deliverer:
    """Makes calls until it is stopped.

    A call in progress is leased: if its deliverer does not finish it, another one makes it after the lease.
    """

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._stopping = threading.Event()
        self._threads: list[threading.Thread] = []

    def start(self) -> None:
        """Begin."""
        self._stopping.clear()
        self._threads = [
            threading.Thread(target=self._loop, args=(n * LOOK_S / THREADS,), name="webhooks", daemon=True)
            for n in range(THREADS)
        ]
        for thread in self._threads:
            thread.start()

    def stop(self) -> None:
        """End soon."""
        self._stopping.set()
        end = time.monotonic() + _STOPPING_S
        for thread in self._threads:
            thread.join(max(end - time.monotonic(), 0.0))

    def _loop(self, pause: float) -> None:
        while not self._stopping.wait(pause):
            pause = LOOK_S
            try:
                while not self._stopping.is_set() and self._outbox.make_one():
                    pass
            except ServiceError as error:
                logger.warning("webhooks wait", error=str(error))
            except Exception:
                logger.exception("webhooks failed")
