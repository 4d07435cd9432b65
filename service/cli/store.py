"""``loa store``."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict
from typing import Any

import typer

from service.cli.output import console, print_json, table
from service.jobs.machinery import Machinery, job_machinery
from service.jobs.process import Registry
from service.jobs.retention import Retention
from service.problems import EXIT_FAILED
from service.settings import Settings, load_settings
from service.store.maintenance import Leftover, verify_store


def run_verify(*, as_json: bool, **given: object) -> None:
    """Verify, and fail if a file was damaged or is gone."""
    _, parts = _opened(given)
    with closing(parts):
        found = verify_store(parts.store)
    if as_json:
        print_json(asdict(found))
    else:
        for why, names in (("damaged, set aside", found.damaged), ("missing", found.missing)):
            for name in names:
                typer.echo(f"{why}: {name}")
        bad = len(found.damaged) + len(found.missing)
        typer.echo(f"{found.sound} files sound, {bad} damaged or missing")
    if found.damaged or found.missing:
        raise typer.Exit(EXIT_FAILED)


def run_gc(*, as_json: bool, dry_run: bool, older_than: float | None, **given: object) -> None:
    """Collect, and tell what."""
    settings, parts = _opened(given)
    days = settings.retention_days if older_than is None else older_than
    with closing(parts):
        retention = Retention(parts.engine, parts.store, settings.data_directory)
        found = list(retention.collect(days, dry_run=dry_run))
    if as_json:
        facts: dict[str, Any] = {"dry_run": dry_run, "older_than_days": days}
        print_json(facts | {"bytes": sum(one.size for one in found), "removed": [asdict(o) for o in found]})
    else:
        _show(found, dry_run=dry_run)


def _show(found: Sequence[Leftover], *, dry_run: bool) -> None:
    """Print a table of what was found by its reason."""
    reasons = sorted({one.why for one in found})
    rows = []
    for why in reasons:
        sizes = [one.size for one in found if one.why == why]
        rows.append((why, str(len(sizes)), f"{sum(sizes) / 1e6:.1f}"))
    if rows:
        console().print(table(("left over", "number", "MB"), rows))
    typer.echo(f"{len(found)} {'to remove' if dry_run else 'removed'}")


def _opened(given: dict[str, object]) -> tuple[Settings, Machinery]:
    """Open the database and the store of the settings."""
    settings = load_settings(**given)
    return settings, job_machinery(settings, Registry(), works=False)
