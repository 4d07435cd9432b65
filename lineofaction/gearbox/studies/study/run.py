"""Study of a scene: its runs, and where they are kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from dynamics.study import Study, StudyTask, keep_runs, study
from fe_contact.workers.content import content_digest
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.studies.computation import Computation, Means, with_defaults
from lineofaction.gearbox.studies.result_file import array_file
from lineofaction.gearbox.studies.study import Inputs
from lineofaction.gearbox.studies.study.checks import check
from lineofaction.gearbox.studies.study.design import design_of, responses_of
from lineofaction.gearbox.studies.study.figures import facts
from lineofaction.gearbox.studies.study.scenes import VariedScene


def study_of(tabled: TabledScene, inputs: Inputs, means: Means) -> Study:
    """Run a study of a scene.

    Raises
    ------
    BadInput
        A factor, a response or a design that there is not.
    """
    places = check(tabled.inputs, inputs)
    with boundary_errors():
        design = design_of(tabled.inputs, inputs, places)
        responses = responses_of(tabled.scene, inputs)
        written = tabled.inputs.model_dump_json()
        scenes = VariedScene(written, tabled.databases, places, str(means.home))
        task = StudyTask(scenes, design.names, responses, inputs.start_s, inputs.receipt)
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
    return replace(result, facts={**result.facts, "design": with_defaults(inputs), "runs": runs})


def kept(result: Study, means: Means) -> Mapping[str, Path]:
    """Return the files of the runs that were kept, by the hash that they are stored under."""
    if means.folder is None:
        return {}
    files = {key: means.folder / f"point_{point}.nc" for point, key in result.facts["runs"].items()}
    return {key: file for key, file in files.items() if file.is_file()}


def missing(result: Study) -> str:
    """Say that no run has figures."""
    return "" if result.usable else f"No run has figures. The first: {result.reason[0]}"


RUN = Computation(
    study_of,
    facts,
    array_file(Study),
    check=check,
    resumed=True,
    kept=kept,
    failure=missing,
)
