"""Differences between the inputs of a job and of its caller's job before it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from service.schemas.answers import Difference, Differences, Value

Json = dict[str, Any]
_MAX = 12
_LONGEST_LIST, _LONGEST_TEXT = 16, 200
NOT_COMPARED = Differences(since=None, first=[], number=0)


def differences_between(reference: Json, inputs: Json, since: str | None = None) -> Differences:
    """Return the differences of `inputs` from `reference`, which are the inputs of the job `since`.

    Without `since` the reference is the defaults. Lists of tables are compared by index. The answer lists the
    first differences in the order of the inputs, with the length in place of a long list or text.
    """
    before, now = dict(_leaves(reference)), dict(_leaves(inputs))
    pairs = {path: (before.get(path), now.get(path)) for path in now | before}
    # types count: True differs from 1
    differing = [path for path, (old, new) in pairs.items() if type(old) is not type(new) or old != new]
    first = [
        Difference(field=path, before=_short(pairs[path][0]), value=_short(pairs[path][1]))
        for path in differing[:_MAX]
    ]
    return Differences(since=since, first=first, number=len(differing))


def differences_column(differences: Differences) -> str:
    """Return differences as the job table has them."""
    return json.dumps(differences.model_dump())


def differences_of(column: str) -> Differences:
    """Return the differences from a column; none for jobs of versions that stored none."""
    content = json.loads(column or "{}")
    return Differences.model_validate(
        {"first": [], "number": 0, **content, "since": content.get("since") or None}
    )


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield paths and values that are no table and no list of tables."""
    if isinstance(value, dict):
        for name, part in value.items():
            yield from _leaves(part, f"{path}.{name}" if path else name)
    elif isinstance(value, list) and any(isinstance(part, dict) for part in value):
        for index, part in enumerate(value):
            yield from _leaves(part, f"{path}[{index}]")
    else:
        yield path, value


def _short(value: Any) -> Value:
    """Return a value, or its length in words if it is long."""
    if isinstance(value, list) and (len(value) > _LONGEST_LIST or any(isinstance(v, list) for v in value)):
        return f"list of {len(value)}"
    if isinstance(value, str) and len(value) > _LONGEST_TEXT:
        return f"text of {len(value)} characters"
    return value  # type: ignore[no-any-return]  # of JSON
