"""The clients of one service: one whose calls block, one whose calls are awaited."""

from __future__ import annotations

import base64
import os
import warnings
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeVar

import httpx2

from host.directories import cache_home
from lineofaction.client.batch import AsyncBatch, Batch
from lineofaction.client.cache import ResultCache
from lineofaction.client.exchange import Exchange
from lineofaction.client.job import AsyncJob, Job
from lineofaction.client.job_calls import JobCalls
from lineofaction.client.offers import ANALYZE, libraries, offers, reader_of, subject_inputs
from lineofaction.client.page_address import PageCalls
from lineofaction.client.process import AsyncProcess, Process, obtained
from lineofaction.client.result_calls import ResultCalls
from lineofaction.client.status import Watch
from lineofaction.client.steps import Steps
from lineofaction.client.surface import (
    Awaiting,
    AwaitingDriver,
    Blocking,
    BlockingDriver,
    Session,
    Surface,
    operation,
)
from lineofaction.gearbox import schemas
from lineofaction.gearbox.loading import load
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import Studies
from lineofaction.gearbox.study import F, Offered, P
from lineofaction.gearbox.study import T as Answer
from service.origin import is_loopback
from service.version import solver_version

if TYPE_CHECKING:
    from pydantic import BaseModel

    from dynamics.results import RunResult
    from dynamics.scene import Scene
    from fe_contact.ste import SteDatabase
    from lineofaction.gearbox.schemas import Case
    from lineofaction.gearbox.schemas.figures import RunFigures, TableFigures
    from lineofaction.gearbox.subjects import CaseLike, SceneLike
    from service.schemas.answers import EffectBody, ExampleBody, UnitBody

# Scenes of dynamics on the tables of a service.

T = TypeVar("T")
M = TypeVar("M", bound="BaseModel")
DEFAULT = "http://127.0.0.1:8321"


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


class _SceneCalls(Surface):
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


# What a service says before anything is computed: plans, drawings, examples, effects, files.


class _LookupCalls(Surface):
    """Answers that need no job."""

    @operation
    def plan(self, case: CaseLike, *, time_budget_s: float | None = None) -> Steps[schemas.PlanBody]:
        """Return what the analysis of a case will be, cost and be wrong by.

        `time_budget_s`: CPU seconds that may be spent.
        """
        inputs = subject_inputs("case", case) | {"time_budget_s": time_budget_s}
        return (yield from self._answer("/v1/plans", {"inputs": inputs}, schemas.PlanBody.model_validate))

    @operation
    def outline(self, case: CaseLike) -> Steps[schemas.OutlineBody]:
        """Return the drawing of both gears, the path of contact and the figures of the pair."""
        body = {"inputs": subject_inputs("case", case)}
        return (yield from self._answer("/v1/cases/outline", body, schemas.OutlineBody.model_validate))

    @operation
    def examples(self) -> Steps[tuple[ExampleBody, ...]]:
        """Return cases to begin with."""
        return self._listed("/v1/examples", "ExampleBody")

    @operation
    def effects(self) -> Steps[tuple[EffectBody, ...]]:
        """Return the optional physics, which a case switches in its table ``[effects]``."""
        return self._listed("/v1/effects", "EffectBody")

    @operation
    def case_from_toml(self, toml: str) -> Steps[schemas.Case]:
        """Return the case in the text of a case file; raises `BadInput` with the lines at fault."""
        return self._validated("/v1/cases/from-toml", toml, "case", schemas.Case)

    @operation
    def case_to_toml(self, case: CaseLike) -> Steps[str]:
        """Return a case with all defaults as the text of a case file."""
        body = {"inputs": subject_inputs("case", case)}
        return (yield from self._answer("/v1/cases/to-toml", body, _text))

    @operation
    def case_as_measured(
        self, case: CaseLike, sheet: Path, gear: str, loaded: str = "right", cutoff_mm: float | None = None
    ) -> Steps[schemas.Case]:
        """Return a case with the pitches and traces of one gear's inspection (CSV) on its loaded flanks.

        Raises `BadInput`: a line of the sheet that is none, or a trace that cannot be evaluated; warns of
        points that are left out.
        """
        measured = {"csv": _read(sheet).decode(), "gear": gear, "loaded": loaded, "cutoff_mm": cutoff_mm}
        return self._as_made(case, {"measured": measured})

    @operation
    def case_of_class(self, case: CaseLike, tolerance_class: int, seed: int = 0) -> Steps[schemas.Case]:
        """Return a case with both gears drawn within a class of ISO 1328-1:2013; equal seeds, equal gears."""
        return self._as_made(case, {"tolerance_class": tolerance_class, "seed": seed})

    @operation
    def scene_from_toml(self, toml: str) -> Steps[schemas.SceneInput]:
        """Return the scene in the text of a scene file; raises `BadInput` with the lines at fault."""
        return self._validated("/v1/scenes/from-toml", toml, "scene", schemas.SceneInput)

    @operation
    def scene_to_toml(self, scene: SceneLike) -> Steps[str]:
        """Return a scene, its case files written out, as the text of a scene file."""
        body = {"inputs": subject_inputs("scene", scene)}
        return (yield from self._answer("/v1/scenes/to-toml", body, _text))

    @operation
    def open_unit(self, file: Path, assume: Sequence[str] = ()) -> Steps[UnitBody]:
        """Return the gear unit in a REXS file (.rexs, .rexsj, .rexsz) as cases, scene and account.

        Its `left_out` says what the file has and the scene has not. Raises `BadInput`: the file cannot be
        read, is no sound REXS file, or has no such component; the message names it.

        Parameters
        ----------
        file : Path
        assume : sequence of str
            Values over the file's, ``"14.helix_angle_reference_diameter=-12"``.
        """
        body = {"rexs_base64": base64.b64encode(_read(file)).decode(), "assume": list(assume)}
        unit: UnitBody = yield from self._answer("/v1/units/open", body, _model("UnitBody").model_validate)
        return unit

    def _answer(self, path: str, body: dict[str, Any], reader: Callable[[Any], T]) -> Steps[T]:
        return self.session.exchange.read(reader, "POST", path, json=body)

    def _as_made(self, case: CaseLike, how: dict[str, Any]) -> Steps[schemas.Case]:
        def made(answer: dict[str, Any]) -> schemas.Case:
            for text in answer["left_out"]:
                warnings.warn(f"left out of the case: {text}", stacklevel=2)
            return schemas.validated(schemas.Case, answer["case"])

        return self._answer("/v1/cases/as-made", {"inputs": subject_inputs("case", case), **how}, made)

    def _validated(self, path: str, toml: str, name: str, model: type[M]) -> Steps[M]:
        return self._answer(path, {"toml": toml}, lambda answer: schemas.validated(model, answer[name]))

    def _listed(self, path: str, model: str) -> Steps[tuple[Any, ...]]:
        return self.session.exchange.read(
            lambda answer: tuple(map(_model(model).model_validate, answer)), "GET", path
        )


def _read(file: Path) -> bytes:
    try:
        return Path(file).read_bytes()
    except OSError as error:
        raise BadInput.of("file", str(file), f"a file that can be read ({error.strerror})") from None


def _text(answer: dict[str, Any]) -> str:
    return str(answer["toml"])


def _model(name: str) -> Any:
    """Return a model of answers; all are loaded with the first of them."""
    return load(f"service.schemas.answers:{name}")


# The address of a service, and how HTTP libraries are to reach it.


def _http_options(base_url: str | None, timeout: float, key: str | None) -> dict[str, Any]:
    """Return the arguments of an httpx2 client, blocking or awaiting, of one service.

    Proxies and certificates are those of the environment (``HTTPS_PROXY``, ``NO_PROXY``, ``SSL_CERT_FILE``);
    this machine is asked without a proxy.
    """
    address = base_url or os.environ.get("LOA_SERVICE") or DEFAULT
    key = key or os.environ.get("LOA_KEY")
    agent = {"User-Agent": f"lineofaction/{solver_version()}"}
    return {
        "base_url": address.rstrip("/"),
        "headers": agent | ({"Authorization": f"Bearer {key}"} if key else {}),
        "timeout": timeout,
        "trust_env": not is_loopback(_host(address)),
    }


def _host(base_url: str) -> str:
    try:
        url = httpx2.URL(base_url)
    except httpx2.InvalidURL:
        url = httpx2.URL()
    if url.scheme not in ("http", "https") or not url.host:
        advice = "Begin it with http:// or https://."
        raise BadInput.of("service", base_url, "an address such as http://127.0.0.1:8321", advice)
    return url.host


class Client(Studies, JobCalls, ResultCalls, PageCalls, _LookupCalls, _SceneCalls):
    """All calls of a client.

    Raises `BadInput`: the address is none.

    Parameters
    ----------
    base_url : str, optional
        Address of the service; default: the environment variable ``LOA_SERVICE``, else
        ``http://127.0.0.1:8321``.
    cache_dir : str or Path, optional
        Where fetched results are kept; default: the user's cache directory.
    transport : httpx2.BaseTransport or httpx2.AsyncBaseTransport, optional
        Replaces the network, for tests.
    timeout : float
        Seconds that connecting, sending, or the next piece of an answer may take.
    attempts : int
        How often a request is sent before the service counts as unreachable.
    patience : float
        Seconds for which the service may be away while a job is waited for: jobs outlast its restart.
    key : str, optional
        Access key of the service; default: the environment variable ``LOA_KEY``.
    progress : callable, optional
        Called with every state seen of any job that is waited for; see `progress_bars`.
    """

    analyze: Offered[[CaseLike], SteDatabase, TableFigures] = Offered()
    simulate: Offered[[SceneLike], RunResult, RunFigures] = Offered()

    def __init__(
        self,
        base_url: str | None = None,
        *,
        cache_dir: str | Path | None = None,
        transport: Any = None,
        timeout: float = 30.0,
        attempts: int = 4,
        patience: float = 60.0,
        key: str | None = None,
        progress: Watch | None = None,
    ) -> None:
        options = _http_options(base_url, timeout, key)
        cache = ResultCache(cache_home() / "results" if cache_dir is None else Path(cache_dir))
        self.session = Session(Exchange(options["base_url"], attempts), cache, patience, progress)
        self._connect(transport, options)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.session.exchange.base_url}>"

    def _connect(self, transport: Any, options: dict[str, Any]) -> None:
        raise NotImplementedError

    def with_terms(
        self, *, title: str = "", tags: Sequence[str] = (), priority: int = 0, max_cost_s: float | None = None
    ) -> Self:
        """Return this client with terms for what it submits; both share connections and cache.

        Parameters
        ----------
        title : str
            Name of its jobs, up to 200 characters.
        tags : sequence of str
            What its jobs are found by: up to 16, each of up to 40 letters, digits and ``._:/+-``.
        priority : int
            -9 to 9: of the jobs that wait the oldest of the highest is next.
        max_cost_s : float, optional
            CPU seconds that each job may take; default: no limit.
        """
        view = copy(self)
        view.session = replace(
            self.session,
            terms={"title": title, "tags": list(tags), "priority": priority, "max_cost_s": max_cost_s},
        )
        return view


class LineOfActionClient(Client, Blocking):
    """A service whose calls block; threads may share one."""

    def _connect(self, transport: httpx2.BaseTransport | None, options: dict[str, Any]) -> None:
        self.driver = BlockingDriver(transport, options)

    def process(self, offered: Offered[P, Answer, F]) -> Process[P, Answer, F]:
        """Return the process of a study, `loa.modes`; it is the attribute of its name too."""
        return Process(self, offers()[offered.name])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections."""
        self.driver.close()

    def job(self, identifier: str) -> Job[Any, Any]:
        """Return a job by its identifier; raises `NotFound`."""
        state = self.status(identifier)
        return Job(self, state, reader_of(state.process))

    def batch(self, identifier: str) -> Batch[Any, Any]:
        """Return a batch by its identifier; raises `NotFound`."""
        state = self.status(identifier)
        return Batch(self, state, reader_of(state.process))


class AsyncLineOfActionClient(Client, Awaiting):
    """A service whose calls are awaited, in one event loop."""

    def _connect(self, transport: httpx2.AsyncBaseTransport | None, options: dict[str, Any]) -> None:
        self.driver = AwaitingDriver(transport, options)

    def process(self, offered: Offered[P, Answer, F]) -> AsyncProcess[P, Answer, F]:
        """Return the process of a study, `loa.modes`; it is the attribute of its name too."""
        return AsyncProcess(self, offers()[offered.name])

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Close the connections."""
        await self.driver.close()

    async def job(self, identifier: str) -> AsyncJob[Any, Any]:
        """Return a job by its identifier; raises `NotFound`."""
        state = await self.status(identifier)
        return AsyncJob(self, state, reader_of(state.process))

    async def batch(self, identifier: str) -> AsyncBatch[Any, Any]:
        """Return a batch by its identifier; raises `NotFound`."""
        state = await self.status(identifier)
        return AsyncBatch(self, state, reader_of(state.process))
