"""``loa keys``: who may use a service."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path

from service.access import KeyFile
from service.cli.output import console, print_json, table
from service.settings import load_settings


def key_file(path: Path | None) -> KeyFile:
    """Return the file named on the command line, or that of the settings."""
    return KeyFile(path or load_settings().key_file)


def run_add(name: str, path: Path | None, *, as_json: bool, **limits: int | None) -> None:
    """Make a key and print it, once."""
    file = key_file(path)
    secret = file.add(name, **limits)
    if as_json:
        print_json({"name": name, "key": secret, "file": str(file.path)})
        return
    sys.stdout.write(f"{secret}\n")
    sys.stderr.write(f"Key {name!r} is in {file.path}. It is shown only once: only its hash is stored.\n")


def run_list(path: Path | None, *, as_json: bool) -> None:
    """Print names and limits."""
    file = key_file(path)
    keys = [{k: v for k, v in asdict(key).items() if k != "sha256"} for key in file.read()]
    if as_json:
        print_json({"file": str(file.path), "keys": keys})
        return
    titles = [
        "name",
        "created",
        "requests per minute",
        "unfinished jobs",
        "highest priority",
        "CPU s of a job",
    ]
    rows = [["no limit" if value is None else str(value) for value in key.values()] for key in keys]
    console().print(table(titles, rows, f"Keys in {file.path}"))


def run_remove(name: str, path: Path | None) -> None:
    """Take a key back; a service that runs heeds it at the next request."""
    key_file(path).remove(name)
