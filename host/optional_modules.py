"""Modules of the extra `analysis`, loaded on first use: whatever reads a result starts without them.

What uses one that is not installed raises `MissingExtra`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from host.extras import missing_extra

if TYPE_CHECKING:
    import fast_simplification
    import pandas
    import scipy
    import skfem
    import xarray
    from scipy import fft, linalg, optimize, sparse, spatial, special
    from scipy.sparse import csgraph
    from scipy.sparse import linalg as sparse_linalg

__all__ = [
    "csgraph",
    "fast_simplification",
    "fft",
    "linalg",
    "optimize",
    "pandas",
    "scipy",
    "skfem",
    "sparse",
    "sparse_linalg",
    "spatial",
    "special",
    "xarray",
]

_ADDRESSES = {
    "csgraph": "scipy.sparse.csgraph",
    "sparse_linalg": "scipy.sparse.linalg",
    **{name: f"scipy.{name}" for name in ("fft", "linalg", "optimize", "sparse", "spatial", "special")},
}
"""Address of each module that is not at the top."""


class OptionalModule:
    """A module that is loaded when its first name is read."""

    def __init__(self, address: str) -> None:
        self._address = address

    def __getattr__(self, name: str) -> Any:
        try:
            module = import_module(self._address)
        except ModuleNotFoundError as error:
            raise missing_extra(error) or error from None
        value = getattr(module, name)
        vars(self)[name] = value  # found there from now on
        return value


def load_numerics() -> None:
    """Load the modules of SciPy, for a warm process whose forks shall find them."""
    for address in _ADDRESSES.values():
        import_module(address)


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = globals()[name] = OptionalModule(_ADDRESSES.get(name, name))
    return module
