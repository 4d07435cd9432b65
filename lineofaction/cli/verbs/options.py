"""Options that several verbs share."""

from __future__ import annotations

from dataclasses import dataclass
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

TaskWorkers = Annotated[
    int, typer.Option("--workers", min=1, max=256, help="Local processes that share the tasks.")
]
DaskScheduler = Annotated[
    str | None, typer.Option("--dask", help="Address of a Dask scheduler whose workers run the tasks.")
]


Force = Annotated[float | None, typer.Option(help="Normal tooth force in N, instead of a torque.")]


@dataclass(frozen=True)
class LoadPoint:
    """One load and alignment."""

    torque: Annotated[
        float | None, typer.Option(help="Torque on the driving gear in N m; default: the highest load.")
    ] = None
    force: Force = None
    misalignment_um: Annotated[
        float | None, typer.Option(help="Misalignment in um; default: the value of the case nearest to 0.")
    ] = None
    center_distance_change_mm: Annotated[
        float | None,
        typer.Option(help="Change of the center distance in mm; default: the value nearest to 0."),
    ] = None

    @property
    def inputs(self) -> dict[str, float | None]:
        """The load and the alignment under the names of their fields."""
        return {
            "torque_n_m": self.torque,
            "normal_force_n": self.force,
            "misalignment_um": self.misalignment_um,
            "center_distance_change_mm": self.center_distance_change_mm,
        }
