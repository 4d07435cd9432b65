"""Addresses that a request may have called about its job, and the bodies of the calls."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from lineofaction.gearbox.problems import BadInput
from service.origin import Origin
from service.routes.context import Context
from service.routes.job_results import batch_results, problem_of, reference_of
from service.routes.jobs import status_info
from service.schemas.answers import Subscriber
from service.settings import Settings
from service.webhooks.calls import Calls
from service.webhooks.deliverer import Deliverer, Outbox


def checked_uris(settings: Settings, subscriber: Subscriber | None) -> dict[str, str]:
    """Return the addresses to call, by event; raises `BadInput` for any that is not listed."""
    if subscriber is None:
        return {}
    listed = settings.origins
    if not listed:
        bound = "left out: this service sends no requests to addresses that its callers name"
        raise BadInput.of("subscriber", None, bound, "Follow /v1/jobs/{id}/events.")
    for event, uri in subscriber.uris.items():
        with suppress(ValueError):  # a text that is no address is refused below, too
            if Origin.of(uri) in listed:
                continue
        bound = f"an address at {' or '.join(map(str, sorted(listed, key=str)))}"
        raise BadInput.of(f"subscriber.{event}Uri", uri, bound)
    return subscriber.uris


def enter_calls(context: Context, job: str, uris: dict[str, str]) -> None:
    """Enter the calls to be made about a job, if there are any."""
    if uris:
        Calls(context.engine).enter(job, uris)


def deliverer_of(context: Context) -> Deliverer | None:
    """Return the deliverer of calls, None: no calls are allowed."""
    settings = context.settings
    if not settings.origins:
        return None
    calls = Calls(context.engine)
    outbox = Outbox(
        calls,
        settings.origins,
        settings.webhook_key,
        lambda job, event: _message(context.within(calls.project_of(job)), job, event),
    )
    return Deliverer(outbox)


def _message(context: Context, identifier: str, event: str) -> Any:
    """Return the body of a call: the status, the document of the results, or the problem."""
    job = context.submissions.find(identifier)
    problem = problem_of(job)
    if event == "inProgress":
        return status_info(job, context.registry).model_dump()
    if event == "failed" and problem is not None:
        return problem.as_json()
    if job.children:
        return batch_results(context, job).model_dump()
    return {context.registry[job.process].output: reference_of(job).model_dump()}
