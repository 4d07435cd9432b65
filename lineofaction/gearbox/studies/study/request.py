"""Checks of a study at its request: parts, paths, values, numbers of points."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Any

from dynamics.mechanism.planet_copies import numbered, planet_parts
from dynamics.study import Response
from lineofaction.gearbox.convert.boundary_errors import named
from lineofaction.gearbox.convert.case import table_axes
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.study import MAX_POINTS, FactorInput, Inputs
from lineofaction.gearbox.studies.study.scenes import (
    Location,
    check_flank,
    mesh_of_case,
    places_of,
    scene_of_json,
    with_value,
)


def responses_of(inputs: Inputs) -> tuple[Response, ...]:
    """Return the responses of every run; raises `BadInput`."""
    responses = []
    for index, entry in enumerate(inputs.responses):
        with named(f"responses[{index}]"):
            responses.append(Response(entry.quantity, entry.part or "", entry.order or 0, entry.mesh or ""))
    return tuple(responses)


def check_parts(scene: SceneInput, responses: tuple[Response, ...]) -> None:
    """Refuse responses of a mesh or bearing that neither the scene nor one of its planets has."""
    meshes, bearings = names_with_planets(scene)
    for index, response in enumerate(responses):
        for field, name, known in (
            ("part", response.part, bearings if response.kind.of == "bearing" else meshes),
            ("mesh", response.mesh, meshes),
        ):
            if name and name not in known:
                raise BadInput.of(f"responses[{index}].{field}", name, f"one of {', '.join(known)}")


def names_with_planets(scene: SceneInput) -> tuple[list[str], list[str]]:
    """Return the names that the meshes and the bearings of a scene have with all its planets."""
    meshes = [mesh.name for mesh in scene.meshes]
    kinds: tuple[Sequence[Any], ...] = scene.bushings, scene.rolling_bearings, scene.planet_bearings
    bearings: list[str] = [part.name for part in chain.from_iterable(kinds)]
    for planets in scene.planets:
        copied = planet_parts(scene, planets.planet)
        for index in range(1, planets.number):
            meshes += [numbered(name, index) for name in copied[0]]
            bearings += [numbered(name, index) for name in copied[1]]
    return meshes, bearings


def factor_places(scene: SceneInput, inputs: Inputs) -> Mapping[str, tuple[Location, ...]]:
    """Return the locations of every factor in the scene.

    Raises `BadInput`: a path that names no number, a value that its field does not accept, or too many
    points.
    """
    places = {}
    for index, factor in enumerate(inputs.factors):
        field = f"factors[{index}].path"
        places[factor.path] = places_of(scene, field, factor.path)
        for location in places[factor.path]:
            _check_case(scene, field, factor, location)
    _check_values(scene, inputs, places)
    return places


def _check_case(scene: SceneInput, field: str, factor: FactorInput, location: Location) -> None:
    """Refuse fields of a case but its flanks, several alignments, and a class of a field that is no slope."""
    index = mesh_of_case(location)
    if index is None:
        if factor.iso1328_class is not None:
            bound = "of a profile or helix slope of a case"
            raise BadInput.of(field.replace("path", "iso1328_class"), factor.iso1328_class, bound)
        return
    check_flank(field, factor.path, location)
    mesh = scene.meshes[index]
    if mesh.case is None and mesh.case_file is None:
        raise BadInput.of(field, factor.path, f"of a mesh with a case: {mesh.name} takes a database")
    case = mesh.case
    if case and max(map(len, (table_axes(case).misalignments, case.errors.center_distance_change_mm))) > 1:
        bound = "of a case at one misalignment and one center distance"
        raise BadInput.of(field, factor.path, bound, "Vary the mesh's misalignment_um of another study.")
    if factor.iso1328_class is not None and location[-1] not in ("profile_slope_um", "helix_slope_um"):
        bound = "of profile_slope_um or helix_slope_um, which the standard has tolerances of"
        raise BadInput.of(field.replace("path", "iso1328_class"), factor.iso1328_class, bound)


def _check_values(scene: SceneInput, inputs: Inputs, places: Mapping[str, tuple[Location, ...]]) -> None:
    """Check the ends of the values, one factor at a time; values of cases are checked with their tables."""
    base = scene.model_dump(mode="json")
    for factor in inputs.factors:
        if any(mesh_of_case(location) is not None for location in places[factor.path]):
            continue
        for value in _ends(factor):
            table = copy.deepcopy(base)
            for location in places[factor.path]:
                with_value(table, location, value)
            scene_of_json(table)
    count = inputs.samples * math.prod(len(f.levels) for f in inputs.factors if f.levels)
    if count > MAX_POINTS:
        raise BadInput.of("factors", count, f"at most {MAX_POINTS} points in all")


def _ends(factor: FactorInput) -> tuple[float, ...]:
    """Return values of a factor that are tried: the ends, of a normal distribution its mean."""
    values = factor.levels or factor.values
    if values:
        return (min(values), max(values))
    if factor.uniform is not None:
        return (factor.uniform.low, factor.uniform.high)
    return (factor.normal.mean,) if factor.normal is not None else ()
