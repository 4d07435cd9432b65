"""Named tuples by address (`tuple_addresses`); without numba, loops take the tuples themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from host.loops import COMPILED

if TYPE_CHECKING or COMPILED:
    from dynamics.kernels.tuple_addresses import by_address, by_value, with_numbers
else:

    def by_address(value):
        """Return the tuple itself."""
        return value

    def with_numbers(*_):
        """Return the decorator that leaves a class as it is."""
        return by_address

    by_value = by_address

__all__ = ["by_address", "by_value", "with_numbers"]
