"""The error tree of dynamics.

::

    DynamicsError
    |- InputError    the caller's: field, value, bound, suggestion
    |- SolveError    no static equilibrium, or a run that stopped early; carries the partial `RunResult`
    `- ResultError   a file is no run result, or of another schema, or damaged

Inner solvers return a status; only `simulate`, the scene's constructors and the readers raise.
"""

from __future__ import annotations

from typing import Any

from bounds import RefusedValue


class DynamicsError(Exception):
    """Anything this package raises on purpose."""


class InputError(DynamicsError, RefusedValue):
    """A value the caller gave cannot be used: field, value, bound and what to try, see `RefusedValue`."""


class SolveError(DynamicsError):
    """A run stopped early; `partial` holds the `RunResult` up to there, if there is one."""

    def __init__(self, message: str, partial: object = None) -> None:
        super().__init__(message)
        self.partial = partial

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle with the partial result."""
        return type(self), (self.args[0], self.partial)


class ResultError(DynamicsError):
    """A file is not a run result this version can read."""
