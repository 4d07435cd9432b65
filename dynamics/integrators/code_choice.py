"""The choice between the ordinary compiled loops and machine code for the structure of a run.

The structure of a run is what is known of its arrays before it: dimensions, and which laws there are. Code
written out for it is faster, but has to be compiled, so it is made only where runs of the structure take
longer than that. It does what the ordinary loops do, to the last bit. It is kept in files: later processes
find it, and find the mark that a structure has been run for some time.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, cast

from dynamics.integrators.advance import advance
from dynamics.structure_code.arithmetic import Unsupported
from dynamics.structure_code.known_parts import Known
from dynamics.structure_code.machine_code import CodeStore, MachineCode
from dynamics.structure_code.module import Module
from dynamics.structure_code.structure import structure_key
from host import cpu_seconds

WORTHWHILE = 1.0
"""Code of a structure is made when its ordinary loops have taken this times the CPU time of compiling it."""
SEEN = 0.1
"""The same factor for a structure that was marked before this run: it is likely to be run again."""
MIN = 0.5
"""CPU time of compiling the smallest structure, s."""
SECONDS_PER_EXPRESSION = 5e-5
"""CPU time of compiling, s: measured 3e-5 to 11e-5 on modules of 15 000 to 130 000 expressions."""

_spent: dict[str, float] = {}
"""CPU time of ordinary loops in this process by the key of the structure, s."""
_expressions: dict[str, float] = {}
"""Expressions of the module of a structure by its key; infinite: it cannot be written out."""


@cache
def _store() -> CodeStore:
    return CodeStore(Path(str(advance.stats.cache_path)))  # where numba keeps the ordinary loops


class StructureCode:
    """Compiled loops that advance a run: the ordinary ones, or code for the structure of the run."""

    def __init__(self, implicit: bool, tuples: Mapping[Any, Known], *, makes: bool = True) -> None:
        """Look for the code of a structure.

        `tuples` are those arguments of `advance` that it gets by address, with what is known of each. Runs of
        the implicit method stay with the ordinary loops. Without `makes` code that exists is used, but no
        time is counted and none is made: so for a probe of the cost that no run follows.
        """
        self._tuples = tuples
        self._makes = makes
        self._code: MachineCode | None = None
        self._seen = False
        self._key = None if implicit else structure_key(tuples)  # None: always the ordinary loops
        if self._key is not None:
            self._code = _store().get(self._key)
            self._seen = _store().seen(self._key)

    @property
    def may_follow(self) -> bool:
        """Whether code for the structure does not exist yet, but may be made during a long run."""
        return self._key is not None and self._code is None

    def advance(self, passed: Any, stop: float, out: Any) -> int:
        """Advance the run to `stop` as the compiled `advance` does, and return its status.

        `passed` are the arguments of `advance` before `stop`; `out` receives the results. The CPU time of
        ordinary loops is counted.
        """
        if self._code is not None:
            return self._code.call("advance", *passed, stop, out)
        start = cpu_seconds()
        status = int(cast(Any, advance)(*passed, stop, out))
        if self._key is not None and self._makes:
            _spent[self._key] = _spent.get(self._key, 0.0) + cpu_seconds() - start
            self._code = self._worthwhile(self._key)
        return status

    def _worthwhile(self, key: str) -> MachineCode | None:
        """Return new code if ordinary loops have taken long enough for it, else None.

        The module, whose size gives the cost of compiling, takes time to write out. So the cost of the
        smallest structure is compared first, and the size is kept.
        """
        share = SEEN if self._seen else WORTHWHILE
        if _spent[key] >= SEEN * MIN:
            _store().note(key)  # the mark: the next run makes the code sooner
        if _spent[key] < share * MIN:
            return None
        module = None
        if key not in _expressions:
            module = _module(self._tuples)
            _expressions[key] = math.inf if module is None else module.expressions
        size = _expressions[key]
        if math.isinf(size) or _spent[key] < share * SECONDS_PER_EXPRESSION * size:
            return None
        module = module or _module(self._tuples)  # written again: some 10 MB that are not kept between calls
        return None if module is None else _store().add(key, module)


def _module(tuples: Mapping[Any, Known]) -> Module | None:
    """Return `advance` written out; None if a law cannot be written out or the source is missing."""
    module = Module()
    try:
        module.export(advance, tuples)
    except (Unsupported, OSError):
        return None
    return module
