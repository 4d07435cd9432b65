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
from service.access import AccessKey, KeyFile
from service.queue.machinery import Machinery, job_machinery
from service.queue.retention import Retention
from service.settings import Settings, load_settings
from service.store import DATABASE_FILE, ResultStore, open_database
from service.store.database import Schema, database_engine, shown
from service.store.deployment import Deployment
from service.store.maintenance import Leftover, Quarantine, reindex, verify_store
from service.store.migrations import REVISIONS
from service.store.places import result_files
from service.worker.process import Registry


def key_file(path: Path | None) -> KeyFile:
    """Return the file named on the command line, or that of the settings."""
    return KeyFile(path or load_settings().key_file)


def run_add(
    name: str, path: Path | None, *, as_json: bool, scopes: str | None, expires: str | None, **rights: Any
) -> None:
    """Make a key and print it, once."""
    file = key_file(path)
    named = None if scopes is None else [scope.strip() for scope in scopes.split(",")]
    _show_once(file, name, file.add(name, expires=expires, scopes=named, **rights), as_json=as_json)


def run_rotate(name: str, path: Path | None, overlap: str, expires: str | None, *, as_json: bool) -> None:
    """Make the next key of a name and print it, once."""
    file = key_file(path)
    _show_once(file, name, file.rotate(name, overlap=overlap, expires=expires), as_json=as_json)


def _show_once(file: KeyFile, name: str, secret: str, *, as_json: bool) -> None:
    """Print a new key."""
    if as_json:
        print_json({"name": name, "key": secret, "file": str(file.path)})
        return
    sys.stdout.write(f"{secret}\n")
    sys.stderr.write(f"Key {name!r} is in {file.path}. It is shown only once: only its hash is stored.\n")


def run_list_keys(path: Path | None, *, as_json: bool) -> None:
    """Print names, rights, limits and ends."""
    file = key_file(path)
    keys = file.read()
    if as_json:
        facts = [{k: v for k, v in asdict(key).items() if k != "sha256"} for key in keys]
        print_json({"file": str(file.path), "keys": facts})
        return
    titles = ["name", "project", "scopes", "created", "expires", "limits"]
    console().print(table(titles, [_row(key) for key in keys], f"Keys in {file.path}"))


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


def run_remove(name: str, path: Path | None) -> None:
    """Take a key back; a service that runs heeds it at the next request."""
    key_file(path).remove(name)


# ``loa database``.


Json = dict[str, Any]


def run_upgrade(*, as_json: bool, **options: object) -> None:
    """Upgrade, and tell from which schema to which."""
    schema, name = _schema(options)
    before = schema.revision()
    schema.upgrade()
    facts: Json = {"database": name, "before": before, "schema": REVISIONS[-1]}
    _tell_schema(facts, f"{name}: {before or 'no tables'} -> {REVISIONS[-1]}", as_json=as_json)


def run_status(*, as_json: bool, **options: object) -> None:
    """Tell both schemas; fail if this program cannot use that of the database."""
    schema, name = _schema(options)
    numbers, current = schema.numbers(), REVISIONS[-1]
    facts: Json = {"database": name, "schema": numbers.newest, "program": current}
    facts |= {"up_to_date": numbers.ours, "usable": numbers.usable}
    newer = f"newer, but this program ({current}) can use it"
    needed = newer if numbers.usable else f"this program needs {current}"
    state = "up to date" if numbers.ours else needed
    _tell_schema(facts, f"{name}: {numbers.newest or 'no tables'}, {state}", as_json=as_json)
    if not numbers.usable:
        raise typer.Exit(EXIT_FAILED)


def _schema(options: dict[str, object]) -> tuple[Schema, str]:
    """Return the schema of the database of the settings, and the database's name."""
    settings = load_settings(**options)
    keep_private()
    engine = database_engine(
        settings.database_address or settings.data_directory / DATABASE_FILE, pooled=False
    )
    return Schema(engine), shown(engine)


def _tell_schema(facts: Json, line: str, *, as_json: bool) -> None:
    """Print for a program or for people."""
    if as_json:
        print_json(facts)
    else:
        typer.echo(line)


# ``loa store``.


def run_verify(*, as_json: bool, **options: object) -> None:
    """Verify, and fail if a file was damaged or is gone."""
    _, parts = _opened(options)
    with closing(parts):
        audit = verify_store(parts.store)
    if as_json:
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
        _show_leftovers(items, settings.quarantine_days, dry_run=dry_run)


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
        _list_names(("damaged", index.damaged), ("of a result that has a file", index.doubled))
        _list_names(("file missing, removed from the index", index.struck))
        typer.echo(f"{index.entered} results entered, {index.known} known, {len(index.damaged)} damaged")
    if index.damaged:
        raise typer.Exit(EXIT_FAILED)


def _list_names(*groups: tuple[str, Sequence[str]]) -> None:
    """Print names, each with the reason why it is listed."""
    for why, names in groups:
        for name in names:
            typer.echo(f"{why}: {name}")


def _show_leftovers(items: Sequence[Leftover], quarantine_days: float, *, dry_run: bool) -> None:
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
