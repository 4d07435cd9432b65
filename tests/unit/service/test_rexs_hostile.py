"""Damaged and hostile REXS files: one clear error in bounded time, nothing read outside the file."""

from __future__ import annotations

import random
import re
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from hostile_rexs import JSON, XML, ZIP, damaged_files, hostile_files

from lineofaction.gearbox.from_rexs.opened import OpenedUnit, opened
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import parsed, serialized
from lineofaction.gearbox.rexs.model import Document

HOSTILE = {name: (data, words) for name, data, words in hostile_files()}
MOST_SECONDS = 10.0  # the largest takes 2.5 s on a loaded machine

_touched: list[str] = []
_watching: list[bool] = []


def _note(event: str, details: tuple[object, ...]) -> None:
    """Note what is opened or connected to while a file is read."""
    if _watching and (event == "open" or event.startswith(("socket.", "os.listdir", "subprocess."))):
        _touched.append(f"{event} {details[:1]}")


@pytest.fixture(scope="module")
def watched() -> Callable[[], object]:
    """Return a context in which nothing may be opened."""
    for data in (XML, JSON, ZIP):
        parsed(data)
    sys.addaudithook(_note)

    @contextmanager
    def watch() -> Iterator[None]:
        _touched.clear()
        _watching.append(True)
        try:
            yield
        finally:
            _watching.clear()
        assert not _touched

    return watch


def test_there_are_200_files() -> None:
    assert len(HOSTILE) + len(list(damaged_files())) >= 200


@pytest.mark.law
@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_with_one_error(name: str, watched: Callable[[], Iterator[None]]) -> None:
    data, words = HOSTILE[name]
    start = time.process_time()
    with watched(), pytest.raises(BadInput, match=words) as caught:  # type: ignore[attr-defined]
        parsed(data)
    assert time.process_time() - start < MOST_SECONDS
    assert len(str(caught.value)) < 2_000 and "Traceback" not in str(caught.value)


def test_a_damaged_file_is_a_model_or_one_error(watched: Callable[[], Iterator[None]]) -> None:
    refusals = 0
    for _, data in damaged_files():
        with watched():  # type: ignore[attr-defined]
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
def test_a_unit_with_a_wrong_number_is_opened_or_refused_with_one_error() -> None:
    """What is opened accounts for all; where it has no scene or lacks a case, a line says why."""
    ends = [_end(data) for data in wrong_units(40)]
    for unit in (end for end in ends if isinstance(end, OpenedUnit)):
        refused = [line for line in unit.lines if line.fate == "refused"]
        assert (unit.scene is not None and len(unit.cases) == 2) or refused
    assert {type(end) for end in ends} == {OpenedUnit, str}


def _end(data: bytes) -> OpenedUnit | str:
    """Return the unit of a file, or the text of its one error."""
    try:
        return opened(parsed(data))
    except BadInput as error:
        assert len(str(error)) < 2_000
        return str(error)


def test_a_file_that_breaks_off_is_refused_by_its_last_line() -> None:
    with pytest.raises(BadInput, match=r"which line 2 is not") as caught:
        parsed(b'<model version="2.0.0">\n  <relations>')
    (fault,) = caught.value.faults
    assert (fault.field, fault.value) == ("file", "<relations>")
