"""``loa store``: check and clean the store of results of a service."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import Any

import typer

from host.directories import keep_private
from lineofaction.cli.output import console, print_json, table
from lineofaction.gearbox.problems import EXIT_FAILED
from service.queue.machinery import job_machinery
from service.queue.retention import Retention
from service.settings import load_settings
from service.store.database import open_database
from service.store.deployment import Deployment
from service.store.maintenance import Leftover, Quarantine, verify_store
from service.store.places import DATABASE_FILE, result_files
from service.store.reindex import reindex
from service.store.results import ResultStore
from service.worker.process import Registry


class Results:
    """The store of results of the settings."""

    def __init__(self, data_directory: Path | None, *, as_json: bool) -> None:
        self._settings, self._as_json = load_settings(data_directory=data_directory), as_json
        keep_private()

    def verify(self) -> None:
        """Verify, and fail if a file was damaged or is gone."""
        with closing(job_machinery(self._settings, Registry(), works=False)) as parts:
            audit = verify_store(parts.store)
        if self._as_json:
            print_json(asdict(audit))
        else:
            lists = (("damaged, set aside", audit.damaged), ("missing", audit.missing))
            _list_names(*lists, ("unknown", audit.unknown))
            bad, aside = len(audit.damaged) + len(audit.missing), len(audit.unknown)
            typer.echo(f"{audit.sound} files intact, {bad} damaged or missing")
            if aside or audit.quarantined:
                typer.echo(f"{aside} not in the index (kept), {audit.quarantined} in quarantine")
        if audit.damaged or audit.missing:
            raise typer.Exit(EXIT_FAILED)

    def collect(self, *, dry_run: bool, older_than: float | None) -> None:
        """Run the retention, and print the removed items."""
        settings = self._settings
        days = settings.retention_days if older_than is None else older_than
        with closing(job_machinery(settings, Registry(), works=False)) as parts:
            terms = (settings.data_directory, settings.quarantine_days)
            retention = Retention(parts.engine, parts.store, *terms)
            items = list(retention.collect(days, dry_run=dry_run))
        if self._as_json:
            answer: dict[str, Any] = {"dry_run": dry_run, "older_than_days": days}
            answer["quarantine_days"] = settings.quarantine_days
            answer |= {"bytes": sum(item.size for item in items), "removed": [asdict(o) for o in items]}
            print_json(answer)
        else:
            _show_leftovers(items, settings.quarantine_days, dry_run=dry_run)

    def reindex(self, *, quarantined: bool) -> None:
        """Rebuild the index, and fail if a file was damaged."""
        settings = self._settings
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
        if self._as_json:
            print_json(asdict(index))
        else:
            _list_names(("damaged", index.damaged), ("of a result that has a file", index.doubled))
            _list_names(("file missing, removed from the index", index.struck))
            typer.echo(f"{index.entered} results entered, {index.known} known, {len(index.damaged)} damaged")
        if index.damaged:
            raise typer.Exit(EXIT_FAILED)


def _list_names(*groups: tuple[str, Sequence[str]]) -> None:
    for why, names in groups:
        for name in names:
            typer.echo(f"{why}: {name}")


def _show_leftovers(items: Sequence[Leftover], quarantine_days: float, *, dry_run: bool) -> None:
    reasons = sorted({item.why for item in items})
    rows = []
    for why in reasons:
        sizes = [item.size for item in items if item.why == why]
        rows.append((why, str(len(sizes)), f"{sum(sizes) / 1e6:.1f}"))
    if rows:
        console().print(table(("left over", "number", "MB"), rows))
    typer.echo(f"{len(items)} {'to remove' if dry_run else 'removed'}")
    if quarantined := sum(item.quarantined for item in items):
        typer.echo(f"of these {quarantined} to quarantine for {quarantine_days:g} days")
