"""Arguments and options that several verbs share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import typer

DEFAULT_SERVICE = "http://127.0.0.1:8321"

AsJson = Annotated[bool, typer.Option("--json", help="Print JSON on standard output and nothing else.")]
AsCsv = Annotated[bool, typer.Option("--csv", help="Print CSV on standard output and nothing else.")]
Service = Annotated[str, typer.Option("--service", envvar="LOA_SERVICE", help="Address of the service.")]
TableService = Annotated[
    str | None,
    typer.Option("--service", help="Fetch the tables from this service instead of computing them locally."),
]

TaskWorkers = Annotated[
    int, typer.Option("--workers", min=1, max=256, help="Local processes that share the tasks.")
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        envvar="LOA_SCHEDULER",
        help="Dask scheduler whose workers share the tasks: its address, or its file.",
    ),
]


Force = Annotated[float | None, typer.Option("--force", help="Normal tooth force in N, instead of a torque.")]


def to_file(text: str) -> Any:
    """Return the option of the file that a verb writes."""
    return typer.Option("-o", "--output", help=text)


@dataclass(frozen=True)
class PairWishes:
    """Data of a pair that the caller names by options.

    A field that is None follows by rule. Lengths are in mm, angles in deg.
    """

    module: Annotated[float | None, typer.Option(min=0.05, max=100.0, help="Normal module in mm.")] = None
    teeth: Annotated[int | None, typer.Option(min=6, max=500, help="Teeth of the pinion, or of the sun.")] = (
        None
    )
    ratio: Annotated[
        float | None, typer.Option(min=1.0, max=50.0, help="Speed ratio, driving to driven gear.")
    ] = None
    helix: Annotated[float | None, typer.Option(min=-45.0, max=45.0, help="Helix angle in deg.")] = None
    width: Annotated[float | None, typer.Option(min=0.05, max=5000.0, help="Face width in mm.")] = None
