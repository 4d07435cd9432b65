"""Values that a caller sets over the values of a case or scene file."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lineofaction.gearbox.problems import BadInput

Json = dict[str, Any]

_FORM = "PATH=VALUE, as in pair.pinion.tip_relief_um=20"
_ENTRY = re.compile(r"^([^.\[\]]+)(?:\[(\d+)\])?$")
_EVERY = "*"


@dataclass(frozen=True)
class InputFile:
    """A file and what is set over it, in order; `project` is the folder that was named in its place.

    `part` is what names of results begin with, where the folder has several such files.
    """

    path: Path
    overrides: tuple[Override, ...] = ()
    project: Path | None = None
    part: str = ""

    @classmethod
    def named(cls, name: str) -> InputFile:
        """Return the file of a name as it is."""
        return cls(Path(name))

    @classmethod
    def of(cls, source: Path | InputFile) -> InputFile:
        """Return a file, one that is named as it is."""
        return source if isinstance(source, InputFile) else cls(source)

    @property
    def folder(self) -> Path:
        """The folder to which the names of files in this file are relative."""
        return self.path.parent

    def __str__(self) -> str:
        return str(self.path)

    @property
    def as_it_is(self) -> Path:
        """The file, of one whose values cannot be set.

        Raises `BadInput`: values are set.
        """
        if self.overrides:
            first = self.overrides[0]
            raise BadInput.of(first.path, first.value, "left out: only a case or a scene file takes values")
        return self.path

    def applied(self, table: Json) -> Json:
        """Return the table of the file with the overrides in it.

        Raises `BadInput`: a path runs through a value that is no table, or names no part of a list.
        """
        if not self.overrides:
            return table
        changed = deepcopy(table)
        for override in self.overrides:
            for owner, key in _places(changed, override, override.path.split(".")):
                if override.value is not None:
                    owner[key] = override.value
                elif isinstance(owner, dict):
                    owner.pop(key, None)
        return changed


@dataclass(frozen=True)
class Override:
    """A value that takes the place of a file's."""

    path: str
    """Names from the top of the file, ``pair.pinion.teeth``; an entry of a list by ``[0]``, by the ``name``
    of a part (``loads.brake.torque_n_m``) or ``*`` for all.
    """
    value: Any
    """Value in TOML's types; None leaves the field out."""

    @classmethod
    def of(cls, text: str) -> Override:
        """Return the override of ``PATH=VALUE``: a TOML value, or else a text; no value leaves the field out.

        Raises `BadInput`: it has another form.
        """
        path, sign, typed = text.partition("=")
        names = path.strip().split(".")
        if not sign or not all(_ENTRY.match(name) for name in names):
            raise BadInput.of("--set", text, f"of the form {_FORM}", "Several: --set A=1 --set B=2.")
        return cls(path.strip(), _value(typed.strip()))


def _value(text: str) -> Any:
    """Return the value of a typed text in TOML's types."""
    if not text:
        return None
    try:
        table = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return text
    return table["value"] if set(table) == {"value"} else text


def _places(owner: Any, override: Override, names: Sequence[str]) -> Iterator[tuple[Any, Any]]:
    """Yield tables or lists with the key that the rest of a path names in them; missing tables are made."""
    first, rest = names[0], names[1:]
    for holder, key in _entries(owner, override, first):
        if not rest:
            yield holder, key
            continue
        if isinstance(holder, dict):
            holder.setdefault(key, {})
        yield from _places(holder[key], override, rest)


def _entries(owner: Any, override: Override, name: str) -> Iterator[tuple[Any, Any]]:
    """Yield the holders and keys of one part of a path."""
    match = _ENTRY.match(name)
    key, index = (match[1], match[2]) if match else (name, None)
    if isinstance(owner, list):
        yield from ((owner, at) for at in _parts(owner, override, key))
    elif not isinstance(owner, dict):
        raise _no_such_part(override, f"inside a table, which {owner!r} is not", "Shorten the path.")
    elif index is None:
        yield owner, key
    else:
        entries = owner.get(key)
        count = len(entries) if isinstance(entries, list) else 0
        if int(index) >= count:
            raise _no_such_part(override, f"an entry of a list: {key} has {count}", "They count from 0.")
        yield entries, int(index)


def _parts(parts: list[Any], override: Override, name: str) -> list[int]:
    names = [part.get("name") if isinstance(part, dict) else None for part in parts]
    chosen = [index for index, known_name in enumerate(names) if name in (_EVERY, known_name)]
    if not chosen:
        known = ", ".join(str(known_name) for known_name in names if known_name is not None) or "[0], [1] ..."
        raise _no_such_part(override, f'a part of the file: there is no "{name}"', f"Known here: {known}.")
    return chosen


def _no_such_part(override: Override, bound: str, remedy: str) -> BadInput:
    return BadInput.of(override.path, override.value, bound, remedy)
