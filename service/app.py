"""The web application."""

from __future__ import annotations

import warnings
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial
from typing import Any

from fastapi import FastAPI

from service.access.capacity import capacity
from service.access.identities import open_identities
from service.directory_lock import DirectoryLock
from service.live.cached_answers import KeptAnswers
from service.live.live_worker import live_pool
from service.management.figures import process_registry
from service.management.request_figures import Metrics
from service.queue.machinery import job_machinery
from service.queue.watcher import Watcher
from service.reading.reader import reading_pool, require_confinement
from service.routes import (
    batches,
    callbacks,
    documents,
    drafts,
    events,
    health,
    job_results,
    jobs,
    processes,
    queries,
    result_drawings,
    results,
)
from service.routes.access import Access
from service.routes.admission import Admission
from service.routes.context import Context
from service.routes.direct_routes import DirectRoutes
from service.routes.middleware import API_PREFIX, Guard
from service.routes.offers import ROUTERS
from service.routes.openapi import ABOUT, install_description
from service.routes.problem_answers import install_error_handlers
from service.routes.warm_up import warm_up
from service.settings import Settings
from service.store.deployment import Deployment
from service.store.places import CACHE_DIRECTORY
from service.store.write_check import WriteCheck
from service.tracing import flush_spans, telemetry_options
from service.version import solver_version
from service.worker.process import Registry, default_registry


def create_app(settings: Settings, registry: Registry | None = None, *, works: bool = True) -> FastAPI:
    """Return the application; it opens its data directory and starts its scheduler when it is started.

    `registry`: the processes it offers; default: analyze and simulate. `works`: it runs jobs itself. Raises
    `BadInput`: another service works in the data directory, or it cannot be written; the files of results are
    those of another database; the address is not loopback and there are no access keys, or their file cannot
    be used; the process may open too few files; confinement is required and the system lacks a part of it.
    """
    warnings.filterwarnings("ignore", message="implausible")  # the answer names them by the caller's fields
    if settings.require_confinement:
        require_confinement()
    identities = open_identities(settings)
    limits = capacity(settings.workers if works else 0)
    lock = DirectoryLock(settings.data_directory) if works else None
    if lock is not None:
        lock.acquire()
    offered = registry or default_registry()
    try:
        context = _context(settings, offered, works)
    except BaseException:
        if lock is not None:
            lock.release()
        raise

    app = FastAPI(
        version=solver_version(),
        lifespan=_lifespan(context, lock),
        generate_unique_id_function=lambda route: route.name,
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        **ABOUT,
        telemetry=telemetry_options(),
    )
    app.state.context, app.state.capacity = context, limits
    parts = (context.engine, context.store, context.writes, context.scheduler)
    app.state.metrics = Metrics(process_registry(*parts, settings))
    install_error_handlers(app)
    install_description(app)
    app.add_middleware(DirectRoutes, router=queries.router, prefix=API_PREFIX)
    always = not settings.loopback or bool(identities)
    app.add_middleware(Access, identities=identities, always=always, admission=Admission(app.state.capacity))
    app.add_middleware(Guard, body_limit=settings.body_limit, metrics=app.state.metrics)
    _route(app, offered)
    return app


def _route(app: FastAPI, registry: Registry) -> None:
    documented = (documents.router, processes.processes_router(registry), jobs.router)
    read = (job_results.job_results_router(registry), results.router, result_drawings.router)
    grouped = (queries.router, queries.live_router, drafts.router, batches.router, events.router)
    for router in (*documented, *read, *grouped, *ROUTERS):
        app.include_router(router, prefix=API_PREFIX)
    for router in (documents.pages_router, health.router):
        app.include_router(router)


def _lifespan(context: Context, lock: DirectoryLock | None) -> Callable[[FastAPI], Any]:
    """Return the lifespan: from start to end of the application the directory is locked and jobs run."""

    @asynccontextmanager
    async def lifespan(_app: FastAPI) -> AsyncIterator[None]:
        if lock is not None:
            lock.acquire()
        context.start_waiting()
        if context.scheduler is not None:
            context.scheduler.start()
        deliverer = callbacks.deliverer_of(context)
        if deliverer is not None:
            deliverer.start()
        warm_up()
        try:
            yield
        finally:
            context.stop_waiting()
            if deliverer is not None:
                deliverer.stop()
            if context.scheduler is not None:
                context.scheduler.stop()
            flush_spans()
            context.close()
            if lock is not None:
                lock.release()

    return lifespan


def _context(settings: Settings, registry: Registry, works: bool) -> Context:
    parts = job_machinery(settings, registry, works=works)
    return Context(
        settings=settings,
        registry=registry,
        submissions=parts.submissions,
        scheduler=parts.scheduler,
        store=parts.store,
        live=live_pool(settings),
        reader=reading_pool(settings.data_directory),
        cached_answers=KeptAnswers(settings.data_directory / CACHE_DIRECTORY / "figures"),
        engine=parts.engine,
        writes=WriteCheck(Deployment(parts.engine, parts.store), parts.integrity),
        watcher=Watcher(parts.engine, partial(events.event_of, registry=registry)),
    )
