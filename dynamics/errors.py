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


class DynamicsError(Exception):
    """Anything this package raises on purpose."""


class InputError(DynamicsError):
    """A value the caller gave cannot be used.

    Parameters
    ----------
    field : str
        Dotted name of the field, e.g. ``"bushings[0].radial_stiffness"``.
    value : object
        What was given.
    bound : str
        What would be accepted, e.g. ``"above 0"``.
    suggestion : str
        What to try.
    """

    def __init__(self, field: str, value: object, bound: str, suggestion: str = "") -> None:
        self.field, self.value, self.bound, self.suggestion = field, value, bound, suggestion
        text = f"{field} = {value!r}: must be {bound}"
        super().__init__(f"{text}. {suggestion}" if suggestion else text)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by the four facts, so that the error crosses process boundaries whole."""
        return type(self), (self.field, self.value, self.bound, self.suggestion)

    def within(self, prefix: str) -> InputError:
        """Return the same error with its field named inside `prefix`."""
        return type(self)(f"{prefix}.{self.field}", self.value, self.bound, self.suggestion)


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
