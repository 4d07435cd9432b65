"""An error of another process, reported as that process reported it."""

from __future__ import annotations

import json
from typing import Any

from lineofaction.gearbox.problems import ServiceError, last_part


class PropagatedError(ServiceError):
    """A problem as the live worker found it."""

    def __init__(self, facts: dict[str, Any]) -> None:
        self._facts = facts
        super().__init__(str(facts["detail"]))

    @property
    def kind(self) -> str:
        """Last part of the type of the problem that came."""
        return last_part(str(self._facts["type"]))

    def as_json(self) -> dict[str, Any]:
        """Return the problem details as they came."""
        return self._facts


def propagated(body: bytes) -> PropagatedError:
    """Return the error in the problem details `body`."""
    return PropagatedError(json.loads(body))
