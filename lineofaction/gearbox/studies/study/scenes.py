"""The scenes of a study: a scene file in which some numbers are replaced.

A factor of the study names a number of the file by a path, and may stand for several locations. Factors of
flanks also need new STE tables, which are solved with the compliance of the same gears.
"""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from bounds.types import Json
from dynamics.scene import Scene
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.errors import FeContactError
from fe_contact.flank.drawing_starts import DrawingStarts
from fe_contact.flank.modification import FlankModification
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.housings import reduced_in
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.level_quantity import with_quantity
from lineofaction.gearbox.problems import BadInput, ServiceError
from lineofaction.gearbox.schemas.declared import figures
from lineofaction.gearbox.schemas.faults import faults_of, known_names, model_in
from lineofaction.gearbox.schemas.scene import SceneInput
from model_studies import LeftOut

Location = tuple[str | int, ...]
"""Keys and indices down to a number of the scene as JSON."""

_EVERY = "*"
"""Name in a path that stands for every part of a kind."""
_SLACK = 1.0 + 1e-9
"""Factor for the rounding of a largest load."""
TABLES = 8  # values of flanks whose tables stay in memory
_LENGTH_IN_FLANKS = 6
"""Length of a location of flanks: meshes, index, case, pair, pinion or wheel, field."""
_ENTRY = re.compile(r"^(\w+)(?:\[(\d+)\])?$")
FLANKS = tuple(figure.field for kind in (FlankModification, DrawingStarts) for figure in figures(kind))
"""Fields of a case that leave the bodies of its gears as they are."""


def places_of(scene: SceneInput, field: str, path: str) -> tuple[Location, ...]:
    """Return the places that a path names.

    Raises `BadInput`: there is no such field or part, or it is no number; the nearest names are suggested.

    Parameters
    ----------
    field : str
        Name of the path in an error.
    path : str
        ``KIND.NAME.FIELD`` of a part, where ``*`` names every part of its kind, or ``TABLE.FIELD``.
    """
    kind, _, rest = path.partition(".")
    parts = getattr(scene, kind, None)
    if kind not in SceneInput.model_fields:
        raise _unknown(field, path, kind, SceneInput.model_fields)
    if isinstance(parts, BaseModel):
        return ((kind, *_below(type(parts), field, path, rest)),)
    if not isinstance(parts, tuple):
        raise BadInput.of(field, path, "the path of a number", f"{kind} has none.")
    # parts of a kind without names go by their index
    names = {str(getattr(part, "name", index)): index for index, part in enumerate(parts)}
    name = next((n for n in sorted(names, key=len, reverse=True) if rest.startswith(f"{n}.")), None)
    if name is None and not rest.startswith(f"{_EVERY}."):
        raise _unknown(field, path, rest.partition(".")[0], [*names, _EVERY])
    chosen = [names[name]] if name is not None else list(names.values())
    further = rest[len(name or _EVERY) + 1 :]
    return tuple((kind, index, *_below(type(parts[index]), field, path, further)) for index in chosen)


def _below(model: type[BaseModel], field: str, path: str, rest: str) -> Iterator[str | int]:
    """Yield the keys and indices of the dotted path `rest` below a table with fields of `model`."""
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
    whole = SceneInput.MANUAL if isinstance(known, Mapping) else "the scene"
    remedy = f"Did you mean {' or '.join(close)}?" if close else known_names(name, list(known), whole)
    return BadInput.of(field, path, f'a path of the scene file: there is no "{name}"', remedy)


def mesh_of_case(location: Location) -> int | None:
    """Return the index of the mesh whose case a place is in; None if it is outside of cases."""
    kind, index, *_ = location
    in_case = kind == "meshes" and location[2] == "case"
    return index if in_case and isinstance(index, int) else None


def check_flank(field: str, path: str, location: Location) -> None:
    """Refuse a field of a case that is no figure of its flanks."""
    in_pair = location[3:4] == ("pair",) and location[4:5] in (("pinion",), ("wheel",))
    if not in_pair or len(location) != _LENGTH_IN_FLANKS or location[5] not in FLANKS:
        bound = "a figure of the flanks in pair.pinion or pair.wheel: other bodies need a table of their own"
        raise BadInput.of(field, path, bound, f"One of {', '.join(FLANKS)}.")


def with_value(table: Json, location: Location, value: float) -> None:
    """Put a value into the scene as JSON, in place; a location that is a list has it in all entries.

    Raises `BadInput`: a list has no such entry.
    """
    *way, last = location
    at: Any = table
    for key in way:
        if isinstance(key, str) and at.get(key) is None:
            at[key] = {}
        at = at[key]
    if isinstance(last, int):
        if last >= len(at):
            path = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in location)
            raise BadInput.of(path.lstrip("."), last, f"an entry below {len(at)}")
        at[last] = value
    elif isinstance(at.get(last), list):
        at[last] = [value] * max(len(at[last]), 1)
    else:
        at[last] = value


@dataclass(frozen=True)
class VariedScene:
    """A scene in which numbers are replaced; it fulfils the protocol `dynamics.study.run_study.Scenes`."""

    written: str
    """The scene as JSON, its cases written out."""
    databases: Mapping[str, SteDatabase]
    """STE databases by name of their mesh."""
    places: Mapping[str, tuple[Location, ...]]
    """Locations of every factor in the scene, by path of the factor."""
    home: str
    """Folder of the caches."""

    def scene(self, values: Mapping[str, float]) -> Scene:
        """Return the scene at values of the factors; raises `LeftOut` where there is none."""
        try:
            inputs = self.inputs(values)
            solids = inputs.housings, inputs.shafts, inputs.bushings, inputs.rolling_bearings
            databases = self._databases_of(inputs, self.expensive(values))
            name = ("reduced housings",)
            housings = self._reused(name, solids, lambda: reduced_in(inputs, Path(self.home)))
            return with_quantity(dynamic_scene(inputs, databases, housings), inputs, housings)
        except (ServiceError, FeContactError) as error:
            raise LeftOut(str(error)) from error

    def expensive(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Return the values of factors that change flanks, and so tables."""
        return {name: values[name] for name in self._of_flanks}

    def inputs(self, values: Mapping[str, float]) -> SceneInput:
        """Return the scene file at values of the factors; raises `BadInput`.

        Parts of the file in which no value is replaced are the same objects in the scenes of all values.
        """
        changes = [(location, value) for name, value in values.items() for location in self.places[name]]
        try:
            return SceneInput.model_validate(vars(self._base) | self._varied(changes))
        except (ValidationError, BadInput):  # validate the whole scene, whose errors name the full path
            table = self._table()
            for location, value in changes:
                with_value(table, location, value)
            return scene_of_json(table)

    def _varied(
        self, changes: Sequence[tuple[Location, float]]
    ) -> dict[str, BaseModel | tuple[BaseModel, ...]]:
        """Return the sections of the scene with replaced values: tables, and lists of tables."""
        by_part: dict[Location, list[tuple[Location, float]]] = {}
        for location, value in changes:
            depth = 2 if isinstance(location[1], int) else 1  # section and index of a part, or a table alone
            by_part.setdefault(location[:depth], []).append((location[depth:], value))
        changed: dict[str, Any] = {}
        for part_location, replaced in by_part.items():
            kind, indices = str(part_location[0]), [int(index) for index in part_location[1:]]
            section = changed.get(kind, getattr(self._base, kind))
            part = section[indices[0]] if indices else section
            made = self._reused(part_location, repr(replaced), partial(_with_values, part, replaced))
            for index in indices:  # at most one
                made = (*section[:index], made, *section[index + 1 :])
            changed[kind] = made
        return changed

    @cached_property
    def _base(self) -> SceneInput:
        return scene_of_json(self._table())

    @cached_property
    def _last(self) -> dict[Location, tuple[Any, Any]]:
        """The parts, tables and housings made last, each with the key of the inputs it was made from."""
        return {}

    @cached_property
    def _tables(self) -> dict[tuple[tuple[str, float], ...], Mapping[str, SteDatabase]]:
        """Tables by the values of the flanks that were used last: effects are decided at some of the runs."""
        return {}

    def _reused(self, name: Location, key: object, make: Callable[[], Any]) -> Any:
        """Return what was made last under a name if its key is equal; else make it anew."""
        known = self._last.get(name)
        if known is None or known[0] != key:
            known = key, make()
            self._last[name] = known
        return known[1]

    def _table(self) -> Json:
        return dict(json.loads(self.written))

    @cached_property
    def _of_flanks(self) -> tuple[str, ...]:
        return tuple(name for name, at in self.places.items() if any(mesh_of_case(p) is not None for p in at))

    @cached_property
    def _condensed(self) -> dict[str, CondensedPair]:
        """Gears with their compliance, of the meshes whose flanks change."""
        inputs = self._base
        changed = {mesh_of_case(location) for name in self._of_flanks for location in self.places[name]}
        condensed = {}
        for k, mesh in enumerate(inputs.meshes):
            if k not in changed:
                continue
            assert mesh.case is not None
            pair, effects = gear_pair(mesh.case), dict(mesh.case.effects)
            cache = Path(self.home) / "compliance"
            bodies = condensed_pair(pair, self.databases[mesh.name], effects, cache, compute=True)
            assert bodies is not None
            condensed[mesh.name] = bodies
        return condensed

    def _databases_of(self, inputs: SceneInput, values: Mapping[str, float]) -> Mapping[str, SteDatabase]:
        """Return the tables at values of the flanks."""
        if not values:
            return self.databases
        key = tuple(values.items())
        tables = self._tables.pop(key, None) or {**self.databases, **self._other_flanks(inputs)}
        self._tables[key] = tables  # the one used last is the last
        if len(self._tables) > TABLES:
            del self._tables[next(iter(self._tables))]
        return tables

    def _other_flanks(self, inputs: SceneInput) -> dict[str, SteDatabase]:
        """Solve the contact of changed flanks at all loads of the tables, including their support loads."""
        tables = {}
        for mesh in inputs.meshes:
            if mesh.name not in self._condensed:
                continue
            known, bodies = self.databases[mesh.name], self._condensed[mesh.name]
            assert mesh.case is not None
            pair = gear_pair(mesh.case)
            force = np.union1d(known.force, known.support_force)
            torques = np.asarray(pair.torque(force[force <= bodies.largest_load * _SLACK]))
            at = float(known.misalignment[0]), float(known.center_distance_change[0])
            tables[mesh.name] = bodies.table(pair, torques, *at)
        return tables


def _with_values(part: BaseModel, values: Sequence[tuple[Location, float]]) -> BaseModel:
    """Return a part with other values; raises `ValidationError`, `BadInput`."""
    table = part.model_dump(mode="json")
    for location, value in values:
        with_value(table, location, value)
    return type(part).model_validate_json(json.dumps(table))


def scene_of_json(table: Json) -> SceneInput:
    """Return the scene in plain JSON; raises `BadInput`."""
    try:
        # strict models take JSON's lists for tuples only from text
        return SceneInput.model_validate_json(json.dumps(table))
    except ValidationError as error:
        raise BadInput(faults_of(error, SceneInput)) from None
