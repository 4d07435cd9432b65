"""What sets a job apart: its inputs that differ from those of its caller's job before it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any, Self

Json = dict[str, Any]
Value = bool | int | float | str | list[bool | int | float | str | None] | None
_MOST = 12
_LONGEST_LIST, _LONGEST_TEXT = 16, 200


@dataclass(frozen=True)
class Difference:
    """An input that differs.

    Attributes
    ----------
    field : str
        Its path, such as ``case.load.torque_n_m`` or ``scene.shafts[0].length_mm``.
    before, value
        There and here; None where it is not stated. Of a long list or text its length in words.
    """

    field: str
    before: Value
    value: Value


@dataclass(frozen=True)
class Differences:
    """What sets a job apart.

    Attributes
    ----------
    since : str
        The job that it is compared with; empty: compared with the defaults.
    first : tuple[Difference, ...]
        The first ones in the order of the inputs, at most 12.
    number : int
        Of all.
    """

    since: str = ""
    first: tuple[Difference, ...] = ()
    number: int = 0

    @classmethod
    def between(cls, reference: Json, inputs: Json, since: str = "") -> Self:
        """Return the differences of `inputs` from `reference`; lists of tables are compared by place."""
        before, now = dict(_leaves(reference)), dict(_leaves(inputs))
        differing = [field for field in now | before if not _same(before.get(field), now.get(field))]
        first = (Difference(f, _short(before.get(f)), _short(now.get(f))) for f in differing[:_MOST])
        return cls(since, tuple(first), len(differing))

    @classmethod
    def of(cls, text: str) -> Self:
        """Return what `str` wrote; nothing of jobs from before differences were kept."""
        facts = json.loads(text or "{}")
        first = tuple(Difference(**difference) for difference in facts.pop("first", ()))
        return cls(**facts, first=first)

    def __str__(self) -> str:
        return json.dumps(asdict(self))


NOT_COMPARED = Differences()


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield paths and values of what is no table and no list of tables."""
    if isinstance(value, dict):
        for name, part in value.items():
            yield from _leaves(part, f"{path}.{name}" if path else name)
    elif isinstance(value, list) and any(isinstance(part, dict) for part in value):
        for index, part in enumerate(value):
            yield from _leaves(part, f"{path}[{index}]")
    else:
        yield path, value


def _same(first: Any, second: Any) -> bool:
    """Whether two values are the same; true is not 1."""
    return type(first) is type(second) and bool(first == second)


def _short(value: Any) -> Value:
    """Return a value, or its length in words if it is long."""
    if isinstance(value, list) and (len(value) > _LONGEST_LIST or any(isinstance(v, list) for v in value)):
        return f"list of {len(value)}"
    if isinstance(value, str) and len(value) > _LONGEST_TEXT:
        return f"text of {len(value)} characters"
    return value  # type: ignore[no-any-return]  # of JSON
