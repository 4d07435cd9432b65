"""The result that came with the program is the answer of a service that computes it."""

import json
from pathlib import Path
from typing import Any

import pytest
from condensed_once import find_condensed
from first_result import first_result
from page_visit import computed, served

STATIC = Path(__file__).parents[2] / "service" / "page" / "static"


@pytest.fixture(scope="module")
def address(tmp_path_factory, condensed_bodies):
    """A service of its own: in that of the pages nobody has analyzed the first example."""
    home = tmp_path_factory.mktemp("first")
    find_condensed(condensed_bodies, home / "lineofaction")
    with served(home) as found:
        yield found


@pytest.mark.nightly
def test_the_result_that_came_with_the_program_is_that_of_a_service(address):
    known = json.loads((STATIC / "first.json").read_text(encoding="utf-8"))
    computed(address, case=known["case"])
    assert_alike(first_result(address)["curve"], known["curve"])


def assert_alike(found: Any, known: Any) -> None:
    """Compare answers number by number."""
    if isinstance(known, dict):
        assert found.keys() == known.keys()
        for key, value in known.items():
            assert_alike(found[key], value)
    elif isinstance(known, list) and known and isinstance(known[0], (dict, list)):
        assert len(found) == len(known)
        for one, other in zip(found, known, strict=True):
            assert_alike(one, other)
    elif (isinstance(known, list) and None in known) or not isinstance(known, (int, float, list)):
        assert found == known
    else:
        assert found == pytest.approx(known, rel=1e-4, abs=1e-9)
