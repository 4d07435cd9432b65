"""``loa keys``, ``loa database`` and ``loa store``: who may use a service, and what it keeps."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import Any

import typer

from host.directories import keep_private
from lineofaction.cli.output import console, print_json, table
from lineofaction.gearbox.problems import EXIT_FAILED
from service.access.keyring import AccessKey, KeyFile
from service.queue.retention import Retention
from service.queue.scheduler import job_machinery
from service.settings import load_settings
from service.store.database import Schema, database_engine, open_database, shown
from service.store.deployment import Deployment
from service.store.maintenance import Leftover, Quarantine, reindex, verify_store
from service.store.migrations import REVISIONS
from service.store.places import DATABASE_FILE, result_files
from service.store.results import ResultStore
from service.worker.process import Registry

Json = dict[str, Any]


class Keys:
    """The access keys in the file named on the command line, or in that of the settings."""

    def __init__(self, path: Path | None, *, as_json: bool = False) -> None:
        self._file, self._as_json = KeyFile(path or load_settings().key_file), as_json

    def add(self, name: str, *, scopes: str | None, expires: str | None, **rights: Any) -> None:
        """Make a key and print it, once."""
        named = None if scopes is None else [scope.strip() for scope in scopes.split(",")]
        self._show_once(name, self._file.add(name, expires=expires, scopes=named, **rights))

    def rotate(self, name: str, overlap: str, expires: str | None) -> None:
        """Make the next key of a name and print it, once."""
        self._show_once(name, self._file.rotate(name, overlap=overlap, expires=expires))

    def _show_once(self, name: str, secret: str) -> None:
        path = self._file.path
        if self._as_json:
            print_json({"name": name, "key": secret, "file": str(path)})
            return
        sys.stdout.write(f"{secret}\n")
        sys.stderr.write(f"Key {name!r} is in {path}. It is shown only once: only its hash is stored.\n")

    def show(self) -> None:
        """Print names, rights, limits and ends."""
        keys = self._file.read()
        if self._as_json:
            facts = [{k: v for k, v in asdict(key).items() if k != "sha256"} for key in keys]
            print_json({"file": str(self._file.path), "keys": facts})
            return
        titles = ["name", "project", "scopes", "created", "expires", "limits"]
        console().print(table(titles, [_row(key) for key in keys], f"Keys in {self._file.path}"))

    def remove(self, name: str) -> None:
        """Take a key back; a service that runs heeds it at the next request."""
        self._file.remove(name)


def _row(key: AccessKey) -> list[str]:
    expires = "never" if key.expires is None else f"{key.expires}{' (expired)' if key.expired else ''}"
    limits = [f"{value} {name.replace('_', ' ')}" for name, value in key.limits.items() if value is not None]
    return [
        key.name,
        key.project or "common",
        ", ".join(key.scopes),
        key.created,
        expires,
        ", ".join(limits) or "none",
    ]


# ``loa database``.


class JobTables:
    """The tables of jobs in the database of the settings."""

    def __init__(self, data_directory: Path | None, *, as_json: bool) -> None:
        settings = load_settings(data_directory=data_directory)
        keep_private()
        engine = database_engine(
            settings.database_address or settings.data_directory / DATABASE_FILE, pooled=False
        )
        self._schema, self._name, self._as_json = Schema(engine), shown(engine), as_json

    def upgrade(self) -> None:
        """Upgrade, and tell from which schema to which."""
        before = self._schema.revision()
        self._schema.upgrade()
        facts: Json = {"database": self._name, "before": before, "schema": REVISIONS[-1]}
        self._tell(facts, f"{before or 'no tables'} -> {REVISIONS[-1]}")

    def status(self) -> None:
        """Tell both schemas; fail if this program cannot use that of the database."""
        numbers, current = self._schema.numbers(), REVISIONS[-1]
        facts: Json = {"database": self._name, "schema": numbers.newest, "program": current}
        facts |= {"up_to_date": numbers.ours, "usable": numbers.usable}
        newer = f"newer, but this program ({current}) can use it"
        needed = newer if numbers.usable else f"this program needs {current}"
        self._tell(facts, f"{numbers.newest or 'no tables'}, {'up to date' if numbers.ours else needed}")
        if not numbers.usable:
            raise typer.Exit(EXIT_FAILED)

    def _tell(self, facts: Json, state: str) -> None:
        if self._as_json:
            print_json(facts)
        else:
            typer.echo(f"{self._name}: {state}")


# ``loa store``.


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
            lost = (("damaged, set aside", audit.damaged), ("missing", audit.missing))
            _list_names(*lost, ("unknown", audit.unknown))
            bad, aside = len(audit.damaged) + len(audit.missing), len(audit.unknown)
            typer.echo(f"{audit.sound} files intact, {bad} damaged or missing")
            if aside or audit.quarantined:
                typer.echo(f"{aside} not in the index (kept), {audit.quarantined} in quarantine")
        if audit.damaged or audit.missing:
            raise typer.Exit(EXIT_FAILED)

    def collect(self, *, dry_run: bool, older_than: float | None) -> None:
        """Collect, and tell what."""
        settings = self._settings
        days = settings.retention_days if older_than is None else older_than
        with closing(job_machinery(settings, Registry(), works=False)) as parts:
            kept = (settings.data_directory, settings.quarantine_days)
            retention = Retention(parts.engine, parts.store, *kept)
            items = list(retention.collect(days, dry_run=dry_run))
        if self._as_json:
            facts: dict[str, Any] = {"dry_run": dry_run, "older_than_days": days}
            facts["quarantine_days"] = settings.quarantine_days
            facts |= {"bytes": sum(item.size for item in items), "removed": [asdict(o) for o in items]}
            print_json(facts)
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
    if held := sum(item.quarantined for item in items):
        typer.echo(f"of these {held} to quarantine for {quarantine_days:g} days")
