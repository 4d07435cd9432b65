"""Readiness under load: waiting for one's turn is no fault for a while, what is broken is one at once."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from lineofaction.gearbox.problems import DatabaseDamaged, DatabaseUnavailable
from service.store import deployment
from service.store.deployment import WriteCheck


class Place:
    """A deployment whose writes end as they are told to."""

    def __init__(self) -> None:
        self.database: Callable[[], None] = lambda: None

    def write_database(self) -> None:
        self.database()

    def write_place(self) -> None:
        pass


def failing(error: Exception) -> Callable[[], None]:
    def step() -> None:
        raise error

    return step


@pytest.fixture
def place(monkeypatch: pytest.MonkeyPatch) -> Place:
    monkeypatch.setattr(deployment, "KEPT_S", -1.0)
    return Place()


def fault(check: WriteCheck) -> str:
    return check.outcome().fault


def test_one_that_waits_for_its_turn_is_ready_until_it_has_waited_too_long(
    place: Place, monkeypatch: pytest.MonkeyPatch
) -> None:
    """200 submissions at once held the database for a second, and a service at work said 503."""
    check = WriteCheck(place)  # type: ignore[arg-type]
    assert fault(check) == ""
    place.database = failing(DatabaseUnavailable("Others hold it."))
    assert fault(check) == ""
    monkeypatch.setattr(deployment, "LATE_S", -1.0)
    assert fault(check) == "Others hold it."


def test_one_that_has_never_written_is_not_ready(place: Place) -> None:
    place.database = failing(DatabaseUnavailable("Others hold it."))
    assert fault(WriteCheck(place)) == "Others hold it."  # type: ignore[arg-type]


def test_damage_is_told_at_once(place: Place) -> None:
    check = WriteCheck(place)  # type: ignore[arg-type]
    assert fault(check) == ""
    place.database = failing(DatabaseDamaged("It is malformed."))
    assert fault(check) == "It is malformed."
