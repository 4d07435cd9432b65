"""Arguments, help and examples of all verbs."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class Later:
    """A module that does the work of verbs, imported when a name of it is first used (start-up time)."""

    def __init__(self, module: str) -> None:
        self._module = f"lineofaction.{module}"

    def __getattr__(self, name: str) -> Any:
        """Return what the module has under this name."""
        return getattr(import_module(self._module), name)
