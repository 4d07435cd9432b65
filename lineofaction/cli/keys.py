"""``loa keys``: who may use a service."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from lineofaction.cli.output import console, print_json, table
from service.access import AccessKey, KeyFile
from service.settings import load_settings


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


def run_list(path: Path | None, *, as_json: bool) -> None:
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
