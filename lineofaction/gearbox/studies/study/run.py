"""Study of a scene: its runs, and their storage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from bounds.types import Json
from dynamics.study import Design, Study, StudyTask, keep_runs, study, with_effects
from dynamics.study.effect_decision import decision_points
from fe_contact.analysis.run_plan import predicted_designs
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means, SceneStudy, array_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.run_cost import run_cost
from lineofaction.gearbox.studies.scene_before_tables import CASES
from lineofaction.gearbox.studies.study import Inputs, StudyFigures
from lineofaction.gearbox.studies.study.design import design_of
from lineofaction.gearbox.studies.study.request import check_parts, factor_places, responses_of
from lineofaction.gearbox.studies.study.scenes import Location, VariedScene, mesh_of_case
from lineofaction.gearbox.units import UM
from model_studies.workers.content_digest import content_digest

PROBED = 3
"""Points of a study whose runs are probed before it begins."""


class _ScenesStudy(SceneStudy[Inputs, StudyFigures, Study]):
    inputs, answer, file = Inputs, StudyFigures, array_file(Study)
    resumed = True

    def check(self, scene: SceneInput, inputs: Inputs) -> None:
        """Refuse a path that names no number, a value that its field does not accept, too many points.

        Responses that have no meaning, or name no part of the scene, are refused too.
        """
        factor_places(scene, inputs)
        check_parts(scene, responses_of(inputs))

    def predicted(self, scene: SceneInput, inputs: Inputs, cache: Path | None) -> StudyCost | None:
        """Return the cost of the runs, by some steps of a few of them, and of the tables of other flanks.

        None: nothing predicts one of these runs.
        """
        places = factor_places(scene, inputs)
        with boundary_errors():
            design = design_of(scene, inputs, places)
        varied = VariedScene(scene.model_dump_json(), {}, places, "")
        count = len(design.points)
        cost = _flank_tables(scene, design, places, cache)
        probed: list[float] = []
        for values in design.points[np.unique(np.linspace(0, count - 1, PROBED).astype(int))]:
            try:
                varied_scene = varied.inputs(dict(zip(design.names, map(float, values), strict=True)))
                runs = run_cost(varied_scene, count, inputs.receipt)
            except BadInput:  # a point without a scene is left out
                continue
            if runs is None:
                return None
            probed.append(runs.seconds / count)
        return cost + StudyCost((Work("runs", float(np.mean(probed)), count, "runs"),)) if probed else None

    def compute(self, tabled: TabledScene, inputs: Inputs, means: Means) -> Study:
        places = factor_places(tabled.inputs, inputs)
        with boundary_errors():
            design = design_of(tabled.inputs, inputs, places)
            written = tabled.inputs.model_dump_json()
            scenes = VariedScene(written, tabled.databases, places, str(means.home))
            task = StudyTask(scenes, design.names, responses_of(inputs), inputs.start_s, inputs.receipt)
            task = with_effects(task, design, means.workers, means.report)
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
        echoed = inputs.model_dump(mode="json")
        return replace(result, metadata={**result.metadata, "design": echoed, "runs": runs})

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
            "effects": result.metadata.get("effects"),
        }

    def stored_runs(self, result: Study, means: Means) -> Mapping[str, Path]:
        if means.folder is None:
            return {}
        files = {key: means.folder / f"point_{point}.nc" for point, key in result.metadata["runs"].items()}
        return {key: file for key, file in files.items() if file.is_file()}

    def failure(self, result: Study) -> str:
        return "" if result.usable else f"No run has figures. The first: {result.reason[0]}"


def _flank_tables(
    scene: SceneInput, design: Design, places: Mapping[str, tuple[Location, ...]], cache: Path | None
) -> StudyCost:
    """Return the cost of the tables of all different flanks of the points."""
    columns, meshes = [], set[int]()
    for column, name in enumerate(design.names):
        of_flanks = {index for index in map(mesh_of_case, places[name]) if index is not None}
        if of_flanks:
            columns.append(column)
            meshes |= of_flanks
    cost = StudyCost(())
    if not columns:
        return cost
    points = np.vstack([design.points, decision_points(design.points, design.kinds)])
    different = len(np.unique(points[:, columns], axis=0))
    for index in sorted(meshes):
        case = scene.meshes[index].case
        if case is not None:
            with boundary_errors():
                predicted = predicted_designs(CASES.of(case).checked, cache)
            contacts = Work("contacts", predicted.design, different, "runs")
            cost += StudyCost((Work("gears", predicted.all_bodies, stage="runs"), contacts), predicted.bytes)
    return cost


def in_boundary_units(result: Study, response: int) -> tuple[str, float]:
    """Return the unit of a response at the boundary, and its SI value."""
    unit = result.unit[response]
    return ("um", UM) if unit == "m" else (unit, 1.0)


def _response_statistics(result: Study, response: int) -> Json:
    unit, scale = in_boundary_units(result, response)
    spread, correlation = result.spread(response), result.correlation(response)
    sampled = [k for k, kind in enumerate(result.kind) if kind not in ("grid", "list")]
    others = [k for k in range(len(result.factor)) if k not in sampled]
    quantiles = zip(spread.fraction, spread.quantile.T, spread.low.T, spread.high.T, strict=True)
    return {
        "name": result.response[response],
        "unit": unit,
        "mean": spread.mean / scale,
        "standard_error": spread.standard_error / scale,
        "confidence": result.confidence,
        "quantiles": [
            {"fraction": fraction, "value": value / scale, "low": low / scale, "high": high / scale}
            for fraction, value, low, high in quantiles
        ],
        "spread_of_level_means": {result.factor[k]: result.swing(k, response) / scale for k in others},
        "rank_correlation": {result.factor[k]: correlation[k] for k in sampled},
    }


def _responses_at(result: Study, point: int) -> Json:
    figures = {}
    for k, name in enumerate(result.response):
        unit, scale = in_boundary_units(result, k)
        value, error = result.figure[point, k] / scale, result.error[point, k] / scale
        figures[name] = {"value": value, "unit": unit, "error": error}
    return figures


def _values(result: Study, point: int) -> dict[str, float]:
    return dict(zip(result.factor, map(float, result.value[point]), strict=True))


RUN = _ScenesStudy()
