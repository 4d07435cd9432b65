"""Options that several verbs share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

DEFAULT_SERVICE = "http://127.0.0.1:8321"

AsJson = Annotated[bool, typer.Option("--json", help="Print JSON on standard output and nothing else.")]
Service = Annotated[str, typer.Option("--service", envvar="LOA_SERVICE", help="Address of the service.")]
StudyFile = Annotated[
    Path | None, typer.Option("-o", "--output", help="File ending in .nc, .json, .png or .html.")
]
TableService = Annotated[
    str | None,
    typer.Option("--service", help="Take the tables from this service instead of computing them here."),
]
