"""What the handlers work with."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from threading import Lock
from typing import Annotated

from fastapi import Depends, Request

from fe_contact.ste import SteDatabase
from service.jobs.live_desk import LiveDesk
from service.jobs.process import Registry
from service.jobs.scheduler import Scheduler
from service.jobs.submissions import Submissions
from service.settings import Settings
from service.store import ResultStore, StoredResult

_MOST_OPEN = 16


class OpenDatabases:
    """The databases asked last, read and verified once; they never change."""

    def __init__(self) -> None:
        self._open: OrderedDict[str, SteDatabase] = OrderedDict()
        self._lock = Lock()

    def get(self, store: ResultStore, key: str) -> SteDatabase:
        """Return the database `key`; raises as `ResultStore.verified`."""
        with self._lock:
            if key in self._open:
                self._open.move_to_end(key)
                return self._open[key]
        stored: StoredResult = store.verified(key, "database")
        database = SteDatabase.from_netcdf(stored.path)
        with self._lock:
            self._open[key] = database
            while len(self._open) > _MOST_OPEN:
                self._open.popitem(last=False)
        return database


@dataclass(frozen=True)
class Context:
    """Everything a handler may use."""

    settings: Settings
    registry: Registry
    submissions: Submissions
    scheduler: Scheduler
    store: ResultStore
    live: LiveDesk
    databases: OpenDatabases = field(default_factory=OpenDatabases)


def context_of(request: Request) -> Context:
    """Return the context of the app that serves `request`."""
    context: Context = request.app.state.context
    return context


Ctx = Annotated[Context, Depends(context_of)]
