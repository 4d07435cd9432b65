"""Steps that outlast a lost connection: repeated for a while, then refused for the caller to repeat."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Concatenate, ParamSpec, Protocol, TypeVar, cast

import structlog
from sqlalchemy import Engine
from sqlalchemy.exc import DBAPIError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as PoolTimeout
from tenacity import RetryCallState, Retrying, retry_if_exception, stop_after_attempt, stop_after_delay
from tenacity.wait import wait_exponential, wait_random

from lineofaction.gearbox.problems import Busy, DatabaseDamaged, DatabaseUnavailable, NoSpace, OutOfFiles
from service.store.dialects import FILES, ROOM, dialect_of
from service.store.writers import TurnTimeout

logger = structlog.get_logger(__name__)
_ATTEMPTS = 6
_PATIENCE_S = 5.0
"""Seconds after which a step is not tried again: an attempt may already have waited for a lock as long as it
may."""
_FIRST_WAIT_S, _LONGEST_WAIT_S = 0.05, 1.0
_KINDS: Mapping[str, tuple[str, type[DatabaseUnavailable]]] = {
    ROOM: ("no space", NoSpace),
    FILES: ("out of files", OutOfFiles),
}
"""Event of the log and error, by the remedy, where a resource is short and the database itself is sound."""
P = ParamSpec("P")
R = TypeVar("R")


def _is_lost(error: BaseException, database: Engine) -> bool:
    """Whether `error` says that the database cannot be reached or asks to try again."""
    if not isinstance(error, DBAPIError) or _remedy_of(error, database) is not None:
        return False
    return dialect_of(database).lost(error)


def _is_busy(error: BaseException, database: Engine) -> bool:
    """Whether `error` says that others have had the database, or all connections to it, for too long."""
    if isinstance(error, DBAPIError):
        return dialect_of(database).busy(error)
    return isinstance(error, PoolTimeout | TurnTimeout)


def _remedy_of(error: BaseException, database: Engine) -> str | None:
    """Return the action of a person if `error` means that the database cannot be used as it is."""
    return dialect_of(database).remedy(error, database.url) if isinstance(error, DBAPIError) else None


class _OnDatabase(Protocol):
    """An object that works on a database."""

    _engine: Engine


S = TypeVar("S", bound=_OnDatabase)


def retried(step: Callable[Concatenate[S, P], R]) -> Callable[Concatenate[S, P], R]:
    """Return a method that is tried again after a lost connection.

    A second run must change nothing: the first may have been committed, with only the reply to it lost.

    Raises
    ------
    DatabaseUnavailable
        The database has not come back after about two seconds.
    Busy
        Others hold what is needed for too long.
    DatabaseDamaged
        The database is damaged or read-only and must be repaired. Not tried again.
    NoSpace, OutOfFiles
        Its disk is full, or this process may open no more files. Not tried again.
    """

    @functools.wraps(step)
    def run(self: S, *args: P.args, **kwargs: P.kwargs) -> R:
        engine = self._engine
        attempts = Retrying(
            retry=retry_if_exception(lambda error: _is_lost(error, engine) or _is_busy(error, engine)),
            stop=stop_after_attempt(_ATTEMPTS) | stop_after_delay(_PATIENCE_S),
            wait=wait_exponential(_FIRST_WAIT_S, _LONGEST_WAIT_S) + wait_random(0.0, _FIRST_WAIT_S),
            before_sleep=_note,
            reraise=True,
        )
        try:
            return attempts(step, self, *args, **kwargs)
        except SQLAlchemyError as error:
            outage = outage_of(error, engine)
            if outage is None:
                raise
            raise outage from error

    return cast(Callable[Concatenate[S, P], R], run)


def outage_of(error: SQLAlchemyError, engine: Engine) -> DatabaseUnavailable | None:
    """Return the outage that an error means; None: the statement is at fault, not the database."""
    if _is_busy(error, engine):
        return Busy("Others write, and have not ended in time. Nothing was changed. Try again later.")
    if _is_lost(error, engine):
        return DatabaseUnavailable("The database cannot be reached. Try again later.")
    if isinstance(error, DBAPIError) and dialect_of(engine).late(error):
        text = "The database has not answered in time. Ask for less of a list, or try again later."
        return DatabaseUnavailable(text)
    remedy = _remedy_of(error, engine)
    return None if remedy is None else unusable(engine, str(getattr(error, "orig", error)), remedy)


def unusable(engine: Engine, fault: str, remedy: str) -> DatabaseUnavailable:
    """Return the error of a database that needs a person; its address is for the log alone."""
    address = engine.url.render_as_string(hide_password=True)
    event, kind = _KINDS.get(remedy, ("database damaged", DatabaseDamaged))
    logger.error(event, database=address, error=fault, remedy=remedy)
    error = kind(f"{kind.title}: {fault}.")
    error.add_note(f"{address}: {remedy}")
    return error


def optional(step: Callable[Concatenate[S, P], None]) -> Callable[Concatenate[S, P], None]:
    """Return a method that does nothing, without an error, where the database is lost, busy or unusable."""

    @functools.wraps(step)
    def run(self: S, *args: P.args, **kwargs: P.kwargs) -> None:
        try:
            step(self, *args, **kwargs)
        except SQLAlchemyError as error:
            away = _is_lost(error, self._engine) or _is_busy(error, self._engine)
            if not away and _remedy_of(error, self._engine) is None:
                raise

    return cast(Callable[Concatenate[S, P], None], run)


def _note(state: RetryCallState) -> None:
    outcome = state.outcome
    error = outcome.exception() if outcome is not None else None
    logger.warning("database lost", attempt=state.attempt_number, error=type(error).__name__)
