"""Study of a scene: its runs, and where they are kept."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from dynamics.mechanism.planet_copies import numbered, planet_parts
from dynamics.study import (
    Design,
    Factor,
    Levels,
    Listed,
    Normal,
    Response,
    Study,
    StudyTask,
    Uniform,
    keep_runs,
    study,
)
from fe_contact.analysis.run_plan import predicted_designs
from fe_contact.microgeometry.tolerances import PROCESS_SPREAD, iso1328_tolerances
from lineofaction.gearbox.convert.case import boundary_errors, gear_pair, table_axes
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means, SceneStudy, array_file
from lineofaction.gearbox.studies.cost import CASES, StudyCost, Work, run_cost
from lineofaction.gearbox.studies.study import MOST_POINTS, FactorInput, Inputs, StudyFigures
from lineofaction.gearbox.studies.study.scenes import (
    Place,
    VariedScene,
    check_flank,
    mesh_of_case,
    places_of,
    scene_of_json,
    with_value,
)
from lineofaction.gearbox.units import UM
from model_studies.workers.remembering import content_digest


class _ScenesStudy(SceneStudy[Inputs, StudyFigures, Study]):
    inputs, answer, file = Inputs, StudyFigures, array_file(Study)
    resumed = True

    def check(self, scene: SceneInput, inputs: Inputs) -> None:
        """Refuse a path that names no number, a value that its field does not accept, too many points.

        So are responses that cannot be, or name no part of the scene.
        """
        _factor_places(scene, inputs)
        _check_parts(scene, _responses(inputs))

    def predicted(self, scene: SceneInput, inputs: Inputs, cache: Path | None) -> StudyCost | None:
        """Return what its runs take, by some steps of a few of them, and the tables of other flanks.

        None: nothing predicts one of these runs.
        """
        places = _factor_places(scene, inputs)
        with boundary_errors():
            points = (design := _design_of(scene, inputs, places)).points
        varied, count = VariedScene(scene.model_dump_json(), {}, places, ""), len(points)
        cost, probed = _flank_tables(scene, design, places, cache), list[float]()
        for values in points[np.unique(np.linspace(0, count - 1, PROBED).astype(int))]:
            try:
                own = varied.inputs(dict(zip(design.names, map(float, values), strict=True)))
                runs = run_cost(own, count, inputs.receipt)
            except BadInput:  # a point without a scene is left out
                continue
            if runs is None:
                return None
            probed.append(runs.seconds / count)
        return cost + StudyCost((Work("runs", float(np.mean(probed)), count),)) if probed else None

    def compute(self, tabled: TabledScene, inputs: Inputs, means: Means) -> Study:
        places = _factor_places(tabled.inputs, inputs)
        with boundary_errors():
            design = _design_of(tabled.inputs, inputs, places)
            written = tabled.inputs.model_dump_json()
            scenes = VariedScene(written, tabled.databases, places, str(means.home))
            task = StudyTask(scenes, design.names, _responses(inputs), inputs.start_s, inputs.receipt)
            result = study(
                task,
                design,
                means.workers,
                means.report,
                confidence=inputs.confidence,
                keep_worst=inputs.keep_worst,
            )
            if means.folder is not None and result.worst.size:
                keep_runs(task, result, means.folder, means.report)
        runs = {str(k): content_digest((task, tuple(map(float, result.value[k])))) for k in result.worst}
        return replace(result, facts={**result.facts, "design": inputs.model_dump(mode="json"), "runs": runs})

    def _derived(self, result: Study) -> Json:
        integration = float(np.nanmean(result.seconds[:, 1])) if result.usable else None
        failed = [(k, reason) for k, reason in enumerate(result.reason) if reason]
        kinds = zip(result.factor, result.kind, strict=True)
        return {
            "points": len(result.reason),
            "factors": [{"path": name, "kind": kind} for name, kind in kinds],
            "responses": [_response_statistics(result, k) for k in range(len(result.response))],
            "worst": [
                {"point": k, "values": _values(result, k), "responses": _responses_at(result, k)}
                for k in map(int, result.worst)
            ],
            "failed": [{"point": k, "values": _values(result, k), "reason": reason} for k, reason in failed],
            "cpu_seconds": {"mean": float(np.mean(result.seconds[:, 0])), "integration_mean": integration},
        }

    def kept(self, result: Study, means: Means) -> Mapping[str, Path]:
        if means.folder is None:
            return {}
        files = {key: means.folder / f"point_{point}.nc" for point, key in result.facts["runs"].items()}
        return {key: file for key, file in files.items() if file.is_file()}

    def failure(self, result: Study) -> str:
        return "" if result.usable else f"No run has figures. The first: {result.reason[0]}"


PROBED = 3
"""Points of a study whose runs are probed before it begins."""


def _flank_tables(
    scene: SceneInput, design: Design, places: Mapping[str, tuple[Place, ...]], cache: Path | None
) -> StudyCost:
    """Return what the tables of all different flanks of the points take."""
    meshes = {name: {mesh_of_case(place) for place in at} - {None} for name, at in places.items()}
    columns = [k for k, name in enumerate(design.names) if meshes[name]]
    if not columns:
        return StudyCost(())
    different = len(np.unique(design.points[:, columns], axis=0))
    cost = StudyCost(())
    for index in sorted({index for own in meshes.values() for index in own if index is not None}):
        case = scene.meshes[index].case
        if case is not None:
            with boundary_errors():
                own = predicted_designs(CASES.of(case).checked, cache)
            cost += StudyCost((Work("gears", own.bodies), Work("contacts", own.design, different)), own.bytes)
    return cost


def in_boundary_units(result: Study, response: int) -> tuple[str, float]:
    """Return the unit of a response at the boundary, and what one of it is in SI."""
    unit = result.unit[response]
    return ("um", UM) if unit == "m" else (unit, 1.0)


def _response_statistics(result: Study, response: int) -> Json:
    unit, one = in_boundary_units(result, response)
    spread, correlation = result.spread(response), result.correlation(response)
    sampled = [k for k, kind in enumerate(result.kind) if kind not in ("grid", "list")]
    others = [k for k in range(len(result.factor)) if k not in sampled]
    quantiles = zip(spread.fraction, spread.quantile.T, spread.low.T, spread.high.T, strict=True)
    return {
        "name": result.response[response],
        "unit": unit,
        "mean": spread.mean / one,
        "standard_error": spread.standard_error / one,
        "confidence": result.confidence,
        "quantiles": [
            {"fraction": fraction, "value": value / one, "low": low / one, "high": high / one}
            for fraction, value, low, high in quantiles
        ],
        "spread_of_level_means": {result.factor[k]: result.swing(k, response) / one for k in others},
        "rank_correlation": {result.factor[k]: correlation[k] for k in sampled},
    }


def _responses_at(result: Study, point: int) -> Json:
    figures = {}
    for k, name in enumerate(result.response):
        unit, one = in_boundary_units(result, k)
        value, error = result.figure[point, k] / one, result.error[point, k] / one
        figures[name] = {"value": value, "unit": unit, "error": error}
    return figures


def _values(result: Study, point: int) -> dict[str, float]:
    return dict(zip(result.factor, map(float, result.value[point]), strict=True))


# The design of a study, from its file.


def _design_of(scene: SceneInput, inputs: Inputs, places: Mapping[str, tuple[Place, ...]]) -> Design:
    """Return the design; raises `BadInput`, `DynamicsError`."""
    factors = {f.path: _factor(k, f, scene, places[f.path]) for k, f in enumerate(inputs.factors)}
    return Design(factors, inputs.samples, inputs.seed)


def _factor(index: int, factor: FactorInput, scene: SceneInput, places: tuple[Place, ...]) -> Factor:
    if factor.levels is not None:
        return Levels(tuple(factor.levels))
    if factor.values is not None:
        return Listed(tuple(factor.values))
    if factor.uniform is not None:
        return Uniform(factor.uniform.low, factor.uniform.high)
    if factor.normal is not None:
        normal = factor.normal
        low = -np.inf if normal.low is None else normal.low
        high = np.inf if normal.high is None else normal.high
        return Normal(normal.mean, normal.standard_deviation, low, high)
    return _by_class(index, factor, scene, places)


def _by_class(index: int, factor: FactorInput, scene: SceneInput, places: tuple[Place, ...]) -> Normal:
    """Return the distribution within a class of ISO 1328 about the designed value, um."""
    limits = set()
    for place in places:
        case = scene.meshes[int(place[1])].case
        assert case is not None and factor.iso1328_class is not None
        gear, name = str(place[4]), str(place[5])
        widths = iso1328_tolerances(gear_pair(case), factor.iso1328_class).modification
        designed = float(getattr(getattr(case.pair, gear), name))
        limits.add((designed, widths[f"{gear}.{name.removesuffix('_um')}"]))
    if len(limits) > 1:
        raise BadInput.of(f"factors[{index}].path", factor.path, "of gears with one tolerance", "Name each.")
    ((design, width),) = limits
    half = width / UM
    return Normal(design, half / PROCESS_SPREAD, design - half, design + half)


# Checks of a study at the request: parts, paths, values, numbers of points.


def _responses(inputs: Inputs) -> tuple[Response, ...]:
    """Return what is taken from every run; raises `BadInput`."""
    responses = []
    for index, own in enumerate(inputs.responses):
        with named(f"responses[{index}]"):
            responses.append(Response(own.quantity, own.part or "", own.order or 0, own.mesh or ""))
    return tuple(responses)


def _check_parts(scene: SceneInput, responses: tuple[Response, ...]) -> None:
    """Every response names a mesh or a bearing of the scene, or of one of its planets."""
    meshes, bearings = _meshes_and_bearings(scene)
    for index, response in enumerate(responses):
        for field, name, known in (
            ("part", response.part, bearings if response.kind.of == "bearing" else meshes),
            ("mesh", response.mesh, meshes),
        ):
            if name and name not in known:
                raise BadInput.of(f"responses[{index}].{field}", name, f"one of {', '.join(known)}")


def _meshes_and_bearings(scene: SceneInput) -> tuple[list[str], list[str]]:
    """Return the names that the meshes and the bearings of a scene have with all its planets."""
    meshes = [mesh.name for mesh in scene.meshes]
    kinds: tuple[Sequence[Any], ...] = scene.bushings, scene.rolling_bearings, scene.planet_bearings
    bearings: list[str] = [part.name for part in chain.from_iterable(kinds)]
    for planets in scene.planets:
        own = planet_parts(scene, planets.planet)
        for index in range(1, planets.number):
            meshes += [numbered(name, index) for name in own[0]]
            bearings += [numbered(name, index) for name in own[1]]
    return meshes, bearings


def _factor_places(scene: SceneInput, inputs: Inputs) -> Mapping[str, tuple[Place, ...]]:
    """Return where every factor stands in the scene.

    Raises `BadInput`: a path that names no number, a value that its field does not accept, or too many
    points.
    """
    places = {}
    for index, factor in enumerate(inputs.factors):
        field = f"factors[{index}].path"
        places[factor.path] = places_of(scene, field, factor.path)
        for place in places[factor.path]:
            _check_case(scene, field, factor, place)
    _check_values(scene, inputs, places)
    return places


def _check_case(scene: SceneInput, field: str, factor: FactorInput, place: Place) -> None:
    """Refuse what of a case cannot be varied: only flanks can, at one alignment; a class is of slopes."""
    index = mesh_of_case(place)
    if index is None:
        if factor.iso1328_class is not None:
            bound = "of a profile or helix slope of a case"
            raise BadInput.of(field.replace("path", "iso1328_class"), factor.iso1328_class, bound)
        return
    check_flank(field, factor.path, place)
    mesh = scene.meshes[index]
    if mesh.case is None and mesh.case_file is None:
        raise BadInput.of(field, factor.path, f"of a mesh with a case: {mesh.name} takes a database")
    case = mesh.case
    if case and max(map(len, (table_axes(case).misalignments, case.errors.center_distance_change_mm))) > 1:
        bound = "of a case at one misalignment and one center distance"
        raise BadInput.of(field, factor.path, bound, "Vary the mesh's misalignment_um of another study.")
    if factor.iso1328_class is not None and place[-1] not in ("profile_slope_um", "helix_slope_um"):
        bound = "of profile_slope_um or helix_slope_um, which the standard has tolerances of"
        raise BadInput.of(field.replace("path", "iso1328_class"), factor.iso1328_class, bound)


def _check_values(scene: SceneInput, inputs: Inputs, places: Mapping[str, tuple[Place, ...]]) -> None:
    """Try the ends of the values, one factor at a time; those of cases are tried with their tables."""
    base = scene.model_dump(mode="json")
    for factor in inputs.factors:
        if any(mesh_of_case(place) is not None for place in places[factor.path]):
            continue
        for value in _ends(factor):
            table = copy.deepcopy(base)
            for place in places[factor.path]:
                with_value(table, place, value)
            scene_of_json(table)
    count = inputs.samples * math.prod(len(f.levels) for f in inputs.factors if f.levels)
    if count > MOST_POINTS:
        raise BadInput.of("factors", count, f"at most {MOST_POINTS} points in all")


def _ends(factor: FactorInput) -> tuple[float, ...]:
    """Return values of a factor that are tried: the ends, of a normal distribution its mean."""
    values = factor.levels or factor.values
    if values:
        return (min(values), max(values))
    if factor.uniform is not None:
        return (factor.uniform.low, factor.uniform.high)
    return (factor.normal.mean,) if factor.normal is not None else ()


RUN = _ScenesStudy()
