"""Paths of factors: the places of a scene file that they name."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from fe_contact.flank.modification import FlankModification
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.declared import figures
from lineofaction.gearbox.schemas.faults import model_in
from lineofaction.gearbox.schemas.scene import SceneInput

Json = dict[str, Any]
Place = tuple[str | int, ...]
"""Keys and indices down to a number of the scene as JSON."""

_EVERY = "*"
_ENTRY = re.compile(r"^(\w+)(?:\[(\d+)\])?$")
_CASE = ("case", "pair")
FLANKS = tuple(figure.field for figure in figures(FlankModification))
"""Fields of a case that leave the bodies of its gears as they are."""


def places_of(scene: SceneInput, field: str, path: str) -> tuple[Place, ...]:
    """Return the places that a path names.

    Parameters
    ----------
    scene : SceneInput
    field : str
        What the path is called in an error.
    path : str
        ``KIND.NAME.FIELD`` of a part, where ``*`` names every part of its kind, or ``TABLE.FIELD``.

    Raises
    ------
    BadInput
        There is no such field or part, or it is no number; the nearest names are suggested.
    """
    kind, _, rest = path.partition(".")
    parts = getattr(scene, kind, None)
    if kind not in SceneInput.model_fields:
        raise _unknown(field, path, kind, SceneInput.model_fields)
    if isinstance(parts, BaseModel):
        return ((kind, *_below(type(parts), field, path, rest)),)
    if not isinstance(parts, tuple):
        raise BadInput.of(field, path, "the path of a number", f"{kind} has none.")
    names = {part_name(part, index): index for index, part in enumerate(parts)}
    name = next((n for n in sorted(names, key=len, reverse=True) if rest.startswith(f"{n}.")), None)
    if name is None and not rest.startswith(f"{_EVERY}."):
        raise _unknown(field, path, rest.partition(".")[0], [*names, _EVERY])
    chosen = [names[name]] if name is not None else list(names.values())
    further = rest[len(name or _EVERY) + 1 :]
    return tuple((kind, index, *_below(type(parts[index]), field, path, further)) for index in chosen)


def part_name(part: BaseModel, index: int) -> str:
    """Return the name of a part; of one without it, its number."""
    return str(getattr(part, "name", index))


def _below(model: type[BaseModel], field: str, path: str, rest: str) -> Iterator[str | int]:
    """Yield keys and indices below a table."""
    for name in rest.split("."):
        entry = _ENTRY.match(name)
        key = entry[1] if entry else name
        if key not in model.model_fields:
            raise _unknown(field, path, name, model.model_fields)
        yield key
        if entry and entry[2]:
            yield int(entry[2])
        inner = model_in(model.model_fields[key].annotation)
        if inner is not None:
            model = inner


def _unknown(field: str, path: str, name: str, known: Sequence[str] | Mapping[str, Any]) -> BadInput:
    close = difflib.get_close_matches(name[:64], list(known), n=3)
    advice = f"Did you mean {' or '.join(close)}?" if close else f"Known here: {', '.join(known)}."
    return BadInput.of(field, path, f'a path of the scene file: there is no "{name}"', advice)


def mesh_of_case(place: Place) -> int | None:
    """Return the index of the mesh whose case a place is in; None if it is outside of cases."""
    return place[1] if place[0] == "meshes" and place[2] == "case" and isinstance(place[1], int) else None


def check_flank(field: str, path: str, place: Place) -> None:
    """Refuse a field of a case that is no figure of its flanks."""
    in_pair = place[3:4] == ("pair",) and place[4:5] in (("pinion",), ("wheel",))
    if not in_pair or len(place) != 6 or place[5] not in FLANKS:
        bound = "a figure of the flanks in pair.pinion or pair.wheel: other bodies need a table of their own"
        raise BadInput.of(field, path, bound, f"One of {', '.join(FLANKS)}.")


def with_value(table: Json, place: Place, value: float) -> None:
    """Put a value into the scene as JSON, in place; a list takes it in all its entries.

    Raises
    ------
    BadInput
        A list has no such entry.
    """
    *way, last = place
    at: Any = table
    for key in way:
        if isinstance(key, str) and at.get(key) is None:
            at[key] = {}
        at = at[key]
    if isinstance(last, int):
        if last >= len(at):
            raise BadInput.of(_path_of(place), last, f"an entry below {len(at)}")
        at[last] = value
    elif isinstance(at.get(last), list):
        at[last] = [value] * max(len(at[last]), 1)
    else:
        at[last] = value


def _path_of(place: Place) -> str:
    """Return a place as faults name it."""
    text = ""
    for key in place:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else key
    return text
