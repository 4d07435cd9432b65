import math
from dataclasses import dataclass

import pytest

from bounds import (
    Bound,
    Checks,
    Declared,
    Kind,
    RefusedValue,
    above,
    between,
    declarations,
    declared,
    described,
    from_to,
    one_of,
    required,
)

CHECKS = Checks(RefusedValue)
WIDTH = Declared(Kind.LENGTH, "m", between(0.0, 2.0), "Width of the strip", 0.5)
LAW = Declared(Kind.SHAPE, "", one_of(("flat", "round")), "Course across it", "flat")


@dataclass(frozen=True)
class Strip:
    """Has two declared fields and another."""

    width: float = declared(1.0, WIDTH)
    name: str = "strip"
    law: str = declared("flat", LAW)


def test_the_declared_fields_come_in_the_order_of_the_dataclass_with_their_defaults():
    assert dict(declarations(Strip)) == {"width": WIDTH, "law": LAW}
    assert list(declarations(Strip)) == ["width", "law"]
    assert Strip() == Strip(1.0, "strip", "flat")


@pytest.mark.parametrize(
    ("fields", "refused", "bound"),
    [
        ({"width": -1e-9}, "width", "from 0 to 2"),
        ({"width": math.nan}, "width", "a finite number"),
        ({"width": "2"}, "width", "a finite number"),
        ({"law": "oval"}, "law", 'one of "flat", "round"'),
    ],
)
def test_a_value_out_of_its_declared_bound_is_refused(fields, refused, bound):
    with pytest.raises(RefusedValue) as caught:
        CHECKS.declared_fields(Strip(**fields))
    assert (caught.value.field, str(caught.value.bound)) == (refused, bound)


def test_the_ends_of_a_declared_bound_are_accepted():
    for width in (0.0, 2.0):
        assert CHECKS.declared_fields(Strip(width, law="round")) is None  # raises otherwise


@pytest.mark.parametrize(
    ("bound", "inside", "beyond"),
    [
        (from_to(0.1, 0.3), (0.1, 0.1 + 0.2), (0.0999999, 0.3000001)),
        (above(0.0), (5e-324, 1e300), (0.0, -1.0)),
        (Bound(low=0.0, high=1.0, high_open=True), (0.0, 0.5), (1.0,)),
    ],
)
def test_a_bound_holds_its_ends_unless_they_are_open(bound, inside, beyond):
    assert all(bound.holds(value) for value in inside)
    assert not any(bound.holds(value) for value in beyond)


def test_a_docstring_can_say_what_the_fields_are():
    text = described(Strip).__doc__ or ""
    assert text.splitlines()[0] == "Has two declared fields and another."
    assert text.splitlines()[4:8] == [
        "width : m",
        "    Width of the strip",
        "law : name",
        "    Course across it",
    ]


@dataclass(frozen=True)
class Plate:
    """Has a field that is required and one that may be left out."""

    width: float = required(WIDTH)
    depth: float | None = declared(None, WIDTH)


def test_what_may_be_left_out_passes_and_what_is_required_does_not():
    CHECKS.declared_fields(Plate(1.0))
    with pytest.raises(TypeError):
        Plate()
    for given, field in ((Plate(None), "width"), (Plate(1.0, 3.0), "depth")):
        with pytest.raises(RefusedValue) as caught:
            CHECKS.declared_fields(given)
        assert caught.value.field == field


WHERE = Declared(Kind.LENGTH, "m", between(-1.0, 1.0), "Place in {unit} from the left; left out: there", 0.5)


@described
@dataclass(frozen=True)
class Mark:
    """Copies of it go on beyond its range."""

    place: float = declared(0.0, WHERE)

    def __post_init__(self) -> None:
        CHECKS.declared_fields(self, beyond=("place",))


def test_a_description_can_say_where_its_unit_stands():
    assert "Place in m from the left; left out: there" in (Mark.__doc__ or "")


def test_fields_beyond_their_range_are_finite():
    assert Mark(7.0).place == 7.0
    with pytest.raises(RefusedValue) as caught:
        Mark(math.inf)
    assert (caught.value.field, str(caught.value.bound)) == ("place", "a finite number")
