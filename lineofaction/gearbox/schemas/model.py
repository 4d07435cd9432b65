"""Models of the boundary, whose validation stops when enough is wrong: a body may hold a million faults.

A list of numbers or texts is left at its first fault. A list of tables, or a table of free names, that is
longer than it may be is not looked into, and of the fields that a table should not have the first 50 are
looked at. What is right is validated as before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import islice, pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NoReturn, TypeVar, cast

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, Strict
from pydantic_core import CoreSchema, PydanticCustomError, PydanticKnownError, core_schema

if TYPE_CHECKING:
    pass

HASH = "^[0-9a-f]{64}$"
"""Pattern of the names of results, which are content hashes."""
MAX_FAULTS = 50
"""Number of faults that are reported of one body."""

_MAX_ENTRIES = 1000
"""Most tables in a list, and most names in a table, where the field declares no other number."""
_TABLES = ("model", "definition-ref")
T = TypeVar("T")
Listed = Annotated[tuple[T, ...], Strict(False)]
"""A list, which Python has as a tuple."""
Name = Annotated[str, Field(min_length=1, max_length=64)]
Coordinate = Annotated[float, Field(ge=-1e6, le=1e6)]
Point = Annotated[Listed[Coordinate], Field(min_length=3, max_length=3)]
Acceleration = Annotated[Listed[Annotated[float, Field(ge=-1e6, le=1e6)]], Field(min_length=3, max_length=3)]
Number = Annotated[float, Field(ge=-1e9, le=1e9)]
_MANY = Field(min_length=1, max_length=100_000)
Times = Annotated[Listed[Annotated[float, Field(ge=0.0, le=1e9)]], _MANY]
Numbers = Annotated[Listed[Number], _MANY]
Course = Literal["linear", "smooth"]
Stiffness = Annotated[float, Field(ge=-1e15, le=1e15)]
SeatRow = Annotated[Listed[Stiffness], Field(min_length=5, max_length=6)]
SeatRows = Annotated[Listed[SeatRow], Field(min_length=5, max_length=6)]
HousingRow = Annotated[Listed[Stiffness], Field(min_length=3, max_length=6000)]
HousingRows = Annotated[Listed[HousingRow], Field(min_length=3, max_length=6000)]
CouplingRow = Annotated[Listed[Number], Field(min_length=6, max_length=6)]
CouplingRows = Annotated[Listed[CouplingRow], Field(min_length=6, max_length=6)]
Json = dict[str, Any]
_ABSENT: Json = {"type": "null"}
_NOT_NULL: Json = {"not": _ABSENT}
_NAMED = "x-named"


def _with_few_faults(schema: CoreSchema) -> CoreSchema:
    """Return the schema of a model so that its validation stops when enough is wrong."""
    for node in list(_nodes(cast(dict[str, Any], schema))):
        listed = node["type"] in ("tuple", "list")
        if listed and not any(entry["type"] in _TABLES for entry in _entries(node)):
            node["fail_fast"] = True
        elif listed or node["type"] == "dict":
            _look_first(node, partial(_not_longer, maximum=node.get("max_length", _MAX_ENTRIES)))
        elif node["type"] == "model-fields":
            _look_first(node, partial(_few_unknown, names=frozenset(node["fields"])))
    return schema


def _nodes(node: dict[str, Any], *, of_field: bool = False) -> Iterator[dict[str, Any]]:
    """Yield a schema and its inner schemas, except models of fields, which have their own bounds.

    A schema comes back as it was left for every model that has it in a field: what is bounded is not again.
    """
    if (of_field and node["type"] in _TABLES) or _looked_first(node):
        return
    yield node
    if "schema" in node:
        yield from _nodes(node["schema"], of_field=of_field)
    inside = [field["schema"] for field in node.get("fields", {}).values()]
    for inner in (*inside, *_entries(node)):
        yield from _nodes(inner, of_field=True)


def _entries(node: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the schemas of the entries of a list: a tuple may have several, a list has one or none."""
    entries = node.get("items_schema", [])
    return entries if isinstance(entries, list) else [entries]


def _look_first(node: dict[str, Any], look: Callable[[Any], Any]) -> None:
    """Let a function see the data of a schema before it is validated."""
    inner = dict(node)
    node.clear()
    node.update(core_schema.no_info_before_validator_function(look, inner))


def _looked_first(node: dict[str, Any]) -> bool:
    """Whether a schema is one of ours, which sees the data before another."""
    look = node["function"]["function"] if node["type"] == "function-before" else None
    return isinstance(look, partial) and look.func in (_not_longer, _few_unknown)


def _not_longer(data: Any, maximum: int) -> Any:
    if isinstance(data, list | tuple | dict) and len(data) > maximum:
        context = {"field_type": "List", "max_length": maximum, "actual_length": len(data)}
        raise PydanticKnownError("too_long", context)
    return data


def _few_unknown(data: Any, names: frozenset[str]) -> Any:
    """Return a table without most of the fields that it should not have."""
    if not isinstance(data, dict) or len(data) <= len(names) + MAX_FAULTS:
        return data
    unknown = set(islice((name for name in data if name not in names), MAX_FAULTS))
    return {name: value for name, value in data.items() if name in names or name in unknown}


class BoundaryModel(BaseModel):
    """A table of the case or scene file, or a JSON body: unknown fields and NaN are refused."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)
    MANUAL: ClassVar[str] = "docs/case-file.md"
    """Page of the manual with all fields."""

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type[BaseModel], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Stop looking when enough is wrong."""
        return _with_few_faults(handler(source))


def refuse(field: str, value: object, bound: str, suggestion: str = "") -> NoReturn:
    """Raise the fault of `field` (relative to the model) from a validator over several fields."""
    raise PydanticCustomError(
        "refused",
        "must be {bound}",
        {"field": field, "value": value, "bound": bound, "suggestion": suggestion},
    )


def refuse_unsorted(field: str, values: Sequence[float] | None, count: int | None = None) -> None:
    """Refuse a list that is not strictly increasing; its first `count` values are said."""
    if values is not None and any(later <= earlier for earlier, later in pairwise(values)):
        refuse(field, list(values)[:count], "strictly increasing", "Sort the list and drop repeats.")


if TYPE_CHECKING:
    Row = Sequence
else:
    Row = Listed
    """A `Listed` of a model that Python users fill in: a checker of types lets them write any sequence."""
