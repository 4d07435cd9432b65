"""Cases and scenes made ready to be sent: files of the caller written out."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from service.input_file import InputFile
from service.problems import BadInput
from service.schemas import Case, read_model, read_table, validated
from service.schemas.scene import MeshInput, SceneInput

CaseLike = Case | Mapping[str, Any] | Path | InputFile
SceneLike = SceneInput | Mapping[str, Any] | Path | InputFile


def case_of(case: CaseLike) -> Case:
    """Return a case from a model, a table or a file; raises `BadInput`."""
    if isinstance(case, Case):
        return case
    return read_model(Case, case) if isinstance(case, Path | InputFile) else validated(Case, dict(case))


def case_inputs(case: CaseLike) -> dict[str, Any]:
    """Return ``{"case": ...}`` as JSON; raises `BadInput`."""
    return {"case": case_of(case).model_dump(mode="json")}


def scene_of(scene: SceneLike) -> tuple[SceneInput, Path]:
    """Return a scene and the folder its files are relative to; raises `BadInput`."""
    if isinstance(scene, SceneInput):
        return scene, Path()
    if isinstance(scene, Path | InputFile):
        return read_model(SceneInput, scene), InputFile.of(scene).folder
    return validated(SceneInput, dict(scene)), Path()


def scene_inputs(scene: SceneLike) -> dict[str, Any]:
    """Return ``{"scene": ...}`` as JSON, its case files written out; raises `BadInput`."""
    return {"scene": portable_scene(*scene_of(scene)).model_dump(mode="json")}


def inputs_of(source: CaseLike | SceneLike) -> dict[str, Any]:
    """Return ``{"case": ...}``, or of what has shafts ``{"scene": ...}``, as JSON; raises `BadInput`."""
    if isinstance(source, SceneInput) or (not isinstance(source, Case) and "shafts" in _table(source)):
        return scene_inputs(source)
    return case_inputs(source)


def _table(source: Mapping[str, Any] | Path | InputFile) -> Mapping[str, Any]:
    """Return the table that was given, or that a file holds."""
    return read_table(source) if isinstance(source, Path | InputFile) else source


def case_of_mesh(mesh: MeshInput, field: str, folder: Path) -> Case | None:
    """Return the case of a mesh, from the scene or its file; None if the mesh names a database."""
    if mesh.case_file is None:
        return mesh.case
    try:
        return read_model(Case, folder / mesh.case_file)
    except BadInput as error:
        raise error.within(f"{field}.case_file") from None


def portable_scene(scene: SceneInput, folder: Path) -> SceneInput:
    """Return the scene with its case files written out.

    Raises
    ------
    BadInput
        A case file cannot be used, or a mesh takes a database file, which a service does not read.
    """
    meshes = []
    for index, mesh in enumerate(scene.meshes):
        field = f"meshes[{index}]"
        if mesh.database_file is not None:
            advice = "Give case_file or database_hash, or run the scene here without a service."
            raise BadInput.of(f"{field}.database_file", mesh.database_file, "left out for a service", advice)
        case = case_of_mesh(mesh, field, folder)
        meshes.append(mesh.model_copy(update={"case": case, "case_file": None}))
    return scene.model_copy(update={"meshes": tuple(meshes)})
