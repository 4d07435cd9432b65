"""Leases of a scheduler on its computations: renewed by a heartbeat, and heeded by whoever works under them.

While a scheduler renews its leases nobody else takes up its computations. One that cannot (it died, was
stopped, or lost the database) loses them: its workers end by themselves before the lease does, because what
keeps them alive is the scheduler's word that it was renewed.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import structlog

from service.queue.claims import Claim, Claims
from service.worker.order import USABLE

RENEWALS = 4
"""Renewals in the time of one lease."""

logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class _Held:
    """A claim, the end of its lease on our own clock, and the call that reports renewals to its worker."""

    claim: Claim
    until: float
    beat: Callable[[float], None]


class Leases:
    """The leases of one scheduler; renewed in a thread of its own, whatever the scheduler waits for.

    Parameters
    ----------
    claims : Claims
    lease_s : float
        Duration of a lease.
    """

    def __init__(self, claims: Claims, lease_s: float) -> None:
        self._claims, self._lease_s = claims, lease_s
        self._held: dict[str, _Held] = {}
        self._lock = threading.Lock()
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Begin to renew."""
        self._stopping.clear()
        self._thread = threading.Thread(target=self._loop, name="leases", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Cease to renew, and hold nothing."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()
        with self._lock:
            self._held.clear()

    def hold(self, claim: Claim, beat: Callable[[float], None]) -> None:
        """Renew the lease of a fresh claim from now on; `beat` is called with each new end."""
        with self._lock:
            self._held[claim.lease] = _Held(claim, claim.asked + USABLE * self._lease_s, beat)

    def drop(self, claim: Claim) -> None:
        """Cease to renew the lease of a claim."""
        with self._lock:
            self._held.pop(claim.lease, None)

    def lapsed(self, claim: Claim) -> bool:
        """Whether the lease of a claim that was held ended, or is about to."""
        with self._lock:
            held = self._held.get(claim.lease)
        return held is None or time.monotonic() > held.until

    def _loop(self) -> None:
        """Until stopped: renew."""
        while not self._stopping.wait(self._lease_s / RENEWALS):
            try:
                self._renew()
            except Exception as error:  # noqa: BLE001 (the next one may succeed; if none does, leases lapse)
                logger.warning("leases not renewed", error=type(error).__name__)

    def _renew(self) -> None:
        """Renew all; a lease that is another's by now, or of work that ended, stays as it is."""
        with self._lock:
            held = list(self._held.values())
        if not held:
            return
        sent = time.monotonic()
        ours = self._claims.renew([entry.claim for entry in held])
        usable = sent + USABLE * self._lease_s
        for entry in held:
            if entry.claim.id in ours and time.monotonic() < min(entry.until, usable):
                self._extend(entry, usable)

    def _extend(self, entry: _Held, until: float) -> None:
        """Note a renewal that came in time, and tell the worker."""
        with self._lock:
            if entry.claim.lease not in self._held:
                return
            self._held[entry.claim.lease] = _Held(entry.claim, until, entry.beat)
        entry.beat(until)
