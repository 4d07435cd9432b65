"""numba, whose cache may hold loops that name what an upgrade has taken away: they are compiled anew.

An entry is renewed with the file of its loop; it also names modules and functions that the loop calls.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit
from numba.core.caching import IndexDataCacheFile

__all__ = ["njit"]


def _unless_gone(load: Callable[..., Any], absent: Callable[[], Any]) -> Callable[..., Any]:
    def guarded(*arguments: Any) -> Any:
        try:
            return load(*arguments)
        except (AttributeError, ImportError):
            return absent()

    return guarded


for _name, _absent in (("load", lambda: None), ("_load_index", dict)):
    if _load := getattr(IndexDataCacheFile, _name, None):
        setattr(IndexDataCacheFile, _name, _unless_gone(_load, _absent))
