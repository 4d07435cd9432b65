"""Checks of single values, each raising one clear `InputError`; see `bounds.Checks`."""

from __future__ import annotations

from bounds import Checks
from fe_contact.errors import InputError

_CHECKS = Checks(InputError)

finite = _CHECKS.finite
positive = _CHECKS.positive
within = _CHECKS.within
integer = _CHECKS.integer
increasing = _CHECKS.increasing
chosen = _CHECKS.chosen
declared_fields = _CHECKS.declared_fields
