"""Arguments, help and examples of all verbs."""

from __future__ import annotations

import gc
import sys
from importlib import import_module
from typing import Any


class Later:
    """A module that does the work of verbs, imported when a name of it is first used (start-up time)."""

    def __init__(self, module: str) -> None:
        self._module = f"lineofaction.{module}"

    def __getattr__(self, name: str) -> Any:
        """Return the attribute of the module by this name.

        What modules make while they load stays: collections neither run then nor look at it later, which is
        a tenth of the start.
        """
        if self._module not in sys.modules and gc.isenabled():
            gc.disable()
            try:
                import_module(self._module)
                gc.freeze()
            finally:
                gc.enable()
        return getattr(import_module(self._module), name)
