"""The jobs of one service and the files they leave: submit, wait, fetch; whatever the processes compute."""

from __future__ import annotations

import base64
import json
import math
import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import httpx2

from service.client.cache import FIGURES, ResultCache
from service.client.connection import Connection
from service.client.status import JobState, OfflineWarning, Result, Watch
from service.client.waiting import Pace, ended
from service.directories import cache_home
from service.problems import BadInput, DamagedFile, NotFound, ServiceError, Unreachable
from service.registry import JSON, NETCDF
from service.schemas.result_kinds import RESULT_KINDS, RESULTS, SUFFIX
from service.version import solver_version

_LONGEST_PAUSE_S = 2.0
_REFERENCES = {"response": "document", "transmissionMode": "reference"}
"""Whatever form a job was submitted with: say where its result is."""


class JobClient:
    """Submit jobs, wait for them, fetch what they make. Threads may share one.

    Parameters
    ----------
    base_url : str, optional
        Address of the service; default: the environment variable ``LOA_SERVICE``, else
        ``http://127.0.0.1:8321``.
    cache_dir : str or Path, optional
        Where fetched results are kept; default: the user's cache directory.
    transport : httpx2.BaseTransport, optional
        Replaces the network, for tests.
    timeout : float
        Seconds that connecting, sending, or the next piece of an answer may take.
    attempts : int
        How often a request is sent before the service counts as unreachable.
    patience : float
        Seconds for which the service may be away while a job is waited for: jobs outlast its restart.
    key : str, optional
        Access key of the service; default: the environment variable ``LOA_KEY``.

    Raises
    ------
    BadInput
        The address is none.
    """

    def __init__(
        self,
        base_url: str | None = None,
        *,
        cache_dir: str | Path | None = None,
        transport: httpx2.BaseTransport | None = None,
        timeout: float = 30.0,
        attempts: int = 4,
        patience: float = 60.0,
        key: str | None = None,
    ) -> None:
        address = base_url or os.environ.get("LOA_SERVICE") or "http://127.0.0.1:8321"
        self._connection = Connection(address, transport, timeout, attempts, key or os.environ.get("LOA_KEY"))
        self._cache = ResultCache(cache_home() / "results" if cache_dir is None else Path(cache_dir))
        self._patience = patience

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections."""
        self._connection.close()

    def submit(self, process: str, inputs: dict[str, Any]) -> JobState:
        """Enter a job; equal work is done once, whoever asks for it.

        Raises
        ------
        BadInput
            The inputs cannot be used.
        QueueFull, Unreachable, ServiceError
        """
        try:
            return self._job("POST", f"/v1/processes/{process}/execution", json={"inputs": inputs})
        except BadInput as error:
            self._note_other_version(error)
            raise

    def status(self, job: str) -> JobState:
        """Return the state of a job."""
        return self._job("GET", f"/v1/jobs/{job}")

    def dismiss(self, job: str) -> JobState:
        """Cancel a job; its work ends unless other jobs share it."""
        return self._job("DELETE", f"/v1/jobs/{job}")

    def _job(self, method: str, path: str, **arguments: Any) -> JobState:
        """Return the status document a request is answered with."""
        return self._connection.read(JobState.from_json, method, path, **arguments)

    def wait(
        self,
        job: str,
        progress: Watch | None = None,
        *,
        timeout: float | None = None,
        interval: float = 0.05,
    ) -> Result:
        """Wait for a job and return where its result is. Whatever ends the waiting, the job goes on.

        Parameters
        ----------
        job : str
            Its identifier.
        progress : callable, optional
            Called with every state seen.
        timeout : float, optional
            Seconds to wait at most.
        interval : float
            Seconds between the first two looks; later pauses grow, to 2 s.

        Raises
        ------
        BadInput, JobFailed, JobDismissed
            The job ended without a result.
        StillRunning
            It did not end within `timeout`; a TimeoutError too.
        Unreachable
            The service was away for longer than the client's patience.
        """

        def look() -> JobState:
            state = self.status(job)
            if progress is not None:
                progress(state)
            return state

        pace = Pace(interval, _LONGEST_PAUSE_S, math.inf if timeout is None else timeout, self._patience)
        ended(job, look, pace)
        return self.result(job)

    def result(self, job: str) -> Result:
        """Return where the result of a job is; raises as `wait`, or `ResultNotReady`."""
        path = f"/v1/jobs/{job}/results"
        return self._connection.read(Result.from_json, "GET", path, params=_REFERENCES)

    def obtain(self, process: str, inputs: dict[str, Any], progress: Watch | None = None) -> Result:
        """Return where the result of inputs is, computed if need be: submit, wait.

        When the service cannot be reached, the result that it gave for the same inputs before is taken, if
        its file is in the cache; an `OfflineWarning` says so. Raises as `submit` and `wait`.
        """
        service = self._connection.base_url
        try:
            result = self.wait(self.submit(process, inputs).id, progress)
        except Unreachable:
            known = self._cache.recall(service, process, inputs)
            if known is None:
                raise
            text = f"No service answers at {service}: the {known.kind} is from the cache."
            warnings.warn(text, OfflineWarning, stacklevel=3)
            return known
        self._cache.remember(service, process, inputs, result)
        return result

    def fetch_file(self, key: str, kind: str = "database") -> Path:
        """Return the netCDF file of a result, from the disk cache or the service.

        The file belongs to the cache: read it, or copy it.

        Raises
        ------
        NotFound
            The service has no such result.
        DamagedFile
            What arrived is not what was sent.
        BadInput
            The cache cannot be written.
        """
        return self.fetch_result(key, kind)[0]

    def fetch_figures(self, key: str, kind: str) -> dict[str, Any]:
        """Return the figures of a result in the units of the boundary; as `fetch_file`."""
        figures: dict[str, Any] = json.loads(self._fetched(key, (kind,), JSON, FIGURES)[0].read_bytes())
        return figures

    def fetch_result(self, key: str, *kinds: str) -> tuple[Path, str]:
        """Return the file of a result of one of some kinds, default all, and its kind; as `fetch_file`."""
        return self._fetched(key, kinds or tuple(RESULT_KINDS), NETCDF, SUFFIX)

    def _fetched(self, key: str, kinds: Sequence[str], form: str, suffix: str) -> tuple[Path, str]:
        """Return a form of a result, and its kind."""
        for kind in kinds:
            cached = self._cache.get(kind, key, suffix)
            if cached is not None:
                return cached, kind
        with self._cache.incoming() as file:
            digest, headers = self._connection.download(f"{RESULTS}/{key}", form, file)
            kind = headers.get("result-kind", kinds[0])
            if kind not in kinds:
                raise NotFound(f"Result {key!r} is no {kinds[0]}, but of the kind {kind}.")
            coded = base64.b64encode(bytes.fromhex(digest)).decode()
            if headers.get("content-digest") != f"sha-256=:{coded}:":
                raise DamagedFile(f"The file of {kind} {key} was damaged in transfer. Fetch it again.")
            return self._cache.keep(kind, key, file, digest, suffix), kind

    def _note_other_version(self, error: BadInput) -> None:
        """Add to a refusal that client and service are of different versions, if they are."""
        try:
            theirs = self._connection.read(lambda facts: str(facts["version"]), "GET", "/v1/")
        except ServiceError:
            return
        if theirs != solver_version():
            error.add_note(
                f"The service is version {theirs}, this client {solver_version()}: they "
                "may differ. Install the version of the service."
            )
