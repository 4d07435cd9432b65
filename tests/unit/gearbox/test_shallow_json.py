"""JSON of others is read to a depth that does not depend on the version of Python."""

import json

import pytest

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.reading import read_table
from lineofaction.gearbox.shallow_json import DEEPEST, shallow_json


def tables(levels):
    return '{"pair":' * levels + "1" + "}" * levels


def lists(levels):
    return "[" * levels + "]" * levels


@pytest.mark.parametrize("nested", [tables, lists])
def test_it_is_read_down_to_the_deepest_level(nested):
    assert shallow_json(nested(DEEPEST)) == json.loads(nested(DEEPEST))
    for levels in (DEEPEST + 1, 400, 20_000, 200_000):
        with pytest.raises(RecursionError):
            shallow_json(nested(levels))


@pytest.mark.parametrize("text", ["1", '"a"', "null", "[]", '{"a": [1, {"b": null}]}'])
def test_what_is_shallow_comes_as_json_gives_it(text):
    assert shallow_json(text) == json.loads(text)


@pytest.mark.parametrize("levels", [400, 20_000])
@pytest.mark.parametrize("nested", [tables, lists])
def test_a_deep_case_is_refused_with_one_error(nested, levels, tmp_path):
    """Python 3.14 reads it; then the tables were walked down until the stack ended."""
    file = tmp_path / "deep.json"
    file.write_text(nested(levels))
    with pytest.raises(BadInput, match="JSON of less depth"):
        read_table(file)
