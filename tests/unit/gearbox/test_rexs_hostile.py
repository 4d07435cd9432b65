"""Damaged and hostile REXS files: opened, or one clear error in bounded time, and nothing else is read."""

import json
import math
import random
import re
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hostile_rexs import JSON, XML, ZIP, damaged_files, hostile_files
from rexs_unit import STAGES, planetary, two_stages

from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import parsed, serialized
from lineofaction.gearbox.rexs.model import Document

HOSTILE = {name: (data, words) for name, data, words in hostile_files()}
MAX_SECONDS = 10.0  # the largest takes 2.5 s on a loaded machine
_touched: list[str] = []
_watching: list[bool] = []


def _note(event: str, details: tuple[object, ...]) -> None:
    """Note what is opened or connected to while a file is read."""
    if _watching and (event == "open" or event.startswith(("socket.", "os.listdir", "subprocess."))):
        _touched.append(f"{event} {details[:1]}")


@pytest.fixture(scope="module")
def watched():
    for data in (XML, JSON, ZIP):
        parsed(data)
    sys.addaudithook(_note)

    @contextmanager
    def watch():
        _touched.clear()
        _watching.append(True)
        try:
            yield
        finally:
            _watching.clear()
        assert not _touched

    return watch


def test_there_are_200_files():
    assert len(HOSTILE) + len(list(damaged_files())) >= 200


@pytest.mark.law
@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_with_one_error(name, watched):
    data, words = HOSTILE[name]
    start = time.process_time()
    with watched(), pytest.raises(BadInput, match=words) as caught:
        parsed(data)
    assert time.process_time() - start < MAX_SECONDS
    assert len(str(caught.value)) < 2_000 and "Traceback" not in str(caught.value)


def test_a_damaged_file_is_a_model_or_one_error(watched):
    refusals = 0
    for _, data in damaged_files():
        with watched():
            try:
                document = parsed(data)
            except BadInput:
                refusals += 1
            else:
                again = parsed(serialized(Document(document.model, document.files), "a.rexsz"))
                assert again.model == document.model
    assert refusals > 105


UNIT = Path(__file__).parents[3] / "examples" / "two_stage_gearbox.rexs"
WRONG = (b"0", b"-1", b"1e300", b"1e-300", b"3", b"77", b"1e20")


def wrong_units(count: int) -> Iterator[bytes]:
    """Yield a whole unit with a wrong number in one place: a value, an id or a reference."""
    text, chance = UNIT.read_bytes(), random.Random(3)
    places = [found.span(1) for found in re.finditer(rb'(?:>| id=")([-0-9.e+]+)["<]', text)]
    for _ in range(count):
        begin, end = chance.choice(places)
        yield text[:begin] + chance.choice(WRONG) + text[end:]


@pytest.mark.filterwarnings("ignore::bounds.PlausibilityWarning")
def test_a_unit_with_a_wrong_number_is_opened_or_refused_with_one_error():
    """What is opened accounts for all; where it has no scene or lacks a case, a line says why."""
    ends = [_end(data) for data in wrong_units(40)]
    for unit in (end for end in ends if isinstance(end, OpenedUnit)):
        refused = [line for line in unit.lines if line.fate == "refused"]
        assert (unit.scene is not None and len(unit.cases) == 2) or refused
    assert {type(end) for end in ends} == {OpenedUnit, str}


def _end(data: bytes) -> OpenedUnit | str:
    try:
        return OpenedUnit.of(parsed(data))
    except BadInput as error:
        assert len(str(error)) < 2_000
        return str(error)


def test_a_file_that_breaks_off_is_refused_by_its_last_line():
    with pytest.raises(BadInput, match=r"which line 2 is not") as caught:
        parsed(b'<model version="2.0.0">\n  <relations>')
    (fault,) = caught.value.faults
    assert (fault.field, fault.value) == ("file", "<relations>")


def _without(document: Document, seed: int) -> Document:
    """Return a document with an attribute or a relation gone, a unit swapped, or a value bent."""
    random = np.random.default_rng(seed)
    model = document.model
    relations, components = list(model.relations), list(model.components)
    kind = int(random.integers(4))
    if kind == 0:
        relations.pop(int(random.integers(len(relations))))
    else:
        index = int(random.choice([n for n, part in enumerate(components) if part.attributes]))
        values = list(components[index].attributes)
        at = int(random.integers(len(values)))
        bent: list[Any] = [-1.0, 0.0, 1e300, math.nan, True, "x", (), (1.0, 2.0), None]
        if kind == 1:
            values.pop(at)
        elif kind == 2:
            values[at] = replace(values[at], unit="kW")
        else:
            values[at] = replace(values[at], value=bent[int(random.integers(len(bent)))])
        components[index] = replace(components[index], attributes=tuple(values))
    return Document(replace(model, relations=tuple(relations), components=tuple(components)))


@pytest.mark.law
@pytest.mark.parametrize("make", [two_stages, planetary])
@pytest.mark.parametrize("seeds", [40, pytest.param(80, marks=pytest.mark.nightly)])
def test_a_damaged_unit_is_opened_or_refused_with_one_error(make, seeds):
    whole, refused, changed = OpenedUnit.of(make()), 0, 0
    for seed in range(seeds):
        try:
            unit = OpenedUnit.of(_without(make(), seed))
        except BadInput as error:
            refused += 1
            assert len(str(error)) < 2_000
        else:
            changed += unit.lines != whole.lines
            json.dumps(unit.files())
    assert refused >= seeds // 40 and changed > seeds // 3


@pytest.mark.parametrize("stage", STAGES)
def test_a_stage_without_a_gear_leaves_the_other(stage):
    unit = OpenedUnit.of(two_stages({11 if stage == STAGES[0] else 13: {"number_of_teeth": None}}))
    assert [case.stage for case in unit.cases] == [other for other in STAGES if other != stage]
