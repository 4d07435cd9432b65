"""Blocks of work in which errors of the libraries become those of the boundary.

The fields and units of a case or scene are loaded with the first such error, since most work raises none.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from dynamics.errors import InputError
from fe_contact.errors import FeContactError
from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import BadInput
from model_studies.workers import WorkersLost

_translated = on_demand("lineofaction.gearbox.convert.errors:translated")


@contextmanager
def boundary_errors(prefix: str = "") -> Iterator[None]:
    """Turn errors of the libraries into the boundary's."""
    try:
        yield
    except (FeContactError, WorkersLost) as error:
        known = _translated(error)
        if isinstance(known, BadInput) and prefix:
            known = known.within(prefix)
        raise known or error from None


@contextmanager
def named(part: str) -> Iterator[None]:
    """Turn input errors of dynamics into the boundary's, named inside `part`."""
    try:
        yield
    except InputError as error:
        raise _translated(error.within(part) if part else error) or error from None
