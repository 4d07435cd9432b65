"""Cases and scenes from models, tables or files, with the content of the files that they name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from pydantic import BaseModel

from lineofaction.gearbox import schemas
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import BadInput

if TYPE_CHECKING:
    from lineofaction.gearbox.from_rexs.opened import OpenedUnit
    from lineofaction.gearbox.schemas.meshes import MeshInput

CaseLike: TypeAlias = "schemas.Case | Mapping[str, Any] | Path | InputFile"
SceneLike: TypeAlias = "schemas.SceneInput | Mapping[str, Any] | Path | InputFile"
StudyLike: TypeAlias = "Mapping[str, Any] | Path | InputFile"
Subject: TypeAlias = "schemas.Case | schemas.SceneInput | OpenedUnit | Mapping[str, Any] | Path | str"


def case_of(case: CaseLike) -> schemas.Case:
    """Return a case from a model, a table or a file; raises `BadInput`."""
    if isinstance(case, schemas.Case):
        return case
    if isinstance(case, Path | InputFile):
        return schemas.read_model(schemas.Case, case)
    return schemas.validated(schemas.Case, _table("case", case))


def case_inputs(case: CaseLike) -> dict[str, Any]:
    """Return ``{"case": ...}`` as JSON; raises `BadInput`."""
    return {"case": case_of(case).model_dump(mode="json")}


def scene_of(scene: SceneLike) -> tuple[schemas.SceneInput, Path]:
    """Return a scene and the folder its files are relative to; raises `BadInput`."""
    if isinstance(scene, schemas.SceneInput):
        return scene, Path()
    if isinstance(scene, Path | InputFile):
        return schemas.read_model(schemas.SceneInput, scene), InputFile.of(scene).folder
    return schemas.validated(schemas.SceneInput, _table("scene", scene)), Path()


def scene_inputs(scene: SceneLike) -> dict[str, Any]:
    """Return ``{"scene": ...}`` as JSON, its case files written out; raises `BadInput`."""
    return {"scene": _portable_scene(*scene_of(scene)).model_dump(mode="json")}


def inputs_of(source: CaseLike | SceneLike) -> dict[str, Any]:
    """Return ``{"case": ...}``, or with shafts ``{"scene": ...}``, as JSON; raises `BadInput`."""
    if isinstance(source, schemas.Case):
        return case_inputs(source)
    if isinstance(source, schemas.SceneInput):
        return scene_inputs(source)
    table = schemas.read_table(source) if isinstance(source, Path | InputFile) else _table("case", source)
    return scene_inputs(source) if "shafts" in table else case_inputs(source)


def study_inputs(study: StudyLike) -> dict[str, Any]:
    """Return the inputs of a study from a table or a file, as JSON; raises `BadInput`."""
    table = schemas.read_table(study) if isinstance(study, Path | InputFile) else _table("study", study)
    return {name: _plain(value) for name, value in table.items()}


def _plain(value: Any) -> Any:
    """Return a value of JSON: any sequence as a list, any model as a table."""
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json")
    if isinstance(value, Mapping):
        return {name: _plain(part) for name, part in value.items()}
    is_sequence = isinstance(value, Iterable) and not isinstance(value, str)
    return [_plain(part) for part in value] if is_sequence else value


def _table(field: str, source: object) -> dict[str, Any]:
    """Return a table; raises `BadInput`: another value, such as a path as text."""
    if isinstance(source, Mapping):
        return dict(source)
    remedy = "A file is given as pathlib.Path."
    text = source if isinstance(source, str) else repr(source)
    raise BadInput.of(field, text[:80], f"a Path, a dictionary or a model of a {field}", remedy)


def case_of_mesh(mesh: MeshInput, field: str, folder: Path) -> schemas.Case | None:
    """Return the case of a mesh, from the scene or its file; None if the mesh names a database."""
    if mesh.case_file is None:
        return mesh.case
    try:
        return schemas.read_model(schemas.Case, folder / mesh.case_file)
    except BadInput as error:
        raise error.within(f"{field}.case_file") from None


def with_inline_cases(scene: schemas.SceneInput, folder: Path) -> schemas.SceneInput:
    """Return the scene with the cases in its files written out; raises `BadInput`."""
    meshes = (with_case(mesh, f"meshes[{i}]", folder) for i, mesh in enumerate(scene.meshes))
    return scene.model_copy(update={"meshes": tuple(meshes)})


def with_case(mesh: MeshInput, field: str, folder: Path) -> MeshInput:
    """Return the mesh with the case in its file written out; raises `BadInput`."""
    case = case_of_mesh(mesh, field, folder)
    return mesh if case is None else mesh.model_copy(update={"case": case, "case_file": None})


def with_absolute_paths(scene: schemas.SceneInput, folder: Path) -> schemas.SceneInput:
    """Return the scene with its cases written out; other files that it names get absolute paths."""
    with_cases = with_inline_cases(scene, folder)
    meshes = tuple(_in_folder(mesh, "database_file", folder) for mesh in with_cases.meshes)
    housings = tuple(_in_folder(part, "modes_file", folder) for part in with_cases.housings)
    return with_cases.model_copy(update={"meshes": meshes, "housings": housings})


def _in_folder(part: Any, field: str, folder: Path) -> Any:
    name = getattr(part, field)
    return part if name is None else part.model_copy(update={field: str(folder / name)})


def _portable_scene(scene: schemas.SceneInput, folder: Path) -> schemas.SceneInput:
    """Return the scene with its case files written out.

    Raises `BadInput`: a case file cannot be used, or a mesh takes a database file, which a service does not
    read.
    """
    meshes = []
    for index, mesh in enumerate(scene.meshes):
        field = f"meshes[{index}]"
        if mesh.database_file is not None:
            remedy = "Give case_file or database_hash, or run the scene here without a service."
            raise BadInput.of(f"{field}.database_file", mesh.database_file, "left out for a service", remedy)
        meshes.append(with_case(mesh, field, folder))
    return without_modes_files(scene.model_copy(update={"meshes": tuple(meshes)}))


def without_modes_files(scene: schemas.SceneInput) -> schemas.SceneInput:
    """Return the scene without its files of modes; the housings keep their matrices."""
    housings = tuple(part.model_copy(update={"modes_file": None}) for part in scene.housings)
    return scene.model_copy(update={"housings": housings})
