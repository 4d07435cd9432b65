"""Cost of work on housings, in figures."""

from __future__ import annotations

from typing import Annotated

from lineofaction.gearbox.schemas.figures import Part, Source


class PredictedCost(Part):
    """Predicted CPU seconds on the host that computed the result, and bytes of the largest working set."""

    cpu_seconds: Annotated[float, Source("seconds")]
    bytes: float


class HousingCost(Part):
    """Cost of work on a housing: bytes are null where the process had been as large before."""

    predicted_cpu_seconds: Annotated[float, Source("predicted_seconds")]
    predicted_bytes: float
    cpu_seconds: Annotated[float, Source("seconds")]
    bytes: float | None
