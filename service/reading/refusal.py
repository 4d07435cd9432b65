"""The refusal of a file that ended its reader: which file or text of an order it was."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from lineofaction.gearbox.problems import BadInput

_TEXTS = ("toml", "csv", "rexs_base64")
_MAX_LENGTH = 20
_REMEDY = (
    "Export it again, or heal it in the program that wrote it; if it is large, leave out what is not needed."
)


def refusal(inputs: Mapping[str, Any], field: str, bound: str) -> BadInput:
    """Return the refusal of the file in a field of the inputs, or of the text in them where that has none."""
    sources = dict(_sources(inputs))
    texts = [name for name in sources if name.rpartition(".")[2] in _TEXTS]
    name = field if field in sources else next(iter([*texts, *sources]), "inputs")
    return BadInput.of(name, sources.get(name), bound, _REMEDY)


def _sources(value: object, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield the field of every file or text that is read, and the name of the file or how the text begins."""
    if isinstance(value, dict):
        if isinstance(value.get("name"), str) and isinstance(value.get("content"), str):
            yield path, value["name"]
            return
        for key, part in value.items():
            inside = f"{path}.{key}" if path else str(key)
            if key in _TEXTS and isinstance(part, str):
                yield inside, part[:_MAX_LENGTH]
            else:
                yield from _sources(part, inside)
    elif isinstance(value, list):
        for index, part in enumerate(value):
            yield from _sources(part, f"{path}[{index}]")
