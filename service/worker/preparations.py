"""Checks of a request beyond its schema, and the normalized inputs that are hashed and worked on."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NoReturn

from fe_contact.solver_version import SOLVER_VERSION
from fe_contact.ste import PairGeometry, SteDatabase
from fe_contact.ste.metadata import SCHEMA_VERSION, content_hash
from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.convert.checked_case import CheckedCases
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.scene import SceneInput
from service.schemas.execute import AnalyzeInputs, SimulateInputs
from service.store.results import ResultStore

CASES = CheckedCases()
"""The last checked cases of this process, a service or a worker. So one check serves a submission, its
predicted cost and its warnings, or a result and the warnings in its file."""

Json = dict[str, Any]


def check_scene_inputs(scene: SceneInput, store: ResultStore) -> None:
    """Check a scene and the sources of its tables; `BadInput`: it cannot move, or names a missing source."""
    for index, housing in enumerate(scene.housings):
        if housing.modes_file is not None:
            _refuse_file(f"housings[{index}].modes_file", housing.modes_file, "Give its matrices")
    check_scene(
        scene, {mesh.name: _pair_data(f"meshes[{i}]", mesh, store) for i, mesh in scene.with_database}
    )


def _pair_data(field: str, mesh: MeshInput, store: ResultStore) -> PairGeometry:
    _check_source(field, mesh, store)
    if mesh.case is not None:
        try:
            return PairGeometry.of(CASES.of(mesh.case).feasible.request.pair)
        except BadInput as error:
            raise error.within(f"{field}.case") from None
    return SteDatabase.from_netcdf(store.verified(str(mesh.database_hash), "database").path).geometry


def _check_source(field: str, mesh: MeshInput, store: ResultStore) -> None:
    """Refuse files of the callers, which a service does not read, and hashes of results that it lacks."""
    for name, path in (("case_file", mesh.case_file), ("database_file", mesh.database_file)):
        if path is not None:
            _refuse_file(f"{field}.{name}", path, "Write the case out, or submit it and give database_hash")
    key = mesh.database_hash
    if key is not None and store.find(key, "database") is None:
        raise BadInput.of(
            f"{field}.database_hash", key, "the hash of a stored database", "Submit its case first."
        )


def check_run(key: str | None, store: ResultStore) -> None:
    """Refuse the hash of a run that is not stored; raises `BadInput`."""
    if key is not None and store.find(key, "run") is None:
        raise BadInput.of("run", key, "the hash of a stored run", "Submit its scene to simulate first.")


def _refuse_file(field: str, path: str, instead: str) -> NoReturn:
    bound = "left out: the service reads no files of its callers"
    raise BadInput.of(field, path, bound, f"{instead}; the client does this for you.")


def prepare_analyze(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Return the case with all defaults; check that it can be computed, unless its result is stored."""
    assert isinstance(inputs, AnalyzeInputs)
    normalized: Json = inputs.model_dump(mode="json")
    if store.find(name_database(normalized), "database") is None:
        _ = CASES.of(inputs.case).feasible  # raises unless it can be computed
    return normalized


def name_database(inputs: Json) -> str:
    """Return the content hash of the database of a case, which its file will state."""
    return content_hash(inputs["case"], SOLVER_VERSION, SCHEMA_VERSION)


def name_of_table(mesh: MeshInput) -> str:
    """Return the content hash of the table of a mesh of a scene."""
    if mesh.case is None:
        return str(mesh.database_hash)
    return name_database({"case": case_json(mesh.case)})


def files_read(inputs: Json, store: ResultStore) -> dict[str, Path]:
    """Return the files of stored results that normalized inputs name, and of stored tables of their cases.

    Raises `NotFound`, `DamagedFile`: a named result is gone; and as `ResultStore.verified`.
    """
    names = [] if inputs.get("run") is None else [(inputs["run"], "run")]
    if inputs.get("scene") is not None:
        scene = SceneInput.model_validate_json(json.dumps(inputs["scene"]))
        for _, mesh in scene.with_database:
            key = name_of_table(mesh)
            if mesh.case is None or store.find(key, "database") is not None:
                names.append((key, "database"))
    return {key: store.verified(key, kind).path for key, kind in names}


def prepare_scene(inputs: BoundaryModel, store: ResultStore) -> Json:
    """Check the scene and the sources of its tables; return it with all defaults."""
    assert isinstance(inputs, SimulateInputs)
    check_scene_inputs(inputs.scene, store)
    return inputs.model_dump(mode="json")
