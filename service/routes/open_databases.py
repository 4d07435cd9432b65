"""Open STE databases, the most recently queried ones."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from functools import cached_property
from threading import Lock
from typing import TYPE_CHECKING

from lineofaction.gearbox.loading import LOADING
from service.store.results import ResultStore

if TYPE_CHECKING:
    from fe_contact.ste import SteDatabase
    from fe_contact.ste.compiled_force import CompiledForce


_MAX_OPEN = 16


@dataclass(frozen=True)
class _OpenDatabase:
    """A database and, once somebody asks for forces, its compiled law."""

    database: SteDatabase

    @property
    def compiled(self) -> bool:
        """Whether the law is at hand."""
        return "law" in self.__dict__

    @cached_property
    def law(self) -> CompiledForce:
        """The compiled force; raises as `boundary_errors` of what `CompiledForce.of` raises."""
        with LOADING:
            from fe_contact.ste.compiled_force import CompiledForce  # noqa: PLC0415 (loads the compiler)
            from lineofaction.gearbox.convert.boundary_errors import boundary_errors  # noqa: PLC0415

        with boundary_errors():
            return CompiledForce.of(self.database)


class OpenDatabases:
    """The databases queried last, read and verified once; they never change."""

    def __init__(self) -> None:
        self._open: OrderedDict[tuple[str, str], _OpenDatabase] = OrderedDict()
        self._lock, self._reading = Lock(), Lock()

    def at_hand(self, store: ResultStore, key: str) -> _OpenDatabase | None:
        """Return the database `key` if it is open: no file is touched, nobody is waited for."""
        address = store.project, key
        with self._lock:
            if address in self._open:
                self._open.move_to_end(address)
            return self._open.get(address)

    def get(self, store: ResultStore, key: str) -> _OpenDatabase:
        """Return the database `key`, read if it is not open; raises as `ResultStore.verified`."""
        opened = self.at_hand(store, key)
        if opened is not None:
            return opened
        with self._reading:  # many ask for a new table at once: it is read once
            return self.at_hand(store, key) or self._read(store, key)

    def _read(self, store: ResultStore, key: str) -> _OpenDatabase:
        """Read and verify a database; beyond `_MAX_OPEN` the least recently queried one is closed."""
        with LOADING:
            from fe_contact.ste import SteDatabase  # noqa: PLC0415 (start-up time)

        opened = _OpenDatabase(SteDatabase.from_netcdf(store.verified(key, "database").path))
        with self._lock:
            self._open[store.project, key] = opened
            while len(self._open) > _MAX_OPEN:
                self._open.popitem(last=False)
        return opened
