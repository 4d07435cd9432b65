"""The client of one service."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from service.client.mesh_tables import MeshTables, scene_on_tables
from service.client.portable import CaseLike, SceneLike, case_of, scene_inputs, scene_of
from service.client.raw_columns import Column, query_columns, read_answer
from service.client.status import JobState, Watch
from service.client.studies import Studies
from service.schemas import Case
from service.schemas.live_answer import LiveOutput
from service.schemas.query import QueryOutput

if TYPE_CHECKING:
    import xarray

    from dynamics.results import RunResult
    from dynamics.scene import Scene
    from fe_contact.ste import SteDatabase


class LineOfActionClient(Studies):
    """Analyze cases and simulate scenes at a service; parameters as of `JobClient`."""

    def submit_case(self, case: CaseLike) -> JobState:
        """Enter the analysis of a case: a model, a table of the same shape, or a file."""
        return self.submit("analyze", {"case": case_of(case).model_dump(mode="json")})

    def submit_scene(self, scene: SceneLike, process: str = "simulate", **further: Any) -> JobState:
        """Enter a process of a scene with its further inputs; case files are written out."""
        return self.submit(process, scene_inputs(scene) | further)

    def analyze(self, case: CaseLike, progress: Watch | None = None) -> SteDatabase:
        """Return the STE database of a case: submit, wait, fetch; raises as `obtain` and `fetch_file`.

        If the service cannot be reached, an earlier result of the same case is taken from the cache.
        """
        return self.fetch(self.analysis_key(case, progress))

    def analysis_key(self, case: CaseLike, progress: Watch | None = None) -> str:
        """Return the content hash of a case's database, after it has been computed."""
        return self.obtain("analyze", {"case": case_of(case).model_dump(mode="json")}, progress).key

    def fetch(self, key: str) -> SteDatabase:
        """Return the STE database of a content hash; a cached one needs no service."""
        from fe_contact.ste import SteDatabase  # noqa: PLC0415 (keeps the import of the client light)

        return SteDatabase.from_netcdf(self.fetch_file(key))

    def fetch_dataset(self, key: str, kind: str = "database") -> xarray.Dataset:
        """Return a netCDF result as an xarray Dataset in memory, with units and names (SI).

        Parameters
        ----------
        key : str
            Its content hash.
        kind : str
            ``database``, ``run``, ``flanks``, ``sensitivity``, ``modes``, ``response`` or ``steady``.
        """
        import xarray  # noqa: PLC0415 (keeps the import of the client light)

        return xarray.load_dataset(self.fetch_file(key, kind), engine="h5netcdf")

    def simulate(self, scene: SceneLike, progress: Watch | None = None) -> RunResult:
        """Return the run of a scene, computed by the service: submit, wait, fetch."""
        from dynamics.results import RunResult  # noqa: PLC0415 (keeps the import of the client light)

        result = self.obtain("simulate", scene_inputs(scene), progress)
        return RunResult.from_netcdf(self.fetch_file(result.key, result.kind))

    def scene(self, scene: SceneLike, progress: Watch | None = None) -> Scene:
        """Return a scene in SI on tables of the service, for a local run by `dynamics.simulation.simulate`.

        Its meshes take their tables by ``case``, ``case_file``, ``database_hash`` or ``database_file``; those
        of cases are as from `analyze`, those of files are read here.

        Raises
        ------
        BadInput
            Named by the fields of the scene.
        JobFailed, NotFound, Unreachable, ServiceError
        """
        inputs, folder = scene_of(scene)
        return scene_on_tables(inputs, MeshTables(folder, self.tables(progress)))

    def tables(self, progress: Watch | None = None) -> ServiceTables:
        """Return this service as the source of the STE databases of scenes."""
        return ServiceTables(self, progress)

    def query(
        self,
        key: str,
        position: Column,
        deflection_um: Column,
        *,
        misalignment_um: Column = 0.0,
        center_distance_change_mm: Column = 0.0,
    ) -> QueryOutput:
        """Return force, tangent stiffness and validity of a stored database at many points.

        Every column (a list, an array) has a value for each point, or one for all. Sent and answered as raw
        float64, so nothing is rounded.

        Raises
        ------
        BadInput
            Columns of different lengths, too many points, a value that is not finite or out of bounds.
        NotFound, Unreachable, ServiceError
        """
        columns = {
            "position": position,
            "deflection_um": deflection_um,
            "misalignment_um": misalignment_um,
            "center_distance_change_mm": center_distance_change_mm,
        }
        path, content = f"/v1/databases/{key}/query", query_columns(columns)
        return read_answer(self._connection.columns(path, content, columns=",".join(columns)))

    def ste(
        self,
        key: str,
        torque_n_m: Sequence[float],
        *,
        misalignment_um: float = 0.0,
        center_distance_change_mm: float = 0.0,
        pinion: Mapping[str, Any] | None = None,
        wheel: Mapping[str, Any] | None = None,
        derivatives: bool = False,
        flanks: bool = False,
        condense: bool = False,
        caller: str | None = None,
    ) -> LiveOutput:
        """Return curves of the gears of a stored database with other flanks, loads and alignment, at once.

        Parameters
        ----------
        key : str
            Of the database.
        torque_n_m : sequence of float
            Increasing, at most twice the highest of the case.
        misalignment_um, center_distance_change_mm : float
        pinion, wheel : mapping, optional
            Flank modifications as in a case file (``tip_relief_um`` ...); others are as in the case.
        derivatives : bool
            Also return the derivatives of each curve by its flanks, the misalignment and the torque.
        flanks : bool
            Also return pressure over the driving gear's flank, load over the face, K_Hbeta.
        condense : bool
            Compute the compliance first if the service has none in its cache.
        caller : str, optional
            Name of the caller: a later request replaces its waiting one (`Superseded`).

        Returns
        -------
        LiveOutput
            ``curves`` with mean, peak-to-peak and harmonics, each with its error; assumptions; cost.

        Raises
        ------
        BadInput
            Named by the fields of the request.
        NotAnalyzed
            The compliance is not in the cache of the service: repeat with `condense`.
        NotFound, QueueFull, Superseded, LiveUnavailable, Unreachable, ServiceError
        """
        question = {
            "torque_n_m": list(torque_n_m),
            "misalignment_um": misalignment_um,
            "center_distance_change_mm": center_distance_change_mm,
            "pinion": dict(pinion or {}),
            "wheel": dict(wheel or {}),
            "derivatives": derivatives,
            "flanks": flanks,
            "condense": condense,
            "caller": caller,
        }
        path = f"/v1/databases/{key}/ste"
        return self._connection.read(LiveOutput.model_validate, "POST", path, json=question)


class ServiceTables:
    """A service as the source of a scene's STE databases."""

    def __init__(self, client: LineOfActionClient, progress: Watch | None) -> None:
        self._client, self._progress = client, progress

    def by_hash(self, key: str) -> SteDatabase:
        """Return the database of a content hash."""
        return self._client.fetch(key)

    def by_case(self, case: Case) -> SteDatabase:
        """Return the database of a case."""
        return self._client.analyze(case, self._progress)
