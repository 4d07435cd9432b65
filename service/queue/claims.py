"""The scheduler's side of the job table: claim, renew, progress, end, put back, take up; and its leases.

Every step names the lease it works under, so that a computation dismissed or taken up by another scheduler
meanwhile stays as it is. Leases end by the clock of the database, which all schedulers share.
"""

from __future__ import annotations

import json
import threading
import time
import uuid
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import structlog
from packaging.version import InvalidVersion, Version
from sqlalchemy import ColumnElement, Connection, Engine, Row, select, update

from service.project import COMMON, at_address
from service.queue.tables import computations
from service.queue.workload import batch_steps, end_computations
from service.store.database import now, reading, writing
from service.store.dialects import dialect_of, retried
from service.version import solver_version
from service.worker.order import USABLE

DEFAULT_LEASE_S = 60.0


@dataclass(frozen=True)
class Claim:
    """A computation that is someone's to run.

    Attributes
    ----------
    id, process, key : str
        Of the computation.
    inputs : dict
    attempts : int
        With this one.
    lease : str
        Name of the lease it is held under: another for every claim.
    asked : float
        When it was claimed, on the holder's monotonic clock, s.
    traceparent : str
        Of the request that entered it; empty: it belongs to no trace.
    waited_from : str
        When it was entered or put back, RFC 3339; empty where that is not known.
    max_cost_s : float or None
        CPU seconds that it may take, as far as known when it was claimed; None: no limit.
    project : str
        Whose jobs wanted it.
    """

    id: str
    process: str
    key: str
    inputs: dict[str, Any]
    attempts: int
    lease: str
    asked: float = field(default_factory=time.monotonic, compare=False)
    max_cost_s: float | None = None
    traceparent: str = field(default="", compare=False)
    waited_from: str = field(default="", compare=False)
    project: str = COMMON


class Claims:
    """Computations as one scheduler sees them.

    Parameters
    ----------
    engine : Engine
    owner : str
        Name of the scheduler, the same after a restart.
    lease_s : float
        How long a claim holds without being renewed.
    program : str
        Version of this program.
    """

    def __init__(
        self,
        engine: Engine,
        owner: str = "",
        lease_s: float = DEFAULT_LEASE_S,
        program: str = solver_version(),
    ) -> None:
        self._engine, self._owner, self._lease_s = engine, owner, lease_s
        self.program = program
        self._newer: set[str] = set()

    def claim(self) -> Claim | None:
        """Take the oldest waiting computation of the highest priority that this program entered."""
        return self._claim(uuid.uuid4().hex, time.monotonic())

    @retried
    def _claim(self, lease: str, requested: float) -> Claim | None:
        """Take a computation under a lease of this name, unless that was done already."""
        mine = select(computations).where(computations.c.lease == lease)
        with writing(self._engine) as connection:
            row = connection.execute(mine).one_or_none()
            if row is not None:
                return _claimed(row, requested)
            row = self._first(connection)
            if row is None:
                return None
            values = {"attempts": row.attempts + 1, "started": row.started or now(), "state": "running"}
            values |= {"owner": self._owner, "lease": lease, "leased_until": self._end(connection)}
            values |= {"message": "Starts.", "updated": now()}
            connection.execute(update(computations).where(computations.c.id == row.id).values(**values))
            claim = _claimed(connection.execute(mine).one(), requested)
            return replace(claim, waited_from=row.updated)

    def _first(self, connection: Connection) -> Row[Any] | None:
        """Return the computation whose turn it is, and lock it.

        The name of a result holds the version of the program that makes it. What an older program entered
        ends with the reason; what a newer one entered is passed over.
        """
        waiting = select(computations).where(computations.c.state == "accepted")
        turn = (computations.c.priority.desc(), computations.c.created)
        first = waiting.order_by(*turn).limit(1).with_for_update(skip_locked=True)
        while True:
            row = connection.execute(first.where(computations.c.program.not_in(self._newer))).one_or_none()
            if row is None or row.program == self.program:
                return row
            if is_newer(row.program, self.program):
                self._newer.add(row.program)
            else:  # 0.2.0 did not write its version down
                text = f"The job was entered by version {row.program or '0.2.0 or older'}; submit it again."
                former = {"state": "failed", "message": text}
                end_computations(connection, computations.c.id == row.id, former)

    def _end(self, connection: Connection) -> float:
        return dialect_of(connection).clock(connection) + self._lease_s

    @retried
    def renew(self, claims: Collection[Claim]) -> set[str]:
        """Let leases begin anew; return the computations that are still ours."""
        ours = _under(claims)
        with writing(self._engine) as connection:
            connection.execute(update(computations).where(ours).values(leased_until=self._end(connection)))
            return set(connection.execute(select(computations.c.id).where(ours)).scalars())

    @retried
    def held(self, claims: Collection[Claim]) -> set[str]:
        """Return the computations that are still ours: neither dismissed nor taken up by another."""
        if not claims:
            return set()
        with reading(self._engine) as connection:
            return set(connection.execute(select(computations.c.id).where(_under(claims))).scalars())

    @retried
    def max_cost_s(self, claim: Claim) -> float | None:
        """Return the CPU seconds that a computation may take now; None: no limit."""
        statement = select(computations.c.max_cost_s).where(computations.c.id == claim.id)
        with reading(self._engine) as connection:
            limit: float | None = connection.execute(statement).scalar()
            return limit

    def progress(self, claim: Claim, stage: str, stage_fraction: float, fraction: float | None) -> None:
        """Note how far the work is; the fraction of the whole never falls."""
        values: dict[str, Any] = {
            "stage": stage,
            "stage_fraction": stage_fraction,
            "message": f"Runs: {stage}.",
        }
        if fraction is not None:
            values["fraction"] = fraction
        self._change(claim, values)

    def succeed(self, claim: Claim) -> None:
        """End with the result stored."""
        done = {"state": "successful", "message": "Done.", "fraction": 1.0, "stage_fraction": 1.0}
        self._end_with(claim, done)

    def fail(
        self, claim: Claim, message: str, faults: Sequence[dict[str, Any]] = (), reference: str = ""
    ) -> None:
        """End without a result."""
        facts = {"faults": json.dumps(list(faults)), "reference": reference}
        self._end_with(claim, {"state": "failed", "message": message.replace("\0", "")} | facts)

    def put_back(self, claim: Claim, message: str, *, counted: bool) -> None:
        """Let it wait again; an attempt that ended through no fault of its own is not counted."""
        attempts = claim.attempts if counted else claim.attempts - 1
        values = {"state": "accepted", "message": message, "stage": "", "stage_fraction": 0.0}
        self._change(claim, values | {"fraction": 0.0, "attempts": attempts})

    @retried
    def _end_with(self, claim: Claim, values: dict[str, Any]) -> None:
        with writing(self._engine) as connection:
            end_computations(connection, _under([claim]), values)

    @retried
    def _change(self, claim: Claim, values: dict[str, Any]) -> None:
        with writing(self._engine) as connection:
            changed = update(computations).where(_under([claim])).values(updated=now(), **values)
            connection.execute(changed)

    @retried
    def advance_batches(self) -> None:
        """Note how far batches are by the states of their jobs; whoever does so first, it is the same."""
        with reading(self._engine) as connection:
            steps = batch_steps(connection)
        if not steps:
            return
        with writing(self._engine) as connection:
            for step in steps:
                connection.execute(step)

    @retried
    def left(self) -> list[Claim]:
        """Return what runs in our name: after a start, what we left behind when we died."""
        mine = computations.c.owner == self._owner
        with reading(self._engine) as connection:
            return _running(connection, mine)

    @retried
    def take_up(self) -> list[Claim]:
        """Take over what runs under leases that have ended; it is ours to put back or to fail."""
        with writing(self._engine) as connection:
            instant = dialect_of(connection).clock(connection)
            ended = (computations.c.state == "running", computations.c.leased_until < instant)
            rows = connection.execute(
                select(computations.c.id).where(*ended).with_for_update(skip_locked=True)
            )
            orphans = list(rows.scalars())
            lease = {"lease": uuid.uuid4().hex, "owner": self._owner, "leased_until": self._end(connection)}
            if not orphans:
                return []
            chosen = computations.c.id.in_(orphans)
            connection.execute(update(computations).where(chosen).values(**lease))
            return _running(connection, chosen)

    @retried
    def waiting(self) -> set[str]:
        """Return the computations that wait."""
        statement = select(computations.c.id).where(computations.c.state == "accepted")
        with reading(self._engine) as connection:
            return set(connection.execute(statement).scalars())


def _under(claims: Collection[Claim]) -> ColumnElement[bool]:
    """Condition of the computations that run under the leases of `claims`."""
    pairs = [(claim.id, claim.lease) for claim in claims]
    named = computations.c.id.in_([identifier for identifier, _ in pairs])
    leased = computations.c.lease.in_({lease for _, lease in pairs})
    return named & leased & (computations.c.state == "running")


def _running(connection: Connection, which: ColumnElement[bool]) -> list[Claim]:
    requested = time.monotonic()
    rows = connection.execute(select(computations).where(which, computations.c.state == "running")).all()
    return [_claimed(row, requested) for row in rows]


def _claimed(row: Row[Any], requested: float) -> Claim:
    inputs, (project, key) = json.loads(row.inputs), at_address(row.key)
    facts = (row.id, row.process, key, inputs, row.attempts, row.lease, requested)
    return Claim(*facts, row.max_cost_s, row.traceparent, project=project)


def is_newer(program: str, than: str) -> bool:
    """Whether a version of the program is newer than another; what is no version is old."""
    try:
        return Version(program) > Version(than)
    except InvalidVersion:
        return False


# Leases of a scheduler on its computations: renewed by a heartbeat, and heeded by whoever works under them.
#
# While a scheduler renews its leases nobody else takes up its computations. One that cannot (it died, was
# stopped, or lost the database) loses them: its workers end by themselves before the lease does, because what
# keeps them alive is the scheduler's word that it was renewed.


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
