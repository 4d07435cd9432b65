"""Write the tables of verbs and processes in docs/cli.md and docs/service.md from the program.

Usage: service_pages.py PAGE... The table of routes stands on the site alone, which makes it when it is built.
"""

from __future__ import annotations

import re
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

from typer.main import get_command

from lineofaction.cli.commands import app
from lineofaction.gearbox.registry import STUDIES
from service.app import create_app
from service.settings import Settings

TABLE = re.compile(r"(<!-- table of (\w+) -->\n\n)(.*?)(\n\n<!-- end of table -->)", re.DOTALL)
ROUTES = "<!-- all routes -->"
"""Mark of the table of routes on the page of the service."""
EXECUTION = re.compile(r"/v1/processes/([a-z-]+)/execution")


def page(text: str, api: dict[str, Any]) -> str:
    """Return the page with its tables anew."""
    tables = {"verbs": verbs(text), "processes": processes(api)}
    return TABLE.sub(lambda found: f"{found[1]}{tables[found[2]]}{found[4]}", text)


def table(titles: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    """Return a table."""
    return "\n".join(f"| {' | '.join(line)} |" for line in (titles, ("---",) * len(titles), *rows))


def verbs(text: str) -> str:
    """Return a table of the verbs but for studies, by the main clause of their help, linked to sections."""
    descriptions = dict(commands(get_command(app), "loa"))
    for name in STUDIES:
        descriptions.pop(f"loa {name}", None)
    linked = {verb: f"[`{verb}`](#{verb.replace(' ', '-')})" for verb in re.findall(r"\n## `(.+)`\n", text)}
    return table(
        ("verb", "what it does"),
        (
            (linked.get(verb, f"`{verb}`"), f"{re.split('[:;] |[.]$', text)[0]}.")
            for verb, text in descriptions.items()
        ),
    )


def commands(group: Any, name: str) -> Iterator[tuple[str, str]]:
    """Yield the verbs of a group and the first line of their help."""
    for verb, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from commands(command, f"{name} {verb}")
        else:
            yield f"{name} {verb}", command.help.partition("\n")[0]


def with_routes(text: str, api: Callable[[], dict[str, Any]]) -> str:
    """Return a page with the table of routes where it has the mark of it; `api` describes the service."""
    return text.replace(ROUTES, routes(api())) if ROUTES in text else text


def described() -> dict[str, Any]:
    """Return the description of the service with all its processes."""
    with tempfile.TemporaryDirectory() as folder:
        return create_app(Settings(data_directory=Path(folder))).openapi()


def routes(api: dict[str, Any]) -> str:
    """Return a table of the routes, those of executions once."""
    rows = {"`POST /v1/processes/{id}/execution`": "Submit a job: 201 with its status and `Location`"}
    for path, operations in api["paths"].items():
        short = re.sub(r"\{\w+_id\}", "{id}", path).replace("{key}", "{hash}")
        for method, operation in () if EXECUTION.fullmatch(path) else operations.items():
            rows[f"`{method.upper()} {short}`"] = operation["summary"]
    return table(("route", "what it does"), rows.items())


def processes(api: dict[str, Any]) -> str:
    """Return the inputs of each process, with the defaults that are one value."""
    rows, schemas = [], api["components"]["schemas"]
    for path, operations in api["paths"].items():
        if found := EXECUTION.fullmatch(path):
            body = operations["post"]["requestBody"]["content"]["application/json"]["schema"]
            execute = schemas[body["$ref"].rpartition("/")[2]]["properties"]["inputs"]
            fields = schemas[execute["$ref"].rpartition("/")[2]]["properties"]
            texts = {name: f"`{name}`{default(told)}" for name, told in fields.items()}
            subject = " or ".join(texts.pop(name) for name in ("case", "scene") if name in texts)
            rows.append((f"`{found[1]}`", subject, ", ".join(texts.values())))
    return table(("process", "of a", "further inputs, with their defaults"), rows)


def default(schema: dict[str, Any]) -> str:
    """Return the default of a field if it is one value."""
    value = schema.get("default")
    return f" ({str(value).lower()})" if isinstance(value, bool | int | float | str) else ""


if __name__ == "__main__":
    description = described()
    for file in map(Path, sys.argv[1:]):
        file.write_text(page(file.read_text("utf-8"), description), "utf-8")
