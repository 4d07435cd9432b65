"""An interrupted table goes on where it was, and takes nothing that another question left."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fe_contact import Gear, GearPair, PitchDeviation, analyze
from fe_contact.analysis.pairs import contact_lines
from fe_contact.geometry import FlankModification, Shaft
from fe_contact.workers import Remembering, RunCost
from fe_contact.workers.remembering import content_digest

ASKED: dict[str, Any] = {"torques": [60.0, 150.0], "level": "draft", "positions": 24, "pitches": 1}


class Interrupted(Exception):
    """What a killed process does not raise; the test goes on."""


@dataclass(frozen=True)
class Here:
    """Workers of this process that count their tasks, and stop for good after so many."""

    most: int = 1_000_000
    cost: RunCost = field(default_factory=RunCost)
    tasks: list[str] = field(default_factory=list)

    def run(self, function: Callable[[Any, Any], Any], shared: Any, items: Sequence[Any]) -> Iterator[Any]:
        for item in items:
            if len(self.tasks) == self.most:
                raise Interrupted
            self.tasks.append(function.__name__)
            yield function(shared, item)


@pytest.fixture(autouse=True)
def small_tasks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut small tables as large ones are."""
    monkeypatch.setattr(contact_lines, "TASK_SECONDS", 0.005)


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("compliance")


def pair(crowning: float = 4e-6) -> GearPair:
    """Return a pair with everything that a task can hold."""
    deviation = PitchDeviation(tuple(np.linspace(0.0, 4e-6, 20)))
    modified = FlankModification(tip_relief=8e-6, tip_relief_length=2e-3, helix_crowning=crowning)
    plain: dict[str, Any] = {"teeth": 20, "normal_module": 4e-3, "face_width": 20e-3, "bore_diameter": 40e-3}
    first = Gear(**plain, helix_angle=radians(15), modification=modified, pitch_deviation=deviation)
    shaft = Shaft(length=0.2, diameter=0.03, position=0.1)
    return GearPair(first, Gear(**plain, helix_angle=-radians(15)), shafts=(shaft, shaft))


@pytest.mark.law
def test_an_interrupted_table_goes_on_where_it_was(cache: Path, tmp_path: Path) -> None:
    whole = analyze(pair(), **ASKED, cache=cache)
    first = Here(most=5)
    with pytest.raises(Interrupted):
        analyze(pair(), **ASKED, cache=cache, workers=Remembering(first, tmp_path, "1"))
    second, third = Here(), Here()
    for workers in (second, third):
        found = analyze(pair(), **ASKED, cache=cache, workers=Remembering(workers, tmp_path, "1"))
        for name in found.__dataclass_fields__:
            if isinstance(getattr(whole, name), np.ndarray):
                np.testing.assert_array_equal(getattr(found, name), getattr(whole, name), err_msg=name)
    alone = Here()
    analyze(pair(), **ASKED, cache=cache, workers=alone)
    assert len(second.tasks) == len(alone.tasks) - 5 > 5
    assert not third.tasks


def test_another_question_takes_nothing(cache: Path, tmp_path: Path) -> None:
    asked = {**ASKED, "positions": 12, "cache": cache, "receipt": "minimal"}
    counts = []
    for crowning, version in ((4e-6, "1"), (4e-6, "1"), (4.0000001e-6, "1"), (4e-6, "2")):
        workers = Here()
        analyze(pair(crowning), **asked, workers=Remembering(workers, tmp_path, version))
        counts.append(len(workers.tasks))
    assert counts[0] > 2 and counts == [counts[0], 0, counts[0], counts[0]]


def test_a_damaged_file_is_made_again(tmp_path: Path) -> None:
    assert list(Remembering(Here(), tmp_path, "1").run(divided, 1.0, [2.0, 4.0])) == [0.5, 0.25]
    for file, content in zip(sorted(tmp_path.iterdir()), (b"", b"x" * 99), strict=True):
        file.write_bytes(content)
    workers = Here()
    assert list(Remembering(workers, tmp_path, "1").run(divided, 1.0, [2.0, 4.0])) == [0.5, 0.25]
    assert len(workers.tasks) == 2


def test_what_nobody_can_tell_apart_is_not_kept(tmp_path: Path) -> None:
    assert list(Remembering(Here(), tmp_path, "1").run(named, object(), [2.0])) == ["2.0"]
    assert list(tmp_path.iterdir()) == []


def divided(shared: float, item: float) -> float:
    return shared / item


def named(shared: object, item: float) -> str:
    return str(item)


class Kind(Enum):
    """Two kinds."""

    ONE = 1
    TWO = 2


@dataclass(frozen=True)
class Thing:
    """Something with all sorts of fields."""

    size: float = 1.0
    values: Any = None
    seconds: float = 0.0


def test_content_decides_and_how_it_came_does_not() -> None:
    grid = np.arange(6.0).reshape(2, 3)
    one = Thing(1.0, (grid, "a", None, Kind.ONE, {"b": 1}))
    assert content_digest(one) == content_digest(Thing(1.0, (grid.copy(), "a", None, Kind.ONE, {"b": 1})))
    assert content_digest(one) == content_digest(replace(one, seconds=9.0))
    others = [
        replace(one, size=np.nextafter(1.0, 2.0)),
        replace(one, values=(grid.T.copy().T, "a", None, Kind.ONE, {"b": 1})),  # laid out otherwise
        replace(one, values=(grid.reshape(3, 2), "a", None, Kind.ONE, {"b": 1})),
        replace(one, values=(grid, "a", None, Kind.TWO, {"b": 1})),
        replace(one, values=(grid, "a", None, Kind.ONE, {"c": 1})),
        replace(one, values=(grid, "a", 0, Kind.ONE, {"b": 1})),
        replace(one, values=((grid, "a"), None, Kind.ONE, {"b": 1})),
    ]
    assert len({content_digest(each) for each in [one, *others]}) == len(others) + 1
