"""Checks of single values, each raising one clear `InputError`; see `bounds.Checks`."""

from __future__ import annotations

from collections.abc import Sequence

from bounds import Checks
from dynamics.errors import InputError

_CHECKS = Checks(InputError)

finite = _CHECKS.finite
positive = _CHECKS.positive
not_negative = _CHECKS.not_negative
within = _CHECKS.within
integer = _CHECKS.integer
one_of = _CHECKS.one_of
increasing = _CHECKS.increasing
chosen = _CHECKS.chosen
declared_fields = _CHECKS.declared_fields


def distinct(field: str, names: Sequence[str]) -> None:
    """Refuse empty or repeated names."""
    for index, name in enumerate(names):
        if not name or name in names[:index]:
            raise InputError(f"{field}[{index}].name", name, "a name that no other one of them has")
