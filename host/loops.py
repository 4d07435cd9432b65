"""Decorators of compiled loops: `njit` for those that Python calls, `inner` for those that loops call.

`LOA_PLAIN_LOOPS=1` takes numba as it is, without its cache: every process compiles what it needs. That is the
way beside `host.shared_loops`, which rests on internals of numba. Where numba is not installed Python
runs the loops, which is enough for reports: `host.interpreted_loops`.
"""

from __future__ import annotations

import os
from importlib.util import find_spec
from typing import TYPE_CHECKING

PLAIN = os.environ.get("LOA_PLAIN_LOOPS", "0") not in {"", "0"}
COMPILED = find_spec("numba") is not None
"""Whether loops can be compiled."""

if TYPE_CHECKING:
    from numba import njit

    from host.shared_loops import inner
elif not COMPILED:
    from host.interpreted_loops import inner, njit
elif PLAIN:
    from host.plain_loops import inner, njit
else:
    from host.shared_loops import inner, njit

__all__ = ["COMPILED", "PLAIN", "inner", "njit"]
