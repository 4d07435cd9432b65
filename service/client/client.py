"""The client of one service."""

from __future__ import annotations

import base64
import hashlib
import os
import time
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import httpx2

from service.client.cache import ResultCache
from service.client.connection import Connection
from service.client.portable import CaseLike, SceneLike, case_of, portable_scene, scene_of
from service.client.raw_columns import query_columns, read_answer
from service.client.status import JobState, Result
from service.client.studies import Studies, Watch
from service.problems import DamagedFile, JobFailed, Unreachable
from service.schemas.query import QueryOutput
from service.schemas.result_kinds import RESULT_KINDS
from service.settings import cache_home

if TYPE_CHECKING:
    from dynamics.results import RunResult
    from fe_contact.ste import SteDatabase

_REFERENCES = {"response": "document", "transmissionMode": "reference"}
"""Whatever form a job was submitted with: say where its result is."""


class LineOfActionClient(Studies):
    """Submit cases and scenes, wait for them, fetch what they make.

    Parameters
    ----------
    base_url : str
        Address of the service.
    cache_dir : Path, optional
        Where fetched results are kept; default: the user's cache directory.
    transport : httpx2.BaseTransport, optional
        Replaces the network, for tests.
    timeout : float
        Seconds one request may take.
    attempts : int
        How often a request is sent before the service counts as unreachable.
    key : str, optional
        Access key of the service; default: the environment variable ``LOA_KEY``.
    """

    def __init__(
        self,
        base_url: str = "http://127.0.0.1:8321",
        *,
        cache_dir: Path | None = None,
        transport: httpx2.BaseTransport | None = None,
        timeout: float = 30.0,
        attempts: int = 4,
        key: str | None = None,
    ) -> None:
        self._connection = Connection(
            base_url, transport, timeout, attempts, key or os.environ.get("LOA_KEY")
        )
        self._cache = ResultCache(cache_dir or cache_home() / "results")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections."""
        self._connection.close()

    # Jobs

    def submit(self, process: str, inputs: dict[str, Any]) -> JobState:
        """Enter a job; equal work is done once, whoever asks for it.

        Raises
        ------
        BadInput
            The inputs cannot be used.
        QueueFull, Unreachable, ServiceError
        """
        return self._job("POST", f"/v1/processes/{process}/execution", json={"inputs": inputs})

    def submit_case(self, case: CaseLike) -> JobState:
        """Enter the analysis of a case: a model, a table of the same shape, or a file."""
        return self.submit("analyze", {"case": case_of(case).model_dump(mode="json")})

    def submit_scene(self, scene: SceneLike, process: str = "simulate", **further: Any) -> JobState:
        """Enter a process of a scene with its further inputs; case files are written out."""
        ready = portable_scene(*scene_of(scene))
        return self.submit(process, {"scene": ready.model_dump(mode="json"), **further})

    def status(self, job: str) -> JobState:
        """Return the state of a job."""
        return self._job("GET", f"/v1/jobs/{job}")

    def dismiss(self, job: str) -> JobState:
        """Cancel a job."""
        return self._job("DELETE", f"/v1/jobs/{job}")

    def _job(self, method: str, path: str, **arguments: Any) -> JobState:
        """Return the status document a request is answered with."""
        return JobState.from_json(self._connection.request(method, path, **arguments).json())

    def wait(
        self, job: str, progress: Watch | None = None, *, timeout: float | None = None, interval: float = 0.2
    ) -> Result:
        """Wait for a job and return where its result is.

        Parameters
        ----------
        job : str
            Its identifier.
        progress : callable, optional
            Called with every state seen.
        timeout : float, optional
            Seconds to wait at most; the job goes on after it.
        interval : float
            Seconds between two looks.

        Raises
        ------
        BadInput, JobFailed, JobDismissed
            The job ended without a result.
        """
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            state = self.status(job)
            if progress is not None:
                progress(state)
            if state.ended:
                return self.result(job)
            if end is not None and time.monotonic() > end:
                raise JobFailed(f"Job {job} did not end within {timeout:g} s. It goes on; look again later.")
            time.sleep(interval)

    def result(self, job: str) -> Result:
        """Return where the result of a job is; raises as `wait`, or `ResultNotReady`."""
        found = self._connection.request("GET", f"/v1/jobs/{job}/results", params=_REFERENCES).json()
        kind, reference = next(iter(found.items()))
        return Result(reference["hash"], kind, reference["href"])

    # Results

    def fetch_file(self, key: str, kind: str = "database") -> Path:
        """Return the file of a result (netCDF or JSON, by its kind), from the disk cache or the service.

        Raises
        ------
        NotFound
            The service has no such result.
        DamagedFile
            What arrived is not what was sent.
        """
        cached = self._cache.get(kind, key)
        if cached is not None:
            return cached
        where = RESULT_KINDS[kind]
        response = self._connection.request(
            "GET", f"{where.path}/{key}", headers={"Accept": where.media_type}
        )
        content = response.content
        digest = base64.b64encode(hashlib.sha256(content).digest()).decode()
        if response.headers.get("content-digest") != f"sha-256=:{digest}:":
            raise DamagedFile(f"The file of {kind} {key} was damaged on its way. Fetch it again.")
        return self._cache.put(kind, key, content)

    def fetch(self, key: str) -> SteDatabase:
        """Return the STE database of a content hash; what is cached needs no service."""
        from fe_contact.ste import SteDatabase  # noqa: PLC0415 (keeps the import of the client light)

        return SteDatabase.from_netcdf(self.fetch_file(key))

    def analyze(self, case: CaseLike, progress: Watch | None = None) -> SteDatabase:
        """Return the STE database of a case: submit, wait, fetch.

        When the service cannot be reached, what it gave for the same case before is taken from the cache.
        """
        return self.fetch(self.analysis_key(case, progress))

    def analysis_key(self, case: CaseLike, progress: Watch | None = None) -> str:
        """Return the content hash of a case's database, after it has been computed."""
        inputs = {"case": case_of(case).model_dump(mode="json")}
        try:
            key = self.wait(self.submit("analyze", inputs).id, progress).key
        except Unreachable:
            known = self._cache.recall(self._connection.base_url, inputs)
            if known is None or self._cache.get("database", known) is None:
                raise
            return known
        self._cache.remember(self._connection.base_url, inputs, key)
        return key

    def simulate(self, scene: SceneLike, progress: Watch | None = None) -> RunResult:
        """Return the run of a scene, computed by the service: submit, wait, fetch."""
        from dynamics.results import RunResult  # noqa: PLC0415 (keeps the import of the client light)

        result = self.wait(self.submit_scene(scene).id, progress)
        return RunResult.from_netcdf(self.fetch_file(result.key, "run"))

    def query(
        self,
        key: str,
        position: Sequence[float],
        deflection_um: Sequence[float],
        *,
        misalignment_um: float | Sequence[float] = 0.0,
        center_distance_change_mm: float | Sequence[float] = 0.0,
    ) -> QueryOutput:
        """Return force, tangent stiffness and validity of a stored database at many points.

        Every list has a value for each point, or one for all. Sent and answered as raw float64, so nothing
        is rounded.

        Raises
        ------
        BadInput
            Lists of different lengths, too many points, a value that is not finite or out of bounds.
        NotFound, Unreachable, ServiceError
        """
        columns = {
            "position": position,
            "deflection_um": deflection_um,
            "misalignment_um": misalignment_um,
            "center_distance_change_mm": center_distance_change_mm,
        }
        response = self._connection.request(
            "POST",
            f"/v1/databases/{key}/query",
            params={"columns": ",".join(columns)},
            content=query_columns(columns),
            headers={"Content-Type": "application/octet-stream", "Accept": "application/octet-stream"},
        )
        return read_answer(response.content)
