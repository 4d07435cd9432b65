"""``loa store``."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict
from typing import Any

import typer

from host.directories import keep_private
from lineofaction.cli.output import console, print_json, table
from lineofaction.gearbox.problems import EXIT_FAILED
from service.queue.machinery import Machinery, job_machinery
from service.queue.retention import Retention
from service.settings import Settings, load_settings
from service.store import DATABASE_FILE, ResultStore, open_database
from service.store.deployment import Deployment
from service.store.maintenance import Leftover, verify_store
from service.store.places import result_files
from service.store.quarantine import Quarantine
from service.store.reindex import reindex
from service.worker.process import Registry


def run_verify(*, as_json: bool, **options: object) -> None:
    """Verify, and fail if a file was damaged or is gone."""
    _, parts = _opened(options)
    with closing(parts):
        audit = verify_store(parts.store)
    if as_json:
        print_json(asdict(audit))
    else:
        _list(("damaged, set aside", audit.damaged), ("missing", audit.missing), ("unknown", audit.unknown))
        bad, aside = len(audit.damaged) + len(audit.missing), len(audit.unknown)
        typer.echo(f"{audit.sound} files intact, {bad} damaged or missing")
        if aside or audit.quarantined:
            typer.echo(f"{aside} not in the index (kept), {audit.quarantined} in quarantine")
    if audit.damaged or audit.missing:
        raise typer.Exit(EXIT_FAILED)


def run_gc(*, as_json: bool, dry_run: bool, older_than: float | None, **options: object) -> None:
    """Collect, and tell what."""
    settings, parts = _opened(options)
    days = settings.retention_days if older_than is None else older_than
    with closing(parts):
        retention = Retention(parts.engine, parts.store, settings.data_directory, settings.quarantine_days)
        items = list(retention.collect(days, dry_run=dry_run))
    if as_json:
        facts: dict[str, Any] = {"dry_run": dry_run, "older_than_days": days}
        facts["quarantine_days"] = settings.quarantine_days
        facts |= {"bytes": sum(item.size for item in items), "removed": [asdict(o) for o in items]}
        print_json(facts)
    else:
        _show(items, settings.quarantine_days, dry_run=dry_run)


def run_reindex(*, as_json: bool, quarantined: bool, **options: object) -> None:
    """Rebuild the index, and fail if a file was damaged."""
    settings = load_settings(**options)
    keep_private()
    engine = open_database(settings.database_address or settings.data_directory / DATABASE_FILE)
    files = result_files(settings.data_directory, settings.results_url, keys=settings.results_keys)
    store = ResultStore(engine, files)
    deployment = Deployment(engine, store)
    try:
        if quarantined:
            deployment.take_over()
            Quarantine(store.files, deployment, settings.quarantine_days).release()
        index = reindex(store, deployment)
    finally:
        engine.dispose()
    if as_json:
        print_json(asdict(index))
    else:
        _list(("damaged", index.damaged), ("of a result that has a file", index.doubled))
        _list(("file missing, removed from the index", index.struck))
        typer.echo(f"{index.entered} results entered, {index.known} known, {len(index.damaged)} damaged")
    if index.damaged:
        raise typer.Exit(EXIT_FAILED)


def _list(*groups: tuple[str, Sequence[str]]) -> None:
    """Print names, each with the reason why it is listed."""
    for why, names in groups:
        for name in names:
            typer.echo(f"{why}: {name}")


def _show(items: Sequence[Leftover], quarantine_days: float, *, dry_run: bool) -> None:
    """Print a table of what was found by its reason."""
    reasons = sorted({item.why for item in items})
    rows = []
    for why in reasons:
        sizes = [item.size for item in items if item.why == why]
        rows.append((why, str(len(sizes)), f"{sum(sizes) / 1e6:.1f}"))
    if rows:
        console().print(table(("left over", "number", "MB"), rows))
    typer.echo(f"{len(items)} {'to remove' if dry_run else 'removed'}")
    if held := sum(item.quarantined for item in items):
        typer.echo(f"of these {held} to quarantine for {quarantine_days:g} days")


def _opened(options: dict[str, object]) -> tuple[Settings, Machinery]:
    settings = load_settings(**options)
    keep_private()
    return settings, job_machinery(settings, Registry(), works=False)
