"""Integrity check of a whole database at the start: a service waits for it only briefly."""

from __future__ import annotations

import threading

from sqlalchemy import Engine

from lineofaction.gearbox.problems import ServiceError
from service.store.database import Schema

PATIENCE_S = 2.0
"""Seconds for which a start waits for the check. The check takes 0.1 to 1 s for 100 MB, many times that from
a cold disk."""


class IntegrityCheck:
    """A check of a database in a thread that ends with the check.

    Attributes
    ----------
    fault : ServiceError or None
        Damage, or the reason why the check failed; None: nothing so far.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self.fault: ServiceError | None = None
        self._thread = threading.Thread(target=self._look, name="integrity", daemon=True)

    def start(self) -> None:
        """Start the check; raises a fault that is found within `PATIENCE_S`, as `Schema.check`."""
        self._thread.start()
        self._thread.join(PATIENCE_S)
        self.confirm()

    def confirm(self) -> None:
        """Raise the fault that was found, if any."""
        if self.fault is not None:
            raise self.fault

    def _look(self) -> None:
        try:
            Schema(self._engine).check()
        except ServiceError as error:
            self.fault = error
