"""Options that several verbs share."""

from __future__ import annotations

from typing import Annotated

import typer

DEFAULT_SERVICE = "http://127.0.0.1:8321"

AsJson = Annotated[bool, typer.Option("--json", help="Print JSON on standard output and nothing else.")]
AsCsv = Annotated[bool, typer.Option("--csv", help="Print CSV on standard output and nothing else.")]
Service = Annotated[str, typer.Option("--service", envvar="LOA_SERVICE", help="Address of the service.")]
TableService = Annotated[
    str | None,
    typer.Option("--service", help="Fetch the tables from this service instead of computing them locally."),
]

Torque = Annotated[
    float | None, typer.Option(help="Torque on the driving gear in N m; default: the highest load.")
]
Force = Annotated[float | None, typer.Option(help="Normal tooth force in N, instead of a torque.")]
Misalignment = Annotated[
    float | None, typer.Option(help="Misalignment in um; default: the value of the case nearest to 0.")
]
CenterDistanceChange = Annotated[
    float | None, typer.Option(help="Change of the center distance in mm; default: the value nearest to 0.")
]
TaskWorkers = Annotated[
    int, typer.Option("--workers", min=1, max=256, help="Local processes that share the tasks.")
]
DaskScheduler = Annotated[
    str | None, typer.Option("--dask", help="Address of a Dask scheduler whose workers run the tasks.")
]


def load_point(
    torque: float | None, force: float | None, misalignment_um: float | None, change_mm: float | None
) -> dict[str, float | None]:
    """Return one load and alignment under the names of their fields."""
    return {
        "torque_n_m": torque,
        "normal_force_n": force,
        "misalignment_um": misalignment_um,
        "center_distance_change_mm": change_mm,
    }
