"""The error tree of fe_contact.

::

    FeContactError
    |- InputError             the caller's: field, value, bound, suggestion
    |  `- InfeasibleGeometry  the numbers are legal one by one, but no such gear or pair exists
    |- MeshError              gmsh failed, or a mesh missed its quality limits
    |- SolveError             a solve did not converge; carries the partial result
    `- DatabaseError          a file is no STE database, or of another schema, or damaged

Inner solvers return a `Status` with residuals; only `analyze` and the readers raise.
"""

from __future__ import annotations

from typing import Any, Self

from bounds import Checks, RefusedValue, Wording


class FeContactError(Exception):
    """Anything this package raises on purpose."""


class InputError(FeContactError, RefusedValue):
    """A value the caller gave cannot be used: field, value, bound and what to try, see `RefusedValue`."""


class InfeasibleGeometry(InputError):
    """The numbers are legal one by one, but no such gear or pair exists.

    `name` is the standard term for what is wrong: "pointed tooth", "interference", "contact ratio",
    "tip clearance", "profile shift sum", "jamming", "undercut" ...
    """

    def __init__(
        self, name: str, field: str, value: object, bound: Wording, suggestion: Wording = ""
    ) -> None:
        self.name = name
        super().__init__(field, value, bound, suggestion)
        self.args = (f"{name}: {self.args[0]}",)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle with the name."""
        return type(self), (self.name, self.field, self.value, self.bound, self.suggestion)

    def within(self, prefix: str) -> Self:
        """Return the same error with its field named inside `prefix`."""
        return type(self)(self.name, f"{prefix}.{self.field}", self.value, self.bound, self.suggestion)


class MeshError(FeContactError):
    """Mesh failure: gmsh failed, or an element missed its quality limit."""


class SolveError(FeContactError):
    """A solve did not converge; `partial` holds whatever was computed."""

    def __init__(self, message: str, partial: object = None) -> None:
        super().__init__(message)
        self.partial = partial


class DatabaseError(FeContactError):
    """A file is not an STE database this version can read."""


_CHECKS = Checks(InputError)

finite = _CHECKS.finite
positive = _CHECKS.positive
within = _CHECKS.within
integer = _CHECKS.integer
increasing = _CHECKS.increasing
chosen = _CHECKS.chosen
declared_fields = _CHECKS.declared_fields
