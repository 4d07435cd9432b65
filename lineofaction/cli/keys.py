"""``loa keys``: who may use a service."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from lineofaction.cli.output import console, print_json, table
from service.access.key_file import AccessKey, KeyFile
from service.settings import load_settings

Json = dict[str, Any]


class Keys:
    """The access keys in the file of the command line, or else in the file of the settings."""

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
            rows = [{k: v for k, v in asdict(key).items() if k != "sha256"} for key in keys]
            print_json({"file": str(self._file.path), "keys": rows})
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
