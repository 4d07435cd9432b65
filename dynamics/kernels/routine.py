"""`routine` makes a `Routine` of a function; where numba is not installed Python runs the function."""

from __future__ import annotations

from functools import update_wrapper
from typing import TYPE_CHECKING

from host.loops import COMPILED

if TYPE_CHECKING or COMPILED:
    from dynamics.kernels.compiled_routine import Routine
else:

    class Routine:
        """A function that is always prepared."""

        prepared = True

        def __init__(self, function):
            update_wrapper(self, function)
            self._function = function

        def prepare(self, *_):
            """Do nothing: there is nothing to compile."""

        def __call__(self, *arguments):
            """Call the function."""
            return self._function(*arguments)


routine = Routine

__all__ = ["Routine", "routine"]
