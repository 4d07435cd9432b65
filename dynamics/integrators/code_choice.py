"""Runs in code of their own for their structure, where they take longer than compiling it.

The code does what the ordinary loops do, to the last bit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, cast

from dynamics.integrators.advance import advance
from dynamics.structure_code.arithmetic import Unsupported
from dynamics.structure_code.arrays import Known
from dynamics.structure_code.machine_code import CodeStore, MachineCode
from dynamics.structure_code.module import Module
from dynamics.structure_code.structure import structure_key
from host import cpu_seconds

WORTHWHILE = 1.0
"""CPU time of ordinary loops from which a structure gets code of its own, over that of compiling it."""
SEEN = 0.1
"""The same for a structure that has been run as long before."""
MIN = 0.5
"""CPU s of the smallest structure."""
SECONDS_PER_EXPRESSION = 5e-5
"""Measured: 3e-5 to 11e-5, of 15 000 to 130 000 expressions."""

_spent: dict[str, float] = {}
_expressions: dict[str, float] = {}
"""Of the modules of structures; infinite: it cannot be written out."""


@cache
def _store() -> CodeStore:
    return CodeStore(Path(str(advance.stats.cache_path)))


class StructureCode:
    """What moves a run on: the ordinary loops, or code for the structure of the run."""

    def __init__(self, implicit: bool, tuples: Mapping[Any, Known], *, makes: bool = True) -> None:
        """Look for the code of the structure of `tuples`, the arguments of `advance` by address.

        Without `makes` it takes code that is there, and counts nothing: a probe that no run follows.
        """
        self._tuples, self._code, self._seen, self._makes = tuples, None, False, makes
        self._key = None if implicit else structure_key(tuples)
        if self._key is not None:
            self._code, self._seen = _store().get(self._key), _store().seen(self._key)

    @property
    def may_follow(self) -> bool:
        """Whether a run that takes long enough is moved on by code that is not there yet."""
        return self._key is not None and self._code is None

    def advance(self, passed: Any, stop: float, out: Any) -> int:
        """Do what `advance` does, and count the time that ordinary loops take."""
        if self._code is not None:
            return self._code.call("advance", *passed, stop, out)
        ordinary, began = cast(Any, advance), cpu_seconds()
        status = int(ordinary(*passed, stop, out))
        if self._key is not None and self._makes:
            _spent[self._key] = _spent.get(self._key, 0.0) + cpu_seconds() - began
            self._code = self._worthwhile(self._key)
        return status

    def _worthwhile(self, key: str) -> MachineCode | None:
        """Return new code where ordinary loops have taken long enough for it."""
        share = SEEN if self._seen else WORTHWHILE
        if _spent[key] >= SEEN * MIN:
            _store().note(key)  # the next run makes it sooner
        if _spent[key] < share * MIN:
            return None
        module = None
        if key not in _expressions:
            module = _module(self._tuples)
            _expressions[key] = math.inf if module is None else module.expressions
        size = _expressions[key]
        if math.isinf(size) or _spent[key] < share * SECONDS_PER_EXPRESSION * size:
            return None
        module = module or _module(self._tuples)  # not kept in the meantime: it takes some 10 MB
        return None if module is None else _store().add(key, module)


def _module(tuples: Mapping[Any, Known]) -> Module | None:
    """Write out `advance`; None where a law cannot be, or where no source is at hand."""
    module = Module()
    try:
        module.export(advance, tuples)
    except (Unsupported, OSError):
        return None
    return module
