"""The hash that names a result."""

from __future__ import annotations

import hashlib
import math

import numpy as np
import pytest

from fe_contact.errors import InputError
from fe_contact.ste.facts import content_hash


def test_is_sha256_of_the_canonical_text():
    """RFC 8785: keys sorted, no white space, numbers as ECMAScript writes them."""
    text = '{"case":{"a":[56,0.00001,1e+30],"b":"\\u20ac"},"schema_version":1,"solver_version":"0.1.0"}'
    case = {"b": "\u20ac", "a": [56.0, 1e-5, 1e30]}
    assert (
        content_hash(case, "0.1.0", 1)
        == hashlib.sha256(text.replace("\\u20ac", "\u20ac").encode()).hexdigest()
    )


def test_order_of_keys_and_spelling_of_numbers_do_not_matter():
    one = content_hash({"teeth": 20, "load": {"torque": 100, "kind": "x"}}, "0.1.0", 1)
    assert one == content_hash({"load": {"kind": "x", "torque": 1e2}, "teeth": 20.0}, "0.1.0", 1)


@pytest.mark.parametrize(
    "other",
    [({"teeth": 21}, "0.1.0", 1), ({"teeth": 20}, "0.1.1", 1), ({"teeth": 20}, "0.1.0", 2), ({}, "0.1.0", 1)],
)
def test_everything_that_decides_a_result_changes_it(other):
    assert content_hash(*other) != content_hash({"teeth": 20}, "0.1.0", 1)


def test_the_last_bit_of_a_number_counts():
    assert content_hash({"x": 0.1}, "", 1) != content_hash({"x": math.nextafter(0.1, 1.0)}, "", 1)


@pytest.mark.parametrize("value", [math.nan, math.inf, np.array([1.0]), {1}, 2**60, object()])
def test_what_is_not_json_is_refused(value):
    with pytest.raises(InputError, match="case = 'dict': must be plain JSON"):
        content_hash({"x": value}, "0.1.0", 1)
