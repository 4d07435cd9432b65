"""The STE databases of a scene's meshes on the command line: from files, computed here, or from a service."""

from __future__ import annotations

from pathlib import Path

from dynamics.system import Scene
from fe_contact.ste import PairFacts, SteDatabase
from service.cli.analyze import analyzed
from service.cli.output import Report
from service.cli.remote import watching
from service.cli.ste import open_ste
from service.client import LineOfActionClient
from service.client.portable import case_of_mesh
from service.convert.checks import check_case
from service.convert.scene import check_scene, dynamic_scene
from service.convert.topology import facts_of
from service.problems import BadInput
from service.schemas import Case
from service.schemas.scene import MeshInput, SceneInput

_ADVICE = "Name the service that holds it: --service http://127.0.0.1:8321"


def scene_with_tables(scene: SceneInput, folder: Path, service: str | None, report: Report) -> Scene:
    """Return the scene in SI with its tables; `folder` is what its files are relative to."""
    client = None if service is None else LineOfActionClient(service)
    try:
        tables = _Tables(folder, client, report)
        check_scene(scene, {mesh.name: tables.facts(i, mesh) for i, mesh in enumerate(scene.meshes)})
        databases = {mesh.name: tables.of(i, mesh) for i, mesh in enumerate(scene.meshes)}
    finally:
        if client is not None:
            client.close()
    return dynamic_scene(scene, databases)


class _Tables:
    """Where the STE databases of the meshes come from; equal cases are computed once."""

    def __init__(self, folder: Path, client: LineOfActionClient | None, report: Report) -> None:
        self._folder, self._client, self._report = folder, client, report
        self._computed: list[tuple[Case, SteDatabase]] = []

    def of(self, index: int, mesh: MeshInput) -> SteDatabase:
        """Return the database of a mesh."""
        place = f"meshes[{index}]"
        if mesh.database_file is not None:
            return open_ste(self._folder / mesh.database_file)
        if mesh.database_hash is not None:
            return self._by_hash(place, mesh.database_hash)
        case = case_of_mesh(mesh, place, self._folder)
        assert case is not None
        try:
            return self._of_case(case)
        except BadInput as error:
            raise error.within(f"{place}.case") from None

    def facts(self, index: int, mesh: MeshInput) -> PairFacts:
        """Return the facts of a mesh's pair; of a case without computing anything."""
        place = f"meshes[{index}]"
        case = case_of_mesh(mesh, place, self._folder)
        if case is None:
            return self.of(index, mesh).facts
        try:
            return facts_of(check_case(case))
        except BadInput as error:
            raise error.within(f"{place}.case") from None

    def _by_hash(self, place: str, key: str) -> SteDatabase:
        """Return a database that a service holds."""
        if self._client is None:
            raise BadInput.of(f"{place}.database_hash", key, "used together with a service", _ADVICE)
        return self._client.fetch(key)

    def _of_case(self, case: Case) -> SteDatabase:
        """Return the database of a case, from the service or computed here."""
        known = next((database for other, database in self._computed if other == case), None)
        if known is not None:
            return known
        if self._client is None:
            database = analyzed(case, self._report)
        else:
            database = self._client.analyze(case, watching(self._report))
        self._computed.append((case, database))
        return database
