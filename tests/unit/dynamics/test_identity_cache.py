"""Results that are kept by the identity of what they are made from."""

import gc
import weakref
from dataclasses import dataclass

import pytest

from dynamics.identity_cache import MAX_CACHED, cached_by, identity_cached


@dataclass(frozen=True)
class Frozen:
    """Data that is equal to another one, and has no hash."""

    values: list[float]


def counted() -> tuple[list[Frozen], object]:
    """A cached function, and what it was called with."""
    calls: list[Frozen] = []

    @identity_cached
    def total(data, factor):
        calls.append(data)
        if factor < 0.0:
            raise ValueError("negative")
        return [factor * value for value in data.values]

    return calls, total


def test_a_result_is_made_once_for_each_object_and_argument():
    calls, total = counted()
    one, equal = Frozen([1.0]), Frozen([1.0])
    assert total(one, 2.0) is total(one, 2.0)
    assert total(equal, 2.0) is not total(one, 2.0)
    assert total(one, 3.0) == [3.0]
    assert [data is one for data in calls] == [True, False, True]


def test_a_tuple_is_the_same_if_its_parts_are():
    one, other = Frozen([1.0]), Frozen([1.0])
    joined = identity_cached(lambda parts: [*parts])
    assert joined((one, other)) is joined((one, other))
    assert joined((one, other)) is not joined((one, one))


def test_data_is_the_same_if_the_parts_that_are_read_are():
    values = [1.0]
    total = cached_by(lambda data: (data.values,))(lambda data: [sum(data.values)])
    assert total(Frozen(values)) is total(Frozen(values))
    assert total(Frozen(values)) is not total(Frozen([1.0]))


def test_an_error_is_raised_each_time():
    calls, total = counted()
    one = Frozen([1.0])
    for _ in range(2):
        with pytest.raises(ValueError, match="negative"):
            total(one, -1.0)
    assert len(calls) == 2


def test_only_the_last_results_are_kept():
    first, total = Frozen([0.0]), identity_cached(lambda data: list(data.values))
    gone = weakref.ref(first)
    total(first)
    del first
    gc.collect()
    assert gone() is not None
    for k in range(MAX_CACHED):
        total(Frozen([float(k)]))
    gc.collect()
    assert gone() is None
