"""Calls for scenes of dynamics on the tables of a service."""

from __future__ import annotations

from typing import TYPE_CHECKING

from host.directories import cache_home
from lineofaction.client.job_calls import JobCalls
from lineofaction.client.offers import ANALYZE, libraries, subject_inputs
from lineofaction.client.process import obtained
from lineofaction.client.result_calls import ResultCalls
from lineofaction.client.steps import Steps
from lineofaction.client.surface import Surface, operation

if TYPE_CHECKING:
    from dynamics.scene import Scene
    from fe_contact.ste import SteDatabase
    from lineofaction.gearbox.schemas import Case
    from lineofaction.gearbox.subjects import CaseLike, SceneLike


class ServiceTables:
    """A service as the source of a scene's STE databases."""

    def __init__(self, client: Surface) -> None:
        self._client = client

    def by_hash(self, key: str) -> Steps[SteDatabase]:
        """Return the database of a content hash."""
        return ResultCalls.fetch(self._client, key)

    def by_case(self, case: Case) -> Steps[SteDatabase]:
        """Return the database of a case."""
        return obtained(self._client, ANALYZE, subject_inputs("case", case))


class SceneCalls(Surface):
    """Scenes on the tables of a service."""

    @operation
    def analysis_key(self, case: CaseLike) -> Steps[str]:
        """Return the content hash of a case's database, after it has been computed."""
        result = yield from JobCalls.obtain(self, ANALYZE.name, subject_inputs("case", case))
        return result.key

    @operation
    def scene(self, scene: SceneLike) -> Steps[Scene]:
        """Return a scene in SI on tables of the service, for a local run by `dynamics.simulation.simulate`.

        Its meshes take their tables by ``case``, ``case_file``, ``database_hash`` or ``database_file``,
        unless they state their ``stiffness``; those of cases are as from `analyze`, those of files are read
        here. Housings by their solids are reduced here. Raises `BadInput` named by the fields of the scene;
        `JobFailed`, `NotFound`, `Unreachable`, `ServiceError`.
        """
        # what declares the fields of a scene is loaded with the first call
        from lineofaction.gearbox.mesh_tables import MeshTables  # noqa: PLC0415
        from lineofaction.gearbox.subjects import scene_of  # noqa: PLC0415

        inputs, folder = scene_of(scene)
        source, tables = MeshTables(folder, ServiceTables(self)), {}
        for index, mesh in inputs.with_database:
            tables[mesh.name] = yield from source.of(index, mesh)
        with libraries():
            # keeps the import of the client light
            from lineofaction.gearbox.convert.housings import reduced_in  # noqa: PLC0415
            from lineofaction.gearbox.convert.scene import dynamic_scene  # noqa: PLC0415

            housings = reduced_in(inputs, cache_home())
        return dynamic_scene(inputs, tables, housings)
