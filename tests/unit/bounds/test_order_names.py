"""Orders have the names of what makes them."""

import pytest

from bounds import order_name, order_words

PAIR = {"mesh": 1.0}, {"pinion": 1 / 23, "wheel": 1 / 67}
STAGES = {"first": 1.0, "second": 20 / 61}, {"input": 1 / 23, "middle": 1 / 61, "output": 20 / 61 / 59}


@pytest.mark.parametrize(
    ("order", "named"),
    [
        (2.0, "mesh 2"),
        (11 / 23, "pinion 11"),
        (92 / 23, "mesh 4"),
        (22 / 23, "mesh 1 - pinion 1"),
        (2 + 3 / 23, "mesh 2 + pinion 3"),
        (2 + 4 / 23, "pinion 50"),
        (1 / 67, "wheel 1"),
        (3 / (23 * 67), ""),
    ],
)
def test_orders_of_a_pair(order, named):
    assert order_name(order, *PAIR) == named


@pytest.mark.parametrize(
    ("order", "named"),
    [
        (3.0, "first 3"),
        (2 * 20 / 61, "second 2"),
        (20 / 61 - 1 / 61, "second 1 - middle 1"),
        (7 / 23, "input 7"),
    ],
)
def test_orders_of_two_stages(order, named):
    assert order_name(order, *STAGES) == named


@pytest.mark.law
@pytest.mark.parametrize(
    ("order", "shaft", "harmonic", "words"),
    [
        (27.0, "pinion", "harmonic 1", "order 27.0 of the pinion, harmonic 1"),
        (80.0 / 3.0, "shaft 3", "harmonic 4 of second", "order 26.67 of shaft 3, harmonic 4 of second"),
        (0.5, "wheel", "", "order 0.5 of the wheel"),
        (1234.0, "input", "", "order 1234.0 of input"),
    ],
)
def test_an_order_is_named_by_its_shaft_and_its_harmonic(order, shaft, harmonic, words):
    assert order_words(order, shaft, harmonic) == words
